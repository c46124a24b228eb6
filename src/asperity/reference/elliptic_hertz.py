"""Hertz contact with an ellipse of contact: two curvatures, pressed without friction into a half-space.

The pressure is ``p0 √(1 − x²/a² − y²/b²)`` on an ellipse with semi-axes a ≥ b, a along x (H. Hertz, J. reine
angew. Math. 92 (1882) 156, DOI 10.1515/crll.1882.92.156; K. L. Johnson, Contact Mechanics, Cambridge
University Press, 1985, sections 3.5, 4.2 and 4.5; A. Sackfield, D. A. Hills, J. Strain Anal. 18 (1983) 101,
DOI 10.1243/03093247V182101).

The stress follows from the potential ``V = ∫∫ p/ρ dS``, with ``S(w) = √((a² + w)(b² + w) w)``

    V = π a b p0 / 2 ∫_λ^∞ (1 − x²/(a² + w) − y²/(b² + w) − z²/w) dw / S(w),

where λ is the largest root of the bracket and z the depth, as

    σ_zz = (∂V/∂z − z ∂²V/∂z²)/(2π),    σ_xx = (2ν ∂V/∂z − z ∂²V/∂x² − (1 − 2ν) ∂²χ/∂x²)/(2π),    ∂χ/∂z = V,

and likewise σ_yy (A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377, DOI 10.1098/rsta.1929.0009). On the
axis λ = z². With ``P = √((a² + z²)(b² + z²))``, ``T = √((b² + z²)/(a² + z²))`` and the integrals

    I_x = ∫ dw / ((a² + w) S),    J_x = ∫ √w dw / ((a² + w) S) = 2 / ((a² + z²)(1 + T)),
    I_y = ∫ dw / ((b² + w) S),    J_y = ∫ √w dw / ((b² + w) S) = 2 / (P (1 + T)),

all from z² to infinity, they are

    σ_zz = −p0 a b / P,
    σ_xx = p0 a b (z I_x + ν z I_y − 2ν/P − (1 − 2ν) J_x / 2),
    σ_yy = p0 a b (z I_y + ν z I_x − 2ν/P − (1 − 2ν) J_y / 2).

I_x and I_y are Carlson's elliptic integrals R_D, in which, unlike in Legendre's integrals K and E, nothing
cancels when the ellipse becomes a circle.
"""

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
import scipy  # whose parts are loaded when they are first used

from asperity.core.arguments import require_positive
from asperity.core.types import Array, ArrayLike
from asperity.reference.hertz import von_mises

SMALLEST_AXIS_RATIO = 1e-6
"""Smallest ratio b/a that is looked for when the ellipse is computed from its curvatures."""

DEPTH_SAMPLES = 200
"""Depths from the surface to 2 b on which a maximum is located before it is refined; it lies above 0.8 b."""


class AxisPeak(NamedTuple):
    """Largest value of a stress measure on the axis, and its depth."""

    value: float
    depth: float


