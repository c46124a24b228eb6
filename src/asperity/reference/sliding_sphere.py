"""Stress in a half-space under a sphere in gross sliding: Hertz's pressure and a shear traction μ p along x.

The traction is ``q0 √(1 − r²/a²)`` with q0 = μ p0 in the whole contact. Its effect on the pressure is
neglected; there is none if both solids have the same elastic constants or are incompressible. Sources: G. M.
Hamilton, L. E. Goodman, J. Appl. Mech. 33 (1966) 371, DOI 10.1115/1.3625051; G. M. Hamilton, Proc. Inst.
Mech. Eng. C 197 (1983) 53, DOI 10.1243/PIME_PROC_1983_197_076_02; K. L. Johnson, Contact Mechanics, Cambridge
University Press, 1985, sections 3.6 and 7.1. The stress under the pressure comes from
`asperity.reference.hertz`; the stress under the traction is derived here in the complex form of Hamilton and
Goodman, with z the depth.

With the potentials ``φ0 = ∫∫ q/ρ dS``, ``∂φ1/∂z = φ0``, ``∂φ2/∂z = φ1`` Cerruti's solution for a traction
along x is (Johnson, section 3.2; commas denote derivatives, z and the shear stresses along z count downward)

    2π σ_xx = 2(1 + ν) φ0,x + 2ν φ2,xxx − z φ1,xxx,      2π σ_xy = φ0,y + 2ν φ2,xxy − z φ1,xxy,
    2π σ_yy = 2ν φ0,x + 2ν φ2,xyy − z φ1,xyy,            2π σ_xz = φ0,z − z φ0,xx,
    2π σ_zz = −z φ0,xz,                                  2π σ_yz = −z φ0,xy.

The potential of the traction equals the potential of a line of point sources at the complex depths i t,

    φ0 = π q0 / (2a) ∫_{−a}^{a} (a² − t²) / R(z + i t) dt,      R(z) = √(r² + z²),

which has the right value on the surface, π² q0 (2a² − r²)/(4a) inside the contact. Let L0 = 1/R and L_n+1 be
an integral of L_n along z: L1 = ln(R + z), L2 = z ln(R + z) − R and so on. Integrating by parts twice,

    φ_n = π q0 / (2a) [4 Im L_n+3 − 4a Re L_n+2]   at z + i a.

The derivatives of L_n with respect to s = r² are short in ``w = R + z``, for which ``∂w/∂z = w/R`` and
``2R = w + s/w``:

    L1' = 1/(2Rw)          L2' = −1/(2w)         L3' = −(z/w + ln w)/4
    L2'' = 1/(4Rw²)        L3'' = −1/(8w²)       L4'' = (1/w + s/(3w³))/16
                                                 L5'' = (ln w − 2s/(3w²) − s²/(12w⁴))/32
    L3''' = 1/(8Rw³)       L4''' = −1/(24w³)     L5''' = (1/w² + s/(2w⁴))/96

Nothing cancels on the axis, at the surface or at the edge of contact. Far away, at a distance d, rounding
errors grow as (d/a)³.
"""

from dataclasses import dataclass

import numpy as np

from asperity.core.types import Array, ArrayLike
from asperity.reference.hertz import Hertz


