"""The fast solver: conjugate gradients on the contact nodes, between prunings of the contact.

On a given set of contact nodes the pressure obeys a linear system, the compliance restricted to the
set, solved by conjugate gradients, with a preconditioner whose work is small and which makes their number
independent of the grid. A *block* of iterations ends when its residual has dropped far enough. It has kept
account of the gap everywhere, from which nodes that penetrate join the set; tension is cut off; and
the gap is evaluated anew in the full precision. Blocks are corrections and run in single precision. The
sum of a block and its pruning is a step between two admissible pressures, shortened to where the energy
is least: the energy cannot grow. A step that pruning spoils is taken again, shortened before it is pruned.

Nodes join by the gap at the end of a block, not by that after pruning: there the contact is out of
balance, and nodes that only seem to penetrate would join beside every patch that has lost its tension.

The load is steered to an area along the *tangent*, the change of pressure per approach on the present
contact. One block gives it, and with it the approach at which each node enters or leaves the contact.

Grids are nested: the solution of a grid of half the nodes on each axis starts that of the next.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from asperity.contact.area import AREA_TOLERANCE, AreaControl
from asperity.contact.certificate import ConvergenceError
from asperity.contact.preconditioner import Preconditioner
from asperity.contact.problem import Control, Problem, Progress, Reporter, State
from asperity.spectral import Array, Fourier

# A block ends when its residual has dropped by this factor, or after this many iterations: short blocks
# while the contact changes, longer by `LENGTHENED` after one that hardly lowered the error, long ones once
# the error is below `SETTLED`. No block goes far below the tolerance.
BLOCK_DROP = 0.05
BLOCK_ITERATIONS = 4
SETTLED = 2e-3
LONG_DROP = 2e-3
LONG_ITERATIONS = 9
LENGTHENED = 2
ENOUGH = 0.3

# Blocks on the finest grid before giving up, and on a coarse one before going on.
MOST_BLOCKS = 400
COARSE_BLOCKS = 20

# Blocks without a smaller error before giving up.
PATIENCE = 40

# The coarsest grid has at least this many nodes on each axis, and coarse grids are solved to these errors.
COARSEST = 32
COARSE_TOLERANCE = 2e-3
COARSE_AREA_TOLERANCE = 1e-2

# A start is used if its load, area, or approach from first touch differs by less than this fraction.
NEAR_START = 0.3

# Share of the spacing of floating-point numbers that counts as the rounding error of a gap.
ROUNDING = 0.1

# Most that the load may change at once along a tangent, relative to itself.
MOST_CHANGE = 0.5

# A solid so many times stiffer than the half-space in some mode estimates its error by its own stiffness.
STIFFER = 2.0

# Pressure with which a node joins, in units of its penetration × E* / spacing.
JOINING = 1.0


class System(NamedTuple):
    """Linear system of a set of contact nodes.

    Attributes
    ----------
    plain : (count,) array of unsigned numbers
        The nodes, in the flattened array.
    residual : (count,) array
        Overlap to be removed, in units of `Level.unit`.
    weight : (count,) array
        The preconditioner's image of a uniform residual.
    weight_sum : float
    fixed_load : bool
        Whether corrections must sum to zero.
    """

    plain: Array
    residual: Array
    weight: Array
    weight_sum: float
    fixed_load: bool

    def uniform_residual(self) -> float:
        """The part of the residual that a change of the approach removes at a fixed load."""
        return _dot(self.weight, self.residual) / self.weight_sum if self.fixed_load else 0.0


class Level:
    """One grid of the hierarchy with its working space."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        grid, outer = problem.grid, problem.fourier
        self.inner = Fourier(grid, np.float32, outer.threads, outer.work)
        self.preconditioner = Preconditioner(problem, self.unit)
        self.response = np.empty(grid.shape, np.float32)
        self.displacement = np.empty(grid.size, np.float32)
        self.coefficients = np.empty(grid.half_shape, np.complex64)

    @cached_property
    def compliance(self) -> Array:
        """Compliance in the precision and in units that suit the blocks."""
        return (self.problem.compliance / self.unit).astype(np.float32)

    @property
    def unit(self) -> float:
        """Displacement of a node per pressure on it: spacing / E*."""
        return min(self.problem.grid.spacing) / self.problem.modulus

    @cached_property
    def highest(self) -> float:
        """Largest magnitude of the heights."""
        return float(np.abs(self.problem.height).max())

    def rounding(self, pressure: Array) -> float:
        """Pressure of a node, by the preconditioner, that stands for the rounding of the gap."""
        compliance, height = self.problem.compliance, self.problem.height
        # A tall layer gives way by far more than the surface is rough.
        largest = self.highest + float(compliance[0, 0]) * float(pressure.mean(dtype=float))
        spacing = float(np.spacing(height.dtype.type(largest)))
        return ROUNDING * spacing / self.unit * float(self.preconditioner.weights[0, 0])

    @cached_property
    def stiffness(self) -> Array | None:
        """Inverse of the compliance, in units of the inverse `unit`, if it is far above the half-space's."""
        q, compliance = self.problem.grid.wavenumber(), self.problem.compliance
        waves = q > 0
        if np.all(2 / self.problem.modulus < STIFFER * (q * compliance)[waves]):
            return None
        out = np.zeros(compliance.shape)
        return np.divide(self.unit, compliance, out=out, where=compliance > 0)

    def respond(self, values: Array) -> Array:
        """Displacement of every node under pressures on the contact."""
        self.inner.forward(self.preconditioner.spread(values), self.coefficients)
        self.coefficients *= self.compliance
        return self.inner.inverse(self.coefficients, self.response, overwrite=True).reshape(-1)

    def correct(
        self, system: System, drop: float = BLOCK_DROP, iterations: int = BLOCK_ITERATIONS
    ) -> tuple[Array, int]:
        """Block of preconditioned conjugate gradients for the compliance on the contact.

        With a fixed load the correction sums to zero. Its displacement of the whole surface is left in
        `displacement`, what remains of the residual in that of the system.
        """
        plain, residual, weight, weight_sum, fixed_load = system
        x, z, d = (np.zeros(plain.size, np.float32) for _ in range(3))
        self.displacement.fill(0)
        response, length = self.response.reshape(-1), np.float32(0)
        first = previous = math.nan
        for iteration in range(iterations + 1):
            total, product = self.preconditioner.apply(residual, z)
            shift = np.float32(total / weight_sum) if fixed_load else np.float32(0)
            product -= float(shift) * _dot(weight, residual)
            if iteration == 0:
                first = product
            if iteration == iterations or not product > drop**2 * first or not product > 0:
                return x, iteration
            # The preconditioner differs a little from one application to the next.
            change = -float(length) * _projected_dot(z, weight, shift, response, plain) if iteration else 0.0
            _advance(d, z, weight, shift, np.float32(max(change / previous, 0) if iteration else 0))
            previous = product
            response = self.respond(d)
            curvature = _dot_gathered(d, response, plain)
            if not curvature > 0:
                return x, iteration + 1
            length = np.float32(product / curvature)
            _step(x, residual, d, response, plain, length)
            _accumulate(self.displacement, response, length)
        raise AssertionError

    def look(self, state: State, fixed_load: bool) -> System:
        """The linear system of the present contact; estimates the error of the state."""
        pressure, gap = state.pressure.reshape(-1), state.gap.reshape(-1)
        plain = _select(pressure)
        self.preconditioner.restrict(plain)
        weight = np.empty(plain.size, np.float32)
        total, _ = self.preconditioner.apply(np.ones(plain.size, np.float32), weight)
        if fixed_load and total:
            # The approach for which the first correction leaves the load as it is.
            state.approach = float(gap[plain[0]])
            state.approach += _weighted_mean(weight, gap, plain, state.approach)
        residual = _residual(gap, plain, state.approach, self.unit)
        estimate = np.empty_like(residual)
        load, _ = self.preconditioner.apply(residual, estimate)
        if fixed_load and total:
            estimate -= np.float32(load / total) * weight
        norm = math.sqrt(_sum_of_squares(pressure))
        missing = math.hypot(
            math.sqrt(_sum_of_squares(estimate)),
            JOINING * math.sqrt(_penetration(pressure, gap, state.approach)) / self.unit,
        )
        if self.stiffness is not None:
            missing = max(missing, self._met_by_layer(plain, residual, fixed_load))
        # Only by chance is the estimate below the rounding of the gaps, of which a given load fixes one.
        unfixed = max(plain.size - fixed_load, 0)
        missing = max(missing, self.rounding(pressure) * math.sqrt(unfixed))
        state.error = missing / norm if norm else (math.inf if missing else 0.0)
        return System(plain, residual, weight, total, fixed_load)

    def advance(self, state: State, system: System, change: Array, reach: float) -> None:
        """Add the change that a block has found; nodes that it makes penetrate join, tension is cut off."""
        pressure, gap = state.pressure.reshape(-1), state.gap.reshape(-1)
        approach = state.approach - self.unit * system.uniform_residual()
        _join(pressure, gap, self.displacement, approach, self.unit)
        _add_clipped(pressure, system.plain, change, np.float32(reach))

    def steer(self, state: State, system: System, area: AreaControl, settled: bool) -> bool:
        """Change the load towards an area, along the tangent of the present contact.

        The block that was due is done with it. Returns whether the load is new.
        """
        pressure, gap = state.pressure.reshape(-1), state.gap.reshape(-1)
        plain, residual = system.plain, system.residual
        if not settled:
            change, used = self.correct(system)
            state.iterations += used
            _add(pressure, plain, change)
            gap += self.unit * self.displacement
            state.approach -= self.unit * system.uniform_residual()
        self.displacement.fill(0)
        if plain.size == gap.size and self.problem.compliance[0, 0] == 0:
            # In full contact the load of such a solid changes at a fixed approach.
            rate = np.ones_like(residual)
        else:
            residual.fill(1)
            rate, used = self.correct(system._replace(fixed_load=False), drop=BLOCK_DROP)
            state.iterations += used
        per_load = float(rate.sum(dtype=float)) / gap.size
        # Changes of the approach at which a node enters or leaves the contact, from lift-off to `most`.
        most = MOST_CHANGE * state.load / per_load
        least = -0.999 * state.load / per_load
        events = _events(pressure, gap, state.approach, self.unit, plain, rate, self.displacement)
        count = int(np.count_nonzero(events <= least))
        edges = np.concatenate(([least], np.sort(events[(events > least) & (events < most)]), [most]))
        # Only numbers of nodes that last while the load changes can be asked for.
        lasting = np.flatnonzero(np.diff(edges) >= area.resolution * state.load / per_load)
        best = lasting[np.argmin(np.abs(lasting + (count - area.target)))]
        in_reach = best < edges.size - 2 or best + count > area.target
        if settled and in_reach and edges[best] < 0 < edges[best + 1]:
            return False
        along = 0.5 * (edges[best] + edges[best + 1])
        if best == 0 and edges[1] >= 0 and count > area.target:
            along = 0.0
        elif best == edges.size - 2:
            along = most
        along = max(along, -most)
        load = state.load
        moved = area.steer(state, settled, load + float(along) * per_load)
        taken = np.float32((state.load - load) / per_load)
        self.displacement *= taken
        _join(pressure, gap, self.displacement, state.approach + self.unit * float(taken), self.unit)
        _add_clipped(pressure, plain, rate, taken)
        return moved

    def level(self, state: State, system: System, tolerance: float) -> bool:
        """Take off the residual's mean by a uniform pressure on the contact; whether that changes the pressure.

        At a given approach the contact of a solid without uniform compliance resists a uniform pressure the
        less the fewer nodes are out of contact, which the preconditioner does not know.
        """
        pressure = state.pressure.reshape(-1)
        ones = np.zeros_like(pressure)
        ones[system.plain] = 1
        response = self.problem.displacement(ones.reshape(self.problem.grid.shape))
        state.iterations += 1
        yielding = float(response.reshape(-1)[system.plain].sum(dtype=float)) / self.unit
        change = float(system.residual.sum(dtype=float)) / yielding if yielding > 0 else 0.0
        norm = math.sqrt(_sum_of_squares(pressure))
        missing = abs(change) * math.sqrt(system.plain.size) / norm
        if missing <= tolerance:
            return False
        state.error = missing
        pressure[system.plain] = np.maximum(pressure[system.plain] + change, 0)
        return True

    def _met_by_layer(self, plain: Array, residual: Array, fixed_load: bool) -> float:
        """Norm of the pressure with which the whole layer would meet a residual on the contact."""
        fourier, grid = self.problem.fourier, self.problem.grid
        overlap = np.zeros(grid.size, fourier.real)
        overlap[plain] = residual
        coefficients = fourier.forward(overlap.reshape(grid.shape)) * self.stiffness
        pressure = fourier.inverse(coefficients.astype(fourier.complex), overwrite=True).reshape(-1)[plain]
        return float(np.linalg.norm(pressure - pressure.mean() if fixed_load else pressure))

    def relax(
        self,
        state: State,
        control: Control,
        tolerance: float,
        area_tolerance: float,
        progress: Progress | None,
        blocks: int,
    ) -> bool:
        """Bring the state to the tolerance on this grid; whether that took no more than so many blocks."""
        problem = self.problem
        fixed_load = control.fixes_load
        height = problem.height.reshape(-1)
        pressure, gap = state.pressure.reshape(-1), state.gap.reshape(-1)
        pressure_before, gap_before = np.empty_like(pressure), np.empty_like(gap)
        area = None
        if control.kind == "area_fraction":
            area = AreaControl(control.value, problem.grid.size, tolerance, area_tolerance)
        report = Reporter(progress, tolerance)
        taken: tuple[Array, Array] | None = None
        moved, reach = False, 1.0
        stalled, best, error_before, length = 0, math.inf, math.inf, BLOCK_ITERATIONS
        for _ in range(blocks):
            if fixed_load:
                if not pressure.any():
                    pressure[np.argmin(height)] = 1
                pressure *= state.load / pressure.mean(dtype=float)
            problem.displacement(state.pressure, state.gap)
            state.iterations += 1
            if not fixed_load:
                factor = _best_scale(pressure, gap, height, control.value)
                pressure *= factor
                gap *= factor
            gap += height
            if taken is not None:
                fraction = _line_search(pressure, pressure_before, gap, gap_before, state.approach)
                if fraction < 0.9:
                    _blend(pressure, pressure_before, fraction)
                    _blend(gap, gap_before, fraction)
                if fraction == 0 and stalled < PATIENCE:
                    # The same step, shorter before it is pruned.
                    reach, stalled = reach / 4, stalled + 1
                    _add_clipped(pressure, *taken, np.float32(reach))
                    continue
                reach = reach / 4 if fraction < 0.1 else min(2 * reach, 1.0)
            system = self.look(state, fixed_load)
            report(state.error)
            if system.plain.size == 0 and state.error == 0:
                break
            # A load just changed takes effect in a block, even if the change is below the tolerance.
            settled = state.error <= tolerance and not moved
            if area is not None and not moved and area.misses(state, settled):
                moved, taken, best = True, None, math.inf
                if not (settled or area.is_near(state)):
                    area.steer(state, settled)
                    continue
                if self.steer(state, system, area, settled):
                    continue
            if settled:
                if fixed_load or not self.level(state, system, tolerance):
                    return True
                taken = None
                continue
            stalled, best = (0, state.error) if state.error < 0.9 * best else (stalled + 1, best)
            if stalled > PATIENCE:
                break
            moved = False
            pressure_before[:] = pressure
            gap_before[:] = gap
            if state.error > SETTLED:
                slow = state.error > 0.8 * error_before
                length = min(length + LENGTHENED, LONG_ITERATIONS) if slow else BLOCK_ITERATIONS
                drop = BLOCK_DROP
            else:
                length = LONG_ITERATIONS
                drop = max(LONG_DROP, ENOUGH * tolerance / max(state.error, tolerance))
            error_before = state.error
            change, used = self.correct(system, drop=drop, iterations=length)
            state.iterations += used
            taken = system.plain, change
            self.advance(state, system, change, reach)
        return False


