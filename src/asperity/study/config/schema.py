"""Type, range, unit, default and description of every setting, read from `schema.yaml`.

A setting is found by its dotted key, such as ``contact.tolerance`` or ``surfaces.NAME.hurst``, where ``NAME``
stands for a name that the user chooses.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from asperity.core.data import packaged_yaml
from asperity.core.packages import ENGINES

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
        "required": [name for name, each in below.items() if not {"default", "left_out"} & each.keys()],
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
