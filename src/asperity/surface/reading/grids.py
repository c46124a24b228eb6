"""Grids with a heading: ESRI and Surfer in ASCII, the Simple Field of Gwyddion, X3P, and TIFF."""

import hashlib
import math
import posixpath
import re
import zipfile
from collections.abc import Sequence
from contextlib import suppress
from typing import Any, BinaryIO
from xml.etree import ElementTree

import numpy as np

from asperity.core.types import Array
from asperity.surface.reading.agreement import FileContent, edges_in_one_unit, metres

SURFER_BLANK = 1.70141e38
"""Smallest number by which Surfer marks nodes without data."""

_ESRI_KEYS = ("ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize", "dx", "dy")
_NO_DATA = "nodata_value"


def read_grid(name: str, file: BinaryIO) -> FileContent:
    """The map in a file of the format ``esri``, ``surfer`` or ``gsf``.

    Raises
    ------
    ValueError
        If an entry of the heading is missing, or the number of heights is not the stated one.
    """
    content = file.read()
    try:
        return _simple_field(content) if name == "gsf" else _READERS[name](content.decode("latin-1").split())
    except (KeyError, IndexError) as error:
        raise ValueError(f"its heading has no {error.args[0]}") from error


def _esri(words: Sequence[str]) -> FileContent:
    """ESRI ASCII grid: square cells, rows from the largest y downwards."""
    entries: dict[str, float] = {_NO_DATA: -9999.0}
    begin = 0
    while words[begin].lower() in (*_ESRI_KEYS, _NO_DATA):
        entries[words[begin].lower()] = _numbers(words[begin + 1 : begin + 2])[0]
        begin += 2
    ny, nx = int(entries["nrows"]), int(entries["ncols"])
    dx = entries["dx"] if "dx" in entries else entries["cellsize"]
    height = _matrix(_numbers(words[begin:]), (ny, nx))[::-1]
    height = np.where(height == entries[_NO_DATA], np.nan, height)
    return FileContent(height, length=(ny * entries.get("dy", dx), nx * dx), length_unit=None)


def _surfer(words: Sequence[str]) -> FileContent:
    """Surfer ASCII grid: nodes from the smallest to the largest x and y, rows from the smallest y upwards."""
    nx, ny, left, right, bottom, top = _numbers(words[1:7])
    height = _matrix(_numbers(words[9:]), (int(ny), int(nx)))
    height = np.where(height >= SURFER_BLANK, np.nan, height)
    length = ny * (top - bottom) / (ny - 1), nx * (right - left) / (nx - 1)
    return FileContent(height, length=length, length_unit=None)


_READERS = {"esri": _esri, "surfer": _surfer}


def _simple_field(content: bytes) -> FileContent:
    """Gwyddion Simple Field: lines ``key = value``, zeros to a multiple of four bytes, and floats."""
    heading = content.partition(b"\0")[0]
    lines = (line.partition("=") for line in heading.decode("utf-8", errors="replace").splitlines()[1:])
    entries: dict[str, Any] = {key.strip(): value.strip() for key, _, value in lines}
    ny, nx = int(entries["YRes"]), int(entries["XRes"])
    begin = 4 * (len(heading) // 4 + 1)
    data = np.frombuffer(content[begin : begin + 4 * ny * nx], "<f4")
    length = None
    if "XReal" in entries and "YReal" in entries:
        length = float(entries["YReal"]), float(entries["XReal"])
    return FileContent(
        height=_matrix(data.astype(float), (ny, nx)),
        channel=entries.get("Title") or "Default",
        length=length,
        length_unit=entries.get("XYUnits") or None,
        unit=entries.get("ZUnits") or None,
    )


def _numbers(words: Sequence[str]) -> Array:
    return np.array([word.replace(",", ".") for word in words], dtype=float)


def _matrix(numbers: Array, shape: tuple[int, int]) -> Array:
    if min(shape) < 2 or numbers.size != shape[0] * shape[1]:
        raise ValueError(f"its heading says {shape[0]} x {shape[1]} heights, it holds {numbers.size}")
    return numbers.reshape(shape)


def tiff_scale(opened: Any) -> dict[str, Any]:
    """Edges with their unit, and the mark of missing data, in a TIFF of ImageJ, OME or GeoTIFF; else empty.

    The resolution of other TIFF files describes a print, not the map.

    Parameters
    ----------
    opened : tifffile.TiffFile
    """
    from tifffile import xml2dict

    page = opened.pages[0]
    (ny, nx), tags = page.shape, page.tags
    scale: dict[str, Any] = {}
    if opened.is_imagej and "XResolution" in tags and "YResolution" in tags:
        unit = str((opened.imagej_metadata or {}).get("unit", "")).replace("\\u00B5", "µ")
        (x, per_x), (y, per_y) = tags["XResolution"].value, tags["YResolution"].value
        if unit.lower() not in ("", "pixel", "pixels") and x and y:
            scale |= {"length": (ny * per_y / y, nx * per_x / x), "length_unit": unit}
    if opened.is_ome:
        with suppress(LookupError, ValueError, TypeError):  # a file without sizes, or with several images
            pixels = xml2dict(opened.ome_metadata)["OME"]["Image"]["Pixels"]
            y, x = (float(pixels[f"PhysicalSize{axis}"]) for axis in "YX")
            units = [pixels.get(f"PhysicalSize{axis}Unit", "µm") for axis in "YX"]
            length, per = edges_in_one_unit((ny * y, nx * x), (units[0], units[1]))
            scale |= {"length": (metres(str(per)) and length), "length_unit": per}
    if opened.is_geotiff:
        keys = page.geotiff_tags
        is_projected = int(keys.get("GTModelTypeGeoKey", 0)) == 1  # others are in degrees
        known = _GEOTIFF_UNITS.get(int(keys.get("ProjLinearUnitsGeoKey", 9001)))
        if is_projected and known and "ModelPixelScale" in keys:
            x, y = keys["ModelPixelScale"][:2]
            scale |= {"length": (ny * y, nx * x), "length_unit": known}
    if "GDAL_NODATA" in tags:
        scale["missing"] = float(tags["GDAL_NODATA"].value)
    return scale


_GEOTIFF_UNITS = {9001: "m", 9002: "ft"}

TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}
"""Data type of an axis → numpy type of its numbers."""


