"""Tables as files: their columns are described, and come back from CSV as they were."""

import numpy as np
import pandas as pd
import pytest

import asperity as asp
from asperity import Body, run
from asperity.core.errors import DatasetError
from asperity.results.tables import check_columns, read_table, units, write_table, write_workbook
from asperity.study.cost.benchmark import cost_table, job_costs
from asperity.views.export import peak_table


@pytest.fixture
def costs(tmp_path):
    surface = {"surface": "a"}
    jobs = (("stress", surface, 60, 100), ("stress", surface, 30, 300), ("claims", {}, 6, 50))
    (tmp_path / "benchmark").mkdir()
    for number, (rule, wildcards, seconds, memory) in enumerate(jobs):
        text = f"max_rss\tcpu_time\trule_name\twildcards\tresources\n{memory}\t{seconds}\t{rule}\t{wildcards}"
        (tmp_path / f"benchmark/{number}.tsv").write_text(text + "\t{'mem_mb': 200}\n")
    return cost_table(job_costs(tmp_path))


def test_tables_of_an_answer_are_described(tmp_path):
    """They come back from CSV; tables of peaks have their units in both unit systems."""
    height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    answer = run(surface, Body(young=210e9, poisson=0.3, yield_stress=1e9), mean_pressure=50e6)
    for table, frame in (("answer", answer.frame()), ("answer_peaks", answer.tables["peaks"])):
        path = tmp_path / f"{table}.csv"
        write_table(frame, table, path)
        pd.testing.assert_frame_equal(read_table(table, path), frame, check_exact=True)
        write_table(frame[:0], table, path)
        assert [*read_table(table, path)] == [*frame]
        path.write_text(path.read_text() + ",".join("x" * len(frame.columns)), encoding="utf-8")
        with pytest.raises(DatasetError, match="could not convert string to float"):
            read_table(table, path)
    for system, unit in (("SI", "depth_um"), ("study", "depth_cell_length")):
        frame = peak_table(answer.stress["lower"].assign_attrs(unit_system=system))
        check_columns(frame, "export_peaks")
        assert units("export_peaks", frame)[unit] == unit.removeprefix("depth_")


def test_workbook_is_in_micrometres_and_megapascals(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    rows = [("contact", "=1+\x01", 1.2e-7, "m", np.nan), ("contact", "maximum pressure", 2e9, "Pa", np.inf)]
    answer = pd.DataFrame(rows, columns=["topic", "quantity", "value", "unit", "error"])
    peaks = pd.DataFrame({"quantity": ["von_mises"], "value_Pa": [3e9], "depth_m": [2e-6]})
    curve = pd.DataFrame(
        {"mean_pressure_Pa": [1e6], "stiffness_Pa_m": [2e13], "electrical_conductance_S_m2": [3e8]}
    )
    per_area = pd.DataFrame({"map_steel_m": [12.0]})
    sheets = {"answer": answer, "peaks": peaks, "curve": curve, "peaks_per_area": per_area}
    write_workbook(sheets, tmp_path / "a.xlsx")
    found = pd.read_excel(tmp_path / "a.xlsx", sheet_name=None)
    assert found["answer"]["value"].tolist() == pytest.approx([0.12, 2000.0])
    assert found["answer"]["unit"].tolist() == ["µm", "MPa"]
    assert found["peaks"].iloc[0].tolist() == ["von_mises", 3000.0, 2.0]
    assert [*found["peaks"]] == ["quantity", "value_MPa", "depth_µm"]
    assert [*found["curve"].iloc[0]] == [1.0, 2e13, 3e8]
    assert [*found["curve"]] == ["mean_pressure_MPa", "stiffness_Pa_m", "electrical_conductance_S_m2"]
    assert found["peaks_per_area"]["map_steel_m"].tolist() == [12.0]
    cells = openpyxl.load_workbook(tmp_path / "a.xlsx")["answer"]
    assert [(cell.value, cell.data_type) for cell in cells["E"][1:]] == [(None, "n"), ("inf", "s")]
    assert (cells["B2"].value, cells["B2"].data_type) == ("=1+?", "s")  # no formula
    write_workbook(sheets, tmp_path / "b.xlsx")
    assert (tmp_path / "a.xlsx").read_bytes() == (tmp_path / "b.xlsx").read_bytes()


def test_costs_add_up_and_keep_the_largest_memory(costs):
    check_columns(costs, "costs")
    minutes = costs.set_index("job")["processor_minutes"].to_dict()
    assert minutes == pytest.approx({"claims": 0.1, "stress a": 1.5, "all": 1.6})
    assert costs["largest_memory_MB"].tolist() == [50, 300, 300]


@pytest.mark.parametrize(
    ("columns", "name", "message"),
    [
        (["of"], "t.csv", "table verification: column 'surface' is missing; columns surface, of,"),
        (["of", "speed"], "t.csv", "table verification: column 'speed' is not among its columns"),
        (["of", "surface", "check", "value", "bound"], "t.csv", "out of order"),
        (["surface", "of", "check", "value", "bound"], "t.xlsx", r"t\.xlsx: a name that ends in \.csv is"),
    ],
)
def test_other_columns_and_suffixes_are_refused(columns, name, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        write_table(pd.DataFrame([[1] * len(columns)], columns=columns), "verification", tmp_path / name)
    assert not list(tmp_path.iterdir())
