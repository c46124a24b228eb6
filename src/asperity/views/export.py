"""Results for other programs: tables of peaks and surface fields, VTK image data (``.vti``) of fields.

A table holds one row for each peak, or for each node of the surface. An image holds fields on equidistant
nodes: x and y of the cell, z upward with 0 in the surface, so that the solid is at z ≤ 0. SI results are
exported in µm and MPa, dimensionless ones in cell lengths and E*; the names of columns and fields end in the
unit.

Images are written plane by plane, so that memory does not grow with the size of a box. The file format is
"VTK XML ImageData" with appended raw data (VTK File Formats, Kitware; https://docs.vtk.org); ParaView, VTK
and pyvista open it.
"""

import os
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from asperity.core.types import Array, Progress
from asperity.results.atomic import atomic_write
from asperity.results.dataset import UNIT_SYSTEM
from asperity.results.variables import SI_UNITS
from asperity.stress.section import StressBox, stress_box
from asperity.views.source import Part, Source, Span, sources

MAX_PLANES = 4096
"""Most planes of a box."""

IMAGE_HEAD = """\
<?xml version="1.0" encoding="UTF-8"?>\
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">\
<ImageData WholeExtent="{extent}" Origin="{origin}" Spacing="{spacing}"><Piece Extent="{extent}">\
<PointData Scalars="{first}">{arrays}</PointData></Piece></ImageData><AppendedData encoding="raw">_"""

IMAGE_ARRAY = '<DataArray type="Float32" Name="{}" NumberOfComponents="1" format="appended" offset="{}"/>'


class ExportUnits(NamedTuple):
    """Units of exported numbers.

    Parameters
    ----------
    length, stress : float
        Size of the exported unit, in the unit of the result; numbers are divided by it.
    length_name, stress_name : str
        Suffixes of the names of columns and fields.
    """

    length: float = 1.0
    stress: float = 1.0
    length_name: str = "cell_length"
    stress_name: str = "effective_modulus"

    @classmethod
    def of(cls, system: str | None) -> "ExportUnits":
        """Units in which the numbers of a result in a system of units are exported."""
        return cls(1e-6, 1e6, "um", "MPa") if system == SI_UNITS else cls()


