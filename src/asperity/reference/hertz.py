"""Hertz contact of a smooth rigid sphere or cylinder with an elastic half-space.

For a sphere without friction: the pressure ``p0 √(1 − r²/a²)`` on a circle of radius a, the displacement of
the surface under it, and the stress everywhere below (H. Hertz, J. reine angew. Math. 92 (1882) 156, DOI
10.1515/crll.1882.92.156; stress: M. T. Huber, Ann. Phys. 319 (1904) 153, DOI 10.1002/andp.19043190612;
surface: K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985, eqs. 3.37–3.42).

Huber's stress is written here in the oblate spheroidal coordinates u, c of the contact circle, ``r² = (a² +
u)(1 − c²)``, ``depth = c √u`` with ``u ≥ 0`` and ``0 ≤ c ≤ 1``. In this form no two large terms cancel on
the axis, at the surface or far away.
"""

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
import scipy  # whose parts are loaded when they are first used

from asperity.core.arguments import require_positive
from asperity.core.types import Array, ArrayLike


class AxisymmetricStress(NamedTuple):
    """Cylindrical stress components, tension positive, z up; the two others are zero by symmetry.

    Attributes
    ----------
    radial, hoop, axial, shear : arrays
        σ_rr, σ_θθ, σ_zz and σ_rz, all of one shape.
    """

    radial: Array
    hoop: Array
    axial: Array
    shear: Array

    @property
    def von_mises(self) -> Array:
        """Von Mises stress."""
        radial, hoop, axial, shear = self
        square = (radial - hoop) ** 2 + (hoop - axial) ** 2 + (axial - radial) ** 2
        return np.sqrt(0.5 * square + 3 * shear**2)


@dataclass(frozen=True)
class Hertz:
    """Contact of a paraboloid ``r² / (2 R)`` with a half-space.

    Parameters
    ----------
    contact_radius : float
        Radius a of the contact circle.
    curvature_radius : float
        Radius of curvature R of the indenter.
    effective_modulus : float
        E* = E / (1 − ν²) of the half-space; stresses are in its unit.

    Raises
    ------
    ValueError
        If one of them is not positive and finite.

    Examples
    --------
    >>> ball = asp.reference.hertz.Hertz(contact_radius=0.1, curvature_radius=1.0)
    >>> round(ball.maximum_pressure, 4)  # 2 E* a/(π R)
    0.0637
    """

    contact_radius: float
    curvature_radius: float
    effective_modulus: float = 1.0

    def __post_init__(self) -> None:
        require_positive(**self.__dict__)

    @classmethod
    def from_load(cls, load: float, curvature_radius: float, effective_modulus: float = 1.0) -> Self:
        """Contact under a force F, ``a³ = 3 F R / (4 E*)``."""
        require_positive(load=load, curvature_radius=curvature_radius, effective_modulus=effective_modulus)
        contact_radius = np.cbrt(0.75 * load * curvature_radius / effective_modulus)
        return cls(float(contact_radius), curvature_radius, effective_modulus)

    @classmethod
    def from_approach(cls, approach: float, curvature_radius: float, effective_modulus: float = 1.0) -> Self:
        """Contact at an approach δ, ``a² = R δ``."""
        require_positive(approach=approach, curvature_radius=curvature_radius)
        return cls(float(np.sqrt(approach * curvature_radius)), curvature_radius, effective_modulus)

    @property
    def maximum_pressure(self) -> float:
        """Pressure p0 on the axis, ``2 E* a / (π R)``."""
        return 2 / np.pi * self.effective_modulus * self.contact_radius / self.curvature_radius

    @property
    def mean_contact_pressure(self) -> float:
        """Load over contact area, two thirds of the maximum pressure; P_0 in the paper."""
        return 2 / 3 * self.maximum_pressure

    @property
    def load(self) -> float:
        """Force on the indenter, ``4 E* a³ / (3 R)``."""
        return 4 / 3 * self.effective_modulus * self.contact_radius**3 / self.curvature_radius

    @property
    def approach(self) -> float:
        """Displacement of the indenter from first touch, ``a² / R``."""
        return self.contact_radius**2 / self.curvature_radius

    def pressure(self, r: ArrayLike) -> Array:
        """Contact pressure at distances `r` from the axis, in the shape of `r`; zero outside the contact."""
        inside = 1 - (np.asarray(r, float) / self.contact_radius) ** 2
        return self.maximum_pressure * np.sqrt(np.maximum(inside, 0.0))

    def displacement(self, r: ArrayLike) -> Array:
        """Downward displacement of the surface at distances `r` from the axis (Eq. 11 without replicas)."""
        scale = self.maximum_pressure * self.contact_radius / (2 * self.effective_modulus)
        return scale * unit_displacement(np.asarray(r, float) / self.contact_radius)

    def stress(self, r: ArrayLike, depth: ArrayLike, poisson: float) -> AxisymmetricStress:
        """Stress below the surface in cylindrical components.

        Parameters
        ----------
        r, depth : array_like
            Distance from the axis and depth, both ≥ 0; they broadcast.
        poisson : float

        Returns
        -------
        AxisymmetricStress
            Four arrays of the broadcast shape, in the unit of the effective modulus. On the surface at the
            edge of contact, where radial and hoop stress have a kink, their limit.

        Raises
        ------
        ValueError
            If a distance or a depth is negative.
        """
        nu = poisson
        rho, zeta = np.broadcast_arrays(
            np.asarray(r, float) / self.contact_radius, np.asarray(depth, float) / self.contact_radius
        )
        if np.any(rho < 0) or np.any(zeta < 0):
            raise ValueError("r and depth must be ≥ 0 everywhere")
        above = rho**2 + zeta**2 - 1
        root = np.hypot(above, 2 * zeta)
        outside = above > 0
        with np.errstate(divide="ignore", invalid="ignore"):
            u = np.where(outside, 0.5 * (root + above), 2 * zeta**2 / (root - above))
            c2 = np.where(outside, 2 * zeta**2 / (root + above), 0.5 * (root - above))
            u, c2 = np.where(root > 0, (u, c2), 0.0)
            c, w = np.sqrt(c2), np.sqrt(u)
            edge = np.where(root > 0, c2 / (u + c2), 0.0)
        angle = w * np.arctan2(1.0, w)
        plane = (1 - 2 * nu) / 3 * (1 + c + c2) / ((1 + c) * (1 + u))
        axial = -c * edge
        radial = plane - axial + c * ((1 - nu) * u / (1 + u) + (1 + nu) * angle - 2)
        hoop = -plane - c * (2 * nu + (1 - nu) * u / (1 + u) - (1 + nu) * angle)
        shear = rho * w * edge / (1 + u)
        return AxisymmetricStress(*(self.maximum_pressure * part for part in (radial, hoop, axial, shear)))

    def stress_cartesian(self, y: ArrayLike, x: ArrayLike, depth: ArrayLike, poisson: float) -> Array:
        """Stress at positions relative to the axis, (..., 6) in the order xx, yy, zz, yz, xz, xy."""
        y, x, depth = np.broadcast_arrays(*(np.asarray(part, float) for part in (y, x, depth)))
        r = np.hypot(y, x)
        radial, hoop, axial, shear = self.stress(r, depth, poisson)
        cosine = np.divide(x, r, out=np.ones_like(r), where=r > 0)
        sine = np.divide(y, r, out=np.zeros_like(r), where=r > 0)
        xx, yy = radial * cosine**2 + hoop * sine**2, radial * sine**2 + hoop * cosine**2
        xy = (radial - hoop) * sine * cosine
        return np.stack([xx, yy, axial, shear * sine, shear * cosine, xy], axis=-1)


