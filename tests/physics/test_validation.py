"""The comparisons with closed forms and finite elements stay within the bounds of the validation table."""

from __future__ import annotations

from importlib import resources

import numpy as np
import pytest
import xarray as xr
import yaml

from asperity.elasticity.layer import Layer
from asperity.reference import calculix
from asperity.reference.elementary import single_mode_displacement, single_mode_stress
from asperity.reference.periodic_hertz import PeriodicHertz
from asperity.spectral import Grid
from asperity.validation.closed_forms import load_area, punch, slab_load_area
from asperity.validation.comparisons import COMPARISONS, title
from asperity.validation.convergence import convergence_order, grid_convergence, mesh_convergence
from asperity.validation.finite_elements import (
    FIELDS,
    compare_calculix,
    compare_elements,
    largest_differences,
)
from asperity.validation.held_out import edge_tension, elliptic_contacts, layer_indentation, wave_asymptotes
from asperity.validation.indenter import CURVATURE_RADIUS, fitted_contact_radius, paraboloid
from asperity.validation.pointwise import displacement_and_stress
from asperity.validation.table import BOUNDS, markdown, relative_error, table_rows


def test_fields_at_points_are_those_of_a_mode() -> None:
    grid = Grid((12, 16), (0.9, 1.2))
    wavenumber = 2 * np.pi / 1.2 * 3
    pressure = np.tile(np.cos(wavenumber * grid.coordinates()[1]), (12, 1))
    y, x, depths = np.array([0.1, 0.37]), np.array([0.21, 0.4]), np.array([0.0, 0.05, 0.3])
    moved, stress = displacement_and_stress(pressure, grid, Layer(1.3, 0.3), y, x, depths)
    expected = single_mode_stress(x, depths[:, None], wavenumber, 0.3)
    # Rounding.
    np.testing.assert_allclose(stress, expected, atol=1e-13)
    expected = single_mode_displacement(x, depths[:, None], wavenumber, 1.3, 0.3)
    np.testing.assert_allclose(moved, expected, atol=1e-13)


def test_fitted_contact_radius_is_that_of_hertz() -> None:
    """The pressure is the closed form's: the fit has no grid error."""
    grid = Grid((64, 64))
    pressure = PeriodicHertz(0.21, 10.0).pressure(np.sqrt(2 * paraboloid(grid, 1.0)))
    assert fitted_contact_radius(pressure, grid) == pytest.approx(0.21, rel=1e-10)


def test_registry_has_the_comparisons_of_the_configuration() -> None:
    schema = yaml.safe_load(resources.files("asperity.config").joinpath("schema.yaml").read_text("utf-8"))
    assert set(COMPARISONS) == set(schema["properties"]["validation"]["properties"])
    for name in COMPARISONS:
        assert 20 < len(title(name)) < 120
        assert title(name).count("(") == title(name).count(")")


@pytest.fixture(scope="module")
def hertz() -> xr.Dataset:
    return load_area(contact_radii=(0.1, 0.2, 0.3), method="active_set")


def test_load_area(hertz: xr.Dataset) -> None:
    """Grid, and Hertz's shape of the pressure."""
    error = np.abs(hertz.solved_contact_radius / hertz.hertz_contact_radius - 1)
    assert error.max() < BOUNDS["load_area"]


def test_load_at_given_area_scales_with_the_effective_modulus(hertz: xr.Dataset) -> None:
    """At one Young's modulus the load rises with Poisson's ratio as 1/(1 − ν²)."""
    scaled = hertz.imposed_mean_pressure_young * (1 - hertz.poisson**2)
    # Rounding; the tolerance of the solver, 1e-6, changes no contact node.
    np.testing.assert_allclose(scaled, scaled.isel(poisson=[0]).values.repeat(3, 0), rtol=1e-12)
    assert np.ptp(hertz.solved_contact_radius.values, axis=0).max() < 1e-6


def test_gfmd_and_active_set_find_the_same_contact_radius(hertz: xr.Dataset) -> None:
    dynamics = load_area(poisson=(0.33,), contact_radii=(0.2,), method="gfmd")
    same = hertz.sel(poisson=0.33).isel(path=1)
    # Solver.
    assert float(dynamics.solved_contact_radius[0, 0]) == pytest.approx(
        float(same.solved_contact_radius), rel=1e-4
    )


@pytest.fixture(scope="module")
def grids() -> xr.Dataset:
    return grid_convergence(points=(32, 64, 128))


