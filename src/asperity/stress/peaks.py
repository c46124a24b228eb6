"""Local maxima in a plane and in a stream of planes, refined between the nodes.

Neighbours
----------
A node of a plane has the 8 nodes around it, and in each of the two adjacent planes the 9 values at the same
lateral positions: 26 in all. If an adjacent plane has another grid, the values there are interpolated (six
nodes along each axis). A peak is strictly larger than all its neighbours. In the surface, the plane at depth
0, there are none above. Any other first plane and the last plane have no peaks. Over a periodic boundary, a
node at an edge has neighbours at the opposite edge. Over a free boundary it has none across its edge.

Where the grid changes between two planes, each plane compares on its own nodes, so that both or neither could
claim a peak between them. There, two maxima that face each other (within a spacing of the coarser grid) are
decided between themselves: the one with the larger refined in-plane value is kept.

A quadratic through the 27 values gives position and value of the peak between the nodes (in the surface,
through the 9 values of the plane). Peaks of a signed field are those of its magnitude; the value keeps the
sign.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
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
from asperity.stress.kernels import find_maxima, gather, interpolate
from asperity.stress.planes import Gather, StressPlane
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
    """Maxima of |field| strictly above their 8 neighbours in a plane.

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
    nodes = _plane_maxima(field, checked_floor(floor), periodic)
    values = _neighbourhood(field, *nodes, periodic)
    refined, y, x = refine_in_plane(_upright(values, values))
    found = Peaks(
        refined * np.sign(values[:, 1, 1]),
        np.zeros(nodes[0].size),
        *_positions(nodes, y, x, grid, periodic),
        values[:, 1, 1],
        np.zeros(nodes[0].size, bool),
    )
    require_finite("plane_peaks", vars(found))
    return found