@dataclass(frozen=True)
class EllipticHertz:
    """Contact of a paraboloid ``x²/(2 R_x) + y²/(2 R_y)``, R_x ≥ R_y, with a half-space.

    Parameters
    ----------
    semi_major, semi_minor : float
        Semi-axes a ≥ b of the ellipse of contact, along x and y.
    maximum_pressure : float
        Pressure p0 on the axis.
    effective_modulus : float
        E* = E / (1 − ν²) of the half-space, in the unit of the pressure.

    Raises
    ------
    ValueError
        If one of them is not positive and finite, or if b > a.

    Examples
    --------
    >>> contact = asp.reference.elliptic_hertz.EllipticHertz(0.2, 0.1, maximum_pressure=0.05)
    >>> round(contact.load, 6)  # 2/3 π a b p0
    0.002094
    """

    semi_major: float
    semi_minor: float
    maximum_pressure: float
    effective_modulus: float = 1.0

    def __post_init__(self) -> None:
        require_positive(**self.__dict__)
        if self.semi_minor > self.semi_major:
            raise ValueError(
                f"semi_minor = {self.semi_minor!r}: at most semi_major = {self.semi_major!r} is needed"
            )

    @classmethod
    def from_load(
        cls,
        load: float,
        curvature_radius_x: float,
        curvature_radius_y: float,
        effective_modulus: float = 1.0,
    ) -> Self:
        """Contact under a force of a paraboloid with principal radii of curvature R_x ≥ R_y.

        Raises
        ------
        ValueError
            If an argument is not positive and finite, if R_y > R_x, or if the ratio of the radii is so large
            that b/a is below `SMALLEST_AXIS_RATIO`.
        """
        require_positive(load=load, effective_modulus=effective_modulus)
        require_positive(curvature_radius_x=curvature_radius_x, curvature_radius_y=curvature_radius_y)
        wanted = curvature_radius_x / curvature_radius_y
        if wanted < 1:
            raise ValueError(
                f"curvature_radius_y = {curvature_radius_y!r}: "
                f"at most curvature_radius_x = {curvature_radius_x!r} is needed"
            )

        def excess(logarithm: float) -> float:
            along_x, along_y = _curvature_integrals(np.exp(logarithm))
            return float(np.log(along_y / along_x / wanted))

        lowest = np.log(SMALLEST_AXIS_RATIO)
        if excess(lowest) < 0:
            raise ValueError(
                f"curvature_radius_x = {curvature_radius_x!r}: "
                f"{wanted:.3g} times curvature_radius_y is too much for b/a ≥ {SMALLEST_AXIS_RATIO:g}"
            )
        ratio = float(np.exp(scipy.optimize.brentq(excess, lowest, 0.0, xtol=1e-15)))
        # p0 of `curvature_radii` inserted into F = 2/3 π a b p0.
        integral, _ = _curvature_integrals(ratio)
        semi_major = float(np.cbrt(3 * load * curvature_radius_x * integral / (np.pi * effective_modulus)))
        semi_minor = ratio * semi_major
        pressure = 1.5 * load / (np.pi * semi_major * semi_minor)
        return cls(semi_major, semi_minor, pressure, effective_modulus)

    @property
    def load(self) -> float:
        """Force, 2/3 π a b p0."""
        return 2 / 3 * np.pi * self.semi_major * self.semi_minor * self.maximum_pressure

    @property
    def mean_contact_pressure(self) -> float:
        """Load over contact area, two thirds of the maximum pressure."""
        return 2 / 3 * self.maximum_pressure

    @property
    def approach(self) -> float:
        """Displacement of the indenter from first touch, ``p0 b K / E*``.

        K is the complete elliptic integral of the first kind of the eccentricity √(1 − b²/a²).
        """
        scale = self.maximum_pressure * self.semi_minor / self.effective_modulus
        return scale * float(scipy.special.ellipk((1 - self._ratio) * (1 + self._ratio)))

    @property
    def curvature_radii(self) -> tuple[float, float]:
        """Principal radii of curvature R_x ≥ R_y of the indenter.

        ``1/R_x = 2 p0 b D / (E* a²)`` and ``1/R_y = 2 p0 D' / (E* b)`` with ``D = (K − E)/e²``, ``D' = K −
        D`` and the complete elliptic integrals K and E of the eccentricity e.
        """
        along_x, along_y = _curvature_integrals(self._ratio)
        scale = 2 * self.maximum_pressure * self.semi_minor / self.effective_modulus
        return self.semi_major**2 / (scale * along_x), self.semi_major**2 / (scale * along_y)

    def pressure(self, y: ArrayLike, x: ArrayLike) -> Array:
        """Contact pressure at positions relative to the axis, zero outside the contact; y and x broadcast."""
        y, x = np.asarray(y, float) / self.semi_minor, np.asarray(x, float) / self.semi_major
        return self.maximum_pressure * np.sqrt(np.maximum(1 - x**2 - y**2, 0.0))

    def stress_on_axis(self, depth: ArrayLike, poisson: float) -> Array:
        """Stress on the axis, where the coordinate axes are principal axes.

        Parameters
        ----------
        depth : array_like
            Depths ≥ 0.
        poisson : float

        Returns
        -------
        (..., 6) array
            In the order xx, yy, zz, yz, xz, xy; the shear stresses are zero.

        Raises
        ------
        ValueError
            If a depth is negative.
        """
        nu, a, b = poisson, self.semi_major, self.semi_minor
        z = np.asarray(depth, float)
        if np.any(z < 0):
            raise ValueError("depth must be ≥ 0 everywhere")
        along_x, along_y = a**2 + z**2, b**2 + z**2
        product, slenderness = np.sqrt(along_x * along_y), np.sqrt(along_y / along_x)
        z_x = z * 2 / 3 * scipy.special.elliprd(z**2, along_y, along_x)
        z_y = z * 2 / 3 * scipy.special.elliprd(z**2, along_x, along_y)
        plane_x = (1 - 2 * nu) / (along_x * (1 + slenderness))
        plane_y = (1 - 2 * nu) / (product * (1 + slenderness))
        scale = self.maximum_pressure * a * b
        xx = scale * (z_x + nu * z_y - 2 * nu / product - plane_x)
        yy = scale * (z_y + nu * z_x - 2 * nu / product - plane_y)
        none = np.zeros_like(xx)
        return np.stack([xx, yy, -scale / product, none, none, none], axis=-1)

    def maximum_von_mises_on_axis(self, poisson: float) -> AxisPeak:
        """Maximum von Mises stress on the axis, and its depth: a sample, refined between its neighbours."""

        def measure(depth: ArrayLike) -> Array:
            return von_mises(self.stress_on_axis(depth, poisson))

        depths = np.linspace(0.0, 2 * self.semi_minor, DEPTH_SAMPLES + 1)
        at = int(measure(depths).argmax())
        found = scipy.optimize.minimize_scalar(
            lambda depth: -float(measure(depth)),
            bounds=(depths[max(at - 1, 0)], depths[min(at + 1, DEPTH_SAMPLES)]),
            method="bounded",
            options={"xatol": 1e-10 * self.semi_minor},
        )
        depth = max(float(found.x), float(depths[at]), key=measure)
        return AxisPeak(float(measure(depth)), depth)

    @property
    def _ratio(self) -> float:
        """Axis ratio b/a."""
        return self.semi_minor / self.semi_major


def _curvature_integrals(ratio: float) -> tuple[float, float]:
    """Integrals D and D' (a/b)² of `EllipticHertz.curvature_radii` for an axis ratio b/a."""
    return float(scipy.special.elliprd(0.0, ratio**2, 1.0)) / 3, float(
        scipy.special.elliprd(0.0, 1.0, ratio**2)
    ) / 3
