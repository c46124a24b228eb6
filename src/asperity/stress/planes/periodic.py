"""Basis fields of the stress in planes under a periodic pressure, transformed from its modes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np

from asperity.core.compiled import compiled, inlined
from asperity.core.parallel import results_of
from asperity.core.types import Array
from asperity.elasticity.layer import COMPONENTS
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.fourier.grid import Fourier, Grid, Work, resample
from asperity.stress.planes.fields import BasisField
from asperity.stress.planes.truncation import PlaneGrid, Truncation, coarser_grids

_XX, _YY, _ZZ, _YZ, _XZ, _XY = range(6)

COLUMNS_AT_ONCE = 64
"""Columns of modes whose spectra stay in the processor's cache until they are transformed along y."""


class PeriodicPlanes:
    """Transforms of basis fields of the stress under a periodic pressure.

    Parameters
    ----------
    solid : LoadedSolid
    depths : (planes,) array
    tolerance : float
        Of the planes on coarser grids, see `asperity.stress_planes`.
    envelope : float
        The constant K of `asperity.stress.planes.truncation.envelope_of`.
    traction : (x, y)
        Shear traction over pressure.
    threads : int
    work : Work
    dtype : "float32" | "float64"
        Precision of the planes.

    Attributes
    ----------
    plan : list of PlaneGrid
        Of each plane.
    mean_pressure : float
    dtype : dtype
    """

    def __init__(
        self,
        solid: LoadedSolid,
        depths: Array,
        tolerance: float,
        envelope: float,
        traction: tuple[float, float],
        threads: int,
        work: Work,
        dtype: str,
    ) -> None:
        self._layer, self._traction, self._threads, self._work = solid.layer, traction, threads, work
        modes = Fourier(solid.grid, threads=threads, work=work).forward(solid.pressure)
        truncation = Truncation(modes, coarser_grids(solid.grid), solid.layer, tolerance, envelope)
        self.plan = [truncation.choose(depth) for depth in depths]
        self.mean_pressure = float(modes[0, 0].real)
        self.dtype = np.dtype(dtype)
        self._finest = solid.grid, modes.astype(np.result_type(self.dtype, np.complex64), copy=False)
        self._use(solid.grid)

    def _use(self, grid: Grid) -> None:
        """Resample the modes of the pressure to a grid."""
        self._fourier = Fourier(grid, self.dtype)
        modes = resample(self._finest[1], self._finest[0], grid)
        q = grid.half_wavenumber().astype(self.dtype)
        along_x, self._along_y = (
            np.stack(pair).astype(self.dtype) for pair in ((grid.qx, grid.odd_qx), (grid.qy, grid.odd_qy))
        )
        starts = range(COLUMNS_AT_ONCE, q.shape[1], COLUMNS_AT_ONCE)
        parts = (
            np.split(array, starts, axis=1) for array in (modes, q, 1 / np.where(q > 0, q, np.inf), along_x)
        )
        self._strips = [[np.ascontiguousarray(part) for part in strip] for strip in zip(*parts, strict=True)]

    @staticmethod
    def row_length(grid: Grid) -> int:
        """Numbers in a row of the array that is filled: room for the coefficients of a row.

        An odd multiple of 16: rows that are a multiple of 4096 bytes apart share the same lines of the cache.
        """
        return 16 * (-(-grid.half_shape[1] // 8) | 1)

    def compute(self, depth: float, own: PlaneGrid, fields: Sequence[BasisField], values: Array) -> None:
        """Compute the basis fields of one plane.

        Parameters
        ----------
        depth : float
        own : PlaneGrid
            Of this plane.
        fields : sequence of BasisField
        values : (fields, ny, `row_length`) array
            The first nx columns are filled.
        """
        grid = own.grid
        if grid != self._fourier.grid:
            self._use(grid)
        engine, nx = self._fourier.engine, grid.shape[1]
        spectra = values.view(self._fourier.complex)[:, :, : grid.half_shape[1]]

        def transform_columns(number: int) -> None:
            first = number * COLUMNS_AT_ONCE
            columns = slice(first, min(first + COLUMNS_AT_ONCE, own.columns))
            count = columns.stop - first
            strip = [np.ascontiguousarray(array[:, :count]) for array in self._strips[number]]
            for coefficients, out in zip(self._coefficients(depth, fields, strip), spectra, strict=True):
                engine.inverse_along_y(coefficients, out[:, columns])

        def transform_rows(number: int) -> None:
            spectra[number, :, own.columns :] = 0
            engine.inverse_along_x(spectra[number], values[number, :, :nx])

        strips = range(-(-own.columns // COLUMNS_AT_ONCE))
        results_of([partial(transform_columns, number) for number in strips], self._threads)
        results_of([partial(transform_rows, number) for number in range(len(fields))], self._threads)
        self._work.nodes += round(len(fields) * grid.size * (1 + own.columns / grid.half_shape[1]) / 2)

    def _coefficients(
        self, depth: float, fields: Sequence[BasisField], strip: Sequence[Array]
    ) -> Iterator[Array]:
        """Coefficients of one basis field after the other, (ny, columns), in the same array.

        Parameters
        ----------
        depth : float
        fields : sequence of BasisField
        strip : sequence of arrays
            Of some columns of the half spectrum: modes of the pressure, (ny, columns); the wavenumber q, and
            1/q or 0 at q = 0, (ny // 2 + 1, columns); q_x for factors even and odd in it, (2, columns).
        """
        real, (modes, q, over_q, along_x) = self.dtype.type, strip
        kernels = self._layer.kernels(q, depth)[:3]
        shear_kernels = self._layer.shear_kernels(q, depth) if any(self._traction) else None
        directions = along_x, self._along_y, over_q
        factor = np.empty(q.shape[1], self.dtype)
        out = np.empty_like(modes)
        traction = tuple(map(real, self._traction))
        for field in fields:
            component, a, b = COMPONENTS.index(field.component), real(field.constant), real(field.slope)
            numbers, into = modes.view(self.dtype), out.view(self.dtype)
            _fill_spectrum(component, a, b, directions, kernels, factor, numbers, into)
            if shear_kernels is not None:
                _add_sliding(component, a, b, traction, directions, tuple(shear_kernels), modes, out)
            if q[0, 0] == 0:
                out[0, 0] = self._mean(field)
            yield out

    def _mean(self, field: BasisField) -> float:
        """The mean of a basis field."""
        traction = dict(zip(("xz", "yz"), self._traction, strict=True))
        return field.constant * self.mean_pressure * {"zz": -1.0, **traction}.get(field.component, 0.0)


@compiled
def _fill_spectrum(
    component: int, a: float, b: float, directions: Any, kernels: Any, factor: Any, modes: Any, out: Any
) -> None:
    """Fill `out` with the coefficients of a A + b B of one component under the pressure.

    Parameters
    ----------
    component : int
        Its place in `COMPONENTS`.
    a, b : float
    directions : tuple
        q_x of the columns and q_y of the rows, each for factors even in it and, zero in a Nyquist mode, for
        odd ones; 1/q of the rows with q_y ≥ 0, and 0 at q = 0.
    kernels : tuple
        Z, L and T of `Layer.kernels` in the rows with q_y ≥ 0.
    factor : (columns,) array
        Any values.
    modes, out : (ny, 2 columns) arrays
        Coefficients of the pressure and those to fill, real and imaginary parts in turn.
    """
    (qx, odd_qx), (qy, odd_qy), over_q = directions
    rows = out.shape[0]
    for j in range(rows // 2 + 1):
        over, z, along, shear = over_q[j], kernels[0][j], kernels[1][j], kernels[2][j]
        if component == _ZZ:
            for i in range(factor.size):
                factor[i] = -a * z[i]
        elif component == _XZ:
            for i in range(factor.size):
                factor[i] = -a * (odd_qx[i] * over[i]) * shear[i]
        elif component == _YZ:
            for i in range(factor.size):
                factor[i] = -a * (odd_qy[j] * over[i]) * shear[i]
        elif component == _XY:
            for i in range(factor.size):
                both = odd_qx[i] * over[i] * (odd_qy[j] * over[i])
                factor[i] = both * (b * (z[i] + along[i]) - a * along[i])
        else:
            for i in range(factor.size):
                c, s = qx[i] * over[i], qy[j] * over[i]
                own, other = (c, s) if component == _XX else (s, c)
                factor[i] = -(a * own * own * along[i] + b * other * other * (z[i] + along[i]))
        _multiply(factor, modes[j], component in (_XZ, _YZ), out[j])
        if 0 < j < rows - j:
            if component in (_YZ, _XY):
                for i in range(factor.size):
                    factor[i] = -factor[i]
            _multiply(factor, modes[rows - j], component in (_XZ, _YZ), out[rows - j])


@inlined
def _multiply(factor: Any, modes: Any, imaginary: bool, out: Any) -> None:
    """Fill `out` with a factor, or one times the imaginary unit, times coefficients."""
    if imaginary:
        for i in range(factor.size):
            out[2 * i] = -factor[i] * modes[2 * i + 1]
            out[2 * i + 1] = factor[i] * modes[2 * i]
    else:
        for i in range(factor.size):
            out[2 * i] = factor[i] * modes[2 * i]
            out[2 * i + 1] = factor[i] * modes[2 * i + 1]


@compiled
def _add_sliding(
    component: int, a: float, b: float, traction: Any, directions: Any, kernels: Any, modes: Any, out: Any
) -> None:
    """Add to `out` the coefficients of a A + b B of one component under a shear traction.

    The traction is `traction` times the pressure; the equations are in ``docs/method.md``. `kernels` are N,
    M, X, P and Q of `Layer.shear_kernels`, `modes` and `out` complex; the others are as of `_fill_spectrum`.
    """
    (qx, odd_qx), (qy, odd_qy), over_q = directions
    friction_x, friction_y = traction
    for j in range(out.shape[0]):
        row = min(j, out.shape[0] - j)
        for i in range(out.shape[1]):
            n, m, turn = kernels[0][row, i], kernels[1][row, i], kernels[4][row, i]
            along, across, over = kernels[2][row, i], kernels[3][row, i], over_q[row, i]
            cc, ss = (qx[i] * over) ** 2, (qy[j] * over) ** 2
            odd_c, odd_s = odd_qx[i] * over, odd_qy[j] * over
            x, y = friction_x * odd_c, friction_y * odd_s
            if component == _XZ:
                both = friction_y * odd_c * odd_s * (along - across)
                out[j, i] += a * (friction_x * (cc * along + ss * across) + both) * modes[j, i]
                continue
            if component == _YZ:
                both = friction_x * odd_c * odd_s * (along - across)
                out[j, i] += a * (friction_y * (ss * along + cc * across) + both) * modes[j, i]
                continue
            if component == _ZZ:
                factor = a * (x + y) * n
            elif component == _XX:
                turned = (x + x) * ss - (y + y) * cc
                factor = a * ((x + y) * cc * m + turned * turn) + b * (x + y) * ss * (n + m)
            elif component == _YY:
                turned = (y + y) * cc - (x + x) * ss
                factor = a * ((x + y) * ss * m + turned * turn) + b * (x + y) * cc * (n + m)
            else:
                x, y = friction_y * odd_c, friction_x * odd_s
                both = y * cc + x * ss
                factor = a * (both * m + (cc - ss) * (x - y) * turn) - b * both * (n + m)
            out[j, i] += complex(-factor * modes[j, i].imag, factor * modes[j, i].real)
