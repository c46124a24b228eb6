"""Loads and measured maps in a configuration that is checked and complete.

The stages of the study import this module: it names no setting that they do not use, so that a new text of a
setting computes nothing again.
"""

from collections.abc import Mapping
from typing import Any

LOAD_LABELS = {
    "contact_area_fraction": "$A/A_0$ = ",
    "mean_pressure": r"$\bar{p}/E^*$ = ",
    "normal_approach": "approach ",
}
"""Settings of section ``contact`` that impose the load, with their names in figures; one of them is given.

Without any, the default of the first holds.
"""

AS_SAMPLE = {"periodic": "none", "undefined": "harmonic"}
"""Treatment of a map of which the distribution of heights is taken, without the points that are filled."""


def imposed_load(contact: Mapping[str, Any]) -> tuple[str, float]:
    """Name and value of the load that a complete section ``contact`` gives."""
    (name,) = (name for name in LOAD_LABELS if name in contact)
    return name, contact[name]


def without_load(contact: Mapping[str, Any]) -> dict[str, Any]:
    """Section ``contact`` without its load."""
    return {name: value for name, value in contact.items() if name not in LOAD_LABELS}


def contact_of(config: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Section ``contact`` of a complete configuration for one surface, which may have a load of its own."""
    own = {**config["surfaces"], **config["measured"]}[name].get("contact")
    return {**without_load(config["contact"]), **own} if own else config["contact"]


def maps_of(config: Mapping[str, Any]) -> dict[str, Any]:
    """Dotted key → settings of every measured map, of a surface or of the heights of one."""
    maps = {f"measured.{name}": entry for name, entry in config.get("measured", {}).items()}
    for name, surface in config.get("surfaces", {}).items():
        if "map" in (heights := surface.get("heights", {})):
            maps[f"surfaces.{name}.heights.map"] = AS_SAMPLE | heights["map"]
    return maps