def solve(
    problem: Problem, control: Control, rtol: float, progress: Progress | None, initial: Array | None
) -> State:
    """Solve a contact problem on nested grids.

    Parameters
    ----------
    problem : Problem
        On the finest grid.
    control : Control
    rtol : float
        Estimated error of the pressure, relative to its norm, to be reached.
    progress : callable, optional
    initial : (ny, nx) array, optional
        Start on the finest grid from this pressure.
    """
    problems = [problem]
    if initial is not None and not _is_near(problem, control, initial):
        initial = None
    while initial is None and (coarser := problems[-1].coarser(COARSEST)) is not None:
        problems.append(coarser)
    coarsest = problems[-1]
    load = control.value if control.kind == "mean_pressure" else math.nan
    if initial is not None:
        pressure = np.maximum(initial, 0).astype(problem.fourier.real)
    else:
        pressure, load = _overlap(coarsest, control)
    if control.kind == "area_fraction":
        load = float(pressure.mean(dtype=float)) if initial is not None else load
    state = State(pressure, np.empty_like(pressure), control.value, load)
    for coarse, finer in zip(reversed(problems[1:]), reversed(problems[:-1]), strict=True):
        Level(coarse).relax(state, control, COARSE_TOLERANCE, COARSE_AREA_TOLERANCE, None, COARSE_BLOCKS)
        state.pressure = coarse.refine(state.pressure, finer, state.approach)
        if control.kind == "area_fraction":
            # Areas converge with the first power of the spacing: the next change is half of the last.
            before, load = load, state.load
            if coarse is not coarsest:
                state.load *= min(max((load / before) ** 0.5, 0.5), 2.0)
        state.gap = np.empty_like(state.pressure)
    if not Level(problem).relax(state, control, rtol, AREA_TOLERANCE, progress, MOST_BLOCKS):
        raise ConvergenceError(
            f"active set on {problem.grid.shape} nodes stopped",
            state.error,
            rtol,
            state.iterations,
            float(state.pressure.mean(dtype=float)),
        )
    return state


