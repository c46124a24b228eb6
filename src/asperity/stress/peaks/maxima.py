"""Maxima of fields above their neighbours in a plane, and their refinement between the nodes.

A quadratic through the values at and around a node gives position and value of the peak between the nodes.
Offsets are in grid spacings from the node.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Self

import numpy as np

from asperity.core.types import Array

MIN_DETERMINANT = 1e-12
"""A smaller determinant of the second derivatives, over the product of those along the axes, is rounding."""


class Entries:
    """Arrays of the same length, an entry for every maximum; None for an array that is not known."""

    @property
    def size(self) -> int:
        """Number of entries."""
        return len(next(iter(vars(self).values())))

    def select(self, chosen: Array) -> Self:
        """Some of the entries."""
        return type(self)(*(None if array is None else array[chosen] for array in vars(self).values()))

    @classmethod
    def join(cls, parts: Iterable[Self]) -> Self:
        """All entries of several sets, in their order."""
        arrays = zip(*(vars(part).values() for part in parts), strict=True)
        return cls(*(None if each[0] is None else np.concatenate(each) for each in arrays))


@dataclass
class Maxima(Entries):
    """Maxima of fields of one plane over their neighbours in it; those of a field by rising rows and columns.

    Parameters
    ----------
    field : (maxima,) integer array
        Number of the field.
    row, column : (maxima,) integer arrays
        The nodes.
    here : (maxima, 3, 3) array
        Values at and around the nodes.
    above : (maxima, 3, 3) array or None
        Those in the plane above, if the maxima exceed them.
    """

    field: Array
    row: Array
    column: Array
    here: Array
    above: Array | None = None

    @property
    def magnitude(self) -> Array:
        """Magnitudes at the nodes."""
        return np.abs(self.here[:, 1, 1])


def refine_in_plane(values: Array) -> Array:
    """Magnitude and offsets y, x, (3, maxima), of the maxima of quadratics through 3 × 3 values.

    Parameters
    ----------
    values : (maxima, 3, 3) array
        Along y and x, the node in the middle. Where that is negative, the sign of all nine is changed.
    """
    sign = np.sign(values[:, 1, 1])
    centre, gradient, second = _derivatives(values, sign)
    nothing, one = np.zeros_like(centre), np.ones_like(centre)
    # A third axis on which nothing changes.
    gradient, second = [nothing, *gradient], [-one, nothing, nothing, *second]
    step = _steps_to_maxima(gradient, second, 1.0)
    return np.stack([centre + 0.5 * sum(g * s for g, s in zip(gradient, step, strict=True)), *step[1:]])


def refine_in_solid(above: Array, here: Array, below: Array, depths: tuple[float, ...]) -> Array:
    """Magnitude, depth and offsets y, x, (4, maxima), of the maxima of quadratics through 3 × 3 × 3 values.

    The quadratic is that of 19 of the 27 values: the mixed derivatives need no corners of the adjacent
    planes.

    Parameters
    ----------
    above, here, below : (maxima, 3, 3) arrays
        Of three planes, along y and x, the node in the middle of `here`. Where that is negative, the sign of
        all values is changed.
    depths : tuple of float
        Of the three planes, which may be unequally spaced.
    """
    up, down = depths[1] - depths[0], depths[2] - depths[1]
    weight_up, weight_down = -down / (up * (up + down)), up / (down * (up + down))
    unit = min(up, down)
    sign = np.sign(here[:, 1, 1])
    centre, (along_y, along_x), second = _derivatives(here, sign)
    over, (over_y, over_x), _ = _derivatives(above, sign)
    under, (under_y, under_x), _ = _derivatives(below, sign)
    # Derivatives along depth per `unit`, of the quadratics through three planes.
    along_z = unit * (weight_up * (over - centre) + weight_down * (under - centre))
    zy = unit * (weight_up * (over_y - along_y) + weight_down * (under_y - along_y))
    zx = unit * (weight_up * (over_x - along_x) + weight_down * (under_x - along_x))
    zz = 2 * (unit * unit) * ((over - centre) / up + (under - centre) / down) / (up + down)
    gradient = [along_z, along_y, along_x]
    step = _steps_to_maxima(gradient, [zz, zy, zx, *second], max(up, down) / unit)
    value = centre + 0.5 * sum(g * s for g, s in zip(gradient, step, strict=True))
    return np.stack([value, depths[1] + unit * step[0], *step[1:]])


def _derivatives(values: Array, sign: Array) -> tuple[Array, list[Array], list[Array]]:
    """Value at the middle of 3 × 3 values times a sign, slopes along y and x, and ∂²/∂y², ∂²/∂y∂x, ∂²/∂x²."""
    v = np.multiply(sign, values.transpose(1, 2, 0), dtype=float)
    centre, upper, lower, left, right = v[1, 1], v[0, 1], v[2, 1], v[1, 0], v[1, 2]
    mixed = (v[2, 2] - v[2, 0] - v[0, 2] + v[0, 0]) / 4
    slopes = [(lower - upper) / 2, (right - left) / 2]
    return centre, slopes, [lower - 2 * centre + upper, mixed, right - 2 * centre + left]


def _steps_to_maxima(gradient: list[Array], second: list[Array], reach: float) -> Array:
    """Newton's steps to the maxima of quadratics, (3, maxima).

    Where a quadratic has no maximum within `reach` along the first axis and one spacing along the others, the
    axis that gains most is refined alone, by at most half a spacing.

    Parameters
    ----------
    gradient : three arrays
    second : six arrays
        Second derivatives: the upper triangle of their matrix, row by row.
    reach : float
    """
    u, v, w = gradient
    a, b, c, d, e, f = second
    # The adjugate of the matrix, divided by the determinant below.
    aa, ab, ac = d * f - e * e, c * e - b * f, b * e - c * d
    bb, bc, cc = a * f - c * c, b * c - a * e, a * d - b * b
    determinant = a * aa + b * ab + c * ac
    # Sylvester's criterion: leading minors of alternating sign.
    negative = (np.abs(determinant) > MIN_DETERMINANT * np.abs(a * d * f)) & (a < 0) & (cc > 0)
    negative &= determinant < 0
    along = [aa * u + ab * v + ac * w, ab * u + bb * v + bc * w, ac * u + bc * v + cc * w]
    with np.errstate(all="ignore"):
        newton = -np.stack(along) / determinant
        alone = np.where(
            np.stack([a, d, f]) < 0, np.clip(-np.stack(gradient) / np.stack([a, d, f]), -0.5, 0.5), 0
        )
    most = np.argmax(np.abs(alone * gradient), axis=0)
    alone *= np.arange(3)[:, None] == most
    within = np.all(np.abs(newton) <= np.array([[reach], [1.0], [1.0]]), axis=0)
    return np.where(negative & within, newton, alone)
