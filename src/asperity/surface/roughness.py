"""Random rough surfaces: self-affine Gaussian surfaces, non-Gaussian transforms, roughness parameters.

A surface is an array of heights ``h[y, x]`` of a periodic cell: the lower face of the rigid indenter,
measured upward, with mean zero. Heights and lengths have one unit, which is the user's choice.

Gaussian surfaces are sums of plane waves. Their amplitudes are independent complex normal deviates times the
square root of a power law between a longest and a shortest wavelength (Eqs. 19 to 21 of the paper). The
deviates are drawn wave by wave, in square rings of growing integer wavenumber. One seed is therefore **the
same surface at every resolution**, and a smaller shortest wavelength adds waves without changing the longer
ones.

Non-Gaussian surfaces are made from Gaussian ones with Johnson's translation system of distributions (Eq. 23).
Hu and Tonder (1992) use the same system for rough surfaces, but transform uncorrelated numbers and filter
them afterwards. Here the finished Gaussian surface is transformed: the moments of the heights are those of
the Johnson curve, and the spectrum differs somewhat from that of the Gaussian surface.

References
----------
N. L. Johnson, Biometrika 36 (1949) 149, doi 10.2307/2332539.
Y. Z. Hu and K. Tonder, Int. J. Mach. Tools Manufact. 32 (1992) 83, doi 10.1016/0890-6955(92)90064-N.
T. D. B. Jacobs, T. Junge and L. Pastewka, Surf. Topogr.: Metrol. Prop. 5 (2017) 013001,
doi 10.1088/2051-672X/aa51f8 (conventions of power spectra).
ISO 25178-2 (names of areal roughness parameters).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import expit

from asperity.arguments import LARGEST, SMALLEST, magnitude, number, real_array, whole_number
from asperity.finite import require_finite
from asperity.spectral import Fourier, Grid, mean_square, radial_average
from asperity.types import Array

# Relative widening of a band of wavenumbers, so that rounding does not remove waves at its ends.
_BAND_SLACK = 1e-9

# Largest δ of the bounded curve: the curve is then straight to a part in a million, and six digits are lost.
_LARGEST_DELTA = 1e6

# Smallest δ at which the Gauss-Hermite rule below gives the moments of the bounded curve to a part in a
# thousand; found by comparison with a sum over 20001 equidistant nodes.
_SMALLEST_FITTED_DELTA = 0.15

# Largest kurtosis at which the rule gives the moments of the unbounded curve to twelve digits, found
# likewise.
_LARGEST_KURTOSIS = 1e6

# Largest difference between the moments asked for and those of a fitted curve.
_FIT_TOLERANCE = 1e-8

_ANY_SIGN = f"a number from {-LARGEST:g} to {LARGEST:g}"


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


def johnson(height: Array, gamma: float, delta: float, zeta: float = -4.0, lam: float = 8.0) -> Array:
    """Johnson's bounded transform (S_B) of a Gaussian surface, equation 23 of the paper.

    The heights are scaled to unit standard deviation, mapped to the interval (ζ, ζ + λ) by

        ζ + λ / (1 + exp((γ − h)/δ)),

    centred, and scaled back to their original rms height. The last step undoes ζ and λ, which therefore have
    no effect; they are kept as arguments because Eq. 23 has them.

    Parameters
    ----------
    height : (ny, nx) array
        Gaussian heights.
    gamma : float
        Position γ of the curve. Positive: the heights have a long tail upward and the lower face blunt
        contacts; negative: the mirror image.
    delta : float
        Width δ of the curve, from 1e-75 to 1e6; the smaller, the more skewed are the heights.
    zeta, lam : float
        Lower bound ζ and width λ > 0 of the interval.

    Returns
    -------
    height : (ny, nx) array
        In the unit of the input, with mean zero and the rms height of the input.

    Raises
    ------
    TypeError, ValueError
        If a parameter is not a number or is out of range, if the heights are not finite or all equal, or if
        the transformed heights are all equal in floating point.

    Notes
    -----
    Johnson (1949). The exponential is evaluated relative to the bound that most heights are near to; relative
    to the other bound they could not be told apart in floating point.

    Examples
    --------
    >>> gaussian = asp.self_affine((64, 64), 0.8, 0.25, 0.125, rms_height=1e-3, seed=1)
    >>> blunt = asp.johnson(gaussian, gamma=2.0, delta=1.0)
    >>> asp.roughness_parameters(blunt).skewness > 0.5
    True
    """
    heights = _varying_heights(height)
    gamma = number("gamma", gamma, _ANY_SIGN, lambda position: abs(position) <= LARGEST)
    delta = number(
        "delta",
        delta,
        f"a number > 0, from {SMALLEST:g} to {_LARGEST_DELTA:g},",
        lambda width: SMALLEST <= width <= _LARGEST_DELTA,
    )
    number("zeta", zeta, _ANY_SIGN, lambda bound: abs(bound) <= LARGEST)
    magnitude("lam", lam)
    normal = (_standardised(heights) - gamma) / delta
    transformed = expit(normal) if gamma >= 0 else -expit(-normal)
    if np.ptp(transformed) == 0:
        raise ValueError(
            f"gamma = {gamma!r}, delta = {delta!r}: a smaller gamma or a larger delta is needed, "
            "all heights are mapped to one bound"
        )
    found = _rescaled(transformed, heights)
    require_finite("johnson", {"height": found})
    return found


def with_moments(height: Array, skewness: float, kurtosis: float) -> Array:
    """Johnson's transform with a given skewness and kurtosis, of a Gaussian surface.

    The bounded curve (S_B) is used where it reaches these moments, else the unbounded one (S_U). Skewness 0
    and kurtosis 3, those of a Gaussian surface, leave the surface as it is.

    Parameters
    ----------
    height : (ny, nx) array
        Gaussian heights.
    skewness, kurtosis : float
        Moments of a transformed normal variable; a finite sample scatters about them. The kurtosis (3 for a
        Gaussian) of any distribution exceeds 1 + skewness²; a curve is found from about 1.2 + 1.1 skewness²
        to 1e6, except close to the moments of a lognormal distribution.

    Returns
    -------
    height : (ny, nx) array
        In the unit of the input, with mean zero and the rms height of the input.

    Raises
    ------
    TypeError, ValueError
        If an argument is not a number, if no curve with these moments is found, or if the heights are not
        finite or all equal.

    Notes
    -----
    Johnson (1949). The parameters γ and δ are fitted by least squares to the moments by Gauss-Hermite
    quadrature.

    Examples
    --------
    >>> gaussian = asp.self_affine((256, 256), 0.8, 1 / 16, 1 / 32, rms_height=1e-3, seed=1)
    >>> peaky = asp.with_moments(gaussian, skewness=0.0, kurtosis=5.0)
    >>> round(asp.roughness_parameters(peaky).kurtosis)
    5
    """
    heights = _varying_heights(height)
    skewness, kurtosis = _checked_moments(skewness, kurtosis)
    standard = _standardised(heights)
    if (skewness, kurtosis) == (0.0, 3.0):
        found = _rescaled(standard, heights)
    else:
        curve, gamma, delta = _fitted_curve(skewness, kurtosis)
        with np.errstate(over="ignore", invalid="ignore"):  # refused by _rescaled
            found = _rescaled(curve((standard - gamma) / delta), heights)
    require_finite("with_moments", {"height": found})
    return found


def _fitted_curve(skewness: float, kurtosis: float) -> tuple[Callable[[Array], Array], float, float]:
    """The curve with these moments, and its parameters γ and δ."""
    for curve in (expit, np.sinh):
        gamma, delta, misfit = _fit(curve, skewness, kurtosis)
        if misfit < _FIT_TOLERANCE and (curve is np.sinh or delta >= _SMALLEST_FITTED_DELTA):
            return curve, gamma, delta
    raise ValueError(
        f"skewness = {skewness!r}, kurtosis = {kurtosis!r}: no Johnson curve with these moments was found; "
        f"a kurtosis from about {1.2 + 1.1 * skewness**2:.3g} to {_LARGEST_KURTOSIS:g}, "
        "not close to that of a lognormal distribution, is needed"
    )


def _checked_moments(skewness: float, kurtosis: float) -> tuple[float, float]:
    """Skewness and kurtosis as floats, checked."""
    highest = _LARGEST_KURTOSIS
    most = highest**0.5  # the kurtosis exceeds the square of the skewness
    return (
        number("skewness", skewness, f"a number from {-most:g} to {most:g}", lambda n: abs(n) <= most),
        number("kurtosis", kurtosis, f"a number from 1 to {highest:g}", lambda n: 1 <= n <= highest),
    )


def _fit(curve: Callable[[Array], Array], skewness: float, kurtosis: float) -> tuple[float, float, float]:
    """Parameters γ and δ of the curve that comes nearest to the moments, and the largest difference left."""

    def residual(shape: Array) -> Array:
        found = _moments(curve((_NORMAL_NODES - shape[0]) / np.exp(shape[1])), _NORMAL_WEIGHTS)
        return np.array(found[1:]) - (skewness, kurtosis)

    # Imported here because it takes half a second and other surfaces do not need it.
    from scipy.optimize import least_squares

    fit = least_squares(residual, (0.0, 0.3), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    return fit.x[0], np.exp(fit.x[1]), float(np.abs(fit.fun).max())


# Gauss-Hermite rule for averages over a normal variable.
_NORMAL_NODES, _NORMAL_WEIGHTS = np.polynomial.hermite_e.hermegauss(200)
_NORMAL_WEIGHTS /= _NORMAL_WEIGHTS.sum()


def _heights(height: ArrayLike) -> Array:
    """Heights as a float64 array, checked."""
    values = real_array("height", height)
    if values.ndim != 2 or values.size == 0:
        raise ValueError(
            f"height of shape {values.shape}: an array (ny, nx) with at least one height is needed"
        )
    wrong = ~(np.abs(values) <= min(LARGEST, float(np.finfo(values.dtype).max)))
    if wrong.any():
        raise ValueError(
            f"height = {values[wrong][0]}: finite heights, at most {LARGEST:g} in size, are needed"
        )
    return values.astype(np.float64)


def _varying_heights(height: ArrayLike) -> Array:
    """Heights as a float64 array, checked, and not all equal."""
    values = _heights(height)
    if np.ptp(values) < SMALLEST:
        raise ValueError(
            f"height: heights that differ by at least {SMALLEST:g} are needed, this surface is flat"
        )
    return values


def _standardised(height: Array) -> Array:
    """The heights with mean zero and standard deviation one."""
    return (height - np.mean(height)) / float(np.std(height))


def _rescaled(transformed: Array, height: Array) -> Array:
    """The transformed heights, centred, with the rms height of the original ones."""
    # Scaled to a largest magnitude of one first, so that squares do not underflow.
    centred = transformed / np.abs(transformed).max()
    centred -= np.mean(centred)
    rms_height = np.std(centred)
    if not (np.isfinite(rms_height) and rms_height > 0):
        raise ValueError(
            "height: a surface without extreme peaks is needed, the transformed heights overflow"
        )
    return centred * (np.std(height) / rms_height)


def _moments(values: Array, weights: Array) -> tuple[float, float, float]:
    """Variance, skewness and kurtosis of weighted values; the last two are NaN if all values are equal."""
    centred = values - weights @ values
    power = centred * centred
    variance = weights @ power
    if variance == 0:
        return 0.0, float("nan"), float("nan")
    power *= centred
    third = weights @ power
    power *= centred
    return variance, third / variance**1.5, (weights @ power) / variance**2


@dataclass(frozen=True)
class RoughnessParameters:
    """Areal roughness parameters of a periodic surface, with their symbols in ISO 25178-2.

    Attributes
    ----------
    rms_height : float
        Root-mean-square height about the mean (Sq), in the unit of the heights.
    rms_gradient : float
        Root-mean-square gradient (Sdq), by spectral derivative: √⟨|∇h|²⟩, the unit of the heights over that
        of the lengths.
    skewness : float
        ⟨h³⟩/⟨h²⟩^(3/2) (Ssk); 0 for a Gaussian surface.
    kurtosis : float
        ⟨h⁴⟩/⟨h²⟩² (Sku); 3 for a Gaussian surface.
    """

    rms_height: float
    rms_gradient: float
    skewness: float
    kurtosis: float


def roughness_parameters(height: Array, length: float | tuple[float, float] = 1.0) -> RoughnessParameters:
    """Root-mean-square height and gradient, skewness and kurtosis of a periodic surface.

    Parameters
    ----------
    height : (ny, nx) array
    length : float or (length_y, length_x)
        Edges of the cell.

    Returns
    -------
    RoughnessParameters

    Raises
    ------
    TypeError, ValueError
        If the heights are not real numbers, not finite or all equal, or the edges are not positive numbers.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> roughness = asp.roughness_parameters(height, length=2e-4)
    >>> print(f"{roughness.rms_height * 1e9:.0f} nm, gradient {roughness.rms_gradient:.4f}")
    100 nm, gradient 0.0114
    """
    values = _varying_heights(height)
    grid = Grid(values.shape, length)  # type: ignore[arg-type]
    heights = np.ravel(values)
    variance, skewness, kurtosis = _moments(heights, np.full(heights.size, 1 / heights.size))
    squared_wavenumber = grid.odd_qy[:, None] ** 2 + grid.odd_qx[None, :] ** 2
    found = RoughnessParameters(
        rms_height=float(variance**0.5),
        rms_gradient=mean_square(Fourier(grid).forward(values), grid, squared_wavenumber) ** 0.5,
        skewness=float(skewness),
        kurtosis=float(kurtosis),
    )
    require_finite("roughness_parameters", asdict(found))
    return found


def spectrum(height: Array, length: float | tuple[float, float] = 1.0) -> tuple[Array, Array]:
    """Radially averaged power spectral density of a periodic surface.

    Parameters
    ----------
    height : (ny, nx) array
    length : float or (length_y, length_x)
        Edges of the cell, in the unit of the heights.

    Returns
    -------
    wavenumber : (rings,) array
        |q| in radians per length, the rings of `asperity.spectral.radial_average`.
    power : (rings,) array
        Two-dimensional power spectral density C(q) = A |ĥ(q)|², A the area of the cell, in length⁴: the
        convention of Jacobs, Junge and Pastewka (2017), in which ∫ C(q) d²q/(2π)² is the mean square height.

    Raises
    ------
    TypeError, ValueError
        If the heights are not real numbers or not finite, or the edges are not positive numbers.

    Examples
    --------
    The slope of the spectrum is −2(1 + H):

    >>> height = asp.self_affine((256, 256), 0.8, 0.25, 1 / 64, rms_height=1e-3, seed=1)
    >>> q, power = asp.spectrum(height)
    >>> inside = (q > 2 * np.pi * 5) & (q < 2 * np.pi * 60)
    >>> slope = np.polyfit(np.log(q[inside]), np.log(power[inside]), 1)[0]
    >>> bool(abs(slope + 2 * (1 + 0.8)) < 0.1)
    True
    """
    values = _heights(height)
    grid = Grid(values.shape, length)  # type: ignore[arg-type]
    power = np.abs(Fourier(grid).forward(values)) ** 2
    wavenumber, average = radial_average(grid.area * power, grid)
    require_finite("spectrum", {"wavenumber": wavenumber, "power": average})
    return wavenumber, average


def target_spectrum(
    grid: Grid, hurst: float, wavelength_long: float, wavelength_short: float, rms_height: float
) -> tuple[Array, Array]:
    """Expected `spectrum` of `self_affine` surfaces: Eq. 19 with C_0 set by the rms height.

    Parameters and errors are those of `self_affine`; the result is that of `spectrum`, on the same rings.
    """
    _require_band(grid, hurst, wavelength_long, wavelength_short)
    power = _power_law(grid.wavenumber(), hurst, wavelength_long, wavelength_short)
    power *= rms_height**2 / np.sum(power @ grid.multiplicity)
    return radial_average(grid.area * power, grid)
