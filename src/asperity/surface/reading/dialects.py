"""Files of instruments that SurfaceTopography reads wrongly or not at all, rewritten as it expects them."""

import re
import struct
import zlib
from contextlib import suppress
from typing import Any, BinaryIO

import numpy as np

from asperity.surface.reading.agreement import FileContent, edges_in_one_unit, metres, require_size

HEADING = 512
"""Bytes at the beginning of a file from which `corrected` takes the units."""

LARGEST_NANOFOCUS_PIXEL = 0.1
"""Largest pixel of a NanoFocus file in mm; above it the lengths are in nm, as instruments write them. No
microscope has pixels of 0.1 mm, and none resolves 0.1 nm."""

_LENGTH = re.compile(r"[GMkmunpfµμ~]?m|Å|A")
"""Units of length in files of instruments."""


def as_expected(format_name: str, file: BinaryIO, limit: float) -> bytes | None:
    """Content of a file rewritten for SurfaceTopography; None where nothing is to be rewritten.

    Raises
    ------
    ValueError
        If it unpacks to more than `limit` GiB, or is damaged.
    """
    if format_name == "sur":
        return _sur(file.read(), limit)
    with suppress(ValueError, LookupError, struct.error):
        return _REWRITES[format_name](file.read())
    return None


def _sdf(content: bytes) -> bytes:
    """ISO 25178-71 and its forerunners, which differ in their first line and in the spelling of the keys."""
    content = content if content.startswith(b"b") else content.lstrip()
    version = content[:8]
    if version.startswith(b"b"):
        content = content[8:]
        if version == b"bISO-2.0":  # has four bytes in place of two for the numbers of points and of profiles
            content = (
                content[:34] + struct.pack("<HH", *struct.unpack_from("<II", content, 34)) + content[42:]
            )
        return b"bISO-1.0" + content
    heading, _, rest = content.partition(b"*")
    entries = {"compression": "0", "datatype": "7", "checktype": "0"}
    for line in heading.decode("latin-1").splitlines():
        key, _, value = line.partition("=" if "=" in line else ":")
        entries[key.strip().lower()] = value.strip()
    for key in _SDF_NUMBERS:
        if number := re.match(r"[-+\d.,eE]+", entries.get(key.lower(), "")):
            entries[key.lower()] = number[0].replace(",", ".")
    lines = [f"{key} = {entries[key.lower()]}" for key in _SDF_NUMBERS if key.lower() in entries]
    return "\n".join(["aISO-1.0", *lines, "*"]).encode() + rest


_SDF_NUMBERS = (
    *("NumPoints", "NumProfiles", "Xscale", "Yscale", "Zscale", "Zresolution"),
    *("Compression", "DataType", "CheckType"),
)


def _sur(content: bytes, limit: float) -> bytes:
    """Digital Surf: points are unpacked; units in UTF-8, and units that are no length, are replaced."""
    header = bytearray(content[:512])
    for start in range(180, 276, 16):
        unit = header[start : start + 16].replace(b"\xc2\xb5", b"\xb5").replace(b"\xce\xbc", b"\xb5")
        header[start : start + 16] = unit.ljust(16, b"\0")
    if not _surf_unit(bytes(header)):
        for start in (212, 260):
            header[start : start + 16] = header[180:196]
    if not content.startswith(b"DSCOMPRESSED"):
        return bytes(header) + content[512:]
    header[:12] = b"DIGITAL SURF"
    bits, size = struct.unpack_from("<H", header, 98)[0], struct.unpack_from("<I", header, 116)[0]
    wanted = bits * size // 8
    require_size(wanted, limit)
    begin = 512 + sum(struct.unpack_from("<HH", header, 334))
    (count,) = struct.unpack_from("<I", content, begin)
    sizes = struct.unpack_from(f"<{2 * count}I", content, begin + 4)[1::2]
    start, points = begin + 4 + 8 * count, b""
    for packed in sizes:
        points += zlib.decompressobj().decompress(content[start : start + packed], wanted - len(points) or 1)
        start += packed
    return bytes(header) + content[512:begin] + points


def _surf_unit(header: bytes) -> str:
    """Unit of the heights in the header of a Digital Surf file; empty if it is no length."""
    unit = header[212:228].split(b"\0")[0].decode("latin-1").strip().replace("æ", "µ").replace("Âµ", "µ")
    return unit if _LENGTH.fullmatch(unit) else ""


