"""Units of pictures: sensible prefixes in SI; cell lengths and E* for dimensionless results."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from asperity.units import scaled_unit, shown_si

SI = "SI"
"""Value of the attribute ``unit_system`` of results in m, Pa and N."""

STUDY = "cell length and effective modulus"
"""Value of the attribute ``unit_system`` of dimensionless results."""

MPA_RANGE = (1e5, 1e11)
"""Largest stresses, in Pa, that are shown in MPa: strengths of materials are given in MPa, up to 100 GPa."""

_SI_UNITS = {"length": "m", "stress": "Pa"}
_STUDY_UNITS = {"length": ("cell length", "cell lengths"), "stress": ("$E^*$", "$E^*$")}


@dataclass(frozen=True)
class Measure:
    """Unit in which a quantity is drawn.

    Parameters
    ----------
    factor : float
        Size of the unit in that of the result; values are divided by it.
    symbol : str
        Such as ``µm``; ``cell length`` or ``$E^*$`` for a dimensionless result; empty if it is not known.
    ratio : bool
        True if values are shown as a multiple of the symbol, ``depth / cell length``.
    after_number : str
        Symbol after a number, where it is another one: ``0.1 cell lengths``.
    """

    factor: float = 1.0
    symbol: str = ""
    ratio: bool = False
    after_number: str = ""

    def label(self, name: str) -> str:
        """Label of an axis, such as ``depth (µm)`` or ``depth / cell length``."""
        if not self.symbol:
            return name
        return f"{name} / {self.symbol}" if self.ratio else f"{name} ({self.symbol})"

    def text(self, value: float, digits: int = 4) -> str:
        """A value with its unit, such as ``12.5 µm``; without an exponent below 10¹⁵."""
        rounded = float(f"{value / self.factor:.{digits}g}")
        return f"{rounded:.15g} {self.after_number or self.symbol}".strip()


def measure(values: ArrayLike, dimension: str, system: str | None) -> Measure:
    """Unit in which values are drawn.

    Parameters
    ----------
    values : array
        The largest magnitude decides the prefix.
    dimension : "length" | "stress"
    system : str or None
        Unit system of the values: `SI`, `STUDY`, or None if it is not known.
    """
    if system is None:
        return Measure()
    if system != SI:
        symbol, after_number = _STUDY_UNITS[dimension]
        return Measure(1.0, symbol, ratio=True, after_number=after_number)
    largest = float(np.max(np.abs(values), initial=0.0))
    if dimension == "stress" and MPA_RANGE[0] <= largest < MPA_RANGE[1]:
        return Measure(1e6, "MPa")
    if dimension == "length" and not largest:
        return Measure(1e-6, "µm")
    return Measure(*scaled_unit(largest, _SI_UNITS[dimension]))


def told(value: float, dimension: str, system: str | None) -> str:
    """A value with its unit, for messages in plain text."""
    if system == SI:
        return shown_si(value, _SI_UNITS[dimension])
    return f"{value:.6g}"
