"""Figure 1: the cell under a Hertzian indenter, drawn from the finite elements' deformed mesh."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from asperity.core.types import Array
from asperity.paper.figures import cell
from asperity.paper.figures.cases import Datasets

DEPTH = 0.14
"""Indentation as drawn, in cell lengths; the computed displacements are magnified to it."""

INDENTER_RADIUS = 0.31
"""Radius to which the indenter is drawn, in cell lengths."""


def draw(validation: Datasets) -> Figure:
    """Draw the periodic cell of the slab with the mesh on its walls, and half of the indenter above it."""
    data = validation["elements"]
    magnify = DEPTH / data.attrs["approach"]
    figure, axis = cell.scene(width=85, height=78)
    cell.ground(axis)
    _draw_slab(axis, data, magnify)

    radius = float(data.contact_radius)
    turn = np.linspace(0, 2 * np.pi, 121)
    edge = float(_indenter(np.array(radius), data, magnify))
    circle = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(121, edge)])
    cell.lines(axis, [circle], colors="#D55E00", linewidths=0.9)

    _draw_indenter(axis, data, magnify)
    _label(axis, radius, edge)
    axis.set(xlim=(-0.5, 0.5), ylim=(-0.5, 0.5), zlim=(-0.12, 1.3))
    axis.set_box_aspect((1, 1, 1.42), zoom=1.06)
    return figure


def caption(validation: Datasets) -> str:
    """Size of what is drawn."""
    data = validation["elements"]
    return (
        f"A paraboloid of radius {data.attrs['curvature_radius']:g} L pressed by "
        f"{data.attrs['approach']:.3g} L into a slab; "
        f"contact radius {float(data['contact_radius']):.3f} L. Displacements are magnified."
    )


def _draw_slab(axis: Axes3D, data: xr.Dataset, magnify: float) -> None:
    """Draw the deformed surface of the slab and the mesh on the two walls that are seen."""
    nodes = data.axis_node.values
    x = np.concatenate([-nodes[:0:-1], nodes])
    top = 1 + magnify * _mirror(_mirror(data.surface_displacement_elements.values).T).T
    # The walls lie at half a period: by symmetry their nodes stay in the plane of the wall.
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


def _draw_indenter(axis: Axes3D, data: xr.Dataset, magnify: float) -> None:
    """Draw the back half of the indenter, and the outline of the section."""
    reach = np.linspace(0, INDENTER_RADIUS, 40)
    r, phi = np.meshgrid(reach, np.linspace(0.0, np.pi, 61))
    lift = _indenter(r, data, magnify)
    axis.plot_surface(
        r * np.cos(phi), r * np.sin(phi), lift, color="#E69F00", alpha=0.75, linewidth=0, antialiased=False,
        rcount=61, ccount=40, rasterized=True,
    )  # fmt: skip
    section = np.concatenate([-reach[::-1], reach])
    profile = _indenter(section, data, magnify)
    cell.lines(axis, [np.column_stack([section, 0 * section, profile])], colors="k", linewidths=0.6)


def _indenter(radius: Array, data: xr.Dataset, magnify: float) -> Array:
    """Height of the indenter's lower face at a distance from its axis, as drawn."""
    curvature, approach = data.attrs["curvature_radius"], data.attrs["approach"]
    return 1 + magnify * (radius**2 / (2 * curvature) - approach)


def _mirror(values: Array, odd: bool = False) -> Array:
    """Values on both sides of the axis, along the last dimension."""
    other = values[..., :0:-1]
    return np.concatenate([-other if odd else other, values], axis=-1)


def _on(place: str, along: Array, height: Array) -> tuple[Array, Array, Array]:
    """Points of the front wall (y = −1/2) or the right one (x = 1/2)."""
    half = np.full(along.shape, 0.5)
    return (along, -half, height) if place == "front" else (half, along, height)


def _label(axis: Axes3D, radius: float, edge: float) -> None:
    """Name the lengths."""
    text = {"fontsize": 8, "ha": "center", "va": "center"}
    axis.text(0.0, -0.68, -0.1, "$L_x$", **text)
    axis.text(0.68, 0.0, -0.1, "$L_y$", **text)
    axis.text(0.58, 0.58, 0.5, "$L_z$", **text)
    axis.text(radius + 0.06, -radius - 0.06, edge, "$a$", color="#D55E00", **text)
    axis.text(0.0, 0.0, 1.44, "paraboloid, radius $R$", **text)
