"""Peaks between the nodes, from quadratics through the values at and around the nodes of maxima.

Offsets are in grid spacings from the node.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from asperity.compiled import compiled, inlined
from asperity.spectral import Grid
from asperity.types import Array

MIN_DETERMINANT = 1e-12
"""A smaller determinant of the second derivatives, over the product of those along the axes, is rounding."""

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

    def select(self, chosen: Array) -> Peaks:
        """Some of the peaks."""
        return Peaks(*(getattr(self, f.name)[chosen] for f in fields(self)))

    @classmethod
    def join(cls, parts: Iterable[Peaks]) -> Peaks:
        """All peaks of several sets, in their order."""
        parts = list(parts)
        empty = np.empty(0)
        if not parts:
            return cls(empty, empty, empty, empty, empty, np.empty(0, bool))
        return cls(*(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(cls)))


class Neighbourhoods(NamedTuple):
    """Values at and around the nodes of peaks of one plane.

    Parameters
    ----------
    field : (peaks,) integer array
        Which field.
    nodes : (rows, columns)
    here : (peaks, 3, 3) array
        In the plane.
    above, below : (peaks, 3, 3) arrays
        In the adjacent planes; not used in the surface.
    depths : (above, here, below) or None
        Depths of the planes; None in the surface.
    depth : float
        Of the plane.
    grid : Grid
        Of the plane.
    """

    field: Array
    nodes: Nodes
    here: Array
    above: Array
    below: Array
    depths: tuple[float, float, float] | None
    depth: float
    grid: Grid


def peaks_of(planes: Sequence[Neighbourhoods], periodic: bool) -> Peaks:
    """Refined peaks of several planes, those of a plane one after the other.

    Parameters
    ----------
    planes : sequence of Neighbourhoods
    periodic : bool
        True if positions beyond an edge of the cell are those at the opposite edge.
    """
    return Peaks.join([_refined(plane, periodic) for plane in planes])


def _refined(plane: Neighbourhoods, periodic: bool) -> Peaks:
    """Peaks of one plane."""
    here, depth = plane.here, np.full(plane.here.shape[0], float(plane.depth))
    if plane.depths is None:
        value, *offsets = refine_in_plane(here)
    else:
        value, depth, *offsets = refine_in_solid(plane.above, here, plane.below, plane.depths)
    along = zip(plane.nodes, offsets, plane.grid.shape, plane.grid.spacing, strict=True)
    y, x = (
        (wrapped(nodes + offset, count) if periodic else nodes + offset) * step
        for nodes, offset, count, step in along
    )
    node_value = here[:, 1, 1].astype(float)
    interior = np.full(value.size, plane.depths is not None)
    return Peaks(value * np.sign(node_value), depth, y, x, node_value, interior)


def wrapped(places: Array, length: ArrayLike) -> Array:
    """Places in a periodic cell, from 0 to below its length."""
    inside = places % length
    # The remainder of a small negative number may be rounded to the length.
    return np.where(inside < length, inside, 0.0)


def refine_in_plane(values: Array) -> Array:
    """Magnitude and offsets y, x, (3, maxima), of the maxima of quadratics through 3 × 3 values.

    Parameters
    ----------
    values : (maxima, 3, 3) array
        Along y and x, the node in the middle. Where that is negative, the sign of all nine is changed.
    """
    out = np.empty((3, values.shape[0]))
    _refine_in_plane(values, out)
    return out


def refine_in_solid(above: Array, here: Array, below: Array, depths: tuple[float, float, float]) -> Array:
    """Magnitude, depth and offsets y, x, (4, maxima), of the maxima of quadratics through 3 × 3 × 3 values.

    Parameters
    ----------
    above, here, below : (maxima, 3, 3) arrays
        Of three planes, along y and x, the node in the middle of `here`. Where that is negative, the sign of
        all values is changed.
    depths : tuple of float
        Of the three planes, which may be unequally spaced.
    """
    out = np.empty((4, here.shape[0]))
    _refine_in_solid(above, here, below, *depths, out)
    return out


@compiled
def _refine_in_plane(values: Any, out: Any) -> None:
    for n in range(values.shape[0]):
        centre, along_y, along_x, yy, xx, yx = _derivatives(values[n], np.sign(np.float64(values[n, 1, 1])))
        # A third axis on which nothing changes.
        second = -1.0, 0.0, 0.0, yy, yx, xx
        _, y, x = _step_to_maximum((0.0, along_y, along_x), second, 1.0)
        out[0, n] = centre + 0.5 * (along_y * y + along_x * x)
        out[1, n], out[2, n] = y, x


@compiled
def _refine_in_solid(
    above: Any, here: Any, below: Any, depth_above: float, depth: float, depth_below: float, out: Any
) -> None:
    up, down = depth - depth_above, depth_below - depth
    weight_up, weight_down = -down / (up * (up + down)), up / (down * (up + down))
    unit = min(up, down)
    reach = max(up, down) / unit
    for n in range(here.shape[0]):
        sign = np.sign(np.float64(here[n, 1, 1]))
        centre, along_y, along_x, yy, xx, yx = _derivatives(here[n], sign)
        over, over_y, over_x, _, _, _ = _derivatives(above[n], sign)
        under, under_y, under_x, _, _, _ = _derivatives(below[n], sign)
        # Derivatives along depth per `unit`, of the quadratics through three planes.
        along_z = unit * (weight_up * (over - centre) + weight_down * (under - centre))
        zy = unit * (weight_up * (over_y - along_y) + weight_down * (under_y - along_y))
        zx = unit * (weight_up * (over_x - along_x) + weight_down * (under_x - along_x))
        zz = 2 * (unit * unit) * ((over - centre) / up + (under - centre) / down) / (up + down)
        gradient, second = (along_z, along_y, along_x), (zz, zy, zx, yy, yx, xx)
        z, y, x = _step_to_maximum(gradient, second, reach)
        out[0, n] = centre + 0.5 * (along_z * z + along_y * y + along_x * x)
        out[1, n], out[2, n], out[3, n] = depth + unit * z, y, x


@inlined
def _derivatives(values: Any, sign: float) -> tuple[float, ...]:
    """Value at the middle of 3 × 3 values times a sign, slopes along y and x, and ∂²/∂y², ∂²/∂x², ∂²/∂y∂x."""
    centre = sign * values[1, 1]
    left, right, upper, lower = values[1, 0], values[1, 2], values[0, 1], values[2, 1]
    left, right, upper, lower = sign * left, sign * right, sign * upper, sign * lower
    corners = sign * values[2, 2] - sign * values[2, 0] - sign * values[0, 2] + sign * values[0, 0]
    slopes = (lower - upper) / 2, (right - left) / 2
    return centre, *slopes, lower - 2 * centre + upper, right - 2 * centre + left, corners / 4


@inlined
def _step_to_maximum(gradient: Any, second: Any, reach: float) -> tuple[float, float, float]:
    """Newton's step to the maximum of a quadratic.

    Where it has no maximum within `reach` along the first axis and one spacing along the others, the axis
    that gains most is refined alone, by at most half a spacing.

    Parameters
    ----------
    gradient : three numbers
    second : six numbers
        Second derivatives: the upper triangle of their matrix, row by row.
    reach : float
    """
    u, v, w = gradient
    a, b, c, d, e, f = second
    # The adjugate of the matrix, divided by the determinant below.
    aa, ab, ac = d * f - e * e, c * e - b * f, b * e - c * d
    bb, bc, cc = a * f - c * c, b * c - a * e, a * d - b * b
    determinant = a * aa + b * ab + c * ac
    # Sylvester's criterion: leading minors of alternating sign.
    if abs(determinant) > MIN_DETERMINANT * abs(a * d * f) and a < 0 and cc > 0 and determinant < 0:
        z = -(aa * u + ab * v + ac * w) / determinant
        y = -(ab * u + bb * v + bc * w) / determinant
        x = -(ac * u + bc * v + cc * w) / determinant
        if abs(z) <= reach and abs(y) <= 1 and abs(x) <= 1:
            return z, y, x
    z, y, x = _step_alone(u, a), _step_alone(v, d), _step_alone(w, f)
    if abs(z * u) >= abs(y * v) and abs(z * u) >= abs(x * w):
        return z, 0.0, 0.0
    return (0.0, y, 0.0) if abs(y * v) >= abs(x * w) else (0.0, 0.0, x)


@inlined
def _step_alone(slope: float, second: float) -> float:
    """Step along one axis."""
    return min(max(-slope / second, -0.5), 0.5) if second < 0 else 0.0
