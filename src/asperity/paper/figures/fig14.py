"""Figure 14: von Mises peaks over value and depth, in the least and the most compressible solid."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.captions import bullets, peak_depths
from asperity.paper.figures.cases import extreme_ratios
from asperity.paper.figures.plots import depth_distributions

STAGES = ("statistics",)
STUDIES = ("compressibility",)
OWN = "poisson_depths"
SEVERAL_RATIOS = True


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the joint density of value and depth for (a) the largest and (b) the smallest Poisson's ratio."""
    return depth_distributions(extreme_ratios(statistics))


def caption(statistics: Mapping[str, xr.Dataset]) -> str:
    """Median depths of the peaks for the extreme Poisson's ratios."""
    return bullets(peak_depths(extreme_ratios(statistics)))
