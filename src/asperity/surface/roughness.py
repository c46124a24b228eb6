"""Random rough surfaces: self-affine Gaussian fields, their Johnson transforms, and their measures.

A surface is the height ``h[y, x]`` of the indenter's lower face, measured upward, with mean zero.
Its Gaussian form is a sum of waves whose amplitudes are independent complex normal deviates times
the square root of a power law between a longest and a shortest wavelength (Eqs. 19-21 of the paper).
The deviates are drawn wave by wave, in rings of growing wavenumber: **the same seed is the same
surface at every resolution**, and a shorter cut-off adds waves without changing the longer ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import expit

from asperity.spectral import Fourier, Grid, mean_square, radial_average
from asperity.types import Array

# The band of a spectrum includes its ends, which rounding must not remove.
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
    """Gaussian self-affine surface.

    Parameters
    ----------
    shape : (ny, nx)
        Nodes of the grid.
    hurst : float
        Hurst exponent H, 0 to 1: the power spectral density falls as q^-(2 + 2H).
    wavelength_long, wavelength_short : float
        Ends of the spectrum, both included; a wave at the grid's Nyquist wavenumber is left out.
    rms_height : float
        Root-mean-square height of this sample, reached exactly.
    seed : int
        Seed of `numpy.random.SeedSequence`.
    length : float or (length_y, length_x)
        Edges of the cell.

    Returns
    -------
    height : (ny, nx) array
        In the unit of `length`, mean zero.

    Raises
    ------
    ValueError
        If an argument is out of range, the grid cannot hold the shortest wavelength, or the cell
        holds no wave of the band.

    Notes
    -----
    Eqs. 19-21, with Δ(−q) = conj Δ(q) so that the surface is real; the two lines of Eq. 21 are the
    real and imaginary part of one deviate.
    """
    grid = Grid(shape, length)  # type: ignore[arg-type]
    _check_band(grid, hurst, wavelength_long, wavelength_short)
    if not (np.isfinite(rms_height) and rms_height >= 0):
        raise ValueError(f"rms_height = {rms_height!r}: a finite number ≥ 0 is needed")
    if int(seed) != seed or seed < 0:
        raise ValueError(f"seed = {seed!r}: a whole number ≥ 0 is needed")

    ky, kx, deviate = _deviates(grid, wavelength_short, seed)
    wavenumber = 2 * np.pi * np.hypot(ky / grid.length[0], kx / grid.length[1])
    amplitude = np.sqrt(_power_law(wavenumber, hurst, wavelength_long, wavelength_short))
    held = (amplitude > 0) & (2 * np.abs(ky) < grid.shape[0]) & (2 * kx < grid.shape[1])
    if not held.any():
        raise ValueError(
            f"wavelength_long = {wavelength_long!r}, wavelength_short = {wavelength_short!r}: "
            f"no wave of this band fits the cell {grid.length} on {grid.shape} nodes"
        )
    ky, kx, mode = ky[held], kx[held], (amplitude * deviate)[held]
    coefficients = np.zeros(grid.half_shape, complex)
    coefficients[ky, kx] = mode
    axis = kx == 0
    coefficients[-ky[axis], 0] = mode[axis].conj()
    coefficients *= rms_height / np.sqrt(mean_square(coefficients, grid))
    return Fourier(grid).inverse(coefficients, overwrite=True)


def _deviates(grid: Grid, wavelength_short: float, seed: int) -> tuple[Array, Array, Array]:
    """Complex normal deviates of half the plane of waves, ring after ring (Eq. 21, Box-Muller)."""
    largest = int(max(grid.length) / wavelength_short * (1 + _BAND_SLACK))
    ky, kx = (k.ravel() for k in np.mgrid[-largest : largest + 1, 0 : largest + 1])
    half = (kx > 0) | (ky > 0)
    ky, kx = ky[half], kx[half]
    order = np.lexsort((kx, ky, np.maximum(np.abs(ky), kx)))
    ky, kx = ky[order], kx[order]
    uniform = np.random.default_rng(np.random.SeedSequence(int(seed))).random((ky.size, 2))
    deviate = np.sqrt(-2 * np.log1p(-uniform[:, 0])) * np.exp(2j * np.pi * uniform[:, 1])
    return ky, kx, deviate


def _power_law(wavenumber: Array, hurst: float, wavelength_long: float, wavelength_short: float) -> Array:
    """C(q)/C_0 of Eq. 19, zero outside the band."""
    lowest, highest = 2 * np.pi / wavelength_long, 2 * np.pi / wavelength_short
    band = (wavenumber >= lowest * (1 - _BAND_SLACK)) & (wavenumber <= highest * (1 + _BAND_SLACK))
    ratio = np.divide(lowest, wavenumber, out=np.zeros_like(wavenumber), where=band)
    return ratio ** (2 * hurst + 2)


def _check_band(grid: Grid, hurst: float, wavelength_long: float, wavelength_short: float) -> None:
    if not 0 <= hurst <= 1:
        raise ValueError(f"hurst = {hurst!r}: a number from 0 to 1 is needed")
    for name, value in (("wavelength_long", wavelength_long), ("wavelength_short", wavelength_short)):
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value!r}: a positive finite length is needed")
    if wavelength_short > wavelength_long:
        raise ValueError(
            f"wavelength_short = {wavelength_short!r}: at most {wavelength_long!r}, the longest, is needed"
        )
    shortest_held = 2 * max(grid.spacing)
    if wavelength_short < shortest_held * (1 - _BAND_SLACK):
        raise ValueError(
            f"wavelength_short = {wavelength_short!r}: at least two nodes are needed, {shortest_held!r} here"
        )


def johnson(height: Array, gamma: float, delta: float, zeta: float = -4.0, lam: float = 8.0) -> Array:
    """Johnson's bounded transform of a Gaussian surface (Eq. 23).

    The heights are standardised, transformed to the interval (ζ, ζ + λ), centred again and brought
    back to their original rms height.

    Parameters
    ----------
    height : (ny, nx) array
    gamma : float
        Positive: a long tail upward, so blunt contacts on the lower face; negative: the mirror image.
    delta : float
        Positive; the smaller, the more skewed.
    zeta, lam : float
        Lower bound and width of the interval before rescaling; λ > 0.

    Returns
    -------
    height : (ny, nx) array
        With the mean zero and the rms height of the input.

    Raises
    ------
    ValueError
        If γ or ζ is not finite, δ or λ not positive, the input not finite or without variation, or the
        transformed heights are all the same in floating point.

    Notes
    -----
    N. L. Johnson, Biometrika 36 (1949) 149, doi 10.2307/2332539. The rescaling undoes ζ and λ. The curve is
    taken from the bound that it comes nearest to, where it would be lost beside the width of the interval.
    """
    for name, value in (("gamma", gamma), ("zeta", zeta)):
        if not np.isfinite(value):
            raise ValueError(f"{name} = {value!r}: a finite number is needed")
    for name, value in (("delta", delta), ("lam", lam)):
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value!r}: a positive finite number is needed")
    normal = (_standardised(height) - gamma) / delta
    transformed = expit(normal) if gamma >= 0 else -expit(-normal)
    if np.ptp(transformed) == 0:
        raise ValueError(f"gamma = {gamma!r}, delta = {delta!r}: all heights come to lie at one bound")
    return _rescaled(transformed, height)


def with_moments(height: Array, skewness: float, kurtosis: float) -> Array:
    """Johnson's transform with a given skewness and kurtosis of a Gaussian surface's heights.

    The bounded curve (S_B) where it reaches these moments, else the unbounded one (S_U). The moments
    are those of a transformed normal variable; a sample's own scatter about them as any sample does.

    Parameters
    ----------
    height : (ny, nx) array
    skewness, kurtosis : float
        Kurtosis 3 is a Gaussian's; it exceeds 1 + skewness² for any distribution.

    Returns
    -------
    height : (ny, nx) array
        With the mean zero and the rms height of the input.

    Raises
    ------
    ValueError
        If no curve of the family has these moments, or the input has no variation.

    Notes
    -----
    N. L. Johnson, Biometrika 36 (1949) 149, doi 10.2307/2332539.
    """
    for curve in (expit, np.sinh):
        gamma, delta, misfit = _fit(curve, skewness, kurtosis)
        if misfit < 1e-8:
            standard = _standardised(height)
            return _rescaled(curve((standard - gamma) / delta), height)
    raise ValueError(
        f"skewness = {skewness!r}, kurtosis = {kurtosis!r}: no Johnson curve has these moments; "
        f"a kurtosis above {1 + skewness**2:.3g}, not too large, is needed"
    )


def _fit(curve: Callable[[Array], Array], skewness: float, kurtosis: float) -> tuple[float, float, float]:
    """γ and δ of the curve whose transformed normal comes nearest to the moments, and the distance."""

    def residual(shape: Array) -> Array:
        found = _moments(curve((_NORMAL_NODES - shape[0]) / np.exp(shape[1])), _NORMAL_WEIGHTS)
        return np.array(found[1:]) - (skewness, kurtosis)

    # Imported here: half a second that no other surface needs.
    from scipy.optimize import least_squares

    fit = least_squares(residual, (0.0, 0.3), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    return fit.x[0], np.exp(fit.x[1]), float(np.abs(fit.fun).max())


_NORMAL_NODES, _NORMAL_WEIGHTS = np.polynomial.hermite_e.hermegauss(200)
_NORMAL_WEIGHTS /= _NORMAL_WEIGHTS.sum()


def _standardised(height: Array) -> Array:
    """The heights with mean zero and rms one."""
    if not np.all(np.isfinite(height)):
        raise ValueError("height: finite heights are needed")
    rms_height = float(np.std(height))
    if rms_height == 0:
        raise ValueError("height: a surface that varies is needed, this one is flat")
    return (height - np.mean(height)) / rms_height


def _rescaled(transformed: Array, height: Array) -> Array:
    """Transformed heights, centred, with the rms height of the original ones."""
    # Heights of the order of one, whose squares do not underflow.
    centred = transformed / np.abs(transformed).max()
    centred -= np.mean(centred)
    return centred * (np.std(height) / np.std(centred))


def _moments(values: Array, weights: Array) -> tuple[float, float, float]:
    """Variance, skewness, kurtosis of weighted values."""
    centred = values - weights @ values
    variance = weights @ centred**2
    if variance == 0:
        return 0.0, float("nan"), float("nan")
    return variance, (weights @ centred**3) / variance**1.5, (weights @ centred**4) / variance**2


@dataclass(frozen=True)
class Measures:
    """What a profilometer would report of a surface."""

    rms_height: float
    rms_gradient: float
    skewness: float
    kurtosis: float


def roughness_parameters(height: Array, length: float | tuple[float, float] = 1.0) -> Measures:
    """Moments of a periodic surface; kurtosis 3 for a Gaussian, gradient by spectral derivative."""
    grid = Grid(np.shape(height), length)  # type: ignore[arg-type]
    heights = np.ravel(height)
    variance, skewness, kurtosis = _moments(heights, np.full(heights.size, 1 / heights.size))
    squared_wavenumber = grid.odd_qy[:, None] ** 2 + grid.odd_qx[None, :] ** 2
    return Measures(
        rms_height=float(variance**0.5),
        rms_gradient=mean_square(Fourier(grid).forward(height), grid, squared_wavenumber) ** 0.5,
        skewness=float(skewness),
        kurtosis=float(kurtosis),
    )


def spectrum(height: Array, length: float | tuple[float, float] = 1.0) -> tuple[Array, Array]:
    """Radially averaged power spectral density, cell area times |ĥ(q)|², against |q|."""
    grid = Grid(np.shape(height), length)  # type: ignore[arg-type]
    power = np.abs(Fourier(grid).forward(height)) ** 2
    return radial_average(grid.area * power, grid)


def target_spectrum(
    grid: Grid, hurst: float, wavelength_long: float, wavelength_short: float, rms_height: float
) -> tuple[Array, Array]:
    """The ensemble's `spectrum`: Eq. 19 with C_0 set by the rms height, averaged over the same rings."""
    power = _power_law(grid.wavenumber(), hurst, wavelength_long, wavelength_short)
    power *= rms_height**2 / np.sum(power @ grid.multiplicity)
    return radial_average(grid.area * power, grid)
