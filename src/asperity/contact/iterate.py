"""The iterate of the active-set solver, its linear system and error, and the steps between iterates.

An iterate is a pressure 0 ≤ p ≤ p_H with the gap it causes. Its *contact nodes* have p > 0; nodes below the
hardness p_H are *elastic*, nodes at it *plastic*. Nodes at a bound are *held* there.
"""

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from asperity.contact.contact_nodes import added, dot, field_of, inserted, norm
from asperity.contact.inner_solve import Correction, InnerSolver, System
from asperity.contact.operators import Operators
from asperity.contact.problem import Control, Problem
from asperity.core.compiled import compiled, vectorised_sums
from asperity.core.parallel import STRIP, apply, run_tasks, sum_parts
from asperity.core.types import Array

# The common change of the pressures is found by Newton's method, which is exact once the set of nodes
# between the bounds no longer changes; this fraction of the load may then be missing by rounding.
MAX_SHIFTS = 100
LOAD_ROUNDING = 1e-10

# Rounding error of a level h + u, as a fraction of the spacing of floating-point numbers of its size.
ROUNDING_FRACTION = 0.1

# Nodes whose levels are compared with a bound at a time.
_BLOCK = 64


@dataclass(frozen=True)
class Pressure:
    """Pressures on a few nodes, zero on all others.

    Attributes
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened grid.
    values : (count,) array
        Non-negative. Pressures of plastic nodes may exceed the hardness, by the pressure that corresponds to
        their overlap.
    load : float
        Mean pressure to which they are brought at a given load.
    is_projected : bool
        True if this is done by the projection onto the admissible pressures, not by scaling.
    includes_candidates : bool
        True if the nodes without pressure are nodes that may touch.
    """

    nodes: Array
    values: Array
    load: float
    is_projected: bool = False
    includes_candidates: bool = False

    @classmethod
    def of_field(cls, field: Array, load: float, margin: float = 0.0) -> "Pressure":
        """The positive values of a field [y, x]; zero where it is above −margin."""
        nodes = np.flatnonzero(field > -margin).astype(np.uint32)
        values = np.maximum(field.reshape(-1)[nodes], 0)
        return cls(nodes, values, load, includes_candidates=margin > 0)


@dataclass(frozen=True)
class HeldNodes:
    """Nodes whose pressure is at its lower bound, zero, or at its upper bound, the hardness.

    Attributes
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened grid.
    level : (count,) array
        As in `Iterate`.
    side : (count,) array
        1 at zero pressure, −1 at the hardness. Overlap × side > 0 is against the conditions of contact.
    """

    nodes: Array
    level: Array
    side: Array


