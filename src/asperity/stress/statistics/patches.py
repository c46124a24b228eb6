"""Patches of contact, and how the depth of the peaks follows the size of the patch above them."""

from __future__ import annotations

from collections import defaultdict
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy import ndimage

from asperity.core.types import Array


class Patches(NamedTuple):
    """Connected patches of contact; nodes are neighbours along edges and diagonals.

    Parameters
    ----------
    number : (ny, nx) array
        Number of the patch at each node, from 1; 0 outside contact.
    radii : (patches,) array
        Radius of the disc of the same area, in grid spacings.
    cells : (2, ny, nx) array
        Cells (y, x) by which each node has to be moved so that its patch is not cut by the edges.
    spans : (patches, 2) boolean array
        True if the patch meets its own periodic image along y and x. It is then cut somewhere.
    """

    number: Array
    radii: Array
    cells: Array
    spans: Array


def contact_patches(contact: Array, periodic: bool = True) -> Patches:
    """Connected patches of contact.

    Parameters
    ----------
    contact : (ny, nx) boolean array
    periodic : bool
        True if opposite edges of the cell are neighbours.
    """
    piece, count = ndimage.label(contact, structure=np.ones((3, 3)))
    root, cells = np.arange(count + 1), np.zeros((count + 1, 2), np.int16)
    spans = np.zeros(cells.shape, bool)
    neighbours = _across_edges(piece) if periodic else {}
    for first in sorted(neighbours):
        if root[first] != first:
            continue
        reached, left = {first}, [first]
        while left:
            one = left.pop()
            for other, step in neighbours[one]:
                if other not in reached:
                    reached.add(other)
                    left.append(other)
                    root[other], cells[other] = first, cells[one] + step
                spans[first] |= cells[other] != cells[one] + step
    lowest, patch = np.unique(root, return_inverse=True)
    number = patch[piece]
    area = np.bincount(number.ravel())[1:]
    return Patches(number, np.sqrt(area / np.pi), np.moveaxis(cells[piece], -1, 0), spans[lowest[1:]])


def _across_edges(piece: Array) -> dict[int, list[tuple[int, Array]]]:
    """Piece → pieces that it meets across opposite edges or corners, and the cells (y, x) to them."""
    edges = set()
    for axis in (0, 1):
        first, last = (np.take(piece, end, axis) for end in (0, -1))
        place = np.arange(first.size)
        for shift in (-1, 0, 1):
            beside, beyond = (place - shift) % first.size, (place - shift) // first.size
            for one, other, turn in zip(first, last[beside], beyond, strict=True):
                if one and other:
                    along_y, along_x = (-1, int(turn))[:: 1 - 2 * axis]
                    edges.add((int(one), int(other), along_y, along_x))
    found = defaultdict(list)
    for one, other, along_y, along_x in sorted(edges):
        step = np.array([along_y, along_x])
        found[one].append((other, step))
        found[other].append((one, -step))
    return found


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
