"""Westergaard contact: a rigid one-dimensional wave pressed without friction into an elastic half-space.

The indenter's lower face is ``A (1 − cos kx)`` with ``k = 2π/λ``; plane strain. Contact is partial below the
mean pressure ``p* = π E* A / λ`` and complete from there on (H. M. Westergaard, J. Appl. Mech. 6 (1939) A49,
DOI 10.1115/1.4008919; K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985, section 13.2).

With ``ε = exp(ik(x + i depth))`` and the half-angle of contact α = ka, the stress follows from one function,
analytic in |ε| < 1,

    Z = −2 p̄ (1 + ε) / (1 − ε + √(1 − ε e^{iα}) √(1 − ε e^{−iα})),

as ``σ_zz = Re Z + depth Im Z'``, ``σ_xx = Re Z − depth Im Z'``, ``σ_xz = depth Re Z'``, except for the
uniform part of σ_xx; the slope of the surface is ``2 Im Z / E*``.
"""

from dataclasses import dataclass

import numpy as np

from asperity.core.arguments import require_positive
from asperity.core.types import Array, ArrayLike


@dataclass(frozen=True)
class Westergaard:
    """Contact of a half-space with a one-dimensional wave along x.

    Parameters
    ----------
    mean_pressure : float
        Load over nominal area, p̄.
    amplitude : float
        Half of the height from valley to peak, A.
    wavelength : float
        λ, in the unit of the amplitude.
    effective_modulus : float
        E* = E / (1 − ν²) of the half-space; stresses are in its unit.

    Raises
    ------
    ValueError
        If one of them is not positive and finite.

    Examples
    --------
    >>> wave = asp.reference.westergaard.Westergaard(mean_pressure=1e-3, amplitude=1e-3)
    >>> round(wave.contact_area_fraction, 4)  # (2/π) arcsin √(p̄ λ/(π E* A))
    0.3816
    """

    mean_pressure: float
    amplitude: float
    wavelength: float = 1.0
    effective_modulus: float = 1.0

    def __post_init__(self) -> None:
        require_positive(**self.__dict__)

    @property
    def complete_pressure(self) -> float:
        """Smallest mean pressure of complete contact, p*."""
        return np.pi * self.effective_modulus * self.amplitude / self.wavelength

    @property
    def contact_area_fraction(self) -> float:
        """Contact width over wavelength, ``2/π asin √(p̄/p*)``."""
        return 2 / np.pi * float(np.arcsin(self._sine))

    @property
    def approach(self) -> float:
        """Displacement of the wave from first touch, relative to the mean displacement of the surface.

        ``A s² (1 − ln s²)`` with s² = p̄/p*, and ``A`` in complete contact.
        """
        square = self._sine**2
        return float(self.amplitude * square * (1 - np.log(square)))

    @property
    def mean_gap(self) -> float:
        """Gap averaged over the cell."""
        return self.amplitude - self.approach

    def height(self, x: ArrayLike) -> Array:
        """Height of the indenter's lower face, zero at its lowest point x = 0."""
        return 2 * self.amplitude * np.sin(np.pi * np.asarray(x, float) / self.wavelength) ** 2

    def pressure(self, x: ArrayLike) -> Array:
        """Contact pressure, zero outside the contact."""
        phase = np.pi * np.asarray(x, float) / self.wavelength
        if self.mean_pressure >= self.complete_pressure:
            return self.mean_pressure + self.complete_pressure * np.cos(2 * phase)
        inside = np.maximum(self._sine**2 - np.sin(phase) ** 2, 0.0)
        return 2 * self.complete_pressure * np.abs(np.cos(phase)) * np.sqrt(inside)

    def gap(self, x: ArrayLike) -> Array:
        """Gap between the surfaces, zero inside the contact."""
        sine, edge = np.abs(np.sin(np.pi * np.asarray(x, float) / self.wavelength)), self._sine
        outside = np.maximum(sine, edge)
        slope = np.sqrt((outside - edge) * (outside + edge))
        return 2 * self.amplitude * (outside * slope - edge**2 * np.arccosh(outside / edge))

    def displacement(self, x: ArrayLike) -> Array:
        """Downward displacement of the surface, mean zero."""
        return self.approach - self.height(x) + self.gap(x)

    def stress(self, x: ArrayLike, depth: ArrayLike, poisson: float, lateral: str = "confined") -> Array:
        """Stress in the half-space, in plane strain along y.

        Parameters
        ----------
        x, depth : array_like
            Positions; they broadcast.
        poisson : float
        lateral : "confined" or "free"
            The mean (q = 0) mode has ``σ_xx = σ_yy = −ν/(1 − ν) p̄`` or zero.

        Returns
        -------
        (..., 6) array
            In the order xx, yy, zz, yz, xz, xy.

        Raises
        ------
        ValueError
            If `lateral` is neither.
        """
        x, depth = np.broadcast_arrays(np.asarray(x, float), np.asarray(depth, float))
        k = 2 * np.pi / self.wavelength
        wave = np.exp(1j * k * x - k * depth)
        if self.mean_pressure >= self.complete_pressure:
            z = -self.mean_pressure - self.complete_pressure * wave
            slope = np.full_like(wave, -self.complete_pressure)
        else:
            turn = np.exp(2j * np.arcsin(self._sine))
            root = np.sqrt(1 - wave * turn) * np.sqrt(1 - wave / turn)
            below = 1 - wave + root
            z = -2 * self.mean_pressure * (1 + wave) / below
            # Z' is infinite at the edges of contact, but depth · Z' is zero on the whole surface.
            steep = np.divide(wave - turn.real, root, out=np.zeros_like(wave), where=depth > 0)
            slope = -2 * self.mean_pressure * (below - (1 + wave) * (steep - 1)) / below**2
        bend = depth * (1j * k * wave * slope)
        xx, zz, xz = z.real - bend.imag, z.real + bend.imag, bend.real
        # Z contains the mean mode as −p̄ in σ_xx too, which is replaced by the chosen lateral stress.
        confined = {"confined": poisson / (1 - poisson), "free": 0.0}
        if lateral not in confined:
            raise ValueError(f"lateral = {lateral!r}: 'confined' or 'free' is needed")
        uniform = -confined[lateral] * self.mean_pressure
        yy = poisson * (xx + zz + 2 * self.mean_pressure) + uniform
        xx = xx + self.mean_pressure + uniform
        none = np.zeros_like(zz)
        return np.stack([xx, yy, zz, none, xz, none], axis=-1)

    @property
    def _sine(self) -> float:
        """Sine of half the phase at the edge of contact, s = √(p̄/p*), at most one."""
        return float(np.sqrt(min(self.mean_pressure / self.complete_pressure, 1.0)))