@dataclass(frozen=True)
class Iterate:
    """Pressures on the contact nodes, and the gap that they cause on a grid.

    Attributes
    ----------
    problem : Problem
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened grid.
    pressure : (count,) array
    load : float
        As in `Pressure`.
    level : (count,) array
        h + u of the nodes: the approach at which a node just touches.
    displacement : (ny, nx) array
    largest : float
        Largest |h| + |u| of the nodes.
    """

    problem: Problem
    nodes: Array
    pressure: Array
    load: float
    level: Array
    displacement: Array
    largest: float

    @classmethod
    def of(cls, problem: Problem, control: Control, start: Pressure, out: Array | None = None) -> "Iterate":
        """Evaluate a pressure, after scaling it to its load, or to the least energy at a given approach.

        If the pressure has vanished everywhere, the node that touches first bears a given load. No pressure
        exceeds the hardness. `out` is an array for the displacement.
        """
        nodes, values = start.nodes, start.values.astype(problem.fourier.real, copy=False)
        load = min(start.load, problem.hardness)  # control by area may ask for a larger load
        if control.fixes_load:
            nodes, values = with_load(problem, nodes, values, load, start.is_projected)
        elif problem.hardness < math.inf:
            if values.max(initial=0) >= problem.hardness:
                problem.plastic.set()
            values = np.minimum(values, values.dtype.type(problem.hardness))
        displacement = problem.displacement(nodes, values, out)
        if not control.fixes_load:
            pressure = values.astype(float, copy=False)
            work = dot(pressure, control.value - problem.height.reshape(-1)[nodes])
            energy = dot(pressure, displacement.reshape(-1)[nodes])
            largest = float(values.max(initial=0))
            if work > 0 and energy > 0 and largest < problem.hardness:
                factor = work / energy
                if factor * largest >= problem.hardness:
                    factor = problem.hardness / largest
                    problem.plastic.set()
                values = values * factor
                displacement *= factor
        level = np.empty_like(values)
        largest = _write_levels(problem.height.reshape(-1), displacement.reshape(-1), nodes, level)
        return cls(problem, nodes, values, load, level, displacement, largest)

    def without_free_nodes(self) -> "Iterate":
        """The iterate without the nodes that bear no pressure."""
        left = self.pressure > 0
        if left.all():
            return self
        return replace(self, nodes=self.nodes[left], pressure=self.pressure[left], level=self.level[left])

    def elastic_and_plastic(self, fixed_load: bool) -> tuple[Array | slice, Array]:
        """Indices in `nodes` of pressures below the hardness, and of pressures at it.

        At a given load one node has to fix the approach: the plastic one with the least overlap, if all are
        plastic.
        """
        plastic = self.pressure >= self.problem.hardness
        if not plastic.any():
            return slice(None), np.empty(0, np.int64)
        if fixed_load and plastic.all():
            plastic[np.argmax(self.level)] = False
        return np.flatnonzero(~plastic), np.flatnonzero(plastic)

    def held_nodes(self, bound: float, plastic: Array) -> HeldNodes:
        """Nodes out of contact with a level below a bound, and the plastic ones."""
        height, displacement = self.problem.height.reshape(-1), self.displacement.reshape(-1)
        real_bound = height.dtype.type(bound)

        def free_nodes_from(start: int) -> tuple[Array, Array]:
            strip = slice(start, start + STRIP)
            edges = np.array((start, min(start + STRIP, height.size)), np.uint32)
            contact_nodes = self.nodes[slice(*np.searchsorted(self.nodes, edges))]
            found, level = np.empty(STRIP, np.uint32), np.empty(STRIP, height.dtype)
            fields = height[strip], displacement[strip]
            count = _write_free_nodes_below(*fields, real_bound, contact_nodes, start, found, level)
            return found[:count].copy(), level[:count].copy()

        tasks = [partial(free_nodes_from, start) for start in range(0, height.size, STRIP)]
        parts = zip(*run_tasks(tasks, self.problem.fourier.threads), strict=True)
        nodes, level = (np.concatenate(part) for part in parts)
        own, sides = self.nodes[plastic], np.ones(nodes.size + plastic.size, np.float32)
        at = np.searchsorted(nodes, own)
        sides[at + np.arange(plastic.size)] = -1
        return HeldNodes(inserted(nodes, at, own), inserted(level, at, self.level[plastic]), sides)

    def with_overlap(self, approach: float) -> Pressure:
        """The pressure; at plastic nodes the pressure that corresponds to their overlap is added."""
        values, plastic = self.pressure, self.pressure >= self.problem.hardness
        if plastic.any():
            overlap = np.where(plastic, approach - self.level, 0) / self.problem.own_compliance
            values = values + np.maximum(overlap, 0).astype(values.dtype)
        return Pressure(self.nodes, values, self.load)

    def pressure_field(self) -> Array:
        """Pressure [y, x] of all nodes."""
        return field_of(self.problem.grid.shape, self.nodes, self.pressure)

    def refined(self, approach: float, finer: Problem, margin: float = 0.0) -> Pressure:
        """Start for a finer grid: the interpolated pressure less the interpolated gap / nodal compliance.

        Outside the contact, where an interpolated pressure may not vanish, the gap is positive: subtracting
        it before negative values are set to zero keeps those nodes free. The gap that is left at elastic
        nodes is not subtracted: where it varies over long distances, it corresponds to a far smaller
        pressure. The overlap of plastic nodes is added, which keeps them at the hardness.
        """
        real = finer.height.dtype.type
        stiffness, level = real(1 / finer.nodal_compliance), real(approach)
        field = self.displacement * -stiffness
        displaced = level - self.problem.height.reshape(-1)[self.nodes]
        plastic = self.pressure >= self.problem.hardness
        displaced[plastic] = self.displacement.reshape(-1)[self.nodes[plastic]]
        field.reshape(-1)[self.nodes] = self.pressure - stiffness * displaced
        out = self.problem.response.resampled(field, finer.grid)
        heights = finer.height.reshape(-1)
        apply(_subtract_gap, finer.fourier.threads, out.reshape(-1), heights, stiffness, level)
        return Pressure.of_field(out, self.load, margin)


