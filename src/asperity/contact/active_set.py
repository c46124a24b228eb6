"""The fast method: an active-set iteration on nested grids that converges for every contact problem.

The pressure 0 ≤ p ≤ p_H minimises the energy ½ p·G p + p·(h − δ), with the compliance G, over all p at an
approach δ, or over all p of a given mean; by default the hardness p_H is infinite.

    for each grid, from the coarsest to the finest:                                `solve`
        start from the pressure of the coarser grid, less its gap over             `Iterate.refined`
        the displacement of a node
        if few nodes touch, solve for the candidates among all nodes               `dilute`
        repeat:                                                                    `ActiveSet.run`
            evaluate the gap under the pressure, by one pair of transforms         `Iterate.of`
            assemble the system of the elastic nodes, estimate the error           `ContactSystem.of`
            stop if the error, and an imposed area, are within their tolerances    `ActiveSet.run`
            if few nodes touch, step to the contact of the candidates, or          `dilute`
            solve for a correction of the pressure, by conjugate gradients         `InnerSolver.solve`
            find the nodes that the correction brings into contact                 `ContactSystem.held_after`
            if an area is imposed, extend the correction to the load for this area `extended_to_area`
            add the correction, release nodes in tension, and stop at the least    `Step.of`
            energy in between; if it does not fall, use exact corrections, and     `ActiveSet._next`
            finally the projected gradient

Hardness enters where a pressure is bounded (`iterate.with_load`) and where held nodes are found
(`Iterate.held_nodes`); the area in `load`; precision in `ActiveSet.run`, which begins on the finest grid in
single precision.

It is related to the conjugate gradients of Polonsky & Keer (1999, 10.1016/S0043-1648(99)00113-1), which
change the set of contact nodes in every iteration, to the bound-constrained conjugate gradients of Vollebregt
(2014, 10.1007/s10957-013-0499-x) and of Bugnicourt et al. (2018, 10.1007/s11249-017-0980-z), and most of all
to the method of Moré & Toraldo (1991, 10.1137/0801008), which alternates between conjugate gradients on a
fixed set and changes of the set. Projected gradients as the step that guarantees convergence are known from
Dostál & Schöberl (2005, 10.1007/s10589-005-4557-7); ``paper/supplement/method.md`` proves it.
Starts from coarser grids are known from multigrid methods, and for rough surfaces from Bemporad & Paggi
(2015, arXiv:1506.00532). New here are

- the preconditioner with a coarse grid (`asperity.contact.operators`), which makes the number of iterations
  independent of the grid,
- that the gap at the end of an inner solve, before tensile nodes are released, decides which nodes enter,
- the interpolation of the pressure to a finer grid, which keeps nodes out of contact free,
- control of the area along the tangent of the contact, which costs one more inner solve,
- that inner solves run in single precision and with a displacement that is right to a per cent, and the
  first steps in single precision, for a solution in double precision.
"""

from dataclasses import dataclass, replace
from itertools import count

import numpy as np

from asperity.contact.contact_nodes import dot, field_of, norm
from asperity.contact.dilute import (
    INNER_DIVISION,
    CandidateProblem,
    CandidateResponse,
    SplitResponse,
    are_few,
    candidates_of,
    divided,
    first_margin,
)
from asperity.contact.inner_solve import MAX_ITERATIONS, RESIDUAL_DROP, InnerSolver
from asperity.contact.iterate import ContactSystem, Iterate, Pressure, Step
from asperity.contact.load import AREA_TOLERANCE, AreaControl, extended_to_area
from asperity.contact.problem import Control, ConvergenceProgress, Problem, State
from asperity.core.errors import ConvergenceError
from asperity.core.types import Array, Progress

# The coarsest grid has at least this many nodes on each axis. Half and twice as many take the same number of
# transforms on the finest grid to 2 %.
MIN_POINTS = 32

# Below this error rounding matters in fields in single precision: they are in double precision.
SINGLE_PRECISION_ERROR = 2e-3

# Below this error the set of contact nodes hardly changes any more: inner solves drop their residual as far
# as the tolerance needs, but for their single precision no further than to this fraction.
FINAL_ERROR = 2e-3
LEAST_RESIDUAL = 2e-3

