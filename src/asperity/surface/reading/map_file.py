"""Reading of height maps: heights, edges and units as a file says them, combined with the options.

Text, arrays of NumPy, pictures and surfaces of asperity are read here, files of instruments by the package
SurfaceTopography.
"""

import gzip
import io
import logging
import math
import os
import re
import sys
import warnings
import zipfile
import zlib
from collections.abc import Iterator, Set
from contextlib import contextmanager, suppress
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any, BinaryIO

import numpy as np

from asperity.core.arguments import own_errors
from asperity.core.packages import require
from asperity.core.types import Array, FilePath
from asperity.settings.map import MapOptions
from asperity.surface.reading import dialects, formats, hierarchical
from asperity.surface.reading.agreement import (
    GIB,
    SAME,
    FileContent,
    MapFile,
    edges_in_one_unit,
    require_size,
)
from asperity.surface.reading.formats import PROFILE, TEXT_FORMATS, UNNAMED, Channel, Format, choose_channel
from asperity.surface.reading.grids import read_grid, read_x3p, tiff_scale
from asperity.surface.reading.heading import height_unit, stated_pixel, zygo_units
from asperity.surface.reading.height_map import PEAKS_UP, HeightMap, MapError
from asperity.surface.reading.number_table import (
    MATRIX_HEADER,
    NumberTable,
    find_dialect,
    grid_points,
    nodes,
    refuse_repeated,
)

ROW_BY_ROW = ("h5", "mat")
"""Bare arrays of SurfaceTopography: element [i, j] is row i along y and column j along x."""

PROFILE_LINES = 4
"""Number of equal lines in the map made from a line scan, which does not vary along y."""

FEW_COLUMNS, ELONGATED = 8, 20
"""A table without edges that has no more columns than this, and this many times more rows, is no map."""

_NOT_IN_FILE = re.compile(r"(channel|missing|mask) = .*(; leave it out|: one of .* is needed)$")
"""Messages about an option that does not suit the file."""

_VOID = re.compile(r"voidpixels\s*=\s*[1-9]", re.IGNORECASE)
"""Line of SPIP: a matrix of zeros, of non-measured points, and ones follows the heights."""

LONGEST_LINE = 900_000
"""Largest number of bytes in a line of text: a row of 65536 heights has about twelve characters for each."""

HDF5 = b"\x89HDF\r\n\x1a\n"
"""First bytes of a file in HDF5, and in NetCDF-4."""

LINE_SCAN = "a rectangular map is needed, not a line scan"
DECLARED = "set format to profile to take it as a map with the same heights for all y"

UNREADABLE = "not a height map that can be read"

logging.getLogger("tifffile").addHandler(logging.NullHandler())  # of damaged files, which are refused


@own_errors
def read_map(path: FilePath | Any, options: MapOptions | None = None, **given: Any) -> HeightMap:
    """Read a height map.

    Parameters
    ----------
    path : path or DataArray
        In one of the formats that docs/formats.md lists, also packed by gzip; or a map over axes y and x.
    options : MapOptions, optional
        Properties of the map that its file does not state; options of the treatment are not used.
    **given
        Fields of `MapOptions`, which override `options`.

    Returns
    -------
    HeightMap
        In metres if the unit is known.

    Raises
    ------
    ImportError
        If SurfaceTopography is not installed, for files of instruments.
    SettingsError
        If an option is unknown or out of range.
    MapError
        If the file is not a rectangular height map, if it does not contain what is needed and no option
        gives it, or if it unpacks to more than `max_memory`. The message names all of this at once.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "map.npy"
    ...     np.save(path, np.random.default_rng(1).normal(size=(40, 60)))
    ...     said = {"unit": "nm", "orientation": "peaks up"}
    ...     surface = asp.read_map(path, physical_size=("80 um", "120 um"), **said)
    >>> surface.height.shape, [round(edge, 9) for edge in surface.length], surface.periodic
    ((40, 60), [8e-05, 0.00012], False)
    """
    found = open_map(path, (options or MapOptions()).replaced(**given))
    if found.problems:
        raise MapError(found.map.name, found.problems)
    return found.map


