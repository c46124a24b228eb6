"""The iterate of the active-set solver: pressures on the contact nodes, and the displacement of all nodes."""

from __future__ import annotations

import math

import numpy as np

from asperity.contact import kernels
from asperity.contact.problem import Control, Problem, State
from asperity.parallel import apply, in_parts, select, total
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
    expected_motion : float
        By which gaps are expected to close in the next step, 0 if that is not known.
    error, iterations
        As in `State`.
    """

    def __init__(self, problem: Problem, nodes: Array, pressure: Array, approach: float, load: float) -> None:
        self._problem = problem
        self._height = problem.height.reshape(-1)
        self._threads = problem.fourier.threads
        self.nodes, self.pressure = nodes, pressure
        self.gap = np.empty_like(pressure)
        self.displacement = np.empty(problem.grid.shape, problem.fourier.real)
        self.approach, self.load = approach, load
        self.error, self.iterations = math.inf, 0
        self.is_evaluated = False
        self.expected_motion = 0.0
        self._near: tuple[float, Array, Array] | None = None

    @classmethod
    def of_field(cls, problem: Problem, pressure: Array, approach: float, load: float) -> Iterate:
        """Iterate of a pressure [y, x] on all nodes; negative values are set to zero."""
        flat = pressure.reshape(-1)
        nodes, values = select(
            lambda part: kernels.count_positive(flat[part]),
            lambda part, *chosen: kernels.write_positive(flat[part], part.start, *chosen),
            flat.size,
            problem.fourier.threads,
            (np.uint32, problem.fourier.real),
        )
        return cls(problem, nodes, values, approach, load)

    @property
    def mean_pressure(self) -> float:
        """Mean over all nodes."""
        return total(kernels.added, self._threads, self.pressure) / self._height.size

    def evaluate(self, control: Control) -> None:
        """Evaluate the gap, after scaling the pressure to the load, or to the least energy at an approach."""
        if control.fixes_load:
            self.pressure *= self.load / self.mean_pressure
        field = self.displacement
        self._spread_pressure(field.reshape(-1))
        self._problem.displacement(field, field)
        self.iterations += 1
        if not control.fixes_load:
            self._scale_to_least_energy(control.value)
        self._gather_gaps()
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
        gap = self.gap if self.is_evaluated else self.pressure
        fields = self.nodes, self.pressure, gap
        self.nodes, self.pressure, self.gap = select(
            lambda part: kernels.count_positive(fields[1][part]),
            lambda part, *left: kernels.write_nodes_under_pressure(*(one[part] for one in fields), *left),
            self.nodes.size,
            self._threads,
            [one.dtype for one in fields],
        )

    def free_nodes_below(self, level: float, reserve: float = 0.0) -> tuple[Array, Array]:
        """Sorted nodes out of contact with a gap below a level, and their gaps.

        Nodes up to `reserve` above the level are kept for the next call, and may be returned as well.
        """
        if self._near is None or self._near[0] < level:
            nodes, gap = self._free_nodes_below(level + reserve)
            self._near = level + reserve, nodes, gap
        return self._near[1:]

    def _free_nodes_below(self, level: float) -> tuple[Array, ...]:
        height, displacement = self.fields()
        bound = height.dtype.type(level)
        free = np.empty(-(-height.size // kernels.CHUNK), np.uint32)

        def marks(part: slice) -> Array:
            return free[part.start // kernels.CHUNK : -(-part.stop // kernels.CHUNK)]

        def mark(part: slice) -> int:
            fields = height[part], displacement[part]
            contact_nodes = self.nodes[self._within(part)]
            return kernels.mark_free_nodes_below(*fields, contact_nodes, part.start, bound, marks(part))

        def write(part: slice, *found: Array) -> None:
            kernels.write_marked(height[part], displacement[part], part.start, marks(part), *found)

        return select(mark, write, height.size, self._threads, (np.uint32, height.dtype), kernels.CHUNK)

    def _within(self, part: slice) -> slice:
        """Where the nodes within a part of the flattened field stand."""
        return slice(*np.searchsorted(self.nodes, np.array((part.start, part.stop), np.uint32)))

    def _spread_pressure(self, field: Array) -> None:
        """Write the pressure of all nodes into a flattened field."""

        def spread(part: slice) -> None:
            within = self._within(part)
            kernels.spread(field[part], self.nodes[within], self.pressure[within], part.start)

        in_parts(spread, field.size, self._threads)

    def _gather_gaps(self) -> None:
        """Gap of the nodes; what is known of other gaps is forgotten."""
        self.gap = np.empty_like(self.pressure)
        height, displacement = self.fields()

        def gather(part: slice) -> None:
            kernels.gaps(height, displacement, self.nodes[part], self.gap[part])

        in_parts(gather, self.nodes.size, self._threads)
        self._near = None

    def refined(self, finer: Problem, load: float) -> Iterate:
        """Start for a finer grid: the interpolated pressure less the interpolated gap / nodal compliance.

        Outside the contact, where an interpolated pressure may not vanish, the gap is positive: subtracting
        it before negative values are set to zero keeps those nodes free. The gap that is left at contact
        nodes is not subtracted: where it varies over long distances, it stands for a far smaller pressure.
        """
        if not self.is_evaluated:
            field = self.pressure_field()
            self.displacement = self._problem.displacement(field, field)
        real = finer.height.dtype.type
        stiffness, approach = real(finer.modulus / min(finer.grid.spacing)), real(self.approach)
        self.drop_free_nodes()
        flat = self.displacement.reshape(-1)

        def subtract_gap(part: slice) -> None:
            within = self._within(part)
            contact = self.nodes[within], self.pressure[within], part.start
            kernels.pressure_less_gap(self._height[part], *contact, approach, stiffness, flat[part])

        in_parts(subtract_gap, flat.size, self._threads)
        out = self._problem.response.interpolated(self.displacement, finer.response)
        heights = finer.height.reshape(-1)
        apply(kernels.subtract_gap, self._threads, heights, approach, stiffness, out.reshape(-1))
        start = Iterate.of_field(finer, out, self.approach, load)
        start.iterations = self.iterations
        return start

    def fields(self) -> tuple[Array, Array]:
        """Height and displacement of all nodes, flattened."""
        return self._height, self.displacement.reshape(-1)

    def pressure_field(self) -> Array:
        """Pressure [y, x] of all nodes."""
        field = np.empty(self.displacement.shape, self.pressure.dtype)
        self._spread_pressure(field.reshape(-1))
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
