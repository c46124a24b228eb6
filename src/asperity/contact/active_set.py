"""The outer loop of the fast solver: an active-set method for pressures that are not negative.

The pressure p ≥ 0 minimises the energy ½ p·G p + p·(h − δ), with the compliance G, over all p at an approach
δ, or over those of a given mean. One step of the loop

1. evaluates the gap in the precision of the fields, and shortens the last step to where the energy is least,
2. assembles the linear system of the *contact nodes*, those with p > 0, and estimates the error of p from it,
3. solves the system approximately by conjugate gradients (`asperity.contact.inner_solve`),
4. adds to the correction a change of the load, if an area is imposed and the correction would miss it
   (`asperity.contact.area_steps`),
5. adds the correction: nodes that it would make penetrate join the contact, and nodes in tension are
   released.

It is kin to the conjugate gradients of Polonsky & Keer (1999, 10.1016/S0043-1648(99)00113-1), which change
the set of contact nodes in every iteration, to the bound-constrained conjugate gradients of Vollebregt (2014,
10.1007/s10957-013-0499-x) and of Bugnicourt et al. (2018, 10.1007/s11249-017-0980-z), and most of all to the
method of Moré & Toraldo (1991, 10.1137/0801008), which alternates between conjugate gradients on a fixed set
and changes of the set. New here are

- the preconditioner with a coarse grid (`asperity.contact.preconditioner`), which makes the number of
  iterations independent of the grid,
- that joining nodes are chosen from the gap at the end of an inner solve, before tensile nodes are released
  (`asperity.contact.safeguard`),
- control of the area along the tangent of the contact (`asperity.contact.tangent`), which costs one more
  inner solve,
- that inner solves run in single precision and with a displacement that is right to a per cent
  (`asperity.contact.inner_response`), and the first steps in single precision, for a solution in double
  precision.
"""

from __future__ import annotations

from dataclasses import dataclass

from asperity.contact.area_control import AreaControl
from asperity.contact.area_steps import AreaSteps
from asperity.contact.assembly import Assembler
from asperity.contact.inner_solve import ContactSystem, InnerAccuracy, InnerSolver
from asperity.contact.iterate import Iterate
from asperity.contact.problem import Control, Problem
from asperity.contact.safeguard import SafeguardedStep, Stagnation
from asperity.contact.soft_mode import SoftMode
from asperity.contact.solver_progress import ConvergenceProgress
from asperity.types import Progress

# Gaps are expected to close by this fraction of their motion in the step before.
EXPECTED_DECREASE = 0.3


@dataclass(frozen=True)
class StoppingRule:
    """When the outer loop ends on a grid.

    Attributes
    ----------
    tolerance : float
        Estimated error of the pressure, relative to its norm.
    area_tolerance : float
        Error of an imposed area, relative to it.
    max_outer_iterations : int
    rounding_suffices : bool
        True if the loop also ends when rounding keeps the error above the tolerance.
    goal : float, optional
        Tolerance of a solution that the loop starts: when the rule is fulfilled, one more step towards it
        follows, without an evaluation of its gap.
    """

    tolerance: float
    area_tolerance: float
    max_outer_iterations: int
    rounding_suffices: bool = False
    goal: float | None = None


class ActiveSet:
    """The outer loop on one grid, with its working space.

    Parameters
    ----------
    problem : Problem
    control : Control
    rule : StoppingRule
    inner : InnerSolver, optional
        One that was made for the same grid, in any precision.
    """

    def __init__(
        self, problem: Problem, control: Control, rule: StoppingRule, inner: InnerSolver | None = None
    ) -> None:
        self._problem = problem
        self._control = control
        self._rule = rule
        self._inner = inner or InnerSolver(problem)
        self._assembler = Assembler(problem, self._inner)
        self._step = SafeguardedStep(problem, self._inner.response)
        self._soft = SoftMode(problem, self._inner)
        self._area = None
        if control.kind == "area_fraction":
            area = AreaControl(control.value, problem.grid.size, rule.tolerance, rule.area_tolerance)
            self._area = AreaSteps(problem, self._inner, self._step, area)

    def solve(self, iterate: Iterate, progress: Progress | None = None) -> bool:
        """Iterate until the rule is fulfilled; True if it is, False if the loop gave up."""
        report = ConvergenceProgress(progress, self._rule.tolerance)
        accuracy, stagnation = InnerAccuracy(self._rule.goal or self._rule.tolerance), Stagnation()
        load_changed = False
        for _ in range(self._rule.max_outer_iterations):
            self._evaluate(iterate)
            fraction = self._step.best_fraction(iterate)
            if fraction == 0 and stagnation.allows_more:
                self._step.repeat_shorter(iterate)
                stagnation.record_repetition()
                continue
            self._step.shorten(iterate, fraction)
            if not iterate.is_evaluated:
                self._evaluate(iterate)
            iterate.drop_free_nodes()
            system = self._assembler.assemble(iterate, self._control.fixes_load)
            report(iterate.error)
            if iterate.nodes.size == 0 and iterate.error == 0:
                # The truncated surface of a coarse grid may be out of reach at the approach.
                return False
            # A load just changed takes effect in an inner solve, even if the change is below the tolerance.
            converged = self._is_converged(iterate, system) and not load_changed
            ends = converged and self._rule.goal is None
            misses = self._area is not None and not load_changed and self._area.misses(iterate, ends)
            if self._area is not None and misses:
                load_changed = self._area.change_load(iterate, system, ends)
                if not load_changed:
                    return True
                self._step.forget()
                stagnation.forget_error()
                continue
            if ends:
                if self._control.fixes_load or not self._soft.balance(iterate, system, self._rule.tolerance):
                    return True
                self._step.forget()
                continue
            stagnation.record(iterate.error)
            if stagnation.gives_up:
                return False
            load_changed = False
            correction = self._inner.solve(system, *accuracy.next(iterate.error))
            iterate.iterations += correction.iterations
            if self._area is None:
                del system  # the step needs memory
                motion = self._step.take(iterate, correction)
            else:
                motion = self._area.take(iterate, system, correction)
            iterate.expected_motion = EXPECTED_DECREASE * motion
            if converged:
                iterate.drop_free_nodes()
                return True
        return False

    def _evaluate(self, iterate: Iterate) -> None:
        """Evaluate the gap; at a given load, a contact that has lost all its nodes begins anew."""
        if self._control.fixes_load and not iterate.pressure.any():
            iterate.start_at_lowest_node()
            self._step.forget()
        iterate.evaluate(self._control)

    def _is_converged(self, iterate: Iterate, system: ContactSystem) -> bool:
        rounding = self._rule.rounding_suffices and system.is_rounding
        return rounding or iterate.error <= self._rule.tolerance
