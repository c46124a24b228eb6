"""Patches of contact, and how the depth of the peaks follows the size of the patch above them."""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from asperity.core.types import Array


def contact_patches(contact: Array, periodic: bool = True) -> tuple[Array, Array]:
    """Connected patches of contact; nodes are neighbours along edges and diagonals.

    Parameters
    ----------
    contact : (ny, nx) boolean array
    periodic : bool
        True if opposite edges of the cell are neighbours.

    Returns
    -------
    number : (ny, nx) array
        Number of the patch at each node, from 1; 0 outside contact.
    radii : (patches,) array
        Radius of the disc of the same area, in grid spacings.
    """
    number, count = ndimage.label(contact, structure=np.ones((3, 3)))
    if periodic:
        # Patches that meet across opposite edges, or diagonally across them, are one.
        edges = ((number[0], number[-1]), (number[:, 0], number[:, -1]))
        pairs = np.hstack([(first, np.roll(last, shift)) for first, last in edges for shift in (-1, 0, 1)])
        pairs = pairs[:, (pairs > 0).all(axis=0)]
        meet = coo_array((np.ones(pairs.shape[1]), tuple(pairs)), shape=(count + 1, count + 1))
        number = connected_components(meet, directed=False)[1][number]
    area = np.bincount(number.ravel())[1:]
    return number, np.sqrt(area / np.pi)


def depth_patch_correlation(depth: Array, row: Array, column: Array, patches: Array, radii: Array) -> float:
    """Rank correlation (Spearman) between the depth of peaks and the radius of the patch above them.

    Parameters
    ----------
    depth, row, column : (peaks,) arrays
        Depth of each peak, and the node above it.
    patches, radii : arrays
        As of `contact_patches`. Peaks that are not under a patch are left out.

    Returns
    -------
    float
        NaN with fewer than two different depths or radii.
    """
    ny, nx = patches.shape
    above = patches[row % ny, column % nx]
    touched = above > 0
    depth, radius = depth[touched], radii[above[touched] - 1]
    if np.unique(depth).size < 2 or np.unique(radius).size < 2:
        return float("nan")
    return float(np.corrcoef(pd.Series(radius).rank(), pd.Series(depth).rank())[0, 1])
