"""Sizes that files declare, looked at before anything is unpacked or allocated.

A file of some kilobytes can unpack to gigabytes. Of every container (ZIP, HDF5, NetCDF, TIFF, MATLAB, NPY,
gzip) the declared sizes of its contents are added and compared with a limit. ZIP members cannot grow beyond
what the archive declares; a gzip file can, and is counted while it is unpacked.
"""

from __future__ import annotations

import io
import math
import os
import struct
import zipfile
import zlib
from collections.abc import Iterable
from typing import IO, Any

DEFAULT_LIMIT = 2.0
"""Largest size, in GiB, to which a file may unpack if the caller sets no limit."""

GIB = 2**30

_MAX_NESTING = 3
"""Depth to which ZIP archives in ZIP archives are looked into: the formats of instruments have two."""

_CHUNK = 2**20

_TAG = 8
_MATLAB_COMPRESSED = 15

_HDF5 = b"\x89HDF\r\n\x1a\n"
_GZIP = b"\x1f\x8b"
_OLE = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"


def check_size(path: str | os.PathLike[str], limit: float, option: str = "max_memory") -> None:
    """Raise an error if a file declares more data than a limit.

    Parameters
    ----------
    path : path
    limit : float
        In GiB.
    option : str
        Name of the limit in the interface of the user, for the message.

    Raises
    ------
    ValueError
        If the file unpacks to more than the limit. A file that is damaged passes: its reader says so.
    """
    require_size(unpacked_size(path, limit), limit, option)


def require_size(size: float, limit: float, option: str) -> None:
    """Raise `ValueError` if a size in bytes is above a limit in GiB."""
    if size > limit * GIB:
        raise ValueError(
            f"{option} = {limit:g} GiB: the file holds {size / GIB:.3g} GiB of data when it is unpacked; set "
            f"it to {math.ceil(size / GIB)} GiB or more if that is right"
        )


def unpacked_size(path: str | os.PathLike[str], limit: float = DEFAULT_LIMIT) -> float:
    """Bytes that a file declares for what is in it, at least those of the file itself.

    Counting stops above the limit in GiB.
    """
    most = limit * GIB
    with open(path, "rb") as file:
        start = file.read(128)
        file.seek(0)
        declared: float = 0
        try:
            if start.startswith(b"PK"):
                declared = _zip_size(file, most)
            elif start.startswith(_HDF5) or _HDF5 in _user_block(file):
                declared = _hdf5_size(path)
            elif start.startswith(b"\x93NUMPY"):
                declared = _npy_size(file)
            elif start.startswith(_GZIP):
                declared = _gzip_size(file, most)
            elif start.startswith((b"II*\x00", b"MM\x00*", b"II+\x00", b"MM\x00+")):
                declared = _tiff_size(path)
            elif start.startswith(b"MATLAB 5.0"):
                declared = _matlab_size(file)
            elif start.startswith(_OLE):
                declared = _ole_size(path, most)
        except _DAMAGED:
            pass
    return max(declared, os.path.getsize(path))


_DAMAGED = (
    OSError,
    ValueError,
    TypeError,
    KeyError,
    RuntimeError,
    NotImplementedError,
    EOFError,
    ImportError,
    struct.error,
    zlib.error,
    zipfile.BadZipFile,
)


def _zip_size(file: IO[bytes], most: float, nesting: int = 0) -> int:
    """Declared sizes of all members, and of the members of archives among them."""
    total = 0
    with zipfile.ZipFile(file) as archive:
        for member in archive.infolist():
            total += member.file_size
            if nesting < _MAX_NESTING and total <= most and member.file_size > 4:
                with archive.open(member) as inner:
                    if inner.read(2) == b"PK":
                        content = io.BytesIO(b"PK" + inner.read())
                        total += _zip_size(content, most, nesting + 1)
    return total


def _hdf5_size(path: str | os.PathLike[str]) -> int:
    """Sizes of all datasets before compression."""
    import h5py

    total = 0

    def add(_: str, node: Any) -> None:
        nonlocal total
        if isinstance(node, h5py.Dataset) and node.shape is not None:
            total += math.prod(node.shape) * node.dtype.itemsize

    with h5py.File(path, "r") as opened:
        opened.visititems(add)
    return total


