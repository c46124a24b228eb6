"""Contents of the files of height maps: heights, edges and units as a file says them, and nothing more.

Text of three columns, arrays of numpy and surfaces of asperity are read here, all other formats by the
package SurfaceTopography.
"""

from __future__ import annotations

import math
import os
import tempfile
import warnings
from collections.abc import Iterable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity.errors import one_line, shown
from asperity.packages import require
from asperity.surface.height_map import LOWER_FACE, ORIENTATIONS, PEAKS_UP, MapError, OptionName, metres
from asperity.surface.scattered import find_points, grid_points
from asperity.surface.unpacked_size import DEFAULT_LIMIT, check_size, gunzipped, require_size
from asperity.types import Array

FEWEST_POINTS = 2
"""Smallest number of points along an edge of a map."""

ARRAY_FORMATS = ("npy", "npz", "h5", "mat")
"""Formats of bare arrays: element [i, j] is row i along y and column j along x, as everywhere in asperity."""

# SDF files of before ISO 25178-71, which SurfaceTopography does not know; only their first line is different.
_OLDER_SDF = {b"aBCR-1.0": b"aISO-1.0", b"bBCR-1.0": b"bISO-1.0"}

_FEW_COLUMNS, _ELONGATED = 8, 20
"""A table without edges that has no more columns than this, and this many times more rows, is no map."""


@dataclass(frozen=True)
class Reading:
    """What the caller says about a file.

    Parameters
    ----------
    physical_size : (length_y, length_x), optional
        Edges of the map, for files that do not contain them: numbers in the unit of the heights, or texts
        with a unit such as ``"512 um"``.
    height_factor : float, optional
        Factor from the numbers in the file to heights, for files that do not contain it.
    unit : str, optional
        Unit of the heights, and of edges given as numbers, for files that do not contain it.
    channel : str or int, optional
        Name or number of the channel; the default is that of the file format.
    orientation : "peaks up" or "lower face", optional
        Meaning of the heights, for files that do not say it.
    max_memory : float
        Largest size of the unpacked file in GiB.

    Examples
    --------
    For an array of numpy, which says neither size nor unit nor which way is up:

    >>> asp.Reading(physical_size=("80 um", "80 um"), unit="nm", orientation="peaks up").unit
    'nm'
    """

    physical_size: tuple[float | str, float | str] | None = None
    height_factor: float | None = None
    unit: str | None = None
    channel: str | int | None = None
    orientation: str | None = None
    max_memory: float = DEFAULT_LIMIT


@dataclass(frozen=True)
class Channel:
    """A channel of a file.

    Parameters
    ----------
    name : str
    shape : (ny, nx), optional
        None for line scans and lists of points.
    kind : str
        Kind of its data, such as ``height`` or ``phase``.
    """

    name: str
    shape: tuple[int, int] | None
    kind: str


@dataclass(frozen=True)
class FileContent:
    """What a file says; None where it says nothing.

    Parameters
    ----------
    height : (ny, nx) array
        In `unit`; NaN where there are no data.
    length : (length_y, length_x), optional
        Edges in `unit`.
    unit : str, optional
        Unit of length.
    factor : float, optional
        Factor from the numbers in the file to `height`.
    periodic : bool
    orientation : "peaks up", "lower face" or None
    channel : str
    """

    height: Array
    length: tuple[float, float] | None
    unit: str | None
    factor: float | None = None
    periodic: bool = False
    orientation: str | None = PEAKS_UP
    channel: str = ""


def read_content(
    path: str | os.PathLike[str], given: Reading, option: OptionName
) -> tuple[FileContent, list[Channel]]:
    """Heights and edges as a file says them, and its channels.

    Raises
    ------
    MapError
        If the file cannot be read as a height map; the message begins with its name.
    """
    name = os.fspath(path)
    if not os.path.isfile(path):
        what = "a folder, a file is needed" if os.path.isdir(path) else "no such file"
        raise MapError(name, [what])
    try:
        check_size(path, given.max_memory, option("max_memory"))
        with ExitStack() as stack:
            return _content(_unpacked(Path(path), stack), given, option)
    except ValueError as error:
        raise MapError(name, [_first_line(error)]) from error


