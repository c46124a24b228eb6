"""The iterate of the active-set solver: pressures on the contact nodes, and the gap that they cause.

The loop over the iterates is in `asperity.contact.active_set.outer_loop`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from asperity.contact.compliance.vectors import added, field_of, inserted
from asperity.contact.problem import Control, Problem
from asperity.core.compiled import compiled, makes_arrays
from asperity.core.parallel import STRIP, results_of, total
from asperity.core.types import Array

# The amount by which the pressures change together is found by Newton's method, which takes a few steps.
MAX_SHIFTS = 100
LOAD_ROUNDING = 1e-14


@dataclass(frozen=True)
class Pressure:
    """Pressures on a few nodes, zero on all others.

    Those of plastic nodes may exceed the hardness, by what their overlap stands for.

    Attributes
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened grid.
    values : (count,) array
        Non-negative.
    load : float
        Mean pressure to which they are scaled at a given load.
    reached_hardness : bool
        True if one was at the hardness in an iterate before.
    """

    nodes: Array
    values: Array
    load: float
    reached_hardness: bool = False

    @classmethod
    def of_field(cls, field: Array, load: float, reached_hardness: bool = False) -> Pressure:
        """The positive values of a field [y, x]."""
        nodes = np.flatnonzero(field > 0).astype(np.uint32)
        return cls(nodes, field.reshape(-1)[nodes], load, reached_hardness)


@dataclass(frozen=True)
class Iterate:
    """Pressures on the contact nodes, and the gap that they cause on a grid.

    Attributes
    ----------
    problem : Problem
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened grid.
    pressure : (count,) array
    load, reached_hardness
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
    reached_hardness: bool

    def without_free_nodes(self) -> Iterate:
        """The same without the nodes that bear no pressure."""
        left = self.pressure > 0
        if left.all():
            return self
        return replace(self, nodes=self.nodes[left], pressure=self.pressure[left], level=self.level[left])

    def elastic_and_plastic(self, fixed_load: bool) -> tuple[Array | slice, Array]:
        """Indices in `nodes` of pressures below the hardness, and of those at it.

        At a given load one node has to fix the approach: the plastic one with the least overlap, if all are
        plastic.
        """
        if not self.reached_hardness:
            return slice(None), np.empty(0, np.int64)
        plastic = self.pressure >= self.problem.hardness
        if fixed_load and plastic.all():
            plastic[np.argmax(self.level)] = False
        return np.flatnonzero(~plastic), np.flatnonzero(plastic)

    def held_nodes(self, bound: float, plastic: Array) -> HeldNodes:
        """Nodes out of contact with a level below a bound, and the plastic ones."""
        nodes, level = self._free_nodes_below(bound)
        own, sides = self.nodes[plastic], np.ones(nodes.size + plastic.size, np.float32)
        at = np.searchsorted(nodes, own)
        sides[at + np.arange(plastic.size)] = -1
        return HeldNodes(inserted(nodes, at, own), inserted(level, at, self.level[plastic]), sides)

    def _free_nodes_below(self, bound: float) -> tuple[Array, Array]:
        """Sorted nodes out of contact with a level below a bound, and their levels."""
        height, displacement = self.problem.height.reshape(-1), self.displacement.reshape(-1)
        real_bound = height.dtype.type(bound)

        def found_in(start: int) -> tuple[Array, Array]:
            part = slice(start, start + STRIP)
            edges = np.array((part.start, part.stop), np.uint32)
            contact_nodes = self.nodes[slice(*np.searchsorted(self.nodes, edges))]
            return _free_below(height[part], displacement[part], contact_nodes, start, real_bound)

        tasks = [partial(found_in, start) for start in range(0, height.size, STRIP)]
        nodes, levels = zip(*results_of(tasks, self.problem.fourier.threads), strict=True)
        return np.concatenate(nodes), np.concatenate(levels)

    def pressure_field(self) -> Array:
        """Pressure [y, x] of all nodes."""
        return field_of(self.problem.grid.shape, self.nodes, self.pressure)

    def refined(self, approach: float, finer: Problem, load: float) -> Pressure:
        """Start for a finer grid: the interpolated pressure less the interpolated gap / nodal compliance.

        Outside the contact, where an interpolated pressure may not vanish, the gap is positive: subtracting
        it before negative values are set to zero keeps those nodes free. The gap that is left at elastic
        nodes is not subtracted: where it varies over long distances, it stands for a far smaller pressure.
        The overlap of plastic nodes is added, which keeps them at the hardness.
        """
        real = finer.height.dtype.type
        stiffness, level = real(1 / finer.unit), real(approach)
        field = self.displacement * -stiffness
        displaced = level - self.problem.height.reshape(-1)[self.nodes]
        if self.reached_hardness:
            plastic = self.pressure >= self.problem.hardness
            displaced[plastic] = self.displacement.reshape(-1)[self.nodes[plastic]]
        field.reshape(-1)[self.nodes] = self.pressure - stiffness * displaced
        out = self.problem.response.interpolated(field, finer.response)
        out -= stiffness * (finer.height - level)
        return Pressure.of_field(out, load, self.reached_hardness)


