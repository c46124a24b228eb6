"""Figure 5: a rough indenter above the cell it is pressed into, from the computed contact."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from asperity.paper.figures import cell
from asperity.paper.figures.cases import Datasets, bullets, contact_area, name
from asperity.views.maps import blocks
from asperity.views.style import label

NODES = 192
"""Largest number of nodes drawn along an edge."""

RELIEF = 0.02
"""Root-mean-square height as drawn, in cell lengths."""

LIFT = 0.4
"""Distance by which the indenter is drawn above its place, in cell lengths."""


def draw(surface: Datasets, contact: Datasets) -> Figure:
    """Draw the deformed solid with its contacts in red, and above it the indenter, coloured by height.

    The last surface is drawn.
    """
    rough, pressed = list(surface.values())[-1], list(contact.values())[-1]
    step = max(1, -(-rough.sizes["x"] // NODES))
    x = rough.x.values[::step] - 0.5
    magnify = RELIEF / float(rough.rms_height)
    height = rough.height.values[::step, ::step]
    down = pressed.displacement.values[::step, ::step] - pressed.displacement.values.min()

    figure, axis = cell.scene(width=110, height=105)
    cell.ground(axis)
    top = 1 - magnify * down
    cell.walls(axis, (x, -0.5, top[0]), (np.full(len(x), x[-1]), x, top[:, -1]))
    contacts = blocks(pressed.pressure.values, (step, step), np.max) > 0
    painted = np.where(contacts[..., None], mpl.colors.to_rgba("#D55E00"), mpl.colors.to_rgba(cell.SOLID))
    cell.surface(axis, x, x, top, painted)
    norm = Normalize(*np.percentile(height / float(rough.rms_height), [0.1, 99.9]))
    colours = mpl.colormaps["viridis"](norm(height / float(rough.rms_height)))
    cell.surface(axis, x, x, 1 + LIFT + magnify * height, colours)
    axis.set(xlim=(-0.5, 0.5), ylim=(-0.5, 0.5), zlim=(-0.08, 1.5))
    axis.set_box_aspect((1, 1, 1.58), zoom=1.04)
    bar = figure.add_axes((0.87, 0.62, 0.02, 0.28))
    figure.colorbar(ScalarMappable(norm, "viridis"), cax=bar, label=r"$h / h_\mathrm{rms}$")
    return figure


def caption(surface: Datasets, contact: Datasets) -> str:
    """The drawn surface, its area of contact and its load."""
    drawn = list(surface)[-1]
    return f"Drawn: {name(label(surface[drawn]))}.\n\n{bullets([contact_area(contact[drawn])])}"