def _tmd(content: bytes) -> bytes:
    """TrueMap: SurfaceTopography takes the comment to have 24 bytes; the points fill the rest of the file."""
    for start in range(30, min(len(content) - 24, 1024)):
        nx, ny = struct.unpack_from("<II", content, start)
        if nx and ny and start + 24 + 4 * nx * ny == len(content):
            return content[:29].ljust(56, b"\0") + content[start:]
    return content


def _nanosurf(content: bytes) -> bytes:
    """Nanosurf: force curves, which lie over a voltage or a time, are no heights."""
    heading, mark, data = content.partition(b"#!")
    sections = re.split(rb"(?m)^(?=\[)", heading)
    for number, section in enumerate(sections):
        across = re.findall(rb"(?m)^Dim[01]Unit=(.*?)\s*$", section)
        if not all(_LENGTH.fullmatch(unit.decode("latin-1")) for unit in across):
            sections[number] = re.sub(rb"(?m)^Dim2Unit=[^\r\n]*", b"Dim2Unit=-", section)
    return b"".join(sections) + mark + data


def _bruker(content: bytes) -> bytes:
    """Nanoscope: every image gets the lines that are stored, and the size of these lines."""
    end = content.find(b"\\*File list end")
    sections = re.split(r"(?m)^(?=\\\*)", content[: max(end, 0)].decode("latin-1"))
    lines_of = (re.findall(r"(?m)^\\([^:\r\n]+): ?([^\r\n]*)", section) for section in sections)
    entries = [{key.lower(): value for key, value in lines} for lines in lines_of]
    titles = [section[2:].split("\n")[0].strip().lower() for section in sections]
    scan = next((entry for entry, title in zip(entries, titles, strict=True) if title in _SCAN_LISTS), {})
    version = next((entry["version"] for entry in entries if "version" in entry), "")
    is_wide = bool(re.fullmatch(r"0x[0-9a-fA-F]+", version)) and int(version, 16) >= 0x09200000
    starts = []
    for number, (title, image) in enumerate(zip(titles, entries, strict=True)):
        if title in _IMAGE_LISTS and {"samps/line", "number of lines", "scan size"} <= image.keys():
            starts.append(int(image["data offset"]))
            lines, size = _bruker_image(image, scan, is_wide)
            text = re.sub(r"(?mi)^\\Aspect Ratio:[^\n]*\n", "", sections[number])
            text = re.sub(r"(?mi)^\\Number of lines:[^\r\n]*", rf"\\Number of lines: {lines}", text)
            sections[number] = re.sub(r"(?mi)^\\Scan Size:[^\r\n]*", rf"\\Scan Size: {size}", text)
        elif title in _SCAN_LISTS:
            sections[number] = re.sub(r"(?mi)^\\Slow Axis Size:[^\n]*\n", "", sections[number])
    if not starts:
        return content
    first, heading = min(starts), "".join(sections).encode("latin-1")
    heading = re.sub(
        rb"(?mi)^(\\Data offset: )(\d+)", lambda found: found[1] + b"%d" % (int(found[2]) + _SPACE), heading
    )
    heading += content[end:first].rstrip(b"\0")
    return heading.ljust(first + _SPACE, b"\0") + content[first:]


_SPACE = 4096
"""Bytes by which the heading may become longer: the data are moved by as many."""

_IMAGE_LISTS = ("ciao image list", "afm image list", "stm image list", "ncafm image list", "image list")
_SCAN_LISTS = ("ciao scan list", "afm list", "stm list", "nc afm list")


