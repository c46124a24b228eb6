"""Numbers of the peaks of every quantity and Poisson's ratio: how many, how large, how deep."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from asperity.core.types import Array
from asperity.stress.peaks.selection import peaks, selection_for

HIGHEST_SHARE = 0.1
"""Share of the peaks that counts as the highest ones."""


def peak_numbers(
    stress: xr.Dataset, levels: Sequence[float] | Array, all_peaks: xr.DataArray | None = None
) -> xr.Dataset:
    """Number, size and depth of the peaks that figures and claims count.

    Parameters
    ----------
    stress : dataset
        Result of `asperity.stress.analysis.analyse_stress`.
    levels : sequence of float
        Shares of the peaks at which quantiles are taken.
    all_peaks : data array, optional
        Along `quantity` and `poisson`, the number of peaks of which those found are the highest, for the
        quantiles. Peaks that were not found count as equal to the smallest one.

    Returns
    -------
    dataset
        Along `quantity` and `poisson`: ``peak_count``, the ``peak_mean`` and ``peak_deviation`` of the
        magnitudes, ``mean_depth`` and ``mean_depth_highest``, of all peaks and of the highest tenth; also
        along `level`: ``peak_quantile``. NaN without peaks.
    """
    quantities, ratios = [str(name) for name in stress["quantity"].values], stress["poisson"].values
    levels, shape = np.asarray(levels), (len(quantities), len(ratios))
    number, mean, deviation, depth, depth_highest = np.full((5, *shape), np.nan)
    quantile = np.full((*shape, levels.size), np.nan)
    for q, p in np.ndindex(shape):
        found = peaks(stress, quantities[q], float(ratios[p]), selection_for(quantities[q]))
        size, depths = np.abs(found["peak_value"].values), found["peak_depth"].values
        number[q, p] = size.size
        if not size.size:
            continue
        depth[q, p] = depths.mean()
        depth_highest[q, p] = depths[size >= np.quantile(size, 1 - HIGHEST_SHARE)].mean()
        all_over_found = 1.0 if all_peaks is None else float(all_peaks[q, p]) / size.size
        quantile[q, p] = np.quantile(size, np.clip(1 - (1 - levels) * all_over_found, 0, 1))
        mean[q, p], deviation[q, p] = size.mean(), size.std()
    kinds = ("quantity", "poisson")
    return xr.Dataset(
        {
            "peak_count": (kinds, number),
            "peak_mean": (kinds, mean),
            "peak_deviation": (kinds, deviation),
            "peak_quantile": ((*kinds, "level"), quantile),
            "mean_depth": (kinds, depth),
            "mean_depth_highest": (kinds, depth_highest),
        },
        coords={"quantity": quantities, "poisson": ratios, "level": levels},
    )