@dataclass(frozen=True)
class SlidingSphere:
    """Sphere that slides on a half-space and drags its surface along x.

    Parameters
    ----------
    contact : Hertz
        Contact of the sphere, with its pressure p.
    friction : float
        Coefficient of friction μ: the traction on the half-space is μ p along +x, or along −x if μ < 0.

    Raises
    ------
    ValueError
        If the coefficient of friction is not finite.

    Examples
    --------
    >>> ball = asp.reference.hertz.Hertz(contact_radius=0.1, curvature_radius=1.0)
    >>> sliding = asp.reference.sliding_sphere.SlidingSphere(ball, friction=0.3)
    >>> sliding.stress(0.0, 0.0, 0.05, poisson=0.3).shape  # xx, yy, zz, yz, xz, xy
    (6,)
    """

    contact: Hertz
    friction: float

    def __post_init__(self) -> None:
        if not np.isfinite(self.friction):
            raise ValueError(f"friction = {self.friction!r}: a finite number is needed")

    def stress(self, y: ArrayLike, x: ArrayLike, depth: ArrayLike, poisson: float) -> Array:
        """Stress by pressure and traction.

        Parameters
        ----------
        y, x : array_like
            Positions relative to the axis.
        depth : array_like
            Depths ≥ 0. All three broadcast.
        poisson : float

        Returns
        -------
        (..., 6) array
            In the order xx, yy, zz, yz, xz, xy, in the unit of the effective modulus.

        Raises
        ------
        ValueError
            If a depth is negative.
        """
        return self.contact.stress_cartesian(y, x, depth, poisson) + self.traction_stress(
            y, x, depth, poisson
        )

    def traction_stress(self, y: ArrayLike, x: ArrayLike, depth: ArrayLike, poisson: float) -> Array:
        """Stress by the traction alone; arguments, result and errors as for `stress`."""
        a = self.contact.contact_radius
        y, x, z = np.broadcast_arrays(*(np.asarray(part, float) / a for part in (y, x, depth)))
        if np.any(z < 0):
            raise ValueError("depth must be ≥ 0 everywhere")
        # For the traction √(1 − r²) along x on the unit circle, with z downward.
        nu, s = poisson, x**2 + y**2
        below = z + 1j
        root = np.sqrt(s + below**2)
        w = root + below
        log = np.log(w)

        def potential(upper: Array, lower: Array) -> Array:
            """Derivative of φ_n / (2π) from the derivatives of L_n+3 and L_n+2."""
            return upper.imag - lower.real

        # Infinite at the edge of contact, where it is a factor of terms that vanish at the surface.
        inverse_root = np.divide(1, root, out=np.zeros_like(root), where=root != 0)
        first = {1: 0.5 * inverse_root / w, 2: -0.5 / w, 3: -0.25 * (below / w + log)}
        second = {
            2: 0.25 * inverse_root / w**2,
            3: -0.125 / w**2,
            4: (1 / w + s / (3 * w**3)) / 16,
            5: (log - 2 * s / (3 * w**2) - s**2 / (12 * w**4)) / 32,
        }
        third = {3: 0.125 * inverse_root / w**3, 4: -1 / (24 * w**3), 5: (1 / w**2 + s / (2 * w**4)) / 96}

        # Derivatives of φ0/(2π), φ1/(2π) and φ2/(2π) with respect to s; slope_z is ∂(φ0/(2π))/∂z.
        slope0, bend0 = potential(first[3], first[2]), potential(second[3], second[2])
        bend1, twist1 = potential(second[4], second[3]), potential(third[4], third[3])
        bend2, twist2 = potential(second[5], second[4]), potential(third[5], third[4])
        slope0_z = potential(first[2], first[1])
        slope_z = potential(below * log - root, log)

        def triple(bend: Array, twist: Array) -> tuple[Array, Array, Array]:
            """Derivatives xxx, xyy and xxy of a function of s from its second and third derivative."""
            return (
                12 * x * bend + 8 * x**3 * twist,
                4 * x * bend + 8 * x * y**2 * twist,
                4 * y * bend + 8 * x**2 * y * twist,
            )

        deep = [z * part for part in triple(bend1, twist1)]
        plane = triple(bend2, twist2)
        xx = 4 * (1 + nu) * x * slope0 + 2 * nu * plane[0] - deep[0]
        yy = 4 * nu * x * slope0 + 2 * nu * plane[1] - deep[1]
        xy = 2 * y * slope0 + 2 * nu * plane[2] - deep[2]
        zz = -z * 2 * x * slope0_z
        xz = slope_z - z * (2 * slope0 + 4 * x**2 * bend0)
        yz = -z * 4 * x * y * bend0
        # The shear stresses along z change sign with the direction of z.
        scale = self.friction * self.contact.maximum_pressure
        return scale * np.stack([xx, yy, zz, -yz, -xz, xy], axis=-1)
