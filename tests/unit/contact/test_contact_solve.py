"""`solve_contact` and `solve_load_path`: controls, methods, boundaries, starts, extremes, memory, refused
arguments."""

from functools import partial

import numpy as np
import pytest
from samples import load_of, refuses, rough

import asperity as asp
from asperity.contact import solve_contact, solve_load_path
from asperity.core.errors import ConvergenceError

HALF_SPACE = asp.Solid(1 - 0.33**2, 0.33)
SLAB = asp.Solid(1 - 0.33**2, 0.33, height=1.0)
INCOMPRESSIBLE = asp.Solid(0.75, 0.5, height=0.1)
SLIPPING = asp.Solid(0.8, 0.2, 0.3, "frictionless")
STEEL, COATING = asp.Solid(210e9, 0.3), asp.Solid(3e9, 0.4, height=0.05)
METHODS = ("active_set", "gfmd")


@pytest.mark.parametrize(
    ("solid", "boundary"),
    [
        (HALF_SPACE, "free"),
        (asp.TwoBodies(HALF_SPACE, asp.Solid(3.0, 0.2)), "free along x"),
        *((s, "periodic") for s in (HALF_SPACE, SLAB, INCOMPRESSIBLE, SLIPPING)),
    ],
)
def test_controls_and_methods_agree(solid, boundary):
    """The tolerances are solver errors."""
    height, truth = rough(), None
    for method in METHODS if boundary == "periodic" else METHODS[:1]:
        settings = {"method": method, "boundary": boundary, "rtol": 1e-9}
        by_load = solve_contact(height, solid, mean_pressure=load_of(height), **settings)
        truth = truth or by_load
        by_approach = solve_contact(height, solid, approach=truth.approach, **settings)
        by_area = solve_contact(height, solid, contact_area_fraction=truth.contact_area_fraction, **settings)
        assert by_load.approach == pytest.approx(truth.approach, abs=1e-7 * height.std())
        for contact in (by_load, by_approach):
            contact.certificate.check(1e-7)
            assert np.abs(contact.pressure - truth.pressure).max() < 1e-6 * truth.maximum_pressure
        assert np.count_nonzero(by_area.pressure) == np.count_nonzero(truth.pressure)
        # On this grid the area changes by one node per few thousandths of the load.
        assert by_area.mean_pressure == pytest.approx(truth.mean_pressure, rel=0.02)


def mirrored():
    half = rough() + rough()[::-1]
    return half + half[:, ::-1]


@pytest.mark.parametrize(
    ("height", "together", "fraction", "rtol"),
    [
        (rough((128, 128)), 1, 0.003, 1e-6),
        (rough((128, 128)), 1, 0.8, 1e-6),
        (mirrored(), 4, 0.01, 1e-6),
        (mirrored(), 4, 0.3, 1e-9),
        (mirrored(), 4, 0.9, 1e-6),
        (np.tile(1e-3 * np.cos(2 * np.pi * np.arange(64) / 64), (64, 1)), 64, 0.3, 1e-6),
    ],
)
def test_nearest_possible_area_is_met(height, together, fraction, rtol):
    """On symmetric surfaces several nodes touch together."""
    contact = solve_contact(height, HALF_SPACE, contact_area_fraction=fraction, rtol=rtol)
    count, wanted = np.count_nonzero(contact.pressure), round(fraction * height.size)
    assert count % together == 0
    assert abs(count - wanted) <= max(together / 2, 1e-4 * wanted)
    contact.certificate.check(100 * rtol)


