"""Steps of the outer loop towards an imposed area: changes of the load that take the contact along.

The number of contact nodes to which a correction leads is known before it is added: those that it leaves
under pressure, and those whose gap it closes. Where that number misses the one asked for, the correction is
extended along the tangent of the contact to another load. So load and pressure converge together. Only if the
area is missed by far, or when the pressure has converged, the load is changed in a step of its own.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from asperity.contact import kernels
from asperity.contact.area_control import MAX_STEERED_ERROR, AreaControl
from asperity.contact.assembly import JOIN_STIFFNESS
from asperity.contact.inner_solve import ContactSystem, Correction, InnerSolver
from asperity.contact.problem import Problem, State
from asperity.contact.tangent import Tangent

# Accuracy of the tangent along which a correction is extended: drop of the residual, and iterations. With one
# iteration the error of the pressure grows from one step to the next where a tenth of the nodes or more
# touch, with three a solution takes up to 5 % more transforms (rough surfaces of 1024² nodes).
TANGENT_DROP = 0.05
TANGENT_ITERATIONS = 2


class AreaSteps:
    """Changes of the load on one grid.

    Parameters
    ----------
    problem : Problem
    inner : InnerSolver
    area : AreaControl
    """

    def __init__(self, problem: Problem, inner: InnerSolver, area: AreaControl) -> None:
        self._problem = problem
        self._inner = inner
        self._area = area
        self._unit = problem.nodal_compliance
        self._kept: Tangent | None = None  # of the last correction for which it was computed

    def misses(self, state: State, converged: bool) -> bool:
        """True if the area has to be changed before the pressure is corrected."""
        if not converged and (state.error > MAX_STEERED_ERROR or self._area.is_near(state)):
            return False
        return self._area.misses(state, converged)

    def steer(self, state: State, system: ContactSystem, correction: Correction) -> Correction | None:
        """The correction extended by a change of the load, which the state takes; None if it can stay.

        Pressure and displacement of the correction are overwritten.
        """
        if not self._area.may_steer(state):
            return None
        pressure, gap, nodes = state.pressure.reshape(-1), state.gap.reshape(-1), system.contact_nodes
        approach = state.approach + correction.approach
        remaining, joining = kernels.touching_nodes(
            pressure, gap, nodes, correction.pressure, correction.displacement, approach, self._unit
        )
        step = self._area.next_step(state, remaining + joining, nodes.size - remaining)
        if step is None:
            return None
        if self._kept is None or step.last_nodes:
            self._kept = self._tangent_beside(correction, state, system)
        tangent = self._kept.on(nodes, system.uniform_image)
        if not tangent.load > 0:
            return None
        load_change = step.load_change
        if step.last_nodes:
            load_change = step.refined(tangent.load * tangent.corrected_change(state, self._area, correction))
        change = load_change / tangent.load
        kernels.add_scaled(correction.pressure, tangent.pressure, np.float32(change))
        kernels.add_scaled(correction.displacement, tangent.displacement, np.float32(change))
        state.load += load_change
        return replace(correction, approach=correction.approach + self._unit * change)

    def change_load(self, state: State, system: ContactSystem, converged: bool) -> bool:
        """Change the load towards the imposed area; False if no other load gives a nearer area.

        If the pressure has converged the whole contact follows the load along its tangent, otherwise the load
        alone changes.
        """
        if converged:
            tangent = self._tangent(state, system)
            change = tangent.change_to_area(state, self._area)
            if change is None:
                return False
            load = self._area.next_load(state, converged, state.load + change * tangent.load)
            self._follow(tangent, state, state.load if load is None else load)
        else:
            load = self._area.next_load(state, converged)
        if load is None:
            return False
        state.load = load
        return True

    def _tangent_beside(self, correction: Correction, state: State, system: ContactSystem) -> Tangent:
        """Tangent with a displacement of its own; that of the correction stays."""
        displacement = correction.displacement.copy()
        tangent = self._tangent(state, system, TANGENT_DROP, TANGENT_ITERATIONS)
        tangent = replace(tangent, displacement=tangent.displacement.copy())
        correction.displacement[:] = displacement
        return tangent

    def _tangent(self, state: State, system: ContactSystem, *accuracy: Any) -> Tangent:
        """Tangent of the present contact, by an inner solve for a uniform residual."""
        size, nodes = self._problem.grid.size, system.contact_nodes
        residual = np.ones_like(system.residual)
        if nodes.size == size and self._problem.response.uniform_compliance == 0:
            # In full contact the load of a solid without uniform displacement changes at a fixed approach.
            pressure, displacement = residual, np.zeros(size, np.float32)
        else:
            uniform = replace(system, residual=residual, image=system.uniform_image.copy(), fixed_load=False)
            correction = self._inner.solve(uniform, *accuracy)
            state.iterations += correction.iterations
            pressure, displacement = correction.pressure, correction.displacement
        return Tangent(nodes, pressure, displacement, float(pressure.sum(dtype=float)) / size, self._unit)

    def _follow(self, tangent: Tangent, state: State, load: float) -> None:
        """Change the pressure along the tangent to a load; penetrating nodes join, nodes in tension leave.

        The displacement of the tangent is overwritten.
        """
        pressure, gap = state.pressure.reshape(-1), state.gap.reshape(-1)
        change = np.float32((load - state.load) / tangent.load)
        displacement = tangent.displacement
        displacement *= change
        approach = state.approach + self._unit * float(change)
        kernels.add_penetrating_nodes(pressure, gap, displacement, approach, self._unit, JOIN_STIFFNESS)
        kernels.add_and_release(pressure, tangent.contact_nodes, tangent.pressure, change)
