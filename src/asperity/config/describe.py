"""The settings as Markdown tables for `config/README.md`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from asperity.config.presets import KEYS
from asperity.config.schema import Entry, accepted, schema, settings

MARK = "<!-- settings: python -m asperity.config describe config/README.md -->\n"
"""Line of the README after which everything is generated."""

_HEAD = ["| key | accepts | unit | default | meaning |", "|---|---|---|---|---|"]


def describe() -> str:
    """All settings: a table for each section of a configuration, and one for settings outside sections."""
    sections = schema()["properties"]
    alone = {key: entry for key, entry in sections.items() if entry.get("type") != "object"}
    tables = [_table("Settings of the whole study", schema()["description"], alone.items())]
    for key, entry in sections.items():
        if key not in alone:
            tables.append(_table(f"`{key}`", entry["description"], _rows(key, entry)))
    return "\n\n".join(tables) + "\n"


def with_settings(text: str) -> str:
    """Text of a README with the tables of `describe` after its `MARK`."""
    return text.split(MARK)[0] + MARK + "\n" + describe()


def _table(title: str, description: str, rows: Iterable[tuple[str, Entry]]) -> str:
    lines = []
    for key, entry in rows:
        cells = (
            f"`{key}`",
            accepted(entry),
            entry.get("unit", ""),
            _default(key, entry),
            entry["description"],
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([f"### {title}", "", description, "", *_HEAD, *lines])


def _rows(section: str, entry: Entry) -> Iterator[tuple[str, Entry]]:
    """Key and description of all settings of a section; a group that repeats another refers to it."""
    groups: dict[str, Entry] = {}
    repeated = ""
    for key, below in settings(entry, f"{section}."):
        if repeated and key.startswith(repeated):
            continue
        if "properties" in below:
            twin = next((other for other, known in groups.items() if known == below["properties"]), None)
            if twin:
                repeated = f"{key}."
                below = {**below, "description": f"{below['description']} Settings as in `{twin}`."}
            groups[key] = below["properties"]
        yield key, below


def _default(key: str, entry: Entry) -> str:
    if key in KEYS:
        return "preset"
    if "default" in entry:
        value = entry["default"]
        return f"`{str(value).lower() if isinstance(value, bool) else value}`"
    return entry.get("left_out", "")
