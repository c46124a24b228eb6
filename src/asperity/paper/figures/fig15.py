"""Figure 15: compressibility and the average decay of the von Mises stress."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.shared import decays


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Eq. 22 for every Poisson's ratio, panel a along depth, panel b in the plane, over the variance there.

    Parameters
    ----------
    statistics : mapping of datasets
        Result of stage statistics of one surface, at several Poisson's ratios.
    """
    (data,) = statistics.values()
    return decays({rf"$\nu = {poisson:g}$": (data, poisson) for poisson in data["poisson"].values})
