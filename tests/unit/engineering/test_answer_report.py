"""Readers of an answer: first screen of the report, tables, pictures and text, also of an opened answer."""

import html
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from test_sample import STEEL, a_map

import asperity as asp
from asperity.engineering.show.pictures import compared_pictures, lead_of, pictures, png_of
from asperity.engineering.show.report import constants_of_table, preview, report
from asperity.engineering.show.tables import TILES, for_reader, tables, text
from asperity.results.tables import check_columns

COATED = asp.Body(
    young=210e9,
    poisson=0.3,
    yield_stress=1e9,
    layers=[{"thickness": 2e-6, "young": 400e9, "poisson": 0.25, "yield_stress": 5e9}],
)


@pytest.fixture(scope="module")
def coated():
    fields = ("von_mises", "principal_1")
    sliding = {"friction": 0.2, "direction": "x"}
    return asp.run(a_map(1), COATED, mean_pressure=200e6, fields=fields, sliding=sliding)


@pytest.fixture(scope="module")
def opened(coated, tmp_path_factory):
    folder = tmp_path_factory.mktemp("answer")
    coated.write(folder)
    return folder, asp.open_answer(folder)


def test_report_text_and_pictures_are_those_of_the_opened_answer(coated, opened):
    folder, again = opened
    assert text(again) == text(coated)
    for before, after in zip(pictures(coated), pictures(again), strict=True):
        image = png_of(before.figure)
        assert (after[:2], png_of(after.figure)) == (before[:2], image)
        assert (folder / f"{before.name}.png").read_bytes() == image
    for name, table in tables(coated).items():
        pd.testing.assert_frame_equal(tables(again)[name], table, check_dtype=False)
    assert (folder / "report.html").read_text(encoding="utf-8").count("<img ") == len([*pictures(coated)])


def test_first_screen(coated):
    """Verdict, at most four tiles, three uncertainties, one picture and warnings of one line; no scripts."""
    page = report(coated)
    first, folded = page[: page.index("<summary><h2>")], page[page.index("<summary><h2>") :]
    positions = [first.index(html.escape(sentence)) for sentence in coated.verdict]
    assert positions == sorted(positions)
    assert max(positions) < first.index('class="headline"') < first.index("<img ")
    assert 1 < first.count("<dt>") <= TILES
    assert first.count("<li>") == len(coated.uncertainties) == 3
    assert any(each.short.startswith("model: ") for each in coated.uncertainties)
    assert first.count("<img ") == 1
    shown = {each.subject for each in coated.uncertainties}
    others = {each.subject for each in coated.warnings if each.warns} - shown
    assert first.count('class="warning"') == len(others)
    assert first.count("one map does not show it") == 1
    assert not re.search("<script|http", page)
    for each in coated.records:
        assert html.escape(each.text()) in folded or each.words in folded
    for each in coated.warnings:
        part = first if each.warns or each.subject in shown else folded
        assert html.escape(each.text[0].upper() + each.text[1:]) in part or html.escape(each.text) in part


def test_lead_picture_is_that_of_the_question_asked(coated):
    assert lead_of(coated).name == "interface_shear"
    plain = asp.run(a_map(1), STEEL, mean_pressure=200e6)
    assert lead_of(plain).name == "section"  # yield, which the yield stress implies
    asked = asp.run(a_map(1), STEEL, mean_pressure=200e6, load_curve={"loads": [50e6, 100e6]})
    assert lead_of(asked).name.startswith(asked.case.load_curve.LEAD)
    elastic = asp.run(a_map(1), STEEL.replaced(yield_stress=None), mean_pressure=200e6)
    assert lead_of(elastic).name == "pressure"
    shown = preview(asked)
    assert shown.count("<img ") == 1
    assert all(html.escape(sentence) in shown for sentence in asked.verdict)


def test_interface_picture_shows_the_record(coated):
    """The largest pixel of the plane is the record, and the cross is at it."""
    record = coated["maximum shear stress on the interface"]
    (shown,) = (each for each in pictures(coated) if each.name == "interface_shear")
    axis = shown.figure.axes[0]
    (cross,) = (line for line in axis.lines if line.get_marker() == "+")
    assert np.ravel(cross.get_xydata()) == pytest.approx(
        1e6 * np.array([record.position.x, record.position.y])
    )
    plane = [coated.plane(2e-6, name) for name in ("xz", "yz")]
    assert float(np.hypot(*plane).max()) == pytest.approx(record.value, rel=0.05)


def test_section_is_drawn_through_the_extreme_value(coated):
    (drawn,) = (each for each in pictures(coated) if each.name == "section")
    found = coated.extreme("von_mises")
    axis = drawn.figure.axes[0]
    (low, high), along = axis.get_xlim(), axis.get_xlabel()[0]
    assert low <= 1e6 * getattr(found, along) <= high
    assert axis.get_ylim()[0] >= 1e6 * found.depth
    mesh = next(each for each in axis.collections if hasattr(each, "get_coordinates"))
    assert 1e6 * float(mesh.get_array().max()) == pytest.approx(found.value, rel=0.1)


def test_tables_have_their_columns(coated):
    for name, table in tables(coated).items():
        check_columns(table, "answer" if name == "answer" else f"answer_{name}")
        if name in coated.tables:
            heading, shown = for_reader(coated, name)
            assert heading.startswith(name.replace("_", " "))
            assert list(shown)
            assert len(shown) <= max(len(table), 1)
    _, spots = for_reader(coated, "contact_spots")
    assert spots["load"].iloc[0].endswith("N")


def test_titles_of_a_long_name_do_not_overlap(coated):
    named = replace(coated, face=replace(coated.face, name="a measured map with a name as long as a line"))
    for each in (each for each in pictures(named) if each.name in ("height", "pressure", "plane")):
        png_of(each.figure)  # places the titles
        first, second = (axis.get_title("left") for axis in each.figure.axes[:2])
        lines = [text.splitlines() for text in (first, second)]
        assert lines[0][0].startswith("a measured map")
        assert not lines[1][0].strip()  # beside the name
        assert len(lines[0]) == len(lines[1]) == 2


def test_compared_pictures_have_one_scale():
    answers = {name: asp.run(a_map(1), STEEL, mean_pressure=load) for name, load in (("a", 1e8), ("b", 3e8))}
    for picture in compared_pictures(answers):
        first, second, *_ = picture.figure.axes
        norms = [
            (each.images or [one for one in each.collections if hasattr(one, "get_coordinates")])[0].norm
            for each in (first, second)
        ]
        assert (norms[0].vmin, norms[0].vmax) == (norms[1].vmin, norms[1].vmax)
        assert (first.get_title("left")[0], second.get_title("left")[0]) == ("a", "b")


def test_constants_are_those_of_the_own_material():
    """Which has the name of one of the table, and no source."""
    own = {"100Cr6": {"young": "70 GPa", "poisson": 0.3}}
    body, load = {"material": "100Cr6"}, {"mean_pressure": 1e6}
    (line,) = constants_of_table(asp.Case(map="a", body=body, load=load, materials=own))
    assert line == "body, 100Cr6: young 70 GPa; poisson 0.3"
    (line,) = constants_of_table(asp.Case(map="a", body=body, load=load))
    assert "young 210 GPa (" in line
