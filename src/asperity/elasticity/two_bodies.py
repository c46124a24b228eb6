"""Two elastic bodies pressed against each other, as one solid for the contact.

Without friction both bodies carry the same pressure, and the gap closes by the sum of their surface
displacements (K. L. Johnson, Contact Mechanics, 1985, chapter 4). Their compliances add up, and for
half-spaces 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂. The stress in each body follows from the common pressure with
the layer of that body.
"""

from dataclasses import dataclass

import numpy as np

from asperity.core.markup import table
from asperity.core.types import Array, ArrayLike
from asperity.elasticity.solid import Solid


@dataclass(frozen=True)
class TwoBodies:
    """Two isotropic linear elastic bodies, each a layer or a half-space, pressed against each other.

    Parameters
    ----------
    lower, upper : Solid
        The solid below the interface and the one above it. Swapping them changes no contact pressure.

    Raises
    ------
    TypeError
        If one of them is not a `Solid`.

    Examples
    --------
    >>> pair = asp.TwoBodies(lower=asp.Solid(210e9, 0.3), upper=asp.Solid(110e9, 0.34))  # steel, bronze
    >>> print(f"{pair.effective_modulus / 1e9:.1f} GPa")
    80.8 GPa
    >>> height = asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> contact = asp.solve_contact(height, pair, 2e-4, mean_pressure=20e6)
    >>> contact.in_body("upper").layer.poisson
    0.34
    """

    lower: Solid
    upper: Solid

    def __post_init__(self) -> None:
        for name, layer in (("lower", self.lower), ("upper", self.upper)):
            if not isinstance(layer, Solid):
                raise TypeError(f"{name} = {layer!r}: a Solid is needed")

    def _repr_html_(self) -> str:
        rows = [
            ("upper", repr(self.upper)),
            ("lower", repr(self.lower)),
            ("E* of the pair", f"{self.effective_modulus:.6g}"),
        ]
        return table("TwoBodies", rows)

    @property
    def effective_modulus(self) -> float:
        """E* of the pair, in the unit of Young's modulus: 1/E* = Σ (1 − νᵢ²)/Eᵢ."""
        return 1 / (1 / self.lower.effective_modulus + 1 / self.upper.effective_modulus)

    @property
    def height(self) -> float | None:
        """Height of the lower of the layers; None if both bodies are half-spaces."""
        heights = [layer.height for layer in (self.lower, self.upper) if layer.height is not None]
        return min(heights, default=None)

    @property
    def interface(self) -> float | None:
        """Depth of the upper of the interfaces under coatings; None without a coating."""
        depths = [layer.interface for layer in (self.lower, self.upper) if layer.interface is not None]
        return min(depths, default=None)

    def surface_compliance(self, q: ArrayLike) -> Array:
        """Sum of the compliances of both surfaces, length per pressure, of the shape of q; see `Solid`."""
        return self.lower.surface_compliance(q) + self.upper.surface_compliance(q)

    def uniform_compliance(self) -> float:
        """Approach of the bodies per unit mean pressure; 0 by rule if a body has no uniform displacement."""
        return self.lower.uniform_compliance() + self.upper.uniform_compliance()


Solids = Solid | TwoBodies
"""A solid that can be pressed: one against a rigid indenter, or two bodies against each other."""


def sliding_coupling(solid: Solids, q: ArrayLike) -> Array:
    """Normal displacement of the surfaces by a shear traction along a wave, over the displacement by an equal
    pressure.

    Gross sliding with friction μ changes the gap of each wave by up to μ times this ratio, which a contact
    without friction neglects. By reciprocity it follows from the kernels V and W of `Solid.kernels` at the
    surface. It is 0 for two equal bodies, (1 − 2ν)/(2 − 2ν) for a half-space against a rigid body, and
    Dundurs' constant β for two half-spaces (J. Dundurs, J. Appl. Mech. 36 (1969) 650,
    DOI 10.1115/1.3564739). On a bonded layer it is not 0 even at ν = 1/2.

    Parameters
    ----------
    solid : Solid or TwoBodies
    q : array
        Wavenumbers, from 1e-75 to 1e75.

    Returns
    -------
    array
        Ratios ≥ 0 of the shape of q.

    Raises
    ------
    TypeError, ValueError
        If a wavenumber is not a number or out of range, or a layer has a free bottom.

    Examples
    --------
    >>> from asperity.elasticity.two_bodies import sliding_coupling
    >>> rubber = asp.Solid(young=2e6, poisson=0.5, height=1e-3)  # 1 mm, bonded to a rigid base
    >>> np.round(sliding_coupling(rubber, [1e2, 1e3, 1e4]), 2)
    array([14.97,  1.23,  0.  ])
    """
    along, normal = np.zeros((2, *np.shape(q)))
    bodies = (solid.lower, solid.upper) if isinstance(solid, TwoBodies) else (solid,)
    for direction, body in zip((1, -1), bodies, strict=False):
        kernels, unit = body.kernels(q, 0.0), (1 + body.poisson) / body.young
        along += direction * unit * kernels.displacement_longitudinal
        normal += unit * kernels.displacement_normal
    return np.abs(along) / normal
