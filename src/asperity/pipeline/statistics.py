"""Stage four: distributions over all peaks and all seeds of a surface, with their uncertainty."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from asperity.pipeline.solid import SOLID_ATTRIBUTES
from asperity.stress.statistics import pool_peaks, probability_density

_HEIGHT_LIMITS = (-6.0, 6.0)


def summarise(
    surfaces: Sequence[xr.Dataset],
    contacts: Sequence[xr.Dataset],
    stresses: Sequence[xr.Dataset],
    bins: int,
    resamples: int,
    confidence: float,
) -> xr.Dataset:
    """Statistics of one surface over its seeds.

    Parameters
    ----------
    surfaces, contacts, stresses : sequence of datasets
        Results of the stages of these names, one for each seed, in one order.
    bins, resamples, confidence
        Section ``statistics`` of the configuration.

    Returns
    -------
    dataset
        As of `asperity.stress.statistics.pool_peaks`, with the distribution of the heights and the measures of
        every member.
    """
    gradients = [float(contact["gradient_rms_contact"]) for contact in contacts]
    dataset = pool_peaks(stresses, gradients, bins=bins, resamples=resamples, confidence=confidence)
    heights = np.concatenate([(s["height"] / s["rms_height"]).values.ravel() for s in surfaces])
    counts, edges, density = probability_density(heights, bins, _HEIGHT_LIMITS)
    dataset["height_edge"] = ("height_edge", edges)
    dataset["height_counts"] = ("height_bin", counts)
    dataset["height_density"] = ("height_bin", density)
    for name in ("skewness", "kurtosis", "rms_gradient"):
        dataset[f"member_{name}"] = ("member", [float(surface[name]) for surface in surfaces])
    for name in ("mean_pressure", "area_fraction"):
        dataset[f"member_{name}"] = ("member", [float(contact[name]) for contact in contacts])
    return dataset.assign_attrs({name: stresses[0].attrs[name] for name in SOLID_ATTRIBUTES})
