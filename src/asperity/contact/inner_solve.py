"""The inner linear solve: preconditioned conjugate gradients on a fixed set of contact nodes.

On the contact nodes the correction x of the pressure solves G x = r, where G is the compliance restricted to
these nodes and r the overlap that is left. G is applied to a per cent, by a stencil and on a coarser grid
(`asperity.contact.inner_response`). The iteration is that of Polonsky & Keer (1999,
10.1016/S0043-1648(99)00113-1), who change the set of contact nodes in every iteration. Here, as in the
method of Moré & Toraldo (1991, 10.1137/0801008), it is fixed for a few iterations, so that the directions
stay conjugate.

At a given load the corrections sum to zero. For that, the multiple of M 1 that makes the sum vanish is
subtracted from the preconditioned residual M r; with M = 1 this is the mean that Polonsky & Keer subtract.
Directions are combined by the formula of Polak and Ribière, which tolerates that M is not quite the same in
every iteration (Notay 2000, 10.1137/S1064827599362314). New here is the preconditioner M
(`asperity.contact.preconditioner`), and that the solve runs in single precision: it computes a correction,
and the outer loop evaluates the gap anew in the precision of the fields.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asperity.contact import kernels
from asperity.contact.inner_response import InnerResponse
from asperity.contact.preconditioner import Preconditioner
from asperity.contact.problem import Problem
from asperity.parallel import apply, total
from asperity.types import Array

# The constants were found by trial, by the number of transforms. On rough surfaces of 512² nodes, halving or
# doubling any of them changes it by at most 5 %, under area control 11 %.

# An inner solve ends when the preconditioned norm of its residual has dropped by this factor, or after so
# many iterations. It is short, because the set of contact nodes still changes.
RESIDUAL_DROP = 0.05
MAX_ITERATIONS = 4

# If the error of the outer loop is above this fraction of the error before, the next inner solve may take so
# many iterations more than the last one, up to `MAX_ITERATIONS_FINAL`.
SLOW_CONVERGENCE = 0.8
ADDED_ITERATIONS = 2

# Below this error the set of contact nodes hardly changes any more, and inner solves are longer.
FINAL_ERROR = 2e-3
RESIDUAL_DROP_FINAL = 2e-3
MAX_ITERATIONS_FINAL = 9

# No inner solve aims at less than this fraction of the tolerance.
USEFUL_FRACTION = 0.3


@dataclass(frozen=True)
class ContactSystem:
    """Linear system for the correction of the pressure on a set of contact nodes.

    Residuals and displacements are in units of `Problem.nodal_compliance`, and so have the unit of a
    pressure.

    Attributes
    ----------
    contact_nodes : (count,) array of unsigned integers
        Indices in the flattened grid.
    residual : (count,) array
        Overlap r to be removed.
    image : (count,) array
        Its image M r under the preconditioner. `InnerSolver.solve` overwrites it.
    uniform_image : (count,) array
        Image M 1 of a uniform residual.
    uniform_sum : float
        Sum of the uniform image.
    fixed_load : bool
        True if the correction has to sum to zero.
    is_rounding : bool
        True if the residual is no larger than the rounding of the gap.
    """

    contact_nodes: Array
    residual: Array
    image: Array
    uniform_image: Array
    uniform_sum: float
    fixed_load: bool
    is_rounding: bool = False

    @property
    def has_free_approach(self) -> bool:
        """True if the approach follows from a given load."""
        return self.fixed_load and self.uniform_sum != 0


@dataclass(frozen=True)
class Correction:
    """Result of an inner solve.

    Attributes
    ----------
    pressure : (count,) array
        Change of the pressure of the contact nodes.
    displacement : (count,) array
        Its displacement of the contact nodes, in units of `Problem.nodal_compliance`, to the rounding of the
        residual.
    approach : float
        Change of the approach that goes with it, zero at a given approach.
    iterations : int
    """

    pressure: Array
    displacement: Array
    approach: float
    iterations: int


class InnerSolver:
    """Conjugate gradients for the systems of one grid, with their working space.

    Parameters
    ----------
    problem : Problem

    Attributes
    ----------
    response : InnerResponse
    preconditioner : Preconditioner
    """

    def __init__(self, problem: Problem) -> None:
        self._unit, self._threads = problem.nodal_compliance, problem.fourier.threads
        self.response = InnerResponse(problem)
        self.preconditioner = Preconditioner(problem, self.response.field)
        self._nodes: Array | None = None

    def restrict(self, nodes: Array) -> None:
        """Choose the contact nodes, by their sorted indices in the flattened grid."""
        if self._nodes is None or not np.array_equal(nodes, self._nodes):
            self.response.restrict(nodes)
            self.preconditioner.restrict(nodes)
            self._nodes = nodes

    def solve(
        self, system: ContactSystem, drop: float = RESIDUAL_DROP, max_iterations: int = MAX_ITERATIONS
    ) -> Correction:
        """Solve the system until the norm of its residual has dropped by a factor, or for some iterations.

        The norm is that of the preconditioner, √(r·M r). Overwrites the image of the system, whose nodes have
        to be those chosen last.
        """
        residual, z, threads = system.residual, system.image, self._threads
        weight, free = system.uniform_image, system.has_free_approach
        x, direction, response = (np.zeros_like(residual) for _ in range(3))
        left = np.empty_like(residual)
        length = np.float32(0)
        first = previous = math.nan
        iterations = 0
        while iterations < max_iterations:
            if iterations:
                self.preconditioner.apply(residual, z)
            sums = total(kernels.sums_of_iteration, threads, z, weight, residual, response)
            image_sum, product, uniform, change, uniform_change = sums
            shift = np.float32(image_sum / system.uniform_sum if free else 0)
            uniform_part = float(shift) * uniform
            product -= uniform_part
            if iterations == 0:
                first = product
            # Below its rounding the product is that of noise.
            rounding = float(np.finfo(np.float32).eps) * abs(uniform_part)
            if not product > max(drop**2 * first, rounding):
                break
            ratio = 0.0
            if iterations:
                # Polak and Ribière: z · (change of the residual) instead of z · residual.
                changed = -float(length) * (change - float(shift) * uniform_change)
                ratio = max(changed / previous, 0.0)
            factors = length, shift, np.float32(ratio)
            apply(kernels.step_and_next_direction, threads, x, direction, z, weight, *factors)
            length, previous = np.float32(0), product
            self.response.respond(direction, response)
            iterations += 1
            curvature = total(kernels.dot, threads, direction, response)
            if not curvature > 0:
                break
            length = np.float32(product / curvature)
            if iterations == 1:
                apply(kernels.less_multiple, threads, residual, response, length, left)
                residual = left
            else:
                apply(kernels.add_multiple, threads, residual, response, -length)
        if length:
            # The last step, which no next direction has followed.
            apply(kernels.add_multiple, threads, x, direction, length)
        # The part of the residual that is left which a change of the approach removes.
        excess = total(kernels.dot, threads, weight, residual) / system.uniform_sum if free else 0.0
        displacement = response
        apply(kernels.less_multiple, threads, system.residual, residual, np.float32(1), displacement)
        return Correction(x, displacement, -(self._unit * excess), iterations)


class InnerAccuracy:
    """Chooses how accurately the next system is solved, from the errors of the outer loop."""

    def __init__(self, tolerance: float) -> None:
        self._tolerance = tolerance
        self._error_before = math.inf
        self._max_iterations = MAX_ITERATIONS

    def next(self, error: float) -> tuple[float, int]:
        """Drop of the residual and largest number of iterations of the next solve, at an estimated error."""
        if error > FINAL_ERROR:
            slow = error > SLOW_CONVERGENCE * self._error_before
            lengthened = min(self._max_iterations + ADDED_ITERATIONS, MAX_ITERATIONS_FINAL)
            self._max_iterations = lengthened if slow else MAX_ITERATIONS
            drop = RESIDUAL_DROP
        else:
            self._max_iterations = MAX_ITERATIONS_FINAL
            drop = max(RESIDUAL_DROP_FINAL, USEFUL_FRACTION * self._tolerance / max(error, self._tolerance))
        self._error_before = error
        return drop, self._max_iterations
