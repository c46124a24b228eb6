"""Figure 15: compressibility and the average decay of the von Mises stress."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.captions import bullets, decay_lengths
from asperity.paper.figures.cases import of_ratios
from asperity.paper.figures.plots import decays

STAGES = ("statistics",)
STUDIES = ("compressibility",)
OWN = "poisson_decay"
SEVERAL_RATIOS = True


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Draw Eq. 22 for each Poisson's ratio, (a) along depth and (b) in the plane, over the variance there."""
    return decays(of_ratios(statistics))


def caption(statistics: Mapping[str, xr.Dataset]) -> str:
    """Lengths over which the covariance falls to half, for each Poisson's ratio."""
    return bullets(decay_lengths(of_ratios(statistics)))
