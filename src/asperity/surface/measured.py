"""Measured height maps, and their preparation for a periodic contact problem.

Maps are read by the package SurfaceTopography, which knows the file formats of the instruments, their units
and pixel sizes. A map shows its peaks upward and is pressed face down: the height of the indenter's lower
face, measured upward, is **minus the map**, while x and y stay as in the map. `make_periodic` fills undefined
points, removes a trend, makes the map periodic, removes short waves and resamples, in this order. Lengths and
heights are afterwards in units of the longer edge of the cell.
"""

from __future__ import annotations

import math
import os
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import choice, whole_number
from asperity.spectral import Fourier, Grid, good_size, resample
from asperity.types import Array

DETRENDS = ("none", "tilt", "curvature")
"""Trends that `make_periodic` can remove."""

PERIODICITIES = ("declared", "mirrored", "windowed")
"""Ways in which `make_periodic` makes a map periodic."""

TAPER = 0.1
"""Fraction of an edge, at each of its ends, over which a windowed map falls to its mean plane."""

FEWEST_POINTS = 2
"""Smallest number of points along an edge of a map."""

LARGEST_HEIGHT = 1e6
"""Largest height of a map in units of its longer edge; a larger one is a wrong unit or a damaged file."""

# Largest variation, relative to the heights, of a map that is flat but for rounding.
_ROUNDING = 1e-13

_EDGES_UNKNOWN = "the file does not say its edges; set physical_size"


@dataclass(frozen=True)
class HeightMap:
    """A rectangular height map as measured.

    Parameters
    ----------
    height : (ny, nx) array
        Heights, peaks upward; NaN where there are no data.
    length : (length_y, length_x)
        Edges of the map, in the unit of the heights.
    periodic : bool
        True if the file states that the map is one period.
    """

    height: Array
    length: tuple[float, float]
    periodic: bool = False


@dataclass(frozen=True)
class PeriodicSurface:
    """The lower face of an indenter as one period of a periodic surface.

    Parameters
    ----------
    height : (ny, nx) array
        Heights measured upward, with mean zero, in units of the longer edge of the cell.
    grid : Grid
        Grid of the heights; the longer edge of its cell is one.
    wavelength_short : float
        Shortest wavelength that was kept, in units of the longer edge.
    """

    height: Array
    grid: Grid
    wavelength_short: float


def read_map(
    path: str | os.PathLike[str],
    physical_size: tuple[float, float] | None = None,
    height_factor: float | None = None,
) -> HeightMap:
    """Read a height map in any file format that SurfaceTopography knows.

    Parameters
    ----------
    path : path
    physical_size : (length_y, length_x), optional
        Edges of the map, in the unit of the heights; only for files that do not contain them.
    height_factor : float, optional
        Factor from the numbers in the file to heights; only for files that do not contain it.

    Returns
    -------
    HeightMap
        Edges are converted to the unit of the heights.

    Raises
    ------
    ImportError
        If SurfaceTopography is not installed.
    ValueError
        If the file is not a rectangular height map, if it does not contain its edges, or if it contains what
        an argument gives.
    """
    try:
        from SurfaceTopography import read_topography
        from SurfaceTopography.Exceptions import MetadataAlreadyFixedByFile
    except ImportError as error:
        raise ImportError(
            "SurfaceTopography is needed to read measured maps: pip install SurfaceTopography"
        ) from error
    if not os.path.isfile(path):
        raise ValueError(f"file = {os.fspath(path)!r}: no such file")
    given: dict[str, Any] = {}
    if physical_size is not None:
        given["physical_sizes"] = (float(physical_size[1]), float(physical_size[0]))
    if height_factor is not None:
        given["height_scale_factor"] = float(height_factor)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = read_topography(os.fspath(path), **given)
    except MetadataAlreadyFixedByFile as error:
        raise ValueError(
            f"{os.fspath(path)}: the file says itself what physical_size or height_factor say; leave it out"
        ) from error
    except Exception as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        if "physical_sizes" in reason:
            raise ValueError(f"{os.fspath(path)}: {_EDGES_UNKNOWN}") from error
        raise ValueError(f"{os.fspath(path)}: not a height map that can be read ({reason})") from error
    if found.dim != 2 or not found.is_uniform:
        raise ValueError(
            f"{os.fspath(path)}: a rectangular map is needed, not a line scan or scattered points"
        )
    sizes = found.physical_sizes
    if sizes is None or any(size is None for size in sizes):
        raise ValueError(f"{os.fspath(path)}: {_EDGES_UNKNOWN}")
    if not all(math.isfinite(size) and size > 0 for size in sizes):
        raise ValueError(f"{os.fspath(path)}: edges > 0 are needed, not {sizes[1]:g} and {sizes[0]:g}")
    if min(found.nb_grid_pts) < FEWEST_POINTS:
        raise ValueError(
            f"{os.fspath(path)}: at least {FEWEST_POINTS} x {FEWEST_POINTS} points are needed, "
            f"not {found.nb_grid_pts[1]} x {found.nb_grid_pts[0]}"
        )
    height: Array = np.ma.filled(np.ma.asarray(found.heights(), dtype=float), np.nan).T
    if np.nanmax(np.abs(height), initial=0.0, where=np.isfinite(height)) > LARGEST_HEIGHT * max(sizes):
        raise ValueError(
            f"{os.fspath(path)}: heights up to {LARGEST_HEIGHT:g} times the longer edge are accepted; "
            "set height_factor or correct the file"
        )
    return HeightMap(height, (float(sizes[1]), float(sizes[0])), bool(found.is_periodic))


