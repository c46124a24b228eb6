"""Hertz contact of two smooth bodies, in which a far smaller rough cell lies at one position.

Scales are separate: over the cell the Hertz pressure hardly changes. The cell is solved as periodic, under
the Hertz pressure at its position as mean pressure. The stress below it is the stress of the cell plus the
stress of the smooth contact at this position, less the mean (q = 0) mode, which both contain.

Below an ellipse
----------------
The pressure p₀ √(1 − x²/a² − y²/b²) has the transform 2π a b p₀ (sin qc − qc cos qc)/(qc)³, with c² =
(a cos θ)² + (b sin θ)² for a wavevector q (cos θ, sin θ). A mode has the stress (A + B q z) e^(−qz) at the
depth z, see `asperity.elasticity.solid`. The integral over q is in closed form: with the angle ψ of (a cos θ,
b sin θ) and w = z/c − i (x cos ψ/a + y sin ψ/b),

    σ(x, y, z) = p₀ ⟨Re {A (1 − w arccot w) + B z/c (arccot w − w/(1 + w²))}⟩,   averaged over 0 ≤ ψ < π.

This is the decomposition into plane waves of F. John (Plane Waves and Spherical Means, 1955): every direction
has the stress of a line load. The mean over equal steps of ψ converges exponentially.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from asperity.core.arguments import magnitude
from asperity.core.types import Array, ArrayLike
from asperity.elasticity.solid import Solid
from asperity.reference.elliptic_hertz import EllipticHertz
from asperity.reference.hertz import LineHertz
from asperity.stress.planes.stream import shear_traction

DIRECTIONS = 1024
"""Number of directions over which the stress below an ellipse is averaged."""

DEPTH_OF_LARGEST = 2.0
"""Depth in smaller half-widths above which the maximum stresses of a Hertz contact lie."""

SMALLEST_DEPTH = 1e-12
"""Least depth over the smaller half-width: in the surface, a mode's stress is infinite at the edge."""


