"""The outer loop of the fast solver: an active-set method for pressures between zero and the hardness.

The pressure 0 ≤ p ≤ H minimises the energy ½ p·G p + p·(h − δ), with the compliance G, over all p at an
approach δ, or over those of a given mean. Contact nodes below the hardness H are *elastic*, those at it
*plastic*; by default H is infinite. One step of the loop

1. evaluates the gap in the precision of the fields, and shortens the step to where the energy is least,
2. assembles the linear system of the elastic nodes, 0 < p < H, and estimates the error of p from it,
3. solves the system approximately by conjugate gradients (`asperity.contact.active_set.inner_solve`),
4. adds to the correction a change of the load, if an area is imposed and the correction would miss it
   (`asperity.contact.active_set.area`),
5. adds the correction: nodes that it would make penetrate enter the contact, nodes in tension are released,
   those above H become plastic, and plastic ones with a gap elastic (`asperity.contact.active_set.step`).

It is kin to the conjugate gradients of Polonsky & Keer (1999, 10.1016/S0043-1648(99)00113-1), which change
the set of contact nodes in every iteration, to the bound-constrained conjugate gradients of Vollebregt (2014,
10.1007/s10957-013-0499-x) and of Bugnicourt et al. (2018, 10.1007/s11249-017-0980-z), and most of all to the
method of Moré & Toraldo (1991, 10.1137/0801008), which alternates between conjugate gradients on a fixed set
and changes of the set. New here are

- the preconditioner with a coarse grid (`asperity.contact.compliance.preconditioner`), which makes the
  number of iterations independent of the grid,
- that nodes enter the contact by the gap at the end of an inner solve, before tensile nodes are released,
- control of the area along the tangent of the contact, which costs one more inner solve,
- that inner solves run in single precision and with a displacement that is right to a per cent
  (`asperity.contact.compliance.inner_response`), and the first steps in single precision, for a solution in
  double precision.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from asperity.contact.active_set.area import AREA_TOLERANCE, AreaControl, extended
from asperity.contact.active_set.assembly import ContactSystem, assemble
from asperity.contact.active_set.inner_solve import RESIDUAL_DROP, InnerSolver
from asperity.contact.active_set.iterate import Iterate, Pressure, evaluate
from asperity.contact.active_set.near_null import balanced
from asperity.contact.active_set.step import EntryCandidates, Step, taken
from asperity.contact.problem import Control, ConvergenceProgress, Problem
from asperity.core.types import Progress

# Below this error rounding matters in single precision, and the set of contact nodes hardly changes any more:
# fields are in double precision, and inner solves are longer. Fields are so, too, if all of the error is
# rounding.
FINAL_ERROR = 2e-3
FINAL_RESIDUAL_DROP = 2e-3

# The loop gives up after so many steps without an error below 0.9 of the smallest before. Of the problems of
# `studies/stability/extremes.py` that are solved, none takes more than 6 such steps.
MAX_STEPS_WITHOUT_PROGRESS = 40


@dataclass(frozen=True)
class StoppingRule:
    """When the outer loop ends on a grid.

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
    max_steps: int = 400
    rounding_suffices: bool = False


@dataclass(frozen=True)
class Outcome:
    """Where the outer loop ended.

    Attributes
    ----------
    iterate : Iterate
    system : ContactSystem
        Approach and error of the iterate.
    iterations : int
        Applications of the compliance.
    converged : bool
    """

    iterate: Iterate
    system: ContactSystem
    iterations: int
    converged: bool


def iterate_on(
    problems: Sequence[Problem],
    control: Control,
    rule: StoppingRule,
    start: Pressure,
    progress: Progress | None = None,
) -> Outcome:
    """Iterate on one grid until the rule is fulfilled, or without progress.

    Parameters
    ----------
    problems : sequence of Problem
        The same problem in single and in double precision, or in one of them.
    control : Control
    rule : StoppingRule
    start : Pressure
    progress : callable, optional
    """
    problem, last = problems[0], problems[-1]
    inner = InnerSolver(problem.response)
    area = None
    if control.kind == "area_fraction":
        area = AreaControl(control.value, problem.grid.size, rule.tolerance, rule.area_tolerance)
    report = ConvergenceProgress(progress, rule.tolerance)
    iterate = evaluate(problem, control, start)
    iterations, length, operators = 1, 1.0, None
    smallest, without_progress = math.inf, 0
    for steps in range(1, rule.max_steps + 1):
        iterate = iterate.without_free_nodes()
        system = assemble(iterate, control, inner, operators)
        operators = system.linear.operators
        report(system.error)
        rounded = rule.rounding_suffices and system.error <= system.rounding
        converged = problem is last and (rounded or system.error <= rule.tolerance)
        misses = area is not None and area.misses(iterate.nodes.size)
        if converged and not misses:
            balance, work = None, 0
            if not control.fixes_load and system.linear.operators.nodes.size:
                # Both errors add up.
                balance, work = balanced(iterate, system, inner, 0.5 * rule.tolerance)
            iterations += work
            if balance is None:
                return Outcome(iterate, system, iterations, True)
            iterate = evaluate(problem, control, balance)
            iterations += 1
            continue
        if iterate.nodes.size == 0 and system.error == 0:
            break  # the truncated surface of a coarse grid may be out of reach at the approach
        if system.error < 0.9 * smallest:
            smallest, without_progress = system.error, 0
        else:
            without_progress += 1
        if without_progress > MAX_STEPS_WITHOUT_PROGRESS or steps == rule.max_steps:
            break
        correction = inner.solve(system.linear, _residual_drop(system.error, rule.tolerance))
        entering, load = EntryCandidates.after(iterate, system, correction), iterate.load
        extension = None
        if area is not None:
            extension = extended(area, iterate, system, correction, entering, inner, converged)
            if extension is None and converged:
                return Outcome(iterate, system, iterations, True)
        if extension is not None:
            correction, entering, load = extension
            smallest = math.inf
        iterations += correction.iterations
        step = Step.of(iterate, system, correction, entering)
        if system.error <= max(FINAL_ERROR, system.rounding):
            problem = last
        if extension is not None or problem is not iterate.problem:
            # Energies at two loads, or in two precisions, do not compare.
            iterate, work = evaluate(problem, control, step.pressure_after(length, load)), 1
        else:
            iterate, length, work = taken(step, problem, control, load, length)
        iterations += work
    return Outcome(iterate, system, iterations, False)


def _residual_drop(error: float, tolerance: float) -> float:
    """Drop of the residual in the next inner solve: no further than the tolerance needs."""
    if error > FINAL_ERROR:
        return RESIDUAL_DROP
    return max(FINAL_RESIDUAL_DROP, 0.3 * tolerance / max(error, tolerance))
