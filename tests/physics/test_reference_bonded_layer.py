"""Contact with a bonded layer against its boundary conditions, its limits and finer quadrature."""

from functools import cache

import numpy as np
import pytest
import scipy.special

from asperity.reference.bonded_layer import BondedLayer
from asperity.reference.hertz import Hertz
from asperity.reference.state_space import StateSpace


@cache
def compliance_ratio(poisson, scaled):
    """Surface compliance over the half-space's, by the state-space solution of a mode."""
    mode = StateSpace(scaled, 0, 1 - poisson**2, poisson, 1, digits=30)
    return float(-mode.displacement(0)[2].real * scaled / 2)


@pytest.mark.parametrize("poisson", [-0.5, 0.3, 0.5])
def test_compliance_is_that_of_state_space(poisson):
    layer = BondedLayer(0.7, poisson)
    for scaled in (1e-3, 0.2, 1.0, 3.0, 20.0):
        # Rounding, relative to the half-space.
        assert layer.compliance_ratio(scaled) == pytest.approx(compliance_ratio(poisson, scaled), abs=1e-15)
    assert np.all(np.isfinite(layer.compliance_ratio([1e-8, 1e3])))


@pytest.mark.parametrize(("ratio", "poisson"), [(0.5, 0.3), (2.0, 0.5)])
def test_surface_inside_the_contact_follows_the_paraboloid(ratio, poisson):
    """A half-space is displaced by ``4/(π E*) ∫ p(s) s K(m)/(r + s) ds``, m = 4rs/(r + s)².

    The layer is displaced less, by ``2/E* ∫ (1 − K) P J0 dξ``.
    """
    height = 0.8
    contact = BondedLayer(height, poisson, effective_modulus=1.7).paraboloid(ratio * height, 50.0)
    radius = contact.contact_radius
    node, weight = np.polynomial.legendre.leggauss(60)
    scaled, s = 10 * (node + 1), 0.5 * radius * (node + 1)
    missing = np.array([1 - compliance_ratio(poisson, u) for u in scaled]) / height
    transform = np.cos(np.outer(scaled / height, s)) @ (0.5 * radius * weight * contact.density(s))

    for r in (0.2 * radius, 0.7 * radius):
        half_space = 0.0
        # s = low + (high − low) v³ (10 − 15 v + 6 v²) is flat at the ends, where the integrand is singular.
        for low, high in ((0.0, r), (r, radius)):
            v = 0.5 * (node + 1)
            s = low + (high - low) * v**3 * (10 - 15 * v + 6 * v**2)
            step = 0.5 * weight * (high - low) * 30 * v**2 * (1 - v) ** 2
            kernel = scipy.special.ellipkm1(((r - s) / (r + s)) ** 2) / (r + s)
            half_space += 4 / (np.pi * 1.7) * np.sum(step * contact.pressure(s) * s * kernel)
        bessel = scipy.special.j0(scaled / height * r)
        found = half_space - 2 / 1.7 * np.sum(10 * weight * missing * transform * bessel)
        # Quadrature over the pressure.
        assert found == pytest.approx(contact.approach - r**2 / 100, rel=1e-7)


def test_thick_layer_is_a_half_space():
    layer = BondedLayer(1e4, 0.3, effective_modulus=1.7)
    contact, hertz = layer.paraboloid(0.3, 2.0), Hertz(0.3, 2.0, 1.7)
    assert contact.load == pytest.approx(hertz.load, rel=1e-10)
    assert contact.approach == pytest.approx(hertz.approach, rel=1e-4)
    r = np.array([0.0, 0.1, 0.29, 0.3, 0.4])
    np.testing.assert_allclose(contact.pressure(r), hertz.pressure(r), atol=1e-10)
    punch = layer.flat_punch(0.3, 0.01)
    assert punch.load == pytest.approx(2 * 1.7 * 0.3 * 0.01, rel=1e-4)
    boussinesq = 1.7 * 0.01 / (np.pi * np.sqrt(0.09 - r[:3] ** 2))
    np.testing.assert_allclose(punch.pressure(r[:3]), boussinesq, rtol=1e-4)
    assert punch.pressure(0.4) == 0
