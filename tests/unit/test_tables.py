"""Tables as files: their columns are described, and come back from CSV as they were."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import asperity as asp
from asperity import markup
from asperity.engineering import Body, run
from asperity.paper.claims.documents import findings
from asperity.paper.claims.report import frame as frame_of_verdicts
from asperity.paper.claims.report import frame_of_readings
from asperity.results.export import peak_table
from asperity.results.tables import TABLES, check_columns, describe_tables, units, write_table
from asperity.runtime.costs import cost_table, job_costs
from asperity.validation.table import Row
from asperity.validation.table import frame as validation_frame

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def answer():
    height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    return run(surface, Body(young=210e9, poisson=0.3, yield_stress=1e9), mean_pressure=50e6)


@pytest.fixture
def costs(tmp_path):
    for name, seconds, memory in (
        ("stress/a/seed1", 60, 100),
        ("stress/a/seed2", 30, 300),
        ("claims", 6, 50),
    ):
        log = tmp_path / "log" / f"{name}.log"
        log.parent.mkdir(parents=True, exist_ok=True)
        log.write_text(f"done\ntook {seconds} s of processor time, {memory} MB of memory")
    return cost_table(job_costs(tmp_path / "log"))


def test_the_page_of_the_tables_is_made_from_their_description():
    page = (DOCS / "tables.md").read_text(encoding="utf-8")
    assert page.endswith("<!-- python -m asperity.results.tables -->\n\n" + describe_tables())


def test_an_answer_comes_back_from_its_files(answer, tmp_path):
    for table, frame in (("answer", answer.frame()), ("answer_peaks", answer.peaks())):
        path = tmp_path / f"{table}.csv"
        write_table(frame, table, path)
        pd.testing.assert_frame_equal(pd.read_csv(path), frame, check_dtype=False)


def test_peaks_of_both_unit_systems_are_described(answer):
    si = peak_table(answer.stresses["lower"].assign_attrs(unit_system="SI"))
    dimensionless = peak_table(answer.stresses["lower"].assign_attrs(unit_system="study"))
    for frame in (si, dimensionless):
        check_columns(frame, "peaks")
    assert units("peaks", si)["depth_um"] == "um"


def test_costs_add_up_and_the_largest_memory_is_kept(costs):
    check_columns(costs, "costs")
    assert costs.set_index("job")["processor_minutes"].to_dict() == pytest.approx(
        {"claims": 0.1, "stress a": 1.5, "all": 1.6}
    )
    assert costs["largest_memory_MB"].tolist() == [50, 300, 300]


def test_the_validation_table_has_its_columns():
    rows = [
        Row("load", "Hertz", "64²", "grid", 2e-3, 1e-2, "test_a"),
        Row("p", "wave", "", "rate", 0.5, 0.8, "test_b"),
    ]
    found = validation_frame(rows)
    check_columns(found, "validation")
    assert found["holds"].tolist() == [True, False]


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (
            pd.DataFrame({"of": ["a"]}),
            "table verification: column 'surface' is missing; columns surface, of,",
        ),
        (
            pd.DataFrame({"of": ["a"], "speed": [1]}),
            "table verification: column 'speed' is not among its columns",
        ),
        (pd.DataFrame({name: [1] for name in ("of", "surface", "check", "value", "bound")}), "out of order"),
    ],
)
def test_a_table_with_other_columns_is_refused(frame, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        write_table(frame, "verification", tmp_path / "table.csv")
    assert not list(tmp_path.iterdir())


def test_another_suffix_is_refused(costs, tmp_path):
    with pytest.raises(ValueError, match=r"costs\.xlsx: a name that ends in \.csv or \.parquet is needed"):
        write_table(costs, "costs", tmp_path / "costs.xlsx")


def test_parquet_needs_pyarrow_and_says_so(costs, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    monkeypatch.setattr("asperity.results.tables.find_spec", lambda name: None)
    with pytest.raises(ImportError, match=r"Parquet needs the package pyarrow: pip install pyarrow"):
        write_table(costs, "costs", tmp_path / "costs.parquet")


def test_parquet_keeps_numbers_and_units(costs, tmp_path):
    pytest.importorskip("pyarrow")
    write_table(costs, "costs", tmp_path / "costs.parquet")
    found = pd.read_parquet(tmp_path / "costs.parquet")
    pd.testing.assert_frame_equal(found, costs)
    assert found.attrs["units"]["processor_minutes"] == "min"


def test_names_of_columns_are_unique_in_every_table():
    for table in TABLES.values():
        names = [column.name for column in table.columns]
        assert len(set(names)) == len(names)


def test_a_frame_is_a_table_in_markdown_and_html():
    frame = pd.DataFrame({"what": ["**a** | `b`", "<c>"], "value": [1 / 3, np.nan]})
    assert markup.markdown(frame).splitlines() == [
        "| what | value |",
        "|---|---|",
        "| **a** \\| `b` | 0.3333 |",
        "| <c> |  |",
    ]
    assert "<td><strong>a</strong> | <code>b</code></td><td>0.3333</td>" in markup.html_table(frame)
    assert "<td>&lt;c&gt;</td>" in markup.html_table(frame)


def test_verdicts_have_their_columns():
    found = findings(DOCS / "ensemble.csv")
    check_columns(frame_of_verdicts(found, 8.0), "claims")
    check_columns(frame_of_readings(found), "claims_readings")
