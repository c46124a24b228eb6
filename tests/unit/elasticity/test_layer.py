"""Solid and two bodies: precision, mean (q = 0) mode, ends of the range, laws of mechanics, refused input."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from project import ROOT
from samples import refuses

from asperity.elasticity.solid import Solid, simplest_solid
from asperity.elasticity.two_bodies import TwoBodies, sliding_coupling
from asperity.reference.state_space import StateSpace

SUPPORTED = [Solid(1.3, 0.3), Solid(1.3, 0.3, 0.4), Solid(1.3, 0.3, 0.4, "frictionless")]
SUPPORTED.append(Solid(1.3, 0.3, 0.2, base=SUPPORTED[0]))


@pytest.mark.parametrize("layer", SUPPORTED)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_fields_broadcast_and_keep_their_precision(layer, dtype):
    """Kernels in single precision equal the kernels in double precision, rounded."""
    q = np.linspace(0, 5, 4, dtype=dtype)[:, None]
    depth = np.linspace(0, 0.375, 3, dtype=dtype)
    complex_type = np.result_type(dtype, np.complex64)
    for values, shape, kind in (
        (layer.surface_compliance(q), (4, 1), dtype),
        (layer.stress(q, q, depth), (4, 3, 6), complex_type),
        (layer.displacement(q, q, depth), (4, 3, 3), complex_type),
    ):
        assert (values.shape, values.dtype) == (shape, kind)
    double = layer.kernels(q.astype(float), depth.astype(float))
    for kernel, row, exact in zip(layer.kernels(q, depth), layer.kernels(q[2], depth), double, strict=True):
        np.testing.assert_array_equal(kernel, exact.astype(dtype), strict=True)
        np.testing.assert_array_equal(kernel[2], row)


@pytest.mark.parametrize("lateral", ["confined", "free"])
@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
def test_mean_mode_obeys_hooke(lateral, bottom):
    layer = Solid(2.0, 0.3, 0.5, bottom, lateral)
    xx, yy, zz, *shear = layer.uniform_stress()
    assert (zz, *shear) == (-1, 0, 0, 0)
    assert xx == yy == (pytest.approx(-0.3 / 0.7) if lateral == "confined" else 0)
    modulus = 2.0 * 0.7 / (1.3 * 0.4) if lateral == "confined" else 2.0
    assert layer.surface_compliance(0.0) == pytest.approx(0.5 / modulus)
    np.testing.assert_array_equal(layer.stress(0.0, 0.0, [0.0, 0.2])[1], layer.uniform_stress())
    displacement = layer.displacement(0.0, 0.0, [0.0, 0.2, 0.5])
    np.testing.assert_allclose(displacement[:, 2], -np.array([0.5, 0.3, 0.0]) / modulus)
    np.testing.assert_array_equal(displacement[:, :2], 0)
    assert [float(kernel) for kernel in layer.kernels(0.0, 0.3)] == [1, 0, 0, 0, 0]


def test_mean_displacement_without_a_support_is_zero():
    """Also of an incompressible layer, which cannot be compressed."""
    half_space = Solid(1.0, 0.3)
    for layer in (half_space, Solid(1.0, 0.3, 1.0, "free")):
        assert layer.uniform_compliance() == layer.surface_compliance(0.0) == 0
    assert np.all(half_space.displacement(0.0, 0.0, [0.0, 3.0]) == 0)
    assert np.all(half_space.stress(0.0, 0.0, 3.0)[:2] == -0.3 / 0.7)
    assert Solid(1.0, 0.5, 1.0).surface_compliance(0.0) == 0


def test_supported_bottoms_do_not_move():
    """The depth of the bottom may be rounded to single precision."""
    q = np.geomspace(1e-8, 1e3, 40)
    for height, depth in ((0.7, 0.7), (0.1, np.float32(0.1))):
        np.testing.assert_array_equal(Solid(1.0, 0.3, height).displacement(q, q, depth), 0)
    slides = Solid(1.0, 0.3, 0.7, "frictionless")
    np.testing.assert_array_equal(slides.displacement(q, q, 0.7)[:, 2], 0)
    np.testing.assert_array_equal(slides.stress(q, q, 0.7)[:, 3:5], 0)
    with pytest.raises(ValueError, match="depth"):
        Solid(1.0, 0.3, 0.1).displacement(2.0, 1.0, float(np.float32(0.1)))


EXTREMES = (1e-75, 1e-40, 1.0, 1e40, 1e75)


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
@pytest.mark.parametrize("poisson", [-1 + 2**-53, 0.3, 0.5])
@pytest.mark.parametrize("height", [*EXTREMES, None])
def test_every_accepted_value_gives_finite_numbers(height, poisson, bottom):
    q = np.array([0.0, *EXTREMES, *np.geomspace(1e-12, 1e9, 60)])
    depth = np.array([0.0, 1e-9, 0.3, 0.9, 1 - 1e-15, 1.0])[:, None] * (height or 1.0)
    for young in EXTREMES:
        layer = Solid(young, poisson, height, bottom)
        fields = layer.stress(q, 0.0, depth), layer.displacement(q, 0.0, depth)
        for values in (*layer.kernels(q, depth), *fields, layer.surface_compliance(q)):
            assert np.isfinite(values).all()


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
@pytest.mark.parametrize("poisson", [-0.95, 0.33, 0.5])
def test_no_mode_differs_by_more(bottom, poisson):
    """On finer samples and in all directions; 1 %: the samples miss the largest value by that."""
    q, half_space = np.geomspace(1.0, 30.0, 60), Solid(1.0, poisson)
    for reach in (2.0, 2 * np.pi, 12.0):
        layer = Solid(1.0, poisson, reach, bottom)
        chosen = simplest_solid(layer, q_min=1.0, tolerance=0.0)
        assert chosen.layer is layer
        depth = np.linspace(0, reach, 201)[:, None, None]
        angle = np.array([0.0, 0.3, np.pi / 4])[:, None]
        direction = q * np.cos(angle), q * np.sin(angle)
        stress = np.abs(layer.stress(*direction, depth) - half_space.stress(*direction, depth)).max()
        compliance = np.abs(layer.surface_compliance(q) / half_space.surface_compliance(q) - 1).max()
        assert chosen.difference == pytest.approx(max(stress, compliance), rel=0.01)


def test_half_space_is_chosen_within_the_tolerance():
    layer = Solid(1.0, 0.33, 1.0, lateral="free")
    chosen, kept = (simplest_solid(layer, 2 * np.pi, tolerance) for tolerance in (0.05, 1e-3))
    assert chosen.layer == Solid(1.0, 0.33, None, lateral="free")
    assert "half-space" in chosen.reason
    assert kept.layer is layer
    assert kept.difference == chosen.difference > 1e-3
    assert "layer" in kept.reason
    half_space, sheet = Solid(1.0, 0.33), Solid(1.0, 0.33, 100.0, "free")
    assert simplest_solid(half_space, 1.0, 0.0).layer is half_space
    assert simplest_solid(half_space, 1.0, 0.0).difference == 0
    assert simplest_solid(sheet, 1.0, 0.5).layer is sheet


SLAB = Solid(1.0, 0.3, 0.4)
FREE = replace(SLAB, bottom="free")


test_wrong_argument_is_refused = refuses(
    (lambda: Solid(1.0, 0.5 + 1e-12), "poisson = .* > -1 and ≤ 0.5"),
    (lambda: Solid(0, 0.3), "young = 0: .* > 0"),
    (lambda: Solid(1.0, 0.3, np.inf), "height = inf: .* > 0, .* or None for the half-space"),
    (lambda: Solid(1.0, 0.3, bottom="glued"), "bottom = 'glued': one of bonded, frictionless, free"),
    (lambda: Solid(1.0, 0.3, lateral="loose"), "lateral = 'loose': one of confined, free"),
    (lambda: SLAB.surface_compliance(-1.0), "q = -1.0: wavenumbers of 0 or from 1e-75 to 1e"),
    (lambda: SLAB.kernels(1.0, -0.1), "depth = .*-0.1.*from 0 to 0.4"),
    (lambda: SLAB.kernels(np.ones(3), np.zeros(2)), r"shapes q \(3,\), depth \(2,\)"),
    (lambda: SLAB.displacement(1.0, np.inf, 0.0), "qy = .*inf"),
    (lambda: SLAB.green_tensor(1.0, np.nan), "qy = .*nan: finite numbers are needed"),
    (lambda: replace(SLAB, height=1e-75).green_tensor(1e-60, 0.0), "green_tensor: too large for complex128"),
    (lambda: SLAB.kernels(np.ma.masked_less([1.0, 2.0], 1.5), 0.0), "q: an array without masked"),
    (lambda: FREE.kernels(1.0, 0.1), "bottom = 'free'"),
    (lambda: FREE.shear_kernels(1.0, 0.1), "bottom = 'free': bonded is needed"),
    (lambda: replace(FREE, height=1e-40).surface_compliance(1e-75), ".*too large for float64"),
    (lambda: Solid(1e-40, 0.3, 1.0).displacement(*np.ones(2, np.float32), 0.0), ".*too large for"),
    (lambda: simplest_solid(SLAB, 0.0, 0.1), "q_min = 0.0: a number > 0"),
    (lambda: TwoBodies(SLAB, None), "^upper = None: a Solid is needed"),
)


STEEL, BRONZE, COATING = Solid(210e9, 0.3), Solid(110e9, 0.34), Solid(3e9, 0.4, height=0.1)


def test_two_half_spaces_are_one():
    """The effective modulus is Hertz's."""
    both, q = TwoBodies(STEEL, BRONZE), np.array([1.0, 1e3, 1e6])
    expected = 1 / ((1 - 0.3**2) / 210e9 + (1 - 0.34**2) / 110e9)
    assert both.effective_modulus == pytest.approx(expected, rel=1e-14)
    np.testing.assert_allclose(both.surface_compliance(q), 2 / (both.effective_modulus * q), rtol=1e-14)
    assert both.uniform_compliance() == 0
    assert both.height is None


