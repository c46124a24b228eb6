"""Basis fields of the stress in planes under a periodic pressure, transformed from its modes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from asperity.core.compiled import compiled
from asperity.core.parallel import results_of
from asperity.core.types import Array
from asperity.elasticity.layer import Kernels, ShearKernels
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.fourier.grid import Fourier, Grid, Work, resample
from asperity.stress.planes.fields import BasisField
from asperity.stress.planes.truncation import PlaneGrid, Truncation

COLUMNS_AT_ONCE = 64
"""Columns of modes whose spectra stay in the processor's cache until they are transformed along y."""


class _Term(NamedTuple):
    """A factor of some columns of the pressure modes.

    Parameters
    ----------
    factor : (ny // 2 + 1, columns) array
        Of the modes with ky ≥ 0.
    odd : bool
        True if the factor of −ky has the opposite sign.
    imaginary : bool
        True if the factor is to be multiplied by the imaginary unit.
    """

    factor: Array
    odd: bool
    imaginary: bool


class _Directions(NamedTuple):
    """Components of the unit wavevectors of some columns of modes with ky ≥ 0, and of factors odd in them."""

    c: Array
    s: Array
    odd_c: Array
    odd_s: Array


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
        truncation = Truncation(modes, solid.grid, solid.layer, tolerance, envelope)
        self.plan = [truncation.choose(depth) for depth in depths]
        self.mean_pressure = float(modes[0, 0].real)
        self.dtype = np.dtype(dtype)
        self._finest = solid.grid, modes.astype(np.result_type(self.dtype, np.complex64), copy=False)
        self._use(solid.grid)

    def _use(self, grid: Grid) -> None:
        """Resample the modes of the pressure to a grid."""
        self._fourier = Fourier(grid, self.dtype)
        self._modes = resample(self._finest[1], self._finest[0], grid)
        self._wavenumber = grid.half_wavenumber().astype(self.dtype)

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

        def transform_columns(first: int) -> None:
            columns = slice(first, min(first + COLUMNS_AT_ONCE, own.columns))
            engine.inverse_along_y(self._spectra(depth, fields, columns), spectra[:, :, columns])

        def transform_rows(number: int) -> None:
            spectra[number, :, own.columns :] = 0
            engine.inverse_along_x(spectra[number], values[number, :, :nx])

        starts = range(0, own.columns, COLUMNS_AT_ONCE)
        results_of([partial(transform_columns, first) for first in starts], self._threads)
        results_of([partial(transform_rows, number) for number in range(len(fields))], self._threads)
        self._work.nodes += round(len(fields) * grid.size * (1 + own.columns / grid.half_shape[1]) / 2)

    def _spectra(self, depth: float, fields: Sequence[BasisField], columns: slice) -> Array:
        """Some columns of the coefficients of the basis fields, (fields, ny, columns)."""
        grid, q = self._fourier.grid, self._wavenumber[:, columns]
        rows = q.shape[0]
        kernels = self._layer.kernels(q, depth)
        over_q = 1 / np.where(q > 0, q, np.inf)
        components = grid.qx[columns], grid.qy[:rows, None], grid.odd_qx[columns], grid.odd_qy[:rows, None]
        directions = _Directions(*(component.astype(self.dtype) * over_q for component in components))
        shear_kernels = self._layer.shear_kernels(q, depth) if any(self._traction) else None
        spectra = np.empty((len(fields), grid.shape[0], q.shape[1]), self._modes.dtype)
        numbers = np.ascontiguousarray(self._modes[:, columns]).view(self.dtype)
        for field, spectrum in zip(fields, spectra, strict=True):
            terms = [*self._pressure_terms(field, kernels, directions)]
            if shear_kernels is not None:
                terms += self._traction_terms(field, shear_kernels, directions)
            _multiply(*terms[0], numbers, spectrum.view(self.dtype))
            for term in terms[1:]:
                product = np.empty_like(spectrum)
                _multiply(*term, numbers, product.view(self.dtype))
                spectrum += product
            if columns.start == 0:
                spectrum[0, 0] = self._mean(field)
        return spectra

    def _mean(self, field: BasisField) -> float:
        """The mean of a basis field."""
        traction = dict(zip(("xz", "yz"), self._traction, strict=True))
        return field.constant * self.mean_pressure * {"zz": -1.0, **traction}.get(field.component, 0.0)

    def _pressure_terms(
        self, field: BasisField, kernels: Kernels, directions: _Directions
    ) -> Iterator[_Term]:
        """Factors of the pressure, with the kernels Z, L and T of `Layer.grid_kernels`."""
        component, a, b = field
        c, s, odd_c, odd_s = directions
        z, along = kernels.normal, kernels.longitudinal
        if component == "zz":
            yield _Term(-a * z, False, False)
        elif component == "xz":
            yield _Term(-a * odd_c * kernels.shear, False, True)
        elif component == "yz":
            yield _Term(-a * odd_s * kernels.shear, True, True)
        elif component == "xy":
            yield _Term(odd_c * odd_s * (b * (z + along) - a * along), True, False)
        else:
            own, other = (c, s) if component == "xx" else (s, c)
            yield _Term(-(a * own * own * along + b * other * other * (z + along)), False, False)

    def _traction_terms(
        self, field: BasisField, kernels: ShearKernels, directions: _Directions
    ) -> Iterator[_Term]:
        """Factors of the pressure under a shear traction, with N, M, X, P and Q of `grid_shear_kernels`.

        The traction on the surface is t = (friction_x, friction_y) p; the equations are in
        ``docs/method.md``. The terms in friction_x and friction_y differ in their parity in ky.
        """
        component, a, b = field
        friction_x, friction_y = self._traction
        c, s, odd_c, odd_s = directions
        cc, ss = c * c, s * s
        n, m, x, t, turn = kernels
        if component in ("xz", "yz"):
            own, other = (friction_x, friction_y) if component == "xz" else (friction_y, friction_x)
            first, second = (cc, ss) if component == "xz" else (ss, cc)
            yield _Term(a * own * (first * x + second * t), False, False)
            yield _Term(a * other * odd_c * odd_s * (x - t), True, False)
        elif component == "xy":
            across = a * (ss * m + (cc - ss) * turn) - b * ss * (n + m)
            yield _Term(friction_y * odd_c * across, False, True)
            across = a * (cc * m - (cc - ss) * turn) - b * cc * (n + m)
            yield _Term(friction_x * odd_s * across, True, True)
        else:
            along_x = {"zz": a * n, "xx": a * (cc * m + 2 * ss * turn) + b * ss * (n + m)}
            along_y = {"zz": a * n, "xx": a * (cc * m - 2 * cc * turn) + b * ss * (n + m)}
            along_x["yy"] = a * (ss * m - 2 * ss * turn) + b * cc * (n + m)
            along_y["yy"] = a * (ss * m + 2 * cc * turn) + b * cc * (n + m)
            yield _Term(friction_x * odd_c * along_x[component], False, True)
            yield _Term(friction_y * odd_s * along_y[component], True, True)


@compiled
def _multiply(factor: Any, odd: bool, imaginary: bool, modes: Any, out: Any) -> None:
    """Fill `out` with the product of a `_Term` and modes, real and imaginary parts in turn."""
    for j in range(out.shape[0]):
        line, own, into = factor[min(j, out.shape[0] - j)], modes[j], out[j]
        sign = line.dtype.type(-1 if odd and 2 * j > out.shape[0] else 1)
        if imaginary:
            for i in range(line.size):
                into[2 * i] = -sign * line[i] * own[2 * i + 1]
                into[2 * i + 1] = sign * line[i] * own[2 * i]
        else:
            for i in range(line.size):
                into[2 * i] = sign * line[i] * own[2 * i]
                into[2 * i + 1] = sign * line[i] * own[2 * i + 1]