def read_x3p(file: BinaryIO) -> FileContent:
    """The map in a file of the format X3P of ISO 25178-72 (earlier ISO 5436-2), in all variants.

    The archive holds ``main.xml`` at its top or in a folder. Heights are in a binary member, or listed in the
    XML; a checksum that is stated has to match. Lengths are in metres.

    Raises
    ------
    ValueError, BadZipFile
        If it holds no map of equally spaced heights, or is damaged.
    """
    with zipfile.ZipFile(file) as archive:
        members = {_plain(name): name for name in archive.namelist()}
        index = min((name for name in members if posixpath.basename(name) == "main.xml"), key=len)
        folder, main = posixpath.dirname(index), archive.read(members[index])

        def member(link: str) -> bytes | None:
            name = _plain(posixpath.join(folder, link))
            return archive.read(members[name]) if name in members else None

        try:
            root = ElementTree.fromstring(main.lstrip(b" \r\n\t"))
        except ElementTree.ParseError as error:
            raise ValueError(f"its main.xml is damaged ({error})") from error

        def text(path: str) -> str:
            return (root.findtext("/".join(f"{{*}}{part}" for part in path.split("/"))) or "").strip()

        def number(path: str, default: float) -> float:
            return float(text(path).replace(",", ".") or default)

        kind, size_z = text("Record1/FeatureType").upper(), text("Record3/MatrixDimension/SizeZ") or "1"
        if kind not in ("SUR", "PRF", "") or size_z != "1":
            raise ValueError(f"a map is needed (FeatureType SUR, SizeZ 1), not {kind} of SizeZ {size_z}")
        is_line = kind == "PRF"
        if {text(f"Record1/Axes/C{axis}/AxisType") for axis in ("X" if is_line else "XY")} != {"I"}:
            raise ValueError("equally spaced points are needed, axes CX and CY of type I")
        shape = int(text("Record3/MatrixDimension/SizeY") or 1), int(text("Record3/MatrixDimension/SizeX"))
        data_type = text("Record1/Axes/CZ/DataType") or "D"
        if data_type not in TYPES:
            raise ValueError(f"its heights are of type {data_type}; one of {', '.join(TYPES)} is needed")
        _require_checksum("main.xml", main, (member(text("Record4/ChecksumFile")) or b"").decode("latin-1"))
        link = text("Record3/DataLink/PointDataLink")
        if link:
            if (points := member(link)) is None:
                raise ValueError(f"its member {link} is missing")
            _require_checksum("heights", points, text("Record3/DataLink/MD5ChecksumPointData"))
            raw: np.ndarray = np.frombuffer(points, TYPES[data_type], math.prod(shape)).astype(float)
        else:
            entries = (item.text or "" for item in root.iterfind("{*}Record3/{*}DataList/{*}Datum"))
            heights = (entry.split(";")[-1].strip().replace(",", ".") for entry in entries)  # last coordinate
            raw = np.array([float(height or "nan") for height in heights])
        if raw.size != math.prod(shape):
            raise ValueError(f"{shape[0]} x {shape[1]} heights are needed, it holds {raw.size}")
        bits = member(text("Record3/DataLink/ValidPointsLink") or "-")
        if bits is not None:
            _require_checksum("valid points", bits, text("Record3/DataLink/MD5ChecksumValidPoints"))
            valid = np.unpackbits(np.frombuffer(bits, "u1"), count=raw.size, bitorder="little")
            raw[valid == 0] = np.nan
        factor = number("Record1/Axes/CZ/Increment", 1.0) or 1.0
        height = (raw * factor + number("Record1/Axes/CZ/Offset", 0.0)).reshape(shape)
        across = number("Record1/Axes/CX/Increment", 0.0)
        pixel = across if is_line else number("Record1/Axes/CY/Increment", 0.0), across
    length = (shape[0] * pixel[0], shape[1] * pixel[1]) if min(pixel) > 0 else None
    return FileContent(height, length=length, unit="m", factor=factor)


def _plain(name: str) -> str:
    """Name of a member in one form: small letters, slashes, no leading point."""
    return posixpath.normpath(name.replace("\\", "/")).lstrip("/").lower()


def _require_checksum(what: str, content: bytes, stated: str) -> None:
    """Raise `ValueError` if the content does not have the checksum that is stated, if there is one."""
    found = re.match(r"\s*([0-9a-fA-F]{32})\b", stated)
    if found and found[1].lower() != hashlib.md5(content, usedforsecurity=False).hexdigest():
        raise ValueError(f"damaged or changed: its {what} do not have the checksum that it states")
