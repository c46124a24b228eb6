"""An answer is the same before and after its folder, wherever that lies, and its numbers keep their bounds.

Every case of the documentation, and every template that none of them has the name of, is answered on maps of
32 × 32 pixels.
"""

import json
import pickle
import re
import shutil
from dataclasses import astuple, fields, replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from project import ROOT
from samples import write_map

import asperity as asp
from asperity.core.errors import DatasetError
from asperity.core.packages import absent
from asperity.core.system import sha256_of
from asperity.engineering.case_file import CHECKSUMS, MAP_FILES, OUT, at, case_of_map, load_case, put
from asperity.engineering.folder import CASE_FILE, DATA, MANIFEST
from asperity.engineering.show.report import report
from asperity.engineering.templates import template, templates

PIXELS, EDGE = 32, 62e-6
FILES = sorted((ROOT / "docs/cases").glob("*.yaml"))
SOURCES = [*FILES, *sorted({*templates()} - {path.stem for path in FILES})]


def small_case(source, folder):
    """A case of the documentation or a template, in a folder with small maps and few steps."""
    path = folder / "case.yaml"
    text = source.read_text("utf-8") if isinstance(source, Path) else template(source)
    path.write_text(text, encoding="utf-8")
    content = case_of_map(load_case(path), 0)
    for seed, keys in enumerate(MAP_FILES):
        if at(content, keys) is not None:
            file = folder / f"map_{seed}.txt"
            height = 1e6 * asp.self_affine((PIXELS, PIXELS), 0.8, EDGE / 2, 8e-6, 1e-7, seed, length=EDGE)
            height[3, 4] += 10 * ("despike" in content["map"])
            put(content, keys, write_map(file, height, (1e6 * EDGE, 1e6 * EDGE)))
    content["map"].pop("points", None)
    if "shifts" in content.get("cycles", {}):
        content["cycles"]["shifts"] = 16
    if "adhesion" in content:
        content["adhesion"]["steps"] = 4
    return asp.Case.read({key: group for key, group in content.items() if key not in (OUT, CHECKSUMS)})


def quantity(name):
    """A check that a number is among the answer."""
    return lambda answer: name in {record.quantity for record in answer.records}


EFFECTS = {
    "adhesion": lambda answer: answer["pull-off force"].value > 0,
    "ball": lambda answer: answer.face.boundary == "free",
    "bearing": lambda answer: answer.case.hertz_contact.maximum_pressure == pytest.approx(1.255e9, rel=1e-3),
    "coating": quantity("maximum shear stress on the interface"),
    "conduction": quantity("thermal contact conductance"),
    "cylinder": lambda answer: (
        answer["load per length"].value > 0 and answer.contact.boundary == "free along y"
    ),
    "fatigue": quantity("maximum Dang Van stress over limit"),
    "fields": lambda answer: {"principal_1"} < {*answer.tables["peaks"]["quantity"]},
    "film": lambda answer: 0.84 < answer["load fraction of the film"].value < 0.85,  # erf 1 = 0.8427
    "filters": lambda answer: any("Gaussian filters left" in each.text for each in answer.warnings),
    "hertz_ball": lambda answer: answer.case.cell_pressure == 1.2e9,
    "hertz_roller": lambda answer: answer.case.cell_pressure == pytest.approx(1.2e9 * 0.96**0.5),
    "instrument": lambda answer: answer.face.treatment.spikes > 0,
    "layer": lambda answer: answer.stress["lower"]["plane_depth"].values.max() == pytest.approx(3e-6),
    "layers": quantity("strength over stress, shear of interface 2"),
    "load_curve": lambda answer: len(answer.tables["curve"]) == 3,
    "moving_faces": lambda answer: {"cycles_lower", "cycles_upper"} == {*answer.datasets},
    "partial_slip": lambda answer: "partial_slip" in answer.datasets,
    "running_in": lambda answer: answer["maximum flattening of the first load"].value > 0,
    "sweep": lambda answer: len({*answer.tables["sweep"]["case"]}) == 4,
    "two_faces": lambda answer: answer.case.counter_map.shift == pytest.approx((10e-6, -4e-6)),
}
"""Case file of the pages → its effect on the answer."""


