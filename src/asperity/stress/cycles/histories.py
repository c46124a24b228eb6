"""Histories of the stress at all points of a body whose contact pressure changes from state to state.

The states are the shifts of two rough bodies against each other, or the positions of a point on its way
through a Hertz contact. Every point of the body has its own history. All states of a plane are in memory
at the same time. The smallest spheres are computed for candidates only: a sphere around the middle of the
bounding box of a history bounds the smallest one, and its radius over √2 bounds the shear stress. In each
row along x the point of the largest bound is computed first, then all points whose bound exceeds its value.

Shakedown
---------
Points along a row have different histories. A centre without restriction still gives an upper bound of the
factor. A residual stress ρ_xx(y, z), common to all histories of a row, is in equilibrium and gives a lower
bound.

Grids are chosen for an envelope, whose modes have the largest magnitude of all states, so that the bound of
the dropped modes holds for every state.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from asperity.core.compiled import compiled_with_arrays
from asperity.core.parallel import run_tasks
from asperity.core.types import Array, ArrayLike, Progress
from asperity.elasticity.loaded_solid import LoadedSolid, direction_cosines
from asperity.elasticity.solid import COMPONENTS, Solid
from asperity.fourier.grid import Fourier, Grid, resample, with_mirror_images
from asperity.stress.cycles.criteria import (
    NUMBERS,
    Criteria,
    CycleMaps,
    fill_points,
    in_double_precision,
    reduce_rows,
)
from asperity.stress.cycles.smallest_sphere import DIMENSIONS, smallest_sphere
from asperity.stress.planes.planes import default_depths
from asperity.stress.planes.stream import PlaneStream, uniform_part

STATES_BYTES = 2**29
"""Memory for the states of some rows of a plane, and for the modes of all states.

