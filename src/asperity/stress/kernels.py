"""Compiled loops over modes: spectra of the linear parts of the stress in one plane.

Arrays that belong together are passed as named tuples. The arrays may be in single or double precision.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from asperity.elasticity.layer import COMPONENTS

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
            z = normal[mirrored, i]
            along = longitudinal[mirrored, i]
            if component == _ZZ:
                out[j, n] = -a * z * pressure[j, i]
            elif component == _XX:
                factor = (a * qx[i] * qx[i] * along + b * qy[j] * qy[j] * (z + along)) / square
                out[j, n] = -factor * pressure[j, i]
            elif component == _YY:
                factor = (a * qy[j] * qy[j] * along + b * qx[i] * qx[i] * (z + along)) / square
                out[j, n] = -factor * pressure[j, i]
            elif component == _XY:
                factor = odd_qx[i] * odd_qy[j] * (a * along - b * (z + along)) / square
                out[j, n] = -factor * pressure[j, i]
            else:
                odd = odd_qy[j] if component == _YZ else odd_qx[i]
                factor = a * odd * shear[mirrored, i] / np.sqrt(square)
                p = pressure[j, i]
                out[j, n] = complex(factor * p.imag, -factor * p.real)


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
    """Add to `out` some columns of the coefficients of a A + b B of one stress component under a shear traction.

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
    half_depth: float, pressure: Any, kernels: Any, wavevectors: Any, first: int, last: int, out: Any
) -> None:
    """Fill some columns of the functions of the modes that the parts of a half-space share.

    With P the coefficients of the pressure, Z and L the kernels and S = Z + L, the functions are Z P, L P,
    L P/q², S P/q², qy L P/q², qy S P/q² and qy depth S P/2; all but the first are zero at q = 0. The
    parts are these times factors that depend on qx alone, see `all_parts`: transforms along y are done
    before, for seven functions in place of eight parts.

    Parameters
    ----------
    half_depth : float
    pressure : (ny, nx // 2 + 1) complex array
    kernels : PlaneKernels
    wavevectors : Wavevectors
    first, last : int
        Columns to fill.
    out : (`SHARED_COLUMNS`, ny, last − first) complex array
    """
    normal, longitudinal, _ = kernels
    qx, qy, _, odd_qy = wavevectors
    rows = out.shape[1]
    for j in range(rows):
        mirrored = min(j, rows - j)
        for i in range(first, last):
            z, along, p = normal[mirrored, i], longitudinal[mirrored, i], pressure[j, i]
            both, square = z + along, qx[i] * qx[i] + qy[j] * qy[j]
            n = i - first
            out[0, j, n] = z * p
            if square == 0.0:
                out[1:, j, n] = 0.0
                continue
            out[1, j, n] = along * p
            out[2, j, n] = along / square * p
            out[3, j, n] = both / square * p
            out[4, j, n] = odd_qy[j] * along / square * p
            out[5, j, n] = odd_qy[j] * both / square * p
            out[6, j, n] = half_depth * odd_qy[j] * both * p


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
    columns : (parts, ny, nx // 2 + 1) complex array
        The functions of `shared_columns` after their transform along y.
    wavevectors : Wavevectors
    first, last : int
        Rows to fill.
    out : (8, last − first, nx // 2 + 1) complex array
        A_xx, A_yy, A_zz, A_yz, A_xz, A_xy, B_xx and B_xy.
    """
    qx, odd_qx = wavevectors.qx, wavevectors.odd_qx
    for j in range(first, last):
        n = j - first
        for i in range(qx.size):
            square = qx[i] * qx[i]
            both = columns[0, j, i] + columns[1, j, i]
            across = square * columns[2, j, i]
            out[0, n, i] = -across
            out[1, n, i] = across - columns[1, j, i]
            out[2, n, i] = -columns[0, j, i]
            yz, xz = columns[6, j, i], half_depth * odd_qx[i] * both
            out[3, n, i] = complex(yz.imag, -yz.real)
            out[4, n, i] = complex(xz.imag, -xz.real)
            out[5, n, i] = -odd_qx[i] * columns[4, j, i]
            out[6, n, i] = square * columns[3, j, i] - both
            out[7, n, i] = odd_qx[i] * columns[5, j, i]
        out[6, n, 0] += mean
