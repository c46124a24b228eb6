"""Tables of the project as files: their columns with units, and one writer for CSV and Parquet.

A table is a data frame of pandas with one row for each case and numbers as numbers. `TABLES` describes all of
them; `docs/tables.md` shows it. For a reader a table is made into Markdown or HTML by
`asperity.markup`.
"""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from asperity.results.atomic import atomic_write

if TYPE_CHECKING:
    import pandas as pd

SUFFIXES = (".csv", ".parquet")


class Column(NamedTuple):
    """A column of a table.

    Parameters
    ----------
    name : str
    unit : str
        ``1`` for a plain number; empty for texts and truth values.
    content : str
        In one line.
    always : bool
        False if some tables of this kind do not have the column.
    """

    name: str
    unit: str
    content: str
    always: bool = True


class Table(NamedTuple):
    """A kind of table: where it is found, what a row is, and its columns.

    Parameters
    ----------
    place : str
        File, command or function that gives it.
    row : str
    columns : tuple of Column
    """

    place: str
    row: str
    columns: tuple[Column, ...]


_PLACE = tuple(Column(f"{name}_m", "m", f"{name} of the peak") for name in ("depth", "y", "x"))

TABLES: dict[str, Table] = {
    "answer": Table(
        "`answer.csv` of `asperity run`, `Answer.frame()`",
        "a number of the answer",
        (
            Column("group", "", "contact, or the stress in one body"),
            Column("name", "", "what the number is"),
            Column("value", "see unit", "in SI"),
            Column("unit", "", "SI unit of the value"),
        ),
    ),
    "answer_peaks": Table(
        "`peaks.csv` of `asperity run`, `Answer.peaks()`",
        "a peak of the contact pressure or of the von Mises stress",
        (
            Column("body", "", "lower or upper"),
            Column("quantity", "", "pressure or von_mises"),
            Column("value_Pa", "Pa", "value of the peak"),
            *_PLACE,
            Column("in_solid", "", "true if the peak is below the surface"),
            Column("under_contact", "", "true if the surface node nearest above it carries pressure"),
        ),
    ),
    "peaks": Table(
        "`asperity export --peaks`, `asperity.results.export.peak_table`",
        "a peak of a stress analysis",
        (
            Column("quantity", "", "analysed quantity"),
            Column("poisson", "1", "Poisson's ratio, empty where the peak is the same for every one"),
            Column("kind", "", "surface or interior"),
            Column("under_contact", "", "true if the surface node nearest above it carries pressure"),
            *(
                Column(f"{name}_{unit}", unit, f"{text}, of results in SI", always=False)
                for name, unit, text in (
                    ("value", "MPa", "value"),
                    ("depth", "um", "depth"),
                    ("y", "um", "position"),
                    ("x", "um", "position"),
                )
            ),
            *(
                Column(f"{name}_{unit}", unit, f"{text}, of dimensionless results", always=False)
                for name, unit, text in (
                    ("value", "effective_modulus", "value"),
                    ("depth", "cell_length", "depth"),
                    ("y", "cell_length", "position"),
                    ("x", "cell_length", "position"),
                )
            ),
        ),
    ),
    "claims": Table(
        "`claims.csv` of a study",
        "a statement of the paper",
        (
            Column("identifier", "", "name of the statement"),
            Column("section", "", "of the paper"),
            Column("the paper says", "", "the statement in our words"),
            Column("measured", "", "the quantity"),
            Column("predicted", "", "region in which the statement wants it"),
            Column("value", "1", "mean over seeds"),
            Column("standard error", "1", "over seeds, or the numerical uncertainty"),
            Column("interval low", "1", "lower end of the interval that decides"),
            Column("interval high", "1", "its upper end"),
            Column("seeds", "1", "their number; 0 if no random surface enters"),
            Column("verdict", "", "outcome"),
            Column("choices", "", "choices of the reading on which the verdict depends"),
            Column("readings", "", "outcomes under several readings"),
            Column("nodes per shortest wavelength", "1", "of the study's grid"),
            Column("value at nodes", "1", "value on the study's grid"),
            Column("continuum shift", "1", "what vanishing grid spacing adds to the value"),
            Column("continuum shift error", "1", "its error"),
            Column("missing", "", "what the configuration lacks to decide"),
        ),
    ),
    "claims_readings": Table(
        "`readings.csv` of a study",
        "a statement of the paper under one reading, the study's own first",
        (
            Column("identifier", "", "name of the statement"),
            Column("reading", "", "option of every choice, as JSON"),
            Column("region low", "1", "lower end of the region in which the statement wants the number"),
            Column("region high", "1", "its upper end"),
            Column("value", "1", "mean over seeds"),
            Column("standard error", "1", "over seeds, or the numerical uncertainty"),
            Column("interval low", "1", "lower end of the interval that decides"),
            Column("interval high", "1", "its upper end"),
            Column("seeds", "1", "their number; 0 if no random surface enters"),
            Column("verdict", "", "outcome"),
            Column("value at nodes", "1", "value on the study's grid"),
            Column("continuum shift", "1", "what vanishing grid spacing adds to the value"),
            Column("continuum shift error", "1", "its error"),
            Column("missing", "", "what the configuration lacks to decide"),
        ),
    ),
    "validation": Table(
        "`validation/table.csv` of a study, `asperity.validation.table.frame`",
        "a comparison with a closed form or another program",
        (
            Column("quantity", "", "what is compared"),
            Column("against", "", "with what"),
            Column("grid", "", "grid and mesh"),
            Column("source", "", "source of the error; rate if the number is an order of convergence"),
            Column("error", "1", "relative error, or the order of convergence"),
            Column("bound", "1", "largest error, or smallest order, that the tests allow"),
            Column("holds", "", "true if the bound is kept"),
            Column("test", "", "test that guards the bound"),
        ),
    ),
    "verification": Table(
        "`verification/….csv` of a study",
        "a law and the amount by which a result breaks it",
        (
            Column("surface", "", "name of the surface"),
            Column("of", "", "seed, or all seeds"),
            Column("check", "", "the law"),
            Column("value", "1", "amount by which it is broken"),
            Column("bound", "1", "amount that is allowed"),
        ),
    ),
    "costs": Table(
        "`costs.csv` of a study (`python workflow/cost.py --csv`)",
        "a rule and surface, the last row the whole study",
        (
            Column("job", "", "rule, and the surface if it has one"),
            Column("jobs", "1", "number of them"),
            Column("processor_minutes", "min", "processor time of all of them"),
            Column("largest_memory_MB", "MB", "of the largest of them"),
            Column("declared_MB", "MB", "memory that the rule declares for it", always=False),
        ),
    ),
    "presets": Table(
        "`tradeoff/…/presets.csv` of a study, `asperity.accuracy.tables.presets_frame`",
        "a preset of accuracy",
        (
            Column("preset", "", "its name"),
            Column("points_per_wavelength", "1", "nodes on the shortest wavelength"),
            Column("contact_tolerance", "1", "`contact.tolerance`"),
            Column("precision", "", "`contact.precision`"),
            Column("depth_tolerance", "1", "`stress.tolerance`"),
            Column("depth_spacing", "1", "`stress.depth_spacing`"),
            Column("half_space_tolerance", "1", "`layer.half_space_tolerance`"),
            Column("seeds", "1", "number of seeds"),
            Column("seconds", "s", "processor time of one surface"),
            Column("error_…", "1", "largest relative error of each output, a column each"),
        ),
    ),
    "tradeoff": Table(
        "`tradeoff/…/errors.csv` of a study, `asperity.accuracy.tables.errors_frame`",
        "an output at one setting of one parameter",
        (
            Column("area_fraction", "1", "real over nominal contact area"),
            Column("parameter", "", "parameter of accuracy; seeds for the scatter of one surface"),
            Column("setting", "see parameter", "its value, as text"),
            Column("output", "", "name of the output"),
            Column("error", "1", "largest relative error of any surface"),
        ),
    ),
}
"""Name → table. Numbers in a column have one unit."""


