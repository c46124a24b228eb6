"""Stress close to the highest pressures, kept from the stream of planes for pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from asperity.contact import Contact
from asperity.core.types import Array
from asperity.fourier.grid import Grid
from asperity.stress.planes.stream import LinearPlane
from asperity.surface.treatment.treatment import TreatedMap

BOXES = 4
"""Close-ups, around the highest pressures: the largest stress is in one of them, but for exceptions."""

WIDTHS = 2
"""Half of the edge of a close-up over the typical width of a patch."""

FEWEST_PIXELS, MOST_PIXELS = 12, 64
"""Half of the edge of a close-up, in pixels."""

DEPTH = 0.6
"""Depth of a close-up over its edge."""

MARGIN = 3
"""Nodes beyond a close-up that the interpolation in it uses."""


@dataclass(frozen=True)
class CloseUp:
    """Fields of the stress in a box of the solid below a high pressure.

    Parameters
    ----------
    grid : Grid
        Of the contact.
    part : (rows, columns)
        Nodes of the box.
    along : "x" or "y"
        Axis across the contact.
    depths : list of float
    planes : list of dict
        Of each depth, field → its values at the nodes.
    """

    grid: Grid
    part: tuple[slice, slice]
    along: str
    depths: list[float] = field(default_factory=list)
    planes: list[dict[str, Array]] = field(default_factory=list)

    def add(self, plane: LinearPlane, names: Sequence[str], poisson: float, periodic: bool) -> None:
        """Keep the next plane, unless one lies below the box already."""
        from scipy.ndimage import map_coordinates

        edge = max((nodes.stop - nodes.start) * step for nodes, step in self._axes)
        if self.depths and self.depths[-1] > DEPTH * edge:
            return
        taken, places = [], []
        for (nodes, step), count, own in zip(self._axes, plane.grid.shape, plane.grid.spacing, strict=True):
            place = np.arange(nodes.start, nodes.stop) * step / own
            node = np.arange(int(place[0]) - MARGIN, int(place[-1]) + MARGIN + 2)
            taken.append(node % count if periodic else np.clip(node, 0, count - 1))
            places.append(place - node[0])
        flat = (taken[0][:, None] * plane.grid.shape[1] + taken[1]).ravel()
        at = np.meshgrid(*places, indexing="ij")
        fields = {}
        for name in names:
            values = plane.field_at(name, poisson, flat).reshape(taken[0].size, taken[1].size)
            fields[name] = map_coordinates(values, at)
        self.depths.append(plane.depth)
        self.planes.append(fields)

    @property
    def _axes(self) -> list[tuple[slice, float]]:
        """Nodes and spacing along y and x."""
        return list(zip(self.part, self.grid.spacing, strict=True))

    def node(self, y: float, x: float) -> tuple[int, int] | None:
        """Row and column in the box of a place; None outside of it."""
        row, column = (
            round(place / step) - nodes.start for place, (nodes, step) in zip((y, x), self._axes, strict=True)
        )
        rows, columns = (nodes.stop - nodes.start for nodes in self.part)
        return (row, column) if 0 <= row < rows and 0 <= column < columns else None


def close_ups(face: TreatedMap, contact: Contact, width: float) -> list[CloseUp]:
    """Empty close-ups around the highest pressures on the map, none of them in the box of a higher one.

    Parameters
    ----------
    face : TreatedMap
    contact : Contact
    width : float
        Typical width of a patch of contact, in pixels.
    """
    found: list[CloseUp] = []
    weight = face.part(contact.pressure) / max(contact.max_pressure, 1e-300)
    depth = contact.plastic_depth
    if depth is not None and depth.any():  # of the nodes at the hardness those that overlap most
        weight = weight + face.part(depth) / depth.max()
    left = weight.copy()
    half = round(min(max(WIDTHS * width, FEWEST_PIXELS), MOST_PIXELS))
    while len(found) < BOXES and left.any():
        middle = np.unravel_index(left.argmax(), left.shape)
        ends = zip(map(int, middle), face.map_shape, strict=True)
        rows, columns = (slice(max(0, node - half), min(count, node + half + 1)) for node, count in ends)
        along = _axis_across(weight[rows, columns], face.grid)
        found.append(CloseUp(face.grid, (rows, columns), along))
        left[rows, columns] = 0
    return found


def _axis_across(weight: Array, grid: Grid) -> str:
    """Axis along which the weight changes most: across the lay, also if there are several ridges."""
    slopes = {
        name: float(np.square(np.diff(weight, axis=axis)).sum()) / step**2
        for name, axis, step in zip("yx", (0, 1), grid.spacing, strict=True)
    }
    return max(slopes, key=lambda name: slopes[name])
