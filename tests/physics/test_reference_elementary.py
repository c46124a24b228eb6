"""Stress and displacement of harmonics and point forces, Westergaard's wave, bisinusoid; refusals of all."""

import mpmath as mp
import numpy as np
import pytest
import scipy.integrate

from asperity.fourier.grid import Grid
from asperity.reference.bisinusoid import Bisinusoid
from asperity.reference.bonded_layer import BondedLayer
from asperity.reference.elementary import (
    largest_shear,
    point_force_stress,
    single_mode_displacement,
    single_mode_stress,
    tangential_point_force_stress,
    von_mises,
)
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.finite_element import Slab, graded
from asperity.reference.hertz import Hertz
from asperity.reference.periodic_hertz import PeriodicHertz
from asperity.reference.sliding_sphere import SlidingSphere
from asperity.reference.westergaard import Westergaard

YOUNG = 1.7
COMPONENTS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
WAVE = Westergaard(mean_pressure=0.1, amplitude=0.05, wavelength=1.3, effective_modulus=YOUNG)
CELL = 1.3 * (np.arange(20000) + 0.5) / 20000
CROSSED = Bisinusoid(amplitude=0.02, wavelength=1.0, effective_modulus=YOUNG)


def slope(field, axis, step=1e-3):
    """Derivative of a field of (x, y, z) along an axis, by a central difference."""
    shift = step * np.eye(3)[axis]
    return lambda point: (field(point + shift) - field(point - shift)) / (2 * step)


def test_stress_and_displacement_of_a_mode_obey_hooke():
    point, nu = np.array([0.4, -0.3, -0.6]), 0.33

    def displacement(r):
        return single_mode_displacement(r[0], -r[2], 2.0, YOUNG, nu)

    gradient = np.stack([slope(displacement, axis, 1e-4)(point) for axis in range(3)], axis=1)
    strain = 0.5 * (gradient + gradient.T)
    shear = YOUNG / (2 * (1 + nu))
    stress = 2 * shear * (strain + nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3))
    # Differences.
    expected = single_mode_stress(0.4, 0.6, 2.0, nu)
    np.testing.assert_allclose([stress[at] for at in COMPONENTS], expected, atol=1e-7)


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

    total, _ = scipy.integrate.quad_vec(ring, 0, np.inf, epsabs=1e-10)
    np.testing.assert_allclose(total, force, atol=1e-8)


def test_measures_of_a_rotated_stress():
    rotation = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    tensor = rotation @ np.diag([1.0, -2.0, 0.5]) @ rotation.T
    stress = np.array([tensor[at] for at in COMPONENTS])
    assert float(largest_shear(stress)) == pytest.approx(1.5, rel=1e-14)
    assert float(von_mises(stress)) == pytest.approx(np.sqrt(0.5 * (9 + 6.25 + 0.25)), rel=1e-14)


