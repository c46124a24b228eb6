"""Axisymmetric frictionless contact with an elastic layer bonded to a rigid base or to a half-space.

A rigid flat punch or a paraboloid ``r²/(2R)`` is pressed into a layer of height h. The mixed boundary
conditions lead to dual integral equations and these to a Fredholm equation of the second kind, solved here
by Gauss–Legendre quadrature (N. N. Lebedev, Ia. S. Ufliand, J. Appl. Math. Mech. 22 (1958) 442; W. C. Hayes,
L. M. Keer, G. Herrmann, L. F. Mockros, J. Biomech. 5 (1972) 541, DOI 10.1016/0021-9290(72)90010-3).

Compliance of the layer
-----------------------
Under the pressure cos ξx the surface is displaced downward by ``2/(E* ξ) K(ξh) cos ξx``. With ζ the distance
from the base, G the shear modulus and κ = 3 − 4ν, displacements ``2G u = κ ψ e_ζ − ζ ∇ψ + ∇φ`` with harmonic
ψ and φ are in equilibrium (Papkovich, Neuber). Two of them vanish on the base:

    ψ = sinh ξζ cos ξx, φ = 0,    and    ψ = cosh ξζ cos ξx, φ = −κ/ξ sinh ξζ cos ξx.

Their combination without shear stress at ζ = h has, with t = ξh,

    K(t) = (κ sinh t cosh t − t) / (κ sinh² t + 4(1 − ν)² + t²).

An axisymmetric pressure ``p(r) = ∫_0^∞ ξ P(ξ) J0(ξr) dξ`` displaces the surface by
``2/E* ∫_0^∞ K(ξh) P(ξ) J0(ξr) dξ``.

On an elastic half-space, with the amplitudes ρ = (Γ − 1)/(Γ + κ) and σ = (Γ κ' − κ)/(Γ κ' + 1) of the field
reflected by the interface, Γ = G/G', the prime for the half-space (D. M. Burmister, J. Appl. Phys. 16
(1945) 89, DOI 10.1063/1.1707558),

    K(t) = (1 + 4 t ρ e^(−2t) − ρ σ e^(−4t)) / ((1 − ρ e^(−2t)) (1 − σ e^(−2t)) − 4 t² ρ e^(−2t)).

Fredholm equation
-----------------
With ``P(ξ) = ∫_0^a φ(t) cos ξt dt`` the pressure is zero outside the contact, r > a. For the displacement
``δ − r²/(2R)`` inside, φ must satisfy

    φ(s) − 2/π ∫_0^a M(s, t) φ(t) dt = E*/π (δ − s²/R),
    M(s, t) = (m(s + t) + m(s − t))/2,    m(x) = 1/h ∫_0^∞ (1 − K(u)) cos(ux/h) du.

The load is ``2π ∫_0^a φ dt`` and the pressure ``φ(a)/√(a² − r²) − ∫_r^a φ'(t) dt/√(t² − r²)``. The pressure
of a paraboloid is finite at the edge, φ(a) = 0, which determines δ. For h → ∞ the kernel M vanishes, which
leaves Hertz contact and Boussinesq's flat punch.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.core.arguments import require_positive
from asperity.core.types import Array, ArrayLike

LARGEST_WAVENUMBER = 25.0
"""Upper end of the integrals over u = ξh: 1 − K falls as 4u² e^(−2u) and is below rounding there."""

WAVENUMBERS, WAVENUMBERS_PER_RATIO = 100, 30
"""Gauss–Legendre nodes of these integrals, and further ones per unit of a/h, since cos(ξa) oscillates."""

PRESSURE_NODES = 64
"""Gauss–Legendre nodes of the integral for the pressure."""


@dataclass(frozen=True)
class BondedLayer:
    """Elastic layer bonded to a rigid base, without friction at the top.

    Parameters
    ----------
    height : float
        Height h of the layer.
    poisson : float
        Poisson's ratio, −1 < ν ≤ 1/2.
    effective_modulus : float
        E* = E / (1 − ν²); pressures are in its unit.
    order : int
        Gauss–Legendre nodes of the Fredholm equation. With 64 the load is good to 10⁻¹² for contact radii up
        to 10 h, to 10⁻⁶ at 20 h.

    Raises
    ------
    ValueError
        If one of them is out of range.

    Examples
    --------
    >>> layer = asp.reference.bonded_layer.BondedLayer(height=0.5, poisson=0.3)
    >>> half_space = asp.reference.hertz.Hertz(contact_radius=0.2, curvature_radius=1.0)
    >>> bool(layer.paraboloid(0.2, 1.0).load > half_space.load)
    True
    """

    height: float
    poisson: float
    effective_modulus: float = 1.0
    order: int = 64

    def __post_init__(self) -> None:
        require_positive(height=self.height, effective_modulus=self.effective_modulus, order=self.order)
        if not -1 < self.poisson <= 0.5:
            raise ValueError(f"poisson = {self.poisson!r}: a number > -1 and ≤ 0.5 is needed")

    def compliance_ratio(self, scaled_wavenumber: ArrayLike) -> Array:
        """Surface compliance over the half-space's, K(t), at t = wavenumber × height > 0."""
        t = np.asarray(scaled_wavenumber, float)
        kappa, decay = 3 - 4 * self.poisson, np.exp(-2 * t)
        # Numerator and denominator are multiplied by 4 e^(−2t), so that they stay finite.
        above = kappa * (1 - decay**2) - 4 * t * decay
        below = kappa * (1 - decay) ** 2 + (16 * (1 - self.poisson) ** 2 + 4 * t**2) * decay
        return above / below

    def flat_punch(self, radius: float, approach: float) -> LayerContact:
        """Contact with a flat-ended cylindrical punch of a given radius at an approach."""
        require_positive(radius=radius, approach=approach)
        return LayerContact(self, radius, 0.0, approach)

    def paraboloid(self, contact_radius: float, curvature_radius: float) -> LayerContact:
        """Contact with a paraboloid ``r²/(2R)`` at a given contact radius."""
        require_positive(contact_radius=contact_radius, curvature_radius=curvature_radius)
        return LayerContact(self, contact_radius, 1 / curvature_radius)


