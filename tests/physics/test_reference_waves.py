"""Westergaard's wave and the bisinusoid; refusals of all closed forms."""

import mpmath as mp
import numpy as np
import pytest
from samples import refuses

from asperity.elasticity.solid import Solid
from asperity.fourier.grid import Grid
from asperity.reference.bisinusoid import Bisinusoid
from asperity.reference.bonded_layer import BondedLayer
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.finite_element import Slab, graded
from asperity.reference.hertz import Hertz
from asperity.reference.periodic_hertz import PeriodicHertz
from asperity.reference.sliding_sphere import SlidingSphere
from asperity.reference.westergaard import Westergaard

YOUNG = 1.7
WAVE = Westergaard(mean_pressure=0.1, amplitude=0.05, wavelength=1.3, effective_modulus=YOUNG)
CELL = 1.3 * (np.arange(20000) + 0.5) / 20000
CROSSED = Bisinusoid(amplitude=0.02, wavelength=1.0, effective_modulus=YOUNG)


def test_wave_is_the_sum_of_its_modes():
    """Displacement u(q) = 2 p(q)/(E* q), and stress; aliasing of the square root."""
    n, depth = 16384, 0.09
    x = 1.3 * np.arange(n) / n
    pressure = np.fft.rfft(WAVE.pressure(x))
    q = 2 * np.pi / 1.3 * np.arange(1, n // 2 + 1)
    moved = np.fft.irfft(np.concatenate([[0], 2 * pressure[1:] / (YOUNG * q)]), n)
    np.testing.assert_allclose(WAVE.displacement(x), moved, atol=4e-6 * WAVE.amplitude)
    assert WAVE.gap(CELL).mean() == pytest.approx(WAVE.mean_gap, rel=1e-6)
    q, places = 2 * np.pi / 1.3 * np.arange(120), np.array([0.0, 0.2, 0.7])
    modes = np.where(q > 0, 2, 1) * pressure[:120].real / n * np.exp(1j * np.outer(places, q))
    total = (modes @ Solid(1.0, 0.3).stress(q, 0.0, depth)).real
    np.testing.assert_allclose(WAVE.stress(places, depth, 0.3), total, atol=5e-7)


def test_mean_mode_of_a_wave():
    """Free and confined cells differ by it, and deep down it is all there is."""
    difference = WAVE.stress(0.2, 0.1, 0.3, "free") - WAVE.stress(0.2, 0.1, 0.3, "confined")
    np.testing.assert_allclose(difference, 0.1 * 3 / 7 * np.array([1, 1, 0, 0, 0, 0]), atol=1e-15)
    deep = WAVE.stress(0.3, 1e4, 0.3)
    np.testing.assert_allclose(deep, 0.1 * np.array([-3 / 7, -3 / 7, -1, 0, 0, 0]), atol=1e-16)


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
    assert CROSSED.nearly_complete_contact_area_fraction(load) == pytest.approx(
        float(1 - mp.pi * edge**2), rel=1e-12
    )


SPHERE = Hertz(1.0, 1.0)


test_bad_values_are_named = refuses(
    (lambda: Hertz(np.nan, 1.0), "contact_radius"),
    (lambda: SPHERE.stress(0.1, -0.1, 0.3), ".*depth"),
    (lambda: PeriodicHertz(0.5, 1.0), "contact_radius = 0.5: below half the period"),
    (lambda: EllipticHertz(1.0, 2.0, 1.0), "semi_minor = 2"),
    (lambda: EllipticHertz.from_load(1.0, 2.0, 3.0), "curvature_radius_y = 3"),
    (lambda: SlidingSphere(SPHERE, np.nan), "friction = nan"),
    (lambda: WAVE.stress(0.2, 0.1, 0.3, "loose"), "lateral"),
    (lambda: Bisinusoid(1.0, wavelength=0.0), "wavelength"),
    (lambda: BondedLayer(0.0, 0.3), "height"),
    (lambda: BondedLayer(1.0, 0.3).paraboloid(-1.0, 1.0), "contact_radius"),
    (lambda: Slab(graded(0.5, 2, 1.0), graded(1.0, 2, 1.0), YOUNG, 0.5), "poisson"),
)
