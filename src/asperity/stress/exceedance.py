"""Volume of a solid in which a field of the stress exceeds a limit, from a stream of planes, and its error.

Each node stands for a box that reaches halfway to its neighbours in its plane and to the adjacent planes. In
the box the field is the quadratic through the node and 18 of its 26 neighbours, as for the peaks between
nodes (`asperity.stress.peaks.maxima`). Along the depth the part of the box above a limit is in closed form;
in the plane it is sampled. A volume smaller than a box, as at the onset of yield, is found like a large one.

Error:
-----
Near the onset a small error of the stress is a large one of the volume. The volume is therefore measured
above lower limits, too: its error is its change when the stress rises by its error, which is more than when
it falls. The error of the stress follows from the stated error of the maximum von Mises stress, and falls
with the number of peaks above the limit.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from asperity.core.compiled import compiled
from asperity.core.types import Array
from asperity.fourier.grid import Grid
from asperity.stress.peaks.maxima import quadratic
from asperity.stress.planes.fields import edges_of, lagrange, lagrange_stencils, neighbour
from asperity.stress.statistics.extrapolation import extreme_error, resolution

SAMPLES = 4
"""Places along each axis of a box at an extreme value at which the depths above the limit are found; half as
many where the field changes steadily, and half of these for lower limits."""

NEAR_BELOW, NEAR_ABOVE = 0.95, 1.1
"""A box whose node and nearest neighbours lie outside these multiples of the lowest and the highest limit is
below or above all limits."""

LEAST_NODE = 0.8
"""Nodes below this fraction of the lowest limit are left out."""


SHARES = 1 - np.array([0.15, 0.04, 0.0])
"""Limits over the one that is asked for."""

LOW_SHARES = 0.5, 0.7
"""Lower limits over that one, above which nodes are counted: an error of the stress is at most its value."""


OF_ALL, OF_ONE, OF_PLASTIC = 0.4, 0.6, 1.2
"""Error of the stress at all peaks, and at a single one, over the stated error of the maximum stress; factor
of both under a hardness (`benchmarks/answers.py`)."""

RESOLVED = 0.14
"""`resolution` below which these errors fall with its square."""

OF_QUADRATIC = 0.002
"""Relative error of the stress by the quadratics between nodes and planes."""


class _Plane(NamedTuple):
    depth: float
    grid: Grid
    values: Array


class Exceedance:
    """Volume in which a field exceeds a limit, and the depths between which it does.

    Parameters
    ----------
    limit : float
    boundary : str
        Of the pressure.
    """

    def __init__(self, limit: float, boundary: str = "periodic") -> None:
        self._limits, self._boundary = limit * SHARES, boundary
        self._volumes, self._low = np.zeros(SHARES.size), np.zeros(len(LOW_SHARES))
        self._depths = np.array([np.inf, -np.inf])
        self._planes: list[_Plane] = []

    @property
    def volume(self) -> float:
        """Volume over the area of a plane, a length."""
        return float(self._volumes[-1])

    @property
    def depths(self) -> tuple[float, float] | None:
        """Depths of the uppermost and the lowest point above the limit; None without any."""
        return (float(self._depths[0]), float(self._depths[1])) if self.volume else None

    def error(self, estimates: xr.Dataset, peaks: float) -> float:
        """Error of the volume over the area, by pixels and planes; NaN where the stress has no estimate.

        If no peak is above the limit, the error is above 0 where the maximum stress and its error reach it.

        Parameters
        ----------
        estimates : dataset
            Result of `asperity.continuum_limit` for one Poisson's ratio. Its attribute ``reason`` or
            ``reason_of_stress`` says why there is no estimate.
        peaks : float
            Number of peaks of the map above the limit, whose errors differ in part.
        """
        relative = extreme_error(estimates, "von_mises")
        if peaks:
            if estimates.attrs["plastic_area"] > 0:
                relative *= OF_PLASTIC
            else:
                relative *= min(1.0, (resolution(estimates) / RESOLVED) ** 2)
            relative = np.hypot(relative * np.hypot(OF_ALL, OF_ONE / np.sqrt(peaks)), OF_QUADRATIC)
        volumes = np.append(np.maximum(self._low, self._volumes[0]), self._volumes)
        return float(np.interp(1 / (1 + relative), (*LOW_SHARES, *SHARES), volumes)) - self.volume

    def add(self, depth: float, grid: Grid, values: Array) -> None:
        """Add the next plane downward, (ny, nx), which must not be changed later."""
        self._planes = [*self._planes[-2:], _Plane(depth, grid, values)]
        if len(self._planes) > 1:
            above = self._planes[0] if len(self._planes) == 3 else None
            self._measure(above, self._planes[-2], self._planes[-1])

    def finish(self, largest: float) -> None:
        """Add the boxes of the last plane; nothing is above the largest value, at nodes and between them."""
        if len(self._planes) > 1:
            self._measure(self._planes[-2], self._planes[-1], None)
        self._volumes[self._limits >= largest] = 0.0

    def _measure(self, above: _Plane | None, here: _Plane, below: _Plane | None) -> None:
        """Add the boxes of a plane; at the ends of the stream the quadratic is linear along the depth."""
        other, edges = above or below, edges_of(self._boundary, here.grid)
        assert other is not None
        distances = tuple(abs((plane or other).depth - here.depth) for plane in (above, below))
        ends = np.array([-distances[0] / 2 if above else 0.0, distances[1] / 2 if below else 0.0])
        highest = here.values.max()
        for number, share in enumerate(LOW_SHARES):
            if highest > (limit := share * self._limits[-1]):
                self._low[number] += np.ptp(ends) * np.mean(here.values > limit)
        if not highest > LEAST_NODE * self._limits[0]:
            return
        sides = []
        for side in (above or other, below or other):
            along = zip(here.grid.shape, side.grid.shape, edges, strict=True)
            sides.append((side.values, tuple(lagrange_stencils(*each) for each in along)))
        along_depth = here.depth, ends, distances, (above is None, below is None)
        planes = here.values, *sides
        _add_boxes(planes, along_depth, edges, self._limits, np.empty((3, 3, 3)), self._volumes, self._depths)


@compiled
def _add_boxes(
    planes: Any, along_depth: Any, edges: Any, limits: Any, memory: Any, volume: Any, depths: Any
) -> None:
    """Add the volumes above the limits in the boxes of a plane, and widen the depths above the last limit.

    Parameters
    ----------
    planes : tuple
        Values of the plane, and of those above and below with stencils from their grids to this one.
    along_depth : tuple
        Depth of the plane, first and last depth of a box from there, distances of the planes above and below,
        and whether these are missing.
    memory : (3, 3, 3) array
    """
    (here, above, below), (depth, (first, last), distances, is_end) = planes, along_depth
    over, around, under = memory[0], memory[1], memory[2]
    (ny, nx), far = here.shape, max(-first, last)
    share = 1.0 / (ny * nx)
    for j in range(ny):
        for i in range(nx):
            if not here[j, i] > LEAST_NODE * limits[0]:
                continue
            least, most = np.inf, -np.inf
            for a in range(3):
                row = neighbour(j - 1 + a, ny, edges[0])
                for b in range(3):
                    around[a, b] = here[row, neighbour(i - 1 + b, nx, edges[1])]
                    least, most = min(least, around[a, b]), max(most, around[a, b])
            for side in (above, below):
                low, high = _range(side, here.shape, j, i)
                least, most = min(least, low), max(most, high)
            if most < NEAR_BELOW * limits[0]:
                continue
            if least > NEAR_ABOVE * limits[-1]:
                for n in range(limits.size):
                    volume[n] += share * (last - first)
                depths[0], depths[1] = min(depths[0], depth + first), max(depths[1], depth + last)
                continue
            _fill_cross(above, here.shape, j, i, edges, over)
            _fill_cross(below, here.shape, j, i, edges, under)
            for a in range(3):
                for b in range(3):
                    if is_end[0]:
                        over[a, b] = 2 * around[a, b] - under[a, b]
                    if is_end[1]:
                        under[a, b] = 2 * around[a, b] - over[a, b]
            centre, in_plane, (z, zy, zx, zz) = quadratic((over, around, under), distances, 1.0, 1.0)
            y, x, yy, yx, xx = in_plane
            reach = (abs(y) + abs(x)) / 2 + (abs(yy) + abs(xx)) / 8 + abs(yx) / 4
            reach += far * (abs(z) + (abs(zy) + abs(zx)) / 2 + abs(zz) * far / 2)
            is_extreme = abs(y) + abs(x) < 2 * (abs(yy) + abs(xx))
            for n in range(limits.size):
                if centre + reach <= limits[n]:
                    break
                is_last = n == limits.size - 1
                top, bottom = first, last
                if centre - reach > limits[n]:
                    volume[n] += share * (last - first)
                else:
                    samples = SAMPLES if is_extreme else SAMPLES // 2
                    samples = samples if is_last else samples // 2
                    excess = centre - limits[n], in_plane, (z, zy, zx, zz)
                    total, top, bottom = _sampled_length(excess, first, last, samples)
                    volume[n] += share * total / (samples * samples)
                if is_last:
                    depths[0], depths[1] = min(depths[0], depth + top), max(depths[1], depth + bottom)


@compiled
def _sampled_length(quadratic: Any, first: float, last: float, samples: int) -> tuple[float, float, float]:
    """Sum of the lengths along the depth where a quadratic is above 0, with its first and last point.

    The lines lie at `samples` places along each axis of the box.
    """
    centre, (y, x, yy, yx, xx), (z, zy, zx, zz) = quadratic
    total, first_point, last_point = 0.0, np.inf, -np.inf
    for k in range(samples):
        v = (k + 0.5) / samples - 0.5
        for m in range(samples):
            u = (m + 0.5) / samples - 0.5
            level = centre + v * (y + 0.5 * yy * v + yx * u) + u * (x + 0.5 * xx * u)
            length, top, bottom = _above_zero(level, z + zy * v + zx * u, zz / 2, first, last)
            total += length
            if length > 0:
                first_point, last_point = min(first_point, top), max(last_point, bottom)
    return total, first_point, last_point


@compiled
def _range(side: Any, shape: Any, j: int, i: int) -> tuple[float, float]:
    """Least and largest value of a plane at its nodes nearest to a node of another grid."""
    values, ((place_y, _), (place_x, _)) = side
    if values.shape == shape:
        return values[j, i], values[j, i]
    least, most = np.inf, -np.inf
    for a in (2, 3):
        for b in (2, 3):
            value = values[place_y[j + 1][a], place_x[i + 1][b]]
            least, most = min(least, value), max(most, value)
    return least, most


@compiled
def _fill_cross(side: Any, shape: Any, j: int, i: int, edges: Any, out: Any) -> None:
    """Fill a node of a grid and its nearest four neighbours with values of a plane."""
    values, ((place_y, weight_y), (place_x, weight_x)) = side
    for a, b in ((1, 1), (0, 1), (2, 1), (1, 0), (1, 2)):
        if values.shape == shape:
            row = neighbour(j - 1 + a, shape[0], edges[0])
            column = neighbour(i - 1 + b, shape[1], edges[1])
            out[a, b] = values[row, column]
        else:
            along_y, along_x = (place_y[j + a], weight_y[0, j + a]), (place_x[i + b], weight_x[0, i + b])
            out[a, b] = lagrange(values, along_y, along_x)


@compiled
def _above_zero(level: float, slope: float, bend: float, first: float, last: float) -> Any:
    """Length of the part of an interval where a quadratic is above 0, and its first and last point."""
    start, stop = level + first * (slope + bend * first), level + last * (slope + bend * last)
    square = slope * slope - 4 * bend * level
    if bend == 0.0 or square <= 0.0:  # linear, or without zeros
        if start > 0 and stop > 0:
            return last - first, first, last
        if start <= 0 and stop <= 0:
            return 0.0, first, last
        zero = first + (last - first) * start / (start - stop)
        return (zero - first, first, zero) if start > 0 else (last - zero, zero, last)
    # Both zeros without cancellation.
    half = -0.5 * (slope + np.copysign(np.sqrt(square), slope))
    one, two = half / bend, level / half
    low, high = min(max(min(one, two), first), last), min(max(max(one, two), first), last)
    if bend < 0:
        return high - low, low, high
    length = (low - first) + (last - high)
    top = first if low > first else high
    return length, top, last if last > high else low
