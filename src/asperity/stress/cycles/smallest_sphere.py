"""The smallest sphere that encloses points in five dimensions, its centre anywhere or in a subspace.

With the centre c in the subspace of the first coordinates, the squared distance of a point is its squared
distance from its projection x plus the constant w of its other coordinates: minimise max (|x − c|² + w). At
most one point more than the subspace has dimensions determines the optimum (E. Welzl, LNCS 555 (1991) 359).
It is reached by exchange, as in P. Wolfe, Math. Program. 11 (1976) 128: the farthest point is added to the
points that fix the sphere, and the centre moves towards the point equally far from all of them; a point whose
weight in the centre falls to 0 on the way is dropped. The radius grows with every added point, so that no set
of points recurs.
"""

from typing import Any

import numpy as np

from asperity.core.compiled import compiled_with_arrays

DIMENSIONS = 5
"""Dimensions of the space of the stress deviators."""

RADIUS_ROUNDING = 1e-13
"""Relative tolerance on the squared radius: of points outside, and of its rise in a step."""

MAX_EXCHANGES = 1000
"""Most points that are added; about ten are needed."""


@compiled_with_arrays
def smallest_sphere(points: Any, free: Any, centre: Any) -> float:
    """Squared radius of the smallest sphere around points, exact to rounding.

    Parameters
    ----------
    points : (5, n) array of double precision
    free : 1 to 5
        Number of the first coordinates along which the centre may move; the others are 0.
    centre : (5,) array
        Filled with the centre.
    """
    support = np.empty(DIMENSIONS + 2, np.int64)
    weight, wanted = np.empty(DIMENSIONS + 2), np.empty(DIMENSIONS + 2)
    support[0], weight[0], count = 0, 1.0, 1
    centre[:] = 0.0
    centre[:free] = points[:free, 0]
    squared = np.empty(points.shape[1])
    radius = -1.0
    for _ in range(MAX_EXCHANGES):
        squared[:] = 0.0
        for k in range(DIMENSIONS):
            for n in range(squared.size):
                squared[n] += (points[k, n] - centre[k]) ** 2
        here, farthest = squared[support[0]], squared.argmax()
        distance = squared[farthest]
        if distance <= here * (1 + RADIUS_ROUNDING) or here <= radius * (1 + 1e-3 * RADIUS_ROUNDING):
            return distance
        radius = here
        support[count], weight[count] = farthest, 0.0
        count += 1
        while True:
            is_end = _wanted_weights(points, free, support, count, wanted)
            step, leaving = 1.0, -1
            for n in range(count):
                if wanted[n] < 0:
                    until = weight[n] / (weight[n] - wanted[n]) if is_end else -weight[n] / wanted[n]
                    if leaving < 0 or until < step:
                        step, leaving = until, n
            for n in range(count):
                change = wanted[n] - weight[n] if is_end else wanted[n]
                weight[n] += step * change
            if leaving < 0:
                break
            for n in range(leaving, count - 1):
                support[n], weight[n] = support[n + 1], weight[n + 1]
            count -= 1
        for k in range(free):
            centre[k] = 0.0
            for n in range(count):
                centre[k] += weight[n] * points[k, support[n]]
    return distance


@compiled_with_arrays
def _wanted_weights(points: Any, free: int, support: Any, count: int, wanted: Any) -> bool:
    """Weights with which the points add up to the point equally far from all; False if affinely dependent.

    `wanted` is then the direction in which the weight of the last point rises while the centre stays.
    """
    first, size = points[:, support[0]], count - 1
    lower, right, is_end = np.empty((size, size)), np.empty(size), True
    for n in range(size):
        point = points[:, support[n + 1]]
        right[n] = 0.0
        for k in range(DIMENSIONS):
            right[n] += 0.5 * (point[k] - first[k]) ** 2
            if k >= free:
                right[n] += (point[k] - first[k]) * first[k]
        for m in range(n + 1):
            other, total = points[:, support[m + 1]], 0.0
            for k in range(free):
                total += (point[k] - first[k]) * (other[k] - first[k])
            gram = total
            for k in range(m):
                total -= lower[n, k] * lower[m, k]
            if m < n:
                lower[n, m] = total / lower[m, m]
            elif total > 1e-14 * gram:
                lower[n, n] = np.sqrt(total)
            else:
                lower[n, n] = np.sqrt(max(total, 1e-300))
                is_end = n < size - 1
    if is_end:
        wanted[0] = 1.0
        for n in range(size):
            for k in range(n):
                right[n] -= lower[n, k] * right[k]
            right[n] /= lower[n, n]
    else:
        size -= 1
        wanted[0], wanted[size + 1] = -1.0, 1.0
        right[:size] = -lower[size, :size]
    for n in range(size - 1, -1, -1):
        for k in range(n + 1, size):
            right[n] -= lower[k, n] * right[k]
        right[n] /= lower[n, n]
    for n in range(size):
        wanted[n + 1] = right[n]
        wanted[0] -= right[n]
    return is_end
