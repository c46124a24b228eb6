"""Tests of `solve`, `solve_path` and the certificate: controls, extremes of the input, bad input."""

from __future__ import annotations

import numpy as np
import pytest

import asperity as asp
from asperity.contact import Contact, solve, solve_path
from asperity.core.errors import ConvergenceError
from asperity.core.types import Array
from asperity.elasticity.layer import Layer

HALF_SPACE = Layer(1 - 0.33**2, 0.33)
SLAB = Layer(1 - 0.33**2, 0.33, height=1.0)
INCOMPRESSIBLE = Layer(0.75, 0.5, height=0.1)
METHODS = ("active_set", "gfmd")


def rough(shape: tuple[int, int] = (64, 64), seed: int = 1) -> Array:
    return asp.self_affine(shape, 0.8, 0.5, 0.125, 1e-3, seed)


def load_of(height: Array, fraction: float = 0.05) -> float:
    return fraction * asp.roughness_parameters(height).rms_gradient


def largest_difference(one: Contact, other: Contact) -> float:
    return float(np.abs(one.pressure - other.pressure).max() / other.pressure.max())


@pytest.mark.parametrize("layer", [HALF_SPACE, SLAB, INCOMPRESSIBLE, Layer(0.8, 0.2, 0.3, "frictionless")])
@pytest.mark.parametrize("method", METHODS)
def test_load_approach_and_area_control_agree(layer: Layer, method: str) -> None:
    """The tolerances are solver errors."""
    height = rough()
    by_load = solve(height, layer, mean_pressure=load_of(height), method=method, rtol=1e-9)
    by_load.certificate.check(1e-7)
    by_approach = solve(height, layer, approach=by_load.approach, method=method, rtol=1e-9)
    assert largest_difference(by_approach, by_load) < 1e-6
    by_area = solve(height, layer, area_fraction=by_load.area_fraction, method=method, rtol=1e-9)
    assert np.count_nonzero(by_area.pressure) == np.count_nonzero(by_load.pressure)
    # On this grid the area changes by one node per few thousandths of the load.
    assert by_area.mean_pressure == pytest.approx(by_load.mean_pressure, rel=0.02)


@pytest.mark.parametrize("layer", [HALF_SPACE, SLAB, INCOMPRESSIBLE])
def test_methods_agree(layer: Layer) -> None:
    height = rough()
    one, other = (
        solve(height, layer, mean_pressure=load_of(height), method=method, rtol=1e-11) for method in METHODS
    )
    assert largest_difference(one, other) < 1e-9
    assert one.approach == pytest.approx(other.approach, abs=1e-9 * height.std())


@pytest.mark.parametrize("area_fraction", [0.003, 0.8])
def test_area_is_met(area_fraction: float) -> None:
    height = rough((128, 128))
    contact = solve(height, HALF_SPACE, area_fraction=area_fraction)
    wanted = round(area_fraction * height.size)
    assert abs(np.count_nonzero(contact.pressure) - wanted) <= max(0.5, 1e-4 * wanted)
    contact.certificate.check(1e-4)


@pytest.mark.parametrize("hurst", [0.2, 0.8])
@pytest.mark.parametrize("area_fraction", [0.003, 0.1])
def test_area_control_takes_at_most_twice_the_transforms_of_load_control(
    hurst: float, area_fraction: float
) -> None:
    """Mean of two surfaces."""
    spent = np.zeros(2)
    for seed in (1, 2):
        height = asp.self_affine((256, 256), hurst, 0.125, 1 / 32, 1e-3, seed)
        by_area = solve(height, HALF_SPACE, area_fraction=area_fraction)
        by_load = solve(height, HALF_SPACE, mean_pressure=by_area.mean_pressure)
        spent += by_area.certificate.pairs, by_load.certificate.pairs
    assert spent[0] < 2 * spent[1]


