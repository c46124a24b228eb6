"""Figure 7: the contact pressure over the cell, one panel for each surface."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from asperity.paper.figures.cases import Datasets, bullets, contact_area
from asperity.results.dataset import grid_of
from asperity.views.maps import blocks
from asperity.views.style import COLUMN, PAGE, label, panels

PIXELS = 512
"""Smallest number of pixels along an edge, where the grid has as many nodes."""

WIDEST = 4.0
"""Largest end of the colours over that of the surface with the smallest pressure: one surface with spikes
does not make the others pale."""


def draw(contact: Datasets) -> Figure:
    """Draw the pressure over E* times the rms gradient of the real contact; white where there is no contact.

    Notes
    -----
    A pixel shows the largest pressure of the nodes under it, so that the smallest contacts are seen.
    """
    maps = {}
    for name, data in contact.items():
        size = max(1, data.sizes["y"] // PIXELS)
        pixels = blocks(data["pressure"].values, (size, size), np.max)
        maps[name] = pixels / float(data["gradient_rms_contact"])
    figure, axes = panels(columns=len(maps), height=76, width=PAGE if len(maps) > 1 else COLUMN)
    ends = [np.percentile(values[values > 0], 99.5) for values in maps.values()]
    largest = min(max(ends), WIDEST * min(ends))
    for axis, (name, values) in zip(axes, maps.items(), strict=True):
        height, width = grid_of(contact[name]).length
        image = axis.imshow(
            np.ma.masked_equal(values, 0),
            origin="lower",
            extent=(0, width, 0, height),
            vmin=0,
            vmax=largest,
            cmap="viridis_r",
        )
        axis.set(xlabel="$x / L$", ylabel="$y / L$")
        title = label(contact[name])
        if ", " in title:  # on lines above that of the letter of the panel, which it would run into
            title = title.replace(", ", ",\n") + "\n"
        axis.set_title(title, loc="center")
        axis.spines[["top", "right"]].set_visible(True)
    figure.colorbar(image, ax=axes, label=r"$t_3 / E^* \bar{g}_r$", extend="max", shrink=0.8)
    return figure


def caption(contact: Datasets) -> str:
    """Area in contact and load of each surface."""
    return bullets(map(contact_area, contact.values()))