def open_map(path: FilePath | Any, options: MapOptions) -> MapFile:
    """Read a height map as far as possible, and list missing properties.

    Raises
    ------
    MapError
        If the file cannot be read as a height map; the message begins with its name.
    """
    if not isinstance(path, (str, os.PathLike)):
        return MapFile(hierarchical.map_over_axes(path), "map", options)
    name = os.fspath(path)
    if problem := path_problem(path):
        raise MapError(name, [problem])
    try:
        with open(path, "rb") as file:
            content = _read(file, name, options)
    except (OSError, EOFError, RuntimeError, zlib.error, zipfile.BadZipFile) as error:
        raise MapError(name, [f"a file without damage is needed ({_first_line(error)})"]) from error
    except ValueError as error:
        raise MapError(name, [_first_line(error)]) from error
    return MapFile(content, name, options)


def open_shared_map(path: FilePath, options: MapOptions, shared: Set[str]) -> MapFile:
    """Read one of several maps that share some options; statements of this file override them."""
    found, said = None, set[str]()
    try:
        found = open_map(path, options)
        problems, said = tuple(found.problems), found.overridden
    except MapError as error:
        problems = error.problems
    said |= {match[1] for text in problems if (match := _NOT_IN_FILE.match(text))}
    said &= shared
    if not said:
        return found or open_map(path, options)  # which raises its error
    left_out: dict[str, Any] = dict.fromkeys(said)
    return open_shared_map(path, options.replaced(**left_out), shared - said)


def path_problem(path: FilePath) -> str:
    """Reason why a path does not lead to a file with a map, empty if it may."""
    if re.search("[\ud800-\udfff]", os.fspath(path)):  # reports and results name it
        return "its name is not UTF-8; rename it"
    if not os.path.exists(path):  # also of names that are too long, or with a null character
        return "no such file"
    if os.path.isdir(path):
        return "a folder, a file is needed"
    return "" if os.path.isfile(path) else "not a regular file"


def _read(plain: BinaryIO, name: str, options: MapOptions) -> FileContent:
    """The content of a file, or of a gzip file, in the first of its possible formats that can read it."""
    is_packed = plain.read(2) == b"\x1f\x8b"
    plain.seek(0)
    file: Any = gzip.GzipFile(fileobj=plain) if is_packed else plain
    begin = file.read(formats.BLOCK)
    if options.format is None and (look := formats.unread_look(begin)):
        raise ValueError(f"{UNREADABLE}: it looks like {look}")
    is_profile = options.format == PROFILE
    possible = formats.possible_formats(begin, file, name, None if is_profile else options.format)
    is_text = bool(possible) and possible[0].name in TEXT_FORMATS
    if is_text and max(map(len, re.split(rb"[\r\n]", begin))) > LONGEST_LINE:
        raise ValueError(
            f"{UNREADABLE}: a line of text has more than {LONGEST_LINE:,} characters; a table has one a row"
        )
    dialect = find_dialect(_text(begin)) if is_text else None
    if not possible or (is_text and dialect is None):
        raise ValueError(
            f"{UNREADABLE}: it looks like {formats.look_of(begin)}; known are {formats.known_extensions()}"
        )
    file.seek(0)
    size = os.path.getsize(name)
    if is_packed:
        file = io.BytesIO(file.read(int(options.max_memory * GIB) + 1))
        size = file.getbuffer().nbytes
    if zipfile.is_zipfile(file):
        with zipfile.ZipFile(file) as archive:
            size = sum(member.file_size for member in archive.infolist())
    require_size(size, options.max_memory)
    file.seek(0)
    if dialect is not None:
        form, content = _table_map(NumberTable(_text(file.read()), dialect), options)
    else:
        form, content = _first_readable(possible, file, name, options)
    if is_profile:  # equal lines with square pixels
        height, length = content.height, content.length
        if min(height.shape) > 1:
            raise ValueError(f"format = 'profile': a line scan is needed, not a map of {height.shape} points")
        if length is not None:
            length = PROFILE_LINES * max(length) / height.size, max(length)
        content = content._replace(height=np.tile(content.height.ravel(), (PROFILE_LINES, 1)), length=length)
    elif min(content.height.shape) < 2:
        raise ValueError(f"{LINE_SCAN} of {content.height.size} points; {DECLARED}")
    if content.length is not None and not min(content.length) > 0:  # such as an unknown scan size
        content = content._replace(length=None)
    if not content.channels:
        choose_channel([Channel(content.channel, None)], options.channel)
    rows, columns = content.height.shape
    is_list = content.orientation is None and columns <= FEW_COLUMNS and rows >= ELONGATED * columns
    if is_list and (columns == 3 or options.physical_size is None or _are_points(content.height)):
        raise ValueError(
            f"a table of {rows} x {columns} numbers is a list of points or a log, not a map; a matrix of "
            "heights, or text with columns x, y, z on a regular grid, is needed"
        )
    if options.format is None:
        formats.require_agreement(name, form)
    return content


