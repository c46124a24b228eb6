"""Covariances of Eq. 22: within a plane, and of planes with the plane of the maximum von Mises stress."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from asperity.core.arguments import require_finite
from asperity.core.compiled import compiled, vectorised_sums_without_nan
from asperity.core.parallel import run_tasks
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, Grid, Work, resample
from asperity.stress.planes.fields import NODES_AT_ONCE, PACKED, PERIODIC, ROW_MARGIN, PlaneFields

MOST_KEPT = 8
"""Planes above the reference that are kept while the largest value still rises from plane to plane."""


class References:
    """For several fields, the plane with the largest value so far, and the covariance of all planes with it.

    The planes come one by one, each on a grid no finer than the one before. Planes above the reference are
    kept as long as the largest value rises from every plane to the next, and compared with the reference when
    it no longer does. Where it rises again later, or none is kept, the planes above are to be added again.

    Parameters
    ----------
    fields, planes : int
        Number of fields, and of planes of the stream.
    finest : Grid
        Grid on which lags in a plane are sampled.
    dtype : "float32" | "float64"
        Precision of the planes.
    keeps : bool
        True if there is memory for planes above the reference, and for the modes of the references.
    threads : int
    work : Work
        Where transforms are counted.

    Attributes
    ----------
    number : (fields,) array
        Number of the plane of the stream that is the reference of each field.
    covariance : (fields, planes) array
        Mean of the product of the fields of each plane and of the reference, less the product of their means.
    missing : (fields,) array
        Number of the uppermost planes that are to be added again.
    """

    def __init__(
        self, fields: int, planes: int, finest: Grid, dtype: Any, keeps: bool, threads: int, work: Work
    ) -> None:
        self.number = np.zeros(fields, int)
        self.covariance = np.full((fields, planes), np.nan)
        self.missing = np.zeros(fields, int)
        self._finest, self._real, self._keeps = finest, np.dtype(dtype), keeps
        self._threads, self._work = threads, work
        self._grid = finest
        self._packed = np.empty((0, 1, 1), PACKED[self._real.name])
        self._largest, self._means, self._steps = np.full(fields, -np.inf), np.zeros(fields), np.ones(fields)
        self._rising = np.full(fields, keeps)
        self._above: list[list[tuple[float, float, Array]]] = [[] for _ in range(fields)]
        self._own: dict[int, tuple[Grid, Array, float, float]] = {}
        self._modes: dict[int, tuple[Grid, Array]] = {}
        self._in_plane: dict[int, Array] = {}

    def on(self, grid: Grid, memory: Array) -> Array:
        """The references on the grid of a plane in steps, (fields, ny, nx); none before the first plane.

        `memory` is the array in which the plane will be computed; until then it serves as working memory.
        """
        if len(self._packed) and grid != self._grid:
            self._end(np.flatnonzero(self._rising))
            former, is_settled = self._packed, len(self._in_plane) == self.number.size
            if is_settled:  # each field takes the place of those before it
                packed = former.reshape(-1)[: len(former) * grid.size].reshape(-1, *grid.shape)
            else:
                packed = np.empty((len(former), *grid.shape), former.dtype)
            fourier = Fourier(grid, self._real, self._threads, self._work)
            numbers = memory.reshape(-1)
            if numbers.size < grid.size + 3 * self._grid.size:
                numbers = np.empty(grid.size + 3 * max(self._grid.size, self._finest.size), self._real)
            field, numbers = numbers[: grid.size].reshape(grid.shape), numbers[grid.size :]
            for m in range(self.number.size):
                source, own, step, mean = self._grid, former[m], self._steps[m], self._means[m]
                if not is_settled:
                    source, own, step, mean = self._own.setdefault(m, (source, own, step, mean))
                if source == grid:
                    packed[m], self._steps[m], self._means[m] = own, step, mean
                else:
                    source, modes = self._transformed(m, grid.size > self._grid.size, numbers)
                    field = fourier.inverse(resample(modes, source, grid), field, overwrite=True)
                    largest = max(field.max(), -field.min())
                    self._fill(packed, [m], largest, PlaneFields.of_array(field, (PERIODIC, PERIODIC)))
            self._packed = packed
        self._grid = grid
        return self._packed

    def add(self, number: int, sums: Array, fields: Callable[[list[int]], PlaneFields]) -> None:
        """Add the next plane downward, given the sums of its rows with the references on its grid.

        It becomes the reference of the fields whose largest value is the largest so far.

        Parameters
        ----------
        number : int
        sums : (fields, ny, `SUMS`) array
            As of `asperity.stress.peaks.search.PlaneSearch`.
        fields : callable
            Returns some of the fields of the plane, which are kept if their largest value has risen.
        """
        size, (total, square, _, _) = self._grid.size, sums.sum(axis=1).T
        largest, mean = sums[:, :, 2].max(axis=1), total / size
        self.compare(number, sums, np.ones(largest.size, bool))
        has_risen = largest > self._largest
        risen = np.flatnonzero(has_risen).tolist()
        self._end(np.flatnonzero(self._rising & ~has_risen))
        if not risen:
            return
        if not len(self._packed):
            self._packed = np.empty((largest.size, *self._grid.shape), self._packed.dtype)
        for m in np.flatnonzero(self._rising & (number > 0)).tolist():
            if len(self._above[m]) == MOST_KEPT:
                self._rising[m], self._above[m] = False, []
            else:
                self._above[m].append((self._steps[m], self._means[m], self._packed[m].copy()))
        self._largest[risen] = largest[risen]
        self._fill(self._packed, risen, largest[risen], fields(risen))
        self.number[risen] = number
        self.covariance[risen, number] = (square / size - mean * mean)[risen]
        self.missing[risen] = np.where(self._rising[risen], 0, number)
        for m in risen:
            self._modes.pop(m, None)
            self._own.pop(m, None)
            self._in_plane.pop(m, None)

    def compare(self, number: int, sums: Array, chosen: Array) -> None:
        """Set the covariances of a plane, given the sums of its rows with the references on its grid."""
        size = self._grid.size
        total, product = sums[chosen, :, 0].sum(axis=1), sums[chosen, :, 3].sum(axis=1) * self._steps[chosen]
        self.covariance[chosen, number] = (product - total * self._means[chosen]) / size

    def _fill(self, packed: Array, places: list[int], largest: Any, fields: PlaneFields) -> None:
        """Write fields to their places in `packed`, in steps that follow from their largest values."""
        steps = np.where(largest > 0, largest, 1.0) / np.iinfo(packed.dtype).max
        per_step, which = np.atleast_1d(1 / steps).astype(self._real), np.array(places)
        strip = max(1, 2 * NODES_AT_ONCE // packed.shape[2])

        def fill(first: int) -> Array:
            sums = np.zeros(which.size, np.int64)
            values = fields.rows(first, min(first + strip, packed.shape[1]))
            _pack(values, per_step, which, first, packed, sums)
            return sums

        tasks = [partial(fill, first) for first in range(0, packed.shape[1], strip)]
        sums = np.sum(run_tasks(tasks, self._threads), axis=0)
        self._steps[places], self._means[places] = steps, steps * sums / packed[0].size

    def _end(self, fields: Array) -> None:
        """Compare the kept planes with the references of some fields, which have not risen further."""
        self._rising[fields] = False
        for m in fields.tolist():
            for above, (step, mean, packed) in enumerate(self._above[m]):
                product = step * self._steps[m] * _mean_product(packed, self._packed[m])
                self.covariance[m, above] = product - mean * self._means[m]
            self._above[m] = []

    def _transformed(self, m: int, finer: bool, memory: Array | None = None) -> tuple[Grid, Array]:
        """Modes and grid of a reference: if `finer`, on the grid of its plane, else on the present one."""
        if m in self._modes:
            return self._modes[m]
        grid, packed, step = self._grid, self._packed[m], self._steps[m]
        if finer and m in self._own:
            grid, packed, step, _ = self._own[m]
        fourier = Fourier(grid, self._real, self._threads, self._work)
        out = field = None
        if memory is not None:
            numbers = fourier.coefficient_type.itemsize // self._real.itemsize  # of a coefficient
            start = numbers * grid.mode_shape[0] * grid.mode_shape[1]
            field = memory[start : start + grid.size].reshape(grid.shape)
            if not self._keeps:
                out = memory[:start].view(fourier.coefficient_type).reshape(grid.mode_shape)
        field = np.multiply(packed, self._real.type(step), out=field)
        found = grid, fourier.forward(field, out)
        if self._keeps:
            self._modes[m] = found
        return found

    def settle(self, memory: Array) -> None:
        """Compute the covariances within the reference planes, which are on the present grid.

        No plane may be missing. The references on the present grid are then no longer needed, unless a larger
        value is found in a deeper plane.
        `memory` is as of `on`.
        """
        self.missing[:] = 0
        self._in_plane = dict(enumerate(self.in_plane(memory.reshape(-1))[1]))

    def in_plane(self, memory: Array | None = None) -> tuple[Array, Array]:
        """Lags, (lags,), and the covariance of each reference within its plane, (fields, lags)."""
        rings, found = _Rings(self._finest), []
        for m in range(self.number.size):
            if m not in self._in_plane:
                source, modes = self._transformed(m, True, memory)
                free = None if memory is None else memory[modes.nbytes // memory.itemsize :]
                found.append(rings.autocovariance(modes, source, self._threads, self._work, free))
            else:
                found.append(self._in_plane[m])
        return rings.lag, np.stack(found)


@compiled
def _pack(values: Any, per_step: Any, which: Any, first: int, out: Any, sums: Any) -> None:
    """Round fields to whole numbers of steps, into rows of `out` from `first` on, and add them to `sums`."""
    for n in range(which.size):
        factor = per_step[n]
        for j in range(values.shape[1]):
            steps = out[which[n], first + j]
            line = values[n, j, ROW_MARGIN : ROW_MARGIN + steps.size]
            for i in range(steps.size):
                steps[i] = np.rint(line[i] * factor)
            total = 0
            for i in range(steps.size):
                total += steps[i]
            sums[n] += total


@vectorised_sums_without_nan
def _mean_product(one: Any, two: Any) -> float:
    """Mean of the product of two fields of whole numbers."""
    total = 0.0
    for j in range(one.shape[0]):
        product = 0.0
        for i in range(one.shape[1]):
            product += float(one[j, i]) * float(two[j, i])
        total += product
    return total / one.size


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
        variance) to half the shorter period, on a mirrored map its shorter edge.

    Raises
    ------
    ValueError, TypeError
        If the field does not have the shape of the grid, or a value is not finite or larger than 1e75.

    Examples
    --------
    >>> grid = asp.Grid((64, 64))
    >>> height = asp.self_affine(grid.shape, 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> lag, covariance = asp.stress.autocorrelation(height, grid)
    >>> print(f"{covariance[0]:.3e}, to half at {np.interp(-0.5, -covariance / covariance[0], lag):.2f}")
    1.000e-06, to half at 0.07
    """
    modes = Fourier(grid).forward(grid.field("field", field))
    rings = _Rings(grid if finest is None else finest)
    covariance = rings.autocovariance(modes, grid)
    require_finite("autocorrelation", {"lag": rings.lag, "covariance": covariance})
    return rings.lag, covariance


