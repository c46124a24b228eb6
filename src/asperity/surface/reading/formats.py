"""Contents of the files of height maps: heights, edges and units as a file says them, and nothing more.

Text of three columns and surfaces of asperity are read here, all other formats by the package
SurfaceTopography.
"""

from __future__ import annotations

import gzip
import io
import math
import os
import stat
import warnings
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np

from asperity.core.errors import one_line, shown
from asperity.core.packages import require
from asperity.core.types import Array
from asperity.fourier.grid import grid_of
from asperity.surface.reading.height_map import (
    LOWER_FACE,
    ORIENTATIONS,
    PEAKS_UP,
    MapError,
    MapOptions,
    metres,
)
from asperity.surface.reading.points import find_points, grid_points, has_numbers, require_numbers

ARRAY_FORMATS = ("npy", "npz", "h5", "mat")
"""Formats of bare arrays: element [i, j] is row i along y and column j along x, as everywhere in asperity."""

WITHOUT_SIGNATURE = ("hgt",)
"""Formats in which any file of a suitable size could be read: they have to be asked for."""

TEXT_FORMATS = ("asc", "xyz")
"""Formats of text, which are not tried for other content: their readers search all of it for numbers."""

BLOCK = 2**16
"""Bytes at the begin of a file that tell text from other content."""

FEW_COLUMNS, ELONGATED = 8, 20
"""A table without edges that has no more columns than this, and this many times more rows, is no map."""

GIB = 2**30

_HDF5 = b"\x89HDF"

# SDF files of before ISO 25178-71, which SurfaceTopography does not know; only their first line is different.
_OLDER_SDF = {b"aBCR-1.0": b"aISO-1.0", b"bBCR-1.0": b"bISO-1.0"}


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
    kind: str = "height"


@dataclass(frozen=True)
class FileContent:
    """What a file says; None where it says nothing.

    Parameters
    ----------
    height : (ny, nx) array
        In `unit`; NaN where there are no data.
    channels : tuple of Channel
    channel : str
        The one that the heights are of.
    length : (length_y, length_x), optional
        Edges in `unit`.
    unit : str, optional
        Unit of length.
    factor : float, optional
        Factor from the numbers in the file to `height`.
    periodic : bool
    orientation : "peaks up", "lower face" or None
    """

    height: Array
    channels: tuple[Channel, ...]
    channel: str
    length: tuple[float, float] | None = None
    unit: str | None = None
    factor: float | None = None
    periodic: bool = False
    orientation: str | None = PEAKS_UP


def read_content(path: str | os.PathLike[str], options: MapOptions) -> FileContent:
    """Heights and edges as a file says them, and its channels.

    Raises
    ------
    MapError
        If the file cannot be read as a height map; the message begins with its name.
    """
    name = os.fspath(path)
    if problem := path_problem(path):
        raise MapError(name, [problem])
    try:
        if surface := _own_surface(path):
            return surface
        with _opened(path, options.max_memory) as file:
            text = None if options.format else _text(file)
            if text is not None and (table := find_points(text)):
                _require_agreement(name, "xyz")
                return _points(table)
            file.seek(0)
            by_name = file.read(4) == _HDF5  # whose reader may keep a file open for a while
            file.seek(0)
            return _instrument_map(name, None if by_name else file, text, options)
    except ValueError as error:
        raise MapError(name, [_first_line(error)]) from error


def path_problem(path: str | os.PathLike[str]) -> str:
    """Reason why a path is not that of a file with a map, empty if it may be."""
    try:
        mode = os.stat(path).st_mode
    except (OSError, ValueError):  # also for names that are too long, or with a null character
        return "no such file"
    if stat.S_ISDIR(mode):
        return "a folder, a file is needed"
    return "" if stat.S_ISREG(mode) else "not a regular file"