def _unpacked(path: Path, stack: ExitStack) -> Path:
    """The path, or that of a temporary file: gzip files unpacked, older SDF files with the newer name."""
    with open(path, "rb") as file:
        start = file.read(8)
        content: Iterable[bytes]
        if start[:2] == b"\x1f\x8b":
            file.seek(0)
            content, name = gunzipped(file, math.inf), path.stem or "map"
        elif start in _OLDER_SDF:
            content, name = iter((_OLDER_SDF[start], file.read())), path.name
        else:
            return path
        written = Path(stack.enter_context(tempfile.TemporaryDirectory())) / name
        with open(written, "wb") as whole:
            whole.writelines(content)
    return written


def _content(path: Path, given: Reading, option: OptionName) -> tuple[FileContent, list[Channel]]:
    """Heights and edges as the file says them, and its channels."""
    check_size(path, given.max_memory, option("max_memory"))
    if (own := _own_surface(path)) is not None:
        return own, [Channel("height", _shape(own.height), "height")]
    if (array := _numpy_array(path, given)) is not None:
        return array, [Channel("array", _shape(array.height), "height")]
    if (points := _point_list(path)) is not None:
        return points, [Channel("z", _shape(points.height), "height")]
    return _instrument_map(path, given, option)


def _own_surface(path: Path) -> FileContent | None:
    """A surface that asperity wrote: variable ``height`` over ``y`` and ``x`` that says its orientation."""
    with open(path, "rb") as file:
        if file.read(4) != b"\x89HDF":
            return None
    import xarray as xr

    try:
        with xr.open_dataset(path, engine="netcdf4") as opened:
            height = opened["height"]
            if height.dims != ("y", "x") or not {"x", "y"} <= set(opened.coords) or min(height.shape) < 2:
                return None
            said = height.attrs.get("orientation")
            if said is None and "lower face" in height.attrs.get("long_name", ""):
                said = LOWER_FACE
            if said not in ORIENTATIONS:
                return None
            units = height.attrs.get("units", "")
            steps = [float(opened[axis][1] - opened[axis][0]) for axis in ("y", "x")]
            length = height.shape[0] * steps[0], height.shape[1] * steps[1]
            values = np.asarray(height.values, dtype=float)
    except (OSError, RuntimeError, ValueError, KeyError, IndexError, AttributeError):
        return None
    unit = None if units.startswith("cell") or not units else units
    return FileContent(values, length, unit, periodic=True, orientation=said, channel="height")


def _numpy_array(path: Path, given: Reading) -> FileContent | None:
    """The array in an NPY file, None for other files."""
    with open(path, "rb") as file:
        if file.read(6) != b"\x93NUMPY":
            return None
    try:
        values = np.load(path, allow_pickle=False)
    except (ValueError, EOFError, OSError) as error:
        raise ValueError(f"not a height map that can be read ({_first_line(error)})") from error
    if values.ndim != 2 or values.dtype.kind not in "iuf":
        raise ValueError(
            f"an array of two dimensions with real numbers is needed, not {values.ndim} of {values.dtype}"
        )
    _require_map(values, True, given)
    return FileContent(values.astype(float), None, None, orientation=None, channel="array")


def _point_list(path: Path) -> FileContent | None:
    """A map given as text with three columns x, y and z."""
    table = find_points(path)
    if table is None:
        return None
    try:
        height, length = grid_points(table.points())
    except ValueError as error:
        raise ValueError(
            f"three columns of numbers that are no points x, y, z on a regular grid ({_first_line(error)})"
        ) from error
    unit = table.height_unit or table.lateral_unit
    if table.lateral_unit and table.height_unit:
        factor = metres(table.lateral_unit) / metres(table.height_unit)
        length = length[0] * factor, length[1] * factor
    return FileContent(height, length, unit, channel="z")


