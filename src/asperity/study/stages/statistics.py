"""Stage statistics: all numbers of the peaks, profiles and decays of one surface, in one dataset.

`seed_statistics` reduces the results of one seed to numbers, the variables ``seed_…``. `surface_statistics`
joins those of all seeds along `seed` and adds what is pooled over seeds. Figures, captions, claims and the
drift check read this dataset; none of them computes such a number again. `statistics_of_seeds`
joins the numbers of the seeds under another condition of the mean (q = 0) mode, which only the claims read.

Stresses are divided by E* ḡ, ḡ being the rms gradient over the true contact of the same seed. Lengths and
depths are in units of the longer edge of the cell.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from asperity.core.types import Array
from asperity.fourier.grid import Grid
from asperity.results import dataset
from asperity.stress.peaks.selection import peaks, selection_for
from asperity.stress.statistics.covariance import decay_lengths_of
from asperity.stress.statistics.density import bin_edges, normalised
from asperity.stress.statistics.patches import contact_patches, depth_patch_correlation
from asperity.stress.statistics.pooling import HIGHEST_SHARE, pool_peaks
from asperity.study.stages.solid import SOLID_ATTRIBUTES

LEVELS = np.concatenate([np.arange(100) / 100, np.arange(991, 1001) / 1000])
"""Shares of the peaks at which quantiles are kept: every percent, above 99 % every tenth of a percent."""

LARGE_PATCH = 30
"""Nodes that a large patch of contact exceeds."""

_HEIGHT_LIMITS = (-6.0, 6.0)
"""Heights over their rms that are counted: a Gaussian surface has one node in 10⁹ beyond."""

_SMALLEST_AREA = 0.01
"""Area fraction from which the load-area curve is fitted: below it the contacts have few nodes."""


class SeedResults(NamedTuple):
    """Results of the stages surface, contact and stress for one seed of a surface."""

    seed: int
    surface: xr.Dataset
    contact: xr.Dataset
    stress: xr.Dataset

    @classmethod
    def read(cls, surface: str, contact: str, stress: str) -> SeedResults:
        """Read the result files of one seed."""
        stages = [dataset.read(path) for path in (surface, contact, stress)]
        return cls(dataset.settings_of(stages[-1])["seed"], *stages)


def surface_statistics(
    results: Iterable[SeedResults], bins: int, resamples: int, confidence: float
) -> xr.Dataset:
    """Statistics of one surface over its seeds.

    Parameters
    ----------
    results : iterable of SeedResults
        One seed after the other; the fields of a seed are not kept.
    bins, resamples, confidence
        Section ``statistics`` of the configuration.

    Returns
    -------
    dataset
        Variables of `seed_statistics` along `seed`, those of
        `asperity.stress.statistics.pooling.pool_peaks`, and the
        distribution of the heights of all seeds.
    """
    edges = bin_edges(np.empty(0), bins, _HEIGHT_LIMITS)
    heights = np.zeros(bins, np.int64)
    seeds, each, stresses = [], [], []
    for seed, surface, contact, stress in results:
        heights += np.histogram((surface["height"] / surface["rms_height"]).values, edges)[0]
        each.append(seed_statistics(surface, contact, stress))
        seeds.append(seed)
        stresses.append(stress)
    of_seeds = xr.concat(each, "seed").assign_coords(seed=seeds)
    pooled = pool_peaks(
        stresses, of_seeds["seed_gradient_rms_contact"].values.tolist(), bins, resamples, confidence
    ).assign_coords(seed=seeds)
    pooled["height_edge"] = ("height_edge", edges)
    pooled["height_counts"] = ("height_bin", heights)
    pooled["height_density"] = ("height_bin", normalised(heights, edges))
    return pooled.merge(of_seeds).assign_attrs({name: stresses[0].attrs[name] for name in SOLID_ATTRIBUTES})


def statistics_of_seeds(results: Iterable[SeedResults]) -> xr.Dataset:
    """Numbers of the seeds of one surface, without what is pooled over them.

    Parameters
    ----------
    results : iterable of SeedResults
        With the stress under another condition of the mean (q = 0) mode than that of the study.

    Returns
    -------
    dataset
        Variables of `seed_statistics` along `seed`.
    """
    each, seeds, attributes = [], [], {}
    for seed, surface, contact, stress in results:
        each.append(seed_statistics(surface, contact, stress))
        seeds.append(seed)
        attributes = {name: stress.attrs[name] for name in SOLID_ATTRIBUTES}
    return xr.concat(each, "seed").assign_coords(seed=seeds).assign_attrs(attributes)


def seed_statistics(surface: xr.Dataset, contact: xr.Dataset, stress: xr.Dataset) -> xr.Dataset:
    """Numbers of one surface and one seed.

    Parameters
    ----------
    surface, contact, stress : datasets
        Results of the stages of these names.

    Returns
    -------
    dataset
        Along `quantity` and `poisson`, numbers of the peaks that figures and claims count; along `level`,
        quantiles of their magnitude. Along `patches` and `poisson`, correlations that interpretations of the
        claims take. NaN where there is nothing to measure.
    """
    gradient = float(contact["gradient_rms_contact"])
    patches, radii = contact_patches(contact["pressure"].values > 0)
    grid = dataset.grid_of(contact)
    numbers: dict[str, object] = {
        f"seed_{name}": float(surface[name]) for name in ("rms_gradient", "skewness", "kurtosis")
    }
    numbers |= _of_contact(contact, float(surface["rms_gradient"]))
    numbers["seed_patches"] = radii.size
    numbers["seed_patch_radius"] = float(np.sqrt(np.prod(grid.spacing)) * np.average(radii, weights=radii**2))
    numbers |= _of_peaks(stress, gradient)
    ratios = stress["poisson"].values.tolist()
    correlations = np.array([_patch_correlations(stress, ratio, grid, patches, radii) for ratio in ratios])
    numbers["seed_depth_patch_correlation"] = ("poisson", correlations[:, 0])
    numbers["seed_patch_correlation"] = (("patches", "poisson"), correlations[:, 1:].T)
    numbers |= _of_planes(stress, gradient)
    coordinates = {
        "quantity": stress["quantity"].values,
        "poisson": stress["poisson"].values,
        "patches": ["highest_of_patch", "large_patches"],
    }
    return xr.Dataset(numbers, coords={**coordinates, "level": LEVELS})


def _of_contact(contact: xr.Dataset, whole_gradient: float) -> dict[str, float]:
    """Load, area and slopes, and the shape of the load-area curve."""
    area, pressure, gradient, approach = (
        float(contact[name])
        for name in ("area_fraction", "mean_pressure", "gradient_rms_contact", "approach")
    )
    outside = max(whole_gradient**2 - area * gradient**2, 0) / max(1 - area, 1e-12)
    exponent, change = _load_area_curve(contact, area)
    return {
        "seed_area_fraction": area,
        "seed_mean_pressure": pressure,
        "seed_approach": approach,
        "seed_gradient_rms_contact": gradient,
        "seed_gradient_rms_outside": float(np.sqrt(outside)),
        "seed_proportionality": area * gradient / pressure,
        "seed_load_exponent": exponent,
        "seed_proportionality_change": change,
    }


def _load_area_curve(contact: xr.Dataset, area: float) -> tuple[float, float]:
    """Exponent of the area over the scaled load, and the change of their ratio, up to the area of the study.

    NaN with fewer than three loads.
    """
    path = contact["path_area_fraction"].values
    kept = (path >= _SMALLEST_AREA * (1 - 1e-3)) & (path <= 1.001 * area)
    if kept.sum() < 3:
        return np.nan, np.nan
    load = (contact["path_mean_pressure"] / contact["path_gradient_rms_contact"]).values[kept]
    ratio = path[kept] / load
    exponent = np.polyfit(np.log(load), np.log(path[kept]), 1)[0]
    return float(exponent), float(ratio[-1] / ratio[0])


def _of_peaks(stress: xr.Dataset, gradient: float) -> dict[str, tuple]:
    """Number, size, spread and depth of the peaks of every quantity and Poisson's ratio."""
    quantities, ratios = [str(name) for name in stress["quantity"].values], stress["poisson"].values
    shape = len(quantities), len(ratios)
    count = np.zeros(shape, np.int64)
    mean, deviation, depth, depth_highest = np.full((4, *shape), np.nan)
    quantile = np.full((*shape, LEVELS.size), np.nan)
    for q, p in np.ndindex(shape):
        found = peaks(stress, quantities[q], float(ratios[p]), selection_for(quantities[q]))
        count[q, p] = found.sizes["peak"]
        if not count[q, p]:
            continue
        magnitude, depths = np.abs(found["peak_value"].values) / gradient, found["peak_depth"].values
        mean[q, p], deviation[q, p], depth[q, p] = magnitude.mean(), magnitude.std(), depths.mean()
        quantile[q, p] = np.quantile(magnitude, LEVELS)
        depth_highest[q, p] = depths[magnitude >= np.quantile(magnitude, 1 - HIGHEST_SHARE)].mean()
    kinds = ("quantity", "poisson")
    return {
        "seed_peak_count": (kinds, count),
        "seed_peak_mean": (kinds, mean),
        "seed_peak_deviation": (kinds, deviation),
        "seed_peak_quantile": ((*kinds, "level"), quantile),
        "seed_mean_depth": (kinds, depth),
        "seed_mean_depth_highest": (kinds, depth_highest),
    }


