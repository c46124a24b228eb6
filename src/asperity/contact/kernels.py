"""Compiled loops of the active-set solver, over all nodes or over the contact nodes.

Fields are flattened. `nodes` holds the indices of the contact nodes in the flattened field; arrays of that
size belong to the contact nodes, one element each. Sums accumulate in double precision.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

# The contact nodes and their forces


@njit(cache=True, error_model="numpy")
def contact_nodes(pressure: Any) -> Any:
    """Indices of the nodes with positive pressure."""
    count = 0
    for i in range(pressure.size):
        if pressure[i] > 0:
            count += 1
    # Unsigned: with signed indices the compiler adds a check for negative ones to every access.
    nodes = np.empty(count, np.uint64)
    count = 0
    for i in range(pressure.size):
        if pressure[i] > 0:
            nodes[count] = i
            count += 1
    return nodes


@njit(cache=True, error_model="numpy")
def pressure_sums(pressure: Any, gap: Any, approach: float) -> tuple[float, float, float]:
    """Mean pressure, sum of squared pressures, and sum of squared penetrations of nodes without pressure."""
    total, squares, penetration = 0.0, 0.0, 0.0
    for i in range(pressure.size):
        if pressure[i] > 0:
            total += pressure[i]
            squares += pressure[i] * pressure[i]
        elif gap[i] < approach:
            penetration += (approach - gap[i]) ** 2
    return total / pressure.size, squares, penetration


@njit(cache=True, error_model="numpy")
def residual(gap: Any, nodes: Any, approach: float, unit: float) -> Any:
    """Overlap δ − (h + u) of the contact nodes, divided by `unit`."""
    out = np.empty(nodes.size, np.float32)
    for k in range(nodes.size):
        out[k] = (approach - gap[nodes[k]]) / unit
    return out


@njit(cache=True, error_model="numpy")
def weighted_mean(weight: Any, gap: Any, nodes: Any, origin: float) -> float:
    """Weighted mean of gap − origin over the contact nodes."""
    total, norm = 0.0, 0.0
    for k in range(nodes.size):
        total += weight[k] * (gap[nodes[k]] - origin)
        norm += weight[k]
    return total / norm


@njit(cache=True, error_model="numpy")
def add_penetrating_nodes(
    pressure: Any, gap: Any, displacement: Any, approach: float, unit: float, stiffness: float
) -> None:
    """Give nodes without pressure that would penetrate a pressure of `stiffness` × penetration / `unit`.

    `displacement`, in units of `unit`, is that of the correction about to be added to the pressure.
    """
    for i in range(pressure.size):
        if pressure[i] == 0:
            overlap = (approach - gap[i]) / unit - displacement[i]
            if overlap > 0:
                pressure[i] = stiffness * overlap


@njit(cache=True, error_model="numpy")
def add_and_release(pressure: Any, nodes: Any, change: Any, fraction: Any) -> None:
    """Add a fraction of a change to the contact nodes; nodes in tension are released, to zero pressure."""
    for k in range(nodes.size):
        pressure[nodes[k]] = max(pressure[nodes[k]] + fraction * change[k], 0.0)


@njit(cache=True, error_model="numpy")
def add(pressure: Any, nodes: Any, change: Any) -> None:
    """Add a change to the contact nodes, of which some may come to be in tension."""
    for k in range(nodes.size):
        pressure[nodes[k]] += change[k]


@njit(cache=True, error_model="numpy")
def closing_changes(gap: Any, approach: float, unit: float, displacement: Any, response: Any) -> Any:
    """Change of the approach, divided by `unit`, at which the gap of each node closes.

    `displacement` is that of a correction about to be added, and `response` the change of the displacement
    per change of the approach, both divided by `unit`.
    """
    changes = np.empty(gap.size, np.float32)
    for i in range(gap.size):
        closing = 1 - response[i]
        changes[i] = ((gap[i] - approach) / unit + displacement[i]) / closing if closing > 0 else np.inf
    return changes


@njit(cache=True, error_model="numpy")
def set_release_changes(changes: Any, pressure: Any, nodes: Any, correction: Any, rate: Any) -> None:
    """Replace the changes of the contact nodes by those at which their pressure becomes zero.

    `rate` is the change of the pressure per change of the approach.
    """
    for k in range(nodes.size):
        corrected = pressure[nodes[k]] + correction[k]
        changes[nodes[k]] = -corrected / rate[k] if rate[k] > 0 else (-np.inf if corrected > 0 else np.inf)


@njit(cache=True, error_model="numpy")
def touching_nodes(
    pressure: Any, gap: Any, nodes: Any, correction: Any, displacement: Any, approach: float, unit: float
) -> tuple[int, int]:
    """Numbers of contact nodes that a correction leaves under pressure, and of nodes whose gap it closes."""
    remaining, joining = 0, 0
    for k in range(nodes.size):
        if pressure[nodes[k]] + correction[k] > 0:
            remaining += 1
    for i in range(pressure.size):
        if pressure[i] == 0 and (approach - gap[i]) / unit > displacement[i]:
            joining += 1
    return remaining, joining


# Minimum of the energy


@njit(cache=True, error_model="numpy")
def line_search(pressure: Any, pressure_before: Any, gap: Any, gap_before: Any, approach: float) -> float:
    """Fraction, between 0 and 1, of a step of the pressure at which the energy is least."""
    slope, curvature = 0.0, 0.0
    for i in range(pressure.size):
        change = pressure[i] - pressure_before[i]
        slope -= change * (gap_before[i] - approach)
        curvature += change * (gap[i] - gap_before[i])
    return min(max(slope / curvature, 0.0), 1.0) if curvature > 0 else 1.0


@njit(cache=True, error_model="numpy")
def interpolate(values: Any, before: Any, fraction: float) -> None:
    """Replace values by those at a fraction of the way from `before`."""
    for i in range(values.size):
        values[i] = before[i] + fraction * (values[i] - before[i])


@njit(cache=True, error_model="numpy")
def energy_scale(pressure: Any, displacement: Any, height: Any, approach: float) -> float:
    """Factor of a pressure, and so of its displacement, at which the energy is least at an approach."""
    work, energy = 0.0, 0.0
    for i in range(pressure.size):
        work += pressure[i] * (approach - height[i])
        energy += pressure[i] * displacement[i]
    return work / energy if energy > 0 and work > 0 else 1.0


@njit(cache=True, error_model="numpy")
def scale_to_gap(pressure: Any, displacement: Any, height: Any, factor: float) -> None:
    """Multiply a pressure and its displacement by a factor, and add the height to the displacement."""
    for i in range(pressure.size):
        pressure[i] *= factor
        displacement[i] = factor * displacement[i] + height[i]


# Vector operations of the conjugate gradients; `shift` × `weight` is subtracted from the preconditioned
# residual z, so that at a given load the corrections sum to zero


@njit(cache=True, error_model="numpy")
def dot(a: Any, b: Any) -> float:
    """Σ a b."""
    total = 0.0
    for k in range(a.size):
        total += a[k] * b[k]
    return total


@njit(cache=True, error_model="numpy")
def sum_and_dot(a: Any, b: Any) -> tuple[float, float]:
    """Σ a and Σ a b."""
    total, product = 0.0, 0.0
    for k in range(a.size):
        total += a[k]
        product += a[k] * b[k]
    return total, product


@njit(cache=True, error_model="numpy")
def dot_on_contact(a: Any, field: Any, nodes: Any) -> float:
    """Σ a field over the contact nodes."""
    total = 0.0
    for k in range(nodes.size):
        total += a[k] * field[nodes[k]]
    return total


@njit(cache=True, error_model="numpy")
def projected_square(z: Any, weight: Any, shift: float) -> float:
    """Σ (z − shift × weight)²."""
    total = 0.0
    for k in range(z.size):
        total += (z[k] - shift * weight[k]) ** 2
    return total


@njit(cache=True, error_model="numpy")
def projected_dot(z: Any, weight: Any, shift: Any, field: Any, nodes: Any) -> float:
    """Σ (z − shift × weight) field over the contact nodes."""
    total = 0.0
    for k in range(nodes.size):
        total += (z[k] - shift * weight[k]) * field[nodes[k]]
    return total


@njit(cache=True, error_model="numpy")
def next_direction(direction: Any, z: Any, weight: Any, shift: Any, ratio: Any) -> None:
    """Direction d ← z − shift × weight + ratio × d."""
    for k in range(direction.size):
        direction[k] = z[k] - shift * weight[k] + ratio * direction[k]


@njit(cache=True, error_model="numpy")
def take_step(x: Any, residual: Any, direction: Any, response: Any, nodes: Any, length: Any) -> None:
    """Solution x ← x + length × d, and residual r ← r − length × G d on the contact nodes."""
    for k in range(nodes.size):
        x[k] += length * direction[k]
        residual[k] -= length * response[nodes[k]]


@njit(cache=True, error_model="numpy")
def add_scaled(field: Any, change: Any, factor: Any) -> None:
    """Add a factor × change to a field."""
    for i in range(field.size):
        field[i] += factor * change[i]


@njit(cache=True, error_model="numpy")
def standard_deviation(values: Any) -> float:
    """Standard deviation, without an array of its own."""
    mean, squares = 0.0, 0.0
    for i in range(values.size):
        mean += values[i]
    mean /= values.size
    for i in range(values.size):
        squares += (values[i] - mean) ** 2
    return np.sqrt(squares / values.size)
