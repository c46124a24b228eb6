"""Non-Gaussian surfaces: Johnson's transforms of the heights, and surfaces with given heights and spectrum.

Johnson's translation system of distributions (Eq. 23 of the paper) is applied to a finished Gaussian surface:
the heights take the moments of the Johnson curve, and the spectrum differs somewhat from the Gaussian
surface's. Hu and Tonder (1992) use the same system for rough surfaces, but transform uncorrelated numbers and
filter them afterwards.

`with_heights` keeps the spectrum. In turns, the heights are replaced rank by rank by heights of the
distribution, and the amplitudes of all waves by the amplitudes of the spectrum, until the two surfaces no
longer approach each other. The last step restores the spectrum: rms height, rms gradient and the band of
wavelengths are exact, and the distribution is reached as far as the band allows.

References
----------
N. L. Johnson, Biometrika 36 (1949) 149, doi 10.2307/2332539.
Y. Z. Hu and K. Tonder, Int. J. Mach. Tools Manufact. 32 (1992) 83, doi 10.1016/0890-6955(92)90064-N.
T. Schreiber and A. Schmitz, Phys. Rev. Lett. 77 (1996) 635, doi 10.1103/PhysRevLett.77.635 (time series).
F. Pérez-Ràfols and A. Almqvist, Tribol. Int. 131 (2019) 591, doi 10.1016/j.triboint.2018.11.020 (surfaces).
ISO 13565-3 (Rpq, Rvq and Rmq of the material probability curve).
"""

import math
from collections.abc import Callable, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import scipy  # whose parts are loaded when they are first used

from asperity.core.arguments import LARGEST, SMALLEST, finite_array, magnitude, number, require_finite
from asperity.core.sizes import good_size
from asperity.core.types import Array, ArrayLike
from asperity.fourier.grid import Fourier, Grid, resample
from asperity.surface.roughness import moments, varying_heights

# Largest δ of the bounded curve: the curve is then straight to a relative 1e-6, and six digits are lost.
_LARGEST_DELTA = 1e6

# Smallest δ at which the Gauss-Hermite rule below gives the moments of the bounded curve to a part in a
# thousand; found by comparison with a sum over 20001 equidistant nodes.
_SMALLEST_FITTED_DELTA = 0.15

# Largest kurtosis at which the rule gives the moments of the unbounded curve to twelve digits, found
# likewise.
_LARGEST_KURTOSIS = 1e6

# Largest difference between the moments asked for and the moments of a fitted curve.
_FIT_TOLERANCE = 1e-8

NODES_PER_WAVE = 4
"""Nodes on the shortest wave of the grid of the iteration. On this grid the mean of the third power of the
heights has no aliasing error, and the mean of the fourth power only from waves at the end of the band. Finer
grids therefore give the same moments."""

IN_BAND = 1e-12
"""Amplitude over the largest one below which a wave is a rounding error."""

MOST_ITERATIONS = 200
SLOWEST = 1e-3
"""Relative fall of the residual in an iteration at which it ends. Up to ten times as many iterations make the
residual smaller by 4 to 30 %."""

_ANY_SIGN = f"a number from {-LARGEST:g} to {LARGEST:g}"


