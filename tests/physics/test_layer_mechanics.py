"""Laws of mechanics and limits that the layer obeys, independent of its formulas."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity.elasticity.layer import Layer

# No deadline, because the first example may compile.
unhurried = settings(deadline=None)

ratios = st.one_of(st.floats(-0.95, 0.5), st.just(0.5))
heights = st.floats(-3, 2).map(lambda exponent: 10.0**exponent)
angles = st.floats(0, 2 * np.pi)
supports = st.sampled_from(["bonded", "frictionless"])


@st.composite
def solids(draw):
    height = draw(st.one_of(st.none(), heights))
    return Layer(draw(st.floats(0.1, 10)), draw(ratios), height, draw(supports))


@unhurried
@given(ratios, supports, st.floats(0, 0.5))
def test_a_tall_layer_is_the_half_space(poisson, bottom, depth):
    tall, half_space = Layer(1.0, poisson, 60.0, bottom), Layer(1.0, poisson)
    # e^(−60) and rounding
    np.testing.assert_allclose(tall.stress(1.0, 0.4, depth), half_space.stress(1.0, 0.4, depth), atol=4e-15)
    assert tall.surface_compliance(1.0) == pytest.approx(half_space.surface_compliance(1.0), rel=4e-15)


def test_long_waves_on_a_bonded_layer_are_uniform_compression():
    """G → height/C11, quadratically in q; at ν = 1/2, G → q² height³/E instead."""
    layer = Layer(2.0, 0.3, 0.5)
    q = np.array([1e-1, 1e-2, 1e-3])
    difference = np.abs(layer.surface_compliance(q) / layer.uniform_compliance() - 1)
    np.testing.assert_allclose(np.diff(np.log10(difference)), -2, atol=0.01)
    stress = layer.stress(1e-7, 0.0, 0.2)
    # Terms of first order in q height.
    np.testing.assert_allclose(stress, layer.uniform_stress(), atol=1e-6)
    rubber = Layer(2.0, 0.5, 0.5)
    assert rubber.surface_compliance(1e-5) == pytest.approx(1e-10 * 0.5**3 / 2.0, rel=1e-8)


def test_long_waves_on_a_frictionless_layer_stretch_it():
    """G → (1 − ν²) height/E: the layer spreads along q but not across; this is not the mean (q = 0) mode."""
    layer = Layer(2.0, 0.3, 0.5, "frictionless")
    assert layer.surface_compliance(1e-6) == pytest.approx((1 - 0.3**2) * 0.5 / 2.0, rel=1e-10)
    assert layer.surface_compliance(1e-6) > 1.1 * layer.surface_compliance(0.0)


def test_long_waves_bend_a_free_layer():
    """G → 12 (1 − ν²)/(E q⁴ height³), the bending compliance of a plate."""
    assert Layer(2.0, 0.3, 0.5, "free").surface_compliance(1e-4) == pytest.approx(
        12 * (1 - 0.3**2) / (2.0 * 1e-16 * 0.5**3), rel=1e-7
    )


@unhurried
@given(solids(), st.floats(-4, 4))
def test_kernels_stay_below_their_envelope(layer, exponent):
    """The bound used to drop modes at a depth: (1 + d) e^(−d), twice that in a layer."""
    reach = layer.height or 1.0
    q = 10.0**exponent / reach
    depth = np.linspace(0, reach, 41)
    envelope = (1 + q * depth) * np.exp(-q * depth)
    limit = (1.0 if layer.height is None else 2.0) * (1 + 1e-13) * envelope + 1e-290
    kernels = layer.kernels(q, depth)
    for kernel in kernels[:3]:
        assert np.all(np.abs(kernel) <= limit)
    for kernel in kernels[3:]:
        assert np.all(np.abs(kernel) <= 2 * (1 - layer.poisson) * limit)