@pytest.mark.parametrize("source", SOURCES, ids=lambda each: getattr(each, "stem", each))
def test_answer_is_the_same_after_its_folder(source, tmp_path, without_pictures):
    case = small_case(source, tmp_path)
    leak = case.questions.get("leak")
    if leak is not None and leak.viscosity is not None and absent(["pyamg"]):
        pytest.skip('pip install "asperity[flow]"')
    answer = asp.run(case)
    assert not isinstance(source, Path) or EFFECTS.get(source.stem, bool)(answer)
    answer.write(tmp_path / "answer")
    assert asp.open_answer(tmp_path / "answer").records == answer.records
    (tmp_path / "elsewhere").mkdir()
    moved = shutil.move(tmp_path / "answer", tmp_path / "elsewhere/moved")
    for file in tmp_path.glob("map_*.txt"):
        file.unlink()
    is_same(answer, asp.open_answer(moved))


def is_same(answer, again):
    """Every part that is kept is equal to the bit, and so are planes and sections that follow from it."""
    for name in ("records", "verdict", "warnings", "assumptions", "origin", "title", "uncertainties"):
        assert getattr(again, name) == getattr(answer, name), name
    assert again.tiles == answer.tiles
    maps = answer.case.map, answer.case.counter_map
    assert again.case.with_maps(*maps).written() == answer.case.written()
    for name in ("height", "pressure", "displacement", "gap", "plastic_depth"):
        same_values(getattr(again.contact, name), getattr(answer.contact, name))
    for each in (
        "approach",
        "contact_area_fraction",
        "mean_pressure",
        "hardness",
        "solid",
        "grid",
        "boundary",
    ):
        assert getattr(again.contact, each) == getattr(answer.contact, each), each
    assert astuple(again.contact.certificate) == astuple(replace(answer.contact.certificate, seconds=0.0))
    for each in fields(answer.face):
        if each.name != "height":
            assert getattr(again.face, each.name) == getattr(answer.face, each.name), each.name
    assert again.tables.keys() == answer.tables.keys()
    for name, table in answer.tables.items():
        pd.testing.assert_frame_equal(again.tables[name], table.reset_index(drop=True), check_exact=True)
    for kept, made in ((again.datasets, answer.datasets), (again.stress, answer.stress)):
        assert kept.keys() == made.keys()
        for name, found in made.items():
            assert {*kept[name].variables} == {*found.variables}
            for variable in found.variables:
                same_values(kept[name][variable].values, found[variable].values)
    for body in answer.case.bodies:
        for field in answer.case.fields:
            assert again.extreme(field, body)[:4] == answer.extreme(field, body)[:4]
            same_values(again.plane(field=field, body=body), answer.plane(field=field, body=body))
        same_values(again.section("y", body=body), answer.section("y", body=body))


def same_values(found, expected):
    if expected is None:
        assert found is None
        return
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.shape == expected.shape
    if expected.dtype.kind == "f":
        assert found.dtype == expected.dtype
        np.testing.assert_array_equal(np.signbit(found), np.signbit(expected))
    np.testing.assert_array_equal(found, expected)


@pytest.fixture
def written(tmp_path, without_pictures):
    """Folder of the answer of a map that is given as an array."""
    height = asp.self_affine((16, 16), 0.8, 32e-6, 16e-6, 1e-7, seed=1, length=64e-6)
    surface = asp.HeightMap(height, (64e-6, 64e-6), periodic=True, unit="m", name="array")
    answer = asp.run(surface, {"young": "210 GPa", "poisson": 0.3}, mean_pressure="50 MPa")
    answer.write(tmp_path / "answer")
    return answer, tmp_path / "answer"


def test_heights_of_an_array_are_kept(written):
    answer, folder = written
    is_same(answer, asp.open_answer(folder))
    again = asp.run(asp.Case.read(asp.open_answer(folder).case.written()))
    assert again["contact area fraction"] == answer["contact area fraction"]


