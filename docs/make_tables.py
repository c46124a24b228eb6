"""Write the tables of pages from the settings and the data files of materials and tables.

python docs/make_tables.py
"""

import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path

from asperity.engineering.case import Case
from asperity.results.tables import TABLES
from asperity.settings.configuration import Configuration
from asperity.settings.materials import CONSTANTS, table
from asperity.settings.model import Entry, Settings, accepted, described, item_of

FOLDER = Path(__file__).parent
MARK = "<!-- python docs/make_tables.py -->\n\n"
"""Line of a page after which everything is made."""

FEWEST = 3
"""A constant that fewer materials have is written beside their kind instead of a column."""

UNITS = {"conductivity": "conductivity, W/(m K)", "resistivity": "resistivity, Ω m"}

_HEAD = ["| key | accepts | default | meaning |", "|---|---|---|---|"]

_KINDS = {
    "a length > 0 with its unit such as 512 um, or a number > 0": "a length",
    "a pressure > 0 with its unit (kPa, MPa, GPa, N/mm^2)": "a pressure",
    "a length > 0 with its unit (nm, um, mm, m)": "a length with its unit",
}
"""Values that several settings accept → their short name in the tables, which `describe` explains once."""

MOST_OR = 4
"""Values in words with more alternatives are separated by commas."""

REPEATED = 3
"""A group that repeats at least so many settings of another one refers to it, and so does a table."""


def study() -> str:
    """The settings of a study; options of a map are described with those of a case."""
    of_case = {"`map` of a [case](../docs/cases.md#map)": described(Case)["properties"]["map"]["properties"]}
    return describe(Configuration, "Settings of the whole study", of_case)


def describe(root: type[Settings], title: str, known: dict[str, Entry] | None = None) -> str:
    """All settings of a class: a table for each group, and one of this title for settings outside groups.

    A group that repeats one in `known`, name → settings, refers to it. Keys of `validation` are only named.
    """
    whole = described(root)
    sections = whole["properties"]
    alone = {key: entry for key, entry in sections.items() if entry.get("type") != "object"}
    parts = [f"### {title}", whole["description"], settings_table(alone.items())]
    known = known or {}
    for key, entry in sections.items():
        if key == "validation":
            names = ", ".join(f"`{name}`" for name in entry["properties"])
            schema = "`workflow/schemas/config.schema.yaml` has their keys."
            parts += [f"### `{key}`", f"{entry['description']} They are {names}; {schema}"]
        elif key not in alone:
            words, rows = _group(key, entry, known)
            # Loads of one surface are those of section `contact`; the page itself says what a question asks.
            rows = [row for row in rows if ".contact." not in row[0]]
            text = [] if key in Case.kinds() else [entry["description"] + words]
            if rows or text:
                parts += [f"### `{key}`", *text, *([settings_table(rows)] if rows else [])]
    explained = [f"*{name}* is {text}" for text, name in _KINDS.items() if f" | {name} | " in "".join(parts)]
    if explained:
        parts.insert(2, f"In the tables {'; '.join(explained)}.")
    return "\n\n".join(parts) + "\n"


def settings_table(rows: Iterable[tuple[str, Entry]]) -> str:
    """A row for each setting, given its dotted key and description."""
    lines = [*_HEAD]
    for key, entry in rows:
        default_text = entry.get("default_text", "")
        if "default" in entry:
            value = entry["default"]
            default_text = f"`{str(value).lower() if isinstance(value, bool) else value}`"
        unit = f", in {entry['unit']}" if entry.get("unit") else ""
        values = ", ".join(entry["enum"]) if "enum" in entry else accepted(entry) + unit
        cells = (f"`{key}`", _short(values), default_text, entry["description"])
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _short(values: str) -> str:
    """Accepted numbers as ranges: "whole, 1 to 20", "> 0, ≤ 1", and the short names of `_KINDS`."""
    for text, name in _KINDS.items():
        values = values.replace(text, name)
    values = re.sub(r"a whole number ≥ (\S+) and ≤ (\S+)", r"whole, \1 to \2", values)
    values = re.sub(r"a number ≥ (\S+) and ≤ (\S+?)(?=,|$)", r"\1 to \2", values)
    values = re.sub(r"a list of (.+?) items?, each ", r"list, \1: ", values)
    values = values.replace(" or ", ", ") if values.count(" or ") > MOST_OR else values
    return re.sub(r"a number ([>≥] \S+) and ([<≤] \S+)", r"\1, \2", values)


