"""Linear interpolation from the coarse-grid nodes, those in every second row and column, and its transpose.

A field on the coarse-grid nodes has a row and a column more than there are even rows and columns.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.contact.compliance.vectors import row_plus_column
from asperity.core.compiled import compiled
from asperity.core.types import Array


def coarse_indices(nodes: Array, shape: tuple[int, int], width: int) -> Array:
    """For each node, 4 × index of a coarse-grid node + 2 × parity of its row + parity of its column.

    Parameters
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened map.
    shape : (ny, nx)
        Nodes of the map.
    width : int
        Columns of the field on the coarse-grid nodes. The index is that of the coarse-grid node in the same
        row and column or in those before, in this field, flattened.
    """
    rows, columns = (np.arange(count, dtype=np.uint32) for count in shape)
    of_row = 4 * (rows // 2 * np.uint32(width)) + 2 * (rows % 2)
    return row_plus_column(nodes, of_row, 4 * (columns // 2) + columns % 2)


@compiled
def restrict(indices: Any, values: Any, width: int, field: Any) -> None:
    """Add values on nodes to a flattened field on the coarse-grid nodes, by transposed interpolation."""
    half = np.float32(0.5)
    for k in range(indices.size):
        index, value = np.int64(indices[k]), values[k]
        i = index >> 2
        # Nothing is added to the next column if the node is in an even one: a branch would be slower.
        after = half * np.float32(index & 1) * value
        before = value - after
        if index & 2:
            before, after = half * before, half * after
            field[i + width] += before
            field[i + width + 1] += after
        field[i] += before
        field[i + 1] += after


@compiled
def add_prolongated(field: Any, indices: Any, width: int, out: Any) -> None:
    """Add the interpolant of a flattened field on the coarse-grid nodes to values on nodes."""
    quarter = np.float32(0.25)
    for k in range(indices.size):
        index = np.int64(indices[k])
        i = index >> 2
        below = i + ((index >> 1) & 1) * width
        after = index & 1
        out[k] += quarter * ((field[i] + field[i + after]) + (field[below] + field[below + after]))