@dataclass(frozen=True)
class HertzContact:
    """Contact of two smooth bodies: an ellipse, or a strip under a roller.

    Equations of H. Hertz as in K. L. Johnson, *Contact Mechanics* (1985), sections 4.1 and 4.2.

    Parameters
    ----------
    maximum_pressure : float
        Pressure p0 in the middle.
    half_width_y, half_width_x : float
        Half-widths along y and x; one of them is infinite under a roller whose axis has this direction.

    Examples
    --------
    A ball of radius 5 mm in a groove, steel on steel:

    >>> pair = asp.TwoBodies(asp.Solid(210e9, 0.3), asp.Solid(210e9, 0.3))
    >>> modulus = pair.effective_modulus
    >>> contact = asp.stress.HertzContact.from_radii(5e-3, 80e-3, modulus, maximum_pressure=1.2e9)
    >>> print(f"{contact.half_width_x * 1e6:.0f} x {contact.half_width_y * 1e6:.0f} µm, "
    ...       f"{contact.maximum_shear(0.3)[1] * 1e6:.0f} µm deep")
    102 x 613 µm, 76 µm deep
    """

    maximum_pressure: float
    half_width_y: float
    half_width_x: float

    def __post_init__(self) -> None:
        magnitude("maximum_pressure", self.maximum_pressure)
        if not 0 < self.narrow < np.inf:
            raise ValueError(
                f"half_width_y = {self.half_width_y!r}, half_width_x = {self.half_width_x!r}: positive "
                "numbers are needed, at most one of them infinite"
            )

    @classmethod
    def from_radii(
        cls,
        radius_x: float,
        radius_y: float,
        effective_modulus: float,
        *,
        maximum_pressure: float | None = None,
        force: float | None = None,
    ) -> Self:
        """Contact of two bodies with the combined radii of curvature, 1/R = 1/R₁ + 1/R₂ along x and along y.

        Parameters
        ----------
        radius_x, radius_y : float
            Combined radii; infinite along the axis of a roller. A concave face has a negative radius.
        effective_modulus : float
        maximum_pressure, force : float
            One of them; under a roller the force per length.

        Raises
        ------
        ValueError
            If an argument is out of range, or not exactly one of maximum pressure and force is given.
        """
        if (maximum_pressure is None) == (force is None):
            raise ValueError("exactly one of maximum_pressure and force is needed")
        load = magnitude("force", force) if force is not None else 1.0
        low, high = sorted((radius_x, radius_y))
        if high == np.inf:
            line = LineHertz.from_load(load, magnitude("radius", low), effective_modulus)
            unit, narrow, wide = line.maximum_pressure, line.half_width, np.inf
        else:
            ellipse = EllipticHertz.from_load(load, high, low, effective_modulus)
            unit, narrow, wide = ellipse.maximum_pressure, ellipse.semi_minor, ellipse.semi_major
        # Half-widths are proportional to the largest pressure.
        scale = 1.0 if maximum_pressure is None else magnitude("maximum_pressure", maximum_pressure) / unit
        along_x, along_y = (narrow, wide) if radius_x <= radius_y else (wide, narrow)
        return cls(scale * unit, scale * along_y, scale * along_x)

    @property
    def narrow(self) -> float:
        """The smaller half-width."""
        return min(self.half_width_y, self.half_width_x)

    def position(self, at: tuple[float, float]) -> tuple[float, float]:
        """Position y, x of a place from the middle, given in half-widths.

        Raises
        ------
        ValueError
            If the place is off the middle along the axis of a roller.
        """
        widths = self.half_width_y, self.half_width_x
        if any(share and width == np.inf for share, width in zip(at, widths, strict=True)):
            raise ValueError(f"at = {at[0]:g} {at[1]:g}: 0 is needed along the axis of the roller")
        y, x = (share * width if share else 0.0 for share, width in zip(at, widths, strict=True))
        return y, x

    def deepest(self, limit: float | None = None) -> float:
        """Depth above which the maximum stresses lie, and all von Mises stresses above a limit.

        Far below a roller the von Mises stress is less than p₀ b/z, and less still below an ellipse.
        """
        return self.narrow * max(DEPTH_OF_LARGEST, self.maximum_pressure / limit if limit else 0.0)

    def pressure(self, y: ArrayLike, x: ArrayLike) -> Array:
        """Pressure at positions relative to the middle; y and x broadcast."""
        inside = 1 - (np.asarray(y) / self.half_width_y) ** 2 - (np.asarray(x) / self.half_width_x) ** 2
        return self.maximum_pressure * np.sqrt(np.maximum(inside, 0.0))

    def maximum_shear(self, poisson: float) -> tuple[float, float]:
        """Maximum shear stress (Tresca) on the axis without friction, and its depth, to 0.1 % of it."""
        depth = self.narrow * np.linspace(0, 2, 2001)
        if np.inf in (self.half_width_y, self.half_width_x):
            stress = LineHertz(self.narrow, self.maximum_pressure).stress(0.0, depth, poisson)
        else:
            wide = max(self.half_width_y, self.half_width_x)
            stress = EllipticHertz(wide, self.narrow, self.maximum_pressure).stress_on_axis(depth, poisson)
        shear = np.ptp(stress[:, :3], axis=1) / 2
        return float(shear.max()), float(depth[shear.argmax()])

    def stress(
        self,
        y: ArrayLike,
        x: ArrayLike,
        layer: Solid,
        friction: float = 0.0,
        sliding_direction: str | float = "x",
    ) -> Callable[[float], Array]:
        """Stress below positions on the surface, as a function of the depth.

        In closed form under a roller; under an ellipse to rounding for axis ratios up to 100, except within
        1/40 of the smaller half-width below the edge or the surface around the contact, where the error is
        below 1e-3 of the maximum pressure.

        Parameters
        ----------
        y, x : (places,) arrays
        layer : Solid
            A half-space.
        friction, sliding_direction
            As for `stress_planes`.

        Returns
        -------
        callable
            Depth → (places, 6) array.
        """
        y, x = (np.atleast_1d(np.asarray(each, float)) for each in np.broadcast_arrays(y, x))
        nu, traction = layer.poisson, shear_traction(friction, sliding_direction, layer)
        if self.half_width_y == np.inf:
            line = LineHertz(self.half_width_x, self.maximum_pressure)
            return lambda depth: line.stress(x, depth, nu, traction)
        if self.half_width_x == np.inf:
            turned, order = HertzContact(self.maximum_pressure, np.inf, self.half_width_y), [1, 0, 2, 4, 3, 5]
            degrees = np.degrees(np.arctan2(*traction))  # x and y change places
            below = turned.stress(x, y, layer, friction, float(degrees))
            return lambda depth: below(depth)[:, order]
        angle = np.pi * (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
        per_y, per_x = np.sin(angle) / self.half_width_y, np.cos(angle) / self.half_width_x
        half_width = 1 / np.hypot(per_y, per_x)
        level, slope = _mode_stress(half_width * per_x, half_width * per_y, nu, traction)
        across = y[:, None] * per_y + x[:, None] * per_x

        def below_ellipse(depth: float) -> Array:
            below = max(depth, SMALLEST_DEPTH * self.narrow) / half_width
            w = below - 1j * across
            cotangent = 0.5j * np.log((w - 1j) / (w + 1j))
            parts = 1 - w * cotangent, below * (cotangent - w / (1 + w**2))
            stress = sum(
                np.einsum("pn,nc->pc", *pair).real for pair in zip(parts, (level, slope), strict=True)
            )
            return self.maximum_pressure / DIRECTIONS * stress

        return below_ellipse

    def background(
        self,
        y: ArrayLike,
        x: ArrayLike,
        layer: Solid,
        friction: float = 0.0,
        sliding_direction: str | float = "x",
    ) -> Callable[[float], Array]:
        """The part of `stress` beyond the mean mode of a cell at each position; (6,) for a single
        position.
        """
        below = self.stress(y, x, layer, friction, sliding_direction)
        mode = layer.uniform_stress()
        mode[4], mode[3] = shear_traction(friction, sliding_direction, layer)
        mean = self.pressure(y, x)[..., None] * mode
        return lambda depth: below(depth).reshape(mean.shape) - mean


def _mode_stress(
    cosine: Array, sine: Array, poisson: float, traction: tuple[float, float]
) -> tuple[Array, Array]:
    """A and B, (directions, 6), of the stress (A + B q z) e^(−qz) of a mode with unit pressure."""
    along, across = traction[0] * cosine + traction[1] * sine, traction[1] * cosine - traction[0] * sine
    # Of A and B, along (l) and across (t) the wavevector: zz, ll, lz; the others have no B.
    zz = np.stack([-np.ones(cosine.shape), 1j * along - 1])
    ll = np.stack([2j * along - 1, 1 - 1j * along])
    lz = np.stack([along, -1j - along])
    tt, tz, lt = poisson * (zz + ll), np.stack([across, 0 * across]), np.stack([1j * across, 0 * across])
    components = (
        cosine**2 * ll + sine**2 * tt - 2 * sine * cosine * lt,
        sine**2 * ll + cosine**2 * tt + 2 * sine * cosine * lt,
        zz,
        sine * lz + cosine * tz,
        cosine * lz - sine * tz,
        sine * cosine * (ll - tt) + (cosine**2 - sine**2) * lt,
    )
    level, slope = np.stack(components, axis=-1)
    return level, slope
