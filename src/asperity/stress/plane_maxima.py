"""Maxima of one field over their neighbours in a plane, and their comparison with an adjacent plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.spectral import Grid
from asperity.stress.fields import KINDS, PLACES, Field, Parts, needed_parts
from asperity.stress.maxima import Search, room_for, search_rows, upper_for
from asperity.stress.neighbours import Stencil, compare
from asperity.stress.refinement import Nodes
from asperity.types import Array


@dataclass(frozen=True)
class SearchedPlane:
    """One field of a plane, of which the peaks are sought.

    Parameters
    ----------
    depth : float
    grid : Grid
    parts : Parts
    field : Field
    periodic : bool
        True if opposite edges are neighbours.
    """

    depth: float
    grid: Grid
    parts: Parts
    field: Field
    periodic: bool

    @classmethod
    def of_field(cls, depth: float, grid: Grid, field: Array, periodic: bool) -> SearchedPlane:
        """A plane with a field of its own."""
        zero = field.dtype.type(0)
        values = np.ascontiguousarray(field)[:, None]
        parts = Parts(values, np.zeros(PLACES, np.int64), grid.shape[1], zero)
        return cls(depth, grid, parts, Field(KINDS["zz"], zero, zero), periodic)

    def compare(self, maxima: Maxima, grid: Grid) -> tuple[Array, Array]:
        """True where a maximum in a plane on `grid` is above the nine values here, and these, (nodes, 3, 3).

        Where it is not, some of the values are left out.
        """
        return self._compare(maxima.nodes, np.abs(maxima.here[:, 1, 1]), grid)

    def values_around(self, nodes: Nodes, grid: Grid) -> Array:
        """The nine values at and around nodes of a grid of the cell, (nodes, 3, 3)."""
        return self._compare(nodes, np.full(nodes[0].size, np.inf), grid)[1]

    def _compare(self, nodes: Nodes, magnitude: Array, grid: Grid) -> tuple[Array, Array]:
        real, place = self.parts.values.dtype, self.parts.place
        kept, values = np.ones(magnitude.size, bool), np.empty((magnitude.size, 3, 3), real)
        stencil = Stencil(
            needed_parts(self.field.kind, place),
            np.where(place >= 0, np.arange(PLACES), -1),
            np.empty((1, PLACES, 1)),
            np.empty((2, 3, 6), np.int64),
            np.empty((2, 3, 6)),
        )
        last = grid.shape, self.periodic, magnitude.astype(real, copy=False), stencil, kept, values
        compare(self.parts, self.field, nodes[0], nodes[1], *last)
        return kept, values


@dataclass
class Maxima:
    """Maxima of one plane over their neighbours in it.

    Parameters
    ----------
    nodes : (rows, columns)
    here : (maxima, 3, 3) array
        Values at and around the nodes.
    above : (maxima, 3, 3) array or None
        Those in the plane above, if the maxima exceed them; None in the first plane.
    """

    nodes: Nodes
    here: Array
    above: Array | None = None

    @classmethod
    def at(cls, index: Array, here: Array, grid: Grid, above: Array | None = None) -> Maxima:
        """Maxima at flat indices of nodes."""
        row, column = np.divmod(index, grid.shape[1])
        return cls((row, column), here, above)

    def select(self, chosen: Array) -> Maxima:
        """Some of the maxima."""
        above = None if self.above is None else self.above[chosen]
        return Maxima((self.nodes[0][chosen], self.nodes[1][chosen]), self.here[chosen], above)


def plane_maxima(plane: SearchedPlane, floor: float) -> Maxima:
    """Nodes whose magnitude is above the floor and above its 8 neighbours, in their order."""
    rows, columns = plane.grid.shape
    real = plane.parts.values.dtype
    capacity = (rows // 2 + 2) * (columns // 2 + 1)
    room = room_for(1, columns, capacity, real, lambda _, shape, dtype: np.empty(shape, dtype))
    kind, ratio, uniform = plane.field
    search = Search(
        np.empty(0, np.int64),
        np.array([kind]),
        np.array([ratio], real),
        np.array([uniform], real),
        np.array([True]),
        np.array([-1]),
        real.type(floor),
        plane.periodic,
        False,
    )
    # One row more at both ends: the rows at the edges are compared with their neighbours too.
    nothing = np.empty((0, 1, 1), real), np.empty((0, 0, 0))
    nodes = np.empty(0, np.int64)
    upper = upper_for([(nodes, nodes, nodes)], rows, real)
    search_rows(plane.parts, plane.parts, search, upper, room, -1, -1, rows + 1, *nothing)
    count = room.counts[0]
    return Maxima.at(room.found[0, :count], room.around[0, :count], plane.grid)
