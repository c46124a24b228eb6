"""Contact with a hardness, against direct solutions and exact identities; another program: `test_peers`."""

import importlib

import numpy as np
import pytest
from samples import HALF_SPACE, LAYER, difference, every_solid, hardened, load_of, rough
from scipy.optimize import lsq_linear

import asperity as asp
from asperity.elasticity.loaded_rectangle import rectangle_compliance


def love_matrix(grid, modulus):
    """Displacement of every node under a unit pressure on another, by the closed form of Love (1929)."""
    y, x = (np.subtract.outer(axis, axis) for axis in grid.coordinates())
    y, x = np.abs(y)[:, None, :, None], np.abs(x)[None, :, None, :]
    return rectangle_compliance(y, x, grid.spacing, modulus).reshape(grid.size, grid.size)


@pytest.mark.parametrize("share", [0.2, 0.6])
def test_pressure_is_that_of_a_bounded_quadratic_program(share):
    """Solver error: ½ p·G p + p·(h − δ) over 0 ≤ p ≤ H, by scipy on a dense matrix."""
    height, grid = rough((18, 18)), asp.Grid((18, 18))
    contact = hardened(height, share, boundary="free", rtol=1e-11)
    assert 0.05 < contact.plastic_load < 1
    # With G = R·Rᵀ the energy is half the square of R p − R⁻¹(δ − h), less a constant.
    root = np.linalg.cholesky(love_matrix(grid, HALF_SPACE.effective_modulus)).T
    target = np.linalg.solve(root.T, contact.approach - height.ravel())
    found = lsq_linear(root, target, (0, contact.hardness), method="bvls", tol=1e-14)
    np.testing.assert_allclose(contact.pressure.ravel(), found.x, rtol=0, atol=1e-7 * contact.hardness)


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@every_solid
def test_out_of_reach_it_changes_no_bit(solid, boundary, dtype):
    height = rough()
    loads = {"mean_pressure": load_of(height), "contact_area_fraction": 0.1, "approach": 0.5 * height.min()}
    for kind, value in loads.items():
        settings = {kind: value, "boundary": boundary, "dtype": dtype}
        elastic = asp.solve_contact(height, solid, **settings)
        # Just above the largest pressure an iterate, not the solution, reaches the hardness.
        for factor in (1.0001, 1e6):
            contact = asp.solve_contact(height, solid, hardness=factor * elastic.maximum_pressure, **settings)
            for name in ("pressure", "gap", "displacement"):
                np.testing.assert_array_equal(getattr(contact, name), getattr(elastic, name))
            assert contact.approach == elastic.approach
            assert contact.plastic_area == contact.plastic_load == contact.plastic_depth.max() == 0


def test_hardness_out_of_reach_costs_no_solution(monkeypatch):
    """One that iterates meet does: the rounding of an elastic solution depends on the way to it."""
    methods = importlib.import_module("asperity.contact.solve").METHODS
    calls, active_set = [], methods["active_set"]
    monkeypatch.setitem(methods, "active_set", lambda *given: calls.append(given) or active_set(*given))
    height = asp.self_affine((64, 64), 0.8, 1 / 2, 1 / 16, 1e-2, seed=0)
    largest = asp.solve_contact(height, LAYER, mean_pressure=1e-3).maximum_pressure
    for factor, solutions in ((10.0, 1), (1.01, 2)):
        calls.clear()
        asp.solve_contact(height, LAYER, mean_pressure=1e-3, hardness=factor * largest)
        assert len(calls) == solutions


@pytest.mark.parametrize("share", [0.9, 0.3, 0.05])
@every_solid
def test_flattened_map_pressed_elastically_has_the_same_pressure(solid, boundary, share):
    """An exact identity; solver error of both solutions."""
    height = rough((96, 80))
    for imposed in ({"mean_pressure": load_of(height)}, {"contact_area_fraction": 0.2}):
        elastic = asp.solve_contact(height, solid, boundary=boundary, **imposed)
        hardness = max(share * elastic.maximum_pressure, 1.2 * elastic.mean_pressure)
        contact = asp.solve_contact(height, solid, hardness=hardness, boundary=boundary, **imposed)
        assert contact.pressure.max() == contact.hardness
        assert contact.certificate.worst < 1e-5
        assert contact.gap.min() > -1e-5 * height.std()
        load = contact.mean_pressure
        again = asp.solve_contact(contact.flattened_height(), solid, mean_pressure=load, boundary=boundary)
        assert difference(again.pressure, contact.pressure) < 5 * contact.rtol
        assert again.approach == pytest.approx(contact.approach, abs=1e-5 * height.std())


@pytest.mark.parametrize("size", [1e-6, 1e-3, 1.0])
@pytest.mark.parametrize("share", [0.6, 0.1])
def test_certificate_bounds_errors_up_to_the_hardness(share, size):
    """Energy of the error, against the solution of the same load and hardness; that one's solver error."""
    height, grid, random = rough((48, 32)), asp.Grid((48, 32)), np.random.default_rng(3)
    near, modes = hardened(height, share), HALF_SPACE.surface_compliance(grid.wavenumber())
    limit, changed = near.hardness, near.pressure * (1 + size * random.standard_normal(grid.shape))
    for pressure in (changed, np.where(near.pressure == limit, limit, changed), changed[:, ::-1]):
        pressure = np.clip(pressure, 0, limit)
        exact = asp.solve_contact(
            height, HALF_SPACE, hardness=limit, mean_pressure=pressure.mean(), rtol=1e-11
        )
        wrong = pressure - exact.pressure
        energy = np.vdot(wrong, np.fft.irfft2(modes * np.fft.rfft2(wrong), grid.shape))
        bound = asp.contact.verify_contact(height, pressure, HALF_SPACE, hardness=limit).error_bound
        assert 0 < energy / (pressure.sum() * height.std()) <= bound < np.inf


