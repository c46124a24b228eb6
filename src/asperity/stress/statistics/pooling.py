"""Statistics of the peaks, profiles and decays of one surface, pooled over its seeds, with their uncertainty.

Each seed is scaled before it is pooled: stresses are divided by E* ḡ_r, where ḡ_r is the rms gradient of the
deformed surface over the real contact of that seed. Scaled variables are named ``scaled_…``. Counts are
kept beside densities, so that other bins need no new analysis.

Bands are percentile intervals of the bootstrap (Efron 1979, doi 10.1214/aos/1176344552) over seeds: whole
seeds are drawn with replacement, because peaks of one surface are not independent. With one seed the band
is NaN.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import partial
from itertools import combinations
from typing import NamedTuple

import numpy as np
import xarray as xr

from asperity.core.arguments import (
    LARGEST,
    finite_array,
    number,
    pair,
    real_array,
    require_finite,
    whole_number,
)
from asperity.core.errors import shown
from asperity.core.types import Array
from asperity.stress.peaks.selection import (
    HIGHEST_SHARE,
    SELECTIONS,
    has_percentile,
    in_cell,
    is_selected,
    select_peaks,
)
from asperity.stress.statistics.covariance import decay_lengths

PERCENTS = (50.0, 90.0, 99.0, 99.9)
"""Percentiles of the magnitude of the pooled peaks."""

MOST_RESAMPLES = 1_000_000
"""Most resamples of the bootstrap."""

_PERCENTILE_BINS = 8192
"""Bins in which percentiles of a resample are found; their error is a ten-thousandth of the largest peak."""

_PROFILES = {"covariance_depth": 2, "covariance_plane": 2, "mean_von_mises": 1, "maximum_von_mises": 1}
"""Profiles of an analysis → power of the stress to which they are proportional."""

NARROWEST_BIN = 1e-300
"""Smallest width of a bin whose density is still finite."""

MOST_BINS = 10_000_000
"""Most bins of a density."""


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
        Results of `asperity.stress.analysis.analyse_stress` with the same planes, quantities and Poisson's
        ratios.
    gradients : sequence of float
        ḡ_r of each seed.
    bins : int
    resamples : int
        Number of bootstrap resamples, at most `MOST_RESAMPLES`.
    confidence : float
        Fraction of the resamples within a band, between 0 and 1.
    seed : int
        Seed of the bootstrap, at least 0.

    Returns
    -------
    dataset
        Along `bin` and `depth_bin`: densities of the peaks of all seeds, and counts. Along `percent`:
        percentiles, NaN if no peak lies above them. Along `plane` and `lag`: depth profiles and, if the
        analyses have them, covariances of Eq. 22, means over seeds, with the lengths over which these fall to
        half, else NaN. ``…_low`` and
        ``…_high`` bound a band.

    Raises
    ------
    ValueError, TypeError
        If the analyses do not fit together, two of them are the same, or a setting is out of range.

    Examples
    --------
    >>> stresses, gradients = [], []
    >>> for seed in (1, 2, 3):
    ...     height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=seed)
    ...     contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    ...     depths = asp.stress.depth_grid(contact.grid, height=0.25)
    ...     stresses.append(asp.analyse_stress(contact, depths, quantities=("von_mises",)))
    ...     gradients.append(contact.gradient_rms_contact)
    >>> pooled = asp.stress.pool_peaks(stresses, gradients, bins=20, resamples=100)
    >>> density = pooled["peak_density"].sel(selection="under_contact", quantity="von_mises", poisson=0.3)
    >>> width = np.diff(pooled["bin_edge"].sel(quantity="von_mises"))
    >>> round(float((density * width).sum()), 6)
    1.0
    """
    stresses, scale = _checked(stresses, gradients)
    resamples = whole_number(
        "resamples",
        resamples,
        f"a whole number from 1 to {MOST_RESAMPLES}",
        lambda count: 1 <= count <= MOST_RESAMPLES,
    )
    confidence = number("confidence", confidence, "a number between 0 and 1", lambda share: 0 < share < 1)
    seed = whole_number("seed", seed, "a whole number ≥ 0", lambda number: number >= 0)
    bootstrap = Bootstrap(len(stresses), resamples, confidence, seed)
    first = stresses[0]
    # The planes and the depths midway, since peaks are refined between planes.
    depths = first["plane_depth"].values
    depth_edges = np.sort(np.concatenate([depths, 0.5 * (depths[1:] + depths[:-1])]))
    pooled = xr.Dataset(
        _pooled_peaks(stresses, scale, depth_edges, bins, bootstrap)
        | _pooled_profiles(stresses, scale, bootstrap),
        coords={
            "selection": list(SELECTIONS),
            "quantity": first["quantity"].values,
            "poisson": first["poisson"].values,
            "percent": list(PERCENTS),
            "depth_edge": depth_edges,
        }
        | ({"lag": first["lag"].values} if "lag" in first else {}),
        attrs={"bootstrap_resamples": resamples, "bootstrap_confidence": confidence},
    )
    lengths = decay_lengths(pooled, "scaled_")
    pooled["decay_length_depth"], pooled["decay_length_plane"] = (("poisson", length) for length in lengths)
    require_finite("pool_peaks", pooled.data_vars, undefined=True)
    return pooled


