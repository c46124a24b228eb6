"""Answers for a bearing: a part of a map in a Hertz contact, forms with two radii, and what they say."""

import numpy as np
import pytest
import xarray as xr
from scipy import stats

import asperity as asp
from asperity.engineering.places import Blocks
from asperity.engineering.questions.cycles import _pixel_error
from asperity.engineering.records import LIMITED, POSITIONS
from asperity.engineering.show.tables import tiles_of
from asperity.settings.model import SettingsError

STEEL = {"young": "207 GPa", "poisson": 0.3, "yield_stress": "2 GPa"}
BALL = {"force": "166.7 N", "radius_x": "3.776 mm", "radius_y": "123.8 mm"}


def ground(shape=(96, 128), pixel=2e-6, seed=1):
    """A map ground along y, as 300 x 400 µm of an instrument."""
    edges = shape[0] * pixel, shape[1] * pixel
    height = asp.self_affine((shape[1], shape[1]), 0.8, edges[1] / 4, 8 * pixel, 1e-7, seed, length=edges[1])
    along = np.repeat(height[: shape[0] // 8], 8, axis=0)
    return asp.HeightMap(along, edges, unit="m", name="ring")


def test_map_wider_than_its_hertz_contact_names_both_remedies():
    with pytest.raises(SettingsError, match=r"map\.crop = fit, which is 66 µm along x.*map\.radius"):
        asp.run(ground(), STEEL, STEEL, load=BALL)


def test_map_wider_than_its_roller_is_to_be_a_cylinder():
    """The remedy is accepted."""
    with pytest.raises(SettingsError, match=r"map.form = cylinder and map.cylinder_axis = y"):
        asp.run(ground(), STEEL, STEEL, load={"hertz_pressure": 5e8, "radius_x": 3.776e-3, "radius_y": "inf"})
    form = {"radius": 3.776e-3, "form": "cylinder", "cylinder_axis": "y"}
    asp.Case(map={"file": ground(), **form}, body=STEEL, load={"force": 0.1})


def test_part_of_a_map_is_pressed_and_said():
    answer = asp.run(
        {"file": ground(), "crop": "66 um", "crop_at": ("80 um", "120 um")}, STEEL, STEEL, load=BALL
    )
    assert answer.face.grid.length == pytest.approx((66e-6, 66e-6))
    assert any(
        "cropped to 66 µm x 66 µm" in line and "around 81 µm x 121 µm" in line for line in answer.face.done
    )
    assert answer.contact.mean_pressure == pytest.approx(1.255e9, rel=1e-3)


def test_elliptic_body_with_a_free_boundary_is_as_hertz_says():
    """Radii of 1 and 4 mm on pixels of a/20; the approach of the paraboloid has no image to disturb it."""
    edges, shape, load = (200e-6, 120e-6), (200, 120), 2.0
    flat = asp.HeightMap(np.zeros(shape), edges, unit="m", name="ball")
    answer = asp.run(
        {"file": flat, "radius": "1 mm", "radius_y": "4 mm", "periodic": "none"}, STEEL, force=load
    )
    exact = asp.stress.HertzContact.from_radii(
        1e-3, 4e-3, asp.Solid(207e9, 0.3).effective_modulus, force=load
    )
    assert answer["maximum pressure"].value == pytest.approx(exact.maximum_pressure, rel=0.01)
    area = np.pi * exact.half_width_x * exact.half_width_y
    assert answer["contact area"].value == pytest.approx(area, rel=0.02)


def test_line_contact_has_its_load_per_length_and_labels_of_the_map():
    """w = π R p₀²/E* (K. L. Johnson, Contact Mechanics, 1985, section 4.2)."""
    small, counter = (ground((64, 64), 5e-7, seed) for seed in (1, 2))
    load = {"hertz_pressure": 1e9, "radius_x": "4 mm", "radius_y": "inf"}
    answer = asp.run(small, STEEL, {**STEEL, "map": counter}, load=load)
    modulus = 207e9 / (1 - 0.3**2) / 2
    assert answer["load per length of the Hertz contact"].value == pytest.approx(
        np.pi * 4e-3 * 1e18 / modulus
    )
    (across,) = (each.text for each in answer.warnings if each.subject == "rolling across the lay")
    assert "the lay of the map is along y, and the direction of rolling is x" in across
    assert answer["force"].note == "on the map"
    assert answer["Sq"].note == "of both faces together"


def test_yield_stress_of_another_hardness_is_a_note():
    told = []
    for given in ({}, {"hardness": "6.4 GPa"}, {"hardness": "6.4 GPa", "yield_stress": "1.8 GPa"}):
        answer = asp.run(ground((64, 64)), {"material": "100Cr6", **given}, mean_pressure="100 MPa")
        told.append([each.text for each in answer.warnings if "another hardness" in each.subject])
    assert [len(each) for each in told] == [0, 1, 0]
    assert "6.4 GPa is given" in told[1][0]


def test_friction_without_a_direction_slides_along_the_lay():
    case = {"sliding": {"friction": 0.08}, "mean_pressure": "100 MPa"}
    answer = asp.run({"file": ground(), "crop": "100 um"}, STEEL, **case)
    assert answer.case.sliding_direction == "y"
    assert any("(sliding.direction)" in advice.text for advice in answer.warnings)
    isotropic = asp.self_affine((64, 64), 0.8, 2e-5, 8e-6, 1e-7, seed=1, length=1e-4)
    answer = asp.run(asp.HeightMap(isotropic, (1e-4, 1e-4), unit="m"), STEEL, **case)
    assert answer.case.sliding_direction == "x"


def test_blocks_give_the_interval_of_a_ratio():
    """Under equal loads Student's t interval for independent blocks, a tenth wider."""
    means = np.random.default_rng(1).random((5, 4)) + 1
    found = Blocks((5, 4), np.full((5, 4), 3.0)).error(means)
    interval = stats.t.interval(0.95, 19, means.mean(), stats.sem(means, axis=None))
    assert found * means.mean() == pytest.approx(1.1 * (interval[1] - interval[0]) / 2)
    assert Blocks((5, 4), means).error(7 * means) == pytest.approx(0)  # in proportion to the load


@pytest.mark.parametrize(("long", "known"), [(20e-6, True), (100e-6, False)])
def test_single_map_says_which_error_it_has(long, known):
    height = asp.self_affine((160, 160), 0.8, long, 8e-6, 1e-7, seed=1, length=160e-6)
    surface = asp.HeightMap(height[:96, :96], (96e-6, 96e-6), unit="m", name="ground")
    answer = asp.run(surface, {**STEEL, "yield_stress": "500 MPa"}, mean_pressure="100 MPa")
    tiles = {each.quantity: each for each in answer.tiles}
    texts = tiles["contact area fraction"].error_texts()
    assert any("extrapolated to zero pixel size" in text for text in texts)
    for name in ("contact area fraction", "volume above yield per area"):
        assert (POSITIONS in tiles[name].errors) == known
    assert tiles["maximum pressure"].unknown == [POSITIONS]
    volume = answer["volume above yield per area"].best_text()
    assert answer.verdict[0].startswith(f"The material yields: volume above yield per area {volume}, down to")
    assert "is limited by the hardness, 1.5 GPa, and is" in answer.verdict[0]
    shown = tiles_of(answer.tiles)
    assert shown[0].name == "volume above yield per area"
    assert [tile.name for tile in shown if LIMITED in tile.lines] == ["maximum von Mises stress"]
    model = [each.short for each in answer.uncertainties if each.subject == "stress beyond yield"]
    ratio = answer["maximum von Mises stress"].best / 500e6
    assert model == [f"model: the stress is elastic, up to {ratio:.3g} times the yield stress"]


def test_below_the_hardness_the_stress_leads_the_verdict():
    height = asp.self_affine((64, 64), 0.8, 4e-5, 2e-5, 1e-7, seed=1, length=1e-4)
    surface = asp.HeightMap(height, (1e-4, 1e-4), periodic=True, unit="m", name="ground")
    body = {**STEEL, "yield_stress": "500 MPa", "hardness": "inf"}
    (verdict, *_) = asp.run(surface, body, mean_pressure="100 MPa").verdict
    assert verdict.startswith("The material yields: maximum von Mises stress ")
    assert "; volume above yield per area " in verdict
    assert "hardness" not in verdict


@pytest.mark.parametrize(("axis", "direction"), [("x", "x"), ("y", "y"), ("x", "y")])
def test_cycles_in_a_hertz_contact_pass_through_it(axis, direction):
    """Of smooth rollers: a shakedown limit of 4 k and a range of τ_xz of p₀/2 (Johnson, section 9.2)."""
    almost = 1e-12 * np.random.default_rng(1).normal(size=(8, 8))
    flat = asp.HeightMap(almost, (60e-6, 60e-6), periodic=True, unit="m", name="flat")
    body = {**STEEL, "fatigue_torsion": "500 MPa", "fatigue_bending": "800 MPa"}
    radii = {f"radius_{axis}": "4.5 mm", f"radius_{'xy'[axis == 'x']}": "inf"}
    case = {"load": {"hertz_pressure": "1.8 GPa", **radii}, "sliding": {"direction": direction}}
    answer = asp.run(flat, body, body, **case)
    assert answer["shakedown factor, at most"].value == pytest.approx(4 * 2 / 3**0.5 / 1.8, rel=0.01)
    assert "Every cycle stays below the fatigue limit on these pixels" in answer.verdict[0]
    if axis == direction:
        assert answer["maximum range of shear stress"].value == pytest.approx(0.9e9, rel=0.01)
        followed = asp.run(flat, body, body, **case, cycles={"shifts": 120})
        name = "maximum Dang Van stress over limit"
        assert answer[name].value == pytest.approx(followed[name].value, rel=0.02)


def test_pixels_change_only_what_the_roughness_adds_to_the_hertz_contact():
    """Deep below the roughness the cycle is that of the smooth contact, whose error is not of the pixels."""
    stress = np.array([[0.3, 0.1], [0.5, 0.4]])  # over (depth, y), at the first depth mostly by roughness
    dims, smooth = ("cycle_depth", "cycle_y"), np.array([0.1, 0.5])
    cycles = xr.Dataset({"dang_van": (dims, stress), "shakedown_upper": (dims, 1 / stress)})
    for name, of_smooth, scale in (("dang_van", smooth, 1.0), ("shakedown_upper", 1 / smooth, 4.0)):
        assert _pixel_error(cycles, name, 0.2, {name: of_smooth}) == 0
        assert _pixel_error(cycles, name, 1.5, {name: of_smooth}) == pytest.approx(scale * 0.1)
        assert _pixel_error(cycles, name, 0.2, {}) == pytest.approx(scale * 0.1)


def test_residual_stress_over_depth_is_that_of_each_plane():
    """A table of equal stresses is their number; a table counts at the depth of the worst cycle."""
    height = asp.surface.add_cylinder(np.zeros((8, 128)), (0.0625, 1.0), 1.0, axis="y")
    contact = asp.solve_contact(
        height, asp.Solid(young=1.0, poisson=0.3), (0.0625, 1.0), contact_area_fraction=0.1
    )
    limits = {"fatigue_torsion": 0.01, "fatigue_bending": 0.016}
    depths = [0.005, 0.02, 0.05]
    values = [
        asp.stress.stress_cycles(contact, depths, residual_stress=residual, **limits)["dang_van"].values
        for residual in (-0.01, ((0.0, 1.0), (-0.01, -0.01)), 0.0, ((0.0, 0.05), (-0.01, 0.0)))
    ]
    np.testing.assert_array_equal(values[0], values[1])
    shares = np.interp(depths, [0, 0.05], [1, 0])[:, None]
    np.testing.assert_allclose(values[3], values[2] + shares * (values[0] - values[2]), atol=1e-12)


def test_residual_stress_in_a_case_is_a_number_or_a_table():
    limits = {"fatigue_torsion": "500 MPa", "fatigue_bending": "800 MPa"}
    table = {"depth": ["0 um", "50 um"], "stress": ["-600 MPa", "0 MPa"]}
    body = asp.Body.read({**STEEL, **limits, "residual_stress": table})
    assert body.residual_stress.stress == (-6e8, 0.0)
    assert asp.Body.read(body.written()) == body
    with pytest.raises(SettingsError, match=r"residual_stress.depth: two or more rising depths"):
        asp.Body.read({**STEEL, **limits, "residual_stress": {**table, "depth": ["50 um", "0 um"]}})


def test_blocks_of_a_coarse_plane_have_the_values_of_its_nodes():
    values, blocks = np.arange(16.0).reshape(4, 4), Blocks((8, 2), np.ones((8, 2)))
    np.testing.assert_array_equal(blocks.means(values)[::2], values.reshape(4, 2, 2).mean(axis=2))
