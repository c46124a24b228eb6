"""Variables of result files: names, units and descriptions.

The dimension of a variable is defined in `variables.yaml`; its unit follows from the system of units of the
file, which the global attribute ``unit_system`` names. Results of the study have lengths in units of the edge
of the cell and stresses in units of the effective modulus E* = E/(1 − ν²); results for given materials are in
SI. A scaled stress is divided by E* and by the rms gradient of the deformed surface over the real contact,
the paper's E* ḡ_r. Texts and truth values have no unit.
"""

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from asperity.core.data import packaged_yaml


class Variable(NamedTuple):
    """Dimension of a variable, and its description: the CF attributes ``long_name`` and ``comment``."""

    dimension: str
    long_name: str
    comment: str = ""


class Stage(NamedTuple):
    """A variable that only the files of a stage have, and a summary of these files."""

    variable: str
    summary: str


class Dimension(NamedTuple):
    """Units of a dimension in both systems of units."""

    study_unit: str
    si_unit: str


def _each(texts: Sequence[str]) -> Iterator[list[str]]:
    """The texts with the first of each words ``{a|b}`` in them, with the second ones, and so on."""
    parts = [[part.split("|") for part in re.split("[{}]", text)] for text in texts]
    for number in range(max(map(len, parts[0]))):
        yield ["".join(words[number % len(words)] for words in text) for text in parts]


_DATA = packaged_yaml("asperity.results", "variables.yaml")
VARIABLES = {
    name: Variable(*own) for key, entry in _DATA["variables"].items() for name, *own in _each([key, *entry])
}
STAGES = {name: Stage(**entry) for name, entry in _DATA["stages"].items()}
DIMENSIONS = {name: Dimension(*entry) for name, entry in _DATA["dimensions"].items()}

STUDY_UNITS = "cell length and effective modulus"
"""Name of the system of units of the study."""

SI_UNITS = "SI"
"""Name of the system of units of results for given materials and loads."""

UNIT_SYSTEMS = {
    STUDY_UNITS: "Units: cell_length is the longer edge of the periodic cell, effective_modulus is "
    "E/(1 - nu^2), scaled_stress is effective_modulus times the rms gradient of the deformed surface over "
    "the real contact.",
    SI_UNITS: "Units: SI.",
}
"""Systems of units of result files → meaning of the names of their units."""

ORIENTATION = "lower face"
"""Attribute ``orientation`` of every height: an indenter's lower face, not a map with its peaks upward."""


def units_of(name: str, system: str = STUDY_UNITS) -> str:
    """Text of the CF attribute ``units`` of a variable in a system of units."""
    dimension = DIMENSIONS[VARIABLES[name].dimension]
    return dimension.si_unit if system == SI_UNITS else dimension.study_unit
