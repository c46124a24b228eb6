"""Figure 10: how the von Mises peaks are distributed over value and depth, one panel a surface."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.shared import depth_distributions
from asperity.paper.figures.style import label


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Number of peaks per unit of value and depth, on a logarithmic scale of colour.

    Parameters
    ----------
    statistics : mapping of datasets
        Results of stage statistics, one a panel.
    """
    return depth_distributions(
        {label(data): (data, data.attrs["poisson_contact"]) for data in statistics.values()}
    )