@dataclass(frozen=True)
class ContactSystem:
    """The system of an iterate, and the error of its pressure.

    Attributes
    ----------
    linear : System
        For the correction of the pressure of the elastic nodes.
    elastic : slice or (count,) array
        Indices of these nodes among the nodes of the iterate.
    plastic : (count,) array
        Indices of the plastic nodes.
    approach : float
        Imposed, or chosen so that the first correction does not change the load.
    error, rounding : float
        Estimated error of the pressure, and the part of it that is rounding, relative to its norm.
    bound : float
        Level h + u below which the nodes out of contact are known.
    held : HeldNodes
        These nodes, and the plastic ones.
    """

    linear: System
    elastic: Array | slice
    plastic: Array
    approach: float
    error: float
    rounding: float
    bound: float
    held: HeldNodes

    @classmethod
    def of(
        cls, iterate: Iterate, control: Control, inner: InnerSolver, before: Operators | None = None
    ) -> "ContactSystem":
        """Linear system of the elastic nodes of an iterate, and the estimated error of its pressure.

        Parameters
        ----------
        iterate : Iterate
        control : Control
        inner : InnerSolver
            Of the same grid.
        before : Operators, optional
            Operators of the system before, which are kept if its elastic nodes are the same.
        """
        problem = iterate.problem
        elastic, plastic = iterate.elastic_and_plastic(control.fixes_load)
        level = iterate.level[elastic]
        operators = inner.operators(iterate.nodes[elastic], before)
        approach = control.value
        if control.fixes_load:
            approach = float(level[0]) if level.size else math.nan  # a pressure that has overflowed
            if operators.uniform_sum:
                weighted = sum_parts(
                    _weighted_sum, problem.fourier.threads, operators.uniform, level, approach
                )
                approach += weighted / operators.uniform_sum
        residual = overlap_of(level, approach, problem.nodal_compliance)
        system = System(operators, residual, operators.precondition(residual), control.fixes_load)
        # A correction moves no node upward by much more than the contact nodes are to move.
        bound = approach + 1.25 * problem.nodal_compliance * max(0.0, -float(residual.min(initial=0)))
        held = iterate.held_nodes(bound, plastic)
        error, rounding = _error(iterate, system, held, approach, inner)
        return cls(system, elastic, plastic, approach, error, rounding, bound, held)

    def held_after(self, iterate: Iterate, correction: Correction, further: float = 0.0) -> "OverlapOfHeld":
        """Overlap of the held nodes after a correction, or if the approach then grows further."""
        unit, approach = iterate.problem.nodal_compliance, self.approach + correction.approach
        # No node moves upward by more than the contact nodes do, which the pressure displaces.
        bound = approach + unit * max(0.0, -float(correction.displacement.min(initial=0))) + further
        held = self.held if bound <= self.bound else iterate.held_nodes(bound, self.plastic)
        overlap = overlap_of(held.level, approach, unit)
        overlap -= self.linear.operators.displacement(correction.pressure, held.nodes)
        return OverlapOfHeld(held, overlap)


@dataclass(frozen=True)
class OverlapOfHeld:
    """Overlap δ − (h + u) of held nodes after a correction, in units of `Problem.nodal_compliance`.

    New contact nodes are chosen from it before tensile nodes are released: afterwards the pressure is out of
    equilibrium, and nodes around every patch that lost tension seem to penetrate.
    """

    held: HeldNodes
    overlap: Array

    @property
    def enter(self) -> Array:
        """True where a node enters the contact."""
        return (self.overlap > 0) & (self.held.side > 0)


