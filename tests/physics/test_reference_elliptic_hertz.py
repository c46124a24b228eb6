"""Elliptic Hertz contact against sums of point loads, circular contact, and its own curvatures."""

import numpy as np
import pytest

from asperity.reference.elementary import largest_shear, point_force_stress, von_mises
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.hertz import Hertz

RATIOS = [0.2, 0.9, 1.0]


def ellipse(ratio):
    return EllipticHertz(semi_major=1.3, semi_minor=1.3 * ratio, largest_pressure=0.7, effective_modulus=2.1)


def point_loads(contact):
    """Places and forces along x = a sin t cos φ, y = b sin t sin φ, where the pressure is p0 cos t."""
    node, weight = np.polynomial.legendre.leggauss(60)
    t, weight = (np.pi / 4 * (node + 1))[:, None], (np.pi / 4 * weight)[:, None]
    angle = 2 * np.pi * np.arange(120) / 120
    a, b = contact.semi_major, contact.semi_minor
    x, y = a * np.sin(t) * np.cos(angle), b * np.sin(t) * np.sin(angle)
    area = a * b * np.sin(t) * np.cos(t) * weight * 2 * np.pi / 120
    return y, x, contact.pressure(y, x) * area


@pytest.mark.parametrize("poisson", [-0.3, 0.5])
@pytest.mark.parametrize("ratio", RATIOS)
def test_stress_on_the_axis_is_the_sum_of_point_loads(ratio, poisson):
    contact = ellipse(ratio)
    y, x, force = point_loads(contact)
    for depth in (0.15, 0.6, 4.0):
        expected = np.einsum("tp,tpc->c", force, point_force_stress(-y, -x, depth, poisson))
        # Quadrature.
        np.testing.assert_allclose(contact.stress_on_axis(depth, poisson), expected, atol=1e-10)


def test_surface_outside_the_contact_is_displaced_by_the_point_loads():
    contact = ellipse(0.4)
    y, x, force = point_loads(contact)
    for there in ((0.9, 0.3), (0.2, 2.0), (30.0, 40.0)):
        potential = np.sum(force / np.hypot(there[0] - y, there[1] - x))
        expected = potential / (np.pi * contact.effective_modulus)
        assert float(contact.displacement(*there)) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("ratio", [*RATIOS, 1e-3])
def test_surface_inside_the_contact_follows_the_indenter(ratio):
    contact = ellipse(ratio)
    radius_x, radius_y = contact.curvature_radii
    y, x = ratio * np.array([0.0, 0.1, 0.9]), np.array([0.0, 1.1, -0.6])
    expected = contact.approach - x**2 / (2 * radius_x) - y**2 / (2 * radius_y)
    np.testing.assert_allclose(contact.displacement(y, x), expected, rtol=1e-10)
    found = EllipticHertz.from_load(contact.load, radius_x, radius_y, 2.1)
    found = found.semi_major, found.semi_minor, found.largest_pressure
    assert found == pytest.approx((1.3, 1.3 * ratio, 0.7), rel=1e-12)
    assert contact.load == pytest.approx(np.pi * 1.3**2 * ratio * contact.mean_contact_pressure, rel=1e-12)


def test_circular_contact_is_hertz():
    circle = Hertz.from_load(2.0, 3.0, 1.5)
    ellipse = EllipticHertz.from_load(2.0, 3.0, 3.0, 1.5)
    assert ellipse.semi_major == ellipse.semi_minor == pytest.approx(circle.contact_radius, rel=1e-14)
    assert ellipse.approach == pytest.approx(circle.approach, rel=1e-14)
    depth = np.array([0.0, 0.1, 1.0, 30.0])
    expected = circle.stress_cartesian(0.0, 0.0, depth, 0.3)
    np.testing.assert_allclose(ellipse.stress_on_axis(depth, 0.3), expected, atol=1e-15)
    y, x = np.array([0.3, 0.0, 2.0]), np.array([0.4, 5.0, -1.0])
    np.testing.assert_allclose(ellipse.displacement(y, x), circle.displacement(np.hypot(y, x)), rtol=1e-13)


@pytest.mark.parametrize("poisson", [0.0, 0.5])
@pytest.mark.parametrize("ratio", [1e-3, 0.2, 1.0])
def test_peaks_on_the_axis_are_the_largest(ratio, poisson):
    contact = ellipse(ratio)
    depth = np.linspace(0, 3 * contact.semi_minor, 30001)
    stress = contact.stress_on_axis(depth, poisson)
    for values, peak in (
        (von_mises(stress), contact.largest_von_mises_on_axis(poisson)),
        (largest_shear(stress), contact.largest_shear_on_axis(poisson)),
    ):
        assert values.max() * (1 - 1e-12) <= peak.value <= values.max() * (1 + 1e-7)
        assert peak.depth == pytest.approx(depth[values.argmax()], abs=2e-4 * contact.semi_minor)


def test_measures_of_a_rotated_stress():
    rotation = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    tensor = rotation @ np.diag([1.0, -2.0, 0.5]) @ rotation.T
    stress = np.array([tensor[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))])
    assert float(largest_shear(stress)) == pytest.approx(1.5, rel=1e-14)
    assert float(von_mises(stress)) == pytest.approx(np.sqrt(0.5 * (9 + 6.25 + 0.25)), rel=1e-14)


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: EllipticHertz(1.0, 0.5, -1.0), "largest_pressure"),
        (lambda: EllipticHertz(1.0, 2.0, 1.0), "semi_minor = 2"),
        (lambda: EllipticHertz.from_load(0.0, 2.0, 1.0), "load"),
        (lambda: EllipticHertz.from_load(1.0, 2.0, 3.0), "curvature_radius_y = 3"),
        (lambda: EllipticHertz.from_load(1.0, 1e30, 1.0), "curvature_radius_x = 1e"),
        (lambda: EllipticHertz(2.0, 1.0, 1.0).stress_on_axis(-0.1, 0.3), "depth"),
    ],
)
def test_bad_values_are_named(make, named):
    with pytest.raises(ValueError, match=named):
        make()
