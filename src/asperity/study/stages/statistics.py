"""Stage statistics: all numbers of the peaks, profiles and decays of one surface, in one dataset.

`surface_statistics` joins the numbers of each seed (`asperity.study.stages.seed_numbers`) along `seed` and
adds what is pooled over seeds. Figures, captions, claims and the drift check read this dataset; none of them
computes such a number again.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import NamedTuple

import numpy as np
import xarray as xr

from asperity.results import dataset
from asperity.stress.statistics.density import bin_edges
from asperity.stress.statistics.pooling import Bootstrap, mean, pool_peaks, pooled_density, with_bounds
from asperity.study.stages.contact import SOLID_ATTRIBUTES
from asperity.study.stages.seed_numbers import seed_statistics

_HEIGHT_LIMITS = (-6.0, 6.0)
"""Heights over their rms that are counted: a Gaussian surface has one node in 10⁹ beyond."""

PEAKS_PER_BIN = 20
"""Least number of peaks for each bin of their densities: an average bin then errs by a fifth."""

FEWEST_BINS = 10
"""Bins of the densities of however few peaks."""


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
        Section ``statistics`` of the configuration. Few peaks have fewer bins (`PEAKS_PER_BIN`).

    Returns
    -------
    dataset
        Variables of `seed_statistics` along `seed`, those of
        `asperity.stress.statistics.pooling.pool_peaks`, the distribution of the heights of all seeds, and the
        mean load along the load-area curve.
    """
    edges = bin_edges(np.empty(0), bins, _HEIGHT_LIMITS)
    seeds, each, stresses, heights, loads = [], [], [], [], []
    for seed, surface, contact, stress in results:
        heights.append(np.histogram((surface["height"] / surface["rms_height"]).values, edges)[0])
        loads.append((contact["path_mean_pressure"] / contact["path_gradient_rms_contact"]).values)
        each.append(seed_statistics(surface, contact, stress))
        seeds.append(seed)
        stresses.append(stress)
    of_seeds = xr.concat(each, "seed").assign_coords(seed=seeds)
    gradients = of_seeds["seed_gradient_rms_contact"].values.tolist()
    counted = of_seeds["seed_peak_count"].sum("seed")
    bins = min(bins, max(FEWEST_BINS, int(counted.min()) // PEAKS_PER_BIN))
    pooled = pool_peaks(stresses, gradients, bins, resamples, confidence).assign_coords(seed=seeds)
    bootstrap = Bootstrap(len(seeds), resamples, confidence)
    density = partial(pooled_density, edges=edges)
    pooled = pooled.assign(
        with_bounds("height_density", ("height_bin",), bootstrap.banded(density, np.stack(heights)))
        | with_bounds("path_scaled_load", ("load",), bootstrap.banded(mean, np.stack(loads)))
        | {
            "path_area_fraction": contact["path_area_fraction"],
            "height_edge": ("height_edge", edges),
            "height_counts": ("height_bin", np.sum(heights, axis=0)),
        }
    )
    return pooled.merge(of_seeds).assign_attrs({name: stresses[0].attrs[name] for name in SOLID_ATTRIBUTES})