@dataclass(frozen=True)
class LineHertz:
    """Contact of a parabolic cylinder along y with a half-space, in plane strain, at rest or sliding.

    The pressure is ``p0 √(1 − x²/b²)`` for every y, the shear traction a multiple of it. With lengths over b
    and z the depth, ``m² = (√(A² + 4x²z²) + A)/2``, ``n² = (√(A² + 4x²z²) − A)/2`` with ``A = 1 − x² + z²``
    and n of the sign of x, the stress is in closed form (E. McEwen, Phil. Mag. 40 (1949) 454, DOI
    10.1080/14786444908521733; K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985, Eqs. 4.49
    and 7.8; the traction along y is in antiplane shear, with the analytic function m − z + i (x − n) of x +
    iz).

    Parameters
    ----------
    half_width : float
        Half-width b of the contact along x.
    maximum_pressure : float
        Pressure p0 on the axis; stresses are in its unit.

    Raises
    ------
    ValueError
        If one of them is not positive and finite.
    """

    half_width: float
    maximum_pressure: float

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
        return self.maximum_pressure * np.stack([xx, poisson * (xx + zz), zz, yz, xz, xy], axis=-1)


def unit_displacement(rho: ArrayLike) -> Array:
    """Dimensionless displacement of the surface at ρ = r/a, in the shape of `rho`.

    π/2 (2 − ρ²) inside the contact, ``(2 − ρ²) asin(1/ρ) + √(ρ² − 1)`` outside: the bracket of Eqs. 11 and
    12 over a². The printed form has a rounding error of ρ² ε far away. Therefore the hypergeometric function
    that equals it is evaluated.
    """
    rho = np.asarray(rho, float)
    inverse = 1 / np.maximum(rho, 1.0)
    outside = 4 / 3 * inverse * scipy.special.hyp2f1(0.5, 0.5, 2.5, inverse**2)
    return np.where(rho <= 1, 0.5 * np.pi * (2 - rho**2), outside)


def von_mises(stress: ArrayLike) -> Array:
    """Von Mises stress of a (..., 6) array in the order xx, yy, zz, yz, xz, xy, (...)."""
    xx, yy, zz, yz, xz, xy = np.moveaxis(np.asarray(stress, float), -1, 0)
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.sqrt(0.5 * normal + 3 * (yz**2 + xz**2 + xy**2))