@pytest.mark.parametrize(("fraction", "rtol"), [(0.01, 1e-6), (0.3, 1e-9), (0.9, 1e-6)])
def test_area_control_on_a_mirrored_surface(fraction: float, rtol: float) -> None:
    """Four nodes touch at a time, and the nearest possible number of nodes is taken."""
    quarter = np.random.default_rng(1).standard_normal((32, 32))
    half = np.concatenate([quarter, quarter[::-1]])
    spectrum = np.fft.rfft2(np.concatenate([half, half[:, ::-1]], axis=1))
    q = np.hypot(np.fft.fftfreq(64)[:, None], np.fft.rfftfreq(64)) * 64
    height = np.fft.irfft2(np.where((q >= 2) & (q <= 8), np.maximum(q, 1) ** -1.8, 0) * spectrum)
    height *= 1e-3 / height.std()
    contact = solve(height, HALF_SPACE, area_fraction=fraction, rtol=rtol)
    count, wanted = np.count_nonzero(contact.pressure), round(fraction * height.size)
    assert count % 4 == 0
    assert abs(count - wanted) <= 2
    contact.certificate.check(100 * rtol)


@pytest.mark.parametrize("fraction", [0.005, 0.3, 0.95])
def test_area_control_on_a_grating(fraction: float) -> None:
    """Two columns of nodes touch at a time."""
    height = np.tile(1e-3 * np.cos(2 * np.pi * np.arange(64) / 64), (64, 1))
    contact = solve(height, HALF_SPACE, area_fraction=fraction)
    assert np.all(np.ptp(contact.pressure, axis=0) < 1e-4 * contact.pressure.max())
    assert abs(np.count_nonzero(contact.pressure) / 64 - 64 * fraction) <= 1
    contact.certificate.check(1e-4)


@pytest.mark.parametrize("method", METHODS)
def test_fields_of_the_solution_are_consistent(method: str) -> None:
    """The tolerances are rounding errors."""
    height = rough()
    contact = solve(height, SLAB, mean_pressure=load_of(height), method=method)
    np.testing.assert_allclose(
        contact.gap, contact.height + contact.displacement - contact.approach, atol=1e-15, rtol=0
    )
    assert contact.area_fraction == np.count_nonzero(contact.pressure) / height.size
    assert contact.mean_pressure == pytest.approx(load_of(height), rel=1e-6)
    assert 0 < contact.gradient_rms_contact < 2 * asp.roughness_parameters(height).rms_gradient
    assert contact.certificate.pairs > 0
    assert contact.certificate.iterations > 0


def test_result_repeats_and_does_not_depend_on_threads() -> None:
    height = rough((256, 130))
    first = solve(height, SLAB, mean_pressure=load_of(height))
    for threads in (1, 2):
        again = solve(height, SLAB, mean_pressure=load_of(height), threads=threads)
        np.testing.assert_array_equal(again.pressure, first.pressure)


# Extremes


@pytest.mark.parametrize("method", METHODS)
def test_full_contact(method: str) -> None:
    """Exact solution: û = −ĥ for every mode but the uniform one."""
    height = rough()
    contact = solve(height, HALF_SPACE, mean_pressure=2.0, method=method, rtol=1e-12)
    assert contact.area_fraction == 1
    assert np.abs(contact.displacement + height - contact.approach).max() < 1e-8 * height.std()
    contact.certificate.check(1e-7)


@pytest.mark.parametrize("method", METHODS)
def test_one_node_in_contact(method: str) -> None:
    height = rough()
    contact = solve(height, HALF_SPACE, area_fraction=1 / height.size, method=method)
    assert np.count_nonzero(contact.pressure) == 1
    assert np.argmax(contact.pressure) == np.argmin(height)
    contact.certificate.check(1e-4)


@pytest.mark.parametrize("load", [1e-15, 1e-100])
def test_vanishing_load(load: float) -> None:
    height = rough()
    contact = solve(height, HALF_SPACE, mean_pressure=load)
    assert contact.mean_pressure == pytest.approx(load, rel=1e-12)
    assert contact.pressure.reshape(-1)[np.argmin(height)] == contact.pressure.max()
    contact.certificate.check(1e-5)


def test_zero_load_gives_first_contact() -> None:
    height = rough()
    contact = solve(height, HALF_SPACE, mean_pressure=0.0)
    assert not contact.pressure.any()
    assert contact.approach == height.min()
    assert contact.area_fraction == 0
    assert np.isnan(contact.gradient_rms_contact)


