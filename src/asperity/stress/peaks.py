"""Local maxima in a plane and in a stream of planes, refined between the nodes.

Neighbours
----------
A node of a plane has the 8 nodes around it, and in each of the two adjacent planes the 9 values at the
same lateral positions: 26 in all. If an adjacent plane has another grid, the values there are
interpolated (sixth order, periodic). A peak is strictly larger than all its neighbours; in the first
plane, the surface, there are none above, and the last plane has no peaks.

Where the grid changes between two planes, each side compares on its own nodes, and a peak between the
planes could be claimed by both or by neither. There, two maxima that face each other (within a spacing
of the coarser grid) are decided between themselves: the larger refined in-plane value stays.

A quadratic through the 27 values gives the position and value of the peak between the nodes (in the
surface plane, through the 9 values of the plane). Peaks of a signed field are those of its magnitude; the
value keeps the sign.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numba import njit
from scipy.spatial import cKDTree

from asperity.spectral import Grid
from asperity.stress.planes import StressPlane
from asperity.types import Array


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
        Not in the surface plane.
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

    def under_contact(self, pressure: Array, grid: Grid) -> Array:
        """Whether the surface node nearest above each peak carries pressure."""
        row = np.rint(self.y / grid.spacing[0]).astype(np.int64) % grid.shape[0]
        column = np.rint(self.x / grid.spacing[1]).astype(np.int64) % grid.shape[1]
        return np.asarray(pressure)[row, column] > 0

    @classmethod
    def join(cls, parts: Iterable[Peaks]) -> Peaks:
        """All peaks of several sets, in their order."""
        parts = list(parts)
        empty = np.empty(0)
        if not parts:
            return cls(empty, empty, empty, empty, empty, np.empty(0, bool))
        return cls(*(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(cls)))


def plane_peaks(field: Array, grid: Grid, floor: float = 0.0) -> Peaks:
    """Maxima of |field| strictly above their 8 neighbours in a periodic plane.

    Parameters
    ----------
    field : (ny, nx) array
    grid : Grid
        With at least three nodes on each axis.
    floor : float
        Maxima of a magnitude at or below it are left out.

    Returns
    -------
    Peaks
        At depth 0, refined in the plane.
    """
    field = _checked_field(field, grid)
    nodes = _plane_maxima(field, floor)
    values = _neighbourhood(field, *nodes)
    refined, y, x = _refine_in_plane(_upright(values, values))
    return Peaks(
        refined * np.sign(values[:, 1, 1]),
        np.zeros(nodes[0].size),
        *_positions(nodes, y, x, grid),
        values[:, 1, 1],
        np.zeros(nodes[0].size, bool),
    )


def find_peaks(planes: Iterable[StressPlane], name: str, index: int = 0, floor: float = 0.0) -> Peaks:
    """Maxima of |field| strictly above their 26 neighbours in a stream of planes.

    Parameters
    ----------
    planes : iterable of StressPlane
        Rising in depth, on any grids of one cell; the first is the surface.
    name : str
        Field to look at.
    index : int
        Which of its Poisson's ratios.
    floor : float
        Maxima of a magnitude at or below it are left out.
    """
    finder = PeakFinder()
    for plane in planes:
        finder.add(plane.depth, plane.grid, plane.fields[name][index], floor)
    return finder.peaks()


@dataclass
class _Candidates:
    """Maxima of one plane over their neighbours in it and in the plane above."""

    nodes: tuple[Array, Array]
    above: Array
    here: Array
    stands: Array

    def keep(self, kept: Array | slice) -> _Candidates:
        nodes = self.nodes[0][kept], self.nodes[1][kept]
        return _Candidates(nodes, self.above[kept], self.here[kept], self.stands[kept])


# Peaks refined together: bounds the memory for their neighbourhoods.
_TOGETHER = 16384

Gather = Callable[[Array], Array]


@dataclass(frozen=True)
class _Level:
    """A plane as its neighbours see it: `look` makes the field from what it gathers of the plane's arrays."""

    depth: float
    grid: Grid
    look: Callable[[Gather], Array]

    def values(self, nodes: tuple[Array, Array], grid: Grid) -> Array:
        """The nine values at and around nodes of `grid`, (nodes, 3, 3)."""
        if self.grid.shape == grid.shape:
            return self.look(lambda array: _neighbourhood(array, *nodes))
        ratio_y, ratio_x = (mine / its for mine, its in zip(self.grid.shape, grid.shape, strict=True))
        return self.look(lambda array: _interpolate(array, *nodes, ratio_y, ratio_x))


