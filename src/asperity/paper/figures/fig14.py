"""Figure 14: von Mises peaks over value and depth, in the least and the most compressible solid."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.shared import depth_distributions


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Panel a: the largest Poisson's ratio of the study; panel b: the smallest.

    Parameters
    ----------
    statistics : mapping of datasets
        Result of stage statistics of one surface, at several Poisson's ratios.
    """
    (data,) = statistics.values()
    ratios = sorted({float(data["poisson"].max()), float(data["poisson"].min())}, reverse=True)
    return depth_distributions({rf"$\nu = {poisson:g}$": (data, poisson) for poisson in ratios})
