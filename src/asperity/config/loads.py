"""The load of a study: one of several settings of section ``contact``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

LOADS = ("area_fraction", "mean_pressure", "approach")
"""Settings of section ``contact`` of which one holds; without any it is the default of the first."""


def imposed_load(contact: Mapping[str, Any]) -> tuple[str, float]:
    """Name and value of the load that a complete section ``contact`` gives."""
    (name,) = (name for name in LOADS if name in contact)
    return name, contact[name]


def without_load(contact: Mapping[str, Any]) -> dict[str, Any]:
    """Section ``contact`` without its load."""
    return {name: value for name, value in contact.items() if name not in LOADS}


def beneath(contact: Mapping[str, Any], overlay: Mapping[str, Any]) -> Mapping[str, Any]:
    """Section ``contact`` beneath an overlay: without its load, if the overlay has one."""
    return without_load(contact) if set(LOADS) & set(overlay) else contact
