"""Volume of a solid in which a field of the stress exceeds limits, from a stream of planes.

Each node stands for a box that reaches halfway to its neighbours in its plane and to the adjacent planes. In
the box the field is the quadratic through the node and 18 of its 26 neighbours, that of the peaks between
nodes (`asperity.stress.peaks.maxima`). Along the depth the part of the box above a limit is in closed form;
in the plane it is sampled. A volume smaller than a box, as at the onset of yield, is found like a large one.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from asperity.core.compiled import compiled, compiled_with_arrays
from asperity.core.types import Array
from asperity.fourier.grid import Grid
from asperity.stress.planes.fields import lagrange, lagrange_stencils, neighbour

SAMPLES = 4
"""Places along each axis of a box at which the depths above a limit are found."""

LEAST_NODE = 0.7
"""Nodes below this share of the lowest limit are left out."""


class _Plane(NamedTuple):
    depth: float
    grid: Grid
    values: Array


class Exceedance:
    """Volume per area in which a field exceeds limits, and the depths between which it does.

    Parameters
    ----------
    limits : (limits,) array
        Rising.
    periodic : bool
        Whether planes repeat sideways.

    Attributes
    ----------
    volume : (limits,) array
        Volume over the area of a plane, a length.
    depths : (limits, 2) array
        Depths of the uppermost and lowest points above each limit; infinite and reversed without any.
    """

    def __init__(self, limits: Array, periodic: bool) -> None:
        self._limits, self._periodic = np.asarray(limits, float), periodic
        self.volume = np.zeros(self._limits.size)
        self.depths = np.tile([np.inf, -np.inf], (self._limits.size, 1))
        self._planes: list[_Plane] = []

    def add(self, depth: float, grid: Grid, values: Array) -> None:
        """Add the next plane downward, (ny, nx), which must not be changed later."""
        self._planes = [*self._planes[-2:], _Plane(depth, grid, values)]
        if len(self._planes) > 1:
            above = self._planes[0] if len(self._planes) == 3 else None
            self._measure(above, self._planes[-2], self._planes[-1])

    def finish(self) -> None:
        """Add the box of the last plane."""
        if len(self._planes) > 1:
            self._measure(self._planes[-2], self._planes[-1], None)

    def _measure(self, above: _Plane | None, here: _Plane, below: _Plane | None) -> None:
        """Add the boxes of a plane; at the ends of the stream the quadratic is linear along the depth."""
        if not here.values.max() > LEAST_NODE * self._limits[0]:
            return
        sides, other = [], above or below
        assert other is not None
        for side in (above or other, below or other):
            pairs = zip(here.grid.shape, side.grid.shape, strict=True)
            sides.append((side.values, tuple(lagrange_stencils(*pair, self._periodic) for pair in pairs)))
        up, down = (abs((plane or other).depth - here.depth) for plane in (above, below))
        ends = np.array([-up / 2 if above else 0.0, down / 2 if below else 0.0])
        _add_boxes(
            here.values,
            *sides,
            (above is None, below is None),
            (up, down),
            here.depth,
            ends,
            self._limits,
            self._periodic,
            self.volume,
            self.depths,
        )


@compiled_with_arrays
def _add_boxes(
    here: Any,
    above: Any,
    below: Any,
    is_end: Any,
    distances: Any,
    depth: float,
    ends: Any,
    limits: Any,
    periodic: bool,
    volume: Any,
    depths: Any,
) -> None:
    (ny, nx), (up, down), (first, last) = here.shape, distances, ends
    weight_up, weight_down = -down / (up * (up + down)), up / (down * (up + down))
    share = 1.0 / (ny * nx * SAMPLES * SAMPLES)
    around, over, under = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for j in range(ny):
        for i in range(nx):
            if not here[j, i] > LEAST_NODE * limits[0]:
                continue
            for a in range(3):
                row = neighbour(j - 1 + a, ny, periodic)
                for b in range(3):
                    around[a, b] = here[row, neighbour(i - 1 + b, nx, periodic)]
            _fill_cross(above, here.shape, j, i, periodic, over)
            _fill_cross(below, here.shape, j, i, periodic, under)
            if is_end[0]:
                over[:] = 2 * around - under
            if is_end[1]:
                under[:] = 2 * around - over
            centre = around[1, 1]
            y, x = (around[2, 1] - around[0, 1]) / 2, (around[1, 2] - around[1, 0]) / 2
            yy, xx = around[2, 1] - 2 * centre + around[0, 1], around[1, 2] - 2 * centre + around[1, 0]
            yx = (around[2, 2] - around[2, 0] - around[0, 2] + around[0, 0]) / 4
            z = weight_up * (over[1, 1] - centre) + weight_down * (under[1, 1] - centre)
            zz = 2 * ((over[1, 1] - centre) / up + (under[1, 1] - centre) / down) / (up + down)
            zy = weight_up * ((over[2, 1] - over[0, 1]) / 2 - y) + weight_down * (
                (under[2, 1] - under[0, 1]) / 2 - y
            )
            zx = weight_up * ((over[1, 2] - over[1, 0]) / 2 - x) + weight_down * (
                (under[1, 2] - under[1, 0]) / 2 - x
            )
            far = max(-first, last)
            reach = (abs(y) + abs(x)) / 2 + (abs(yy) + abs(xx)) / 8 + abs(yx) / 4
            reach += far * (abs(z) + (abs(zy) + abs(zx)) / 2 + abs(zz) * far / 2)
            for n in range(limits.size):
                if centre + reach <= limits[n]:
                    break
                if centre - reach > limits[n]:
                    volume[n] += share * SAMPLES * SAMPLES * (last - first)
                    depths[n, 0] = min(depths[n, 0], depth + first)
                    depths[n, 1] = max(depths[n, 1], depth + last)
                    continue
                total = 0.0
                for k in range(SAMPLES):
                    v = (k + 0.5) / SAMPLES - 0.5
                    for m in range(SAMPLES):
                        u = (m + 0.5) / SAMPLES - 0.5
                        level = centre - limits[n] + v * (y + 0.5 * yy * v + yx * u) + u * (x + 0.5 * xx * u)
                        length, top, bottom = _above_zero(level, z + zy * v + zx * u, zz / 2, first, last)
                        if length > 0:
                            total += length
                            depths[n, 0] = min(depths[n, 0], depth + top)
                            depths[n, 1] = max(depths[n, 1], depth + bottom)
                volume[n] += share * total


@compiled
def _fill_cross(side: Any, shape: Any, j: int, i: int, periodic: bool, out: Any) -> None:
    """Fill a node of a grid and its nearest four neighbours with values of a plane."""
    values, ((place_y, weight_y), (place_x, weight_x)) = side
    for a, b in ((1, 1), (0, 1), (2, 1), (1, 0), (1, 2)):
        if values.shape == shape:
            row, column = neighbour(j - 1 + a, shape[0], periodic), neighbour(i - 1 + b, shape[1], periodic)
            out[a, b] = values[row, column]
        else:
            out[a, b] = lagrange(values, (place_y[j + a], weight_y[j + a]), (place_x[i + b], weight_x[i + b]))


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
