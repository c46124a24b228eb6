"""The paraboloid that is pressed into a half-space or a slab, its contact radius, and the fields below.

Lengths are in units of the edge of the square cell and stresses in units of E*. The axis of the paraboloid
is on the middle node of the grid. The model is linear: all stresses scale with the curvature of the
indenter.
"""

import numpy as np

from asperity.contact import Contact, solve_contact
from asperity.core.types import Array, ArrayLike
from asperity.elasticity.solid import Solid
from asperity.fourier.grid import Fourier, Grid, resample

CURVATURE_RADIUS = 1000.0
"""Radius of curvature of the paraboloid, in cell edges.

It keeps the slope at the edge of contact near 10⁻⁴, as linear theory assumes."""

LARGEST_DECAY = 40.0
"""Modes with q · depth above this are left out: they have decayed below rounding, e⁻⁴⁰ = 4 · 10⁻¹⁸."""

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


def bonded_slab(poisson: float, height: float = 1.0) -> Solid:
    """Bonded slab with E* = 1."""
    return Solid(1 - poisson**2, poisson, height=height, bottom="bonded")


def slab_contact(points: int, approach: float) -> Contact:
    """Contact of the paraboloid with the bonded cubic slab at an approach, by the spectral solver."""
    height = paraboloid(Grid((points, points)), CURVATURE_RADIUS)
    return solve_contact(height, bonded_slab(0.33), approach=approach, rtol=1e-8)


def largest_sample(values: Array, depth: Array) -> tuple[float, float]:
    """Height and depth of the maximum of evenly sampled values, by a parabola through three samples."""
    i = int(np.clip(values.argmax(), 1, len(values) - 2))
    below, here, above = values[i - 1 : i + 2]
    bend = below - 2 * here + above
    shift = 0.5 * (below - above) / bend
    return here - 0.25 * (below - above) * shift, depth[i] + shift * (depth[1] - depth[0])


def displacement_and_stress(
    pressure: Array, grid: Grid, layer: Solid, y: ArrayLike, x: ArrayLike, depths: ArrayLike
) -> tuple[Array, Array]:
    """Displacement and stress below a pressure, as sums over its Fourier modes.

    Parameters
    ----------
    pressure : (ny, nx) array
    grid : Grid
    layer : Solid
    y, x : (points,) arrays
        Positions in the coordinates of the grid.
    depths : (depths,) array

    Returns
    -------
    displacement : (depths, points, 3) array
    stress : (depths, points, 6) array
    """
    y, x = np.atleast_1d(y), np.atleast_1d(x)
    rows, row_of_point = np.unique(y, return_inverse=True)
    spectrum = Fourier(grid).forward(pressure)
    displacement: list[Array] = []
    stress: list[Array] = []
    for depth in np.atleast_1d(depths):
        # The modes that have not decayed at this depth: at most one node more than `grid` along each axis,
        # and no mode of `grid` is at the Nyquist wavevector.
        reach = [LARGEST_DECAY * edge / (2 * np.pi * depth) if depth > 0 else np.inf for edge in grid.length]
        ny, nx = (int(min(n + 1, 2 * np.ceil(most) + 1)) for n, most in zip(grid.shape, reach, strict=True))
        modes = Grid((ny, nx), grid.length)
        coefficients = resample(spectrum, grid, modes) * modes.multiplicity[1]
        wave_y = np.exp(1j * np.outer(rows, modes.qy))
        wave_x = np.exp(1j * np.outer(x, modes.qx))
        qx, qy = modes.qx[None, :], modes.qy[:, None]
        for kernel, out in (
            (layer.displacement(qx, qy, depth), displacement),
            (layer.stress(qx, qy, depth), stress),
        ):
            flat = (coefficients[..., None] * kernel).reshape(modes.shape[0], -1)
            lines = (wave_y @ flat).reshape(len(rows), len(modes.qx), -1)
            out.append(np.einsum("px,pxc->pc", wave_x, lines[row_of_point]).real)
    return np.array(displacement), np.array(stress)
