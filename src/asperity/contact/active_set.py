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
from typing import NamedTuple

import numpy as np

from asperity.contact import kernels
from asperity.contact.control import AREA_TOLERANCE, AreaControl
from asperity.contact.preconditioner import Preconditioner
from asperity.contact.problem import Control, Problem, Reporter, State
from asperity.errors import ConvergenceError
from asperity.spectral import Fourier
from asperity.types import Array, Progress

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
    image : (count,) array
        The preconditioner's image of the residual.
    weight : (count,) array
        That of a uniform residual.
    weight_sum : float
    fixed_load : bool
        Whether corrections must sum to zero.
    """

    plain: Array
    residual: Array
    image: Array
    weight: Array
    weight_sum: float
    fixed_load: bool

    def uniform_residual(self) -> float:
        """The part of the residual that a change of the approach removes at a fixed load."""
        fixed = self.fixed_load and self.weight_sum
        return kernels.dot(self.weight, self.residual) / self.weight_sum if fixed else 0.0


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

    def rounding(self, mean_pressure: float) -> float:
        """Pressure of a node, by the preconditioner, that stands for the rounding of the gap."""
        compliance, height = self.problem.compliance, self.problem.height
        # A tall layer gives way by far more than the surface is rough.
        largest = self.highest + float(compliance[0, 0]) * mean_pressure
        spacing = float(np.spacing(height.dtype.type(largest)))
        return ROUNDING * spacing / self.unit * float(self.preconditioner.weights[0, 0])

    @cached_property
    def stiffness(self) -> Array | None:
        """Inverse of the compliance, in units of the inverse `unit`, if it is far above the half-space's."""
        if self.problem.layer.height is None:
            return None
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
        `displacement`, what remains of the residual, and the image of that, in those of the system.
        """
        plain, residual, z, weight, weight_sum, fixed_load = system
        x, d = np.zeros(plain.size, np.float32), np.zeros(plain.size, np.float32)
        self.displacement.fill(0)
        response, length = self.response.reshape(-1), np.float32(0)
        first = previous = math.nan
        for iteration in range(iterations + 1):
            if iteration:
                self.preconditioner.apply(residual, z)
            total, product = kernels.sum_and_dot(z, residual)
            shift = np.float32(total / weight_sum if fixed_load and weight_sum else 0)
            product -= float(shift) * kernels.dot(weight, residual)
            if iteration == 0:
                first = product
            if iteration == iterations or not product > drop**2 * first or not product > 0:
                return x, iteration
            ratio = 0.0
            if iteration:
                # Of the change of the residual: the preconditioner is not quite the same every time.
                changed = -float(length) * kernels.projected_dot(z, weight, shift, response, plain)
                ratio = max(changed / previous, 0.0)
            kernels.advance(d, z, weight, shift, np.float32(ratio))
            previous = product
            response = self.respond(d)
            curvature = kernels.dot_gathered(d, response, plain)
            if not curvature > 0:
                return x, iteration + 1
            length = np.float32(product / curvature)
            kernels.step(x, residual, d, response, plain, length)
            kernels.accumulate(self.displacement, response, length)
        raise AssertionError

    def look(self, state: State, fixed_load: bool) -> System:
        """The linear system of the present contact; estimates the error of the state."""
        pressure, gap = state.pressure.reshape(-1), state.gap.reshape(-1)
        plain = kernels.select(pressure)
        self.preconditioner.restrict(plain)
        weight = self.preconditioner.apply_uniform()
        total = float(weight.sum(dtype=float))
        if fixed_load and total:
            # The approach for which the first correction leaves the load as it is.
            state.approach = float(gap[plain[0]])
            state.approach += kernels.weighted_mean(weight, gap, plain, state.approach)
        residual = kernels.residual(gap, plain, state.approach, self.unit)
        image = np.empty_like(residual)
        self.preconditioner.apply(residual, image)
        shift = float(image.sum(dtype=float)) / total if fixed_load and total else 0.0
        load, squares, penetration = kernels.norms(pressure, gap, state.approach)
        norm = math.sqrt(squares)
        missing = math.hypot(
            math.sqrt(kernels.projected_square(image, weight, shift)),
            JOINING * math.sqrt(penetration) / self.unit,
        )
        if self.stiffness is not None:
            missing = max(missing, self._met_by_layer(plain, residual, fixed_load))
        # Only by chance is the estimate below the rounding of the gaps, of which a given load fixes one.
        unfixed = max(plain.size - fixed_load, 0)
        missing = max(missing, self.rounding(load) * math.sqrt(unfixed))
        state.error = missing / norm if norm else (math.inf if missing else 0.0)
        return System(plain, residual, image, weight, total, fixed_load)

    def advance(self, state: State, system: System, change: Array, reach: float) -> None:
        """Add the change that a block has found; nodes that it makes penetrate join, tension is cut off."""
        pressure, gap = state.pressure.reshape(-1), state.gap.reshape(-1)
        approach = state.approach - self.unit * system.uniform_residual()
        kernels.join(pressure, gap, self.displacement, approach, self.unit, JOINING)
        kernels.add_clipped(pressure, system.plain, change, np.float32(reach))

    def steer(self, state: State, system: System, area: AreaControl, settled: bool) -> bool:
        """Change the load towards an area, along the tangent of the present contact.

        The block that was due is done with it. Returns whether the load is new.
        """
        pressure, gap = state.pressure.reshape(-1), state.gap.reshape(-1)
        plain, residual = system.plain, system.residual
        if not settled:
            change, used = self.correct(system)
            state.iterations += used
            kernels.add(pressure, plain, change)
            gap += self.unit * self.displacement
            state.approach -= self.unit * system.uniform_residual()
        self.displacement.fill(0)
        if plain.size == gap.size and self.problem.compliance[0, 0] == 0:
            # In full contact the load of such a solid changes at a fixed approach.
            rate = np.ones_like(residual)
        else:
            residual.fill(1)
            rate, used = self.correct(system._replace(image=system.weight.copy(), fixed_load=False))
            state.iterations += used
        per_load = float(rate.sum(dtype=float)) / gap.size
        # Changes of the approach at which a node enters or leaves the contact, from lift-off to `most`.
        most = MOST_CHANGE * state.load / per_load
        least = -0.999 * state.load / per_load
        events = kernels.events(pressure, gap, state.approach, self.unit, plain, rate, self.displacement)
        count = int(np.count_nonzero(events <= least))
        edges = np.concatenate(([least], np.sort(events[(events > least) & (events < most)]), [most]))
        # Only numbers of nodes that last while the load changes can be asked for, unless there is none.
        lasting = np.flatnonzero(np.diff(edges) >= area.resolution * state.load / per_load)
        lasting = lasting if lasting.size else np.arange(edges.size - 1)
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
        approach = state.approach + self.unit * float(taken)
        kernels.join(pressure, gap, self.displacement, approach, self.unit, JOINING)
        kernels.add_clipped(pressure, plain, rate, taken)
        return moved

    def balance(self, state: State, system: System, tolerance: float) -> bool:
        """Take off the mean residual by a uniform pressure on the contact; whether that changes the pressure.

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
        error = abs(change) * math.sqrt(system.plain.size) / float(np.linalg.norm(pressure))
        if error <= tolerance:
            return False
        state.error = error
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
        pressure = state.pressure.reshape(-1)
        pressure_before, gap_before = np.empty_like(pressure), np.empty_like(state.gap)
        area = None
        if control.kind == "area_fraction":
            area = AreaControl(control.value, problem.grid.size, tolerance, area_tolerance)
        report = Reporter(progress, tolerance)
        taken: tuple[Array, Array] | None = None
        moved, reach = False, 1.0
        stalled, best, error_before, length = 0, math.inf, math.inf, BLOCK_ITERATIONS
        for _ in range(blocks):
            self.evaluate(state, control)
            gap = state.gap.reshape(-1)
            if taken is not None:
                fraction = kernels.line_search(
                    pressure, pressure_before, gap, gap_before.reshape(-1), state.approach
                )
                if fraction < 0.9:
                    kernels.blend(pressure, pressure_before, fraction)
                    kernels.blend(gap, gap_before.reshape(-1), fraction)
                if fraction == 0 and stalled < PATIENCE:
                    # The same step, shorter before it is pruned.
                    reach, stalled = reach / 4, stalled + 1
                    kernels.add_clipped(pressure, *taken, np.float32(reach))
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
                if fixed_load or not self.balance(state, system, tolerance):
                    return True
                taken = None
                continue
            stalled, best = (0, state.error) if state.error < 0.9 * best else (stalled + 1, best)
            if stalled > PATIENCE:
                break
            moved = False
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
            pressure_before[:] = pressure
            self.advance(state, system, change, reach)
            state.gap, gap_before = gap_before, state.gap
        return False

    def evaluate(self, state: State, control: Control) -> None:
        """The gap under the pressure, which is scaled to the load, or to the least energy at an approach."""
        pressure, height = state.pressure.reshape(-1), self.problem.height.reshape(-1)
        mean = float(pressure.mean(dtype=float)) if control.fixes_load else 1.0
        if mean == 0:
            pressure[np.argmin(height)], mean = 1, 1 / pressure.size
        self.problem.displacement(state.pressure, state.gap)
        state.iterations += 1
        gap = state.gap.reshape(-1)
        if control.fixes_load:
            factor = state.load / mean
        else:
            factor = kernels.best_scale(pressure, gap, height, control.value)
        kernels.scale(pressure, gap, height, factor)


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
    load = control.value if control.kind == "mean_pressure" else math.nan
    if initial is not None:
        pressure = np.maximum(initial, 0).astype(problem.fourier.real)
    else:
        pressure, load = _overlap(problems[-1], control)
    if control.kind == "area_fraction":
        load = float(pressure.mean(dtype=float)) if initial is not None else load
    state = State(pressure, np.empty_like(pressure), control.value, load)
    loads: list[float] = []
    while len(problems) > 1:
        coarse = problems.pop()
        Level(coarse).relax(state, control, COARSE_TOLERANCE, COARSE_AREA_TOLERANCE, None, COARSE_BLOCKS)
        state.pressure = coarse.refine(state.pressure, problems[-1], state.approach)
        state.gap = np.empty_like(state.pressure)
        if control.kind == "area_fraction":
            loads.append(state.load)
            state.load = _foreseen(loads)
    if not Level(problem).relax(state, control, rtol, AREA_TOLERANCE, progress, MOST_BLOCKS):
        raise ConvergenceError(
            f"active set on {problem.grid.shape} nodes stopped",
            state.error,
            rtol,
            state.iterations,
            float(state.pressure.mean(dtype=float)),
        )
    return state


def _foreseen(loads: list[float]) -> float:
    """Load of the next grid at a given area, from those of the grids before.

    Areas converge with the first power of the spacing: the next change is half of the last.
    """
    if len(loads) < 2:
        return loads[-1]
    return loads[-1] * min(max((loads[-1] / loads[-2]) ** 0.5, 0.5), 2.0)


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
