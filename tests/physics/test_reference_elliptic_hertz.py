"""Elliptic Hertz contact against sums of point loads, and against circular and line contact."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.integrate
import scipy.optimize

from asperity.reference.elementary import largest_shear, point_force_stress, von_mises
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.hertz import Hertz

RATIOS = [0.2, 0.9]


def ellipse(ratio: float) -> EllipticHertz:
    return EllipticHertz(semi_major=1.3, semi_minor=1.3 * ratio, largest_pressure=0.7, effective_modulus=2.1)


def integrated_stress(contact: EllipticHertz, depth: float, poisson: float) -> np.ndarray:
    """Point loads summed over x = a sin t cos φ, y = b sin t sin φ, where the pressure is p0 cos t."""
    node, weight = np.polynomial.legendre.leggauss(60)
    t, weight = np.pi / 4 * (node + 1), np.pi / 4 * weight
    angle = 2 * np.pi * np.arange(120) / 120
    radius = np.sin(t)[:, None]
    x = contact.semi_major * radius * np.cos(angle)
    y = contact.semi_minor * radius * np.sin(angle)
    area = contact.semi_major * contact.semi_minor * radius * np.cos(t)[:, None] * weight[:, None]
    force = contact.largest_pressure * np.cos(t)[:, None] * area * 2 * np.pi / 120
    stress = point_force_stress(-y, -x, depth, poisson)
    return np.sum(force[..., None] * stress, axis=(0, 1))


@pytest.mark.parametrize("poisson", [-0.3, 0.3, 0.5])
@pytest.mark.parametrize("ratio", RATIOS)
def test_stress_on_the_axis_is_the_sum_of_point_loads(ratio: float, poisson: float) -> None:
    contact = ellipse(ratio)
    for depth in (0.15, 0.6, 4.0):
        found = contact.stress_on_axis(depth, poisson)
        # Quadrature.
        np.testing.assert_allclose(found, integrated_stress(contact, depth, poisson), atol=1e-10)


def potential_inside(contact: EllipticHertz, y: float, x: float) -> float:
    """∫∫ p/ρ dS in polar coordinates around a point of the contact, without elliptic integrals.

    Along a ray the pressure is p0 √(A − 2 B s − C s²); its integral over both rays of a line is π p0 (A +
    B²/C)/(2 √C).
    """
    a, b = contact.semi_major, contact.semi_minor

    def line(angle: float) -> float:
        cosine, sine = np.cos(angle), np.sin(angle)
        constant = 1 - (x / a) ** 2 - (y / b) ** 2
        linear = x * cosine / a**2 + y * sine / b**2
        square = (cosine / a) ** 2 + (sine / b) ** 2
        return np.pi * (constant + linear**2 / square) / (2 * np.sqrt(square))

    integral, _ = scipy.integrate.quad(line, 0, np.pi, epsabs=1e-13, epsrel=1e-13)
    return contact.largest_pressure * integral


@pytest.mark.parametrize("ratio", RATIOS)
def test_surface_inside_the_contact_follows_the_indenter(ratio: float) -> None:
    contact = ellipse(ratio)
    radius_x, radius_y = contact.curvature_radii
    for y, x in ((0.0, 0.0), (0.1 * ratio, 1.1), (0.9 * ratio, -0.6)):
        expected = contact.approach - x**2 / (2 * radius_x) - y**2 / (2 * radius_y)
        found = potential_inside(contact, y, x) / (np.pi * contact.effective_modulus)
        assert found == pytest.approx(expected, rel=1e-11)
        assert float(contact.displacement(y, x)) == pytest.approx(expected, rel=1e-12)


def test_surface_outside_the_contact_is_displaced_by_the_pressure() -> None:
    """Direct integration over the ellipse, far enough outside to be smooth."""
    contact = ellipse(0.4)
    node, weight = np.polynomial.legendre.leggauss(60)
    t, weight = np.pi / 4 * (node + 1), np.pi / 4 * weight
    angle = 2 * np.pi * np.arange(120) / 120
    x = contact.semi_major * np.sin(t)[:, None] * np.cos(angle)
    y = contact.semi_minor * np.sin(t)[:, None] * np.sin(angle)
    area = (
        contact.semi_major * contact.semi_minor * (np.sin(t) * np.cos(t) * weight)[:, None] * 2 * np.pi / 120
    )
    for there in ((0.9, 0.3), (0.2, 2.0), (30.0, 40.0)):
        inverse = 1 / np.hypot(there[0] - y, there[1] - x)
        potential = np.sum(contact.pressure(y, x) * area * inverse)
        found = float(contact.displacement(*there))
        assert found == pytest.approx(potential / (np.pi * contact.effective_modulus), rel=1e-10)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
def test_circular_contact_is_hertz(poisson: float) -> None:
    circle = Hertz.from_load(2.0, 3.0, 1.5)
    ellipse = EllipticHertz.from_load(2.0, 3.0, 3.0, 1.5)
    assert ellipse.semi_major == ellipse.semi_minor == pytest.approx(circle.contact_radius, rel=1e-14)
    assert ellipse.approach == pytest.approx(circle.approach, rel=1e-14)
    assert ellipse.curvature_radii == pytest.approx((3.0, 3.0), rel=1e-14)
    depth = np.array([0.0, 0.1, 1.0, 30.0])
    expected = circle.stress_cartesian(0.0, 0.0, depth, poisson)
    np.testing.assert_allclose(ellipse.stress_on_axis(depth, poisson), expected, atol=1e-15)
    y, x = np.array([0.3, 0.0, 2.0]), np.array([0.4, 5.0, -1.0])
    np.testing.assert_allclose(ellipse.displacement(y, x), circle.displacement(np.hypot(y, x)), rtol=1e-13)


def test_slender_contact_tends_to_line_contact() -> None:
    """In plane strain, with the largest pressure: σ_xx = −p0 ((1 + 2 z²/b²)/√(1 + z²/b²) − 2 z/b)."""
    slender, nu = EllipticHertz(1e4, 1.0, 0.7), 0.3
    z = np.array([0.1, 0.78, 2.0])
    root = np.sqrt(1 + z**2)
    across, down = -0.7 * ((1 + 2 * z**2) / root - 2 * z), -0.7 / root
    expected = np.stack([nu * (across + down), across, down], axis=-1)
    np.testing.assert_allclose(slender.stress_on_axis(z, nu)[:, :3], expected, atol=2e-4)


def test_load_and_curvatures_give_the_contact_back() -> None:
    for ratio in (*RATIOS, 1e-3):
        contact = ellipse(ratio)
        found = EllipticHertz.from_load(contact.load, *contact.curvature_radii, 2.1)
        assert found.semi_major == pytest.approx(contact.semi_major, rel=1e-12)
        assert found.semi_minor == pytest.approx(contact.semi_minor, rel=1e-12)
        assert found.largest_pressure == pytest.approx(0.7, rel=1e-12)


@pytest.mark.parametrize("poisson", [0.0, 0.5])
@pytest.mark.parametrize("ratio", [1e-3, *RATIOS])
def test_peaks_on_the_axis_are_the_largest(ratio: float, poisson: float) -> None:
    contact = ellipse(ratio)
    depth = np.linspace(0, 3 * contact.semi_minor, 10001)
    stress = contact.stress_on_axis(depth, poisson)
    for values, peak in (
        (von_mises(stress), contact.largest_von_mises_on_axis(poisson)),
        (largest_shear(stress), contact.largest_shear_on_axis(poisson)),
    ):
        assert peak.value == pytest.approx(values.max(), rel=1e-7)
        assert peak.value >= values.max() * (1 - 1e-12)
        assert peak.depth == pytest.approx(depth[values.argmax()], abs=6e-4 * contact.semi_minor)


def test_largest_shear_is_half_the_principal_spread() -> None:
    rotation = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    tensor = rotation @ np.diag([1.0, -2.0, 0.5]) @ rotation.T
    stress = np.array([tensor[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))])
    assert float(largest_shear(stress)) == pytest.approx(1.5, rel=1e-14)
    assert float(von_mises(stress)) == pytest.approx(np.sqrt(0.5 * (9 + 6.25 + 0.25)), rel=1e-14)


@pytest.mark.parametrize("name", ["semi_major", "semi_minor", "largest_pressure", "effective_modulus"])
def test_bad_values_are_named(name: str) -> None:
    good = {"semi_major": 1.0, "semi_minor": 0.5, "largest_pressure": 1.0}
    with pytest.raises(ValueError, match=name):
        EllipticHertz(**{**good, name: -1.0})


def test_exchanged_axes_and_radii_are_refused() -> None:
    with pytest.raises(ValueError, match="semi_minor = 2"):
        EllipticHertz(1.0, 2.0, 1.0)
    with pytest.raises(ValueError, match="curvature_radius_y = 3"):
        EllipticHertz.from_load(1.0, 2.0, 3.0)
    with pytest.raises(ValueError, match="curvature_radius_x = 1e"):
        EllipticHertz.from_load(1.0, 1e30, 1.0)
    with pytest.raises(ValueError, match="depth"):
        EllipticHertz(2.0, 1.0, 1.0).stress_on_axis(-0.1, 0.3)
