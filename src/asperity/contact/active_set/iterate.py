"""The iterate of the active-set solver: pressures on the contact nodes, and the gap that they cause.

The loop over the iterates is in `asperity.contact.active_set.outer_loop`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from asperity.contact.compliance.vectors import added, field_of, within
from asperity.contact.problem import Control, Problem
from asperity.core.compiled import compiled, makes_arrays
from asperity.core.parallel import STRIP, apply, in_parts, results_of, total
from asperity.core.types import Array


@dataclass(frozen=True)
class Pressure:
    """Pressures on a few nodes, zero on all others.

    Attributes
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened grid.
    values : (count,) array
        Non-negative.
    load : float
        Mean pressure to which they are scaled at a given load.
    """

    nodes: Array
    values: Array
    load: float

    @classmethod
    def of_field(cls, field: Array, load: float) -> Pressure:
        """The positive values of a field [y, x]."""
        nodes = np.flatnonzero(field > 0).astype(np.uint32)
        return cls(nodes, field.reshape(-1)[nodes], load)


@dataclass(frozen=True)
class Iterate:
    """Pressures on the contact nodes, and the gap that they cause on a grid.

    Attributes
    ----------
    problem : Problem
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened grid.
    pressure : (count,) array
    load : float
        As in `Pressure`.
    level : (count,) array
        h + u of the nodes: the approach at which a node just touches.
    displacement : (ny, nx) array
    """

    problem: Problem
    nodes: Array
    pressure: Array
    load: float
    level: Array
    displacement: Array

    def without_free_nodes(self) -> Iterate:
        """The same without the nodes that bear no pressure."""
        left = np.flatnonzero(self.pressure > 0)
        if left.size == self.nodes.size:
            return self
        return replace(self, nodes=self.nodes[left], pressure=self.pressure[left], level=self.level[left])

    def free_nodes_below(self, bound: float) -> tuple[Array, Array]:
        """Sorted nodes out of contact with a level below a bound, and their levels."""
        height, displacement = self.problem.height.reshape(-1), self.displacement.reshape(-1)
        real_bound = height.dtype.type(bound)

        def found_in(start: int) -> tuple[Array, Array]:
            part = slice(start, start + STRIP)
            contact_nodes = self.nodes[within(self.nodes, part)]
            return _free_below(height[part], displacement[part], contact_nodes, start, real_bound)

        tasks = [partial(found_in, start) for start in range(0, height.size, STRIP)]
        nodes, levels = zip(*results_of(tasks, self.problem.fourier.threads), strict=True)
        return np.concatenate(nodes), np.concatenate(levels)

    def pressure_field(self) -> Array:
        """Pressure [y, x] of all nodes."""
        threads = self.problem.fourier.threads
        return field_of(self.problem.grid.shape, self.nodes, self.pressure, threads)

    def refined(self, approach: float, finer: Problem, load: float) -> Pressure:
        """Start for a finer grid: the interpolated pressure less the interpolated gap / nodal compliance.

        Outside the contact, where an interpolated pressure may not vanish, the gap is positive: subtracting
        it before negative values are set to zero keeps those nodes free. The gap that is left at contact
        nodes is not subtracted: where it varies over long distances, it stands for a far smaller pressure.
        """
        real = finer.height.dtype.type
        stiffness, level = real(1 / finer.unit), real(approach)
        field = self.displacement * -stiffness
        heights = self.problem.height.reshape(-1)[self.nodes]
        field.reshape(-1)[self.nodes] = self.pressure - stiffness * (level - heights)
        out = self.problem.response.interpolated(field, finer.response)
        threads = finer.fourier.threads
        apply(_subtract_gap, threads, finer.height.reshape(-1), level, stiffness, out.reshape(-1))
        return Pressure.of_field(out, load)


def evaluate(problem: Problem, control: Control, start: Pressure) -> Iterate:
    """Iterate of a pressure, after scaling it to its load, or to the least energy at a given approach.

    At a given load, the node that touches first bears a pressure that has vanished everywhere.
    """
    nodes, values = start.nodes, start.values.astype(problem.fourier.real, copy=False)
    if control.fixes_load:
        mean = total(added, problem.fourier.threads, values) / problem.grid.size
        if not mean > 0:
            nodes = np.array([np.argmin(problem.height)], np.uint32)
            values, mean = np.ones(1, values.dtype), 1 / problem.grid.size
        values = values * (start.load / mean)
    field = field_of(problem.grid.shape, nodes, values, problem.fourier.threads)
    displacement = problem.response.displacement(field, field)
    if not control.fixes_load:
        pressure = values.astype(float, copy=False)
        overlap = control.value - problem.datum - problem.height.reshape(-1)[nodes]
        work = float(pressure @ overlap)
        energy = float(pressure @ displacement.reshape(-1)[nodes])
        if work > 0 and energy > 0:
            values = values * (work / energy)
            displacement *= work / energy
    level = np.empty_like(values)
    fields = problem.height.reshape(-1), displacement.reshape(-1)
    in_parts(
        lambda part: _write_levels(*fields, nodes[part], level[part]), nodes.size, problem.fourier.threads
    )
    return Iterate(problem, nodes, values, start.load, level, displacement)


@compiled
def _write_levels(height: Any, displacement: Any, nodes: Any, out: Any) -> None:
    """Write the level h + u of nodes."""
    for k in range(nodes.size):
        out[k] = height[nodes[k]] + displacement[nodes[k]]


@compiled
def _subtract_gap(height: Any, approach: Any, stiffness: Any, pressure: Any) -> None:
    """Subtract stiffness × (h − δ) from a pressure."""
    for i in range(pressure.size):
        pressure[i] -= stiffness * (height[i] - approach)


@makes_arrays
def _free_below(height: Any, displacement: Any, contact_nodes: Any, start: int, bound: Any) -> Any:
    """Nodes of a part of a field out of contact with a level h + u below a bound, and their levels."""
    nodes, levels = np.empty(height.size, np.uint32), np.empty(height.size, height.dtype)
    found, k = 0, 0
    for i in range(height.size):
        level = height[i] + displacement[i]
        if level < bound:
            while k < contact_nodes.size and contact_nodes[k] < start + i:
                k += 1
            if k == contact_nodes.size or contact_nodes[k] != start + i:
                nodes[found], levels[found] = start + i, level
                found += 1
    return nodes[:found].copy(), levels[:found].copy()
