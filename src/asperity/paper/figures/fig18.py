"""Figure 18: von Mises peaks over value and depth, without and with the shortest waves."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.captions import bullets, peak_depths
from asperity.paper.figures.cases import shortest_waves
from asperity.paper.figures.plots import depth_distributions

STAGES = ("statistics",)
STUDIES = ("kurtosis",)


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the joint densities of the two surfaces with the shortest waves, the shorter one in panel b.

    The unit of depth in both panels, λ_sn, is the shortest wavelength of the surface in panel a.
    """
    cases = shortest_waves(statistics)
    return depth_distributions(cases, unit=cases[0].wavelength_short, symbol=r"\lambda_{sn}")


def caption(statistics: Mapping[str, xr.Dataset]) -> str:
    """Median depths of the peaks in one unit of depth."""
    cases = shortest_waves(statistics)
    return bullets(peak_depths(cases, unit=cases[0].wavelength_short, symbol="λ_sn"))
