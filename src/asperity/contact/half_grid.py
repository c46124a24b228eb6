"""The same contact on half of the nodes along both edges, which estimates the discretisation error."""

from dataclasses import replace
from typing import Any

from asperity.contact.solution import Contact
from asperity.contact.solve import solve_contact
from asperity.core.types import Array
from asperity.elasticity.two_bodies import Solids
from asperity.fourier.grid import Fourier, Grid, mean_square, resample

HALF_TOLERANCE = 1e-4
"""Tolerance of the second solution and of the planes of its stress, far below the discretisation error."""


def solve_on_half(
    height: Array, solid: Solids, grid: Grid, boundary: str = "periodic", **settings: Any
) -> tuple[Contact, float]:
    """The contact on half of the nodes, and the fraction of the squared gradient that they do not hold.

    `settings` of `asperity.solve_contact` hold the load. A range of adhesion that half of the nodes do not
    resolve is longer. Where the map ends every second node is kept,
    and the fraction is not computed: it is 0.
    """
    lost = 0.0
    if boundary != "periodic":
        height = height[::2, ::2]
        edges = [2 * step * nodes for step, nodes in zip(grid.spacing, height.shape, strict=True)]
        grid = Grid((height.shape[0], height.shape[1]), (edges[0], edges[1]), grid.mirrored)
    else:
        height, grid, lost = on_half_the_nodes(height, grid)
    if (adhesion := settings.get("adhesion")) is not None:
        settings["adhesion"] = adhesion.resolved_on(solid, grid)
    contact = solve_contact(height, solid, grid, boundary=boundary, rtol=HALF_TOLERANCE, **settings)
    return contact, lost


def on_half_the_nodes(height: Array, grid: Grid) -> tuple[Array, Grid, float]:
    """Long waves of periodic heights on half as many nodes, their grid, and the gradient lost.

    It is lost in waves that half of the nodes along both edges do not hold, as a part of its square.
    """
    half = replace(grid, shape=(max(grid.shape[0] // 2, 4), max(grid.shape[1] // 2, 4)))
    modes = Fourier(grid).forward(height)
    whole = mean_square(modes, grid, grid.wavenumber() ** 2)
    modes = resample(modes, grid, half)
    kept = mean_square(modes, half, half.wavenumber() ** 2)
    return Fourier(half).inverse(modes), half, 1 - kept / whole if whole else 0.0
