"""Values of settings that a configuration leaves out, and the load, which is one of several settings."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

from asperity.study.config.presets import KEYS, PRESETS
from asperity.study.config.schema import Entry, schema, setting

LOADS = {"area_fraction": "$A/A_0$ = ", "mean_pressure": r"$\bar{p}/E^*$ = ", "approach": "approach "}
"""Settings of section ``contact`` of which one holds, and their names in figures.

Without any of them it is the default of the first.
"""


def imposed_load(contact: Mapping[str, Any]) -> tuple[str, float]:
    """Name and value of the load that a complete section ``contact`` gives."""
    (name,) = (name for name in LOADS if name in contact)
    return name, contact[name]


def without_load(contact: Mapping[str, Any]) -> dict[str, Any]:
    """Section ``contact`` without its load."""
    return {name: value for name, value in contact.items() if name not in LOADS}


def contact_of(config: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Section ``contact`` of a complete configuration for one surface, which may have a load of its own."""
    own = {**config["surfaces"], **config["measured"]}[name].get("contact")
    return {**without_load(config["contact"]), **own} if own else config["contact"]


def default(key: str) -> Any:
    """Default of a setting by its dotted key, None if it has none.

    For a setting of accuracy that is the value in the default preset.
    """
    if key in KEYS:
        return getattr(PRESETS[setting("accuracy")["default"]], KEYS[key])
    return setting(key).get("default")


def complete(config: Mapping[str, Any]) -> dict[str, Any]:
    """A configuration with the settings that it leaves out.

    They are the defaults of the schema and the values of the preset that ``accuracy`` names.

    Parameters
    ----------
    config : mapping
        Accepted by `asperity.study.config.check.check`; a section without a default may be missing.

    Returns
    -------
    dict
        A copy. A complete configuration stays as it is. A measured map without a shortest wavelength keeps
        its own number of points.
    """
    whole = _with_defaults(config, schema())
    preset = PRESETS[whole["accuracy"]]
    whole.setdefault("seeds", list(range(1, preset.seeds + 1)))
    for key, name in KEYS.items():
        section, last = key.split(".")
        whole[section].setdefault(last, getattr(preset, name))
    if set(LOADS) & set(config.get("contact", {})):
        whole["contact"] = without_load(whole["contact"]) | {
            name: value for name, value in config["contact"].items() if name in LOADS
        }
    if "area_fraction" in whole["contact"]:
        whole["contact"].setdefault("path_area_fractions", [whole["contact"]["area_fraction"]])
    whole["stress"].setdefault("poisson", [whole["layer"]["poisson"]])
    whole["measured"] = {name: complete_map(surface) for name, surface in whole["measured"].items()}
    for surface in (*whole.get("surfaces", {}).values(), *whole["measured"].values()):
        if isinstance(surface.get("wavelength_short"), (int, float)):  # not for a length with its unit
            surface.setdefault("points", preset.points(surface["wavelength_short"]))
    return whole


def complete_map(surface: Mapping[str, Any]) -> dict[str, Any]:
    """An entry of ``measured`` with the trend that is subtracted if it names none."""
    seam = surface.get("periodic") in ("mirrored", "windowed")
    return {"detrend": "tilt" if seam else "none", **surface}


def _with_defaults(values: Mapping[str, Any], entry: Entry) -> dict[str, Any]:
    """A copy of a group of settings with the defaults of its schema, at every level."""
    known = entry.get("properties", {})
    whole = dict(values)
    for name, below in known.items():
        if "default" in below:
            whole.setdefault(name, below["default"])
    for name, value in whole.items():
        below = known.get(name, entry.get("additionalProperties"))
        inside = isinstance(value, Mapping) and isinstance(below, Mapping)
        whole[name] = _with_defaults(value, below) if inside else copy.deepcopy(value)
    return whole
