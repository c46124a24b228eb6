"""Maxima of two planes on different grids that face each other."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from asperity.stress.plane_maxima import Maxima, SearchedPlane
from asperity.stress.refinement import refine_in_plane, wrapped
from asperity.types import Array

REACH = 3.001
"""Largest distance of the nodes of two maxima that face each other, in spacings of the coarser grid: refined
positions are at most one spacing from their nodes, and from each other."""


def facing_pairs(
    upper: Maxima, upper_plane: SearchedPlane, lower: Maxima, lower_plane: SearchedPlane
) -> tuple[Array, Array, Array]:
    """Pairs of maxima that face each other across a change of grid, and where the upper one is the larger.

    Two maxima face each other if their refined positions are within a spacing of the coarser grid, and no
    other ones are nearer.

    Returns
    -------
    upper, lower : (pairs,) integer arrays
        Indices of the two maxima of each pair.
    wins : (pairs,) bool array
    """
    scale = np.maximum(upper_plane.grid.spacing, lower_plane.grid.spacing)
    box = np.array(upper_plane.grid.length) / scale

    def places(plane: SearchedPlane, maxima: Maxima, y: Array, x: Array) -> Array:
        """Refined places in spacings, and in a third dimension, which keeps fields apart."""
        place = np.stack([maxima.nodes[0] + y, maxima.nodes[1] + x], axis=1) * (plane.grid.spacing / scale)
        return np.column_stack([wrapped(place, box) if plane.periodic else place, 2.0 * maxima.field])

    near = np.flatnonzero(_are_near(lower, lower_plane, upper, upper_plane, box))
    if not near.size:
        return np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0, bool)
    lower = lower.select(near)
    high, *offset_up = refine_in_plane(upper.here)
    low, *offset_low = refine_in_plane(lower.here)
    place_up = places(upper_plane, upper, *offset_up)
    place_low = places(lower_plane, lower, *offset_low)
    size = np.array([*box, 0.0]) if upper_plane.periodic else None
    distance, facing = cKDTree(place_low, boxsize=size).query(place_up, p=np.inf)
    close = np.flatnonzero(np.asarray(distance) <= 1.0)
    partner = np.asarray(facing)[close]
    mutual = np.asarray(cKDTree(place_up, boxsize=size).query(place_low[partner], p=np.inf)[1]) == close
    pair, partner = close[mutual], partner[mutual]
    return pair, near[partner], high[pair] > low[partner]


def _are_near(
    maxima: Maxima, plane: SearchedPlane, others: Maxima, other_plane: SearchedPlane, box: Array
) -> Array:
    """True for all maxima within `REACH` of another one of their field, and for some of those that are not.

    The cell, `box` spacings long, is divided into squares at least as wide as the reach: maxima in the square
    of another one and in the eight around it are near.
    """
    count = np.maximum(box / REACH, 1).astype(int)

    def squares(plane: SearchedPlane, maxima: Maxima) -> tuple[Array, Array]:
        row, column = (
            (np.arange(nodes) * squares // nodes)[place]
            for nodes, squares, place in zip(plane.grid.shape, count, maxima.nodes, strict=True)
        )
        return row, column

    row, column = squares(other_plane, others)
    taken = np.zeros((max(maxima.field.max(), others.field.max()) + 1, *(count + 2)), bool)
    for step_y in (0, 1, 2):
        for step_x in (0, 1, 2):
            taken[others.field, row + step_y, column + step_x] = True
    if plane.periodic:
        taken[:, [1, -2]] |= taken[:, [-1, 0]]
        taken[:, :, [1, -2]] |= taken[:, :, [-1, 0]]
    row, column = squares(plane, maxima)
    return taken[maxima.field, row + 1, column + 1]
