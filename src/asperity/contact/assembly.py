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
from functools import cached_property

import numpy as np

from asperity.contact import kernels
from asperity.contact.inner_solve import ContactSystem
from asperity.contact.preconditioner import Preconditioner
from asperity.contact.problem import Problem, State
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
    preconditioner : Preconditioner
        Restricted to the contact nodes of each system that is assembled.
    """

    def __init__(self, problem: Problem, preconditioner: Preconditioner) -> None:
        self._problem = problem
        self._preconditioner = preconditioner
        self._unit = problem.nodal_compliance

    def assemble(self, state: State, fixed_load: bool) -> tuple[ContactSystem, float]:
        """Linear system of the nodes under pressure, and the estimated error of the pressure.

        With a fixed load the system refers to the approach for which the first correction leaves the load as
        it is, otherwise to the approach of the state. The state is not changed.
        """
        pressure, gap = state.pressure.reshape(-1), state.gap.reshape(-1)
        nodes = kernels.contact_nodes(pressure)
        self._preconditioner.restrict(nodes)
        uniform_image = self._preconditioner.apply_uniform()
        uniform_sum = float(uniform_image.sum(dtype=float))
        approach = state.approach
        if fixed_load and uniform_sum:
            approach = float(gap[nodes[0]])
            approach += kernels.weighted_mean(uniform_image, gap, nodes, approach)
        residual = kernels.residual(gap, nodes, approach, self._unit)
        image = np.empty_like(residual)
        self._preconditioner.apply(residual, image)
        system = ContactSystem(nodes, approach, residual, image, uniform_image, uniform_sum, fixed_load)
        return system, self._error(pressure, gap, system)

    def _error(self, pressure: Array, gap: Array, system: ContactSystem) -> float:
        """Estimated error of the pressure, relative to its norm."""
        mean_pressure, squares, penetration = kernels.pressure_sums(pressure, gap, system.approach)
        norm = math.sqrt(squares)
        shift = 0.0
        if system.has_free_approach:
            shift = float(system.image.sum(dtype=float)) / system.uniform_sum
        error = math.hypot(
            math.sqrt(kernels.projected_square(system.image, system.uniform_image, shift)),
            JOIN_STIFFNESS * math.sqrt(penetration) / self._unit,
        )
        if self._stiffness is not None:
            error = max(error, self._response_of_layer(system))
        # Fewer gaps than contact nodes are uncertain if one of them is fixed by the approach.
        uncertain = max(system.contact_nodes.size - system.fixed_load, 0)
        error = max(error, self._rounding(mean_pressure) * math.sqrt(uncertain))
        return error / norm if norm else (math.inf if error else 0.0)

    def _rounding(self, mean_pressure: float) -> float:
        """Pressure of a node that corresponds to the rounding error of its gap."""
        height, compliance = self._problem.height, self._problem.response.uniform_compliance
        # The uniform displacement of a tall layer may be far larger than the heights.
        largest = self._largest_height + compliance * mean_pressure
        spacing = float(np.spacing(height.dtype.type(largest)))
        return ROUNDING_FRACTION * spacing / self._unit * float(self._preconditioner.stencil[0, 0])

    def _response_of_layer(self, system: ContactSystem) -> float:
        """Norm of the pressure with which the whole layer would remove the residual of the contact nodes."""
        fourier, grid, nodes = self._problem.fourier, self._problem.grid, system.contact_nodes
        overlap = np.zeros(grid.size, fourier.real)
        overlap[nodes] = system.residual
        coefficients = fourier.forward(overlap.reshape(grid.shape)) * self._stiffness
        pressure = fourier.inverse(coefficients.astype(fourier.complex), overwrite=True).reshape(-1)[nodes]
        return float(np.linalg.norm(pressure - pressure.mean() if system.fixed_load else pressure))

    @cached_property
    def _largest_height(self) -> float:
        return float(np.abs(self._problem.height).max())

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
