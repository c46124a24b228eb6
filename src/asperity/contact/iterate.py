"""The iterate of the active-set solver: pressures on the contact nodes, and the displacement of all nodes."""

from __future__ import annotations

import math

import numpy as np

from asperity.contact import kernels
from asperity.contact.problem import Control, Problem, State
from asperity.types import Array


class Iterate:
    """Pressures on a few nodes, and the displacement of the surface under them.

    Parameters
    ----------
    problem : Problem
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened grid.
    pressure : (count,) array
        On the nodes, non-negative; it is zero on all others.
    approach, load : float
        As in `State`.

    Attributes
    ----------
    gap : (count,) array
        h + u of the nodes at the last evaluation, without the approach.
    displacement : (ny, nx) array
        u at the last evaluation.
    is_evaluated : bool
        True if gap and displacement are those of the pressure.
    error, iterations
        As in `State`.
    """

    def __init__(
        self, problem: Problem, nodes: Array, pressure: Array, approach: float, load: float
    ) -> None:
        self._problem = problem
        self._height = problem.height.reshape(-1)
        self.nodes, self.pressure = nodes, pressure
        self.gap = np.empty_like(pressure)
        self.displacement = np.empty(problem.grid.shape, problem.fourier.real)
        self.approach, self.load = approach, load
        self.error, self.iterations = math.inf, 0
        self.is_evaluated = False
        self._forget_gaps()

    @classmethod
    def of_field(cls, problem: Problem, pressure: Array, approach: float, load: float) -> Iterate:
        """Iterate of a pressure [y, x] on all nodes; negative values are set to zero."""
        flat = pressure.reshape(-1)
        nodes = np.flatnonzero(flat > 0).astype(np.uint32)
        return cls(problem, nodes, flat[nodes].astype(problem.fourier.real), approach, load)

    def evaluate(self, control: Control) -> None:
        """Evaluate the gap, after scaling the pressure to the load, or to the least energy at an approach."""
        if control.fixes_load:
            self.pressure *= self.load / (float(self.pressure.sum(dtype=float)) / self._height.size)
        field = self.displacement
        kernels.spread(field.reshape(-1), self.nodes, self.pressure)
        self._problem.displacement(field, field)
        self.iterations += 1
        if not control.fixes_load:
            self._scale_to_least_energy(control.value)
        self.gap = kernels.gaps(self._height, field.reshape(-1), self.nodes)
        self._forget_gaps()
        self.is_evaluated = True

    def _scale_to_least_energy(self, approach: float) -> None:
        pressure = self.pressure.astype(float)
        work = float(pressure @ (approach - self._height[self.nodes]))
        energy = float(pressure @ self.displacement.reshape(-1)[self.nodes])
        if work > 0 and energy > 0:
            self.pressure *= work / energy
            self.displacement *= work / energy

    def set_pressure(self, nodes: Array, pressure: Array) -> None:
        """Change the nodes and the pressures on them; the gap has to be evaluated anew."""
        self.nodes, self.pressure = nodes, pressure
        self.is_evaluated = False

    def start_at_lowest_node(self) -> None:
        """Put the whole pressure on the node that touches first."""
        self.set_pressure(np.array([np.argmin(self._height)], np.uint32), np.ones(1, self._height.dtype))

    def drop_free_nodes(self) -> None:
        """Leave out the nodes without pressure."""
        contact = self.pressure > 0
        if not contact.all():
            self.nodes, self.pressure = self.nodes[contact], self.pressure[contact]
            if self.is_evaluated:
                self.gap = self.gap[contact]

    def free_nodes_below(self, level: float, reserve: float = 0.0) -> tuple[Array, Array]:
        """Sorted nodes out of contact with a gap below a level, and their gaps.

        Nodes up to `reserve` above the level are kept for the next call, and may be returned as well.
        """
        if self._near is None or self._near[0] < level:
            if self._least_gaps is None:
                self._least_gaps = kernels.least_gaps(*self.fields())
            bound = self._height.dtype.type(level + reserve)
            near = kernels.free_nodes_below(*self.fields(), self.nodes, self._least_gaps, bound)
            self._near = (level + reserve, *near)
        return self._near[1:]

    def _forget_gaps(self) -> None:
        self._near: tuple[float, Array, Array] | None = None
        self._least_gaps: Array | None = None

    def add_displacement(self, change: Array) -> None:
        """Add a change to the displacement of all nodes, that of a change of the pressure."""
        self.displacement += change.reshape(self.displacement.shape)
        self.gap = kernels.gaps(self._height, self.displacement.reshape(-1), self.nodes)
        self._forget_gaps()

    def fields(self) -> tuple[Array, Array]:
        """Height and displacement of all nodes, flattened."""
        return self._height, self.displacement.reshape(-1)

    def pressure_field(self) -> Array:
        """Pressure [y, x] of all nodes."""
        field = np.empty(self.displacement.shape, self.pressure.dtype)
        kernels.spread(field.reshape(-1), self.nodes, self.pressure)
        return field

    def state(self, mean_compliance: float = 0.0) -> State:
        """The fields of the iterate on the whole grid.

        `mean_compliance` is the mean displacement per unit of the mean pressure that the response left out.
        """
        displacement, approach = self.displacement, self.approach
        if mean_compliance:
            mean = mean_compliance * self.load
            displacement += displacement.dtype.type(mean)
            approach += mean
        return State(
            self.pressure_field(),
            approach,
            self.load,
            self.error,
            self.iterations,
            displacement if self.is_evaluated else None,
        )
