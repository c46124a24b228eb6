"""Fields over the surface for other programs: as VTK image data (``.vti``), as a table, or along a line.

The fields are those of a surface or a contact: height of the rough face, contact pressure, gap, displacement.
Units and conventions are those of `asperity.results.export`: µm and MPa for results in SI. Files are written
row by row, so that memory does not grow with their size.
"""

from __future__ import annotations

import os
from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from asperity.results.atomic import atomic_write
from asperity.results.export import Box, ExportUnits, export_units, image_head
from asperity.results.window import Window
from asperity.types import Array

LENGTHS = ("height", "gap", "displacement")
"""Fields that are lengths; the pressure is a stress."""

ROWS_AT_ONCE = 64
"""Rows of nodes of a table that are written together."""


def surface_fields(data: xr.Dataset, height: Array | None = None) -> dict[str, Array]:
    """Fields over the surface of a result: name → array [y, x].

    Parameters
    ----------
    data : dataset
        Result of stage surface or contact.
    height : array, optional
        Height of the rough face, if the result does not hold it.

    Raises
    ------
    ValueError
        If the result has no such field.
    """
    found = {
        name: data[name].values for name in ("height", "pressure", "gap", "displacement") if name in data
    }
    if height is not None:
        found = {"height": height} | found
    if not found:
        raise ValueError("result: a surface or a contact, with fields over y and x, is needed")
    return found


def named(fields: Mapping[str, Array], units: ExportUnits) -> dict[str, tuple[Array, float]]:
    """Fields by name with unit, such as ``pressure_MPa``, with the size of the unit."""
    return {
        f"{name}_{units.length_name if name in LENGTHS else units.stress_name}": (
            values,
            units.length if name in LENGTHS else units.stress,
        )
        for name, values in fields.items()
    }


def write_surface_image(
    data: xr.Dataset, path: str | os.PathLike[str], fields: Mapping[str, Array], part: Window
) -> int:
    """Write fields over a part of the surface as VTK image data of one layer of nodes; return its bytes."""
    units = export_units(data)
    columns = named(fields, units)
    field_bytes = 4 * part.y.size * part.x.size
    head = image_head(Box(np.zeros(1), part), list(columns), units, field_bytes)
    with atomic_write(path) as unfinished, open(unfinished, "wb") as file:
        file.write(head)
        for values, unit in columns.values():
            file.write(np.uint64(field_bytes).astype("<u8").tobytes())
            for row in part.of(values):
                file.write((row / unit).astype("<f4").tobytes())
        file.write(b"\n</AppendedData></VTKFile>\n")
        return file.tell()


def write_surface_table(
    data: xr.Dataset, path: str | os.PathLike[str], fields: Mapping[str, Array], part: Window
) -> int:
    """Write fields over a part of the surface as CSV, a row for each node; return the number of rows.

    Columns: y and x with their unit, then the fields with theirs. A part of one row or column of nodes is a
    profile.
    """
    units = export_units(data)
    columns = named(fields, units)
    with atomic_write(path) as unfinished, open(unfinished, "w", encoding="utf-8", newline="") as file:
        for first in range(0, part.y.size, ROWS_AT_ONCE):
            rows = slice(first, min(first + ROWS_AT_ONCE, part.y.size))
            y, x = np.meshgrid(part.y[rows] / units.length, part.x / units.length, indexing="ij")
            table = pd.DataFrame(
                {f"y_{units.length_name}": y.ravel(), f"x_{units.length_name}": x.ravel()}
                | {name: (part.of(values)[rows] / unit).ravel() for name, (values, unit) in columns.items()}
            )
            table.to_csv(file, index=False, header=not first, float_format="%.7g", lineterminator="\n")
    return part.y.size * part.x.size
