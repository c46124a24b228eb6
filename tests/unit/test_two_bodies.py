"""Two elastic bodies: their compliances add up."""

import numpy as np
import pytest

from asperity.elasticity.layer import Layer
from asperity.elasticity.two_bodies import TwoBodies, sliding_coupling
from asperity.reference.state_space import StateSpace

STEEL, BRONZE, COATING = Layer(210e9, 0.3), Layer(110e9, 0.34), Layer(3e9, 0.4, height=0.1)


def test_two_half_spaces_are_one():
    """The effective modulus is that of Hertz."""
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
    found = sliding_coupling(Layer(2.0, poisson, height), 1.0)
    assert found == pytest.approx(float(by_traction / by_pressure), rel=1e-12)


def test_sliding_couples_half_spaces_by_dundurs_constant():
    shear = [body.young / (2 * (1 + body.poisson)) for body in (STEEL, BRONZE)]
    beta = 0.5 * ((1 - 0.6) / shear[0] - (1 - 0.68) / shear[1]) / (0.7 / shear[0] + 0.66 / shear[1])
    found = sliding_coupling(TwoBodies(STEEL, BRONZE), [1.0, 1e6])
    np.testing.assert_allclose(found, abs(beta), rtol=1e-13)
    assert sliding_coupling(TwoBodies(COATING, COATING), 3.0) == 0
