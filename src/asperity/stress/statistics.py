"""Distributions, autocorrelations, and ensembles with their uncertainty.

`probability_density`, `joint_counts` and `autocorrelation` look at one field or one set of values;
`pool_peaks` merges the analyses of several seeds of one surface. Stresses are divided here by
E* ḡ, ḡ the rms gradient of the deformed surface over the true contact of the same seed; such variables
are named ``scaled_…``. Counts are kept beside densities, so that another binning needs no other run.

Bands are percentile intervals of the bootstrap over seeds: whole seeds are drawn with replacement,
because peaks of one surface are not independent. One seed has no band (NaN).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from asperity.spectral import Fourier, Grid, resample
from asperity.stress.selection import SELECTIONS, peaks
from asperity.types import Array

PERCENTS = (50.0, 90.0, 99.0, 99.9)

_FINE_BINS = 8192


class Density(NamedTuple):
    """A histogram and its probability density.

    Parameters
    ----------
    counts : (bins,) integer array
    edges : (bins + 1,) array
    density : (bins,) array
        Counts over their sum and the width of their bin; all zero without values.
    """

    counts: Array
    edges: Array
    density: Array


def probability_density(values: Array, bins: int = 100, limits: tuple[float, float] | None = None) -> Density:
    """Probability density of values in equal bins.

    Parameters
    ----------
    values : array
    bins : int
    limits : (lowest, highest), optional
        By default the smallest and largest value. Values outside are not counted.

    Raises
    ------
    ValueError
        If `bins` is less than one, a value is not finite, or the limits do not rise.
    """
    values = np.asarray(values, dtype=float).ravel()
    if not np.all(np.isfinite(values)):
        raise ValueError(f"values: {np.sum(~np.isfinite(values))} are not finite, all must be")
    edges = _edges(values, bins, limits)
    counts = np.histogram(values, edges)[0]
    return Density(counts, edges, _normalised(counts, edges))


def joint_counts(values: Array, depths: Array, value_edges: Array, depth_edges: Array) -> Array:
    """How many peaks lie in each bin of value and depth, (values, depths) integers."""
    return np.histogram2d(values, depths, (value_edges, depth_edges))[0].astype(np.int64)


def autocorrelation(field: Array, grid: Grid, finest: Grid | None = None) -> tuple[Array, Array]:
    """Radially averaged autocovariance of a plane field (Eq. 22 within a plane, not normalised).

    By the theorem of Wiener and Khinchin, without the mean.

    Parameters
    ----------
    field : (ny, nx) array
    grid : Grid
    finest : Grid, optional
        Grid of the same cell on which the lags are sampled, by default the same.

    Returns
    -------
    lag, covariance : (lags,) arrays
        Averages over rings of lag vectors, one spacing of `finest` wide, from lag 0 (the variance) to half
        the shorter edge of the cell.
    """
    finest = grid if finest is None else finest
    power = np.abs(Fourier(grid).forward(field)) ** 2
    power[0, 0] = 0.0
    power = resample(power.astype(complex), grid, finest)
    covariance = Fourier(finest).inverse(power, overwrite=True)
    width = min(finest.spacing)
    y, x = finest.coordinates()
    y, x = np.minimum(y, finest.length[0] - y), np.minimum(x, finest.length[1] - x)
    rings = int(min(finest.length) / 2 / width + 1e-9) + 1
    ring = np.rint(np.hypot(y[:, None], x[None, :]) / width).astype(np.int64).ravel()
    count = np.bincount(ring)[:rings]
    total = np.bincount(ring, covariance.ravel())[:rings]
    return width * np.arange(rings), total / count


def pool_peaks(
    stresses: Sequence[xr.Dataset],
    gradients: Sequence[float],
    bins: int = 100,
    resamples: int = 1000,
    confidence: float = 0.95,
    seed: int = 0,
) -> xr.Dataset:
    """Statistics of one surface over its seeds.

    Parameters
    ----------
    stresses : sequence of datasets
        Results of `asperity.stress.analysis.analyse_stress` with the same planes, quantities and Poisson's ratios.
    gradients : sequence of float
        ḡ of each seed.
    bins : int
    resamples : int
        Draws of the bootstrap over seeds.
    confidence : float
        Share of the draws within a band.
    seed : int
        Of the draws.

    Returns
    -------
    dataset
        ``…_low`` and ``…_high`` are the band. Along `bin` and `depth_bin`: densities and counts of peaks
        (pooled over seeds in the densities, one by one in the counts). Along `percent`: percentiles.
        Along `plane`, `lag`: covariances of Eq. 22 and depth profiles, means over seeds.

    Raises
    ------
    ValueError
        If the analyses do not fit together or a setting is out of range.
    """
    stresses, scale = _checked_pool(stresses, gradients, resamples, confidence)
    weights = _bootstrap_weights(len(stresses), resamples, seed)
    first = stresses[0]
    quantities = [str(name) for name in first["quantity"].values]
    ratios = first["poisson"].values
    shape = (len(SELECTIONS), len(quantities), ratios.size)

    depth_edges = _depth_edges(first["plane_depth"].values)
    edges = np.empty((len(quantities), bins + 1))
    counts = np.zeros((len(stresses), *shape, bins), np.int64)
    joint = np.zeros((*shape, bins, depth_edges.size - 1), np.int64)
    density, percentiles = np.zeros((3, *shape, bins)), np.full((3, *shape, len(PERCENTS)), np.nan)
    for q, quantity in enumerate(quantities):
        every = [
            np.concatenate([peaks(stress, quantity, nu)["peak_value"].values for nu in ratios]) / gradient
            for stress, gradient in zip(stresses, scale, strict=True)
        ]
        edges[q] = _edges(np.concatenate(every), bins, None)
        for s, selection in enumerate(SELECTIONS):
            for p, poisson in enumerate(ratios):
                chosen = [peaks(stress, quantity, poisson, selection) for stress in stresses]
                values = [
                    found["peak_value"].values / gradient
                    for found, gradient in zip(chosen, scale, strict=True)
                ]
                own = np.stack([np.histogram(v, edges[q])[0] for v in values])
                counts[:, s, q, p] = own
                joint[s, q, p] = sum(
                    joint_counts(v, found["peak_depth"].values, edges[q], depth_edges)
                    for v, found in zip(values, chosen, strict=True)
                )
                density[:, s, q, p] = _with_band(_pooled_density, own, weights, confidence, edges[q])
                percentiles[:, s, q, p] = _percentiles(values, weights, confidence)
    result = {
        "seed_gradient_rms_contact": ("member", scale),
        "bin_edge": (("quantity", "edge"), edges),
        "peak_counts": (("member", "selection", "quantity", "poisson", "bin"), counts),
        "joint_counts": (("selection", "quantity", "poisson", "bin", "depth_bin"), joint),
    }
    result |= _banded("peak_density", ("selection", "quantity", "poisson", "bin"), density)
    result |= _banded("peak_percentile", ("selection", "quantity", "poisson", "percent"), percentiles)
    for name, power, dimensions in (
        ("covariance_depth", 2, ("poisson", "plane")),
        ("covariance_plane", 2, ("poisson", "lag")),
        ("mean_von_mises", 1, ("poisson", "plane")),
        ("largest_von_mises", 1, ("poisson", "plane")),
    ):
        each = np.stack([b[name].values / g**power for b, g in zip(stresses, scale, strict=True)])
        flat = each.reshape(len(stresses), -1)
        banded = _with_band(_mean, flat, weights, confidence).reshape(3, *each.shape[1:])
        result |= _banded(f"scaled_{name}", dimensions, banded)
    result["plane_depth"] = ("plane", first["plane_depth"].values)
    reference = np.stack([stress["reference_depth"].values for stress in stresses])
    result |= _banded("reference_depth", ("poisson",), _with_band(_mean, reference, weights, confidence))
    return xr.Dataset(
        result,
        coords={
            "selection": list(SELECTIONS),
            "quantity": quantities,
            "poisson": ratios,
            "percent": list(PERCENTS),
            "lag": first["lag"].values,
            "depth_edge": depth_edges,
        },
        attrs={"bootstrap_resamples": resamples, "bootstrap_confidence": confidence},
    )


def _checked_pool(
    stresses: Sequence[xr.Dataset], gradients: Sequence[float], resamples: int, confidence: float
) -> tuple[list[xr.Dataset], Array]:
    stresses, scale = list(stresses), np.asarray(gradients, dtype=float)
    if not stresses or scale.shape != (len(stresses),):
        raise ValueError(
            f"gradients = {gradients!r}: one for each of the {len(stresses)} stresses (at least one)"
        )
    if not (np.all(np.isfinite(scale)) and np.all(scale > 0)):
        raise ValueError(f"gradients = {gradients!r}: positive finite numbers are needed")
    if resamples < 1:
        raise ValueError(f"resamples = {resamples!r}: at least 1 is needed")
    if not 0 < confidence < 1:
        raise ValueError(f"confidence = {confidence!r}: a number between 0 and 1 is needed")
    for name in ("quantity", "poisson", "plane_depth", "lag"):
        if any(not np.array_equal(stress[name].values, stresses[0][name].values) for stress in stresses):
            raise ValueError(f"stresses: all must have the same {name}")
    return stresses, scale


# A bin at least so wide has a finite density.
_NARROWEST = 1e-300


def _edges(values: Array, bins: int, limits: tuple[float, float] | None) -> Array:
    if bins != int(bins) or bins < 1:
        raise ValueError(f"bins = {bins!r}: a whole number of at least 1 is needed")
    if limits is None:
        # Values so near to each other that a density would overflow are taken for equal.
        alike = values.size and np.ptp(values) < bins * _NARROWEST
        return np.histogram_bin_edges(values[:1] if alike else values, int(bins))
    if not (np.all(np.isfinite(limits)) and limits[0] < limits[1]):
        raise ValueError(f"limits = {limits!r}: two finite rising numbers are needed")
    return np.linspace(limits[0], limits[1], int(bins) + 1)


def _depth_edges(depths: Array) -> Array:
    """Edges of the depth bins: the planes and the depths midway, peaks being refined between planes."""
    return np.sort(np.concatenate([depths, 0.5 * (depths[1:] + depths[:-1])]))


def _normalised(counts: Array, edges: Array) -> Array:
    total = counts.sum(axis=-1, keepdims=True)
    return counts / (np.maximum(total, 1) * np.diff(edges))


def _bootstrap_weights(members: int, resamples: int, seed: int) -> Array:
    """How often each member is drawn, (resamples, members); none with a single member."""
    if members == 1:
        return np.zeros((0, 1))
    draws = np.random.default_rng(seed).multinomial(members, np.full(members, 1 / members), resamples)
    return draws.astype(float)


def _pooled_density(weights: Array, counts: Array, edges: Array) -> Array:
    return _normalised(weights @ counts, edges)


def _mean(weights: Array, values: Array) -> Array:
    return weights @ values / weights.sum(axis=1, keepdims=True)


def _with_band(
    estimate: Callable[..., Array], values: Array, weights: Array, confidence: float, *further: Array
) -> Array:
    """Estimate over all members, and the ends of its band, (3, ...)."""
    centre = estimate(np.ones((1, len(values))), values, *further)[0]
    if not len(weights):
        return np.stack([centre, np.full_like(centre, np.nan), np.full_like(centre, np.nan)])
    draws = estimate(weights, values, *further)
    tail = (1 - confidence) / 2
    return np.stack([centre, *np.quantile(draws, [tail, 1 - tail], axis=0)])


def _percentiles(values: Sequence[Array], weights: Array, confidence: float) -> Array:
    """Percentiles of the magnitudes of all values, and their bands, (3, percents)."""
    magnitudes = [np.abs(v) for v in values]
    pooled = np.concatenate(magnitudes)
    if not pooled.size:
        return np.full((3, len(PERCENTS)), np.nan)
    edges = np.linspace(0.0, max(pooled.max(), np.finfo(float).tiny), _FINE_BINS + 1)
    counts = np.stack([np.histogram(m, edges)[0] for m in magnitudes])

    def estimate(weights: Array, counts: Array) -> Array:
        cumulative = np.cumsum(weights @ counts, axis=1)
        shares = np.array(PERCENTS) / 100
        found = [
            np.interp(shares, line / max(line[-1], 1.0), edges[1:], left=edges[0]) for line in cumulative
        ]
        return np.array(found)

    banded = _with_band(estimate, counts, weights, confidence)
    banded[0] = np.percentile(pooled, PERCENTS)
    return banded


def _banded(name: str, dimensions: tuple[str, ...], values: Array) -> dict[str, tuple]:
    return {
        name: (dimensions, values[0]),
        f"{name}_low": (dimensions, values[1]),
        f"{name}_high": (dimensions, values[2]),
    }