@pytest.mark.parametrize("method", METHODS)
def test_fields_of_the_solution_are_consistent(method):
    """The tolerances are rounding errors."""
    height = rough()
    contact = solve_contact(height, SLAB, mean_pressure=load_of(height), method=method)
    np.testing.assert_allclose(contact.gap, height + contact.displacement - contact.approach, atol=1e-15)
    assert contact.contact_area_fraction == np.count_nonzero(contact.pressure) / height.size
    assert contact.mean_pressure == pytest.approx(load_of(height), rel=1e-6)
    assert contact.mean_contact_pressure == pytest.approx(contact.pressure[contact.pressure > 0].mean())
    assert 0 < contact.gradient_rms_contact < 2 * asp.roughness_parameters(height).rms_gradient
    assert min(contact.certificate.pairs, contact.certificate.iterations) > 0
    assert repr(contact).startswith("<Contact of 64 × 64 nodes: contact area fraction 0.")
    written = contact.to_dataset().attrs
    assert written["certificate_pairs"] == contact.certificate.pairs
    assert "certificate_seconds" not in written  # files are the same in every run


@pytest.mark.parametrize(
    ("solid", "boundary", "mirrored"),
    [(SLAB, "periodic", False), (HALF_SPACE, "free", False), (HALF_SPACE, "periodic", True)],
)
def test_threads_change_no_bit(solid, boundary, mirrored):
    height = rough((256, 130))
    settings = {"mean_pressure": load_of(height), "boundary": boundary}
    grid = asp.Grid(height.shape, mirrored=mirrored)
    first, *others = (solve_contact(height, solid, grid, **settings, threads=n) for n in (1, 1, 2))
    for again in others:
        for name in ("pressure", "displacement", "gap"):
            np.testing.assert_array_equal(getattr(again, name), getattr(first, name))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("dtype", "rtol"), [("float32", 1e-8), ("float64", 1e-17)])
def test_unreachable_tolerance_raises_convergence_error(method, dtype, rtol):
    height = rough((32, 32))
    with pytest.raises(ConvergenceError, match="residual") as caught:
        solve_contact(height, SLAB, mean_pressure=load_of(height), dtype=dtype, rtol=rtol, method=method)
    error = caught.value
    assert error.residual > error.tolerance == rtol
    assert error.iterations > 0
    assert error.load == pytest.approx(load_of(height), rel=0.1)


def test_exact_steps_solve_a_sheet_with_plateaus():
    """In 730 pairs of transforms; steps to the least energy take 10,900."""
    plateaus = np.maximum(asp.self_affine((64, 64), 0.8, 0.4, 0.1, 1e-2, seed=1), 0)
    sheet = asp.Solid(1.0, 0.3, height=0.03, bottom="free")
    certificate = solve_contact(plateaus, sheet, mean_pressure=1e-3).certificate
    assert certificate.pairs < 2000
    certificate.check(1e-3)


# Extremes


@pytest.mark.parametrize("method", METHODS)
def test_full_contact_is_flat(method):
    """Exact solution: û = −ĥ for every mode but the uniform one."""
    height = rough()
    contact = solve_contact(height, HALF_SPACE, mean_pressure=2.0, method=method, rtol=1e-12)
    assert contact.contact_area_fraction == 1
    assert np.abs(contact.displacement + height - contact.approach).max() < 1e-8 * height.std()
    contact.certificate.check(1e-7)
    for solid in (HALF_SPACE, SLAB, INCOMPRESSIBLE):
        flat = solve_contact(np.zeros((16, 16)), solid, mean_pressure=0.01, method=method)
        np.testing.assert_allclose(flat.pressure, 0.01, rtol=1e-6)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("dtype", "fraction"), [("float64", 1.0), ("float64", 0.9996), ("float32", 1.0)])
def test_full_area_is_least_load_of_full_contact(method, dtype, fraction):
    """That load is −min of the pressure of zero mean under which the surface is flat, p̂ = −ĥ E* q / 2."""
    height = 1e-3 * np.random.default_rng(0).normal(size=(32, 32))
    wavenumber = 2 * np.pi * np.fft.fftfreq(32, 1 / 32)
    q = np.hypot(wavenumber[:, None], wavenumber)
    zero_mean = np.fft.ifft2(-np.fft.fft2(height) * HALF_SPACE.effective_modulus * q / 2).real
    contact = solve_contact(height, HALF_SPACE, contact_area_fraction=fraction, method=method, dtype=dtype)
    assert contact.contact_area_fraction == 1
    assert contact.mean_pressure == pytest.approx(-zero_mean.min(), rel=1e-5)


