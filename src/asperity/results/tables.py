"""Tables of the project as files: their columns with units, and writers for CSV and Excel.

A table is a data frame of pandas with one row for each case and numbers as numbers. `tables.yaml` describes
all of them; `docs/tables.md` shows it. For a reader a table is made into Markdown or HTML by
`asperity.core.markup`.
"""

import math
import re
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np

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

    try:
        found = pd.read_csv(path, dtype=str, keep_default_na=False)
        numbers = units(table, found)
        for name in found.columns:
            found[name] = _typed(found[name].tolist(), name in numbers)
    except (OSError, ValueError, KeyError) as error:
        raise DatasetError(f"{path}: a table of this version is needed ({error})") from error
    return found


def _typed(texts: list[str], is_number: bool) -> "list[Any]":
    """Values of a column from their texts: truth values, whole numbers, numbers or texts."""
    if texts and {*texts} <= {"True", "False"}:
        return [text == "True" for text in texts]
    if not is_number:
        return texts
    try:
        return [int(text) for text in texts]
    except ValueError:
        return [float(text or "nan") for text in texts]


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
"""SI unit → unit in a sheet of Excel, and its size.

The file is a zip archive of XML parts (Office Open XML, ECMA-376), written without a package for it: openpyxl
takes a tenth of the time of a whole calculation to write the peaks of a map of 512 × 512 points.
"""

_OPEN = "http://schemas.openxmlformats.org"
_SHEETS = f"{_OPEN}/spreadsheetml/2006/main"
_NOT_IN_XML = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_workbook(tables: "Mapping[str, pd.DataFrame]", path: FilePath) -> None:
    """Write tables as the sheets of one Excel file, in µm and MPa.

    Parameters
    ----------
    tables : mapping
        Name of a sheet → table, described in `TABLES` under that name, or under it after ``answer_``.
    path : path
        Ends in .xlsx.
    """
    types = "application/vnd.openxmlformats-officedocument.spreadsheetml."
    sheets = {f"sheet{number}": name for number, name in enumerate(tables, 1)}
    contents = f'<Override PartName="/xl/workbook.xml" ContentType="{types}sheet.main+xml"/>'
    names = ""
    for number, (part, name) in enumerate(sheets.items(), 1):
        contents += f'<Override PartName="/xl/{part}.xml" ContentType="{types}worksheet+xml"/>'
        names += f'<sheet name="{escape(name, quote=False)}" sheetId="{number}" r:id="{part}"/>'
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{_OPEN}/package/2006/content-types"><Default Extension="rels"'
        f' ContentType="application/vnd.openxmlformats-package.relationships+xml"/>{contents}</Types>',
        "_rels/.rels": _relations("officeDocument", {"book": "xl/workbook.xml"}),
        "xl/_rels/workbook.xml.rels": _relations("worksheet", {part: f"{part}.xml" for part in sheets}),
        "xl/workbook.xml": f'<workbook xmlns="{_SHEETS}" xmlns:r="{_OPEN}/officeDocument/2006/relationships">'
        f"<sheets>{names}</sheets></workbook>",
    }
    for part, name in sheets.items():
        shown = _in_sheet_units(name, tables[name])
        columns = (map(_cell, shown[column].tolist()) for column in shown)
        rows = [map(_cell, shown), *zip(*columns, strict=True)]
        lines = "".join(f"<row>{''.join(row)}</row>" for row in rows)
        parts[f"xl/{part}.xml"] = f'<worksheet xmlns="{_SHEETS}"><sheetData>{lines}</sheetData></worksheet>'
    with ZipFile(path, "w") as book:
        for name, content in parts.items():
            entry = ZipInfo(name)  # without the time
            entry.compress_type = ZIP_DEFLATED
            book.writestr(entry, f'<?xml version="1.0" encoding="UTF-8"?>{content}', compresslevel=1)


def _relations(kind: str, targets: Mapping[str, str]) -> str:
    """Part of an Excel file that refers to other parts, in XML."""
    kinds = f"{_OPEN}/officeDocument/2006/relationships/{kind}"
    relation = '<Relationship Id="{}" Type="{}" Target="{}"/>'
    found = "".join(relation.format(name, kinds, target) for name, target in targets.items())
    return f'<Relationships xmlns="{_OPEN}/package/2006/relationships">{found}</Relationships>'


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


def _cell(value: Any) -> str:
    """A cell of a sheet, which holds no infinity, and nothing where a value is missing."""
    if value is None or value != value:
        return "<c/>"
    if isinstance(value, (bool, np.bool_)):
        return f'<c t="b"><v>{int(value)}</v></c>'
    if isinstance(value, (int, float, np.number)) and abs(value) != math.inf:
        return f"<c><v>{value:.16g}</v></c>"
    text = _NOT_IN_XML.sub("?", str(value))
    return f'<c t="inlineStr"><is><t xml:space="preserve">{escape(text, quote=False)}</t></is></c>'
