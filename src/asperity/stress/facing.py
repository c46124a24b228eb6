"""Maxima of two planes on different grids that face each other."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from asperity.stress.plane_maxima import Maxima, SearchedPlane
from asperity.stress.refinement import Nodes, refine_in_plane
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

    def places(plane: SearchedPlane, nodes: Nodes, y: Array | float, x: Array | float) -> Array:
        place = np.stack([nodes[0] + y, nodes[1] + x], axis=1) * (plane.grid.spacing / scale)
        return place % box if plane.periodic else place

    at_upper = places(upper_plane, upper.nodes, 0.0, 0.0)
    at_lower = places(lower_plane, lower.nodes, 0.0, 0.0)
    of_upper, of_lower = (upper.field, at_upper), (lower.field, at_lower)
    near = np.flatnonzero(_are_near(of_lower, of_upper, box, upper_plane.periodic))
    if not near.size:
        return np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0, bool)
    lower = lower.select(near)
    high, *offset_up = refine_in_plane(upper.here)
    low, *offset_low = refine_in_plane(lower.here)
    place_up = _apart(upper.field, places(upper_plane, upper.nodes, *offset_up))
    place_low = _apart(lower.field, places(lower_plane, lower.nodes, *offset_low))
    size = np.array([*box, 0.0]) if upper_plane.periodic else None
    distance, facing = cKDTree(place_low, boxsize=size).query(place_up, p=np.inf)
    back = np.asarray(cKDTree(place_up, boxsize=size).query(place_low, p=np.inf)[1])
    pair = np.flatnonzero((np.asarray(distance) <= 1.0) & (back[facing] == np.arange(high.size)))
    partner = np.asarray(facing)[pair]
    return pair, near[partner], high[pair] > low[partner]


def _apart(field: Array, places: Array) -> Array:
    """Places in three dimensions, of which the third keeps different fields apart."""
    return np.column_stack([places, 2.0 * field])


def _are_near(places: tuple[Array, Array], others: tuple[Array, Array], box: Array, periodic: bool) -> Array:
    """True for all places within `REACH` of one of the others, and for some of those that are not.

    Places are given with their fields, and counted in squares at least as wide as the reach: those in the
    square of one of the others and in the eight around it are near.
    """
    count = np.maximum(box / REACH, 1).astype(int)
    square, other = (np.minimum((each / box * count).astype(int), count - 1) for _, each in (places, others))
    (own, _), (field, _) = places, others
    taken = np.zeros((max(own.max(), field.max()) + 1, *(count + 2)), bool)
    for step_y in (0, 1, 2):
        for step_x in (0, 1, 2):
            taken[field, other[:, 0] + step_y, other[:, 1] + step_x] = True
    if periodic:
        taken[:, [1, -2]] |= taken[:, [-1, 0]]
        taken[:, :, [1, -2]] |= taken[:, :, [-1, 0]]
    return taken[own, square[:, 0] + 1, square[:, 1] + 1]
