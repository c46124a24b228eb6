"""Figure 10: how the von Mises peaks are distributed over value and depth, one panel for each surface."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.captions import bullets, peak_depths
from asperity.paper.figures.cases import of_surfaces
from asperity.paper.figures.plots import depth_distributions

STAGES = ("statistics",)
STUDIES = ("hurst",)
SUPPLEMENT = ("moments", "measured")
OWN = "depths"


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the joint density of value and depth, on a logarithmic scale of colour."""
    return depth_distributions(of_surfaces(statistics))


def caption(statistics: Mapping[str, xr.Dataset]) -> str:
    """Median depths of the peaks of each surface."""
    return bullets(peak_depths(of_surfaces(statistics)))
