"""Variables of result files: names, units and descriptions, and conversion between systems of units.

The dimension of a variable is defined in `variables.yaml`; its unit follows from the system of units of the
file, which the global attribute ``unit_system`` names. Results of the study have lengths in units of the edge
of the cell and stresses in units of the effective modulus E* = E/(1 − ν²); results for given materials are in
SI. A scaled stress is divided by E* and by the rms gradient of the deformed surface over the real contact,
the paper's E* ḡ_r. Texts and truth values have no unit.
"""

import copy
from typing import Any, NamedTuple

import xarray as xr

from asperity.core.data import packaged_yaml
from asperity.fourier.grid import CELL_EDGE, CELL_MIRRORED, CELL_NODES, grid_of


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
    """Units of a dimension in both systems of units, and its powers of length and of stress."""

    study_unit: str
    si_unit: str
    length: int
    stress: int


_DATA = packaged_yaml("asperity.results", "variables.yaml")
VARIABLES = {name: Variable(*entry) for name, entry in _DATA["variables"].items()}
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

SETTINGS = {
    "surface": {"wavelength_long": "length", "wavelength_short": "length", "rms_height": "length"},
    "layer": {"height": "length"},
    "contact": {"mean_pressure": "stress", "approach": "length", "hardness": "stress"},
}
"""Section of the settings of a result → its settings with a dimension."""


def units_of(name: str, system: str = STUDY_UNITS) -> str:
    """Text of the CF attribute ``units`` of a variable in a system of units."""
    dimension = DIMENSIONS[VARIABLES[name].dimension]
    return dimension.si_unit if system == SI_UNITS else dimension.study_unit


def in_si(
    data: xr.Dataset, settings: dict[str, Any], length: float, modulus: float = 1.0
) -> tuple[xr.Dataset, dict[str, Any]]:
    """A result of the study and its settings in SI units.

    Parameters
    ----------
    data : dataset
    settings : dict
    length : float
        Longer edge of the cell in m.
    modulus : float
        Effective modulus in Pa.
    """
    scaled = _scaled(data, length, modulus, SI_UNITS).assign_attrs(cell_length=length)
    if modulus != 1.0:
        scaled.attrs["effective_modulus"] = modulus
    return scaled, _settings_scaled(settings, length, modulus)


def in_cell_lengths(data: xr.Dataset, settings: dict[str, Any]) -> tuple[xr.Dataset, dict[str, Any]]:
    """A result in SI units and its settings in units of the study; others stay as they are."""
    if data.attrs.get("unit_system") != SI_UNITS:
        return data, settings
    length, modulus = cell_length(data), float(data.attrs.get("effective_modulus", 1.0))
    back = _scaled(data, 1 / length, 1 / modulus, STUDY_UNITS)
    if "effective_modulus" in data.attrs:
        back.attrs["effective_modulus"] = 1.0
    return back, _settings_scaled(settings, 1 / length, 1 / modulus)


def cell_length(data: xr.Dataset) -> float:
    """Longer period of the cell of a result in SI units, in m."""
    return float(data.attrs["cell_length"]) if "cell_length" in data.attrs else max(grid_of(data).period)


def _scaled(data: xr.Dataset, length: float, stress: float, system: str) -> xr.Dataset:
    scaled = data.copy()
    for name in data.variables:
        dimension = DIMENSIONS[VARIABLES[str(name)].dimension]
        if dimension.length or dimension.stress:
            values = data[name]
            factor = length**dimension.length * stress**dimension.stress
            kept = (CELL_EDGE, CELL_NODES, CELL_MIRRORED)
            cell = {key: value for key, value in values.attrs.items() if key in kept}
            if CELL_EDGE in cell:
                cell[CELL_EDGE] *= factor
            scaled[name] = (values.dims, values.values * factor, cell)
    if "wavelength_short" in data.attrs:
        scaled.attrs["wavelength_short"] = data.attrs["wavelength_short"] * length
    return scaled.assign_attrs(unit_system=system)


def _settings_scaled(settings: dict[str, Any], length: float, stress: float) -> dict[str, Any]:
    scaled = copy.deepcopy(settings)
    for section, names in SETTINGS.items():
        for name, dimension in names.items():
            if isinstance(scaled.get(section, {}).get(name), (int, float)):
                scaled[section][name] *= length if dimension == "length" else stress
    return scaled
