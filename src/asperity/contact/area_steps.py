"""Steps of the outer loop towards an imposed area: changes of the load that take the contact along.

The number of contact nodes to which a step leads is known before its gap is evaluated: those that it leaves
under pressure, and those that join. Where that number misses the one asked for, the correction is extended
along the tangent of the contact to another load, and the step is taken anew. So load and pressure converge
together. Only if the area is missed by far, or when the pressure has converged, the load is changed in a step
of its own.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from asperity.contact import kernels
from asperity.contact.area_control import MAX_STEERED_ERROR, AreaControl
from asperity.contact.assembly import JOIN_STIFFNESS
from asperity.contact.closing import ClosingNodes
from asperity.contact.inner_solve import ContactSystem, Correction, InnerSolver
from asperity.contact.iterate import Iterate
from asperity.contact.places import places_in_union
from asperity.contact.problem import Problem
from asperity.contact.safeguard import SafeguardedStep
from asperity.contact.tangent import Tangent

# Accuracy of the tangent along which a correction is extended: drop of the residual, and iterations at most.
TANGENT_DROP = 0.05
TANGENT_ITERATIONS = 4

# The multiple of the tangent for the last few nodes is at most so many times that of the power law.
PLAUSIBLE = 5.0

# The number of contact nodes is taken from the tangent if it lasts while the multiple of the tangent changes
# by this fraction of that of the power law: about the error of the displacement in inner solves.
LEAST_INTERVAL = 0.01

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
        tangent = self._solved_for_uniform(iterate, system, TANGENT_DROP, TANGENT_ITERATIONS)
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
        response = self._inner.response
        near = ClosingNodes.after(iterate, correction, response, unit, unit * reach)
        rate = np.maximum(1 - response.respond_at(near.nodes, tangent.pressure), LEAST_RATE)
        leaving = -(iterate.pressure + correction.pressure) / np.maximum(tangent.pressure, LEAST_RATE)
        edges = np.sort(np.concatenate((-near.overlap / rate, leaving)))
        index = self._area.target
        if not 0 < index < edges.size:
            return expected
        before, after = float(edges[index - 1]), float(edges[index])
        factor = 0.5 * (before + after)
        # Nodes that touch at the same load, as on a surface with a symmetry, cannot be parted.
        lasts = after - before > LEAST_INTERVAL * abs(expected)
        return factor if lasts and abs(factor) < reach else expected

    def change_load(self, iterate: Iterate, system: ContactSystem, converged: bool) -> bool:
        """Change the load towards the imposed area; False if no other load gives a nearer area.

        If the pressure has converged the whole contact follows the load along its tangent, otherwise the load
        alone changes.
        """
        if converged:
            tangent = self._tangent(iterate, system)
            change = tangent.change_to_area(iterate, self._area)
            if change is None:
                return False
            load = self._area.next_load(iterate, converged, iterate.load + change * tangent.load)
            if load is not None:
                self._follow(tangent, iterate, load)
        else:
            load = self._area.next_load(iterate, converged)
        if load is None:
            return False
        iterate.load = load
        return True

    def _tangent(self, iterate: Iterate, system: ContactSystem) -> Tangent:
        """Tangent of the present contact, by an inner solve for a uniform residual."""
        size, response = self._problem.grid.size, self._inner.response
        pressure = np.ones_like(system.residual)
        # In full contact the load of a solid without uniform displacement changes at a fixed approach.
        displaces = pressure.size < size or self._problem.response.uniform_compliance != 0
        if displaces:
            pressure = self._solved_for_uniform(iterate, system).pressure
        load = float(pressure.sum(dtype=float)) / size
        return Tangent(pressure, load, self._problem.nodal_compliance, response, displaces)

    def _solved_for_uniform(self, iterate: Iterate, system: ContactSystem, *accuracy: Any) -> Correction:
        """Correction that answers a uniform residual at a given approach."""
        uniform = replace(
            system,
            residual=np.ones_like(system.residual),
            image=system.uniform_image.copy(),
            fixed_load=False,
        )
        correction = self._inner.solve(uniform, *accuracy)
        iterate.iterations += correction.iterations
        return correction

    def _follow(self, tangent: Tangent, iterate: Iterate, load: float) -> None:
        """Change the pressure along the tangent to a load; penetrating nodes join, nodes in tension leave."""
        unit = self._problem.nodal_compliance
        change = np.float32((load - iterate.load) / tangent.load)
        approach = iterate.approach + unit * float(change)
        nodes, gap = iterate.free_nodes_below(max(approach, iterate.approach))
        overlap = np.empty(gap.size, np.float32)
        kernels.residual(gap, approach, unit, overlap)
        overlap -= change * tangent.displacement_at(nodes)
        joins, real = overlap > 0, iterate.pressure.dtype
        pressure = np.maximum(iterate.pressure + (change * tangent.pressure).astype(real), 0)
        joined = (JOIN_STIFFNESS * overlap[joins]).astype(real)
        places = places_in_union(iterate.nodes, nodes[joins])
        iterate.set_pressure(
            kernels.inserted(places, iterate.nodes, nodes[joins]), kernels.inserted(places, pressure, joined)
        )
        iterate.drop_free_nodes()
