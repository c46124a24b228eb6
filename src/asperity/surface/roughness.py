"""Roughness parameters, power spectrum and texture of surfaces.

A surface is an array of heights ``h[y, x]`` of a periodic cell: the lower face of the rigid indenter,
measured upward, with mean zero. Heights and lengths have one unit, which is the user's choice.

References
----------
T. D. B. Jacobs, T. Junge and L. Pastewka, Surf. Topogr.: Metrol. Prop. 5 (2017) 013001,
doi 10.1088/2051-672X/aa51f8 (conventions of power spectra).
ISO 25178-2 (names of areal roughness parameters).
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from asperity.core.arguments import SMALLEST, finite_array, require_finite
from asperity.core.types import Array, ArrayLike
from asperity.fourier.grid import Edges, Fourier, Grid, mean_square, radial_average

if TYPE_CHECKING:
    import xarray as xr


CORRELATED = 0.2
"""Value of the autocorrelation that ends a length of the texture (ISO 25178-2)."""

CORE_SHARE, RATIO_CLASSES = 0.4, 5000
"""Fraction of the area over which the equivalent line is fitted, and classes of the material ratio curve."""

DIRECTIONS = 180
"""Directions over half a turn in which the autocorrelation is followed."""

MOST_STEPS = 16
"""Largest number of steps along a direction, per point of the longer edge of the map. Square pixels take 1.4
for steps of half a pixel, oblong ones more."""

LAY_FILTER = 0.125
"""Standard deviation of the Gaussian filter before the slopes that give the lay, over the shortest length of
the texture. Without the filter, white noise of the rms height of ridges that are four such lengths apart
turns their lay by 13°, with it by 3°; twice as wide a filter leaves fewer independent slopes of short
ridges."""

LEAST_FILTER = 0.85
"""Smallest standard deviation of this filter in pixels. With the filter the lay of ridges three pixels wide
is found to 1°, with differences of neighbouring heights alone to 6°."""

TIP_SAFETY = 0.5
"""Largest curvature of the sharpest peaks, over the tip's, at which the tip has not rounded them."""


def checked_heights(height: ArrayLike) -> Array:
    """Heights as a float64 array, checked."""
    values = finite_array("height", height)
    if values.ndim != 2 or values.size == 0:
        raise ValueError(
            f"height of shape {values.shape}: an array (ny, nx) with at least one height is needed"
        )
    return values.astype(np.float64)


def varying_heights(height: ArrayLike) -> Array:
    """Heights as a float64 array, checked, and not all equal."""
    values = checked_heights(height)
    if np.ptp(values) < SMALLEST:
        raise ValueError(
            f"height: heights that differ by at least {SMALLEST:g} are needed, this surface is flat"
        )
    return values


def moments(values: Array, weights: Array) -> tuple[float, float, float]:
    """Variance, skewness and kurtosis of weighted values; the last two are NaN if all values are equal."""
    # Sums, not scalar products, whose rounding depends on the number of threads.
    centred = values - np.sum(weights * values)
    power = centred * centred
    variance = np.sum(weights * power)
    if variance == 0:
        return 0.0, float("nan"), float("nan")
    power *= centred
    third = np.sum(weights * power)
    power *= centred
    return variance, third / variance**1.5, np.sum(weights * power) / variance**2


@dataclass(frozen=True)
class RoughnessParameters:
    """Areal roughness parameters of a periodic surface, with their symbols in ISO 25178-2.

    Attributes
    ----------
    rms_height : float
        Root-mean-square height about the mean (Sq), in the unit of the heights.
    rms_gradient : float
        Root-mean-square gradient (Sdq), by spectral derivative: √⟨|∇h|²⟩, the unit of the heights over the
        unit of the lengths.
    skewness : float
        ⟨h³⟩/⟨h²⟩^(3/2) (Ssk); 0 for a Gaussian surface.
    kurtosis : float
        ⟨h⁴⟩/⟨h²⟩² (Sku); 3 for a Gaussian surface.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> found = asp.roughness_parameters(height)
    >>> round(found.rms_height, 9), bool(found.rms_gradient > 0)
    (0.001, True)
    """

    rms_height: float
    rms_gradient: float
    skewness: float
    kurtosis: float


