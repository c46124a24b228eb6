"""Stress under a sliding sphere against sums of point forces, and polynomials at the surface."""

import numpy as np
import pytest

from asperity.reference.elementary import tangential_point_force_stress
from asperity.reference.hertz import Hertz
from asperity.reference.sliding_sphere import SlidingSphere

CONTACT = Hertz(contact_radius=0.3, curvature_radius=2.0, effective_modulus=1.7)
SLIDING = SlidingSphere(CONTACT, friction=0.4)
TRACTION = 0.4 * CONTACT.largest_pressure
RADIUS = CONTACT.contact_radius


@pytest.mark.parametrize("poisson", [-0.3, 0.3, 0.5])
def test_stress_is_the_sum_of_point_forces(poisson):
    """Point forces over r = a sin t, where the traction is μ p0 cos t; two places are at the surface."""
    node, weight = np.polynomial.legendre.leggauss(80)
    t, weight = (np.pi / 4 * (node + 1))[:, None], (np.pi / 4 * weight)[:, None]
    angle = 2 * np.pi * np.arange(160) / 160
    there_x, there_y = RADIUS * np.sin(t) * np.cos(angle), RADIUS * np.sin(t) * np.sin(angle)
    force = TRACTION * np.cos(t) * RADIUS**2 * np.sin(t) * np.cos(t) * weight * 2 * np.pi / 160
    inside = [(0.0, 0.0, 0.1), (0.1, 0.17, 0.07), (-0.29, 0.1, 0.08), (0.2, -0.5, 0.05), (1.0, 2.0, 0.5)]
    for y, x, depth in [*inside, (0.5, 0.1, 0.0), (0.3, -0.4, 0.0)]:
        stress = tangential_point_force_stress(y - there_y, x - there_x, depth, poisson)
        expected = np.sum(force[..., None] * stress, axis=(0, 1))
        # Quadrature.
        found = SLIDING.traction_stress(y, x, depth, poisson)
        np.testing.assert_allclose(found, expected, atol=1e-9 * TRACTION)


@pytest.mark.parametrize("poisson", [0.0, 0.5])
def test_surface_inside_the_contact(poisson):
    """Polynomials that follow from φ0 = π² q0 (2a² − r²)/(4a) and Δφ2 = −φ0 in the plane.

    φ0,x = −π² q0 x/(2a), and φ2 = −π² q0/(4a) (a² r²/2 − r⁴/16), of which φ2,xxx = 3π² q0 x/(8a),
    φ2,xyy = π² q0 x/(8a) and φ2,xxy = π² q0 y/(8a).
    """
    radius = RADIUS * np.array([0.0, 0.3, 0.9, 0.999999])[:, None]
    angle = np.linspace(0, 2 * np.pi, 12)
    y, x = radius * np.sin(angle), radius * np.cos(angle)
    scale = -np.pi * TRACTION / (8 * RADIUS)
    nu, none = poisson, np.zeros_like(x)
    expected = [(4 + nu) * x, 3 * nu * x, none, none, SLIDING.traction(y, x) / scale, (2 - nu) * y]
    expected = scale * np.stack(expected, axis=-1)
    np.testing.assert_allclose(SLIDING.traction_stress(y, x, 0.0, nu), expected, atol=1e-13 * TRACTION)
    np.testing.assert_array_equal(
        SLIDING.traction_stress(y, x, -0.0, nu), SLIDING.traction_stress(y, x, 0.0, nu)
    )
    # The edge of contact, where the stress changes as a square root of the distance.
    edge = [SLIDING.traction_stress(0.0, -RADIUS, depth, nu) for depth in (0.0, 1e-12)]
    np.testing.assert_allclose(*edge, atol=1e-5 * TRACTION)


def test_tension_behind_the_sphere():
    """At the trailing edge π (4 + ν) q0/8, with (1 − 2ν) p0/3 of the pressure."""
    nu = 0.25
    found = SLIDING.stress(0.0, -RADIUS, 0.0, nu)
    expected = np.pi * (4 + nu) / 8 * TRACTION + (1 - 2 * nu) / 3 * CONTACT.largest_pressure
    assert float(found[0]) == pytest.approx(expected, rel=1e-13)
    np.testing.assert_allclose(found[2:], 0.0, atol=1e-15)


def test_bad_values_are_named():
    with pytest.raises(ValueError, match="friction = nan"):
        SlidingSphere(CONTACT, np.nan)
    with pytest.raises(ValueError, match="depth"):
        SLIDING.stress(0.0, 0.0, -0.1, 0.3)
