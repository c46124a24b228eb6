"""HDF5 and NetCDF files: limits that protect the reader, and maps over named axes with units."""

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from asperity.core.arguments import plane_axes, rising
from asperity.core.errors import shown
from asperity.fourier.grid import CELL_MIRRORED, grid_of
from asperity.surface.reading.agreement import SAME, FileContent, metres, require_size
from asperity.surface.reading.formats import UNNAMED, Channel, choose_channel
from asperity.surface.reading.height_map import LOWER_FACE, ORIENTATIONS, MapOptions

if TYPE_CHECKING:
    import xarray as xr

EQUAL_STEPS = 1e-3
"""Largest relative difference of the steps between equally spaced positions."""


def largest_chunk(file: BinaryIO) -> int:
    """Bytes of the largest chunk of an HDF5 file, which is unpacked as a whole for each of its numbers.

    Raises
    ------
    ValueError
        If the numbers of a dataset lie in other files.
    """
    import h5py

    sizes = [0]

    def look(name: str, node: Any) -> None:
        if isinstance(node, h5py.Dataset):
            if node.is_virtual or node.external:
                raise ValueError(
                    f"the numbers of its dataset {name} lie in other files; one with them is needed"
                )
            sizes.append(int(np.prod(node.chunks or (0,), dtype=float)) * node.dtype.itemsize)

    with h5py.File(file, "r") as opened:
        opened.visititems(look)
    return max(sizes)


def with_attributes(content: FileContent, attributes: Mapping[str, Any]) -> FileContent:
    """Heights of a dataset in HDF5 with unit, factor, offset and mark of missing data in its attributes."""
    found = {name.lower(): np.ravel(values)[0] for name, values in attributes.items() if np.size(values)}
    unit, factor = found.get("units", found.get("unit", "")), found.get("scale_factor")
    missing = [found[name] for name in ("_fillvalue", "missing_value", "no data") if name in found]
    height = np.where(np.isin(content.height, missing), np.nan, content.height)
    return content._replace(
        height=height * float(factor or 1.0) + float(found.get("add_offset", 0.0)),
        factor=factor and float(factor),
        unit=(unit.decode() if isinstance(unit, bytes) else str(unit)) or None,
    )


def netcdf_map(path: str, options: MapOptions) -> FileContent | None:
    """A map in a NetCDF file, over axes with the names of rows and columns; None if there is none.

    Rows and columns follow from the names of the axes and their positions, which have units of their own;
    axes of one point are dropped. A surface that asperity wrote states its orientation, and is one period.

    Raises
    ------
    ValueError
        If the positions are not equally spaced, the map is larger than accepted, or all variables have more
        than two axes.
    """
    import xarray as xr

    try:
        with warnings.catch_warnings(action="ignore"):  # of parts that are no arrays
            opened = xr.open_dataset(path, engine="netcdf4", decode_times=False)
    except (OSError, RuntimeError, ValueError, KeyError, AttributeError):
        return None
    with opened:
        if str(opened.attrs.get("source")).startswith("asperity ") and "height" not in opened:
            raise ValueError("a result of asperity without heights; the map or its surface.nc is needed")
        found = opened.squeeze()
        numeric = {
            str(name): values for name, values in found.data_vars.items() if values.dtype.kind in "fiu"
        }
        maps = [
            name
            for name, values in numeric.items()
            if values.ndim == 2 and min(values.shape) > 1 and plane_axes(values.dims)
        ]
        if "heights" in opened.variables:  # of SurfaceTopography, which reads it
            return None
        if not maps:
            for name, values in numeric.items():
                if values.ndim > 2:
                    axes = ", ".join(map(str, values.dims))
                    raise ValueError(f"its variable {name} lies over {axes}: a map over two axes is needed")
            return None
        channels = tuple(Channel(name, (found[name].shape[0], found[name].shape[1])) for name in maps)
        index, undecided = choose_channel(
            channels, options.channel, lambda number: found[maps[number]].values
        )
        chosen = found[maps[index]]
        require_size(8.0 * chosen.size, options.max_memory)
        content = map_over_axes(chosen.load())
    return content._replace(channel=maps[index], channels=channels, undecided=undecided)


def map_over_axes(values: "xr.DataArray") -> FileContent:
    """A map from an array over axes with the names of rows and columns.

    Raises
    ------
    ValueError
        If the axes have other names, or the positions along them are not equally spaced.
    """
    dims = getattr(values, "dims", ()) if hasattr(values, "dtype") else ()
    if len(dims) != 2 or not plane_axes(dims) or values.dtype.kind not in "fiu":
        found = shown(dims) if dims else type(values).__name__
        raise ValueError(f"{found}: a file, or a DataArray of real numbers over y and x, is needed")
    values = rising(values)
    default = LOWER_FACE if "lower face" in str(values.attrs.get("long_name")) else None
    orientation = str(values.attrs.get("orientation", default))
    is_own = orientation in ORIENTATIONS
    length, length_unit = _edges(values, is_own)
    return FileContent(
        height=values.values.astype(float),
        channel=str(values.name or UNNAMED),
        length=length,
        length_unit=length_unit,
        unit=_unit(values),
        periodic=is_own and not any(CELL_MIRRORED in axis.attrs for axis in values.coords.values()),
        orientation=orientation if is_own else None,
    )


def _edges(values: "xr.DataArray", is_own: bool) -> tuple[tuple[float, float] | None, str | None]:
    """Edges of a map, from the positions along its axes, and their unit if the heights have another.

    None if the positions are not there, or are numbers of points or degrees.
    """
    axes = [values[axis] for axis in values.dims if axis in values.coords]
    if len(axes) < 2:
        return None, None
    units = [_unit(axis) for axis in axes]
    if is_own and values.dims == ("y", "x"):
        edges = list(grid_of(values.to_dataset(name="height")).length)
    else:
        edges = []
        for axis in axes:
            place = axis.values.astype(float)
            step = (place[-1] - place[0]) / (place.size - 1)
            if not np.allclose(np.diff(place), step, rtol=EQUAL_STEPS, atol=0):
                raise ValueError(f"the positions {axis.name} are not equally spaced")
            edges.append(place.size * step)
    try:
        sizes = [metres(unit) for unit in units if unit is not None]
    except ValueError:  # degrees
        return None, None
    if len(sizes) == 2:
        return (edges[0] * sizes[0], edges[1] * sizes[1]), "m"
    if not is_own and edges == [axis.size for axis in axes]:  # numbers of points
        return None, None
    return (edges[0], edges[1]), SAME if is_own else None


def _unit(values: "xr.DataArray") -> str | None:
    """Unit of a variable; None without one, and of a result in lengths of its cell."""
    unit = str(values.attrs.get("units", values.attrs.get("unit", ""))).strip()
    return None if not unit or unit.startswith("cell") else unit
