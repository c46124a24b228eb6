"""The inner linear solve: preconditioned conjugate gradients on a fixed set of contact nodes.

On the contact nodes the correction x of the pressure solves G x = r, where G is the compliance restricted to
these nodes and r the remaining overlap. G is applied to a per cent, by a stencil and on a coarser grid
(`asperity.contact.operators`). The iteration is due to Polonsky & Keer (1999, 10.1016/S0043-1648(99)00113-1),
who change the set of contact nodes in every iteration. Here, as in the method of Moré & Toraldo (1991,
10.1137/0801008), it is fixed for a few iterations, so that the directions stay conjugate.

At a given load the corrections sum to zero. For that, the multiple of M 1 that makes the sum vanish is
subtracted from the preconditioned residual M r; with M = 1 this is the mean that Polonsky & Keer subtract.
Directions are combined by the formula of Polak and Ribière, which tolerates that M is not quite the same in
every iteration (Notay 2000, 10.1137/S1064827599362314). New here is the preconditioner M
(`asperity.contact.operators`), and that the solve runs in single precision: it computes a
correction, and the outer loop evaluates the gap anew in the precision of the fields.
"""

from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.contact.contact_nodes import StencilProduct, add_multiple, dot
from asperity.contact.operators import InnerResponse, Operators, Preconditioner
from asperity.contact.response import Response
from asperity.core.compiled import compiled, vectorised_sums
from asperity.core.parallel import apply, sum_parts
from asperity.core.types import Array

# An inner solve ends when the preconditioned norm of its residual has dropped by this factor, or after so
# many iterations. It is short, because the set of contact nodes still changes.
RESIDUAL_DROP = 0.05
MAX_ITERATIONS = 9

# A layer uses its own stiffness in the error estimate if it is more than so many times stiffer than the
# half-space in some mode. For a softer layer the preconditioner underestimates the error by at most this
# factor.
STIFF_LAYER = 2.0


@dataclass(frozen=True)
class System:
    """Linear system for the correction of the pressure on the contact nodes.

    Attributes
    ----------
    operators : Operators
    residual : (count,) array
        Overlap r to be removed.
    preconditioned : (count,) array
        Pressures M r.
    fixed_load : bool
        True if the correction has to sum to zero.
    """

    operators: Operators
    residual: Array
    preconditioned: Array
    fixed_load: bool

    @property
    def has_free_approach(self) -> bool:
        """True if the approach follows from a given load."""
        return self.fixed_load and self.operators.uniform_sum != 0


@dataclass(frozen=True)
class Correction:
    """Result of an inner solve.

    Attributes
    ----------
    pressure : (count,) array
        Change of the pressure of the contact nodes.
    displacement : (count,) array
        Its displacement of the contact nodes, to the rounding of the residual.
    approach : float
        Change of the approach with it, zero at a given approach.
    iterations : int
    """

    pressure: Array
    displacement: Array
    approach: float
    iterations: int