def _is_near(problem: Problem, control: Control, pressure: Array) -> bool:
    """Whether a pressure is a better start than the solution of a coarser grid."""
    if control.kind == "area_fraction":
        now = float(np.count_nonzero(pressure > 0)) / problem.grid.size
    elif control.kind == "mean_pressure":
        now = float(np.maximum(pressure, 0).mean())
    else:
        pressure = np.maximum(pressure, 0).astype(problem.fourier.real)
        gap = problem.displacement(pressure) + problem.height
        contact = pressure > 0
        now = float(gap[contact].mean()) - problem.height.min() if contact.any() else 0.0
        return abs(now - (control.value - problem.height.min())) < NEAR_START * abs(now)
    return abs(now - control.value) < NEAR_START * control.value


def _overlap(problem: Problem, control: Control) -> tuple[Array, float]:
    """First guess: pressure in proportion to the overlap with the undeformed solid."""
    height = problem.height
    if control.kind == "approach":
        return np.zeros_like(height), math.nan
    stiffness = problem.modulus * 2 * math.pi / max(problem.grid.length)
    if control.kind == "area_fraction":
        fraction = min(0.999, 2 * control.value)
        level = float(max(np.quantile(height, fraction), height.min() + 1e-3 * np.std(height, dtype=float)))
        pressure = np.maximum(level - height, 0) * stiffness
        if not pressure.any():
            pressure[:] = stiffness * min(problem.grid.spacing) * 1e-3
        return pressure, float(pressure.mean(dtype=float))
    low = float(height.min())
    high = float(height.max()) + control.value / stiffness
    for _ in range(60):
        level = 0.5 * (low + high)
        if np.maximum(level - height, 0).mean() * stiffness > control.value:
            high = level
        else:
            low = level
    return np.maximum(high - height, 0) * stiffness, control.value


