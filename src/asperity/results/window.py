"""Part of the cell between positions along y and x: the nodes that are drawn or exported."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from asperity.spectral import Grid
from asperity.types import Array

Span = tuple[float, float]
"""First and last position of a part of an axis."""

_SLACK = 1e-9
"""A node that lies outside by this share of the edge, by rounding, counts as inside."""


@dataclass(frozen=True)
class Window:
    """Part of a cell.

    Parameters
    ----------
    rows, columns : slice
        Nodes along y and x.
    y, x : arrays
        Positions of these nodes.
    spacing : (along y, along x)
    """

    rows: slice
    columns: slice
    y: Array
    x: Array
    spacing: tuple[float, float]

    def of(self, field: Array) -> Array:
        """The part of a field [y, x]."""
        return field[self.rows, self.columns]


def window(
    grid: Grid,
    y: Span | None = None,
    x: Span | None = None,
    told: Callable[[float], str] = "{:.6g}".format,
) -> Window:
    """The part of a cell between two positions along each axis, both included; by default all of it.

    Parameters
    ----------
    grid : Grid
    y, x : (first, last), optional
    told : callable, optional
        Text of a length in messages.

    Raises
    ------
    ValueError
        If the positions do not rise, lie outside the cell, or have fewer than two nodes between them.
    """
    parts, positions = [], []
    for name, span, nodes, edge in zip("yx", (y, x), grid.coordinates(), grid.length, strict=True):
        part = slice(0, nodes.size)
        if span is not None:
            low, high = span
            given, slack = f"{name} = {told(low)} to {told(high)}", _SLACK * edge
            if not 0 <= low < high <= edge + slack:
                raise ValueError(f"{given}: rising positions from 0 to {told(edge)} are needed")
            part = slice(*map(int, np.searchsorted(nodes, [low - slack, high + slack])))
            if part.stop - part.start < 2:
                apart = told(edge / nodes.size)
                raise ValueError(f"{given}: at least two nodes are needed, they are {apart} apart")
        parts.append(part)
        positions.append(nodes[part])
    return Window(parts[0], parts[1], positions[0], positions[1], grid.spacing)
