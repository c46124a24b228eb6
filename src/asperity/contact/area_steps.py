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
from asperity.contact.closing import ClosingNodes
from asperity.contact.inner_solve import ContactSystem, Correction, InnerSolver
from asperity.contact.iterate import Iterate
from asperity.contact.problem import Problem
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

    def misses(self, iterate: Iterate, converged: bool) -> bool:
        """True if the area has to be changed before the pressure is corrected."""
        if not converged and (iterate.error > MAX_STEERED_ERROR or self._area.is_near(iterate)):
            return False
        return self._area.misses(iterate, converged)

    def steer(self, iterate: Iterate, system: ContactSystem, correction: Correction) -> Correction | None:
        """The correction extended by a change of the load, which the iterate takes; None if it can stay."""
        if not self._area.may_steer(iterate):
            return None
        nodes = system.contact_nodes
        closing = ClosingNodes.after(iterate, correction, self._inner.response, self._unit)
        remaining = int(np.count_nonzero(iterate.pressure + correction.pressure > 0))
        joining = int(np.count_nonzero(closing.overlap > 0))
        step = self._area.next_step(iterate, remaining + joining, nodes.size - remaining)
        if step is None:
            return None
        if self._kept is None or step.last_nodes:
            self._kept = self._tangent(iterate, system, TANGENT_DROP, TANGENT_ITERATIONS)
        tangent = self._kept.on(nodes, system.uniform_image)
        if not tangent.load > 0:
            return None
        load_change = step.load_change
        if step.last_nodes:
            load_change = step.refined(
                tangent.load * tangent.corrected_change(iterate, self._area, correction)
            )
        change = np.float32(load_change / tangent.load)
        iterate.load += load_change
        return replace(
            correction,
            pressure=correction.pressure + change * tangent.pressure,
            displacement=correction.displacement + change * tangent.displacement(),
            approach=correction.approach + self._unit * float(change),
        )

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

    def _tangent(self, iterate: Iterate, system: ContactSystem, *accuracy: Any) -> Tangent:
        """Tangent of the present contact, by an inner solve for a uniform residual."""
        size, nodes, response = self._problem.grid.size, system.contact_nodes, self._inner.response
        residual = np.ones_like(system.residual)
        # In full contact the load of a solid without uniform displacement changes at a fixed approach.
        displaces = nodes.size < size or self._problem.response.uniform_compliance != 0
        if displaces:
            uniform = replace(system, residual=residual, image=system.uniform_image.copy(), fixed_load=False)
            correction = self._inner.solve(uniform, *accuracy)
            iterate.iterations += correction.iterations
            residual = correction.pressure
        load = float(residual.sum(dtype=float)) / size
        return Tangent(nodes, residual, load, self._unit, response, displaces)

    def _follow(self, tangent: Tangent, iterate: Iterate, load: float) -> None:
        """Change the pressure along the tangent to a load; penetrating nodes join, nodes in tension leave."""
        change = np.float32((load - iterate.load) / tangent.load)
        approach = iterate.approach + self._unit * float(change)
        nodes, gap = iterate.free_nodes_below(max(approach, iterate.approach))
        overlap = kernels.residual(gap, approach, self._unit) - change * tangent.displacement_at(nodes)
        joins, real = overlap > 0, iterate.pressure.dtype
        pressure = kernels.add_and_release(iterate.pressure, tangent.pressure, change)
        joined = (JOIN_STIFFNESS * overlap[joins]).astype(real)
        iterate.set_pressure(*kernels.merge(iterate.nodes, nodes[joins], pressure, joined))
        iterate.drop_free_nodes()
