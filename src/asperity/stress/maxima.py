"""Compiled search for the maxima of fields in the rows of a plane."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from asperity.compiled import compiled, inlined, sums_without_nan
from asperity.intrinsics import lowest_bit
from asperity.machine_code import discard_outdated
from asperity.stress.fields import SHARED, field_at, fill_row, fill_von_mises, value_at
from asperity.stress.neighbours import exceeds, neighbour
from asperity.stress.row_sums import sum_row
from asperity.types import Array

_MARGIN = 16
"""Numbers beside a row of values, of which the nearest are those beyond the edge."""

_CHUNK = 32
"""Nodes that are compared with their neighbours together: a bit of one number for each."""


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
    rows : (fields, 3, at least columns + 2 `_MARGIN`) array in the precision of the plane
        The last three rows of each field.
    bits : the same as integers
    shared : `SHARED` array in the precision of the plane
    skipped : (at least columns,) array in the precision of the plane
    flags : (at least columns / `_CHUNK`,) uint32 array
        A bit for every node of a row.
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
    skipped: Any
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
    rows = empty("rows", (fields, 3, (-(-columns // _MARGIN) + 2) * _MARGIN), real)
    return Room(
        rows,
        rows.view(f"i{real.itemsize}"),
        empty("shared", SHARED, real),
        empty("skipped", (columns,), real),
        empty("flags", (-(-columns // _CHUNK),), np.uint32),
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
    sums : (averaged, rows, 5) array
        Sum of each row, of its squares, its largest value, and over the compared nodes the sum of the field
        and of its product with the reference; empty if nothing is summed.
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
                sum_row(
                    values,
                    room.bits[t, line],
                    _MARGIN,
                    columns,
                    row,
                    reference,
                    m,
                    room.skipped,
                    sums[m, row],
                )
            if search.sought[t]:
                _fill_margins(values, columns, periodic)
                if j - start >= 2:
                    searched = neighbour(j - 1, rows, periodic)
                    _search_row(room, t, j - 1, searched, columns, search.floor, upper, fields)
    if search.compared:
        room.count[0] = _keep_above(above, search.fields, periodic, room, before)


@inlined
def _fill_margins(line: Any, columns: int, periodic: bool) -> None:
    """Repeat the values beyond the edges of a row."""
    line[_MARGIN - 1] = line[_MARGIN + neighbour(-1, columns, periodic)]
    line[_MARGIN + columns] = line[_MARGIN + neighbour(columns, columns, periodic)]


@inlined
def _search_row(
    room: Any, t: int, j: int, row: int, columns: int, floor: float, upper: Any, fields: int
) -> None:
    """Add the maxima of one row of a field, and compare those of the plane above with it.

    The values in the row and in those beside it are the last three of the field in `room`, the row's own at
    the place `j` modulo three.
    """
    previous, here, after = room.rows[t, (j - 1) % 3], room.rows[t, j % 3], room.rows[t, (j + 1) % 3]
    _mark_higher(previous, here, after, columns, floor, room.flags)
    for c in range(room.flags.size):
        if room.flags[c]:
            _add_maxima(previous, here, after, room.flags[c], c * _CHUNK, row, room, t)
    first, last = upper.first[row * fields + t], upper.first[row * fields + t + 1]
    if first < last:
        _compare_upper(previous, here, after, upper, first, last)


@sums_without_nan
def _mark_higher(previous: Any, here: Any, after: Any, columns: int, floor: float, flags: Any) -> None:
    """Mark the nodes of a row that are above a floor, and of whose four neighbours none is higher."""
    centre, left, right = here[_MARGIN:], here[_MARGIN - 1 :], here[_MARGIN + 1 :]
    upper, lower = previous[_MARGIN:], after[_MARGIN:]
    whole = columns // _CHUNK
    for c in range(whole):
        n = c * _CHUNK
        flags[c] = _higher(centre[n:], left[n:], right[n:], upper[n:], lower[n:], floor, _CHUNK)
    if flags.size > whole:
        n = whole * _CHUNK
        flags[whole] = _higher(centre[n:], left[n:], right[n:], upper[n:], lower[n:], floor, columns - n)


@inlined
def _higher(centre: Any, left: Any, right: Any, upper: Any, lower: Any, floor: float, count: int) -> Any:
    """A bit for each of some nodes, for `_mark_higher`."""
    bits = np.int32(0)
    for i in range(count):
        magnitude = abs(centre[i])
        higher = (
            (magnitude > floor)
            & (magnitude >= abs(left[i]))
            & (magnitude >= abs(right[i]))
            & (magnitude >= abs(upper[i]))
            & (magnitude >= abs(lower[i]))
        )
        bits = np.int32(bits | (np.int32(1 << i) if higher else np.int32(0)))
    return np.uint32(bits)


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
    # Straight through all: the processor fetches the next values while it waits for these.
    for n in range(before, room.count[0]):
        above[n, 1, 1] = value_at(parts, field_at(fields, field[n]), row[n], column[n])
    kept = before
    for n in range(before, room.count[0]):
        magnitude = abs(around[n, 1, 1])
        if not magnitude > abs(above[n, 1, 1]):
            continue
        own = field_at(fields, field[n])
        if exceeds(parts, own, row[n], column[n], periodic, magnitude, above[kept]):
            field[kept], row[kept], column[kept] = field[n], row[n], column[n]
            for k in range(9):
                around[kept, k // 3, k % 3] = around[n, k // 3, k % 3]
            kept += 1
    return kept


discard_outdated(__name__)
