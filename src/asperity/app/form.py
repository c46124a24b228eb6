"""The form: which settings of a case stand in which step of the page, and the case that it makes.

`page.html.j2` draws it from `inputs`, which `server.py` passes on.
"""

import shlex
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import asperity.engineering
from asperity.core.errors import InputError
from asperity.engineering.case import Case
from asperity.engineering.case_file import CHECKSUMS, OUT, at, case_of_map, changed_files, leaves, put
from asperity.engineering.templates import yaml_line
from asperity.settings.model import (
    Entry,
    Problem,
    SettingsError,
    accepted,
    described,
    entries,
    item_of,
    scalar,
)
from asperity.settings.reader import parse

EXAMPLE = str(Path(asperity.engineering.__file__).parent / "maps" / "ground_1.x3p")
"""A map that comes with asperity."""

LOADS = {
    "mean_pressure": ("mean_pressure",),
    "force": ("force",),
    "normal_approach": ("normal_approach",),
    "contact_area_fraction": ("contact_area_fraction",),
    "hertz": ("hertz_pressure", "force", "mean_pressure", "radius_x", "radius_y", "at"),
}
"""Kind of the load → settings of the group `load`."""

COUNTER_BODIES = {
    "flat": "rigid and flat",
    "rigid map": "rigid, with a map",
    "elastic": "elastic and flat",
    "elastic map": "elastic, with a map",
}
"""Kind of the counter body → its words."""

MAPS = {
    "pooled": "positions of one surface, pooled to one answer",
    "compared": "different surfaces, an answer of each beside the other",
}
"""What several maps are → the words for it."""

LABELS = {
    "young": "Young's modulus",
    "poisson": "Poisson's ratio",
    "fatigue_torsion": "fatigue limit in torsion",
    "fatigue_bending": "fatigue limit in bending",
    "shear": "shear strength",
    "tension": "tensile strength",
    "energy": "fracture energy",
    "toughness": "fracture toughness",
    "work": "work of adhesion",
    "range": "range of adhesion",
    "at": "position in the contact",
    "load.radius_x": "effective (combined) radius along x",
    "load.radius_y": "effective (combined) radius along y",
    "hertz_pressure": "Hertz pressure",
    "fields": "stresses to be shown",
    "detrend": "form removal",
    "undefined": "non-measured points",
    "missing": "number of a non-measured point",
    "seal": "load that seals",
    "lambda_ratio": "film thickness ratio Λ",
}
"""Setting, or its whole key → its label in the form, where that is not its name."""

MISSING = (": missing", " = None")
"""Beginnings of the message on a setting that is to be given."""

LONGEST_PROPOSED = 24
"""Characters of a proposed value that a field can show; a longer one stands below the field."""

QUESTIONS = {name: kind.ASKS for name, kind in Case.kinds().items() if kind.ASKS}
"""Group of a question → how the page asks it."""

LAYERS = 4
"""Most layers of a body that the form holds."""

BODIES = ("body", "counter_body")

SWITCHES = {f"use.{name}": name for name in (*QUESTIONS, "sliding", "sample")} | {
    f"use.{body}.layers.{number}": f"{body}.layers.{number}" for body in BODIES for number in range(LAYERS)
}
"""Key of a check box of the page → the group that it adds to the case."""

CHOICES: dict[str, tuple[str, ...]] = {
    "choose.load": tuple(LOADS),
    "choose.counter_body": tuple(COUNTER_BODIES),
    "choose.maps": tuple(MAPS),
}
"""Key of a choice of the page → its values; the first holds at the start."""

FIRST = {
    "map": ("unit", "physical_size", "despike", "detrend", "periodic", "scan_lines"),
    "body": ("material", "young", "poisson", "yield_stress", "hardness"),
    "counter_body": ("material", "young", "poisson", "yield_stress", "hardness"),
    "counter_body.map": ("file", "turned_about", "shift", "unit", "physical_size"),
}
"""Group → its settings that stand at the top; the others stand under "more settings"."""


class Input(NamedTuple):
    """A field of the form: dotted key, label, description, accepted values, and proposed value."""

    key: str
    label: str
    text: str
    accepts: str
    proposed: str
    options: tuple[str, ...]
    is_first: bool


@cache
def settings() -> dict[str, Entry]:
    """Dotted key → description of all settings that the form has; lists of maps are fields of text."""
    return {
        key.replace(".layers.0.", f".layers.{number}."): entry
        for key, entry in entries(described(Case))
        for number in range(LAYERS if ".layers.0." in key else 1)
        if "properties" not in item_of(entry) and not key.startswith("body.map.")
    }


def inputs(group: str) -> Iterator[Input]:
    """Fields of the settings of a group, without its subgroups."""
    for key, entry in settings().items():
        name = key.rpartition(".")[2]
        if _group_of(key) != group or key == "map.file":
            continue
        first = FIRST.get(group)
        options = tuple(map(str, entry.get("enum", ())))
        if entry.get("type") == "boolean":
            options = ("true", "false")
        proposed = entry.get("default_text") or entry.get("default", "")
        if "example" in entry and not options:
            proposed = f"such as {_text(key, entry['example'])}"
        yield Input(
            key,
            LABELS.get(key) or label_of(name),
            entry["description"].replace("`", ""),
            accepted(entry).replace("`", ""),
            _text(key, proposed),
            options,
            first is None or name in first,
        )


def label_of(name: str) -> str:
    """Label of a setting or a group in words of the field."""
    return LABELS.get(name, name.replace("_", " "))


def _group_of(key: str) -> str:
    """The group in whose fields the form has a setting: the base of a body is asked for with its layer."""
    group, _, name = key.rpartition(".")
    return f"{group}.layers.0" if name == "base" else group


