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
from functools import cached_property
from typing import Any

import numpy as np

from asperity.contact.active_set.inner_solve import InnerSolver, Operators, System
from asperity.contact.active_set.iterate import HeldNodes, Iterate
from asperity.contact.compliance.response import Response
from asperity.contact.compliance.vectors import added, dot
from asperity.contact.problem import Control
from asperity.core.compiled import compiled, sums
from asperity.core.parallel import apply, total
from asperity.core.types import Array

# A layer uses its own stiffness in the error estimate if it is more than so many times stiffer than the
# half-space in some mode. Below, the estimate by the preconditioner is too small by at most this factor.
STIFF_LAYER = 2.0

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


class Assembler:
    """Assembles the linear systems of one grid.

    Parameters
    ----------
    response : Response
        In any precision.
    inner : InnerSolver
    """

    def __init__(self, response: Response, inner: InnerSolver) -> None:
        self._response = response
        self._inner = inner
        self._unit, self._threads = response.nodal_compliance, response.fourier.threads

    def assemble(self, iterate: Iterate, control: Control, before: Operators | None = None) -> ContactSystem:
        """Linear system of the elastic nodes, and the estimated error of the pressure."""
        elastic, plastic = iterate.elastic_and_plastic(control.fixes_load)
        level, unit = iterate.level[elastic], self._unit
        operators = self._inner.operators(iterate.nodes[elastic], before)
        approach = control.value - iterate.problem.datum
        if control.fixes_load:
            approach = float(level[0])
            if operators.uniform_sum:
                weighted = total(_weighted_sum, self._threads, operators.uniform, level, approach)
                approach += weighted / operators.uniform_sum
        residual = np.empty(level.size, np.float32)
        apply(write_overlap, self._threads, level, approach, unit, residual)
        system = System(operators, residual, operators.precondition(residual), control.fixes_load)
        # A correction moves no node upward by much more than the contact nodes are to move.
        bound = approach + 1.25 * unit * max(0.0, -float(residual.min(initial=0)))
        held = iterate.held_nodes(bound, plastic)
        error, rounding = self._error(iterate, system, held, approach)
        return ContactSystem(system, elastic, plastic, approach, error, rounding, bound, held)

    def _error(
        self, iterate: Iterate, system: System, held: HeldNodes, approach: float
    ) -> tuple[float, float]:
        """Estimated error of the pressure, and the part of it that is rounding, relative to its norm."""
        operators, threads = system.operators, self._threads
        norm = math.sqrt(total(dot, threads, iterate.pressure, iterate.pressure))
        shift = 0.0
        if system.has_free_approach:
            shift = total(added, threads, system.preconditioned) / operators.uniform_sum
        corrected = total(_projected_square, threads, system.preconditioned, operators.uniform, shift)
        penetration = np.maximum(held.side * (approach - held.level.astype(float)), 0) / self._unit
        error = math.hypot(math.sqrt(corrected), float(np.linalg.norm(penetration)))
        if self._stiffness is not None:
            error = max(error, self._response_of_layer(iterate, system))
        # Fewer gaps than contact nodes are uncertain if one of them is fixed by the approach.
        uncertain = max(operators.nodes.size - system.fixed_load, 0)
        rounding = self._rounding(iterate) * math.sqrt(uncertain)
        error = max(error, rounding)
        return (error / norm, rounding / norm) if norm else (math.inf if error else 0.0, 0.0)

    def _rounding(self, iterate: Iterate) -> float:
        """Pressure of a node that corresponds to the rounding error of its gap."""
        problem = iterate.problem
        mean_pressure = total(added, self._threads, iterate.pressure) / problem.grid.size
        lowest, highest = problem.height_range
        # The uniform displacement of a tall layer may be far larger than the heights.
        largest = max(highest, -lowest) + problem.response.uniform_compliance * mean_pressure
        spacing = float(np.spacing(problem.height.dtype.type(largest)))
        return ROUNDING_FRACTION * spacing / self._unit * self._inner.nodal_stiffness

    def _response_of_layer(self, iterate: Iterate, system: System) -> float:
        """Norm of the pressure with which the whole layer would remove the residual of the contact nodes."""
        fourier, grid, nodes = iterate.problem.fourier, iterate.problem.grid, system.operators.nodes
        overlap = np.zeros(grid.size, fourier.real)
        overlap[nodes] = system.residual
        coefficients = fourier.forward(overlap.reshape(grid.shape)) * self._stiffness
        pressure = fourier.inverse(coefficients.astype(fourier.complex), overwrite=True).reshape(-1)[nodes]
        return float(np.linalg.norm(pressure - pressure.mean() if system.fixed_load else pressure))

    @cached_property
    def _stiffness(self) -> Array | None:
        """Stiffness of the modes times the nodal compliance; None unless far above the half-space's."""
        response = self._response
        if response.solid.height is None:
            return None
        q, compliance = response.grid.wavenumber(), response.compliance
        waves = q > 0
        softest = 2 / response.solid.effective_modulus
        if np.all(softest < STIFF_LAYER * (q * compliance)[waves]):
            return None
        out = np.zeros(compliance.shape)
        return np.divide(self._unit, compliance, out=out, where=compliance > 0)


@compiled
def write_overlap(level: Any, approach: float, unit: float, out: Any) -> None:
    """Write the overlap δ − (h + u) of nodes, divided by `unit`."""
    for k in range(level.size):
        out[k] = (approach - level[k]) / unit


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