# After so many steps without progress one step follows the projected gradient; the length of inner solves
# has then been doubled as often. From single precision the loop then continues in double precision.
PATIENCE = 3

# The whole step is taken unless the energy is least before this fraction of it: otherwise the whole step
# does not raise the energy.
WHOLE_STEP = 0.5

# If the energy is least before this fraction of a step, more nodes have to enter or leave the contact than
# a correction with an error of a few per cent finds, as on a sheet that bends. Corrections are then solved
# almost exactly, and whole steps are taken whatever the energy, until the number of nodes that enter or
# leave has not fallen for so many steps.
LEAST_FRACTION = 0.1
EXACT_RESIDUAL_DROP = 1e-3
MAX_EXACT_ITERATIONS = 300
MAX_EXACT_STEPS = 30

# After that such a step is shortened by a factor before nodes are released, so many times; later steps are
# shortened, too, and lengthened step by step.
SHORTENING = 4.0
MAX_TRIALS = 3

# The loop gives up after so many steps without progress.
MAX_STEPS_WITHOUT_PROGRESS = 100

# The preconditioner accounts for the mean displacement if it makes the contact at most so many times stiffer
# against a uniform pressure than it is. Without this correction the error on rough surfaces of 256² nodes is
# below the tolerance where it makes the contact up to 20 times stiffer, and up to 66 tolerances beyond.
MAX_STIFFNESS_RATIO = 10.0

# The loop gives up if this correction is still needed after so many times.
MAX_BALANCES = 30

# Contacts of a half-space with a smaller area than this fraction are not examined: patches, rows, lattices
# and random nodes on up to a tenth of the area are made at most 1.4 times stiffer.
LEAST_BALANCED = 0.1


# Without an exact displacement candidates are solved to the error of their displacement, and near an iterate
# no further than to this fraction of its error, in at most so many steps.
CANDIDATE_DROP, MAX_CANDIDATE_STEPS = 1e-4, 30


@dataclass(frozen=True)
class StoppingRule:
    """Conditions under which the outer loop ends on a grid.

    Attributes
    ----------
    tolerance : float
        Estimated error of the pressure, relative to its norm.
    area_tolerance : float
        Error of an imposed area, relative to it.
    max_steps : int
    rounding_suffices : bool
        True if the loop also ends when rounding keeps the error above the tolerance.
    """

    tolerance: float
    area_tolerance: float = AREA_TOLERANCE
    max_steps: int = 1000
    rounding_suffices: bool = False


