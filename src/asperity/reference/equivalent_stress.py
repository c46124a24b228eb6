"""Scalar measures of a stress with six components xx, yy, zz, yz, xz, xy along the last axis."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity.types import Array


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
