"""Change of a contact with its load: stiffness, the loads of one set of contact nodes, control by area.

While the same nodes are in contact and the same ones are plastic, pressure and gap are linear in the load.
Their change, the *tangent*, gives the stiffness, and the loads at which the first pressure vanishes or
reaches the hardness, or the first gap closes.

**Control by area** seeks the load that gives a number of contact nodes while the pressure converges. The
number of contact nodes to which a step leads is known before its gap is evaluated. If it differs from the
imposed number, the correction is extended along the tangent, on which each node enters or leaves the
contact at a known change of the approach, so that the number of contact nodes follows by sorting these
changes. Loads at which the pressure has converged bracket the load that is sought. Several nodes may touch
at the same load, as on a surface with a symmetry. If for that reason the area jumps past the imposed one,
the bracket closes on the jump, and the side with the nearer area is taken.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from asperity.contact.contact_nodes import dot, norm
from asperity.contact.inner_solve import Correction, InnerSolver, System
from asperity.contact.iterate import ContactSystem, Iterate, OverlapOfHeld
from asperity.contact.problem import Units
from asperity.contact.response import response_on
from asperity.core.errors import ConvergenceError
from asperity.core.types import Array
from asperity.elasticity.two_bodies import Solids
from asperity.fourier.grid import Boundary, Grid, with_mirror_images

# Residual, relative to the change of the pressure, at which the solution for a tangent ends. An inner solve
# leaves a few per cent of it.
TANGENT_RESIDUAL = 1e-7
MAX_TANGENT_SOLVES = 200
MAX_TANGENT_ITERATIONS = 300

# Contact nodes may differ from the number asked for by one half, or by this fraction of it.
AREA_TOLERANCE = 1e-4

# Loads that differ by less than this fraction of the pressure's tolerance, or of the load of one node, are
# equal. With 10 instead of 0.1 area control takes twice the transforms on 1024² nodes.
LOAD_RESOLUTION = 0.1

# Largest relative change of the load in one step.
MAX_LOAD_CHANGE = 0.5

# Before the pressure has converged the load changes in at most so many steps. Most solutions take three.
MAX_EARLY_CHANGES = 8

# Under layers the number of contact nodes says nothing beyond this error, which a pressure has that is
# interpolated from a coarser grid under a stiff film.
MAX_EARLY_ERROR = 3.0


@dataclass(frozen=True, eq=False)
class Tangent:
    """Change of a contact per change of its mean pressure.

    Attributes
    ----------
    pressure : (ny, nx) array
        On the nodes that move, zero elsewhere; its mean is one.
    closing : (ny, nx) array
        Change of the overlap: change of the approach less change of the displacement.
    approach : float
        Change of the approach.
    """

    pressure: Array
    closing: Array
    approach: float


def tangent(moving: Array, grid: Grid, solid: Solids, boundary: Boundary) -> Tangent | None:
    """Tangent of a contact; None if no node moves.

    By conjugate gradients in double precision, with an inner solve as their preconditioner.

    Parameters
    ----------
    moving : (ny, nx) array of bool
        True at nodes whose gap stays closed while their pressure changes.
    grid, solid, boundary
        As in `asperity.contact.Contact`.

    Raises
    ------
    ConvergenceError
        If the residual does not fall to its tolerance.
    """
    if not moving.any():
        return None
    if isinstance(grid.mirrored, tuple):
        found = tangent(with_mirror_images(moving, grid), grid.whole_cell, solid, boundary)
        return found and Tangent(found.pressure[grid.map], found.closing[grid.map], found.approach)
    units = Units.of_solid(solid, grid)
    response = response_on(boundary, units.solid(solid), units.grid(grid))
    if moving.all() and response.uniform_compliance == 0:  # not even by rounding errors
        return Tangent(np.ones(grid.shape), np.zeros(grid.shape), 0.0)
    inner, nodes = InnerSolver(response), np.flatnonzero(moving).astype(np.uint32)
    operators = inner.operators(nodes)
    pressure = np.where(moving, grid.size / nodes.size, 0.0)
    direction, own = np.zeros_like(pressure), pressure.reshape(-1)
    level = response.displacement(pressure).reshape(-1)[nodes] / response.nodal_compliance
    residual, before, previous = level.mean() - level, np.zeros(nodes.size), math.inf
    for solves in range(MAX_TANGENT_SOLVES + 1):
        error = norm(residual) / norm(own)
        if error <= TANGENT_RESIDUAL:
            break
        if solves == MAX_TANGENT_SOLVES:
            load = float(pressure.mean())
            remedy = "impose a mean pressure in place of the contact area"
            raise ConvergenceError("stiffness of the contact", error, TANGENT_RESIDUAL, solves, load, remedy)
        scale = float(np.abs(residual).max())
        scaled = (residual / scale).astype(np.float32)
        system = System(operators, scaled, operators.precondition(scaled), fixed_load=True)
        correction = inner.solve(system, max_iterations=MAX_TANGENT_ITERATIONS).pressure * scale
        correction -= correction.mean()
        ratio = max(dot(correction, residual - before) / previous, 0.0)
        direction.reshape(-1)[nodes] = correction + ratio * direction.reshape(-1)[nodes]
        along = direction.reshape(-1)[nodes]
        level = response.displacement(direction).reshape(-1)[nodes] / response.nodal_compliance
        length = dot(residual, along) / dot(along, level)
        before, previous = residual, dot(correction, residual)
        own[nodes] += length * along
        residual = residual - length * (level - level.mean())
    own *= grid.size / own.sum()
    displaced, unit = response.displacement(pressure), units.height / units.stress
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


class AreaControl:
    """Brackets the load that gives a number of contact nodes.

    Parameters
    ----------
    contact_area_fraction : float
    size : int
        Number of nodes of the grid.
    rtol : float
        Tolerance of the pressure.
    tolerance : float
        Tolerance of the area, relative to the area asked for.

    Attributes
    ----------
    target : int
        Number of contact nodes asked for.
    resolution : float
        Relative difference below which two loads are taken as equal.
    """

    def __init__(
        self, contact_area_fraction: float, size: int, rtol: float, tolerance: float = AREA_TOLERANCE
    ) -> None:
        self.target = max(1, round(contact_area_fraction * size))
        self.resolution = LOAD_RESOLUTION * min(rtol, 1 / self.target)
        self._allowed = max(tolerance * self.target, 0.5)
        self._early_changes = 0
        self._low = (0.0, 0)
        self._high = (math.inf, size + 1)
        self._width = math.inf
        self._closed = False
        self._last: tuple[float, int] | None = None

    def misses(self, count: int) -> bool:
        """True if a number of contact nodes is not near enough, and a nearer one is possible."""
        return abs(count - self.target) > self._allowed and not self._closed

    def may_change(self) -> bool:
        """True if the load may change before the pressure has converged; the number of calls is limited."""
        self._early_changes += 1
        return self._early_changes <= MAX_EARLY_CHANGES

    def log_ratio(self, count: int) -> float:
        """Logarithm of the imposed area over the area of a number of contact nodes."""
        return math.log(self.target / max(1, count))

    def power_law(self, load: float, count: int) -> float:
        """Load by a power law load ~ area^exponent through the last two loads."""
        exponent = 1.1
        if self._last is not None and count != self._last[1] and load != self._last[0]:
            slope = math.log(load / self._last[0]) / math.log(count / self._last[1])
            exponent = min(max(slope, 0.25), 4.0) if slope > 0 else exponent
        self._last = (load, max(1, count))
        limit = math.log1p(MAX_LOAD_CHANGE)
        return load * math.exp(min(max(exponent * self.log_ratio(count), -limit), limit))

    def bracketed(self, load: float, count: int, guess: float) -> float | None:
        """Next load after the pressure has converged at a load; None if the load is kept.

        It is the guess, if it lies within the bracket and the bracket shrinks fast, or the bracket's middle.
        Once the bracket has closed, it is the end with the nearer area.
        """
        if guess == load:
            return None
        if count < self.target:
            self._low = max(self._low, (load, count))
        else:
            self._high = min(self._high, (load, count))
        width = self._high[0] - self._low[0]
        if not (self._low[0] > 0 and math.isfinite(width)):
            return guess
        if width <= self.resolution * self._high[0]:
            self._closed = True
            nearest, _ = min((self._low, self._high), key=lambda end: abs(end[1] - self.target))
            return None if load == nearest else nearest
        shrinks = width <= 0.5 * self._width
        self._width = width
        return guess if self._low[0] < guess < self._high[0] and shrinks else self._low[0] + 0.5 * width


def extended_to_area(
    area: AreaControl,
    iterate: Iterate,
    system: ContactSystem,
    correction: Correction,
    held: OverlapOfHeld,
    inner: InnerSolver,
    converged: bool,
    effort: tuple[float, int] | tuple[()] = (),
) -> tuple[Correction, OverlapOfHeld, float] | None:
    """Extend a correction to the load at which the number of contact nodes is the target.

    The tangent is found with an effort, as of `InnerSolver.solve`.

    Returns
    -------
    (Correction, OverlapOfHeld, load) or None
        None if the load stays.
    """
    unit, load = iterate.problem.nodal_compliance, iterate.load
    after = iterate.pressure[system.elastic] + correction.pressure
    count = int(np.count_nonzero(after > 0) + np.count_nonzero(held.enter)) + system.plastic.size
    if not converged:
        near = abs(count - area.target) <= max(AREA_TOLERANCE * area.target, 0.5)
        layered = iterate.problem.response.solid.interface is not None
        if near or (layered and system.error > MAX_EARLY_ERROR) or not area.may_change():
            return None
    nodes = system.linear.operators.nodes
    if nodes.size == iterate.problem.grid.size and iterate.problem.response.uniform_compliance == 0:
        # Full contact of a solid without uniform displacement: the approach stays.
        zero = np.zeros(nodes.size, np.float32)
        tangent = Correction(np.ones(nodes.size, np.float32), zero, 0.0, 0)
    else:
        tangent = replace(inner.solve_uniform(system.linear.operators, *effort), approach=1.0)
    slope = float(tangent.pressure.sum(dtype=float)) / iterate.problem.grid.size
    if not slope > 0:
        return None
    up = MAX_LOAD_CHANGE * load / slope
    down = 0.999 * load / slope if converged else up
    near_nodes = system.held_after(iterate, correction, unit * up)
    rate = 1 - system.linear.operators.displacement(tangent.pressure, near_nodes.held.nodes)
    closing = near_nodes.held.side > 0
    edges = (
        np.divide(distance, rates, out=np.full(distance.size, never), where=rates > 0)
        for distance, rates, never in (
            (-near_nodes.overlap[closing], rate[closing], np.inf),
            (-after, tangent.pressure, -np.inf),
        )
    )
    # Nodes that touch at the same load do so at slightly different ones before the pressure has converged.
    shortest = area.resolution if converged else max(area.resolution, 0.02 / area.target)
    factor = _change_to(area.target - system.plastic.size, edges, -down, up, shortest * load / slope)
    factor = min(max(factor, -up), up)
    new_load = load + factor * slope
    if system.plastic.size and factor:
        # Nodes that enter bear much of the load where few nodes are elastic.
        elastic, hardness = after + np.float32(factor) * tangent.pressure, iterate.problem.hardness
        others = near_nodes.overlap + factor * rate + np.where(near_nodes.held.side < 0, hardness, 0)
        pressure = np.clip(np.concatenate((elastic, others)), 0, hardness)
        borne = float(pressure.sum(dtype=float)) / iterate.problem.grid.size
        new_load = load + min(max(borne - load, -MAX_LOAD_CHANGE * load), MAX_LOAD_CHANGE * load)
    if converged:
        if new_load == load and system.plastic.size + 1 >= iterate.nodes.size:
            # Where all nodes are plastic no tangent gives the load at which the next one touches.
            new_load = area.power_law(load, iterate.nodes.size)
        found = area.bracketed(load, iterate.nodes.size, new_load)
        if found is None:
            return None
        if system.plastic.size and new_load != load:
            factor, new_load = factor * (found - load) / (new_load - load), found
        else:
            factor = (found - load) / slope
            new_load = load + factor * slope
    moved = Correction(
        correction.pressure + np.float32(factor) * tangent.pressure,
        correction.displacement + np.float32(factor) * tangent.displacement,
        correction.approach + unit * factor * bool(tangent.approach),
        correction.iterations + tangent.iterations,
    )
    overlap = near_nodes.overlap + np.float32(factor) * rate
    return moved, replace(near_nodes, overlap=overlap), new_load


def _change_to(target: int, edges: Iterable[Array], least: float, most: float, shortest: float) -> float:
    """Change below which `target` edges lie, or the nearest stable number of them; 0 if no change is needed.

    `edges` are changes at which the number of contact nodes grows, and `least` and `most` the range of the
    change. Numbers that hold over a shorter range than `shortest` are skipped.
    """
    first, within = 0, []
    for some in edges:
        first += int(np.count_nonzero(some <= least))
        within.append(some[(some > least) & (some < most)])
    bounds = np.concatenate(([least], *within, [most]))
    bounds.sort()
    lasting = np.flatnonzero(np.diff(bounds) >= shortest)
    if not lasting.size:
        lasting = np.arange(bounds.size - 1)
    best = int(lasting[np.argmin(np.abs(lasting + (first - target)))])
    if best == bounds.size - 2 and best + first < target:
        return most
    if bounds[best] < 0 < bounds[best + 1] or (best == 0 and first > target and bounds[1] >= 0):
        return 0.0
    return float(0.5 * (bounds[best] + bounds[best + 1]))