@pytest.mark.parametrize("layer", [HALF_SPACE, SLAB])
def test_lift_off(layer: Layer) -> None:
    height = rough()
    contact = solve(height, layer, approach=height.min() - 1e-3)
    assert not contact.pressure.any()
    np.testing.assert_allclose(contact.gap.min(), 1e-3, rtol=1e-12)
    contact.certificate.check(0.0)


@pytest.mark.parametrize("layer", [HALF_SPACE, SLAB, INCOMPRESSIBLE])
@pytest.mark.parametrize("method", METHODS)
def test_flat_surface(layer: Layer, method: str) -> None:
    contact = solve(np.zeros((16, 16)), layer, mean_pressure=0.01, method=method)
    np.testing.assert_allclose(contact.pressure, 0.01, rtol=1e-6)
    assert contact.area_fraction == 1


@pytest.mark.parametrize(
    ("shape", "length"),
    [((31, 47), 1.0), ((45, 64), (0.5, 1.5)), ((16, 128), (0.25, 2.0)), ((1, 64), (0.1, 1.0))],
)
def test_odd_and_oblong_grids(shape: tuple[int, int], length: float | tuple[float, float]) -> None:
    generator = np.random.default_rng(4)
    height = 1e-3 * generator.standard_normal(shape)
    height += 1e-2 * np.cos(2 * np.pi * np.arange(shape[1]) / shape[1])
    contact = solve(height, HALF_SPACE, length, mean_pressure=0.01, rtol=1e-9)
    assert 0 < contact.area_fraction < 1
    contact.certificate.check(1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_single_precision_throughout(method: str) -> None:
    """Rounding of single precision, 6e-8, times the conditioning of the problem."""
    height = rough()
    reference = solve(height, SLAB, mean_pressure=load_of(height), rtol=1e-9)
    contact = solve(height, SLAB, mean_pressure=load_of(height), dtype="float32", rtol=1e-4, method=method)
    assert contact.pressure.dtype == contact.gap.dtype == np.float32
    assert np.linalg.norm(contact.pressure - reference.pressure) < 1e-3 * np.linalg.norm(reference.pressure)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("dtype", "rtol"), [("float32", 1e-8), ("float32", 1e-14), ("float64", 1e-17)])
def test_unreachable_tolerance_raises_convergence_error(method: str, dtype: str, rtol: float) -> None:
    height = rough((32, 32))
    with pytest.raises(ConvergenceError, match="residual") as caught:
        solve(height, SLAB, mean_pressure=load_of(height), dtype=dtype, rtol=rtol, method=method)
    error = caught.value
    assert error.residual > error.tolerance == rtol
    assert error.iterations > 0
    assert error.load == pytest.approx(load_of(height), rel=0.1)


# Load paths


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        ("area_fraction", [0.05, 0.07]),
        ("mean_pressure", [2e-4, 0.0, 4e-4]),
        ("force", [3e-4, 1e-4]),
        ("approach", [-4e-3, -1e-3, -5e-4]),
    ],
)
def test_a_path_is_its_contacts_one_by_one(kind: str, values: list[float]) -> None:
    height = rough()
    plural = {"area_fraction": "area_fractions", "approach": "approaches"}.get(kind, f"{kind}s")
    for value, step in zip(values, solve_path(height, SLAB, **{plural: values}), strict=True):
        np.testing.assert_array_equal(step.pressure, solve(height, SLAB, **{kind: value}).pressure)


def test_a_path_of_nothing_or_of_bad_values_is_refused() -> None:
    with pytest.raises(ValueError, match="exactly one of area_fractions"):
        solve_path(rough(), HALF_SPACE)
    path = solve_path(rough(), HALF_SPACE, mean_pressures=[1e-3, "many"])  # type: ignore[list-item]
    assert next(path).area_fraction > 0
    with pytest.raises(TypeError, match=r"mean_pressure = 'many'"):
        next(path)


def test_progress_rises_to_its_end() -> None:
    height = rough()
    seen: list[float] = []
    list(
        solve_path(
            height, SLAB, mean_pressures=[1e-4, 2e-4], progress=lambda done, total: seen.append(done / total)
        )
    )
    assert seen == sorted(seen)
    assert seen[-1] == 1
    assert len(seen) > 4


