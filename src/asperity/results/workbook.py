"""Tables as the sheets of an Excel file, in the units in which surfaces and stresses are read.

The file is a zip archive of XML parts (Office Open XML, ECMA-376), written without a package for it: openpyxl
takes a tenth of the time of a whole calculation to write the peaks of a map of 512 × 512 points.
"""

import math
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np

from asperity.core.types import FilePath

if TYPE_CHECKING:
    import pandas as pd

SHEET_UNITS = {
    "m": ("µm", 1e-6),
    "m^2": ("µm²", 1e-12),
    "m^3": ("µm³", 1e-18),
    "Pa": ("MPa", 1e6),
    "1/m^2": ("1/mm²", 1e6),
}
"""SI unit → unit in a sheet, and its size."""

SHEET_COLUMNS = {"m": "m", "m2": "m^2", "Pa": "Pa"}
"""End of the name of a column → its unit."""

_OPEN = "http://schemas.openxmlformats.org"
_SHEETS = f"{_OPEN}/spreadsheetml/2006/main"
_NOT_IN_XML = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_workbook(tables: "Mapping[str, pd.DataFrame]", path: FilePath) -> None:
    """Write tables as the sheets of one Excel file, in µm and MPa.

    Parameters
    ----------
    tables : mapping
        Name of a sheet → table whose columns end in their units, as ``_m`` and ``_Pa``, or that has a column
        ``unit`` for its other numbers.
    path : path
        Ends in .xlsx.
    """
    types = "application/vnd.openxmlformats-officedocument.spreadsheetml."
    sheets = {f"sheet{number}": name for number, name in enumerate(tables, 1)}
    contents = f'<Override PartName="/xl/workbook.xml" ContentType="{types}sheet.main+xml"/>'
    names = ""
    for number, (part, name) in enumerate(sheets.items(), 1):
        contents += f'<Override PartName="/xl/{part}.xml" ContentType="{types}worksheet+xml"/>'
        names += f'<sheet name="{escape(name)}" sheetId="{number}" r:id="{part}"/>'
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{_OPEN}/package/2006/content-types"><Default Extension="rels"'
        f' ContentType="application/vnd.openxmlformats-package.relationships+xml"/>{contents}</Types>',
        "_rels/.rels": _relations("officeDocument", {"book": "xl/workbook.xml"}),
        "xl/_rels/workbook.xml.rels": _relations("worksheet", {part: f"{part}.xml" for part in sheets}),
        "xl/workbook.xml": f'<workbook xmlns="{_SHEETS}" xmlns:r="{_OPEN}/officeDocument/2006/relationships">'
        f"<sheets>{names}</sheets></workbook>",
    }
    for part, name in sheets.items():
        parts[f"xl/{part}.xml"] = _sheet(_in_sheet_units(tables[name]))
    with ZipFile(path, "w") as book:
        for name, content in parts.items():
            entry = ZipInfo(name)  # without the time
            entry.compress_type = ZIP_DEFLATED
            book.writestr(entry, f'<?xml version="1.0" encoding="UTF-8"?>{content}', compresslevel=1)


def _relations(kind: str, targets: Mapping[str, str]) -> str:
    """Part of an Excel file that refers to other parts, in XML."""
    kinds = f"{_OPEN}/officeDocument/2006/relationships/{kind}"
    found = "".join(
        f'<Relationship Id="{name}" Type="{kinds}" Target="{target}"/>' for name, target in targets.items()
    )
    return f'<Relationships xmlns="{_OPEN}/package/2006/relationships">{found}</Relationships>'


def _in_sheet_units(frame: "pd.DataFrame") -> "pd.DataFrame":
    """A table in the units of a sheet."""
    shown = frame.copy()
    for column in shown.select_dtypes("number"):
        if "unit" in shown:
            factors = shown["unit"].map(lambda unit: SHEET_UNITS.get(unit, (unit, 1.0))[1])
            shown[column] = shown[column] / factors
        elif (end := str(column).rpartition("_")[2]) in SHEET_COLUMNS:
            unit, factor = SHEET_UNITS[SHEET_COLUMNS[end]]
            shown[column] = shown[column] / factor
            shown = shown.rename(columns={column: f"{str(column).removesuffix(end)}{unit}"})
    if "unit" in shown:
        shown["unit"] = shown["unit"].map(lambda unit: SHEET_UNITS.get(unit, (unit, 1.0))[0])
    return shown


def _sheet(frame: "pd.DataFrame") -> str:
    """A table as a sheet of an Excel file, in XML."""
    rows = [map(_cell, frame), *zip(*(map(_cell, frame[column].tolist()) for column in frame), strict=True)]
    lines = "".join(f"<row>{''.join(row)}</row>" for row in rows)
    return f'<worksheet xmlns="{_SHEETS}"><sheetData>{lines}</sheetData></worksheet>'


def _cell(value: Any) -> str:
    """A cell of a sheet, which holds no infinity, and nothing where a value is missing."""
    if value is None or value != value:
        return "<c/>"
    if isinstance(value, (bool, np.bool_)):
        return f'<c t="b"><v>{int(value)}</v></c>'
    if isinstance(value, (int, float, np.number)) and abs(value) != math.inf:
        return f"<c><v>{value:.16g}</v></c>"
    text = _NOT_IN_XML.sub("?", str(value))
    return f'<c t="inlineStr"><is><t xml:space="preserve">{escape(text)}</t></is></c>'
