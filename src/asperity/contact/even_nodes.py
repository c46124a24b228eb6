"""Linear interpolation from the even nodes, those in every second row and column, and its transpose.

A field on the even nodes has a row and a column more than there are even rows and columns.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.compiled import compiled
from asperity.contact.places import row_plus_column
from asperity.types import Array


def places_of(nodes: Array, shape: tuple[int, int], width: int, threads: int = 1) -> Array:
    """Where nodes lie among the even nodes: 4 × index + 2 × parity of the row + parity of the column.

    Parameters
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened map.
    shape : (ny, nx)
        Nodes of the map.
    width : int
        Columns of the field on the even nodes. The index is that of the even node in the same row and column
        or in those before, in this field, flattened.
    threads : int
    """
    rows, columns = (np.arange(count, dtype=np.uint32) for count in shape)
    of_row = 4 * (rows // 2 * np.uint32(width)) + 2 * (rows % 2)
    return row_plus_column(nodes, of_row, 4 * (columns // 2) + columns % 2, threads)


@compiled
def add_transposed(places: Any, values: Any, width: int, field: Any) -> None:
    """Add values on nodes to a flattened field on the even nodes around them, by transposed interpolation."""
    half = np.float32(0.5)
    for k in range(places.size):
        place, value = np.int64(places[k]), values[k]
        i = place >> 2
        # Nothing is added to the next column if the node is in an even one: a branch would be slower.
        after = half * np.float32(place & 1) * value
        before = value - after
        if place & 2:
            before, after = half * before, half * after
            field[i + width] += before
            field[i + width + 1] += after
        field[i] += before
        field[i + 1] += after


@compiled
def spread_transposed(
    places: Any, values: Any, first: Any, edges: Any, width: int, begin: int, end: int, odd: int, field: Any
) -> None:
    """Write what `add_transposed` makes of values to every second strip of rows of a field.

    The values of a strip are added to its rows and to the first row of the next one. The even strips have to
    be written before the odd ones: they set that row to zero too, so that odd ones can add to it.

    Parameters
    ----------
    places, values
        Of the nodes, sorted.
    first, edges
        The first node and the first row of each strip, and their numbers at the end.
    width : int
        Columns of the field.
    begin, end : int
        Of the even or odd strips, those from number `begin` to before `end`.
    odd : int
        1 for the odd strips, 0 for the even ones.
    field
        Flattened.
    """
    for strip in range(2 * begin + odd, 2 * end + odd, 2):
        top, bottom = edges[strip], edges[strip + 1]
        field[(top + odd) * width : (bottom + 1 - odd) * width] = 0
        some = slice(first[strip], first[strip + 1])
        add_transposed(places[some], values[some], width, field)


@compiled
def add_interpolated(field: Any, places: Any, width: int, out: Any) -> None:
    """Add the interpolant of a flattened field on the even nodes to values on nodes."""
    quarter = np.float32(0.25)
    for k in range(places.size):
        place = np.int64(places[k])
        i = place >> 2
        below = i + ((place >> 1) & 1) * width
        after = place & 1
        out[k] += quarter * ((field[i] + field[i + after]) + (field[below] + field[below + after]))
