"""Response of a half-space, or of two, to a pressure on the map alone: nothing surrounds the map.

Each node stands for a rectangle under uniform pressure, of the size of the spacing and with the node in its
middle; see `asperity.elasticity.loaded_rectangle`. Far from the map the displacement is zero.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from asperity.contact.compliance.response import Response
from asperity.core.types import Array
from asperity.elasticity.loaded_rectangle import (
    PaddedFourier,
    compliance_modes,
    padded_grid,
    rectangle_compliance,
    slope_modes,
)
from asperity.fourier.grid import Grid


class FreeResponse(Response):
    """Response to an isolated pressure, exact for pressures that are uniform on the rectangle of a node."""

    boundary = "free"
    repeats = False
    transforms = PaddedFourier

    @cached_property
    def half_compliance(self) -> Array:
        return self.compliance[: self.mode_grid.shape[0] // 2 + 1].astype(self.fourier.real)

    @property
    def compliance(self) -> Array:
        return compliance_modes(self.grid, self.solid.effective_modulus)

    @property
    def mode_grid(self) -> Grid:
        """The padded grid, on which distances within the map do not wrap around."""
        return padded_grid(self.grid)

    @property
    def uniform_compliance(self) -> float:
        """The displacement in the middle of the map."""
        return rectangle_compliance(0.0, 0.0, self.grid.length, self.solid.effective_modulus).item()

    def coarsened(self, height: Array, shape: tuple[int, int]) -> tuple[Response, Array]:
        """The surface is averaged over pairs of nodes; a last node without a partner counts twice."""
        spacing, length = list(self.grid.spacing), list(self.grid.length)
        for axis in (0, 1):
            if shape[axis] < height.shape[axis]:
                length[axis] = 2 * shape[axis] * spacing[axis]
                height = _averaged(height, axis)
        return self.on_grid(Grid(shape, (length[0], length[1]))), height

    def interpolated(self, field: Array, finer: Response) -> Array:
        """Linear interpolation."""
        for axis in (0, 1):
            if self.grid.shape[axis] < finer.grid.shape[axis]:
                field = _interpolated(field, axis, finer.grid.shape[axis])
        return field

    def gradient(self, pressure: Array, displacement: Array) -> tuple[Array, Array]:
        """The exact slopes at the nodes under the same uniformly loaded rectangles."""
        fourier = PaddedFourier(self.grid, np.float64, self.fourier.threads, self.fourier.work)
        coefficients = fourier.forward(pressure)
        slope_y, slope_x = (
            fourier.inverse(coefficients * modes, overwrite=True)
            for modes in slope_modes(self.grid, self.solid.effective_modulus)
        )
        return slope_y, slope_x


def _averaged(field: Array, axis: int) -> Array:
    """Means over pairs of nodes along an axis."""
    lines = np.moveaxis(field, axis, 0)
    if len(lines) % 2:
        lines = np.concatenate([lines, lines[-1:]])
    return np.moveaxis(0.5 * (lines[::2] + lines[1::2]), 0, axis)


def _interpolated(field: Array, axis: int, nodes: int) -> Array:
    """Linear interpolation to twice the nodes along an axis, of which the first `nodes` are returned."""
    lines = np.moveaxis(field, axis, 0)
    padded = np.concatenate([lines[:1], lines, lines[-1:]])
    out = np.empty((2 * len(lines), *lines.shape[1:]), field.dtype)
    out[::2] = 0.75 * padded[1:-1] + 0.25 * padded[:-2]
    out[1::2] = 0.75 * padded[1:-1] + 0.25 * padded[2:]
    return np.ascontiguousarray(np.moveaxis(out[:nodes], 0, axis))
