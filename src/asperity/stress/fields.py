"""Compiled formulas of the fields of a plane from the linear parts A and B of its stress components.

A field is computed row by row for all nodes, at single nodes, or between the nodes of a plane from
interpolated parts. All three use one formula in one order of operations, so that the results have the same
bits, in the precision of the plane.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from asperity.compiled import compiled, inlined, sums_without_nan
from asperity.elasticity.layer import COMPONENTS
from asperity.intrinsics import fetch
from asperity.machine_code import discard_outdated
from asperity.stress.principal import LARGEST_SHEAR, PRINCIPAL_1, PRINCIPAL_2, PRINCIPAL_3, principal_stresses
from asperity.types import Array

KINDS = {
    **{name: number for number, name in enumerate(COMPONENTS)},
    "von_mises": 6,
    "hydrostatic": 7,
    "largest_shear": 8 + LARGEST_SHEAR,
    "principal_1": 8 + PRINCIPAL_1,
    "principal_2": 8 + PRINCIPAL_2,
    "principal_3": 8 + PRINCIPAL_3,
}
"""Name of a field → its number in the compiled functions."""

_XX, _YY, _ZZ, _YZ, _XZ, _XY = range(6)
_VON_MISES, _HYDROSTATIC, _MEASURES = 6, 7, 8
_SLOPE_XX, _SLOPE_YY, _SLOPE_XY = 6, 7, 8

PLACES = 9
"""Entries of `Parts.place`."""


class Parts(NamedTuple):
    """Linear parts of the stress of a plane.

    Parameters
    ----------
    values : (rows, parts, at least `columns`) array
        A row may be longer than the plane.
    place : (`PLACES`,) integer array
        Where in a row of `values` A_xx, A_yy, A_zz, A_yz, A_xz, A_xy, B_xx, B_yy and B_xy are; −1 for one
        that is not needed, or for B_yy, which follows from A_xx + A_yy + A_zz = B_xx + B_yy but for the
        uniform mode. Where A is the stress itself, any of its components stands for B.
    columns : int
    mean_pressure : float
        Minus the uniform part of A_zz, in the precision of `values`.
    """

    values: Any
    place: Any
    columns: int
    mean_pressure: Any


class Field(NamedTuple):
    """One field of a plane.

    Parameters
    ----------
    kind : int
        Of `KINDS`.
    ratio : float
        Poisson's ratio ν; 0 where A is the stress itself. In the precision of the plane.
    uniform : float
        Uniform part of σ_xx and σ_yy, in the precision of the plane.
    """

    kind: int
    ratio: Any
    uniform: Any


class Fields(NamedTuple):
    """Several fields of a plane: arrays of what a `Field` consists of."""

    kinds: Any
    ratios: Any
    uniforms: Any

    @classmethod
    def of(cls, fields: Sequence[Field], real: np.dtype[Any]) -> Fields:
        """The fields of a plane in this precision."""
        kinds, ratios, uniforms = zip(*fields, strict=True)
        return cls(np.array(kinds), np.array(ratios, real), np.array(uniforms, real))


@inlined
def field_at(fields: Any, number: int) -> Any:
    """One of several fields."""
    return Field(fields.kinds[number], fields.ratios[number], fields.uniforms[number])


@inlined
def _von_mises(first: float, second: float, xy: float, across: float) -> float:
    """The von Mises stress from σ_xx − σ_yy, σ_yy − σ_zz, σ_xy and σ_yz² + σ_xz²."""
    shear = xy * xy + across
    # A number in single precision leaves the precision of the others as it is.
    return np.sqrt(first * (first + second) + second * second + np.float32(3) * shear)


@inlined
def _hydrostatic(trace: float, ratio: float, uniform: float, mean_pressure: float) -> float:
    """A third of the trace of A + ν B; that of B is the trace of A without its uniform part."""
    return (trace + ratio * (trace + mean_pressure) + uniform + uniform) / 3.0


@compiled
def _measure(kind: int, x: float, y: float, z: float, yz: float, xz: float, xy: float) -> float:
    """The largest shear stress or a principal stress."""
    first, second, third = principal_stresses(float(x), float(y), float(z), float(yz), float(xz), float(xy))
    if kind == _MEASURES + LARGEST_SHEAR:
        return 0.5 * (first - third)
    if kind == _MEASURES + PRINCIPAL_1:
        return first
    return second if kind == _MEASURES + PRINCIPAL_2 else third


@compiled
def fill_row(parts: Any, field: Any, row: int, out: Any) -> None:
    """Fill `out`, at least (columns,), with one row of a field other than the von Mises stress."""
    values, place, columns, mean = parts
    kind, ratio, uniform = field
    if kind < _VON_MISES and (kind != _YY or place[_SLOPE_YY] >= 0):
        a = values[row, place[kind]]
        if kind in (_ZZ, _YZ, _XZ):
            for i in range(columns):
                out[i] = a[i]
            return
        b = values[row, place[_SLOPE_XY if kind == _XY else _SLOPE_XX + kind]]
        added = uniform - uniform if kind == _XY else uniform
        for i in range(columns):
            out[i] = a[i] + ratio * b[i] + added
        return
    xx, yy, zz = values[row, place[_XX]], values[row, place[_YY]], values[row, place[_ZZ]]
    if kind == _HYDROSTATIC:
        for i in range(columns):
            out[i] = _hydrostatic(xx[i] + yy[i] + zz[i], ratio, uniform, mean)
        return
    slope = values[row, place[_SLOPE_XX]]
    if kind == _YY:
        for i in range(columns):
            out[i] = yy[i] + ratio * (xx[i] + yy[i] + zz[i] + mean - slope[i]) + uniform
        return
    yz, xz, xy = values[row, place[_YZ]], values[row, place[_XZ]], values[row, place[_XY]]
    slope_xy = values[row, place[_SLOPE_XY]]
    for i in range(columns):
        slope_yy = xx[i] + yy[i] + zz[i] + mean - slope[i]
        x, y = xx[i] + ratio * slope[i] + uniform, yy[i] + ratio * slope_yy + uniform
        out[i] = _measure(kind, x, y, zz[i], yz[i], xz[i], xy[i] + ratio * slope_xy[i])


SHARED = (5, 528)
"""Numbers of a node that all its von Mises stresses share, and nodes of which they fit into the cache."""


@compiled
def fill_von_mises(
    parts: Any, row: int, ratios: Any, uniforms: Any, places: Any, shared: Any, out: Any, line: int, at: int
) -> None:
    """Fill one row of several von Mises stresses.

    Parameters
    ----------
    parts : Parts
    row : int
    ratios, uniforms : (fields,) arrays in the precision of the plane
    places : integer array
        Which fields are computed.
    shared : `SHARED` array in the precision of the plane
        Room for what they share.
    out : (fields, lines, numbers) array
        Field m is written to ``out[m, line, at:]``.
    line, at : int
    """
    values, place, columns, mean = parts
    all_xx, all_yy, all_zz = values[row, place[_XX]], values[row, place[_YY]], values[row, place[_ZZ]]
    all_yz, all_xz, all_xy = values[row, place[_YZ]], values[row, place[_XZ]], values[row, place[_XY]]
    all_slope, all_slope_xy = values[row, place[_SLOPE_XX]], values[row, place[_SLOPE_XY]]
    first, second, slope_yy, across, slope_first = shared[0], shared[1], shared[2], shared[3], shared[4]
    for start in range(0, columns, shared.shape[1]):
        stop = min(start + shared.shape[1], columns)
        xx, yy, zz, slope = all_xx[start:stop], all_yy[start:stop], all_zz[start:stop], all_slope[start:stop]
        yz, xz, xy, slope_xy = (
            all_yz[start:stop],
            all_xz[start:stop],
            all_xy[start:stop],
            all_slope_xy[start:stop],
        )
        for i in range(xx.size):
            slope_yy[i] = xx[i] + yy[i] + zz[i] + mean - slope[i]
        for i in range(xx.size):
            slope_first[i] = slope[i] - slope_yy[i]
        for i in range(xx.size):
            first[i] = xx[i] - yy[i]
        for i in range(xx.size):
            second[i] = yy[i] - zz[i]
        for i in range(xx.size):
            across[i] = yz[i] * yz[i] + xz[i] * xz[i]
        for m in places:
            ratio, uniform, field = ratios[m], uniforms[m], out[m, line, at + start : at + stop]
            for i in range(field.size):
                field[i] = _von_mises(
                    first[i] + ratio * slope_first[i],
                    second[i] + ratio * slope_yy[i] + uniform,
                    xy[i] + ratio * slope_xy[i],
                    across[i],
                )


@compiled
def fill_fields(
    parts: Any, kind: int, ratios: Any, uniforms: Any, places: Any, shared: Any, out: Any
) -> None:
    """Fill some of the arrays of `out`, (fields, rows, columns), with fields of one kind.

    Arguments are those of `fill_von_mises`, and `kind` as of `Field`.
    """
    for row in range(out.shape[1]):
        if kind == _VON_MISES:
            fill_von_mises(
                parts, row, ratios, uniforms, places, shared, out, row, out.shape[2] - parts.columns
            )
        else:
            for m in places:
                fill_row(parts, Field(kind, ratios[m], uniforms[m]), row, out[m, row])


def needed_parts(kind: int, place: Array) -> Array:
    """True for every entry of `Parts.place` on which a field depends."""
    needed = np.zeros(PLACES, bool)
    if kind < _VON_MISES and (kind != _YY or place[_SLOPE_YY] >= 0):
        needed[kind] = True
        if kind not in (_ZZ, _YZ, _XZ):
            needed[_SLOPE_XY if kind == _XY else _SLOPE_XX + kind] = True
    elif kind in (_YY, _HYDROSTATIC):
        needed[[_XX, _YY, _ZZ]] = True
        needed[_SLOPE_XX] = kind == _YY
    else:
        needed[:] = True
        needed[_SLOPE_YY] = False
    return needed


@inlined
def value_at(parts: Any, field: Any, row: Any, column: Any) -> float:
    """A field at one node."""
    values, place, _, mean = parts
    kind, ratio, uniform = field
    if kind < _VON_MISES and (kind != _YY or place[_SLOPE_YY] >= 0):
        value = values[row, place[kind], column]
        if kind in (_ZZ, _YZ, _XZ):
            return value
        slope = values[row, place[_SLOPE_XY if kind == _XY else _SLOPE_XX + kind], column]
        return value + ratio * slope + (uniform - uniform if kind == _XY else uniform)
    xx = values[row, place[_XX], column]
    yy = values[row, place[_YY], column]
    zz = values[row, place[_ZZ], column]
    if kind == _HYDROSTATIC:
        return _hydrostatic(xx + yy + zz, ratio, uniform, mean)
    slope = values[row, place[_SLOPE_XX], column]
    slope_yy = xx + yy + zz + mean - slope
    y = yy + ratio * slope_yy + uniform
    if kind == _YY:
        return y
    x = xx + ratio * slope + uniform
    xy = values[row, place[_XY], column] + ratio * values[row, place[_SLOPE_XY], column]
    yz, xz = values[row, place[_YZ], column], values[row, place[_XZ], column]
    if kind == _VON_MISES:
        first, second = xx - yy + ratio * (slope - slope_yy), yy - zz + ratio * slope_yy + uniform
        return _von_mises(first, second, xy, yz * yz + xz * xz)
    return _measure(kind, x, y, zz, yz, xz, xy)


@inlined
def fetch_at(parts: Any, field: Any, row: Any, column: Any) -> None:
    """Have the processor fetch what `value_at` will read, without waiting for it."""
    values, place = parts.values, parts.place
    kind = field.kind
    if kind < _VON_MISES and (kind != _YY or place[_SLOPE_YY] >= 0):
        fetch(values, row, place[kind], column)
        if kind not in (_ZZ, _YZ, _XZ):
            fetch(values, row, place[_SLOPE_XY if kind == _XY else _SLOPE_XX + kind], column)
        return
    for part in range(values.shape[1]):
        fetch(values, row, part, column)


@compiled
def pack(values: Any, factor: float, out: Any) -> None:
    """Fill an array of 16-bit integers with values ≥ 0 times a factor, rounded."""
    for j in range(values.shape[0]):
        for i in range(values.shape[1]):
            out[j, i] = np.uint16(np.int32(values[j, i] * factor + 0.5))


@sums_without_nan
def moments(one: Any, two: Any) -> tuple[float, float, float]:
    """Means of two fields and of their product, summed row by row."""
    mean_one = mean_two = product = 0.0
    for j in range(one.shape[0]):
        row_one = row_two = row_product = 0.0
        for i in range(one.shape[1]):
            value_one, value_two = float(one[j, i]), float(two[j, i])
            row_one += value_one
            row_two += value_two
            row_product += value_one * value_two
        mean_one += row_one
        mean_two += row_two
        product += row_product
    return mean_one / one.size, mean_two / one.size, product / one.size


discard_outdated(__name__)
