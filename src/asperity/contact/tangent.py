"""Change of a contact with its load, while the same nodes are in contact and the same ones are plastic.

Pressure and gap are then linear in the load. Their change per mean pressure is the pressure of mean one on
the nodes that move that displaces all of them by the same amount. From it follow the stiffness, and the loads
at which the first pressure vanishes or reaches the hardness, or the first gap closes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asperity.contact.active_set.inner_solve import InnerSolver, System
from asperity.contact.compliance import response_on
from asperity.contact.units import Units
from asperity.core.types import Array
from asperity.elasticity.two_bodies import Solid
from asperity.fourier.grid import Grid

# Residual, relative to the change of the pressure, at which the inner solves end; each leaves a few per cent.
RESIDUAL = 1e-7
MAX_SOLVES = 60


@dataclass(frozen=True, eq=False)
class Tangent:
    """Change of a contact per change of its mean pressure.

    Attributes
    ----------
    pressure : (ny, nx) array
        On the nodes that move, zero elsewhere; its mean is one.
    closing : (ny, nx) array
        Change of the overlap: of the approach less that of the displacement.
    approach : float
        Change of the approach.
    """

    pressure: Array
    closing: Array
    approach: float


def tangent(moving: Array, grid: Grid, solid: Solid, boundary: str) -> Tangent | None:
    """Tangent of a contact; None if no node moves.

    Parameters
    ----------
    moving : (ny, nx) array of bool
        True at nodes whose gap stays closed while their pressure changes.
    grid, solid, boundary
        As in `asperity.contact.Contact`.
    """
    if not moving.any():
        return None
    units = Units.of_solid(solid, grid)
    response = response_on(boundary, units.solid(solid), units.grid(grid))
    inner, nodes = InnerSolver(response), np.flatnonzero(moving).astype(np.uint32)
    operators = inner.operators(nodes)
    pressure = np.where(moving, grid.size / nodes.size, 0.0)
    own = pressure.reshape(-1)
    displaced = response.displacement(pressure)
    for _ in range(MAX_SOLVES):
        level = displaced.reshape(-1)[nodes]
        residual = (level.mean() - level) / response.nodal_compliance
        if np.linalg.norm(residual) <= RESIDUAL * np.linalg.norm(own):
            break
        scale = float(np.abs(residual).max())
        scaled = (residual / scale).astype(np.float32)
        system = System(operators, scaled, operators.precondition(scaled), fixed_load=True)
        own[nodes] += scale * inner.solve(system).pressure
        own[nodes] *= grid.size / own.sum()
        displaced = response.displacement(pressure)
    unit = units.height / units.stress
    approach = float(displaced.reshape(-1)[nodes].mean())
    return Tangent(pressure, unit * (approach - displaced), unit * approach)


def load_interval(pressure: Array, gap: Array, hardness: float, found: Tangent | None) -> tuple[float, float]:
    """Least and largest mean pressure between which the same nodes touch, and the same ones are plastic.

    Parameters
    ----------
    pressure, gap : (ny, nx) arrays
        The gap of plastic nodes is the negative plastic depth.
    hardness : float
    found : Tangent or None
        None if no node moves.
    """
    load = float(pressure.mean(dtype=float))
    if found is None:
        return load, load
    moving, rate = found.pressure != 0, found.pressure
    with np.errstate(divide="ignore", invalid="ignore"):
        released = np.where(moving, -pressure / rate, np.nan)
        yields = np.where(moving, (hardness - pressure) / rate, np.nan)
        meets = np.where(moving, np.nan, gap / found.closing)
    changes = np.concatenate([change.ravel() for change in (released, yields, meets)])
    falls, rises = changes[changes < 0], changes[changes > 0]
    return load + float(falls.max(initial=-load)), load + float(rises.min(initial=math.inf))