class InnerSolver:
    """Conjugate gradients for the systems of one grid.

    Parameters
    ----------
    response : Response
        In any precision.
    divided : bool
        As of `asperity.contact.operators.InnerResponse`.

    Attributes
    ----------
    nodal_stiffness : float
        Pressure that removes a unit residual of a node that alone is in contact.
    layer_stiffness : (ny, nx // 2 + 1) array or None
        Stiffness of the modes times the nodal compliance; None unless far above the half-space's.
    """

    def __init__(self, response: Response, divided: bool = True) -> None:
        self._unit, self._threads = response.nodal_compliance, response.fourier.threads
        products = StencilProduct(response.grid, response.free, self._threads)
        self._response = InnerResponse(response, products, divided)
        self._preconditioner = Preconditioner(response, products)
        self.nodal_stiffness = self._preconditioner.nodal_stiffness
        self.layer_stiffness = None
        if response.solid.height is not None:
            q, compliance = response.grid.wavenumber(), response.compliance
            softest = 2 / response.solid.effective_modulus
            if not np.all(softest < STIFF_LAYER * (q * compliance)[q > 0]):
                out = np.zeros(compliance.shape)
                np.divide(response.nodal_compliance, compliance, out=out, where=compliance > 0)
                self.layer_stiffness = out

    def with_response(self, response: InnerResponse) -> "InnerSolver":
        """The solver with other displacements."""
        other = copy(self)
        other._response, other.layer_stiffness = response, None
        return other

    def operators(self, nodes: Array, before: Operators | None = None) -> Operators:
        """Operators on contact nodes; the operators before if the nodes are the same."""
        if before is not None and before.response is self._response and np.array_equal(nodes, before.nodes):
            return before
        return Operators(nodes, self._response, self._preconditioner)

    def solve_uniform(
        self, operators: Operators, drop: float = RESIDUAL_DROP, max_iterations: int = MAX_ITERATIONS
    ) -> Correction:
        """Correction that removes a uniform overlap of the contact nodes at a given approach."""
        ones = np.ones(operators.nodes.size, np.float32)
        return self.solve(System(operators, ones, operators.uniform, fixed_load=False), drop, max_iterations)

    def solve(
        self, system: System, drop: float = RESIDUAL_DROP, max_iterations: int = MAX_ITERATIONS
    ) -> Correction:
        """Solve a system until the norm of its residual has dropped by a factor, or for some iterations.

        The norm is √(r·M r), with the preconditioner M.
        """
        operators, threads, free = system.operators, self._threads, system.has_free_approach
        residual, z, weight = system.residual.copy(), system.preconditioned, operators.uniform
        x, direction, response = (np.zeros_like(residual) for _ in range(3))
        length, level = np.float32(0), 0.0
        first = previous = np.nan
        iterations = 0
        while iterations < max_iterations:
            if iterations:
                z = operators.precondition(residual)
            sums = sum_parts(_sums_of_iteration, threads, z, weight, residual, response)
            z_sum, product, uniform, change, uniform_change = sums
            shift = np.float32(z_sum / operators.uniform_sum if free else 0)
            uniform_part = float(shift) * uniform
            product -= uniform_part
            if iterations == 0:
                first = product
            # A product below its rounding error is noise.
            rounding = float(np.finfo(np.float32).eps) * abs(uniform_part)
            if not product > max(drop**2 * first, rounding):
                break
            ratio = 0.0
            if iterations:
                # Polak and Ribière: z · (change of the residual) instead of z · residual.
                changed = -float(length) * (change - float(shift) * uniform_change)
                ratio = max(changed / previous, 0.0)
            factors = length, shift, np.float32(ratio)
            apply(_step_and_next_direction, threads, x, direction, z, weight, *factors)
            length, previous = np.float32(0), product
            response = operators.displacement(direction)
            iterations += 1
            curvature = sum_parts(dot, threads, direction, response)
            if not curvature > 0:
                break
            length = np.float32(product / curvature)
            # Without its level, which the approach removes, the residual keeps its digits.
            apply(_reduce, threads, residual, response, length, shift)
            level += float(shift)
        if length:
            # The last step, which no next direction has followed.
            apply(add_multiple, threads, x, direction, length)
        # The part of the remaining residual that a change of the approach removes.
        excess = level + sum_parts(dot, threads, weight, residual) / operators.uniform_sum if free else 0.0
        displacement = system.residual - residual
        displacement -= np.float32(level)
        return Correction(x, displacement, -(self._unit * excess), iterations)


# Loops of the conjugate gradients; `shift` × `weight` is subtracted from the preconditioned residual z, so
# that at a given load the corrections sum to zero.


@vectorised_sums
def _sums_of_iteration(z: Any, weight: Any, residual: Any, response: Any) -> tuple[float, ...]:
    """Σ z, Σ z × residual, Σ weight × residual, Σ z × response and Σ weight × response."""
    total, product, uniform, change, uniform_change = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(z.size):
        zk, w = np.float64(z[k]), np.float64(weight[k])
        r, y = np.float64(residual[k]), np.float64(response[k])
        total += zk
        product += zk * r
        uniform += w * r
        change += zk * y
        uniform_change += w * y
    return total, product, uniform, change, uniform_change


@compiled
def _reduce(residual: Any, response: Any, length: Any, level: Any) -> None:
    """Subtract length × response + level from the residual."""
    for k in range(residual.size):
        residual[k] -= length * response[k] + level


@compiled
def _step_and_next_direction(
    x: Any, direction: Any, z: Any, weight: Any, length: Any, shift: Any, ratio: Any
) -> None:
    """Solution x ← x + length × d, then direction d ← z − shift × weight + ratio × d."""
    for k in range(x.size):
        d = direction[k]
        x[k] += length * d
        direction[k] = z[k] - shift * weight[k] + ratio * d
