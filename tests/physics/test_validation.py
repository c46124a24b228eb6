"""The solver against closed forms and finite elements, within the bounds of the validation table."""

import numpy as np
import pytest

from asperity.elasticity.layer import Layer
from asperity.reference import calculix
from asperity.reference.elementary import single_mode_displacement, single_mode_stress
from asperity.reference.periodic_hertz import PeriodicHertz
from asperity.spectral import Grid
from asperity.validation import comparisons as validation
from asperity.validation.comparisons import BOUNDS, FIELDS


def test_fields_at_any_point_are_those_of_a_mode():
    grid = Grid((12, 16), (0.9, 1.2))
    wavenumber = 2 * np.pi / 1.2 * 3
    pressure = np.tile(np.cos(wavenumber * grid.coordinates()[1]), (12, 1))
    y, x, depths = np.array([0.1, 0.37]), np.array([0.21, 0.4]), np.array([0.0, 0.05, 0.3])
    moved, stress = validation.fields_at(pressure, grid, Layer(1.3, 0.3), y, x, depths)
    expected = single_mode_stress(x, depths[:, None], wavenumber, 0.3)
    # Rounding.
    np.testing.assert_allclose(stress, expected, atol=1e-13)
    expected = single_mode_displacement(x, depths[:, None], wavenumber, 1.3, 0.3)
    np.testing.assert_allclose(moved, expected, atol=1e-13)


def test_fitted_contact_radius_finds_that_of_hertz():
    """The fit itself, on the closed form's pressure: no grid error at all."""
    grid = Grid((64, 64))
    distance = np.sqrt(2 * validation.paraboloid(grid, 1.0))

    class Exact:
        pressure = PeriodicHertz(0.21, 10.0).pressure(distance)

    Exact.grid = grid
    assert validation.contact_radius(Exact) == pytest.approx(0.21, rel=1e-10)


@pytest.fixture(scope="module")
def load_area():
    return validation.load_area(contact_radii=(0.1, 0.2, 0.3), method="active_set")


def test_load_area(load_area):
    """Grid, and Hertz's shape of the pressure."""
    error = np.abs(load_area.solved_contact_radius / load_area.hertz_contact_radius - 1)
    assert error.max() < BOUNDS["load_area"]


def test_load_at_given_area_scales_with_the_effective_modulus(load_area):
    """Stiffer with Poisson's ratio at one Young's modulus, as 1/(1 − ν²)."""
    scaled = load_area.imposed_mean_pressure_young * (1 - load_area.poisson**2)
    # Rounding; and the solver's tolerance, 1e-6, moves no node.
    np.testing.assert_allclose(scaled, scaled.isel(poisson=[0]).values.repeat(3, 0), rtol=1e-12)
    assert np.ptp(load_area.solved_contact_radius.values, axis=0).max() < 1e-6


def test_gfmd_and_active_set_draw_the_same_figure(load_area):
    dynamics = validation.load_area(poisson=(0.33,), contact_radii=(0.2,), method="gfmd")
    same = load_area.sel(poisson=0.33).isel(path=1)
    # Solver.
    assert float(dynamics.solved_contact_radius[0, 0]) == pytest.approx(
        float(same.solved_contact_radius), rel=1e-4
    )


@pytest.fixture(scope="module")
def grid_convergence():
    return validation.grid_convergence(points=(32, 64, 128))


def test_wave_pressure_rate(grid_convergence):
    """A square root at the edge of contact allows first order."""
    rate = validation._rate(grid_convergence.grid_points, grid_convergence.wave_pressure_error)
    assert rate > BOUNDS["wave_pressure_rate"]


def test_wave_approach(grid_convergence):
    assert grid_convergence.wave_approach_error[-1] < BOUNDS["wave_approach"]


def test_slab_load(grid_convergence):
    assert grid_convergence.slab_load_error[-1] < BOUNDS["slab_load"]


@pytest.fixture(scope="module")
def elements():
    return validation.compare_elements((20, 16), points=256)


def test_elements_load(elements):
    """Mesh and grid; the contact of the elements is their own."""
    assert abs(validation.differences(elements).difference_load) < BOUNDS["elements_load"]


