"""From a measured map to the lower face of an indenter, with a record of everything that was done to it.

The steps are, in this order: spikes are removed, points without data are filled, a trend is subtracted, the
map is made periodic (or left as it is, for a contact without periodic boundaries), short waves are removed,
and the map is resampled. Lengths are in the unit of the map: metres, if its unit is known.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import LARGEST, choice, number, whole_number
from asperity.errors import shown
from asperity.finite import require_finite
from asperity.spectral import Grid, good_size
from asperity.surface.height_map import HeightMap, MapError, OptionName, orientation_needed
from asperity.surface.levelling import (
    Trend,
    edge_step,
    fill_harmonic,
    find_spikes,
    low_pass_bounded,
    low_pass_periodic,
    mirrored,
    subtract_trend,
    tukey_window,
)
from asperity.surface.treatment_record import MapTreatment
from asperity.types import Array
from asperity.units import shown_si

DETRENDS = ("none", "tilt", "curvature")
"""Trends that can be removed."""

PERIODICITIES = ("declared", "mirrored", "windowed")
"""Ways in which a map is made periodic."""

WITHOUT_PERIOD = (*PERIODICITIES, "none")
"""The same, and ``none``: the map is left as it is, for a contact with a free boundary."""

DESPIKE = 8.0
"""Threshold that is proposed for spikes, in robust standard deviations from the local median. No point of
Gaussian self-affine surfaces of 512² points is above it, for Hurst exponents from 0.2 to 0.9."""

MOST_POINTS = 2**16
"""Most nodes on the longer edge of a map that is resampled: 34 GB."""

# Largest variation, relative to the heights, of a map that is flat but for rounding.
_ROUNDING = 1e-13


@dataclass(frozen=True)
class Treatment:
    """Settings of the preparation of a map.

    Parameters
    ----------
    detrend : "none", "tilt" or "curvature"
        Trend that is removed by least squares: the mean, the mean plane, or a polynomial of degree two.
    periodic : "declared", "mirrored", "windowed" or "none", optional
        Declared: the map is taken as one period. Mirrored: the map and its mirror images at two edges form a
        cell of twice the edges. Windowed: the map is multiplied with a Tukey window (F. J. Harris, Proc. IEEE
        66 (1978) 51, doi 10.1109/PROC.1978.10837), which falls to zero over a tenth at each end of an edge.
        None: the map is not made periodic, for ``boundary="free"``. By default only a map that its file
        states to be periodic is accepted.
    undefined : "harmonic", optional
        Points without data are filled by a harmonic function; by default a map with such points is refused.
    despike : float, optional
        Spikes beyond this number of robust standard deviations from the local median are replaced by a
        harmonic function; see `asperity.surface.levelling.find_spikes`. By default none is.
    wavelength_short : float, optional
        Waves shorter than this are removed, from two nodes to the longer edge; in the unit of the map.
    points : int, optional
        Number of nodes on the longer edge of the map, or of the cell if it is mirrored, at least 2. By
        default that of the map.

    Examples
    --------
    >>> asp.Treatment(periodic="mirrored", despike=8, wavelength_short=16e-6).detrend
    'tilt'
    """

    detrend: str = "tilt"
    periodic: str | None = None
    undefined: str | None = None
    despike: float | None = None
    wavelength_short: float | None = None
    points: int | None = None


@dataclass(frozen=True, repr=False)
class TreatedMap:
    """The lower face of an indenter made from a map.

    Parameters
    ----------
    height : (ny, nx) array
        Heights measured upward, with mean zero.
    grid : Grid
        Grid of the heights, in their unit.
    wavelength_short : float
        Shortest wavelength that was kept.
    treatment : MapTreatment
        Record of what was done.
    """

    height: Array
    grid: Grid
    wavelength_short: float
    treatment: MapTreatment

    def __repr__(self) -> str:
        ny, nx = self.height.shape
        return f"<TreatedMap of {ny} × {nx} nodes, shortest wavelength {self.wavelength_short:.4g}>"


def treat_map(
    surface: HeightMap,
    treatment: Treatment | None = None,
    option: OptionName = str,
    periodicities: Sequence[str] = WITHOUT_PERIOD,
) -> TreatedMap:
    """The lower face of an indenter made from a measured map.

    Parameters
    ----------
    surface : HeightMap
    treatment : Treatment, optional
    option : callable
        Gives the name of an argument in the interface of the user, for messages.
    periodicities : sequence of str
        Accepted values of ``periodic``.

    Raises
    ------
    MapError
        If a setting is out of range or missing, or if the map is flat; the message says all that is wrong.

    Examples
    --------
    >>> heights = asp.self_affine((40, 40), 0.8, 60e-6, 10e-6, rms_height=1e-7, seed=1, length=80e-6)
    >>> heights[3, 5] = np.nan  # a point without data
    >>> surface = asp.HeightMap(heights, length=(80e-6, 80e-6))
    >>> made = asp.treat_map(surface, asp.Treatment(periodic="mirrored", undefined="harmonic"))
    >>> made.height.shape, bool(np.isfinite(made.height).all())
    ((80, 80), True)
    """
    treatment = treatment or Treatment()
    if problems := treatment_problems(surface, treatment, option, periodicities):
        raise MapError(surface.name, problems)
    missing = ~np.isfinite(surface.height)
    spikes = np.zeros_like(missing)
    if treatment.despike is not None:
        spikes = find_spikes(surface.height, treatment.despike)
    filled = fill_harmonic(surface.height, missing | spikes)
    level, trend = subtract_trend(filled, treatment.detrend, surface.length)
    if np.ptp(level) <= _ROUNDING * np.abs(filled).max():
        raise MapError(surface.name, ["a surface that varies is needed, this one is flat"])
    step = edge_step(level)
    periodic, length, altered = treatment.periodic, surface.length, 0.0
    if periodic == "mirrored":
        level, length = mirrored(level), (2 * length[0], 2 * length[1])
    elif periodic == "windowed":
        window = tukey_window(level.shape)
        level, altered = level * window, float(np.mean(window < 1))
    lower = level - np.mean(level) if surface.orientation == "lower face" else np.mean(level) - level
    grid = Grid((level.shape[0], level.shape[1]), length)
    target = grid if treatment.points is None else _with_points(grid, treatment.points)
    low_pass = low_pass_bounded if periodic == "none" else low_pass_periodic
    smooth = low_pass(lower, grid, target, treatment.wavelength_short)
    if np.ptp(smooth) <= _ROUNDING * np.ptp(lower):
        raise MapError(
            surface.name,
            [
                f"{option('wavelength_short')}: a smaller one is needed, the map has no waves of this length "
                "or longer"
            ],
        )
    shortest = treatment.wavelength_short or _two_nodes(grid, target)
    require_finite("treat_map", {"height": smooth})
    record = _record(surface, treatment, (missing, spikes), trend, target)
    whole = MapTreatment(
        **record,
        altered_fraction=altered,
        edge_step_before=step,
        edge_step=edge_step(smooth),
        wavelength_short=shortest,
    )
    return TreatedMap(smooth, target, shortest, whole)


def treatment_problems(
    surface: HeightMap,
    treatment: Treatment,
    option: OptionName = str,
    periodicities: Sequence[str] = WITHOUT_PERIOD,
) -> list[str]:
    """Everything that a map and settings lack to be treated, before anything is computed.

    Raises
    ------
    MapError
        If the map itself is none.
    """
    surface.check()
    problems: list[str] = []
    checks: list[tuple[Any, tuple[Any, ...]]] = [(choice, (option("detrend"), treatment.detrend, DETRENDS))]
    if treatment.periodic is not None:
        checks.append((choice, (option("periodic"), treatment.periodic, periodicities)))
    if treatment.despike is not None:
        name = option("despike")
        checks.append((number, (name, treatment.despike, "a number ≥ 3", lambda value: value >= 3)))
    if treatment.points is not None:
        name, accepted = option("points"), f"a whole number from 2 to {MOST_POINTS}"
        checks.append((whole_number, (name, treatment.points, accepted, lambda n: 2 <= n <= MOST_POINTS)))
    for check, arguments in checks:
        try:
            check(*arguments)
        except (TypeError, ValueError) as error:
            problems.append(str(error))
    if surface.orientation is None:
        problems.append(orientation_needed(option("orientation")))
    if treatment.periodic is None and not surface.periodic:
        problems.append(
            f"{option('periodic')}: the file does not say that the map is one period; "
            f"set {option('periodic')} to {', '.join(periodicities[:-1])} or {periodicities[-1]}"
            f"{' (for a free boundary)' if 'none' in periodicities else ''}"
        )
    if treatment.undefined not in (None, "harmonic"):
        problems.append(f"{option('undefined')} = {shown(treatment.undefined)}: harmonic is needed")
    elif surface.missing and treatment.undefined is None:
        problems.append(
            f"{option('undefined')}: {surface.missing} points of the map have no data; "
            f"set {option('undefined')} to harmonic"
        )
    if not problems:
        problems += _wavelength_problem(surface, treatment, option("wavelength_short"))
    return problems


def _wavelength_problem(surface: HeightMap, treatment: Treatment, name: str) -> list[str]:
    """Message on a shortest wavelength out of range."""
    given = treatment.wavelength_short
    if given is None:
        return []
    factor = 2 if treatment.periodic == "mirrored" else 1
    shape = surface.height.shape
    length = factor * surface.length[0], factor * surface.length[1]
    grid = Grid((factor * shape[0], factor * shape[1]), length)
    target = grid if treatment.points is None else _with_points(grid, treatment.points)
    shortest, longest = _two_nodes(grid, target), max(grid.length)
    unit = surface.unit is not None
    low, high = (shown_si(edge, "m", 6) if unit else f"{edge:.6g}" for edge in (shortest, longest))
    if isinstance(given, (int, float)) and shortest * (1 - 1e-9) <= given <= longest * (1 + 1e-9):
        return []
    in_metres = unit and isinstance(given, (int, float)) and abs(given) <= LARGEST
    value = shown_si(given, "m", 6) if in_metres else shown(given)
    return [f"{name} = {value}: a number ≥ {low} (two nodes), ≤ {high} is needed"]


def _two_nodes(grid: Grid, target: Grid) -> float:
    return 2 * max(*grid.spacing, *target.spacing)


def _record(
    surface: HeightMap,
    treatment: Treatment,
    marked: tuple[Array, Array],
    trend: Trend,
    target: Grid,
) -> dict[str, Any]:
    """The part of the record that does not depend on the result."""
    missing, spikes = (int(np.count_nonzero(points)) for points in marked)
    return {
        "orientation": surface.orientation,
        "unit": "m" if surface.unit else "unknown",
        "missing": missing,
        "spikes": spikes,
        "filled_fraction": (missing + spikes) / surface.height.size,
        "despike": treatment.despike or 0.0,
        "detrend": treatment.detrend,
        "tilt": math.atan(math.hypot(*trend.slope)),
        "bow": trend.bow,
        "periodic": treatment.periodic or "stated by the file",
        "shape_y": surface.height.shape[0],
        "shape_x": surface.height.shape[1],
        "points_y": target.shape[0],
        "points_x": target.shape[1],
        "length_y": target.length[0],
        "length_x": target.length[1],
        "filtered": int(treatment.wavelength_short is not None),
    }


def _with_points(grid: Grid, points: int) -> Grid:
    """A grid of the same cell with `points` nodes on its longer edge and about square pixels."""
    shape = tuple(
        int(points) if edge == max(grid.length) else good_size(round(points * edge / max(grid.length)))
        for edge in grid.length
    )
    return Grid((shape[0], shape[1]), grid.length)
