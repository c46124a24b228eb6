"""Compiled loops of the active-set solver, over all nodes or over the contact nodes.

Fields are flattened. `nodes` holds the sorted indices of the contact nodes in the flattened field; arrays of
that size belong to the contact nodes, one element each. Sums accumulate in double precision.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.compiled import compiled, makes_arrays, sums
from asperity.intrinsics import lowest_bit
from asperity.machine_code import discard_outdated

CHUNK = 32
"""Number of nodes that are compared with a level together."""

# The contact nodes and their gaps


@compiled
def spread(field: Any, nodes: Any, values: Any, start: int) -> None:
    """Write values on nodes of a part of a field, whose first node is `start`, and zero on all others."""
    field[:] = 0
    for k in range(nodes.size):
        field[nodes[k] - start] = values[k]


@compiled
def gaps(height: Any, displacement: Any, nodes: Any, out: Any) -> None:
    """Write the gap h + u of nodes."""
    for k in range(nodes.size):
        out[k] = height[nodes[k]] + displacement[nodes[k]]


@compiled
def pressure_less_gap(
    height: Any, nodes: Any, pressure: Any, start: int, approach: Any, stiffness: Any, displacement: Any
) -> None:
    """Replace the displacement u by the pressure less stiffness × u; on nodes under pressure u is δ − h.

    Of a part of the field, whose first node is `start`.
    """
    for i in range(displacement.size):
        displacement[i] *= -stiffness
    for k in range(nodes.size):
        i = nodes[k] - start
        displacement[i] = pressure[k] - stiffness * (approach - height[i])


@compiled
def subtract_gap(height: Any, approach: Any, stiffness: Any, pressure: Any) -> None:
    """Subtract stiffness × (h − δ) from a pressure."""
    for i in range(pressure.size):
        pressure[i] -= stiffness * (height[i] - approach)


@compiled
def write_from_datum(height: Any, datum: float, out: Any) -> None:
    """Write heights, measured from a datum, in the precision of `out`."""
    for i in range(height.size):
        out[i] = height[i] - datum


@compiled
def mark_free_nodes_below(
    height: Any, displacement: Any, nodes: Any, start: int, level: Any, free: Any
) -> int:
    """Mark the nodes of a part of a field that are out of contact and whose gap h + u is below a level.

    Parameters
    ----------
    height, displacement
        Of the part.
    nodes
        Contact nodes in it.
    start : int
        Its first node.
    level
    free : array of unsigned integers
        A bit for each node of the part is written, `CHUNK` in one number.

    Returns
    -------
    int
        Number of the nodes.
    """
    for c in range(free.size):
        h, u = height[c * CHUNK : (c + 1) * CHUNK], displacement[c * CHUNK : (c + 1) * CHUNK]
        below = np.int32(0)
        for i in range(h.size):
            below = np.int32(below | (np.int32(1 << i) if h[i] + u[i] < level else np.int32(0)))
        free[c] = below
    for k in range(nodes.size):
        node = np.uint32(nodes[k] - start)
        free[node // np.uint32(CHUNK)] &= ~(np.uint32(1) << (node % np.uint32(CHUNK)))
    count = 0
    for c in range(free.size):
        bits = free[c]
        while bits:
            bits &= bits - np.uint32(1)
            count += 1
    return count


@compiled
def write_marked(height: Any, displacement: Any, start: int, free: Any, nodes: Any, gap: Any) -> None:
    """Write the nodes that are marked in a part of a field, and their gaps h + u."""
    k = 0
    for c in range(free.size):
        bits = free[c]
        while bits:
            i = c * CHUNK + lowest_bit(bits)
            nodes[k], gap[k] = start + i, height[i] + displacement[i]
            bits &= bits - np.uint32(1)
            k += 1


@makes_arrays
def inserted(places: Any, values: Any, others: Any) -> Any:
    """Values with others inserted, which then have these places."""
    out = np.empty(values.size + others.size, values.dtype)
    first = 0
    for k in range(places.size + 1):
        place = places[k] if k < places.size else out.size
        for i in range(first, place):
            out[i] = values[i - k]
        if k < places.size:
            out[place] = others[k]
        first = place + 1
    return out


@compiled
def count_positive(values: Any) -> int:
    """Number of positive values."""
    count = 0
    for k in range(values.size):
        count += values[k] > 0
    return count


@compiled
def write_positive(field: Any, start: int, nodes: Any, values: Any) -> None:
    """Write the nodes where a part of a field is positive, whose first node is `start`, and its values."""
    k = 0
    for i in range(field.size):
        if field[i] > 0:
            nodes[k], values[k] = start + i, field[i]
            k += 1


@compiled
def write_nodes_under_pressure(
    nodes: Any, pressure: Any, gap: Any, nodes_left: Any, pressure_left: Any, gap_left: Any
) -> None:
    """Write the nodes with a positive pressure, with pressure and gap."""
    left = 0
    for k in range(pressure.size):
        if pressure[k] > 0:
            nodes_left[left], pressure_left[left], gap_left[left] = nodes[k], pressure[k], gap[k]
            left += 1


@sums
def squared_overlap(gap: Any, approach: float) -> float:
    """Sum of the squared overlaps δ − (h + u) of the nodes that penetrate."""
    total = 0.0
    for k in range(gap.size):
        overlap = approach - np.float64(gap[k])
        total += overlap * overlap if overlap > 0 else 0.0
    return total


@sums
def residual(gap: Any, approach: float, unit: float, out: Any) -> None:
    """Overlap δ − (h + u) of nodes, divided by `unit`."""
    for k in range(gap.size):
        out[k] = (approach - gap[k]) / unit


@sums
def weighted_sum(weight: Any, gap: Any, origin: float) -> float:
    """Weighted sum of gap − origin over the contact nodes."""
    total = 0.0
    for k in range(gap.size):
        total += np.float64(weight[k]) * (gap[k] - origin)
    return total


# Steps of the outer loop


@compiled
def add_and_release(pressure: Any, change: Any, joined: Any, fraction: Any, joins: Any, out: Any) -> None:
    """Write the pressure with a fraction of a change added; nodes in tension are released, to zero pressure.

    For joined nodes the fraction is `joins` instead.
    """
    for k in range(pressure.size):
        out[k] = max(pressure[k] + (joins if joined[k] else fraction) * change[k], 0.0)


@sums
def energy_along(
    pressure: Any, pressure_before: Any, gap: Any, gap_before: Any, approach: float
) -> tuple[float, float]:
    """Minus the slope of the energy at the start of a step of the pressure, and the curvature along it."""
    slope, curvature = 0.0, 0.0
    for i in range(pressure.size):
        change = np.float64(pressure[i]) - np.float64(pressure_before[i])
        slope -= change * (gap_before[i] - approach)
        curvature += change * (np.float64(gap[i]) - np.float64(gap_before[i]))
    return slope, curvature


# Vector operations of the conjugate gradients; `shift` × `weight` is subtracted from the preconditioned
# residual z, so that at a given load the corrections sum to zero


@sums
def added(a: Any) -> float:
    """Σ a."""
    total = 0.0
    for k in range(a.size):
        total += np.float64(a[k])
    return total


@sums
def dot(a: Any, b: Any) -> float:
    """Σ a b."""
    total = 0.0
    for k in range(a.size):
        total += np.float64(a[k]) * np.float64(b[k])
    return total


@sums
def sums_of_iteration(z: Any, weight: Any, residual: Any, response: Any) -> tuple[float, ...]:
    """Σ z, Σ z × residual, Σ weight × residual, Σ z × response and Σ weight × response."""
    total, product, uniform, change, uniform_change = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(z.size):
        image, w = np.float64(z[k]), np.float64(weight[k])
        r, y = np.float64(residual[k]), np.float64(response[k])
        total += image
        product += image * r
        uniform += w * r
        change += image * y
        uniform_change += w * y
    return total, product, uniform, change, uniform_change


@sums
def projected_square(z: Any, weight: Any, shift: float) -> float:
    """Σ (z − shift × weight)²."""
    total = 0.0
    for k in range(z.size):
        total += (z[k] - shift * weight[k]) ** 2
    return total


@compiled
def step_and_next_direction(
    x: Any, direction: Any, z: Any, weight: Any, length: Any, shift: Any, ratio: Any
) -> None:
    """Solution x ← x + length × d, then direction d ← z − shift × weight + ratio × d."""
    for k in range(x.size):
        d = direction[k]
        x[k] += length * d
        direction[k] = z[k] - shift * weight[k] + ratio * d


@compiled
def add_multiple(values: Any, others: Any, factor: Any) -> None:
    """Add factor × others to values."""
    for k in range(values.size):
        values[k] += factor * others[k]


@compiled
def less_multiple(values: Any, others: Any, factor: Any, out: Any) -> None:
    """Write values − factor × others to another array: in the same one, `add_multiple` is faster."""
    for k in range(values.size):
        out[k] = values[k] - factor * others[k]


# Of the result, for the certificate


@sums
def squared_deviation(values: Any, mean: float) -> float:
    """Σ (value − mean)²."""
    total = 0.0
    for i in range(values.size):
        total += (values[i] - mean) ** 2
    return total


@compiled
def write_gap(height: Any, displacement: Any, approach: Any, out: Any) -> None:
    """Write the gap h + u − δ."""
    for i in range(height.size):
        out[i] = (height[i] + displacement[i]) - approach


@compiled
def gap_of_contact(pressure: Any, height: Any, displacement: Any) -> tuple[float, int, float]:
    """Sum of h + u over the nodes under pressure, their number, and the sum of the pressure."""
    total_gap, count, total = 0.0, 0, 0.0
    for i in range(pressure.size):
        total += np.float64(pressure[i])
        if pressure[i] > 0:
            total_gap += np.float64(height[i] + displacement[i])
            count += 1
    return total_gap, count, total


@compiled
def measures_of_contact(pressure: Any, gap: Any) -> tuple[float, ...]:
    """Least p, least g, largest p, largest |g| of the contact, Σ p, Σ g, and Σ p |g| and Σ p of the contact.

    What is not a number in the fields makes Σ p or Σ g not a number either.
    """
    least, largest = pressure[0], pressure[0]
    least_gap, contact_gap = gap[0], 0.0
    total, total_gap, work, support = 0.0, 0.0, 0.0, 0.0
    for i in range(pressure.size):
        p, g = pressure[i], gap[i]
        total += p
        total_gap += g
        least, largest = min(least, p), max(largest, p)
        least_gap = min(least_gap, g)
        if p > 0:
            contact_gap = max(contact_gap, abs(g))
            work += p * abs(g)
            support += p
    return least, least_gap, largest, contact_gap, total, total_gap, work, support


discard_outdated(__name__)