# A coarse grid need not be solved better than its own discretisation error. Found by trial on rough surfaces
# of 512² and 1024² nodes: a fifth and four times the tolerance of a dense contact take as many transforms to
# 1 %, but the smaller one takes up to a fifth more steps. Dilute contacts take half a pair of transforms less
# with ten times the tolerance.
COARSE_RULE = StoppingRule(tolerance=1e-2, area_tolerance=1e-2, max_steps=20, rounding_suffices=True)
DILUTE_COARSE_RULE = replace(COARSE_RULE, tolerance=0.1)


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
        Estimated error of the pressure to be reached, relative to its norm.
    progress : callable, optional
        Follows the error on the finest grid.
    initial : (ny, nx) array, optional
        Pressure to start from on the finest grid.

    Raises
    ------
    ConvergenceError
        If rounding keeps the error above the tolerance.
    """
    problems = [problem]
    if problem.height.dtype == np.float64:
        problems = [problem.in_single_precision(), problem]
    if initial is None:
        start, iterations = _start_from_coarse_grids(problems[0], control)
    else:
        load = control.value if control.kind == "mean_pressure" else float(initial.mean(dtype=float))
        start, iterations = Pressure.of_field(initial, load), 0
    loop = ActiveSet(problems, control, StoppingRule(rtol), progress)
    iterate, system, converged = loop.run(start)
    iterations += loop.iterations
    if not converged:
        raise ConvergenceError(
            f"active set on {problem.grid.shape} nodes stopped",
            system.error,
            rtol,
            iterations,
            float(iterate.pressure.sum(dtype=float)) / problem.grid.size,
            _remedy(system),
        )
    problem.response.release()
    return State(
        iterate.pressure_field(),
        system.approach,
        iterate.load,
        system.error,
        iterations,
        iterate.displacement,
    )


def _remedy(system: ContactSystem) -> str:
    """Advice for a solution that has stopped."""
    if system.error <= 10 * system.rounding:
        found = f"rounding of heights and displacements alone is an error of about {system.rounding:.1g}"
        return f"{found}: a larger rtol is needed"
    return "a larger rtol is needed, or a solid that bends less, or numbers of similar magnitude"


def _start_from_coarse_grids(problem: Problem, control: Control) -> tuple[Pressure, int]:
    """Pressure solved on the coarse grids, one after the other, from a first guess; and the work."""
    problems, iterations = [problem], 0
    while (coarser := problems[-1].coarser(MIN_POINTS)) is not None:
        problems.append(coarser)
    pressure, margin = first_guess(problems[-1], control), 0.0
    while len(problems) > 1:
        rule = DILUTE_COARSE_RULE if margin else COARSE_RULE
        loop = ActiveSet([problems.pop()], control, rule)
        iterate, system, _ = loop.run(pressure)
        iterations += loop.iterations
        # An area that a flat cannot have is sought for on the whole grid: candidates take many more steps.
        is_finest = len(problems) == 1
        margin = 0.0 if loop.misses_area(iterate) else first_margin(iterate, problems[-1], is_finest)
        pressure = iterate.refined(system.approach, problems[-1], margin)
    return pressure, iterations


def first_guess(problem: Problem, control: Control) -> Pressure:
    """Pressure in proportion to the overlap of the indenter with the undeformed solid.

    The factor is the stiffness of the longest wave of the cell. At an imposed approach the pressure is zero.
    """
    height, hardness = problem.height, problem.hardness
    solid, longest = problem.response.solid, 2 * np.pi / max(problem.grid.period)
    stiffness = solid.effective_modulus * longest
    if solid.interface is not None:
        stiffness = 2 / float(solid.surface_compliance(longest))
    if control.kind == "approach":
        return Pressure.of_field(np.zeros_like(height), np.nan)
    if control.kind == "mean_pressure":
        # The level at which the overlap gives this pressure, at most the hardness, by bisection.
        low = float(height.min())
        level = float(height.max()) + control.value / stiffness
        for _ in range(60):
            middle = 0.5 * (low + level)
            if np.clip(middle - height, 0, hardness / stiffness).mean() * stiffness > control.value:
                level = middle
            else:
                low = middle
    else:
        # Twice the imposed area lies below this level, since the overlap exceeds the contact.
        least = height.min() + 1e-3 * np.std(height, dtype=float)
        level = float(max(np.quantile(height, min(0.999, 2 * control.value)), least))
    pressure = np.minimum(np.maximum(level - height, 0) * stiffness, hardness)
    if pressure.max() >= hardness:
        problem.plastic.set()
    if control.kind == "mean_pressure":
        return Pressure.of_field(pressure, control.value)
    if not pressure.any():
        pressure[:] = min(stiffness * min(problem.grid.spacing) * 1e-3, 0.5 * hardness)
    return Pressure.of_field(pressure, float(pressure.mean(dtype=float)))


class Stagnation:
    """Counts the steps since a number, such as the error, last fell below nine tenths of its minimum."""

    def __init__(self) -> None:
        self.steps, self._smallest = 0, np.inf

    def record(self, value: float) -> None:
        """Record the number after a step."""
        if value < 0.9 * self._smallest:
            self.steps, self._smallest = 0, value
        else:
            self.steps += 1

    def forget(self) -> None:
        """Accept any error as progress, because the load has changed."""
        self._smallest = np.inf


class ActiveSet:
    """The outer loop on one grid.

    Parameters
    ----------
    problems : list of Problem
        The same problem in single and in double precision, or in one of them; a finished one is removed.
    control : Control
    rule : StoppingRule
    progress : callable, optional

    Attributes
    ----------
    iterations : int
        Applications of the compliance.
    """

    def __init__(
        self,
        problems: list[Problem],
        control: Control,
        rule: StoppingRule,
        progress: Progress | None = None,
        inner: InnerSolver | None = None,
    ) -> None:
        self._problems, self._control, self._rule = problems, control, rule
        self._inner = inner or InnerSolver(problems[-1].response)
        self._split: tuple[SplitResponse, SplitResponse] | None = None  # while steps are taken on candidates
        self._report = ConvergenceProgress(progress, rule.tolerance)
        self.iterations = 0
        self._area, self._length = None, 1.0
        self._error_before = np.inf
        # Of the number of nodes that enter or leave in exact steps. Corrections then stay exact on this grid:
        # where the set no longer changes, the next one reaches the tolerance, and there is no step to save.
        self._exact: Stagnation | None = None
        if control.kind == "contact_area_fraction":
            size = problems[0].grid.size
            self._area = AreaControl(control.value, size, rule.tolerance, rule.area_tolerance)

    def run(self, start: Pressure) -> tuple[Iterate, ContactSystem, bool]:
        """The last iterate, its system, and whether it fulfils the rule."""
        stagnation, operators, balances = Stagnation(), None, 0
        if start.includes_candidates:
            start = self._contact_of_candidates(start)
        iterate = self._evaluated(self._problems[0], start)
        for steps in count():
            iterate = iterate.without_free_nodes()
            system = ContactSystem.of(iterate, self._control, self._inner, operators)
            same_nodes, operators = system.linear.operators is operators, system.linear.operators
            self._report(system.error)
            within = system.error <= self._rule.tolerance
            within |= self._rule.rounding_suffices and system.error <= system.rounding
            converged = len(self._problems) == 1 and within and np.isfinite(system.approach)
            if converged and not self.misses_area(iterate):
                balance = self._balance(iterate, system)
                if balance is None:
                    return iterate, system, True
                balances += 1
                if balances > MAX_BALANCES:
                    return iterate, system, False
                iterate = self._evaluated(iterate.problem, balance, iterate.displacement)
                continue
            stagnation.record(system.error)
            if steps == self._rule.max_steps or self._is_hopeless(iterate, system, stagnation):
                return iterate, system, False
            found = None if converged else self._step_on_candidates(iterate, system)
            if found is None:
                found = self._corrected(iterate, system, converged, same_nodes, stagnation)
            if found is None:
                return iterate, system, True
            step, load = found
            keeps_load = load == iterate.load or not self._control.fixes_load
            del found  # the next iterate takes its memory
            # Single precision is left where its rounding matters.
            coarse = (
                system.error > max(SINGLE_PRECISION_ERROR, 2 * system.rounding)
                and stagnation.steps < PATIENCE
            )
            keeps_precision = len(self._problems) == 1 or coarse
            if not keeps_precision:
                del self._problems[0]
            if not (keeps_precision and keeps_load):
                # Energies at two loads, or in two precisions, do not compare.
                stagnation.forget()
                if self._exact is not None:
                    self._exact = Stagnation()
                target, problem = step.pressure_after(1.0, load), self._problems[0]
                out = iterate.displacement if iterate.problem is problem else None
                del iterate, system, step  # the fields in single precision are not needed any more
                iterate = self._evaluated(problem, target, out)
            else:
                iterate = self._next(iterate, system, step, stagnation)
                del system, step
        raise AssertionError  # the loop returns

    def misses_area(self, iterate: Iterate) -> bool:
        """True if an iterate does not have the imposed area."""
        return self._area is not None and self._area.misses(iterate.nodes.size)

    def _corrected(
        self,
        iterate: Iterate,
        system: ContactSystem,
        converged: bool,
        same_nodes: bool,
        stagnation: Stagnation,
    ) -> tuple[Step, float] | None:
        """Step by a correction of the pressure, and its load; None if the iterate is kept."""
        exact = (EXACT_RESIDUAL_DROP, MAX_EXACT_ITERATIONS) if self._exact else ()
        longest = MAX_ITERATIONS * 2 ** (PATIENCE if same_nodes else min(stagnation.steps, PATIENCE))
        if system.error > FINAL_ERROR:
            drop = RESIDUAL_DROP
        else:  # no further than the tolerance needs
            tolerance = self._rule.tolerance
            drop = max(LEAST_RESIDUAL, 0.3 * tolerance / max(system.error, tolerance))
        effort = exact or (drop, longest)
        correction = self._inner.solve(system.linear, *effort)
        held, load, extension = system.held_after(iterate, correction), iterate.load, None
        if self._area is not None:
            extension = extended_to_area(
                self._area, iterate, system, correction, held, self._inner, converged, exact
            )
            if extension is None and converged:
                return None
        if extension is not None:
            correction, held, load = extension
        self.iterations += correction.iterations
        return Step.of(iterate, system, correction, held), load

    def _contact_of_candidates(self, start: Pressure) -> Pressure:
        """The contact of the candidates of a start, in the last precision; the start if they are many."""
        problem, bearing = self._problems[-1], np.flatnonzero(start.values)
        if not (bearing.size and are_few(start.nodes, problem)):
            return start
        whole, split = divided(problem, self._rule.tolerance)
        self._problems[:] = [whole]
        self._split = split, SplitResponse(problem.response, INNER_DIVISION)
        nearby = CandidateProblem(problem, start.nodes, split)
        found = Pressure(bearing, start.values[bearing], start.load)
        found = self._solved(nearby, found, max(split.division.error, 0.3 * self._rule.tolerance))
        return Pressure(start.nodes[found.nodes], found.values, found.load)

    def _step_on_candidates(self, iterate: Iterate, system: ContactSystem) -> tuple[Step, float] | None:
        """Step to the contact of the nodes that may touch, and its load; None if they are many.

        A step that does not lower the error to a tenth is the last one.
        """
        if self._split is None:
            return None
        candidates = candidates_of(iterate, system)
        helps = system.error < 0.1 * self._error_before and are_few(candidates, iterate.problem)
        self._error_before = system.error
        if not helps:
            self._split = None
            return None
        nearby = CandidateProblem(iterate.problem, candidates, self._split[0], iterate)
        start = iterate.with_overlap(system.approach)
        start = replace(start, nodes=np.searchsorted(candidates, start.nodes))
        tolerance = max(CANDIDATE_DROP * system.error, 0.3 * self._rule.tolerance)
        found = self._solved(nearby, start, tolerance)
        return nearby.step_to(found, system.approach), found.load

    def _solved(self, nearby: CandidateProblem, start: Pressure, tolerance: float) -> Pressure:
        """The contact of candidates, from a pressure."""
        assert self._split is not None
        inner = self._inner.with_response(CandidateResponse(nearby.candidates, self._split[1]))
        rule = StoppingRule(tolerance, self._rule.area_tolerance, MAX_CANDIDATE_STEPS, True)
        loop = ActiveSet([nearby], self._control, rule, inner=inner)
        found, system, _ = loop.run(start)
        self.iterations += loop.iterations
        return found.with_overlap(system.approach)

    def _evaluated(self, problem: Problem, pressure: Pressure, out: Array | None = None) -> Iterate:
        """Iterate of a pressure; `out` is an array for its displacement."""
        self.iterations += 1
        return Iterate.of(problem, self._control, pressure, out)

    def _is_hopeless(self, iterate: Iterate, system: ContactSystem, stagnation: Stagnation) -> bool:
        """True if rounding keeps the error from falling, or nothing is in reach."""
        if iterate.nodes.size == 0 and not system.error > 0:
            return True  # no node is within reach of the approach, or the pressure has overflowed
        if len(self._problems) > 1:
            return False
        limit = 2 * system.rounding
        if iterate.pressure.dtype == np.float32:  # a solution in double precision can follow
            limit = max(limit, SINGLE_PRECISION_ERROR)
        rounded = stagnation.steps > PATIENCE and system.error <= limit
        return rounded or stagnation.steps > MAX_STEPS_WITHOUT_PROGRESS

    def _next(self, iterate: Iterate, system: ContactSystem, step: Step, stagnation: Stagnation) -> Iterate:
        """The iterate after a step at the same load, in the arrays of the previous iterate.

        It has the least energy along the step. If the energy hardly falls, exact steps follow, which need
        not lower it. When they no longer help, shorter steps are tried, and finally the step along the
        projected gradient, which lowers the energy; after many steps that have not lowered the error this
        step is tried first. The best iterate is taken.
        """
        problem, field = iterate.problem, iterate.displacement
        if self._exact is not None and self._exact.steps <= MAX_EXACT_STEPS:
            after = self._evaluated(problem, step.pressure_after(1.0, iterate.load), field)
            self._exact.record(step.exchanged(after))
            return after
        best, decrease = Pressure(iterate.nodes, iterate.pressure, iterate.load), 0.0
        trials = 0 if stagnation.steps % (PATIENCE + 1) == PATIENCE else MAX_TRIALS
        for trial in range(trials + 1):
            if trial == trials:
                step = Step.gradient(iterate, system)
            elif trial:
                self._length /= SHORTENING
                step = step.without_entering()
            length = 1.0 if trial == trials else self._length
            after = self._evaluated(problem, step.pressure_after(length, iterate.load), field)
            fraction, fall = step.least_energy(after)
            if fall > decrease:
                best, decrease = step.between(after, fraction if fraction < WHOLE_STEP else 1.0), fall
            if fraction >= LEAST_FRACTION:
                break
            if self._exact is None:
                self._exact = Stagnation()
                if problem.has_whole_grid:
                    self._inner = InnerSolver(problem.response, divided=False)
                return after
        self._length = min(2 * self._length, 1.0)
        if fraction >= WHOLE_STEP and fall == decrease:
            return after
        return self._evaluated(problem, best, field)

    def _balance(self, iterate: Iterate, system: ContactSystem) -> Pressure | None:
        """Pressure without its error along the near-null mode at a given approach; None if that is small.

        The fewer nodes are out of contact, the less a pressure on the whole contact displaces a solid
        without uniform displacement; in full contact it does not displace it at all. The preconditioner,
        and with it the error estimate, does not account for that. The pressure d that removes a uniform
        overlap of the contact is then a near-null mode of the compliance: a large error in proportion to d
        has a small residual. The same holds for a node that still penetrates: the pressure that removes its
        overlap displaces the contact far more than elsewhere. Nodes that penetrate enter the contact
        here, and plastic nodes with a gap are relieved.
        """
        operators, problem = system.linear.operators, iterate.problem
        nodes, hardness = operators.nodes, problem.hardness
        few = problem.response.solid.height is None and nodes.size < LEAST_BALANCED * problem.grid.size
        if self._control.fixes_load or not nodes.size or few or not problem.has_whole_grid:
            return None
        uniform = _displacement(problem, nodes, np.ones(nodes.size))
        compliance = float(uniform[nodes].sum(dtype=float))
        if MAX_STIFFNESS_RATIO * compliance * operators.uniform_sum > nodes.size**2:
            return None
        correction = self._inner.solve_uniform(operators, drop=LEAST_RESIDUAL)
        direction = correction.pressure.astype(iterate.pressure.dtype)
        response = _displacement(problem, nodes, direction)
        self.iterations += 2 + correction.iterations
        curvature = dot(direction, response[nodes])
        if not curvature > 0:
            return None
        pressure = iterate.pressure_field().reshape(-1)
        level = problem.height.reshape(-1) + iterate.displacement.reshape(-1)
        overlap = (system.approach - level) / problem.nodal_compliance
        entering = np.where(pressure == 0, np.maximum(overlap, 0), 0)
        entering += np.where(pressure >= hardness, np.minimum(overlap, 0), 0)
        change = dot(direction, overlap[nodes]) / curvature
        hidden = dot(np.abs(response), np.abs(entering)) / curvature
        error = (abs(change) + hidden) * norm(direction) / norm(iterate.pressure)
        if error <= 0.5 * self._rule.tolerance:  # both errors add up
            return None
        pressure += entering
        pressure[nodes] = np.clip(pressure[nodes] + change * direction, 0, hardness)
        return Pressure.of_field(pressure, iterate.load)


def _displacement(problem: Problem, nodes: Array, pressure: Array) -> Array:
    """Displacement of all nodes under pressures on some of them, in units of the nodal compliance."""
    field = field_of(problem.grid.shape, nodes, pressure.astype(problem.fourier.real, copy=False))
    return problem.response.displacement(field, field).reshape(-1) / problem.nodal_compliance
