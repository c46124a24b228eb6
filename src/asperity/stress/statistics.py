"""Densities, joint counts and autocorrelations of one field or one set of values.

`asperity.stress.pooling` merges the analyses of several seeds with these functions.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from asperity.arguments import LARGEST, finite_array, number, pair, whole_number
from asperity.compiled import compiled
from asperity.errors import shown
from asperity.finite import require_finite
from asperity.spectral import Fourier, Grid, Work, resample
from asperity.types import Array

NARROWEST_BIN = 1e-300
"""Smallest width of a bin whose density is still finite."""

LINES_AT_ONCE = 256
"""Lines that are transformed together."""

MOST_BINS = 10_000_000
"""Most bins of a density."""


class Density(NamedTuple):
    """A histogram and its probability density.

    Parameters
    ----------
    counts : (bins,) integer array
    edges : (bins + 1,) array
    density : (bins,) array
        Counts divided by their sum and by the width of their bin; zero if nothing was counted.
    """

    counts: Array
    edges: Array
    density: Array


def probability_density(values: Array, bins: int = 100, limits: tuple[float, float] | None = None) -> Density:
    """Probability density of values in bins of equal width.

    Parameters
    ----------
    values : array
    bins : int
    limits : (lowest, highest), optional
        By default the smallest and the largest value. Values outside the limits are not counted.

    Raises
    ------
    ValueError
        If `bins` is out of range, a value is not finite or larger than 1e75, or the limits do not rise.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1.0, seed=1)
    >>> density = asp.probability_density(height, bins=20)
    >>> density.density.size, round(float(np.sum(density.density * np.diff(density.edges))), 12)
    (20, 1.0)
    """
    values = finite_array("values", values).ravel()
    edges = bin_edges(values, bins, limits)
    counts = np.histogram(values, edges)[0]
    found = Density(counts, edges, normalised(counts, edges))
    require_finite("probability_density", found._asdict())
    return found


def bin_edges(values: Array, bins: int, limits: tuple[float, float] | None = None) -> Array:
    """Edges of bins of equal width between limits, by default from the smallest to the largest value.

    Values so close together that bins between them would have no width count as equal.
    """
    bins = whole_number(
        "bins", bins, f"a whole number from 1 to {MOST_BINS}", lambda count: 1 <= count <= MOST_BINS
    )
    if limits is None:
        width = max(NARROWEST_BIN, float(np.spacing(np.abs(values).max()))) if values.size else 0.0
        alike = values.size and np.ptp(values) < 2 * bins * width
        if not alike:
            return np.histogram_bin_edges(values, bins)
        half = max(0.5, bins * width)
        return np.linspace(values[0] - half, values[0] + half, bins + 1)
    accepted = "a pair of finite rising numbers, farther apart than their rounding,"
    first, last = (
        number("limits", limit, accepted, lambda size: abs(size) <= LARGEST)
        for limit in pair("limits", limits, accepted)
    )
    if not last - first > 2 * bins * max(NARROWEST_BIN, float(np.spacing(max(abs(first), abs(last))))):
        raise ValueError(f"limits = {shown(limits)}: {accepted} is needed")
    return np.linspace(first, last, bins + 1)


def normalised(counts: Array, edges: Array) -> Array:
    """Probability density from counts in bins, along the last axis; zero where nothing was counted."""
    total = counts.sum(axis=-1, keepdims=True)
    return counts / (np.maximum(total, 1) * np.diff(edges))


def joint_counts(values: Array, depths: Array, value_edges: Array, depth_edges: Array) -> Array:
    """Number of peaks in each bin of value and depth, (values, depths) integers."""
    return np.histogram2d(values, depths, (value_edges, depth_edges))[0].astype(np.int64)


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
    finest = grid if finest is None else finest
    field = finite_array("field", field)
    if field.shape != grid.shape:
        raise ValueError(f"field has the shape {field.shape}: that of its grid, {grid.shape}, is needed")
    rings = LagRings(finest)
    mean = rings.autocovariance(Fourier(grid).forward(field), grid)
    require_finite("autocorrelation", {"lag": rings.lag, "covariance": mean})
    return rings.lag, mean


class LagRings:
    """Rings of lag vectors in a cell, each one spacing of a grid wide.

    Parameters
    ----------
    grid : Grid
        Grid on which the lags are sampled.

    Attributes
    ----------
    lag : (lags,) array
        Radius of each ring, from 0 to half the shorter edge of the cell.
    """

    def __init__(self, grid: Grid) -> None:
        self._grid, width = grid, min(grid.spacing)
        y, x = (axis[: axis.size // 2 + 1] for axis in grid.coordinates())
        rings = int(min(grid.length) / 2 / width + 1e-9) + 1
        number = np.rint(np.sqrt((y[:, None] / width) ** 2 + (x / width) ** 2))
        self.lag, self._ring = width * np.arange(rings), np.minimum(number, rings).astype(np.int32)
        self._count = self._sum(np.ones(number.shape))

    def autocovariance(self, modes: Array, grid: Grid, work: Work | None = None) -> Array:
        """Covariance of a field with itself, averaged over each ring of lags, (lags,).

        Parameters
        ----------
        modes : complex array
            Coefficients of the field.
        grid : Grid
            Their grid.
        work : Work, optional
            Where the transform is counted.
        """
        # Lags (y, x) and (y, −x) are in the same ring: their mean has a power that is even in both axes.
        power = np.empty(modes.shape, modes.real.dtype)
        _fill_even_power(modes, power)
        if grid != self._grid:
            power = resample(power, grid, self._grid)
        fourier = Fourier(self._grid, power.dtype)
        rows, nodes = self._ring.shape
        # Of a real even column the transform is real: two are transformed along y as one complex column.
        half = (power.shape[1] + 1) // 2
        others = power.shape[1] - half
        pairs = np.empty((1, power.shape[0], half), fourier.complex)
        pairs.real[0] = power[:, :half]
        pairs.imag[0, :, :others] = power[:, half:]
        pairs.imag[0, :, others:] = 0
        for first in range(0, half, LINES_AT_ONCE):
            block = pairs[:, :, first : first + LINES_AT_ONCE]
            fourier.inverse_along_y(block, block)
        columns = np.zeros((1, rows, power.shape[1]), fourier.complex)
        columns.real[0, :, :half] = pairs.real[0, :rows]
        columns.real[0, :, half:] = pairs.imag[0, :rows, :others]
        covariance = np.empty((1, rows, self._grid.shape[1]), fourier.real)
        for first in range(0, rows, LINES_AT_ONCE):
            strip = slice(first, min(first + LINES_AT_ONCE, rows))
            fourier.inverse_along_x(columns[:, strip], covariance[:, strip])
        if work is not None:
            work.nodes += self._grid.size // 2
        return self._sum(covariance[0, :, :nodes]) / self._count

    def _sum(self, values: Array) -> Array:
        """Sum over all nodes of each ring, from those with y and x up to half of the cell."""
        along_y, along_x = (np.full(n // 2 + 1, 2.0) for n in self._grid.shape)
        for weights, nodes in zip((along_y, along_x), self._grid.shape, strict=True):
            weights[[0, nodes // 2] if nodes % 2 == 0 else [0]] = 1.0
        sums = np.zeros(self.lag.size + 1)
        _add_to_rings(values, along_y, along_x, self._ring, sums)
        return sums[:-1]


@compiled
def _fill_even_power(modes: Any, out: Any) -> None:
    """Fill `out` with the squared magnitudes of modes, each with the mean of ky and −ky, without the mean."""
    rows, columns = modes.shape
    for j in range(rows):
        for i in range(columns):
            one, two = modes[j, i], modes[(rows - j) % rows, i]
            power = one.real * one.real + one.imag * one.imag
            out[j, i] = (power + (two.real * two.real + two.imag * two.imag)) / 2
    out[0, 0] = 0


@compiled
def _add_to_rings(values: Any, along_y: Any, along_x: Any, ring: Any, sums: Any) -> None:
    """Add values, weighted along both axes, to the sums of their rings."""
    for j in range(ring.shape[0]):
        for i in range(ring.shape[1]):
            sums[ring[j, i]] += along_y[j] * along_x[i] * values[j, i]


def half_length(distance: Array, correlation: Array, share: float = 0.5) -> float:
    """Distance at which a correlation first falls to a share, by linear interpolation; NaN if never."""
    fallen = np.flatnonzero(correlation <= share)
    if not fallen.size or fallen[0] == 0:
        return float("nan")
    i = int(fallen[0])
    return float(np.interp(share, correlation[[i, i - 1]], distance[[i, i - 1]]))


def decay_lengths(
    depth: Array, along_depth: Array, lag: Array, in_plane: Array, reference: float, share: float = 0.5
) -> tuple[float, float]:
    """Distances over which the covariance of Eq. 22 falls to a share, below the reference plane and in it.

    Parameters
    ----------
    depth, along_depth : (planes,) arrays
        Depth of each plane and its covariance with the reference plane.
    lag, in_plane : (lags,) arrays
        Distance in the reference plane and the covariance there; the first is the variance.
    reference : float
        Depth of the reference plane.
    share : float
    """
    below = depth >= reference
    variance = in_plane[0]
    return (
        half_length(depth[below] - reference, along_depth[below] / variance, share),
        half_length(lag, in_plane / variance, share),
    )
