"""Figure 1: the cell under a Hertzian indenter, drawn from the finite elements' deformed mesh."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from asperity.paper.figures import cell
from asperity.types import Array

DEPTH = 0.14
"""Indentation as drawn, in cell lengths; the computed displacements are magnified to it."""


def draw(validation: Mapping[str, xr.Dataset]) -> Figure:
    """The periodic cell of the slab, half of the indenter cut away.

    Parameters
    ----------
    validation : mapping of datasets
        ``elements``, of `asperity.validation.finite_elements.compare_elements`.
    """
    data = validation["elements"]
    approach, curvature = data.attrs["approach"], data.attrs["curvature_radius"]
    magnify = DEPTH / approach
    figure, axis = cell.scene(width=85, height=78)
    cell.ground(axis)

    nodes = data.axis_node.values
    x = np.concatenate([-nodes[:0:-1], nodes])
    top = 1 + magnify * _mirror(_mirror(data.surface_displacement_elements.values).T).T

    # The wall at half a period, seen from outside: its mesh moves in its own plane alone.
    across, _, up = data.rim_displacement_elements.transpose("component", "node_z", "axis_node").values
    along = x + magnify * _mirror(across, odd=True)
    height = data.node_z.values[:, None] + magnify * _mirror(up)
    half = np.full(x.size, 0.5)
    cell.walls(axis, (along[-1], -half, height[-1]), (half, along[-1], height[-1]))
    for place in ("front", "right"):
        mesh = [
            *(np.column_stack(_on(place, along[row], height[row])) for row in range(0, len(height), 2)),
            *(np.column_stack(_on(place, along[:, i], height[:, i])) for i in range(0, x.size, 2)),
        ]
        cell.lines(axis, mesh, colors="k", linewidths=0.15, alpha=0.6)
    cell.surface(axis, x, x, top, cell.SOLID)

    radius = float(data.contact_radius)
    turn = np.linspace(0, 2 * np.pi, 121)
    edge = 1 + magnify * (radius**2 / (2 * curvature) - approach)
    circle = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(121, edge)])
    cell.lines(axis, [circle], colors="#D55E00", linewidths=0.9)

    # The back half of the indenter, up to where it meets the height drawn.
    reach = np.linspace(0, 0.31, 40)
    around = np.linspace(0.0, np.pi, 61)
    r, phi = np.meshgrid(reach, around)
    lift = 1 + magnify * (r**2 / (2 * curvature) - approach)
    axis.plot_surface(
        r * np.cos(phi), r * np.sin(phi), lift, color="#E69F00", alpha=0.75, linewidth=0, antialiased=False,
        rcount=61, ccount=40, rasterized=True,
    )  # fmt: skip
    profile = 1 + magnify * (np.concatenate([-reach[::-1], reach]) ** 2 / (2 * curvature) - approach)
    section = np.concatenate([-reach[::-1], reach])
    cell.lines(axis, [np.column_stack([section, 0 * section, profile])], colors="k", linewidths=0.6)

    _label(axis, radius, edge)
    axis.set(xlim=(-0.5, 0.5), ylim=(-0.5, 0.5), zlim=(-0.12, 1.3))
    axis.set_box_aspect((1, 1, 1.42), zoom=1.06)
    return figure


def _mirror(values: Array, odd: bool = False) -> Array:
    """Both sides of the axis, along the last dimension."""
    other = values[..., :0:-1]
    return np.concatenate([-other if odd else other, values], axis=-1)


def _on(place: str, along: Array, height: Array) -> tuple[Array, Array, Array]:
    """Points of the front wall (y = −1/2) or the right one (x = 1/2)."""
    half = np.full(along.shape, 0.5)
    return (along, -half, height) if place == "front" else (half, along, height)


def _label(axis: Axes3D, radius: float, edge: float) -> None:
    """Names of the lengths."""
    text = {"fontsize": 8, "ha": "center", "va": "center"}
    axis.text(0.0, -0.68, -0.1, "$L_x$", **text)
    axis.text(0.68, 0.0, -0.1, "$L_y$", **text)
    axis.text(0.58, 0.58, 0.5, "$L_z$", **text)
    axis.text(radius + 0.06, -radius - 0.06, edge, "$a$", color="#D55E00", **text)
    axis.text(0.0, 0.0, 1.44, "paraboloid, radius $R$", **text)
