"""Answers under a tangential force: numbers on the map, files, stress of both bodies, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from samples import refuses
from test_engineering import STEEL, a_rough_map

import asperity as asp
from asperity import Body, Case, run
from asperity.core.packages import MissingPackageError
from asperity.engineering.show.pictures import pictures

LOAD, FRICTION, AREA = 100e6, 0.3, (64e-6) ** 2
LIMIT = FRICTION * LOAD * AREA
HALF = {
    "mean_pressure": LOAD,
    "sliding": {"friction": FRICTION},
    "partial_slip": {"tangential_force": 0.5 * LIMIT},
}


@pytest.fixture(scope="module")
def fretting():
    return run(a_rough_map(), STEEL, STEEL, **HALF)


def values(answer, topic="partial slip"):
    return {each.quantity: each.value for each in answer.records if each.topic == topic}


def test_numbers_are_those_of_partial_slip(fretting):
    found = values(fretting)
    contact = fretting.contact
    slip = asp.contact.partial_slip(contact, FRICTION, tangential_force=0.5 * FRICTION * contact.force)
    assert found["tangential force"] == pytest.approx(0.5 * LIMIT, rel=1e-5)
    assert found["tangential displacement"] == pytest.approx(slip.displacement, rel=1e-5)
    assert found["energy lost in a cycle ± force"] == pytest.approx(slip.lost_energy, rel=1e-4)
    assert fretting.face.grid.mirrored
    assert any("by a factor of" in advice.text for advice in fretting.warnings)
    by_displacement = {"partial_slip": {"tangential_displacement": slip.displacement}}
    soft = STEEL.replaced(yield_stress=200e6)
    other = run(a_rough_map(), soft, soft, **HALF | by_displacement)
    assert values(other)["tangential force"] == pytest.approx(0.5 * LIMIT, rel=1e-4)
    assert np.isinf(other.contact.hardness)  # the one that the yield stress suggests is left out


def test_larger_force_than_friction_slides():
    answer = run(a_rough_map(), STEEL, **HALF | {"partial_slip": {"tangential_force": 2 * LIMIT}})
    found = values(answer)
    assert found["tangential force"] == pytest.approx(LIMIT, rel=1e-5)
    assert found["sticking area fraction of the contact"] == 0
    (told,) = (advice for advice in answer.warnings if advice.subject == "gross sliding")
    assert told.warns
    assert "245.8 mN is not below friction times load, 122.9 mN" in told.text


def test_files_hold_the_slip(fretting, tmp_path, without_pictures):
    drawn = {each.name for each in pictures(fretting)}
    assert drawn >= {"slip", "shear_traction", "cycle"}
    assert "cycle.csv" in {path.name for path in fretting.write(tmp_path)}
    stored = asp.read_result(tmp_path / "contact.nc")
    solid = asp.LoadedSolid.from_dataset(stored)
    sticking = fretting.datasets["partial_slip"]["sticking_pressure"].values
    traction = FRICTION * (fretting.contact.pressure - sticking)
    np.testing.assert_allclose(FRICTION * solid.sliding_pressure, traction)
    (plane,) = asp.stress_planes(solid, [0.0], fields=["xz"], friction=FRICTION)
    np.testing.assert_allclose(plane.fields["xz"][0], traction, atol=1e-9 * LOAD)
    assert "In full sliding" not in (tmp_path / "report.html").read_text("utf-8")


SOFT = Body(young=2e9, poisson=0.4)
LEAK = {"leak": {"direction": "x", "viscosity": 1e-3, "pressure_difference": 1e5}}


def test_percolation_is_that_of_the_map():
    """A mirrored map, whose cell repeats, has the constrictions of one image without surroundings."""
    answer = run(a_rough_map(), SOFT, mean_pressure=2e6, leak={"direction": "y"})
    found, contact = values(answer, "gap"), answer.contact
    assert answer.face.grid.mirrored
    assert (found["contact percolates along x"], found["gap percolates along y"]) == (0.0, 1.0)
    alone = replace(contact, grid=answer.face.map_alone().grid, boundary="free")
    for axis, width in zip("yx", asp.contact.percolation(alone).constriction, strict=True):
        assert found[f"narrowest constriction along {axis}"] == pytest.approx(width, rel=1e-12)
    assert "leakage along y" not in found


def test_missing_solver_is_named_before_the_contact(monkeypatch):
    hidden = {"pyamg": None}
    monkeypatch.setattr("asperity.core.packages.find_spec", lambda module: hidden.get(module, module))
    monkeypatch.setattr("asperity.engineering.stages.press", None)
    with pytest.raises(MissingPackageError, match="not installed: pyamg"):
        run(a_rough_map(), SOFT, mean_pressure=2e6, **LEAK)


def case_of(slip=None, body=None, **groups):
    """A case of steel under 2 N with friction, and a tangential force unless the slip is given."""
    slip = {"tangential_force": "0.5 N"} if slip is None else slip
    known = {"map": "a.x3p", "load": {"force": "2 N"}, "sliding": {"friction": 0.3}, "partial_slip": slip}
    body = {"young": "210 GPa", "poisson": 0.3} | (body or {})
    return lambda: Case.read(known | {"body": body} | groups)


DISPLACED, LAYER = (
    {"tangential_displacement": "1 nm"},
    {"thickness": "5 um", "young": "3 GPa", "poisson": 0.4},
)
HERTZ = {"hertz_pressure": "1 GPa", "radius_x": "9 mm"}
LIMITS = {"fatigue_torsion": "300 MPa", "fatigue_bending": "480 MPa"}
test_bad_cases = refuses(
    (case_of(leak={"viscosity": 0.1}), "leak.viscosity: needs leak.pressure_difference"),
    (case_of(leak={"pressure_difference": "1 bar"}), "leak.pressure_difference: needs leak.viscosity"),
    (case_of(leak={"direction": "z"}), "leak.direction = 'z': x or y is needed"),
    (case_of(DISPLACED | {"tangential_force": "0.5 N"}), "partial_slip: exactly one of tangential_force and"),
    (case_of({}), "partial_slip: exactly one of tangential_force and"),
    (case_of(sliding={}), "partial_slip: needs sliding.friction, above 0"),
    (
        case_of(body={"hardness": "5 GPa"}),
        r"partial_slip: requires an elastic contact; set body.hardness: inf \(the hardness is 5 GPa, given\)",
    ),
    (case_of(body=LIMITS), "partial_slip: not accepted with stress cycles"),
    (case_of(load=HERTZ), "partial_slip: not accepted with a map in a Hertz contact"),
    (case_of(load_curve={"loads": ["1 N"]}), "partial_slip: not accepted with load_curve"),
    (
        case_of(DISPLACED, {"layers": [LAYER], "base": "bonded", "young": None, "poisson": None}),
        "partial_slip.tangential_displacement: half-spaces are needed",
    ),
)