def test_start_from_the_solution_saves_transforms() -> None:
    height = rough((128, 128))
    cold = solve(height, HALF_SPACE, mean_pressure=load_of(height))
    warm = solve(height, HALF_SPACE, mean_pressure=load_of(height), initial=cold)
    assert warm.certificate.pairs < 0.5 * cold.certificate.pairs


@pytest.mark.parametrize("method", ["active_set", "gfmd"])
def test_tension_in_a_given_start_counts_as_no_pressure(method):
    height = rough((32, 32))
    settings = {"area_fraction": 0.1, "rtol": 1e-4, "method": method}
    cold = solve(height, HALF_SPACE, **settings)
    warm = solve(height, HALF_SPACE, **settings, initial=np.full((32, 32), -1e-3))
    np.testing.assert_allclose(warm.pressure, cold.pressure, atol=1e-3 * cold.max_pressure)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind", ["approach", "mean_pressure", "area_fraction"])
def test_a_huge_start_changes_nothing(kind: str, method: str) -> None:
    height = rough()
    cold = solve(height, HALF_SPACE, mean_pressure=load_of(height))
    start = np.random.default_rng(1).random(height.shape) * 1e6 * cold.max_pressure
    contact = solve(height, HALF_SPACE, **{kind: getattr(cold, kind)}, initial=start, method=method)
    assert contact.mean_pressure == pytest.approx(cold.mean_pressure, rel=1e-2)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("dtype", "fraction"), [("float64", 1.0), ("float64", 0.9996), ("float32", 1.0)])
def test_full_area_is_the_least_load_of_full_contact(method: str, dtype: str, fraction: float) -> None:
    """That load is −min of the pressure of zero mean under which the surface is flat, p̂ = −ĥ E* q / 2."""
    height = 1e-3 * np.random.default_rng(0).normal(size=(32, 32))
    solid, wavenumber = Layer(0.91, 0.3), 2 * np.pi * np.fft.fftfreq(32, 1 / 32)
    q = np.hypot(wavenumber[:, None], wavenumber)
    zero_mean = np.fft.ifft2(-np.fft.fft2(height) * solid.effective_modulus * q / 2).real
    for surface in (height, np.roll(height, 3, axis=1)):
        contact = solve(surface, solid, area_fraction=fraction, method=method, dtype=dtype)
        assert contact.area_fraction == 1
        assert contact.mean_pressure == pytest.approx(-zero_mean.min(), rel=1e-5)


# Bad input

SHAPE = (16, 16)
LOAD = {"mean_pressure": 0.1}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "exactly one of"),
        ({**LOAD, "area_fraction": 0.1}, "exactly one of"),
        ({"area_fraction": 0.0}, "area_fraction = 0.0"),
        ({"mean_pressure": np.nan}, "mean_pressure = nan"),
        ({"mean_pressure": "1"}, "mean_pressure = '1'"),
        ({"force": -1.0}, r"^force = -1.0: 0 or a number from 1e-150 to 1e\+150 is needed"),
        ({"approach": 1.0}, "approach = 1.0: less than the mean height"),
        ({**LOAD, "method": "magic"}, "method = 'magic'"),
        ({**LOAD, "rtol": 0.0}, "rtol = 0.0"),
        ({**LOAD, "threads": 0}, "threads = 0"),
        ({**LOAD, "dtype": "int32"}, "dtype = 'int32'"),
        ({**LOAD, "dtype": None}, "dtype = None"),
        ({**LOAD, "initial": np.zeros((3, 3))}, "initial has the shape"),
        ({**LOAD, "initial": np.full(SHAPE, np.inf)}, "initial: 256 of 256 nodes"),
        ({**LOAD, "length": -1.0}, "length = -1.0"),
        ({**LOAD, "solid": 3}, "solid = 3"),
        ({**LOAD, "height": np.zeros(16)}, "two-dimensional"),
        ({**LOAD, "height": np.zeros(SHAPE, complex)}, "height = array.*real numbers are needed"),
        ({**LOAD, "height": np.diag([np.nan] + 15 * [0.0])}, "1 of 256 nodes are not finite"),
    ],
)
def test_wrong_arguments_are_refused(arguments: dict, message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=message):
        solve(**{"height": np.zeros(SHAPE), "solid": HALF_SPACE, **arguments})