def _user_block(file: IO[bytes]) -> bytes:
    """The bytes at which HDF5 may start in a MATLAB file."""
    file.seek(512)
    found = file.read(8)
    file.seek(0)
    return found


def _npy_size(file: IO[bytes]) -> int:
    from numpy.lib import format as npy

    version = npy.read_magic(file)
    header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, dtype = header(file)
    return math.prod(shape) * dtype.itemsize


def _gzip_size(file: IO[bytes], most: float) -> int:
    """Size after unpacking: the size at the end of the file, or more if counting finds more."""
    file.seek(-4, os.SEEK_END)
    declared: int = struct.unpack("<I", file.read(4))[0]
    if declared > most:
        return declared
    file.seek(0)
    return max(declared, sum(len(chunk) for chunk in gunzipped(file, most)))


def gunzipped(file: IO[bytes], most: float) -> Iterable[bytes]:
    """Content of a gzip file in small chunks, until more than `most` bytes have come.

    Raises
    ------
    ValueError
        If the file is damaged.
    """
    unpack = zlib.decompressobj(wbits=31)
    count = 0
    pending = b""
    while count <= most:
        pending = pending or file.read(_CHUNK)
        if not pending:
            return
        try:
            chunk = unpack.decompress(pending, _CHUNK)
        except zlib.error as error:
            raise ValueError(f"a gzip file without damage is needed ({error})") from error
        pending = unpack.unconsumed_tail
        count += len(chunk)
        if chunk:
            yield chunk
        if unpack.eof:
            pending = unpack.unused_data.lstrip(b"\0")
            unpack = zlib.decompressobj(wbits=31)


def _tiff_size(path: str | os.PathLike[str]) -> int:
    import tifffile

    total = 0
    with tifffile.TiffFile(path) as opened:
        for page in opened.pages:
            total += math.prod(page.shape) * int(page.dtype.itemsize if page.dtype is not None else 1)
    return total


def _matlab_size(file: IO[bytes]) -> int:
    """Sizes of all elements of a MATLAB 5 file; of a compressed one, only the tag in front is unpacked."""
    file.seek(126)
    order = "<" if file.read(2) == b"IM" else ">"
    total = 0
    while len(tag := file.read(_TAG)) == _TAG:
        kind, size = struct.unpack(f"{order}II", tag)
        if kind >> 16:  # a small element, whose data are in the tag
            continue
        end = file.tell() + size
        if kind == _MATLAB_COMPRESSED:
            inner = zlib.decompressobj().decompress(file.read(min(size, 64)), _TAG)
            total += struct.unpack(f"{order}II", inner)[1]
        else:
            total += size
            end += -size % _TAG
        file.seek(end)
    return total


def _ole_size(path: str | os.PathLike[str], most: float) -> int:
    """Sizes of all streams of an OLE container (MountainsMap), and of the zlib blocks in them.

    Nothing in the container declares the sizes of the blocks: whatever begins like one is unpacked in chunks
    that are not kept.
    """
    import olefile

    total = 0
    with olefile.OleFileIO(str(path)) as opened:
        for name in opened.listdir():
            data = opened.openstream(name).read()
            total += len(data)
            position = data.find(b"\x78")
            while position >= 0 and total <= most:
                packed, size = _zlib_block(data, position)
                total += size
                position = data.find(b"\x78", position + max(packed, 1))
    return total


def _zlib_block(data: bytes, position: int) -> tuple[int, int]:
    """Packed and unpacked length of a zlib block, zeros if there is none at this position."""
    if int.from_bytes(data[position : position + 2], "big") % 31:
        return 0, 0
    unpack, size, read = zlib.decompressobj(), 0, position
    pending = b""
    while not unpack.eof:
        if not pending:
            pending = data[read : read + _CHUNK]
            read += len(pending)
            if not pending:
                return 0, 0
        try:
            size += len(unpack.decompress(pending, _CHUNK))
        except zlib.error:
            return 0, 0
        pending = unpack.unconsumed_tail
    return read - len(unpack.unused_data) - position, size
