"""Depths of the planes in which the stress is computed."""

from __future__ import annotations

import numpy as np

from asperity.finite import require_finite
from asperity.spectral import Grid
from asperity.stress.arguments import MAX_PLANES, checked_number
from asperity.types import Array


def depth_grid(grid: Grid, height: float | None = None, spacing: float = 0.5, growth: float = 0.125) -> Array:
    """Depths of planes from the surface to the bottom, close near the surface and farther apart below.

    A contact spot of radius a has its largest von Mises stress at 0.38–0.55 a, and the stress changes over
    lengths of about a. A feature at depth d is at least about 2 d wide, because shorter modes have decayed.
    Planes are therefore `spacing` grid spacings apart at first, and `growth` × depth apart below.

    Parameters
    ----------
    grid : Grid
        Of the contact pressure.
    height : float, optional
        Depth of the last plane, by default the longer edge of the cell.
    spacing : float
        Distance between the planes nearest to the surface, in spacings of the grid.
    growth : float
        Largest distance between planes, relative to their depth.

    Returns
    -------
    depths : (planes,) array
        Rising from 0 to the height.

    Raises
    ------
    ValueError, TypeError
        If an argument is not a positive finite number, or more than `MAX_PLANES` planes would be needed.

    Examples
    --------
    >>> depths = asp.depth_grid(asp.Grid((64, 64)), height=0.5)
    >>> depths[:4] * 64  # in spacings of the grid
    array([0. , 0.5, 1. , 1.5])
    >>> depths.size, float(depths[-1])
    (27, 0.5)
    """
    positive = "a positive finite number"
    spacing = checked_number("spacing", spacing, positive, lambda value: value > 0)
    growth = checked_number("growth", growth, positive, lambda value: value > 0)
    bottom = max(grid.length)
    if height is not None:
        bottom = checked_number("height", height, "a positive finite length", lambda value: value > 0)
    finest = spacing * min(grid.spacing)
    depths = [0.0]
    while depths[-1] < bottom:
        if len(depths) == MAX_PLANES:
            raise ValueError(
                f"spacing = {spacing:g}, growth = {growth:g}: larger values are needed, these make more than "
                f"{MAX_PLANES} planes to the depth {bottom:g}"
            )
        depths.append(depths[-1] + max(finest, growth * depths[-1]))
    depths[-1] = bottom
    if len(depths) > 2 and bottom - depths[-2] < 0.5 * (depths[-2] - depths[-3]):
        del depths[-2]
    found = np.array(depths)
    require_finite("depth_grid", {"depths": found})
    return found
