"""Answers under a tangential force: numbers on the map, files, stress of both bodies, and what is refused."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from samples import refuses
from test_engineering import STEEL, a_rough_map

import asperity as asp
from asperity.core.packages import MissingPackageError, absent
from asperity.engineering import Body, Case, run

LOAD, FRICTION, AREA = 100e6, 0.3, (64e-6) ** 2
LIMIT = FRICTION * LOAD * AREA
HALF = {"mean_pressure": LOAD, "friction": FRICTION, "tangential_force": 0.5 * LIMIT}


@pytest.fixture(scope="module")
def fretting():
    return run(a_rough_map(), STEEL, STEEL, **HALF)


def values(answer, group="partial slip"):
    return {row.name: row.value for row in answer.rows if row.group == group}


def test_numbers_are_those_of_partial_slip(fretting):
    found = values(fretting)
    contact = fretting.contact
    slip = asp.partial_slip(contact, FRICTION, tangential_force=0.5 * FRICTION * contact.force)
    assert found["tangential force"] == pytest.approx(0.5 * LIMIT, rel=1e-5)
    assert found["tangential displacement"] == pytest.approx(slip.displacement, rel=1e-5)
    assert found["energy lost in a cycle ± force"] == pytest.approx(slip.lost_energy / 4, rel=1e-4)
    assert fretting.face.is_mirrored  # the cell holds four images of the map
    assert found["tangential displacement"] == pytest.approx(
        fretting.coarse["tangential displacement"], rel=0.1
    )
    assert any("by a factor of" in advice.text for advice in fretting.advice)
    by_displacement = {"tangential_displacement": slip.displacement}
    soft = replace(STEEL, yield_stress=200e6)
    other = run(a_rough_map(), soft, soft, mean_pressure=LOAD, friction=FRICTION, **by_displacement)
    assert values(other)["tangential force"] == pytest.approx(0.5 * LIMIT, rel=1e-4)
    assert other.plastic.hardness == 600e6  # solved without the tangential displacement


def test_files_hold_the_slip(fretting, tmp_path):
    names = {path.name for path in asp.write_answer(fretting, tmp_path)}
    assert names >= {"slip.png", "shear_traction.png", "cycle.png", "cycle.csv"}
    stored = asp.read_result(tmp_path / "contact.nc")
    solid = asp.LoadedSolid.from_dataset(stored)
    np.testing.assert_allclose(FRICTION * solid.sliding_pressure, fretting.slip.traction)
    (plane,) = asp.stress_planes(solid, [0.0], fields=["xz"], friction=FRICTION)
    np.testing.assert_allclose(plane.fields["xz"][0], fretting.slip.traction, atol=1e-9 * LOAD)
    assert "In full sliding" not in (tmp_path / "report.html").read_text("utf-8")


SOFT = Body(2e9, 0.4)
LEAK = {"flow_direction": "x", "viscosity": 1e-3, "pressure_difference": 1e5}


def test_percolation_is_that_of_the_map():
    """A mirrored map, whose cell repeats, has the constrictions of one image without surroundings."""
    answer = run(a_rough_map(), SOFT, mean_pressure=2e6, flow_direction="y")
    found, contact, part = values(answer, "gap"), answer.contact, answer.face.part
    assert answer.face.is_mirrored
    assert (found["contact percolates along x"], found["gap percolates along y"]) == (0.0, 1.0)
    grid = asp.Grid(answer.face.map_shape, answer.face.map_length)
    alone = replace(
        contact, gap=part(contact.gap), pressure=part(contact.pressure), grid=grid, boundary="free"
    )
    for axis, width in zip("yx", asp.percolation(alone).constriction, strict=True):
        assert found[f"narrowest constriction along {axis}"] == pytest.approx(width, rel=1e-12)
    assert "leakage along y" not in found


@pytest.mark.skipif(bool(absent(["reynoldsflow"])), reason='pip install "asperity[flow]"')
def test_leak_through_a_mirrored_map(tmp_path):
    """Its edges across the flow are reservoirs, the others are sealed: as without surroundings; solver."""
    answer = run(a_rough_map(), SOFT, mean_pressure=2e6, **LEAK)
    found, contact, part = values(answer, "gap"), answer.contact, answer.face.part
    grid = asp.Grid(answer.face.map_shape, answer.face.map_length)
    alone = replace(
        contact, gap=part(contact.gap), pressure=part(contact.pressure), grid=grid, boundary="free"
    )
    flow = asp.film_flow(alone, 1e-3, 1e5, "x")
    assert found["leakage along x"] == pytest.approx(flow.flow_rate, rel=1e-6)
    assert found["leakage along x"] == pytest.approx(answer.coarse["leakage along x"], rel=0.5)
    assert found["pressure flow factor"] == pytest.approx(flow.flow_factor, rel=1e-6)
    np.testing.assert_allclose(answer.flow.pressure, flow.pressure, atol=1e-3 * 1e5)
    assert (tmp_path / "flow.png") in asp.write_answer(answer, tmp_path)
    with pytest.raises(ValueError, match="flow_direction = 'x': a smaller load is needed"):
        run(a_rough_map(), SOFT, area_fraction=1.0, **LEAK)


def test_missing_solver_is_named_before_the_contact(monkeypatch):
    hidden = {"reynoldsflow": None}
    monkeypatch.setattr("asperity.core.packages.find_spec", lambda module: hidden.get(module, module))
    monkeypatch.setattr(sys.modules[run.__module__], "press", None)
    with pytest.raises(MissingPackageError, match="not installed: reynoldsflow"):
        run(a_rough_map(), SOFT, mean_pressure=2e6, **LEAK)


SETTINGS = {"map": "a.x3p", "young": "210 GPa", "poisson": 0.3, "force": "2 N", "friction": 0.3}


def case_of(**changed):
    return lambda: Case.of({**SETTINGS, "tangential_force": "0.5 N"} | changed)


LAYER = {"layer_height": "5 um", "tangential_displacement": "1 nm"}
test_bad_cases = refuses(
    (lambda: Case.of(SETTINGS | {"viscosity": 0.1}), "viscosity = 0.1: a pressure_difference is needed"),
    (lambda: Case.of(SETTINGS | {"flow_direction": "z"}), "flow_direction = 'z': one of x, y"),
    (case_of(tangential_force="0.7 N"), "tangential_force = 700 mN: at most 600 mN is needed"),
    (case_of(tangential_displacement="1 nm"), "tangential_force = 500 mN: not accepted together"),
    (case_of(hardness="5 GPa"), "tangential_force = 500 mN: an elastic contact"),
    (case_of(fatigue_torsion="300 MPa", fatigue_bending="480 MPa"), "tangential_force = 500 mN: full slidin"),
    (lambda: Case.of(SETTINGS | LAYER), "tangential_displacement = 1 nm: half-spaces"),
    (
        lambda: run(a_rough_map(), STEEL, **HALF | {"tangential_force": 2 * LIMIT}),
        "tangential_force = 245.8 mN: at",
    ),
    (
        lambda: run(a_rough_map(), Body(1e9, 0.3), area_fraction=0.1, friction=0.1, tangential_force=1.0),
        "tangential_force = 1 N: at most",
    ),
)
