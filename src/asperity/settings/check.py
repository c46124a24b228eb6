"""Check of a configuration of the study, and the values of the settings that it leaves out."""

import copy
import math
from collections.abc import Iterator, Mapping
from typing import Any

from asperity.core.errors import shown
from asperity.settings.accuracy import PARTS, PRESETS
from asperity.settings.configuration import Configuration, Contact
from asperity.settings.model import Entry, SettingsError, described, entry_of, number
from asperity.settings.sections import LOAD_LABELS, without_load

_FEWEST_PLANES = 4
"""Planes of the stress that a layer must hold: verification needs one away from both faces."""


def check(config: Mapping[str, Any]) -> dict[str, Any]:
    """A configuration with all settings that it leaves out.

    Parameters
    ----------
    config : mapping
        A configuration, with its overlays merged.

    Returns
    -------
    dict
        As of `complete`.

    Raises
    ------
    SettingsError
        With all unknown and missing keys and values outside their ranges; if there are none, with all
        settings that contradict each other.
    """
    Configuration.read(config)
    whole = complete(config)
    if found := [*_contradictions(whole)]:
        raise SettingsError("", found)
    return whole


def complete(config: Mapping[str, Any]) -> dict[str, Any]:
    """A configuration with the settings that it leaves out.

    They are their defaults and the values of the preset that ``accuracy`` names. Numbers stay as they are
    written, whole or not.

    Parameters
    ----------
    config : mapping
        Accepted by `check`.

    Returns
    -------
    dict
        A copy. A complete configuration stays as it is. A measured map without a shortest wavelength keeps
        its own number of points.
    """
    whole = _with_defaults(config, described(Configuration))
    preset = PRESETS[whole["accuracy"]]
    whole.setdefault("seeds", list(range(1, preset.seeds + 1)))
    for (section, key), name in PARTS.items():
        whole[section].setdefault(key, getattr(preset, name))
    if load := {name: value for name, value in config.get("contact", {}).items() if name in LOAD_LABELS}:
        whole["contact"] = without_load(whole["contact"]) | load
    if "contact_area_fraction" in whole["contact"]:
        whole["contact"].setdefault(
            "path_contact_area_fractions", [whole["contact"]["contact_area_fraction"]]
        )
    whole["stress"].setdefault("poisson", [whole["layer"]["poisson"]])
    for surface in (*whole["surfaces"].values(), *whole["measured"].values()):
        if isinstance(surface.get("wavelength_short"), (int, float)):  # not for a length with its unit
            surface.setdefault("points", preset.points(surface["wavelength_short"]))
    return whole


def _with_defaults(values: Mapping[str, Any], entry: Entry) -> dict[str, Any]:
    """A copy of a group of settings with their defaults, at every level."""
    known = entry.get("properties", {})
    defaults = {name: below["default"] for name, below in known.items() if "default" in below}
    whole = {**values, **{name: value for name, value in defaults.items() if name not in values}}
    for name, value in whole.items():
        below = known.get(name, entry.get("additionalProperties"))
        inside = isinstance(value, Mapping) and isinstance(below, Mapping)
        whole[name] = _with_defaults(value, below) if inside else copy.deepcopy(value)
    return whole


def _contradictions(config: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Key and rest of the message of sections of a complete configuration that contradict each other."""
    surfaces, measured, layer = config["surfaces"], config["measured"], config["layer"]
    known = {**surfaces, **measured}
    if not known:
        needed = "at least one is needed, here or under measured, or the paper's by"
        yield "surfaces", f": missing; {needed} based_on: config/config.yaml"
    for name in measured.keys() & surfaces.keys():
        yield f"measured.{name}", f": another name is needed, surfaces.{name} has it"
    most = entry_of(Configuration, "surfaces.NAME.points")["maximum"]
    for section in ("surfaces", "measured"):
        for name, surface in config[section].items():
            if surface.get("points", 0) > most:
                text = f": {surface['points']} are too many for a grid of at most {most}; "
                text += "a longer wavelength_short or another accuracy is needed"
                yield f"{section}.{name}.points", text
    for study, names in config.get("studies", {}).items():
        for name in names:
            if name not in known:
                needed = f"the name of a surface is needed ({', '.join(known)})"
                yield f"studies.{study}", f" = {shown(name)}: {needed}"
    if config["claims"] and config["figures"] != "paper":
        needed = "needs figures = 'paper': the claims are statements about the paper's surfaces"
        yield "claims", f" = true {needed}"
    grids = ((each.get("points", math.inf), name) for name, each in known.items())
    points, name = min(grids, default=(1, ""))
    least = _FEWEST_PLANES * config["stress"]["depth_spacing"] / points
    if known and layer["height"] < least and "base" not in layer:
        planes = f"{_FEWEST_PLANES} planes at its depth_spacing"
        text = f" = {layer['height']!r}: at least {number(least)} is needed for {name}, {planes}"
        yield "layer.height", text
    contact = Contact.model_construct(**config["contact"])  # with the tolerance of the preset
    yield from ((f"contact.{key}", text) for key, text in contact.contradictions())
    if layer["poisson"] not in (listed := config["stress"]["poisson"]):
        needed = f"layer.poisson = {layer['poisson']!r} must be one of them"
        yield "stress.poisson", f" = {shown(listed)}: {needed}"
