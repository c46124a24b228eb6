"""Paraboloid that the comparisons press into a half-space or a slab, and its contact radius.

Lengths are in units of the edge of the square cell and stresses in units of E*. The axis of the paraboloid
is on the middle node of the grid. The model is linear: all stresses scale with the curvature of the
indenter.
"""

from __future__ import annotations

import numpy as np

from asperity.contact import Contact, solve
from asperity.elasticity.layer import Layer
from asperity.spectral import Grid
from asperity.types import Array

CURVATURE_RADIUS = 1000.0
"""Radius of curvature of the paraboloid, in cell edges.

It keeps the slope at the edge of contact near 10⁻⁴: CalculiX turns the pressure with the surface, linear
theory does not."""

INDENTATION = 0.02
"""The paper's indentation depth, in units of slab height × cell edge / radius of curvature."""


def paraboloid(grid: Grid, curvature_radius: float) -> Array:
    """Height ``r²/(2R)`` of the indenter's lower face, lowest at the middle node of the grid, (ny, nx)."""
    y, x = (spacing * (np.arange(n) - n // 2) for n, spacing in zip(grid.shape, grid.spacing, strict=True))
    return (y[:, None] ** 2 + x**2) / (2 * curvature_radius)


def fitted_contact_radius(pressure: Array, grid: Grid) -> float:
    """Contact radius from a fit to the pressure, which resolves it better than a count of contact nodes.

    In Hertz contact the squared pressure falls linearly with r² and is zero at the edge of contact. A
    parabola in r² is fitted to it where it is above a tenth of its largest value.
    """
    square = pressure**2
    inside = square > 0.1 * square.max()
    distance = 2 * CURVATURE_RADIUS * paraboloid(grid, CURVATURE_RADIUS)[inside]
    c, b, a = np.polyfit(distance / distance.max(), square[inside] / square.max(), 2)
    # This form of the root stays finite when the parabola is a line.
    return float(np.sqrt(-2 * a / (b - np.sqrt(b**2 - 4 * a * c)) * distance.max()))


def bonded_slab(poisson: float, height: float = 1.0) -> Layer:
    """Bonded slab with E* = 1."""
    return Layer(1 - poisson**2, poisson, height=height, bottom="bonded")


def slab_contact(points: int, approach: float, poisson: float = 0.33, rtol: float = 1e-8) -> Contact:
    """Contact of the paraboloid with the bonded cubic slab at an approach, by the spectral solver."""
    height = paraboloid(Grid((points, points)), CURVATURE_RADIUS)
    return solve(height, bonded_slab(poisson), approach=approach, rtol=rtol)


def largest_sample(values: Array, depth: Array) -> tuple[float, float]:
    """Height and depth of the maximum of evenly sampled values, by a parabola through three samples."""
    i = int(np.clip(values.argmax(), 1, len(values) - 2))
    below, here, above = values[i - 1 : i + 2]
    bend = below - 2 * here + above
    shift = 0.5 * (below - above) / bend
    return here - 0.25 * (below - above) * shift, depth[i] + shift * (depth[1] - depth[0])
