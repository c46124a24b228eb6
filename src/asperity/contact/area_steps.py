"""Steps of the outer loop towards an imposed area: changes of the load that take the contact along.

The number of contact nodes to which a step leads is known before its gap is evaluated: those that it leaves
under pressure, and those that join. Where that number misses the one asked for, the correction is extended
along the tangent of the contact to another load, and the step is taken anew. So load and pressure converge
together. Only if the area is missed by far, or when the pressure has converged, the load is changed in a step
of its own.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asperity.contact.area_control import MAX_STEERED_ERROR, AreaControl
from asperity.contact.inner_solve import ContactSystem, Correction, InnerSolver
from asperity.contact.iterate import Iterate
from asperity.contact.problem import Problem
from asperity.contact.safeguard import SafeguardedStep

# Accuracy of the tangent along which a correction is extended: drop of the residual, and iterations at most.
TANGENT_DROP = 0.05
TANGENT_ITERATIONS = 4

# The multiple of the tangent for the last few nodes is at most so many times that of the power law.
PLAUSIBLE = 5.0

# Lower bound of the rates at which gaps close and pressures grow along the tangent. Slower nodes stay as they
# are.
LEAST_RATE = 1e-6


class AreaSteps:
    """Changes of the load on one grid.

    Parameters
    ----------
    problem : Problem
    inner : InnerSolver
    step : SafeguardedStep
    area : AreaControl
    """

    def __init__(
        self, problem: Problem, inner: InnerSolver, step: SafeguardedStep, area: AreaControl
    ) -> None:
        self._problem = problem
        self._inner = inner
        self._step = step
        self._area = area

    def misses(self, iterate: Iterate, converged: bool) -> bool:
        """True if the area has to be changed before the pressure is corrected."""
        if not converged and (iterate.error > MAX_STEERED_ERROR or self._area.is_near(iterate)):
            return False
        return self._area.misses(iterate, converged)

    def take(self, iterate: Iterate, system: ContactSystem, correction: Correction) -> float:
        """Take a step, with another load if the area would be missed.

        Returns
        -------
        float
            By how much gaps closed at most.
        """
        steers = self._area.may_steer(iterate)
        nodes, before = iterate.nodes, iterate.pressure
        motion = self._step.take(iterate, correction)
        if not steers:
            return motion
        count = int(np.count_nonzero(iterate.pressure > 0))
        released = int(np.count_nonzero(before + correction.pressure <= 0))
        step = self._area.next_step(iterate, count, released)
        if step is None:
            return motion
        uniform = replace(
            system,
            residual=np.ones_like(correction.pressure),
            image=system.uniform_image.copy(),
            fixed_load=False,
        )
        tangent = self._inner.solve(uniform, TANGENT_DROP, TANGENT_ITERATIONS)
        iterate.iterations += tangent.iterations
        load = float(tangent.pressure.sum(dtype=float)) / self._problem.grid.size
        if not load > 0:
            return motion
        iterate.set_pressure(nodes, before)
        factor = step.load_change / load
        if step.last_nodes:
            factor = self._factor_of_last_nodes(iterate, correction, tangent, factor)
        extended = Correction(
            correction.pressure + np.float32(factor) * tangent.pressure,
            correction.displacement + np.float32(factor) * tangent.displacement,
            correction.approach + self._problem.nodal_compliance * factor,
            0,
        )
        iterate.load += factor * load
        motion = self._step.take(iterate, extended)
        self._step.forget()
        return motion

    def _factor_of_last_nodes(
        self, iterate: Iterate, correction: Correction, tangent: Correction, expected: float
    ) -> float:
        """Multiple of the tangent at which the number of contact nodes is that asked for.

        It follows from the multiples at which each node enters or leaves the contact, of which those up to
        `PLAUSIBLE` times the expected multiple are known.
        """
        unit, reach = self._problem.nodal_compliance, PLAUSIBLE * abs(expected)
        approach = iterate.approach + correction.approach
        upward = max(0.0, -float(correction.displacement.min(initial=0)))
        candidates, gap = iterate.free_nodes_below(approach + unit * (upward + reach))
        respond_at = self._inner.response.respond_at
        opening = (gap - approach) / unit + respond_at(candidates, correction.pressure)
        closing = np.maximum(1 - respond_at(candidates, tangent.pressure), LEAST_RATE)
        leaving = -(iterate.pressure + correction.pressure) / np.maximum(tangent.pressure, LEAST_RATE)
        edges = np.sort(np.concatenate((opening / closing, leaving)))
        index = self._area.target
        if not 0 < index < edges.size:
            return expected
        factor = 0.5 * float(edges[index - 1] + edges[index])
        return factor if abs(factor) < reach else expected
