"""Type, range, unit, default and description of every setting, and the values of those that are left out.

`schema.yaml` describes the settings. A setting is found by its dotted key, such as ``contact.tolerance`` or
``surfaces.NAME.hurst``, where ``NAME`` is a placeholder for a name that the user chooses.

A configuration names a preset of accuracy, which sets every source of error at once; a setting that it gives
itself overrides the preset. Cost and errors of each preset, after the correction of the grid, are measured by
``benchmarks/tradeoff.py``.
"""

import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from asperity.core.data import packaged_yaml
from asperity.core.packages import ENGINES
from asperity.core.sizes import good_size

Entry = Mapping[str, Any]
"""Description of one setting, or of a group of settings, in the words of a JSON Schema."""

_TYPES = {
    "number": "a number",
    "integer": "a whole number",
    "string": "text",
    "boolean": "true or false",
    "array": "a list",
    "object": "a group of keys",
}


@cache
def schema() -> Entry:
    """Description of a whole configuration."""
    read = packaged_yaml("asperity.study.config", "schema.yaml")
    read["properties"]["fft_engine"]["enum"] = list(ENGINES)
    return _group(read)


def _group(entry: Entry) -> Entry:
    """An entry; a group takes no unknown keys, and requires those without a value of their own."""
    if not {"properties", "additionalProperties"} & entry.keys():
        return entry
    below = {name: _group(each) for name, each in entry.get("properties", {}).items()}
    named = entry.get("additionalProperties")
    return {
        **entry,
        "type": "object",
        "properties": below,
        "additionalProperties": _group(named) if named else False,
        "required": [name for name, each in below.items() if not {"default", "default_text"} & each.keys()],
    }


def setting(key: str) -> Entry:
    """Description of one setting, by its dotted key."""
    entry = schema()
    for part in key.split("."):
        entry = entry["additionalProperties"] if part == "NAME" else entry["properties"][part]
    return entry


def settings(entry: Entry, prefix: str = "") -> Iterator[tuple[str, Entry]]:
    """Dotted key and description of every group and setting below an entry, in the order of the schema."""
    for name, below in entry.get("properties", {}).items():
        yield f"{prefix}{name}", below
        yield from settings(below, f"{prefix}{name}.")
    if isinstance(named := entry.get("additionalProperties"), Mapping):
        yield from settings(named, f"{prefix}NAME.")


def accepted(entry: Entry) -> str:
    """Accepted values of a setting in words, such as "a number > 0 and ≤ 1"."""
    if "accepts" in entry:
        return entry["accepts"]
    if "enum" in entry:
        return " or ".join(map(str, entry["enum"]))
    if entry["type"] == "array":
        fewest, most = entry.get("minItems", 0), entry.get("maxItems")
        count = f"≥ {fewest}" if most is None else f"{most}" if fewest == most else f"{fewest} to {most}"
        items = f"{count} {'distinct ' if entry.get('uniqueItems') else ''}items" if most != 1 else "1 item"
        return f"a list of {items}, each {accepted(entry['items'])}"
    if "maxLength" in entry:
        return f"{_TYPES[entry['type']]} of {entry['minLength']} to {entry['maxLength']} characters"
    signs = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
    limits = " and ".join(f"{sign} {number(entry[limit])}" for limit, sign in signs.items() if limit in entry)
    return f"{_TYPES[entry['type']]} {limits}".strip()


def number(value: float) -> str:
    """A number in few characters: no needless zeros, exponents for large and small ones."""
    return f"{value:.10g}"


@dataclass(frozen=True)
class AccuracySettings:
    """Settings of accuracy, one for every source of error.

    Parameters
    ----------
    points_per_wavelength : float
        Grid spacings per shortest wavelength of a surface: the discretisation.
    contact_tolerance : float
        Estimated error of the pressure, relative to its norm.
    precision : "float64" or "float32"
        Floating-point precision of the contact problem.
    depth_tolerance : float
        Largest error that a coarser grid may cause in a deep plane.
    depth_spacing : float
        Distance between planes near the surface, in grid spacings.
    half_space_tolerance : float
        Largest difference at which the half-space replaces the layer.
    seeds : int
        Number of random surfaces of each kind.
    """

    points_per_wavelength: float
    contact_tolerance: float
    precision: str
    depth_tolerance: float
    depth_spacing: float
    half_space_tolerance: float
    seeds: int

    def points(self, wavelength_short: float) -> int:
        """Nodes on an edge of a unit cell, an even number whose Fourier transform is fast."""
        return good_size(round(self.points_per_wavelength / wavelength_short - 1e-6))


PRESETS = {
    "draft": AccuracySettings(4.0, 1e-4, "float64", 1e-2, 0.25, 0.05, 1),
    "paper": AccuracySettings(8.0, 1e-6, "float64", 1e-4, 0.5, 0.05, 1),
    "reference": AccuracySettings(16.0, 1e-8, "float64", 1e-6, 0.25, 0.05, 8),
}

KEYS = {
    "contact.tolerance": "contact_tolerance",
    "contact.precision": "precision",
    "stress.tolerance": "depth_tolerance",
    "stress.depth_spacing": "depth_spacing",
    "layer.half_space_tolerance": "half_space_tolerance",
}
"""Key of the configuration → attribute of `AccuracySettings`.

The other two attributes set ``seeds`` and, surface by surface, ``points``.
"""

_PARTS = {tuple(key.split(".")): name for key, name in KEYS.items()}
"""Section and last part of each key of `KEYS` → attribute."""


def accuracy_of(config: Mapping[str, Any], name: str) -> AccuracySettings:
    """Settings of accuracy in a complete configuration, for one entry of ``surfaces``."""
    surface = config["surfaces"][name]
    return AccuracySettings(
        points_per_wavelength=surface["points"] * surface["wavelength_short"],
        seeds=len(config["seeds"]),
        **{name: config[section][key] for (section, key), name in _PARTS.items()},
    )


def overlay(settings: AccuracySettings, wavelengths: Mapping[str, float]) -> dict[str, Any]:
    """Overlay of a configuration with these settings of accuracy.

    Parameters
    ----------
    settings : AccuracySettings
    wavelengths : mapping
        Name of a surface → its shortest wavelength.
    """
    keys: dict[str, Any] = {"seeds": list(range(1, settings.seeds + 1))}
    keys["surfaces"] = {name: {"points": settings.points(short)} for name, short in wavelengths.items()}
    for (section, key), name in _PARTS.items():
        keys.setdefault(section, {})[key] = getattr(settings, name)
    return keys


LOAD_LABELS = {"area_fraction": "$A/A_0$ = ", "mean_pressure": r"$\bar{p}/E^*$ = ", "approach": "approach "}
"""Settings of section ``contact`` that impose the load, with their names in figures; one of them is given.

Without any, the default of the first holds.
"""


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
    for (section, key), name in _PARTS.items():
        whole[section].setdefault(key, getattr(preset, name))
    if set(LOAD_LABELS) & set(config.get("contact", {})):
        whole["contact"] = without_load(whole["contact"]) | {
            name: value for name, value in config["contact"].items() if name in LOAD_LABELS
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
    """An entry of ``measured`` with a trend to subtract: its own, or a tilt if the map is made periodic."""
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
