"""Compiled loops over modes and nodes: stress of a mode, fields of a plane, neighbourhoods of peaks.

Arrays that belong together are passed as named tuples. The arrays may be in single or double precision.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from asperity.elasticity.layer import COMPONENTS

_XX, _YY, _ZZ, _YZ, _XZ, _XY = (COMPONENTS.index(name) for name in ("xx", "yy", "zz", "yz", "xz", "xy"))


class Components(NamedTuple):
    """Fields A of the six stress components in one plane, arrays of one length; ordered as `COMPONENTS`."""

    xx: Any
    yy: Any
    zz: Any
    yz: Any
    xz: Any
    xy: Any


class Slopes(NamedTuple):
    """Fields B of the stress A + ν B, as far as the others do not follow from them.

    B_zz, B_yz and B_xz are zero, and B_yy = A_xx + A_yy + A_zz − B_xx but for the uniform mode.
    """

    xx: Any
    xy: Any


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
    component: int, a: float, b: float, pressure: Any, kernels: Any, wavevectors: Any, out: Any
) -> None:
    """Fill `out` with the coefficients of a A + b B of one stress component.

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
    out : (ny, nx // 2 + 1) complex array
    """
    normal, longitudinal, shear = kernels
    qx, qy, odd_qx, odd_qy = wavevectors
    rows, columns = out.shape
    for j in range(rows):
        mirrored = min(j, rows - j)
        for i in range(columns):
            square = qx[i] * qx[i] + qy[j] * qy[j]
            if square == 0.0:
                out[j, i] = -a * pressure[j, i] if component == _ZZ else 0.0
                continue
            z = normal[mirrored, i]
            along = longitudinal[mirrored, i]
            if component == _ZZ:
                out[j, i] = -a * z * pressure[j, i]
            elif component == _XX:
                factor = (a * qx[i] * qx[i] * along + b * qy[j] * qy[j] * (z + along)) / square
                out[j, i] = -factor * pressure[j, i]
            elif component == _YY:
                factor = (a * qy[j] * qy[j] * along + b * qx[i] * qx[i] * (z + along)) / square
                out[j, i] = -factor * pressure[j, i]
            elif component == _XY:
                factor = odd_qx[i] * odd_qy[j] * (a * along - b * (z + along)) / square
                out[j, i] = -factor * pressure[j, i]
            else:
                odd = odd_qy[j] if component == _YZ else odd_qx[i]
                factor = a * odd * shear[mirrored, i] / np.sqrt(square)
                p = pressure[j, i]
                out[j, i] = complex(factor * p.imag, -factor * p.real)


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
    out: Any,
) -> None:
    """Add to `out` the coefficients of a A + b B of one stress component under a shear traction.

    The traction on the surface is t = (friction_x, friction_y) p; the equations are in ``docs/method.md``.

    Parameters
    ----------
    component, pressure, wavevectors, out
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
        for i in range(columns):
            p = pressure[j, i]
            square = qx[i] * qx[i] + qy[j] * qy[j]
            if square == 0.0:
                if component == _XZ:
                    out[j, i] += a * friction_x * p
                elif component == _YZ:
                    out[j, i] += a * friction_y * p
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
                out[j, i] += factor * p
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
            out[j, i] += complex(-factor * p.imag, factor * p.real)


@njit(cache=True, error_model="numpy", nogil=True)
def combine(a: Any, b: Any, ratio: float, uniform: float, out: Any) -> None:
    """Fill `out` with a + ratio · b + uniform."""
    for n in range(a.size):
        out[n] = a[n] + ratio * b[n] + uniform


@njit(cache=True, error_model="numpy", nogil=True)
def von_mises(
    constant: Any, slope: Any, ratio: float, uniform: float, mean_pressure: float, out: Any
) -> None:
    """Fill `out` with the von Mises stress of A + ν B.

    Parameters
    ----------
    constant : Components
    slope : Slopes
    ratio : float
        Poisson's ratio ν; 0 where A is the stress itself.
    uniform : float
        Uniform part of σ_xx and σ_yy.
    mean_pressure : float
        Minus the uniform part of σ_zz, which is in A_zz.
    out : array
    """
    for n in range(out.size):
        x, y, z = constant.xx[n], constant.yy[n], constant.zz[n]
        slope_yy = x + y + z + mean_pressure - slope.xx[n]
        x += ratio * slope.xx[n] + uniform
        y += ratio * slope_yy + uniform
        t = constant.xy[n] + ratio * slope.xy[n]
        normal = (x - y) * (x - y) + (y - z) * (y - z) + (z - x) * (z - x)
        shear = t * t + constant.yz[n] * constant.yz[n] + constant.xz[n] * constant.xz[n]
        out[n] = np.sqrt(0.5 * normal + 3.0 * shear)


@njit(cache=True, error_model="numpy", nogil=True)
def moments(one: Any, two: Any) -> tuple[float, float, float]:
    """Means of two fields and of their product, summed row by row."""
    mean_one = mean_two = product = 0.0
    for j in range(one.shape[0]):
        row_one = row_two = row_product = 0.0
        for i in range(one.shape[1]):
            row_one += one[j, i]
            row_two += two[j, i]
            row_product += one[j, i] * two[j, i]
        mean_one += row_one
        mean_two += row_two
        product += row_product
    return mean_one / one.size, mean_two / one.size, product / one.size


@njit(cache=True, error_model="numpy", nogil=True)
def find_maxima(field: Any, floor: float, periodic: bool, found: Any) -> int:
    """Fill `found` with the flat indices of the maxima of |field| in its plane; return their number.

    A maximum is above `floor` and strictly above its 8 neighbours. Across an edge lie those of the opposite
    edge, or with `periodic` false the mirror image of the plane about its outermost nodes.
    """
    rows, columns = field.shape
    count = 0
    for j in range(rows):
        before = _neighbour(j - 1, rows, periodic)
        after = _neighbour(j + 1, rows, periodic)
        for i in range(columns):
            value = abs(field[j, i])
            if not value > floor:
                continue
            left = _neighbour(i - 1, columns, periodic)
            right = _neighbour(i + 1, columns, periodic)
            if (
                value > abs(field[j, left])
                and value > abs(field[j, right])
                and value > abs(field[before, i])
                and value > abs(field[after, i])
                and value > abs(field[before, left])
                and value > abs(field[before, right])
                and value > abs(field[after, left])
                and value > abs(field[after, right])
            ):
                found[count] = j * columns + i
                count += 1
    return count


@njit(cache=True, error_model="numpy", nogil=True)
def _neighbour(node: int, nodes: int, periodic: bool) -> int:
    """Index of a node at most one beyond the edges: on the opposite edge, or its mirror image."""
    if node < 0:
        return nodes - 1 if periodic else 1
    if node >= nodes:
        return 0 if periodic else nodes - 2
    return node


@njit(cache=True, error_model="numpy", nogil=True)
def gather(field: Any, row: Any, column: Any, periodic: bool, out: Any) -> None:
    """Fill `out`, (nodes, 3, 3), with the values at and around nodes; across edges as in `find_maxima`."""
    rows, columns = field.shape
    for n in range(row.size):
        for a in range(3):
            line = _neighbour(row[n] + a - 1, rows, periodic)
            for b in range(3):
                out[n, a, b] = field[line, _neighbour(column[n] + b - 1, columns, periodic)]


@njit(cache=True, error_model="numpy", nogil=True)
def interpolate(
    field: Any, row: Any, column: Any, ratio_y: float, ratio_x: float, other: Any, periodic: bool, out: Any
) -> None:
    """Fill `out`, (nodes, 3, 3), with the values at and around nodes of another grid of the same cell.

    The interpolation is Lagrange's on the six nearest nodes along each axis.

    Parameters
    ----------
    field : (ny, nx) array
    row, column : (nodes,) arrays
        Nodes of the other grid.
    ratio_y, ratio_x : float
        Spacing of the other grid over that of the field.
    other : (rows, columns)
        Shape of the other grid.
    periodic : bool
        As in `find_maxima`.
    out : (nodes, 3, 3) array
    """
    rows, columns = field.shape
    weight_y, weight_x = np.empty(6), np.empty((3, 6))
    place_x = np.empty((3, 6), np.int64)
    for n in range(row.size):
        for b in range(3):
            position = _unless_periodic(column[n] + b - 1, other[1], periodic) * ratio_x
            base = _stencil(position, columns, periodic)
            _lagrange_weights(position - base, weight_x[b])
            for m in range(6):
                place_x[b, m] = (base + m - 2) % columns
        for a in range(3):
            position = _unless_periodic(row[n] + a - 1, other[0], periodic) * ratio_y
            base = _stencil(position, rows, periodic)
            _lagrange_weights(position - base, weight_y)
            out[n, a, :] = 0.0
            for k in range(6):
                line = field[(base + k - 2) % rows]
                for b in range(3):
                    part = 0.0
                    for m in range(6):
                        part += weight_x[b, m] * line[place_x[b, m]]
                    out[n, a, b] += weight_y[k] * part


@njit(cache=True, error_model="numpy", nogil=True)
def _unless_periodic(node: int, nodes: int, periodic: bool) -> int:
    """The index itself, or over a free boundary that of its mirror image."""
    return node if periodic else _neighbour(node, nodes, periodic)


@njit(cache=True, error_model="numpy", nogil=True)
def _stencil(position: float, nodes: int, periodic: bool) -> int:
    """Third of the six nodes from which a position is interpolated, all of them within an isolated map."""
    base = int(np.floor(position))
    return base if periodic else max(2, min(base, nodes - 4))


@njit(cache=True, error_model="numpy", nogil=True)
def _lagrange_weights(fraction: float, out: Any) -> None:
    """Fill `out` with the weights of Lagrange's interpolation from the six nodes −2 … 3 to `fraction`."""
    for k in range(6):
        weight = 1.0
        for m in range(6):
            if m != k:
                weight *= (fraction - (m - 2)) * (1.0 / (k - m))
        out[k] = weight