def _checked(stresses: Sequence[xr.Dataset], gradients: Sequence[float]) -> tuple[list[xr.Dataset], Array]:
    stresses, scale = list(stresses), real_array("gradients", gradients).astype(float)
    if not stresses or scale.shape != (len(stresses),):
        raise ValueError(
            f"gradients = {gradients!r}: one for each of the {len(stresses)} stresses (at least one)"
        )
    if not (np.all(np.isfinite(scale)) and np.all(scale > 0)):
        raise ValueError(f"gradients = {gradients!r}: positive finite numbers are needed")
    for name in ("quantity", "poisson", "plane_depth", "lag"):
        if any(not np.array_equal(stress.get(name, ()), stresses[0].get(name, ())) for stress in stresses):
            raise ValueError(f"stresses: all must have the same {name}")
    peaks_of = [stress["peak_value"].values for stress in stresses]
    for one, other in combinations(range(len(stresses)), 2):
        if peaks_of[one].size and np.array_equal(peaks_of[one], peaks_of[other]):
            raise ValueError(
                f"stresses: numbers {one + 1} and {other + 1} have the same peaks; every seed is needed once"
            )
    return stresses, scale * [stress.attrs.get("effective_modulus", 1.0) for stress in stresses]


class Bootstrap:
    """Resamples of the seeds, the same for every number, and the bands that they give.

    Parameters
    ----------
    seeds, resamples : int
    confidence : float
    seed : int
        Of the random numbers.
    """

    def __init__(self, seeds: int, resamples: int, confidence: float, seed: int = 0) -> None:
        self._tail = (1 - confidence) / 2
        # Number of times that each seed is drawn, (resamples, seeds).
        draws = np.random.default_rng(seed).multinomial(seeds, np.full(seeds, 1 / seeds), resamples)
        # A few seeds have few resamples that differ: four have 35.
        different, which = np.unique(draws, axis=0, return_inverse=True)
        self._which = which.reshape(-1)  # a column in numpy 2.0
        self._draws = different.astype(float) if seeds > 1 else np.zeros((0, 1))

    def banded(self, estimate: Callable[[Array, Array], Array], values: Array) -> Array:
        """An estimate over all seeds and the ends of its band, (3, ...).

        Parameters
        ----------
        estimate : callable
            (resamples, seeds) weights and the values → (resamples, ...) estimates.
        values : (seeds, ...) array
        """
        centre = estimate(np.ones((1, len(values))), values)
        if not len(self._draws):
            return np.concatenate([centre, np.full((2, *centre.shape[1:]), np.nan)])
        drawn = estimate(self._draws, values)[self._which]
        return np.concatenate([centre, np.quantile(drawn, [self._tail, 1 - self._tail], axis=0)])


def _pooled_peaks(
    stresses: Sequence[xr.Dataset], scale: Array, depth_edges: Array, bins: int, bootstrap: Bootstrap
) -> dict[str, tuple]:
    """Counts, densities, percentiles and median depths of the peaks."""
    quantities = [str(name) for name in stresses[0]["quantity"].values]
    ratios = stresses[0]["poisson"].values
    shape = (len(SELECTIONS), len(quantities), ratios.size)
    of_quantities = []  # edges of bins, common to all seeds, selections and Poisson's ratios
    for name in quantities:
        values = [
            select_peaks(stress, name, ratio)["peak_value"].values / gradient
            for stress, gradient in zip(stresses, scale, strict=True)
            for ratio in stress["poisson"].values
        ]
        of_quantities.append(bin_edges(np.concatenate(values), bins))
    edges = np.stack(of_quantities)
    maps = in_cell(stresses[0])[1]  # in the period whose peaks are counted
    counts = np.zeros((len(stresses), *shape, bins), np.int64 if maps == 1 else float)
    joint = np.zeros((*shape, bins, depth_edges.size - 1), counts.dtype)
    density, percentiles = np.zeros((3, *shape, bins)), np.full((3, *shape, len(PERCENTS)), np.nan)
    median_depth = np.full((2, *shape), np.nan)
    for q, p in np.ndindex(shape[1:]):
        every = [in_cell(select_peaks(stress, quantities[q], float(ratios[p])))[0] for stress in stresses]
        for s, selection in enumerate(SELECTIONS):
            masks = [is_selected(found, selection) for found in every]
            values, depths = (
                [found[name].values[mask] for found, mask in zip(every, masks, strict=True)]
                for name in ("peak_value", "peak_depth")
            )
            values = [value / g for value, g in zip(values, scale, strict=True)]
            own = np.stack([np.histogram(v, edges[q])[0] for v in values])
            counts[:, s, q, p] = own / maps
            found_at = np.concatenate(values), np.concatenate(depths)
            joint[s, q, p] = np.histogram2d(*found_at, bins=(edges[q], depth_edges))[0] / maps
            # The highest peaks: those in the bins of the largest values with at most `HIGHEST_SHARE` of all.
            above = np.cumsum(joint[s, q, p].sum(axis=1)[::-1])[::-1]
            highest = joint[s, q, p][above <= HIGHEST_SHARE * joint[s, q, p].sum()]
            for part, chosen in enumerate((joint[s, q, p], highest)):
                median_depth[part, s, q, p] = _median(chosen.sum(axis=0), depth_edges)
            density[:, s, q, p] = bootstrap.banded(partial(pooled_density, edges=edges[q]), own)
            percentiles[:, s, q, p] = _percentiles(values, bootstrap)
    kinds = ("selection", "quantity", "poisson")
    return {
        "bin_edge": (("quantity", "edge"), edges),
        "peak_counts": (("seed", *kinds, "bin"), counts),
        "joint_counts": ((*kinds, "bin", "depth_bin"), joint),
        "median_depth": (kinds, median_depth[0]),
        "median_depth_highest": (kinds, median_depth[1]),
        **with_bounds("peak_density", (*kinds, "bin"), density),
        **with_bounds("peak_percentile", (*kinds, "percent"), percentiles),
    }