def _text(content: bytes) -> str:
    """Text in UTF-16, UTF-8 or Latin-1; its last character may be cut off."""
    if content.startswith(formats.BYTE_ORDER_MARKS):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


class _OtherFormatError(ValueError):
    """Raised for a file in another format than the one that is tried."""


def _first_readable(
    possible: list[Format], file: BinaryIO, name: str, options: MapOptions
) -> tuple[Format, FileContent]:
    """The first of the possible formats in which a file can be read, and its content."""
    reasons = []
    if any(
        file.seek(offset) == offset and file.read(8) == HDF5 for offset in (0, 512)
    ):  # 512 in files of MATLAB
        require(("h5py",))
        require_size(hierarchical.largest_chunk(file), options.max_memory)
    for form in possible:
        file.seek(0)
        if form.name in ("npy", "npz"):
            return form, _array(file, options)
        if form.name in ("png", "tiff"):
            return form, _picture(form, file, options)
        if form.name == "x3p":
            return form, read_x3p(file)
        if form.name in ("esri", "surfer", "gsf"):
            return form, read_grid(form.name, file)
        if form.name == "nc" and (found := hierarchical.netcdf_map(name, options)):
            return form, found
        try:
            return form, _instrument_map(form, file, options)
        except _OtherFormatError as error:
            reasons.append(str(error))
    raise ValueError(f"{UNREADABLE} ({reasons[0]})")


def _table_map(table: NumberTable, options: MapOptions) -> tuple[Format, FileContent]:
    """Content of a table, and its format: a matrix of heights, points, or a line scan."""
    matrix, points, profile = (formats.known_formats()[found] for found in TEXT_FORMATS)
    lists_points = options.format == points.name or table.names_points
    if 3 < table.columns <= FEW_COLUMNS and len(table.rows) >= ELONGATED * table.columns:
        lists_points |= _are_points(np.array(table.rows))
    if options.format == PROFILE:
        return profile, _profile(table)
    if table.columns < 3:
        raise ValueError(f"{LINE_SCAN} of {table.columns} columns; {DECLARED}")
    if not lists_points and (found := _matrix(table, matrix, options)):
        return matrix, found
    try:
        height, (y, x) = grid_points(table.numbers()[:, :3], table.line_numbers)
    except ValueError as error:
        raise ValueError(
            f"three columns of numbers that are no points x, y, z on a regular grid ({_first_line(error)})"
        ) from error
    unit_x, unit_y, unit = table.column_units[:3]
    length, length_unit = edges_in_one_unit((y, x), (unit_y, unit_x))
    if stated := zygo_units(table.header):
        pixel, length_unit, unit = stated
        length = y * pixel, x * pixel
    return points, FileContent(height, "z", length=length, length_unit=length_unit, unit=unit)