class PeakFinder:
    """Finds the maxima of one field while its planes pass by; remembers one plane."""

    def __init__(self) -> None:
        self._found: list[Peaks] = []
        self._last: _Level | None = None
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
        look: Callable[[Gather], Array] | None = None,
    ) -> None:
        """The next plane downward.

        Parameters
        ----------
        depth, grid, field, floor
            As in `find_peaks`.
        look : callable, optional
            Returns values of the field, made from what the function it is given gathers of arrays like
            `field`; it is remembered, and `field` is not. By default the field itself is.
        """
        field = _checked_field(field, grid)
        level = _Level(float(depth), grid, look or (lambda gather: gather(field)))
        nodes = _plane_maxima(field, floor)
        here = _neighbourhood(field, *nodes)
        last = self._last
        if last is None:
            candidates = _Candidates(nodes, here, here, np.ones(nodes[0].size, bool))
        else:
            if not level.depth > last.depth:
                raise ValueError(f"depth = {depth!r}: planes rising in depth are needed, below {last.depth}")
            above = last.values(nodes, grid)
            stands = _exceeds(here, above)
            candidates = _Candidates(nodes, above, here, stands)
            self._finish(last, level, candidates)
            candidates = candidates.keep(candidates.stands)
            self._depth_above = last.depth
        self._candidates, self._last = candidates, level

    def _finish(self, last: _Level, level: _Level, lower: _Candidates) -> None:
        """Settle the candidates of the last plane, and those of this one that face them."""
        upper = self._candidates
        assert upper is not None
        below = level.values(upper.nodes, last.grid)
        stands = _exceeds(upper.here, below)
        if last.grid.shape != level.grid.shape:
            _settle_facing(upper, stands, last.grid, lower, level.grid)
        upper.stands = stands
        kept = upper.keep(stands)
        above = self._depth_above
        depths = None if above is None else (above, last.depth, level.depth)
        below = below[stands]
        for start in range(0, len(below), _TOGETHER):
            some = slice(start, start + _TOGETHER)
            self._found.append(_refined(kept.keep(some), below[some], last, depths))


def _settle_facing(
    upper: _Candidates, upper_stands: Array, upper_grid: Grid, lower: _Candidates, lower_grid: Grid
) -> None:
    """Let one of each pair of maxima stand that face each other across a change of grid."""
    if not (upper.nodes[0].size and lower.nodes[0].size):
        return
    value_up, y_up, x_up = _refine_in_plane(_upright(upper.here, upper.here))
    value_low, y_low, x_low = _refine_in_plane(_upright(lower.here, lower.here))
    scale = np.maximum(upper_grid.spacing, lower_grid.spacing)
    box = np.array(upper_grid.length) / scale
    place_up = np.stack(_positions(upper.nodes, y_up, x_up, upper_grid), axis=1) / scale
    place_low = np.stack(_positions(lower.nodes, y_low, x_low, lower_grid), axis=1) / scale
    tree_up, tree_low = cKDTree(place_up % box, boxsize=box), cKDTree(place_low % box, boxsize=box)
    distance, facing = tree_low.query(place_up % box, p=np.inf)
    back = np.asarray(tree_up.query(place_low % box, p=np.inf)[1])
    pair = np.flatnonzero((np.asarray(distance) <= 1.0) & (back[facing] == np.arange(upper.nodes[0].size)))
    partner = np.asarray(facing)[pair]
    wins = value_up[pair] > value_low[partner]
    upper_stands[pair] = wins
    lower.stands[partner] = ~wins


def _refined(candidates: _Candidates, below: Array, level: _Level, depths: tuple | None) -> Peaks:
    here = candidates.here
    sign = np.sign(here[:, 1, 1])
    if depths is None:
        value, y, x = _refine_in_plane(_upright(here, here))
        depth = np.full(y.size, level.depth)
    else:
        cube = np.stack([_upright(layer, here) for layer in (candidates.above, here, below)], axis=1)
        value, depth, y, x = _refine(cube, *depths)
    return Peaks(
        value * sign,
        depth,
        *_positions(candidates.nodes, y, x, level.grid),
        here[:, 1, 1],
        np.full(y.size, depths is not None),
    )


def _checked_field(field: Array, grid: Grid) -> Array:
    field = np.asarray(field)
    if field.shape != grid.shape:
        raise ValueError(f"field has shape {field.shape}: that of its grid, {grid.shape}, is needed")
    if min(grid.shape) < 3:
        raise ValueError(f"grid.shape = {grid.shape}: at least three nodes on each axis are needed")
    return field