@dataclass(frozen=True)
class Coating(BondedLayer):
    """Elastic layer bonded to an elastic half-space.

    Parameters
    ----------
    base_modulus : float
        E* of the half-space, in the same unit as `effective_modulus`.
    base_poisson : float
        Poisson's ratio of the half-space.
    """

    base_modulus: float = 1.0
    base_poisson: float = 0.3

    def compliance_ratio(self, scaled_wavenumber: ArrayLike) -> Array:
        """As for `BondedLayer`, K(t) on the elastic half-space."""
        t = np.asarray(scaled_wavenumber, float)
        kappa, below, decay = 3 - 4 * self.poisson, 3 - 4 * self.base_poisson, np.exp(-2 * t)
        shear = self.effective_modulus * (1 - self.poisson) / (self.base_modulus * (1 - self.base_poisson))
        rho, sigma = (shear - 1) / (shear + kappa), (shear * below - kappa) / (shear * below + 1)
        above = 1 + 4 * t * rho * decay - rho * sigma * decay**2
        return above / ((1 - rho * decay) * (1 - sigma * decay) - 4 * t**2 * rho * decay)


class LayerContact:
    """Contact with a bonded layer, a result of `BondedLayer`, by the discrete Fredholm equation.

    The kernel is separable, ``M(s, t) = Σ w_ξ cos ξs cos ξt``, with the nodes and weights of the integral
    over ξ.

    Parameters
    ----------
    layer : BondedLayer
    contact_radius : float
    curvature : float
        1/R of the paraboloid, zero for the flat punch.
    approach : float, optional
        By default the approach at which φ(a) = 0.

    Attributes
    ----------
    contact_radius, curvature, approach, load : float
    """

    def __init__(
        self, layer: BondedLayer, contact_radius: float, curvature: float, approach: float | None = None
    ) -> None:
        self.contact_radius, self.curvature = contact_radius, curvature
        node, weight = np.polynomial.legendre.leggauss(layer.order)
        s, weights = 0.5 * contact_radius * (node + 1), 0.5 * contact_radius * weight
        count = WAVENUMBERS + int(WAVENUMBERS_PER_RATIO * contact_radius / layer.height)
        node, weight = np.polynomial.legendre.leggauss(count)
        scaled = 0.5 * LARGEST_WAVENUMBER * (node + 1)
        self._wavenumbers, step = scaled / layer.height, 0.5 * LARGEST_WAVENUMBER * weight / layer.height
        correction = 2 / np.pi * (1 - layer.compliance_ratio(scaled)) * step
        cosines = np.cos(np.multiply.outer(s, self._wavenumbers))
        system = np.eye(layer.order) - ((cosines * correction) @ cosines.T) * weights
        # φ is δ times the solution for the right-hand side E*/π, less 1/R times the solution for E*/π s².
        self._scale = layer.effective_modulus / np.pi
        sides = self._scale * np.stack([np.ones(layer.order), s**2], axis=1)
        flat, curved = np.linalg.solve(system, sides).T
        if approach is None:
            edge = correction * np.cos(self._wavenumbers * contact_radius)
            edge_flat = self._scale + edge @ (cosines.T @ (weights * flat))
            edge_curved = self._scale * contact_radius**2 + edge @ (cosines.T @ (weights * curved))
            approach = float(curvature * edge_curved / edge_flat)
        density = approach * flat - curvature * curved
        self.approach, self.load = approach, 2 * np.pi * float(weights @ density)
        # 2/π (1 − K(ξh)) P(ξ) dξ: amplitudes of the cosines by which φ differs from the φ of a half-space.
        self._excess = correction * (cosines.T @ (weights * density))

    def density(self, s: ArrayLike) -> Array:
        """φ at distances 0 ≤ s ≤ a from the axis."""
        s = np.asarray(s, float)
        half_space = self._scale * (self.approach - self.curvature * s**2)
        return half_space + np.cos(np.multiply.outer(s, self._wavenumbers)) @ self._excess

    def pressure(self, r: ArrayLike) -> Array:
        """Contact pressure at distances `r` from the axis, zero outside the contact.

        The integral over t is one over v, with ``t² = r² + (a² − r²) v²``, of the smooth function φ'(t)/t.
        """
        r = np.asarray(r, float)
        square = np.maximum(self.contact_radius**2 - r**2, 0.0)
        node, weight = np.polynomial.legendre.leggauss(PRESSURE_NODES)
        t = np.sqrt(r[..., None] ** 2 + square[..., None] * (0.5 * (node + 1)) ** 2)
        # φ'(t)/t; np.sinc(x) is sin(πx)/(πx).
        phase = np.multiply.outer(t, self._wavenumbers)
        slope = -np.sinc(phase / np.pi) @ (self._wavenumbers**2 * self._excess)
        slope -= 2 * self._scale * self.curvature
        smooth = -np.sqrt(square) * (slope @ (0.5 * weight))
        if self.curvature:
            return smooth
        with np.errstate(divide="ignore"):
            return smooth + np.where(square > 0, self.density(self.contact_radius) / np.sqrt(square), 0.0)