def test_layers_add_their_compliances():
    both, q = TwoBodies(COATING, STEEL), np.array([0.0, 1.0, 30.0])
    parts = [layer.surface_compliance(q) for layer in (COATING, STEEL)]
    np.testing.assert_array_equal(both.surface_compliance(q), parts[0] + parts[1])
    assert both.uniform_compliance() == COATING.uniform_compliance()
    assert both.height == 0.1


@pytest.mark.parametrize("poisson", [-0.3, 0.3, 0.5])
@pytest.mark.parametrize("height", [0.2, 1.0, 4.0])
def test_sliding_displaces_a_layer_as_state_space(height, poisson):
    mode = StateSpace(1, 0, 2.0, poisson, height, digits=30)
    by_traction, by_pressure = (abs(mode.state(0, mode.solve(top))[2]) for top in ([1, 0, 0], [0, 0, -1]))
    found = sliding_coupling(Solid(2.0, poisson, height), 1.0)
    assert found == pytest.approx(float(by_traction / by_pressure), rel=1e-12)


def test_sliding_couples_half_spaces_by_dundurs_constant():
    shear = [body.young / (2 * (1 + body.poisson)) for body in (STEEL, BRONZE)]
    beta = 0.5 * ((1 - 0.6) / shear[0] - (1 - 0.68) / shear[1]) / (0.7 / shear[0] + 0.66 / shear[1])
    found = sliding_coupling(TwoBodies(STEEL, BRONZE), [1.0, 1e6])
    np.testing.assert_allclose(found, abs(beta), rtol=1e-13)
    assert sliding_coupling(TwoBodies(COATING, COATING), 3.0) == 0


