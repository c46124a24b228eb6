"""Stress and displacement of harmonics and point forces, and Westergaard's wave."""

import numpy as np
import pytest
import scipy.integrate

from asperity.reference.elementary import (
    point_force_displacement,
    point_force_stress,
    single_mode_displacement,
    single_mode_stress,
    tangential_point_force_displacement,
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


@pytest.mark.parametrize("poisson", [-0.3, 0.0, 0.33, 0.45])
def test_stress_and_displacement_obey_hooke(poisson):
    point = np.array([0.4, -0.3, -0.6])
    found = hooke(lambda r: single_mode_displacement(r[0], -r[2], 2.0, YOUNG, poisson), point, poisson)
    # Differences.
    np.testing.assert_allclose(found, single_mode_stress(0.4, 0.6, 2.0, poisson), atol=1e-7)
    found = hooke(lambda r: point_force_displacement(r[1], r[0], -r[2], YOUNG, poisson), point, poisson)
    np.testing.assert_allclose(found, point_force_stress(-0.3, 0.4, 0.6, poisson), atol=1e-6)

    def dragged(r):
        return tangential_point_force_displacement(r[1], r[0], -r[2], YOUNG, poisson)

    found = hooke(dragged, point, poisson)
    np.testing.assert_allclose(found, tangential_point_force_stress(-0.3, 0.4, 0.6, poisson), atol=1e-6)


def test_point_force_is_carried_by_every_plane():
    def ring(r):
        return 2 * np.pi * r * point_force_stress(0.6 * r, 0.8 * r, 0.2, 0.3)[2]

    # Quadrature.
    assert scipy.integrate.quad(ring, 0, np.inf)[0] == pytest.approx(-1.0, rel=1e-8)


def test_tangential_point_force_is_carried_by_every_plane():
    """The mean of σ_xz over a circle, times 2πr, in all rings of a plane."""
    angle = 2 * np.pi * np.arange(8) / 8

    def ring(r):
        stress = tangential_point_force_stress(r * np.sin(angle), r * np.cos(angle), 0.2, 0.3)
        return 2 * np.pi * r * stress[:, [2, 3, 4]].mean(axis=0)

    total = [scipy.integrate.quad(lambda r, n=n: ring(r)[n], 0, np.inf)[0] for n in range(3)]
    # Quadrature.
    np.testing.assert_allclose(total, [0.0, 0.0, 1.0], atol=1e-8)


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
