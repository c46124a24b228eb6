"""Maxima of fields above their neighbours in a plane, and their refinement between the nodes.

A quadratic through the values at and around a node gives position and value of the peak between the nodes.
Offsets are in grid spacings from the node.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from asperity.core.compiled import compiled, compiled_with_arrays
from asperity.core.types import Array

MIN_DETERMINANT = 1e-12
"""A smaller determinant of the second derivatives, over the product of its diagonal, is rounding."""


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
    """Maxima of fields of one plane over their neighbours in it; of each field by rising rows and columns.

    Parameters
    ----------
    field : (maxima,) integer array
        Number of the field.
    row, column : (maxima,) integer arrays
        The nodes.
    here : (maxima, 3, 3) array
        Values at and around the nodes.
    above : (maxima, 3, 3) array or None
        Values in the plane above, if the maxima exceed them.
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


@compiled_with_arrays
def refine_in_plane(values: Any) -> Any:
    """Magnitude and offsets y, x, (3, maxima), of the maxima of quadratics through 3 × 3 values.

    Parameters
    ----------
    values : (maxima, 3, 3) array
        Along y and x, the node in the middle. Where it is negative, the sign of all nine is changed.
    """
    out = np.empty((3, len(values)))
    # With a third axis on which nothing changes.
    for n in range(values.shape[0]):
        centre, along_y, along_x, yy, yx, xx = derivatives(values[n], np.sign(values[n, 1, 1]))
        step = _step_to_maximum((0.0, along_y, along_x), (-1.0, 0.0, 0.0, yy, yx, xx), 1.0)
        out[0, n] = centre + 0.5 * (along_y * step[1] + along_x * step[2])
        out[1, n], out[2, n] = step[1], step[2]
    return out


def refine_in_solid(above: Array, here: Array, below: Array, depths: tuple[float, ...]) -> Array:
    """Magnitude, depth and offsets y, x, (4, maxima), of the maxima of quadratics through 3 × 3 × 3 values.

    The quadratic uses 19 of the 27 values: the mixed derivatives need no corners of the adjacent planes.

    Parameters
    ----------
    above, here, below : (maxima, 3, 3) arrays
        Of three planes, along y and x, the node in the middle of `here`. Where it is negative, the sign of
        all values is changed.
    depths : tuple of float
        Of the three planes, which may be unequally spaced.
    """
    out = np.empty((4, len(here)))
    _refine_in_solid(above, here, below, tuple(map(float, depths)), out)
    return out


@compiled
def _refine_in_solid(above: Any, here: Any, below: Any, depths: Any, out: Any) -> None:
    """Fill `out` as `refine_in_solid` says, with derivatives along depth per `unit`."""
    distances = depths[1] - depths[0], depths[2] - depths[1]
    unit = min(distances)
    for n in range(here.shape[0]):
        around = above[n], here[n], below[n]
        centre, in_plane, (along_z, zy, zx, zz) = quadratic(around, distances, np.sign(here[n, 1, 1]), unit)
        along_y, along_x, yy, yx, xx = in_plane
        second = zz, zy, zx, yy, yx, xx
        step = _step_to_maximum((along_z, along_y, along_x), second, max(distances) / unit)
        out[0, n] = centre + 0.5 * (along_z * step[0] + along_y * step[1] + along_x * step[2])
        out[1, n], out[2, n], out[3, n] = depths[1] + unit * step[0], step[1], step[2]


@compiled
def quadratic(values: Any, distances: Any, sign: float, unit: float) -> Any:
    """The quadratic through 3 × 3 values times a sign in each of three planes at distances.

    Value at the node, derivatives y, x, yy, yx, xx, and along depth, per unit, z, zy, zx, zz.
    """
    (above, here, below), (up, down) = values, distances
    weight_up, weight_down = -down / (up * (up + down)), up / (down * (up + down))
    centre, y, x, yy, yx, xx = derivatives(here, sign)
    over, over_y, over_x, _, _, _ = derivatives(above, sign)
    under, under_y, under_x, _, _, _ = derivatives(below, sign)
    z = unit * (weight_up * (over - centre) + weight_down * (under - centre))
    zy = unit * (weight_up * (over_y - y) + weight_down * (under_y - y))
    zx = unit * (weight_up * (over_x - x) + weight_down * (under_x - x))
    zz = 2 * (unit * unit) * ((over - centre) / up + (under - centre) / down) / (up + down)
    return centre, (y, x, yy, yx, xx), (z, zy, zx, zz)


@compiled
def derivatives(values: Any, sign: float) -> tuple[float, float, float, float, float, float]:
    """Value at the middle of 3 × 3 values times a sign, slopes along y and x, and ∂²/∂y², ∂²/∂y∂x, ∂²/∂x²."""
    sign = np.float64(sign)
    centre = sign * values[1, 1]
    upper, lower, left, right = (
        sign * values[0, 1],
        sign * values[2, 1],
        sign * values[1, 0],
        sign * values[1, 2],
    )
    mixed = (sign * values[2, 2] - sign * values[2, 0] - sign * values[0, 2] + sign * values[0, 0]) / 4
    along_y, along_x = (lower - upper) / 2, (right - left) / 2
    return centre, along_y, along_x, lower - 2 * centre + upper, mixed, right - 2 * centre + left


@compiled
def _step_to_maximum(gradient: Any, second: Any, reach: float) -> tuple[float, float, float]:
    """Newton's step to the maximum of a quadratic.

    Where it has no maximum within `reach` along the first axis and one spacing along the others, the axis
    that gains most is refined alone, by at most half a spacing. `second` is the upper triangle of the matrix
    of second derivatives, row by row.
    """
    u, v, w = gradient
    a, b, c, d, e, f = second
    # The adjugate of the matrix, divided by the determinant below.
    aa, ab, ac = d * f - e * e, c * e - b * f, b * e - c * d
    bb, bc, cc = a * f - c * c, b * c - a * e, a * d - b * b
    determinant = a * aa + b * ab + c * ac
    # Sylvester's criterion: leading minors of alternating sign.
    if a < 0 and cc > 0 and determinant < 0 and -determinant > MIN_DETERMINANT * abs(a * d * f):
        x = -(aa * u + ab * v + ac * w) / determinant
        y = -(ab * u + bb * v + bc * w) / determinant
        z = -(ac * u + bc * v + cc * w) / determinant
        if abs(x) <= reach and abs(y) <= 1.0 and abs(z) <= 1.0:
            return x, y, z
    x = min(max(-u / a, -0.5), 0.5) if a < 0 else 0.0
    y = min(max(-v / d, -0.5), 0.5) if d < 0 else 0.0
    z = min(max(-w / f, -0.5), 0.5) if f < 0 else 0.0
    gain_x, gain_y, gain_z = abs(x * u), abs(y * v), abs(z * w)
    if gain_x >= gain_y and gain_x >= gain_z:
        return x, 0.0, 0.0
    return (0.0, y, 0.0) if gain_y >= gain_z else (0.0, 0.0, z)
