"""Random self-affine surfaces: Gaussian heights with the power spectrum of the paper (Eqs. 19 to 21).

A surface is a sum of plane waves. Their amplitudes are independent complex normal deviates times the square
root of a power law between a longest and a shortest wavelength. The deviates are drawn wave by wave, in
square rings of growing integer wavenumber. One seed is therefore **the same surface at every resolution**,
and a smaller shortest wavelength adds waves without changing the longer ones.
"""

import numpy as np

from asperity.core.arguments import LARGEST, SMALLEST, magnitude, number, require_finite, whole_number
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, Grid, mean_square, radial_average

# Relative widening of a band of wavenumbers, so that rounding does not remove waves at its ends.
_BAND_SLACK = 1e-9


def self_affine(
    shape: tuple[int, int],
    hurst: float,
    wavelength_long: float,
    wavelength_short: float,
    rms_height: float,
    seed: int,
    length: float | tuple[float, float] = 1.0,
) -> Array:
    """Gaussian self-affine surface, after equations 19 to 21 of the paper.

    Parameters
    ----------
    shape : (ny, nx)
        Number of nodes on each axis.
    hurst : float
        Hurst exponent H, from 0 to 1: the power spectral density falls as q^-(2 + 2H).
    wavelength_long, wavelength_short : float
        Longest and shortest wavelength of the spectrum, both included, in the unit of `length`. Waves at the
        Nyquist wavenumber of the grid are left out.
    rms_height : float
        Root-mean-square height of this sample, reached exactly; 0 or from 1e-75 to 1e75.
    seed : int
        Seed ≥ 0 of `numpy.random.SeedSequence`.
    length : float or (length_y, length_x)
        Edges of the cell.

    Returns
    -------
    height : (ny, nx) array
        In the unit of `rms_height`, with mean zero.

    Raises
    ------
    TypeError, ValueError
        If an argument is not a number or is out of range, if the grid has fewer than two nodes on the
        shortest wavelength, or if no wave of the spectrum fits the cell.

    Notes
    -----
    The two lines of Eq. 21 are the real and the imaginary part of one deviate Δ(q), made from uniform numbers
    as by G. E. P. Box and M. E. Muller (1958, doi 10.1214/aoms/1177706645). Δ(−q) is the complex conjugate of
    Δ(q), so that the surface is real.

    Examples
    --------
    A surface of 0.2 mm with rms height 0.1 µm; one seed is the same surface on every grid:

    >>> coarse = asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> fine = asp.self_affine((128, 128), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> np.allclose(fine[::2, ::2], coarse, rtol=0, atol=1e-18)
    True
    """
    grid = Grid(shape, length)  # type: ignore[arg-type]
    _require_band(grid, hurst, wavelength_long, wavelength_short)
    rms_height = number(
        "rms_height",
        rms_height,
        f"0 or a number from {SMALLEST:g} to {LARGEST:g}",
        lambda size: size == 0 or SMALLEST <= size <= LARGEST,
    )
    seed = whole_number("seed", seed, "a whole number ≥ 0", lambda value: value >= 0)

    ky, kx, deviate = _deviates(grid, wavelength_short, seed)
    wavenumber = 2 * np.pi * np.hypot(ky / grid.length[0], kx / grid.length[1])
    amplitude = np.sqrt(_power_law(wavenumber, hurst, wavelength_long, wavelength_short))
    in_band = (amplitude > 0) & (2 * np.abs(ky) < grid.shape[0]) & (2 * kx < grid.shape[1])
    if not in_band.any():
        raise ValueError(
            f"wavelength_long = {wavelength_long!r}, wavelength_short = {wavelength_short!r}: "
            f"no wave of this band fits the cell {grid.length} on {grid.shape} nodes"
        )
    ky, kx, mode = ky[in_band], kx[in_band], (amplitude * deviate)[in_band]
    coefficients = np.zeros(grid.mode_shape, complex)
    coefficients[ky, kx] = mode
    axis = kx == 0
    coefficients[-ky[axis], 0] = mode[axis].conj()
    coefficients *= rms_height / np.sqrt(mean_square(coefficients, grid))
    height = Fourier(grid).inverse(coefficients, overwrite=True)
    require_finite("self_affine", {"height": height})
    return height


def _deviates(grid: Grid, wavelength_short: float, seed: int) -> tuple[Array, Array, Array]:
    """Integer wavenumbers ky, kx of half the plane of waves, and their complex normal deviates (Eq. 21).

    Waves are sorted by square rings max(|ky|, |kx|), so that a smaller `wavelength_short` appends waves.
    """
    largest = int(max(grid.length) / wavelength_short * (1 + _BAND_SLACK))
    ky, kx = (k.ravel() for k in np.mgrid[-largest : largest + 1, 0 : largest + 1])
    half = (kx > 0) | (ky > 0)
    ky, kx = ky[half], kx[half]
    order = np.lexsort((kx, ky, np.maximum(np.abs(ky), kx)))
    ky, kx = ky[order], kx[order]
    uniform = np.random.default_rng(np.random.SeedSequence(seed)).random((ky.size, 2))
    deviate = np.sqrt(-2 * np.log1p(-uniform[:, 0])) * np.exp(2j * np.pi * uniform[:, 1])
    return ky, kx, deviate


def _power_law(wavenumber: Array, hurst: float, wavelength_long: float, wavelength_short: float) -> Array:
    """Power spectral density C(q)/C_0 of Eq. 19; zero outside the band."""
    lowest, highest = 2 * np.pi / wavelength_long, 2 * np.pi / wavelength_short
    band = (wavenumber >= lowest * (1 - _BAND_SLACK)) & (wavenumber <= highest * (1 + _BAND_SLACK))
    ratio = np.divide(lowest, wavenumber, out=np.zeros_like(wavenumber), where=band)
    return ratio ** (2 * hurst + 2)


def _require_band(grid: Grid, hurst: float, wavelength_long: float, wavelength_short: float) -> None:
    """Raise an error if the parameters of a spectrum are out of range, or if the grid is too coarse."""
    number("hurst", hurst, "a number from 0 to 1", lambda exponent: 0 <= exponent <= 1)
    magnitude("wavelength_long", wavelength_long)
    magnitude("wavelength_short", wavelength_short)
    if wavelength_short > wavelength_long:
        raise ValueError(
            f"wavelength_short = {wavelength_short!r}: at most {wavelength_long!r}, the longest, is needed"
        )
    shortest_held = 2 * max(grid.spacing)
    if wavelength_short < shortest_held * (1 - _BAND_SLACK):
        raise ValueError(
            f"wavelength_short = {wavelength_short!r}: at least two nodes are needed, {shortest_held!r} here"
        )


def target_spectrum(
    grid: Grid, hurst: float, wavelength_long: float, wavelength_short: float, rms_height: float
) -> tuple[Array, Array]:
    """Expected `spectrum` of `self_affine` surfaces: Eq. 19 with C_0 set by the rms height.

    Parameters and errors as for `self_affine`, result as of `spectrum`, on the same rings.
    """
    _require_band(grid, hurst, wavelength_long, wavelength_short)
    power = _power_law(grid.wavenumber(), hurst, wavelength_long, wavelength_short)
    power *= rms_height**2 / grid.sum_over_modes(power)
    return radial_average(grid.area * power, grid)
