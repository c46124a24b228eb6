"""Compiled sums over one row of a field, and copies of it."""

from __future__ import annotations

from typing import Any

from asperity.compiled import compiled, inlined_sums_without_nan
from asperity.intrinsics import every_second
from asperity.machine_code import discard_outdated

_BLOCK = 1024
"""Numbers that are summed in their own precision."""


@inlined_sums_without_nan
def sum_row(
    values: Any,
    bits: Any,
    at: int,
    columns: int,
    row: int,
    reference: Any,
    m: int,
    out: Any,
) -> None:
    """Sum one row of a field ≥ 0, or of any field whose largest value is not asked for.

    Parameters
    ----------
    values : array
        The row begins at its place `at`, and the first place is room for one number.
    bits : the same as integers
    at, columns, row : int
    reference : (fields, rows / step, columns / step) array
        Fields with which this one is compared at every `step`-th node, with a step of 1 or 2.
    m : int
        Which of these it is compared with, if there are so many.
    out : (5,) array
        Becomes the sum of the row, of its squares, its largest value, and over the compared nodes the sum of
        the field and of its product with the reference.
    """
    here = values[at:]
    out[0], out[1], bits[0] = _sums(here, bits[at:], columns)
    out[2] = values[0]
    out[3] = out[4] = 0.0
    if m >= reference.shape[0]:
        return
    step = columns // reference.shape[2]
    if row % step == 0:
        out[3], out[4] = _products(here, reference[m, row // step], step)


@compiled
def take_row(values: Any, at: int, columns: int, row: int, out: Any, m: int) -> None:
    """Write one row of a field, or every second value of every second row, to its place.

    Parameters
    ----------
    values, at, columns, row
        As of `sum_row`.
    out : (fields, rows / step, columns / step) array
    m : int
        Which of the fields of `out` it is, if there are so many.
    """
    if m >= out.shape[0]:
        return
    here, step = values[at:], columns // out.shape[2]
    if row % step:
        return
    line = out[m, row // step]
    if step == 1:
        for i in range(line.size):
            line[i] = here[i]
    else:
        for i in range(line.size):
            line[i] = every_second(here, i)


@inlined_sums_without_nan
def _sums(values: Any, bits: Any, count: int) -> tuple[float, float, int]:
    """Sums of some values and of their squares, and the bits of the largest.

    The bits of numbers ≥ 0 are in the order of the numbers. Comparisons of integers are turned into
    operations on vectors, those of floating-point numbers are not.
    """
    total = squares = 0.0
    largest = bits[0]
    for first in range(0, count, _BLOCK):
        last = min(first + _BLOCK, count)
        some, their_bits = values[first:last], bits[first:last]
        part = square = values[0] - values[0]
        for i in range(last - first):
            part += some[i]
            square += some[i] * some[i]
            largest = max(largest, their_bits[i])
        total += part
        squares += square
    return total, squares, largest


@inlined_sums_without_nan
def _products(values: Any, others: Any, step: int) -> tuple[float, float]:
    """Sums of every first or second of some values, and of their products with others."""
    total = products = 0.0
    for first in range(0, others.size, _BLOCK):
        last = min(first + _BLOCK, others.size)
        some, other = values[step * first :], others[first:last]
        part = product = values[0] - values[0]
        if step == 1:
            for i in range(last - first):
                part += some[i]
                product += some[i] * other[i]
        else:
            for i in range(last - first):
                value = every_second(some, i)
                part += value
                product += value * other[i]
        total += part
        products += product
    return total, products


discard_outdated(__name__)
