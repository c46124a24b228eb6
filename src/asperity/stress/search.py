"""Search of a plane for the maxima of its fields, and sums of its rows, while these are in the cache."""

from __future__ import annotations

import numpy as np

from asperity.core.parallel import KeptArrays
from asperity.core.types import Array
from asperity.stress.peaks.maxima import Maxima, maxima_in_rows
from asperity.stress.planes.fields import SUMS, PlaneFields, bands_of


class PlaneSearch:
    """Computes, searches and sums the fields of a plane row by row, as its basis fields are transformed.

    Parameters
    ----------
    fields : PlaneFields
    sought : (fields,) bool array
        Fields whose maxima are sought.
    floor : float
        Maxima of a magnitude at or below it are left out.
    summed : int
        Number of the first fields whose rows are summed.
    references : (fields, ny, nx) array
        Whole numbers, by which the first fields are multiplied.
    kept : KeptArrays
    above : PlaneFields, optional
        Those of the plane above, if it is in memory and on the same grid: most maxima do not exceed it.

    Attributes
    ----------
    sums : (summed, ny, `SUMS`) array
        As of `maxima_in_rows`.
    """

    def __init__(
        self,
        fields: PlaneFields,
        sought: Array,
        floor: float,
        summed: int,
        references: Array,
        kept: KeptArrays,
        above: PlaneFields | None = None,
    ) -> None:
        self._kept = kept
        self.fields, self._sought, self._references, self._above = fields, sought, references, above
        self._floor, self._rows = floor, fields.basis.values.shape[1]
        self._bands = bands_of(self._rows)
        self.sums = np.zeros((summed, self._rows, SUMS))
        self._found: list[list[Maxima]] = [[] for _ in self._bands]

    def add_rows(self, band: int, first: int, last: int) -> None:
        """Add the next rows of a band."""
        found = maxima_in_rows(
            self.fields,
            self._bands[band][0],
            first,
            last,
            self._floor,
            self._sought,
            self._above,
            self._references,
            self.sums,
            self._kept,
        )
        self._found[band].append(found)

    def maxima(self, floor: float) -> Maxima:
        """Maxima above a floor when all rows are added; those of a field by rising rows and columns."""
        edges = [(start - 1, start + 1) for start, _ in self._bands[1:]]
        around = [(0, 1), *edges, (self._rows - 1, self._rows)]
        between = [
            maxima_in_rows(self.fields, first - 1, first - 1, last + 1, self._floor) for first, last in around
        ]
        parts = between[:1]
        for of_band, after in zip(self._found, between[1:], strict=True):
            parts += [*of_band, after]
        found = Maxima.join(parts)
        del parts, of_band
        self._found = []  # before another copy is made
        high = self._sought[found.field] & (found.magnitude > floor)
        return found if high.all() else found.select(np.flatnonzero(high))
