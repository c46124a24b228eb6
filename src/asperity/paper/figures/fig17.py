"""Figure 17: skewness and short waves, and the distribution of the von Mises peaks."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.shared import density, name_density
from asperity.paper.figures.style import label, panels


def draw(statistics: Mapping[str, Mapping[str, xr.Dataset]]) -> Figure:
    """Panel a: surfaces of different skewness; panel b: surfaces of different shortest wavelength.

    Parameters
    ----------
    statistics : mapping of mappings of datasets
        Results of stage statistics by surface, by study: ``skewness`` and ``kurtosis``.
    """
    figure, axes = panels(columns=len(statistics))
    for axis, study in zip(axes, statistics.values(), strict=True):
        for data in study.values():
            density(axis, data, "von_mises", data.attrs["poisson_contact"], label=label(data))
        name_density(axis, r"\sigma_\mathrm{VM}")
        axis.legend()
    return figure
