"""Peaks between the nodes, from quadratics through the values at and around the nodes of maxima.

All functions work on many maxima at once. Offsets are in grid spacings from the node.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np

from asperity.spectral import Grid
from asperity.types import Array

MIN_DETERMINANT = 1e-12
"""A smaller determinant of the second derivatives, over the product of those along the axes, is rounding."""

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
    found = []
    some: list[Neighbourhoods] = []
    for plane in planes:
        if some and (some[0].depths is None or sum(each.here.shape[0] for each in some) > PEAKS_AT_ONCE):
            found.append(_refined(some, periodic))
            some = []
        some.append(plane)
    if some:
        found.append(_refined(some, periodic))
    return Peaks.join(found)


def _refined(planes: Sequence[Neighbourhoods], periodic: bool) -> Peaks:
    """Peaks of some planes, of which the surface is none or the only one."""
    sizes = [plane.here.shape[0] for plane in planes]

    def each(values: Sequence[Any]) -> Array:
        """The value of its plane for every peak."""
        return np.repeat(np.array(values), sizes, axis=0)

    here = np.concatenate([plane.here for plane in planes]).astype(float, copy=False)
    if planes[0].depths is None:
        value, y, x = refine_in_plane(upright(here, here))
        depth = each([plane.depth for plane in planes])
    else:
        above, below = (np.concatenate([getattr(p, name) for p in planes]) for name in ("above", "below"))
        cube = np.stack([upright(values, here) for values in (above, here, below)], axis=1)
        value, depth, y, x = refine_in_solid(cube, *each([plane.depths for plane in planes]).T)
    row, column = (np.concatenate([plane.nodes[axis] for plane in planes]) for axis in (0, 1))
    shape, spacing = (
        each([getattr(plane.grid, name) for plane in planes]).T for name in ("shape", "spacing")
    )
    return Peaks(
        value * np.sign(here[:, 1, 1]),
        depth,
        _position(row + y, shape[0], periodic) * spacing[0],
        _position(column + x, shape[1], periodic) * spacing[1],
        here[:, 1, 1],
        np.full(y.size, planes[0].depths is not None),
    )


def _position(place: Array, nodes: Array, periodic: bool) -> Array:
    return place % nodes if periodic else place


def upright(values: Array, centre: Array) -> Array:
    """Neighbourhoods with the sign changed where the value at their centre is negative."""
    return values * np.sign(centre[:, 1:2, 1:2])


def refine_in_plane(values: Array) -> tuple[Array, Array, Array]:
    """Value and offsets y, x of the maxima of quadratics through 3 × 3 values.

    Parameters
    ----------
    values : (maxima, 3, 3) array
        Along y and x, the node in the middle.
    """
    centre = values[:, 1, 1]
    gradient = np.stack([values[:, 2, 1] - values[:, 0, 1], values[:, 1, 2] - values[:, 1, 0]], axis=1) / 2
    hessian = np.empty((centre.size, 2, 2))
    hessian[:, 0, 0] = values[:, 2, 1] - 2 * centre + values[:, 0, 1]
    hessian[:, 1, 1] = values[:, 1, 2] - 2 * centre + values[:, 1, 0]
    hessian[:, 0, 1] = hessian[:, 1, 0] = _mixed_difference(values)
    step = _step_to_maximum(gradient, hessian)
    return centre + 0.5 * np.sum(gradient * step, axis=1), step[:, 0], step[:, 1]


def refine_in_solid(
    values: Array, above: Array | float, here: Array | float, below: Array | float
) -> tuple[Array, Array, Array, Array]:
    """Value, depth and offsets y, x of the maxima of quadratics through 3 × 3 × 3 values.

    Parameters
    ----------
    values : (maxima, 3, 3, 3) array
        Along depth, y and x, the node in the middle.
    above, here, below : (maxima,) arrays or float
        Depths of the three planes, which may be unequally spaced.
    """
    up, down = here - above, below - here
    weight_up, weight_down = -down / (up * (up + down)), up / (down * (up + down))
    unit = np.minimum(up, down)

    def slope(lines: Array) -> Array:
        """Derivative along depth of the quadratic through three planes, per `unit`."""
        middle = lines[:, 1]
        return unit * (weight_up * (lines[:, 0] - middle) + weight_down * (lines[:, 2] - middle))

    centre = values[:, 1, 1, 1]
    gradient = np.empty((centre.size, 3))
    hessian = np.empty((centre.size, 3, 3))
    column = values[:, :, 1, 1]
    gradient[:, 0] = slope(column)
    gradient[:, 1] = (values[:, 1, 2, 1] - values[:, 1, 0, 1]) / 2
    gradient[:, 2] = (values[:, 1, 1, 2] - values[:, 1, 1, 0]) / 2
    hessian[:, 0, 0] = (
        2 * unit**2 * ((column[:, 0] - centre) / up + (column[:, 2] - centre) / down) / (up + down)
    )
    hessian[:, 1, 1] = values[:, 1, 2, 1] - 2 * centre + values[:, 1, 0, 1]
    hessian[:, 2, 2] = values[:, 1, 1, 2] - 2 * centre + values[:, 1, 1, 0]
    hessian[:, 1, 2] = hessian[:, 2, 1] = _mixed_difference(values[:, 1])
    hessian[:, 0, 1] = hessian[:, 1, 0] = slope((values[:, :, 2, 1] - values[:, :, 0, 1]) / 2)
    hessian[:, 0, 2] = hessian[:, 2, 0] = slope((values[:, :, 1, 2] - values[:, :, 1, 0]) / 2)
    reach = np.ones_like(gradient)
    reach[:, 0] = np.maximum(up, down) / unit
    step = _step_to_maximum(gradient, hessian, reach)
    value = centre + 0.5 * np.sum(gradient * step, axis=1)
    return value, here + unit * step[:, 0], step[:, 1], step[:, 2]


def _mixed_difference(values: Array) -> Array:
    """Second difference along y and x of 3 × 3 values."""
    return (values[:, 2, 2] - values[:, 2, 0] - values[:, 0, 2] + values[:, 0, 0]) / 4


def _step_to_maximum(gradient: Array, hessian: Array, reach: Array | float = 1.0) -> Array:
    """Newton's steps to the maxima of quadratics.

    Where a quadratic has no maximum within `reach`, the axis that gains most is refined alone, by at most
    half a spacing.
    """
    axes = np.arange(gradient.shape[1])
    curvature = hessian[:, axes, axes]
    adjugate, determinant = _adjugate(hessian)
    regular = np.abs(determinant) > MIN_DETERMINANT * np.abs(np.prod(curvature, axis=1))
    safe = np.where(regular, determinant, 1.0)
    step = -np.einsum("nij,nj->ni", adjugate, gradient) / safe[:, None]
    # Sylvester's criterion: leading minors of alternating sign.
    leading = hessian[:, 0, 0] * hessian[:, 1, 1] - hessian[:, 0, 1] ** 2
    downhill = (hessian[:, 0, 0] < 0) & (leading > 0)
    if axes.size == 3:
        downhill &= determinant < 0
    trusted = regular & downhill & np.all(np.abs(step) <= reach, axis=1)
    alone = np.where(curvature < 0, -gradient / np.where(curvature < 0, curvature, -1.0), 0.0)
    alone = np.clip(alone, -0.5, 0.5)
    largest = np.argmax(np.abs(alone * gradient), axis=1)
    single = np.where(axes == largest[:, None], alone, 0.0)
    return np.where(trusted[:, None], step, single)


def _adjugate(matrix: Array) -> tuple[Array, Array]:
    """Adjugates and determinants of symmetric matrices, (matrices, 2, 2) or (matrices, 3, 3)."""
    a, b, d = matrix[:, 0, 0], matrix[:, 0, 1], matrix[:, 1, 1]
    out = np.empty_like(matrix)
    if matrix.shape[1] == 2:
        out[:, 0, 0], out[:, 1, 1] = d, a
        out[:, 0, 1] = out[:, 1, 0] = -b
        return out, a * d - b * b
    c, e, f = matrix[:, 0, 2], matrix[:, 1, 2], matrix[:, 2, 2]
    out[:, 0, 0] = d * f - e * e
    out[:, 1, 1] = a * f - c * c
    out[:, 2, 2] = a * d - b * b
    out[:, 0, 1] = out[:, 1, 0] = c * e - b * f
    out[:, 0, 2] = out[:, 2, 0] = b * e - c * d
    out[:, 1, 2] = out[:, 2, 1] = b * c - a * e
    return out, a * out[:, 0, 0] + b * out[:, 0, 1] + c * out[:, 0, 2]
