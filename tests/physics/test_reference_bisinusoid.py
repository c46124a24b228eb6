"""Bisinusoidal contact against quadrature; `test_validation.py` compares it with solved contacts."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from asperity.fourier.grid import Grid
from asperity.reference.bisinusoid import Bisinusoid
from asperity.reference.hertz import Hertz

WAVE = Bisinusoid(amplitude=0.02, wavelength=1.0, effective_modulus=1.7)


def test_complete_contact_is_that_of_two_modes() -> None:
    """Mode by mode the pressure is E* q/2 times the displacement."""
    grid = Grid((8, 8))
    y, x = grid.coordinates()
    height = WAVE.height(y[:, None], x)
    modes = -1.7 * grid.wavenumber() / 2 * np.fft.rfft2(height)
    modes[0, 0] = 0.3 * 64
    expected = np.fft.irfft2(modes, grid.shape)
    np.testing.assert_allclose(WAVE.complete_contact_pressure(y[:, None], x, 0.3), expected, rtol=1e-13)
    assert WAVE.complete_contact_pressure(0.5, 0.5, WAVE.complete_pressure) == pytest.approx(0.0, abs=1e-16)


def test_small_contact_is_hertz_at_every_peak() -> None:
    load = 1e-4 * WAVE.complete_pressure
    curvature = (WAVE.height(0.0, 1e-4) / 0.5e-8).item()
    radius = Hertz.from_load(load, 1 / curvature, 1.7).contact_radius
    # The wave at 10⁻⁴ is a parabola to (k x)²/12.
    assert WAVE.small_area_fraction(load) == pytest.approx(np.pi * radius**2, rel=1e-6)


def test_gap_around_a_valley_has_the_given_volume() -> None:
    """The crack under ``p* − p̄ − p* k² r²/4``, by quadrature."""
    missing, full = mp.mpf("0.01"), mp.mpf(WAVE.complete_pressure)
    load = float(full * (1 - missing))
    edge = mp.sqrt(6 * missing) / (2 * mp.pi)

    def tension(r):
        return full * (missing - (mp.pi * r) ** 2)

    def inner(t):
        # With s = t sin φ.
        return mp.quad(lambda angle: tension(t * mp.sin(angle)) * t * mp.sin(angle), [0, mp.pi / 2])

    assert abs(inner(edge)) < 1e-10 * full * missing
    # The volume ∫ 2π r w dr, integrated first over r from 0 to t.
    volume = 2 * mp.pi * 4 / (mp.pi * mp.mpf(1.7)) * mp.quad(lambda t: t * inner(t), [0, edge])
    assert WAVE.nearly_complete_mean_gap(load) == pytest.approx(float(volume), rel=1e-10)
    assert WAVE.nearly_complete_area_fraction(load) == pytest.approx(float(1 - mp.pi * edge**2), rel=1e-12)


def test_bad_values_are_named() -> None:
    with pytest.raises(ValueError, match="wavelength"):
        Bisinusoid(1.0, wavelength=0.0)
