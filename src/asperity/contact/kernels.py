"""Passes over the nodes of a grid, or over its contact nodes, each done at once for what needs it.

Fields are flattened. `plain` holds the numbers of contact nodes; arrays of that size belong to them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit


@njit(cache=True, error_model="numpy")
def select(pressure: Any) -> Any:
    """Numbers of the nodes under pressure."""
    count = 0
    for i in range(pressure.size):
        if pressure[i] > 0:
            count += 1
    # Unsigned, because the compiler guards every access by a signed number against one below zero.
    plain = np.empty(count, np.uint64)
    count = 0
    for i in range(pressure.size):
        if pressure[i] > 0:
            plain[count] = i
            count += 1
    return plain


@njit(cache=True, error_model="numpy")
def norms(pressure: Any, gap: Any, approach: float) -> tuple[float, float, float]:
    """Mean of the pressures, and sums of their squares and of those of penetrations of nodes without."""
    total, squares, penetration = 0.0, 0.0, 0.0
    for i in range(pressure.size):
        if pressure[i] > 0:
            total += pressure[i]
            squares += pressure[i] * pressure[i]
        elif gap[i] < approach:
            penetration += (approach - gap[i]) ** 2
    return total / pressure.size, squares, penetration


@njit(cache=True, error_model="numpy")
def join(pressure: Any, gap: Any, displacement: Any, approach: float, unit: float, joining: float) -> None:
    """Give pressure to nodes without it that are about to penetrate."""
    for i in range(pressure.size):
        if pressure[i] == 0:
            overlap = (approach - gap[i]) / unit - displacement[i]
            if overlap > 0:
                pressure[i] = joining * overlap


@njit(cache=True, error_model="numpy")
def weighted_mean(weight: Any, gap: Any, plain: Any, origin: float) -> float:
    total, norm = 0.0, 0.0
    for k in range(plain.size):
        total += weight[k] * (gap[plain[k]] - origin)
        norm += weight[k]
    return total / norm


@njit(cache=True, error_model="numpy")
def residual(gap: Any, plain: Any, approach: float, unit: float) -> Any:
    out = np.empty(plain.size, np.float32)
    for k in range(plain.size):
        out[k] = (approach - gap[plain[k]]) / unit
    return out


@njit(cache=True, error_model="numpy")
def add_clipped(pressure: Any, plain: Any, change: Any, reach: Any) -> None:
    for k in range(plain.size):
        pressure[plain[k]] = max(pressure[plain[k]] + reach * change[k], 0.0)


@njit(cache=True, error_model="numpy")
def line_search(pressure: Any, pressure_before: Any, gap: Any, gap_before: Any, approach: float) -> float:
    """Fraction of a step at which the energy is least."""
    slope, curvature = 0.0, 0.0
    for i in range(pressure.size):
        change = pressure[i] - pressure_before[i]
        slope -= change * (gap_before[i] - approach)
        curvature += change * (gap[i] - gap_before[i])
    return min(max(slope / curvature, 0.0), 1.0) if curvature > 0 else 1.0


@njit(cache=True, error_model="numpy")
def best_scale(pressure: Any, displacement: Any, height: Any, approach: float) -> float:
    """Factor on the pressure, and so on the displacement, at which the energy is least."""
    work, energy = 0.0, 0.0
    for i in range(pressure.size):
        work += pressure[i] * (approach - height[i])
        energy += pressure[i] * displacement[i]
    return work / energy if energy > 0 and work > 0 else 1.0


@njit(cache=True, error_model="numpy")
def scale(pressure: Any, displacement: Any, height: Any, factor: float) -> None:
    """Multiply a pressure and its displacement, to which the height is added."""
    for i in range(pressure.size):
        pressure[i] *= factor
        displacement[i] = factor * displacement[i] + height[i]


@njit(cache=True, error_model="numpy")
def events(
    pressure: Any, gap: Any, approach: float, unit: float, plain: Any, rate: Any, response: Any
) -> Any:
    """Change of the approach at which each node enters or leaves the contact."""
    changes = np.empty(pressure.size, np.float32)
    for i in range(pressure.size):
        closing = 1 - response[i]
        changes[i] = (gap[i] - approach) / (unit * closing) if closing > 0 else np.inf
    for k in range(plain.size):
        changes[plain[k]] = -pressure[plain[k]] / rate[k] if rate[k] > 0 else -np.inf
    return changes


@njit(cache=True, error_model="numpy")
def add(pressure: Any, plain: Any, change: Any) -> None:
    for k in range(plain.size):
        pressure[plain[k]] += change[k]


@njit(cache=True, error_model="numpy")
def accumulate(displacement: Any, response: Any, length: Any) -> None:
    for i in range(displacement.size):
        displacement[i] += length * response[i]


@njit(cache=True, error_model="numpy")
def blend(values: Any, before: Any, fraction: float) -> None:
    for i in range(values.size):
        values[i] = before[i] + fraction * (values[i] - before[i])


@njit(cache=True, error_model="numpy")
def dot(a: Any, b: Any) -> float:
    total = 0.0
    for k in range(a.size):
        total += a[k] * b[k]
    return total


@njit(cache=True, error_model="numpy")
def sum_and_dot(a: Any, b: Any) -> tuple[float, float]:
    total, product = 0.0, 0.0
    for k in range(a.size):
        total += a[k]
        product += a[k] * b[k]
    return total, product


@njit(cache=True, error_model="numpy")
def projected_square(a: Any, weight: Any, shift: float) -> float:
    total = 0.0
    for k in range(a.size):
        total += (a[k] - shift * weight[k]) ** 2
    return total


@njit(cache=True, error_model="numpy")
def projected_dot(a: Any, weight: Any, shift: Any, field: Any, plain: Any) -> float:
    total = 0.0
    for k in range(plain.size):
        total += (a[k] - shift * weight[k]) * field[plain[k]]
    return total


@njit(cache=True, error_model="numpy")
def dot_gathered(a: Any, field: Any, plain: Any) -> float:
    total = 0.0
    for k in range(plain.size):
        total += a[k] * field[plain[k]]
    return total


@njit(cache=True, error_model="numpy")
def advance(direction: Any, z: Any, weight: Any, shift: Any, ratio: Any) -> None:
    for k in range(direction.size):
        direction[k] = z[k] - shift * weight[k] + ratio * direction[k]


@njit(cache=True, error_model="numpy")
def step(x: Any, residual: Any, direction: Any, response: Any, plain: Any, length: Any) -> None:
    for k in range(plain.size):
        x[k] += length * direction[k]
        residual[k] -= length * response[plain[k]]


@njit(cache=True, error_model="numpy")
def standard_deviation(values: Any) -> float:
    mean, squares = 0.0, 0.0
    for i in range(values.size):
        mean += values[i]
    mean /= values.size
    for i in range(values.size):
        squares += (values[i] - mean) ** 2
    return np.sqrt(squares / values.size)