@dataclass(frozen=True)
class Step:
    """A step from a pressure, on the nodes in contact before it and the nodes that enter.

    Attributes
    ----------
    nodes, pressure, level : (count,) arrays
        Before the step.
    change : (count,) array
        Change of the pressure; at a held node its overlap over the displacement of a node per unit of its own
        pressure.
    enters : (count,) array of bool
        True at nodes that enter the contact.
    approach : float
    is_projected : bool
        As in `Pressure`.
    """

    nodes: Array
    pressure: Array
    level: Array
    change: Array
    enters: Array
    approach: float
    is_projected: bool = False

    @classmethod
    def of(
        cls, iterate: Iterate, system: ContactSystem, correction: Correction, after: OverlapOfHeld
    ) -> "Step":
        """The step that a correction leads to."""
        enter, real, held = after.enter, iterate.pressure.dtype, after.held
        overlap = after.overlap * np.float32(
            iterate.problem.nodal_compliance / iterate.problem.own_compliance
        )
        new = held.nodes[enter]
        at = np.searchsorted(iterate.nodes, new)
        change = np.zeros_like(iterate.pressure)
        change[system.elastic] = correction.pressure
        if system.plastic.size:
            change[system.plastic] = overlap[held.side < 0]
        enters = np.zeros(iterate.nodes.size + new.size, np.bool_)
        enters[at + np.arange(new.size)] = True
        return cls(
            inserted(iterate.nodes, at, new),
            inserted(iterate.pressure, at, np.zeros(new.size, real)),
            inserted(iterate.level, at, held.level[enter]),
            inserted(change, at, overlap[enter]),
            enters,
            system.approach,
        )

    @classmethod
    def gradient(cls, iterate: Iterate, system: ContactSystem) -> "Step":
        """The step along the projected gradient: each pressure changes by its overlap / nodal compliance.

        At a given load the overlap is taken at the mean level of the elastic nodes: the projection onto the
        load, which changes all by a common amount, then lowers the approach, so that no other node enters.
        """
        rise = float(system.linear.residual.mean(dtype=float)) if system.linear.fixed_load else 0.0
        still = Correction(system.linear.residual - np.float32(rise), np.zeros(1, np.float32), 0.0, 0)
        overlap = overlap_of(
            system.held.level, system.approach, iterate.problem.nodal_compliance
        ) - np.float32(rise)
        return replace(cls.of(iterate, system, still, OverlapOfHeld(system.held, overlap)), is_projected=True)

    def exchanged(self, after: Iterate) -> int:
        """Number of nodes that come to a bound, or leave one, on the way to an iterate."""
        if after.nodes.size != self.nodes.size:
            return after.nodes.size  # no pressure was left
        hardness = after.problem.hardness
        bounds = ((pressure > 0) + 1 * (pressure >= hardness) for pressure in (self.pressure, after.pressure))
        return int(np.count_nonzero(np.not_equal(*bounds)))

    def without_entering(self) -> "Step":
        """The same step without the nodes that enter, whose pressure stays zero."""
        return replace(self, change=np.where(self.enters, 0, self.change))

    def pressure_after(self, length: float, load: float) -> Pressure:
        """Pressure after a part of the step; nodes in tension are released."""
        pressure = self.pressure.dtype.type(length) * self.change
        pressure += self.pressure
        np.maximum(pressure, 0, out=pressure)
        return Pressure(self.nodes, pressure, load, self.is_projected)

    def least_energy(self, after: Iterate) -> tuple[float, float]:
        """Fraction of the way to an iterate at which the energy is least, and its fall until there.

        The pressures before and after are both admissible, and so are all between them: adding nodes to the
        contact and releasing nodes in tension can raise the energy, which a correction on a fixed set of
        contact nodes cannot (compare the projected searches of Moré & Toraldo 1991, 10.1137/0801008).
        """
        if after.nodes.size != self.nodes.size:
            return 0.0, 0.0  # no pressure was left
        arrays = after.pressure, self.pressure, after.level, self.level
        slope, curvature = sum_parts(_energy_along, after.problem.fourier.threads, *arrays, self.approach)
        fraction = min(max(slope / curvature, 0.0), 1.0) if curvature > 0 else 1.0
        return fraction, fraction * (slope - 0.5 * fraction * curvature)

    def between(self, after: Iterate, fraction: float) -> Pressure:
        """Pressure at a fraction of the way to an iterate."""
        pressure = self.pressure + self.pressure.dtype.type(fraction) * (after.pressure - self.pressure)
        return Pressure(self.nodes, pressure, after.load)


def overlap_of(level: Array, approach: float, unit: float) -> Array:
    """Overlap δ − (h + u) of nodes, divided by `unit`, in single precision."""
    return (np.subtract(approach, level, dtype=float) / unit).astype(np.float32)