@pytest.mark.parametrize(
    ("solid", "boundary"), [(HALF_SPACE, "periodic"), (SLAB, "periodic"), (HALF_SPACE, "free")]
)
def test_first_contact_and_lift_off(solid, boundary):
    height = rough()
    touching = solve_contact(height, solid, mean_pressure=0.0, boundary=boundary)
    apart = solve_contact(height, solid, approach=height.min() - 1e-3, boundary=boundary)
    assert touching.approach == height.min()
    assert apart.gap.min() == pytest.approx(1e-3, rel=1e-12)
    apart.certificate.check(0.0)
    for contact in (touching, apart):
        assert not contact.pressure.any()
        assert contact.contact_area_fraction == 0
        assert np.isnan(contact.gradient_rms_contact)


# Load paths and starts


@pytest.mark.parametrize(
    ("kind", "values", "settings"),
    [
        ("contact_area_fractions", [0.05, 0.07], {}),
        ("mean_pressures", [2e-4, 0.0, 4e-4], {}),
        ("forces", [3e-4, 1e-4], {"boundary": "free"}),
        ("approaches", [-4e-3, -1e-3, -5e-4], {}),
    ],
)
def test_path_is_its_contacts_one_by_one(kind, values, settings):
    height, shares = rough(), []
    reported = {"progress": lambda done, total: shares.append(done / total)}
    steps = solve_load_path(height, HALF_SPACE, **{kind: values}, **settings, **reported)
    assert not shares  # a contact is solved when it is asked for
    kind = "approach" if kind == "approaches" else kind[:-1]
    for value, step in zip(values, steps, strict=True):
        alone = solve_contact(height, HALF_SPACE, **{kind: value}, **settings)
        np.testing.assert_array_equal(step.pressure, alone.pressure)
    assert shares == sorted(shares)
    assert shares[-1] == 1
    assert len(shares) > 2 * len(values)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind", ["approach", "mean_pressure", "contact_area_fraction"])
@pytest.mark.parametrize("scale", [1e6, -1.0])
def test_huge_start_and_tension_change_nothing(scale, kind, method):
    height = rough()
    cold = solve_contact(height, HALF_SPACE, mean_pressure=load_of(height))
    start = np.random.default_rng(1).random(height.shape) * scale * cold.maximum_pressure
    contact = solve_contact(height, HALF_SPACE, **{kind: getattr(cold, kind)}, initial=start, method=method)
    assert contact.mean_pressure == pytest.approx(cold.mean_pressure, rel=1e-2)


# Two bodies


def test_each_body_carries_the_common_pressure():
    contact = solve_contact(rough(), asp.TwoBodies(STEEL, COATING), 1.0, mean_pressure=1e7)
    for name, layer in (("lower", STEEL), ("upper", COATING)):
        body = contact.in_body(name)
        assert body.layer is layer
        assert body.grid is contact.grid
        assert body.pressure is contact.pressure
    with pytest.raises(AttributeError, match=r"^layer: this contact has two bodies"):
        _ = contact.layer
    alone = pressed(solid=SLAB)
    assert alone.in_body("lower").layer is alone.layer is SLAB


SHAPE = (16, 16)
FLAT, PAIR = np.zeros(SHAPE), asp.TwoBodies(HALF_SPACE, SLAB)
NOISE = np.random.default_rng(0).standard_normal(SHAPE)


def pressed(height=FLAT, solid=HALF_SPACE, **settings):
    return solve_contact(height, solid, **{"mean_pressure": 0.1} | settings)


