"""The question that `asperity.engineering.run` answers: map, bodies and load, in SI units."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from asperity.core.arguments import choice, magnitude, number
from asperity.core.errors import one_line, shown
from asperity.elasticity.layer import Layer
from asperity.elasticity.loaded_solid import traction_direction
from asperity.elasticity.two_bodies import TwoBodies
from asperity.stress.planes.stream import shear_traction
from asperity.surface.reading.height_map import PEAKS_UP, HeightMap, MapOptions
from asperity.surface.treatment.face_to_face import face_to_face
from asperity.surface.treatment.treatment import TreatedMap, treat_map, usable_map

CONTROL_UNITS = {"mean_pressure": "Pa", "force": "N", "approach": "m", "area_fraction": "1"}
"""Quantity of which one is imposed → its unit."""

LONGEST_NAME = 60
"""Characters of the name of a map that titles show at most."""


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
        _ = self.layer  # which checks its constants
        if self.yield_stress is not None:
            magnitude("yield_stress", self.yield_stress)

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
        choice("load", self.kind, tuple(CONTROL_UNITS))
        if self.kind == "area_fraction":
            number(self.kind, self.value, "a number > 0 and ≤ 1", lambda value: 0 < value <= 1)
        else:
            magnitude(self.kind, self.value)

    @classmethod
    def chosen(cls, given: Mapping[str, float | None]) -> Load:
        """The load from keyword arguments of which exactly one is given."""
        named = {kind: value for kind, value in given.items() if value is not None}
        if len(named) != 1:
            known, found = ", ".join(CONTROL_UNITS), ", ".join(named) or "none"
            raise ValueError(f"exactly one of {known} is needed, got {found}")
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
        for name, body in (("lower", self.lower), ("upper", self.upper or self.lower)):
            if not isinstance(body, Body):
                raise TypeError(f"{name} = {shown(body)}: a Body is needed")
            shear_traction(self.friction, self.sliding_direction, body.layer)

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


@dataclass(frozen=True)
class CounterMap:
    """A map of the upper body, and how it is laid on that of the lower one.

    Parameters
    ----------
    source : path or HeightMap
        File of a map, or a map in metres, with its peaks upward as measured.
    options : MapOptions, optional
        What is known of the file, and how trend, spikes and points without data are treated; by default as
        for the other map.
    turned_about : "y" or "x"
        Axis about which the map is turned over, to face down.
    shift : (y, x)
        Position in m of the middle of this map over that of the other one.
    """

    source: str | os.PathLike[str] | HeightMap
    options: MapOptions | None = None
    turned_about: str = "y"
    shift: tuple[float, float] = (0.0, 0.0)


def read_face(
    source: str | os.PathLike[str] | HeightMap, options: MapOptions, counter: CounterMap | None = None
) -> TreatedMap:
    """Read a map and prepare it, with the map of the counter body if that is rough too.

    Parameters
    ----------
    source : path or HeightMap
        A height map is in metres.
    options : MapOptions
    counter : CounterMap, optional

    Raises
    ------
    MapError, TypeError, ValueError
        If a map cannot be read, has no unit, or needs an option that is not given, or if the two do not go
        together.
    """
    name, surface = _read(source, options)
    if counter is None:
        return replace(treat_map(surface, _completed(options, surface)), name=name)
    own = counter.options or options
    counter_name, counter_surface = _read(counter.source, own)
    face, filled, done = _levelled(surface, options)
    counter_face, counter_filled, counter_done = _levelled(counter_surface, own)
    pair = face_to_face(face, counter_face, counter.turned_about, counter.shift)
    treated = treat_map(pair.map, replace(_completed(options, pair.map), despike=None))
    record = replace(treated.treatment, filled_fraction=filled + counter_filled)
    lines = [
        *(f"map: {line}" for line in done),
        *(f"counter map: {line}" for line in counter_done),
        *pair.done,
        *(line for line in treated.done[1:] if not (pair.whole and line.startswith("levelled"))),
    ]
    return replace(treated, name=f"{name} on {counter_name}", treatment=record, done=tuple(lines))


def _completed(options: MapOptions, surface: HeightMap | None = None) -> MapOptions:
    """The options, by default with points filled and a map mirrored that does not call itself periodic."""
    periodic = options.periodic or (None if surface and surface.periodic else "mirrored")
    return replace(options, periodic=periodic, undefined="harmonic")


def _read(source: str | os.PathLike[str] | HeightMap, options: MapOptions) -> tuple[str, HeightMap]:
    """Name and heights of a map that has all that its treatment needs."""
    if isinstance(source, HeightMap):
        name, surface = source.name or "map", replace(source, unit=source.unit or "m")
    else:
        name, surface = Path(source).stem, usable_map(source, _completed(options))
    name = one_line(name)
    return name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 3]}...", surface


def _levelled(surface: HeightMap, options: MapOptions) -> tuple[HeightMap, float, list[str]]:
    """A map without spikes, missing points and trend; the share that was filled, and what was done."""
    bounded = replace(
        _completed(options, surface), periodic="none", wavelength_short=None, points=None, radius=None
    )
    treated = treat_map(surface, bounded)
    height = -treated.height if surface.orientation == PEAKS_UP else treated.height
    done = [line for line in treated.done[1:] if not line.startswith("not made periodic")]
    return replace(surface, height=height), treated.treatment.filled_fraction, done
