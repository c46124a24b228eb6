"""Compiled search for the maxima of fields in a plane, and their comparison with the adjacent planes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from asperity.machine_code import discard_outdated
from asperity.stress.fields import PLACES, SHARED, Field, Parts, fill_row, fill_von_mises, value_at

_compiled = njit(cache=True, error_model="numpy", nogil=True)
_inlined = njit(
    cache=True,
    error_model="numpy",
    nogil=True,
    forceinline=True,
)
# Numbers may be added in any order, and none is NaN: only then loops that sum or compare are vectorised.
_reduction = njit(
    cache=True,
    error_model="numpy",
    nogil=True,
    fastmath={"reassoc", "nnan", "nsz", "contract"},
)

_FROM_CENTRE = ((0, 0), (0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (1, -1), (-1, -1), (-1, 1))
"""A node and its neighbours: most maxima end at the node itself."""

_INVERSE_PRODUCTS = np.array([1 / np.prod([k - m for m in range(6) if m != k]) for k in range(6)])
"""Denominators of Lagrange's formula on six nodes."""

_MARGIN = 16
"""Numbers beside a row of values, of which the nearest are those beyond the edge."""

_BLOCK = 1024
"""Numbers that are summed in their own precision."""

_WORD = 8
"""Flags of nodes that are looked at together."""


class Search(NamedTuple):
    """Fields of a plane that are searched or averaged.

    Parameters
    ----------
    von_mises : integer array
        Which fields are von Mises stresses: the first ones.
    kinds : (fields,) integer array
    ratios, uniforms : (fields,) arrays in the precision of the plane
        As of `asperity.stress.fields.Field`.
    sought : (fields,) bool array
        True where maxima are sought.
    averaged : (fields,) integer array
        Where in `reference` and `sums` a field is compared; −1 where it is not averaged.
    floor : float
        Maxima of a magnitude at or below it are left out.
    periodic : bool
    compared : bool
        True if only maxima above their neighbours in the plane above are taken.
    """

    von_mises: Any
    kinds: Any
    ratios: Any
    uniforms: Any
    sought: Any
    averaged: Any
    floor: float
    periodic: bool
    compared: bool


class Room(NamedTuple):
    """Arrays in which a band of rows is searched, kept from plane to plane.

    Parameters
    ----------
    rows : (fields, 3, columns + 2 `_MARGIN`) array in the precision of the plane
        The last three rows of each field.
    bits : the same as integers
    shared : `SHARED` array in the precision of the plane
    skipped : (at least columns,) array in the precision of the plane
    flags, words : (at least columns + 8,) uint8 array, the same as uint64
    found : (fields, nodes) integer array
        Flat indices of the maxima.
    around : (fields, nodes, 3, 3) array in the precision of the plane
        Values at and around them.
    above : (fields, nodes, 3, 3) array in the precision of the plane
        Those in the plane above, if it is on the same grid.
    counts, before : (fields,) integer arrays
        Number of the maxima found so far, and before the last rows.
    """

    rows: Any
    bits: Any
    shared: Any
    skipped: Any
    flags: Any
    words: Any
    found: Any
    around: Any
    above: Any
    counts: Any
    before: Any


