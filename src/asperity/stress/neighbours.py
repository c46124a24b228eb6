"""Compiled comparison of maxima with the nine values at and around them in an adjacent plane."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from asperity.compiled import compiled, inlined
from asperity.intrinsics import fetch
from asperity.machine_code import discard_outdated
from asperity.stress.fields import PLACES, Field, Parts, field_at, value_at

_FROM_CENTRE = ((0, 0), (0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (1, -1), (-1, -1), (-1, 1))
"""A node and its neighbours: most maxima end at the node itself."""

_INVERSE_PRODUCTS = np.array([1 / np.prod([k - m for m in range(6) if m != k]) for k in range(6)])
"""Denominators of Lagrange's formula on six nodes."""


_AHEAD = 4
"""Values of a node are fetched into the cache while so many nodes before it are compared."""


@inlined
def neighbour(node: int, nodes: int, periodic: bool) -> int:
    """Index of a node at most two beyond the edges: at the opposite edge, or its mirror image."""
    if node < 0:
        return node % nodes if periodic else -node
    if node >= nodes:
        return node % nodes if periodic else 2 * nodes - 2 - node
    return node


@compiled
def exceeds(
    parts: Any, field: Any, row: int, column: int, periodic: bool, magnitude: float, out: Any
) -> bool:
    """True if a magnitude is above the nine values at and around a node, which are written to `out`."""
    rows, columns = parts.values.shape[0], parts.columns
    for k in range(9):
        a, b = _FROM_CENTRE[k]
        line, place = neighbour(row + a, rows, periodic), neighbour(column + b, columns, periodic)
        value = value_at(parts, field, line, place)
        out[a + 1, b + 1] = value
        if not magnitude > abs(value):
            return False
    return True


class Stencil(NamedTuple):
    """What is interpolated between the nodes of a plane, and room for the values.

    Parameters
    ----------
    needed : (fields, `PLACES`) bool array
        True for the linear parts on which a field depends.
    place : (`PLACES`,) integer array
        As of `Parts`, where the parts are all there in their order.
    given : (1, `PLACES`, 1) array
        Room for the parts at one point.
    places, weights : (2, 3, 6) integer and float array
        Room for the nodes around it and its neighbours along each axis.
    """

    needed: Any
    place: Any
    given: Any
    places: Any
    weights: Any


@compiled
def compare(
    parts: Any,
    fields: Any,
    which: Any,
    row: Any,
    column: Any,
    other: tuple[int, int],
    periodic: bool,
    magnitude: Any,
    stencil: Any,
    kept: Any,
    out: Any,
) -> None:
    """Take the values of fields at and around nodes as long as a magnitude is above them.

    On another grid, the linear parts are interpolated by Lagrange's formula on the six nearest nodes along
    each axis.

    Parameters
    ----------
    parts : Parts
    fields : Fields
    which, row, column : (nodes,) arrays
        One of the fields, and a node of a grid of the same cell.
    other : (rows, columns)
        Shape of this grid.
    periodic : bool
    magnitude : (nodes,) array
    stencil : Stencil
    kept : (nodes,) bool array
        True where the magnitude is above all nine values, false elsewhere.
    out : (nodes, 3, 3) array
        Filled where it is.
    All arrays of numbers but those of `stencil` are in the precision of the plane.
    """
    rows = parts.values.shape[0]
    same = rows == other[0] and parts.columns == other[1]
    for n in range(row.size):
        field = field_at(fields, which[n])
        if same:
            kept[n] = exceeds(parts, field, row[n], column[n], periodic, magnitude[n], out[n])
            continue
        if n == 0 or row[n] != row[n - 1]:
            for a in (-1, 0, 1):
                along_y = stencil.places[0, a], stencil.weights[0, a]
                _stencil(row[n] + a, other[0], rows, periodic, *along_y)
        later = n + _AHEAD
        if later < row.size:
            _fetch_between(parts, stencil.needed[which[later]], row[later], column[later], other)
        needed = stencil.needed[which[n]]
        along_x = column[n], other[1]
        kept[n] = _exceeds_between(parts, field, needed, *along_x, periodic, magnitude[n], stencil, out[n])


@inlined
def _fetch_between(parts: Any, needed: Any, row: int, column: int, other: tuple[int, int]) -> None:
    """Have the processor fetch what `_exceeds_between` first reads for a node away from the edges."""
    values, place = parts.values, parts.place
    rows, columns = values.shape[0], parts.columns
    first, left = row * rows // other[0] - 2, column * columns // other[1] - 2
    if 0 <= first < rows - 5 and 0 <= left < columns - 5:
        for part in range(PLACES):
            if needed[part]:
                for j in range(first, first + 6):
                    fetch(values, j, place[part], left)
                    fetch(values, j, place[part], left + 5)


@compiled
def _exceeds_between(
    parts: Any,
    field: Any,
    needed: Any,
    column: int,
    columns: int,
    periodic: bool,
    magnitude: float,
    stencil: Any,
    out: Any,
) -> bool:
    """As `exceeds`, at a node of another grid, for whose row the stencil is there."""
    place, given, places, weights = stencil.place, stencil.given, stencil.places, stencil.weights
    there = Parts(given, place, parts.columns, np.float64(parts.mean_pressure))
    origin = np.int64(0)
    precise = Field(field.kind, np.float64(field.ratio), np.float64(field.uniform))
    for k in range(9):
        a, b = _FROM_CENTRE[k]
        if k < 4 and a == 0:  # the node and its neighbours in the row: those in other rows need no others
            _stencil(column + b, columns, parts.columns, periodic, places[1, b], weights[1, b])
        for part in range(PLACES):
            if needed[part]:
                along_y, along_x = (places[0, a], weights[0, a]), (places[1, b], weights[1, b])
                given[0, part, 0] = _weighted(parts.values, parts.place[part], along_y, along_x)
        value = value_at(there, precise, origin, origin)
        out[a + 1, b + 1] = value
        if not magnitude > abs(value):
            return False
    return True


@inlined
def _weighted(values: Any, part: int, along_y: Any, along_x: Any) -> float:
    place, weight = along_x
    a, b, c, d, e, f = place[0], place[1], place[2], place[3], place[4], place[5]
    u, v, w, x, y, z = weight[0], weight[1], weight[2], weight[3], weight[4], weight[5]
    total = 0.0
    for k in range(6):
        line = values[along_y[0][k], part]
        along = (u * line[a] + v * line[b]) + (w * line[c] + x * line[d]) + (y * line[e] + z * line[f])
        total += along_y[1][k] * along
    return total


@compiled
def _stencil(node: int, others: int, nodes: int, periodic: bool, place: Any, weight: Any) -> None:
    """Places and weights of the six nodes nearest to a node of another grid, for Lagrange's interpolation.

    Over a free boundary a node beyond an edge is its mirror image, and all six lie within the map.
    """
    if not periodic:
        node = neighbour(node, others, periodic)
    position = node * (nodes / others)
    base = int(np.floor(position))
    if not periodic:
        base = max(2, min(base, nodes - 4))
    fraction = position - base
    for k in range(6):
        place[k] = base + k - 2
        while place[k] < 0:
            place[k] += nodes
        while place[k] >= nodes:
            place[k] -= nodes
        weight[k] = _INVERSE_PRODUCTS[k]
        for m in range(6):
            if m != k:
                weight[k] *= fraction - (m - 2)


discard_outdated(__name__)