class _Rings:
    """Rings of lag vectors of a grid, and the autocovariances that are averaged over them."""

    def __init__(self, grid: Grid) -> None:
        self._grid, width, cell = grid, min(grid.spacing), grid.whole_cell
        self.lag = width * np.arange(int(min(cell.length) / 2 / width + 1e-9) + 1)
        self._squares, self._weights = [], []
        # The lags (y, x) and (−y, −x) have the same value: half of the rows are enough. On a mirrored map
        # half of the columns are enough, too.
        for axis, is_halved in enumerate((True, grid.images[1] == 2)):
            lags, length = cell.coordinates()[axis], cell.length[axis]
            weight = np.ones(lags.size)
            if is_halved:
                lags, weight = lags[: lags.size // 2 + 1], np.full(lags.size // 2 + 1, 2.0)
                weight[0] = 1.0
                if cell.shape[axis] % 2 == 0:
                    weight[-1] = 1.0
            self._squares.append((np.minimum(lags, length - lags) / width) ** 2)
            self._weights.append(weight)

    def autocovariance(
        self,
        modes: Array,
        source: Grid,
        threads: int = 1,
        work: Work | None = None,
        memory: Array | None = None,
    ) -> Array:
        """Covariance of a field at the lags, from its coefficients on the grid `source`.

        They are written over, and the covariance in the plane to `memory`, if that is given.
        """
        power = modes.copy() if memory is None else modes
        rows = max(1, NODES_AT_ONCE // power.shape[1])
        for start in range(0, len(power), rows):
            power[start : start + rows] *= np.conj(power[start : start + rows])
        power[0, 0] = 0
        if source != self._grid:
            power = resample(power, source, self._grid)
        fourier = Fourier(self._grid, power.real.dtype, threads, Work() if work is None else work)
        out = None if memory is None else memory[: self._grid.size].reshape(self._grid.shape)
        if self._grid.mirrored:
            # The nodes are half a spacing from the mirror line, lags are whole spacings: a wave at a lag is
            # the mean of its values half a spacing before and after it over cos(q spacing/2).
            (step_y, step_x), grid = self._grid.spacing, self._grid
            power /= np.outer(np.cos(grid.qy * step_y / 2), np.cos(grid.qx * step_x / 2))
        covariance = fourier.inverse(power, out, overwrite=True)
        if self._grid.mirrored:
            for _ in range(2):  # along y, then along x
                covariance = np.pad(covariance, ((1, 1), (0, 0)), "edge")
                covariance = (0.5 * (covariance[1:] + covariance[:-1])).T
        sums = np.zeros((2, self.lag.size + 1))
        (along_y, along_x), (weight_y, weight_x) = self._squares, self._weights
        _sum_rings(covariance, along_y, along_x, weight_y, weight_x, sums)
        return sums[0, :-1] / sums[1, :-1]


@compiled
def _sum_rings(values: Any, along_y: Any, along_x: Any, weight_y: Any, weight_x: Any, out: Any) -> None:
    """Add to `out`, (2, rings + 1), values with their weights and the weights, by the nearest whole lag.

    The last place takes all longer lags.
    """
    for j in range(along_y.size):
        for i in range(along_x.size):
            ring = int(min(np.sqrt(along_y[j] + along_x[i]) + 0.5, out.shape[1] - 1.0))
            weight = weight_y[j] * weight_x[i]
            out[0, ring] += weight * values[j, i]
            out[1, ring] += weight


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
        NaN under a uniform stress, which has no variance, or one below rounding errors; where the covariance
        does not fall to half; and in an analysis without covariances.
    """
    if f"{prefix}covariance_plane" not in profiles:
        unknown = np.full(profiles.sizes["poisson"], np.nan)
        return unknown, unknown
    depth, lag = profiles["plane_depth"].values, profiles["lag"].values
    names = f"{prefix}covariance_depth", f"{prefix}covariance_plane", "reference_depth"
    lengths = []
    for along_depth, in_plane, reference in zip(*(profiles[name].values for name in names), strict=True):
        below = depth >= reference
        # Both are the variance in the reference plane, and differ where it is below their rounding errors.
        known = in_plane[0] > 0 and along_depth[below][:1].max(initial=0) < 2 * in_plane[0]
        variance = in_plane[0] if known else np.nan
        below_reference = half_length(depth[below] - reference, along_depth[below] / variance)
        lengths.append((below_reference, half_length(lag, in_plane / variance)))
    found = np.array(lengths).T
    return found[0], found[1]
