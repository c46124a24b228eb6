"""Maxima of fields over their neighbours in a plane, and their comparison with an adjacent plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.spectral import Grid
from asperity.stress.fields import KINDS, PLACES, Field, Fields, Parts, needed_parts
from asperity.stress.maxima import Search, room_for, search_rows, upper_for
from asperity.stress.neighbours import Stencil, compare
from asperity.stress.refinement import Nodes
from asperity.types import Array


@dataclass(frozen=True)
class SearchedPlane:
    """Fields of a plane, of which the peaks are sought.

    Parameters
    ----------
    depth : float
    grid : Grid
    parts : Parts
    fields : Fields
    periodic : bool
        True if opposite edges are neighbours.
    """

    depth: float
    grid: Grid
    parts: Parts
    fields: Fields
    periodic: bool

    @classmethod
    def of_field(cls, depth: float, grid: Grid, field: Array, periodic: bool) -> SearchedPlane:
        """A plane with a field of its own."""
        zero = field.dtype.type(0)
        values = np.ascontiguousarray(field)[:, None]
        parts = Parts(values, np.zeros(PLACES, np.int64), grid.shape[1], zero)
        return cls(depth, grid, parts, Fields.of([Field(KINDS["zz"], zero, zero)], field.dtype), periodic)

    def compare(self, maxima: Maxima, grid: Grid) -> tuple[Array, Array]:
        """True where a maximum in a plane on `grid` is above the nine values here, and these, (nodes, 3, 3).

        Where it is not, some of the values are left out.
        """
        return self._compare(maxima, maxima.magnitude, grid)

    def values_around(self, maxima: Maxima, grid: Grid) -> Array:
        """The nine values at and around the nodes of maxima in a plane on `grid`, (nodes, 3, 3)."""
        return self._compare(maxima, np.full(maxima.size, np.inf), grid)[1]

    def _compare(self, maxima: Maxima, magnitude: Array, grid: Grid) -> tuple[Array, Array]:
        real, place = self.parts.values.dtype, self.parts.place
        kept, values = np.ones(maxima.size, bool), np.empty((maxima.size, 3, 3), real)
        stencil = Stencil(
            np.stack([needed_parts(kind, place) for kind in self.fields.kinds]),
            np.where(place >= 0, np.arange(PLACES), -1),
            np.empty((1, PLACES, 1)),
            np.empty((2, 3, 6), np.int64),
            np.empty((2, 3, 6)),
        )
        compare(
            self.parts,
            self.fields,
            maxima.field,
            *maxima.nodes,
            grid.shape,
            self.periodic,
            magnitude.astype(real, copy=False),
            stencil,
            kept,
            values,
        )
        return kept, values


@dataclass
class Maxima:
    """Maxima of fields of one plane over their neighbours in it, by rising rows, fields and columns.

    Parameters
    ----------
    field : (maxima,) integer array
        Which field.
    nodes : (rows, columns)
    here : (maxima, 3, 3) array
        Values at and around the nodes.
    above : (maxima, 3, 3) array or None
        Those in the plane above, if the maxima exceed them; None if they have not been compared.
    """

    field: Array
    nodes: Nodes
    here: Array
    above: Array | None = None

    @property
    def size(self) -> int:
        """Number of maxima."""
        return self.field.size

    @property
    def magnitude(self) -> Array:
        """Magnitudes at the nodes."""
        return np.abs(self.here[:, 1, 1])

    def select(self, chosen: Array) -> Maxima:
        """Some of the maxima."""
        above = None if self.above is None else self.above[chosen]
        row, column = self.nodes
        return Maxima(self.field[chosen], (row[chosen], column[chosen]), self.here[chosen], above)


def plane_maxima(plane: SearchedPlane, floor: float) -> Maxima:
    """Maxima of a plane of one field: nodes whose magnitude is above the floor and above its 8 neighbours."""
    rows, columns = plane.grid.shape
    real = plane.parts.values.dtype
    capacity = (rows // 2 + 2) * (columns // 2 + 1)
    room = room_for(1, columns, capacity, real, lambda _, shape, dtype: np.empty(shape, dtype))
    search = Search(
        plane.fields,
        np.empty(0, np.int64),
        np.array([True]),
        np.array([-1]),
        real.type(floor),
        plane.periodic,
        False,
    )
    # One row more at both ends: the rows at the edges are compared with their neighbours too.
    nothing = np.empty((0, 1, 1), real), np.empty((0, 1, 1), real), np.empty((0, 0, 0))
    nodes = np.empty(0, np.int64)
    upper = upper_for(nodes, nodes, np.empty(0, real), rows)
    search_rows(plane.parts, plane.parts, search, upper, room, -1, -1, rows + 1, *nothing)
    count = room.count[0]
    nodes_found = room.row[:count], room.column[:count]
    return Maxima(room.field[:count], nodes_found, room.around[:count])