def _text(key: str, value: Any) -> str:
    """A value as the text of a field; files have a line each, a table is as in a file."""
    if isinstance(value, Mapping):
        return yaml_line(value)
    if isinstance(value, (list, tuple)):
        return ("\n" if key.endswith(".file") else ", ").join(map(str, value))
    return str(value).lower() if isinstance(value, bool) else str(value)


def is_used(key: str, values: Mapping[str, str]) -> bool:
    """True if a setting is part of the case, given the check boxes and choices of the page."""
    if not all(values.get(switch) for switch, group in SWITCHES.items() if _needs(_group_of(key), group)):
        return False
    if key.startswith("load."):
        return key.removeprefix("load.") in LOADS[chosen("choose.load", values)]
    if key.startswith("sample.") and has_several(values):
        return chosen("choose.maps", values) == "pooled"
    if key.startswith("counter_body."):
        kind = chosen("choose.counter_body", values)
        return ("map" if key.startswith("counter_body.map.") else "elastic") in kind
    return True


def _needs(group: str, other: str) -> bool:
    """True if a group is used only with another one: itself, or the layers of a body that lie above it."""
    (body, _, number), (of, _, above) = group.partition(".layers."), other.partition(".layers.")
    if number and above:
        return body == of and int(above) <= int(number.partition(".")[0])
    return group == other


def chosen(key: str, values: Mapping[str, str]) -> str:
    """Value of a choice of the page."""
    given = values.get(key, "")
    return given if given in CHOICES[key] else CHOICES[key][0]


def content_of(values: Mapping[str, str]) -> dict[str, Any]:
    """The groups of a case, as a case file holds them, from the texts of the form.

    What the page asks for and a case may leave out, such as the material of an elastic counter body, is None
    until it is given: the case is refused, and no other one is computed.
    """
    content: dict[str, Any] = {}
    for switch, group in SWITCHES.items():
        if values.get(switch) and is_used(f"{group}.", values):
            put(content, group.split("."), {})
    for key, entry in settings().items():
        text = values.get(key, "").strip()
        if not text or not is_used(key, values):
            continue
        value: Any = scalar(text, entry)
        if text.startswith("{"):  # a table
            with suppress(InputError):  # else the text, which the check refuses
                value = parse(f"value: {text}", key)["value"]
        elif entry.get("type") == "array":
            value = [scalar(each.strip(), item_of(entry)) for each in text.split(",")]
        elif key.endswith(".file") and "\n" in text:
            value = text.splitlines()
        put(content, key.split("."), value)
    if has_several(values) and chosen("choose.maps", values) == "pooled":
        content.setdefault("sample", {})
    counter = chosen("choose.counter_body", values)
    if "elastic" in counter and not content.get("counter_body", {}).keys() - {"map"}:
        put(content, ["counter_body", "material"], None)
    if "map" in counter and at(content, ("counter_body", "map")) is None:
        put(content, ["counter_body", "map"], {})
    if "sliding" in content:
        content["sliding"].setdefault("friction", None)
    return content


def has_several(values: Mapping[str, str]) -> bool:
    """True for several maps of the body."""
    return "\n" in values.get("map.file", "").strip()


def contents_of(content: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The groups of the case of each of its maps."""
    files = at(content, ("map", "file"))
    return [case_of_map(content, number) for number in range(len(files) if isinstance(files, list) else 1)]


def values_of(content: Mapping[str, Any]) -> dict[str, str]:
    """Texts of the form from the groups of a case: the reverse of `content_of`.

    Raises
    ------
    SettingsError
        If ``asperity run`` refuses the case for something else than what is missing.
    """
    found = []
    try:
        first = case_of_map(content, 0)
        Case.read({key: group for key, group in first.items() if key not in (OUT, CHECKSUMS)})
    except SettingsError as error:
        found += [problem for problem in error.found if not problem.text.startswith(MISSING)]
    found += [
        Problem(f"{body}.layers", f": the page holds at most {LAYERS}; asperity run takes any number")
        for body in BODIES
        if len(at(content, (body, "layers")) or ()) > LAYERS
    ]
    if found := [*found, *changed_files(content)]:
        raise SettingsError("", found)
    given = {key: at(content, key.split(".")) for key in settings()}
    values = {key: _text(key, value) for key, value in given.items() if value is not None}
    for switch, group in SWITCHES.items():
        if at(content, group.split(".")) is not None:
            values[switch] = "yes"
    load, counter = content.get("load") or {}, content.get("counter_body") or {}
    kinds = [kind for kind in LOADS if kind in load]
    values["choose.load"] = (
        "hertz" if {"radius_x", "hertz_pressure"} & load.keys() else (kinds or ["mean_pressure"])[0]
    )
    if isinstance(at(content, ("map", "file")), list):
        values["choose.maps"] = "pooled" if "sample" in content else "compared"
    if counter:
        elastic = "elastic" if counter.keys() - {"map"} else "rigid"
        values["choose.counter_body"] = f"{elastic} map" if "map" in counter else "elastic"
    return values


def command_of(content: Mapping[str, Any], flags: Mapping[str, str]) -> str:
    """The command line that answers a case.

    Parameters
    ----------
    content : mapping
        Groups of the case.
    flags : mapping
        Dotted key → flag of ``asperity run``; all other settings are given by ``--set``.
    """
    files = at(content, ("map", "file")) or "MAP"
    files = files if isinstance(files, list) else [files]
    words = ["asperity", "run", *files]
    for key, value in leaves(content):
        if key == "map.file":
            continue
        if key == "sample" and not value:
            words.append("--pooled")
        elif key in flags and value is not None:
            words += [flags[key], *map(str, value if isinstance(value, list) else [value])]
        else:
            words += ["--set", f"{key}={yaml_line(value)}"]
    return shlex.join(words)
