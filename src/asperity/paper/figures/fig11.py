"""Figure 11: the average decay of the von Mises stress along depth and in the plane of its largest peak."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.shared import decays
from asperity.paper.figures.style import label


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Eq. 22, panel a along depth, panel b in the plane, each over the variance in that plane.

    Parameters
    ----------
    statistics : mapping of datasets
        Results of stage statistics, by surface.
    """
    return decays({label(data): (data, data.attrs["poisson_contact"]) for data in statistics.values()})
