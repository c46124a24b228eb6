"""Displacement and stress of the spectral solution at chosen points, without interpolation."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity.elasticity.layer import Layer
from asperity.spectral import Fourier, Grid, resample
from asperity.types import Array

LARGEST_DECAY = 40.0
"""Modes with q · depth above this are left out: they have decayed below rounding, e⁻⁴⁰ = 4 · 10⁻¹⁸."""


def displacement_and_stress(
    pressure: Array, grid: Grid, layer: Layer, y: ArrayLike, x: ArrayLike, depths: ArrayLike
) -> tuple[Array, Array]:
    """Displacement and stress below a pressure, as sums over its Fourier modes.

    Parameters
    ----------
    pressure : (ny, nx) array
    grid : Grid
    layer : Layer
    y, x : (points,) arrays
        Positions in the coordinates of the grid.
    depths : (depths,) array

    Returns
    -------
    displacement : (depths, points, 3) array
    stress : (depths, points, 6) array
    """
    y, x = np.atleast_1d(y), np.atleast_1d(x)
    rows, row_of_point = np.unique(y, return_inverse=True)
    spectrum = Fourier(grid).forward(pressure)
    displacement: list[Array] = []
    stress: list[Array] = []
    for depth in np.atleast_1d(depths):
        modes = _modes_that_reach(grid, depth)
        coefficients = resample(spectrum, grid, modes) * modes.multiplicity
        wave_y = np.exp(1j * np.outer(rows, modes.qy))
        wave_x = np.exp(1j * np.outer(x, modes.qx))
        qx, qy = modes.qx[None, :], modes.qy[:, None]
        for kernel, out in (
            (layer.displacement(qx, qy, depth), displacement),
            (layer.stress(qx, qy, depth), stress),
        ):
            flat = (coefficients[..., None] * kernel).reshape(modes.shape[0], -1)
            lines = (wave_y @ flat).reshape(len(rows), len(modes.qx), -1)
            out.append(np.einsum("px,pxc->pc", wave_x, lines[row_of_point]).real)
    return np.array(displacement), np.array(stress)


def _modes_that_reach(grid: Grid, depth: float) -> Grid:
    """Grid whose modes are those of `grid` that have not decayed at `depth`.

    It has at most one node more than `grid` along each axis, and no mode of `grid` is at its Nyquist
    wavevector.
    """
    reach = [LARGEST_DECAY * edge / (2 * np.pi * depth) if depth > 0 else np.inf for edge in grid.length]
    ny, nx = (int(min(n + 1, 2 * np.ceil(modes) + 1)) for n, modes in zip(grid.shape, reach, strict=True))
    return Grid((ny, nx), grid.length)
