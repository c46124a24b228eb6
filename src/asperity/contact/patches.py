"""Contact spots, and connected parts of the gap."""

from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import ndimage

from asperity.core.types import Array


class Patches(NamedTuple):
    """Contact spots: nodes in contact that are neighbours.

    Parameters
    ----------
    number : (ny, nx) array
        Number of the spot at each node, from 1; 0 outside contact.
    radii : (patches,) array
        Radius of the disc of the same area, in grid spacings.
    cells : (2, ny, nx) array
        Cells (y, x) by which each node has to be moved so that its spot is not cut by the edges.
    spans : (patches, 2) boolean array
        True if the spot meets its own periodic image along y and x. It is then cut somewhere.
    """

    number: Array
    radii: Array
    cells: Array
    spans: Array


def contact_patches(
    contact: Array, periodic: bool | tuple[bool, ...] = True, diagonals: bool = True
) -> Patches:
    """Contact spots: nodes in contact that are neighbours.

    Parameters
    ----------
    contact : (ny, nx) boolean array
    periodic : bool or (bool, bool)
        True if opposite edges of the cell are neighbours, or along y and along x. The edges of a mirrored
        map are not: a spot at an edge is a neighbour of its own mirror image.
    diagonals : bool
        True if nodes are neighbours along diagonals, too, not along edges only.
    """
    piece, count = ndimage.label(contact, structure=np.ones((3, 3)) if diagonals else None)
    root, cells = np.arange(count + 1), np.zeros((count + 1, 2), np.int16)
    spans = np.zeros(cells.shape, bool)
    meets = periodic if isinstance(periodic, tuple) else (periodic, periodic)
    neighbours = _across_edges(piece, (-1, 0, 1) if diagonals else (0,), meets)
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


def _across_edges(
    piece: Array, shifts: Sequence[int], meets: tuple[bool, ...]
) -> dict[int, list[tuple[int, Array]]]:
    """Piece → pieces that it meets across opposite edges, at shifted nodes, and the cells (y, x) to them."""
    edges = set()
    for axis in (axis for axis in (0, 1) if meets[axis]):
        first, last = (np.take(piece, end, axis) for end in (0, -1))
        place = np.arange(first.size)
        for shift in shifts:
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