def _pooled_profiles(stresses: Sequence[xr.Dataset], scale: Array, bootstrap: Bootstrap) -> dict[str, tuple]:
    """Covariances and depth profiles, means over seeds."""
    result: dict[str, tuple] = {}
    for name, power in ((name, power) for name, power in _PROFILES.items() if name in stresses[0]):
        each = np.stack([s[name].values / g**power for s, g in zip(stresses, scale, strict=True)])
        result |= with_bounds(f"scaled_{name}", stresses[0][name].dims, bootstrap.banded(mean, each))
    reference = np.stack([stress["reference_depth"].values for stress in stresses])
    result |= with_bounds("reference_depth", ("poisson",), bootstrap.banded(mean, reference))
    result["plane_depth"] = ("plane", stresses[0]["plane_depth"].values)
    return result


def _median(counts: Array, edges: Array) -> float:
    """Median of what is counted in bins and evenly distributed in each; NaN if nothing is."""
    total = counts.sum()
    if not total:
        return float("nan")
    return float(np.interp(0.5, np.concatenate([[0.0], np.cumsum(counts)]) / total, edges))


def pooled_density(weights: Array, counts: Array, edges: Array) -> Array:
    """Density from the counts of all seeds, (resamples, bins), by the weights of the seeds."""
    return normalised(weights @ counts, edges)


def mean(weights: Array, values: Array) -> Array:
    """Mean over seeds, (resamples, ...), by the weights of the seeds."""
    return np.tensordot(weights, values, 1) / len(values)


def _percentiles(values: Sequence[Array], bootstrap: Bootstrap) -> Array:
    """Percentiles of the magnitudes of all values, and their bands, (3, percents); NaN of too few values.

    The percentiles are exact, and of the resamples are found in fine bins.
    """
    magnitudes = [np.abs(v) for v in values]
    pooled = np.concatenate(magnitudes)
    if not pooled.size:
        return np.full((3, len(PERCENTS)), np.nan)
    edges = np.linspace(0.0, max(pooled.max(), np.finfo(float).tiny), _PERCENTILE_BINS + 1)
    counts = np.stack([np.histogram(m, edges)[0] for m in magnitudes])
    shares = np.array(PERCENTS) / 100

    def estimate(weights: Array, counts: Array) -> Array:
        # One resample after the other: all at once would take 130 MB.
        cumulative = (np.cumsum(drawn @ counts) for drawn in weights)
        found = [
            np.interp(shares, line / max(line[-1], 1.0), edges[1:], left=edges[0]) for line in cumulative
        ]
        return np.array(found)

    banded = bootstrap.banded(estimate, counts)
    banded[0] = np.percentile(pooled, PERCENTS)
    return np.where(has_percentile(pooled.size, shares), banded, np.nan)


def with_bounds(name: str, dimensions: tuple[Hashable, ...], values: Array) -> dict[str, tuple]:
    """Variables of an estimate and the ends of its band, from (3, ...) values."""
    ends = ("", "_low", "_high")
    return {f"{name}{end}": (dimensions, each) for end, each in zip(ends, values, strict=True)}


class Density(NamedTuple):
    """A histogram and its probability density.

    Parameters
    ----------
    counts : (bins,) integer array
    edges : (bins + 1,) array
    density : (bins,) array
        Counts divided by their sum and by the width of their bin; zero if nothing was counted.

    Examples
    --------
    >>> found = asp.stress.probability_density(np.array([0.0, 0.1, 0.2, 1.0]), bins=2)
    >>> found.counts, found.density
    (array([3, 1]), array([1.5, 0.5]))
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

    Returns
    -------
    Density

    Raises
    ------
    ValueError
        If `bins` is out of range, a value is not finite or larger than 1e75, or the limits do not rise.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1.0, seed=1)
    >>> density = asp.stress.probability_density(height, bins=20)
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