@contextmanager
def _opened(path: str | os.PathLike[str], limit: float) -> Iterator[BinaryIO]:
    """The file, or the content of a gzip file or of an older SDF file; refused above the limit in GiB."""
    with open(path, "rb") as plain:
        file: BinaryIO = plain
        start, size = plain.read(8), os.path.getsize(path)
        try:
            if start.startswith(b"\x1f\x8b"):
                with gzip.open(path) as packed:
                    content = packed.read(int(limit * GIB) + 1)
                file, size = io.BytesIO(content), len(content)
            elif start in _OLDER_SDF:
                file = io.BytesIO(_OLDER_SDF[start] + plain.read())
            if zipfile.is_zipfile(file):
                with zipfile.ZipFile(file) as archive:
                    size = sum(member.file_size for member in archive.infolist())
        except (OSError, EOFError, zlib.error, zipfile.BadZipFile) as error:
            raise ValueError(f"an archive without damage is needed ({error})") from error
        _require_size(size, limit)
        file.seek(0)
        yield file


def _require_size(size: float, limit: float) -> None:
    if size > limit * GIB:
        raise ValueError(
            f"max_memory = {limit:g} GiB: the file holds {size / GIB:.3g} GiB of data or more when it is "
            "unpacked; set it to more if that is right"
        )


def _text(file: BinaryIO) -> str | None:
    """The text of a file, None if its first block is no text or has no line of numbers."""
    start = file.read(BLOCK)
    is_utf_16 = start.startswith((b"\xff\xfe", b"\xfe\xff"))
    if b"\0" in start and not is_utf_16:
        return None
    if not has_numbers(start.decode("utf-16" if is_utf_16 else "utf-8", errors="replace")):
        return None
    content = start + file.read()
    if is_utf_16:
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _own_surface(path: str | os.PathLike[str]) -> FileContent | None:
    """A surface that asperity wrote: variable ``height`` over ``y`` and ``x`` that says its orientation."""
    with open(path, "rb") as file:
        if file.read(4) != _HDF5:
            return None
    import xarray as xr

    try:
        with xr.open_dataset(path, engine="netcdf4") as opened:
            height = opened["height"]
            orientation = height.attrs.get("orientation")
            if orientation is None and "lower face" in height.attrs.get("long_name", ""):
                orientation = LOWER_FACE
            is_surface = height.dims == ("y", "x") and {"y", "x"} <= set(height.coords)
            if orientation not in ORIENTATIONS or not is_surface or min(height.shape) < 2:
                return None
            surface = opened[["height"]].load()
    except (OSError, RuntimeError, ValueError, KeyError, AttributeError):
        return None
    units = height.attrs.get("units", "")
    return FileContent(
        height=np.asarray(surface["height"].values, dtype=float),
        channels=(Channel("height", (height.shape[0], height.shape[1])),),
        channel="height",
        length=grid_of(surface).length,
        unit=None if units.startswith("cell") or not units else units,
        periodic=True,
        orientation=orientation,
    )


def _points(table: Any) -> FileContent:
    """A map given as text with three columns x, y and z."""
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
    return FileContent(height, (Channel("z", height.shape),), "z", length, unit)


def _reader(name: str, file: BinaryIO | None, is_text: bool, format: str | None) -> Any:
    """The reader of SurfaceTopography for a file, by its name if it is not open."""
    from SurfaceTopography.IO import lookup_reader_by_format as readers
    from SurfaceTopography.IO.Reader import MagicMatch

    if format is not None and format not in readers:
        raise ValueError(f"format = {shown(format)}: one of {', '.join(sorted(readers))} is needed")
    begin = file.read(BLOCK) if file else b""
    skipped = WITHOUT_SIGNATURE if is_text else (*WITHOUT_SIGNATURE, *TEXT_FORMATS)
    reason = f"no known format; one of {', '.join(WITHOUT_SIGNATURE)} needs its format to be set"
    for found in [format] if format else readers:
        if format is None and (found in skipped or readers[found].can_read(begin) is MagicMatch.NO):
            continue
        try:
            if file:
                file.seek(0)
            return readers[found](file or name)
        except Exception as error:  # readers of many formats raise errors of any type for other files
            reason = _first_line(error) if format else reason
    raise ValueError(f"not a height map that can be read ({reason})")


