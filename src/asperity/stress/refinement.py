"""Position and value of maxima between the nodes, from quadratics through the neighbouring values.

All functions work on many maxima at once. Offsets are in grid spacings from the node.
"""

from __future__ import annotations

import numpy as np

from asperity.types import Array

MIN_DETERMINANT = 1e-12
"""A smaller determinant of the second derivatives, over the product of those along the axes, is rounding."""


def refine_in_plane(values: Array) -> tuple[Array, Array, Array]:
    """Value and offsets y, x of the maxima of quadratics through 3 × 3 values.

    Parameters
    ----------
    values : (maxima, 3, 3) array
        Along y and x, the node in the middle.
    """
    centre = values[:, 1, 1]
    gradient = np.stack([values[:, 2, 1] - values[:, 0, 1], values[:, 1, 2] - values[:, 1, 0]], axis=1) / 2
    hessian = np.empty((centre.size, 2, 2))
    hessian[:, 0, 0] = values[:, 2, 1] - 2 * centre + values[:, 0, 1]
    hessian[:, 1, 1] = values[:, 1, 2] - 2 * centre + values[:, 1, 0]
    hessian[:, 0, 1] = hessian[:, 1, 0] = _mixed_difference(values)
    step = _step_to_maximum(gradient, hessian)
    return centre + 0.5 * np.sum(gradient * step, axis=1), step[:, 0], step[:, 1]


def refine_in_solid(
    values: Array, above: float, here: float, below: float
) -> tuple[Array, Array, Array, Array]:
    """Value, depth and offsets y, x of the maxima of quadratics through 3 × 3 × 3 values.

    Parameters
    ----------
    values : (maxima, 3, 3, 3) array
        Along depth, y and x, the node in the middle.
    above, here, below : float
        Depths of the three planes, which may be unequally spaced.
    """
    up, down = here - above, below - here
    weight_up, weight_down = -down / (up * (up + down)), up / (down * (up + down))
    unit = min(up, down)

    def slope(lines: Array) -> Array:
        """Derivative along depth of the quadratic through three planes, per `unit`."""
        middle = lines[:, 1]
        return unit * (weight_up * (lines[:, 0] - middle) + weight_down * (lines[:, 2] - middle))

    centre = values[:, 1, 1, 1]
    gradient = np.empty((centre.size, 3))
    hessian = np.empty((centre.size, 3, 3))
    column = values[:, :, 1, 1]
    gradient[:, 0] = slope(column)
    gradient[:, 1] = (values[:, 1, 2, 1] - values[:, 1, 0, 1]) / 2
    gradient[:, 2] = (values[:, 1, 1, 2] - values[:, 1, 1, 0]) / 2
    hessian[:, 0, 0] = (
        2 * unit**2 * ((column[:, 0] - centre) / up + (column[:, 2] - centre) / down) / (up + down)
    )
    hessian[:, 1, 1] = values[:, 1, 2, 1] - 2 * centre + values[:, 1, 0, 1]
    hessian[:, 2, 2] = values[:, 1, 1, 2] - 2 * centre + values[:, 1, 1, 0]
    hessian[:, 1, 2] = hessian[:, 2, 1] = _mixed_difference(values[:, 1])
    hessian[:, 0, 1] = hessian[:, 1, 0] = slope((values[:, :, 2, 1] - values[:, :, 0, 1]) / 2)
    hessian[:, 0, 2] = hessian[:, 2, 0] = slope((values[:, :, 1, 2] - values[:, :, 1, 0]) / 2)
    step = _step_to_maximum(gradient, hessian, np.array([max(up, down) / unit, 1.0, 1.0]))
    value = centre + 0.5 * np.sum(gradient * step, axis=1)
    return value, here + unit * step[:, 0], step[:, 1], step[:, 2]


def _mixed_difference(values: Array) -> Array:
    """Second difference along y and x of 3 × 3 values."""
    return (values[:, 2, 2] - values[:, 2, 0] - values[:, 0, 2] + values[:, 0, 0]) / 4


def _step_to_maximum(gradient: Array, hessian: Array, reach: Array | float = 1.0) -> Array:
    """Newton's steps to the maxima of quadratics.

    Where a quadratic has no maximum within `reach`, the axis that gains most is refined alone, by at most
    half a spacing.
    """
    axes = np.arange(gradient.shape[1])
    curvature = hessian[:, axes, axes]
    adjugate, determinant = _adjugate(hessian)
    regular = np.abs(determinant) > MIN_DETERMINANT * np.abs(np.prod(curvature, axis=1))
    safe = np.where(regular, determinant, 1.0)
    step = -np.einsum("nij,nj->ni", adjugate, gradient) / safe[:, None]
    # Sylvester's criterion: leading minors of alternating sign.
    leading = hessian[:, 0, 0] * hessian[:, 1, 1] - hessian[:, 0, 1] ** 2
    downhill = (hessian[:, 0, 0] < 0) & (leading > 0)
    if axes.size == 3:
        downhill &= determinant < 0
    trusted = regular & downhill & np.all(np.abs(step) <= reach, axis=1)
    alone = np.where(curvature < 0, -gradient / np.where(curvature < 0, curvature, -1.0), 0.0)
    alone = np.clip(alone, -0.5, 0.5)
    largest = np.argmax(np.abs(alone * gradient), axis=1)
    single = np.where(axes == largest[:, None], alone, 0.0)
    return np.where(trusted[:, None], step, single)


def _adjugate(matrix: Array) -> tuple[Array, Array]:
    """Adjugates and determinants of symmetric matrices, (matrices, 2, 2) or (matrices, 3, 3)."""
    a, b, d = matrix[:, 0, 0], matrix[:, 0, 1], matrix[:, 1, 1]
    out = np.empty_like(matrix)
    if matrix.shape[1] == 2:
        out[:, 0, 0], out[:, 1, 1] = d, a
        out[:, 0, 1] = out[:, 1, 0] = -b
        return out, a * d - b * b
    c, e, f = matrix[:, 0, 2], matrix[:, 1, 2], matrix[:, 2, 2]
    out[:, 0, 0] = d * f - e * e
    out[:, 1, 1] = a * f - c * c
    out[:, 2, 2] = a * d - b * b
    out[:, 0, 1] = out[:, 1, 0] = c * e - b * f
    out[:, 0, 2] = out[:, 2, 0] = b * e - c * d
    out[:, 1, 2] = out[:, 2, 1] = b * c - a * e
    return out, a * out[:, 0, 0] + b * out[:, 0, 1] + c * out[:, 0, 2]
