"""All tables of an answer, a table for a reader, and the answer as text for the terminal."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from textwrap import fill
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from asperity.engineering.answer_data import ONE_POSITION, REPEATS, AnswerData, by_topic, without_repeats
from asperity.engineering.questions.sweep import words_of
from asperity.engineering.records import LIMITED, POSITIONS, Record
from asperity.results.tables import units

SHOWN_ROWS = 40
"""Most rows of a table in a report."""

FIRST_ROWS = 10
"""Rows that are shown of a longer table in falling order."""

WIDEST = 100
"""Most characters of a line of words on the terminal."""

TILES = 4
"""Most numbers at the top of a page."""

FALLING = ("peaks", "contact_spots")
"""Tables in falling order."""


class Tile(NamedTuple):
    """A number at the top of a page: its name, itself, and lines below it."""

    name: str
    number: str
    lines: list[str]


def tiles_of(records: Sequence[Record], units: Any = None) -> list[Tile]:
    """The first records as numbers at the top of a page; units as of `Record.scale`."""
    several = len({each.body for each in records if each.body}) > 1
    tiles = []
    for each in records[:TILES]:
        number, _, rest = each.number(units).partition(": ")
        errors = replace(each, varies=False).error_texts(units)  # `unknown_of` says it once
        name = f"{each.quantity}, {each.body} body" if several and each.body else each.quantity
        limited = LIMITED if LIMITED in each.note else ""
        tiles.append(Tile(name, number, [*filter(None, [rest, limited, each.place(units)]), *errors]))
    return tiles


def unknown_of(records: Sequence[Record]) -> str:
    """That the errors at the top of a page leave out positions, as a sentence; empty if they do not."""
    if not any(POSITIONS in each.unknown for each in records[:TILES]):
        return ""
    if any(POSITIONS in each.errors for each in records[:TILES]):
        return f"± {POSITIONS} is estimated from parts of this map; no other ± includes it."
    return "No ± includes how much other positions of the surface differ: one map does not show it."


def tables(answer: AnswerData) -> dict[str, pd.DataFrame]:
    """Name of a file or sheet → table: all numbers, warnings, peaks, spots, gaps, tables of the questions."""
    return {"answer": answer.frame(), "warnings": answer.warnings_table(), **answer.tables}


def for_reader(answer: AnswerData, name: str) -> tuple[str, pd.DataFrame]:
    """Heading of a table of an answer, and rows of it as texts with units."""
    heading, table = name.replace("_", " "), answer.tables[name]
    if name == "sweep":
        return heading, _of_sweep(answer.case, table)
    rows, unit_of = np.arange(len(table)), units(f"answer_{name}", table)
    if name in FALLING and len(table) > FIRST_ROWS:
        rows, heading = rows[:FIRST_ROWS], f"{heading}, the first {FIRST_ROWS} of {len(table)}"
    elif len(table) > SHOWN_ROWS:
        rows = np.linspace(0, len(table) - 1, FIRST_ROWS + 1).round().astype(int)
        heading = f"{heading}, {rows.size} of {len(table)} rows"
    shown = {}
    for column, values in table.iloc[rows].items():
        unit = unit_of.get(str(column), "")
        end = f"_{unit.replace('^', '').replace('/', '_').replace(' ', '_')}" if unit else ""
        is_number = values.dtype.kind in "iuf"
        texts = (Record("", value, unit or "1").number() if is_number else str(value) for value in values)
        shown[str(column).removesuffix(end).replace("_", " ")] = [*texts]
    return heading, pd.DataFrame(shown)


def _of_sweep(case: Any, table: pd.DataFrame) -> pd.DataFrame:
    """The shown numbers of a sweep: a row for each value, a column for each number."""
    found: dict[str, dict[str, str]] = {}
    for name, point in zip(table["case"].unique(), case.sweep.points(case), strict=True):
        found[name] = {"sweep": ", ".join(f"{words_of(key)} = {text}" for key, (_, text) in point.items())}
    shown = table[table["is_shown"]]
    several = len({*shown["body"]} - {""}) > 1
    for row in shown.to_dict("records"):
        name = f"{row['quantity']}, {row['body']} body" if several and row["body"] else row["quantity"]
        found[row["case"]][name] = row["best"]
    return pd.DataFrame(found.values()).fillna("")


def in_columns(tables: Mapping[str, pd.DataFrame], lines: Sequence[str] = ()) -> str:
    """Lines, then tables of texts with equal columns, of at most `WIDEST` characters if possible."""
    every, lines = pd.concat(tables.values()), [*lines]
    names, *columns = every.columns
    width = max(map(len, every[names])) + 4
    wide = {name: max(len(name), *map(len, every[name])) + 2 for name in columns}
    while columns:  # further columns stand below, with the names again
        here = [columns.pop(0)]
        while columns and width + sum(wide[name] for name in [*here, columns[0]]) <= WIDEST:
            here.append(columns.pop(0))
        lines.append(" " * width + "".join(f"{name:<{wide[name]}}" for name in here).rstrip())
        for title, table in tables.items():
            lines.append(title)
            for row in table.to_dict("records"):
                cells = "".join(f"{row[name]:<{wide[name]}}" for name in here)
                lines.append(f"  {row[names]:<{width - 2}}{cells}".rstrip())
        lines.append("")
    return "\n".join(lines[:-1])


def text(answer: AnswerData) -> str:
    """The answer as a block of text, warnings last."""
    width = max(len(each.quantity) for each in answer.records)
    lines = [fill(answer.title, WIDEST), "", *(fill(each, WIDEST) for each in answer.verdict)]
    if answer.uncertainties:
        lines += ["", "largest uncertainties", *(f"  {each.short}" for each in answer.uncertainties)]
    shown = without_repeats(answer.records)
    for heading, records in by_topic(answer.case, shown):
        lines += ["", heading, *(f"  {each.quantity:<{width}}  {each.text()}" for each in records)]
    if "sweep" in answer.tables:
        _, rows = for_reader(answer, "sweep")
        lines += ["", rows.set_index("sweep").T.to_string(line_width=WIDEST)]
    lines += ["", ONE_POSITION]
    lines += ["", REPEATS] if len(shown) < len(answer.records) else []
    lines += ["", "what was done to the map", *(f"  {step}" for step in answer.face.done)]
    for each in answer.warnings:
        lines += ["", fill(f"{each.level}: {each.text}", WIDEST)]
    return "\n".join(lines)
