"""Loads under which the same nodes are in contact.

While no node enters or leaves, pressure and gap are linear in the load. Their change per mean pressure is the
pressure of mean one on the contact nodes that displaces all of them by the same amount. The first pressure
that vanishes, or gap that closes, as the load falls or rises ends the interval.
"""

from __future__ import annotations

import math

import numpy as np

from asperity.contact.active_set.inner_solve import InnerSolver, System
from asperity.contact.compliance import response_on
from asperity.contact.units import Units
from asperity.core.types import Array
from asperity.elasticity.two_bodies import Solid
from asperity.fourier.grid import Grid

# An inner solve leaves a few per cent of the residual, since its displacement is right to about one.
INNER_SOLVES = 4


def load_interval(
    pressure: Array, gap: Array, grid: Grid, solid: Solid, boundary: str
) -> tuple[float, float]:
    """Least and largest mean pressure between which the nodes under pressure are the same.

    Parameters
    ----------
    pressure, gap : (ny, nx) arrays
    grid, solid, boundary
        As in `asperity.contact.Contact`.
    """
    units = Units.of_solid(solid, grid)
    response = response_on(boundary, units.solid(solid), units.grid(grid))
    inner = InnerSolver(response)
    nodes = np.flatnonzero(pressure > 0).astype(np.uint32)
    load = float(pressure.mean(dtype=float))
    if not nodes.size:
        return 0.0, 0.0
    operators = inner.operators(nodes)
    rate = np.zeros(grid.shape)
    rate.reshape(-1)[nodes] = grid.size / nodes.size
    for _ in range(INNER_SOLVES):
        displaced = response.displacement(rate).reshape(-1)
        residual = ((displaced[nodes].mean() - displaced[nodes]) / response.nodal_compliance).astype(
            np.float32
        )
        system = System(operators, residual, operators.precondition(residual), fixed_load=True)
        rate.reshape(-1)[nodes] += inner.solve(system).pressure
    displaced = response.displacement(rate)
    closing = displaced.reshape(-1)[nodes].mean() - displaced
    with np.errstate(divide="ignore", invalid="ignore"):
        changes = np.where(pressure > 0, -pressure / rate, gap * (units.stress / units.height) / closing)
    falls, rises = changes[changes < 0], changes[changes > 0]
    return load + float(falls.max(initial=-load)), load + float(rises.min(initial=math.inf))