def test_thin_free_sheet_raises_convergence_error() -> None:
    height = asp.self_affine((128, 128), 0.8, 1 / 8, 1 / 16, 1e-3, 1)
    load = 0.05 * asp.roughness_parameters(height).rms_gradient
    thick, thin = (Layer(1.0, 0.33, height=part, bottom="free") for part in (0.3, 0.03))
    assert solve(height, thick, mean_pressure=load).certificate.pairs < 30
    with pytest.raises(ConvergenceError, match="stopped"):
        solve(height, thin, mean_pressure=load)


# Force and two bodies

STEEL, BRONZE = Layer(210e9, 0.3), Layer(110e9, 0.34)
COATING = Layer(3e9, 0.4, height=0.02)


@pytest.mark.parametrize("method", METHODS)
def test_a_force_is_the_mean_pressure_times_the_area_of_the_cell(method: str) -> None:
    height, length = 1e-3 * rough((48, 64)), (1.5e-3, 2e-3)
    by_force = solve(height, STEEL, length, force=40.0, method=method)
    by_pressure = solve(height, STEEL, length, mean_pressure=40.0 / 3e-6, method=method)
    assert by_force.force == pytest.approx(40.0, rel=1e-6)
    np.testing.assert_allclose(by_force.pressure, by_pressure.pressure, rtol=1e-9)


@pytest.mark.parametrize(
    ("pair", "control"),
    [
        ((STEEL, BRONZE), "mean_pressure"),
        ((STEEL, COATING), "area_fraction"),
        ((COATING, Layer(5e9, 0.2, 0.1)), "approach"),
    ],
)
def test_swapping_the_bodies_changes_nothing(pair: tuple[Layer, Layer], control: str) -> None:
    """The sum of two numbers has the same bits in both orders."""
    height = rough()
    value = {"mean_pressure": 1e7, "area_fraction": 0.1, "approach": 0.5 * float(height.min())}[control]
    one, other = (solve(height, asp.TwoBodies(*bodies), **{control: value}) for bodies in (pair, pair[::-1]))
    np.testing.assert_array_equal(one.pressure, other.pressure)
    assert one.approach == other.approach


def test_a_body_that_hardly_yields_acts_like_a_rigid_indenter() -> None:
    """The compliance of the pair exceeds that of the layer by at most 1e-9 of it."""
    height = rough()
    pair = solve(height, asp.TwoBodies(SLAB, Layer(1e10, 0.3)), mean_pressure=load_of(height), rtol=1e-9)
    alone = solve(height, SLAB, mean_pressure=load_of(height), rtol=1e-9)
    assert largest_difference(pair, alone) < 1e-6


def test_each_body_carries_the_common_pressure() -> None:
    height = rough()
    contact = solve(height, asp.TwoBodies(STEEL, COATING), mean_pressure=1e7)
    for name, layer in (("lower", STEEL), ("upper", COATING)):
        body = contact.in_body(name)
        assert body.layer is layer
        assert body.grid is contact.grid
        assert body.pressure is contact.pressure
        plane = next(iter(asp.stress_planes(body, [0.0])))
        assert plane.fields["von_mises"].max() > 0
    with pytest.raises(AttributeError, match=r"^layer: this contact has two bodies"):
        _ = contact.layer
    with pytest.raises(ValueError, match=r"^body = 'left': 'lower' or 'upper' is needed"):
        contact.in_body("left")
    alone = solve(height, SLAB, mean_pressure=load_of(height))
    assert alone.in_body("lower").layer is alone.layer is SLAB
    with pytest.raises(
        ValueError, match=r"^body = 'upper': 'lower', because the indenter is rigid, is needed"
    ):
        alone.in_body("upper")


def test_summary_of_a_contact_is_one_line() -> None:
    contact = solve(rough(), SLAB, mean_pressure=1e-4)
    assert repr(contact).startswith("<Contact of 64 × 64 nodes: area fraction 0.")
    assert contact.mean_contact_pressure == pytest.approx(contact.pressure[contact.pressure > 0].mean())
