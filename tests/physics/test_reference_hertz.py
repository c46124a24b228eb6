"""Hertz contact of a sphere at rest and sliding, of an ellipse, and of a square array of spheres."""

import numpy as np
import pytest
import scipy.integrate
import scipy.special

from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.hertz import Hertz, von_mises
from asperity.reference.periodic_hertz import PeriodicHertz
from asperity.reference.sliding_sphere import SlidingSphere

SPHERE = Hertz(contact_radius=0.3, curvature_radius=2.0, effective_modulus=1.7)
SLIDING = SlidingSphere(SPHERE, friction=0.4)
TRACTION = 0.4 * SPHERE.maximum_pressure


def ellipse(ratio):
    return EllipticHertz(semi_major=1.3, semi_minor=1.3 * ratio, maximum_pressure=0.7, effective_modulus=2.1)


def test_load_approach_and_pressure_belong_together():
    assert Hertz.from_load(SPHERE.load, 2.0, 1.7).contact_radius == pytest.approx(0.3, rel=1e-14)
    assert Hertz.from_approach(SPHERE.approach, 2.0, 1.7).contact_radius == pytest.approx(0.3, rel=1e-14)
    assert SPHERE.load == pytest.approx(np.pi * 0.3**2 * SPHERE.mean_contact_pressure, rel=1e-14)
    load, _ = scipy.integrate.quad(lambda r: 2 * np.pi * r * SPHERE.pressure(r), 0, 0.3)
    assert load == pytest.approx(SPHERE.load, rel=1e-8)


def test_surface_follows_the_sphere_and_the_printed_form():
    """Inside and outside the contact; rounding of the printed form, about ρ³ ε."""
    r = np.linspace(0, 0.3, 50)
    np.testing.assert_allclose(SPHERE.displacement(r), SPHERE.approach - r**2 / 4, rtol=1e-14)
    rho = np.array([1.0001, 1.5, 4.0, 8.0])
    printed = SPHERE.approach / np.pi * ((2 - rho**2) * np.arcsin(1 / rho) + np.sqrt(rho**2 - 1))
    np.testing.assert_allclose(SPHERE.displacement(0.3 * rho), printed, rtol=1e-12)


def slope(field, axis, step=1e-3):
    """Derivative of a field of (x, y, z) along an axis, by a central difference."""
    shift = step * np.eye(3)[axis]
    return lambda point: (field(point + shift) - field(point - shift)) / (2 * step)


@pytest.mark.parametrize("stress", [SPHERE.stress_cartesian, SLIDING.traction_stress])
@pytest.mark.parametrize("poisson", [-0.3, 0.5])
def test_stress_is_in_equilibrium_and_compatible(stress, poisson):
    """∂_j σ_ij = 0, and ∇²σ_ij + ∂_i ∂_j σ_kk/(1 + ν) = 0 (Beltrami, Michell)."""

    def tensor(point):
        xx, yy, zz, yz, xz, xy = stress(point[1], point[0], -point[2], poisson)
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    axes = range(3)
    for point in ([0.1, 0.17, -0.2], [0.4, -0.3, -0.3], [0.0, 0.0, -0.25]):
        second = np.array([[slope(slope(tensor, i), j)(np.array(point)) for j in axes] for i in axes])
        compatible = np.einsum("kkij->ij", second) + np.einsum("ijkk->ij", second) / (1 + poisson)
        # Truncation of the differences; second derivatives are up to 10.
        np.testing.assert_allclose(compatible, 0, atol=2e-3)
        np.testing.assert_allclose(sum(slope(tensor, i)(np.array(point))[i] for i in axes), 0, atol=1e-4)


