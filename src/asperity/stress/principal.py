"""Principal stresses of a symmetric tensor in closed form.

The deviator is divided by its largest element. Its eigenvalue farthest from the two others comes from the
trigonometric solution of the cubic (O. K. Smith, Commun. ACM 4 (1961) 168, DOI 10.1145/355578.366316), which
is accurate for this one only: the two others may be close together, and there the arc cosine loses half of
the digits. They are therefore the eigenvalues of the 2 × 2 tensor that is left in the plane across the first
principal direction (W. M. Scherzinger, C. R. Dohrmann, Comput. Methods Appl. Mech. Eng. 197 (2008) 4007, DOI
10.1016/j.cma.2008.03.031). All three are accurate to rounding of the largest stress.
"""

from __future__ import annotations

import numpy as np

from asperity.compiled import compiled

LARGEST_SHEAR, PRINCIPAL_1, PRINCIPAL_2, PRINCIPAL_3 = range(4)
"""Numbers of the fields that follow from the principal stresses."""


@compiled
def principal_stresses(
    xx: float, yy: float, zz: float, yz: float, xz: float, xy: float
) -> tuple[float, float, float]:
    """Principal stresses σ1 ≥ σ2 ≥ σ3 of a symmetric tensor."""
    mean = (xx + yy + zz) / 3.0
    a, b, c = xx - mean, yy - mean, zz - mean
    scale = max(abs(a), abs(b), abs(c), abs(yz), abs(xz), abs(xy))
    if scale == 0.0:
        return mean, mean, mean
    a, b, c, f, g, h = a / scale, b / scale, c / scale, yz / scale, xz / scale, xy / scale
    # Rounding of the mean may be all that there is of a deviator.
    rest = (a + b + c) / 3.0
    mean += scale * rest
    a, b, c = a - rest, b - rest, c - rest
    radius = np.sqrt((a * a + b * b + c * c + 2.0 * (f * f + g * g + h * h)) / 6.0)
    if radius < 1e-15:
        return mean, mean, mean
    determinant = a * (b * c - f * f) - h * (h * c - f * g) + g * (h * f - b * g)
    cosine = min(1.0, abs(determinant) / (2.0 * radius * radius * radius))
    apart = 2.0 * radius * np.cos(np.arccos(cosine) / 3.0)
    if determinant < 0.0:
        apart = -apart
    first, second, coupling = _tensor_across(a - apart, b - apart, c - apart, f, g, h)
    first += apart
    second += apart
    middle = 0.5 * (first + second)
    half = np.hypot(0.5 * (first - second), coupling)
    upper, lower = middle + half, middle - half
    if determinant < 0.0:
        return mean + scale * max(upper, apart), mean + scale * lower, mean + scale * min(lower, apart)
    return mean + scale * max(upper, apart), mean + scale * upper, mean + scale * min(lower, apart)


@compiled
def _tensor_across(a: float, b: float, c: float, f: float, g: float, h: float) -> tuple[float, float, float]:
    """A tensor with one eigenvalue 0 in the plane across that direction: two normal elements and the shear.

    The rows of the tensor span this plane. The longest row gives the first axis, what is left of the longest
    of the others the second.
    """
    rows = ((a, h, g), (h, b, f), (g, f, c))
    longest, axis = -1.0, 0
    for n in range(3):
        x, y, z = rows[n]
        length = x * x + y * y + z * z
        if length > longest:
            longest, axis = length, n
    ux, uy, uz = rows[axis]
    length = np.sqrt(longest)
    ux, uy, uz = ux / length, uy / length, uz / length
    longest = -1.0
    vx = vy = vz = 0.0
    for n in range(3):
        x, y, z = rows[n]
        along = x * ux + y * uy + z * uz
        x, y, z = x - along * ux, y - along * uy, z - along * uz
        length = x * x + y * y + z * z
        if n != axis and length > longest:
            longest, vx, vy, vz = length, x, y, z
    length = np.sqrt(longest)
    vx, vy, vz = vx / length, vy / length, vz / length
    first = a * ux * ux + b * uy * uy + c * uz * uz + 2.0 * (f * uy * uz + g * ux * uz + h * ux * uy)
    second = a * vx * vx + b * vy * vy + c * vz * vz + 2.0 * (f * vy * vz + g * vx * vz + h * vx * vy)
    coupling = (
        a * ux * vx
        + b * uy * vy
        + c * uz * vz
        + f * (uy * vz + uz * vy)
        + g * (ux * vz + uz * vx)
        + h * (ux * vy + uy * vx)
    )
    return first, second, coupling
