"""The scene of a case: map, bodies and load, without the questions.

The physics is imported where it is needed: forms, help and schemas are made without it.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, field_validator

from asperity.contact import Adhesion, Contact
from asperity.core.types import FIELDS, Array
from asperity.core.units import shown_si
from asperity.elasticity.loaded_solid import LARGEST, LoadedSolid, direction_cosines, traction_direction
from asperity.elasticity.solid import Solid
from asperity.elasticity.two_bodies import TwoBodies
from asperity.fourier.grid import Grid
from asperity.settings.body import Body
from asperity.settings.load import LARGEST_LOAD, UNITS, Attraction, Hertz, Load
from asperity.settings.map import CounterMap, Map
from asperity.settings.materials import OwnMaterials
from asperity.settings.model import DISTINCT, Settings, one_of, optional, setting
from asperity.stress.cycles.hertz_contact import HertzContact

OF_BOTH_MAPS = {
    *("s_filter", "l_filter", "wavelength_short", "points", "ends"),
    *("radius", "radius_y", "form", "cylinder_axis"),
}
"""Settings of `map` that treat the composite roughness, not the map of one body."""

MATERIALS = "materials.yaml"
"""Name of a user's own table of materials beside the case file."""


SEPARATE_SHARE = 0.4
"""Edges of the part of a map that `fit` takes over the widths of its Hertz contact: the pressure of the
contact falls by less than a tenth from the middle of that part to the middle of an edge."""

LONGEST_PART = 1.0
"""Edge in m of that part along the axis of a roller, whose contact has no end; no map is longer."""

WAY = np.linspace(-2, 2, 81)
"""Places of a point on its way through a smooth Hertz contact, from the middle, in half-widths."""


