"""Maps in the format X3P of ISO 25178-72 (earlier ISO 5436-2), in all variants that programs write.

The archive holds ``main.xml`` at its top or in a folder. Heights are in a binary member, or listed in the
XML; a checksum that is stated has to match. Lengths are in metres.
"""

import hashlib
import math
import posixpath
import re
import zipfile
from typing import BinaryIO
from xml.etree import ElementTree

import numpy as np

from asperity.surface.reading.agreement import FileContent

TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}
"""Data type of an axis → numpy type of its numbers."""


def read_x3p(file: BinaryIO) -> FileContent:
    """The map in an X3P file.

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
