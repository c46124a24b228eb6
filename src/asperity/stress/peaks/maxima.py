"""Maxima of fields above their neighbours in a plane, and their refinement between the nodes.

Of adjacent nodes of a plane with the same value, such as the two beside the mirror of a mirrored map, the
upper and then the left one counts as larger: whether one of them is the peak does not depend on rounding.

A quadratic through the values at and around a node gives position and value of the peak between the nodes.
Offsets are in grid spacings from the node.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from asperity.core.compiled import compiled
from asperity.core.parallel import KeptArrays
from asperity.core.types import Array
from asperity.stress.planes.fields import (
    BLOCK,
    LANES,
    PACKED,
    ROW_MARGIN,
    SUMS,
    PlaneFields,
    fill_rows,
    row_length,
    sum_row,
    value_at,
)

MIN_DETERMINANT = 1e-12
"""A smaller determinant of the second derivatives, over the product of those along the axes, is rounding."""

WORDS = 4
"""Words of eight flags that are looked at together."""


class Entries:
    """Arrays of the same length, an entry for every maximum; None for an array that is not known."""

    @property
    def size(self) -> int:
        """Number of entries."""
        return len(next(iter(vars(self).values())))

    def select(self, chosen: Array) -> Self:
        """Some of the entries."""
        return type(self)(*(None if array is None else array[chosen] for array in vars(self).values()))

    @classmethod
    def join(cls, parts: Iterable[Self]) -> Self:
        """All entries of several sets, in their order."""
        arrays = zip(*(vars(part).values() for part in parts), strict=True)
        return cls(*(None if each[0] is None else np.concatenate(each) for each in arrays))


@dataclass
class Maxima(Entries):
    """Maxima of fields of one plane over their neighbours in it; those of a field by rising rows and columns.

    Parameters
    ----------
    field : (maxima,) integer array
        Number of the field.
    row, column : (maxima,) integer arrays
        The nodes.
    here : (maxima, 3, 3) array
        Values at and around the nodes.
    above : (maxima, 3, 3) array or None
        Those in the plane above, if the maxima exceed them.
    """

    field: Array
    row: Array
    column: Array
    here: Array
    above: Array | None = None

    @property
    def magnitude(self) -> Array:
        """Magnitudes at the nodes."""
        return np.abs(self.here[:, 1, 1])


def maxima_in_rows(
    fields: PlaneFields,
    start: int,
    first: int,
    last: int,
    floor: float,
    sought: Array | None = None,
    above: PlaneFields | None = None,
    references: Array | None = None,
    sums: Array | None = None,
    kept: KeptArrays | None = None,
) -> Maxima:
    """Maxima in rows of a plane: nodes whose magnitude is above the floor and the 8 neighbours.

    Parameters
    ----------
    fields : PlaneFields
    start, first, last : int
        Rows from `first` to `last` − 1 are computed, those from `start` on have been, the last two into
        `kept`. All rows that now have both neighbours for the first time are searched.
    floor : float
    sought : (fields,) bool array, optional
        Fields whose maxima are sought, by default all.
    above : PlaneFields, optional
        Of the plane above, on the same grid: maxima that do not exceed it at their node are left out.
    references : (fields, ny, nx) array, optional
        Whole numbers, by which the first fields are multiplied.
    sums : (fields, ny, `SUMS`) array, optional
        Becomes, for the first fields and each computed row, the sum, the sum of squares and, in its place 3,
        that of products with the references; the largest value of all these rows stands in the first one.
    kept : KeptArrays, optional
        Memory of the last rows.
    """
    real, columns, count = fields.basis.values.dtype, fields.basis.columns, fields.formulas.kinds.size
    kept = KeptArrays() if kept is None else kept
    flags = kept.array("flags", (-(-columns // (8 * WORDS)) * 8 * WORDS,), bool)
    flags[columns:] = False
    most = count * (last - first) * (columns // 2 + 1)
    nodes = [kept.array(name, (most,), np.int32) for name in ("field", "row", "column")]
    found = (*nodes, kept.array("here", (most, 3, 3), real))
    memory = (
        kept.array("values", (count, 3, row_length(columns)), real),
        kept.array("shared", (5, BLOCK), real),
        (kept.array("largest", (count, LANES), real), kept.array("lanes", (3, LANES), real)),
        (flags, flags.view(np.uint64), kept.array("places", (columns // 2 + 1,), np.int32)),
    )
    number = _search_rows(
        (fields.basis, (fields if above is None else above).basis),
        fields.formulas,
        np.ones(count, bool) if sought is None else sought,
        (real.type(floor), fields.periodic, above is not None),
        (start, first, last),
        memory,
        np.empty((0, 1, 1), PACKED[real.name]) if references is None else references,
        np.empty((0, 0, SUMS)) if sums is None else sums,
        found,
    )
    return Maxima(*(array[:number].copy() for array in found))


@compiled
def _search_rows(
    planes: Any,
    formulas: Any,
    sought: Any,
    options: Any,
    rows: Any,
    memory: Any,
    references: Any,
    sums: Any,
    found: Any,
) -> int:
    """As `maxima_in_rows`, row by row, so that values stay in the cache; returns the number of maxima."""
    (basis, above), (floor, periodic, is_compared), (start, first, last) = planes, options, rows
    (values, shared, (largest, lanes), marks), (field, row, column, here) = memory, found
    places, columns, count = marks[2], basis.columns, 0
    largest[:] = -np.inf
    for j in range(first, last):
        fill_rows(basis, formulas, j, periodic, shared, values, j % 3, j % 3 + 1)
        for m in range(sums.shape[0]):
            line = values[m, j % 3, ROW_MARGIN : ROW_MARGIN + columns]
            sum_row(line, references, m, j, largest[m], lanes, sums[m, j])
        if j < start + 2:
            continue
        for m in range(sought.size):
            if not sought[m]:
                continue
            lines = values[m, (j - 2) % 3], values[m, (j - 1) % 3], values[m, j % 3]
            number = _mark(lines, columns, floor, marks)
            if is_compared:
                left = 0
                for n in range(number):  # without branches: the values of many nodes are fetched together
                    i = places[n]
                    kind, ratio, uniform = formulas.kinds[m], formulas.ratios[m], formulas.uniforms[m]
                    other = value_at(above, kind, ratio, uniform, j - 1, i)
                    places[left] = i
                    left += abs(lines[1][ROW_MARGIN + i]) > abs(other)
                number = left
            for n in range(number):
                field[count], row[count], column[count] = m, j - 1, places[n]
                for a in range(3):
                    for b in range(3):
                        here[count, a, b] = lines[a][ROW_MARGIN - 1 + places[n] + b]
                count += 1
    for m in range(sums.shape[0]):
        for i in range(LANES):
            sums[m, first, 2] = max(sums[m, first, 2], largest[m, i])
    return count


@compiled
def _mark(lines: Any, columns: int, floor: float, marks: Any) -> int:
    """Fill `places` with the maxima in the middle one of three lines; their number.

    The nearest four neighbours are compared first, in vectors; a word holds eight flags.
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


