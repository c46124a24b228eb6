"""Results for other programs: peaks as CSV, fields of the stress in a box as VTK image data (``.vti``).

A table holds one row for each peak. An image holds fields on equidistant nodes: x and y of the cell, z upward
with 0 in the surface, so that the solid is at z ≤ 0. SI results are exported in µm and MPa, dimensionless
ones in cell lengths and E*; the names of columns and fields end in the unit.

Fields are written plane by plane, so that memory does not grow with the size of the box. The file format is
"VTK XML ImageData" with appended raw data (VTK File Formats, Kitware; https://docs.vtk.org); ParaView, VTK
and pyvista open it. `uvw` makes its description; the data are written here, because `uvw` holds all of them
in memory as text.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np
import pandas as pd
import xarray as xr

from asperity.results.atomic import atomic_write
from asperity.results.tables import write_table
from asperity.results.window import Span, Window, window
from asperity.spectral import Grid
from asperity.stress.planes import stress_planes
from asperity.stress.pressed import ContactLike
from asperity.types import Array, Progress

MOST_PLANES = 4096
"""Most planes of a box."""


@dataclass(frozen=True)
class ExportUnits:
    """Units of exported numbers.

    Parameters
    ----------
    length, stress : float
        Size of the exported unit in that of the result; numbers are divided by it.
    length_name, stress_name : str
        Ends of the names of columns and fields.
    """

    length: float = 1.0
    stress: float = 1.0
    length_name: str = "cell_length"
    stress_name: str = "effective_modulus"


DIMENSIONLESS = ExportUnits()
MICROMETRES_AND_MEGAPASCALS = ExportUnits(1e-6, 1e6, "um", "MPa")


def export_units(data: xr.Dataset) -> ExportUnits:
    """Units in which the numbers of a result are exported."""
    return MICROMETRES_AND_MEGAPASCALS if data.attrs.get("unit_system") == "SI" else DIMENSIONLESS


def peak_table(stress: xr.Dataset) -> pd.DataFrame:
    """Peaks of a stress analysis as a table, the largest of each quantity first.

    Parameters
    ----------
    stress : dataset
        Result of stage stress.

    Returns
    -------
    table : DataFrame
        ``quantity``; ``poisson``, empty where the peak is the same for every ratio; ``kind``, "surface" or
        "interior"; ``under_contact``; ``value``, ``depth``, ``y`` and ``x``, each with its unit in its name,
        such as ``value_MPa`` and ``depth_um``.

    Raises
    ------
    ValueError
        If it is another dataset.
    """
    if "peak_value" not in stress:
        raise ValueError("stress: a result of asperity stress is needed, this one has no peaks")
    units = export_units(stress)
    table = pd.DataFrame(
        {
            "quantity": stress["peak_quantity"].values.astype(str),
            "poisson": stress["peak_poisson"].values,
            "kind": np.where(stress["peak_interior"].values, "interior", "surface"),
            "under_contact": stress["peak_under_contact"].values.astype(bool),
            f"value_{units.stress_name}": stress["peak_value"].values / units.stress,
            **{
                f"{name}_{units.length_name}": stress[f"peak_{name}"].values / units.length
                for name in ("depth", "y", "x")
            },
        }
    )
    order = table.assign(size=-table[f"value_{units.stress_name}"].abs())
    return table.loc[order.sort_values(["quantity", "poisson", "size"], kind="stable").index].reset_index(
        drop=True
    )


def write_peaks(stress: xr.Dataset, path: str | os.PathLike[str]) -> int:
    """Write `peak_table` as CSV, with seven digits, or as Parquet, and return the number of its rows."""
    table = peak_table(stress)
    write_table(table, "peaks", path, float_format="%.7g")
    return len(table)


@dataclass(frozen=True)
class Box:
    """Part of a solid, on equidistant nodes.

    Parameters
    ----------
    depths : (planes,) array
        Equidistant, rising.
    window : Window
        Nodes of the grid of the contact.
    """

    depths: Array
    window: Window

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of nodes along z, y and x."""
        return self.depths.size, self.window.y.size, self.window.x.size


def make_box(
    grid: Grid,
    depth: Span,
    y: Span | None = None,
    x: Span | None = None,
    spacing: float | None = None,
    told: Callable[[float], str] = "{:.6g}".format,
) -> Box:
    """Box between two depths, and between two positions along y and x, all included.

    Parameters
    ----------
    grid : Grid
        Of the contact.
    depth : (first, last)
    y, x : (first, last), optional
        By default the whole cell.
    spacing : float, optional
        Largest distance between planes, by default that between the nodes of the grid.
    told : callable, optional
        Text of a length in messages.

    Raises
    ------
    ValueError
        If positions do not rise or are outside the cell, or the box has fewer than two nodes along an axis or
        more than `MOST_PLANES` planes.
    """
    top, bottom = depth
    spacing = min(grid.spacing) if spacing is None else spacing
    given = f"depth = {told(top)} to {told(bottom)}"
    if not 0 <= top < bottom:
        raise ValueError(f"{given}: rising depths ≥ 0 are needed")
    if not spacing > 0:
        raise ValueError(f"spacing = {told(spacing)}: a distance > 0 is needed")
    intervals = (bottom - top) / spacing
    if intervals > MOST_PLANES - 1:
        raise ValueError(
            f"{given}, spacing = {told(spacing)}: a spacing of at least "
            f"{told((bottom - top) / (MOST_PLANES - 1))} is needed, for at most {MOST_PLANES} planes"
        )
    depths = np.linspace(top, bottom, max(2, int(np.ceil(intervals - 1e-6)) + 1))
    return Box(depths, window(grid, y, x, told))