def _bruker_image(image: dict[str, str], scan: dict[str, str], is_wide: bool) -> tuple[int, str]:
    """Number of stored lines of an image, and its size.

    The slow axis of a whole scan is the fast one over the aspect ratio of the scan, unless the file states
    another size; of a scan that was captured early it is the fraction of the lines.
    """
    points, lines, length = (int(image[key]) for key in ("samps/line", "number of lines", "data length"))
    size = 4 if is_wide and length >= 4 * points * lines else int(image.get("bytes/pixel", "2"))
    listed = [re.match(r"\d+", scan.get(key, "")) for key in ("samps/line", "lines")]
    across, whole = (int(found[0]) if found else 0 for found in listed)
    if lines * points * size > length:
        if length == across * whole * size:  # which SurfaceTopography takes
            return lines, image["scan size"]
        lines = length // (points * size)
    fast, second, unit = _bruker_size(image["scan size"])
    ratio = [float(part) for part in re.findall(r"[\d.]+", scan.get("aspect ratio", ""))]
    slow = fast * ratio[1] / ratio[0] if len(ratio) == 2 and min(ratio) > 0 else fast
    if "slow axis size" in scan and "scan size" in scan:
        fast, _, unit = _bruker_size(scan["scan size"])
        slow, _, slow_unit = _bruker_size(scan["slow axis size"])
        slow *= metres(slow_unit) / metres(unit)
        second = fast
    if np.isclose(second, fast, rtol=1e-3) or np.isclose(second, slow, rtol=1e-3):
        second = slow * (min(lines / whole, 1.0) if whole else 1.0)
    return lines, f"{fast:.9g} {second:.9g} {unit}"


def _bruker_size(text: str) -> tuple[float, float, str]:
    """Fast and slow axis of a size such as ``10 5 ~m``, or of ``10 ~m``, and its unit."""
    numbers = re.findall(r"[-+\d.]+(?:e[-+]?\d+)?", text)
    return float(numbers[0]), float(numbers[-1]), text.split()[-1]


_REWRITES = {"di": _bruker, "ezd": _nanosurf, "sdf": _sdf, "tmd": _tmd}


def add_unlabelled(reader: Any, channel_info: Any) -> None:
    """Add the fields of a Gwyddion file whose heights have no unit to the channels of its reader."""
    for key, value in reader._metadata.items():
        found = re.fullmatch(r"/(\d+)/data", key)
        field = value["GwyDataField"] if found else {}
        if found and int(found[1]) not in reader._channels and not _gwyddion_unit(field, "z"):
            number = int(found[1])
            reader._indices.append(number)
            reader._channels[number] = channel_info(
                reader,
                len(reader._channels),
                name=reader._metadata.get(f"{key}/title"),
                dim=2,
                nb_grid_pts=(field["xres"], field["yres"]),
                physical_sizes=(abs(field["xreal"]) or 1.0, abs(field["yreal"]) or 1.0),
                height_scale_factor=1.0,
                periodic=False,
                uniform=True,
                unit=_gwyddion_unit(field, "xy") or None,
                tags={"data": field["data"], "index": number, "unlabelled": True},
            )


def _gwyddion_unit(field: dict[str, Any], axis: str) -> str:
    """Unit of the heights (``z``) or of the edges (``xy``) of a field; empty if it has none."""
    return str(field.get(f"si_unit_{axis}", {}).get("GwySIUnit", {}).get("unitstr", ""))


def corrected(format_name: str, begin: bytes, info: Any, content: FileContent) -> FileContent:
    """The content with corrected units and missing points, where SurfaceTopography reads them wrongly.

    Parameters
    ----------
    format_name : str
    begin : bytes
        The first `HEADING` bytes of the file.
    info : SurfaceTopography.IO.Reader.ChannelInfo
    content : FileContent
    """
    if format_name == "asc" and content.length and content.unit is None:
        units = info.info["raw_metadata"]
        across = units.get("xunit")
        length, unit = edges_in_one_unit(content.length, (units.get("yunit") or across, across))
        return content._replace(length=length, length_unit=unit)
    if format_name == "sdf":
        smallest = {3: -3.4e38, 4: -128.0, 7: -3.4e38}.get(info.info["raw_metadata"]["DataType"], -np.inf)
        gaps = content.height / content.factor <= smallest * (1 - 1e-9)
        return content._replace(height=np.where(gaps, np.nan, content.height))
    if format_name == "nms" and content.length:
        ny, nx = content.height.shape
        if max(content.length[0] / ny, content.length[1] / nx) > 1e3 * LARGEST_NANOFOCUS_PIXEL:
            return content._replace(length=(content.length[0] * 1e-6, content.length[1] * 1e-6))
    if info.tags.get("unlabelled") or (format_name == "sur" and not _surf_unit(begin)):
        return content._replace(unit=None, length_unit=content.unit, factor=None)
    return content
