"""Figure 6: the heights of the rough surfaces, and a cross-section of each."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.style import label, panels


def draw(surface: Mapping[str, xr.Dataset], statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Panel a: probability density of the heights over all seeds; panel b: the section y = L/2.

    Parameters
    ----------
    surface, statistics : mapping of datasets
        Results of the stages of these names, by surface.
    """
    figure, (heights, section) = panels()
    for name, data in statistics.items():
        edges = data["height_edge"].values
        heights.plot((edges[1:] + edges[:-1]) / 2, data["height_density"], label=label(surface[name]))
    heights.set(
        xlabel=r"$h / h_\mathrm{rms}$", ylabel="probability density", xlim=(-4.5, 4.5), ylim=(0, None)
    )
    heights.legend()
    for data in surface.values():
        profile = data["height"].isel(y=data.sizes["y"] // 2) / data["rms_height"]
        section.plot(data["x"], profile, lw=0.6, label=label(data))
    section.set(xlabel="$x / L$", ylabel=r"$h / h_\mathrm{rms}$", xlim=(0, 1))
    section.legend(loc="upper right", ncols=len(surface))
    section.set_ylim(top=1.25 * section.get_ylim()[1])
    return figure
