"""Units in which a contact problem is solved."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from asperity.contact.problem import Control
from asperity.core.types import Array
from asperity.elasticity.layer import Layer
from asperity.elasticity.two_bodies import Solid, TwoBodies
from asperity.fourier.grid import Grid


@dataclass(frozen=True)
class Units:
    """Units of a contact problem, in which its numbers are near one.

    They are powers of two, so that the solution is the same bit by bit.

    Attributes
    ----------
    length, height, stress : float
        In the unit of lengths and in that of Young's modulus.
    datum : float
        Height from which heights and the approach are measured.
    """

    length: float
    height: float
    stress: float
    datum: float

    @classmethod
    def of(cls, lowest: float, highest: float, solid: Solid, grid: Grid, control: Control) -> Units:
        """Units of edge, modulus, and heights.

        Heights have the unit of the edge, unless their range, or what the load or the approach makes of a
        half-space if that is more, is smaller or larger by more than 2^40.
        """
        edge, modulus = max(grid.length), solid.effective_modulus
        depth = highest - lowest
        datum = 0.0 if depth else lowest
        if control.kind == "mean_pressure":
            depth = max(depth, control.value / modulus * edge)
        elif control.kind == "approach":
            depth = max(depth, control.value - lowest)
        length, height = _power_of_two(edge), _power_of_two(depth if depth > 0 else edge)
        if 2.0**-40 <= height / length <= 2.0**40:
            height = length
        return cls(length, height, _power_of_two(modulus) * (height / length), datum)

    @classmethod
    def of_solid(cls, solid: Solid, grid: Grid) -> Units:
        """Units of edge and modulus."""
        length = _power_of_two(max(grid.length))
        return cls(length, length, _power_of_two(solid.effective_modulus), 0.0)

    @property
    def change(self) -> bool:
        """True if they are not those of the caller."""
        return (self.length, self.height, self.stress, self.datum) != (1, 1, 1, 0)

    def grid(self, grid: Grid) -> Grid:
        return Grid(grid.shape, (grid.length[0] / self.length, grid.length[1] / self.length))

    def solid(self, solid: Solid) -> Solid:
        """The solid in these units: the ratio of a stress to a slope is its modulus."""
        if isinstance(solid, TwoBodies):
            return TwoBodies(self.layer(solid.lower), self.layer(solid.upper))
        return self.layer(solid)

    def layer(self, layer: Layer) -> Layer:
        height = None if layer.height is None else layer.height / self.length
        return replace(layer, young=layer.young / self.stress / self.length * self.height, height=height)

    def heights(self, height: Array) -> Array:
        if self.height == 1 and self.datum == 0:
            return height
        return (height - self.datum) / self.height

    def control(self, control: Control) -> Control:
        if control.kind == "mean_pressure":
            return replace(control, value=control.value / self.stress)
        if control.kind == "approach":
            return replace(control, value=(control.value - self.datum) / self.height)
        return control


def _power_of_two(value: float) -> float:
    """The power of two at or below a positive number."""
    return math.ldexp(0.5, math.frexp(value)[1])
