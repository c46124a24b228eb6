"""Compiled loops over modes: spectra of the linear parts of the stress in one plane.

Arrays that belong together are passed as named tuples. The arrays may be in single or double precision.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from asperity.compiled import compiled, fused, fused_inlined
from asperity.elasticity.kernels import half_space_stresses
from asperity.elasticity.layer import COMPONENTS
from asperity.machine_code import discard_outdated

_XX, _YY, _ZZ, _YZ, _XZ, _XY = (COMPONENTS.index(name) for name in ("xx", "yy", "zz", "yz", "xz", "xy"))


class PlaneKernels(NamedTuple):
    """Kernels Z, L and T of `Layer.grid_kernels` at one depth, (ny // 2 + 1, nx // 2 + 1) arrays."""

    normal: Any
    longitudinal: Any
    shear: Any


class TractionKernels(NamedTuple):
    """Kernels N, M, X, P and Q of `Layer.grid_shear_kernels` at one depth, arrays as in `PlaneKernels`."""

    normal: Any
    longitudinal: Any
    shear: Any
    transverse: Any
    in_plane: Any


class Wavevectors(NamedTuple):
    """Components of the wavevectors of a grid, those of odd factors with the Nyquist mode zero (`Grid`)."""

    qx: Any
    qy: Any
    odd_qx: Any
    odd_qy: Any


@compiled
def mode_stress(
    component: int, a: float, b: float, pressure: Any, kernels: Any, wavevectors: Any, first: int, out: Any
) -> None:
    """Fill `out` with some columns of the coefficients of a A + b B of one stress component.

    Parameters
    ----------
    component : int
        Its place in `COMPONENTS`.
    a, b : float
        The uniform mode is that of a A_zz; it is zero for all other components.
    pressure : (ny, nx // 2 + 1) complex array
        Coefficients of the contact pressure.
    kernels : PlaneKernels
    wavevectors : Wavevectors
    first : int
        Column of the grid that is the first of `out`.
    out : (ny, columns) complex array
    """
    normal, longitudinal, shear = kernels
    qx, qy, odd_qx, odd_qy = wavevectors
    rows, columns = out.shape
    for j in range(rows):
        mirrored = min(j, rows - j)
        for n in range(columns):
            i = first + n
            square = qx[i] * qx[i] + qy[j] * qy[j]
            if square == 0.0:
                out[j, n] = -a * pressure[j, i] if component == _ZZ else 0.0
                continue
            z, along, p = normal[mirrored, i], longitudinal[mirrored, i], pressure[j, i]
            if component in (_YZ, _XZ):
                odd = odd_qy[j] if component == _YZ else odd_qx[i]
                factor = a * odd * shear[mirrored, i] / np.sqrt(square)
                out[j, n] = complex(factor * p.imag, -factor * p.real)
                continue
            if component == _ZZ:
                factor = a * z
            elif component == _XY:
                factor = odd_qx[i] * odd_qy[j] * (a * along - b * (z + along)) / square
            else:
                own, other = (qx[i], qy[j]) if component == _XX else (qy[j], qx[i])
                factor = (a * own * own * along + b * other * other * (z + along)) / square
            out[j, n] = complex(-factor * p.real, -factor * p.imag)


@compiled
def add_sliding_stress(
    component: int,
    a: float,
    b: float,
    friction_x: float,
    friction_y: float,
    pressure: Any,
    kernels: Any,
    wavevectors: Any,
    first: int,
    out: Any,
) -> None:
    """Add to `out` some columns of the coefficients of a A + b B of one component under a shear traction.

    The traction on the surface is t = (friction_x, friction_y) p; the equations are in ``docs/method.md``.

    Parameters
    ----------
    component, pressure, wavevectors, first, out
        As for `mode_stress`.
    a, b : float
        The uniform mode is that of a A: σ_xz = t_x and σ_yz = t_y.
    friction_x, friction_y : float
    kernels : TractionKernels
    """
    qx, qy, odd_qx, odd_qy = wavevectors
    rows, columns = out.shape
    for j in range(rows):
        mirrored = min(j, rows - j)
        for k in range(columns):
            i = first + k
            p = pressure[j, i]
            square = qx[i] * qx[i] + qy[j] * qy[j]
            if square == 0.0:
                if component == _XZ:
                    out[j, k] += a * friction_x * p
                elif component == _YZ:
                    out[j, k] += a * friction_y * p
                continue
            q = np.sqrt(square)
            cc, ss = qx[i] * qx[i] / square, qy[j] * qy[j] / square
            if component in (_XZ, _YZ):
                x, t = kernels.shear[mirrored, i], kernels.transverse[mirrored, i]
                both = odd_qx[i] * odd_qy[j] / square * (x - t)
                if component == _XZ:
                    factor = a * (friction_x * (cc * x + ss * t) + friction_y * both)
                else:
                    factor = a * (friction_y * (ss * x + cc * t) + friction_x * both)
                out[j, k] += factor * p
                continue
            # Odd in one component of the wavevector, or in both: zero in a Nyquist mode.
            x, y = friction_x * odd_qx[i] / q, friction_y * odd_qy[j] / q
            n, m = kernels.normal[mirrored, i], kernels.longitudinal[mirrored, i]
            turn = kernels.in_plane[mirrored, i]
            if component == _ZZ:
                factor = a * (x + y) * n
            elif component == _XX:
                factor = a * ((x + y) * cc * m + 2.0 * (x * ss - y * cc) * turn) + b * (x + y) * ss * (n + m)
            elif component == _YY:
                factor = a * ((x + y) * ss * m + 2.0 * (y * cc - x * ss) * turn) + b * (x + y) * cc * (n + m)
            else:
                across_x, across_y = friction_y * odd_qx[i] / q, friction_x * odd_qy[j] / q
                along = across_y * cc + across_x * ss
                factor = a * (along * m + (cc - ss) * (across_x - across_y) * turn) - b * along * (n + m)
            out[j, k] += complex(-factor * p.imag, factor * p.real)


COLUMN_PARTS = 7
"""Parts A and B of a half-space, all but A_xz, that `half_space_columns` fills."""


class ColumnRoom(NamedTuple):
    """Arrays for one row of some columns, in double precision or, where it is said, that of the plane.

    Parameters
    ----------
    scaled, over_square, decay : (columns,) arrays in the precision of the plane
    argument, power : (columns,) arrays
    exponent, scale : (columns,) arrays, the same memory as integers and as numbers
    factors : (`COLUMN_PARTS`, 2 columns) array in the precision of the plane
    """

    scaled: Any
    over_square: Any
    decay: Any
    argument: Any
    power: Any
    exponent: Any
    scale: Any
    factors: Any


_COLUMN_XY, _COLUMN_SLOPE_XX, _COLUMN_SLOPE_XY = 4, 5, 6

_LARGEST_ARGUMENT = 700.0
_LOG2_E = 1 / math.log(2.0)
_LN2_HIGH = 0.693145751953125
_LN2_LOW = 1.4286068203094173e-06
_TAYLOR = tuple(1.0 / math.factorial(k) for k in range(13, -1, -1))
"""Coefficients of e^x, the highest first."""

_MANTISSA, _BIAS = 52, 1023
"""Bits of the mantissa of a number in double precision, and its exponent for 1."""


@fused
def half_space_columns(
    depth: float, pressure: Any, wavevectors: Any, first: int, room: Any, out: Any
) -> None:
    """Fill some columns of the coefficients of the parts A and B in a half-space.

    A_xz is left out: it is the only part odd in qx and even in qy, and i qx depth/2 times the sum of A_xx,
    A_yy and A_zz. This factor depends on qx alone, so that it can be applied after the transforms along y,
    which are thus done for seven parts in place of eight.

    Parameters
    ----------
    depth : float
    pressure : (ny, 2 (nx // 2 + 1)) array
        Coefficients of the contact pressure, real and imaginary parts in turn.
    wavevectors : Wavevectors
    first : int
        First column to fill.
    room : ColumnRoom
    out : (`COLUMN_PARTS`, ny, 2 columns) array
        A_xx, A_yy, A_zz, A_yz, A_xy, B_xx and B_xy, real and imaginary parts in turn.
    """
    rows, columns = out.shape[1], out.shape[2] // 2
    qx, odd_qx = wavevectors.qx[first : first + columns], wavevectors.odd_qx[first : first + columns]
    for j in range(rows // 2 + 1):
        _fill_decay(depth, qx, wavevectors.qy[j], room)
        _fill_factors(depth, qx, odd_qx, wavevectors.qy[j], wavevectors.odd_qy[j], room)
        # The row of −qy has the same factors but for the sign of those odd in qy.
        for sign, row in ((1, j), (-1, rows - j)):
            if sign == 1 or 0 < j < row:
                coefficients = pressure[row, 2 * first : 2 * (first + columns)]
                for m in range(COLUMN_PARTS):
                    own = qx.dtype.type(sign if m in (_YZ, _COLUMN_XY, _COLUMN_SLOPE_XY) else 1)
                    _multiply(room.factors[m], own, coefficients, m == _YZ, out[m, row])


@fused
def _fill_decay(depth: float, qx: Any, qy: float, room: Any) -> None:
    """Fill `room` with q depth, 1/q² (0 at q = 0) and e^(−q depth) for one row of modes.

    The exponential is 2^n times a Taylor series on |x| ≤ ln 2 / 2, in double precision: NumPy's would not be
    vectorised.
    """
    scaled, over_square, argument = room.scaled, room.over_square, room.argument
    power, exponent, scale, decay = room.power, room.exponent, room.scale, room.decay
    zero, one = qx.dtype.type(0), qx.dtype.type(1)
    for i in range(qx.size):
        square = qx[i] * qx[i] + qy * qy
        scaled[i] = depth * np.sqrt(square)
        over_square[i] = one / square if square > zero else zero
    for i in range(qx.size):
        argument[i] = -scaled[i] if scaled[i] < _LARGEST_ARGUMENT else -_LARGEST_ARGUMENT
    for i in range(qx.size):
        exponent[i] = np.int64(argument[i] * _LOG2_E - 0.5)
    for i in range(qx.size):
        argument[i] = argument[i] - exponent[i] * _LN2_HIGH - exponent[i] * _LN2_LOW
    for i in range(qx.size):
        x = argument[i]
        total = _TAYLOR[0]
        for coefficient in _TAYLOR[1:]:
            total = total * x + coefficient
        power[i] = total
    for i in range(qx.size):
        exponent[i] = (exponent[i] + _BIAS) << _MANTISSA
    for i in range(qx.size):
        decay[i] = power[i] * scale[i]


@fused
def _fill_factors(depth: float, qx: Any, odd_qx: Any, qy: float, odd_qy: float, room: Any) -> None:
    """Fill the factors of the pressure, each twice in turn, that of A_yz without the imaginary unit."""
    scaled, over_square, decay, factors = room.scaled, room.over_square, room.decay, room.factors
    xx, yy, zz, yz = factors[_XX], factors[_YY], factors[_ZZ], factors[_YZ]
    xy, slope_xx, slope_xy = factors[_COLUMN_XY], factors[_COLUMN_SLOPE_XX], factors[_COLUMN_SLOPE_XY]
    one = qx.dtype.type(1)
    for i in range(qx.size):
        _, longitudinal, _ = half_space_stresses(one, scaled[i], decay[i])
        xx[2 * i] = xx[2 * i + 1] = -longitudinal * (qx[i] * qx[i] * over_square[i])
    for i in range(qx.size):
        _, longitudinal, _ = half_space_stresses(one, scaled[i], decay[i])
        yy[2 * i] = yy[2 * i + 1] = -longitudinal * (qy * qy * over_square[i])
    for i in range(qx.size):
        normal, _, _ = half_space_stresses(one, scaled[i], decay[i])
        zz[2 * i] = zz[2 * i + 1] = -normal
    for i in range(qx.size):
        yz[2 * i] = yz[2 * i + 1] = depth * odd_qy * decay[i]
    for i in range(qx.size):
        _, longitudinal, _ = half_space_stresses(one, scaled[i], decay[i])
        xy[2 * i] = xy[2 * i + 1] = -longitudinal * (odd_qx[i] * odd_qy * over_square[i])
    for i in range(qx.size):
        slope_xx[2 * i] = slope_xx[2 * i + 1] = -(decay[i] + decay[i]) * (qy * qy * over_square[i])
    for i in range(qx.size):
        slope_xy[2 * i] = slope_xy[2 * i + 1] = (decay[i] + decay[i]) * (odd_qx[i] * odd_qy * over_square[i])


@fused_inlined
def _multiply(factors: Any, sign: float, pressure: Any, turned: bool, out: Any) -> None:
    """Fill `out` with factors times coefficients, times −i if turned."""
    if turned:
        for i in range(out.size // 2):
            out[2 * i] = sign * factors[2 * i] * pressure[2 * i + 1]
            out[2 * i + 1] = -sign * factors[2 * i + 1] * pressure[2 * i]
    else:
        for k in range(out.size):
            out[k] = sign * factors[k] * pressure[k]


@fused
def half_space_xz(half_depth: float, odd_qx: Any, first: int, last: int, parts: Any, room: Any) -> None:
    """Fill some rows of A_xz after the transform along y, from A_xx, A_yy and A_zz.

    Parameters
    ----------
    half_depth : float
    odd_qx : (columns,) array
    first, last : int
        Rows to fill.
    parts : (ny, at least 5, at least 2 columns) array
        A_xx, A_yy, A_zz, A_yz and A_xz, real and imaginary parts in turn.
    room : (2 columns,) array
    """
    for j in range(first, last):
        xx, yy, zz, xz = parts[j, _XX], parts[j, _YY], parts[j, _ZZ], parts[j, _XZ]
        # The sum first: only loops that read and write few arrays are turned into operations on vectors.
        for k in range(room.size):
            room[k] = xx[k] + yy[k] + zz[k]
        for i in range(odd_qx.size):
            factor = half_depth * odd_qx[i]
            xz[2 * i] = -factor * room[2 * i + 1]
            xz[2 * i + 1] = factor * room[2 * i]


@compiled
def clear_columns(parts: Any, first: int, last: int, start: int, stop: int) -> None:
    """Set some columns of some rows of (rows, parts, columns) to zero."""
    for j in range(first, last):
        for part in range(parts.shape[1]):
            line = parts[j, part, start:stop]
            for i in range(line.size):
                line[i] = 0


discard_outdated(__name__)