def test_sliding_coupling_of_a_bonded_layer_is_that_of_the_page():
    """`docs/stress.md`, over waves from 0.06 to 6000 heights."""
    page = " ".join((ROOT / "docs/stress.md").read_text("utf-8").split())
    numbers = re.search(r"at most ([\d.]+) at ν = ([\d.]+) and ([\d.]+) at ν = ([\d.]+)\.", page)
    first, at_first, second, at_second = map(float, numbers.groups())
    q = np.logspace(-3, 2, 2001)
    largest = {nu: sliding_coupling(Solid(1.0, nu, 1.0), q).max() for nu in (at_first, at_second)}
    assert largest == {at_first: pytest.approx(first, abs=0.005), at_second: pytest.approx(second, abs=0.005)}


ratios = st.one_of(st.floats(-0.95, 0.5), st.just(0.5))
heights = st.one_of(st.none(), st.floats(-3, 2).map(lambda exponent: 10.0**exponent))
supports = st.sampled_from(["bonded", "frictionless"])
solids = st.builds(Solid, st.floats(0.1, 10), ratios, heights, supports)


@given(solids, st.floats(-3, 3), st.floats(0, 6.3))
def test_green_tensor_is_hermitian_positive_and_symmetric(layer, exponent, angle):
    """And equal under a reflection of z, which exchanges the faces."""
    q = 10.0**exponent / (layer.height or 1.0)
    tensor = layer.green_tensor(q * np.cos(angle), q * np.sin(angle))
    scale = np.sqrt(np.diag(tensor).real)
    scaled = tensor / np.outer(scale, scale)
    np.testing.assert_array_equal(tensor, tensor.conj().T)
    assert np.linalg.eigvalsh(scaled).min() > -1e-15
    signs = np.array([1, 1, -1, 1, 1, -1])
    np.testing.assert_array_equal(tensor, np.outer(signs, signs) * np.roll(tensor, (3, 3), axis=(0, 1)))
    pulled = replace(layer, bottom="free").surface_compliance(np.hypot(q * np.cos(angle), q * np.sin(angle)))
    assert tensor[2, 2] == pytest.approx(pulled, rel=4e-15)


@given(solids, st.floats(-4, 4))
def test_kernels_stay_below_their_envelope(layer, exponent):
    """The bound used to drop modes at a depth: (1 + d) e^(−d), twice as large in a layer."""
    reach = layer.height or 1.0
    depth = np.linspace(0, reach, 41)
    decay = 10.0**exponent / reach * depth
    limit = (1.0 if layer.height is None else 2.0) * (1 + 1e-13) * (1 + decay) * np.exp(-decay) + 1e-290
    for number, kernel in enumerate(layer.kernels(10.0**exponent / reach, depth)):
        assert np.all(np.abs(kernel) <= limit * (1 if number < 3 else 2 * (1 - layer.poisson)))
