"""Units of pictures, and colour scales that single outliers do not flatten.

Units have sensible prefixes in SI; dimensionless results are drawn in cell lengths and E*.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from asperity.core.types import Array
from asperity.core.units import scaled_unit
from asperity.results.variables import SI_UNITS

if TYPE_CHECKING:
    from matplotlib.colors import Normalize

MPA_RANGE = (1e5, 1e11)
"""Maximum stresses, in Pa, that are shown in MPa: strengths of materials are given in MPa, up to 100 GPa."""

_SI_UNITS = {"length": "m", "stress": "Pa"}
_STUDY_UNITS = {"length": ("cell length", "cell lengths"), "stress": ("$E^*$", "$E^*$")}


@dataclass(frozen=True)
class Measure:
    """Unit in which a quantity is drawn.

    Parameters
    ----------
    factor : float
        Size of the unit, in the unit of the result; values are divided by it.
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
            return f"{name} (input units)"
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
        Unit system of the values, None if it is not known.
    """
    if system is None:
        return Measure()
    if system != SI_UNITS:
        symbol, after_number = _STUDY_UNITS[dimension]
        return Measure(1.0, symbol, ratio=True, after_number=after_number)
    largest = float(np.max(np.abs(values), initial=0.0))
    if dimension == "stress" and MPA_RANGE[0] <= largest < MPA_RANGE[1]:
        return Measure(1e6, "MPa")
    if dimension == "length" and not largest:
        return Measure(1e-6, "µm")
    return Measure(*scaled_unit(largest, _SI_UNITS[dimension]))


TAIL_SHARE = 0.001
"""Fraction of the values at each end that the limits ignore."""

MIN_IN_TAIL = 3
"""Fewest values at each end that are ignored: one wrong node of a map makes up to three high peaks."""

BEYOND_SHARE = 1e-6
"""Values beyond a limit by less than this fraction of the scale are not reported."""

QUANTILE_MARGIN = 0.25
"""The limits reach beyond the quantiles by at most this fraction of their distance. So the limits of Gaussian
values lie 4.6 standard deviations from the mean; of 512² independent values one is expected beyond them."""

SEQUENTIAL = "viridis"
"""Colours from dark (small) to light (large), as for stresses; perceptually uniform, for any colour
vision."""

FALLING = "viridis_r"
"""Colours from light (small) to dark (large), of heights of a lower face, whose lowest points are peaks."""

STRESS = "inferno"
"""Colours of stresses that have one sign."""

SIGNED = "coolwarm"
"""Colours of stresses of both signs, the same lightness for both (K. Moreland, 2009,
doi 10.1007/978-3-642-10520-3_9); grey is zero."""


@dataclass(frozen=True)
class Limits:
    """Limits of a colour scale or of an axis, and the extreme values.

    Parameters
    ----------
    low, high : float
    smallest, largest : float
        Extreme finite values, which may lie beyond the limits.
    """

    low: float
    high: float
    smallest: float
    largest: float

    @property
    def extend(self) -> str:
        """Ends of the colour bar beyond which there are values, in the words of matplotlib."""
        return {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[
            int(self.smallest < self.low - self._slack), int(self.largest > self.high + self._slack)
        ]

    @property
    def _slack(self) -> float:
        return BEYOND_SHARE * (self.high - self.low)

    def symmetric(self) -> Limits:
        """Limits of the same size on both sides of zero."""
        size = max(abs(self.low), abs(self.high))
        return replace(self, low=-size, high=size)

    def normalise(self, unit: Measure) -> Normalize:
        """Map from values in a unit to colours."""
        from matplotlib.colors import Normalize

        return Normalize(self.low / unit.factor, self.high / unit.factor)

    def beyond(self, values: Array, unit: Measure) -> str:
        """Number and extreme of the values beyond the limits in words; empty if there are none."""
        parts = []
        for count, word, extreme in (
            (np.count_nonzero(values > self.high + self._slack), "above", np.nanmax(values, initial=-np.inf)),
            (np.count_nonzero(values < self.low - self._slack), "below", np.nanmin(values, initial=np.inf)),
        ):
            if count:
                points = "point" if count == 1 else "points"
                bound = "up to" if word == "above" else "down to"
                parts.append(f"{count} {points} {word} the scale, {bound} {unit.text(float(extreme), 3)}")
        return "; ".join(parts)


def robust_limits(fields: Iterable[Array], low: float | None = None) -> Limits:
    """Limits that hold nearly all values of some fields and are not moved by single outliers.

    They are the extreme values, or the quantiles of each field at `TAIL_SHARE` with a `QUANTILE_MARGIN` if
    these are nearer.

    Parameters
    ----------
    fields : iterable of arrays
        Of any shapes; missing values are left out.
    low : float, optional
        Fixed lower limit, such as 0 for a pressure.
    """
    bottoms, tops, smallest, largest = [], [], [], []
    for field in fields:
        values = field[np.isfinite(field)]
        if not values.size:
            continue
        smallest.append(float(values.min()))
        largest.append(float(values.max()))
        tail = min(max(TAIL_SHARE, MIN_IN_TAIL / values.size), 0.5)
        lower, upper = np.quantile(values, [tail, 1 - tail])
        margin = QUANTILE_MARGIN * (upper - (lower if low is None else low))
        bottoms.append(max(smallest[-1], float(lower - margin)))
        tops.append(min(largest[-1], float(upper + margin)))
    if not tops:
        return Limits(0.0, 1.0, 0.0, 0.0)
    bottom = min(bottoms) if low is None else low
    top = max(tops)
    if not top > bottom:
        top = bottom + (abs(bottom) or 1.0)
    return Limits(bottom, top, min(smallest), max(largest))


class Look(NamedTuple):
    """Colours of a map.

    Parameters
    ----------
    label : str
        Name of the quantity.
    dimension : "length" | "stress"
    colours : str
        Colour map.
    outline : str
        Colour of the outlines of contacts; empty for none.
    reduce : callable
        Value of a pixel from the values of the nodes that it stands for.
    low : float or None
        Fixed lower limit.
    signed : bool
        True if zero is in the middle of the colours.
    """

    label: str
    dimension: str
    colours: str
    outline: str
    reduce: Callable[..., Array]
    low: float | None = None
    signed: bool = False

    def limits(self, values: Iterable[Array]) -> Limits:
        """Common limits of the colours of several results."""
        found = robust_limits(values, self.low)
        return found.symmetric() if self.signed else found


class Scale(NamedTuple):
    """Colours, limits and units in which several panels are drawn.

    Parameters
    ----------
    look : Look
    limits : Limits
    unit, length : Measure
        Of the values and of the positions.
    level : float or None
        Value of a contour.
    """

    look: Look
    limits: Limits
    unit: Measure
    length: Measure
    level: float | None = None


def blocks(values: Array, size: Sequence[int], reduce: Callable[..., Array]) -> Array:
    """Values [y, x] of blocks of nodes, each of `size` nodes along y and x; the last ones may be smaller."""
    missing = [(0, -nodes % block) for nodes, block in zip(values.shape, size, strict=True)]
    padded = np.pad(values, missing, mode="edge")
    rows, columns = (nodes // block for nodes, block in zip(padded.shape, size, strict=True))
    return reduce(padded.reshape(rows, size[0], columns, size[1]), axis=(1, 3))


def largest_magnitude(values: Array, axis: tuple[int, ...]) -> Array:
    """The value of largest magnitude along some axes, with its sign."""
    high, low = values.max(axis=axis), values.min(axis=axis)
    return np.where(high >= -low, high, low)