def write_table(
    frame: pd.DataFrame, table: str, path: str | os.PathLike[str], float_format: str | None = None
) -> None:
    """Write a table as CSV or Parquet, by the suffix of the path, whole or not at all.

    Parameters
    ----------
    frame : DataFrame
        Its columns are those of `TABLES`, in that order; a Parquet file keeps their units in
        ``frame.attrs``.
    table : str
        Name in `TABLES`.
    path : path
        Ends in .csv or .parquet; the latter needs the package pyarrow.
    float_format : str, optional
        Of numbers in a CSV file, such as ``"%.8g"``; by default all digits.

    Raises
    ------
    ValueError
        If the suffix is another, a column is not in the description, or one is missing.
    ImportError
        If pyarrow is needed and not installed.
    DatasetError
        If the file cannot be written; an earlier file of the same name is still there then.
    """
    path = Path(path)
    if path.suffix not in SUFFIXES:
        raise ValueError(f"{path}: a name that ends in {' or '.join(SUFFIXES)} is needed")
    if path.suffix == ".parquet" and find_spec("pyarrow") is None:
        raise ImportError(f"{path}: Parquet needs the package pyarrow: pip install pyarrow, or write .csv")
    check_columns(frame, table)
    with atomic_write(path) as unfinished:
        if path.suffix == ".csv":
            frame.to_csv(unfinished, index=False, float_format=float_format, lineterminator="\n")
        else:
            described = frame.copy()
            described.attrs["units"] = units(table, frame)
            described.to_parquet(unfinished, index=False)


