"""Search of a plane for the maxima of its fields, and sums of its rows, while these are in the cache."""

from __future__ import annotations

import numpy as np

from asperity.core.parallel import KeptArrays
from asperity.core.types import Array
from asperity.stress.peaks.maxima import Maxima, mark, marked, maxima_in_rows
from asperity.stress.planes.fields import BLOCK, Fields, bands_of, fill_rows, row_length
from asperity.stress.statistics.covariance import SUMS, sum_rows


class PlaneSearch:
    """Computes, searches and sums the fields of a plane row by row, as its basis fields are transformed.

    Parameters
    ----------
    fields : Fields
    sought : (fields,) bool array
        Fields whose maxima are sought.
    floor : float
        Maxima of a magnitude at or below it are left out.
    summed : int
        Number of the first fields whose rows are summed.
    references : (fields, ny, nx) array
        Whole numbers, by which the first fields are multiplied.
    kept : KeptArrays
    above : Fields, optional
        Those of the plane above, if it is in memory and on the same grid: most maxima do not exceed it.

    Attributes
    ----------
    sums : (summed, ny, `SUMS`) array
        As of `asperity.stress.statistics.covariance.sum_rows`.
    """

    def __init__(
        self,
        fields: Fields,
        sought: Array,
        floor: float,
        summed: int,
        references: Array,
        kept: KeptArrays,
        above: Fields | None = None,
    ) -> None:
        self._kept = kept
        self.fields, self._sought, self._references, self._above = fields, sought, references, above
        self._real = fields.basis.values.dtype
        self._floor = self._real.type(floor)
        self._rows = fields.basis.values.shape[1]
        self._bands = bands_of(self._rows)
        self.sums = np.zeros((summed, self._rows, SUMS))
        self._strips: dict[int, tuple[Array, Array, Array]] = {}
        self._found: list[list[Maxima]] = [[] for _ in self._bands]

    def add_rows(self, band: int, first: int, last: int) -> None:
        """Add the next rows of a band, whose number is that of the first ones or, at the end, smaller."""
        (start, stop), columns = self._bands[band], self.fields.basis.columns
        begun = first > start
        if not begun:
            shape = self._sought.size, last - first + 2, row_length(columns)
            values = self._kept.array("values", shape, self._real)
            flags = self._kept.array("flags", (*shape[:2], -(-columns // 8) * 8), bool)
            flags[:, :, columns:] = False
            self._strips[band] = values, flags, self._kept.array("shared", (5, BLOCK), self._real)
        values, flags, shared = self._strips[band]
        fields = self.fields
        if begun:  # with the last two rows before these
            values[:, :2] = values[:, -2:]
        stop = 2 + last - first
        fill_rows(fields.basis, fields.formulas, first, fields.periodic, shared, values, 2, stop)
        # Called from here, not from a compiled loop: the order of its sums would be that of the caller.
        sum_rows(values, 2, stop, columns, first, self._references, shared[0], self.sums)
        lines = 1 if begun else 3, last - first + 1
        count = mark(
            values, lines[0], stop - 1, columns, self._floor, self._sought, flags, flags.view(np.uint64)
        )
        if count:
            self._found[band].append(
                marked(self.fields, values, flags, count, *lines, first - 2, self._above)
            )
        if last == stop:
            del self._strips[band]

    def maxima(self, floor: float) -> Maxima:
        """Maxima above a floor when all rows are added; those of a field by rising rows and columns."""
        edges = [(start - 1, start + 1) for start, _ in self._bands[1:]]
        around = [(0, 1), *edges, (self._rows - 1, self._rows)]
        between = [maxima_in_rows(self.fields, first, last, float(self._floor)) for first, last in around]
        parts = between[:1]
        for of_band, after in zip(self._found, between[1:], strict=True):
            parts += [*of_band, after]
        found = Maxima.join(parts)
        del parts, of_band
        self._found = []  # before another copy is made
        high = self._sought[found.field] & (found.magnitude > floor)
        return found if high.all() else found.select(np.flatnonzero(high))