def write_vtk(
    path: str | os.PathLike[str],
    result: Any,
    fields: Sequence[str] = (),
    depth: Span | None = None,
    *,
    unit_system: str = SI_UNITS,
    **settings: Any,
) -> None:
    """Write a surface or contact as VTK image data (``.vti``), for ParaView and pyvista.

    Parameters
    ----------
    path : path
    result : dataset or object
        A surface or a contact, as for `asperity.views.plot_pressure`.
    fields : names
        Fields of the stress below a contact; by default height, pressure, gap and displacement over the
        surface are written.
    depth : (first, last)
        Of the box in which the stress is written.
    unit_system : str
        Of a result that does not say its own.
    **settings
        `y` and `x`, the part of the cell, (first, last) each; for a stress also `spacing` of the planes,
        `poisson`, `body`, `friction` and `sliding_direction`, as for `asperity.views.plot_section`.

    Raises
    ------
    ValueError
        If an argument is out of range, or the result describes no solid.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> height = asp.self_affine((32, 32), 0.8, 20e-6, 8e-6, rms_height=1e-7, seed=1, length=40e-6)
    >>> contact = asp.solve_contact(height, asp.Solid(210e9, 0.3), 40e-6, contact_area_fraction=0.1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     asp.views.write_vtk(Path(folder) / "box.vti", contact, ["xx"], depth=(0, 2e-6))
    ...     (Path(folder) / "box.vti").read_bytes()[-11:]
    b'</VTKFile>\\n'
    """
    (source,) = sources(result, unit_system)
    if not fields:
        write_surface_image(path, surface_fields(source, source.part(**settings)))
        return
    if depth is None:
        raise ValueError("depth = None: a pair (first, last) is needed for the fields of a stress")
    write_box(box_below(source, fields, depth, **settings), path, ExportUnits.of(source.system))


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
    """
    units = ExportUnits.of(stress.attrs.get(UNIT_SYSTEM))
    value = f"value_{units.stress_name}"
    table = pd.DataFrame(
        {
            "quantity": stress["peak_quantity"].values.astype(str),
            "poisson": stress["peak_poisson"].values,
            "kind": np.where(stress["peak_interior"].values, "interior", "surface"),
            "under_contact": stress["peak_under_contact"].values.astype(bool),
            value: stress["peak_value"].values / units.stress,
            **{
                f"{name}_{units.length_name}": stress[f"peak_{name}"].values / units.length
                for name in ("depth", "y", "x")
            },
        }
    )
    order = table.assign(size=-table[value].abs()).sort_values(["quantity", "poisson", "size"], kind="stable")
    return order.drop(columns="size").reset_index(drop=True)


def box_depths(source: Source, depth: Span, spacing: float | None = None) -> Array:
    """Equidistant depths of the planes of a box, both ends included.

    Parameters
    ----------
    source : Source
        The contact.
    depth : (first, last)
    spacing : float, optional
        Largest distance between planes, by default the spacing of the grid.

    Raises
    ------
    ValueError
        If the depths do not rise, or there are more than `MAX_PLANES` planes.
    """
    top, bottom = depth
    spacing = min(source.grid.spacing) if spacing is None else spacing
    given = f"depth = {source.shown(top)} to {source.shown(bottom)}"
    if not 0 <= top < bottom:
        raise ValueError(f"{given}: rising depths ≥ 0 are needed")
    if not spacing > 0:
        raise ValueError(f"spacing = {source.shown(spacing)}: a distance > 0 is needed")
    intervals = (bottom - top) / spacing
    if intervals > MAX_PLANES - 1:
        raise ValueError(
            f"{given}, spacing = {source.shown(spacing)}: a spacing of at least "
            f"{source.shown((bottom - top) / (MAX_PLANES - 1))} is needed, for at most {MAX_PLANES} planes"
        )
    return np.linspace(top, bottom, max(2, int(np.ceil(intervals - 1e-6)) + 1))


def box_below(
    source: Source,
    fields: Sequence[str],
    depth: Span,
    y: Span | None = None,
    x: Span | None = None,
    *,
    spacing: float | None = None,
    poisson: float | None = None,
    **body: Any,
) -> StressBox:
    """Fields of the stress in a box below a contact, on nodes of its grid and planes of equal distance.

    Parameters
    ----------
    source : Source
        The contact.
    fields : names
    depth, spacing
        As for `box_depths`.
    y, x : (first, last), optional
        Part of the cell.
    poisson
        As for `asperity.views.plot_section`.
    **body
        Arguments of `Source.loaded`.
    """
    solid, sliding = source.loaded(**body)
    rows, columns = ((float(nodes[0]), float(nodes[-1])) for nodes in source.positions(source.part(y, x)))
    depths = box_depths(source, depth, spacing)
    return stress_box(solid, depths, rows, columns, fields, poisson, tolerance=0.0, **sliding)


def write_box(
    box: StressBox,
    path: str | os.PathLike[str],
    units: ExportUnits,
    progress: Progress | None = None,
) -> int:
    """Write the fields of a box of one Poisson's ratio as VTK image data, and return the bytes of the file.

    Parameters
    ----------
    box : StressBox
        With equidistant depths.
    path : path
        Ends in ``.vti``.
    units : ExportUnits
        Its unit of stress is given in the unit of the pressure.
    progress : callable, optional
    """
    planes = ([plane[name][0] / units.stress for name in box.fields] for plane in box.planes(progress))
    axes = box.x / units.length, box.y / units.length, box.depth / units.length
    return _write_image(path, axes, [f"{name}_{units.stress_name}" for name in box.fields], planes)


def surface_fields(source: Source, part: Part) -> xr.Dataset:
    """Fields over a part of the surface in their exported units, which the names of all variables end in."""
    units = ExportUnits.of(source.system)
    y, x = (f"{axis}_{units.length_name}" for axis in "yx")
    fields = {}
    for name, values in source.fields.items():
        unit, word = (units.stress, units.stress_name) if name == "pressure" else units[::2]
        fields[f"{name}_{word}"] = ((y, x), values[part] / unit)
    along_y, along_x = source.positions(part)
    return xr.Dataset(fields, coords={y: along_y / units.length, x: along_x / units.length})


def write_surface_image(path: str | os.PathLike[str], fields: xr.Dataset) -> int:
    """Write fields over the surface as VTK image data of one layer of nodes; return its bytes."""
    y, x = (fields[name].values for name in fields.dims)
    plane = [values.values for values in fields.values()]
    return _write_image(path, (x, y, np.zeros(1)), [str(name) for name in fields], [plane])


def write_surface_table(path: str | os.PathLike[str], fields: xr.Dataset) -> int:
    """Write fields over the surface as CSV, a row for each node; return the number of rows.

    Columns: y and x, then the fields, each with its unit. A part of one row or column of nodes is a profile.
    """
    table = fields.to_dataframe()
    with atomic_write(path) as unfinished:
        table.to_csv(unfinished, float_format="%.7g", lineterminator="\n")
    return len(table)


def _write_image(
    path: str | os.PathLike[str],
    axes: tuple[Array, Array, Array],
    names: Sequence[str],
    planes: Iterable[Sequence[Array]],
) -> int:
    """Write VTK image data, plane by plane from the surface downward; return its bytes.

    `axes` are the positions x, y and depth of the nodes, `names` the names of the fields, and `planes` yields
    the fields [y, x] of each plane.
    """
    x, y, depth = axes
    plane_bytes = 4 * x.size * y.size
    field_bytes = plane_bytes * depth.size
    upward = x, y, 0.0 - depth[::-1]
    steps = [(nodes[-1] - nodes[0]) / (nodes.size - 1) if nodes.size > 1 else 1.0 for nodes in upward]
    arrays = [IMAGE_ARRAY.format(name, number * (8 + field_bytes)) for number, name in enumerate(names)]
    head = IMAGE_HEAD.format(
        extent=" ".join(f"0 {nodes.size - 1}" for nodes in upward),
        origin=" ".join(repr(float(nodes[0])) for nodes in upward),
        spacing=" ".join(repr(float(step)) for step in steps),
        first=names[0],
        arrays="".join(arrays),
    ).encode()
    begins = [len(head) + number * (8 + field_bytes) for number in range(len(names))]
    with atomic_write(path) as unfinished, open(unfinished, "wb") as file:
        file.write(head)
        for begin in begins:
            file.seek(begin)
            file.write(np.uint64(field_bytes).astype("<u8").tobytes())
        for number, fields in enumerate(planes):
            deeper = depth.size - 1 - number  # z rises upward, so that the deepest plane comes first
            for begin, values in zip(begins, fields, strict=True):
                file.seek(begin + 8 + deeper * plane_bytes)
                file.write(np.ascontiguousarray(values, "<f4").data)
        file.seek(begins[-1] + 8 + field_bytes)
        file.write(b"\n</AppendedData></VTKFile>\n")
        return file.tell()
