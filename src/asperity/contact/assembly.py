"""Assembly of the linear system of the present contact, and estimate of the error of its pressure.

The solution p* of the contact problem and a pressure p differ by the pressure that removes what is wrong with
p: the residual on the contact nodes, and the penetration of nodes without pressure. The error estimate is the
norm of that pressure, as the preconditioner M gives it, relative to the norm of p. Two lower bounds hold it
up:

- A layer that is much stiffer than the half-space answers a residual by a much larger pressure than M, which
  is made for the half-space. There the norm of the pressure is used with which the whole layer, all nodes in
  contact, would remove the residual.
- The gap is known only to its rounding, which stands for a pressure of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from asperity.contact import kernels
from asperity.contact.inner_solve import ContactSystem, InnerSolver
from asperity.contact.iterate import Iterate
from asperity.contact.problem import Problem
from asperity.parallel import apply, total
from asperity.types import Array

# Pressure of a node that joins the contact, in units of its penetration / nodal compliance. The error
# estimate counts penetrations by the same measure. Found by trial on rough surfaces of 512² nodes: values
# from 0.25 to 1 take the same number of transforms to 2 %, 2 takes 7 % and 4 takes 13 % more.
JOIN_STIFFNESS = 1.0

# A layer uses its own stiffness in the error estimate if it is more than so many times stiffer than the
# half-space in some mode. Below, the estimate by the preconditioner is too small by at most this factor.
STIFF_LAYER = 2.0

# Lower bound of the rounding error of a gap, as a fraction of the spacing of floating-point numbers.
ROUNDING_FRACTION = 0.1


class Assembler:
    """Assembles the linear systems of one grid.

    Parameters
    ----------
    problem : Problem
    inner : InnerSolver
        Restricted to the contact nodes of each system that is assembled.
    """

    def __init__(self, problem: Problem, inner: InnerSolver) -> None:
        self._problem = problem
        self._inner = inner
        self._unit = problem.nodal_compliance

    def assemble(self, iterate: Iterate, fixed_load: bool) -> ContactSystem:
        """Linear system of the nodes under pressure, and the estimated error of the pressure.

        With a fixed load the approach of the iterate becomes the one for which the first correction leaves
        the load as it is. The error of the iterate is set.
        """
        gap, nodes = iterate.gap, iterate.nodes
        self._inner.restrict(nodes)
        preconditioner = self._inner.preconditioner
        uniform_image = preconditioner.apply_uniform()
        uniform_sum = self._total(kernels.added, uniform_image)
        if fixed_load and uniform_sum:
            iterate.approach = float(gap[0])
            weighted = self._total(kernels.weighted_sum, uniform_image, gap, iterate.approach)
            iterate.approach += weighted / uniform_sum
        residual = np.empty(gap.size, np.float32)
        apply(kernels.residual, self._problem.fourier.threads, gap, iterate.approach, self._unit, residual)
        image = np.empty_like(residual)
        preconditioner.apply(residual, image)
        system = ContactSystem(nodes, residual, image, uniform_image, uniform_sum, fixed_load)
        iterate.error, rounding = self._error(iterate, system)
        return replace(system, is_rounding=iterate.error <= rounding)

    def _error(self, iterate: Iterate, system: ContactSystem) -> tuple[float, float]:
        """Estimated error of the pressure, and the part of it that is rounding, relative to its norm."""
        norm = math.sqrt(self._total(kernels.dot, iterate.pressure, iterate.pressure))
        shift = 0.0
        if system.has_free_approach:
            shift = self._total(kernels.added, system.image) / system.uniform_sum
        _, gap_of_free = iterate.free_nodes_below(iterate.approach, reserve=iterate.expected_motion)
        penetration = math.sqrt(self._total(kernels.squared_overlap, gap_of_free, iterate.approach))
        error = math.hypot(
            math.sqrt(self._total(kernels.projected_square, system.image, system.uniform_image, shift)),
            JOIN_STIFFNESS * penetration / self._unit,
        )
        if self._stiffness is not None:
            error = max(error, self._response_of_layer(system))
        # Fewer gaps than contact nodes are uncertain if one of them is fixed by the approach.
        uncertain = max(system.contact_nodes.size - system.fixed_load, 0)
        mean_pressure = self._total(kernels.added, iterate.pressure) / self._problem.grid.size
        rounding = self._rounding(mean_pressure) * math.sqrt(uncertain)
        error = max(error, rounding)
        return (error / norm, rounding / norm) if norm else (math.inf if error else 0.0, 0.0)

    def _total(self, function: Callable[..., float], *arguments: Any) -> float:
        return total(function, self._problem.fourier.threads, *arguments)

    def _rounding(self, mean_pressure: float) -> float:
        """Pressure of a node that corresponds to the rounding error of its gap."""
        height, compliance = self._problem.height, self._problem.response.uniform_compliance
        # The uniform displacement of a tall layer may be far larger than the heights.
        largest = self._problem.largest_height + compliance * mean_pressure
        spacing = float(np.spacing(height.dtype.type(largest)))
        return ROUNDING_FRACTION * spacing / self._unit * self._inner.preconditioner.nodal_stiffness

    def _response_of_layer(self, system: ContactSystem) -> float:
        """Norm of the pressure with which the whole layer would remove the residual of the contact nodes."""
        fourier, grid, nodes = self._problem.fourier, self._problem.grid, system.contact_nodes
        overlap = np.zeros(grid.size, fourier.real)
        overlap[nodes] = system.residual
        coefficients = fourier.forward(overlap.reshape(grid.shape)) * self._stiffness
        pressure = fourier.inverse(coefficients.astype(fourier.complex), overwrite=True).reshape(-1)[nodes]
        return float(np.linalg.norm(pressure - pressure.mean() if system.fixed_load else pressure))

    @cached_property
    def _stiffness(self) -> Array | None:
        """Stiffness of the modes times the nodal compliance; None unless far above the half-space's."""
        problem = self._problem
        if problem.solid.height is None:
            return None
        q, compliance = problem.grid.wavenumber(), problem.compliance
        waves = q > 0
        if np.all(2 / problem.modulus < STIFF_LAYER * (q * compliance)[waves]):
            return None
        out = np.zeros(compliance.shape)
        return np.divide(self._unit, compliance, out=out, where=compliance > 0)