def test_wave_is_the_sum_of_its_modes():
    """Displacement u(q) = 2 p(q)/(E* q), and stress; aliasing of the square root."""
    n, depth = 16384, 0.09
    x = 1.3 * np.arange(n) / n
    pressure = np.fft.rfft(WAVE.pressure(x))
    q = 2 * np.pi / 1.3 * np.arange(1, n // 2 + 1)
    moved = np.fft.irfft(np.concatenate([[0], 2 * pressure[1:] / (YOUNG * q)]), n)
    np.testing.assert_allclose(WAVE.displacement(x), moved, atol=4e-6 * WAVE.amplitude)
    assert WAVE.gap(CELL).mean() == pytest.approx(WAVE.mean_gap, rel=1e-6)
    total = np.zeros((n, 6)) + 0.1 * np.array([-3 / 7, -3 / 7, -1, 0, 0, 0])
    for k in range(1, 120):
        total += 2 * pressure[k].real / n * single_mode_stress(x, depth, 2 * np.pi / 1.3 * k, 0.3)
    np.testing.assert_allclose(WAVE.stress(x, depth, 0.3), total, atol=5e-7)


def test_mean_mode_of_a_wave():
    """Free and confined cells differ by it, and deep down it is all there is."""
    difference = WAVE.stress(0.2, 0.1, 0.3, "free") - WAVE.stress(0.2, 0.1, 0.3, "confined")
    np.testing.assert_allclose(difference, 0.1 * 3 / 7 * np.array([1, 1, 0, 0, 0, 0]), atol=1e-15)
    deep = WAVE.stress(0.3, 1e4, 0.3)
    np.testing.assert_allclose(deep, 0.1 * np.array([-3 / 7, -3 / 7, -1, 0, 0, 0]), atol=1e-16)


def test_complete_contact_follows_the_wave():
    wave = Westergaard(1.0, 0.05, 1.3, YOUNG)
    assert wave.complete_pressure < 1
    assert wave.area_fraction == 1
    assert wave.approach == pytest.approx(0.05)
    assert np.all(wave.gap(CELL) == 0)
    np.testing.assert_allclose(wave.stress(CELL, 0.0, 0.3)[:, 2], -wave.pressure(CELL), atol=1e-12)


def test_complete_contact_of_crossed_waves():
    """Mode by mode the pressure is E* q/2 times the displacement."""
    grid = Grid((8, 8))
    y, x = grid.coordinates()
    modes = -YOUNG * grid.wavenumber() / 2 * np.fft.rfft2(CROSSED.height(y[:, None], x))
    modes[0, 0] = 0.3 * 64
    expected = np.fft.irfft2(modes, grid.shape)
    np.testing.assert_allclose(CROSSED.complete_contact_pressure(y[:, None], x, 0.3), expected, rtol=1e-13)
    full = CROSSED.complete_contact_pressure(0.5, 0.5, CROSSED.complete_pressure)
    assert full == pytest.approx(0.0, abs=1e-16)


def test_small_contact_of_crossed_waves_is_hertz():
    load = 1e-4 * CROSSED.complete_pressure
    curvature = (CROSSED.height(0.0, 1e-4) / 0.5e-8).item()
    radius = Hertz.from_load(load, 1 / curvature, YOUNG).contact_radius
    # The wave at 10⁻⁴ is a parabola to (k x)²/12.
    assert CROSSED.small_area_fraction(load) == pytest.approx(np.pi * radius**2, rel=1e-6)


def test_gap_around_a_valley_has_its_volume():
    """The crack under ``p* − p̄ − p* k² r²/4``, by quadrature."""
    missing, full = mp.mpf("0.01"), mp.mpf(CROSSED.complete_pressure)
    load = float(full * (1 - missing))
    edge = mp.sqrt(6 * missing) / (2 * mp.pi)

    def inner(t):
        """∫ tension s ds over s = t sin φ."""
        return mp.quad(
            lambda angle: full * (missing - (mp.pi * t * mp.sin(angle)) ** 2) * t * mp.sin(angle),
            [0, mp.pi / 2],
        )

    assert abs(inner(edge)) < 1e-10 * full * missing
    # The volume ∫ 2π r w dr, integrated first over r from 0 to t.
    volume = 2 * mp.pi * 4 / (mp.pi * mp.mpf(YOUNG)) * mp.quad(lambda t: t * inner(t), [0, edge])
    assert CROSSED.nearly_complete_mean_gap(load) == pytest.approx(float(volume), rel=1e-10)
    assert CROSSED.nearly_complete_area_fraction(load) == pytest.approx(float(1 - mp.pi * edge**2), rel=1e-12)


SPHERE = Hertz(1.0, 1.0)


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: Hertz(np.nan, 1.0), "contact_radius"),
        (lambda: Hertz.from_load(-1.0, 1.0), "load"),
        (lambda: Hertz.from_approach(1.0, 0.0), "curvature_radius"),
        (lambda: SPHERE.stress(0.1, -0.1, 0.3), "depth"),
        (lambda: PeriodicHertz(0.5, 1.0), "below half the period"),
        (lambda: EllipticHertz(1.0, 0.5, -1.0), "largest_pressure"),
        (lambda: EllipticHertz(1.0, 2.0, 1.0), "semi_minor = 2"),
        (lambda: EllipticHertz.from_load(0.0, 2.0, 1.0), "load"),
        (lambda: EllipticHertz.from_load(1.0, 2.0, 3.0), "curvature_radius_y = 3"),
        (lambda: EllipticHertz.from_load(1.0, 1e30, 1.0), "curvature_radius_x = 1e"),
        (lambda: EllipticHertz(2.0, 1.0, 1.0).stress_on_axis(-0.1, 0.3), "depth"),
        (lambda: SlidingSphere(SPHERE, np.nan), "friction = nan"),
        (lambda: SlidingSphere(SPHERE, 0.1).stress(0.0, 0.0, -0.1, 0.3), "depth"),
        (lambda: WAVE.stress(0.2, 0.1, 0.3, "loose"), "lateral"),
        (lambda: Bisinusoid(1.0, wavelength=0.0), "wavelength"),
        (lambda: BondedLayer(0.0, 0.3), "height"),
        (lambda: BondedLayer(1.0, -1.0), "poisson"),
        (lambda: BondedLayer(1.0, 0.51), "poisson"),
        (lambda: BondedLayer(1.0, 0.3, order=0), "order"),
        (lambda: BondedLayer(1.0, 0.3).paraboloid(-1.0, 1.0), "contact_radius"),
        (lambda: Slab(graded(0.5, 2, 1.0), graded(1.0, 2, 1.0), YOUNG, 0.5), "poisson"),
    ],
)
def test_bad_values_are_named(make, named):
    with pytest.raises(ValueError, match=named):
        make()