def test_an_opened_answer_needs_no_working_folder(written, monkeypatch):
    answer, folder = written
    monkeypatch.chdir(folder.parent)
    opened = asp.open_answer(folder.name)
    monkeypatch.chdir(folder.parent.parent)
    again = pickle.loads(pickle.dumps(opened))
    is_same(answer, opened)
    assert str(again) == str(answer)
    np.testing.assert_array_equal(again.contact.pressure, answer.contact.pressure)
    assert all(again.tables[name].equals(table) for name, table in answer.tables.items())


def test_a_folder_keeps_its_kind(written, tmp_path):
    """What can be opened is never replaced by another kind, and what cannot be opened is not written."""
    answer, folder = written
    sample, comparison = asp.pool({"answer": answer}), answer.compare(answer)
    (tmp_path / "comparison").mkdir()
    comparison.write(tmp_path / "comparison")
    sample.write(tmp_path)
    both = f"{tmp_path}: holds a sample", f"{folder}: holds an answer"
    for item, wrong in ((answer, tmp_path), (comparison, tmp_path), (comparison, folder)):
        with pytest.raises(ValueError, match="|".join(map(re.escape, both))):
            item.write(wrong)
    assert str(asp.open_answer(tmp_path)) == str(sample)
    assert str(asp.open_answer(tmp_path / "comparison")) == str(comparison)
    answer.__dict__["folder"] = None
    for item in (sample, answer.compare(answer)):
        with pytest.raises(ValueError, match=r"the answer of .* is needed .*; write it first"):
            item.write(tmp_path / "new")


def rewritten(folder, content):
    """`DATA` with another content, which its manifest knows, as from another version of asperity."""
    (folder / DATA).write_text(content, encoding="utf-8")
    manifest = json.loads((folder / MANIFEST).read_text("utf-8")) | {DATA: sha256_of(folder / DATA)}
    (folder / MANIFEST).write_text(json.dumps(manifest), encoding="utf-8")


def test_another_format_is_refused_in_one_line(written):
    _, folder = written
    plain = json.loads((folder / DATA).read_text("utf-8"))
    rewritten(folder, json.dumps(plain | {"format": plain["format"] + 1}))
    with pytest.raises(DatasetError, match=r"answer\.json: format \d+; format \d+ is read by") as caught:
        asp.open_answer(folder)
    assert "\n" not in str(caught.value)
    assert load_case(folder / CASE_FILE)["body"]["poisson"] == 0.3


def test_changed_files_of_an_answer_are_refused(written):
    _, folder = written
    opened = asp.open_answer(folder)
    for name in ("peaks.csv", "contact.nc", DATA):
        content = (folder / name).read_bytes()
        (folder / name).write_bytes(content[:-20] + b"x" * 20)
    for wrong in (lambda: opened.contact, lambda: opened.tables["peaks"], lambda: asp.open_answer(folder)):
        with pytest.raises(DatasetError, match="changed after it was written"):
            wrong()


@pytest.mark.parametrize(
    "content", ["", "{", "[]", '{"records": []}', '{"format": 1}', '{"format": 1, "records": [{}]}']
)
def test_damaged_answer_is_refused_in_one_line(written, content):
    _, folder = written
    rewritten(folder, content)
    with pytest.raises(DatasetError, match=r"answer\.json: damaged") as caught:
        asp.open_answer(folder)
    assert "\n" not in str(caught.value)


def test_folder_without_an_answer_is_refused(tmp_path):
    with pytest.raises(DatasetError, match="the folder of an answer of asperity run is needed"):
        asp.open_answer(tmp_path)


def test_every_question_that_changes_inputs_has_a_report():
    """Its table has a column without a unit; an answer is not pooled with itself."""
    height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, 1e-7, seed=1, length=2e-4)
    surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    answer = asp.run(surface, asp.Body(young=210e9, poisson=0.3), mean_pressure=3e8, sensitivity={})
    assert "one per cent" in report(answer, drawn=[])
    for answers, message in (([answer, answer], "given twice"), (answer, "a list or a mapping")):
        with pytest.raises((ValueError, TypeError), match=message):
            asp.pool(answers)
    for wrong in (lambda: answer.plane(field="vonmises"), lambda: answer.section("z")):
        with pytest.raises(ValueError, match="is needed"):
            wrong()
