"""Places of nodes in arrays that are ordered otherwise than the map."""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.compiled import compiled
from asperity.parallel import in_parts
from asperity.types import Array


def row_plus_column(nodes: Array, of_row: Array, of_column: Array, threads: int = 1) -> Array:
    """Sum of a number of its row and a number of its column, for each of some nodes.

    Parameters
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened map.
    of_row, of_column : (ny,) and (nx,) arrays of the same type
    threads : int

    Returns
    -------
    (count,) array of that type
    """
    out = np.empty(nodes.size, of_row.dtype)
    in_parts(lambda part: _row_plus_column(nodes[part], of_row, of_column, out[part]), nodes.size, threads)
    return out


def places_in_union(nodes: Array, others: Array) -> Array:
    """Places that other nodes get in the sorted union of two sorted sets without common nodes."""
    return np.searchsorted(nodes, others) + np.arange(others.size)


@compiled
def _row_plus_column(nodes: Any, of_row: Any, of_column: Any, out: Any) -> None:
    row, start = np.int64(0), np.int64(0)
    for k in range(nodes.size):
        node = np.int64(nodes[k])
        if node >= start + of_column.size:
            row = node // of_column.size
            start = row * of_column.size
        out[k] = of_row[row] + of_column[node - start]