def make_periodic(
    surface: HeightMap,
    detrend: str,
    periodic: str | None = None,
    undefined: str | None = None,
    wavelength_short: float | None = None,
    points: int | None = None,
) -> PeriodicSurface:
    """The periodic lower face of an indenter made from a measured map.

    Parameters
    ----------
    surface : HeightMap
    detrend : "none", "tilt" or "curvature"
        Trend that is removed by least squares: the mean, the mean plane, or a polynomial of degree two.
    periodic : "declared", "mirrored" or "windowed", optional
        Declared: the map is taken as one period. Mirrored: the map and its mirror images at two edges form a
        cell of twice the edges. Windowed: the map is multiplied with a Tukey window (F. J. Harris, Proc. IEEE
        66 (1978) 51, doi 10.1109/PROC.1978.10837), which falls to zero over the fraction `TAPER` at each end
        of an edge. By default only a map that its file states to be periodic is accepted.
    undefined : "harmonic", optional
        Points without data are filled by a harmonic function; by default a map with such points is refused.
    wavelength_short : float, optional
        Waves shorter than this are removed; in units of the longer edge of the cell, from two nodes to 1.
    points : int, optional
        Number of nodes on the longer edge, at least 2; the map is interpolated by Fourier series. By default
        the number of the map.

    Returns
    -------
    PeriodicSurface

    Raises
    ------
    ValueError
        If an argument is out of range, if the map is flat, or if it needs an argument that is not given; the
        message says which.
    """
    choice("detrend", detrend, DETRENDS)
    if periodic is not None:
        choice("periodic", periodic, PERIODICITIES)
    if periodic is None and not surface.periodic:
        raise ValueError(
            "periodic: the file does not say that the map is one period; "
            "set periodic to mirrored, windowed or declared"
        )
    given = _filled(surface, undefined)
    height = _detrended(given, detrend)
    if np.ptp(height) <= _ROUNDING * np.abs(given).max():
        raise ValueError("file: a surface that varies is needed, this one is flat")
    length = surface.length
    if periodic == "mirrored":
        height = np.block([[height, height[:, ::-1]], [height[::-1], height[::-1, ::-1]]])
        length = (2 * length[0], 2 * length[1])
    elif periodic == "windowed":
        from scipy.signal.windows import tukey

        window_y, window_x = (tukey(n, 2 * TAPER, sym=False) for n in height.shape)
        height = height * window_y[:, None] * window_x[None, :]
    edge = max(length)
    grid = Grid(height.shape, (length[0] / edge, length[1] / edge))
    return _band_limited((np.mean(height) - height) / edge, grid, wavelength_short, points)


