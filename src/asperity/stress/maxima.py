"""Compiled search for the maxima of fields in the rows of a plane."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from asperity.compiled import compiled, inlined
from asperity.intrinsics import BITS, higher, higher_than, lowest_bit
from asperity.machine_code import discard_outdated
from asperity.stress.fields import SHARED, fetch_at, field_at, fill_row, fill_von_mises, value_at
from asperity.stress.neighbours import exceeds, neighbour
from asperity.stress.row_sums import sum_row, take_row
from asperity.types import Array

_MARGIN = 16
"""Numbers beside a row of values, of which the nearest are those beyond the edge."""


class Search(NamedTuple):
    """Fields of a plane that are searched or averaged.

    Parameters
    ----------
    fields : Fields
    von_mises : integer array
        Which fields are von Mises stresses: the first ones.
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

    fields: Any
    von_mises: Any
    sought: Any
    averaged: Any
    floor: float
    periodic: bool
    compared: bool


class Room(NamedTuple):
    """Arrays in which a band of rows is searched, kept from plane to plane.

    Parameters
    ----------
    rows : (fields, 3, at least columns + `_MARGIN` + `BITS`) array in the precision of the plane
        The last three rows of each field.
    bits : the same as integers
    shared : `SHARED` array in the precision of the plane
    pending : (fields, words) uint32 array
        A bit for every node of the last row of a field: the nodes that are maxima if no neighbour in the next
        row is higher.
    flags : (words,) uint32 array
        The same for one field, of the row before.
    field, row, column : (maxima,) integer arrays
        Fields and nodes of the maxima, by rising rows, fields and columns.
    around : (maxima, 3, 3) array in the precision of the plane
        Values at and around them.
    above : (maxima, 3, 3) array in the precision of the plane
        Those in the plane above, if it is on the same grid.
    count : (1,) integer array
        Number of the maxima found so far.
    """

    rows: Any
    bits: Any
    shared: Any
    pending: Any
    flags: Any
    field: Any
    row: Any
    column: Any
    around: Any
    above: Any
    count: Any


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
    words = -(-columns // BITS)
    rows = empty("rows", (fields, 3, (words + 2) * BITS), real)
    return Room(
        rows,
        rows.view(f"i{real.itemsize}"),
        empty("shared", SHARED, real),
        empty("pending", (fields, words), np.uint32),
        empty("flags", (words,), np.uint32),
        empty("field", (fields * most,), np.int64),
        empty("row", (fields * most,), np.int64),
        empty("column", (fields * most,), np.int64),
        empty("around", (fields * most, 3, 3), real),
        empty("above", (fields * most, 3, 3), real),
        np.zeros(1, np.int64),
    )


class Upper(NamedTuple):
    """Maxima of the plane above, if it is on the same grid, to be compared with the rows of this plane.

    Parameters
    ----------
    first : (rows × fields + 1,) integer array
        Place of the first maximum of each field in each row among all.
    column : (maxima,) integer array
    magnitude : (maxima,) array in the precision of the plane
    kept : (maxima,) bool array
        Becomes true where the magnitude is above all nine values at and around the node.
    values : (maxima, 3, 3) array in the precision of the plane
        Becomes these values.
    """

    first: Any
    column: Any
    magnitude: Any
    kept: Any
    values: Any


def upper_for(line: Array, column: Array, magnitude: Array, lines: int) -> Upper:
    """Maxima given by row × fields + field, which rises, columns and magnitudes."""
    first = np.zeros(lines + 1, np.int64)
    np.cumsum(np.bincount(line, minlength=lines), out=first[1:])
    values = np.empty((line.size, 3, 3), magnitude.dtype)
    return Upper(first, column, magnitude, np.zeros(line.size, bool), values)


@compiled
def search_rows(
    parts: Any,
    above: Any,
    search: Any,
    upper: Any,
    room: Any,
    start: int,
    first: int,
    last: int,
    reference: Any,
    taken: Any,
    sums: Any,
) -> None:
    """Compute the fields of some rows of a plane, search the rows above them for maxima, and sum.

    Parameters
    ----------
    parts, above : Parts
        Of the plane and, if `Search.compared`, of the one above on the same grid.
    search : Search
    upper : Upper
    room : Room
    start, first, last : int
        Rows `first` to `last` − 1 are new, those from `start` have been searched before. A row is compared
        with both its neighbours when the one after it is there: all but `start` and `last` − 1.
        Rows beyond the edges are those at the opposite edge or their mirror image.
    reference : (averaged, rows / step, columns / step) array
        Fields with which each averaged one is compared at every `step`-th node; empty if there are none.
    taken : (averaged, rows / step, columns / step) array
        Becomes the averaged fields at every `step`-th node; empty if they are not needed.
    sums : (averaged, rows, 5) array
        Sum of each row, of its squares, its largest value, and over the compared nodes the sum of the field
        and of its product with the reference; empty if nothing is summed or taken.
    """
    rows, columns, periodic = parts.values.shape[0], parts.columns, search.periodic
    fields, before = search.sought.size, room.count[0]
    for j in range(first, last):
        row, line = neighbour(j, rows, periodic), j % 3
        of_plane = search.fields.ratios, search.fields.uniforms
        if search.von_mises.size:
            fill_von_mises(parts, row, *of_plane, search.von_mises, room.shared, room.rows, line, _MARGIN)
        for t in range(fields):
            values = room.rows[t, line]
            if t >= search.von_mises.size:
                fill_row(parts, field_at(search.fields, t), row, values[_MARGIN:])
            m = search.averaged[t]
            if m >= 0 and sums.size:
                sum_row(values, room.bits[t, line], _MARGIN, columns, row, reference, m, sums[m, row])
                take_row(values, _MARGIN, columns, row, taken, m)
            if search.sought[t]:
                _fill_margins(values, columns, periodic)
                if j > start:
                    _mark(
                        values, room.rows[t, (j - 1) % 3], columns, search.floor, room.pending[t], room.flags
                    )
                else:
                    room.pending[t] = 0
                if j - start >= 2:
                    searched = neighbour(j - 1, rows, periodic)
                    found = room.count[0]
                    _search_row(room, t, j - 1, searched, upper, fields)
                    if search.compared:
                        for n in range(found, room.count[0]):
                            fetch_at(above, field_at(search.fields, t), searched, room.column[n])
    if search.compared:
        room.count[0] = _keep_above(above, search.fields, periodic, room, before)


@inlined
def _fill_margins(line: Any, columns: int, periodic: bool) -> None:
    """Repeat the values beyond the edges of a row."""
    line[_MARGIN - 1] = line[_MARGIN + neighbour(-1, columns, periodic)]
    line[_MARGIN + columns] = line[_MARGIN + neighbour(columns, columns, periodic)]


@compiled
def _mark(here: Any, previous: Any, columns: int, floor: float, pending: Any, flags: Any) -> None:
    """Mark the nodes of a row and of the one before it that may be maxima, from their four neighbours.

    A node is marked in `pending` if it is above the floor, higher than its neighbours in the row before and
    on the left, and not lower than that on the right. It is left in `flags` if that in the next row is not
    higher either. One comparison thus tells of two nodes.
    """
    following = higher(here, _MARGIN, here, _MARGIN - 1)
    for c in range(flags.size):
        place = _MARGIN + c * BITS
        higher_left = following
        following = higher(here, place + BITS, here, place + BITS - 1)
        lower_right = (higher_left >> np.uint32(1)) | (following << np.uint32(BITS - 1))
        higher_before = higher(here, place, previous, place)
        flags[c] = pending[c] & ~higher_before
        pending[c] = higher_than(here, place, floor) & higher_before & higher_left & ~lower_right
    if columns % BITS:
        pending[flags.size - 1] &= (np.uint32(1) << np.uint32(columns % BITS)) - np.uint32(1)


@inlined
def _search_row(room: Any, t: int, j: int, row: int, upper: Any, fields: int) -> None:
    """Add the maxima among the marked nodes of one row, and compare those of the plane above with it.

    The values in the row and in those beside it are the last three of the field in `room`, the row's own at
    the place `j` modulo three.
    """
    previous, here, after = room.rows[t, (j - 1) % 3], room.rows[t, j % 3], room.rows[t, (j + 1) % 3]
    for c in range(room.flags.size):
        if room.flags[c]:
            _add_maxima(previous, here, after, room.flags[c], c * BITS, row, room, t)
    first, last = upper.first[row * fields + t], upper.first[row * fields + t + 1]
    if first < last:
        _compare_upper(previous, here, after, upper, first, last)


@compiled
def _compare_upper(previous: Any, here: Any, after: Any, upper: Any, first: int, last: int) -> None:
    """Compare maxima of the plane above in one row with the values there and in the rows beside it."""
    for n in range(first, last):
        higher = True
        for b in range(3):
            place = _MARGIN + upper.column[n] + b - 1
            for a, value in enumerate((previous[place], here[place], after[place])):
                upper.values[n, a, b] = value
                higher &= upper.magnitude[n] > abs(value)
        upper.kept[n] = higher


@compiled
def _add_maxima(
    previous: Any, here: Any, after: Any, bits: Any, start: int, row: int, room: Any, t: int
) -> None:
    """Add those of some nodes to the maxima of which no neighbour is higher, and none before it as high."""
    while bits:
        column = start + np.int64(lowest_bit(bits))
        bits &= bits - np.uint32(1)
        count = room.count[0]
        around = room.around[count]
        for b in range(3):
            place = _MARGIN + column + b - 1
            around[0, b], around[1, b], around[2, b] = previous[place], here[place], after[place]
        centre = abs(around[1, 1])
        earlier = max(abs(around[0, 0]), abs(around[0, 1]), abs(around[0, 2]), abs(around[1, 0]))
        later = max(abs(around[1, 2]), abs(around[2, 0]), abs(around[2, 1]), abs(around[2, 2]))
        if centre > earlier and centre >= later:
            room.field[count], room.row[count], room.column[count] = t, row, column
            room.count[0] = count + 1


@compiled
def _keep_above(parts: Any, fields: Any, periodic: bool, room: Any, before: int) -> int:
    """Keep those of the last maxima that are above the plane `parts`; returns the number of all."""
    field, row, column, around, above = room.field, room.row, room.column, room.around, room.above
    kept = before
    for n in range(before, room.count[0]):
        own = field_at(fields, field[n])
        if abs(around[n, 1, 1]) > abs(value_at(parts, own, row[n], column[n])):
            for j in (-1, 1):
                fetch_at(parts, own, neighbour(row[n] + j, parts.values.shape[0], periodic), column[n])
            _move(room, n, kept)
            kept += 1
    last, kept = kept, before
    for n in range(before, last):
        own = field_at(fields, field[n])
        if exceeds(parts, own, row[n], column[n], periodic, abs(around[n, 1, 1]), above[kept]):
            _move(room, n, kept)
            kept += 1
    return kept


@inlined
def _move(room: Any, n: int, place: int) -> None:
    """Write a maximum, without the values above it, to another place."""
    room.field[place], room.row[place], room.column[place] = room.field[n], room.row[n], room.column[n]
    for k in range(9):
        room.around[place, k // 3, k % 3] = room.around[n, k // 3, k % 3]


discard_outdated(__name__)