def test_soft_limit_is_the_bearing_area():
    """All contact is plastic: its area is load over hardness, to one node, and its nodes are the lowest."""
    height = rough() * 1e3
    hardness = 1e-3
    for share in (0.1, 0.37, 0.5):
        contact = asp.solve_contact(height, HALF_SPACE, mean_pressure=share * hardness, hardness=hardness)
        nodes = np.count_nonzero(contact.pressure)
        assert abs(nodes - share * height.size) <= 1
        lowest = np.sort(height, axis=None)[nodes]
        assert height[contact.pressure > 0].max() < lowest + 1e-2 * height.std()


def test_area_and_approach_grow_as_hardness_falls():
    found = [hardened(rough(), share) for share in (1.5, 0.7, 0.5, 0.3, 0.2, 0.1)]
    for quantity in ("contact_area_fraction", "plastic_area", "plastic_load", "approach"):
        values = np.array([getattr(contact, quantity) for contact in found])
        assert np.all(np.diff(values) >= 0), quantity
        assert np.all(np.diff(values)[1:] > 0), quantity


def test_approach_and_load_give_the_same_contact():
    """Solver error of both solutions."""
    height = rough((64, 96))
    by_load = hardened(height, 0.3, LAYER, rtol=1e-9)
    settings = {"approach": by_load.approach, "hardness": by_load.hardness}
    by_approach = asp.solve_contact(height, LAYER, **settings, rtol=1e-9)
    assert difference(by_approach.pressure, by_load.pressure) < 1e-7


def test_certificate_knows_the_hardness():
    height = rough()
    contact, load = hardened(height, 0.5), load_of(height)

    def worst(**given):
        return asp.contact.verify_contact(
            height, contact.pressure, HALF_SPACE, mean_pressure=load, **given
        ).worst

    assert worst(hardness=contact.hardness) < 1e-5
    assert worst() > 1e-2  # the overlap of plastic nodes is a penetration without a hardness
    assert worst(hardness=0.9 * contact.hardness) > 0.05  # pressures above it
    assert worst(hardness=1.1 * contact.hardness) > 1e-2  # nodes below it must not overlap


def test_results_know_the_hardness(tmp_path):
    height = rough()
    contact = asp.solve_contact(height, HALF_SPACE, contact_area_fraction=0.1, hardness=0.02)
    contact.to_netcdf(tmp_path / "contact.nc")
    stored = asp.read_result(tmp_path / "contact.nc")
    np.testing.assert_array_equal(stored["plastic_depth"], contact.plastic_depth)
    assert float(stored["hardness"]) == 0.02
    assert float(stored["plastic_area"]) == contact.plastic_area > 0
    assert (
        "plastic_depth" not in asp.solve_contact(height, HALF_SPACE, contact_area_fraction=0.1).to_dataset()
    )


def test_peaks_on_plateaus_are_those_at_the_nodes():
    """Quadratics through the nodes give pressures of 1.3 times the hardness on this grid."""
    height = asp.self_affine((128, 128), 0.8, 1 / 4, 1 / 16, rms_height=1e-3, seed=1)
    load = 0.02 * asp.roughness_parameters(height).rms_gradient
    contact = asp.solve_contact(height, asp.Solid(1.0, 0.3), mean_pressure=load, hardness=20 * load)
    stress = asp.analyse_stress(contact, quantities=("pressure", "von_mises"))
    assert "without plastic strain" in stress.attrs["plastic_contact"]
    assert (
        "plastic_contact"
        not in asp.analyse_stress(asp.solve_contact(height, HALF_SPACE, mean_pressure=load)).attrs
    )
    largest = stress["peak_value"].groupby(stress["peak_quantity"]).max()
    assert largest.sel(peak_quantity="pressure") == contact.hardness
    assert largest.sel(peak_quantity="von_mises") == pytest.approx(
        float(stress["maximum_von_mises"].max()), rel=1e-6
    )


def test_area_of_many_loads_keeps_the_hardness():
    """Of two equal lowest nodes; without a hardness the solver takes a load above it."""
    height = np.zeros((7, 3))
    height[6, [0, 2]], height[0, 0] = -2, 1
    settings = {"contact_area_fraction": 0.001}
    above = asp.solve_contact(height, HALF_SPACE, **settings).maximum_pressure
    contact = asp.solve_contact(height, HALF_SPACE, **settings, hardness=0.5 * above)
    assert contact.contact_area_fraction == 2 / 21
    assert 0 < contact.maximum_pressure <= contact.hardness


def test_start_above_the_hardness_finds_the_area():
    height = 1e-3 * np.random.default_rng(6).normal(size=(2, 2))
    start = np.random.default_rng(0).normal(size=(2, 2))
    contact = asp.solve_contact(
        height, asp.Solid(402.0, 0.0), contact_area_fraction=0.75, initial=start, hardness=1.0
    )
    assert contact.contact_area_fraction == 0.75
    assert contact.maximum_pressure <= 1.0
