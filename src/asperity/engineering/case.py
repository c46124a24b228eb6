"""The question that `asperity.engineering.run` answers: bodies and load, in SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from asperity.arguments import choice, magnitude, number
from asperity.elasticity.layer import BOTTOMS, Layer
from asperity.elasticity.two_bodies import TwoBodies
from asperity.errors import shown
from asperity.stress.arguments import checked_sliding
from asperity.stress.pressed import traction_direction

CONTROLS = ("mean_pressure", "force", "approach", "area_fraction")
"""Quantities of which one is imposed."""

CONTROL_UNITS = {"mean_pressure": "Pa", "force": "N", "approach": "m", "area_fraction": "1"}
"""Unit of each of them."""


@dataclass(frozen=True)
class Body:
    """An elastic body.

    Parameters
    ----------
    young : float
        Young's modulus in Pa.
    poisson : float
        Poisson's ratio.
    yield_stress : float, optional
        In Pa; without it nothing is said about yielding.
    height : float, optional
        Height in m of a layer on a rigid base; without it the body is a half-space.
    bottom : "bonded", "frictionless" or "free"
        Lower face of the layer.

    Examples
    --------
    >>> steel = Body(young=210e9, poisson=0.3, yield_stress=1.5e9)  # Pa
    >>> coating = Body(young=2e9, poisson=0.4, height=5e-6)  # 5 µm on a rigid base
    >>> coating.layer.height
    5e-06
    """

    young: float
    poisson: float
    yield_stress: float | None = None
    height: float | None = None
    bottom: str = "bonded"

    def __post_init__(self) -> None:
        magnitude("young", self.young)
        number("poisson", self.poisson, "a number > -1 and ≤ 0.5", lambda ratio: -1 < ratio <= 0.5)
        if self.yield_stress is not None:
            magnitude("yield_stress", self.yield_stress)
        if self.height is not None:
            magnitude("height", self.height)
        choice("bottom", self.bottom, BOTTOMS)

    @property
    def layer(self) -> Layer:
        """The body as the solver takes it."""
        return Layer(self.young, self.poisson, self.height, self.bottom)


@dataclass(frozen=True)
class Load:
    """The one quantity that is imposed.

    Parameters
    ----------
    kind : "mean_pressure", "force", "approach" or "area_fraction"
        Load over the nominal area in Pa; load in N; approach of the bodies since their first touch in m; real
        over nominal contact area.
    value : float
    """

    kind: str
    value: float

    def __post_init__(self) -> None:
        choice("load", self.kind, CONTROLS)
        if self.kind == "area_fraction":
            number(self.kind, self.value, "a number > 0 and ≤ 1", lambda value: 0 < value <= 1)
        else:
            magnitude(self.kind, self.value)

    @classmethod
    def chosen(cls, given: Mapping[str, float | None]) -> Load:
        """The load from keyword arguments of which exactly one is given."""
        named = {kind: value for kind, value in given.items() if value is not None}
        if len(named) != 1:
            raise ValueError(
                f"exactly one of {', '.join(CONTROLS)} is needed, got {', '.join(named) if named else 'none'}"
            )
        return cls(*named.popitem())


@dataclass(frozen=True)
class Case:
    """Bodies and load.

    Parameters
    ----------
    lower : Body
    upper : Body or None
        None: rigid. Which of the bodies is rough does not matter as long as the slopes are small.
    load : Load
    friction : float
        Coefficient μ of full sliding, with the shear traction μ p; the pressure stays that of the contact
        without friction. Half-spaces, and layers bonded to a rigid base.
    sliding_direction : "x", "y" or float
        Direction in which the upper body moves over the lower one, that of the traction on the lower body; a
        number is an angle in degrees from x towards y.
    """

    lower: Body
    upper: Body | None
    load: Load
    friction: float = 0.0
    sliding_direction: str | float = "x"

    def __post_init__(self) -> None:
        if not isinstance(self.lower, Body):
            raise TypeError(f"lower = {shown(self.lower)}: a Body is needed")
        if self.upper is not None and not isinstance(self.upper, Body):
            raise TypeError(f"upper = {shown(self.upper)}: a Body or None (rigid) is needed")
        for body in self.bodies.values():
            checked_sliding(self.friction, self.sliding_direction, body.layer)

    def sliding_of(self, body: str) -> dict[str, Any]:
        """Friction and direction of the traction on a body, as arguments of `asperity.stress_planes`."""
        return {
            "friction": self.friction,
            "sliding_direction": traction_direction(self.sliding_direction, body),
        }

    @property
    def bodies(self) -> dict[str, Body]:
        """The elastic bodies by name."""
        return {"lower": self.lower} if self.upper is None else {"lower": self.lower, "upper": self.upper}

    @property
    def solid(self) -> Layer | TwoBodies:
        """What the solver presses."""
        return self.lower.layer if self.upper is None else TwoBodies(self.lower.layer, self.upper.layer)
