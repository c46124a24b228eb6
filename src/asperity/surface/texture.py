"""Lengths and direction of a surface's texture, and the bluntest tip that can have measured it."""

from __future__ import annotations

import numpy as np

from asperity.core.types import Array

CORRELATED = 0.2
"""Value of the autocorrelation that ends a length of the texture (ISO 25178-2)."""

DIRECTIONS = 180
"""Directions over half a turn in which the autocorrelation is followed."""

TIP_SAFETY = 0.5
"""Curvature of the sharpest peaks over that of the tip up to which the tip has not rounded them."""


def texture(height: Array, spacing: tuple[float, float]) -> tuple[float, float, float]:
    """Autocorrelation length Sal, texture aspect ratio Str and direction of the lay of ISO 25178-2.

    The autocorrelation is the mean product of the heights over the area that the surface and its shifted
    image share, for shifts up to half of each edge.

    Parameters
    ----------
    height : (ny, nx) array
        Levelled heights, not periodic.
    spacing : (y, x)

    Returns
    -------
    shortest : float
        Shortest length over which the autocorrelation falls to `CORRELATED`; NaN for a flat surface.
    ratio : float
        The shortest over the longest such length, which is taken as half of the map if it is longer.
    direction : float
        Direction of the longest one in degrees from x towards y, from 0 to 180.
    """
    from scipy.ndimage import map_coordinates

    ny, nx = height.shape
    centred = height - height.mean()
    product = np.fft.irfft2(np.abs(np.fft.rfft2(centred, (2 * ny, 2 * nx))) ** 2, (2 * ny, 2 * nx))
    rows, columns = np.arange(ny // 2 + 1), np.arange(-(nx // 2), nx // 2 + 1)
    shared = (ny - rows)[:, None] * (nx - np.abs(columns))
    correlation = product[rows[:, None], columns] / shared
    if not correlation[0, nx // 2] > 0:
        return np.nan, np.nan, np.nan
    angle = np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    farthest = np.hypot(rows[-1] * spacing[0], columns[-1] * spacing[1])
    radius = np.arange(0.0, farthest, min(spacing) / 2)
    y, x = (
        np.outer(part(angle), radius) / step for part, step in zip((np.sin, np.cos), spacing, strict=True)
    )
    along = map_coordinates(correlation, [y, x + nx // 2], order=1, cval=-1.0) / correlation[0, nx // 2]
    after = np.argmax(along < CORRELATED, axis=1)
    above, below = (along[np.arange(DIRECTIONS), after - step] for step in (1, 0))
    ends = (after - (CORRELATED - below) / (above - below)) * radius[1]
    longest = int(np.argmax(ends))
    return float(ends.min()), float(ends.min() / ends[longest]), float(np.degrees(angle[longest]))


def finest_tip(height: Array, spacing: tuple[float, float]) -> float:
    """Largest radius of a tip that has not rounded the peaks, which point up, at the distance of two points.

    A. Sanner, W. G. Nöhring, L. A. Thimons, T. D. B. Jacobs and L. Pastewka, Appl. Surf. Sci. Adv. 7 (2022)
    100190, doi 10.1016/j.apsadv.2021.100190.
    """
    sharpest = max(
        float(-np.diff(height, 2, axis=axis).min(initial=0.0)) / spacing[axis] ** 2 for axis in (0, 1)
    )
    return TIP_SAFETY / sharpest if sharpest else np.inf
