"""Asymptotes of bisinusoidal contact against quadrature and against principal pivoting on a grid."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from asperity.fourier.grid import Grid
from asperity.reference.bisinusoid import Bisinusoid
from asperity.reference.hertz import Hertz
from asperity.reference.pivoting import pivot

WAVE = Bisinusoid(amplitude=0.02, wavelength=1.0, effective_modulus=1.7)


def solved(load: float, points: int) -> tuple[float, float]:
    """Area fraction and mean gap at a load over p*, by the direct solution with the compliance 2/(E* q)."""
    grid = Grid((points, points))
    y, x = grid.coordinates()
    q = grid.wavenumber()
    compliance = np.divide(2, 1.7 * q, out=np.zeros_like(q), where=q > 0)
    height = WAVE.height(y[:, None], x)
    # The lowest part of the wave as first guess of the contact.
    guess = height <= np.quantile(height, min(4 * load, 1.0))
    pressure = pivot(height, compliance, mean_pressure=load * WAVE.complete_pressure, guess=guess)
    displaced = height + np.fft.irfft2(compliance * np.fft.rfft2(pressure), grid.shape)
    gap = displaced - displaced[pressure > 0].mean()
    return float(np.mean(pressure > 0)), float(gap.mean())


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


def test_nearly_complete_contact_on_a_grid() -> None:
    """The gap is eight nodes across, and its radius known to half a node."""
    load = 0.95
    area, gap = solved(load, 48)
    assert 1 - area == pytest.approx(
        1 - WAVE.nearly_complete_area_fraction(load * WAVE.complete_pressure), rel=0.15
    )
    assert gap == pytest.approx(WAVE.nearly_complete_mean_gap(load * WAVE.complete_pressure), rel=0.05)


def test_small_contact_on_a_grid() -> None:
    """A count of contact nodes, 14 to the radius, and what the cosine and the neighbours add to Hertz."""
    load = 0.01
    area, _ = solved(load, 128)
    assert area == pytest.approx(WAVE.small_area_fraction(load * WAVE.complete_pressure), rel=0.06)


def test_bad_values_are_named() -> None:
    with pytest.raises(ValueError, match="wavelength"):
        Bisinusoid(1.0, wavelength=0.0)
