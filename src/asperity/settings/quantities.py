"""Types of quantities with units: text such as ``210 GPa`` becomes a number in SI.

In files and on the command line a quantity needs its unit. In Python a number is in SI units.
"""

import math
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic_core import CoreSchema, core_schema

from asperity.settings.model import NeededError


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
    """

    dimension: str
    positive: bool = True
    infinite: bool = False

    def __call__(self, value: Any, info: core_schema.ValidationInfo) -> float:
        """The value in SI; `NeededError` if it is not accepted."""
        from asperity.core.units import to_si  # needs NumPy; the help of a command does not

        if self.infinite and str(value).lstrip(".") == "inf":
            return math.inf
        try:
            bare = isinstance(value, (int, float)) and not isinstance(value, bool)
            if bare and not (info.context or {}).get("units"):
                found = float(value)
            else:
                found = to_si(value, self.dimension)
        except ValueError:
            raise NeededError(self.needed(value)) from None
        if not math.isfinite(found) or (self.positive and not found > 0):
            raise NeededError(self.needed(value))
        return found

    def needed(self, value: Any = "") -> str:
        """Accepted values in words."""
        from asperity.core.units import DIMENSIONS, misread

        article = "an" if self.dimension[0] in "ae" else "a"
        units = ", ".join(DIMENSIONS[self.dimension].examples)
        sign = " > 0" if self.positive else ""
        other = " or inf" if self.infinite else ""
        return f"{article} {self.dimension}{sign} with its unit ({units}{misread(value, self.dimension)}){other}"

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """A check by this object; written as text with the unit."""
        written = core_schema.plain_serializer_function_ser_schema(self._written, when_used="json")
        return core_schema.with_info_plain_validator_function(self, serialization=written)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """Description of the quantity as text."""
        return {"type": "string", "format": self.dimension, "accepts": self.needed()}

    def _written(self, value: float) -> Any:
        from asperity.core.units import DIMENSIONS, shown_si

        return "inf" if math.isinf(value) else shown_si(value, DIMENSIONS[self.dimension].unit, 15)


Length = Annotated[float, Quantity("length")]
Position = Annotated[float, Quantity("length", positive=False)]
Radius = Annotated[float, Quantity("length", infinite=True)]
Area = Annotated[float, Quantity("area")]
Volume = Annotated[float, Quantity("volume")]
Pressure = Annotated[float, Quantity("pressure")]
Hardness = Annotated[float, Quantity("pressure", infinite=True)]
Stress = Annotated[float, Quantity("pressure", positive=False)]
Force = Annotated[float, Quantity("force")]


@dataclass(frozen=True)
class QuantityOrNumber(Quantity):
    """A positive number, whose unit the setting states, or a text with a unit; both stay as they are."""

    def __call__(self, value: Any, info: core_schema.ValidationInfo) -> Any:
        """The value; `NeededError` if it is not accepted."""
        if isinstance(value, str):
            super().__call__(value, info)
        elif isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 < value < math.inf:
            raise NeededError(self.needed(value))
        return value

    def needed(self, value: Any = "") -> str:
        """Accepted values in words."""
        return f"{super().needed(value)}, or a number > 0"

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """Description of the quantity as text or number."""
        return {"type": ["number", "string"], "format": self.dimension, "accepts": self.needed()}

    def _written(self, value: Any) -> Any:
        return value


LengthOrNumber = Annotated[float | str, QuantityOrNumber("length")]
