"""Compiled loops over the contact nodes that several modules of the solver share.

Fields are flattened. `nodes` holds the sorted indices of the contact nodes in the flattened field; arrays of
that size hold one element for each contact node. Sums accumulate in double precision.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.core.compiled import compiled, makes_arrays, sums
from asperity.core.types import Array


def field_of(shape: tuple[int, int], nodes: Array, values: Array) -> Array:
    """Field [y, x] of values on nodes, zero on all others."""
    field = np.zeros(shape, values.dtype)
    field.reshape(-1)[nodes.astype(np.intp)] = values  # in less than half the time of other integers
    return field


@makes_arrays
def inserted(values: Any, at: Any, others: Any) -> Any:
    """Values with others inserted before the sorted places `at`, in a third of the time of `numpy.insert`."""
    out = np.empty(values.size + others.size, values.dtype)
    first = 0
    for k in range(at.size):
        for i in range(first, at[k]):
            out[i + k] = values[i]
        out[at[k] + k] = others[k]
        first = at[k]
    for i in range(first, values.size):
        out[i + at.size] = values[i]
    return out


@sums
def added(a: Any) -> float:
    """Σ a."""
    total = 0.0
    for k in range(a.size):
        total += np.float64(a[k])
    return total


@sums
def dot(a: Any, b: Any) -> float:
    """Σ a b."""
    total = 0.0
    for k in range(a.size):
        total += np.float64(a[k]) * np.float64(b[k])
    return total


@compiled
def add_multiple(values: Any, others: Any, factor: Any) -> None:
    """Add factor × others to values."""
    for k in range(values.size):
        values[k] += factor * others[k]


def row_plus_column(nodes: Array, of_row: Array, of_column: Array) -> Array:
    """Sum of a number of its row and a number of its column, for each of some nodes.

    Parameters
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened map.
    of_row, of_column : (ny,) and (nx,) arrays of the same type

    Returns
    -------
    (count,) array of that type
    """
    out = np.empty(nodes.size, of_row.dtype)
    _row_plus_column(nodes, of_row, of_column, out)
    return out


@compiled
def _row_plus_column(nodes: Any, of_row: Any, of_column: Any, out: Any) -> None:
    row, start = np.int64(0), np.int64(0)
    for k in range(nodes.size):
        node = np.int64(nodes[k])
        if node >= start + of_column.size:
            row = node // of_column.size
            start = row * of_column.size
        out[k] = of_row[row] + of_column[node - start]
