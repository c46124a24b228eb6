"""Local maxima in a plane and in a stream of planes, refined between the nodes.

Neighbours
----------
A node of a plane has the 8 nodes around it, and in each of the two adjacent planes the 9 values at the same
lateral positions: 26 in all. If an adjacent plane has another grid, the values there are interpolated (six
nodes along each axis). A peak is larger than all its neighbours. Of adjacent nodes of a plane with the same
value, such as the two that face each other across the mirror of a mirrored map, the upper and then the left
one counts as larger: which of them is the peak, or whether one is, does not hang on rounding. In the surface,
the plane at depth 0, there are no neighbours above. Any other first plane and the last plane have no peaks.
Over a periodic boundary, a node at an edge has neighbours at the opposite edge. Over a free boundary it has
none across its edge.

Where the grid changes between two planes, each plane compares on its own nodes, so that both or neither could
claim a peak between them. There, two maxima that face each other (within a spacing of the coarser grid) are
decided between themselves: the one with the larger refined in-plane value is kept.

A quadratic through the 27 values gives position and value of the peak between the nodes (in the surface,
through the 9 values of the plane). Peaks of a signed field are those of its magnitude; the value keeps the
sign.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields

import numpy as np
from scipy.spatial import cKDTree

from asperity.arguments import finite_array
from asperity.finite import require_finite
from asperity.spectral import Grid
from asperity.stress.arguments import (
    BOUNDARIES,
    checked_field,
    checked_floor,
    checked_name,
    checked_nodes,
    checked_ratio,
)
from asperity.stress.fields import KINDS, PLACES, Field, Parts, needed_parts
from asperity.stress.maxima import Search, Stencil, compare, room_for, search_rows
from asperity.stress.planes import StressPlane
from asperity.stress.refinement import refine_in_plane, refine_in_solid
from asperity.types import Array

PEAKS_AT_ONCE = 16384
"""Peaks refined together: bounds the memory for their neighbourhoods."""

Nodes = tuple[Array, Array]
"""Rows and columns of nodes of a plane."""


@dataclass(frozen=True)
class Peaks:
    """Local maxima, one entry each in arrays of the same length.

    Parameters
    ----------
    value : float array
        Refined value, with its sign.
    depth, y, x : float arrays
        Refined position; y and x within the cell.
    node_value : float array
        Value at the node.
    interior : bool array
        True below the surface, False in it.
    """

    value: Array
    depth: Array
    y: Array
    x: Array
    node_value: Array
    interior: Array

    @property
    def size(self) -> int:
        """Number of peaks."""
        return self.value.size

    def under_contact(self, pressure: Array, grid: Grid, boundary: str = "periodic") -> Array:
        """True where the surface node nearest above a peak carries pressure."""
        row = np.rint(self.y / grid.spacing[0]).astype(np.int64)
        column = np.rint(self.x / grid.spacing[1]).astype(np.int64)
        if boundary == "periodic":
            row, column = row % grid.shape[0], column % grid.shape[1]
        else:
            row, column = np.clip(row, 0, grid.shape[0] - 1), np.clip(column, 0, grid.shape[1] - 1)
        return np.asarray(pressure)[row, column] > 0

    @classmethod
    def join(cls, parts: Iterable[Peaks]) -> Peaks:
        """All peaks of several sets, in their order."""
        parts = list(parts)
        empty = np.empty(0)
        if not parts:
            return cls(empty, empty, empty, empty, empty, np.empty(0, bool))
        return cls(*(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(cls)))


def plane_peaks(field: Array, grid: Grid, floor: float = 0.0, boundary: str = "periodic") -> Peaks:
    """Maxima of |field| above their 8 neighbours in a plane; of equal neighbours the first one counts.

    Parameters
    ----------
    field : (ny, nx) array
    grid : Grid
        With at least three nodes on each axis.
    floor : float
        Maxima of a magnitude at or below it are left out.
    boundary : "periodic" | "free"
        The plane repeats sideways, or has no neighbours across its edges.

    Returns
    -------
    Peaks
        At depth 0, refined in the plane.

    Raises
    ------
    ValueError
        If the field does not have the shape of the grid or is not finite, or `floor` is negative.

    Examples
    --------
    >>> grid = asp.Grid((32, 32))
    >>> y, x = grid.coordinates()
    >>> wave = np.cos(2 * np.pi * (x - 0.3)) * np.cos(2 * np.pi * (y[:, None] - 0.4))
    >>> peaks = asp.plane_peaks(wave, grid)
    >>> for value, y, x in zip(peaks.value, peaks.y, peaks.x):
    ...     print(f"{value:+.2f} at y = {y:.2f}, x = {x:.2f}")
    +1.00 at y = 0.40, x = 0.30
    -1.00 at y = 0.40, x = 0.80
    -1.00 at y = 0.90, x = 0.30
    +1.00 at y = 0.90, x = 0.80
    """
    checked_nodes(grid)
    field = checked_field("field", finite_array("field", field), grid)
    periodic = checked_name("boundary", boundary, BOUNDARIES) == "periodic"
    plane = SearchedPlane.of_field(0.0, grid, field, periodic)
    maxima = _plane_maxima(plane, checked_floor(floor))
    found = _refined(maxima, maxima.here, plane, None)
    require_finite("plane_peaks", vars(found))
    return found


def find_peaks(
    planes: Iterable[StressPlane],
    name: str,
    poisson: float | None = None,
    floor: float = 0.0,
    boundary: str = "periodic",
) -> Peaks:
    """Maxima of |field| above their 26 neighbours in a stream of planes.

    Parameters
    ----------
    planes : iterable of StressPlane
        Rising in depth, on any grids of one cell. Peaks in the surface are found if the first is at depth 0.
    name : str
        Name of a field of the planes.
    poisson : float, optional
        One of the Poisson's ratios of the planes, needed if they have several.
    floor : float
        Maxima of a magnitude at or below it are left out.
    boundary : "periodic" | "free"
        That of the contact.

    Raises
    ------
    ValueError
        If the planes do not have the field or the Poisson's ratio, do not rise in depth, or are not finite.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> planes = asp.stress_planes(contact, np.linspace(0, 0.1, 21), fields=("largest_shear",))
    >>> peaks = asp.find_peaks(planes, "largest_shear", floor=0.1 * contact.max_pressure)
    >>> highest = peaks.value.argmax()
    >>> bool(0.25 < peaks.value[highest] / contact.max_pressure < 0.35)  # 0.31 under a ball
    True
    """
    finder = PeakFinder(checked_name("boundary", boundary, BOUNDARIES))
    floor = checked_floor(floor)
    for plane in planes:
        fields = plane.fields[checked_name("name", name, list(plane.fields))]
        ratio = plane.poisson.index(checked_ratio(poisson, plane.poisson))
        checked_nodes(plane.grid)
        finder.add(plane.depth, plane.grid, checked_field("field", fields[ratio], plane.grid), floor)
    found = finder.peaks()
    require_finite("find_peaks", vars(found))
    return found


@dataclass(frozen=True)
class SearchedPlane:
    """One field of a plane, of which the peaks are sought.

    Parameters
    ----------
    depth : float
    grid : Grid
    parts : Parts
    field : Field
    periodic : bool
        True if opposite edges are neighbours.
    """

    depth: float
    grid: Grid
    parts: Parts
    field: Field
    periodic: bool

    @classmethod
    def of_field(cls, depth: float, grid: Grid, field: Array, periodic: bool) -> SearchedPlane:
        """A plane with a field of its own."""
        zero = field.dtype.type(0)
        values = np.ascontiguousarray(field)[:, None]
        parts = Parts(values, np.zeros(PLACES, np.int64), grid.shape[1], zero)
        return cls(depth, grid, parts, Field(KINDS["zz"], zero, zero), periodic)

    def compare(self, maxima: Maxima, grid: Grid) -> tuple[Array, Array]:
        """True where a maximum in a plane on `grid` is above the nine values here, and these, (nodes, 3, 3).

        Where it is not, some of the values are left out.
        """
        return self._compare(maxima.nodes, np.abs(maxima.here[:, 1, 1]), grid)

    def values_around(self, nodes: Nodes, grid: Grid) -> Array:
        """The nine values at and around nodes of a grid of the cell, (nodes, 3, 3)."""
        return self._compare(nodes, np.full(nodes[0].size, np.inf), grid)[1]

    def _compare(self, nodes: Nodes, magnitude: Array, grid: Grid) -> tuple[Array, Array]:
        real, place = self.parts.values.dtype, self.parts.place
        kept, values = np.ones(magnitude.size, bool), np.empty((magnitude.size, 3, 3), real)
        stencil = Stencil(
            needed_parts(self.field.kind, place),
            np.where(place >= 0, np.arange(PLACES), -1),
            np.empty((1, PLACES, 1)),
            np.empty((2, 6), np.int64),
            np.empty((2, 6)),
        )
        last = grid.shape, self.periodic, magnitude.astype(real, copy=False), stencil, kept, values
        compare(self.parts, self.field, nodes[0], nodes[1], *last)
        return kept, values


@dataclass
class Maxima:
    """Maxima of one plane over their neighbours in it.

    Parameters
    ----------
    nodes : (rows, columns)
    here : (maxima, 3, 3) array
        Values at and around the nodes.
    above : (maxima, 3, 3) array or None
        Those in the plane above, if the maxima exceed them; None in the first plane.
    """

    nodes: Nodes
    here: Array
    above: Array | None = None

    @classmethod
    def at(cls, index: Array, here: Array, grid: Grid, above: Array | None = None) -> Maxima:
        """Maxima at flat indices of nodes."""
        row, column = np.divmod(index, grid.shape[1])
        return cls((row, column), here, above)

    def select(self, chosen: Array) -> Maxima:
        """Some of the maxima."""
        above = None if self.above is None else self.above[chosen]
        return Maxima((self.nodes[0][chosen], self.nodes[1][chosen]), self.here[chosen], above)


class PeakFinder:
    """Finds the maxima of one field as its planes are added one by one.

    Parameters
    ----------
    boundary : "periodic" | "free"
        That of the contact.
    """

    def __init__(self, boundary: str = "periodic") -> None:
        self._periodic = boundary == "periodic"
        self._found: list[Peaks] = []
        self._last: SearchedPlane | None = None
        self._depth_above: float | None = None
        self._candidates: Maxima | None = None

    def peaks(self) -> Peaks:
        """All peaks found so far: those of every plane but the last."""
        return Peaks.join(self._found)

    def add(self, depth: float, grid: Grid, field: Array, floor: float = 0.0) -> None:
        """Add the next plane downward.

        Parameters
        ----------
        depth : float
        grid : Grid
            With at least three nodes on each axis.
        field : (ny, nx) array
            Of finite numbers in single or double precision; this is not checked. It is kept until the next
            plane.
        floor : float
            Maxima of a magnitude at or below it are left out.
        """
        plane = SearchedPlane.of_field(float(depth), grid, field, self._periodic)
        self.add_maxima(plane, _plane_maxima(plane, floor))

    def add_maxima(self, plane: SearchedPlane, maxima: Maxima) -> None:
        """Add the next plane downward, with the maxima in it or those of them that exceed the plane above.

        The arrays of a plane must last until the plane after the next is computed.
        """
        last = self._last
        if last is None:
            # Of the planes that may come first, the surface alone has no neighbour above.
            self._candidates = maxima if plane.depth == 0 else maxima.select(np.zeros(0, np.int64))
        else:
            if not plane.depth > last.depth:
                raise ValueError(
                    f"depth = {plane.depth!r}: planes rising in depth are needed, below {last.depth}"
                )
            if maxima.above is None:
                kept, maxima.above = last.compare(maxima, plane.grid)
            else:
                kept = np.ones(maxima.here.shape[0], bool)
            self._finish(last, plane, maxima, kept)
            self._depth_above = last.depth
            self._candidates = maxima.select(np.flatnonzero(kept))
        self._last = plane

    def _finish(self, last: SearchedPlane, plane: SearchedPlane, lower: Maxima, lower_kept: Array) -> None:
        """Decide on the candidates of the last plane, and on those of this plane that face them."""
        upper = self._candidates
        assert upper is not None
        kept, below = plane.compare(upper, last.grid)
        if last.grid.shape != plane.grid.shape:
            pair, partner, wins = _facing(upper, last, lower, plane)
            kept[pair], lower_kept[partner] = wins, ~wins
            # Maxima that win have not been compared with all nine values.
            won, won_below = pair[wins], partner[~wins]
            assert lower.above is not None
            below[won] = plane.values_around(upper.select(won).nodes, last.grid)
            lower.above[won_below] = last.values_around(lower.select(won_below).nodes, plane.grid)
        depths = None if self._depth_above is None else (self._depth_above, last.depth, plane.depth)
        every = np.flatnonzero(kept)
        for start in range(0, every.size, PEAKS_AT_ONCE):
            some = upper.select(every[start : start + PEAKS_AT_ONCE])
            under = below[every[start : start + PEAKS_AT_ONCE]]
            self._found.append(_refined(some, under, last, depths))


def _facing(
    upper: Maxima, upper_plane: SearchedPlane, lower: Maxima, lower_plane: SearchedPlane
) -> tuple[Array, Array, Array]:
    """Pairs of maxima that face each other across a change of grid, and where the upper one is the larger.

    Returns
    -------
    upper, lower : (pairs,) integer arrays
        Indices of the two maxima of each pair.
    wins : (pairs,) bool array
    """
    nothing = np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0, bool)
    if not (upper.here.size and lower.here.size):
        return nothing
    scale = np.maximum(upper_plane.grid.spacing, lower_plane.grid.spacing)
    box = np.array(upper_plane.grid.length) / scale if upper_plane.periodic else None

    def places(plane: SearchedPlane, nodes: Nodes, y: Array | float, x: Array | float) -> Array:
        place = np.stack(_positions(nodes, y, x, plane.grid, plane.periodic), axis=1) / scale
        return place if box is None else place % box

    # Refined positions are at most one spacing from their nodes.
    around = cKDTree(places(upper_plane, upper.nodes, 0.0, 0.0), boxsize=box)
    at_nodes = places(lower_plane, lower.nodes, 0.0, 0.0)
    distance, _ = around.query(at_nodes, p=np.inf, distance_upper_bound=3.001)
    near = np.flatnonzero(np.isfinite(distance))
    if not near.size:
        return nothing
    lower = lower.select(near)
    high, *offset_up = refine_in_plane(_upright(upper.here, upper.here))
    low, *offset_low = refine_in_plane(_upright(lower.here, lower.here))
    place_up = places(upper_plane, upper.nodes, *offset_up)
    place_low = places(lower_plane, lower.nodes, *offset_low)
    distance, facing = cKDTree(place_low, boxsize=box).query(place_up, p=np.inf)
    back = np.asarray(cKDTree(place_up, boxsize=box).query(place_low, p=np.inf)[1])
    pair = np.flatnonzero((np.asarray(distance) <= 1.0) & (back[facing] == np.arange(high.size)))
    partner = np.asarray(facing)[pair]
    return pair, near[partner], high[pair] > low[partner]


def _refined(
    maxima: Maxima, below: Array, plane: SearchedPlane, depths: tuple[float, float, float] | None
) -> Peaks:
    """Peaks of one plane; `depths` are those above, here and below, or None in the surface."""
    here, above = maxima.here.astype(float, copy=False), maxima.above
    if depths is None or above is None:
        value, y, x = refine_in_plane(_upright(here, here))
        depth = np.full(y.size, plane.depth)
    else:
        cube = np.stack([_upright(values, here) for values in (above, here, below)], axis=1)
        value, depth, y, x = refine_in_solid(cube, *depths)
    return Peaks(
        value * np.sign(here[:, 1, 1]),
        depth,
        *_positions(maxima.nodes, y, x, plane.grid, plane.periodic),
        here[:, 1, 1],
        np.full(y.size, depths is not None),
    )


def _upright(values: Array, centre: Array) -> Array:
    """Neighbourhoods with the sign changed where the value at their centre is negative."""
    return values * np.sign(centre[:, 1:2, 1:2])


def _positions(
    nodes: Nodes, y: Array | float, x: Array | float, grid: Grid, periodic: bool
) -> tuple[Array, Array]:
    """Positions of points at the offsets y, x (in spacings) from nodes; within the cell if it is periodic."""
    row, column = nodes[0] + y, nodes[1] + x
    if periodic:
        row, column = row % grid.shape[0], column % grid.shape[1]
    return row * grid.spacing[0], column * grid.spacing[1]


def _plane_maxima(plane: SearchedPlane, floor: float) -> Maxima:
    """Nodes whose magnitude is above the floor and above its 8 neighbours, in their order."""
    rows, columns = plane.grid.shape
    real = plane.parts.values.dtype
    capacity = (rows // 2 + 2) * (columns // 2 + 1)
    room = room_for(1, columns, capacity, real, lambda _, shape, dtype: np.empty(shape, dtype))
    kind, ratio, uniform = plane.field
    search = Search(
        np.empty(0, np.int64),
        np.array([kind]),
        np.array([ratio], real),
        np.array([uniform], real),
        np.array([True]),
        np.array([-1]),
        real.type(floor),
        plane.periodic,
        False,
    )
    # One row more at both ends: the rows at the edges are compared with their neighbours too.
    nothing = np.empty((0, 1, 1), real), np.empty((0, 0, 0))
    search_rows(plane.parts, plane.parts, search, room, -1, -1, rows + 1, *nothing)
    count = room.counts[0]
    return Maxima.at(room.found[0, :count], room.around[0, :count], plane.grid)