def with_load(
    problem: Problem, nodes: Array, values: Array, load: float, is_projected: bool = False
) -> tuple[Array, Array]:
    """Nodes and pressures of a given mean, between zero and the hardness.

    Pressures below the hardness are scaled. If some reach it, or on demand, all change by a common amount
    instead, and pressures beyond a bound are set to it: this is the projection onto the admissible pressures.
    If these nodes cannot bear the load at the hardness, released nodes, and then the lowest nodes of the
    surface, bear the rest. If no node bears pressure, the lowest node bears the load.
    """
    hardness, wanted, threads = problem.hardness, float(load) * problem.grid.size, problem.fourier.threads
    rounding = 4 * float(np.finfo(values.dtype).eps)
    needed = math.ceil(wanted / hardness * (1 - rounding)) or 1
    bearing = int(np.count_nonzero(values))
    if not bearing:
        nodes, values = nodes[:0], values[:0]
    if min(needed, problem.height.size) > nodes.size:
        heights = problem.height.reshape(-1).copy()
        heights[nodes] = np.inf
        missing = min(needed, heights.size) - nodes.size
        lowest = np.sort(np.argpartition(heights, missing - 1)[:missing]).astype(np.uint32)
        at = np.searchsorted(nodes, lowest)
        nodes, values = np.insert(nodes, at, lowest), np.insert(values, at, wanted / missing)
    factor, largest = wanted / sum_parts(added, threads, values), float(values.max())
    if not is_projected and largest < hardness and largest * factor < hardness:
        return nodes, values * values.dtype.type(factor)
    if not is_projected or largest * max(factor, 1.0) >= hardness:
        problem.plastic.set()
    least = -1.0 if needed > bearing else 0.0  # nodes up to this pressure stay released
    shift, low, high, before = 0.0, -hardness, largest, -1
    for _ in range(MAX_SHIFTS):
        borne, elastic = sum_parts(_shifted_sums, threads, values, shift, least, hardness)
        if abs(borne - wanted) <= LOAD_ROUNDING * wanted and elastic == before:
            break
        before = elastic
        low, high = (shift, high) if borne > wanted else (low, shift)
        shift += (borne - wanted) / elastic if elastic else math.copysign(math.inf, borne - wanted)
        if not low < shift < high:
            shift = 0.5 * (low + high)
    out = np.empty_like(values)
    apply(_write_shifted, threads, values, shift, least, hardness * (1 - rounding), out)
    out[out >= hardness * (1 - rounding)] = hardness
    return nodes, out


def _error(
    iterate: Iterate, system: System, held: HeldNodes, approach: float, inner: InnerSolver
) -> tuple[float, float]:
    """Estimated error of the pressure, and the part of it that is rounding, relative to its norm.

    The solution p* of the contact problem and a pressure p differ by the pressure that removes the violations
    of p: the residual on the contact nodes, the penetration of nodes without pressure, and the gap of plastic
    nodes. The error estimate is the norm of that pressure, as the preconditioner M gives it; a node that
    penetrates, or a plastic one with a gap, contributes that length over the displacement of a node per unit
    of its own pressure. The estimate is at least as large as two lower bounds:

    - In a layer that is much stiffer than the half-space a residual corresponds to a much larger pressure
      than M gives, because M is made for the half-space. The norm of the pressure with which the whole
      layer, all nodes in contact, would remove the residual is used instead.
    - The gap is known only to its rounding error, which corresponds to a pressure.
    """
    problem, operators, threads = iterate.problem, system.operators, iterate.problem.fourier.threads
    of_pressure = math.sqrt(sum_parts(dot, threads, iterate.pressure, iterate.pressure))
    shift = 0.0
    if system.has_free_approach:
        shift = sum_parts(added, threads, system.preconditioned) / operators.uniform_sum
    corrected = sum_parts(_projected_square, threads, system.preconditioned, operators.uniform, shift)
    penetration = np.maximum(held.side * (approach - held.level.astype(float)), 0)
    penetration /= problem.own_compliance
    error = math.hypot(math.sqrt(corrected), norm(penetration))
    if inner.layer_stiffness is not None:
        fourier = problem.fourier
        overlap = field_of(problem.grid.shape, operators.nodes, system.residual.astype(fourier.real))
        coefficients = (fourier.forward(overlap) * inner.layer_stiffness).astype(fourier.coefficient_type)
        pressure = fourier.inverse(coefficients, overwrite=True).take(operators.nodes)
        pressure -= pressure.mean() if system.fixed_load else 0
        error = max(error, norm(pressure))
    # Fewer gaps than contact nodes are uncertain if one of them is fixed by the approach.
    uncertain = max(operators.nodes.size - system.fixed_load, 0)
    of_level = ROUNDING_FRACTION * float(np.spacing(problem.height.dtype.type(iterate.largest)))
    rounding = of_level / problem.nodal_compliance * inner.nodal_stiffness * math.sqrt(uncertain)
    error = max(error, rounding)
    if not of_pressure > 0:
        return (0.0 if error == 0 else math.inf), 0.0
    return error / of_pressure, rounding / of_pressure