Planes are computed again for the next rows, and modes for the next plane if they do not fit."""

EXACT_ABOVE = 0.5
"""Fraction of the maximum Dang Van stress above which every point is computed, for the distribution."""

ERROR_OVER_CHANGE = 2.0
"""Error of the worst values over their change with half of the states: the estimate holds in 11 of 12 cases
(`benchmarks/moving.py`)."""

STRIP = 4096
"""Number of points whose candidates are chosen together, in whole rows."""


@dataclass(frozen=True, eq=False)
class MovingPressure:
    """States of the contact pressure on a body, in coordinates that are fixed to the body.

    Parameters
    ----------
    pressures : sequence of (ny, nx) arrays
        None where there is no contact.
    grid : Grid
        A mirrored grid is replaced by its whole cell.
    layer : Solid
    direction : "x", "y" or float
        Of the motion, as `sliding_direction` of `asperity.stress_planes`.
    friction, sliding_direction
        As for `asperity.stress_planes`.
    background : callable, optional
        Depth → stress (states, 6) that is added, uniform over the plane.
    is_unloaded : bool
        True if the unloaded body, σ = 0, is one more state.
    deepest : float
        Depth down to which the background matters; 0 without one.
    """

    pressures: Sequence[Array | None]
    grid: Grid
    layer: Solid
    direction: str | float = "x"
    friction: float = 0.0
    sliding_direction: str | float = "x"
    background: Callable[[float], Array] | None = None
    is_unloaded: bool = False
    deepest: float = 0.0

    def __post_init__(self) -> None:
        if self.grid.mirrored:
            cells = [p if p is None else with_mirror_images(p, self.grid) for p in self.pressures]
            object.__setattr__(self, "pressures", cells)
            object.__setattr__(self, "grid", self.grid.whole_cell)


class Histories(CycleMaps):
    """Numbers of the histories of a body, the worst of each row.

    Parameters
    ----------
    moving : MovingPressure
    criteria : Criteria
    depths, tolerance, threads
        As for `asperity.stress.stress_cycles`.
    """

    def __init__(
        self,
        moving: MovingPressure,
        criteria: Criteria,
        depths: ArrayLike | None,
        tolerance: float,
        threads: int,
    ) -> None:
        super().__init__(moving.grid, criteria)
        self._moving, self._threads = moving, threads
        fourier = Fourier(moving.grid, threads=threads)
        largest = np.zeros(moving.grid.mode_shape)
        for pressure in moving.pressures:
            if pressure is not None:
                np.maximum(largest, np.abs(fourier.forward(pressure)), out=largest)
        envelope = LoadedSolid(fourier.inverse(largest), moving.grid, moving.layer, deepest=moving.deepest)
        if depths is None:
            depths = default_depths(envelope)
        sliding: dict[str, Any] = {"friction": moving.friction, "sliding_direction": moving.sliding_direction}
        self._stream = PlaneStream(envelope, depths, None, ("von_mises",), tolerance, threads, **sliding)
        self._sliding, self._fourier = sliding, fourier
        self._grid = moving.grid
        self._states = [self._solid(pressure) for pressure in moving.pressures]
        self._streams: dict[int, PlaneStream] = {}
        self.names = [name for name in self.names if name != "shakedown_line"]
        self._direction = direction_cosines(moving.direction)
        self._halves = np.full((2, 3), -np.inf)

    def run(self, progress: Progress | None) -> None:
        """Compute all planes."""
        for plane in self._stream.planes(progress):
            self._use(plane.grid)
            (ny, nx), count = plane.grid.shape, len(self._states)
            rows = max(1, min(ny, STATES_BYTES // (4 * len(COMPONENTS) * nx * count)))
            blocks = [self._plane(plane.depth, first, min(first + rows, ny)) for first in range(0, ny, rows)]
            found, along, dang_van = zip(*blocks, strict=True)
            self.take(
                plane.depth,
                np.concatenate(found, axis=1),
                np.concatenate(along, axis=1) * plane.grid.spacing[1],
                np.concatenate(dang_van),
            )

    def _use(self, grid: Grid) -> None:
        """Resample the states to the grid of a plane."""
        if grid == self._grid:
            return
        self._grid, coarse = grid, Fourier(grid, threads=self._threads)
        self._streams.clear()

        def on_grid(pressure: Array | None) -> Array | None:
            if pressure is None:
                return None
            modes = resample(self._fourier.forward(pressure), self._moving.grid, grid)
            return coarse.inverse(modes, overwrite=True)

        self._states = [self._solid(on_grid(pressure)) for pressure in self._moving.pressures]

    def _solid(self, pressure: Array | None) -> LoadedSolid | None:
        return None if pressure is None else LoadedSolid(pressure, self._grid, self._moving.layer)

    def _stream_of(self, number: int, solid: LoadedSolid) -> PlaneStream:
        """The planes of a state, whose modes are kept for the next depth if those of all states fit."""
        if number in self._streams:
            return self._streams[number]
        stream = PlaneStream(solid, [0.0], None, ("von_mises",), 0.0, self._threads, **self._sliding)
        if len(self._states) * 8 * self._grid.size <= STATES_BYTES:
            self._streams[number] = stream
        return stream

    def _plane(self, depth: float, first: int, last: int) -> tuple[Array, Array, Array]:
        """Largest numbers of some rows of a plane, (5, rows), their columns, and the Dang Van stress."""
        layer, nx = self._moving.layer, self._grid.shape[1]
        states = np.zeros((len(self._states), len(COMPONENTS), (last - first) * nx), np.float32)
        count, uniform = len(COMPONENTS), uniform_part(layer, layer.poisson, depth)
        for number, solid in enumerate(self._states):
            if solid is None:
                continue
            for plane in self._stream_of(number, solid).planes(at=[depth]):
                fields = plane.fields(COMPONENTS, [layer.poisson] * count, [uniform] * count).whole()
                states[number] = fields[:, first:last].reshape(count, -1)
        if self._moving.background is not None:
            states += self._moving.background(depth)[:, :, None]
        strip = max(1, STRIP // nx) * nx
        tasks = [
            partial(self._strip, states[:, :, start : start + strip], nx)
            for start in range(0, states.shape[2], strip)
        ]
        found, along, halves, dang_van = zip(*run_tasks(tasks, self._threads), strict=True)
        self._halves = np.max([self._halves, *halves], axis=0)
        return np.concatenate(found, axis=1), np.concatenate(along, axis=1), np.concatenate(dang_van)

    def _strip(self, states: Array, columns: int) -> tuple[Array, Array, Array, Array]:
        """Largest numbers of some rows, (5, rows), their columns, the same of half the states, Dang Van."""
        states = np.ascontiguousarray(states.transpose(1, 2, 0))  # a history in consecutive memory
        rows = states.shape[1] // columns
        exact, dang_van = self._numbers(states, rows)
        exact = exact.reshape(3, rows, columns)
        found, along = np.zeros((2, 5, rows))
        found[:3], along[:3] = exact.max(axis=2), exact.argmax(axis=2)
        if "shakedown_lower" in self.names:
            fill_row_radii(states.reshape(len(COMPONENTS), rows, -1), self._moving.is_unloaded, found[4])
        halves = [self._numbers(states[:, :, first::2], 1)[0].max(axis=1) for first in (0, 1)]
        return found, along, np.array(halves), dang_van

    def _numbers(self, states: Array, rows: int) -> tuple[Array, Array]:
        """Range, Dang Van stress and squared radius, (3, points), of the points that may be largest.

        Also the Dang Van stress of all points, below `EXACT_ABOVE` as its upper bound.
        """
        unloaded, alpha = self._moving.is_unloaded, self.criteria.alpha
        bound, exact = np.empty((2, states.shape[1])), np.full((3, states.shape[1]), -np.inf)
        fill_bounds(states, unloaded, alpha, bound)
        x, y = self._direction
        along_motion = x * states[4] + y * states[3]
        exact[0] = np.ptp(np.pad(along_motion, ((0, 0), (0, 1))) if unloaded else along_motion, axis=1)
        del along_motion  # as large as a sixth of the states
        by_row = bound.reshape(2, rows, -1)
        chosen = np.zeros(by_row.shape[1:], bool)
        for upper in by_row:
            chosen[np.arange(rows), upper.argmax(axis=1)] = True
        large = np.full(chosen.shape, False)
        for turn in range(2):
            at = np.flatnonzero(chosen | large)
            out = np.empty((5, at.size))
            reduce_rows(in_double_precision(states[:, at]), unloaded, True, False, alpha, out)
            exact[1:, at] = out[1:3]
            best = exact[1:].reshape(by_row.shape).max(axis=2, keepdims=True)
            unknown = (exact[2] == -np.inf).reshape(chosen.shape)
            chosen = (by_row > best).any(axis=0) & unknown
            if turn == 0 and self.criteria.has_fatigue and rows > 1:
                large = (by_row[0] > EXACT_ABOVE * max(best[0].max(), self._halves[:, 1].max())) & unknown
        return exact, np.where(exact[1] == -np.inf, bound[0], exact[1])

    def dataset(self) -> xr.Dataset:
        """The result of `asperity.stress.stress_cycles`, with places along x and the error of few states."""
        found = super().dataset()
        halves = np.zeros((5, 2))
        halves[:3] = self._halves.T
        worst_depth = found.attrs["worst_dang_van" if "dang_van" in self.names else "worst_shear_range"][1]
        few = self.criteria.at(worst_depth).numbers(halves).mean(axis=1)
        worst = {name: found.attrs[f"worst_{name}"][0] for name in self.names if name in NUMBERS[:3]}
        changes = [
            abs(float(few[NUMBERS.index(name)]) - value) / max(abs(value), 1e-300)
            for name, value in worst.items()
        ]
        return found.assign_attrs(few_shifts_error=ERROR_OVER_CHANGE * max(changes))


@compiled_with_arrays
def fill_row_radii(states: Any, unloaded: bool, out: Any) -> None:
    """Fill `out`, (rows,), with the squared radius around all histories of a row, free along xx."""
    count = states.shape[2]
    points, centre = np.zeros((DIMENSIONS, count + (1 if unloaded else 0))), np.empty(DIMENSIONS)
    for row in range(states.shape[1]):
        fill_points(states, row, unloaded, points)
        out[row] = smallest_sphere(points, np.int64(1), centre)


@compiled_with_arrays
def fill_bounds(states: Any, unloaded: bool, alpha: float, out: Any) -> None:
    """Fill `out`, (2, points), with upper bounds of the Dang Van stress and the squared radius."""
    count = states.shape[2]
    points, middle = np.zeros((DIMENSIONS, count + (1 if unloaded else 0))), np.empty(DIMENSIONS)
    for n in range(states.shape[1]):
        fill_points(states, n, unloaded, points)
        mean = 0.0 if unloaded else -np.inf
        for k in range(count):
            mean = max(mean, (float(states[0, n, k]) + float(states[1, n, k]) + float(states[2, n, k])) / 3)
        for i in range(DIMENSIONS):
            middle[i] = (points[i].min() + points[i].max()) / 2
        out[1, n] = 0.0
        for k in range(points.shape[1]):
            squared = 0.0
            for i in range(DIMENSIONS):
                squared += (points[i, k] - middle[i]) ** 2
            out[1, n] = max(out[1, n], squared)
        out[0, n] = np.sqrt(out[1, n] / 2) + alpha * mean