def _patch_correlations(
    stress: xr.Dataset, ratio: float, grid: Grid, patches: Array, radii: Array
) -> list[float]:
    """Rank correlations of the depth of von Mises peaks with the radius of the patch of contact above.

    They are those of all peaks, of the highest below each patch, and of the latter below large patches.
    """
    found = peaks(stress, "von_mises", ratio, selection_for("von_mises"))
    row, column = (
        np.rint(found[f"peak_{axis}"].values / step).astype(int)
        for axis, step in zip("yx", grid.spacing, strict=True)
    )
    patch = patches[row % grid.shape[0], column % grid.shape[1]]  # from 1; 0 outside contact
    by_patch = pd.Series(np.abs(found["peak_value"].values)).groupby(patch)
    highest = np.sort(by_patch.idxmax().drop(0, errors="ignore").to_numpy(int))
    large = highest[radii[patch[highest] - 1] > np.sqrt(LARGE_PATCH / np.pi) * (1 + 1e-12)]
    depth = found["peak_depth"].values
    return [
        depth_patch_correlation(depth[some], row[some], column[some], patches, radii) if some.size else np.nan
        for some in (np.arange(depth.size), highest, large)
    ]


def _of_planes(stress: xr.Dataset, gradient: float) -> dict[str, tuple]:
    """Largest von Mises stress, its depth, and the lengths over which the stress decays (Eq. 22)."""
    along_depth, in_plane = decay_lengths_of(stress)
    return {
        "seed_largest_von_mises": ("poisson", stress["largest_von_mises"].max("plane").values / gradient),
        "seed_reference_depth": ("poisson", stress["reference_depth"].values),
        "seed_decay_length_depth": ("poisson", along_depth),
        "seed_decay_length_plane": ("poisson", in_plane),
    }
