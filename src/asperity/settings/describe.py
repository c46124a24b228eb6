"""Tables of all settings, in Markdown."""

from collections.abc import Iterable, Mapping

from asperity.settings.configuration import Configuration
from asperity.settings.model import Entry, Settings, accepted, described, item_of

MARK = "<!-- settings: python -m asperity.settings describe config/README.md -->\n"
"""Line of the README after which everything is generated."""

_HEAD = ["| key | accepts | default | meaning |", "|---|---|---|---|"]

_KINDS = {
    "a length > 0 with its unit such as 512 um, or a number > 0": "a length",
    "a pressure > 0 with its unit (kPa, MPa, GPa, N/mm^2)": "a pressure",
    "a length > 0 with its unit (nm, um, mm, m)": "a length with its unit",
}
"""Values that several settings accept → their short name in the tables, which `describe` explains once."""


FEWEST = 3
"""A group that repeats at least so many settings of another one refers to it."""


def describe(root: type[Settings] = Configuration, title: str = "Settings of the whole study") -> str:
    """All settings of a class: a table for each group, and one of this title for settings outside groups."""
    whole = described(root)
    sections = whole["properties"]
    alone = {key: entry for key, entry in sections.items() if entry.get("type") != "object"}
    parts = [f"### {title}", whole["description"], table(alone.items())]
    known: dict[str, Entry] = {}
    for key, entry in sections.items():
        if key not in alone:
            words, rows = _group(key, entry, known)
            parts += [f"### `{key}`", entry["description"] + words]
            parts += [table(rows)] if rows else []
    explained = [f"*{name}* is {text}" for text, name in _KINDS.items() if f" | {name} | " in "".join(parts)]
    if explained:
        parts.insert(2, f"In the tables {'; '.join(explained)}.")
    return "\n\n".join(parts) + "\n"


def with_settings(text: str) -> str:
    """Text of a README with the tables of `describe` after its `MARK`."""
    return text.split(MARK)[0] + MARK + "\n" + describe()


def table(rows: Iterable[tuple[str, Entry]]) -> str:
    """A row for each setting, given its dotted key and description."""
    lines = [*_HEAD]
    for key, entry in rows:
        default_text = entry.get("default_text", "")
        if "default" in entry:
            value = entry["default"]
            default_text = f"`{str(value).lower() if isinstance(value, bool) else value}`"
        unit = f", in {entry['unit']}" if entry.get("unit") else ""
        values = accepted(entry) + unit
        cells = (f"`{key}`", _KINDS.get(values, values), default_text, entry["description"])
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _group(group: str, entry: Entry, known: dict[str, Entry]) -> tuple[str, list[tuple[str, Entry]]]:
    """Words after the description of a group, and its rows without settings that a group in `known` has, too.

    The group is added to `known`, which holds the settings of every group.
    """
    words, rows = "", list[tuple[str, Entry]]()
    own = entry.get("properties", {})
    alike = {other: [name for name in own if own[name] == each.get(name)] for other, each in known.items()}
    other = max(alike, key=lambda name: len(alike[name]), default="")
    common = alike.get(other, [])
    if len(common) < min(FEWEST, len(own)):
        common = []
    elif common == [*own]:
        words = f" Settings as in `{other}`." if own else ""
    else:
        names = (
            "Settings" if common == [*known[other]] else f"{', '.join(f'`{name}`' for name in common)} are"
        )
        words = f" {names} as in `{other}`, besides those below."
    if own:
        known[group] = own
    for name, below in own.items():
        if name not in common:
            item = item_of(below)
            more, inner = _group(f"{group}.{name}{'' if item is below else '.0'}", item, known)
            rows += [(f"{group}.{name}", {**below, "description": below["description"] + more}), *inner]
    if isinstance(named := entry.get("additionalProperties"), Mapping):
        more, inner = _group(f"{group}.NAME", named, known)
        words, rows = words + more, rows + inner
    return words, rows
