"""Hertz contact of one sphere and of a square array."""

import numpy as np
import pytest
import scipy.integrate
import scipy.special

from asperity.reference.elementary import von_mises
from asperity.reference.hertz import Hertz
from asperity.reference.periodic_hertz import PeriodicHertz

CONTACT = Hertz(contact_radius=0.3, curvature_radius=2.0, effective_modulus=1.7)


def test_load_approach_and_pressure_belong_together():
    assert Hertz.from_load(CONTACT.load, 2.0, 1.7).contact_radius == pytest.approx(0.3, rel=1e-14)
    assert Hertz.from_approach(CONTACT.approach, 2.0, 1.7).contact_radius == pytest.approx(0.3, rel=1e-14)
    assert CONTACT.load == pytest.approx(np.pi * 0.3**2 * CONTACT.mean_contact_pressure, rel=1e-14)
    load, _ = scipy.integrate.quad(lambda r: 2 * np.pi * r * CONTACT.pressure(r), 0, 0.3)
    assert load == pytest.approx(CONTACT.load, rel=1e-8)


def test_surface_follows_the_indenter_inside_contact_and_the_printed_form_outside():
    r = np.linspace(0, 0.3, 50)
    np.testing.assert_allclose(CONTACT.displacement(r), CONTACT.approach - r**2 / 4, rtol=1e-14)
    rho = np.array([1.0001, 1.5, 4.0, 8.0])
    printed = (2 - rho**2) * np.arcsin(1 / rho) + np.sqrt(rho**2 - 1)
    expected = CONTACT.approach / np.pi * printed
    # Rounding of the printed form, about ρ³ ε.
    np.testing.assert_allclose(CONTACT.displacement(0.3 * rho), expected, rtol=1e-12)


@pytest.mark.parametrize("nu", [0.0, 0.5])
def test_stress_is_the_hankel_transform_of_the_pressure(nu):
    """Every component at points off the axis, from the half-space's kernels and the transformed pressure."""
    r, depth, a = 0.23, 0.11, CONTACT.contact_radius

    def integral(kernel):
        def integrand(t):
            # ∫ p r J0(tr) dr = p0 a² (sin ta − ta cos ta)/(ta)³
            s = t * a
            pressure = a**2 * (np.sin(s) - s * np.cos(s)) / s**3
            return pressure * t * kernel(t) * np.exp(-t * depth)

        return scipy.integrate.quad(integrand, 0, 400, limit=2000, epsabs=1e-13, epsrel=1e-12)[0]

    j0, j1 = scipy.special.j0, scipy.special.j1
    axial = -integral(lambda t: (1 + t * depth) * j0(t * r))
    shear = integral(lambda t: t * depth * j1(t * r))
    along = integral(lambda t: (1 - t * depth) * j0(t * r))
    bent = integral(lambda t: (1 - 2 * nu - t * depth) * j1(t * r) / (t * r))
    mean = integral(lambda t: 2 * nu * j0(t * r))
    expected = np.array([-along + bent, -mean - bent, axial, shear]) * CONTACT.largest_pressure
    # Quadrature.
    found = np.array(CONTACT.stress(r, depth, nu))
    np.testing.assert_allclose(found, expected, atol=1e-9 * CONTACT.largest_pressure)


def test_surface_stress_is_the_pressure_without_shear():
    """From the axis to beyond the edge of contact, where radial and hoop stress have a kink."""
    r = np.linspace(0, 3, 301)
    stress = CONTACT.stress(r, 0.0, 0.3)
    np.testing.assert_allclose(stress.axial, -CONTACT.pressure(r), atol=1e-15)
    assert np.all(stress.shear == 0)
    assert np.all(np.isfinite(stress))
    np.testing.assert_allclose(stress.radial[r > 0.3], -stress.hoop[r > 0.3], atol=1e-15)


def test_components_turn_with_the_position():
    components = CONTACT.stress_cartesian([0.0, 0.2], [0.2, 0.0], 0.1, 0.3)
    np.testing.assert_allclose(components[1], components[0][[1, 0, 2, 4, 3, 5]], atol=1e-15)
    np.testing.assert_allclose(von_mises(components), CONTACT.stress(0.2, 0.1, 0.3).von_mises, rtol=1e-14)


@pytest.mark.parametrize(("poisson", "peak", "depth"), [(0.0, 0.7696, 0.3819), (0.5, 0.5327, 0.5479)])
def test_largest_von_mises_stress(poisson, peak, depth):
    z = np.linspace(0, 1, 10001)
    found = CONTACT.stress(0.0, 0.3 * z, poisson).von_mises / CONTACT.largest_pressure
    # The printed digits.
    assert found.max() == pytest.approx(peak, abs=5e-5)
    assert z[found.argmax()] == pytest.approx(depth, abs=1.5e-4)


def test_replicas_against_the_fourier_sum():
    """The same displacement by modes: Hertz's pressure transformed, divided by q."""
    contact = PeriodicHertz(0.2, 10.0)
    n = 700
    k = 2 * np.pi * np.arange(-n, n + 1)
    kx, ky = k[None, :], k[n:, None]
    q = np.hypot(kx, ky)
    q[0, n] = 1.0
    s = q * 0.2
    pressure = 2 * np.pi * contact.largest_pressure * 0.2**2 * (np.sin(s) - s * np.cos(s)) / s**3
    mode = np.where(ky > 0, 2, 1) * 2 / q * pressure
    mode[0, n] = 0.0
    for y, x in ((0.0, 0.2), (0.5, 0.5), (0.1, 0.3)):
        summed = float(np.sum(mode * (np.cos(kx * x + ky * y) - 1)))
        # Truncation of the sum over modes.
        assert contact.displacement(y, x) == pytest.approx(summed, rel=1e-4)


def test_displacement_is_periodic():
    """The sum over a window of neighbours is periodic only up to its truncation."""
    contact = PeriodicHertz(0.2, 10.0)
    assert contact.displacement(0.5, 0.7) == pytest.approx(float(contact.displacement(0.5, 0.3)), rel=1e-10)


def test_enhancement_of_small_contacts():
    """The neighbours' curvature: 1 + c (a/L)³ with c = (4/3π) · 9.0336/2, the sum of r⁻³ over the lattice."""
    zeta = scipy.special.zeta
    lattice = 4 * zeta(1.5) * (zeta(1.5, 0.25) - zeta(1.5, 0.75)) / 8
    small = PeriodicHertz(0.01, 1.0).enhancement
    # The next order, (a/L)².
    assert (small - 1) / 0.01**3 == pytest.approx(2 / np.pi * lattice / 3, rel=1e-3)


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: Hertz(np.nan, 1.0), "contact_radius"),
        (lambda: Hertz.from_load(-1.0, 1.0), "load"),
        (lambda: Hertz.from_approach(1.0, 0.0), "curvature_radius"),
        (lambda: CONTACT.stress(0.1, -0.1, 0.3), "depth"),
        (lambda: PeriodicHertz(0.5, 1.0), "below half the period"),
    ],
)
def test_bad_values_are_named(make, named):
    with pytest.raises(ValueError, match=named):
        make()
