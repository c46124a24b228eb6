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


def derivative(field, point, axis, step=1e-4):
    shift = step * np.eye(3)[axis]
    return (np.asarray(field(point + shift)) - field(point - shift)) / (2 * step)


@pytest.mark.parametrize("poisson", [-0.3, 0.0, 0.33, 0.5])
def test_stresses_are_in_equilibrium(poisson):
    point = np.array([0.4, -0.3, -0.6])
    for stress in (
        lambda r: single_mode_stress(r[0], -r[2], 2.0, poisson),
        lambda r: point_force_stress(r[1], r[0], -r[2], poisson),
        lambda r: tangential_point_force_stress(r[1], r[0], -r[2], poisson),
    ):
        along = [derivative(stress, point, axis) for axis in range(3)]
        for row in ((0, 5, 4), (5, 1, 3), (4, 3, 2)):
            assert sum(along[axis][part] for axis, part in enumerate(row)) == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("poisson", [-0.3, 0.33])
def test_displacement_of_a_harmonic_obeys_hooke(poisson):
    point = np.array([0.4, 0.0, -0.6])

    def moved(r):
        return single_mode_displacement(r[0], -r[2], 2.0, YOUNG, poisson)

    gradient = np.stack([derivative(moved, point, axis) for axis in range(3)], axis=1)
    mu = YOUNG / (2 * (1 + poisson))
    tensor = 2 * mu * poisson / (1 - 2 * poisson) * np.trace(gradient) * np.eye(3) + mu * (
        gradient + gradient.T
    )
    expected = single_mode_stress(0.4, 0.6, 2.0, poisson)
    np.testing.assert_allclose(tensor[[0, 1, 2, 0], [0, 1, 2, 2]], expected[[0, 1, 2, 4]], atol=1e-7)


@pytest.mark.parametrize(
    ("force", "carried"), [(point_force_stress, [-1, 0, 0]), (tangential_point_force_stress, [0, 0, 1])]
)
def test_a_point_force_is_carried_by_every_plane(force, carried):
    """The means of σ_zz, σ_yz and σ_xz over a circle, times 2πr, in all rings of a plane."""
    angle = 2 * np.pi * np.arange(8) / 8

    def ring(r):
        stress = force(r * np.sin(angle), r * np.cos(angle), 0.2, 0.3)
        return 2 * np.pi * r * stress[:, [2, 3, 4]].mean(axis=0)

    total = [scipy.integrate.quad(lambda r, n=n: ring(r)[n], 0, np.inf)[0] for n in range(3)]
    np.testing.assert_allclose(total, carried, atol=1e-8)  # quadrature


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
