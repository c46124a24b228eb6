"""Linear parts of the stress in planes under a periodic pressure, transformed from its modes.

A transform is done in two halves: along y for a block of columns of all spectra at a time, along x for a
strip of rows of all parts at a time. Each block and strip stays in the processor's cache from its spectrum to
the transformed values, and a strip up to what is made of it.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from asperity.elasticity.layer import COMPONENTS, Layer
from asperity.spectral import Fourier, Grid, resample
from asperity.stress.kernels import (
    COLUMN_PARTS,
    ColumnRoom,
    PlaneKernels,
    TractionKernels,
    Wavevectors,
    add_sliding_stress,
    clear_columns,
    half_space_columns,
    half_space_xz,
    mode_stress,
)
from asperity.stress.parts import ALL_PARTS, Part
from asperity.stress.truncation import PlaneGrid, Truncation
from asperity.types import Array

COLUMNS_AT_ONCE = 64
"""Columns of a block."""

CACHE_LINE = 64
"""Bytes of a line of the processor's cache."""

STRIP_BYTES = 2**20
"""Largest size of a strip of rows of all parts: it stays in the cache of one core."""

FEWEST_ROWS = 4
"""Rows of a strip are a multiple of this number: up to sixteen rows of parts are transformed together."""

ROWS_OF_GROUP = 16
"""Rows of a group, of which bands are made."""

BANDS = 8
"""Most groups of consecutive rows, each of which one thread goes through from the first to the last."""

GROUPS_OF_BAND = 8
"""Fewest groups of a band, if there are several bands."""

Run = Callable[[Callable[[Any], None], Sequence[Any]], None]
"""Calls a function for every item of a sequence, on one thread or several."""

Visit = Callable[[int, int, int], None]
"""Called with a band, and the first and the last row + 1 of a strip of it that is there."""


