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
    SHARED_COLUMNS,
    PlaneKernels,
    TractionKernels,
    Wavevectors,
    add_sliding_stress,
    all_parts,
    mode_stress,
    shared_columns,
)
from asperity.stress.parts import ALL_PARTS, Part
from asperity.stress.truncation import PlaneGrid, Truncation
from asperity.types import Array

COLUMNS_AT_ONCE = 64
"""Columns of a block."""

ROWS_AT_ONCE = 16
"""Rows of a strip."""

BANDS = 8
"""Most groups of consecutive strips, each of which one thread goes through from the first to the last."""

STRIPS_OF_BAND = 8
"""Fewest strips of a band, if there are several bands."""

Run = Callable[[Callable[[Any], None], Sequence[Any]], None]
"""Calls a function for every item of a sequence, on one thread or several."""

Visit = Callable[[int, int, int], None]
"""Called with a band, and the first and the last row + 1 of a strip of it that is there."""


def bands_of(rows: int) -> list[tuple[int, int]]:
    """First and last row + 1 of every band of a plane."""
    strips = -(-rows // ROWS_AT_ONCE)
    bands = min(BANDS, max(1, strips // STRIPS_OF_BAND))
    edges = [min(rows, ROWS_AT_ONCE * (strips * band // bands)) for band in range(bands + 1)]
    return list(pairwise(edges))


def strips_of(first: int, last: int) -> list[tuple[int, int]]:
    """First and last row + 1 of every strip of a band."""
    return [(row, min(row + ROWS_AT_ONCE, last)) for row in range(first, last, ROWS_AT_ONCE)]


class KeptArrays(threading.local):
    """Arrays of each thread that are used again: writing to new memory takes twice as long."""

    def __init__(self) -> None:
        self._arrays: dict[str, Array] = {}

    def array(self, name: str, shape: tuple[int, ...], dtype: Any) -> Array:
        """An array with any values, in memory that is kept under this name."""
        size = math.prod(shape)
        kept = self._arrays.get(name)
        if kept is None or kept.size < size or kept.dtype != dtype:
            kept = self._arrays[name] = np.empty(size, dtype)
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
        """Numbers in a row of the arrays that are filled: room for the coefficients of a row."""
        return 2 * (grid.shape[1] // 2 + 1)

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
        values : (parts, ny, 2 (nx // 2 + 1)) array
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
        spectra = values.view(fourier.complex)
        source = self._source(depth, parts)

        def transform_columns(first: int) -> None:
            last = min(first + COLUMNS_AT_ONCE, columns)
            shape = source.count, grid.shape[0], last - first
            block = kept.array("block", shape, fourier.complex)
            source.fill_columns(first, last, block)
            fourier.inverse_along_y(block, spectra[: source.count, :, first:last])

        def transform_rows(band: int) -> None:
            for first, last in strips_of(*bands[band]):
                rows = values[:, first:last, : grid.shape[1]]
                shape = rows[source.transformed].shape[0], last - first, spectra.shape[2]
                strip = kept.array("strip", shape, fourier.complex)
                source.fill_rows(spectra, first, last, strip, columns)
                strip[:, :, columns:] = 0
                fourier.inverse_along_x(strip, rows[source.transformed])
                source.complete(first, last, rows)
                visit(band, first, last)

        run(transform_columns, range(0, columns, COLUMNS_AT_ONCE))
        bands = bands_of(grid.shape[0])
        run(transform_rows, range(len(bands)))
        along_y = source.count * columns / grid.half_shape[1]
        return round(grid.size * (along_y + len(parts[source.transformed])) / 2)

    def _source(self, depth: float, parts: Sequence[Part]) -> _SharedSpectra | _SurfaceSpectra | _Spectra:
        if tuple(parts) == ALL_PARTS and self._layer.height is None and not any(self._traction):
            if depth == 0 and self._fourier.grid == self._finest[0]:
                return _SurfaceSpectra(self._modes, self._fourier, self._pressure)
            return _SharedSpectra(depth, self._modes, self._fourier)
        return _Spectra(depth, self._modes, self._fourier, self._layer, parts, self._traction)


class _SharedSpectra:
    """Spectra of all parts A and B in a half-space, from fewer functions transformed along y.

    Attributes
    ----------
    count : int
        Number of functions to transform along y.
    transformed : slice
        Parts that are transformed along x.
    """

    count, transformed = SHARED_COLUMNS, slice(None)

    def __init__(self, depth: float, modes: Array, fourier: Fourier) -> None:
        grid, real = fourier.grid, fourier.real
        self._real, self._half_depth = real, real.type(0.5 * depth)
        self._mean = real.type(modes[0, 0].real)
        self._modes = modes.view(real)
        self._wavevectors = Wavevectors(
            *(q.astype(real) for q in (grid.qx, grid.qy, grid.odd_qx, grid.odd_qy))
        )

    def fill_columns(self, first: int, last: int, out: Array) -> None:
        """Fill `out` with some columns of the functions, to be transformed along y."""
        factors = np.empty((SHARED_COLUMNS, last - first), self._real)
        common = self._half_depth, self._modes, self._wavevectors
        shared_columns(*common, first, factors, out.view(self._real))

    def fill_rows(self, spectra: Array, first: int, last: int, out: Array, columns: int) -> None:
        """Fill `out` with some rows and the first columns of the parts, to be transformed along x."""
        wavevectors = self._wavevectors._replace(qx=self._wavevectors.qx[:columns])
        common = self._half_depth, self._mean, spectra.view(self._real), wavevectors
        all_parts(*common, first, last, out.view(self._real))

    def complete(self, first: int, last: int, out: Array) -> None:
        """Fill some rows of the parts that are not transformed."""


class _SurfaceSpectra:
    """Spectra of all parts A and B in the surface of a half-space; attributes as of `_SharedSpectra`.

    There σ_zz is minus the pressure, σ_yz and σ_xz are zero, and A_xx + A_yy = σ_zz, B_xx = 2 A_yy and
    B_xy = −2 A_xy but for the uniform mode: A_xx and A_xy alone are transformed.
    """

    count, transformed = 2, slice(0, 6, 5)

    def __init__(self, modes: Array, fourier: Fourier, pressure: Array) -> None:
        grid = fourier.grid
        square = grid.qx**2 + grid.qy[:, None] ** 2
        square[0, 0] = np.inf
        self._over_square = (modes / square).astype(modes.dtype)
        self._qx, self._odd_qx, self._odd_qy = (
            q.astype(fourier.real) for q in (grid.qx, grid.odd_qx, grid.odd_qy)
        )
        self._pressure, self._mean = pressure, fourier.real.type(modes[0, 0].real)

    def fill_columns(self, first: int, last: int, out: Array) -> None:
        """Fill `out` with some columns of the functions, to be transformed along y."""
        out[0] = self._over_square[:, first:last]
        np.multiply(self._odd_qy[:, None], out[0], out=out[1])

    def fill_rows(self, spectra: Array, first: int, last: int, out: Array, columns: int) -> None:
        """Fill `out` with some rows and the first columns of the parts, to be transformed along x."""
        np.multiply(-(self._qx**2), spectra[0, first:last], out=out[0])
        np.multiply(-self._odd_qx, spectra[1, first:last], out=out[1])

    def complete(self, first: int, last: int, out: Array) -> None:
        """Fill some rows of the parts that are not transformed."""
        xx, yy, zz, yz, xz, xy, slope_xx, slope_xy = out
        np.negative(self._pressure[first:last], out=zz, casting="same_kind")
        np.subtract(zz, xx, out=yy)
        yy += self._mean
        np.multiply(yy, 2, out=slope_xx)
        np.multiply(xy, -2, out=slope_xy)
        yz[...] = xz[...] = 0


class _Spectra:
    """Spectra of any parts, also under a shear traction; attributes as of `_SharedSpectra`."""

    transformed = slice(None)

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
        self.count = len(parts)
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

    def fill_rows(self, spectra: Array, first: int, last: int, out: Array, columns: int) -> None:
        """Fill `out` with some rows and the first columns of the parts, to be transformed along x."""
        out[:, :, :columns] = spectra[: self.count, first:last, :columns]

    def complete(self, first: int, last: int, out: Array) -> None:
        """Fill some rows of the parts that are not transformed."""
