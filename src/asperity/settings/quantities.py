"""Types of quantities with units: text such as ``210 GPa`` becomes a number in SI.

In files and on the command line a quantity needs its unit. In Python a number is in SI units.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Real
from typing import Annotated, Any

from pydantic import Field
from pydantic_core import CoreSchema, core_schema

from asperity.settings.model import NeededError, Number, SettingsError, accepted


@dataclass(frozen=True)
class Quantity:
    """A number of a physical dimension.

    Parameters
    ----------
    dimension : str
        A key of `asperity.core.units.DIMENSIONS`.
    positive : bool
        True if only values above 0 are accepted.
    infinite : bool
        True if ``inf`` is accepted.
    word : str
        A word that is accepted, too, and stays as it is.
    bare : bool
        True if a number in the SI unit is accepted everywhere.
    """

    dimension: str
    positive: bool = True
    infinite: bool = False
    word: str = ""
    bare: bool = False

    def __call__(self, value: Any, info: core_schema.ValidationInfo) -> Any:
        """The value in SI; `NeededError` if it is not accepted."""
        if self.word and value == self.word:
            return value
        from asperity.core.arguments import LARGEST, SMALLEST  # need NumPy; the help of a command does not
        from asperity.core.units import misread, to_si

        if self.infinite and str(value).lstrip(".") == "inf":
            return math.inf
        try:
            bare = isinstance(value, Real) and not isinstance(value, bool)
            if bare and (self.bare or not (info.context or {}).get("units")):
                found = float(value)
            elif self.dimension != "force" and misread(value, self.dimension):  # 50 mPa, where MPa is meant
                raise ValueError
            else:
                found = to_si(value, self.dimension)
        except (ValueError, OverflowError):
            raise NeededError(self.needed(value)) from None
        if not (SMALLEST <= found <= LARGEST or (not self.positive and abs(found) <= LARGEST)):
            raise NeededError(self.needed(value))
        return found

    def needed(self, value: Any = "") -> str:
        """Accepted values in words."""
        from asperity.core.units import DIMENSIONS, misread

        article = "an" if self.dimension[0] in "ae" else "a"
        units = ", ".join(DIMENSIONS[self.dimension].examples)
        sign = " > 0" if self.positive else ""
        other = " or inf" if self.infinite else f" or {self.word}" if self.word else ""
        other += f" or a number in {DIMENSIONS[self.dimension].unit}" if self.bare else ""
        return (
            f"{article} {self.dimension}{sign} with its unit ({units}{misread(value, self.dimension)}){other}"
        )

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """A check by this object; written as text with the unit."""
        written = core_schema.plain_serializer_function_ser_schema(self.written, when_used="json")
        return core_schema.with_info_plain_validator_function(self, serialization=written)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """Description of the quantity as text."""
        text = {"type": "string", "format": self.dimension}
        kinds = {"anyOf": [text, {"type": "number"}]} if self.bare else text
        return {**kinds, "accepts": self.needed()}

    def written(self, value: float) -> Any:
        """The value as text with its unit."""
        from asperity.core.units import DIMENSIONS, shown_si

        if value == self.word:
            return value
        return "inf" if math.isinf(value) else shown_si(value, DIMENSIONS[self.dimension].unit, 15)


@dataclass(frozen=True)
class Written:
    """A number in a unit of its own, or text with a unit; both stay as they are written.

    Parameters
    ----------
    dimension : str
        A key of `asperity.core.units.DIMENSIONS`.
    example : str
        An accepted text.
    """

    dimension: str
    example: str

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """A check of text by its dimension, of all other values as of the number."""

        def checked(value: Any, check: Any, info: core_schema.ValidationInfo) -> Any:
            if not isinstance(value, str):
                return check(value)
            Quantity(self.dimension)(value, info)
            return value

        as_it_is = core_schema.plain_serializer_function_ser_schema(lambda value: value)
        numbers = handler(source)
        return core_schema.with_info_wrap_validator_function(checked, numbers, serialization=as_it_is)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """Description of both."""
        numbers = handler(schema["schema"])
        words = f"a {self.dimension} > 0 with its unit such as {self.example}, or {accepted(numbers)}"
        return {"anyOf": [numbers, {"type": "string", "format": self.dimension}], "accepts": words}


Length = Annotated[float, Quantity("length")]
Position = Annotated[float, Quantity("length", positive=False)]
Radius = Annotated[float, Quantity("length", infinite=True)]
Area = Annotated[float, Quantity("area")]
Volume = Annotated[float, Quantity("volume")]
Pressure = Annotated[float, Quantity("pressure")]
Hardness = Annotated[float, Quantity("pressure", infinite=True)]
STRESS = Quantity("pressure", positive=False)
Stress = Annotated[float, STRESS]
Viscosity = Annotated[float, Quantity("viscosity", bare=True)]
Force = Annotated[float, Quantity("force")]
LengthOrNumber = Annotated[Number, Field(gt=0), Written("length", "512 um")]
"""A length with its unit, or a number whose unit the setting states; both stay as they are written."""

_TOLERANCE = re.compile(r"(.+?)\s*(?:±|\+/?-)\s*(\d+(?:\.\d+)?)\s*%")


def split_tolerances(case: Mapping[str, Any]) -> dict[str, Any]:
    """The groups of a case with inputs such as ``210 GPa ± 5 %`` split into value and tolerance."""
    tolerances: dict[str, float] = {}

    def plain(each: Any, key: str) -> Any:
        if isinstance(each, Mapping):
            return {name: plain(part, f"{key}.{name}") for name, part in each.items()}
        if isinstance(each, (list, tuple)):
            return [plain(part, f"{key}.{number}") for number, part in enumerate(each)]
        if not (isinstance(each, str) and "±" in each):
            return each
        if (found := _TOLERANCE.fullmatch(each.strip())) is None:
            text = f" = {each}: a tolerance in per cent is needed, such as 210 GPa ± 5 %"
            raise SettingsError("", [(key, text)])
        tolerances[key] = float(found[2]) / 100
        try:
            return float(found[1])
        except ValueError:
            return found[1]

    groups = {
        name: each if name in ("map", "materials") else plain(each, name) for name, each in case.items()
    }
    asked = groups.get("sensitivity") or {}
    if (
        tolerances
        and isinstance(asked, Mapping)
        and isinstance(given := asked.get("tolerances", {}), Mapping)
    ):
        groups["sensitivity"] = {**asked, "tolerances": {**given, **tolerances}}
    return groups
