"""Contacts on a mirrored map alone against those on the cell of the map and its three mirror images."""

from dataclasses import replace

import numpy as np
import pytest
from samples import HALF_SPACE, difference

import asperity as asp
from asperity.contact.patches import contact_patches
from asperity.fourier.grid import with_mirror_images
from asperity.results.dataset import grid_of

LAYER = asp.Solid(1.0, 0.3, height=0.05)
SOLIDS = {
    "half-space": HALF_SPACE,
    "layer": LAYER,
    "incompressible": asp.Solid(1.0, 0.5, height=0.02),
    "free": asp.Solid(1.0, 0.3, height=0.3, bottom="free"),
    "coating": asp.Solid(3.0, 0.2, 0.02, base=HALF_SPACE),
    "two": asp.TwoBodies(HALF_SPACE, asp.Solid(0.4, 0.45, height=0.1)),
}
LOADS = [
    {"mean_pressure": 0.03},
    {"force": 0.02},
    {"approach": 0.7},
    {"mean_pressure": 0.03, "hardness": 0.2},
    {"approach": 0.7, "hardness": 0.2},
    {"contact_area_fraction": 0.2},
]
TOLERANCE = 1e-8


def rough(shape):
    return asp.self_affine((160, 160), 0.8, 1 / 4, 1 / 20, 1e-2, seed=2)[: shape[0], : shape[1]]


def both(shape, solid, load, **settings):
    """The contact on a mirrored map, and that on the cell of four, which carries four times a force."""
    height, grid = rough(shape), asp.Grid(shape, (shape[0] / 64, shape[1] / 50), mirrored=True)
    load, whole = dict(load), grid.whole_cell
    if "approach" in load:
        load["approach"] *= float(height.min())
    settings = {"rtol": TOLERANCE} | settings
    found = asp.solve_contact(height, solid, grid, **load, **settings)
    if "force" in load:
        load["force"] *= 4
    return found, asp.solve_contact(with_mirror_images(height, grid), solid, whole, **load, **settings)


def require_equal(found, expected, tolerance):
    ny, nx = found.grid.shape
    for name in ("pressure", "displacement", "gap"):
        assert difference(getattr(found, name), getattr(expected, name)[:ny, :nx]) < tolerance, name
    for name in (
        "contact_area_fraction",
        "mean_pressure",
        "approach",
        "gradient_rms_contact",
        "maximum_pressure",
    ):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=tolerance), name
    assert found.certificate.worst < max(tolerance, 10 * TOLERANCE)


@pytest.mark.parametrize("solid", SOLIDS)
@pytest.mark.parametrize("load", LOADS[:-1], ids=str)
def test_loads_and_solids(load, solid):
    """A hundred tolerances of the solver."""
    found, expected = both((30, 41), SOLIDS[solid], load)
    require_equal(found, expected, 100 * TOLERANCE)
    if "hardness" not in load:
        assert found.stiffness == pytest.approx(expected.stiffness, rel=1e-5)
        np.testing.assert_allclose(found.load_interval, expected.load_interval, rtol=1e-5)


@pytest.mark.parametrize("shape", [(1, 2), (1, 37), (3, 5), (31, 17), (64, 20), (130, 128)])
def test_odd_prime_and_oblong_maps(shape):
    require_equal(*both(shape, HALF_SPACE, LOADS[0]), 100 * TOLERANCE)


@pytest.mark.parametrize("settings", [{"method": "gfmd", "rtol": 1e-6}, {"dtype": "float32", "rtol": 1e-4}])
def test_damped_dynamics_and_single_precision(settings):
    found, expected = both((20, 33), LAYER, LOADS[0], **settings)
    assert found.pressure.dtype == settings.get("dtype", "float64")
    require_equal(found, expected, 1e-4 if "method" in settings else 1e-3)


def test_imposed_area():
    """The area fixes the load no closer than the interval in which the same nodes touch."""
    found, expected = both((40, 44), HALF_SPACE, LOADS[-1])
    assert found.contact_area_fraction == expected.contact_area_fraction
    least, most = expected.load_interval
    assert least * (1 - 1e-6) < found.mean_pressure < most * (1 + 1e-6)


def test_certificate_of_the_map_is_that_of_the_cell():
    found, _ = both((30, 41), HALF_SPACE, LOADS[0])
    height, pressure = found.height, found.pressure + 1e-3 * (found.pressure > 0)
    own = asp.contact.verify_contact(height, pressure, HALF_SPACE, found.grid, mean_pressure=0.03)
    fields = (with_mirror_images(field, found.grid) for field in (height, pressure))
    whole = asp.contact.verify_contact(*fields, HALF_SPACE, found.grid.whole_cell, mean_pressure=0.03)
    assert own.violations == pytest.approx(whole.violations, rel=1e-8, abs=1e-12)


def test_load_path_starts_from_a_contact():
    height, grid = rough((40, 44)), asp.Grid((40, 44), mirrored=True)
    first, second = asp.solve_load_path(height, HALF_SPACE, grid, mean_pressures=[0.02, 0.025])
    again = asp.solve_contact(height, HALF_SPACE, grid, mean_pressure=0.025, initial=first)
    assert difference(again.pressure, second.pressure) < 1e-5


def test_grid_survives_a_file(tmp_path):
    found, _ = both((20, 33), LAYER, LOADS[0])
    found.to_netcdf(tmp_path / "contact.nc")
    assert grid_of(asp.read_result(tmp_path / "contact.nc")) == found.grid


@pytest.mark.parametrize("direction", ["x", 30.0])
def test_partial_slip(direction):
    found, expected = (
        asp.contact.partial_slip(
            contact, 0.4, tangential_force=0.2 * contact.force, sliding_direction=direction
        )
        for contact in both((20, 33), HALF_SPACE, LOADS[0])
    )
    ny, nx = found.contact.grid.shape
    for name in ("traction", "slip", "lost_energy_density"):
        assert difference(getattr(found, name), getattr(expected, name)[:ny, :nx]) < 1e-6, name
    for name in ("compliance_ratio", "displacement", "deviation", "sticking_area", "stiffness"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-6), name


def test_edges_of_a_mirrored_map_do_not_meet():
    """A channel that ends at a corner, and patches at opposite edges."""
    found, _ = both((20, 33), HALF_SPACE, LOADS[0])
    assert not found.edges_meet
    pressure = np.ones((20, 33))
    pressure[0, :30] = 0
    blocked = replace(found, pressure=pressure, gap=np.ones((20, 33)))
    assert asp.contact.percolation(blocked).gap == (False, False)
    touching = np.zeros((20, 33), bool)
    touching[5, [0, -1]] = True
    assert contact_patches(touching, found.edges_meet).radii.size == 2


def test_free_boundary_is_refused():
    with pytest.raises(ValueError, match="without mirror images"):
        both((8, 8), HALF_SPACE, LOADS[0], boundary="free")
