"""All tables of an answer, and a table for a reader."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd

from asperity.engineering.answer_data import AnswerData
from asperity.engineering.records import FRACTION, MODEL, POSITIVE, UNBOUNDED, Record
from asperity.results.tables import units

SHOWN_ROWS = 40
"""Most rows of a table in a report."""

FIRST_ROWS = 10
"""Rows that are shown of a longer table in falling order."""

FALLING = ("peaks", "contact_spots")
"""Tables in falling order."""


def tables(answer: AnswerData) -> dict[str, pd.DataFrame]:
    """Name of a file or sheet → table: all numbers, warnings, peaks, spots, gaps, tables of the questions."""
    return {"answer": answer.frame(), "warnings": answer.warnings_table(), **answer.tables}


def for_reader(name: str, table: pd.DataFrame) -> tuple[str, pd.DataFrame]:
    """Heading of a table of an answer, and rows of it as texts with units."""
    heading = name.replace("_", " ")
    if name == "sweep":
        return heading, _of_sweep(table)
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
        numbers = [
            Record("", value, unit or "1").number() if _is_number(value) else str(value) for value in values
        ]
        shown[str(column).removesuffix(end).replace("_", " ")] = numbers
    return heading, pd.DataFrame(shown)


def _of_sweep(table: pd.DataFrame) -> pd.DataFrame:
    """The shown numbers of a sweep: a row for each value, a column for each number."""
    found: dict[str, dict[str, str]] = {}
    shown = table[table["is_shown"]]
    several = len({*shown["body"]} - {""}) > 1
    for row in shown.to_dict("records"):
        bounds = {each.reason: each for each in (FRACTION, POSITIVE)}.get(row["bound"], UNBOUNDED)
        number = Record("", row["value"], row["unit"], extrapolated=row["extrapolated"], bounds=bounds)
        # Words in place of a number, such as none, begin its text.
        words = row["text"].partition(";")[0] if row["text"][:1].isalpha() else ""
        name = f"{row['quantity']}, {row['body']} body" if several and row["body"] else row["quantity"]
        at = re.sub(r"[\w.]+\.(?=\w+ = )", "", row["case"]).replace("_", " ")
        found.setdefault(at, {"sweep": at})[name] = (
            words or number.with_error(MODEL, row["error"]).best_text()
        )
    return pd.DataFrame(found.values()).fillna("")


def _is_number(value: object) -> bool:
    """True for a number that is no truth value."""
    return isinstance(value, (int, float, np.number)) and not isinstance(value, (bool, np.bool_))
