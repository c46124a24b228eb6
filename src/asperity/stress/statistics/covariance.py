"""Covariances of Eq. 22: within a plane, and of planes with that of the largest von Mises stress."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from asperity.core.arguments import require_finite
from asperity.core.compiled import compiled, sums_without_nan
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, Grid, Work, resample
from asperity.stress.planes.fields import MARGIN

MOST_KEPT = 8
"""Planes above the reference that are kept while the largest value still rises from plane to plane."""

PACKED = {"float32": np.uint16, "float64": np.uint32}
"""Types of the whole numbers from 0 to the largest value in which planes are kept. Rounding, by 1e-5 or 2e-10
of the largest value, is averaged over all nodes: the error of a covariance is below 1e-6 or 1e-11 of it."""

SUMS = 4
"""Numbers of each row in `row_sums`."""

_BLOCK = 1024
"""Numbers that are summed in their own precision."""


class References:
    """For several fields, the plane with the largest value so far, and the covariance of all planes with it.

    The planes come one by one, each on a grid no finer than the one before. Those above the reference are
    kept as long as the largest value rises from every plane to the next, and compared with the reference
    when it no longer does. Where it rises again later, the planes above are to be added again.

    Parameters
    ----------
    fields, planes : int
        Number of fields, and of planes of the stream.
    finest : Grid
        Grid on which lags in a plane are sampled.
    threads : int
    work : Work
        Where transforms are counted.

    Attributes
    ----------
    number : (fields,) array
        Which plane of the stream is the reference of each field.
    covariance : (fields, planes) array
        Mean of the product of the fields of each plane and of the reference, less the product of their means.
    missing : (fields,) array
        Number of the uppermost planes that are to be added again.
    """

    def __init__(self, fields: int, planes: int, finest: Grid, threads: int, work: Work) -> None:
        self.number = np.zeros(fields, int)
        self.covariance = np.full((fields, planes), np.nan)
        self.missing = np.zeros(fields, int)
        self._finest, self._threads, self._work = finest, threads, work
        self._grid = finest
        self._fields = np.empty((0, 0, 0))
        self._largest, self._means = np.full(fields, -np.inf), np.zeros(fields)
        self._rising = np.full(fields, True)
        self._above: list[tuple[Array, Array]] = []
        self._modes: dict[int, tuple[Grid, Array]] = {}

    @property
    def is_rising(self) -> bool:
        """True while the next plane may become a reference whose planes above are all kept."""
        return bool(self._rising.any())

    def on(self, grid: Grid) -> Array:
        """The references on the grid of the next plane, (fields, ny, nx); none before the first plane."""
        if self._fields.size and grid != self._grid:
            self._end(np.flatnonzero(self._rising))
            fields = np.empty((self.number.size, *grid.shape), self._fields.dtype)
            for m, field in enumerate(fields):
                field[:] = self._resampled(m, grid)
                self._means[m] = self._modes[m][1][0, 0].real
            self._fields = fields
        self._grid = grid
        return self._fields

    def add(self, number: int, sums: Array, fields: Callable[[], Array]) -> None:
        """Add the next plane downward, given the sums of its rows with the references on its grid.

        It becomes the reference of the fields whose largest value is the largest so far.

        Parameters
        ----------
        number : int
        sums : (fields, ny, `SUMS`) array
            As of `row_sums`.
        fields : callable
            Returns the fields of the plane, (fields, ny, nx), which are kept if a largest value has risen.
        """
        size, (total, square, _, product) = self._grid.size, sums.sum(axis=1).T
        largest, mean = sums[:, :, 2].max(axis=1), total / size
        self.covariance[:, number] = product / size - mean * self._means
        has_risen = largest > self._largest
        risen = np.flatnonzero(has_risen)
        self._end(np.flatnonzero(self._rising & ~has_risen))
        if not risen.size:
            return
        if self.is_rising and self._fields.size:
            self._above.append(self._packed())
        if len(self._above) > MOST_KEPT:
            self._rising[:] = False
            self._above = []
        former, self._fields = self._fields, fields()
        for m in np.flatnonzero(~has_risen).tolist():
            self._fields[m] = former[m]
        self.number[risen], self._largest[risen], self._means[risen] = number, largest[risen], mean[risen]
        self.covariance[risen, number] = (square / size - mean * mean)[risen]
        for m in risen.tolist():
            self._modes.pop(m, None)
            self.missing[m] = 0 if self._rising[m] else number

    def _packed(self) -> tuple[Array, Array]:
        """The references in little memory: steps, (fields,), and numbers of steps."""
        packed = np.empty(self._fields.shape, PACKED[self._fields.dtype.name])
        steps = np.where(self._largest > 0, self._largest, 1.0) / np.iinfo(packed.dtype).max
        _pack(self._fields, (1 / steps).astype(self._fields.dtype), packed)
        return steps, packed

    def _end(self, fields: Array) -> None:
        """Compare the kept planes with the references of some fields, which have not risen further."""
        self._rising[fields] = False
        for m in fields.tolist():
            for above, (steps, packed) in enumerate(self._above):
                self.covariance[m, above] = steps[m] * _covariance(packed[m], self._fields[m])
        if not self.is_rising:
            self._above = []

    def _transformed(self, m: int) -> tuple[Grid, Array]:
        """The modes of a reference and their grid, that of the plane in which it was found."""
        if m not in self._modes:
            fourier = Fourier(self._grid, self._fields.dtype, self._threads, self._work)
            self._modes[m] = self._grid, fourier.forward(self._fields[m])
        return self._modes[m]

    def _resampled(self, m: int, grid: Grid) -> Array:
        """A reference on a grid."""
        source, modes = self._transformed(m)
        fourier = Fourier(grid, self._fields.dtype, self._threads, self._work)
        return fourier.inverse(resample(modes, source, grid), overwrite=True)

    def in_plane(self) -> tuple[Array, Array]:
        """Lags, (lags,), and the covariance of each reference within its plane, (fields, lags)."""
        lag, found = np.empty(0), []
        for m in range(self.number.size):
            source, modes = self._transformed(m)
            lag, covariance = autocovariance(modes, source, self._finest, self._threads, self._work)
            found.append(covariance)
        return lag, np.stack(found)

    def add_again(self, number: int, grid: Grid, fields: Array) -> None:
        """Compare a plane above some references that has not been compared, given its fields."""
        for m in np.flatnonzero(self.missing > number).tolist():
            self.covariance[m, number] = _covariance(fields[m], self._resampled(m, grid))


def row_sums(values: Array, columns: int, first: int, references: Array) -> Array:
    """Sum of each row of fields ≥ 0, sum of squares, largest value, and sum of products with references.

    Parameters
    ----------
    values : (fields, rows + 2, at least `MARGIN` + columns) array
        As of `asperity.stress.planes.fields.Fields.rows`, with one row more on both sides.
    columns, first : int
        Number of columns, and of the first row.
    references : (fields, ny, columns) array
        There may be fewer fields than in `values`: the products of the others are 0.

    Returns
    -------
    (fields, rows, `SUMS`) array
    """
    sums = np.zeros((values.shape[0], values.shape[1] - 2, SUMS))
    sums[:, :, 2] = values[:, 1:-1, MARGIN : MARGIN + columns].max(axis=2)
    _sum_rows(values, columns, first, references.astype(values.dtype, copy=False), sums)
    return sums


@sums_without_nan
def _sum_rows(values: Any, columns: int, first: int, references: Any, sums: Any) -> None:
    for m in range(sums.shape[0]):
        for j in range(sums.shape[1]):
            for start in range(0, columns, _BLOCK):
                stop = min(start + _BLOCK, columns)
                some = values[m, j + 1, MARGIN + start : MARGIN + stop]
                total = square = product = some[0] - some[0]
                for i in range(some.size):
                    total += some[i]
                    square += some[i] * some[i]
                if m < references.shape[0]:
                    other = references[m, first + j, start:stop]
                    for i in range(some.size):
                        product += some[i] * other[i]
                sums[m, j, 0] += total
                sums[m, j, 1] += square
                sums[m, j, 3] += product


@compiled
def _pack(fields: Any, per_step: Any, out: Any) -> None:
    """Fill `out` with fields ≥ 0 as whole numbers of steps."""
    for m in range(fields.shape[0]):
        factor, half = per_step[m], per_step.dtype.type(0.5)
        for j in range(fields.shape[1]):
            line, steps = fields[m, j], out[m, j]
            for i in range(line.size):
                steps[i] = line[i] * factor + half


def _covariance(one: Array, two: Array) -> float:
    """Mean of the product of two fields, less the product of their means."""
    mean_one, mean_two, product = _moments(one, two)
    return product - mean_one * mean_two


@sums_without_nan
def _moments(one: Any, two: Any) -> tuple[float, float, float]:
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


def autocorrelation(field: Array, grid: Grid, finest: Grid | None = None) -> tuple[Array, Array]:
    """Autocovariance of a plane field, averaged over directions.

    This is Eq. 22 within a plane, not normalised. It is computed from the power spectrum without the mean
    (theorem of Wiener and Khinchin).

    Parameters
    ----------
    field : (ny, nx) array
    grid : Grid
    finest : Grid, optional
        Grid of the same cell on which the lags are sampled; by default `grid`.

    Returns
    -------
    lag, covariance : (lags,) arrays
        Averages over rings of lag vectors, each ring one spacing of `finest` wide, from lag 0 (the
        variance) to half the shorter edge of the cell.

    Raises
    ------
    ValueError, TypeError
        If the field does not have the shape of the grid, or a value is not finite or larger than 1e75.

    Examples
    --------
    >>> grid = asp.Grid((64, 64))
    >>> height = asp.self_affine(grid.shape, 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> lag, covariance = asp.autocorrelation(height, grid)
    >>> print(f"{covariance[0]:.3e}, to half at {np.interp(-0.5, -covariance / covariance[0], lag):.2f}")
    1.000e-06, to half at 0.07
    """
    modes = Fourier(grid).forward(grid.field("field", field))
    lag, covariance = autocovariance(modes, grid, grid if finest is None else finest)
    require_finite("autocorrelation", {"lag": lag, "covariance": covariance})
    return lag, covariance


def autocovariance(
    modes: Array, grid: Grid, finest: Grid, threads: int = 1, work: Work | None = None
) -> tuple[Array, Array]:
    """Lags and covariance as of `autocorrelation`, from the coefficients of the field."""
    power = modes.real**2 + modes.imag**2
    power[0, 0] = 0
    if grid != finest:
        power = resample(power, grid, finest)
    fourier = Fourier(finest, power.dtype, threads, Work() if work is None else work)
    covariance = fourier.inverse(power)
    width = min(finest.spacing)
    rings = int(min(finest.length) / 2 / width + 1e-9) + 1
    along_y, along_x = (
        (np.minimum(axis, length - axis) / width) ** 2
        for axis, length in zip(finest.coordinates(), finest.length, strict=True)
    )
    # The lags (y, x) and (−y, −x) have the same value: half of the rows are enough.
    rows = along_y.size // 2 + 1
    weight = np.full(rows, 2.0)
    weight[0] = 1.0
    if along_y.size % 2 == 0:
        weight[-1] = 1.0
    ring = np.minimum(np.sqrt(along_y[:rows, None] + along_x) + 0.5, rings).astype(np.int64).ravel()
    total = np.bincount(ring, (weight[:, None] * covariance[:rows]).ravel())
    count = np.bincount(ring, np.repeat(weight, along_x.size))
    return width * np.arange(rings), total[:rings] / count[:rings]


def half_length(distance: Array, correlation: Array) -> float:
    """Distance at which a correlation first falls to one half, by linear interpolation; NaN if never."""
    fallen = np.flatnonzero(correlation <= 0.5)
    if not fallen.size or fallen[0] == 0:
        return float("nan")
    i = int(fallen[0])
    return float(np.interp(0.5, correlation[[i, i - 1]], distance[[i, i - 1]]))


def decay_lengths(profiles: xr.Dataset, prefix: str = "") -> tuple[Array, Array]:
    """Distances over which the covariance of Eq. 22 falls to half, below the reference plane and in it.

    Parameters
    ----------
    profiles : dataset
        An analysis of the stress, or means of several.
    prefix : str
        Of the names of its covariances.

    Returns
    -------
    along_depth, in_plane : (ratios,) arrays
    """
    depth, lag = profiles["plane_depth"].values, profiles["lag"].values
    names = f"{prefix}covariance_depth", f"{prefix}covariance_plane", "reference_depth"
    lengths = []
    for along_depth, in_plane, reference in zip(*(profiles[name].values for name in names), strict=True):
        below = depth >= reference
        below_reference = half_length(depth[below] - reference, along_depth[below] / in_plane[0])
        lengths.append((below_reference, half_length(lag, in_plane / in_plane[0])))
    found = np.array(lengths).T
    return found[0], found[1]
