"""Units in which a contact of very large or very small numbers is solved.

Edges, heights and stresses may be given in any unit. A problem whose numbers are far from one is solved in
units of its own, powers of two, so that neither squares nor numbers in single precision overflow or vanish.
Multiplication by a power of two is exact: the solution is the same bit by bit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from asperity.arguments import LARGEST, SMALLEST
from asperity.contact.problem import Control
from asperity.contact.solution import Contact
from asperity.elasticity.layer import Layer
from asperity.elasticity.two_bodies import Solid, TwoBodies
from asperity.spectral import Grid
from asperity.types import Array

# Numbers between 2^-50 and 2^50 (1e±15) are solved as they are: their squares fit into single precision.
MAX_EXPONENT = 50


@dataclass(frozen=True)
class Units:
    """Units of a contact problem.

    Attributes
    ----------
    length, height, stress : float
        Powers of two, in the unit of lengths and in that of Young's modulus.
    datum : float
        Height from which heights and the approach are measured.
    """

    length: float = 1.0
    height: float = 1.0
    stress: float = 1.0
    datum: float = 0.0

    def grid(self, grid: Grid) -> Grid:
        """A grid in these units."""
        return Grid(grid.shape, (grid.length[0] / self.length, grid.length[1] / self.length))

    def solid(self, solid: Solid) -> Solid:
        """A solid in these units: the ratio of a stress to a slope is its modulus."""
        if isinstance(solid, TwoBodies):
            return TwoBodies(self._layer(solid.lower), self._layer(solid.upper))
        return self._layer(solid)

    def _layer(self, layer: Layer) -> Layer:
        height = None if layer.height is None else layer.height / self.length
        return replace(layer, young=layer.young / self.stress / self.length * self.height, height=height)

    def heights(self, height: Array) -> Array:
        """Heights in these units."""
        return height if self == Units() else (height - self.datum) / self.height

    def control(self, control: Control) -> Control:
        """An imposed quantity in these units."""
        if control.kind == "mean_pressure":
            return replace(control, value=control.value / self.stress)
        if control.kind == "approach":
            return replace(control, value=(control.value - self.datum) / self.height)
        return control

    def restored(self, found: Contact, height: Array, solid: Solid, grid: Grid) -> Contact:
        """A solution in these units as one in those of the caller.

        Raises
        ------
        ValueError
            If the precision of its fields does not hold the numbers in those units.
        """
        if self == Units():
            return found
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            restored = replace(
                found,
                height=height.astype(found.height.dtype),
                pressure=found.pressure * found.pressure.dtype.type(self.stress),
                displacement=found.displacement * found.gap.dtype.type(self.height),
                gap=found.gap * found.gap.dtype.type(self.height),
                grid=grid,
                solid=solid,
                mean_pressure=found.mean_pressure * self.stress,
                approach=found.approach * self.height + self.datum,
            )
        pressure = restored.pressure
        if not (
            np.count_nonzero(pressure) == np.count_nonzero(found.pressure)
            and np.all(np.isfinite(pressure))
            and bool(np.ptp(restored.height)) == bool(np.ptp(height))
        ):
            other = "float64 or other units" if pressure.itemsize == 4 else "other units"
            raise ValueError(
                f"dtype = {pressure.dtype.name!r}: cannot hold heights of about {self.height:.0e} and "
                f"pressures of about {self.stress:.0e}; {other} are needed"
            )
        return restored


def units_of(height_range: tuple[float, float], solid: Solid, grid: Grid, control: Control) -> Units:
    """Units for a problem: those of its numbers, unless they are near one or it is flat.

    The unit of heights is the range of the heights, or what the load or the approach makes of a half-space
    if that is more.
    """
    edge, modulus = max(grid.length), solid.effective_modulus
    lowest, highest = height_range
    extent = highest - lowest
    datum = 0.0 if extent else lowest
    depth = extent
    if control.kind == "mean_pressure":
        depth = max(depth, control.value / modulus * edge)
    elif control.kind == "approach":
        depth = max(depth, control.value - lowest)
    if depth <= 0:
        depth = edge
    length, unit, stress = _exponent(edge), _exponent(depth), _exponent(modulus)
    stress += unit - length
    if not datum and max(map(abs, (length, unit, stress, _exponent(modulus)))) <= MAX_EXPONENT:
        return Units()
    units = Units(math.ldexp(1.0, length), math.ldexp(1.0, unit), math.ldexp(1.0, stress), datum)
    return units if _are_accepted(units, solid, grid) else Units(datum=datum)


def _exponent(number: float) -> int:
    """Exponent of the power of two next to a positive number."""
    return math.frexp(number)[1]


def _are_accepted(units: Units, solid: Solid, grid: Grid) -> bool:
    """True if the edges and the solid are within their ranges in these units."""
    layers = (solid.lower, solid.upper) if isinstance(solid, TwoBodies) else (solid,)
    lengths = [*grid.length, *(layer.height for layer in layers if layer.height is not None)]
    moduli = [layer.young / units.stress / units.length * units.height for layer in layers]
    numbers = [*(length / units.length for length in lengths), *moduli]
    return all(SMALLEST <= value <= LARGEST for value in numbers)