def refine_in_plane(values: Array) -> Array:
    """Magnitude and offsets y, x, (3, maxima), of the maxima of quadratics through 3 × 3 values.

    Parameters
    ----------
    values : (maxima, 3, 3) array
        Along y and x, the node in the middle. Where that is negative, the sign of all nine is changed.
    """
    sign = np.sign(values[:, 1, 1])
    centre, gradient, second = _derivatives(values, sign)
    nothing, one = np.zeros_like(centre), np.ones_like(centre)
    # A third axis on which nothing changes.
    gradient, second = [nothing, *gradient], [-one, nothing, nothing, *second]
    step = _steps_to_maxima(gradient, second, 1.0)
    return np.stack([centre + 0.5 * sum(g * s for g, s in zip(gradient, step, strict=True)), *step[1:]])


def refine_in_solid(above: Array, here: Array, below: Array, depths: tuple[float, ...]) -> Array:
    """Magnitude, depth and offsets y, x, (4, maxima), of the maxima of quadratics through 3 × 3 × 3 values.

    The quadratic is that of 19 of the 27 values: the mixed derivatives need no corners of the adjacent
    planes.

    Parameters
    ----------
    above, here, below : (maxima, 3, 3) arrays
        Of three planes, along y and x, the node in the middle of `here`. Where that is negative, the sign of
        all values is changed.
    depths : tuple of float
        Of the three planes, which may be unequally spaced.
    """
    up, down = depths[1] - depths[0], depths[2] - depths[1]
    weight_up, weight_down = -down / (up * (up + down)), up / (down * (up + down))
    unit = min(up, down)
    sign = np.sign(here[:, 1, 1])
    centre, (along_y, along_x), second = _derivatives(here, sign)
    over, (over_y, over_x), _ = _derivatives(above, sign)
    under, (under_y, under_x), _ = _derivatives(below, sign)
    # Derivatives along depth per `unit`, of the quadratics through three planes.
    along_z = unit * (weight_up * (over - centre) + weight_down * (under - centre))
    zy = unit * (weight_up * (over_y - along_y) + weight_down * (under_y - along_y))
    zx = unit * (weight_up * (over_x - along_x) + weight_down * (under_x - along_x))
    zz = 2 * (unit * unit) * ((over - centre) / up + (under - centre) / down) / (up + down)
    gradient = [along_z, along_y, along_x]
    step = _steps_to_maxima(gradient, [zz, zy, zx, *second], max(up, down) / unit)
    value = centre + 0.5 * sum(g * s for g, s in zip(gradient, step, strict=True))
    return np.stack([value, depths[1] + unit * step[0], *step[1:]])


