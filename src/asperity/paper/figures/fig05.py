"""Figure 5: a rough indenter above the cell it is pressed into, from the computed contact."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from asperity.paper.figures import cell
from asperity.types import Array

NODES = 192
"""Most nodes drawn along an edge."""

RELIEF = 0.02
"""Root-mean-square height as drawn, in cell lengths."""

LIFT = 0.4
"""How far the indenter is drawn above its place."""


def draw(surface: Mapping[str, xr.Dataset], contact: Mapping[str, xr.Dataset]) -> Figure:
    """The deformed solid with its contacts in red, and the indenter lifted off it, coloured by height.

    Parameters
    ----------
    surface, contact : mapping of datasets
        Results of the stages of these names; the last surface is drawn.
    """
    name = list(surface)[-1]
    rough, pressed = surface[name], contact[name]
    x = rough.x.values
    step = max(1, -(-len(x) // NODES))
    height, displacement = rough.height.values, pressed.displacement.values
    magnify = RELIEF / float(rough.rms_height)
    x = x[::step] - 0.5
    height = height[::step, ::step]
    down = displacement[::step, ::step]
    down = down - displacement.min()
    touching = pressed.pressure.values
    # A drawn node is in contact if any node it stands for is.
    patches = np.pad(touching, ((0, -len(touching) % step), (0, -len(touching) % step)))
    patches = patches.reshape(len(x), step, len(x), step).max(axis=(1, 3)) > 0

    figure, axis = cell.scene(width=110, height=105)
    cell.ground(axis)
    top = 1 - magnify * down
    front, right = top[0], top[:, -1]
    corner = np.full(len(x), x[-1])
    cell.walls(axis, (x, -0.5, front), (corner, x, right))
    cell.surface(axis, x, x, top, _painted(patches))
    norm = Normalize(*np.percentile(height / float(rough.rms_height), [0.1, 99.9]))
    colours = mpl.colormaps["viridis"](norm(height / float(rough.rms_height)))
    cell.surface(axis, x, x, 1 + LIFT + magnify * height, colours)
    axis.set(xlim=(-0.5, 0.5), ylim=(-0.5, 0.5), zlim=(-0.08, 1.5))
    axis.set_box_aspect((1, 1, 1.58), zoom=1.04)
    bar = figure.add_axes((0.87, 0.62, 0.02, 0.28))
    figure.colorbar(ScalarMappable(norm, "viridis"), cax=bar, label=r"$h / h_\mathrm{rms}$")
    return figure


def _painted(patches: Array) -> Array:
    """Colours of the solid's surface, contacts in red."""
    colours = np.empty((*patches.shape, 4))
    colours[:] = mpl.colors.to_rgba(cell.SOLID)
    colours[patches] = mpl.colors.to_rgba("#D55E00")
    return colours