def _upright(values: Array, centre: Array) -> Array:
    """Neighbourhoods turned over where the value at their centre is negative."""
    return values * np.sign(centre[:, 1:2, 1:2])


def _exceeds(here: Array, other: Array) -> Array:
    """Whether the magnitude at the centre is above nine others."""
    return np.abs(here[:, 1, 1]) > np.abs(other).max(axis=(1, 2), initial=0.0)


def _positions(nodes: tuple[Array, Array], y: Array, x: Array, grid: Grid) -> tuple[Array, Array]:
    """Positions within the cell of points at the offsets y, x (in spacings) from nodes."""
    return (
        (nodes[0] + y) % grid.shape[0] * grid.spacing[0],
        (nodes[1] + x) % grid.shape[1] * grid.spacing[1],
    )


def _neighbourhood(field: Array, row: Array, column: Array) -> Array:
    """The nine values at and around nodes, (nodes, 3, 3)."""
    out = np.empty((row.size, 3, 3))
    _gather(field, row, column, out)
    return out


def _interpolate(field: Array, row: Array, column: Array, ratio_y: float, ratio_x: float) -> Array:
    """The nine values at and around nodes of a grid `ratio` times coarser, (nodes, 3, 3)."""
    out = np.empty((row.size, 3, 3))
    _interpolate_each(field, row, column, ratio_y, ratio_x, out)
    return out


def _refine_in_plane(values: Array) -> tuple[Array, Array, Array]:
    """Value and offsets y, x (in spacings) of the maxima of quadratics through 3 × 3 values."""
    centre = values[:, 1, 1]
    gradient = np.stack([values[:, 2, 1] - values[:, 0, 1], values[:, 1, 2] - values[:, 1, 0]], axis=1) / 2
    hessian = np.empty((centre.size, 2, 2))
    hessian[:, 0, 0] = values[:, 2, 1] - 2 * centre + values[:, 0, 1]
    hessian[:, 1, 1] = values[:, 1, 2] - 2 * centre + values[:, 1, 0]
    hessian[:, 0, 1] = hessian[:, 1, 0] = (
        values[:, 2, 2] - values[:, 2, 0] - values[:, 0, 2] + values[:, 0, 0]
    ) / 4
    step = _newton(gradient, hessian)
    return centre + 0.5 * np.sum(gradient * step, axis=1), step[:, 0], step[:, 1]


def _refine(cube: Array, above: float, here: float, below: float) -> tuple[Array, Array, Array, Array]:
    """Value, depth and offsets y, x (in spacings) of the maxima of quadratics through 3 × 3 × 3 values."""
    up, down = here - above, below - here
    weight_up, weight_down = -down / (up * (up + down)), up / (down * (up + down))
    unit = min(up, down)

    def slope(values: Array) -> Array:
        """Derivative along depth of the quadratic through three planes, per unit."""
        middle = values[:, 1]
        return unit * (weight_up * (values[:, 0] - middle) + weight_down * (values[:, 2] - middle))

    centre = cube[:, 1, 1, 1]
    gradient = np.empty((centre.size, 3))
    hessian = np.empty((centre.size, 3, 3))
    column = cube[:, :, 1, 1]
    gradient[:, 0] = slope(column)
    hessian[:, 0, 0] = (
        2 * unit**2 * ((column[:, 0] - centre) / up + (column[:, 2] - centre) / down) / (up + down)
    )
    gradient[:, 1] = (cube[:, 1, 2, 1] - cube[:, 1, 0, 1]) / 2
    gradient[:, 2] = (cube[:, 1, 1, 2] - cube[:, 1, 1, 0]) / 2
    hessian[:, 1, 1] = cube[:, 1, 2, 1] - 2 * centre + cube[:, 1, 0, 1]
    hessian[:, 2, 2] = cube[:, 1, 1, 2] - 2 * centre + cube[:, 1, 1, 0]
    middle = cube[:, 1]
    hessian[:, 1, 2] = hessian[:, 2, 1] = (
        middle[:, 2, 2] - middle[:, 2, 0] - middle[:, 0, 2] + middle[:, 0, 0]
    ) / 4
    hessian[:, 0, 1] = hessian[:, 1, 0] = slope((cube[:, :, 2, 1] - cube[:, :, 0, 1]) / 2)
    hessian[:, 0, 2] = hessian[:, 2, 0] = slope((cube[:, :, 1, 2] - cube[:, :, 1, 0]) / 2)
    step = _newton(gradient, hessian, np.array([max(up, down) / unit, 1.0, 1.0]))
    value = centre + 0.5 * np.sum(gradient * step, axis=1)
    return value, here + unit * step[:, 0], step[:, 1], step[:, 2]


