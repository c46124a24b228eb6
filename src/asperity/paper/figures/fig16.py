"""Figure 16: the heights of the skewed surfaces and of those with other cut-offs, and a section of each."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.shared import height_density
from asperity.paper.figures.style import label, panels

_OFFSET = 7.0


def draw(
    surface: Mapping[str, Mapping[str, xr.Dataset]], statistics: Mapping[str, Mapping[str, xr.Dataset]]
) -> Figure:
    """Panels a, b: density of the heights over all seeds; panels c, d: the section y = L/2, shifted.

    Parameters
    ----------
    surface, statistics : mapping of mappings of datasets
        Results of the stages of these names by surface, by study: ``skewness`` (panels a, c) and
        ``kurtosis`` (panels b, d).
    """
    figure, axes = panels(columns=len(statistics), rows=2, height=58)
    for study, heights, section in zip(statistics, axes, axes[len(statistics) :], strict=False):
        moment = "skewness" if study == "skewness" else "kurtosis"
        for number, (name, data) in enumerate(statistics[study].items()):
            measured = float(data[f"member_{moment}"].mean())
            title = label(surface[study][name])
            height_density(heights, data, label=f"{title}\n{moment} {measured:+.2f}".replace(" +", " "))
            profile = surface[study][name]["height"].isel(y=surface[study][name].sizes["y"] // 2)
            shifted = profile / surface[study][name]["rms_height"] - _OFFSET * number
            section.plot(shifted["x"], shifted, lw=0.5, label=title)
            section.axhline(-_OFFSET * number, color="k", lw=0.3)
        heights.legend(fontsize=6)
        heights.set_ylim(top=1.05 * heights.get_ylim()[1])
        section.set(xlabel="$x / L$", ylabel=r"$h / h_\mathrm{rms}$, shifted", xlim=(0, 1), yticks=[])
    return figure