def find_peaks(
    planes: Iterable[StressPlane],
    name: str,
    poisson: float | None = None,
    floor: float = 0.0,
    boundary: str = "periodic",
) -> Peaks:
    """Maxima of |field| strictly above their 26 neighbours in a stream of planes.

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


@dataclass
class _Candidates:
    """Maxima of one plane over their neighbours in it and in the plane above.

    Parameters
    ----------
    nodes : (rows, columns)
    above, here : (maxima, 3, 3) arrays
        Values at and around the nodes, in the plane above and in their own.
    kept : (maxima,) bool array
        True where the maximum is also above its neighbours in the adjacent planes that were compared.
    """

    nodes: Nodes
    above: Array
    here: Array
    kept: Array

    def select(self, chosen: Array | slice) -> _Candidates:
        """Some of the candidates."""
        nodes = self.nodes[0][chosen], self.nodes[1][chosen]
        return _Candidates(nodes, self.above[chosen], self.here[chosen], self.kept[chosen])


@dataclass(frozen=True)
class _AdjacentPlane:
    """A plane as its neighbours see it.

    Parameters
    ----------
    depth : float
    grid : Grid
    sample : callable
        Returns values of the field, made from what the function it is given gathers of the plane's arrays.
    periodic : bool
        True if opposite edges are neighbours.
    """

    depth: float
    grid: Grid
    sample: Callable[[Gather], Array]
    periodic: bool

    def values_around(self, nodes: Nodes, grid: Grid) -> Array:
        """The nine values at and around nodes of `grid`, (nodes, 3, 3)."""
        if self.grid.shape == grid.shape:
            return self.sample(lambda array: _neighbourhood(array, *nodes, self.periodic))
        y, x = (mine / its for mine, its in zip(self.grid.shape, grid.shape, strict=True))
        return self.sample(
            lambda array: _interpolated_neighbourhood(array, *nodes, y, x, grid.shape, self.periodic)
        )


class PeakFinder:
    """Finds the maxima of one field as its planes are added one by one; keeps one plane in memory.

    Parameters
    ----------
    boundary : "periodic" | "free"
        That of the contact.
    """

    def __init__(self, boundary: str = "periodic") -> None:
        self._periodic = boundary == "periodic"
        self._found: list[Peaks] = []
        self._last: _AdjacentPlane | None = None
        self._depth_above: float | None = None
        self._candidates: _Candidates | None = None

    def peaks(self) -> Peaks:
        """All peaks found so far: those of every plane but the last."""
        return Peaks.join(self._found)

    def add(
        self,
        depth: float,
        grid: Grid,
        field: Array,
        floor: float = 0.0,
        sample: Callable[[Gather], Array] | None = None,
    ) -> None:
        """Add the next plane downward.

        Parameters
        ----------
        depth : float
        grid : Grid
            With at least three nodes on each axis.
        field : (ny, nx) array
            Of finite numbers in single or double precision; this is not checked.
        floor : float
            Maxima of a magnitude at or below it are left out.
        sample : callable, optional
            Returns values of the field, made from what the function it is given gathers of arrays like
            `field`. It is kept until the next plane, and `field` is not; by default the field itself is kept.
        """
        plane = _AdjacentPlane(float(depth), grid, sample or (lambda take: take(field)), self._periodic)
        nodes = _plane_maxima(field, floor, self._periodic)
        here = _neighbourhood(field, *nodes, self._periodic)
        last = self._last
        if last is None:
            candidates = _Candidates(nodes, here, here, np.full(nodes[0].size, plane.depth == 0))
        else:
            if not plane.depth > last.depth:
                raise ValueError(f"depth = {depth!r}: planes rising in depth are needed, below {last.depth}")
            above = last.values_around(nodes, grid)
            candidates = _Candidates(nodes, above, here, _exceeds(here, above))
            self._finish(last, plane, candidates)
            self._depth_above = last.depth
        self._candidates, self._last = candidates.select(candidates.kept), plane

    def _finish(self, last: _AdjacentPlane, plane: _AdjacentPlane, lower: _Candidates) -> None:
        """Decide on the candidates of the last plane, and on those of this plane that face them."""
        upper = self._candidates
        assert upper is not None
        below = plane.values_around(upper.nodes, last.grid)
        upper.kept = _exceeds(upper.here, below)
        if last.grid.shape != plane.grid.shape:
            _keep_one_of_each_pair(upper, last.grid, lower, plane.grid, self._periodic)
        peaks, below = upper.select(upper.kept), below[upper.kept]
        depths = None if self._depth_above is None else (self._depth_above, last.depth, plane.depth)
        for start in range(0, len(below), PEAKS_AT_ONCE):
            some = slice(start, start + PEAKS_AT_ONCE)
            self._found.append(_refined(peaks.select(some), below[some], last, depths))


def _keep_one_of_each_pair(
    upper: _Candidates, upper_grid: Grid, lower: _Candidates, lower_grid: Grid, periodic: bool
) -> None:
    """Keep one of every two maxima that face each other across a change of grid."""
    if not (upper.nodes[0].size and lower.nodes[0].size):
        return
    value_up, y_up, x_up = refine_in_plane(_upright(upper.here, upper.here))
    value_low, y_low, x_low = refine_in_plane(_upright(lower.here, lower.here))
    scale = np.maximum(upper_grid.spacing, lower_grid.spacing)
    box = np.array(upper_grid.length) / scale
    place_up = np.stack(_positions(upper.nodes, y_up, x_up, upper_grid, periodic), axis=1) / scale
    place_low = np.stack(_positions(lower.nodes, y_low, x_low, lower_grid, periodic), axis=1) / scale
    around = None
    if periodic:
        around, place_up, place_low = box, place_up % box, place_low % box
    tree_up, tree_low = cKDTree(place_up, boxsize=around), cKDTree(place_low, boxsize=around)
    distance, facing = tree_low.query(place_up, p=np.inf)
    back = np.asarray(tree_up.query(place_low, p=np.inf)[1])
    pair = np.flatnonzero((np.asarray(distance) <= 1.0) & (back[facing] == np.arange(upper.nodes[0].size)))
    partner = np.asarray(facing)[pair]
    wins = value_up[pair] > value_low[partner]
    upper.kept[pair] = wins
    lower.kept[partner] = ~wins


def _refined(
    candidates: _Candidates, below: Array, plane: _AdjacentPlane, depths: tuple[float, float, float] | None
) -> Peaks:
    """Peaks of one plane; `depths` are those above, here and below, or None in the surface."""
    here = candidates.here
    if depths is None:
        value, y, x = refine_in_plane(_upright(here, here))
        depth = np.full(y.size, plane.depth)
    else:
        cube = np.stack([_upright(values, here) for values in (candidates.above, here, below)], axis=1)
        value, depth, y, x = refine_in_solid(cube, *depths)
    return Peaks(
        value * np.sign(here[:, 1, 1]),
        depth,
        *_positions(candidates.nodes, y, x, plane.grid, plane.periodic),
        here[:, 1, 1],
        np.full(y.size, depths is not None),
    )


def _upright(values: Array, centre: Array) -> Array:
    """Neighbourhoods with the sign changed where the value at their centre is negative."""
    return values * np.sign(centre[:, 1:2, 1:2])


def _exceeds(here: Array, other: Array) -> Array:
    """True where the magnitude at the centre is above those of nine others."""
    return np.abs(here[:, 1, 1]) > np.abs(other).max(axis=(1, 2), initial=0.0)


def _positions(nodes: Nodes, y: Array, x: Array, grid: Grid, periodic: bool) -> tuple[Array, Array]:
    """Positions of points at the offsets y, x (in spacings) from nodes; within the cell if it is periodic."""
    row, column = nodes[0] + y, nodes[1] + x
    if periodic:
        row, column = row % grid.shape[0], column % grid.shape[1]
    return row * grid.spacing[0], column * grid.spacing[1]


def _neighbourhood(field: Array, row: Array, column: Array, periodic: bool) -> Array:
    """The nine values at and around nodes, (nodes, 3, 3)."""
    out = np.empty((row.size, 3, 3))
    gather(field, row, column, periodic, out)
    return out


def _interpolated_neighbourhood(
    field: Array,
    row: Array,
    column: Array,
    ratio_y: float,
    ratio_x: float,
    other: tuple[int, int],
    periodic: bool,
) -> Array:
    """The nine values at and around nodes of a grid whose spacing is `ratio` times larger, (nodes, 3, 3)."""
    out = np.empty((row.size, 3, 3))
    interpolate(field, row, column, ratio_y, ratio_x, other, periodic, out)
    return out


def _plane_maxima(field: Array, floor: float, periodic: bool) -> Nodes:
    """Nodes whose magnitude is above the floor and strictly above its 8 neighbours."""
    found = np.empty((field.shape[0] + 1) * (field.shape[1] + 1) // 4 + 1, np.int64)
    count = find_maxima(field, float(floor), periodic, found)
    return found[:count] // field.shape[1], found[:count] % field.shape[1]