@njit(cache=True, error_model="numpy")
def _select(pressure: Any) -> Any:
    """Numbers of the nodes under pressure."""
    count = 0
    for i in range(pressure.size):
        if pressure[i] > 0:
            count += 1
    # Unsigned, because the compiler guards every access by a signed number against one below zero.
    plain = np.empty(count, np.uint64)
    count = 0
    for i in range(pressure.size):
        if pressure[i] > 0:
            plain[count] = i
            count += 1
    return plain


@njit(cache=True, error_model="numpy")
def _penetration(pressure: Any, gap: Any, approach: float) -> float:
    """Sum of the squares of the penetrations of nodes without pressure."""
    total = 0.0
    for i in range(pressure.size):
        if pressure[i] <= 0 and gap[i] < approach:
            total += (approach - gap[i]) ** 2
    return total


@njit(cache=True, error_model="numpy")
def _join(pressure: Any, gap: Any, displacement: Any, approach: float, unit: float) -> None:
    """Give pressure to nodes without it that are about to penetrate."""
    for i in range(pressure.size):
        if pressure[i] == 0:
            overlap = (approach - gap[i]) / unit - displacement[i]
            if overlap > 0:
                pressure[i] = JOINING * overlap


@njit(cache=True, error_model="numpy")
def _weighted_mean(weight: Any, gap: Any, plain: Any, origin: float) -> float:
    total, norm = 0.0, 0.0
    for k in range(plain.size):
        total += weight[k] * (gap[plain[k]] - origin)
        norm += weight[k]
    return total / norm