def _are_points(numbers: Array) -> bool:
    """True if the first columns of a list hold positions on a regular grid."""
    with suppress(ValueError):
        return bool(grid_points(numbers[:, :3])[0].size)
    return False


def _matrix(table: NumberTable, form: Format, options: MapOptions) -> FileContent | None:
    """A matrix of heights, with the edges and units of its heading; None for three columns without edges."""
    is_asked_for = options.format == form.name or table.columns > 3
    try:
        lines, bare = table.with_headings()
    except ValueError:  # numbers of points beside a list of them
        if is_asked_for:
            raise
        return None
    pixel = stated_pixel(table.header)
    if any(map(MATRIX_HEADER.search, lines[: len(table.header)])):
        heading, rows = lines[: len(table.header)], lines[len(table.header) :]
        void, half = _VOID.search("\n".join(heading)), len(rows) // 2
        is_validity = void and {*map(float, " ".join(rows[half:]).split())} <= {0.0, 1.0}
        parts = (rows[:half], rows[half:]) if is_validity else (rows,)
        content, *valid = (
            _instrument_map(form, io.StringIO("\n".join([*heading, *part])), options) for part in parts
        )
        if valid:
            content = content._replace(height=np.where(valid[0].height == 0, np.nan, content.height))
    elif not is_asked_for:
        return None
    else:
        content = FileContent(table.heights(pixel is not None), orientation=None)
    if content.unit is None:
        content = content._replace(unit=height_unit(table.header, pixel is not None))
    if pixel and content.length is None:
        length = content.height.shape[0] * pixel[0][0], content.height.shape[1] * pixel[0][1]
        content = content._replace(length=length, length_unit=pixel[1], orientation=PEAKS_UP)
    if content.length is None and len(bare) == 2:
        return content._replace(length=(bare["y"], bare["x"]), length_unit=None)
    return content


def _profile(table: NumberTable) -> FileContent:
    """A line scan of columns x and z, or z."""
    numbers, unit = table.numbers(), table.column_units[-1]
    if numbers.shape[1] > 2:
        raise ValueError(
            f"format = 'profile': columns x and z, or z, are needed, not {numbers.shape[1]} columns"
        )
    line, length = numbers[:, -1], None
    if numbers.shape[1] == 2:
        index, spacing, count = nodes(numbers[:, 0], "x")
        refuse_repeated(index, table.line_numbers)
        line = np.full(count, np.nan)
        line[index] = numbers[:, 1]
        if np.median(np.diff(np.sort(index))) > 1:
            raise ValueError("the positions x are not equally spaced")
        length = spacing, count * spacing
    return FileContent(line[None, :], "z", length=length, length_unit=table.column_units[0], unit=unit)


def _array(file: BinaryIO, options: MapOptions) -> FileContent:
    """An array of NumPy, or one of several."""
    try:
        loaded = np.load(file, allow_pickle=False)
        arrays = {UNNAMED: loaded} if isinstance(loaded, np.ndarray) else {}
        for name in () if arrays else loaded:
            with suppress(ValueError):  # of objects, which are not unpacked
                arrays[name] = loaded[name]
    except Exception as error:  # of damaged files of any kind
        raise ValueError(f"{UNREADABLE} ({_first_line(error)})") from error
    arrays = {name: each for name, each in arrays.items() if each.ndim == 2 and each.dtype.kind in "fiu"}
    if not arrays:
        raise ValueError(f"{UNREADABLE} (it holds no array of real numbers with two dimensions)")
    channels = tuple(Channel(name, array.shape) for name, array in arrays.items())
    index, undecided = choose_channel(channels, options.channel, lambda number: [*arrays.values()][number])
    chosen = channels[index].name
    require_size(8.0 * arrays[chosen].size, options.max_memory)
    return FileContent(arrays[chosen].astype(float), chosen, channels, undecided, orientation=None)


