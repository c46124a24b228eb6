"""Stress close to a patch of contact, kept from the stream of planes for pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
import xarray as xr

from asperity.contact import Contact
from asperity.core.types import Array
from asperity.stress.planes.stream import LinearPlane
from asperity.surface.treatment.treatment import TreatedMap

PATCHES = 4
"""Patches of the highest pressures that are kept: the largest stress is under one of them."""

WIDTHS, LENGTHS = 4, 1
"""Half of the edge of a close-up over the width and, if that is less, over the length of its patch."""

FEWEST_PIXELS, MOST_PIXELS = 12, 64
"""Half of the edge of a close-up, in pixels."""

MARGIN = 3
"""Nodes beyond a close-up that the interpolation in it uses."""


@dataclass(frozen=True)
class CloseUp:
    """Fields of the stress in a box of the solid around a patch of contact.

    Parameters
    ----------
    middle : (y, x)
        Place in the cell of the largest pressure of the patch.
    half : float
        Half of the edge of the box.
    along : "x" or "y"
        Axis across the patch.
    planes : list of (depth, (y, x), {field: values})
        As far as the stream has come, each on the nodes of its own grid.
    """

    middle: tuple[float, float]
    half: float
    along: str
    planes: list[tuple[float, tuple[Array, Array], dict[str, Array]]] = field(default_factory=list)

    @property
    def spans(self) -> tuple[tuple[float, float], ...]:
        """First and last place along y and x."""
        return tuple((place - self.half, place + self.half) for place in self.middle)

    def add(self, plane: LinearPlane, names: Sequence[str], poisson: float, periodic: bool) -> None:
        """Keep the next plane."""
        nodes, places = [], []
        for (first, last), count, step in zip(self.spans, plane.grid.shape, plane.grid.spacing, strict=True):
            node = np.arange(np.floor(first / step) - MARGIN, np.ceil(last / step) + MARGIN + 1, dtype=int)
            if not periodic:
                node = node[(node >= 0) & (node < count)]
            nodes.append(node % count)
            places.append(node * step)
        flat = (nodes[0][:, None] * plane.grid.shape[1] + nodes[1]).ravel()
        shape = nodes[0].size, nodes[1].size
        values = {name: plane.field_at(name, poisson, flat).reshape(shape) for name in names}
        self.planes.append((plane.depth, (places[0], places[1]), values))

    def holds(self, y: float, x: float) -> bool:
        """True if a place lies in the box."""
        return all(first <= place <= last for place, (first, last) in zip((y, x), self.spans, strict=True))

    def plane(self, name: str, depth: float, y: Array, x: Array) -> Array:
        """A field at places of the kept plane nearest to a depth."""
        nearest = min(self.planes, key=lambda plane: abs(plane[0] - depth))
        return _interpolated(nearest[1], nearest[2][name], y, x)

    def section(self, name: str, at: float, nodes: Array) -> xr.DataArray:
        """A field (depth, along) in a vertical section at places along it."""
        deepest = 1.2 * self.half
        rows, depths = [], []
        for depth, axes, values in self.planes:
            y, x = (np.array([at]), nodes) if self.along == "x" else (nodes, np.array([at]))
            rows.append(_interpolated(axes, values[name], y, x).ravel())
            depths.append(depth)
            if depth > deepest:
                break
        return xr.DataArray(np.array(rows), {"depth": depths, self.along: nodes}, ("depth", self.along))


def _interpolated(axes: tuple[Array, Array], values: Array, y: Array, x: Array) -> Array:
    """Values between equidistant nodes, by cubic splines."""
    from scipy.ndimage import map_coordinates

    steps = [(axis[-1] - axis[0]) / (axis.size - 1) for axis in axes]
    places = [(place - axis[0]) / step for place, axis, step in zip((y, x), axes, steps, strict=True)]
    return map_coordinates(values, np.meshgrid(*places, indexing="ij"), order=3, mode="nearest")


def close_ups(face: TreatedMap, contact: Contact, spots: pd.DataFrame) -> list[CloseUp]:
    """Empty close-ups of the patches that bear the highest pressures."""
    pixel, most = max(face.grid.spacing), min(face.map_length) / 2
    highest = spots.nlargest(PATCHES, "largest_pressure_Pa")
    pressure, found = face.part(contact.pressure), []
    for spot in highest.itertuples():
        row, column = np.argwhere(pressure == spot.largest_pressure_Pa)[0]
        half = max(min(WIDTHS * spot.width_m, LENGTHS * spot.length_m), FEWEST_PIXELS * pixel)
        middle = row * face.grid.spacing[0], column * face.grid.spacing[1]
        along = "x" if 45 <= spot.angle_deg <= 135 else "y"
        found.append(CloseUp(middle, min(half, MOST_PIXELS * pixel, most), along))
    return found