def bands_of(rows: int) -> list[tuple[int, int]]:
    """First and last row + 1 of every band of a plane."""
    groups = -(-rows // ROWS_OF_GROUP)
    bands = min(BANDS, max(1, groups // GROUPS_OF_BAND))
    edges = [min(rows, ROWS_OF_GROUP * (groups * band // bands)) for band in range(bands + 1)]
    return list(pairwise(edges))


def strips_of(band: tuple[int, int], values: Array) -> list[tuple[int, int]]:
    """First and last row + 1 of every strip of a band of a plane with these arrays, (ny, parts, numbers)."""
    rows = max(1, STRIP_BYTES // values.strides[0] // FEWEST_ROWS) * FEWEST_ROWS
    first, last = band
    return [(row, min(row + rows, last)) for row in range(first, last, rows)]


def aligned_array(size: int, dtype: Any) -> Array:
    """An array with any values that begins with a line of the processor's cache."""
    size = size * np.dtype(dtype).itemsize
    memory = np.empty(size + CACHE_LINE, np.uint8)
    start = -memory.ctypes.data % CACHE_LINE
    return memory[start : start + size].view(dtype)


class KeptArrays(threading.local):
    """Arrays of each thread that are used again: writing to new memory takes twice as long."""

    def __init__(self) -> None:
        self._arrays: dict[str, Array] = {}

    def array(self, name: str, shape: tuple[int, ...], dtype: Any) -> Array:
        """An array with any values, in memory that is kept under this name."""
        size = math.prod(shape)
        kept = self._arrays.get(name)
        if kept is None or kept.size < size or kept.dtype != dtype:
            kept = self._arrays[name] = aligned_array(size, dtype)
        return kept[:size].reshape(shape)


class PeriodicPlanes:
    """Transforms of linear parts of the stress under a periodic pressure.

    Attributes
    ----------
    plan : list of PlaneGrid
        Of each plane.
    mean_pressure : float
    """

    def __init__(
        self,
        pressure: Array,
        modes: Array,
        grid: Grid,
        layer: Layer,
        depths: Array,
        tolerance: float,
        envelope: float,
        traction: tuple[float, float],
        dtype: str,
    ) -> None:
        truncation = Truncation(modes, grid, layer, tolerance, envelope)
        self.plan = [truncation.choose(depth) for depth in depths]
        self.mean_pressure = float(modes[0, 0].real)
        self._fourier = Fourier(grid, dtype)
        self._modes = modes.astype(self._fourier.complex, copy=False)
        self._pressure = pressure
        self._finest = grid, self._modes
        self._layer, self._traction = layer, traction
        self._kept = KeptArrays()

    @staticmethod
    def row_length(grid: Grid) -> int:
        """Numbers in a row of the arrays that are filled: room for the coefficients of a row.

        An odd multiple of 16: rows that are a multiple of 4096 bytes apart share the same lines of the cache.
        """
        coefficients = grid.shape[1] // 2 + 1
        return 16 * (-(-coefficients // 8) | 1)

    def compute(
        self, depth: float, own: PlaneGrid, parts: Sequence[Part], values: Array, run: Run, visit: Visit
    ) -> int:
        """Compute the parts of one plane.

        Parameters
        ----------
        depth : float
        own : PlaneGrid
            Of this plane.
        parts : sequence of Part
        values : (ny, parts, `row_length`) array
            The first nx columns of each row are filled.
        run, visit : callable

        Returns
        -------
        nodes : int
            Nodes of the transforms.
        """
        grid = own.grid
        columns = own.columns or grid.half_shape[1]
        if grid.shape != self._fourier.grid.shape:
            self._fourier = Fourier(grid, self._fourier.dtype)
            self._modes = resample(self._finest[1], self._finest[0], grid)
        fourier, kept = self._fourier, self._kept
        spectra = values.view(fourier.complex)[:, :, : grid.half_shape[1]]
        source = self._source(depth, parts)

        def transform_columns(first: int) -> None:
            last = min(first + COLUMNS_AT_ONCE, columns)
            count = sum(spectra[0, own].shape[0] for own in source.columns)
            block = kept.array("block", (count, grid.shape[0], last - first), fourier.complex)
            source.fill_columns(first, last, block)
            start = 0
            for own in source.columns:
                target = spectra[:, own, first:last].transpose(1, 0, 2)
                fourier.inverse_along_y(block[start : start + target.shape[0]], target)
                start += target.shape[0]

        def transform_rows(band: int) -> None:
            for first, last in strips_of(bands[band], values):
                source.complete_rows(values, first, last, columns)
                if columns < spectra.shape[2]:
                    clear_columns(values, first, last, 2 * columns, 2 * spectra.shape[2])
                for own in source.rows:
                    lines = values[first:last, own].reshape(1, -1, values.shape[2])
                    coefficients = lines.view(fourier.complex)[:, :, : grid.half_shape[1]]
                    fourier.inverse_along_x(coefficients, lines[:, :, : grid.shape[1]])
                source.complete(first, last, values[first:last, :, : grid.shape[1]])
                visit(band, first, last)

        run(transform_columns, range(0, columns, COLUMNS_AT_ONCE))
        bands = bands_of(grid.shape[0])
        run(transform_rows, range(len(bands)))
        along_y = sum(spectra[0, own].shape[0] for own in source.columns) * columns / grid.half_shape[1]
        along_x = sum(spectra[0, own].shape[0] for own in source.rows)
        return round(grid.size * (along_y + along_x) / 2)

    def _source(self, depth: float, parts: Sequence[Part]) -> _HalfSpaceSpectra | _SurfaceSpectra | _Spectra:
        if tuple(parts) == ALL_PARTS and self._layer.height is None and not any(self._traction):
            if depth == 0 and self._fourier.grid == self._finest[0]:
                return _SurfaceSpectra(self._modes, self._fourier, self._pressure)
            return _HalfSpaceSpectra(depth, self._modes, self._fourier, self._kept)
        return _Spectra(depth, self._modes, self._fourier, self._layer, parts, self._traction)


class _HalfSpaceSpectra:
    """Spectra of all parts A and B in a half-space.

    Attributes
    ----------
    columns : sequence of slices
        Parts that are transformed along y.
    rows : sequence of slices
        Parts that are transformed along x, all at once or one by one.
    """

    columns, rows = (slice(0, 4), slice(5, 8)), (slice(None),)

    def __init__(self, depth: float, modes: Array, fourier: Fourier, kept: KeptArrays) -> None:
        grid, real = fourier.grid, fourier.real
        self._real, self._kept = real, kept
        self._depth, self._half_depth = real.type(depth), real.type(0.5 * depth)
        self._modes = modes.view(real)
        self._wavevectors = Wavevectors(
            *(q.astype(real) for q in (grid.qx, grid.qy, grid.odd_qx, grid.odd_qy))
        )

    def fill_columns(self, first: int, last: int, out: Array) -> None:
        """Fill `out` with some columns of the parts to be transformed along y."""
        size = last - first
        kept, real = self._kept, self._real
        scale = kept.array("scale", (size,), np.dtype(float))
        room = ColumnRoom(
            scaled=kept.array("scaled", (size,), real),
            over_square=kept.array("over_square", (size,), real),
            decay=kept.array("decay", (size,), real),
            argument=kept.array("argument", (size,), np.dtype(float)),
            power=kept.array("power", (size,), np.dtype(float)),
            exponent=scale.view(np.int64),
            scale=scale,
            factors=kept.array("factors", (COLUMN_PARTS, 2 * size), real),
        )
        half_space_columns(self._depth, self._modes, self._wavevectors, first, room, out.view(self._real))

    def complete_rows(self, values: Array, first: int, last: int, columns: int) -> None:
        """Fill the parts that have not been transformed along y, in some rows and the first columns."""
        room = self._kept.array("trace", (2 * columns,), self._real)
        half_space_xz(self._half_depth, self._wavevectors.odd_qx[:columns], first, last, values, room)

    def complete(self, first: int, last: int, out: Array) -> None:
        """Fill some rows of the parts that are not transformed along x."""


class _SurfaceSpectra:
    """Spectra of all parts A and B in the surface of a half-space; attributes as of `_HalfSpaceSpectra`.

    There σ_zz is minus the pressure, σ_yz and σ_xz are zero, and A_xx + A_yy = σ_zz, B_xx = 2 A_yy and
    B_xy = −2 A_xy but for the uniform mode: A_xx and A_xy alone are transformed.
    """

    columns = rows = (slice(0, 1), slice(5, 6))

    def __init__(self, modes: Array, fourier: Fourier, pressure: Array) -> None:
        self._modes, self._grid, self._real = modes, fourier.grid, fourier.real
        self._pressure, self._mean = pressure, fourier.real.type(modes[0, 0].real)

    def fill_columns(self, first: int, last: int, out: Array) -> None:
        """Fill `out` with some columns of the parts to be transformed along y."""
        grid, modes = self._grid, self._modes[:, first:last]
        square = grid.qx[first:last] ** 2 + grid.qy[:, None] ** 2
        if first == 0:
            square[0, 0] = np.inf
        over_square = (modes * (1 / square)).astype(modes.dtype)
        qx, odd_qx = (q[first:last].astype(self._real) for q in (grid.qx, grid.odd_qx))
        np.multiply(-(qx**2), over_square, out=out[0])
        np.multiply(-odd_qx, over_square, out=out[1])
        out[1] *= grid.odd_qy.astype(self._real)[:, None]

    def complete_rows(self, values: Array, first: int, last: int, columns: int) -> None:
        """Fill the parts that have not been transformed along y."""

    def complete(self, first: int, last: int, out: Array) -> None:
        """Fill some rows of the parts that are not transformed along x."""
        xx, yy, zz, yz, xz, xy, slope_xx, slope_xy = out.swapaxes(0, 1)
        np.negative(self._pressure[first:last], out=zz, casting="same_kind")
        np.subtract(zz, xx, out=yy)
        yy += self._mean
        np.multiply(yy, 2, out=slope_xx)
        np.multiply(xy, -2, out=slope_xy)
        yz[...] = xz[...] = 0


class _Spectra:
    """Spectra of any parts, also under a shear traction; attributes as of `_HalfSpaceSpectra`."""

    rows = (slice(None),)

    def __init__(
        self,
        depth: float,
        modes: Array,
        fourier: Fourier,
        layer: Layer,
        parts: Sequence[Part],
        traction: tuple[float, float],
    ) -> None:
        grid = fourier.grid
        kernels = layer.grid_kernels(grid, depth, fourier.real)
        self.columns = (slice(0, len(parts)),)
        self._kernels = PlaneKernels(kernels.normal, kernels.longitudinal, kernels.shear)
        self._traction_kernels = None
        if any(traction):
            self._traction_kernels = TractionKernels(*layer.grid_shear_kernels(grid, depth, fourier.real))
        self._parts, self._traction = parts, traction
        self._modes = modes
        self._wavevectors = Wavevectors(grid.qx, grid.qy, grid.odd_qx, grid.odd_qy)

    def fill_columns(self, first: int, last: int, out: Array) -> None:
        """Fill `out` with some columns of the parts, to be transformed along y."""
        for part, spectrum in zip(self._parts, out, strict=True):
            kind = COMPONENTS.index(part.component), part.constant, part.slope
            mode_stress(*kind, self._modes, self._kernels, self._wavevectors, first, spectrum)
            if self._traction_kernels is not None:
                add_sliding_stress(
                    *kind,
                    *self._traction,
                    self._modes,
                    self._traction_kernels,
                    self._wavevectors,
                    first,
                    spectrum,
                )

    def complete_rows(self, values: Array, first: int, last: int, columns: int) -> None:
        """Fill the parts that have not been transformed along y."""

    def complete(self, first: int, last: int, out: Array) -> None:
        """Fill some rows of the parts that are not transformed along x."""
