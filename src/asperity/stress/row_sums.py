"""Compiled sums over one row of a field."""

from __future__ import annotations

from typing import Any

from asperity.compiled import sums_without_nan

_BLOCK = 1024
"""Numbers that are summed in their own precision."""


@sums_without_nan
def sum_row(
    values: Any,
    bits: Any,
    at: int,
    columns: int,
    row: int,
    reference: Any,
    m: int,
    room: Any,
    out: Any,
) -> None:
    """Sum one row of a field.

    Parameters
    ----------
    values : array
        The row begins at its place `at`, and the first place is room for one number.
    bits : the same as integers
    at, columns, row : int
    reference : (fields, rows / step, columns / step) array
        Fields with which this one is compared at every `step`-th node.
    m : int
        Which of these it is compared with, if there are so many.
    room : (at least columns / step,) array
    out : (5,) array
        Becomes the sum of the row, of its squares, its largest value, and over the compared nodes the sum of
        the field and of its product with the reference.
    """
    here = values[at:]
    out[0], out[1] = _sums(here, here, columns)
    bits[0] = _largest(bits[at:], columns)
    out[2] = values[0]
    out[3] = out[4] = 0.0
    if m >= reference.shape[0]:
        return
    step = columns // reference.shape[2]
    if row % step:
        return
    other = reference[m, row // step]
    if step == 2:
        for i in range(other.size):
            room[i] = here[2 * i]
        out[3], out[4] = _sums(room, other, other.size)
    else:
        out[3], out[4] = _sums(here, other, other.size)


@sums_without_nan
def _sums(values: Any, others: Any, count: int) -> tuple[float, float]:
    """Sums of some values and of their products with others: in blocks in their own precision."""
    total = product = 0.0
    for first in range(0, count, _BLOCK):
        last = min(first + _BLOCK, count)
        some, same = values[first:last], others[first:last]
        part = here = values[0] - values[0]
        for i in range(last - first):
            here += some[i]
            part += some[i] * same[i]
        total += here
        product += part
    return total, product


@sums_without_nan
def _largest(bits: Any, count: int) -> int:
    """Bits of the largest of some values ≥ 0, from their bits, which are in the same order.

    Loops that compare integers are vectorised, those that compare floating-point numbers are not.
    """
    largest = bits[0]
    for i in range(count):
        largest = max(largest, bits[i])
    return largest