def _picture(form: Format, file: BinaryIO, options: MapOptions) -> FileContent:
    """A picture of heights, or of grey levels."""
    require(("tifffile", "matplotlib"))  # which brings Pillow
    scale: dict[str, Any] = {}
    try:
        if form.name == "tiff":
            import tifffile

            opened = tifffile.TiffFile(file)
            pages = opened.pages
            require_size(8.0 * math.prod(pages[0].shape), options.max_memory)
            values = pages[0].asarray() if len(pages) == 1 else np.empty(0)
            scale = tiff_scale(opened) if values.ndim == 2 else {}
        else:
            from PIL import Image

            image = Image.open(file)
            require_size(8.0 * math.prod(image.size), options.max_memory)
            values = np.asarray(image) if image.mode in ("L", "I", "F", "I;16", "I;16B") else np.empty(0)
    except Exception as error:  # of damaged files of any kind
        raise ValueError(f"{UNREADABLE} ({_first_line(error)})") from error
    if values.ndim != 2 or values.dtype.kind not in "fiu":
        raise ValueError("one picture of heights or grey levels is needed, not one in colours or several")
    height, missing = values.astype(float), scale.pop("missing", None)
    if missing is not None:
        height[np.isclose(height, missing, rtol=1e-6, atol=0)] = np.nan
    return FileContent(height, orientation=None, is_grey=values.dtype.kind != "f", **scale)


_readers: dict[str, ModuleType] = {}
"""Modules of SurfaceTopography that were imported without its functions of analysis."""


@contextmanager
def _surface_topography() -> Iterator[None]:
    """Block in which readers of SurfaceTopography can be imported without its functions of analysis.

    The package imports these with statistics, optimisation and pictures, which no reader needs: without them
    the first file of Gwyddion takes 0.1 s of processor time instead of 1.05 s. Outside the block an import
    gives the whole package.
    """
    if "SurfaceTopography" in sys.modules:
        yield
        return
    outside = {name: module for name, module in sys.modules.items() if name.split(".")[0] == "NuMPI"}
    if not _readers:
        (folder,) = find_spec("SurfaceTopography").submodule_search_locations  # type: ignore[union-attr, misc]
        for part in ("", ".IO", ".Uniform"):
            package = _readers[f"SurfaceTopography{part}"] = ModuleType(f"SurfaceTopography{part}")
            package.__path__ = [os.path.join(folder, part[1:])]
        _readers["NuMPI.Optimization"] = ModuleType("NuMPI.Optimization")
    sys.modules.update(_readers)
    try:
        base = import_module("SurfaceTopography.IO.Reader").ReaderBase
        sys.modules["SurfaceTopography.IO"].ReaderBase = base  # type: ignore[attr-defined]
        yield
    finally:
        for name in [name for name in sys.modules if name.split(".")[0] in ("SurfaceTopography", "NuMPI")]:
            _readers[name] = sys.modules.pop(name)
        sys.modules.update(outside)


