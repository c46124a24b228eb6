"""Local maxima of a field in a plane and in a stream of planes, refined between the nodes.

Neighbours
----------
A node of a plane has the 8 nodes around it, and in each of the two adjacent planes the 9 values at the same
lateral positions: 26 in all. If an adjacent plane has another grid, the values there are interpolated (six
nodes along each axis). A peak is larger than all its neighbours. In the surface, the plane at depth 0, there
are no neighbours above. Any other first plane and the last plane have no peaks. Two planes at consecutive
floating-point numbers are the two faces of the interface under a coating: neither has neighbours in the
other. Over a periodic boundary, a node at an edge has neighbours at the opposite edge. Over a free boundary
it has none across its edge. On a mirrored map they are the images of the node and of its neighbours. An
outermost node with the same value as its image is one peak, on the mirror line.

Where the grid changes between two planes, each plane compares on its own nodes, so that both or neither could
claim a peak between them. There, of two matched maxima of the planes (within a spacing of the coarser grid)
the one with the larger refined in-plane value is kept.

Peaks of a signed field are peaks of its magnitude; the value keeps the sign.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from asperity.core.arguments import choice, number, require_finite
from asperity.core.types import Array
from asperity.fourier.grid import EVEN, Grid, boundary_on
from asperity.stress.peaks.maxima import Entries, Maxima, refine_in_plane, refine_in_solid
from asperity.stress.peaks.search import Lower, PlaneSearch
from asperity.stress.peaks.selection import checked_ratio
from asperity.stress.planes.fields import (
    FIELDS,
    MIRRORED,
    ODD,
    PERIODIC,
    PlaneFields,
    bands_of,
    edges_of,
    strips_of,
)
from asperity.stress.planes.planes import StressPlane

REFINED_AT_ONCE = 2**12
"""Peaks that are refined together: about a kilobyte each."""

REACH = 3.001
"""Largest distance of the nodes of two matched maxima, in spacings of the coarser grid: refined positions are
at most one spacing from their nodes, and from each other."""

MAX_SQUARES = 1024
"""Most squares along an edge of the cell in which maxima near others are looked for."""


@dataclass(frozen=True)
class Peaks(Entries):
    """Local maxima, one entry each in arrays of the same length.

    Parameters
    ----------
    value : float array
        Refined value, with its sign.
    depth, y, x : float arrays
        Refined position; y and x within the cell, from the first node of the finest grid. On a mirrored map
        they reach from half a spacing before this node, the mirror line.
    node_value : float array
        Value at the node.
    interior : bool array
        True below the surface, False in it.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> planes = asp.stress_planes(contact, [0.0, 0.005, 0.01, 0.015], fields=("von_mises",))
    >>> peaks = asp.stress.find_peaks(planes, "von_mises")
    >>> peaks.value.shape == peaks.depth.shape, bool(peaks.depth.max() < 0.015)
    (True, True)
    """

    value: Array
    depth: Array
    y: Array
    x: Array
    node_value: Array
    interior: Array

    def under_contact(self, pressure: Array, grid: Grid, boundary: str = "periodic") -> Array:
        """True where the surface node nearest above a peak carries pressure."""
        along = zip((self.y, self.x), grid.spacing, grid.shape, edges_of(boundary, grid), strict=True)
        nearest = ((np.rint(at / step).astype(np.int64), nodes, edges) for at, step, nodes, edges in along)
        row, column = (
            node % nodes if edges == PERIODIC else np.clip(node, 0, nodes - 1)
            for node, nodes, edges in nearest
        )
        return np.asarray(pressure)[row, column] > 0


_NOTHING = np.empty(0)
NO_PEAKS = Peaks(_NOTHING, _NOTHING, _NOTHING, _NOTHING, _NOTHING, np.empty(0, bool))


class SearchedPlane(NamedTuple):
    """Fields of a plane, of which the peaks are sought; `refresh` brings their basis fields into memory.

    `first_node` is the position y, x of the first node.
    """

    depth: float
    grid: Grid
    first_node: tuple[float, float]
    fields: PlaneFields
    refresh: Callable[..., None] = lambda: None

    def exceeded(
        self, maxima: Maxima, grid: Grid, decided: Array, wins: Array, threads: int
    ) -> tuple[Array, Array]:
        """Maxima in a plane on `grid` that are above the nine values here, and these values.

        For the maxima `decided`, `wins` is the answer, whatever the values are.
        """
        self.refresh()
        magnitude = maxima.magnitude
        magnitude[decided] = np.where(wins, np.inf, 0.0)
        return self.fields.exceeded(maxima.field, maxima.row, maxima.column, grid.shape, magnitude, threads)


class PeakFinder:
    """Finds the peaks of one or several fields as their planes are added one by one."""

    def __init__(self, threads: int = 1) -> None:
        self._threads = threads
        self._found: list[tuple[Array, Peaks]] = []
        self._last: tuple[SearchedPlane, Maxima] | None = None
        self._depth_above = np.nan

    def peaks(self, field: int = 0) -> Peaks:
        """Peaks of a field found so far, in every plane but the last."""
        of_field = [peaks.select(np.flatnonzero(own == field)) for own, peaks in self._found]
        return Peaks.join([NO_PEAKS, *of_field])

    def plane_above(self, depth: float, grid: Grid) -> tuple[PlaneFields | None, Maxima | None]:
        """The last plane and its candidates, if it is on this grid and in the material at this depth."""
        if self._last is None or self._last[0].grid != grid or self._are_faces(depth):
            return None, None
        return self._last[0].fields, self._last[1]

    def _are_faces(self, depth: float) -> bool:
        """True if a plane at this depth and the last one are the two faces of an interface."""
        return self._last is not None and depth == np.nextafter(self._last[0].depth, np.inf)

    def finish(self) -> None:
        """Forget the last plane, in which there are no peaks."""
        self._last = None

    def add(self, plane: SearchedPlane, search: PlaneSearch, floor: float) -> None:
        """Add the next plane downward.

        Parameters
        ----------
        plane : SearchedPlane
            Its arrays must last until the plane after the next is computed.
        search : PlaneSearch
            All its rows are added.
        floor : float
            Of the maxima in the plane.
        """
        # The maxima of the last plane are compared first: `LinearPlane.refresh` may overwrite this plane.
        # Maxima take much memory: they are deleted as soon as they are no longer needed.
        lower = search.lower()
        if self._last is None:
            maxima = search.maxima(floor)
            # Of the planes that may come first, the surface alone has no neighbour above.
            maxima = maxima if plane.depth == 0 else maxima.select(np.empty(0, np.int64))
        elif self._are_faces(plane.depth):
            last, upper = self._last
            self._found.append((upper.field, _refined(upper, last)))
            self._depth_above = last.depth
            maxima = search.maxima(floor)
        else:
            last, upper = self._last
            if not plane.depth > last.depth:
                raise ValueError(
                    f"depth = {plane.depth!r}: planes rising in depth are needed, below {last.depth}"
                )
            self._last = None
            pair = partner = np.empty(0, np.int64)
            wins = np.empty(0, bool)
            if last.grid == plane.grid:
                self._add_peaks(upper, last, lower, plane)
                del upper, lower
                maxima = search.maxima(floor)
            else:
                maxima = search.maxima(floor)
                if upper.size and maxima.size:
                    pair, partner, wins = _matched_maxima(upper, last, maxima, plane)
                lower = Lower(*plane.exceeded(upper, last.grid, pair, wins, self._threads))
                self._add_peaks(upper, last, lower, plane)
                del upper, lower
            self._depth_above = last.depth
            if maxima.above is None:
                kept, above = last.exceeded(maxima, plane.grid, partner, ~wins, self._threads)
                maxima = maxima.select(kept)
                maxima.above = above
        self._last = plane, maxima

    def _add_peaks(self, upper: Maxima, last: SearchedPlane, lower: Lower, plane: SearchedPlane) -> None:
        """Add the maxima of the last plane that exceed this one."""
        depths = self._depth_above, last.depth, plane.depth
        for start in range(0, lower.size, REFINED_AT_ONCE):
            some = slice(start, start + REFINED_AT_ONCE)
            found = upper.select(lower.number[some])
            self._found.append((found.field, _refined(found, last, lower.values[some], depths)))


def _refined(
    maxima: Maxima, plane: SearchedPlane, below: Array | None = None, depths: tuple[float, ...] = ()
) -> Peaks:
    """Peaks from maxima of a plane, refined in it alone where no plane above is known.

    `below` are the values at and around the nodes in the plane below, `depths` belong to the three planes.
    """
    if maxima.above is None or below is None:
        value, *offsets = refine_in_plane(maxima.here)
        depth = np.full(maxima.size, plane.depth)
    else:
        value, depth, *offsets = refine_in_solid(maxima.above, maxima.here, below, depths)
    node_value = maxima.here[:, 1, 1].astype(float)
    y, x = _positions(maxima, plane, offsets).T
    interior = np.full(maxima.size, plane.depth > 0)
    return Peaks(value * np.sign(node_value), depth, y, x, node_value, interior)


def _positions(maxima: Maxima, plane: SearchedPlane, offsets: list[Array]) -> Array:
    """Positions of maxima within the cell, (maxima, 2)."""
    nodes, spacing = np.array(plane.grid.shape), np.array(plane.grid.spacing)
    places = np.stack([maxima.row + offsets[0], maxima.column + offsets[1]], axis=1)
    if MIRRORED in plane.fields.edges:
        # A node of an even field and its image have the same value, and the maximum lies between them.
        is_even = ~np.array([ODD.get(name, EVEN) for name in FIELDS])[plane.fields.formulas.kinds]
        row_column = np.stack([maxima.row, maxima.column], axis=1)
        for edge, line in ((0, -0.5), (nodes - 1, nodes - 0.5)):
            places = np.where(is_even[maxima.field] & (row_column == edge), line, places)
        return places * spacing + plane.first_node
    for axis, edges in enumerate(plane.fields.edges):
        if edges == PERIODIC:
            along = places[:, axis]
            along %= nodes[axis]
            # The remainder of a small negative number may be rounded to the length.
            along[along >= nodes[axis]] = 0.0
    return places * spacing


def _matched_maxima(
    upper: Maxima, upper_plane: SearchedPlane, lower: Maxima, lower_plane: SearchedPlane
) -> tuple[Array, Array, Array]:
    """Matched maxima of neighbouring planes on different grids, and where the upper one is the larger.

    Two maxima match if their refined positions are within a spacing of the coarser grid, and no other ones
    are nearer. Returns the indices of both maxima of each pair, and a truth value, (pairs,) each.
    """
    spacing = np.maximum(upper_plane.grid.spacing, lower_plane.grid.spacing)
    cell = np.array(upper_plane.grid.length) / spacing
    count = np.clip(cell // REACH, 1, MAX_SQUARES).astype(int)

    def squares(maxima: Maxima, plane: SearchedPlane, shift: tuple[int, ...] = (0, 0)) -> tuple[Array, ...]:
        along, before = zip((maxima.row, maxima.column), shift, plane.grid.shape, count, strict=True), 0
        if plane.grid.mirrored:  # the first node is half a spacing from the mirror line
            before = 1
        return maxima.field, *(
            ((2 * node + before) * size // (2 * nodes) + step) % size for node, step, nodes, size in along
        )

    taken = np.zeros((upper_plane.fields.formulas.kinds.size, *count), bool)
    for shift in product((-1, 0, 1), repeat=2):
        taken[squares(upper, upper_plane, shift)] = True
    # Few maxima of the lower plane have one of the upper plane in their square or a neighbouring one.
    near = np.flatnonzero(taken[squares(lower, lower_plane)])
    if not near.size:
        return near, near, np.empty(0, bool)
    values, places = [], []
    for maxima, plane in ((upper, upper_plane), (lower.select(near), lower_plane)):
        value, *offsets = refine_in_plane(maxima.here)
        place = _positions(maxima, plane, offsets) / spacing
        values.append(value)
        places.append(np.column_stack([place, 2.0 * maxima.field]))  # a third dimension keeps fields apart
    (high, low), (place_up, place_low) = values, places
    from scipy.spatial import cKDTree  # a tenth of a second, and planes of one grid need none

    repeats = np.array(upper_plane.fields.edges) == PERIODIC
    box = np.array([*np.where(repeats, cell, 0.0), 0.0]) if repeats.any() else None
    distance, nearest = cKDTree(place_low, boxsize=box).query(place_up, p=np.inf)
    close = np.flatnonzero(np.asarray(distance) <= 1.0)
    partner = np.asarray(nearest)[close]
    mutual = np.asarray(cKDTree(place_up, boxsize=box).query(place_low[partner], p=np.inf)[1]) == close
    pair, partner = close[mutual], partner[mutual]
    return pair, near[partner], high[pair] > low[partner]


def plane_peaks(field: Array, grid: Grid, floor: float = 0.0, boundary: str = "periodic") -> Peaks:
    """Maxima of |field| above their 8 neighbours in a plane; of equal neighbours the first one is taken.

    Parameters
    ----------
    field : (ny, nx) array
    grid : Grid
        With at least three nodes on each axis; mirrored if the field is even about the mirror lines.
    floor : float
        Maxima of a magnitude at or below it are left out.
    boundary : "periodic" | "free"
        The plane, with its mirror images if it is mirrored, repeats sideways, or has no neighbours across
        its edges.

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
    >>> peaks = asp.stress.plane_peaks(wave, grid)
    >>> for value, y, x in zip(peaks.value, peaks.y, peaks.x):
    ...     print(f"{value:+.2f} at y = {y:.2f}, x = {x:.2f}")
    +1.00 at y = 0.40, x = 0.30
    -1.00 at y = 0.40, x = 0.80
    -1.00 at y = 0.90, x = 0.30
    +1.00 at y = 0.90, x = 0.80
    """
    plane, search, floor = _searched((0.0, grid, (0.0, 0.0)), "zz", field, floor, boundary)
    found = _refined(search.maxima(floor), plane)
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
        Boundary of the contact.

    Returns
    -------
    Peaks

    Raises
    ------
    ValueError
        If the planes do not have the field or the Poisson's ratio, do not rise in depth, or are not finite.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> planes = asp.stress_planes(contact, np.linspace(0, 0.1, 21), fields=("maximum_shear",))
    >>> peaks = asp.stress.find_peaks(planes, "maximum_shear", floor=0.1 * contact.maximum_pressure)
    >>> highest = peaks.value.argmax()
    >>> bool(0.25 < peaks.value[highest] / contact.maximum_pressure < 0.35)  # 0.31 under a ball
    True
    """
    finder = PeakFinder()
    for plane in planes:
        values = plane.fields[choice("name", name, list(plane.fields))]
        ratio = plane.poisson.index(checked_ratio(poisson, plane.poisson))
        above = finder.plane_above(plane.depth, plane.grid)
        own = plane.depth, plane.grid, plane.first_node
        finder.add(*_searched(own, name, values[ratio], floor, boundary, *above))
    found = finder.peaks()
    require_finite("find_peaks", vars(found))
    return found


