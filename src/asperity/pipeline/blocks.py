"""Blocks of seeds of one surface on one grid: how many nodes the grid has, and how many seeds share one job.

It imports no library of data: the workflow reads it whenever it starts.
"""

from __future__ import annotations

import math

from asperity.spectral import good_size

SURFACE_ALONE = 0
"""Number of nodes on the shortest wavelength that stands for samples without a contact."""

BLOCK_NODES = 2048**2
"""Nodes of all seeds of a block, which take ten seconds or so; larger grids have blocks of one seed."""

MOST_SEEDS = 32
"""Most seeds of a block of contacts."""

SURFACE_SEEDS = 256
"""Seeds of a block of surfaces alone."""


def grid_points(wavelength_short: float, nodes: float) -> int:
    """Nodes on an edge of the cell for a number of nodes on the shortest wavelength.

    The surface alone has the smallest grid that holds all of its waves.
    """
    if nodes == SURFACE_ALONE:
        return good_size(2 * math.floor(1 / wavelength_short + 1e-6) + 2)
    return round(nodes / wavelength_short)


def block_size(wavelength_short: float, nodes: float) -> int:
    """Seeds of a block: as many as share one job."""
    if nodes == SURFACE_ALONE:
        return SURFACE_SEEDS
    return max(1, min(MOST_SEEDS, BLOCK_NODES // grid_points(wavelength_short, nodes) ** 2))