def write_box(
    contact: ContactLike,
    path: str | os.PathLike[str],
    box: Box,
    fields: Sequence[str] = ("von_mises",),
    poisson: float | None = None,
    units: ExportUnits = DIMENSIONLESS,
    progress: Progress | None = None,
    **sliding: Any,
) -> int:
    """Write fields of the stress in a box as VTK image data, in single precision.

    Parameters
    ----------
    contact : object with ``pressure``, ``grid`` and ``layer``
    path : path
        Ends in ``.vti``.
    box : Box
    fields : names
        As for `asperity.stress_planes`.
    poisson : float, optional
        By default that of the contact.
    units : ExportUnits
        The unit of stress is in that of the pressure.
    progress : callable, optional
    **sliding
        ``friction`` and ``sliding_direction`` of `asperity.stress_planes`.

    Returns
    -------
    size : int
        Bytes of the file.
    """
    shape = box.shape
    plane_bytes = 4 * shape[1] * shape[2]
    field_bytes = plane_bytes * shape[0]
    names = [f"{name}_{units.stress_name}" for name in fields]
    head = image_head(box, names, units, field_bytes)
    with atomic_write(path) as unfinished, open(unfinished, "wb") as file:
        file.write(head)
        begins = [len(head) + number * (8 + field_bytes) for number in range(len(fields))]
        for begin in begins:
            file.seek(begin)
            file.write(np.uint64(field_bytes).astype("<u8").tobytes())
        planes = planes_on_grid(contact, box.depths, fields, poisson, progress, **sliding)
        for number, plane in enumerate(planes):
            # z rises upward, so that the deepest plane comes first.
            place = 8 + (shape[0] - 1 - number) * plane_bytes
            for begin, name in zip(begins, fields, strict=True):
                part = box.window.of(plane[name]) / units.stress
                _write_at(file, begin + place, part)
        file.seek(begins[-1] + 8 + field_bytes)
        file.write(b"\n</AppendedData></VTKFile>\n")
        return file.tell()


def planes_on_grid(
    contact: ContactLike,
    depths: Array,
    fields: Sequence[str],
    poisson: float | None = None,
    progress: Progress | None = None,
    **sliding: Any,
) -> Iterator[dict[str, Array]]:
    """Stream fields of the stress on the grid of the contact, in the unit of its pressure.

    Parameters
    ----------
    contact, depths, fields, progress
        As for `asperity.stress_planes`.
    poisson : float, optional
        By default that of the contact.
    **sliding
        ``friction`` and ``sliding_direction`` of `asperity.stress_planes`.

    Yields
    ------
    fields : dict
        Name → array [y, x] of one plane.
    """
    planes = stress_planes(contact, depths, poisson, fields, tolerance=0.0, progress=progress, **sliding)
    for plane in planes:
        yield {name: values[0] for name, values in plane.fields.items()}


def _write_at(file: BinaryIO, place: int, values: Array) -> None:
    file.seek(place)
    file.write(np.ascontiguousarray(values, "<f4").data)


def image_head(box: Box, names: Sequence[str], units: ExportUnits, field_bytes: int) -> bytes:
    """The XML of an image up to its data: nodes, and name and place of every field.

    Parameters
    ----------
    box : Box
    names : sequence of str
        Names of the fields, with their units.
    units : ExportUnits
    field_bytes : int
        Bytes of each field.
    """
    from uvw import ImageData

    positions = [box.window.x, box.window.y, *([-box.depths[::-1]] if box.depths.size > 1 else [])]
    ranges = [(float(nodes[0]) / units.length, float(nodes[-1]) / units.length) for nodes in positions]
    image = ImageData(None, ranges, [nodes.size for nodes in positions], vtk_version="1.0")
    if box.depths.size == 1:
        # uvw leaves out the third of the numbers that VTK needs for a single layer of nodes.
        step = [
            (last - first) / (nodes.size - 1) for (first, last), nodes in zip(ranges, positions, strict=True)
        ]
        origin = ranges[0][0], ranges[1][0], -float(box.depths[0]) / units.length
        image.writer.setDataNodeAttributes(
            {
                "WholeExtent": image.extent,
                "Spacing": f"{step[0]} {step[1]} 1.0",
                "Origin": " ".join(map(str, origin)),
            }
        )
    image.writer.root.setAttribute("header_type", "UInt64")
    image.point_data.setAttributes({"Scalars": names[0]})
    for number, name in enumerate(names):
        image.point_data.register(
            "DataArray",
            {
                "type": "Float32",
                "Name": name,
                "NumberOfComponents": "1",
                "format": "appended",
                "offset": str(number * (8 + field_bytes)),
            },
        )
    text: bytes = image.writer.document.toxml(encoding="UTF-8")
    return text.removesuffix(b"</VTKFile>") + b'<AppendedData encoding="raw">_'