def room_for(
    fields: int, columns: int, most: int, real: np.dtype[Any], empty: Callable[[str, Any, Any], Any]
) -> Room:
    """Room for a number of fields and at most so many maxima of each.

    Parameters
    ----------
    fields, columns, most : int
    real : dtype
        Precision of the plane.
    empty : callable
        Makes an array with any values from a name, a shape and a type.
    """
    rows = empty("rows", (fields, 3, columns + 2 * _MARGIN), real)
    flags = empty("flags", (_WORD * (columns // _WORD + 2),), np.uint8)
    return Room(
        rows,
        rows.view(f"i{real.itemsize}"),
        empty("shared", SHARED, real),
        empty("skipped", (columns,), real),
        flags,
        flags.view(np.uint64),
        empty("found", (fields, most), np.int64),
        empty("around", (fields, most, 3, 3), real),
        empty("above", (fields, most, 3, 3), real),
        np.zeros(fields, np.int64),
        np.zeros(fields, np.int64),
    )


@_compiled
def search_rows(
    parts: Any,
    above: Any,
    search: Any,
    room: Any,
    start: int,
    first: int,
    last: int,
    reference: Any,
    sums: Any,
) -> None:
    """Compute the fields of some rows of a plane, search the rows above them for maxima, and sum.

    Parameters
    ----------
    parts, above : Parts
        Of the plane and, if `Search.compared`, of the one above on the same grid.
    search : Search
    room : Room
    start, first, last : int
        Rows `first` to `last` − 1 are new, those from `start` have been searched before. A row is compared
        with both its neighbours when the one after it is there: all but `start` and `last` − 1.
        Rows beyond the edges are those at the opposite edge or their mirror image.
    reference : (averaged, rows / step, columns / step) array
        Fields with which each averaged one is compared at every `step`-th node; empty if there are none.
    sums : (averaged, rows, 5) array
        Sum of each row, of its squares, its largest value, and over the compared nodes the sum of the field
        and of its product with the reference; empty if nothing is summed.
    """
    rows, columns, periodic = parts.values.shape[0], parts.columns, search.periodic
    fields = search.kinds.size
    for t in range(fields):
        room.before[t] = room.counts[t]
    for j in range(first, last):
        row, line = neighbour(j, rows, periodic), j % 3
        of_plane = search.ratios, search.uniforms
        if search.von_mises.size:
            fill_von_mises(parts, row, *of_plane, search.von_mises, room.shared, room.rows, line, _MARGIN)
        for t in range(fields):
            values = room.rows[t, line]
            if t >= search.von_mises.size:
                field = Field(search.kinds[t], search.ratios[t], search.uniforms[t])
                fill_row(parts, field, row, values[_MARGIN:])
            m = search.averaged[t]
            if m >= 0 and sums.size:
                _sum_row(
                    room.rows, room.bits, t, line, columns, row, reference, m, room.skipped, sums[m, row]
                )
            if search.sought[t]:
                _fill_margins(values, columns, periodic)
                if j - start >= 2:
                    _search_row(j - 1, columns, neighbour(j - 1, rows, periodic), search.floor, room, t)
    if search.compared:
        # While the rows of the plane above are in the cache for all fields.
        for t in range(fields):
            field = Field(search.kinds[t], search.ratios[t], search.uniforms[t])
            room.counts[t] = _keep_above(above, field, periodic, room, t)


@_inlined
def _fill_margins(line: Any, columns: int, periodic: bool) -> None:
    """Repeat the values beyond the edges of a row."""
    line[_MARGIN - 1] = line[_MARGIN + neighbour(-1, columns, periodic)]
    line[_MARGIN + columns] = line[_MARGIN + neighbour(columns, columns, periodic)]


@_reduction
def _sum_row(
    rows: Any,
    bits: Any,
    t: int,
    line: int,
    columns: int,
    row: int,
    reference: Any,
    m: int,
    room: Any,
    out: Any,
) -> None:
    here = rows[t, line, _MARGIN:]
    out[0], out[1] = _sums(here, here, columns)
    bits[t, line, 0] = _largest(bits[t, line, _MARGIN:], columns)
    out[2] = rows[t, line, 0]
    out[3] = out[4] = 0.0
    if m >= reference.shape[0]:
        return
    step = columns // reference.shape[2]
    if row % step:
        return
    other = reference[m, row // step]
    if step == 2:
        for i in range(other.size):
            room[i] = here[2 * i]
        out[3], out[4] = _sums(room, other, other.size)
    else:
        out[3], out[4] = _sums(here, other, other.size)


@_reduction
def _sums(values: Any, others: Any, count: int) -> tuple[float, float]:
    """Sums of some values and of their products with others: in blocks in their own precision."""
    total = product = 0.0
    for first in range(0, count, _BLOCK):
        last = min(first + _BLOCK, count)
        some, same = values[first:last], others[first:last]
        part = here = values[0] - values[0]
        for i in range(last - first):
            here += some[i]
            part += some[i] * same[i]
        total += here
        product += part
    return total, product


@_compiled
def _largest(bits: Any, count: int) -> int:
    """Bits of the largest of some values ≥ 0, from their bits, which are in the same order.

    Loops that compare integers are vectorised, those that compare floating-point numbers are not.
    """
    largest = bits[0]
    for i in range(count):
        largest = max(largest, bits[i])
    return largest


@_reduction
def _search_row(j: int, columns: int, row: int, floor: float, room: Any, t: int) -> None:
    """Add the maxima of one row, from the values in it and in the rows beside it."""
    previous, here, after = room.rows[t, (j - 1) % 3], room.rows[t, j % 3], room.rows[t, (j + 1) % 3]
    centre, left, right = here[_MARGIN:], here[_MARGIN - 1 :], here[_MARGIN + 1 :]
    upper, lower = previous[_MARGIN:], after[_MARGIN:]
    flags = room.flags
    for i in range(columns):
        magnitude = abs(centre[i])
        flags[i] = (
            (magnitude > floor)
            & (magnitude >= abs(left[i]))
            & (magnitude >= abs(right[i]))
            & (magnitude >= abs(upper[i]))
            & (magnitude >= abs(lower[i]))
        )
    for i in range(columns, columns + _WORD):
        flags[i] = 0
    for word in range((columns + _WORD - 1) // _WORD):
        if room.words[word]:
            for i in range(_WORD * word, _WORD * word + _WORD):
                if flags[i]:
                    _add_maximum(previous, here, after, i, row * columns, room, t)


@_inlined
def _add_maximum(previous: Any, here: Any, after: Any, column: int, first: int, room: Any, t: int) -> None:
    """Add a node to the maxima if none of its neighbours is higher, and none before it as high."""
    count = room.counts[t]
    around = room.around[t, count]
    for b in range(3):
        place = _MARGIN + column + b - 1
        around[0, b], around[1, b], around[2, b] = previous[place], here[place], after[place]
    centre = abs(around[1, 1])
    earlier = max(abs(around[0, 0]), abs(around[0, 1]), abs(around[0, 2]), abs(around[1, 0]))
    later = max(abs(around[1, 2]), abs(around[2, 0]), abs(around[2, 1]), abs(around[2, 2]))
    if centre > earlier and centre >= later:
        room.found[t, count] = first + column
        room.counts[t] = count + 1


@_inlined
def neighbour(node: int, nodes: int, periodic: bool) -> int:
    """Index of a node at most two beyond the edges: at the opposite edge, or its mirror image."""
    if node < 0:
        return node % nodes if periodic else -node
    if node >= nodes:
        return node % nodes if periodic else 2 * nodes - 2 - node
    return node


@_compiled
def _keep_above(parts: Any, field: Any, periodic: bool, room: Any, t: int) -> int:
    """Keep those of the last maxima that are above the plane `parts`; returns the number of all."""
    columns = parts.columns
    found, around, above = room.found[t], room.around[t], room.above[t]
    kept = room.before[t]
    # Straight through all: the processor fetches the next values while it waits for these.
    for n in range(kept, room.counts[t]):
        above[n, 1, 1] = value_at(parts, field, found[n] // columns, found[n] % columns)
    for n in range(kept, room.counts[t]):
        magnitude = abs(around[n, 1, 1])
        if not magnitude > abs(above[n, 1, 1]):
            continue
        row, column = found[n] // columns, found[n] % columns
        if _exceeds(parts, field, row, column, periodic, magnitude, above[kept]):
            found[kept] = found[n]
            for k in range(9):
                around[kept, k // 3, k % 3] = around[n, k // 3, k % 3]
            kept += 1
    return kept


@_compiled
def _exceeds(
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
    needed : (`PLACES`,) bool array
        True for the linear parts on which the field depends.
    place : (`PLACES`,) integer array
        As of `Parts`, where the parts are all there in their order.
    given : (1, `PLACES`, 1) array
        Room for the parts at one point.
    places, weights : (2, 6) integer and float array
        Room for the nodes around it.
    """

    needed: Any
    place: Any
    given: Any
    places: Any
    weights: Any


@_compiled
def compare(
    parts: Any,
    field: Any,
    row: Any,
    column: Any,
    other: tuple[int, int],
    periodic: bool,
    magnitude: Any,
    stencil: Any,
    kept: Any,
    out: Any,
) -> None:
    """Take the values of a field at and around nodes as long as a magnitude is above them.

    On another grid, the linear parts are interpolated by Lagrange's formula on the six nearest nodes along
    each axis.

    Parameters
    ----------
    parts : Parts
    field : Field
    row, column : (nodes,) arrays
        Nodes of a grid of the same cell.
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
    same = parts.values.shape[0] == other[0] and parts.columns == other[1]
    for n in range(row.size):
        if same:
            kept[n] = _exceeds(parts, field, row[n], column[n], periodic, magnitude[n], out[n])
        else:
            kept[n] = _exceeds_between(
                parts, field, row[n], column[n], other, periodic, magnitude[n], stencil, out[n]
            )


@_compiled
def _exceeds_between(
    parts: Any,
    field: Any,
    row: int,
    column: int,
    other: tuple[int, int],
    periodic: bool,
    magnitude: float,
    stencil: Any,
    out: Any,
) -> bool:
    """As `_exceeds`, at a node of another grid."""
    needed, place, given, places, weights = stencil
    there = Parts(given, place, parts.columns, np.float64(parts.mean_pressure))
    origin = np.int64(0)
    precise = Field(field.kind, np.float64(field.ratio), np.float64(field.uniform))
    for k in range(9):
        a, b = _FROM_CENTRE[k]
        _stencil(row + a, other[0], parts.values.shape[0], periodic, places[0], weights[0])
        _stencil(column + b, other[1], parts.columns, periodic, places[1], weights[1])
        for part in range(PLACES):
            if needed[part]:
                given[0, part, 0] = _weighted(parts.values, parts.place[part], places, weights)
        value = value_at(there, precise, origin, origin)
        out[a + 1, b + 1] = value
        if not magnitude > abs(value):
            return False
    return True


@_inlined
def _weighted(values: Any, part: int, places: Any, weights: Any) -> float:
    place, weight = places[1], weights[1]
    a, b, c, d, e, f = place[0], place[1], place[2], place[3], place[4], place[5]
    u, v, w, x, y, z = weight[0], weight[1], weight[2], weight[3], weight[4], weight[5]
    total = 0.0
    for k in range(6):
        line = values[places[0, k], part]
        along = (u * line[a] + v * line[b]) + (w * line[c] + x * line[d]) + (y * line[e] + z * line[f])
        total += weights[0, k] * along
    return total


@_compiled
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
        place[k] = (base + k - 2) % nodes
        weight[k] = _INVERSE_PRODUCTS[k]
        for m in range(6):
            if m != k:
                weight[k] *= fraction - (m - 2)


discard_outdated(__name__)