@njit(cache=True, error_model="numpy")
def _residual(gap: Any, plain: Any, approach: float, unit: float) -> Any:
    out = np.empty(plain.size, np.float32)
    for k in range(plain.size):
        out[k] = (approach - gap[plain[k]]) / unit
    return out


@njit(cache=True, error_model="numpy")
def _add_clipped(pressure: Any, plain: Any, change: Any, reach: Any) -> None:
    for k in range(plain.size):
        pressure[plain[k]] = max(pressure[plain[k]] + reach * change[k], 0.0)


@njit(cache=True, error_model="numpy")
def _line_search(pressure: Any, pressure_before: Any, gap: Any, gap_before: Any, approach: float) -> float:
    """Fraction of a step at which the energy is least."""
    slope, curvature = 0.0, 0.0
    for i in range(pressure.size):
        change = pressure[i] - pressure_before[i]
        slope -= change * (gap_before[i] - approach)
        curvature += change * (gap[i] - gap_before[i])
    return min(max(slope / curvature, 0.0), 1.0) if curvature > 0 else 1.0


@njit(cache=True, error_model="numpy")
def _best_scale(pressure: Any, displacement: Any, height: Any, approach: float) -> float:
    """Factor on the pressure, and so on the displacement, at which the energy is least."""
    work, energy = 0.0, 0.0
    for i in range(pressure.size):
        work += pressure[i] * (approach - height[i])
        energy += pressure[i] * displacement[i]
    return work / energy if energy > 0 and work > 0 else 1.0


