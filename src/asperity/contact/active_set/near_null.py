"""Correction of the mean displacement near full contact at a given approach.

A solid without uniform displacement is the softer for a pressure on the whole contact, the fewer nodes are
out of contact: in full contact it does not answer at all. The preconditioner, and with it the error estimate,
does not account for that. The pressure d that answers a uniform overlap of the contact is then a near-null
mode of the compliance. An error in proportion to d hides behind a small residual, and so does the effect of a
node that still penetrates: it stands for a pressure on that node, which displaces the contact by far more
than elsewhere.
"""

from __future__ import annotations

import numpy as np

from asperity.contact.active_set.assembly import ContactSystem
from asperity.contact.active_set.inner_solve import InnerSolver
from asperity.contact.active_set.iterate import Iterate, Pressure
from asperity.contact.compliance.vectors import field_of
from asperity.contact.problem import Problem
from asperity.core.types import Array

# The preconditioner accounts for the mean displacement if it makes the contact at most so many times stiffer
# against a uniform pressure than it is. Without this correction the error on rough surfaces of 256² nodes is
# below the tolerance where it makes the contact up to 20 times stiffer, and up to 66 tolerances beyond.
MAX_STIFFNESS_RATIO = 10.0


def balanced(
    iterate: Iterate, system: ContactSystem, inner: InnerSolver, tolerance: float
) -> tuple[Pressure | None, int]:
    """Pressure without its error along the near-null mode, and applications of the compliance.

    The pressure is None if that error is below a tolerance, relative to the norm of the pressure. Nodes that
    penetrate enter the contact, and plastic nodes with a gap are relieved.
    """
    nodes, unit, hardness = system.linear.operators.nodes, iterate.problem.unit, iterate.problem.hardness
    uniform = _displacement(iterate.problem, nodes, np.ones(nodes.size))
    compliance = float(uniform[nodes].sum(dtype=float))
    if MAX_STIFFNESS_RATIO * compliance * system.linear.operators.uniform_sum > nodes.size**2:
        return None, 1
    correction = inner.solve_uniform(system.linear.operators, drop=2e-3)
    direction = correction.pressure.astype(iterate.pressure.dtype)
    response = _displacement(iterate.problem, nodes, direction)
    work = 2 + correction.iterations
    curvature = float(np.dot(direction, response[nodes]))
    if not curvature > 0:
        return None, work
    pressure = iterate.pressure_field().reshape(-1)
    level = iterate.problem.height.reshape(-1) + iterate.displacement.reshape(-1)
    overlap = (system.approach - level) / unit
    entering = np.where(pressure == 0, np.maximum(overlap, 0), 0)
    entering += np.where(pressure >= hardness, np.minimum(overlap, 0), 0)
    change = float(np.dot(direction, overlap[nodes])) / curvature
    hidden = float(np.dot(np.abs(response), np.abs(entering))) / curvature
    error = (abs(change) + hidden) * float(np.linalg.norm(direction) / np.linalg.norm(iterate.pressure))
    if error <= tolerance:
        return None, work
    pressure += entering
    pressure[nodes] = np.clip(pressure[nodes] + change * direction, 0, hardness)
    return Pressure.of_field(pressure, iterate.load, iterate.reached_hardness), work


def _displacement(problem: Problem, nodes: Array, pressure: Array) -> Array:
    """Displacement of all nodes under pressures on some of them, in units of the nodal compliance."""
    field = field_of(problem.grid.shape, nodes, pressure.astype(problem.fourier.real, copy=False))
    return problem.response.displacement(field, field).reshape(-1) / problem.unit