def _instrument_map(path: Path, given: Reading, option: OptionName) -> tuple[FileContent, list[Channel]]:
    """A map in a format that SurfaceTopography reads."""
    require(("SurfaceTopography",))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from SurfaceTopography.IO import open_topography
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            reader = open_topography(os.fspath(path))
        except Exception as error:  # readers of many formats raise errors of any type for damaged files
            raise ValueError(f"not a height map that can be read ({_reason(error)})") from error
        with reader:
            infos = reader.channels
            by_rows = reader.format() in ARRAY_FORMATS
            channels = [_channel(info, by_rows) for info in infos]
            index = _channel_index(channels, given.channel, reader, option("channel"))
            info = infos[index]
            if _grid_shape(info) is None or info.is_uniform is False:
                raise ValueError("a rectangular map is needed, not a line scan or scattered points")
            require_size(8.0 * math.prod(info.nb_grid_pts), given.max_memory, option("max_memory"))
            sizes = info.physical_sizes
            known = sizes is not None and len(sizes) == 2 and all(size is not None for size in sizes)
            missing = {} if known else {"physical_sizes": tuple(map(float, info.nb_grid_pts))}
            try:
                read = reader.topography(channel_index=index, **missing)
                height: Array = np.ma.filled(np.ma.asarray(read.heights(), dtype=float), np.nan)
            except Exception as error:
                raise ValueError(f"not a height map that can be read ({_reason(error)})") from error
    bare = by_rows or (reader.format() == "asc" and not known and read.unit is None)
    if not by_rows:
        height = height.T
    _require_map(height, bare, given)
    content = FileContent(
        height=np.ascontiguousarray(height),
        length=(float(sizes[1]), float(sizes[0])) if known else None,
        unit=read.unit,
        factor=info.height_scale_factor,
        periodic=bool(read.is_periodic),
        orientation=None if bare else PEAKS_UP,
        channel=info.name,
    )
    return content, channels


def _channel_index(channels: list[Channel], wanted: str | int | None, reader: Any, option: str) -> int:
    """Number of the wanted channel; without a wish, that of the default channel of the format."""
    if not channels:
        raise ValueError("not a height map that can be read (the file holds none)")
    if wanted is None:
        default = int(reader.default_channel.index)
        heights = [number for number, channel in enumerate(channels) if channel.kind == "height"]
        return default if default in heights or not heights else heights[0]
    names = [channel.name for channel in channels]
    if names.count(str(wanted)) == 1:
        return names.index(str(wanted))
    if str(wanted).isdecimal() and int(wanted) < len(names):
        return int(wanted)
    known = ", ".join(f"{number} ({one_line(name)})" for number, name in enumerate(names))
    raise ValueError(f"{option} = {shown(wanted)}: one of {known} is needed")


def _require_map(height: Array, bare: bool, given: Reading) -> None:
    """Raise `ValueError` for too few points, and for a bare table that looks like a list."""
    rows, columns = height.shape
    if min(rows, columns) < FEWEST_POINTS:
        raise ValueError(
            f"at least {FEWEST_POINTS} x {FEWEST_POINTS} points are needed, not {rows} x {columns}"
        )
    narrow = columns <= _FEW_COLUMNS and rows >= _ELONGATED * columns
    if bare and narrow and (columns == 3 or given.physical_size is None):
        raise ValueError(
            f"a table of {rows} x {columns} numbers is a list of points or a log, not a map; a matrix of "
            "heights, or text with columns x, y, z on a regular grid, is needed"
        )


def _grid_shape(info: Any) -> tuple[int, int] | None:
    """Shape (ny, nx) of a channel, None if it is not a rectangular map."""
    points = info.nb_grid_pts
    if info.dim != 2 or points is None or len(points) != 2:
        return None
    return points[1], points[0]


def _channel(info: Any, by_rows: bool) -> Channel:
    shape = _grid_shape(info)
    if shape is not None and by_rows:
        shape = shape[::-1]
    return Channel(info.name, shape, info.data_kind.value)


def _shape(height: Array) -> tuple[int, int]:
    return height.shape[0], height.shape[1]


def _reason(error: Exception) -> str:
    """First line of an error of SurfaceTopography; without the list of readers that it has tried."""
    reason = _first_line(error)
    return "no known format" if reason.startswith("tried ") else reason


def _first_line(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__
