"""Patches of contact, and how the depth of the peaks follows the size of the patch above them."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

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
    parent = np.arange(count + 1)

    def root(i: int) -> int:
        while parent[i] != i:
            i = parent[i]
        return i

    # Join the patches that meet across the periodic edges: union-find over the nodes on opposite edges.
    edges = ((number[0], number[-1]), (number[:, 0], number[:, -1])) if periodic else ()
    for first, last in edges:
        for shift in (-1, 0, 1):
            moved = np.roll(last, shift)
            for one, other in zip(first, moved, strict=True):
                if one and other:
                    parent[root(one)] = root(other)
    roots = np.array([root(i) for i in range(count + 1)])
    merged = np.unique(roots, return_inverse=True)[1][number] if count else number
    area = np.bincount(merged.ravel())[1:]
    return merged, np.sqrt(area / np.pi)


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
    return float(np.corrcoef(_ranks(radius), _ranks(depth))[0, 1])


def _ranks(values: Array) -> Array:
    """Rank of each value; equal values share the mean of their ranks."""
    _, number, counts = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(counts) - 0.5 * (counts - 1))[number]
