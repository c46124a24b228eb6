"""Laws of mechanics and limits that the layer obeys, independent of its formulas."""

from dataclasses import replace

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
    """G → 12 (1 − ν²)/(E q⁴ height³), the bending compliance of a plate, on both faces."""
    bending = 12 * (1 - 0.3**2) / (2.0 * 1e-16 * 0.5**3)
    layer = Layer(2.0, 0.3, 0.5, "free")
    assert layer.surface_compliance(1e-4) == pytest.approx(bending, rel=1e-7)
    tensor = layer.green_tensor(1e-4, 0.0)
    np.testing.assert_allclose(tensor[[2, 2, 5, 5], [2, 5, 2, 5]], bending, rtol=1e-7)


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
    """The bound used to drop modes at a depth: (1 + d) e^(−d), twice that in a layer."""
    reach = layer.height or 1.0
    depth = np.linspace(0, reach, 41)
    decay = 10.0**exponent / reach * depth
    limit = (1.0 if layer.height is None else 2.0) * (1 + 1e-13) * (1 + decay) * np.exp(-decay) + 1e-290
    for number, kernel in enumerate(layer.kernels(10.0**exponent / reach, depth)):
        assert np.all(np.abs(kernel) <= limit * (1 if number < 3 else 2 * (1 - layer.poisson)))