def _require_agreement(name: str, found: str) -> None:
    """Raise `ValueError` if the extension of a file is that of other formats than its content."""
    from SurfaceTopography.IO import lookup_reader_by_format as readers

    extension = os.path.splitext(name.lower().removesuffix(".gz"))[1].removeprefix(".")
    named = [known for known, reader in readers.items() if extension in reader.file_extensions()]
    both_text = found in TEXT_FORMATS and not {*named}.isdisjoint(TEXT_FORMATS)
    if named and found not in named and not both_text:
        raise ValueError(
            f"its name is that of format {' or '.join(named)}, its content of {found}; rename it, or set "
            f"format to {found}"
        )


def _instrument_map(name: str, file: BinaryIO | None, text: str | None, options: MapOptions) -> FileContent:
    """A map in a format that SurfaceTopography reads."""
    require(("SurfaceTopography",))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with _reader(name, file, text is not None, options.format) as reader:
            found = reader.format()
            if found == "asc" and text is not None:
                require_numbers(text)
            infos = reader.channels
            by_rows = found in ARRAY_FORMATS
            channels = tuple(_channel(info, by_rows) for info in infos)
            index = _channel_index(channels, options.channel, reader)
            info = infos[index]
            shape = channels[index].shape
            if shape is None or info.is_uniform is False:
                raise ValueError("a rectangular map is needed, not a line scan or scattered points")
            _require_size(8.0 * math.prod(shape), options.max_memory)
            sizes = info.physical_sizes
            known_size = sizes is not None and len(sizes) == 2 and all(size is not None for size in sizes)
            assumed = {} if known_size else {"physical_sizes": tuple(map(float, info.nb_grid_pts))}
            try:
                topography = reader.topography(channel_index=index, **assumed)
                height: Array = np.ma.filled(np.ma.asarray(topography.heights(), dtype=float), np.nan)
            except Exception as error:
                raise ValueError(f"not a height map that can be read ({_first_line(error)})") from error
    if options.format is None:
        _require_agreement(name, found)
    bare = by_rows or (found == "asc" and not known_size and topography.unit is None)
    height = np.ascontiguousarray(height if by_rows else height.T)
    _require_map(height.shape, bare, options)
    return FileContent(
        height=height,
        channels=channels,
        channel=info.name,
        length=(float(sizes[1]), float(sizes[0])) if known_size else None,
        unit=topography.unit,
        factor=info.height_scale_factor,
        periodic=bool(topography.is_periodic),
        orientation=None if bare else PEAKS_UP,
    )


def _channel(info: Any, by_rows: bool) -> Channel:
    points = info.nb_grid_pts
    shape = None
    if info.dim == 2 and points is not None and len(points) == 2:
        shape = (points[0], points[1]) if by_rows else (points[1], points[0])
    return Channel(info.name, shape, info.data_kind.value)


def _channel_index(channels: tuple[Channel, ...], wanted: str | int | None, reader: Any) -> int:
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
    raise ValueError(f"channel = {shown(wanted)}: one of {known} is needed")


def _require_map(shape: tuple[int, ...], bare: bool, options: MapOptions) -> None:
    """Raise `ValueError` for too few points, and for a bare table that looks like a list."""
    rows, columns = shape
    if min(shape) < 2:
        raise ValueError(f"at least 2 x 2 points are needed, not {rows} x {columns}")
    narrow = columns <= FEW_COLUMNS and rows >= ELONGATED * columns
    if bare and narrow and (columns == 3 or options.physical_size is None):
        raise ValueError(
            f"a table of {rows} x {columns} numbers is a list of points or a log, not a map; a matrix of "
            "heights, or text with columns x, y, z on a regular grid, is needed"
        )


def _first_line(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__
