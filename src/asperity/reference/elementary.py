"""Half-space under one harmonic of pressure or a point force, and scalar measures of a stress.

All other loads are sums of these. Stress components are in the order xx, yy, zz, yz, xz, xy.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity.core.arguments import require_positive
from asperity.core.types import Array


def single_mode_stress(x: ArrayLike, depth: ArrayLike, wavenumber: float, poisson: float) -> Array:
    """Stress under the pressure ``cos qx`` of unit amplitude, in plane strain along y.

    Source: K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985, section 13.2. The mean
    pressure is zero, and there is no uniform stress.

    Parameters
    ----------
    x, depth : array_like
        Positions; they broadcast.
    wavenumber : float
        q > 0.
    poisson : float

    Returns
    -------
    (..., 6) array
    """
    require_positive(wavenumber=wavenumber)
    phase, y = np.broadcast_arrays(wavenumber * np.asarray(x, float), wavenumber * np.asarray(depth, float))
    even, odd = np.cos(phase) * np.exp(-y), np.sin(phase) * np.exp(-y)
    none = np.zeros_like(even)
    return np.stack([-(1 - y) * even, -2 * poisson * even, -(1 + y) * even, none, y * odd, none], axis=-1)


def single_mode_displacement(
    x: ArrayLike, depth: ArrayLike, wavenumber: float, young: float, poisson: float
) -> Array:
    """Displacement (x, y, z), z up, under the pressure ``cos qx`` of unit amplitude, (..., 3).

    Arguments as for `single_mode_stress`; `young` is in the unit of the pressure.
    """
    require_positive(wavenumber=wavenumber, young=young)
    phase, y = np.broadcast_arrays(wavenumber * np.asarray(x, float), wavenumber * np.asarray(depth, float))
    scale = (1 + poisson) / (young * wavenumber) * np.exp(-y)
    along = -scale * (1 - 2 * poisson - y) * np.sin(phase)
    up = -scale * (2 * (1 - poisson) + y) * np.cos(phase)
    return np.stack([along, np.zeros_like(along), up], axis=-1)


def point_force_stress(y: ArrayLike, x: ArrayLike, depth: ArrayLike, poisson: float) -> Array:
    """Stress under a unit force pressing on the surface at the origin: Boussinesq's solution.

    Source: K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985, eq. 3.19; rearranged so that
    no two large terms cancel near the axis. The stress is infinite at the origin.

    Parameters
    ----------
    y, x, depth : array_like
        Positions relative to the force; they broadcast.
    poisson : float

    Returns
    -------
    (..., 6) array
    """
    n_x, n_y, n_z, spread = _direction(y, x, depth)
    weight, cubic = (1 - 2 * poisson) / spread, 3 / spread
    # (1 − n_z)/(n_x² + n_y²) = 1/(1 + n_z)
    blunt = (2 + n_z) / (1 + n_z) ** 2
    xx = -cubic * n_x**2 * n_z + weight * (n_z - 1 / (1 + n_z) + n_x**2 * blunt)
    yy = -cubic * n_y**2 * n_z + weight * (n_z - 1 / (1 + n_z) + n_y**2 * blunt)
    xy = -cubic * n_x * n_y * n_z + weight * n_x * n_y * blunt
    zz = -cubic * n_z**3
    return np.stack([xx, yy, zz, cubic * n_y * n_z**2, cubic * n_x * n_z**2, xy], axis=-1)


def tangential_point_force_stress(y: ArrayLike, x: ArrayLike, depth: ArrayLike, poisson: float) -> Array:
    """Stress under a unit force along x on the surface at the origin: Cerruti's solution, (..., 6).

    Source: K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985, eq. 3.76. Arguments as for
    `point_force_stress`.
    """
    n_x, n_y, n_z, spread = _direction(y, x, depth)
    weight, cubic = (1 - 2 * poisson) / spread, 3 / spread
    single = 1 / (1 + n_z) ** 2
    double = (3 + n_z) / (1 + n_z) ** 3
    xx = -cubic * n_x**3 + weight * n_x * (1 - 3 * single + n_x**2 * double)
    yy = -cubic * n_x * n_y**2 + weight * n_x * (1 - single + n_y**2 * double)
    xy = -cubic * n_x**2 * n_y + weight * n_y * (-single + n_x**2 * double)
    zz = -cubic * n_x * n_z**2
    return np.stack([xx, yy, zz, cubic * n_x * n_y * n_z, cubic * n_x**2 * n_z, xy], axis=-1)


def _direction(y: ArrayLike, x: ArrayLike, depth: ArrayLike) -> tuple[Array, Array, Array, Array]:
    """Direction (x, y, depth) of positions from the origin, and the area of the half sphere through them."""
    y, x, depth = np.broadcast_arrays(*(np.asarray(part, float) for part in (y, x, depth)))
    distance = np.sqrt(x**2 + y**2 + depth**2)
    return x / distance, y / distance, depth / distance, 2 * np.pi * distance**2


def von_mises(stress: ArrayLike) -> Array:
    """Von Mises stress of a (..., 6) array, (...)."""
    xx, yy, zz, yz, xz, xy = np.moveaxis(np.asarray(stress, float), -1, 0)
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.sqrt(0.5 * normal + 3 * (yz**2 + xz**2 + xy**2))


def largest_shear(stress: ArrayLike) -> Array:
    """Half of the difference of the largest and smallest principal stress of a (..., 6) array, (...)."""
    xx, yy, zz, yz, xz, xy = np.moveaxis(np.asarray(stress, float), -1, 0)
    tensor = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1)
    principal = np.linalg.eigvalsh(tensor.reshape(*xx.shape, 3, 3))
    return 0.5 * (principal[..., 2] - principal[..., 0])
