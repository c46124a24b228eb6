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
- control of the area along the tangent of the contact (`asperity.contact.tangent`), which costs one or two
  more inner solves,
- that inner solves run in single precision, for a solution in double precision.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.contact import kernels
from asperity.contact.area_control import AreaControl
from asperity.contact.area_steps import AreaSteps
from asperity.contact.assembly import Assembler
from asperity.contact.inner_solve import InnerAccuracy, InnerSolver
from asperity.contact.problem import Control, Problem, State
from asperity.contact.safeguard import SafeguardedStep, Stagnation
from asperity.contact.soft_mode import SoftMode
from asperity.contact.solver_progress import ConvergenceProgress
from asperity.types import Progress


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
    """

    tolerance: float
    area_tolerance: float
    max_outer_iterations: int


class ActiveSet:
    """The outer loop on one grid, with its working space.

    Parameters
    ----------
    problem : Problem
    control : Control
    rule : StoppingRule
    """

    def __init__(self, problem: Problem, control: Control, rule: StoppingRule) -> None:
        self._problem = problem
        self._control = control
        self._rule = rule
        self._unit = problem.nodal_compliance
        self._inner = InnerSolver(problem)
        self._assembler = Assembler(problem, self._inner.preconditioner)
        self._step = SafeguardedStep(problem)
        self._soft = SoftMode(problem, self._inner)
        self._area = None
        if control.kind == "area_fraction":
            area = AreaControl(control.value, problem.grid.size, rule.tolerance, rule.area_tolerance)
            self._area = AreaSteps(problem, self._inner, area)

    def solve(self, state: State, progress: Progress | None = None) -> bool:
        """Iterate until the state fulfils the stopping rule; True if it does, False if the loop gave up."""
        report = ConvergenceProgress(progress, self._rule.tolerance)
        accuracy, stagnation = InnerAccuracy(self._rule.tolerance), Stagnation()
        load_changed = False
        for _ in range(self._rule.max_outer_iterations):
            self._evaluate_gap(state)
            if not self._step.shorten(state, may_repeat=stagnation.allows_more):
                stagnation.record_repetition()
                continue
            system, state.error = self._assembler.assemble(state, self._control.fixes_load)
            state.approach = system.approach
            report(state.error)
            if system.contact_nodes.size == 0 and state.error == 0:
                # The truncated surface of a coarse grid may be out of reach at the approach.
                return False
            # A load just changed takes effect in an inner solve, even if the change is below the tolerance.
            converged = state.error <= self._rule.tolerance and not load_changed
            if self._area is not None and not load_changed and self._area.misses(state, converged):
                load_changed = self._area.change_load(state, system, converged)
                if not load_changed:
                    return True
                self._step.forget()
                stagnation.forget_error()
                continue
            if converged:
                if self._control.fixes_load or not self._soft.balance(state, system, self._rule.tolerance):
                    return True
                self._step.forget()
                continue
            stagnation.record(state.error)
            if stagnation.gives_up:
                return False
            load_changed = False
            correction = self._inner.solve(system, *accuracy.next(state.error))
            state.iterations += correction.iterations
            steered = None if self._area is None else self._area.steer(state, system, correction)
            self._step.take(state, system, correction if steered is None else steered)
            if steered is not None:
                self._step.forget()
                stagnation.forget_error()
        return False

    def _evaluate_gap(self, state: State) -> None:
        """Evaluate the gap, after scaling the pressure to the load, or to the least energy at an approach."""
        pressure, height = state.pressure.reshape(-1), self._problem.height.reshape(-1)
        mean = float(pressure.mean(dtype=float)) if self._control.fixes_load else 1.0
        if mean == 0:
            pressure[np.argmin(height)], mean = 1, 1 / pressure.size
        self._problem.displacement(state.pressure, state.gap)
        state.iterations += 1
        gap = state.gap.reshape(-1)
        if self._control.fixes_load:
            factor = state.load / mean
        else:
            factor = kernels.energy_scale(pressure, gap, height, self._control.value)
        kernels.scale_to_gap(pressure, gap, height, factor)