@compiled
def _write_free_nodes_below(
    height: Any, displacement: Any, bound: Any, contact: Any, first: int, nodes: Any, levels: Any
) -> int:
    """Write nodes with a level h + u below a bound, except contact nodes, and their levels; their number.

    The first node has the index `first`. Nodes are taken in blocks, by loops without a branch on each node.
    """
    count, place = 0, 0
    for start in range(0, height.size, _BLOCK):
        h, u = height[start : start + _BLOCK], displacement[start : start + _BLOCK]
        block = levels[count : count + h.size]
        for i in range(h.size):
            block[i] = h[i] + u[i]
        while place < contact.size and np.int64(contact[place]) < first + start + h.size:
            block[np.int64(contact[place]) - first - start] = np.inf
            place += 1
        below = False
        for i in range(h.size):
            below |= block[i] < bound
        if below:
            for i in range(h.size):
                level = block[i]
                nodes[count], levels[count] = first + start + i, level
                count += level < bound
    return count


@compiled
def _subtract_gap(field: Any, height: Any, stiffness: Any, level: Any) -> None:
    """Subtract stiffness × (height − level) from a field."""
    for i in range(field.size):
        field[i] -= stiffness * (height[i] - level)


@compiled
def _write_levels(height: Any, displacement: Any, nodes: Any, out: Any) -> float:
    """Write the level h + u of nodes, and return the largest |h| + |u|."""
    largest = 0.0
    for k in range(nodes.size):
        h, u = height[nodes[k]], displacement[nodes[k]]
        out[k] = h + u
        largest = max(largest, np.float64(abs(h) + abs(u)))
    return largest


@compiled
def _shifted_sums(values: Any, shift: float, least: float, hardness: float) -> tuple[float, int]:
    """Sum of pressures less a common amount, between zero and the hardness, and the number between them."""
    total, elastic = 0.0, 0
    for k in range(values.size):
        if values[k] > least:
            pressure = np.float64(values[k]) - shift
            if pressure >= hardness:
                total += hardness
            elif pressure > 0:
                total += pressure
                elastic += 1
    return total, elastic


@compiled
def _write_shifted(values: Any, shift: float, least: float, hardness: Any, out: Any) -> None:
    """Write pressures less a common amount, between zero and the hardness; all but it are below it."""
    for k in range(values.size):
        pressure = np.float64(values[k]) - shift
        out[k] = min(max(pressure, 0.0), hardness) if values[k] > least else 0.0


@vectorised_sums
def _weighted_sum(weight: Any, level: Any, origin: float) -> float:
    """Σ weight × (level − origin)."""
    total = 0.0
    for k in range(level.size):
        total += np.float64(weight[k]) * (level[k] - origin)
    return total


@vectorised_sums
def _projected_square(z: Any, weight: Any, shift: float) -> float:
    """Σ (z − shift × weight)²."""
    total = 0.0
    for k in range(z.size):
        total += (z[k] - shift * weight[k]) ** 2
    return total


@vectorised_sums
def _energy_along(
    pressure: Any, pressure_before: Any, level: Any, level_before: Any, approach: float
) -> tuple[float, float]:
    """Minus the slope of the energy at the start of a step of the pressure, and the curvature along it."""
    slope, curvature = 0.0, 0.0
    for i in range(pressure.size):
        change = np.float64(pressure[i]) - np.float64(pressure_before[i])
        slope -= change * (level_before[i] - approach)
        curvature += change * (np.float64(level[i]) - np.float64(level_before[i]))
    return slope, curvature