class HeldNodes(NamedTuple):
    """Nodes whose pressure is at its lower bound, zero, or at its upper bound, the hardness.

    Parameters
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened grid.
    level : (count,) array
        As in `Iterate`.
    side : (count,) array
        1 at zero pressure, −1 at the hardness. Overlap × side > 0 is against the conditions of contact.
    """

    nodes: Array
    level: Array
    side: Array


def evaluate(problem: Problem, control: Control, start: Pressure) -> Iterate:
    """Iterate of a pressure, after scaling it to its load, or to the least energy at a given approach.

    At a given load, the node that touches first bears a pressure that has vanished everywhere. No pressure
    exceeds the hardness.
    """
    nodes, values = start.nodes, start.values.astype(problem.fourier.real, copy=False)
    hardness, reached = problem.hardness, start.reached_hardness
    load = min(start.load, hardness)  # of which control by area may ask for more
    is_plastic = False
    if hardness < math.inf and values.size:
        plastic = start.values >= start.values.dtype.type(hardness)
        is_plastic = bool(plastic.any())
        bounded = np.where(plastic, values.dtype.type(hardness), values)
        values = np.maximum(values, bounded) if control.fixes_load else bounded
    if control.fixes_load:
        mean = total(added, problem.fourier.threads, values) / problem.grid.size
        if not mean > 0:
            nodes = np.array([np.argmin(problem.height)], np.uint32)
            values, mean = np.ones(1, values.dtype), 1 / problem.grid.size
        scaled = values * (load / mean)
        if is_plastic or (hardness < math.inf and scaled.max() > hardness):
            nodes, scaled = with_load(problem, nodes, values, load)
        values = scaled
    field = field_of(problem.grid.shape, nodes, values)
    displacement = problem.response.displacement(field, field)
    if not control.fixes_load:
        pressure = values.astype(float, copy=False)
        overlap = control.value - problem.datum - problem.height.reshape(-1)[nodes]
        work = float(pressure @ overlap)
        energy = float(pressure @ displacement.reshape(-1)[nodes])
        if work > 0 and energy > 0 and not is_plastic:
            factor = min(work / energy, hardness / values.max())
            values = values * factor
            displacement *= factor
    level = np.empty_like(values)
    _write_levels(problem.height.reshape(-1), displacement.reshape(-1), nodes, level)
    if hardness < math.inf and values.size:
        reached |= is_plastic or bool(values.max() >= hardness)
    return Iterate(problem, nodes, values, load, level, displacement, reached)


def with_load(problem: Problem, nodes: Array, values: Array, load: float) -> tuple[Array, Array]:
    """Nodes and pressures of a given mean: values less a common amount, between zero and the hardness.

    A change of the approach does that to nodes far apart: the energy falls along the way. Nodes without
    pressure, and then the lowest of the surface, bear what the others cannot at the hardness.
    """
    hardness, wanted = problem.hardness, float(load) * problem.grid.size
    rounding = 4 * float(np.finfo(values.dtype).eps)
    needed = math.ceil(wanted / hardness * (1 - rounding))
    if needed > nodes.size:
        heights = problem.height.reshape(-1).copy()
        heights[nodes] = np.inf
        missing = needed - nodes.size
        lowest = np.sort(np.argpartition(heights, missing - 1)[:missing])
        at = np.searchsorted(nodes, lowest)
        nodes, values = np.insert(nodes, at, lowest), np.insert(values, at, 0)
    given, released = values.astype(float), values <= 0
    if needed <= np.count_nonzero(values):
        given[released] = -math.inf
    low, high = float(given.min(where=given > -math.inf, initial=hardness)) - hardness, float(given.max())
    shift, pressure = 0.0, np.clip(given, 0, hardness)
    for _ in range(MAX_SHIFTS):
        excess = float(pressure.sum()) - wanted
        if abs(excess) <= LOAD_ROUNDING * wanted:
            break
        low, high = (shift, high) if excess > 0 else (low, shift)
        elastic = np.count_nonzero((pressure > 0) & (pressure < hardness))
        shift += excess / elastic if elastic else math.inf
        if not low < shift < high:
            shift = 0.5 * (low + high)
        pressure = np.clip(given - shift, 0, hardness)
    pressure = pressure.astype(values.dtype)
    return nodes, np.where(pressure < hardness * (1 - rounding), pressure, values.dtype.type(hardness))


@compiled
def _write_levels(height: Any, displacement: Any, nodes: Any, out: Any) -> None:
    """Write the level h + u of nodes."""
    for k in range(nodes.size):
        out[k] = height[nodes[k]] + displacement[nodes[k]]


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