def test_elements_away(elements):
    """Mesh and grid, farther than a twentieth of the cell from the edge of contact."""
    assert validation.differences(elements).difference_away.max() < BOUNDS["elements_away"]


def test_elements_edge(elements):
    """The kink of the pressure, which neither the mesh nor the grid resolves."""
    assert validation.differences(elements).difference_edge.max() < BOUNDS["elements_edge"]


def test_difference_falls_with_the_mesh():
    found = validation.mesh_convergence(((8, 7), (16, 13)), points=256)
    coarse, fine = found.difference_away.values
    # Quadratic elements: half the size, a quarter of the error; the edge spoils some of it.
    assert np.all(fine < 0.45 * coarse)


def test_differences_find_a_wrong_field(elements):
    spoiled = elements.copy()
    spoiled["stress_xx_elements"] = 1.1 * elements.stress_xx_elements
    away = validation.differences(spoiled).difference_away
    assert away.sel(field="stress_xx") > 10 * BOUNDS["elements_away"]
    assert away.sel(field="stress_zz") < BOUNDS["elements_away"]


@pytest.fixture(scope="module")
def calculix_result(tmp_path_factory):
    if not calculix.available():
        pytest.skip("CalculiX is optional and not installed")
    folder = tmp_path_factory.mktemp("calculix")
    return validation.differences(validation.compare_calculix(folder, (8, 7), penalty=2e3))


def test_calculix_load(calculix_result):
    """Mesh, penalty and grid."""
    assert abs(calculix_result.difference_load) < BOUNDS["calculix_load"]


def test_calculix_away(calculix_result):
    """Mesh, penalty and grid."""
    assert calculix_result.difference_away.max() < BOUNDS["calculix_away"]


@pytest.fixture(scope="module")
def punch():
    return validation.punch(points=256, samples=9)


def test_punch_peak(punch):
    """Grid, and the neighbours in the periodic cell."""
    error = punch.peak_von_mises_array / punch.peak_von_mises_closed_form - 1
    assert np.abs(error).max() < BOUNDS["punch_peak"]


def test_punch_depth(punch):
    error = punch.peak_depth_array / punch.peak_depth_closed_form - 1
    assert np.abs(error).max() < BOUNDS["punch_depth"]


def test_uniform_mode_explains_what_the_cell_adds(punch):
    """Confined and free differ from summed single contacts by the uniform lateral stress alone."""
    nu, pressure = punch.poisson, float(punch.largest_pressure)
    mean = 2 / 3 * np.pi * float(punch.contact_radius) ** 2
    for name, lateral in (("free", 0 * nu), ("confined", nu / (1 - nu))):
        change = (punch[f"peak_von_mises_{name}"] - punch.peak_von_mises_array) / pressure
        # On the axis von Mises is |σ_xx − σ_zz|.
        np.testing.assert_allclose(change, (0.5 + nu - lateral) * mean, atol=1e-4)


def test_slab_is_stiffer_than_the_half_space():
    found = validation.slab_load_area(heights=(0.25, 1.0), steps=3, method="active_set")
    assert np.all(found.slab_stiffening > 1.05)
    assert np.all(found.slab_stiffening[0] > found.slab_stiffening[1])


def test_table_holds_and_shows_what_does_not(load_area, grid_convergence, elements, punch):
    datasets = {
        "load_area": load_area,
        "grid_convergence": grid_convergence,
        "elements": elements,
        "punch": punch,
    }
    rows = validation.table(datasets)
    assert all(row.holds for row in rows)
    assert {row.test.removeprefix("test_validation.py::") for row in rows} <= set(globals())
    assert len(rows) == 5 + 2 * len(FIELDS) + 2 * punch.sizes["poisson"]
    text = validation.markdown(rows)
    assert text.count("\n") == len(rows) + 2
    assert "exceeded" not in text
    datasets["load_area"] = load_area.assign(solved_contact_radius=1.1 * load_area.solved_contact_radius)
    assert "**exceeded**" in validation.markdown(validation.table(datasets))
