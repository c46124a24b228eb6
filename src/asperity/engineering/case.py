"""The question that `asperity.engineering.run` answers: map, bodies, load and outputs, in SI units."""

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Any

import numpy as np

from asperity.contact import Contact
from asperity.core.arguments import choice, choices, magnitude, number
from asperity.core.errors import shown
from asperity.core.units import DIMENSIONS, shown_si, to_si
from asperity.elasticity.layer import Layer
from asperity.elasticity.loaded_solid import LARGEST as LARGEST_PRESSURE
from asperity.elasticity.loaded_solid import LoadedSolid, traction_direction
from asperity.elasticity.two_bodies import TwoBodies
from asperity.engineering.face import CounterMap, Source, counter_map_of, is_hertz, options_of
from asperity.stress.cycles.criteria import hydrostatic_factor
from asperity.stress.cycles.hertz_contact import HertzContact
from asperity.stress.cycles.stress_cycles import axis_of_motion
from asperity.stress.cycles.survival import weibull_exponent
from asperity.stress.planes.fields import FIELDS
from asperity.stress.planes.stream import shear_traction
from asperity.surface.reading.height_map import HeightMap, MapOptions

LOAD_QUANTITIES = {
    "pressure": ("mean_pressure", "pressure"),
    "hertz_pressure": ("hertz_pressure", "pressure"),
    "force": ("force", "force"),
    "approach": ("approach", "length"),
    "area_fraction": ("area_fraction", ""),
}
"""Setting → quantity that it imposes, and its dimension."""

CONTROL_UNITS = {kind: DIMENSIONS[name].unit if name else "1" for kind, name in LOAD_QUANTITIES.values()}
"""Quantity that may be imposed → its unit."""

BODY = {
    "young": ("young", "pressure"),
    "poisson": ("poisson", ""),
    "yield": ("yield_stress", "pressure"),
    "hardness": ("hardness", "pressure"),
    "conductivity": ("conductivity", ""),
    "resistivity": ("resistivity", ""),
    "fatigue_torsion": ("fatigue_torsion", "pressure"),
    "fatigue_bending": ("fatigue_bending", "pressure"),
    "residual_stress": ("residual_stress", "pressure"),
    "layer_height": ("height", "length"),
    "bottom": ("bottom", ""),
    "coating": ("coating", "length"),
    "coating_young": ("coating_young", "pressure"),
    "coating_poisson": ("coating_poisson", ""),
    "coating_yield": ("coating_yield", "pressure"),
}
"""Setting → field of `Body`, and its dimension; settings of the upper body begin with ``counter_``."""

MAX_LOADS, RISING = 100, "a list of rising values"
"""Most loads of a load curve, and their description in messages."""

LARGEST_LOAD = 1e6
"""Largest mean pressure over the effective modulus, and approach over the edge of the map."""

HARDNESS_OVER_YIELD = 3.0
"""Indentation hardness over yield stress (D. Tabor, The Hardness of Metals, 1951)."""

TANGENTIAL = {"tangential_force": "force", "tangential_displacement": "length"}
"""Setting and field of `Case` for partial slip → its dimension."""

FILM = {"flow_direction": "", "viscosity": "", "pressure_difference": "pressure"}
"""The same for the gap and the film in it."""

CONDUCTION = ("conductivity", "resistivity")
"""Fields of `Body` that a contact conductance needs for both bodies."""

