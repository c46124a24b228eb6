"""The one place for the discrete Fourier convention: grids, wavevectors, transforms, resampling.

Convention
----------
A periodic field ``f[y, x]`` on a grid of ``shape = (ny, nx)`` nodes over a cell of
``length = (length_y, length_x)`` has the coefficients ``f̂[ky, kx]`` with

    f(r) = Σ_q f̂(q) exp(+i q·r),     f̂(q) = (1 / (ny nx)) Σ_r f(r) exp(−i q·r),

so that ``f̂(0)`` is the mean and ``Σ_q |f̂(q)|²`` the mean square. Every pair (shape, length, spacing)
is in array order, y before x. The fields are real, and only the half ``kx ≥ 0`` of the coefficients
is stored: shape ``(ny, nx // 2 + 1)``. A sum over all q is a sum over the stored columns weighted
with `Grid.multiplicity`.

Nyquist rule
------------
On an even axis the coefficient at the Nyquist wavevector stands for a cosine alone. A factor odd in
that component of q (a first derivative, a shear stress) is zero there: `Grid.odd_qx` and
`Grid.odd_qy` are the wavevectors with that rule applied, ``qx`` and ``qy`` without it. `resample`
keeps the modes strictly below the Nyquist wavevector of both grids, and no others.

Transforms
----------
`Fourier` wraps ducc0 in double or single precision and counts the work done. There is no planning,
and the lines of a grid are transformed in blocks that do not depend on the number of threads: the
same bits in every run and for every number of threads.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Any

import ducc0
import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from asperity.types import Array

REAL_TYPES = (np.dtype(np.float32), np.dtype(np.float64))

# Lines are transformed a vector register at a time and the remainder one by one, which rounds
# differently; whole blocks leave no remainder in any thread.
_BLOCK = 128

# Rows this many bytes apart share the same lines of the processor's cache: writing several of them at once
# in single precision takes three times as long as through rows that are `_PADDING` numbers longer.
_CRITICAL_STRIDE = 4096
_PADDING = 16


@dataclass(frozen=True)
class Grid:
    """A periodic rectangular grid.

    Parameters
    ----------
    shape : (ny, nx)
        Number of nodes on each axis, even or odd, at least one.
    length : float or (length_y, length_x)
        Edges of the cell; one number for a square cell.

    Raises
    ------
    ValueError
        If a number of nodes or an edge is not positive and finite.
    """

    shape: tuple[int, int]
    length: tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        shape = tuple(self.shape)
        if len(shape) != 2 or any(n != int(n) or n < 1 for n in shape):
            raise ValueError(f"shape = {self.shape!r}: two positive whole numbers (ny, nx) are needed")
        length = np.broadcast_to(np.asarray(self.length, dtype=float), (2,))
        if not (np.all(np.isfinite(length)) and np.all(length > 0)):
            raise ValueError(f"length = {self.length!r}: positive finite edges are needed")
        object.__setattr__(self, "shape", (int(shape[0]), int(shape[1])))
        object.__setattr__(self, "length", (float(length[0]), float(length[1])))

    @property
    def size(self) -> int:
        """Number of nodes."""
        return self.shape[0] * self.shape[1]

    @property
    def area(self) -> float:
        """Area of the cell."""
        return self.length[0] * self.length[1]

    @property
    def spacing(self) -> tuple[float, float]:
        """Distance between nodes along y and x."""
        return self.length[0] / self.shape[0], self.length[1] / self.shape[1]

    @property
    def half_shape(self) -> tuple[int, int]:
        """Shape of the stored half of the coefficients."""
        return self.shape[0], self.shape[1] // 2 + 1

    @cached_property
    def kx(self) -> Array:
        """Integer wavenumbers of the columns, (nx // 2 + 1,)."""
        return np.arange(self.shape[1] // 2 + 1)

    @cached_property
    def ky(self) -> Array:
        """Integer wavenumbers of the rows, (ny,): zero, the positive ones, the negative ones."""
        ny = self.shape[0]
        rows = np.arange(ny)
        return np.where(rows <= ny // 2, rows, rows - ny)

    @cached_property
    def qx(self) -> Array:
        """Wavevector components of the columns, (nx // 2 + 1,)."""
        return 2 * np.pi / self.length[1] * self.kx

    @cached_property
    def qy(self) -> Array:
        """Wavevector components of the rows, (ny,)."""
        return 2 * np.pi / self.length[0] * self.ky

    @cached_property
    def odd_qx(self) -> Array:
        """`qx` with the Nyquist column zero: the factor of anything odd in qx."""
        return np.where(2 * self.kx == self.shape[1], 0.0, self.qx)

    @cached_property
    def odd_qy(self) -> Array:
        """`qy` with the Nyquist row zero: the factor of anything odd in qy."""
        return np.where(2 * self.ky == self.shape[0], 0.0, self.qy)

    @cached_property
    def multiplicity(self) -> Array:
        """How many modes each stored column stands for, (nx // 2 + 1,): one or two."""
        return np.where((self.kx == 0) | (2 * self.kx == self.shape[1]), 1.0, 2.0)

    def wavenumber(self) -> Array:
        """|q| of every stored mode, (ny, nx // 2 + 1)."""
        return np.hypot(self.qy[:, None], self.qx[None, :])

    def coordinates(self) -> tuple[Array, Array]:
        """Positions y, (ny,), and x, (nx,), of the nodes."""
        spacing_y, spacing_x = self.spacing
        return spacing_y * np.arange(self.shape[0]), spacing_x * np.arange(self.shape[1])


@dataclass
class Work:
    """Transforms done so far, counted in nodes: the common currency of solvers and planes."""

    nodes: int = 0

    def transforms(self, grid: Grid) -> float:
        """Real transforms of `grid` that would have cost as much."""
        return self.nodes / grid.size

    def pairs(self, grid: Grid) -> float:
        """Pairs of a forward and an inverse transform of `grid` that would have cost as much."""
        return self.nodes / (2 * grid.size)


@dataclass
class Fourier:
    """Real transforms on one grid, in one precision, on a number of threads.

    Parameters
    ----------
    grid : Grid
    dtype : "float64" or "float32"
        Precision of the fields; the coefficients are complex of the same precision.
    threads : int
        The result does not depend on it.
    work : Work, optional
        Where the work done is added; several grids may share one.
    """

    grid: Grid
    dtype: DTypeLike = "float64"
    threads: int = 1
    work: Work = field(default_factory=Work)

    def __post_init__(self) -> None:
        self.real: np.dtype[Any] = np.dtype(self.dtype)
        if self.real not in REAL_TYPES:
            raise ValueError(f"dtype = {self.dtype!r}: float64 or float32 is needed")
        self.complex: np.dtype[Any] = np.result_type(self.real, np.complex64)

    def forward(self, values: Array, out: Array | None = None) -> Array:
        """Coefficients f̂ of the field `values[y, x]`."""
        self.work.nodes += self.grid.size
        values = np.asarray(values, dtype=self.real)
        if out is None:
            out = np.empty(self.grid.half_shape, self.complex)
        for rows, threads in self._blocks(self.grid.shape[0]):
            ducc0.fft.r2c(values[rows], axes=(1,), forward=True, inorm=2, out=out[rows], nthreads=threads)
        for columns, threads in self._blocks(out.shape[1]):
            part = out[:, columns]
            ducc0.fft.c2c(part, axes=(0,), forward=True, inorm=2, out=part, nthreads=threads)
        return out

    def inverse(self, coefficients: Array, out: Array | None = None, overwrite: bool = False) -> Array:
        """Field f[y, x] of the `coefficients`, which `overwrite` gives up as working space."""
        self.work.nodes += self.grid.size
        if out is None:
            out = np.empty(self.grid.shape, self.real)
        coefficients = np.asarray(coefficients, dtype=self.complex)
        columnwise = coefficients if overwrite else np.empty_like(coefficients)
        for columns, threads in self._blocks(coefficients.shape[1]):
            ducc0.fft.c2c(
                coefficients[:, columns],
                axes=(0,),
                forward=False,
                out=columnwise[:, columns],
                nthreads=threads,
            )
        ny, nx = self.grid.shape
        padded = out.strides[0] % _CRITICAL_STRIDE == 0 and self.real == np.float32
        room = np.empty((_BLOCK, nx + _PADDING), self.real)[:, :nx] if padded else None
        for rows, threads in self._blocks(ny, _BLOCK if padded else None):
            target = out[rows] if room is None else room[: rows.stop - rows.start]
            ducc0.fft.c2r(
                columnwise[rows],
                axes=(1,),
                lastsize=nx,
                forward=False,
                out=target,
                nthreads=threads,
                allow_overwriting_input=True,
            )
            if room is not None:
                out[rows] = target
        return out

    def _blocks(self, lines: int, most: int | None = None) -> list[tuple[slice, int]]:
        """Lines to transform together, at most so many, each part with its number of threads."""
        whole = lines - lines % _BLOCK
        edges = [*range(0, whole, most or whole or 1), whole]
        parts = [(slice(start, stop), self.threads) for start, stop in pairwise(edges)]
        return [*parts, (slice(whole, lines), 1)] if whole < lines else parts


def good_size(minimum: int, even: bool = True) -> int:
    """Smallest number of nodes ≥ `minimum` whose transform is fast, even if asked."""
    step = 2 if even else 1
    return step * int(ducc0.fft.good_size(-(-int(minimum) // step), True))


def resample(coefficients: Array, source: Grid, target: Grid) -> Array:
    """Coefficients of the same field on another grid of the same cell.

    Modes strictly below the Nyquist wavevector of both grids are kept, all others are zero: exact
    when refining a field without Nyquist modes, a spectral truncation when coarsening.
    """
    if source.length != target.length:
        raise ValueError(f"resample: cells differ, {source.length} and {target.length}")
    if source.shape == target.shape:
        return coefficients.copy()
    out = np.zeros(target.half_shape, coefficients.dtype)
    rows = (min(source.shape[0], target.shape[0]) - 1) // 2
    columns = (min(source.shape[1], target.shape[1]) - 1) // 2 + 1
    out[: rows + 1, :columns] = coefficients[: rows + 1, :columns]
    if rows:
        out[-rows:, :columns] = coefficients[-rows:, :columns]
    return out


def mean_square(coefficients: Array, grid: Grid, weight: ArrayLike = 1.0) -> float:
    """⟨f²⟩ by Parseval, with an optional `weight` for each stored mode."""
    power = (coefficients.real.astype(float) ** 2 + coefficients.imag.astype(float) ** 2) * weight
    return float(np.sum(power @ grid.multiplicity))


def gradient(coefficients: Array, fourier: Fourier) -> tuple[Array, Array]:
    """Fields ∂f/∂y and ∂f/∂x, by spectral differentiation with the Nyquist rule."""
    grid = fourier.grid
    slope_y = fourier.inverse(1j * grid.odd_qy[:, None] * coefficients, overwrite=True)
    slope_x = fourier.inverse(1j * grid.odd_qx[None, :] * coefficients, overwrite=True)
    return slope_y, slope_x


def radial_average(values: Array, grid: Grid) -> tuple[Array, Array]:
    """Average of a quantity of the stored modes over rings of |q|.

    Parameters
    ----------
    values : (ny, nx // 2 + 1) array
        One real number for each stored mode.
    grid : Grid

    Returns
    -------
    wavenumber, average : (rings,) arrays
        Rings are one fundamental wavenumber (of the longer edge) wide, centred on its multiples, the
        mode q = 0 left out, up to the largest |q| that every direction reaches.
    """
    width = 2 * np.pi / max(grid.length)
    rings = int(min(grid.qx[-1], np.abs(grid.qy).max()) / width + 1e-9)
    ring = np.rint(grid.wavenumber() / width).astype(np.int64)
    weight = np.broadcast_to(grid.multiplicity, grid.half_shape)
    kept = ring <= rings
    count = np.bincount(ring[kept], weight[kept], minlength=rings + 1)
    total = np.bincount(ring[kept], (weight * values)[kept], minlength=rings + 1)
    filled = np.flatnonzero(count[1:]) + 1
    return width * filled, total[filled] / count[filled]
