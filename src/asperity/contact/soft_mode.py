"""Correction of the mean displacement near full contact at a given approach.

A solid without uniform displacement is the softer for a pressure on the whole contact, the fewer nodes are
out of contact: in full contact it does not answer at all. The preconditioner, and with it the error estimate,
does not account for that. The pressure d that answers a uniform overlap of the contact is then far softer
than all others. An error in proportion to d hides behind a small residual, and so does the effect of a node
that still penetrates: it stands for a pressure on that node, which displaces the contact by far more than
elsewhere.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asperity.contact.assembly import JOIN_STIFFNESS
from asperity.contact.inner_solve import (
    MAX_ITERATIONS_FINAL,
    RESIDUAL_DROP_FINAL,
    ContactSystem,
    InnerSolver,
)
from asperity.contact.problem import Problem, State
from asperity.types import Array

# The preconditioner accounts for the mean displacement if it makes the contact at most so many times stiffer
# against a uniform pressure than it is. Without this correction the error on rough surfaces of 256² nodes is
# below the tolerance where it makes the contact up to 20 times stiffer, and up to 66 tolerances beyond.
KNOWN_SOFTNESS = 10.0


class SoftMode:
    """Finds and removes the error along the softest pressure on the contact.

    Parameters
    ----------
    problem : Problem
    inner : InnerSolver
    """

    def __init__(self, problem: Problem, inner: InnerSolver) -> None:
        self._problem = problem
        self._inner = inner
        self._unit = problem.nodal_compliance

    def balance(self, state: State, system: ContactSystem, tolerance: float) -> bool:
        """Remove the error along the softest pressure if it exceeds a tolerance; True if it did.

        The tolerance is relative to the norm of the pressure. Nodes that penetrate join the contact.
        """
        pressure, nodes = state.pressure.reshape(-1), system.contact_nodes
        uniform = np.zeros_like(pressure)
        uniform[nodes] = 1
        compliance = float(self._respond(uniform, state)[nodes].sum(dtype=float))
        if KNOWN_SOFTNESS * compliance * system.uniform_sum > nodes.size**2:
            return False
        direction = self._softest(state, system)
        response = self._respond(direction, state)
        curvature = float(np.dot(direction, response))
        if not curvature > 0:
            return False
        overlap = (state.approach - state.gap.reshape(-1)) / self._unit
        joining = np.where(pressure == 0, np.maximum(overlap, 0), 0)
        change = float(np.dot(direction, overlap)) / curvature
        hidden = float(np.dot(np.abs(response), joining)) / curvature
        error = (abs(change) + hidden) * float(np.linalg.norm(direction) / np.linalg.norm(pressure))
        if error <= tolerance:
            return False
        state.error = error
        pressure += JOIN_STIFFNESS * joining
        pressure[nodes] = np.maximum(pressure[nodes] + change * direction[nodes], 0)
        return True

    def _softest(self, state: State, system: ContactSystem) -> Array:
        """Pressure that answers a uniform overlap of the contact nodes, on all nodes of the grid."""
        uniform = replace(
            system,
            residual=np.ones_like(system.residual),
            image=system.uniform_image.copy(),
            fixed_load=False,
        )
        correction = self._inner.solve(uniform, RESIDUAL_DROP_FINAL, MAX_ITERATIONS_FINAL)
        state.iterations += correction.iterations
        direction = np.zeros_like(state.pressure.reshape(-1))
        direction[system.contact_nodes] = correction.pressure
        return direction

    def _respond(self, pressure: Array, state: State) -> Array:
        """Displacement under a pressure, in units of `Problem.nodal_compliance`, in full precision."""
        displacement = self._problem.displacement(pressure.reshape(self._problem.grid.shape)).reshape(-1)
        state.iterations += 1
        return displacement / self._unit
