"""Tables of all settings, in Markdown."""

from collections.abc import Iterable, Iterator

from asperity.settings.configuration import Configuration
from asperity.settings.model import Entry, Settings, accepted, described, entries

MARK = "<!-- settings: python -m asperity.settings describe config/README.md -->\n"
"""Line of the README after which everything is generated."""

_HEAD = ["| key | accepts | unit | default | meaning |", "|---|---|---|---|---|"]


def describe(root: type[Settings] = Configuration, title: str = "Settings of the whole study") -> str:
    """All settings of a class: a table for each group, and one of this title for settings outside groups."""
    whole = described(root)
    sections = whole["properties"]
    alone = {key: entry for key, entry in sections.items() if entry.get("type") != "object"}
    parts = [f"### {title}", whole["description"], table(alone.items())]
    known: dict[str, Entry] = {}
    for key, entry in sections.items():
        if key in alone:
            continue
        parts += [f"### `{key}`", entry["description"]]
        below = entry.get("properties")
        if twin := next((other for other, each in known.items() if below and each == below), None):
            parts[-1] += f" Settings as in `{twin}`."
        elif rows := [*_rows(key, entry)]:
            parts += [table(rows)]
        known[key] = below or {}
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
        cells = (f"`{key}`", accepted(entry), entry.get("unit", ""), default_text, entry["description"])
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _rows(section: str, entry: Entry) -> Iterator[tuple[str, Entry]]:
    """Key and description of all settings of a section; a group that repeats another refers to it."""
    groups: dict[str, Entry] = {}
    repeated = ""
    for key, below in entries(entry, f"{section}."):
        if repeated and key.startswith(repeated):
            continue
        if "properties" in below:
            twin = next((other for other, known in groups.items() if known == below["properties"]), None)
            if twin:
                repeated = f"{key}."
                below = {**below, "description": f"{below['description']} Settings as in `{twin}`."}
            groups[key] = below["properties"]
        yield key, below
