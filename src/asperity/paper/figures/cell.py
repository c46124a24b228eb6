"""The cell in three dimensions: a block of solid with its deformed surface, and the indenter above it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from asperity.core.types import Array
from asperity.views.style import MILLIMETRE

SOLID, FRONT, RIGHT = "#c9d6df", "#9fb3c1", "#8aa0b0"
"""Colours of the solid's surface and of the two walls that are seen."""

Edge = tuple[Array, Array | float, Array]


def scene(width: float, height: float) -> tuple[Figure, Axes3D]:
    """A figure of `width` × `height` millimetres, filled by three-dimensional axes without frame.

    Objects are drawn in the order in which they are added, whatever lies in front.
    """
    figure = Figure(figsize=(width * MILLIMETRE, height * MILLIMETRE))
    figure.set_layout_engine("none")
    axis = Axes3D(figure, (0.0, 0.0, 1.0, 1.0), computed_zorder=False)
    figure.add_axes(axis)
    axis.view_init(24, -58)
    axis.set_axis_off()
    axis.set_proj_type("ortho")
    return figure, axis


def surface(axis: Axes3D, x: Array, y: Array, z: Array, colour: str | Array) -> None:
    """Draw a surface z over the coordinates x and y, in one colour or one for each node, lightly shaded."""
    paint: dict[str, Any] = {"color": colour} if isinstance(colour, str) else {"facecolors": colour}
    columns, rows = np.meshgrid(x, y)
    axis.plot_surface(
        columns, rows, z, rcount=len(y), ccount=len(x), lw=0, antialiased=False, rasterized=True, **paint
    )


def walls(axis: Axes3D, front: Edge, right: Edge) -> None:
    """Draw the two faces of the block that are seen, from the given upper edges (x, y, z) down to z = 0."""
    for edge, shade in ((front, FRONT), (right, RIGHT)):
        x, y, z = np.broadcast_arrays(*edge)
        top = np.column_stack([x, y, z])
        bottom = np.column_stack([x, y, np.zeros_like(z)])[::-1]
        axis.add_collection3d(
            Poly3DCollection([np.vstack([top, bottom])], facecolor=shade, edgecolor="k", linewidth=0.4)
        )


def lines(axis: Axes3D, segments: Sequence[Array], **look: Any) -> None:
    """Draw polylines of points (x, y, z)."""
    axis.add_collection3d(Line3DCollection(segments, **look))


def ground(axis: Axes3D) -> None:
    """Draw the rigid ground to which the block is bonded."""
    reach, thick = 0.56, 0.05
    corners = np.array([[-reach, -reach], [reach, -reach], [reach, reach], [-reach, reach]])
    front = [(x, -reach, z) for x, z in ((-reach, 0), (reach, 0), (reach, -thick), (-reach, -thick))]
    right = [(reach, y, z) for y, z in ((-reach, 0), (reach, 0), (reach, -thick), (-reach, -thick))]
    top = [(x, y, 0.0) for x, y in corners]
    axis.add_collection3d(
        Poly3DCollection(
            [top, front, right], facecolor=["#e6e6e6", "#bbbbbb", "#a8a8a8"], edgecolor="k", linewidth=0.3
        )
    )