def _instrument_map(form: Format, file: Any, options: MapOptions) -> FileContent:
    """A map in a format that SurfaceTopography reads."""
    require(("SurfaceTopography",))
    with warnings.catch_warnings(action="ignore"), _surface_topography():
        warnings.simplefilter("error", np.exceptions.ComplexWarning)
        module = import_module(f"SurfaceTopography.IO.{form.reader}")
        (opened,) = (
            kind
            for kind in vars(module).values()
            if isinstance(kind, type) and getattr(kind, "_format", None) == form.name
        )
        try:
            original = b"" if form.name in TEXT_FORMATS else file.read(dialects.HEADING)
            file.seek(0)
            rewritten = dialects.as_expected(form.name, file, options.max_memory)
            file.seek(0)
            reader = opened(file if rewritten is None else io.BytesIO(rewritten))
            if form.name == "gwy":
                dialects.add_unlabelled(reader, import_module("SurfaceTopography.IO.Reader").ChannelInfo)
        except Exception as error:  # readers raise errors of any type for other files
            raise _OtherFormatError(_first_line(error)) from error
        with reader:
            infos = reader.channels
            if not infos:
                raise _OtherFormatError("it has no channel that is a map of heights")
            by_rows = form.name in ROW_BY_ROW
            logical, found = _logical(form, reader, file), []
            for info in infos:
                points, shape = info.nb_grid_pts, None
                if info.dim == 2 and points is not None and len(points) == 2:
                    shape = (points[0], points[1]) if by_rows else (points[1], points[0])
                kind = "logical" if info.name in logical else info.data_kind.value
                found.append(Channel(str(info.name), shape, kind))
            channels = tuple(found)

            def look(number: int) -> Array:
                with suppress(np.exceptions.ComplexWarning):
                    return np.asarray(reader.topography(number, (1.0, 1.0)).heights())
                return np.empty(0)

            index, undecided = choose_channel(channels, options.channel, look if by_rows else None)
            info = infos[index]
            shape = channels[index].shape
            is_line = info.dim == 1 and options.format == PROFILE
            if is_line:
                shape = 1, info.nb_grid_pts[0]
            if shape is None or info.is_uniform is False:
                raise ValueError(f"{LINE_SCAN} or scattered points")
            require_size(8.0 * math.prod(shape), options.max_memory)
            sizes = info.physical_sizes
            known_size = sizes is not None and all(size is not None for size in sizes)
            assumed = {} if known_size else {"physical_sizes": tuple(map(float, info.nb_grid_pts))}
            try:
                topography = reader.topography(channel_index=index, **assumed)
                marked, mask = np.ma.getmaskarray(topography.heights()), ""
                if form.name == "gwy" and marked.any():  # grains, for example, besides non-measured points
                    reader._masks.clear()
                    kept = reader.topography(channel_index=index, **assumed)
                    is_kept = options.mask is None and bool(np.ptp(kept.heights()[marked]))
                    topography = kept if is_kept else topography
                    done = "kept; set it to excluded to leave them out" if is_kept else "left out"
                    mask = f"mask: {marked.sum()} points that the file marks are {done}"
                height: Array = np.ma.filled(np.ma.asarray(topography.heights(), dtype=float), np.nan)
            except Exception as error:
                raise ValueError(f"{UNREADABLE} ({_first_line(error)})") from error
            attributes = dict(reader._h5[info.name].attrs) if form.name == "h5" else {}
    is_bare = by_rows or (form.name == "asc" and not known_size and topography.unit is None)
    content = FileContent(
        height=np.ascontiguousarray(height if by_rows else np.atleast_2d(height.T)),
        channels=channels,
        channel=channels[index].name,
        undecided=undecided,
        length=(float(sizes[-1]) if len(sizes) > 1 else 0.0, float(sizes[0])) if known_size else None,
        length_unit=SAME if topography.unit else None,
        unit=topography.unit,
        factor=info.height_scale_factor,
        periodic=bool(topography.is_periodic),
        orientation=None if is_bare else PEAKS_UP,
        mask=mask,
        instrument=str((topography.info.get("instrument") or {}).get("name") or ""),
    )
    if form.name == "h5":
        return hierarchical.with_attributes(content, attributes)
    return dialects.corrected(form.name, original, info, content)


def _logical(form: Format, reader: Any, file: Any) -> set[str]:
    """Names of arrays that hold true and false."""
    if form.name == "h5":
        return {info.name for info in reader.channels if reader._h5[info.name].dtype.kind == "b"}
    if form.name != "mat" or reader._hdf5:
        return set()
    file.seek(0)
    return {name for name, _, kind in import_module("scipy.io").whosmat(file) if kind == "logical"}


def _first_line(error: Exception) -> str:
    text = str(error).splitlines()[0] if str(error) else type(error).__name__
    return re.sub(r"'?<_io\.\w+ object at 0x\w+>'?", "itself", text)
