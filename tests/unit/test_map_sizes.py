"""Files that unpack to much are refused by the sizes that they declare, in little memory."""

import gzip
import io
import re
import struct
import tracemalloc
import zipfile
import zlib

import numpy as np
import pytest

from asperity.surface.height_map import MapError
from asperity.surface.reading import read_map
from asperity.surface.unpacked_size import _zlib_block, unpacked_size

pytest.importorskip("SurfaceTopography")
MAX_MEMORY_USED = 50e6


def deflated_zeros(megabytes):
    """Raw deflate stream of zeros, by repetition of one block."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = packer.compress(bytes(2**20)) + packer.flush(zlib.Z_FULL_FLUSH)
    return block * megabytes + packer.flush()


def zip_bomb(path, members, megabytes):
    """ZIP archive of members of zeros, written byte by byte; their check sums are not right."""
    data = deflated_zeros(megabytes)
    size = megabytes * 2**20
    body, directory = bytearray(), bytearray()
    for name in members:
        fields = struct.pack("<HHHHHIII", 20, 0, 8, 0, 0x5021, 0, len(data), size)
        offset = len(body)
        body += b"PK\x03\x04" + fields + struct.pack("<HH", len(name), 0) + name.encode() + data
        tail = struct.pack("<HHHHHII", len(name), 0, 0, 0, 0, 0, offset)
        directory += b"PK\x01\x02" + struct.pack("<H", 20) + fields + tail + name.encode()
    end = struct.pack("<HHHHIIH", 0, 0, len(members), len(members), len(directory), len(body), 0)
    path.write_bytes(bytes(body + directory) + b"PK\x05\x06" + end)


def x3p_of_5_gigabytes(path):
    zip_bomb(path, ["main.xml", "bindata/data.bin"], 2500)


def nested_zip(path):
    inner = io.BytesIO()
    with zipfile.ZipFile(inner, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("data.bin", bytes(30 * 2**20))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("inner.zip", inner.getvalue())


def gzip_of_zeros(path):
    path.write_bytes(gzip.compress(bytes(40 * 2**20), mtime=0))


def gzip_that_declares_less(path):
    """Its last member, whose size is at the end of the file, is small."""
    path.write_bytes(gzip.compress(bytes(40 * 2**20), mtime=0) + gzip.compress(b"end", mtime=0))


def hdf5_of_zeros(path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        file.create_dataset("height", (20000, 20000), "f8", chunks=(1000, 1000), compression="gzip")


def npy_of_nothing(path):
    header = np.lib.format.header_data_from_array_1_0(np.zeros((1, 1)))
    with open(path, "wb") as file:
        np.lib.format.write_array_header_1_0(file, header | {"shape": (20000, 20000)})


def npz_of_zeros(path):
    np.savez_compressed(path, height=np.zeros((2000, 2000)))


def matlab_of_zeros(path):
    from scipy.io import savemat

    savemat(path, {"height": np.zeros((2000, 2000))}, do_compression=True)


def tiff_of_nothing(path):
    """Header of a compressed TIFF of 60000 x 60000 points of 16 bits."""
    tags = [(256, 4, 60000), (257, 4, 60000), (258, 3, 16), (259, 3, 8), (262, 3, 1), (273, 4, 8)]
    tags += [(277, 3, 1), (278, 4, 60000), (279, 4, 10)]
    entries = b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in tags)
    path.write_bytes(b"II*\0" + struct.pack("<IH", 8, len(tags)) + entries + bytes(4 + 10))


@pytest.mark.parametrize(
    ("name", "write", "limit", "gigabytes"),
    [
        ("bomb.x3p", x3p_of_5_gigabytes, 2.0, "4.88"),
        ("nested.zip", nested_zip, 0.02, "0.0293"),
        ("map.asc.gz", gzip_of_zeros, 0.02, "0.0391"),
        ("liar.asc.gz", gzip_that_declares_less, 0.02, None),
        ("zeros.h5", hdf5_of_zeros, 2.0, "2.98"),
        ("zeros.npy", npy_of_nothing, 2.0, "2.98"),
        ("zeros.npz", npz_of_zeros, 0.02, "0.0298"),
        ("zeros.mat", matlab_of_zeros, 0.02, "0.0298"),
        ("zeros.lext", tiff_of_nothing, 2.0, "6.71"),
    ],
)
def test_a_file_that_unpacks_to_much_is_refused_in_little_memory(tmp_path, name, write, limit, gigabytes):
    path = tmp_path / name
    write(path)
    assert path.stat().st_size < 6e6
    tracemalloc.start()
    try:
        with pytest.raises(MapError) as caught:
            read_map(path, max_memory=limit)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < MAX_MEMORY_USED
    assert f"max_memory = {limit:g} GiB: the file holds" in str(caught.value)
    if gigabytes:
        assert f"holds {gigabytes} GiB of data when it is unpacked" in str(caught.value)


def test_a_higher_limit_lets_a_file_pass(tmp_path):
    np.savez_compressed(tmp_path / "map.npz", height=np.random.default_rng(0).normal(size=(200, 200)))
    size = unpacked_size(tmp_path / "map.npz")
    given = {"physical_size": (1.0, 1.0), "height_factor": 1e-3, "orientation": "peaks up"}
    with pytest.raises(MapError, match=re.escape("max_memory")):
        read_map(tmp_path / "map.npz", **given, max_memory=0.9 * size / 2**30)
    assert read_map(tmp_path / "map.npz", **given, max_memory=1.1 * size / 2**30).height.shape == (200, 200)


def test_the_zlib_blocks_of_a_container_are_counted():
    packed = zlib.compress(bytes(10 * 2**20))
    assert _zlib_block(b"head" + packed + b"tail", 4) == (len(packed), 10 * 2**20)
    assert _zlib_block(b"head" + packed[:-20], 4) == (0, 0)
    assert _zlib_block(b"xxxxxxxxxx", 0) == (0, 0)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        (
            "array.gwy",
            b"GWYPGwyContainer\0" + struct.pack("<I", 2**31) + b"/0/data\0D" + struct.pack("<I", 2**30),
        ),
        ("empty.gz", b"\x1f\x8b"),
        ("broken.gz", b"\x1f\x8b\x08\0\0\0\0\0\0\x03" + b"\xff" * 40),
        ("empty.zip", b"PK\x03\x04"),
        ("short.npy", b"\x93NUMPY\x01\x00"),
        ("short.h5", b"\x89HDF\r\n\x1a\n"),
        ("short.tif", b"II*\0\x08\0\0\0"),
        ("short.mnt", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600)),
        ("text.mat", b"MATLAB 5.0 MAT-file".ljust(126) + b"IM"),
    ],
)
def test_a_damaged_container_is_refused_in_one_line(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(MapError) as caught:
        read_map(tmp_path / name)
    assert "\n" not in str(caught.value)
    assert "delete" not in str(caught.value)
