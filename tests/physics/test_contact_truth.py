"""Contact against closed forms and direct solutions, over periodic and free boundaries."""

import numpy as np
import pytest
from samples import centred, difference, load_of, order, rough
from solution_check import mode_compliance

import asperity as asp
from asperity.contact import solve_contact
from asperity.elasticity.loaded_rectangle import rectangle_compliance
from asperity.reference.hertz import Hertz
from asperity.reference.pivoting import pivot

UNIT = asp.Solid(1.0, 0.0)


def test_hertz_without_images_converges():
    """Grid error alone, rms over loads; the contact is as wide as 0.8 of the map."""
    points, errors = [32, 64, 128], []
    for n in points:
        grid, rows = asp.Grid((n, n)), []
        r = np.hypot(*centred(grid))
        for radius in np.linspace(0.3, 0.4, 6):
            exact = Hertz(contact_radius=radius, curvature_radius=2.0, effective_modulus=3.0)
            solid = asp.Solid(3.0, 0.0)
            contact = solve_contact(r**2 / 4, solid, force=exact.load, boundary="free", rtol=1e-8)
            width = np.sqrt(contact.contact_area_fraction / np.pi) / radius - 1
            largest = contact.maximum_pressure / exact.maximum_pressure - 1
            approach = (contact.approach - contact.height.min()) / exact.approach - 1
            rows.append((difference(contact.pressure, exact.pressure(r)), width, largest, approach))
        errors.append(np.sqrt(np.mean(np.square(rows), axis=0)))
    least_orders, bounds = (0.9, 0.7, 1.5, 1.0), (6e-3, 6e-3, 3e-4, 2e-4)
    for error, least, bound in zip(np.transpose(errors), least_orders, bounds, strict=True):
        assert order(points, error) > least
        assert error[-1] < bound


def test_load_of_flat_square_punch():
    """Load F = π C E* a δ of a rigid square of edge a, with the capacitance C = 0.366787 of the unit square.

    C: C.-O. Hwang, M. Mascagni, J. Appl. Phys. 95 (2004) 3798, DOI 10.1063/1.1664031. The pressure is
    infinite at the edge, and the grid error is halved from grid to grid.
    """
    stiffness = []
    for points in (32, 64, 128):
        contact = solve_contact(np.zeros((points, points)), UNIT, approach=1e-3, boundary="free")
        assert contact.contact_area_fraction == 1
        stiffness.append(contact.force / 1e-3)
        assert contact.stiffness == pytest.approx(stiffness[-1], rel=1e-6)  # linear: solver error
    exact = np.pi * 0.366787
    assert exact - stiffness[2] < 0.55 * (exact - stiffness[1]) < 0.55**2 * (exact - stiffness[0])
    assert 2 * stiffness[2] - stiffness[1] == pytest.approx(exact, rel=1e-3)


def direct_pressure(height, grid, **imposed):
    """Pressure by principal pivoting, on a padded map whose added nodes are far above the solid."""
    ny, nx = height.shape
    padded = np.full((2 * ny, 2 * nx), height.max() + 1e3 * np.ptp(height))
    padded[:ny, :nx] = height
    if "mean_pressure" in imposed:
        imposed["mean_pressure"] /= 4
    apart = (np.minimum(np.arange(2 * n), 2 * n - np.arange(2 * n)) for n in height.shape)
    y, x = (step * nodes for step, nodes in zip(grid.spacing, apart, strict=True))
    modes = np.fft.rfft2(rectangle_compliance(y[:, None], x, grid.spacing, 1.0)).real
    return pivot(padded, modes, guess=padded < np.median(height), **imposed)[:ny, :nx]


@pytest.mark.parametrize(("shape", "length"), [((16, 16), (1.0, 1.0)), ((12, 21), (0.5, 1.7))])
@pytest.mark.parametrize("fraction", [0.01, 0.1, 0.5])
def test_free_pressure_is_that_of_direct_solution(shape, length, fraction):
    """Solver error; the closed form of the kernel is tested in multiple precision."""
    height = 1e-2 * np.random.default_rng(7).standard_normal(shape)
    contact = solve_contact(height, UNIT, length, mean_pressure=fraction * 0.1, boundary="free", rtol=1e-11)
    assert 1 < np.count_nonzero(contact.pressure) < height.size
    by_load = direct_pressure(height, contact.grid, mean_pressure=fraction * 0.1)
    np.testing.assert_allclose(contact.pressure, by_load, rtol=0, atol=1e-8 * by_load.max())
    by_approach = direct_pressure(height, contact.grid, approach=contact.approach)
    np.testing.assert_allclose(contact.pressure, by_approach, rtol=0, atol=1e-7 * by_load.max())


@pytest.mark.parametrize("contact_area_fraction", [0.01, 0.3])
@pytest.mark.parametrize(("shape", "length"), [((3, 200), (1.0, 1e4)), ((24, 24), (1.0, 1e-2))])
def test_pressure_on_narrow_pixels_is_direct(shape, length, contact_area_fraction):
    """Pixels 100 and 150 times as long as wide. Solver error."""
    height = 1e-3 * np.random.default_rng(0).standard_normal(shape)
    contact = solve_contact(height, UNIT, length, contact_area_fraction=contact_area_fraction)
    modes = mode_compliance(UNIT, asp.Grid(shape, length))
    exact = pivot(height, modes, mean_pressure=contact.mean_pressure)
    assert difference(contact.pressure, exact) < 1e-5


@pytest.mark.parametrize("method", ["active_set", "gfmd"])
@pytest.mark.parametrize("part", [0.3, 0.99, 0.999])
def test_approach_near_full_contact(part, method):
    """The load grows without limit towards the mean height; against the direct solution."""
    height = rough((24, 24))
    approach = (1 - part) * float(height.min())
    contact = solve_contact(height, UNIT, approach=approach, method=method, rtol=1e-6)
    exact = pivot(height, mode_compliance(UNIT, asp.Grid(height.shape)), approach=approach)
    assert difference(contact.pressure, exact) < 3e-6


@pytest.mark.parametrize(
    ("load", "rtol", "settings"),
    [
        (0.05, 1e-4, {"boundary": "free"}),
        (0.05, 1e-8, {"boundary": "free"}),
        *((load, 1e-6, {"method": "gfmd"}) for load in (1e-7, 1e-3, 1e-1)),
        (1e-3, 1e-4, {"method": "gfmd"}),
    ],
)
def test_true_error_is_below_the_tolerance(load, rtol, settings):
    height = rough((128, 128))
    imposed = {"mean_pressure": load_of(height, load), "boundary": settings.get("boundary", "periodic")}
    contact = solve_contact(height, UNIT, **imposed | settings, rtol=rtol)
    assert difference(contact.pressure, solve_contact(height, UNIT, **imposed, rtol=1e-11).pressure) < rtol
