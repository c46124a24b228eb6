"""Search of a plane for the maxima of its fields, and sums of its rows, while these are in the cache.

Of adjacent nodes of a plane with the same value the upper and then the left one is taken as larger, so that
the choice of the peak does not depend on rounding. A node of a mirrored map is taken before its mirror image.
"""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from asperity.core.compiled import compiled
from asperity.core.parallel import KeptArrays
from asperity.core.types import Array
from asperity.stress.peaks.maxima import Entries, Maxima
from asperity.stress.planes.fields import (
    BLOCK,
    LANES,
    MIRRORED,
    PACKED,
    ROW_MARGIN,
    SUMS,
    PlaneFields,
    bands_of,
    exceeds_around,
    fill_rows,
    row_length,
    rows_at_once,
    strips_of,
    sum_row,
    value_at,
)

WORDS = 4
"""Words that are tested together; a word holds the flags of eight nodes."""


Kind = TypeVar("Kind", bound=Entries)


@dataclass
class Lower(Entries):
    """Values in a plane at and around candidates of the plane above that exceed them.

    Parameters
    ----------
    number : (candidates,) integer array
        Rising numbers of the candidates.
    values : (candidates, 3, 3) array
    """

    number: Array
    values: Array


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
    references : (fields, ny, nx) array, optional
        Whole numbers, by which the first fields are multiplied.
    kept : KeptArrays, optional
    above : PlaneFields, optional
        Fields of the plane above, if it is in memory and on the same grid: maxima that do not exceed it are
        left out.
    candidates : Maxima, optional
        Maxima of the plane above, by rising rows, if it is on the same grid: they are compared with this
        plane.

    Attributes
    ----------
    sums : (summed, ny, `SUMS`) array
        For each row of the first fields the sum, the sum of squares and, in its place 3, the sum of products
        with the references; the largest values of some rows stand in the first of them, in its place 2.
    """

    def __init__(
        self,
        fields: PlaneFields,
        sought: Array,
        floor: float,
        summed: int = 0,
        references: Array | None = None,
        kept: KeptArrays | None = None,
        above: PlaneFields | None = None,
        candidates: Maxima | None = None,
    ) -> None:
        real, rows = fields.basis.values.dtype, fields.basis.values.shape[1]
        self._rows = rows
        self.fields, self._sought = fields, sought
        self._planes = fields.basis, (fields if above is None else above).basis
        self._options = real.type(floor), fields.edges, above is not None
        if candidates is None:
            nothing = np.empty(0, np.int32)
            candidates = Maxima(nothing, nothing, nothing, np.empty((0, 3, 3), real))
        first = np.searchsorted(candidates.row, np.arange(rows + 1))
        self._candidates: tuple[Array, ...] = first, candidates.field, candidates.column, candidates.magnitude
        self._references = np.empty((0, 1, 1), PACKED[real.name]) if references is None else references
        self.sums = np.zeros((summed, rows, SUMS))
        self._kept = KeptArrays() if kept is None else kept
        self._bands = bands_of(rows)
        self._is_one_strip = strips_of(self._bands[0], fields.basis.columns) == [(0, rows)]
        self._memory: dict[int, tuple[Any, ...]] = {}
        self._found: list[list[tuple[Maxima, Lower]]] = [[] for _ in self._bands]
        self._maxima: list[Maxima] = []

    def add_rows(self, band: int, first: int, last: int) -> None:
        """Add the next rows of a band, one of `strips_of`."""
        # A whole plane has its neighbours beyond the edges.
        rows = (-1, -1, last + 1) if self._is_one_strip else (self._bands[band][0], first, last)
        self._found[band].append(self._search(rows, self.sums))

    def lower(self) -> Lower:
        """The candidates that exceed this plane, when all rows are added, and forget the candidates."""
        parts = self._found[0]
        if not self._is_one_strip:
            edges = [(start - 1, start + 1) for start, _ in self._bands[1:]]
            around, no_sums = [(0, 1), *edges, (self._rows - 1, self._rows)], self.sums[:0]
            between = [self._search((first - 1, first - 1, last + 1), no_sums) for first, last in around]
            parts = between[:1]
            for of_band, after in zip(self._found, between[1:], strict=True):
                parts += [*of_band, after]
        self._candidates, self._found = (), []
        self._maxima = [found for found, _ in parts]
        return _joined(Lower, [vars(found) for _, found in parts])

    def maxima(self, floor: float) -> Maxima:
        """Maxima above a floor, of each field in the order of rising rows and columns."""
        if self._found:
            self.lower()
        high = np.concatenate([found.magnitude for found in self._maxima]) > floor
        parts, self._maxima = [vars(found) for found in self._maxima], []
        return _joined(Maxima, parts, slice(None) if high.all() else np.flatnonzero(high))

    def _arrays(self) -> tuple[Any, ...]:
        """Memory of the present thread, in which `rows_at_once` are searched."""
        array, real, columns = self._kept.array, self._options[0].dtype, self.fields.basis.columns
        count = self._sought.size
        most = count * rows_at_once(columns) * (columns // 2 + 1)
        flags = array("flags", (-(-columns // (8 * WORDS)) * 8 * WORDS,), bool)
        flags[columns:] = False
        return (
            (array("values", (count, 3, row_length(columns)), real), np.zeros(row_length(columns), real)),
            array("shared", (5, BLOCK), real),
            (array("largest", (count, LANES), real), array("lanes", (3, LANES), real)),
            (flags, flags.view(np.uint64), array("places", (columns // 2 + 1,), np.int32)),
            (
                *(array(name, (most,), np.int32) for name in ("field", "row", "column")),
                *(array(name, (most, 3, 3), real) for name in ("here", "above")),
            ),
            (array("number", (most,), np.int64), array("below", (most, 3, 3), real)),
        )

    def _search(self, rows: tuple[int, int, int], sums: Array) -> tuple[Maxima, Lower]:
        """Maxima in some rows, and the candidates in these that exceed them.

        `rows` are the first row of which the fields, if they are needed, are in the memory of this thread,
        the first and the last + 1 that are computed. All rows that have both neighbours for the first time
        are searched.
        """
        thread = threading.get_ident()
        if thread not in self._memory:
            self._memory[thread] = self._arrays()
        *_, (*found, above), exceeding = self._memory[thread]
        is_compared = self._options[2]
        count, number = _search_rows(
            self._planes,
            self.fields.formulas,
            self._sought,
            self._options,
            rows,
            self._candidates,
            self._memory[thread],
            (self._references, sums),
        )
        maxima = Maxima(*(array[:count].copy() for array in found))
        maxima.above = above[:count].copy() if is_compared else None
        return maxima, Lower(*(array[:number].copy() for array in exceeding))


def _joined(kind: type[Kind], parts: list[dict[str, Any]], chosen: Any = slice(None)) -> Kind:
    """Some entries of several sets, which lose their arrays one by one: two copies would take memory."""
    joined = {}
    for name in list(parts[0]):
        arrays = [part.pop(name) for part in parts]
        joined[name] = None if arrays[0] is None else np.concatenate(arrays)[chosen]
    return kind(**joined)


@compiled
def _search_rows(
    planes: Any,
    formulas: Any,
    sought: Any,
    options: Any,
    rows: Any,
    candidates: Any,
    memory: Any,
    summed: Any,
) -> tuple[int, int]:
    """As `PlaneSearch._search`, row by row, so that values stay in the cache; returns the numbers of both."""
    (basis, above), (floor, edges, is_compared), (start, first, last) = planes, options, rows
    references, sums = summed
    first_candidate, candidate_field, candidate_column, candidate_magnitude = candidates
    (values, nothing), shared, (largest, lanes), marks, (field, row, column, here, over), (number, below) = (
        memory
    )
    places, columns, count, exceeding = marks[2], basis.columns, 0, 0
    largest[:] = -np.inf
    for j in range(first, last):
        fill_rows(basis, formulas, j, edges, shared, values, j % 3, j % 3 + 1)
        for m in range(sums.shape[0] if 0 <= j < basis.values.shape[1] else 0):
            line = values[m, j % 3, ROW_MARGIN : ROW_MARGIN + columns]
            sum_row(line, references, m, j, largest[m], lanes, sums[m, j])
        if j < start + 2:
            continue
        for m in range(sought.size):
            if not sought[m]:
                continue
            lines = values[m, (j - 2) % 3], values[m, (j - 1) % 3], values[m, j % 3]
            formula = formulas.kinds[m], formulas.ratios[m], formulas.uniforms[m]
            left_image, above_line = lines[1][ROW_MARGIN - 1], lines[0]
            if edges[0] == MIRRORED:  # no node is below its mirror images above and to the left
                lines[1][ROW_MARGIN - 1] = 0
                above_line = nothing if j == 1 else above_line
            marked = _mark((above_line, lines[1], lines[2]), columns, floor, marks)
            lines[1][ROW_MARGIN - 1] = left_image
            if is_compared:
                left = 0
                for n in range(marked):  # without branches: the values of many nodes are fetched together
                    i = places[n]
                    other = value_at(above, *formula, j - 1, i)
                    places[left] = i
                    left += abs(lines[1][ROW_MARGIN + i]) > abs(other)
                marked = left
            for n in range(marked):
                field[count], row[count], column[count] = m, j - 1, places[n]
                for a in range(3):
                    for b in range(3):
                        here[count, a, b] = lines[a][ROW_MARGIN - 1 + places[n] + b]
                is_above = True
                if is_compared:
                    size = abs(here[count, 1, 1])
                    is_above = exceeds_around(above, formula, j - 1, places[n], edges, size, over[count])
                count += is_above
        for n in range(first_candidate[j - 1], first_candidate[j]):
            m, is_above = candidate_field[n], True
            for a in range(3):
                for b in range(3):
                    value = values[m, (j - 2 + a) % 3, ROW_MARGIN - 1 + candidate_column[n] + b]
                    below[exceeding, a, b] = value
                    is_above &= candidate_magnitude[n] > abs(value)
            number[exceeding] = n
            exceeding += is_above
    for m in range(sums.shape[0]):
        for i in range(LANES):
            sums[m, max(first, 0), 2] = max(sums[m, max(first, 0), 2], largest[m, i])
    return count, exceeding


@compiled
def _mark(lines: Any, columns: int, floor: float, marks: Any) -> int:
    """Fill `places` with the maxima in the middle one of three lines; their number.

    The nearest four neighbours are compared first, in vectors.
    """
    (above, here, below), (flags, words, places) = lines, marks
    first, last = ROW_MARGIN - 1, ROW_MARGIN + columns + 1
    above, here, below, line = above[first:last], here[first:last], below[first:last], flags[:columns]
    for i in range(line.size):
        centre = abs(here[i + 1])
        line[i] = (
            (centre > floor)
            & (centre > abs(above[i + 1]))
            & (centre > abs(here[i]))
            & (centre >= abs(here[i + 2]))
            & (centre >= abs(below[i + 1]))
        )
    count = 0
    for w in range(0, words.size, WORDS):
        if not (words[w] | words[w + 1] | words[w + 2] | words[w + 3]):
            continue
        for i in range(8 * w, 8 * (w + WORDS)):
            if flags[i]:
                centre = abs(here[i + 1])
                places[count] = i
                count += (
                    (centre > abs(above[i]))
                    & (centre > abs(above[i + 2]))
                    & (centre >= abs(below[i]))
                    & (centre >= abs(below[i + 2]))
                )
    return count