def check_columns(frame: pd.DataFrame, table: str) -> None:
    """Raise `ValueError` unless the columns of a frame are those of a table, in their order."""
    columns = TABLES[table].columns
    order = [_described(str(name), columns) for name in frame.columns]
    unknown = [str(name) for name, found in zip(frame.columns, order, strict=True) if found is None]
    missing = [column.name for column in columns if column.always and column not in order]
    if unknown or missing:
        problem = f"{unknown[0]!r} is not among its columns" if unknown else f"{missing[0]!r} is missing"
        raise ValueError(f"table {table}: column {problem}; columns {_names(columns)} are needed")
    places = [columns.index(found) for found in order if found is not None]
    if places != sorted(places):
        raise ValueError(f"table {table}: columns {', '.join(map(str, frame.columns))} are out of order")


def units(table: str, frame: pd.DataFrame) -> dict[str, str]:
    """Column → unit, of the columns of a frame that have one."""
    columns = TABLES[table].columns
    found = {str(name): _described(str(name), columns) for name in frame.columns}
    return {name: column.unit for name, column in found.items() if column is not None and column.unit}


def _described(name: str, columns: tuple[Column, ...]) -> Column | None:
    """The description of a column; ``error_…`` stands for all names that begin so."""
    for column in columns:
        start, dots, _ = column.name.partition("…")
        if name == column.name or (dots and name.startswith(start)):
            return column
    return None


def _names(columns: tuple[Column, ...]) -> str:
    return ", ".join(column.name for column in columns if column.always)


def describe_tables() -> str:
    """All tables with their columns, in Markdown."""
    parts = []
    for name, table in TABLES.items():
        lines = [f"| `{c.name}` | {c.unit} | {c.content} |" for c in table.columns]
        head = f"## {name}\n\n{table.place[0].upper()}{table.place[1:]}. A row is {table.row}.\n"
        parts.append("\n".join([head, "| column | unit | content |", "|---|---|---|", *lines]))
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    print(describe_tables(), end="")
