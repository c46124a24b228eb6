"""Measured height maps, made fit for a periodic solve in a stated way.

A map is read by SurfaceTopography, which knows the formats of the instruments, their units and pixel
sizes. It shows its peaks upward and is pressed face down: the height of the indenter's lower face,
measured upward, is **minus the map**; x and y stay as in the map. Lengths and heights are then in units
of the longer edge of the cell. The steps, in this order: fill undefined points, detrend, make
periodic, remove short waves, resample.
"""

from __future__ import annotations

import math
import os
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.spectral import Fourier, Grid, good_size, resample
from asperity.types import Array

DETRENDS = ("none", "tilt", "curvature")
PERIODICITIES = ("declared", "mirrored", "windowed")

TAPER = 0.1
"""Part of each edge over which a windowed map falls to its mean plane, at either end."""

FEWEST = 2
"""Least number of points along an edge of a map."""

STEEPEST = 1e6
"""Largest height of a map over its longer edge; more is a wrong unit or a wrong number."""

_ROUNDING = 1e-13
_EDGES_UNKNOWN = "the file does not say its edges; set physical_size"


@dataclass(frozen=True)
class HeightMap:
    """A rectangular map as measured.

    Parameters
    ----------
    height : (ny, nx) array
        Peaks upward; NaN where there are no data.
    length : (length_y, length_x)
        Edges in the unit of the heights.
    periodic : bool
        Whether its file says that it is one period.
    """

    height: Array
    length: tuple[float, float]
    periodic: bool = False


@dataclass(frozen=True)
class PeriodicSurface:
    """A lower face of an indenter fit for a periodic solve.

    Parameters
    ----------
    height : (ny, nx) array
        Measured upward, mean zero, in units of the longer edge of the cell.
    grid : Grid
        Its longer edge is one.
    wavelength_short : float
        Shortest wavelength that was kept, in the same unit.
    """

    height: Array
    grid: Grid
    wavelength_short: float


def read_map(
    path: str | os.PathLike[str],
    physical_size: tuple[float, float] | None = None,
    height_factor: float | None = None,
) -> HeightMap:
    """Read a height map in any format that SurfaceTopography knows.

    Parameters
    ----------
    path : path
    physical_size : (length_y, length_x), optional
        Edges in the unit of the heights, if the file does not say.
    height_factor : float, optional
        From the numbers in the file to heights, if the file does not say.

    Returns
    -------
    HeightMap

    Raises
    ------
    ImportError
        If SurfaceTopography is not installed.
    ValueError
        If the file is no map, does not say how large it is, or says what an argument says too.
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
        raise ValueError(f"{os.fspath(path)}: a line scan or scattered points, a rectangular map is needed")
    sizes = found.physical_sizes
    if sizes is None or any(size is None for size in sizes):
        raise ValueError(f"{os.fspath(path)}: {_EDGES_UNKNOWN}")
    if not all(math.isfinite(size) and size > 0 for size in sizes):
        raise ValueError(f"{os.fspath(path)}: edges {sizes[1]:g} and {sizes[0]:g}, numbers > 0 are needed")
    if min(found.nb_grid_pts) < FEWEST:
        raise ValueError(
            f"{os.fspath(path)}: {found.nb_grid_pts[1]} x {found.nb_grid_pts[0]} points, "
            f"at least {FEWEST} x {FEWEST} are needed"
        )
    height: Array = np.ma.filled(np.ma.asarray(found.heights(), dtype=float), np.nan).T
    if np.nanmax(np.abs(height), initial=0.0, where=np.isfinite(height)) > STEEPEST * max(sizes):
        raise ValueError(
            f"{os.fspath(path)}: heights above {STEEPEST:g} times its edges; set height_factor or correct it"
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
    """A measured map as the periodic lower face of an indenter.

    Parameters
    ----------
    surface : HeightMap
    detrend : "none", "tilt" or "curvature"
        What is taken off by least squares: the mean, the mean plane, or a polynomial of degree two.
    periodic : "declared", "mirrored" or "windowed", optional
        Declared: the map is one period as it is. Mirrored: the map and its mirror images at two edges,
        a cell of twice the edges. Windowed: the outer `TAPER` of each edge falls to the mean plane
        (Tukey's window). By default only a map that its file calls periodic is accepted.
    undefined : "harmonic", optional
        Fill points without data by a harmonic function; by default a map that has some is refused.
    wavelength_short : float, optional
        Waves shorter than this are removed; in units of the longer edge of the cell.
    points : int, optional
        Nodes on the longer edge, by Fourier interpolation; by default as measured.

    Returns
    -------
    PeriodicSurface

    Raises
    ------
    ValueError
        If an argument is out of range, or the map is not accepted as it is: the message says what to
        set.
    """
    if detrend not in DETRENDS:
        raise ValueError(f"detrend = {detrend!r}: {', '.join(DETRENDS)} is needed")
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
    elif periodic not in (None, "declared"):
        raise ValueError(f"periodic = {periodic!r}: {', '.join(PERIODICITIES)} is needed")
    edge = max(length)
    grid = Grid(height.shape, (length[0] / edge, length[1] / edge))
    return _band_limited((np.mean(height) - height) / edge, grid, wavelength_short, points)


def edge_step(height: Array) -> float:
    """How rough the seam of a period is: rms step across its edges over rms step between all neighbours.

    About one for a periodic map, zero for a mirrored one, larger where the edges do not meet.
    """
    across = np.concatenate([height[0] - height[-1], height[:, 0] - height[:, -1]])
    along_y, along_x = np.diff(height, axis=0), np.diff(height, axis=1)
    inside = (np.sum(along_y**2) + np.sum(along_x**2)) / max(along_y.size + along_x.size, 1)
    return float(np.sqrt(np.mean(across**2) / inside)) if inside > 0 else 0.0


def _filled(surface: HeightMap, undefined: str | None) -> Array:
    """The heights with a value everywhere."""
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
    """The heights less a least-squares polynomial; its terms are orthogonal on a full grid."""
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
    """The surface without short waves, on the grid asked for."""
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
        raise ValueError("wavelength_short: nothing of the map is left without its shorter waves")
    return PeriodicSurface(smooth, target, wavelength_short)


def _with_points(grid: Grid, points: int) -> Grid:
    """A grid of the same cell with so many nodes on its longer edge, and as dense on the other."""
    if int(points) != points or points < 2:
        raise ValueError(f"points = {points!r}: a whole number ≥ 2 is needed")
    shape = tuple(
        int(points) if edge == max(grid.length) else good_size(round(points * edge / max(grid.length)))
        for edge in grid.length
    )
    return Grid((shape[0], shape[1]), grid.length)
