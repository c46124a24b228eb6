"""Reading of height maps: every file format of the package SurfaceTopography, point lists, and own results.

Lengths are converted to metres if the file or the caller says their unit. What the caller says must not
contradict the file. Everything that is wrong or missing is reported at once, in one line.
"""

from __future__ import annotations

import math
import os
import tempfile
import warnings
from collections.abc import Iterable
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from asperity.errors import one_line, shown
from asperity.surface.height_map import (
    LOWER_FACE,
    ORIENTATIONS,
    PEAKS_UP,
    HeightMap,
    MapError,
    OptionName,
    metres,
    orientation_needed,
)
from asperity.surface.scattered import find_points, grid_points
from asperity.surface.unpacked_size import DEFAULT_LIMIT, check_size, gunzipped, require_size
from asperity.types import Array
from asperity.units import to_si

FEWEST_POINTS = 2
"""Smallest number of points along an edge of a map."""

LARGEST_HEIGHT = 1e6
"""Largest height of a map in units of its longer edge; a larger one is a wrong unit or a damaged file."""

ARRAY_FORMATS = ("npy", "npz", "h5", "mat")
"""Formats of bare arrays: element [i, j] is row i along y and column j along x, as everywhere in asperity."""

AGREEMENT = 1e-3
"""Relative difference up to which what the caller says is what the file says: one pixel of a map of 1000."""

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
class Inspected:
    """A file as far as it can be read.

    Parameters
    ----------
    map : HeightMap
        Its edges are numbers of pixels if they are not known.
    channels : list of Channel
    problems : list of str
        What is missing or contradicts the file; empty if the map can be used.
    """

    map: HeightMap
    channels: list[Channel]
    problems: list[str]


@dataclass(frozen=True)
class _Content:
    """What a file says: heights and edges in its own units, None where it says nothing."""

    height: Array
    length: tuple[float, float] | None
    unit: str | None
    factor: float | None = None
    periodic: bool = False
    orientation: str | None = PEAKS_UP
    channel: str = ""


def read_map(
    path: str | os.PathLike[str],
    physical_size: tuple[float | str, float | str] | None = None,
    height_factor: float | None = None,
    unit: str | None = None,
    channel: str | int | None = None,
    orientation: str | None = None,
    max_memory: float = DEFAULT_LIMIT,
) -> HeightMap:
    """Read a height map.

    Parameters
    ----------
    path : path
        In any format that SurfaceTopography reads, a text of three columns x, y, z on a regular grid, or a
        surface of asperity; also packed by gzip.
    physical_size, height_factor, unit, channel, orientation, max_memory
        As in `Reading`.

    Returns
    -------
    HeightMap
        In metres if the unit is known.

    Raises
    ------
    ImportError
        If SurfaceTopography is not installed.
    MapError
        If the file is not a rectangular height map, if it does not contain what is needed and no argument
        gives it, if an argument contradicts it, or if it unpacks to more than `max_memory`. The message names
        all of this at once.
    """
    given = Reading(physical_size, height_factor, unit, channel, orientation, max_memory)
    found = inspect_map(path, given)
    if found.problems:
        raise MapError(os.fspath(path), found.problems)
    return found.map


def inspect_map(
    path: str | os.PathLike[str], given: Reading | None = None, option: OptionName = str
) -> Inspected:
    """Read a height map as far as possible, and list what is missing.

    Parameters
    ----------
    path : path
    given : Reading, optional
    option : callable
        Gives the name of an argument in the interface of the user, for messages.

    Raises
    ------
    MapError
        If the file cannot be read as a height map.
    """
    given = given or Reading()
    name = os.fspath(path)
    if not os.path.isfile(path):
        raise MapError("", [f"file = {name!r}: no such file"])
    try:
        check_size(path, given.max_memory, option("max_memory"))
        with ExitStack() as stack:
            content, channels = _content(_unpacked(Path(path), stack), given, option)
    except MapError as error:
        raise MapError(name, error.problems) from error
    except ValueError as error:
        raise MapError(name, [_first_line(error)]) from error
    problems: list[str] = []
    found = _combined(content, given, option, problems)
    return Inspected(replace(found, name=name), channels, problems)


def _unpacked(path: Path, stack: ExitStack) -> Path:
    """The path, or that of a temporary file: of gzip files unpacked, of older SDF files with the newer name."""
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


def _content(path: Path, given: Reading, option: OptionName) -> tuple[_Content, list[Channel]]:
    """Heights and edges as the file says them, and its channels."""
    check_size(path, given.max_memory, option("max_memory"))
    if (own := _own_surface(path)) is not None:
        return own, [Channel("height", _shape(own.height), "height")]
    if (points := _point_list(path)) is not None:
        return points, [Channel("z", _shape(points.height), "height")]
    return _instrument_map(path, given, option)


def _own_surface(path: Path) -> _Content | None:
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
    return _Content(values, length, unit, periodic=True, orientation=said, channel="height")


def _point_list(path: Path) -> _Content | None:
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
    return _Content(height, length, unit, channel="z")


