"""Units of the interfaces: text with a unit to a number in SI, and a number in SI to text.

The library itself converts nothing: its arguments are in any one consistent system of units. The command
line, the configuration and the reports take and show units through this module. `pint` does the conversion,
and is imported at the first use.
"""

import math
import re
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NamedTuple

from asperity.core.errors import shown

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class Dimension(NamedTuple):
    """A physical dimension of numbers with units in the interfaces.

    Parameters
    ----------
    unit : str
        SI unit as text for `pint` and for CF `units` attributes.
    examples : tuple of str
        Accepted units, for messages.
    """

    unit: str
    examples: tuple[str, ...]


DIMENSIONS = {
    "length": Dimension("m", ("nm", "um", "mm", "m")),
    "area": Dimension("m^2", ("um^2", "mm^2", "m^2")),
    "volume": Dimension("m^3", ("um^3", "mm^3", "m^3")),
    "pressure": Dimension("Pa", ("kPa", "MPa", "GPa", "N/mm^2")),
    "force": Dimension("N", ("mN", "N", "kN")),
    "viscosity": Dimension("Pa s", ("mPa s", "Pa s")),
    "work of adhesion": Dimension("J/m^2", ("mJ/m^2", "J/m^2")),
}

# pint evaluates arithmetic in a text, and a long power takes hours: only a number with a unit is passed on.
_NUMBER_AND_UNIT = re.compile(
    r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*"
    r"([A-Za-zµμ]+(?:\^?[2-4])?(?:[*/· ][A-Za-zµμ]+(?:\^?[2-4])?)*)"
)
_HARDNESS_NUMBER = re.compile(r"(\d+(?:\.\d+)?)\s*(HV|HB|HBW|HK)[\d.]*")

KILOGRAM_FORCE_PER_SQUARE_MILLIMETRE = 9.80665e6
"""In Pa: the unit of numbers of hardness after Vickers, Brinell and Knoop (ISO 6507-1, 6506-1, 4545-1)."""

_ROCKWELL = re.compile(r"(\d+(?:\.\d+)?)\s*HRC")

ROCKWELL_TO_VICKERS = {
    **{20: 238, 25: 266, 30: 302, 35: 345, 40: 392, 45: 446},
    **{50: 513, 55: 595, 60: 697, 65: 832, 68: 940},
}
"""Rockwell C → Vickers hardness of steels that are not austenitic (ASTM E140, table 1)."""

_USUAL = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([pnuµμmkMGT]?)(m|Pa|N)")
"""A number, a prefix and an SI unit."""

_PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_EXPONENTS = {prefix: exponent for exponent, prefix in _PREFIXES.items()} | {"u": -6, "μ": -6}
_SUPERSCRIPTS = {"": "", "2": "²", "3": "³"}


def to_si(value: Any, dimension: str, name: str = "value") -> float:
    """Number in the SI unit of a dimension.

    Parameters
    ----------
    value : str or pint.Quantity
        A number with its unit, such as ``"210 GPa"``.
    dimension : str
        A key of `DIMENSIONS`.
    name : str
        Name of the setting, for messages.

    Raises
    ------
    ValueError
        If the value has no unit, a unit of another dimension, or is not a finite number.
    """
    known, number = DIMENSIONS[dimension], math.nan
    usual = _USUAL.fullmatch(value.strip()) if isinstance(value, str) else None
    if usual and usual[3] == known.unit:  # without pint, whose import takes a quarter of a second
        if usual[2] + usual[3] != "mPa":  # which is refused: MPa is meant
            exponent = _EXPONENTS[usual[2]]  # powers of ten above 1 are exact: 300 nm is 0.3 um to the bit
            number = float(usual[1]) * 10.0**exponent if exponent > 0 else float(usual[1]) / 10.0**-exponent
    else:
        with suppress(Exception):  # pint has errors of many unrelated types for a unit that it does not know
            import pint

            if isinstance(value, str):
                powers = {ord(sign): power for power, sign in _SUPERSCRIPTS.items() if power}
                parts: Any = _NUMBER_AND_UNIT.fullmatch(value.strip().translate(powers))
                own = re.sub(r"(?<=[A-Za-zµμ])(?=[2-4])", "^", parts[2])  # mm2 is mm^2
                magnitude, unit = float(parts[1]), own
            else:
                magnitude, unit = float(value.magnitude), value.units
            quantity = pint.get_application_registry().Quantity(magnitude, unit)
            number = float(quantity.to(known.unit).magnitude)
    if math.isfinite(number):
        return number
    example = ""
    with suppress(TypeError, ValueError, OverflowError):
        float(value)
        example = f", such as '{str(value).strip()} {known.examples[1]}'"
    raise ValueError(
        f"{name} = {shown(value)}: a number with a unit of {dimension} ({', '.join(known.examples)}"
        f"{misread(value, dimension)}) is needed{example}"
    )


