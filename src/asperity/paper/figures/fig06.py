"""Figure 6: the heights of the rough surfaces, and a cross-section of each."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.captions import bullets, height_moments
from asperity.paper.figures.plots import height_densities
from asperity.views.style import label, panels

STAGES = ("surface", "statistics")
STUDIES = ("hurst",)
SUPPLEMENT = ("moments", "measured")
OWN = "heights"


def draw(surface: Mapping[str, xr.Dataset], statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Draw (a) the probability density of the heights, all seeds, and (b) the section y = L/2 of one seed."""
    figure, (heights, section) = panels()
    height_densities(heights, [label(data) for data in statistics.values()], statistics.values())
    heights.legend()
    for data in surface.values():
        profile = data["height"].isel(y=data.sizes["y"] // 2) / data["rms_height"]
        section.plot(data["x"], profile, lw=0.6, label=label(data))
    section.set(xlabel="$x / L$", ylabel=r"$h / h_\mathrm{rms}$", xlim=(0, 1))
    section.legend(loc="upper right", ncols=len(surface))
    section.set_ylim(top=1.25 * section.get_ylim()[1])
    return figure


def caption(surface: Mapping[str, xr.Dataset], statistics: Mapping[str, xr.Dataset]) -> str:
    """Skewness and kurtosis of each surface."""
    return bullets(height_moments(surface, statistics))
