"""Laws of mechanics and limits that the layer obeys, independent of its formulas."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asperity.elasticity.layer import Layer

ratios = st.one_of(st.floats(-0.95, 0.5), st.just(0.5))
heights = st.one_of(st.none(), st.floats(-3, 2).map(lambda exponent: 10.0**exponent))
supports = st.sampled_from(["bonded", "frictionless"])
solids = st.builds(Layer, st.floats(0.1, 10), ratios, heights, supports)


@given(ratios, supports, st.floats(0, 0.5))
def test_tall_layer_is_the_half_space(poisson, bottom, depth):
    """Up to e^(−60) and rounding."""
    tall, half_space = Layer(1.0, poisson, 60.0, bottom), Layer(1.0, poisson)
    np.testing.assert_allclose(tall.stress(1.0, 0.4, depth), half_space.stress(1.0, 0.4, depth), atol=4e-15)
    assert tall.surface_compliance(1.0) == pytest.approx(half_space.surface_compliance(1.0), rel=4e-15)


def test_long_waves_bend_a_free_layer():
    """G → 12 (1 − ν²)/(E q⁴ height³), the bending compliance of a plate."""
    bending = 12 * (1 - 0.3**2) / (2.0 * 1e-16 * 0.5**3)
    assert Layer(2.0, 0.3, 0.5, "free").surface_compliance(1e-4) == pytest.approx(bending, rel=1e-7)


@given(solids, st.floats(-4, 4))
def test_kernels_stay_below_their_envelope(layer, exponent):
    """The bound used to drop modes at a depth: (1 + d) e^(−d), twice that in a layer."""
    reach = layer.height or 1.0
    depth = np.linspace(0, reach, 41)
    decay = 10.0**exponent / reach * depth
    limit = (1.0 if layer.height is None else 2.0) * (1 + 1e-13) * (1 + decay) * np.exp(-decay) + 1e-290
    for number, kernel in enumerate(layer.kernels(10.0**exponent / reach, depth)):
        assert np.all(np.abs(kernel) <= limit * (1 if number < 3 else 2 * (1 - layer.poisson)))