def misread(value: Any, dimension: str = "") -> str:
    """Addition to the message on a comma, a number of hardness, or a unit in other letters; else empty."""
    text = str(value).strip()
    if dimension == "pressure" and (found := _HARDNESS_NUMBER.fullmatch(text)):
        pressure = float(found[1]) * KILOGRAM_FORCE_PER_SQUARE_MILLIMETRE
        return f"; {float(found[1]):g} {found[2]} is {shown_si(pressure, 'Pa')}"
    if dimension == "pressure" and (found := _ROCKWELL.fullmatch(text)):
        import numpy as np

        known = [*ROCKWELL_TO_VICKERS]
        if not known[0] <= float(found[1]) <= known[-1]:
            return f"; {float(found[1]):g} HRC is outside of the scale, {known[0]} to {known[-1]} HRC"
        vickers = float(np.interp(float(found[1]), known, [*ROCKWELL_TO_VICKERS.values()]))
        of_steel = shown_si(vickers * KILOGRAM_FORCE_PER_SQUARE_MILLIMETRE, "Pa", 2)
        return f"; {float(found[1]):g} HRC is about {vickers:.0f} HV on steel, {of_steel}"
    if dimension and (found := _NUMBER_AND_UNIT.fullmatch(text)):
        cases = {unit.lower(): unit for unit in DIMENSIONS[dimension].examples}
        meant = cases.get(found[2].lower(), found[2])
        return "" if meant == found[2] else f"; did you mean {found[1]} {meant}?"
    if re.match(r"[+-]?\d+,\d", text):
        return f"; with a decimal point, not a comma: {text.replace(',', '.', 1)}"
    return ""


def shown_si(value: float, unit: str, digits: int = 4) -> str:
    """Number in SI as text with a sensible prefix, such as ``"1.234 GPa"``.

    Parameters
    ----------
    value : float
        In `unit`.
    unit : str
        ``1``, or a unit that takes prefixes: ``m``, ``m^2``, ``m^3``, ``Pa``, ``N``, ``Ω``, ``m^3/s``.
    digits : int
        Significant digits.
    """
    if unit == "1":
        return f"{value:.{digits}g}"
    if not math.isfinite(value):
        return f"{value:g} {_symbol(0, unit)}"
    factor, symbol = scaled_unit(float(f"{value:.{digits}g}"), unit)
    scaled = float(f"{value / factor:.{digits}g}")
    return f"{scaled:.15g} {symbol}"


def scaled_unit(values: "ArrayLike", unit: str) -> tuple[float, str]:
    """Factor and symbol of a unit that suits the largest magnitude of some values.

    Parameters
    ----------
    values : array
        In `unit`; infinite and missing values are left out.
    unit : str
        ``m``, ``m^2``, ``m^3``, ``Pa``, ``N``, ``Ω`` or one of them per another unit, as ``m^3/s``.

    Returns
    -------
    factor : float
        Size of the scaled unit in `unit`; values are divided by it.
    symbol : str
        Such as ``"MPa"`` or ``"µm²"``.
    """
    import numpy as np  # texts with units are also read where NumPy is not installed, to plan a study

    array = np.abs(np.asarray(values, dtype=float)).ravel()
    array = array[np.isfinite(array)]
    largest = float(array.max()) if array.size else 0.0
    power = int(unit.partition("/")[0].partition("^")[2] or 1)
    exponent = 0
    if largest > 0:
        # The next larger unit is used from 0.1 of it for an area, and from 0.01 of it for a volume.
        exponent = 3 * math.floor((math.log10(largest) + 1e-9 + power - 1) / (3 * power))
        exponent = min(max(exponent, min(_PREFIXES)), max(_PREFIXES))
    if unit.startswith("m"):
        exponent = min(exponent, 0)
    return 10.0 ** (power * exponent), _symbol(exponent, unit)


def _symbol(exponent: int, unit: str) -> str:
    unit, per, other = unit.partition("/")
    base, _, power = unit.partition("^")
    return f"{_PREFIXES[exponent]}{base}{_SUPERSCRIPTS[power]}{per}{other}"
