"""Results of the study in SI units, and back: every variable by its dimension.

A result in SI units of the commands ``asperity surface --length`` and ``asperity solve --young`` is that of
the study times the edge of the cell and the effective modulus. Lengths in its settings are in metres too.
"""

from __future__ import annotations

import copy
from typing import Any

import xarray as xr

from asperity.results.dataset import grid_of
from asperity.results.variables import SI_UNITS, STUDY_UNITS, VARIABLES

POWERS = {
    "length": (1, 0),
    "1/length": (-1, 0),
    "length^4": (4, 0),
    "stress": (0, 1),
    "stress^2": (0, 2),
    "force": (2, 1),
}
"""Dimension → powers of length and of stress; variables of all others are numbers."""

SETTINGS = {
    "surface": {"wavelength_long": "length", "wavelength_short": "length", "rms_height": "length"},
    "layer": {"height": "length"},
    "contact": {"mean_pressure": "stress", "approach": "length"},
}
"""Section of the settings of a result → those with a dimension."""


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
    told = {"cell_length": length} | ({"effective_modulus": modulus} if modulus != 1.0 else {})
    return _scaled(data, length, modulus, SI_UNITS).assign_attrs(told), _settings_scaled(
        settings, length, modulus
    )


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
    """Longer edge of the cell of a result in SI units, in m."""
    return float(data.attrs["cell_length"]) if "cell_length" in data.attrs else max(grid_of(data).length)


def _scaled(data: xr.Dataset, length: float, stress: float, system: str) -> xr.Dataset:
    factors = {}
    for name in data.variables:
        powers = POWERS.get(VARIABLES[str(name)].dimension)
        if powers is not None:
            factors[name] = length ** powers[0] * stress ** powers[1]
    scaled = data.copy()
    for name, factor in factors.items():
        values = data[name]
        scaled[name] = (values.dims, values.values * factor)
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
