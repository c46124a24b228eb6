"""Tables of the project as files: their columns with units, and writers for CSV and Excel.

A table is a data frame of pandas with one row for each case and numbers as numbers. `tables.yaml` describes
all of them; `docs/tables.md` shows it. For a reader a table is made into Markdown or HTML by
`asperity.core.markup`.
"""

import math
import re
from collections.abc import Mapping
from datetime import datetime
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.core.data import packaged_yaml
from asperity.core.errors import DatasetError
from asperity.core.types import FilePath
from asperity.results.atomic import atomic_write

if TYPE_CHECKING:
    import pandas as pd

TABLES: dict[str, dict[str, Any]] = packaged_yaml("asperity.results", "tables.yaml")
"""Name → ``source``, ``row`` and ``columns`` of a table; a column is [unit, content], and may be marked
optional.

Numbers in a column have one unit, ``1`` for a plain number; texts and truth values have none.
"""


def write_table(frame: "pd.DataFrame", table: str, path: FilePath, float_format: str | None = None) -> None:
    """Write a table as CSV, whole or not at all.

    Parameters
    ----------
    frame : DataFrame
        Its columns are in `TABLES`, in the same order.
    table : str
        Name in `TABLES`.
    path : path
        Ends in .csv.
    float_format : str, optional
        Of numbers, such as ``"%.8g"``; by default all digits.

    Raises
    ------
    ValueError
        If the suffix is another, a column is not in the description, or one is missing.
    DatasetError
        If the file cannot be written; an earlier file of the same name is still there then.
    """
    path = Path(path)
    if path.suffix != ".csv":
        raise ValueError(f"{path}: a name that ends in .csv is needed")
    check_columns(frame, table)
    with atomic_write(path) as unfinished:
        frame.to_csv(unfinished, index=False, float_format=float_format, lineterminator="\n")


def read_table(table: str, path: FilePath) -> "pd.DataFrame":
    """A table as it was before `write_table` wrote it, equal to the bit.

    Raises
    ------
    DatasetError
        If it cannot be read, or has other columns.
    """
    import pandas as pd

    options: Any = {"keep_default_na": False}
    if tuple(map(int, pd.__version__.split(".")[:2])) < (3, 1):  # later ones always read the exact number
        options["float_precision"] = "round_trip"
    try:
        header = pd.read_csv(path, nrows=0)
        numbers = units(table, header)
        texts: Any = {name: str for name in header if name not in numbers}
        options["na_values"] = {name: [""] for name in numbers}
        found = pd.read_csv(path, dtype=texts, **options)
        found[[*numbers]].astype(float)  # a ValueError where one is no number
    except (OSError, ValueError, KeyError) as error:
        raise DatasetError(f"{path}: a table of this version is needed ({error})") from error
    for name in texts:
        if len(found) and {*found[name].unique()} <= {"True", "False"}:
            found[name] = found[name] == "True"
    return found


def check_columns(frame: "pd.DataFrame", table: str) -> None:
    """Raise `ValueError` unless a frame has the columns of a table, in their order."""
    columns = TABLES[table]["columns"]
    found = [_described(str(name), columns) for name in frame.columns]
    needed = [name for name, (_, _, *optional) in columns.items() if not optional]
    unknown = [str(name) for name, known in zip(frame.columns, found, strict=True) if not known]
    missing = [name for name in needed if name not in found]
    if unknown or missing:
        problem = f"{unknown[0]!r} is not among its columns" if unknown else f"{missing[0]!r} is missing"
        raise ValueError(f"table {table}: column {problem}; columns {', '.join(needed)} are needed")
    if found != sorted(found, key=list(columns).index):
        raise ValueError(f"table {table}: columns {', '.join(map(str, frame.columns))} are out of order")


def units(table: str, frame: "pd.DataFrame") -> dict[str, str]:
    """Column → unit, of the columns of a frame that have one."""
    columns = TABLES[table]["columns"]
    found = {str(name): columns[_described(str(name), columns)][0] for name in frame.columns}
    return {name: unit for name, unit in found.items() if unit}


def _described(name: str, columns: dict[str, Any]) -> str:
    """Name under which a column is described, empty if it is not; ``error_…`` describes all such names."""
    families = (known for known in columns if known[-1] == "…" and name.startswith(known[:-1]))
    return name if name in columns else next(families, "")


SHEET_UNITS = {
    "m": ("µm", 1e-6),
    "m^2": ("µm²", 1e-12),
    "m^3": ("µm³", 1e-18),
    "Pa": ("MPa", 1e6),
    "1/m^2": ("1/mm²", 1e6),
}
"""SI unit → unit in a sheet of Excel, and its size."""

_UNPRINTABLE = re.compile("[\x00-\x08\x0b-\x1f]")

PLAIN_TEXT = {"constant_memory": True, "strings_to_formulas": False, "strings_to_urls": False}
"""Options of a workbook in which a text never becomes a formula or a link."""

WRITTEN = datetime(2026, 1, 1)
"""Date in every workbook: equal tables make equal files."""


def write_workbook(tables: "Mapping[str, pd.DataFrame]", path: FilePath) -> None:
    """Write tables as the sheets of one Excel file, in µm and MPa.

    Parameters
    ----------
    tables : mapping
        Name of a sheet → table, described in `TABLES` under that name, or under it after ``answer_``.
    path : path
        Ends in .xlsx.
    """
    from xlsxwriter import Workbook

    with Workbook(path, PLAIN_TEXT) as book:
        book.set_properties({"created": WRITTEN})
        for name, frame in tables.items():
            sheet, shown = book.add_worksheet(name), _in_sheet_units(name, frame)
            columns = (map(_cell, shown[column].tolist()) for column in shown)
            for number, row in enumerate([list(shown), *zip(*columns, strict=True)]):
                sheet.write_row(number, 0, row)


def _in_sheet_units(name: str, frame: "pd.DataFrame") -> "pd.DataFrame":
    """A table with lengths in µm and stresses in MPa; names of columns end in the units of the sheet."""
    shown = frame.copy()
    for column, unit in units(f"answer_{name}" if f"answer_{name}" in TABLES else name, frame).items():
        if unit == "see unit":
            factors = shown["unit"].map(lambda each: SHEET_UNITS.get(each, (each, 1.0))[1])
            shown[column] = shown[column] / factors
        elif unit in SHEET_UNITS:
            new, factor = SHEET_UNITS[unit]
            shown[column] = shown[column] / factor
            shown = shown.rename(columns={column: f"{column.removesuffix(unit.replace('^', ''))}{new}"})
    if "unit" in shown:
        shown["unit"] = shown["unit"].map(lambda unit: SHEET_UNITS.get(unit, (unit, 1.0))[0])
    return shown


def _cell(value: Any) -> Any:
    """A cell of a sheet, which holds no infinity, and nothing where a value is missing."""
    if value is None or value != value:
        return None
    if isinstance(value, Real) and abs(value) != math.inf:
        return value
    return _UNPRINTABLE.sub("?", str(value))