def _group(group: str, entry: Entry, known: dict[str, Entry]) -> tuple[str, list[tuple[str, Entry]]]:
    """Words after the description of a group, and its rows without settings that a group in `known` has, too.

    The group is added to `known`, which holds the settings of every group.
    """
    words, rows = "", list[tuple[str, Entry]]()
    own = entry.get("properties", {})
    alike = {other: [name for name in own if own[name] == each.get(name)] for other, each in known.items()}
    other = max(alike, key=lambda name: len(alike[name]), default="")
    common = alike.get(other, [])
    shown = other if " " in other else f"`{other}`"
    if len(common) < min(REPEATED, len(own)):
        common = []
    elif common == [*own]:
        words = f" Settings as in {shown}." if own else ""
    else:
        names = (
            "Settings" if common == [*known[other]] else f"{', '.join(f'`{name}`' for name in common)} are"
        )
        words = f" {names} as in {shown}, besides those below."
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


def settings() -> str:
    """The settings of a case, a table for each group."""
    return describe(Case, "Settings outside groups")


def materials() -> str:
    """The materials and their constants."""
    every = [name for each in table().values() for name in each.constants]
    listed = [name for name in CONSTANTS if every.count(name) >= FEWEST]
    rows = []
    for each in table().values():
        rare = [f"{name} {found.value}" for name, found in each.constants.items() if name not in listed]
        kind = ", ".join(filter(None, [each.group, str(each.state), *rare]))
        shown = [str(each.constants[name].value) if name in each.constants else "" for name in listed]
        rows.append([", ".join([f"**{each.name}**", *each.also]), kind, *shown])
    head = ["**material**, other names", "kind", *(UNITS.get(name, name) for name in listed)]
    return f"{_table(head, rows)}\n"


def _table(head: list[str], rows: list[list[str]]) -> str:
    """A table in Markdown."""
    cells = [[cell.replace("|", "/") for cell in row] for row in rows]
    return "\n".join(f"| {' | '.join(row)} |" for row in [head, ["---"] * len(head), *cells])


def tables(of_answers: bool) -> str:
    """The tables of answers or of a study with their columns; those of an earlier table are not repeated."""
    parts = []
    shown: dict[str, dict[str, list[str]]] = {}
    for name, described_table in TABLES.items():
        if of_answers != (name.startswith("answer") or name == "export_peaks"):
            continue
        columns = described_table["columns"]
        common = {
            other: [each for each in known if columns.get(each) == known[each]]
            for other, known in shown.items()
        }
        other = max(common, key=lambda each: len(common[each]), default="")
        repeated = common[other] if len(common.get(other, ())) >= REPEATED else []
        lines = [
            f"- `{column}`{_unit(column, unit)}: {content}"
            for column, (unit, content, *_) in columns.items()
            if column not in repeated
        ]
        if repeated:
            names = ", ".join(f"`{each}`" for each in repeated)
            whole = len(repeated) == len(shown[other])
            lines.append(f"- all columns of `{other}`" if whole else f"- {names}: as in `{other}`")
        source, row = described_table["source"], described_table["row"]
        head = f"## {name}\n\n{source[0].upper()}{source[1:]}. A row is {row}.\n"
        parts.append("\n".join([head, *lines]))
        shown[name] = columns
    return "\n\n".join(parts) + "\n"


def _unit(column: str, unit: str) -> str:
    """The unit in parentheses, unless the name of the column ends with it."""
    is_named = f"_{column}".endswith(f"_{re.sub('[^A-Za-z0-9]+', '_', unit)}")
    return "" if unit in ("", "see unit") or is_named else f" ({unit})"


PAGES: dict[str, Callable[[], str]] = {
    "cases.md": settings,
    "materials.md": materials,
    "../config/README.md": study,
    "tables.md": partial(tables, True),
    "../paper/supplement/tables.md": partial(tables, False),
}
"""Page → function that makes its tables."""


def page(name: str) -> str:
    """The text of a page with its tables made anew."""
    return (FOLDER / name).read_text(encoding="utf-8").split(MARK)[0] + MARK + PAGES[name]()


if __name__ == "__main__":
    for each in PAGES:
        (FOLDER / each).write_text(page(each), encoding="utf-8")
