"""Compiled loops of the active-set solver, over all nodes or over the contact nodes.

Fields are flattened. `nodes` holds the sorted indices of the contact nodes in the flattened field; arrays of
that size belong to the contact nodes, one element each. Sums accumulate in double precision.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

CHUNK = 32
"""Number of nodes that are tested together for a gap below a level."""

# Lets the compiler add in vectors: the order of a sum depends on the processor, not on the number of threads.
_VECTOR_SUMS = {"reassoc", "contract", "nsz"}

# The contact nodes and their gaps


@njit(cache=True, nogil=True, error_model="numpy")
def spread(field: Any, nodes: Any, values: Any) -> None:
    """Write values on nodes of a field, and zero on all others."""
    field[:] = 0
    for k in range(nodes.size):
        field[nodes[k]] = values[k]


@njit(cache=True, nogil=True, error_model="numpy")
def gaps(height: Any, displacement: Any, nodes: Any, out: Any) -> None:
    """Write the gap h + u of nodes."""
    for k in range(nodes.size):
        out[k] = height[nodes[k]] + displacement[nodes[k]]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_VECTOR_SUMS | {"nnan"})
def least_gaps(height: Any, displacement: Any) -> Any:
    """Least gap in each group of `CHUNK` nodes."""
    out = np.empty(-(-height.size // CHUNK), height.dtype)
    for c in range(out.size):
        h, u = height[c * CHUNK : (c + 1) * CHUNK], displacement[c * CHUNK : (c + 1) * CHUNK]
        least = h[0] + u[0]
        for i in range(h.size):
            gap = h[i] + u[i]
            least = gap if gap < least else least
        out[c] = least
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def free_nodes_below(
    height: Any, displacement: Any, nodes: Any, least_gap: Any, level: Any
) -> tuple[Any, Any]:
    """Sorted nodes out of contact whose gap is below a level, and their gaps.

    `least_gap` is that of `least_gaps`.
    """
    size = 0
    for c in range(least_gap.size):
        size += CHUNK if least_gap[c] < level else 0
    found, gap = np.empty(size, np.uint32), np.empty(size, height.dtype)
    count, k = 0, 0
    for c in range(least_gap.size):
        if not least_gap[c] < level:
            continue
        start, stop = c * CHUNK, min((c + 1) * CHUNK, height.size)
        while k < nodes.size and nodes[k] < start:
            k += 1
        for i in range(start, stop):
            if k < nodes.size and nodes[k] == i:
                k += 1
            else:
                # Written in any case, and kept if the gap is below the level.
                found[count], gap[count] = i, height[i] + displacement[i]
                count += gap[count] < level
    return found[:count].copy(), gap[:count].copy()


@njit(cache=True, nogil=True, error_model="numpy")
def merge(nodes: Any, others: Any, values: Any, values_of_others: Any) -> tuple[Any, Any]:
    """Two sorted sets of nodes without common elements as one, with the values on them."""
    merged = np.empty(nodes.size + others.size, np.uint32)
    out = np.empty(merged.size, values.dtype)
    j, k = 0, 0
    for i in range(merged.size):
        if k == others.size or (j < nodes.size and nodes[j] < others[k]):
            merged[i], out[i] = nodes[j], values[j]
            j += 1
        else:
            merged[i], out[i] = others[k], values_of_others[k]
            k += 1
    return merged, out


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_VECTOR_SUMS)
def squared_overlap(gap: Any, approach: float) -> float:
    """Sum of the squared overlaps δ − (h + u) of the nodes that penetrate."""
    total = 0.0
    for k in range(gap.size):
        overlap = approach - np.float64(gap[k])
        total += overlap * overlap if overlap > 0 else 0.0
    return total


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_VECTOR_SUMS)
def residual(gap: Any, approach: float, unit: float) -> Any:
    """Overlap δ − (h + u) of the contact nodes, divided by `unit`."""
    out = np.empty(gap.size, np.float32)
    for k in range(gap.size):
        out[k] = (approach - gap[k]) / unit
    return out


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_VECTOR_SUMS)
def weighted_mean(weight: Any, gap: Any, origin: float) -> float:
    """Weighted mean of gap − origin over the contact nodes."""
    total, norm = 0.0, 0.0
    for k in range(gap.size):
        total += np.float64(weight[k]) * (gap[k] - origin)
        norm += weight[k]
    return total / norm


# Steps of the outer loop


@njit(cache=True, nogil=True, error_model="numpy")
def add_and_release(pressure: Any, change: Any, fraction: Any) -> Any:
    """Pressure with a fraction of a change added; nodes in tension are released, to zero pressure."""
    out = np.empty_like(pressure)
    for k in range(pressure.size):
        out[k] = max(pressure[k] + fraction * change[k], 0.0)
    return out


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_VECTOR_SUMS)
def line_search(pressure: Any, pressure_before: Any, gap: Any, gap_before: Any, approach: float) -> float:
    """Fraction, between 0 and 1, of a step of the pressure at which the energy is least."""
    slope, curvature = 0.0, 0.0
    for i in range(pressure.size):
        change = np.float64(pressure[i]) - np.float64(pressure_before[i])
        slope -= change * (gap_before[i] - approach)
        curvature += change * (np.float64(gap[i]) - np.float64(gap_before[i]))
    return min(max(slope / curvature, 0.0), 1.0) if curvature > 0 else 1.0


# Vector operations of the conjugate gradients; `shift` × `weight` is subtracted from the preconditioned
# residual z, so that at a given load the corrections sum to zero


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_VECTOR_SUMS)
def dot(a: Any, b: Any) -> float:
    """Σ a b."""
    total = 0.0
    for k in range(a.size):
        total += np.float64(a[k]) * np.float64(b[k])
    return total


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_VECTOR_SUMS)
def sum_and_dot(a: Any, b: Any) -> tuple[float, float]:
    """Σ a and Σ a b."""
    total, product = 0.0, 0.0
    for k in range(a.size):
        total += a[k]
        product += np.float64(a[k]) * np.float64(b[k])
    return total, product


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_VECTOR_SUMS)
def projected_square(z: Any, weight: Any, shift: float) -> float:
    """Σ (z − shift × weight)²."""
    total = 0.0
    for k in range(z.size):
        total += (z[k] - shift * weight[k]) ** 2
    return total


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_VECTOR_SUMS)
def projected_dot(z: Any, weight: Any, shift: Any, values: Any) -> float:
    """Σ (z − shift × weight) × values."""
    total = 0.0
    for k in range(z.size):
        total += np.float64(z[k] - shift * weight[k]) * np.float64(values[k])
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def next_direction(direction: Any, z: Any, weight: Any, shift: Any, ratio: Any) -> None:
    """Direction d ← z − shift × weight + ratio × d."""
    for k in range(direction.size):
        direction[k] = z[k] - shift * weight[k] + ratio * direction[k]


@njit(cache=True, nogil=True, error_model="numpy")
def take_step(x: Any, residual: Any, total: Any, direction: Any, response: Any, length: Any) -> None:
    """Solution x ← x + length × d, its displacement likewise, and residual r ← r − length × G d."""
    for k in range(x.size):
        x[k] += length * direction[k]
        total[k] += length * response[k]
        residual[k] -= length * response[k]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_VECTOR_SUMS)
def standard_deviation(values: Any) -> float:
    """Standard deviation, without an array of its own."""
    mean, squares = 0.0, 0.0
    for i in range(values.size):
        mean += values[i]
    mean /= values.size
    for i in range(values.size):
        squares += (values[i] - mean) ** 2
    return np.sqrt(squares / values.size)


@njit(cache=True, nogil=True, error_model="numpy")
def extremes_of_contact(pressure: Any, gap: Any) -> tuple[float, float, float, float, float, float, float]:
    """Least, largest and total pressure, least gap, and of the contact: largest |g|, Σ p |g| and Σ p.

    What is not a number makes the results infinite or not numbers either.
    """
    least, largest, total = pressure[0], pressure[0], 0.0
    least_gap, contact_gap, work, support = gap[0], 0.0, 0.0, 0.0
    for i in range(pressure.size):
        p, g = pressure[i], gap[i]
        total += p
        # Written so that a comparison with what is not a number is kept.
        least_gap = least_gap if least_gap <= g else g
        if p != 0:
            least = least if least <= p else p
            largest = largest if largest >= p else p
            if not p <= 0:
                contact_gap = contact_gap if contact_gap >= abs(g) else abs(g)
                work += p * abs(g)
                support += p
        elif least > 0:
            least = p
    return least, largest, total, least_gap, contact_gap, work, support