LENGTHS = dict.fromkeys(("wavelength_short", "radius", "s_filter", "l_filter"), "length")
"""Fields of `MapOptions` that are lengths; numbers in `physical_size` are in the unit of the heights."""


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
        In Pa; without it yielding is not analysed.
    hardness : float, optional
        Largest pressure in Pa that its surface bears; without it the contact is elastic. See
        `asperity.contact.solve`.
    conductivity, resistivity : float, optional
        Thermal conductivity in W/(m K) and electrical resistivity in Ω m. If both bodies have them, the
        contact conductance is computed.
    height : float, optional
        Height in m of a layer on a rigid base; without it the body is a half-space.
    bottom : "bonded", "frictionless" or "free"
        Lower face of the layer.
    fatigue_torsion, fatigue_bending : float, optional
        Fatigue limits in Pa in fully reversed torsion and bending, both or none. With them the cycles of the
        stress are analysed, with this body taken as smooth; see `asperity.stress_cycles`.
    residual_stress : float, optional
        Equal normal stresses along x and y in Pa in the unloaded body, compression negative. They are added
        to the mean stress in the criterion of Dang Van.
    coating, coating_young, coating_poisson : float, optional
        Thickness in m, Young's modulus in Pa and Poisson's ratio of a coating that is bonded to the body, a
        half-space; all or none. The hardness is that of the coated body, yield stress and fatigue limits are
        those below the coating.
    coating_yield : float, optional
        Yield stress of the coating in Pa.

    Examples
    --------
    >>> steel = asp.Body(young=210e9, poisson=0.3, yield_stress=1.5e9)  # Pa
    >>> film = asp.Body(young=2e9, poisson=0.4, height=5e-6)  # 5 µm on a rigid base
    >>> film.layer.height
    5e-06
    >>> coated = asp.Body(210e9, 0.3, coating=2e-6, coating_young=400e9, coating_poisson=0.25)
    >>> coated.layer
    Layer(young=4e+11, poisson=0.25, height=2e-06, base=Layer(young=2.1e+11, poisson=0.3))
    """

    young: float
    poisson: float
    yield_stress: float | None = None
    height: float | None = None
    bottom: str = "bonded"
    hardness: float | None = None
    conductivity: float | None = None
    resistivity: float | None = None
    fatigue_torsion: float | None = None
    fatigue_bending: float | None = None
    coating: float | None = None
    coating_young: float | None = None
    coating_poisson: float | None = None
    coating_yield: float | None = None
    residual_stress: float | None = None

    def __post_init__(self) -> None:
        given = {name: getattr(self, name) for name in ("coating", "coating_young", "coating_poisson")}
        missing = [name for name, value in given.items() if value is None]
        if 0 < len(missing) < len(given) or (missing and self.coating_yield is not None):
            raise ValueError(f"{missing[0]}: missing; a coating needs all of {', '.join(given)}")
        if self.coating is not None and (self.height is not None or self.bottom != "bonded"):
            raise ValueError(
                f"coating = {shown_si(self.coating, 'm')}: not accepted with a height or a bottom of the body"
            )
        _ = self.layer  # checks its constants
        for name in ("yield_stress", "hardness", "conductivity", "resistivity", "coating_yield"):
            if getattr(self, name) is not None:
                magnitude(name, getattr(self, name))
        if self.fatigue_torsion is not None or self.fatigue_bending is not None:
            hydrostatic_factor(self.fatigue_torsion, self.fatigue_bending)

    @property
    def layer(self) -> Layer:
        """The body as the solver takes it."""
        body = Layer(self.young, self.poisson, self.height, self.bottom)
        if self.coating is None or self.coating_young is None or self.coating_poisson is None:
            return body
        return Layer(self.coating_young, self.coating_poisson, self.coating, base=body)


@dataclass(frozen=True)
class HertzPlace:
    """Place of the map in a Hertz contact of bodies that are far larger than the map.

    Parameters
    ----------
    radius_x, radius_y : float
        Combined radii of curvature of both bodies along x and along y in m; infinite along the axis of a
        roller.
    at : (y, x)
        Place of the map from the middle of the contact, in half-widths.
    """

    radius_x: float
    radius_y: float
    at: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("radius_x", "radius_y"):
            if getattr(self, name) != math.inf:
                magnitude(name, getattr(self, name))
        if self.radius_x == self.radius_y == math.inf:
            raise ValueError("radius_x = inf, radius_y = inf: at most one of them is infinite")
        y, x = self.at
        roller = (self.radius_y == math.inf and y) or (self.radius_x == math.inf and x)
        if not self.share > 0 or roller:
            where = " across the axis of the roller" if math.inf in (self.radius_x, self.radius_y) else ""
            raise ValueError(
                f"at = {y:g} {x:g}: a place inside the contact, nearer than one half-width{where}, is needed"
            )

    @property
    def share(self) -> float:
        """Pressure at the place over the largest pressure."""
        return math.sqrt(max(0.0, 1 - self.at[0] ** 2 - self.at[1] ** 2))

    def contact(self, kind: str, load: float, effective_modulus: float) -> HertzContact:
        """The Hertz contact under a kind of `Load`; a `mean_pressure` is the pressure at the place."""
        given = {"force": load} if kind == "force" else {"largest_pressure": load}
        if kind == "mean_pressure":
            given["largest_pressure"] /= self.share
        return HertzContact.from_radii(self.radius_x, self.radius_y, effective_modulus, **given)


@dataclass(frozen=True)
class Load:
    """The one quantity that is imposed.

    Parameters
    ----------
    kind : "mean_pressure", "hertz_pressure", "force", "approach" or "area_fraction"
        Load over the nominal area in Pa; largest pressure of a Hertz contact; load in N; approach of the
        bodies since their first touch in m; real over nominal contact area.
    value : float
    path : tuple of float
        Rising loads of a load curve, the last equal to the value; empty for a single load.
    """

    kind: str
    value: float
    path: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        choice("load", self.kind, tuple(CONTROL_UNITS))
        for value in self.path or (self.value,):
            if self.kind == "area_fraction":
                number(self.kind, value, "a number > 0 and ≤ 1", lambda value: 0 < value <= 1)
            else:
                magnitude(self.kind, value)
        if any(after <= before for before, after in pairwise(self.path)):
            raise ValueError(
                f"{self.kind} = {', '.join(f'{value:g}' for value in self.path)}: {RISING} is needed"
            )

    @classmethod
    def chosen(cls, **given: float | Sequence[float] | None) -> "Load":
        """The load from exactly one given keyword argument; several values are a load curve."""
        named = {kind: value for kind, value in given.items() if value is not None}
        if len(named) != 1:
            known, found = ", ".join(CONTROL_UNITS), ", ".join(named) or "none"
            raise ValueError(f"exactly one of {known} is needed, got {found}")
        kind, value = named.popitem()
        if isinstance(value, str) or not isinstance(value, Sequence):
            return cls(kind, value)
        if not 1 <= len(value) <= MAX_LOADS:
            raise ValueError(f"{kind} has {len(value)} values: 1 to {MAX_LOADS} are needed")
        return cls(kind, value[-1], tuple(value) if len(value) > 1 else ())


@dataclass(frozen=True)
class Case:
    """Map, bodies, load and outputs: all that an answer depends on.

    Parameters
    ----------
    source : path or HeightMap
        File of the map of the lower body, or a map in metres.
    lower : Body
    upper : Body or None
        None: rigid. Which of the bodies is rough does not matter as long as the slopes are small.
    load : Load
    friction : float
        Coefficient of friction μ of full sliding, with the shear traction μ p; the pressure is that of the
        contact without friction. For half-spaces, coated or not, and layers bonded to a rigid base.
    sliding_direction : "x", "y" or float
        Direction in which the upper body moves over the lower one, that of the traction on the lower body; a
        number is an angle in degrees from x towards y.
    options : MapOptions
        By default points without data are filled, and a map that is not declared periodic is mirrored. With
        ``periodic="none"`` nothing surrounds the map.
    counter_map : CounterMap or None
    fields : names
        Fields of `asperity.stress_planes` whose peaks are listed and that are drawn.
    hertz : HertzPlace, optional
        Place of the map in the Hertz contact of two half-spaces. The load is then the largest pressure or the
        force of that contact, or the mean pressure at the place.
    shifts : int, optional
        Positions of two rough faces that move against each other along the sliding direction, for the stress
        cycles of each; in a Hertz contact, positions of a point that passes through it. See
        `asperity.MovingContact`.
    slide_to_roll : float
        As of `asperity.MovingContact`.
    fatigue_scatter, fatigue_volume : float, optional
        Coefficient of variation of the fatigue limits, and stressed volume in m³ of the specimens on which
        they were measured, both or none: the probability that no crack starts follows; see
        `asperity.cracks_per_area`.
    tangential_force, tangential_displacement : float, optional
        Force on the map in N, of at most the friction times the load, or displacement of the bodies in m:
        instead of full sliding the bodies slip in part, see `asperity.partial_slip`.
    flow_direction : "x" or "y", optional
        Direction of a leak; with it the percolation of the gap is analysed, see `asperity.percolation`.
    viscosity, pressure_difference : float, optional
        Viscosity in Pa s of a film that leaks along that direction, by default x, and its pressure drop over
        the length of the map in Pa; see `asperity.film_flow`.

    Examples
    --------
    >>> settings = {"map": "steel.x3p", "young": "210 GPa", "poisson": 0.3, "pressure": "50 MPa"}
    >>> case = asp.engineering.Case.of(settings)
    >>> case.load.value, case.settings() == settings
    (50000000.0, True)
    """

    source: Source
    lower: Body
    upper: Body | None
    load: Load
    friction: float = 0.0
    sliding_direction: str | float = "x"
    options: MapOptions = MapOptions()  # noqa: RUF009  is immutable
    counter_map: CounterMap | None = None
    fields: Sequence[str] = ("von_mises",)
    hertz: HertzPlace | None = None
    tangential_force: float | None = None
    tangential_displacement: float | None = None
    flow_direction: str | None = None
    viscosity: float | None = None
    pressure_difference: float | None = None
    shifts: int | None = None
    slide_to_roll: float = 0.0
    fatigue_scatter: float | None = None
    fatigue_volume: float | None = None

    def __post_init__(self) -> None:
        for name, body in (("lower", self.lower), ("upper", self.upper or self.lower)):
            if not isinstance(body, Body):
                raise TypeError(f"{name} = {shown(body)}: a Body is needed")
            shear_traction(self.friction, self.sliding_direction, body.layer)
        object.__setattr__(self, "fields", choices("fields", self.fields, FIELDS))
        for name in CONDUCTION:
            values = [getattr(body, name) for body in self.bodies.values()]
            if any(values) and not (len(values) == 2 and all(values)):
                raise ValueError(
                    f"{name} = {max(filter(None, values)):g}: a second elastic body (counter_young), with "
                    f"its own {name}, is needed"
                )
            if any(values) and self.solid.height is not None:
                raise ValueError(f"{name} = {values[0]:g}: half-spaces without coatings are needed")
        self._check_hertz()
        if self.load.kind == "mean_pressure" or self.hertz is not None:
            self.check_pressure(self.cell_pressure)
        self._check_sideways()
        for name, other in (("viscosity", "pressure_difference"), ("pressure_difference", "viscosity")):
            if (value := getattr(self, name)) is not None:
                magnitude(name, value)
                if getattr(self, other) is None:
                    raise ValueError(f"{name} = {value:g}: a {other} is needed, too")
        if self.viscosity is not None and self.flow_direction is None:
            object.__setattr__(self, "flow_direction", "x")
        if self.flow_direction is not None:
            choice("flow_direction", self.flow_direction, ("x", "y"))
        self._check_motion()

    def _check_motion(self) -> None:
        if (self.fatigue_scatter is None) != (self.fatigue_volume is None):
            raise ValueError("fatigue_scatter, fatigue_volume: both are needed, or none")
        if self.fatigue_scatter is not None:
            weibull_exponent(self.fatigue_scatter)
            if not any(body.fatigue_torsion for body in self.bodies.values()):
                raise ValueError(f"fatigue_scatter = {self.fatigue_scatter:g}: fatigue limits are needed")
        if self.shifts is None:
            if self.slide_to_roll:
                raise ValueError(f"slide_to_roll = {self.slide_to_roll:g}: shifts are needed")
            if any(body.fatigue_torsion for body in self.bodies.values()):
                axis_of_motion(self.sliding_direction)
                if self.counter_map is not None:
                    raise ValueError(
                        f"counter_map = {shown(_name_of(self.counter_map.source))}: shifts are needed for "
                        "the stress cycles of two rough faces"
                    )
            return
        refused = {
            "slide_to_roll without a Hertz contact": self.slide_to_roll and self.hertz is None,
            "boundary = 'free'": self.options.periodic == "none",
            "a radius of the map": self.options.radius is not None,
            "a load curve": self.load.path,
            "a coating": any(body.coating for body in self.bodies.values()),
            "partial slip": self.tangential_force or self.tangential_displacement,
        }
        for name in (name for name, given in refused.items() if given):
            raise ValueError(f"shifts = {self.shifts}: not accepted together with {name}")

    def _check_hertz(self) -> None:
        if self.hertz is None:
            if self.load.kind == "hertz_pressure":
                raise ValueError(f"hertz_pressure = {shown_si(self.load.value, 'Pa')}: a radius is needed")
            return
        if self.load.kind not in ("hertz_pressure", "force", "mean_pressure"):
            raise ValueError(
                f"{self.load.kind}: Hertz pressure, force or mean pressure is needed in a Hertz contact"
            )
        if self.load.kind == "force" and math.inf in (self.hertz.radius_x, self.hertz.radius_y):
            raise ValueError("force: the Hertz pressure is needed under a roller, whose length is not known")
        if self.solid.height is not None:
            name = "layer_height" if self.solid.interface is None else "coating"
            raise ValueError(f"{name} = {self.solid.height:g}: half-spaces are needed in a Hertz contact")
        if self.options.periodic == "none":
            raise ValueError(
                "boundary = 'free': periodic is needed in a Hertz contact, of which the map is a part"
            )

    @property
    def hertz_contact(self) -> HertzContact | None:
        """The Hertz contact under the load."""
        if self.hertz is None:
            return None
        return self.hertz.contact(self.load.kind, self.load.value, self.solid.effective_modulus)

    @property
    def cell_pressure(self) -> float:
        """Mean pressure on the map in a Hertz contact; without one the load."""
        contact = self.hertz_contact
        return self.load.value if contact is None else contact.largest_pressure * self.hertz.share  # type: ignore

    def loaded_body(self, contact: Contact, name: str) -> LoadedSolid:
        """A body under the pressure of a contact, with the stress that the Hertz contact adds."""
        loaded = contact.in_body(name)
        if self.hertz is None:
            return loaded
        smooth = self.hertz.contact("mean_pressure", contact.mean_pressure, self.solid.effective_modulus)
        below = smooth.background(*smooth.position(self.hertz.at), loaded.layer, **self.sliding_of(name))
        return replace(loaded, background=below, deepest=smooth.deepest(self.bodies[name].yield_stress))

    def check_pressure(self, mean_pressure: float) -> None:
        """Raise `ValueError` for a mean pressure that is too large, or not below the hardness."""
        most = min(LARGEST_LOAD * self.solid.effective_modulus, LARGEST_PRESSURE)
        if not mean_pressure < most:
            given = shown_si(self.load.value, CONTROL_UNITS[self.load.kind])
            raise ValueError(
                f"{self.load.kind} = {given}: a mean pressure "
                f"of less than {shown_si(most, 'Pa')} is needed, it would be {shown_si(mean_pressure, 'Pa')}"
            )
        if self.hardness and not mean_pressure < self.hardness:
            raise ValueError(
                f"hardness = {shown_si(self.hardness, 'Pa')}: more than the pressure "
                f"{shown_si(mean_pressure, 'Pa')} is needed, the mean over the nominal area"
            )

    def _check_sideways(self) -> None:
        given = {name: value for name in TANGENTIAL if (value := getattr(self, name)) is not None}
        for name, value in given.items():
            magnitude(name, value)
            text = f"{name} = {shown_si(value, DIMENSIONS[TANGENTIAL[name]].unit)}"
            if len(given) > 1:
                raise ValueError(f"{text}: not accepted together with {next(iter(given.keys() - {name}))}")
            if not self.friction:
                raise ValueError(f"{text}: a friction above 0 is needed")
            if self.hertz is not None:
                raise ValueError(f"{text}: a map that is no part of a Hertz contact is needed")
            if self.load.path:
                raise ValueError(f"{text}: one load is needed, not a load curve")
            if self.hardness:
                raise ValueError(f"{text}: an elastic contact is needed, without hardness")
            if any(body.fatigue_torsion for body in self.bodies.values()):
                raise ValueError(f"{text}: full sliding is needed for stress cycles (fatigue_torsion)")
            if name == "tangential_displacement" and self.solid.uniform_compliance():
                raise ValueError(f"{text}: half-spaces are needed, or a tangential_force on layers")
        if self.load.kind == "force":
            self.check_tangential_force(self.load.value)

    def check_tangential_force(self, force: float) -> None:
        """Raise `ValueError` if the tangential force is above the friction times a load on the map."""
        limit = self.friction * force
        if self.tangential_force is not None and self.tangential_force > limit * (1 + 1e-12):
            raise ValueError(
                f"tangential_force = {shown_si(self.tangential_force, 'N')}: at most {shown_si(limit, 'N')} "
                "is needed, friction times load, at which the bodies slide"
            )

    @classmethod
    def of(cls, settings: Mapping[str, Any]) -> "Case":
        """The case from the settings of ``asperity run``, quantities as texts with their units."""

        def si(name: str, dimension: str) -> Any:
            value = settings[name]
            return to_si(value, dimension, name) if dimension else value

        def body(prefix: str) -> Body:
            known = {prefix + name: entry for name, entry in BODY.items() if prefix + name in settings}
            constants = {field: si(name, dimension) for name, (field, dimension) in known.items()}
            try:
                return Body(**constants)
            except ValueError as error:
                raise ValueError(f"{prefix}{error}") from error

        loads = {
            kind: loads_of(name, settings) for name, (kind, _) in LOAD_QUANTITIES.items() if name in settings
        }
        direction = settings.get("sliding_direction", "x")
        return cls(
            settings["map"],
            body(""),
            body("counter_") if "counter_young" in settings else None,
            Load.chosen(**loads),
            settings.get("friction", 0.0),
            direction if direction in ("x", "y") else float(direction),
            options_of(settings),
            counter_map_of(settings),
            tuple(settings.get("fields", ("von_mises",))),
            hertz_of(settings),
            shifts=settings.get("shifts"),
            slide_to_roll=settings.get("slide_to_roll", 0.0),
            fatigue_scatter=settings.get("fatigue_scatter"),
            fatigue_volume=si("fatigue_volume", "volume") if "fatigue_volume" in settings else None,
            **{name: si(name, kind) for name, kind in (TANGENTIAL | FILM).items() if name in settings},
        )

    def settings(self) -> dict[str, Any]:
        """The settings from which `of` makes the case, without those at their default."""
        found: dict[str, Any] = {"map": _name_of(self.source)}

        def add(name: str, value: Any, default: Any = None, dimension: str = "") -> None:
            if value != default:
                found[name] = _plain(value, dimension)

        for prefix, body in (("", self.lower), ("counter_", self.upper)):
            for name, (field, dimension) in BODY.items() if body else ():
                add(prefix + name, getattr(body, field), "bonded" if name == "bottom" else None, dimension)
        for name, (kind, dimension) in LOAD_QUANTITIES.items():
            value = self.load.path or self.load.value
            add(name, value if kind == self.load.kind else None, dimension=dimension)
        add("friction", self.friction, 0.0)
        direction = self.sliding_direction
        add("sliding_direction", direction if isinstance(direction, str) else f"{direction:.15g}", "x")
        for entry in fields(MapOptions):
            value, dimension = getattr(self.options, entry.name), LENGTHS.get(entry.name, "")
            if (entry.name, value) == ("periodic", "none"):
                add("boundary", "free")
            elif entry.name == "channel" and value is not None:
                add("channel", str(value))
            elif entry.name != "undefined":
                add(entry.name, value, entry.default, dimension)
        if counter := self.counter_map:
            add("counter_map", _name_of(counter.source))
            add("counter_turned_about", counter.turned_about, "y")
            add("counter_shift", tuple(counter.shift), (0.0, 0.0), "length")
        add("fields", self.fields, ("von_mises",))
        add("shifts", self.shifts)
        add("slide_to_roll", self.slide_to_roll, 0.0)
        add("fatigue_scatter", self.fatigue_scatter)
        add("fatigue_volume", self.fatigue_volume, dimension="volume")
        if hertz := self.hertz:
            is_roller = math.inf in (hertz.radius_x, hertz.radius_y)
            add("radius", hertz.radius_y if hertz.radius_x == math.inf else hertz.radius_x, None, "length")
            add("form", "cylinder" if is_roller else None)
            add("cylinder_axis", "x" if hertz.radius_x == math.inf else None)
            add("radius_y", None if is_roller else hertz.radius_y, None, "length")
            add("at", hertz.at)
        for name, dimension in (TANGENTIAL | FILM).items():
            add(name, getattr(self, name), dimension=dimension)
        return found

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
    def different_bodies(self) -> dict[str, Body]:
        """The elastic bodies by name; of two with the same stress only the lower one.

        Equal bodies have the same stress without friction and without moving faces.
        """
        alike = self.lower == self.upper and not self.friction and self.shifts is None
        return {"lower": self.lower} if alike else self.bodies

    @property
    def hardness(self) -> float | None:
        """The smaller hardness of the bodies; None if they have none."""
        return min((body.hardness for body in self.bodies.values() if body.hardness), default=None)

    @property
    def resistivities(self) -> dict[str, float]:
        """Name of a conductance → sum of the resistivities of both bodies, thermal or electrical."""
        bodies, found = self.bodies.values(), {}
        if self.lower.conductivity:
            found["thermal_conductance"] = sum(1 / (body.conductivity or math.inf) for body in bodies)
        if self.lower.resistivity:
            found["electrical_conductance"] = sum(body.resistivity or 0.0 for body in bodies)
        return found

    @property
    def solid(self) -> Layer | TwoBodies:
        """The solid, or the two bodies, that the solver presses."""
        return self.lower.layer if self.upper is None else TwoBodies(self.lower.layer, self.upper.layer)


def loads_of(name: str, settings: Mapping[str, Any]) -> float | list[float]:
    """The load, or the rising loads, of a setting of `LOAD_QUANTITIES`, in SI units.

    Raises
    ------
    ValueError
        If several do not rise, or ``steps`` is given without two of them.
    """
    given, dimension = settings[name], LOAD_QUANTITIES[name][1]
    listed = given if isinstance(given, (list, tuple)) else [given]
    loads = [to_si(value, dimension, name) if dimension else value for value in listed]
    shown_loads = shown(" ".join(map(str, listed)))
    if any(after <= before for before, after in pairwise(loads)):
        raise ValueError(f"{name} = {shown_loads}: {RISING} is needed")
    if (steps := settings.get("steps")) is not None:
        if len(loads) != 2:
            raise ValueError(
                f"{name} = {shown_loads}: two values, the first and the last, are needed with steps"
            )
        loads = np.geomspace(loads[0], loads[1], steps).tolist()
    return loads if len(loads) > 1 else loads[0]


def hertz_of(settings: Mapping[str, Any]) -> HertzPlace | None:
    """The Hertz contact in settings of ``asperity run``; None if they describe none."""
    if not is_hertz(settings) or "radius" not in settings:
        return None
    radius = to_si(settings["radius"], "length", "radius")
    radii = radius, to_si(settings["radius_y"], "length", "radius_y") if "radius_y" in settings else radius
    if settings.get("form") == "cylinder":
        radii = (math.inf, radius) if settings.get("cylinder_axis") == "x" else (radius, math.inf)
    return HertzPlace(*radii, tuple(settings.get("at", (0.0, 0.0))))


def suggested_hardness(case: Case) -> float | None:
    """Hardness that the yield stresses of a case without hardness suggest; None without a yield stress."""
    bodies = case.bodies.values()
    limits = [body.yield_stress if body.coating is None else body.coating_yield for body in bodies]
    known = [limit for limit in limits if limit is not None]
    return HARDNESS_OVER_YIELD * min(known) if known and case.hardness is None else None


def _name_of(source: Source) -> str:
    return source.name or "map" if isinstance(source, HeightMap) else os.fspath(source)


def _plain(value: Any, dimension: str) -> Any:
    """A value for a YAML file: a quantity as text with its unit, a tuple as a list."""
    if isinstance(value, (tuple, list)):
        return [_plain(item, dimension) for item in value]
    if not dimension or isinstance(value, str):
        return value
    return shown_si(value, DIMENSIONS[dimension].unit, 15)
