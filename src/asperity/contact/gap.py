"""The gap between two pressed bodies: its percolation, and its narrowest constriction.

Nodes of the contact are neighbours along edges and diagonals, nodes of the gap along edges only: a fluid does
not pass between two contacts that meet at a corner. Then either the contact spans a map along y, or the gap
along x. In a periodic cell a path that meets its own image percolates.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy import ndimage

from asperity.contact.patches import contact_patches
from asperity.contact.solution import Contact
from asperity.core.types import Array


@dataclass(frozen=True)
class Percolation:
    """Percolation of contact and gap along y and x, and the constriction of the best path of each.

    Attributes
    ----------
    contact, gap : (bool, bool)
        True if a path spans the map along y and along x.
    constriction : (float, float)
        Smallest gap on the path along y, and along x, whose smallest gap is largest; 0 without a path.
    place : (2, 2) tuple
        Position (y, x) of the node with this gap on the path along y, and along x; NaN without a path.
    """

    contact: tuple[bool, bool]
    gap: tuple[bool, bool]
    constriction: tuple[float, float]
    place: tuple[tuple[float, float], tuple[float, float]]


def percolation(contact: Contact) -> Percolation:
    """Percolation of contact and gap along both axes, and the narrowest constriction of the gap.

    The constriction is found by bisection over the sorted gaps: it is the largest gap g for which the
    nodes with gaps ≥ g percolate.

    The constriction is the critical one of B. N. J. Persson and C. Yang, J. Phys.: Condens. Matter 20 (2008)
    315011.

    Parameters
    ----------
    contact : Contact

    Returns
    -------
    Percolation

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> found = asp.contact.percolation(contact)
    >>> found.contact, found.gap
    ((False, False), (True, True))
    >>> bool(0 < found.constriction[1] < contact.gap.max())
    True
    """
    gap, periodic = open_gap(contact), contact.edges_meet
    levels = np.sort(gap[gap > 0])

    @cache
    def spans(level: int) -> tuple[bool, bool]:
        return spanned(gap >= levels[level], periodic, diagonals=False)

    opened = spans(0) if levels.size else (False, False)
    constriction, place = [0.0, 0.0], [(np.nan, np.nan)] * 2
    for axis in np.flatnonzero(opened):
        closes = bisect_left(range(levels.size), True, key=lambda level: not spans(level)[axis])
        constriction[axis] = float(levels[closes - 1])
        nodes = np.argwhere(gap == levels[closes - 1])[0]
        place[axis] = tuple((nodes * contact.grid.spacing).tolist())
    touching = spanned(contact.touching, periodic, diagonals=True)
    return Percolation(touching, opened, tuple(constriction), tuple(place))  # type: ignore


def spanned(phase: Array, periodic: bool, diagonals: bool) -> tuple[bool, bool]:
    """True for y, and for x, if connected nodes span a map, or meet their image in a periodic cell."""
    if periodic:
        spans = contact_patches(phase, True, diagonals).spans
        return bool(spans[:, 0].any()), bool(spans[:, 1].any())
    piece, _ = ndimage.label(phase, structure=np.ones((3, 3)) if diagonals else None)
    ends = ((piece[0], piece[-1]), (piece[:, 0], piece[:, -1]))
    along_y, along_x = (bool(np.intersect1d(*sides).any()) for sides in ends)
    return along_y, along_x


def open_gap(contact: Contact) -> Array:
    """The gap of a contact [y, x], 0 where it touches."""
    return np.where(contact.touching, 0.0, np.maximum(contact.gap, 0.0))