@njit(cache=True, error_model="numpy")
def _events(
    pressure: Any, gap: Any, approach: float, unit: float, plain: Any, rate: Any, response: Any
) -> Any:
    """Change of the approach at which each node enters or leaves the contact."""
    changes = np.empty(pressure.size, np.float32)
    for i in range(pressure.size):
        closing = 1 - response[i]
        changes[i] = (gap[i] - approach) / (unit * closing) if closing > 0 else np.inf
    for k in range(plain.size):
        changes[plain[k]] = -pressure[plain[k]] / rate[k] if rate[k] > 0 else -np.inf
    return changes


@njit(cache=True, error_model="numpy")
def _add(pressure: Any, plain: Any, change: Any) -> None:
    for k in range(plain.size):
        pressure[plain[k]] += change[k]


@njit(cache=True, error_model="numpy")
def _accumulate(displacement: Any, response: Any, length: Any) -> None:
    for i in range(displacement.size):
        displacement[i] += length * response[i]


@njit(cache=True, error_model="numpy")
def _blend(values: Any, before: Any, fraction: float) -> None:
    for i in range(values.size):
        values[i] = before[i] + fraction * (values[i] - before[i])


@njit(cache=True, error_model="numpy")
def _sum_of_squares(values: Any) -> float:
    total = 0.0
    for i in range(values.size):
        total += values[i] * values[i]
    return total


@njit(cache=True, error_model="numpy")
def _dot(a: Any, b: Any) -> float:
    total = 0.0
    for k in range(a.size):
        total += a[k] * b[k]
    return total


@njit(cache=True, error_model="numpy")
def _projected_dot(a: Any, weight: Any, shift: Any, field: Any, plain: Any) -> float:
    total = 0.0
    for k in range(plain.size):
        total += (a[k] - shift * weight[k]) * field[plain[k]]
    return total


@njit(cache=True, error_model="numpy")
def _dot_gathered(a: Any, field: Any, plain: Any) -> float:
    total = 0.0
    for k in range(plain.size):
        total += a[k] * field[plain[k]]
    return total


@njit(cache=True, error_model="numpy")
def _advance(direction: Any, z: Any, weight: Any, shift: Any, ratio: Any) -> None:
    for k in range(direction.size):
        direction[k] = z[k] - shift * weight[k] + ratio * direction[k]


@njit(cache=True, error_model="numpy")
def _step(x: Any, residual: Any, direction: Any, response: Any, plain: Any, length: Any) -> None:
    for k in range(plain.size):
        x[k] += length * direction[k]
        residual[k] -= length * response[plain[k]]