def roughness_parameters(height: Array, length: Edges = 1.0) -> RoughnessParameters:
    """Root-mean-square height and gradient, skewness and kurtosis of a periodic surface.

    Parameters
    ----------
    height : (ny, nx) array
    length : float, (length_y, length_x) or Grid
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
    values = varying_heights(height)
    grid = Grid(values.shape, length).of_heights  # type: ignore[arg-type]
    heights = np.ravel(values)
    variance, skewness, kurtosis = moments(heights, np.full(heights.size, 1 / heights.size))
    squared_wavenumber = grid.odd_qy[:, None] ** 2 + grid.odd_qx[None, :] ** 2
    found = RoughnessParameters(
        rms_height=float(variance**0.5),
        rms_gradient=mean_square(Fourier(grid).forward(values), grid, squared_wavenumber) ** 0.5,
        skewness=float(skewness),
        kurtosis=float(kurtosis),
    )
    require_finite("roughness_parameters", asdict(found))
    return found


def sampling_error(height: Array, grid: Grid) -> float:
    """Relative standard deviation of the rms height between places of a surface, from one of them.

    The power of each wave of a random surface varies independently from place to place; the fewer waves
    contribute most of the height, the more the rms height varies. Heights have mean zero, and are not all
    equal. Of four waves of a mirrored map that differ by signs, one is independent, not two.
    """
    grid = grid.of_heights
    modes = Fourier(grid).forward(height)
    power = np.abs(modes) ** 2
    squares, total = mean_square(modes, grid, power), mean_square(modes, grid, np.ones_like(power))
    return float((1.0 if grid.mirrored else 0.5) * np.sqrt(squares) / total)


def spectrum(height: Array, length: Edges = 1.0) -> tuple[Array, Array]:
    """Radially averaged power spectral density of a periodic surface.

    Parameters
    ----------
    height : (ny, nx) array
    length : float, (length_y, length_x) or Grid
        Edges of the cell, in the unit of the heights.

    Returns
    -------
    wavenumber : (rings,) array
        |q| in radians per length, the rings of `asperity.fourier.grid.radial_average`.
    power : (rings,) array
        Two-dimensional power spectral density C(q) = A |ĥ(q)|², A the area of a period, in length⁴: the
        convention of Jacobs, Junge and Pastewka (2017), in which ∫ C(q) d²q/(2π)² is the mean square height.

    Raises
    ------
    TypeError, ValueError
        If the heights are not real numbers or not finite, or the edges are not positive numbers.

    Examples
    --------
    The slope of the spectrum is −2(1 + H):

    >>> height = asp.self_affine((256, 256), 0.8, 0.25, 1 / 64, rms_height=1e-3, seed=1)
    >>> q, power = asp.surface.spectrum(height)
    >>> inside = (q > 2 * np.pi * 5) & (q < 2 * np.pi * 60)
    >>> slope = np.polyfit(np.log(q[inside]), np.log(power[inside]), 1)[0]
    >>> bool(abs(slope + 2 * (1 + 0.8)) < 0.1)
    True
    """
    values = checked_heights(height)
    grid = Grid(values.shape, length).of_heights  # type: ignore[arg-type]
    power = np.abs(Fourier(grid).forward(values)) ** 2
    wavenumber, average = radial_average(grid.whole_cell.area * power, grid)
    require_finite("spectrum", {"wavenumber": wavenumber, "power": average})
    return wavenumber, average


def surface_dataset(height: Array, grid: Grid) -> xr.Dataset:
    """Heights over y and x as in result files, with their roughness parameters and their spectrum."""
    import xarray as xr

    wavenumber, power = spectrum(height, grid)
    return xr.Dataset(
        {
            "height": (("y", "x"), height),
            **asdict(roughness_parameters(height, grid)),
            "spectrum": ("wavenumber", power),
        },
        coords=grid.dataset_coordinates() | {"wavenumber": wavenumber},
    )


def rms_step(height: Array, spacing: tuple[float, float]) -> float:
    """Rms gradient between neighbouring points of a map with edges; NaN are no neighbours."""
    steps = (np.diff(height, axis=axis) / spacing[axis] for axis in (0, 1))
    return float(np.sqrt(sum(np.mean(np.square(step[np.isfinite(step)])) for step in steps)))


class CoreRoughness(NamedTuple):
    """Parameters of the material ratio curve (ISO 25178-2), heights in the unit of the map.

    Parameters
    ----------
    core : float
        Core height Sk.
    peaks, valleys : float
        Reduced peak height Spk and reduced valley depth Svk.
    """

    core: float
    peaks: float
    valleys: float


def core_roughness(height: Array) -> CoreRoughness:
    """Core height, reduced peak height and reduced valley depth of a map with its peaks upward.

    The equivalent line is fitted to the material ratio curve over the 40 % of the area in which its secant is
    flattest; the triangles of the peaks above the core and of the valleys below it have the areas that the
    curve has there (ISO 25178-2, ISO 13565-2).
    """
    ratio = np.linspace(0.0, 1.0, RATIO_CLASSES + 1)
    curve = np.quantile(height, 1 - ratio)
    width = round(CORE_SHARE * RATIO_CLASSES)
    begin = int(np.argmin(curve[:-width] - curve[width:]))
    slope, top = np.polyfit(ratio[begin : begin + width + 1], curve[begin : begin + width + 1], 1)
    reduced = []
    for side, end in ((curve, top), (-curve[::-1], -(top + slope))):
        above = np.maximum(side - end, 0.0)
        share = float(np.interp(-end, -side, ratio))
        reduced.append(2 * float(np.trapezoid(above, ratio)) / share if share else 0.0)
    return CoreRoughness(-float(slope), *reduced)


STRONG_LAY = 0.3
"""Texture aspect ratio below which a lay is strong (ISO 25178-2)."""


BEYOND = -1e9
"""Stands for the autocorrelation beyond half of an edge, where it is not known."""


def texture(height: Array, spacing: tuple[float, float]) -> tuple[float, float, float]:
    """Autocorrelation length Sal, texture aspect ratio Str and direction of the lay of ISO 25178-2.

    The autocorrelation is the mean product of the heights over the area that the surface and its shifted
    image share, for shifts up to half of each edge.

    Parameters
    ----------
    height : (ny, nx) array
        Levelled heights, not periodic.
    spacing : (y, x)

    Returns
    -------
    shortest : float
        Shortest length over which the autocorrelation falls to `CORRELATED`; NaN for a flat surface.
    ratio : float
        The shortest over the longest such length.
    direction : float
        Direction of the lay in degrees from x towards y, from 0 to 180, along which the mean square slope is
        smallest after a Gaussian filter that leaves out noise much shorter than `shortest`. The direction of
        the longest length differs from it where the edges of the map cut the autocorrelation.
    """
    from scipy.ndimage import gaussian_filter

    (ny, nx), (_, ends) = height.shape, correlated_lengths(height, spacing, beyond=True)
    centred, shortest = height - height.mean(), float(ends.min())
    if np.isnan(shortest):
        return np.nan, np.nan, np.nan
    width = max(LAY_FILTER * shortest, LEAST_FILTER * max(spacing))
    blur = [min(width / step, n / 4) for step, n in zip(spacing, height.shape, strict=True)]
    # The filter continues the map beyond its edges.
    cut = [min(int(2 * pixels), (n - 1) // 2) for pixels, n in zip(blur, height.shape, strict=True)]
    inside = slice(cut[0], ny - cut[0]), slice(cut[1], nx - cut[1])
    slope_y = gaussian_filter(centred, blur, (1, 0))[inside] / spacing[0]
    slope_x = gaussian_filter(centred, blur, (0, 1))[inside] / spacing[1]
    steepest = np.arctan2(2 * np.sum(slope_y * slope_x), np.sum(slope_x**2) - np.sum(slope_y**2)) / 2
    return shortest, shortest / float(ends.max()), float(np.degrees(steepest) + 90) % 180


def correlated_lengths(
    height: Array, spacing: tuple[float, float], beyond: bool = False
) -> tuple[Array, Array]:
    """Directions in radians from x towards y, and the correlation lengths of the heights along them.

    Over these lengths the autocorrelation falls to `CORRELATED`; it is known up to half of each edge, where
    they end, or `beyond` which it is taken to decay exponentially. NaN for a flat surface.
    """
    from scipy.ndimage import map_coordinates

    ny, nx = height.shape
    centred = height - height.mean()
    fourier = Fourier(Grid((2 * ny, 2 * nx)))
    power = np.abs(fourier.forward(np.pad(centred, ((0, ny), (0, nx))))) ** 2
    product = fourier.grid.size * fourier.inverse(power)
    rows, columns = np.arange(ny // 2 + 1), np.arange(-(nx // 2), nx // 2 + 1)
    shared = (ny - rows)[:, None] * (nx - np.abs(columns))
    correlation = product[rows[:, None], columns] / shared
    angle = np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    if not correlation[0, nx // 2] > 0:
        return angle, np.full(DIRECTIONS, np.nan)
    farthest = np.hypot(rows[-1] * spacing[0], columns[-1] * spacing[1])
    step = max(min(spacing) / 2, farthest / (MOST_STEPS * max(ny, nx)))
    # The last radii lie beyond the map, where the autocorrelation ends for every direction.
    radius = np.arange(0.0, farthest + 2 * step, step)
    y, x = (
        np.outer(part(angle), radius) / step for part, step in zip((np.sin, np.cos), spacing, strict=True)
    )
    correlation /= correlation[0, nx // 2]
    along = map_coordinates(correlation, [y, x + nx // 2], order=1, cval=BEYOND)
    after = np.argmax(along < CORRELATED, axis=1)
    above, below = (along[np.arange(DIRECTIONS), after - step] for step in (1, 0))
    length = (after - (CORRELATED - below) / (above - below)) * step
    if beyond:
        farther = np.log(CORRELATED) / np.log(np.clip(above, CORRELATED, 1 - 1e-9))
        length = np.where(below == BEYOND, np.maximum((after - 1) * step * farther, length), length)
    return angle, length


def finest_tip(height: Array, spacing: tuple[float, float]) -> float:
    """Largest radius of a tip that has not rounded the peaks, which point up, at the distance of two points.

    A. Sanner, W. G. Nöhring, L. A. Thimons, T. D. B. Jacobs and L. Pastewka, Appl. Surf. Sci. Adv. 7 (2022)
    100190, doi 10.1016/j.apsadv.2021.100190.
    """
    sharpest = max(
        float(-np.diff(height, 2, axis=axis).min(initial=0.0)) / spacing[axis] ** 2 for axis in (0, 1)
    )
    return TIP_SAFETY / sharpest if sharpest else np.inf
