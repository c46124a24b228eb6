"""Stress and displacement of harmonics and point forces, and Westergaard's wave."""

import numpy as np
import pytest
import scipy.integrate

from asperity.reference.elementary import (
    point_force_stress,
    single_mode_displacement,
    single_mode_stress,
    tangential_point_force_stress,
)
from asperity.reference.westergaard import Westergaard

YOUNG = 1.7


def hooke(displacement, point, poisson, step=1e-4):
    """Stress of a displacement field of (x, y, z), z up, by central differences."""
    gradient = np.empty((3, 3))
    for axis in range(3):
        shift = np.zeros(3)
        shift[axis] = step
        gradient[:, axis] = (displacement(point + shift) - displacement(point - shift)) / (2 * step)
    strain = 0.5 * (gradient + gradient.T)
    mu = YOUNG / (2 * (1 + poisson))
    lame = 2 * mu * poisson / (1 - 2 * poisson)
    stress = lame * np.trace(strain) * np.eye(3) + 2 * mu * strain
    return np.array([stress[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))])


def test_stress_and_displacement_of_a_mode_obey_hooke():
    point, poisson = np.array([0.4, -0.3, -0.6]), 0.33
    found = hooke(lambda r: single_mode_displacement(r[0], -r[2], 2.0, YOUNG, poisson), point, poisson)
    # Differences.
    np.testing.assert_allclose(found, single_mode_stress(0.4, 0.6, 2.0, poisson), atol=1e-7)


def slope(field, axis, step=1e-3):
    """Derivative of a field of (x, y, z) along an axis, by a central difference."""
    shift = step * np.eye(3)[axis]
    return lambda point: (field(point + shift) - field(point - shift)) / (2 * step)


@pytest.mark.parametrize("stress", [point_force_stress, tangential_point_force_stress])
@pytest.mark.parametrize("poisson", [-0.3, 0.33, 0.5])
def test_point_force_is_in_equilibrium_and_compatible(stress, poisson):
    """∂_j σ_ij = 0, and ∇²σ_ij + ∂_i ∂_j σ_kk/(1 + ν) = 0 (Beltrami, Michell); no traction on the surface."""

    def tensor(point):
        xx, yy, zz, yz, xz, xy = stress(point[1], point[0], -point[2], poisson)
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    point, axes = np.array([0.4, -0.3, -0.6]), range(3)
    second = np.array([[slope(slope(tensor, i), j)(point) for j in axes] for i in axes])
    compatible = np.einsum("kkij->ij", second) + np.einsum("ijkk->ij", second) / (1 + poisson)
    # Truncation of the differences; each derivative is of the order of one.
    np.testing.assert_allclose(compatible, 0, atol=5e-4)
    np.testing.assert_allclose(sum(slope(tensor, i)(point)[i] for i in axes), 0, atol=1e-5)
    assert np.all(stress(-0.3, 0.4, 0.0, poisson)[2:5] == 0)


@pytest.mark.parametrize(
    ("stress", "force"), [(point_force_stress, [0, 0, -1]), (tangential_point_force_stress, [1, 0, 0])]
)
def test_point_force_is_carried_by_every_plane(stress, force):
    """The mean of σ_xz, σ_yz and σ_zz over a circle, times 2πr, in all rings of a plane."""
    angle = 2 * np.pi * np.arange(8) / 8

    def ring(r):
        on_circle = stress(r * np.sin(angle), r * np.cos(angle), 0.2, 0.3)
        return 2 * np.pi * r * on_circle[:, [4, 3, 2]].mean(axis=0)

    total = [scipy.integrate.quad(lambda r, n=n: ring(r)[n], 0, np.inf)[0] for n in range(3)]
    # Quadrature.
    np.testing.assert_allclose(total, force, atol=1e-8)


WAVE = Westergaard(mean_pressure=0.1, amplitude=0.05, wavelength=1.3, effective_modulus=YOUNG)
CELL = 1.3 * (np.arange(20000) + 0.5) / 20000


def test_displacement_is_that_of_the_pressure():
    """Mode by mode, u(q) = 2 p(q) / (E* q)."""
    n = 4096
    x = 1.3 * np.arange(n) / n
    pressure = np.fft.rfft(WAVE.pressure(x))
    q = 2 * np.pi / 1.3 * np.arange(1, n // 2 + 1)
    modes = np.concatenate([[0], 2 * pressure[1:] / (YOUNG * q)])
    # Aliasing of the square root.
    np.testing.assert_allclose(WAVE.displacement(x), np.fft.irfft(modes, n), atol=2e-6 * WAVE.amplitude * 20)
    assert WAVE.gap(CELL).mean() == pytest.approx(WAVE.mean_gap, rel=1e-6)


def test_stress_is_the_sum_of_its_modes():
    n, depth = 16384, 0.09
    x = 1.3 * np.arange(n) / n
    pressure = np.fft.rfft(WAVE.pressure(x)) / n
    total = np.zeros((n, 6)) + 0.1 * np.array([-3 / 7, -3 / 7, -1, 0, 0, 0])
    for k in range(1, 120):
        total += 2 * pressure[k].real * single_mode_stress(x, depth, 2 * np.pi / 1.3 * k, 0.3)
    # Aliasing of the square root.
    np.testing.assert_allclose(WAVE.stress(x, depth, 0.3), total, atol=5e-7)


def test_free_and_confined_differ_by_the_mean_mode():
    difference = WAVE.stress(0.2, 0.1, 0.3, "free") - WAVE.stress(0.2, 0.1, 0.3, "confined")
    np.testing.assert_allclose(difference, 0.1 * 3 / 7 * np.array([1, 1, 0, 0, 0, 0]), atol=1e-15)
    with pytest.raises(ValueError, match="lateral"):
        WAVE.stress(0.2, 0.1, 0.3, "loose")


def test_complete_contact_follows_the_wave():
    wave = Westergaard(1.0, 0.05, 1.3, YOUNG)
    assert wave.complete_pressure < 1
    assert wave.area_fraction == 1
    assert wave.approach == pytest.approx(0.05)
    assert np.all(wave.gap(CELL) == 0)
    np.testing.assert_allclose(wave.stress(CELL, 0.0, 0.3)[:, 2], -wave.pressure(CELL), atol=1e-12)


def test_deep_stress_is_uniform_without_overflow():
    deep = WAVE.stress(0.3, 1e4, 0.3)
    np.testing.assert_allclose(deep, 0.1 * np.array([-3 / 7, -3 / 7, -1, 0, 0, 0]), atol=1e-16)
