"""Hertz contact of a cylinder with a half-space: pressure and stress in plane strain, at rest or sliding.

The pressure is ``p0 √(1 − x²/b²)`` for every y, the shear traction a multiple of it. With lengths over b
and z the depth, ``m² = (√(A² + 4x²z²) + A)/2``, ``n² = (√(A² + 4x²z²) − A)/2`` with ``A = 1 − x² + z²`` and n
of the sign of x, the stress is in closed form (E. McEwen, Phil. Mag. 40 (1949) 454, DOI
10.1080/14786444908521733; K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985, Eqs. 4.49 and
7.8; the traction along y is in antiplane shear, with the analytic function m − z + i (x − n) of x + iz).
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from asperity.core.arguments import require_positive
from asperity.core.types import Array


@dataclass(frozen=True)
class LineHertz:
    """Contact of a parabolic cylinder along y with a half-space.

    Parameters
    ----------
    half_width : float
        Half-width b of the contact along x.
    largest_pressure : float
        Pressure p0 on the axis; stresses are in its unit.

    Raises
    ------
    ValueError
        If one of them is not positive and finite.
    """

    half_width: float
    largest_pressure: float

    def __post_init__(self) -> None:
        require_positive(**self.__dict__)

    @classmethod
    def from_load(cls, load: float, curvature_radius: float, effective_modulus: float = 1.0) -> Self:
        """Contact under a force per length P, ``b² = 4 P R / (π E*)``, ``p0 = 2 P / (π b)``."""
        require_positive(load=load, curvature_radius=curvature_radius, effective_modulus=effective_modulus)
        half_width = float(np.sqrt(4 * load * curvature_radius / (np.pi * effective_modulus)))
        return cls(half_width, 2 * load / (np.pi * half_width))

    def stress(
        self, x: ArrayLike, depth: ArrayLike, poisson: float, traction: tuple[float, float] = (0.0, 0.0)
    ) -> Array:
        """Stress at places x, depth ≥ 0; they broadcast.

        Parameters
        ----------
        x, depth : array_like
        poisson : float
        traction : (x, y)
            Shear traction on the half-space over the pressure.

        Returns
        -------
        (..., 6) array
            In the order xx, yy, zz, yz, xz, xy, z upward.
        """
        along, across = traction
        x, z = np.broadcast_arrays(*(np.asarray(each, float) / self.half_width for each in (x, depth)))
        square = 1 - x**2 + z**2
        root = np.hypot(square, 2 * x * z)
        with np.errstate(divide="ignore", invalid="ignore"):
            m2 = np.where(square > 0, (root + square) / 2, 2 * (x * z) ** 2 / (root - square))
            n2 = np.where(square > 0, 2 * (x * z) ** 2 / (root + square), (root - square) / 2)
            m2, n2 = np.where(root > 0, (m2, n2), 0.0)
            ratio = np.where(root > 0, (z**2 + n2) / root, 1.0)
            share = np.where(root > 0, (m2 - z**2) / root, 0.0)
        m, n = np.sqrt(m2), np.sign(x) * np.sqrt(n2)
        xx = 2 * z - m * (1 + ratio) + along * (n * (2 + share) - 2 * x)
        zz = -m * (1 - ratio) - along * n * share
        xz = n * share + along * (m * (1 + ratio) - 2 * z)
        yz, xy = across * (m - z), across * (n - x)
        return self.largest_pressure * np.stack([xx, poisson * (xx + zz), zz, yz, xz, xy], axis=-1)
