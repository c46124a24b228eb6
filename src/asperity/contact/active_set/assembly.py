"""Assembly of the linear system of the present contact, and estimate of the error of its pressure.

The solution p* of the contact problem and a pressure p differ by the pressure that removes what is wrong with
p: the residual on the contact nodes, the penetration of nodes without pressure, and the gap of plastic nodes,
those at the hardness. The error estimate is the norm of that pressure, as the preconditioner M gives it,
relative to the norm of p; a node that penetrates, or a plastic one with a gap, counts with that length over
the nodal compliance. Two lower bounds hold it up:

- A layer that is much stiffer than the half-space answers a residual by a much larger pressure than M, which
  is made for the half-space. There the norm of the pressure is used with which the whole layer, all nodes in
  contact, would remove the residual.
- The gap is known only to its rounding, which stands for a pressure of its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.contact.active_set.inner_solve import InnerSolver, Operators, System
from asperity.contact.active_set.iterate import HeldNodes, Iterate
from asperity.contact.compliance.vectors import added, dot, field_of
from asperity.contact.problem import Control, Problem
from asperity.core.compiled import sums
from asperity.core.parallel import total
from asperity.core.types import Array

# Lower bound of the rounding error of a level, as a fraction of the spacing of floating-point numbers.
ROUNDING_FRACTION = 0.1


@dataclass(frozen=True)
class ContactSystem:
    """The system of an iterate, and the error of its pressure.

    Attributes
    ----------
    linear : System
        For the correction of the pressure of the elastic nodes, those in contact below the hardness.
    elastic : slice or (count,) array
        Indices of these nodes in those of the iterate.
    plastic : (count,) array
        Indices of the plastic nodes, at the hardness.
    approach : float
        Imposed, or the one for which the first correction leaves the load as it is.
    error, rounding : float
        Estimated error of the pressure, and the part of it that is rounding, relative to its norm.
    bound : float
        Level h + u below which the nodes out of contact are known.
    held : HeldNodes
        These nodes, and the plastic ones.
    """

    linear: System
    elastic: Array | slice
    plastic: Array
    approach: float
    error: float
    rounding: float
    bound: float
    held: HeldNodes


def assemble(
    iterate: Iterate, control: Control, inner: InnerSolver, before: Operators | None = None
) -> ContactSystem:
    """Linear system of the elastic nodes of an iterate, and the estimated error of its pressure.

    Parameters
    ----------
    iterate : Iterate
    control : Control
    inner : InnerSolver
        Of the same grid.
    before : Operators, optional
        Those of the system before, which are kept if its elastic nodes are the same.
    """
    problem = iterate.problem
    elastic, plastic = iterate.elastic_and_plastic(control.fixes_load)
    level = iterate.level[elastic]
    operators = inner.operators(iterate.nodes[elastic], before)
    approach = control.value - problem.datum
    if control.fixes_load:
        approach = float(level[0])
        if operators.uniform_sum:
            weighted = total(_weighted_sum, problem.fourier.threads, operators.uniform, level, approach)
            approach += weighted / operators.uniform_sum
    residual = overlap_of(level, approach, problem.unit)
    system = System(operators, residual, operators.precondition(residual), control.fixes_load)
    # A correction moves no node upward by much more than the contact nodes are to move.
    bound = approach + 1.25 * problem.unit * max(0.0, -float(residual.min(initial=0)))
    held = iterate.held_nodes(bound, plastic)
    error, rounding = _error(iterate, system, held, approach, inner)
    return ContactSystem(system, elastic, plastic, approach, error, rounding, bound, held)


def overlap_of(level: Array, approach: float, unit: float) -> Array:
    """Overlap δ − (h + u) of nodes, divided by `unit`, in single precision."""
    return (np.subtract(approach, level, dtype=float) / unit).astype(np.float32)


def _error(
    iterate: Iterate, system: System, held: HeldNodes, approach: float, inner: InnerSolver
) -> tuple[float, float]:
    """Estimated error of the pressure, and the part of it that is rounding, relative to its norm."""
    problem, operators, threads = iterate.problem, system.operators, iterate.problem.fourier.threads
    norm = math.sqrt(total(dot, threads, iterate.pressure, iterate.pressure))
    shift = 0.0
    if system.has_free_approach:
        shift = total(added, threads, system.preconditioned) / operators.uniform_sum
    corrected = total(_projected_square, threads, system.preconditioned, operators.uniform, shift)
    penetration = np.maximum(held.side * (approach - held.level.astype(float)), 0) / problem.unit
    error = math.hypot(math.sqrt(corrected), float(np.linalg.norm(penetration)))
    if inner.layer_stiffness is not None:
        error = max(error, _response_of_layer(problem, system, inner.layer_stiffness))
    # Fewer gaps than contact nodes are uncertain if one of them is fixed by the approach.
    uncertain = max(operators.nodes.size - system.fixed_load, 0)
    rounding = _rounding_of_gap(iterate) / problem.unit * inner.nodal_stiffness * math.sqrt(uncertain)
    error = max(error, rounding)
    return (error / norm, rounding / norm) if norm else (math.inf if error else 0.0, 0.0)


def _rounding_of_gap(iterate: Iterate) -> float:
    """Rounding error of the gap of a node."""
    problem = iterate.problem
    mean_pressure = total(added, problem.fourier.threads, iterate.pressure) / problem.grid.size
    lowest, highest = problem.height_range
    # The uniform displacement of a tall layer may be far larger than the heights.
    largest = max(highest, -lowest) + problem.response.uniform_compliance * mean_pressure
    return ROUNDING_FRACTION * float(np.spacing(problem.height.dtype.type(largest)))


def _response_of_layer(problem: Problem, system: System, stiffness: Array) -> float:
    """Norm of the pressure with which the whole layer would remove the residual of the contact nodes."""
    fourier, nodes = problem.fourier, system.operators.nodes
    overlap = field_of(problem.grid.shape, nodes, system.residual.astype(fourier.real))
    coefficients = (fourier.forward(overlap) * stiffness).astype(fourier.complex)
    pressure = fourier.inverse(coefficients, overwrite=True).take(nodes)
    return float(np.linalg.norm(pressure - pressure.mean() if system.fixed_load else pressure))


@sums
def _weighted_sum(weight: Any, level: Any, origin: float) -> float:
    """Σ weight × (level − origin)."""
    total = 0.0
    for k in range(level.size):
        total += np.float64(weight[k]) * (level[k] - origin)
    return total


@sums
def _projected_square(z: Any, weight: Any, shift: float) -> float:
    """Σ (z − shift × weight)²."""
    total = 0.0
    for k in range(z.size):
        total += (z[k] - shift * weight[k]) ** 2
    return total
