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

from asperity.contact import kernels
from asperity.contact.assembly import JOIN_STIFFNESS
from asperity.contact.inner_solve import (
    MAX_ITERATIONS_FINAL,
    RESIDUAL_DROP_FINAL,
    ContactSystem,
    InnerSolver,
)
from asperity.contact.iterate import Iterate
from asperity.contact.problem import Problem
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

    def balance(self, iterate: Iterate, system: ContactSystem, tolerance: float) -> bool:
        """Remove the error along the softest pressure if it exceeds a tolerance; True if it did.

        The tolerance is relative to the norm of the pressure. Nodes that penetrate join the contact.
        """
        nodes, size = iterate.nodes, self._problem.grid.size
        uniform = self._respond(np.ones(nodes.size), iterate)
        compliance = float(uniform[nodes].sum(dtype=float))
        if KNOWN_SOFTNESS * compliance * system.uniform_sum > nodes.size**2:
            return False
        direction = self._softest(iterate, system)
        response = self._respond(direction, iterate)
        curvature = float(np.dot(direction, response[nodes]))
        if not curvature > 0:
            return False
        pressure = np.zeros(size, iterate.pressure.dtype)
        kernels.spread(pressure, nodes, iterate.pressure, 0)
        height, displacement = iterate.fields()
        overlap = (iterate.approach - (height + displacement)) / self._unit
        joining = np.where(pressure == 0, np.maximum(overlap, 0), 0)
        change = float(np.dot(direction, overlap[nodes])) / curvature
        hidden = float(np.dot(np.abs(response), joining)) / curvature
        error = (abs(change) + hidden) * float(np.linalg.norm(direction) / np.linalg.norm(iterate.pressure))
        if error <= tolerance:
            return False
        iterate.error = error
        pressure += JOIN_STIFFNESS * joining
        pressure[nodes] = np.maximum(pressure[nodes] + change * direction, 0)
        contact = np.flatnonzero(pressure > 0).astype(np.uint32)
        iterate.set_pressure(contact, pressure[contact])
        return True

    def _softest(self, iterate: Iterate, system: ContactSystem) -> Array:
        """Pressure that answers a uniform overlap of the contact nodes."""
        uniform = replace(
            system,
            residual=np.ones_like(system.residual),
            image=system.uniform_image.copy(),
            fixed_load=False,
        )
        correction = self._inner.solve(uniform, RESIDUAL_DROP_FINAL, MAX_ITERATIONS_FINAL)
        iterate.iterations += correction.iterations
        return correction.pressure.astype(iterate.pressure.dtype)

    def _respond(self, pressure: Array, iterate: Iterate) -> Array:
        """Displacement of all nodes under a pressure, in units of `Problem.nodal_compliance`."""
        field = np.empty(self._problem.grid.shape, self._problem.fourier.real)
        kernels.spread(field.reshape(-1), iterate.nodes, pressure, 0)
        iterate.iterations += 1
        return self._problem.displacement(field, field).reshape(-1) / self._unit