def test_wave_pressure_rate(grids: xr.Dataset) -> None:
    """The square root at the edge of contact allows first order."""
    order = convergence_order(grids.grid_points, grids.wave_pressure_error)
    assert order > BOUNDS["wave_pressure_rate"]


def test_wave_approach(grids: xr.Dataset) -> None:
    assert grids.wave_approach_error[-1] < BOUNDS["wave_approach"]


def test_slab_load(grids: xr.Dataset) -> None:
    assert grids.slab_load_error[-1] < BOUNDS["slab_load"]


@pytest.fixture(scope="module")
def elements() -> xr.Dataset:
    return compare_elements((20, 16), points=256)


def test_elements_load(elements: xr.Dataset) -> None:
    """Mesh and grid; the elements find their own contact."""
    assert abs(largest_differences(elements).difference_load) < BOUNDS["elements_load"]


def test_elements_away(elements: xr.Dataset) -> None:
    """Mesh and grid, farther than a twentieth of the cell from the edge of contact."""
    assert largest_differences(elements).difference_away.max() < BOUNDS["elements_away"]


def test_elements_edge(elements: xr.Dataset) -> None:
    """The square root of the pressure, which neither the mesh nor the grid resolves."""
    assert largest_differences(elements).difference_edge.max() < BOUNDS["elements_edge"]


def test_difference_falls_with_the_mesh() -> None:
    found = mesh_convergence(((8, 7), (16, 13)), points=256)
    coarse, fine = found.difference_away.values
    # Quadratic elements: half the size, a quarter of the error; the edge of contact spoils some of it.
    assert np.all(fine < 0.45 * coarse)


def test_a_wrong_field_is_found(elements: xr.Dataset) -> None:
    spoiled = elements.copy()
    spoiled["stress_xx_elements"] = 1.1 * elements.stress_xx_elements
    away = largest_differences(spoiled).difference_away
    assert away.sel(field="stress_xx") > 10 * BOUNDS["elements_away"]
    assert away.sel(field="stress_zz") < BOUNDS["elements_away"]


