"""From a measured map to the lower face of an indenter, with a record of everything that was done to it.

The steps are, in this order: scan lines are levelled, spikes are found, a trend is fitted to all other points
that have data and subtracted, spikes and non-measured points are filled, Gaussian filters are applied, the
map is made periodic (or left as it is, for a contact without periodic boundaries), short waves are removed,
the map is resampled, and the form of a sphere or cylinder is added.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, get_args

import numpy as np

from asperity.core.arguments import require_finite
from asperity.core.errors import one_line
from asperity.core.sizes import good_size
from asperity.core.system import available_memory
from asperity.core.types import Array, FilePath
from asperity.fourier.grid import Grid, boundary_on
from asperity.settings.map import Detrend, MapOptions, Periodicity
from asperity.surface.form import add_cylinder, add_sphere
from asperity.surface.reading.agreement import MapFile
from asperity.surface.reading.formats import PROFILE, UNNAMED
from asperity.surface.reading.height_map import (
    LOWER_FACE,
    ORIENTATION_NEEDED,
    HeightMap,
    MapError,
    is_period,
)
from asperity.surface.reading.map_file import open_map
from asperity.surface.roughness import rms_step
from asperity.surface.treatment import levelling

DESPIKE = 8.0
"""Threshold that is proposed for spikes, in robust standard deviations from the local median. No point of
Gaussian self-affine surfaces of 512² points is above it, for Hurst exponents from 0.2 to 0.9."""

BYTES_PER_NODE = {"periodic": 205.0, "free": 410.0, "free along y": 410.0, "free along x": 410.0}
"""Memory of a contact and its stress for each node of the grid, by the boundary; measured by
`asperity run`, for a periodic map from 512² to 1024² points."""

ANSWER_MEMORY = 3.7e8
"""Memory of an answer of `asperity run` without its calculation, in bytes."""

FLAT_VARIATION = 1e-13
"""Largest variation, relative to the heights, of a map that is flat except for rounding."""


class Doubt(NamedTuple):
    """What is doubtful about a map; ``str`` is a sentence that begins with the option.

    Attributes
    ----------
    option : str
        Field of `MapOptions` that answers the doubt.
    text : str
    proposed, purpose : str
        Value of the option, and what it is set for; empty if none is proposed.
    """

    option: str
    text: str
    proposed: str = ""
    purpose: str = ""

    def __str__(self) -> str:
        return f"{self.option}: {self.sentence}"

    @property
    def sentence(self) -> str:
        """The doubt with the proposed value, without the option."""
        return self.text + (f"; set it to {self.proposed} {self.purpose}" if self.proposed else "")


@dataclass(frozen=True)
class MapTreatment:
    """Changes to a map by its treatment, in numbers; lengths are in the unit of the map.

    Parameters
    ----------
    missing, spikes : int
        Non-measured points of the file, and points removed as spikes. Both were filled.
    filled_fraction : float
        Fraction of the points that were filled.
    tilt : float
        Angle of the mean plane that was removed, in radians.
    bow : float
        Height of the terms of degree two that were removed, from lowest to highest point.
    altered_fraction : float
        Fraction of the area that a window lowered.
    filtered_height, filtered_gradient : float
        Rms height and rms gradient between neighbouring points after the Gaussian filters over before; 1
        without a filter.
    edge_step_before, edge_step : float
        `asperity.surface.treatment.levelling.edge_step` of the levelled map and of the result.
    """

    missing: int
    spikes: int
    filled_fraction: float
    tilt: float
    bow: float
    altered_fraction: float
    filtered_height: float
    filtered_gradient: float
    edge_step_before: float
    edge_step: float


@dataclass(frozen=True, repr=False)
class TreatedMap:
    """The lower face of an indenter made from a map.

    Parameters
    ----------
    height : (ny, nx) array
        Heights measured upward, with mean zero before a form is added.
    grid : Grid
        Grid of the heights, in their unit; mirrored if the map is continued by its mirror images.
    wavelength_short : float
        Shortest wavelength that was kept.
    treatment : MapTreatment
    done : tuple of str
        The steps of the treatment, a sentence for each.
    name : str
        Name of the map.
    boundary : str
        Boundary of the contact: "free" if the map was not made periodic, "free along x" if it ends there.
    doubts : tuple of Doubt
        Doubts about the map that its options do not answer, if `asperity.prepare_map` looked for them.

    Examples
    --------
    >>> height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> made = asp.prepare_map(asp.HeightMap(height, (2e-4, 2e-4), unit="m"), periodic="mirrored")
    >>> made.height.shape, made.boundary
    ((32, 32), 'periodic')
    """

    height: Array
    grid: Grid
    wavelength_short: float
    treatment: MapTreatment
    done: tuple[str, ...] = ()
    name: str = ""
    boundary: str = "periodic"
    doubts: tuple[Doubt, ...] = ()

    def __repr__(self) -> str:
        ny, nx = self.height.shape
        doubts = "".join(f"; {doubt}" for doubt in self.doubts)
        return f"<TreatedMap of {ny} × {nx} nodes, shortest wavelength {self.wavelength_short:.4g}{doubts}>"

    def part_of(self, grid: Grid) -> tuple[slice, slice]:
        """Rows and columns of the map on a grid of the map, or of the whole cell of a mirrored map."""
        whole = (1, 1) if grid.mirrored else self.grid.images
        rows, columns = (slice(0, count // images) for count, images in zip(grid.shape, whole, strict=True))
        return rows, columns

    def map_alone(self) -> TreatedMap:
        """The surface without its periodic images and mirror images: nothing surrounds it."""
        return replace(self, grid=Grid(self.grid.shape, self.grid.length), boundary="free")


def usable_map(path: FilePath, options: MapOptions, needs_unit: bool = True) -> HeightMap:
    """The map in a file, if file and options state all that its treatment needs."""
    found = open_map(path, options)
    if problems := missing_options(found, options, needs_unit):
        raise MapError(found.map.name, problems)
    return found.map


def missing_options(found: MapFile, options: MapOptions, needs_unit: bool = True) -> list[str]:
    """Everything that a file and the options lack for the treatment of a map."""
    problems = list(found.problems)
    if needs_unit and found.map.unit is None and not any(text.startswith("unit") for text in problems):
        problems.append(found.unit_needed)
    return problems + [text for text in _missing(found.map, options) if text not in problems]


def treat_map(
    surface: HeightMap, options: MapOptions | None = None, *, joins: bool = False, **given: Any
) -> TreatedMap:
    """The lower face of an indenter made from a measured map.

    Parameters
    ----------
    surface : HeightMap
    options : MapOptions, optional
        Options on the content of a file are not used.
    joins : bool
        True if the slope across the edges of a mirrored map is removed, so that its images join smoothly.
    **given
        Fields of `MapOptions`, which override `options`.

    Raises
    ------
    MapError
        If an option is out of range or missing, or if the map is flat; the message says all that is wrong.

    Examples
    --------
    >>> heights = asp.self_affine((40, 40), 0.8, 60e-6, 10e-6, rms_height=1e-7, seed=1, length=80e-6)
    >>> heights[3, 5] = np.nan  # a point without data
    >>> surface = asp.HeightMap(heights, length=(80e-6, 80e-6))
    >>> made = asp.prepare_map(surface, periodic="mirrored", undefined="harmonic")
    >>> made.height.shape, bool(np.isfinite(made.height).all())
    ((40, 40), True)
    """
    options = (options or MapOptions()).replaced(**given)
    if problems := _missing(surface, options):
        raise MapError(surface.name, problems)
    grid, target = _grids(surface, options)
    shortest, radii = _lengths(surface, options, grid, target)
    levelled = _levelled(surface, options)
    if levelled.is_flat and radii is None:
        raise MapError(surface.name, ["a surface that varies is needed, or a radius: this one is flat"])
    level, filtered, words = _filtered(levelled.height, surface, options, grid)
    step, altered, edges = levelling.edge_step(level), 0.0, ""
    if joins and options.periodic == "mirrored":
        level, widths = levelling.level_edges(
            level, [axis for axis, name in enumerate("yx") if options.ends != name]
        )
        if max(widths) > 0.5:
            within = surface.shown_length(
                *(size * step for size, step in zip(widths, grid.spacing, strict=True))
            )
            edges = f", with the slope across the edges removed within {within} of them"
    if options.periodic == "windowed":
        window = levelling.tukey_window(level.shape)
        level, altered = level * window, float(np.mean(window < 1))

    lower = level - np.mean(level) if surface.orientation == LOWER_FACE else np.mean(level) - level
    height = levelling.low_pass(lower, grid, target, shortest)
    if not levelled.is_flat and np.ptp(height) <= FLAT_VARIATION * np.ptp(lower):
        problem = "wavelength_short: a smaller one is needed, the map has no waves of this length or longer"
        raise MapError(surface.name, [problem])
    stepped = f"edge step {step:.3g} times that between neighbouring points"
    ways = {
        None: f"taken as one period, as the file states: {stepped}",
        "declared": f"taken as one period, as declared: {stepped}",
        "mirrored": f"mirrored at two edges: the cell is {surface.shown_length(*grid.period)}{edges}",
        "windowed": f"windowed: {100 * altered:.3g} % of the area lowered towards the mean",
        "none": "not made periodic: for a free boundary",
    }
    way, boundary = ways[options.periodic], boundary_of(options)
    if (ends := options.ends) in ("y", "x"):
        how = "mirrored" if options.periodic == "mirrored" else "taken as one period"
        way = f"{how} along {'x' if ends == 'y' else 'y'}; along {ends} nothing surrounds it"
    done = [*_words_on_heights(surface, options, levelled), *words, way]
    if shortest is not None:
        done.append(f"waves shorter than {surface.shown_length(shortest)} removed")
    if target.shape != grid.shape:
        done.append(f"resampled to {target.shape[0]} x {target.shape[1]} points")
    treatment = MapTreatment(
        missing=surface.missing,
        spikes=levelled.spikes,
        filled_fraction=(surface.missing + levelled.spikes) / surface.height.size,
        tilt=levelled.tilt,
        bow=levelled.bow,
        altered_fraction=altered,
        filtered_height=filtered[0],
        filtered_gradient=filtered[1],
        edge_step_before=step,
        edge_step=0.0 if options.periodic == "mirrored" else levelling.edge_step(height),
    )
    require_finite("treat_map", {"height": height})
    _, cell = boundary_on(boundary, Grid(target.shape, target.length, options.periodic == "mirrored"))
    treated = TreatedMap(
        height,
        cell,
        shortest or _two_nodes(grid, target),
        treatment,
        tuple(done),
        surface.name,
        boundary,
    )
    return treated if radii is None else _with_form(treated, options, radii, surface)


class _Levelled(NamedTuple):
    """Heights without spikes and trend, filled where there are no data, and what was removed.

    Lengths are in the unit of the map, and the tilt is in radians.
    """

    height: Array
    line_offset: float
    spikes: int
    detrend: Detrend
    tilt: float
    bow: float
    is_flat: bool


def _levelled(surface: HeightMap, options: MapOptions) -> _Levelled:
    """Scan lines levelled, spikes and trend removed, and gaps filled, in this order."""
    raw, gaps, offset, spikes = surface.height, ~np.isfinite(surface.height), 0.0, 0
    if options.scan_lines is not None:
        raw, offsets = levelling.level_lines(raw, options.scan_lines)
        offset = float(np.std(offsets))
    if options.despike is not None:
        found = levelling.find_spikes(raw, options.despike)
        gaps, spikes = gaps | found, int(np.count_nonzero(found))
    detrend = options.detrend or ("none" if is_period(options, surface) else "tilt")
    level, slope, bow = levelling.subtract_trend(raw, detrend, surface.length, ~gaps)
    is_flat = bool(np.ptp(level[~gaps]) <= FLAT_VARIATION * np.abs(raw[~gaps]).max())
    filled = levelling.fill_harmonic(level, gaps)
    return _Levelled(filled, offset, spikes, detrend, math.atan(math.hypot(*slope)), bow, is_flat)


def _words_on_heights(surface: HeightMap, options: MapOptions, found: _Levelled) -> Iterator[str]:
    """What the heights are, how their file was read, what was taken from them, and what was filled."""
    if surface.orientation == LOWER_FACE:
        yield "used as it is: the map holds an indenter's lower face"
    else:
        yield "turned upside down: the peaks of the map touch first"
    if surface.channel not in ("", UNNAMED):
        yield f"channel of the file: {one_line(surface.channel)}"
    yield from surface.notes
    if options.format == PROFILE:
        yield "line scan: the same heights for all y, which is plane strain"
    if options.scan_lines is not None:
        rms = surface.shown_length(found.line_offset)
        yield f"scan lines along x levelled ({options.scan_lines}): rms offset {rms} removed"
    if options.despike is not None:
        share = surface.shown_share(found.spikes)
        beyond = f"beyond {options.despike:g} robust standard deviations from the local median"
        yield f"spikes: {share} {beyond} replaced"
    degrees = f"tilt of {math.degrees(found.tilt):.3g}°"
    curvature = f"{degrees} and curvature of {surface.shown_length(found.bow)} height"
    trends = {"none": "mean height", "tilt": degrees, "curvature": curvature}
    remark = ""
    if is_period(options, surface):
        has_step = found.detrend != "none"
        remark = ", with a step at the edges of the period" if has_step else ", a period has no tilt"
    yield f"levelled: {trends[found.detrend]} removed{remark}"
    if surface.missing:
        yield f"non-measured: {surface.shown_share(surface.missing)} filled by a harmonic function"


def make_periodic(surface: HeightMap, options: MapOptions | None = None, **given: Any) -> TreatedMap:
    """The periodic lower face of an indenter, in units of the longer edge of its cell.

    Parameters
    ----------
    surface : HeightMap
    options : MapOptions, optional
        ``periodic="none"`` is not accepted. Numbers for `wavelength_short`, radii, `s_filter` and `l_filter`
        are in units of the longer edge of the cell, which has twice the edges of the map if it is mirrored,
        and `points` are the nodes on that edge.
    **given
        Fields of `MapOptions`, which override `options`.

    Returns
    -------
    TreatedMap
        Lengths, also in its record, are in units of the longer edge of the cell. The grid of a mirrored map
        has the nodes and the edges of the map alone.

    Raises
    ------
    MapError
        As for `prepare_map`.

    Examples
    --------
    >>> edges = 80e-6, 120e-6
    >>> heights = asp.self_affine((40, 60), 0.8, 60e-6, 10e-6, rms_height=1e-7, seed=1, length=edges)
    >>> surface = asp.HeightMap(heights, edges)
    >>> made = make_periodic(surface, periodic="mirrored")
    >>> made.height.shape, made.grid.length, made.grid.period  # the longer edge of the cell is 1
    ((40, 60), (0.33333333333333337, 0.5), (0.6666666666666667, 1.0))
    """
    options = (options or MapOptions()).replaced(**given)
    if options.periodic == "none":
        known = ", ".join(get_args(Periodicity)[:-1])
        raise MapError(surface.name, [f"periodic = 'none': one of {known} is needed"])
    if boundary_of(options) != "periodic":
        raise MapError(surface.name, [f"ends = {options.ends}: none is needed for a periodic map"])
    edge = cell_edge(surface, options)
    lengths: dict[str, Any] = {
        name: getattr(options, name)
        for name in ("wavelength_short", "radius", "radius_y", "s_filter", "l_filter")
    }
    for name, length in lengths.items():
        if isinstance(length, str):
            lengths[name] = surface.in_map_unit(name, length) / edge
    options = options.replaced(**lengths)
    scale = 1 / edge
    scaled = replace(
        surface,
        height=surface.height * scale,
        length=(surface.length[0] * scale, surface.length[1] * scale),
        unit=None,
    )
    return treat_map(scaled, options)


def boundary_of(options: MapOptions) -> str:
    """Boundary of the contact of a map."""
    if options.periodic == "none":
        return "free"
    return "periodic" if options.ends in (None, "none") else f"free along {options.ends}"


def cell_edge(surface: HeightMap, options: MapOptions) -> float:
    """Longer edge of the periodic cell that a map becomes."""
    return max(surface.length) * (2 if options.periodic == "mirrored" else 1)


def _missing(surface: HeightMap, options: MapOptions) -> list[str]:
    """Properties that neither the map nor an option states."""
    problems = []
    if surface.orientation is None:
        problems.append(ORIENTATION_NEEDED)
    if options.periodic is None and not surface.periodic:
        problems.append(
            "periodic: the file does not say that the map is one period; set it to declared, mirrored or "
            "windowed, or press it with a free boundary"
        )
    if options.periodic is None and surface.periodic and options.detrend not in (None, "none"):
        problems.append(
            f"detrend = {options.detrend!r}: the file states that the map is one period, which has no trend; "
            "leave it out, or set periodic too"
        )
    if options.ends in ("y", "x") and options.periodic in ("windowed", "none"):
        problems.append(f"ends = {options.ends}: a map that is mirrored or declared is needed")
    if surface.missing and options.undefined is None:
        problems.append(f"undefined: {surface.missing} points of the map have no data; set it to harmonic")
    return problems


def _lengths(
    surface: HeightMap, options: MapOptions, grid: Grid, target: Grid
) -> tuple[float | None, tuple[float, float | None] | None]:
    """Shortest wavelength and radii (x, y) of the form in the unit of the map, checked; None if not given."""
    wavelength, radius, radius_y = (
        None if length is None else surface.in_map_unit(name, length)
        for name in ("wavelength_short", "radius", "radius_y")
        for length in [getattr(options, name)]
    )
    shortest, longest = _two_nodes(grid, target), max(grid.length)
    if options.periodic == "mirrored":
        longest = max(grid.period)
    if wavelength is not None and not shortest * (1 - 1e-9) <= wavelength <= longest * (1 + 1e-9):
        low, high, value = (surface.shown_length(size, digits=6) for size in (shortest, longest, wavelength))
        problem = f"wavelength_short = {value}: a number ≥ {low} (two nodes), ≤ {high} is needed"
        raise MapError(surface.name, [problem])
    return wavelength, None if radius is None else (radius, radius_y)


def _filtered(
    level: Array, surface: HeightMap, options: MapOptions, grid: Grid
) -> tuple[Array, tuple[float, float], list[str]]:
    """Heights after the Gaussian filters, remaining fractions of Sq and Sdq, and both in words."""
    given = {"s_filter": options.s_filter, "l_filter": options.l_filter}
    index = {name: surface.in_map_unit(name, value) for name, value in given.items() if value is not None}
    if not index:
        return level, (1.0, 1.0), []
    if len(index) == 2 and index["s_filter"] >= index["l_filter"]:
        shown = [surface.shown_length(value, digits=6) for value in index.values()]
        raise MapError(surface.name, [f"s_filter = {shown[0]}: less than l_filter = {shown[1]} is needed"])
    continued = Grid(grid.shape, grid.length, bool(grid.mirrored) or options.periodic == "windowed")
    found = levelling.gaussian_filter(level, continued, index.get("s_filter"), index.get("l_filter"))
    sizes = [(float(np.std(height)), rms_step(height, grid.spacing)) for height in (level, found)]
    shares = sizes[1][0] / sizes[0][0], sizes[1][1] / sizes[0][1]
    if shares[0] <= FLAT_VARIATION:
        stated = ", ".join(
            f"{name} = {surface.shown_length(value, digits=6)}" for name, value in index.items()
        )
        raise MapError(surface.name, [f"{stated}: a filter that leaves some of the heights is needed"])
    names = " and ".join(
        f"{name[0].upper()}-filter of {surface.shown_length(value)}" for name, value in index.items()
    )
    heights = " to ".join(surface.shown_length(size[0]) for size in sizes)
    text = f"Gaussian {names}: Sq {heights}, Sdq {sizes[0][1]:.3g} to {sizes[1][1]:.3g}"
    return found, shares, [text]


def _grids(surface: HeightMap, options: MapOptions) -> tuple[Grid, Grid]:
    """Grid of the map before it is resampled, and after it, with about square pixels.

    Both are mirrored if the map has edges that do not match, so that no step there enters its spectrum.
    """
    has_edges = options.periodic in ("mirrored", "none") or boundary_of(options) != "periodic"
    grid = Grid(surface.height.shape, surface.length, has_edges)
    images = 2 if options.periodic == "mirrored" else 1
    if options.points is None:
        return grid, grid
    points, odd = divmod(options.points, images)
    if odd or points < 2:
        problem = f"points = {options.points}: an even number ≥ 4 is needed on the cell of a mirrored map"
        raise MapError(surface.name, [problem])
    longest = max(grid.length)
    ny, nx = (
        points if edge == longest else good_size(round(options.points * edge / longest)) // images
        for edge in grid.length
    )
    if min(ny, nx) < 2 // images:
        problem = f"points = {options.points}: more are needed for two on the shorter edge of the cell"
        raise MapError(surface.name, [problem])
    target = Grid((ny, nx), grid.length, grid.mirrored)
    need = 1e-6 * BYTES_PER_NODE[boundary_of(options)] * ny * nx
    if need > (available := available_memory()):
        problem = (
            f"points: a grid of {ny} × {nx} nodes needs about {need / 1e3:.3g} GB of memory, this machine "
            f"has {available / 1e3:.3g} GB; fewer points are needed"
        )
        raise MapError(surface.name, [problem])
    return grid, target


def _two_nodes(grid: Grid, target: Grid) -> float:
    return 2 * max(*grid.spacing, *target.spacing)


def _with_form(
    treated: TreatedMap, options: MapOptions, radii: tuple[float, float | None], surface: HeightMap
) -> TreatedMap:
    """The surface with the form of a sphere or cylinder."""
    part, (radius, radius_y) = treated.map_alone().grid, radii
    flat, word = np.zeros(part.shape), "a sphere"
    if options.form == "sphere":
        form = add_sphere(flat, part, radius, radius_y=radius_y)
    else:
        form = add_cylinder(flat, part, radius, axis=options.cylinder_axis)
        word = f"a cylinder along {options.cylinder_axis}"
    line = f"form of {word} of radius {surface.shown_length(radius, digits=4)} added"
    if radius_y is not None:
        shown_x, shown_y = (surface.shown_length(each, digits=4) for each in (radius, radius_y))
        line = f"form of radius {shown_x} along x and {shown_y} along y added"
    return replace(treated, height=treated.height + form, done=(*treated.done, line))