def covering(height, contact_area_fraction=0.1, **settings):
    return solve_contact(height, HALF_SPACE, contact_area_fraction=contact_area_fraction, **settings)


under, path = partial(solve_contact, FLAT, HALF_SPACE), partial(solve_load_path, FLAT, HALF_SPACE)

test_wrong_argument_is_refused = refuses(
    (lambda: under(), "exactly one of"),
    (lambda: covering(FLAT, 0.0), "contact_area_fraction = 0.0"),
    (lambda: under(force=-1.0), r"force = -1.0: 0 or a number from 1e-150 to 1e\+150 is n"),
    (lambda: under(approach=1.0), "approach = 1.0: less than 0, the mean height, is needed"),
    (lambda: pressed(method="magic"), "method = 'magic'"),
    (lambda: pressed(rtol=0.0), "rtol = 0.0"),
    (lambda: pressed(threads=0), "threads = 0"),
    (lambda: pressed(dtype="int32"), "dtype = 'int32'"),
    (lambda: pressed(initial=np.zeros((3, 3))), "initial has the shape"),
    (lambda: pressed(solid=3), "solid = 3"),
    (lambda: pressed(np.zeros(16)), ".*two-dimensional"),
    (lambda: pressed(np.diag([np.nan] + 15 * [0.0])), ".*1 of 256 nodes are not finite"),
    (
        lambda: pressed(boundary="open"),
        "boundary = 'open': one of periodic, free, free along y, free along x is",
    ),
    (lambda: pressed(FLAT, SLAB, boundary="free"), "boundary = 'free': half-spaces are .* of height 1"),
    (  # in units of the heights it would be another number
        lambda: asp.solve_contact(
            1e-7 * np.eye(8), asp.Solid(2e11, 0.3, height=1e-5), 1e-4, mean_pressure=1e6, boundary="free"
        ),
        "boundary = 'free': half-spaces are .* of height 1e-05, under",
    ),
    (lambda: pressed(method="gfmd", boundary="free"), "method = 'gfmd': active_set is needed for boundary ="),
    (lambda: covering(1e-60 * NOISE, dtype="float32"), "dtype = 'float32': cannot hold heights of .*float64"),
    (
        lambda: solve_contact(NOISE[:3], HALF_SPACE, (1e-6, 1.0), contact_area_fraction=0.1),
        r"length = .*: spacings .* by a factor of at most 300 are needed in a periodic cell, and here by 1",
    ),
    (lambda: pressed(hardness=0.1), "hardness = 0.1: more than the mean pressure 0.1"),
    (lambda: pressed(hardness=1.0, method="gfmd"), ".*active_set is needed"),
    (lambda: covering(NOISE, 1.0, hardness=1e-3), "contact_area_fraction = 1: less is needed"),
    (lambda: pressed(solid=PAIR).in_body("left"), "body = 'left': 'lower' or 'upper' is needed"),
    (lambda: pressed().in_body("upper"), "body = 'upper': 'lower', because the indenter is rigid, is needed"),
    # before the first of the loads is solved
    (lambda: path(mean_pressures=[1e-3, np.nan]), "mean_pressure = nan"),
    (lambda: path(mean_pressures=1e-3), "mean_pressures = 0.001: a list of loads"),
    (lambda: path(forces=[1], hardnes=1), "hardnes: not an argument of solve_load_path; did"),
    (lambda: pressed(hardness=-np.inf), "hardness = -inf: a number > 0, .* or inf for an elastic contact"),
    (
        lambda: path(mean_pressures=[1e-3, 2e-3, 1e-3], hardness=0.1),
        "mean_pressures = .*: rising values are needed with a hardness",
    ),
)


def test_infinite_hardness_is_elastic_contact():
    elastic = covering(NOISE)
    again = covering(NOISE, hardness=elastic.hardness)
    np.testing.assert_array_equal(again.pressure, elastic.pressure)
    assert again.plastic_depth is None