def _derivatives(values: Array, sign: Array) -> tuple[Array, list[Array], list[Array]]:
    """Value at the middle of 3 × 3 values times a sign, slopes along y and x, and ∂²/∂y², ∂²/∂y∂x, ∂²/∂x²."""
    v = np.multiply(sign, values.transpose(1, 2, 0), dtype=float)
    centre, upper, lower, left, right = v[1, 1], v[0, 1], v[2, 1], v[1, 0], v[1, 2]
    mixed = (v[2, 2] - v[2, 0] - v[0, 2] + v[0, 0]) / 4
    slopes = [(lower - upper) / 2, (right - left) / 2]
    return centre, slopes, [lower - 2 * centre + upper, mixed, right - 2 * centre + left]


def _steps_to_maxima(gradient: list[Array], second: list[Array], reach: float) -> Array:
    """Newton's steps to the maxima of quadratics, (3, maxima).

    Where a quadratic has no maximum within `reach` along the first axis and one spacing along the others, the
    axis that gains most is refined alone, by at most half a spacing.

    Parameters
    ----------
    gradient : three arrays
    second : six arrays
        Second derivatives: the upper triangle of their matrix, row by row.
    reach : float
    """
    u, v, w = gradient
    a, b, c, d, e, f = second
    # The adjugate of the matrix, divided by the determinant below.
    aa, ab, ac = d * f - e * e, c * e - b * f, b * e - c * d
    bb, bc, cc = a * f - c * c, b * c - a * e, a * d - b * b
    determinant = a * aa + b * ab + c * ac
    # Sylvester's criterion: leading minors of alternating sign.
    negative = (np.abs(determinant) > MIN_DETERMINANT * np.abs(a * d * f)) & (a < 0) & (cc > 0)
    negative &= determinant < 0
    along = [aa * u + ab * v + ac * w, ab * u + bb * v + bc * w, ac * u + bc * v + cc * w]
    with np.errstate(all="ignore"):
        newton = -np.stack(along) / determinant
        alone = np.where(
            np.stack([a, d, f]) < 0, np.clip(-np.stack(gradient) / np.stack([a, d, f]), -0.5, 0.5), 0
        )
    most = np.argmax(np.abs(alone * gradient), axis=0)
    alone *= np.arange(3)[:, None] == most
    within = np.all(np.abs(newton) <= np.array([[reach], [1.0], [1.0]]), axis=0)
    return np.where(negative & within, newton, alone)