def johnson(height: Array, gamma: float, delta: float, zeta: float = -4.0, lam: float = 8.0) -> Array:
    """Johnson's bounded transform (S_B) of a Gaussian surface, equation 23 of the paper.

    The heights are scaled to unit standard deviation, mapped to the interval (ζ, ζ + λ) by

        ζ + λ / (1 + exp((γ − h)/δ)),

    centred, and scaled back to their original rms height. The last step removes the effect of ζ and λ; they
    are kept as arguments because Eq. 23 has them.

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
    Johnson (1949). The exponential is evaluated relative to the bound to which most heights are close;
    relative to the other bound they would be equal in floating point.

    Examples
    --------
    >>> gaussian = asp.self_affine((64, 64), 0.8, 0.25, 0.125, rms_height=1e-3, seed=1)
    >>> blunt = asp.surface.johnson(gaussian, gamma=2.0, delta=1.0)
    >>> asp.roughness_parameters(blunt).skewness > 0.5
    True
    """
    heights = varying_heights(height)
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
    transformed = scipy.special.expit(normal) if gamma >= 0 else -scipy.special.expit(-normal)
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
    and kurtosis 3, as of a Gaussian surface, leave the surface as it is.

    Parameters
    ----------
    height : (ny, nx) array
        Gaussian heights.
    skewness, kurtosis : float
        Moments of a transformed normal variable; a finite sample scatters about them. The kurtosis (3 for a
        Gaussian) of any distribution exceeds 1 + skewness²; a curve is found from about 1.2 + 1.1 skewness²
        to 1e6, except close to the moments of a lognormal distribution (from a skewness of 3 on, within 0.1 %
        of its kurtosis) and beyond a skewness of 20.

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
    >>> peaky = asp.surface.with_moments(gaussian, skewness=0.0, kurtosis=5.0)
    >>> round(asp.roughness_parameters(peaky).kurtosis)
    5
    """
    heights = varying_heights(height)
    largest = _LARGEST_KURTOSIS**0.5  # the kurtosis exceeds the square of the skewness
    accepted = f"a number from {-largest:g} to {largest:g}"
    skewness = number("skewness", skewness, accepted, lambda n: abs(n) <= largest)
    accepted = f"a number from 1 to {_LARGEST_KURTOSIS:g}"
    kurtosis = number("kurtosis", kurtosis, accepted, lambda n: 1 <= n <= _LARGEST_KURTOSIS)
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
    # Imported here because it takes half a second and other surfaces do not need it.
    from scipy.optimize import least_squares

    def residual(shape: Array, curve: Callable[[Array], Array]) -> Array:
        found = moments(curve((_NORMAL_NODES - shape[0]) / np.exp(shape[1])), _NORMAL_WEIGHTS)
        return np.array(found[1:]) - (skewness, kurtosis)

    # From a nearly symmetric curve the fit does not reach very skew bounded ones: the other starts are close
    # to the lognormal curve of this skewness, (ω + 2) √(ω − 1) with ω = exp(1/δ²). The farther one is needed
    # from a skewness of about 10 on.
    cube = np.cbrt(1 + skewness**2 / 2 + abs(skewness) * np.sqrt(1 + skewness**2 / 4))
    width = 1 / np.sqrt(np.log(max(cube + 1 / cube - 1, 1.01)))
    lognormal = [(math.copysign(factor * width, skewness), math.log(width)) for factor in (2, 8)]
    for curve, start in product((scipy.special.expit, np.sinh), [(0.0, 0.3), *lognormal]):
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            fit = least_squares(residual, start, xtol=1e-14, ftol=1e-14, gtol=1e-14, args=(curve,))
        gamma, delta = fit.x[0], np.exp(fit.x[1])
        is_met = np.abs(fit.fun).max() < _FIT_TOLERANCE
        if is_met and (curve is np.sinh or delta >= _SMALLEST_FITTED_DELTA):
            return curve, gamma, delta
    raise ValueError(
        f"skewness = {skewness!r}, kurtosis = {kurtosis!r}: no Johnson curve with these moments was found; "
        f"a kurtosis from about {1.2 + 1.1 * skewness**2:.3g} to {_LARGEST_KURTOSIS:g}, "
        "not close to a lognormal distribution's, is needed"
    )


# Gauss-Hermite rule for averages over a normal variable.
_NORMAL_NODES, _NORMAL_WEIGHTS = np.polynomial.hermite_e.hermegauss(200)
_NORMAL_WEIGHTS /= _NORMAL_WEIGHTS.sum()


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


class ShapedSurface(NamedTuple):
    """A surface with the spectrum of one surface and nearly the heights of a distribution.

    Parameters
    ----------
    height : (ny, nx) array
    heights_residual : float
        Root-mean-square difference between the sorted heights of this surface and of the distribution, over
        the rms height.
    spectrum_residual : float
        The same of the amplitudes of all waves: a rounding error.
    iterations : int
    """

    height: Array
    heights_residual: float
    spectrum_residual: float
    iterations: int


def with_heights(
    height: ArrayLike,
    *,
    moments: Sequence[float] | None = None,
    plateau: Sequence[float] | None = None,
    sample: ArrayLike | None = None,
) -> ShapedSurface:
    """Surface with the amplitudes of all waves of a surface, and heights of another distribution.

    Exactly one of `moments`, `plateau` and `sample` is given.

    Parameters
    ----------
    height : (ny, nx) array
        Heights of a periodic lower face, as of `self_affine`. Waves at the Nyquist wavenumber are left out.
    moments : (skewness, kurtosis)
        Of a Johnson curve, as in `with_moments`. Positive skewness makes blunt contacts.
    plateau : (Rpq, Rvq, Rmq)
        Root-mean-square roughness of plateau and valleys, of which only the ratio matters, and the material
        ratio in per cent at which one passes into the other (ISO 13565-3): two Gaussians, the valleys of a
        map being the high parts of the lower face.
    sample : array
        Heights of a lower face with that distribution, an array of any shape such as
        ``treat_map(...).height``. Only the shape of the distribution matters.

    Returns
    -------
    ShapedSurface
        Its height has the unit, rms height and rms gradient of the input. It is the same surface for the same
        waves on every grid.

    Raises
    ------
    TypeError, ValueError
        If not exactly one distribution is given, or one or the heights are out of range.

    Examples
    --------
    >>> gaussian = asp.self_affine((256, 256), 0.8, 1 / 4, 1 / 32, rms_height=1e-3, seed=1)
    >>> shaped = asp.surface.with_heights(gaussian, moments=(-1.0, 4.0))
    >>> before, after = (asp.roughness_parameters(h) for h in (gaussian, shaped.height))
    >>> f"{after.skewness:.2f}", abs(after.rms_gradient / before.rms_gradient - 1) < 1e-12
    ('-1.00', True)
    >>> honed = asp.surface.with_heights(gaussian, plateau=(0.1, 0.4, 80))
    >>> shaped.heights_residual < 0.01, honed.heights_residual < 0.01
    (True, True)
    """
    values = varying_heights(height)
    grid = Grid(values.shape)
    modes = Fourier(grid).forward(values)
    modes[0, 0] = 0
    in_band = np.abs(modes) > IN_BAND * np.abs(modes).max()
    in_band &= (2 * np.abs(grid.ky[:, None]) < grid.shape[0]) & (2 * grid.kx[None, :] < grid.shape[1])
    rows, columns = np.nonzero(in_band)
    if not rows.size:
        raise ValueError("height: waves below the Nyquist wavenumber are needed, this surface has none")
    largest = int(np.abs(grid.ky[rows]).max()), int(grid.kx[columns].max())
    iteration_grid = Grid(
        (good_size(NODES_PER_WAVE * max(largest[0], 1)), good_size(NODES_PER_WAVE * max(largest[1], 1)))
    )
    fourier, modes = Fourier(iteration_grid), resample(modes, grid, iteration_grid)
    amplitude = np.abs(modes)
    field = fourier.inverse(modes)
    target = _sorted_heights(field.size, field.std(), moments, plateau, sample)

    residuals = [np.inf, 2.0]
    while len(residuals) < MOST_ITERATIONS + 2 and residuals[-1] <= (1 - SLOWEST) * residuals[-2]:
        field.flat[np.argsort(field, axis=None)] = target
        wanted = fourier.forward(field)
        modes = amplitude * np.exp(1j * np.angle(wanted))
        field = fourier.inverse(modes)
        residuals.append(_heights_residual(field, target))
    found = Fourier(grid).inverse(resample(modes, iteration_grid, grid))
    require_finite("with_heights", {"height": found})
    reached = np.abs(resample(Fourier(grid).forward(found), grid, iteration_grid))
    error = np.sqrt(np.sum((reached - amplitude) ** 2) / np.sum(amplitude**2))
    # The grid of the iteration is often coarser: between its nodes the heights differ more.
    residual = _heights_residual(found, _sorted_heights(found.size, found.std(), moments, plateau, sample))
    return ShapedSurface(found, residual, float(error), len(residuals) - 2)


def _heights_residual(height: Array, target: Array) -> float:
    """Root-mean-square difference between the heights, sorted, and rising heights, over the rms of these."""
    return float(np.sqrt(np.mean((np.sort(height, axis=None) - target) ** 2) / np.mean(target**2)))


def _sorted_heights(count: int, rms_height: Any, moments: Any, plateau: Any, sample: Any) -> Array:
    """Rising heights of the distribution with mean zero, each of the same fraction of the area."""
    given = {"moments": moments, "plateau": plateau, "sample": sample}
    names = [name for name, value in given.items() if value is not None]
    if len(names) != 1:
        raise ValueError(
            f"{', '.join(names) or 'no distribution'}: exactly one of {', '.join(given)} is needed"
        )
    share = (np.arange(count) + 0.5) / count
    if sample is not None:
        values = np.sort(np.ravel(finite_array("sample", sample)))  # numpy.quantile takes minutes
        found = np.interp(share, (np.arange(values.size) + 0.5) / values.size, values)
        if not found.std() > 0:
            raise ValueError(f"sample: heights are needed that differ in more than one of {count} places")
    elif moments is not None:
        skewness, kurtosis = _numbers("moments", moments, ("skewness", "kurtosis"))
        found = with_moments(scipy.special.ndtri(share)[None], skewness, kurtosis)[0]
    else:
        peaks, valleys, ratio = _numbers("plateau", plateau, ("Rpq", "Rvq", "Rmq"))
        magnitude("plateau Rpq", peaks)
        magnitude("plateau Rvq", valleys)
        number("plateau Rmq", ratio, "a number between 0 and 100", lambda percent: 0 < percent < 100)
        # The share of the lower face below a height is the material ratio of the map above it.
        normal, bend = scipy.special.ndtri(share), scipy.special.ndtri(ratio / 100)
        found = np.where(normal < bend, peaks, valleys) * (normal - bend)
    found -= found.mean()
    return found * (rms_height / found.std())


def _numbers(name: str, values: Any, parts: Sequence[str]) -> list[float]:
    if not isinstance(values, Sequence | np.ndarray) or len(values) != len(parts):
        raise ValueError(f"{name} = {values!r}: {len(parts)} numbers ({', '.join(parts)}) are needed")
    return list(values)