def _searched(
    own: tuple[float, Grid, tuple[float, float]],
    name: str,
    field: Array,
    floor: float,
    boundary: str,
    above: PlaneFields | None = None,
    candidates: Maxima | None = None,
) -> tuple[SearchedPlane, PlaneSearch, float]:
    """A plane with one field, its search and the floor; the arguments are checked here.

    `own` are the first entries of a `SearchedPlane`.
    """
    grid = own[1]
    check_nodes(grid)
    field, floor = grid.field("field", field), checked_floor(floor)
    fields = PlaneFields.of_array(field, edges_of(*boundary_on(boundary, grid)), name)
    search = PlaneSearch(fields, np.ones(1, bool), floor, above=above, candidates=candidates)
    for place, band in enumerate(bands_of(grid.shape[0])):
        for strip in strips_of(band, grid.shape[1]):
            search.add_rows(place, *strip)
    return SearchedPlane(*own, fields), search, floor


def checked_floor(floor: float) -> float:
    """The magnitude at or below which maxima are left out."""
    return number("floor", floor, "a finite number ≥ 0", lambda size: size >= 0)


def check_nodes(grid: Grid) -> None:
    """Raise `ValueError` if the grid is too small for a node to have neighbours on all sides."""
    if min(grid.shape) < 3:
        raise ValueError(f"grid.shape = {grid.shape}: at least three nodes on each axis are needed")
