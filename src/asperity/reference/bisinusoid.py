"""Asymptotes of contact with a rigid bisinusoidal wave on a half-space: small and nearly complete contact.

The indenter's lower face is ``A (1 − (cos kx + cos ky)/2)`` with ``k = 2π/λ``: one peak in each square cell
of edge λ, and 2A from valley to peak. It is the wave ``Δ (1 − cos cos)`` of K. L. Johnson, J. A. Greenwood,
J. G. Higginson, Int. J. Mech. Sci. 27 (1985) 383, DOI 10.1016/0020-7403(85)90029-3, with Δ = A and the axes
turned by 45°.

In complete contact the pressure of each cosine has the amplitude ``E* k A / 4``. The lowest pressure, at the
valleys, is therefore zero at the mean pressure ``p* = π E* A / λ``.

Small contact: every peak is a paraboloid with 1/R = A k²/2 under the load p̄ λ², and Hertz's solution gives

    area fraction = π (3/(8π) p̄/p*)^(2/3).

Nearly complete contact: the surfaces are apart in a circle of radius b around every valley. There the
pressure of complete contact is ``p̄ − p* + p* k² r²/4``, in part negative. Removing it opens a circular
crack, whose edge has no stress intensity, ``∫_0^b (p* − p̄ − p* k² r²/4) r dr/√(b² − r²) = 0``. Hence ``b² =
6 (1 − p̄/p*)/k²`` and

    area fraction = 1 − 3/(2π) (1 − p̄/p*),      mean gap = 16/15 (p* − p̄) b³/(E* λ²).

The mean gap is the integral over the circle of the crack opening at r, divided by λ²; the opening is

    4/(π E*) ∫_r^b dt/√(t² − r²) ∫_0^t (p* − p̄ − p* k² s²/4) s ds/√(t² − s²).
"""

from dataclasses import dataclass

import numpy as np

from asperity.core.arguments import require_positive
from asperity.core.types import Array, ArrayLike


@dataclass(frozen=True)
class Bisinusoid:
    """Bisinusoidal wave on a half-space.

    Parameters
    ----------
    amplitude : float
        Half of the height from valley to peak, A.
    wavelength : float
        Edge λ of the square cell.
    effective_modulus : float
        E* = E / (1 − ν²) of the half-space; pressures are in its unit.

    Raises
    ------
    ValueError
        If one of them is not positive and finite.

    Examples
    --------
    >>> wave = asp.reference.bisinusoid.Bisinusoid(amplitude=1e-3)
    >>> round(wave.complete_pressure, 6)  # π E* A/λ
    0.003142
    """

    amplitude: float
    wavelength: float = 1.0
    effective_modulus: float = 1.0

    def __post_init__(self) -> None:
        require_positive(**self.__dict__)

    @property
    def complete_pressure(self) -> float:
        """Smallest mean pressure of complete contact, p*."""
        return np.pi * self.effective_modulus * self.amplitude / self.wavelength

    def height(self, y: ArrayLike, x: ArrayLike) -> Array:
        """Height of the indenter's lower face, zero at its lowest point x = y = 0; y and x broadcast."""
        squares = [np.sin(np.pi * np.asarray(part, float) / self.wavelength) ** 2 for part in (y, x)]
        return self.amplitude * (squares[0] + squares[1])

    def complete_contact_pressure(self, y: ArrayLike, x: ArrayLike, mean_pressure: float) -> Array:
        """Pressure of complete contact at a mean pressure, negative where it would be tension."""
        return mean_pressure + self.complete_pressure * (1 - self.height(y, x) / self.amplitude)

    def small_contact_area_fraction(self, mean_pressure: float) -> float:
        """Area fraction for p̄ ≪ p*."""
        return float(np.pi * (3 / (8 * np.pi) * mean_pressure / self.complete_pressure) ** (2 / 3))

    def nearly_complete_contact_area_fraction(self, mean_pressure: float) -> float:
        """Area fraction for p̄ just below p*; one from p* on."""
        return 1 - 3 / (2 * np.pi) * max(1 - mean_pressure / self.complete_pressure, 0.0)

    def nearly_complete_mean_gap(self, mean_pressure: float) -> float:
        """Gap averaged over the cell for p̄ just below p*; zero from p* on."""
        missing = max(self.complete_pressure - mean_pressure, 0.0)
        square = 6 * missing / self.complete_pressure * (self.wavelength / (2 * np.pi)) ** 2
        return 16 / 15 * missing * square**1.5 / (self.effective_modulus * self.wavelength**2)