def _instrument_map(path: Path, given: Reading, option: OptionName) -> tuple[_Content, list[Channel]]:
    """A map in a format that SurfaceTopography reads."""
    try:
        from SurfaceTopography.IO import open_topography
    except ImportError as error:
        raise ImportError(
            "SurfaceTopography is needed to read measured maps: pip install SurfaceTopography"
        ) from error
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
    content = _Content(
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
        raise ValueError("no height map in the file")
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


def _combined(content: _Content, given: Reading, option: OptionName, problems: list[str]) -> HeightMap:
    """The map in metres, from what the file and the caller say; contradictions are added to `problems`."""
    factor = _height_factor(content, given, option("height_factor"), problems)
    unit, size_of_unit = _unit(content, given, option, problems)
    length = _length(content, given, size_of_unit, option, problems)
    if given.orientation is not None and given.orientation not in ORIENTATIONS:
        accepted = " or ".join(map(repr, ORIENTATIONS))
        problems.append(f"{option('orientation')} = {shown(given.orientation)}: {accepted} is needed")
    elif given.orientation is not None and content.orientation not in (None, given.orientation):
        if content.orientation == LOWER_FACE:
            problems.append(
                f"{option('orientation')} = {given.orientation!r}: the file holds the lower face of an "
                "indenter; leave it out"
            )
    elif given.orientation is None and content.orientation is None:
        problems.append(orientation_needed(option("orientation")))
    scale = size_of_unit if size_of_unit is not None else 1.0
    height = content.height if factor * scale == 1 else content.height * (factor * scale)
    known = length is not None
    edges = length or tuple(map(float, height.shape))
    if known and not all(math.isfinite(edge) and edge > 0 for edge in edges):
        problems.append(f"edges > 0 are needed, not {edges[0]:g} and {edges[1]:g}")
    finite = np.isfinite(height)
    if not finite.any():
        problems.append("no point of the map has data")
    elif known and np.abs(height).max(initial=0.0, where=finite) > LARGEST_HEIGHT * max(edges):
        problems.append(
            f"heights up to {LARGEST_HEIGHT:g} times the longer edge are accepted; set "
            f"{option('height_factor')} or correct the file"
        )
    return HeightMap(
        height=height,
        length=(float(edges[0]), float(edges[1])),
        periodic=content.periodic,
        orientation=given.orientation or content.orientation,
        unit=unit,
        channel=content.channel,
    )


def _height_factor(content: _Content, given: Reading, option: str, problems: list[str]) -> float:
    """Factor that the caller applies to the heights; the file's own is applied by its reader."""
    factor = given.height_factor
    if factor is None:
        return 1.0
    if not (isinstance(factor, (int, float)) and math.isfinite(factor) and factor > 0):
        problems.append(f"{option} = {shown(factor)}: a number > 0 is needed")
    elif content.factor is not None and not math.isclose(factor, content.factor, rel_tol=AGREEMENT):
        problems.append(f"{option} = {factor:g}: the file says {content.factor:g}; leave it out")
    elif content.factor is None and content.unit is not None and factor != 1:
        problems.append(f"{option} = {factor:g}: the file says heights in {content.unit}; leave it out")
    elif content.factor is None:
        return float(factor)
    return 1.0


def _unit(
    content: _Content, given: Reading, option: OptionName, problems: list[str]
) -> tuple[str | None, float | None]:
    """Unit of the heights and its size in metres, None if nobody says it."""
    sizes: list[float | None] = []
    for unit, source in ((content.unit, "unit of the file"), (given.unit, option("unit"))):
        try:
            sizes.append(None if unit is None else metres(unit, source))
        except ValueError as error:
            sizes.append(None)
            problems.append(str(error))
    own, said = sizes
    if own is not None and said is not None and not math.isclose(own, said, rel_tol=1e-9):
        problems.append(f"{option('unit')} = {given.unit!r}: the file says {content.unit}; leave it out")
    if own is not None:
        return content.unit, own
    return (given.unit, said) if said is not None else (None, None)


def _length(
    content: _Content, given: Reading, size_of_unit: float | None, option: OptionName, problems: list[str]
) -> tuple[float, float] | None:
    """Edges in metres, or in the unknown unit of the file; None if nobody says them."""
    scale = size_of_unit or 1.0
    own = None if content.length is None else (content.length[0] * scale, content.length[1] * scale)
    name = option("physical_size")
    if given.physical_size is None:
        if own is None:
            problems.append(f"the file does not say its edges; set {name}")
        return own
    said: list[float] = []
    for edge in given.physical_size:
        if not isinstance(edge, str):
            said.append(float(edge) * scale)
            continue
        if size_of_unit is None:
            problems.append(f"{option('unit')}: the file does not say the unit of its heights; set it")
            return own
        try:
            said.append(to_si(edge, "length", name))
        except ValueError as error:
            problems.append(str(error))
            return own
    if len(said) != 2 or not all(math.isfinite(edge) and edge > 0 for edge in said):
        problems.append(f"{name} = {shown(given.physical_size)}: two lengths > 0 (y, x) are needed")
        return own
    if own is None:
        return said[0], said[1]
    if not np.allclose(said, own, rtol=AGREEMENT, atol=0):
        unit = f" {content.unit}" if content.unit else ""
        size = " x ".join(f"{edge / scale:.6g}" for edge in own)
        problems.append(f"{name}: the file itself says {size}{unit} (y, x); leave it out")
    return own


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
