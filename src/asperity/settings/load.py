"""The load of a case: exactly one quantity is imposed, and each has a class of its own."""

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from pydantic import (
    GetPydanticSchema,
    PlainValidator,
    SerializeAsAny,
    ValidationInfo,
)

from asperity.core.errors import did_you_mean
from asperity.settings.model import (
    ContradictionError,
    NeededError,
    Number,
    Settings,
    described,
    nested,
    optional,
    setting,
)
from asperity.settings.quantities import Force as ForceInNewton
from asperity.settings.quantities import Length, Pressure, Radius

UNITS = {"mean_pressure": "Pa", "hertz_pressure": "Pa", "force": "N", "approach": "m", "area_fraction": "1"}
"""Quantity that may be imposed → its unit."""

LARGEST_LOAD = 1e6
"""Largest mean pressure over the effective modulus, and approach over the edge of the map."""


class OneLoad(Settings):
    """A load that one quantity imposes."""

    @property
    def kind(self) -> str:
        """Name of the quantity that is imposed."""
        return next(name for name in UNITS if getattr(self, name, None) is not None)

    @property
    def value(self) -> float:
        """Its value in SI units."""
        return float(getattr(self, self.kind))


class MeanPressure(OneLoad):
    """Load over the nominal area."""

    mean_pressure: Pressure = setting(..., example="50 MPa")
    """Load over the nominal area."""


class Force(OneLoad):
    """Load on the area of the map."""

    force: ForceInNewton = setting(..., example="12 N")
    """Load on the area of the map, or on the whole Hertz contact."""


class Approach(OneLoad):
    """Normal approach of the bodies since their first touch."""

    approach: Length = setting(..., example="200 nm")
    """Normal approach of the bodies since their first touch (δ − min h, docs/glossary.md)."""


class AreaFraction(OneLoad):
    """Contact area fraction."""

    area_fraction: Number = setting(..., gt=0, le=1, example=0.05)
    """Contact area fraction: real over nominal contact area."""


class Hertz(OneLoad):
    """Load of a Hertz contact of half-spaces, of which the map is a small part.

    Raises
    ------
    SettingsError
        If not exactly one load is given, or the place is outside of the contact.
    """

    hertz_pressure: Pressure | None = optional("another quantity is imposed", example="1.2 GPa")
    """Maximum pressure of a Hertz contact, of which the map is a small part."""
    force: ForceInNewton | None = optional("another quantity is imposed")
    """Force of the whole Hertz contact."""
    mean_pressure: Pressure | None = optional("another is imposed")
    """Pressure of the Hertz contact at the place of the map."""
    radius_x: Radius = setting(..., default_text="no Hertz contact", example="9 mm")
    """Combined radius of curvature of both bodies along x, or `inf` along the axis of a roller. With it
    the map lies in a Hertz contact."""
    radius_y: Radius | None = optional("the radius along x", example="80 mm")
    """Combined radius of curvature along y, or `inf` along the axis of a roller."""
    at: tuple[Number, Number] = setting(
        (0.0, 0.0),
        accepts="two numbers (y, x) inside the contact, nearer than one half-width",
        example=[0, 0.2],
    )
    """Position (y, x) of the map relative to the middle of the Hertz contact, in half-widths of the
    contact."""

    def contradictions(self) -> Iterator[tuple[str, str]]:
        given = [name for name in UNITS if getattr(self, name, None) is not None]
        if len(given) != 1:
            text = ": exactly one of them is needed in a Hertz contact, "
            yield "hertz_pressure, force, mean_pressure", f"{text}{' and '.join(given) or 'none'} given"
        is_roller = math.inf in self.radii
        if self.radii == (math.inf, math.inf):
            yield "radius_y", " = inf: at most one of the radii is infinite"
        y, x = self.at
        if not self.share > 0 or (is_roller and (y if self.radii[1] == math.inf else x)):
            where = " across the axis of the roller" if is_roller else ""
            inside = f"a place inside the contact, nearer than one half-width{where}, is needed"
            yield "at", f" = {y:g} {x:g}: {inside}"
        if is_roller and self.force is not None:
            yield "force", ": the Hertz pressure is needed under a roller, whose length is not known"

    @property
    def radii(self) -> tuple[float, float]:
        """Radii along x and along y in m."""
        return self.radius_x, self.radius_x if self.radius_y is None else self.radius_y

    @property
    def share(self) -> float:
        """Pressure at the place over the largest pressure."""
        return math.sqrt(max(0.0, 1 - self.at[0] ** 2 - self.at[1] ** 2))


LOADS: tuple[type[OneLoad], ...] = (MeanPressure, Force, Approach, AreaFraction)


def _chosen(value: Any, info: ValidationInfo) -> OneLoad:
    """The load of the class whose quantity is given."""
    if isinstance(value, OneLoad):
        return value
    if not isinstance(value, Mapping):
        raise NeededError(f"a group with one of {', '.join(UNITS)}")
    known = Hertz.model_fields.keys() | UNITS.keys()
    if unknown := [str(name) for name in value if name not in known]:
        raise ContradictionError(*((name, f": unknown key{did_you_mean(name, known)}") for name in unknown))
    in_hertz_contact = not value.keys().isdisjoint(Hertz.model_fields.keys() - UNITS.keys())
    given = [name for name in UNITS if name in value]
    if in_hertz_contact and (others := [name for name in given if name not in Hertz.model_fields]):
        text = ": hertz_pressure, force or mean_pressure is needed in a Hertz contact"
        raise ContradictionError(*((name, text) for name in others))
    if not in_hertz_contact and len(given) != 1:
        text = f": exactly one of them is needed, {' and '.join(given) or 'none'} given"
        raise ContradictionError((", ".join(UNITS), text))
    if not in_hertz_contact and given == ["hertz_pressure"]:
        raise ContradictionError(("hertz_pressure", ": needs radius_x"))
    chosen = Hertz if in_hertz_contact else next(each for each in LOADS if given[0] in each.model_fields)
    return nested(chosen, value, info)


def _description(*_: Any) -> dict[str, Any]:
    """Description of a load, in the words of a JSON Schema."""
    kinds = [described(kind)["properties"] for kind in (Hertz, *LOADS)]
    one = "exactly one of mean_pressure, force, approach, area_fraction and hertz_pressure"
    return {
        "type": "object",
        "description": f"The load: {one}.",
        "accepts": f"a group with one of {', '.join(UNITS)}",
        "additionalProperties": False,
        "properties": {key: entry for properties in kinds for key, entry in properties.items()},
    }


# The description is made when it is asked for: it takes as long as the import of pydantic.
Load = Annotated[SerializeAsAny[OneLoad], PlainValidator(_chosen), GetPydanticSchema(None, _description)]
"""A load of one of the classes of this module, or a mapping from which it is made."""