@pytest.fixture(scope="module")
def calculix_differences(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    if not calculix.available():
        pytest.skip("CalculiX is optional and not installed")
    folder = tmp_path_factory.mktemp("calculix")
    return largest_differences(compare_calculix(folder, (8, 7), penalty=2e3))


def test_calculix_load(calculix_differences: xr.Dataset) -> None:
    """Mesh, penalty and grid."""
    assert abs(calculix_differences.difference_load) < BOUNDS["calculix_load"]


def test_calculix_away(calculix_differences: xr.Dataset) -> None:
    """Mesh, penalty and grid."""
    assert calculix_differences.difference_away.max() < BOUNDS["calculix_away"]


@pytest.fixture(scope="module")
def huber() -> xr.Dataset:
    return punch(points=256, samples=5)


def test_punch_peak(huber: xr.Dataset) -> None:
    """Grid, and the neighbours in the periodic cell."""
    error = huber.peak_von_mises_array / huber.peak_von_mises_closed_form - 1
    assert np.abs(error).max() < BOUNDS["punch_peak"]


def test_punch_depth(huber: xr.Dataset) -> None:
    error = huber.peak_depth_array / huber.peak_depth_closed_form - 1
    assert np.abs(error).max() < BOUNDS["punch_depth"]


def test_confined_and_free_differ_from_summed_contacts_by_the_uniform_mode(huber: xr.Dataset) -> None:
    nu, pressure = huber.poisson, float(huber.largest_pressure)
    mean = 2 / 3 * np.pi * float(huber.contact_radius) ** 2
    for name, lateral in (("free", 0 * nu), ("confined", nu / (1 - nu))):
        change = (huber[f"peak_von_mises_{name}"] - huber.peak_von_mises_array) / pressure
        # On the axis von Mises is |σ_xx − σ_zz|.
        np.testing.assert_allclose(change, (0.5 + nu - lateral) * mean, atol=1e-4)


def test_slab_is_stiffer_than_the_half_space() -> None:
    found = slab_load_area(heights=(0.25, 1.0), steps=3, method="active_set")
    assert np.all(found.slab_stiffening > 1.05)
    assert np.all(found.slab_stiffening[0] > found.slab_stiffening[1])


def test_paraboloid_has_its_curvature() -> None:
    height = paraboloid(Grid((8, 8)), CURVATURE_RADIUS)
    assert height[4, 4] == 0
    assert height[4, 5] == pytest.approx(0.125**2 / (2 * CURVATURE_RADIUS), rel=1e-15)


def test_table_holds_and_shows_an_exceeded_bound(
    hertz: xr.Dataset, grids: xr.Dataset, elements: xr.Dataset, huber: xr.Dataset
) -> None:
    datasets = {"load_area": hertz, "grid_convergence": grids, "elements": elements, "punch": huber}
    rows = table_rows(datasets)
    assert all(row.holds for row in rows)
    assert {row.test.removeprefix("test_validation.py::") for row in rows} <= set(globals())
    assert len(rows) == 5 + 2 * len(FIELDS) + 2 * huber.sizes["poisson"]
    text = markdown(rows)
    assert text.count("\n") == len(rows) + 2
    assert "exceeded" not in text
    datasets["load_area"] = hertz.assign(solved_contact_radius=1.1 * hertz.solved_contact_radius)
    assert "**exceeded**" in markdown(table_rows(datasets))


@pytest.fixture(scope="module")
def ellipses() -> xr.Dataset:
    return elliptic_contacts()


@pytest.mark.xdist_group("ellipses")
def test_elliptic_pressure(ellipses: xr.Dataset) -> None:
    """Grid."""
    assert relative_error(ellipses, "largest_pressure").max() < BOUNDS["elliptic_pressure"]


@pytest.mark.xdist_group("ellipses")
@pytest.mark.parametrize("name", ["von_mises", "largest_shear"])
def test_elliptic_stress(ellipses: xr.Dataset, name: str) -> None:
    """Grid."""
    assert relative_error(ellipses, name).max() < BOUNDS["elliptic_stress"]


@pytest.mark.xdist_group("ellipses")
@pytest.mark.parametrize("name", ["von_mises", "largest_shear"])
def test_elliptic_depth(ellipses: xr.Dataset, name: str) -> None:
    """Grid, and the parabola through three depths."""
    assert relative_error(ellipses, f"{name}_depth").max() < BOUNDS["elliptic_depth"]


def test_edge_tension() -> None:
    """Grid. The stress has an infinite slope inside the edge of contact, so that its error falls slowly."""
    found = edge_tension()
    difference = np.abs(found.solved_tension - found.exact_tension)
    assert difference.max() < BOUNDS["edge_tension"]
    assert difference.sel(poisson=0.5).max() < 1e-12  # no radial stress: rounding
    assert float(found.solved_tension.sel(poisson=0.0).max()) > 0.32


@pytest.fixture(scope="module")
def layers() -> xr.Dataset:
    return layer_indentation()


@pytest.mark.xdist_group("layers")
def test_layer_punch_load(layers: xr.Dataset) -> None:
    """Grid: the pressure is singular at the edge."""
    errors = relative_error(layers, "load").sel(indenter="flat punch")
    assert errors.max() < BOUNDS["layer_punch_load"]


@pytest.mark.xdist_group("layers")
def test_layer_paraboloid_load(layers: xr.Dataset) -> None:
    """Grid, and for the thickest incompressible layer the neighbours."""
    errors = relative_error(layers, "load").sel(indenter="paraboloid")
    assert errors.max() < BOUNDS["layer_paraboloid_load"]


@pytest.mark.xdist_group("layers")
def test_layer_contact_radius(layers: xr.Dataset) -> None:
    """Grid: a count of nodes, 26 to the radius."""
    assert relative_error(layers, "contact_radius").max() < BOUNDS["layer_contact_radius"]


@pytest.fixture(scope="module")
def waves() -> xr.Dataset:
    return wave_asymptotes()


@pytest.mark.xdist_group("waves")
def test_wave_small_contact(waves: xr.Dataset) -> None:
    """The asymptote's own error, which falls with the load."""
    errors = relative_error(waves, "contact_radius")
    assert errors[0] < BOUNDS["wave_small_contact"]
    assert errors[0] < 0.3 * errors[1]


@pytest.mark.xdist_group("waves")
def test_wave_nearly_complete(waves: xr.Dataset) -> None:
    """The asymptote's own error, which falls with the part out of contact, and the grid."""
    errors = relative_error(waves, "mean_gap")
    assert errors[-1] < BOUNDS["wave_nearly_complete"]
    assert errors[-1] < 0.3 * errors[0]