@pytest.mark.parametrize("nu", [0.0, 0.5])
def test_sliding_stress_inside_the_contact_is_polynomial(nu):
    """From φ0 = π² q0 (2a² − r²)/(4a) and Δφ2 = −φ0 in the plane.

    φ0,x = −π² q0 x/(2a), and φ2 = −π² q0/(4a) (a² r²/2 − r⁴/16), of which φ2,xxx = 3π² q0 x/(8a),
    φ2,xyy = π² q0 x/(8a) and φ2,xxy = π² q0 y/(8a).
    """
    radius, angle = 0.3 * np.array([0.0, 0.3, 0.9, 0.999999])[:, None], np.linspace(0, 2 * np.pi, 12)
    y, x = radius * np.sin(angle), radius * np.cos(angle)
    scale, none = -np.pi * TRACTION / (8 * 0.3), np.zeros_like(x)
    traction = 0.4 * SPHERE.pressure(np.hypot(y, x)) / scale
    expected = scale * np.stack([(4 + nu) * x, 3 * nu * x, none, none, traction, (2 - nu) * y], axis=-1)
    for surface in (0.0, -0.0):
        found = SLIDING.traction_stress(y, x, surface, nu)
        np.testing.assert_allclose(found, expected, atol=1e-13 * TRACTION)
    # The edge of contact, where the stress changes as a square root of the distance.
    edge = [SLIDING.traction_stress(0.0, -0.3, depth, nu) for depth in (0.0, 1e-12)]
    np.testing.assert_allclose(*edge, atol=1e-5 * TRACTION)


@pytest.mark.parametrize("ratio", [1e-3, 0.2, 0.9, 1.0])
def test_load_and_curvatures_belong_together(ratio):
    contact = ellipse(ratio)
    radius_x, radius_y = contact.curvature_radii
    found = EllipticHertz.from_load(contact.load, radius_x, radius_y, 2.1)
    found = found.semi_major, found.semi_minor, found.maximum_pressure
    assert found == pytest.approx((1.3, 1.3 * ratio, 0.7), rel=1e-12)
    assert contact.load == pytest.approx(np.pi * 1.3**2 * ratio * contact.mean_contact_pressure, rel=1e-12)


@pytest.mark.parametrize("poisson", [0.0, 0.5])
@pytest.mark.parametrize("ratio", [1e-3, 0.2, 1.0])
def test_peak_on_the_axis_is_the_largest(ratio, poisson):
    contact = ellipse(ratio)
    depth = np.linspace(0, 3 * contact.semi_minor, 30001)
    values = von_mises(contact.stress_on_axis(depth, poisson))
    peak = contact.maximum_von_mises_on_axis(poisson)
    assert values.max() * (1 - 1e-12) <= peak.value <= values.max() * (1 + 1e-7)
    assert peak.depth == pytest.approx(depth[values.argmax()], abs=2e-4 * contact.semi_minor)


def test_array_of_spheres_is_the_fourier_sum():
    """Hertz's pressure transformed, divided by q; truncation of the sum over modes."""
    contact, n = PeriodicHertz(0.2, 10.0), 700
    k = 2 * np.pi * np.arange(-n, n + 1)
    kx, ky = k[None, :], k[n:, None]
    q = np.hypot(kx, ky)
    q[0, n] = 1.0
    s = q * 0.2
    pressure = 2 * np.pi * contact.maximum_pressure * 0.2**2 * (np.sin(s) - s * np.cos(s)) / s**3
    mode = np.where(ky > 0, 2, 1) * 2 / q * pressure
    mode[0, n] = 0.0
    for y, x in ((0.0, 0.2), (0.5, 0.5), (0.1, 0.3)):
        summed = float(np.sum(mode * (np.cos(kx * x + ky * y) - 1)))
        assert contact.displacement(y, x) == pytest.approx(summed, rel=1e-4)
    # The sum over a window of neighbours is periodic only up to its truncation.
    assert contact.displacement(0.5, 0.7) == pytest.approx(float(contact.displacement(0.5, 0.3)), rel=1e-10)


def test_neighbours_enhance_small_contacts():
    """The neighbours' curvature: 1 + c (a/L)³ with c = (4/3π) · 9.0336/2, the sum of r⁻³ over the lattice."""
    zeta = scipy.special.zeta
    lattice = 4 * zeta(1.5) * (zeta(1.5, 0.25) - zeta(1.5, 0.75)) / 8
    small = PeriodicHertz(0.01, 1.0).enhancement
    # The next order, (a/L)².
    assert (small - 1) / 0.01**3 == pytest.approx(2 / np.pi * lattice / 3, rel=1e-3)