def _newton(gradient: Array, hessian: Array, reach: Array | float = 1.0) -> Array:
    """Steps to the maxima of quadratics; along each axis alone where the whole one has none within reach."""
    axes = np.arange(gradient.shape[1])
    curvature = hessian[:, axes, axes]
    determinant = np.linalg.det(hessian)
    regular = np.abs(determinant) > 1e-12 * np.abs(np.prod(curvature, axis=1))
    safe = np.where(regular[:, None, None], hessian, -np.eye(axes.size))
    step = -np.linalg.solve(safe, gradient[:, :, None])[:, :, 0]
    downhill = np.all(np.linalg.eigvalsh(safe) < 0, axis=1)
    trusted = regular & downhill & np.all(np.abs(step) <= reach, axis=1)
    alone = np.where(curvature < 0, -gradient / np.where(curvature < 0, curvature, -1.0), 0.0)
    alone = np.clip(alone, -0.5, 0.5)
    largest = np.argmax(np.abs(alone * gradient), axis=1)
    single = np.where(axes == largest[:, None], alone, 0.0)
    return np.where(trusted[:, None], step, single)


def _plane_maxima(field: Array, floor: float) -> tuple[Array, Array]:
    """Nodes whose magnitude is above the floor and strictly above its 8 neighbours."""
    found = np.empty(field.size // 4 + 1, np.int64)
    count = _scan(field, float(floor), found)
    return found[:count] // field.shape[1], found[:count] % field.shape[1]


@njit(cache=True, error_model="numpy", nogil=True)
def _scan(field: Any, floor: float, found: Any) -> int:
    """Numbers of the nodes above the floor and all 8 neighbours, and how many they are."""
    rows, columns = field.shape
    count = 0
    for j in range(rows):
        before = rows - 1 if j == 0 else j - 1
        after = 0 if j == rows - 1 else j + 1
        for i in range(columns):
            value = abs(field[j, i])
            if not value > floor:
                continue
            left = columns - 1 if i == 0 else i - 1
            right = 0 if i == columns - 1 else i + 1
            if (
                value > abs(field[j, left])
                and value > abs(field[j, right])
                and value > abs(field[before, i])
                and value > abs(field[after, i])
                and value > abs(field[before, left])
                and value > abs(field[before, right])
                and value > abs(field[after, left])
                and value > abs(field[after, right])
            ):
                found[count] = j * columns + i
                count += 1
    return count


@njit(cache=True, error_model="numpy", nogil=True)
def _weights(fraction: float, out: Any) -> None:
    """Weights of Lagrange's interpolation from six nodes −2 … 3 to `fraction`."""
    for k in range(6):
        weight = 1.0
        for m in range(6):
            if m != k:
                weight *= (fraction - (m - 2)) * (1.0 / (k - m))
        out[k] = weight


@njit(cache=True, error_model="numpy", nogil=True)
def _gather(field: Any, row: Any, column: Any, out: Any) -> None:
    """Fill `out` with the values of `_neighbourhood`."""
    rows, columns = field.shape
    for n in range(row.size):
        for a in range(3):
            line = (row[n] + a - 1) % rows
            for b in range(3):
                out[n, a, b] = field[line, (column[n] + b - 1) % columns]


@njit(cache=True, error_model="numpy", nogil=True)
def _interpolate_each(field: Any, row: Any, column: Any, ratio_y: float, ratio_x: float, out: Any) -> None:
    """Fill `out` with the values of `_interpolate`."""
    rows, columns = field.shape
    weight_y, weight_x = np.empty(6), np.empty((3, 6))
    place_x = np.empty((3, 6), np.int64)
    for n in range(row.size):
        for b in range(3):
            position = (column[n] + b - 1) * ratio_x
            base = int(np.floor(position))
            _weights(position - base, weight_x[b])
            for m in range(6):
                place_x[b, m] = (base + m - 2) % columns
        for a in range(3):
            position = (row[n] + a - 1) * ratio_y
            base = int(np.floor(position))
            _weights(position - base, weight_y)
            out[n, a, :] = 0.0
            for k in range(6):
                line = field[(base + k - 2) % rows]
                for b in range(3):
                    part = 0.0
                    for m in range(6):
                        part += weight_x[b, m] * line[place_x[b, m]]
                    out[n, a, b] += weight_y[k] * part
