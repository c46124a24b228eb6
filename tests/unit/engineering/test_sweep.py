"""A sweep of settings: its rows, the value at the limit, refusals, and a killed sweep that continues."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pandas as pd
import pytest
from project import ROOT
from samples import refuses

import asperity as asp
from asperity.app import form
from asperity.cli.main import main
from asperity.engineering.case_file import load_case
from asperity.engineering.face import read_face
from asperity.engineering.press import press
from asperity.engineering.records import find
from asperity.engineering.stages import BESIDE, answer_of, work_of

EDGE = 64e-6
HEIGHT = asp.self_affine((64, 64), 0.8, 32e-6, 4e-6, rms_height=1e-7, seed=2, length=EDGE)
MAP = asp.HeightMap(HEIGHT, (EDGE, EDGE), periodic=True, unit="m", name="coated")
COATING = {"thickness": 2e-6, "young": 400e9, "poisson": 0.25}
STEEL = {"young": 210e9, "poisson": 0.3, "yield_stress": 2e9, "layers": [COATING]}
THICKNESS = "body.layers.0.thickness"
CASE = {"map": MAP, "body": STEEL, "load": {"mean_pressure": 2e8}}


def test_rows_are_the_records_of_single_runs():
    """To ten times the tolerance of the contact, 1e-6, of the largest number in the unit."""
    answer = asp.run(MAP, STEEL, mean_pressure=2e8, sweep={"values": {THICKNESS: [1e-6, 2e-6, "3 um"]}})
    table = answer.tables["sweep"]
    for thickness in (1e-6, 2e-6, 3e-6):
        rows = table[table[f"at_{THICKNESS}"] == thickness]
        alone = asp.run(MAP, STEEL | {"layers": [COATING | {"thickness": thickness}]}, mean_pressure=2e8)
        assert rows["quantity"].tolist() == [each.quantity for each in alone.records]
        table_alone, scale = alone.frame(), rows.groupby("unit")["value"].transform("max").to_numpy()
        for column in ("value", "error"):
            difference = np.nan_to_num(rows[column].to_numpy() - table_alone[column].to_numpy())
            assert (np.abs(difference) <= 1e-5 * scale).all()
            assert (rows[column].isna().to_numpy() == table_alone[column].isna().to_numpy()).all()
    assert {each.name for each in answer.case.sweep.pictures(answer)} == {"sweep"}
    assert "thickness = 3 µm" in str(answer)


def test_warm_start_has_the_solution_of_a_cold_one():
    """To the tolerance of the pressure, 1e-6 of its norm, of each of the two."""
    case, other = asp.Case(**CASE), asp.Case(**CASE | {"load": {"mean_pressure": 1.8e8}})
    face = read_face(case.map).face
    cold, warm = press(face, case), press(face, case, start=press(face, other))
    assert np.linalg.norm(warm.pressure - cold.pressure) < 2e-6 * np.linalg.norm(cold.pressure)


def test_value_at_the_limit_is_that_of_hertz():
    """p₀³ = 6 F E*² / (π³ R²) (K. L. Johnson, Contact Mechanics, 1985, Eq. 4.24), inverted."""
    smooth = asp.HeightMap(np.zeros((64, 64)), (96e-6, 96e-6), unit="m", name="ball")
    ball = {"file": smooth, "radius": "1 mm", "periodic": "none"}
    values = {"load.force": {"from": 0.5, "to": 2.0, "steps": 4}, "body.poisson": [0.2, 0.3]}
    sweep = {"values": values, "number": "maximum pressure", "limit": "2 GPa"}
    answer = asp.run(ball, {"young": 210e9, "poisson": 0.3}, force=1.0, sweep=sweep)
    found = [each for each in answer.records if each.quantity.startswith("value at the limit")]
    for record, ratio in zip(found, (0.2, 0.3), strict=True):
        force = 2e9**3 * np.pi**3 * 1e-6 / (6 * (210e9 / (1 - ratio**2)) ** 2)
        assert record.value == pytest.approx(force, rel=0.03)
        assert record.note.endswith("its error is not known")  # with a free boundary
        assert record.unit == "N"
    assert "is below its limit, 2 GPa, for a force below" in answer.verdict[0]


def sweeps(**values):
    return lambda: asp.Case(**CASE, sweep={"values": values})


test_wrong_sweep_is_refused_in_one_line = refuses(
    (sweeps(**{"body.yong": [1e9]}), "sweep.values.body.yong: unknown key; did you mean young?"),
    (sweeps(**{"body.base": ["bonded"]}), "sweep.values.body.base = 'bonded': a setting that is a number"),
    (sweeps(**{"map.radius": [5]}), "sweep.values.map.radius = 5: a length with its unit is needed"),
    (sweeps(**{"body.layers.4.thickness": [1e-6]}), "sweep.values.body.layers.4.thickness: the case has no"),
    (sweeps(**{"body.layers.-1.thickness": [1e-6]}), "sweep.values.body.layers.-1.thickness: the case has"),
    (sweeps(**{"film.share": [0.5]}), "sweep.values.film.share: the case has no group film"),
    (sweeps(**{THICKNESS: ["-1 um"]}), f"sweep.values.{THICKNESS} = '-1 um': a length > 0"),
    (sweeps(**{"load.mean_pressure": [1e20]}), "sweep.values.load.mean_pressure = 100000000 TPa: load"),
    (sweeps(**{"body.poisson": [0], "body.young": [1], THICKNESS: [1]}), r"sweep\.values = .*: one or two"),
    (sweeps(**{"body.poisson": {"from": 0.1, "to": 0.2, "steps": 1}}), r"sweep\.values\.body.* = .*, with 2"),
    (sweeps(**{"body.poisson": {"from": 0, "to": 0.2, "steps": 60}, "body.young": [1, 2]}), "sweep: at most"),
    (lambda: asp.Case(**CASE, sweep={"values": {"body.young": [1e9]}, "limit": "7 bananas"}), "sweep.limit"),
)  # fmt: skip


SMALL = asp.self_affine((16, 16), 0.8, 32e-6, 16e-6, rms_height=1e-7, seed=2, length=EDGE)


def small(values, **given):
    """The answer to a sweep on a small map."""
    return asp.run(SMALL, STEEL, length=EDGE, mean_pressure=2e8, sweep={"values": values, **given})


def test_lengths_of_the_map_are_swept():
    """Their rows are those of single runs."""
    heights = asp.HeightMap(SMALL, (EDGE, EDGE), unit="um")

    def answer(sweep=None, **options):
        given = {"map": {"file": heights, **options}, "body": STEEL, "load": {"mean_pressure": 2e8}}
        case = asp.Case(**given, sweep=sweep)
        return answer_of(case, read_face(case.map))

    for key, values in (("radius", ["1 mm", "2 mm"]), ("wavelength_short", ["16 um", "24 um"])):
        table = answer({"values": {f"map.{key}": values}}).tables["sweep"]
        rows = table[table["quantity"] == "maximum pressure"]
        assert rows[f"at_map.{key}"].tolist() == pytest.approx(
            [1e-3, 2e-3] if key == "radius" else [16e-6, 24e-6]
        )
        alone = [next(find(answer(**{key: value}).records, "maximum pressure")).value for value in values]
        assert rows["value"].tolist() == pytest.approx(alone, rel=1e-5)


def test_equal_values_are_computed_once_and_close_ones_have_names():
    """One micrometre in two units is one value; values that agree in four digits are two."""
    table = small({THICKNESS: ["1 um", "1000 nm", "1 um", "1.00001 um"]}).tables["sweep"]
    assert len({*table["case"]}) == len({*table[f"at_{THICKNESS}"]}) == 2


def test_number_or_limit_that_does_not_fit_is_a_warning():
    """The numbers at the top are drawn all the same; a limit in another unit is none."""
    for given, text in (
        ({"number": "foo"}, "foo, is none of this answer"),
        ({"number": "maximum pressure", "limit": "5 um"}, "5 um, is no limit of the maximum pressure, in Pa"),
    ):
        answer = small({THICKNESS: [1e-6, 2e-6]}, **given)
        assert any(text in each.text for each in answer.warnings)
        table, (picture,) = answer.tables["sweep"], answer.case.sweep.pictures(answer)
        assert {"maximum pressure", "contact area fraction"} <= {*table["quantity"][table["is_shown"]]}
        assert "dotted" not in picture.caption


def test_file_form_and_cost_have_the_sweep(tmp_path):
    short = "map: a.npy\nbody: {young: 1 GPa, poisson: 0.3}\nload: {force: 1 N}\n"
    (tmp_path / "case.yaml").write_text(f"{short}sweep: {{values: {{body.poisson: [0.1, 0.2]}}}}")
    case = asp.Case.read(form.content_of(form.values_of(load_case(tmp_path / "case.yaml"))))
    assert case.sweep.path(case, "body.poisson") == [0.1, 0.2]
    work = work_of(case)
    assert work["cases of sweep"] == pytest.approx(2 * sum(work_of(case.replaced(sweep=None)).values()))
    divided = work_of(case, processes=2)["cases of sweep"]
    assert divided == pytest.approx(BESIDE / 2 * work["cases of sweep"])
    written = asp.Case(**CASE, sweep={"values": {THICKNESS: [1e-6]}}).written()["sweep"]
    assert written == {"values": {THICKNESS: ["1 µm"]}}


def test_killed_sweep_continues(tmp_path, monkeypatch, without_pictures):
    """Rows that were finished are kept, and only with --resume."""
    monkeypatch.chdir(tmp_path)
    np.save("ground.npy", 1e6 * HEIGHT[:32, :32])
    words = ["run", "ground.npy", "--unit", "um", "--physical-size", "32 um", "32 um", "--young", "210 GPa"]
    words += ["--poisson", "0.3", "--mean-pressure", "50 MPa", "--out", "out"]
    words += ["--set", "sweep.values={body.poisson: [0.1, 0.2, 0.35, 0.45]}"]
    environment = os.environ | {"PYTHONPATH": str(ROOT / "src")}
    process = subprocess.Popen(
        [sys.executable, "-m", "asperity", *words], env=environment, stderr=subprocess.DEVNULL
    )
    rows = tmp_path / "out/.rows"
    while not (found := [*rows.glob("*.json")]) and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert found, "killed before it ended"
    kept = json.loads(found[0].read_text())
    kept[0]["value"] = 123.0
    found[0].write_text(json.dumps(kept))
    assert main([*words, "--resume"]) == 0
    assert (pd.read_csv("out/sweep.csv")["value"] == 123.0).sum() == 1
    assert not rows.exists()
    rows.mkdir()
    (rows / found[0].name).write_text(json.dumps(kept))
    assert main(words) == 0
    assert not (pd.read_csv("out/sweep.csv")["value"] == 123.0).any()


def test_cases_side_by_side_have_the_rows_of_one_process(monkeypatch):
    monkeypatch.setattr("asperity.engineering.face.SMALLEST_PARALLEL", 0)
    body, values = {"young": 210e9, "poisson": 0.3}, {"values": {"body.young": [1e11, 3e11]}}
    case = asp.Case(map=MAP, body=body, load={"mean_pressure": 5e7}, sweep=values)
    one, two = (answer_of(case, cores=cores).tables["sweep"] for cores in (1, 2))
    pd.testing.assert_frame_equal(one, two)