def edge_step(height: Array) -> float:
    """Rms height step across the edges of a period, relative to the rms step between all neighbouring nodes.

    It is about one for a periodic map, zero for a mirrored one, and larger if opposite edges do not match.
    """
    across = np.concatenate([height[0] - height[-1], height[:, 0] - height[:, -1]])
    along_y, along_x = np.diff(height, axis=0), np.diff(height, axis=1)
    inside = (np.sum(along_y**2) + np.sum(along_x**2)) / max(along_y.size + along_x.size, 1)
    return float(np.sqrt(np.mean(across**2) / inside)) if inside > 0 else 0.0


def _filled(surface: HeightMap, undefined: str | None) -> Array:
    """The heights with values at all points."""
    missing = ~np.isfinite(surface.height)
    if not missing.any():
        return surface.height
    if undefined is None:
        raise ValueError(
            f"undefined: {int(missing.sum())} points of the map have no data; set undefined to harmonic"
        )
    if undefined != "harmonic":
        raise ValueError(f"undefined = {undefined!r}: harmonic is needed")
    from SurfaceTopography import Topography

    masked = np.ma.masked_invalid(surface.height.T)
    topography = Topography(masked, (surface.length[1], surface.length[0]))
    return np.asarray(topography.interpolate_undefined_data_with_harmonic_function().heights()).T


def _detrended(height: Array, detrend: str) -> Array:
    """The heights minus their least-squares polynomial, whose terms are orthogonal on a full grid."""
    linear_y, linear_x = (np.linspace(-1.0, 1.0, n) if n > 1 else np.zeros(1) for n in height.shape)
    square_y, square_x = (np.square(linear) - np.mean(np.square(linear)) for linear in (linear_y, linear_x))
    one_y, one_x = np.ones_like(linear_y), np.ones_like(linear_x)
    terms = [(one_y, one_x)]
    if detrend in ("tilt", "curvature"):
        terms += [(linear_y, one_x), (one_y, linear_x)]
    if detrend == "curvature":
        terms += [(square_y, one_x), (linear_y, linear_x), (one_y, square_x)]
    left = height.astype(float)
    for term_y, term_x in terms:
        norm = (term_y @ term_y) * (term_x @ term_x)
        if norm > 0:
            left -= np.outer((term_y @ height @ term_x) / norm * term_y, term_x)
    return left


def _band_limited(
    height: Array, grid: Grid, wavelength_short: float | None, points: int | None
) -> PeriodicSurface:
    """The surface without short waves, with `points` nodes on the longer edge."""
    target = grid if points is None else _with_points(grid, points)
    shortest = 2 * max(*grid.spacing, *target.spacing)
    filtered = wavelength_short is not None
    if wavelength_short is None:
        wavelength_short = shortest
    elif not (math.isfinite(wavelength_short) and shortest * (1 - 1e-9) <= wavelength_short <= 1):
        raise ValueError(
            f"wavelength_short = {wavelength_short!r}: a number ≥ {shortest:.6g} (two nodes), ≤ 1 is needed"
        )
    coefficients = Fourier(grid).forward(height)
    if filtered:
        coefficients[grid.wavenumber() > 2 * np.pi / wavelength_short * (1 + 1e-9)] = 0.0
    coefficients[0, 0] = 0.0
    smooth = Fourier(target).inverse(resample(coefficients, grid, target), overwrite=True)
    if np.ptp(smooth) <= _ROUNDING * np.ptp(height):
        raise ValueError(
            "wavelength_short: a smaller one is needed, the map has no waves of this length or longer"
        )
    return PeriodicSurface(smooth, target, wavelength_short)


def _with_points(grid: Grid, points: int) -> Grid:
    """A grid of the same cell with `points` nodes on its longer edge and about square pixels."""
    points = whole_number("points", points, "a whole number ≥ 2", lambda n: n >= 2)
    shape = tuple(
        points if edge == max(grid.length) else good_size(round(points * edge / max(grid.length)))
        for edge in grid.length
    )
    return Grid((shape[0], shape[1]), grid.length)
