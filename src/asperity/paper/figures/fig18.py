"""Figure 18: von Mises peaks over value and depth, without and with the shortest waves."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.shared import depth_distributions
from asperity.paper.figures.style import label, wavelength_short


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """The two surfaces with the shortest waves, panel b the shorter; depth in one unit for both.

    Parameters
    ----------
    statistics : mapping of datasets
        Results of stage statistics, by surface. The unit of depth, λ_sn, is the shortest wavelength of
        the surface in panel a.
    """
    chosen = sorted(statistics.values(), key=wavelength_short)[:2][::-1]
    return depth_distributions(
        {label(data): (data, data.attrs["poisson_contact"]) for data in chosen},
        unit=wavelength_short(chosen[0]),
        symbol=r"\lambda_{sn}",
    )
