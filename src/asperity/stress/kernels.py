"""Compiled loops over modes: spectra of the linear parts of the stress in one plane.

Arrays that belong together are passed as named tuples. The arrays may be in single or double precision.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from asperity.elasticity.kernels import half_space_kernels
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


@njit(cache=True, error_model="numpy", nogil=True)
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


@njit(cache=True, error_model="numpy", nogil=True)
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


SHARED_COLUMNS = 7
"""Functions of the modes from which `all_parts` makes the eight parts A and B of a half-space."""


@njit(cache=True, error_model="numpy", nogil=True)
def shared_columns(
    half_depth: float,
    pressure: Any,
    wavevectors: Any,
    first: int,
    factors: Any,
    out: Any,
) -> None:
    """Fill some columns of the functions of the modes that the parts of a half-space share.

    With P the coefficients of the pressure, E = e^(−q depth), Z = (1 + q depth) E and L = (1 − q depth) E,
    the functions are Z P, L P, L P/q², 2 E P/q², qy L P/q², 2 qy E P/q² and qy depth E P; all but the first
    are zero at q = 0. The parts are these times factors that depend on qx alone, see `all_parts`: transforms
    along y are done before, for seven functions in place of eight parts.

    Parameters
    ----------
    half_depth : float
    pressure : (ny, 2 (nx // 2 + 1)) array
        Coefficients of the contact pressure, real and imaginary parts in turn.
    wavevectors : Wavevectors
    first : int
        First column to fill.
    factors : (`SHARED_COLUMNS`, columns) array
        Room for the factors of one row.
    out : (`SHARED_COLUMNS`, ny, 2 columns) array
        Real and imaginary parts in turn.
    """
    qy, odd_qy = wavevectors.qy, wavevectors.odd_qy
    rows, columns = out.shape[1], factors.shape[1]
    qx = wavevectors.qx[first : first + columns]
    depth = half_depth + half_depth
    scaled = factors[6]
    for j in range(rows // 2 + 1):
        for i in range(columns):
            scaled[i] = depth * np.sqrt(qx[i] * qx[i] + qy[j] * qy[j])
        for i in range(columns):
            square = qx[i] * qx[i] + qy[j] * qy[j]
            # Of these kernels none that is used depends on Poisson's ratio.
            normal, along, shear, _, _ = half_space_kernels(float(scaled[i]), 0.0)
            decay = normal - shear
            factors[0, i] = normal
            factors[1, i] = along
            factors[2, i] = along / square
            factors[3, i] = 2 * decay / square
            factors[4, i] = odd_qy[j] * (along / square)
            factors[6, i] = depth * odd_qy[j] * decay
            factors[5, i] = odd_qy[j] * factors[3, i]
        if j == 0 and first == 0:
            for m in range(1, SHARED_COLUMNS):
                factors[m, 0] = 0.0
        # The row of −qy has the same factors but for the sign of those odd in qy, the last three.
        mirrored = rows - j if j else 0
        for m in range(SHARED_COLUMNS):
            odd = m > 3
            for i in range(columns):
                k, factor = 2 * (first + i), factors[m, i]
                out[m, j, 2 * i] = factor * pressure[j, k]
                out[m, j, 2 * i + 1] = factor * pressure[j, k + 1]
            if mirrored != j:
                for i in range(columns):
                    k, factor = 2 * (first + i), -factors[m, i] if odd else factors[m, i]
                    out[m, mirrored, 2 * i] = factor * pressure[mirrored, k]
                    out[m, mirrored, 2 * i + 1] = factor * pressure[mirrored, k + 1]


@njit(cache=True, error_model="numpy", nogil=True)
def all_parts(
    half_depth: float, mean: float, columns: Any, wavevectors: Any, first: int, last: int, out: Any
) -> None:
    """Fill some rows of the parts A and B of all components in a half-space, to be transformed along x.

    Parameters
    ----------
    half_depth : float
    mean : float
        Pressure mode q = 0, of which σ_zz alone has a part.
    columns : (parts, ny, 2 (nx // 2 + 1)) array
        The functions of `shared_columns` after their transform along y; real and imaginary parts in turn.
    wavevectors : Wavevectors
    first, last : int
        Rows to fill.
    out : (8, last − first, 2 (nx // 2 + 1)) array
        A_xx, A_yy, A_zz, A_yz, A_xz, A_xy, B_xx and B_xy; real and imaginary parts in turn.
    """
    qx, odd_qx = wavevectors.qx, wavevectors.odd_qx
    for j in range(first, last):
        z, along, along_over_square = columns[0, j], columns[1, j], columns[2, j]
        both_over_square, turned, both_turned = columns[3, j], columns[4, j], columns[5, j]
        shear = columns[6, j]
        n = j - first
        xx, yy, zz, yz, xz, xy = out[0, n], out[1, n], out[2, n], out[3, n], out[4, n], out[5, n]
        slope_xx, slope_xy = out[6, n], out[7, n]
        for i in range(qx.size):
            square, odd = qx[i] * qx[i], odd_qx[i]
            for k in (2 * i, 2 * i + 1):
                across = square * along_over_square[k]
                xx[k] = -across
                yy[k] = across - along[k]
                zz[k] = -z[k]
                xy[k] = -odd * turned[k]
                slope_xx[k] = square * both_over_square[k] - (z[k] + along[k])
                slope_xy[k] = odd * both_turned[k]
        slope_xx[0] += mean
        for i in range(qx.size):
            k, odd = 2 * i, half_depth * odd_qx[i]
            yz[k], yz[k + 1] = shear[k + 1], -shear[k]
            xz[k], xz[k + 1] = odd * (z[k + 1] + along[k + 1]), -odd * (z[k] + along[k])


discard_outdated(__name__)
