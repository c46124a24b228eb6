"""Search of the planes of a stream for the maxima of several fields, while their rows are in the cache."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np

from asperity.stress.fields import KINDS, Field, Fields
from asperity.stress.linear_plane import LinearPlane
from asperity.stress.maxima import Room, Search, room_for, search_rows, upper_for
from asperity.stress.periodic import KeptArrays, bands_of
from asperity.stress.plane_maxima import Maxima
from asperity.types import Array

SUMS = 5
"""Numbers that `asperity.stress.maxima.search_rows` sums of each row."""


@dataclass(frozen=True)
class SoughtField:
    """A field that is computed in every plane.

    Parameters
    ----------
    name : str
    poisson, uniform : float
        Poisson's ratio, and the uniform part of σ_xx and σ_yy over the mean pressure.
    sought : bool
        True if its maxima are sought.
    averaged : bool
        True if its rows are summed.
    """

    name: str
    poisson: float
    uniform: float
    sought: bool
    averaged: bool

    def compiled(self, plane: LinearPlane) -> Field:
        """The field of a plane as the compiled functions take it."""
        real = plane.dtype.type
        ratio = self.poisson if plane.slope else 0.0
        return Field(KINDS[self.name], real(ratio), real(self.uniform * plane.mean_pressure))


class _KeptRoom(threading.local):
    """The room of each thread, used again as long as it is large enough."""

    def __init__(self) -> None:
        self._arrays = KeptArrays()
        self._kind: tuple[object, ...] = ()
        self._rows = 0

    def empty(self, fields: int, columns: int, rows: int, real: np.dtype[Any]) -> Room:
        """Room for so many rows, without maxima."""
        kind = fields, columns, real
        if kind != self._kind or rows > self._rows:
            most = (rows // 2 + 1) * (columns // 2 + 1)
            self._room = room_for(fields, columns, most, real, self._arrays.array)
            self._kind, self._rows = kind, rows
        self._room.count[0] = 0
        return self._room


class PlaneSearch:
    """Computes and searches fields of one plane after the other; keeps its memory.

    Parameters
    ----------
    fields : sequence of SoughtField
        Von Mises stresses first, and those with a reference first among the averaged ones.
    periodic : bool

    Attributes
    ----------
    compiled : Fields
        The fields of the last plane.
    lower : (kept, values) or None
        For the maxima in the plane above, if it is on the same grid: which of them are above the nine values
        at and around the node in the last plane, and these values.
    sums : (averaged, rows, `SUMS`) array
        As of `asperity.stress.maxima.search_rows`, of the last plane.
    """

    def __init__(self, fields: Sequence[SoughtField], periodic: bool) -> None:
        self.fields, self._periodic = list(fields), periodic
        self.sums = np.empty((0, 0, SUMS))
        others = [number for number, field in enumerate(fields) if field.name != "von_mises"]
        self._von_mises = np.arange(min(others, default=len(self.fields)))
        averaged = np.cumsum([field.averaged for field in fields]) - 1
        self._averaged = np.where([field.averaged for field in fields], averaged, -1)
        self._kept = _KeptRoom()

    def start(
        self,
        plane: LinearPlane,
        above: LinearPlane | None,
        upper: Maxima | None,
        floor: float,
        reference: Array,
        taken: Array,
    ) -> None:
        """Begin a plane.

        Parameters
        ----------
        plane : LinearPlane
        above : LinearPlane or None
            The plane before it.
        upper : Maxima, optional
            Those in the plane above that may be peaks.
        floor : float
            Maxima at or below it are left out.
        reference, taken : arrays
            As of `asperity.stress.maxima.search_rows`.
        """
        real, rows = plane.dtype, plane.grid.shape[0]
        self._parts = plane.parts()
        compared = above is not None and above.grid == plane.grid
        self._above = above.parts() if above is not None and compared else self._parts
        self.compiled = Fields.of([field.compiled(plane) for field in self.fields], real)
        self._search = Search(
            self.compiled,
            self._von_mises,
            np.array([field.sought for field in self.fields]),
            self._averaged,
            real.type(floor),
            self._periodic,
            compared,
        )
        if upper is not None and compared:
            line = upper.nodes[0] * len(self.fields) + upper.field
            self._upper = upper_for(line, upper.nodes[1], upper.magnitude, rows * len(self.fields))
        else:
            nothing = np.empty(0, np.int64)
            self._upper = upper_for(nothing, nothing, np.empty(0, real), rows * len(self.fields))
        self._references = reference, taken
        self.sums = np.empty((int(self._averaged.max()) + 1, rows, SUMS))
        self._bands = bands_of(rows)
        self._rooms: list[Room | None] = [None] * len(self._bands)
        self._found: list[tuple[Array, ...]] = [() for _ in self._bands]

    def add_rows(self, band: int, first: int, last: int) -> None:
        """Search some rows that have been filled, the next ones of a band."""
        start, stop = self._bands[band]
        if first == start:
            self._rooms[band] = self._room(stop - start)
        room = self._rooms[band]
        assert room is not None
        self._search_rows(room, start, first, last, self.sums)
        if last == stop:
            self._found[band] = self._maxima_in(room)
            self._rooms[band] = None

    def finish(self) -> None:
        """Search the rows at the edges of the bands, when all have been filled."""
        rows = self._parts.values.shape[0]
        edges = [start for start, _ in self._bands]
        around = [(edge - 2, edge + 2) for edge in edges]
        if not self._periodic:
            around[0] = (-1, 2)
            edges.append(rows)
            around.append((rows - 2, rows + 1))
        nothing = np.empty((0, 0, SUMS))
        before, after = [], []
        for edge, (start, stop) in zip(edges, around, strict=True):
            room = self._room(stop - start)
            self._search_rows(room, start, start, stop, nothing)
            found = self._maxima_in(room)
            of_row_before = np.count_nonzero(found[1] != edge)
            before.append(tuple(array[:of_row_before] for array in found))
            after.append(tuple(array[of_row_before:] for array in found))
        if self._periodic:
            before.append(before[0])
        # By rising rows: of every band its first row, those between, and its last one.
        self._found = [*chain(*zip(after, self._found, before[1:], strict=False))]
        self.lower = (self._upper.kept, self._upper.values) if self._search.compared else None

    def maxima_above(self, floor: float) -> Maxima:
        """Maxima of the fields in the last plane of a magnitude above a floor, that of the search or higher.

        If the plane above is on the same grid, only those are left that exceed it.
        """
        arrays = [np.concatenate(part) for part in zip(*self._found, strict=True)]
        field, row, column, here = arrays[:4]
        found = Maxima(field, (row, column), here, arrays[4] if self._search.compared else None)
        high = found.magnitude > floor
        return found if high.all() else found.select(np.flatnonzero(high))

    def _search_rows(self, room: Room, start: int, first: int, last: int, sums: Array) -> None:
        both, rows = (self._parts, self._above), (start, first, last)
        search_rows(*both, self._search, self._upper, room, *rows, *self._references, sums)

    def _room(self, rows: int) -> Room:
        return self._kept.empty(len(self.fields), self._parts.columns, rows, self._parts.values.dtype)

    def _maxima_in(self, room: Room) -> tuple[Array, ...]:
        """Fields, rows and columns of the maxima that have been found, and the values around them."""
        found = [room.field, room.row, room.column, room.around]
        if self._search.compared:
            found.append(room.above)
        return tuple(array[: room.count[0]].copy() for array in found)