class Scene(Settings):
    """Map, bodies and load, on which the contact depends. Numbers are in SI units."""

    map: Map = setting(...)
    """The height map that is pressed, peaks upward; or the name of its file alone."""
    body: Body = setting(...)
    """The body, whose surface is the map."""
    counter_body: Body | None = optional("rigid and flat")
    """The counter body, rigid if only its map is given. Which of the two is rough does not matter as long as
    the slopes are small."""
    load: Load = setting(...)
    """The load."""
    adhesion: Attraction | None = optional("no adhesion")
    """Adhesion: the faces attract each other, and a force pulls them off."""
    fields: Annotated[tuple[one_of(FIELDS), ...], Field(min_length=1), DISTINCT] = setting(  # type: ignore[valid-type]
        ("von_mises",)
    )
    """Fields of the stress whose peaks are listed and that are drawn."""
    materials: OwnMaterials | None = optional(f"`{MATERIALS}` beside the case, if there is one")
    """File with materials of your own, or a group of them: name → constants. The case of an answer holds
    those that it uses."""

    @field_validator("counter_body", mode="wrap")
    @classmethod
    def _or_rigid(cls, value: Any, made: Any) -> Any:
        return Body.or_rigid(value, made)

    @property
    def pressed_map(self) -> Map:
        """The map, with the default of `ends`: across a cylinder, on half-spaces without film."""
        own = self.map
        given = (
            own.radius is None or own.form != "cylinder" or own.ends or own.periodic in ("windowed", "none")
        )
        if given or self.layers_and_coatings or "film" in self.questions:
            return own
        return own.replaced(ends="x" if own.cylinder_axis == "y" else "y")

    @property
    def questions(self) -> Mapping[str, Any]:
        """The questions that are asked, by the names of their groups; a scene alone has none."""
        return {}

    def _problems(self) -> Iterator[tuple[str, str]]:
        """Settings of map, bodies and load that exclude each other, and loads that are too large."""
        if self.body.map is not None:
            yield "body.map", ": not accepted; the map of the body is the group `map`"
        if self.counter_map is not None:
            given = self.counter_map.model_dump(include=OF_BOTH_MAPS, exclude_unset=True, exclude_none=True)
            for name in given:
                yield f"counter_body.map.{name}", f": not accepted; it holds for both maps, give map.{name}"
        if "form" in self.map.model_fields_set and self.map.radius is None:
            yield "map.form", ": needs map.radius"
        if self.map.radius_y is not None and (self.map.radius is None or self.map.form == "cylinder"):
            yield "map.radius_y", ": needs map.radius, the radius along x, and no cylinder"
        if "cylinder_axis" in self.map.model_fields_set and self.map.form != "cylinder":
            yield "map.cylinder_axis", ": needs map.form: cylinder"
        if free := self.map.free_edges:
            refused = f": not accepted with {free[0]} = {free[1]}, a free boundary"
            yield from ((key, refused) for key in self.layers_and_coatings)
        if self.map.ends in ("y", "x") and self.map.periodic in ("windowed", "none"):
            yield "map.ends", f" = {self.map.ends}: needs map.periodic: mirrored or declared"
        if self.map.form == "cylinder" and self.map.ends == self.map.cylinder_axis:
            across = "x" if self.map.ends == "y" else "y"
            yield (
                "map.ends",
                f" = {self.map.ends}: {across} or none is needed, a cylinder ends across its axis",
            )
        load = self.load
        if isinstance(load, Hertz):
            needed = ": half-spaces are needed in a Hertz contact"
            yield from ((key, needed) for key in self.layers_and_coatings)
            if free:
                needed = "a periodic map is needed in a Hertz contact, of which it is a part"
                yield free[0], f" = {free[1]}: {needed}"
            if self.map.radius is not None:
                yield "map.radius", ": not accepted in a Hertz contact, whose radii stand in the load"
        if load.kind in ("mean_pressure", "hertz_pressure") or isinstance(load, Hertz):
            yield from self.problems_of_pressure(self.cell_pressure)

    def problems_of_pressure(self, mean_pressure: float) -> Iterator[tuple[str, str]]:
        """A mean pressure on the map that is too high, or not below the hardness."""
        most = min(LARGEST_LOAD * self.solid.effective_modulus, LARGEST)
        given = shown_si(self.load.value, UNITS[self.load.kind])
        if not mean_pressure < most:
            needed = f"a mean pressure of less than {shown_si(most, 'Pa')} is needed"
            yield (
                f"load.{self.load.kind}",
                f" = {given}: {needed}, it would be {shown_si(mean_pressure, 'Pa')}",
            )
        elif self.hardness and not self.hardness_is_estimated and not mean_pressure < self.hardness:
            bodies = self.groups_of_bodies.items()
            name = next(name for name, body in bodies if body.hardness == self.hardness)
            mean = shown_si(mean_pressure, "Pa")
            needed = f"a mean pressure below the hardness {shown_si(self.hardness, 'Pa')} is needed"
            needed += "" if given == mean else f", it would be {mean}"
            remedy = f"check both units, or set {name}.hardness: inf for an elastic contact"
            yield f"load.{self.load.kind}", f" = {given}: {needed}; {remedy}"

    @property
    def elastic_counter_body(self) -> Body | None:
        """The counter body; None if it is rigid."""
        return None if self.counter_body is None or self.counter_body.is_rigid else self.counter_body

    @property
    def groups_of_bodies(self) -> dict[str, Body]:
        """The elastic bodies by the names of their groups."""
        groups = {"body": self.body, "counter_body": self.elastic_counter_body}
        return {name: body for name, body in groups.items() if body is not None}

    @property
    def layers_and_coatings(self) -> list[str]:
        """Dotted keys of the layers and coatings of the elastic bodies."""
        return [f"{name}.layers" for name, body in self.groups_of_bodies.items() if body.layers]

    @property
    def bodies(self) -> dict[str, Body]:
        """The elastic bodies by their place, ``lower`` and ``upper``."""
        return dict(zip(("lower", "upper"), self.groups_of_bodies.values(), strict=False))

    @property
    def different_bodies(self) -> dict[str, Body]:
        """The elastic bodies by name; of two with the same stress only the lower one.

        Equal bodies have the same stress without friction and without moving faces.
        """
        cycles = self.questions.get("cycles")
        moves = self.friction or (cycles is not None and cycles.shifts is not None)
        counter = self.elastic_counter_body
        alike = counter is not None and self.body.is_like(counter)
        return {"lower": self.body} if alike and not moves else self.bodies

    def stress_title(self, body: str) -> str:
        """Heading of the stress of one body."""
        if self.elastic_counter_body is None:
            return "stress in the elastic body"
        if len(self.different_bodies) == 1:
            return "stress in both bodies"
        return f"stress in the {body} body ({self.bodies[body].in_words})"

    @property
    def friction(self) -> float:
        """Coefficient of friction of the stress."""
        sliding = self.questions.get("sliding")
        return 0.0 if sliding is None else sliding.friction

    @property
    def sliding_direction(self) -> str | float:
        """Direction in which the counter body moves over the body."""
        sliding = self.questions.get("sliding")
        given = None if sliding is None else sliding.direction
        return "x" if given is None else given

    @property
    def along(self) -> str:
        """That direction in words."""
        given = self.sliding_direction
        return given if isinstance(given, str) else f"{given:g}° from x"

    @property
    def carried(self) -> float:
        """Fraction of the load that the contact carries; a film carries the rest."""
        film = self.questions.get("film")
        return 1.0 if film is None else 1.0 - film.share

    def sliding_of(self, body: str) -> dict[str, Any]:
        """Friction and direction of the traction on a body, as arguments of `asperity.stress_planes`."""
        direction = traction_direction(self.sliding_direction, body)
        return {"friction": self.friction, "sliding_direction": direction}

    @property
    def softer(self) -> Body | None:
        """The body of the smaller hardness; None if no body has one."""
        known = [body for body in self.bodies.values() if math.isfinite(body.hardness or math.inf)]
        return min(known, key=lambda body: body.hardness or math.inf, default=None)

    @property
    def hardness_is_estimated(self) -> bool:
        """True if the smaller hardness of the bodies follows from a yield stress."""
        return self.softer is not None and self.softer.hardness_is_estimated

    @property
    def hardness(self) -> float | None:
        """The smaller hardness of the bodies; None if they have none.

        One that is only estimated is left out under a larger pressure, which no contact bears, and in partial
        slip, whose contact is elastic.
        """
        if self.softer is None:
            return None
        found, kind = self.softer.hardness, self.load.kind
        if self.softer.hardness_is_estimated and found is not None:
            is_pressure = kind in ("mean_pressure", "hertz_pressure") or self.hertz_contact is not None
            if "partial_slip" in self.questions or (is_pressure and self.cell_pressure >= found):
                return None
        return found

    @cached_property
    def solid(self) -> Solid | TwoBodies:
        """The solid, or the two bodies, that the solver presses."""
        if (counter := self.elastic_counter_body) is None:
            return solid_of(self.body)

        return TwoBodies(solid_of(self.body), solid_of(counter))

    def adhesion_on(self, grid: Grid) -> Adhesion | None:
        """The attraction of the faces on a grid, on which a range that is fitted depends."""
        if (given := self.adhesion) is None:
            return None
        if isinstance(given.range, str):
            return Adhesion.fitted(given.work, self.solid, grid, given.law)
        return Adhesion(given.work, given.range, given.law)

    @property
    def hertz_contact(self) -> HertzContact | None:
        """The Hertz contact under the load."""
        if not isinstance(self.load, Hertz):
            return None
        return hertz_contact(self.load, self.load.kind, self.load.value, self.solid.effective_modulus)

    @property
    def part_in_hertz_contact(self) -> tuple[str, str]:
        """Edges (y, x) of a part of a map over which the pressure of the Hertz contact is nearly uniform."""
        contact = self.hertz_contact
        assert contact is not None
        y, x = (
            shown_si(min(2 * SEPARATE_SHARE * half_width, LONGEST_PART), "m", 2)
            for half_width in (contact.half_width_y, contact.half_width_x)
        )
        return y, x

    @property
    def cell_pressure(self) -> float:
        """Mean pressure on the map in a Hertz contact; without one the load."""
        contact, load = self.hertz_contact, self.load
        return contact.maximum_pressure * load.share if contact and isinstance(load, Hertz) else load.value

    def loaded_body(self, contact: Contact, name: str) -> LoadedSolid:
        """A body under the pressure of a contact, with the stress that layers and Hertz contact add.

        The contact carries `carried` of the pressure of the Hertz contact, and slides.
        """
        loaded, load, body = contact.in_body(name), self.load, self.bodies[name]
        if any(residual := [layer.residual_stress or 0.0 for layer in body.layers]):
            depths, stresses = [*body.interfaces.values()], [*residual, 0.0]
            equal = np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0])
            return replace(loaded, background=lambda depth: stresses[bisect_left(depths, depth)] * equal)
        if not isinstance(load, Hertz):
            return loaded
        smooth, sliding = self._smooth_contact(load, contact, name)
        below = smooth.background(*smooth.position(load.at), loaded.layer, **sliding)
        return replace(loaded, background=below, deepest=smooth.deepest(body.yield_stress))

    def passage(self, contact: Contact, name: str) -> Callable[[float], Array] | None:
        """Stress (6, places) at a depth, of a point that passes through the smooth Hertz contact of a case.

        It passes along the axis next to the direction of sliding, and in any case across a roller.
        """
        if not isinstance(load := self.load, Hertz):
            return None
        smooth, sliding = self._smooth_contact(load, contact, name)
        widths = np.array([smooth.half_width_y, smooth.half_width_x])
        moves = np.abs(direction_cosines(self.sliding_direction)[::-1]) * np.isfinite(widths)
        places = np.repeat(np.array([smooth.position(load.at)]).T, WAY.size, axis=1)
        axis = int(np.argmax(moves)) if moves.any() else int(np.argmin(widths))
        places[axis] = WAY * widths[axis]
        y, x = places
        below = smooth.stress(y, x, solid_of(self.bodies[name]), **sliding)
        return lambda depth: below(depth).T

    def _smooth_contact(
        self, load: Hertz, contact: Contact, name: str
    ) -> tuple[HertzContact, dict[str, Any]]:
        """The Hertz contact around a contact, and friction and direction of its traction on a body."""
        sliding, pressure = self.sliding_of(name), contact.mean_pressure / self.carried
        sliding["friction"] *= self.carried
        return hertz_contact(load, "mean_pressure", pressure, self.solid.effective_modulus), sliding

    def under(self, **load: float) -> Scene:
        """The same bodies under another load, without questions."""
        given = {name: getattr(self, name) for name in ("map", "body", "counter_body", "adhesion")}
        return Scene(**given, load=self.load.place | load)

    @property
    def counter_map(self) -> CounterMap | None:
        """The map of the counter body, without the options that it has from the map."""
        return None if self.counter_body is None else self.counter_body.map

    def with_maps(self, surface: Map, counter: CounterMap | None) -> Self:
        """The same case with other options of its maps."""
        counter_body = self.counter_body
        if counter_body is not None and counter is not None:
            counter_body = counter_body.model_copy(update={"map": counter})
        return self.replaced(map=surface, counter_body=counter_body)


def hertz_contact(place: Hertz, kind: str, load: float, effective_modulus: float) -> HertzContact:
    """The Hertz contact under a kind of load; a `mean_pressure` is the pressure at the place of the map."""
    given = {"force": load} if kind == "force" else {"maximum_pressure": load}
    if kind == "mean_pressure":
        given["maximum_pressure"] /= place.share
    return HertzContact.from_radii(*place.radii, effective_modulus, **given)


def solid_of(body: Body) -> Solid:
    """A body as the solver takes it: layers on a half-space or a rigid base, or a half-space."""
    base = Solid(body.young, body.poisson) if body.base is None else None
    if base is not None and not body.layers:
        return base
    layers = [(layer.thickness, layer.young, layer.poisson) for layer in body.layers]
    return Solid.stack(layers, base, body.base or "bonded")
