"""The load of a case, imposed on the map or on a Hertz contact around it, and the adhesion of the faces."""

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, GetPydanticSchema, PlainValidator, SerializeAsAny, ValidationInfo

from asperity.settings.model import NeededError, Number, Settings, described, nested, optional, setting
from asperity.settings.quantities import Force, Length, Pressure, Quantity, Radius

UNITS = {
    "mean_pressure": "Pa",
    "hertz_pressure": "Pa",
    "force": "N",
    "normal_approach": "m",
    "contact_area_fraction": "1",
}
"""Quantity that may be imposed → its unit."""

LARGEST_LOAD = 1e6
"""Largest mean pressure over the effective modulus, and approach over the edge of the map."""

ACCEPTED = f"a group with one of {', '.join(UNITS)}"

OTHER = "another load is given"


class OneLoad(Settings):
    """The load: exactly one of mean_pressure, force, normal_approach, contact_area_fraction and
    hertz_pressure.
    """

    model_config = ConfigDict(json_schema_extra={"accepts": ACCEPTED})

    mean_pressure: Pressure | None = optional(OTHER, example="50 MPa")
    """Load over the nominal area, in a Hertz contact at the position of the map."""
    force: Force | None = optional(OTHER, example="12 N")
    """Load on the area of the map, or on the whole Hertz contact."""
    normal_approach: Length | None = optional(OTHER, example="200 nm")
    """Normal approach since first contact (δ − min h, docs/glossary.md)."""
    contact_area_fraction: Number | None = optional(OTHER, gt=0, le=1, example=0.05)
    """Real over nominal contact area."""
    hertz_pressure: Pressure | None = optional(OTHER, example="1.2 GPa")
    """Maximum pressure of a Hertz contact, of which the map is a small part."""
    radius_x: Radius | None = optional("no Hertz contact", example="9 mm")
    """Combined radius of curvature of both bodies along x, or `inf` along the axis of a roller. With it
    the map lies in a Hertz contact."""
    radius_y: Radius | None = optional("the radius along x", example="80 mm")
    """Combined radius of curvature along y."""
    at: tuple[Number, Number] = setting(
        (0.0, 0.0),
        accepts="two numbers (y, x) inside the contact, nearer than one half-width",
        example=[0, 0.2],
    )
    """Position (y, x) of the map in the Hertz contact, from its middle, in half-widths."""

    def contradictions(self) -> Iterator[tuple[str, str]]:
        given = [name for name in UNITS if getattr(self, name) is not None]
        if len(given) != 1:
            words = f"exactly one of them is needed, {' and '.join(given) or 'none'} given"
            yield ", ".join(UNITS), f": {words}"
        if self.radius_x is None:
            wrong = self.model_fields_set & {"hertz_pressure", "radius_y", "at"}
            yield from ((name, ": needs radius_x") for name in sorted(wrong))

    @property
    def kind(self) -> str:
        """Name of the quantity that is imposed."""
        return next(name for name in UNITS if getattr(self, name) is not None)

    @property
    def value(self) -> float:
        """Its value in SI units."""
        return float(getattr(self, self.kind))

    @property
    def place(self) -> dict[str, Any]:
        """Settings of the Hertz contact, and the place of the map in it; empty without one."""
        return {}


class Hertz(OneLoad):
    """Load of a Hertz contact of half-spaces, of which the map is a small part."""

    radius_x: Radius = setting(...)

    def contradictions(self) -> Iterator[tuple[str, str]]:
        yield from super().contradictions()
        text = ": hertz_pressure, force or mean_pressure is needed in a Hertz contact"
        yield from (
            (name, text)
            for name in ("normal_approach", "contact_area_fraction")
            if getattr(self, name) is not None
        )
        is_roller = math.inf in self.radii
        if self.radii == (math.inf, math.inf):
            yield "radius_y", " = inf: at most one of the radii is infinite"
        y, x = self.at
        if not self.share > 0 or (is_roller and (y if self.radii[1] == math.inf else x)):
            where = " across the axis of the roller" if is_roller else ""
            inside = f"a position inside the contact, nearer than one half-width{where}, is needed"
            yield "at", f" = {y:g} {x:g}: {inside}"
        if is_roller and self.force is not None:
            yield "force", ": the Hertz pressure is needed under a roller, whose length is not known"

    @property
    def place(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in ("radius_x", "radius_y", "at")}

    @property
    def radii(self) -> tuple[float, float]:
        """Radii along x and along y in m."""
        return self.radius_x, self.radius_x if self.radius_y is None else self.radius_y

    @property
    def share(self) -> float:
        """Pressure at the position over the maximum pressure."""
        return math.sqrt(max(0.0, 1 - self.at[0] ** 2 - self.at[1] ** 2))


def _chosen(value: Any, info: ValidationInfo) -> OneLoad:
    """The load, of a Hertz contact if it has a radius."""
    if isinstance(value, OneLoad):
        return value
    if not isinstance(value, Mapping):
        raise NeededError(ACCEPTED)
    return nested(OneLoad if value.get("radius_x") is None else Hertz, value, info)


# The description is made when it is asked for: it takes as long as the import of pydantic.
Load = Annotated[
    SerializeAsAny[OneLoad],
    PlainValidator(_chosen),
    GetPydanticSchema(None, lambda *_: dict(described(OneLoad))),
]
"""A load of one of the classes of this module, or a mapping from which it is made."""


FIT = "fit"
"""Range that follows from the grid."""


class Attraction(Settings):
    """Attraction of the faces across the gap."""

    work: Annotated[float, Quantity("work of adhesion")] = setting(..., example="50 mJ/m^2", varied=True)
    """Work of adhesion: energy per area that separates the faces."""
    range: Annotated[float | str, Quantity("length", word=FIT)] = setting(FIT, example="20 nm")
    """Length over which the attraction acts; its maximum is work over range. With `fit` the shortest range
    whose cohesive zone spans four pixels."""
    law: Literal["exponential", "maugis-dugdale"] = setting("exponential")
    """Attraction as a function of the gap: `exponential`, or constant up to the range (`maugis-dugdale`)."""
