"""Figure 11: the average decay of the von Mises stress along depth and in the plane of its largest peak."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.captions import bullets, decay_lengths
from asperity.paper.figures.cases import of_surfaces
from asperity.paper.figures.plots import decays

STAGES = ("statistics",)
STUDIES = ("hurst",)
SUPPLEMENT = ("moments", "measured")
OWN = "decay"


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Draw Eq. 22 (a) along depth and (b) in the plane, over the variance in that plane."""
    return decays(of_surfaces(statistics))


def caption(statistics: Mapping[str, xr.Dataset]) -> str:
    """Lengths over which the covariance falls to half, for each surface."""
    return bullets(decay_lengths(of_surfaces(statistics)))
