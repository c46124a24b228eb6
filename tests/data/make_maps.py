"""Write one small height map in the file format of each family of instruments.

All files hold the same surface: steel, ground along y, 40 x 48 pixels of 2 µm, in whole nanometres, with a
tilt, spikes of an optical instrument, and points without data. The writers follow the public descriptions of
the formats and use nothing of the packages that read them:

- X3P: ISO 25178-72 (ZIP archive of ``main.xml``, 16-bit heights, validity bits and an MD5 sum),
- GWY: Gwyddion user guide, "Gwyddion native data format" (serialised GwyContainer with a mask and two
  channels),
- SDF: ISO 25178-71, ASCII (``steel.sdf``), and the older BCR-1.0 in its binary form (``steel_bcr.sdf``),
- ASC: text matrix of Gwyddion with a header,
- NC: classic NetCDF with the names of SurfaceTopography,
- XYZ: text with three columns as Gwyddion exports it, points without data are left out,
- NPY: array of numpy, in micrometres, that says neither size nor unit.
"""

import hashlib
import io
import struct
import zipfile
from pathlib import Path

import numpy as np
from scipy.io import netcdf_file

FOLDER = Path(__file__).parent
SHAPE = (40, 48)
PIXEL = 2e-6
SPIKES = ((7, 11), (7, 12), (21, 30), (33, 5))
MISSING = ((3, 40), (4, 40), (4, 41), (5, 40), (18, 9), (29, 22), (29, 23))
ZIP_DATE = (2020, 1, 1, 0, 0, 0)


def ground_steel():
    """Heights in nanometres, integers, peaks upward; and the mask of the points that have data."""
    random = np.random.default_rng(20)
    ny, nx = SHAPE
    qy, qx = np.fft.fftfreq(ny)[:, None], np.fft.rfftfreq(nx)[None, :]
    # Grinding marks are long in y: wavenumbers along y count eight times.
    size = np.hypot(8 * qy, qx)
    size[0, 0] = np.inf
    amplitude = (size**2 + 0.03**2) ** -0.9
    height = np.fft.irfft2(amplitude * np.fft.rfft2(random.normal(size=SHAPE)), s=SHAPE)
    height *= 400 / height.std()
    y, x = np.mgrid[:ny, :nx]
    height += 12.0 * x - 5.0 * y
    for spot in SPIKES:
        height[spot] += 15000.0
    valid = np.ones(SHAPE, dtype=bool)
    valid[tuple(np.transpose(MISSING))] = False
    return np.rint(height).astype(int), valid


def write_x3p(path, height, valid):
    points = height.astype("<i2").tobytes()
    bits = np.packbits(valid.ravel(), bitorder="little").tobytes()
    main = f"""<?xml version="1.0" encoding="UTF-8" standalone="no" ?>
<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2" \
xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" \
xsi:schemaLocation="http://www.opengps.eu/2008/ISO5436_2 http://www.opengps.eu/2008/ISO5436_2/ISO5436_2.xsd">
  <Record1>
    <Revision>ISO5436 - 2000</Revision>
    <FeatureType>SUR</FeatureType>
    <Axes>
      <CX><AxisType>I</AxisType><DataType>D</DataType><Increment>{PIXEL!r}</Increment><Offset>0</Offset></CX>
      <CY><AxisType>I</AxisType><DataType>D</DataType><Increment>{PIXEL!r}</Increment><Offset>0</Offset></CY>
      <CZ><AxisType>A</AxisType><DataType>I</DataType><Increment>1e-9</Increment><Offset>0</Offset></CZ>
    </Axes>
  </Record1>
  <Record2>
    <Date>2020-01-01T00:00:00</Date>
    <Instrument>
      <Manufacturer>asperity</Manufacturer><Model>test data</Model>
      <Serial>not available</Serial><Version>1</Version>
    </Instrument>
    <CalibrationDate>2020-01-01T00:00:00</CalibrationDate>
    <ProbingSystem><Type>Software</Type><Identification>make_maps.py</Identification></ProbingSystem>
  </Record2>
  <Record3>
    <MatrixDimension><SizeX>{SHAPE[1]}</SizeX><SizeY>{SHAPE[0]}</SizeY><SizeZ>1</SizeZ></MatrixDimension>
    <DataLink>
      <PointDataLink>bindata/data.bin</PointDataLink>
      <MD5ChecksumPointData>{hashlib.md5(points).hexdigest().upper()}</MD5ChecksumPointData>
      <ValidPointsLink>bindata/valid.bin</ValidPointsLink>
      <MD5ChecksumValidPoints>{hashlib.md5(bits).hexdigest().upper()}</MD5ChecksumValidPoints>
    </DataLink>
  </Record3>
  <Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4>
</p:ISO5436_2>
""".encode()
    checksum = f"{hashlib.md5(main).hexdigest()} *main.xml\n".encode()
    members = {
        "main.xml": main,
        "bindata/data.bin": points,
        "bindata/valid.bin": bits,
        "md5checksum.hex": checksum,
    }
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            member = zipfile.ZipInfo(name, ZIP_DATE)
            member.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(member, content)


def gwy_text(text):
    return text.encode() + b"\0"


def gwy_object(name, *components):
    """Serialised object: name, size of the components, components."""
    content = b"".join(components)
    return gwy_text(name) + struct.pack("<I", len(content)) + content


def gwy_component(name, kind, value):
    return gwy_text(name) + kind.encode() + value


def gwy_unit(unit):
    return gwy_object("GwySIUnit", gwy_component("unitstr", "s", gwy_text(unit)))


def gwy_field(values, unit):
    """Serialised GwyDataField."""
    ny, nx = values.shape
    numbers = np.ascontiguousarray(values, dtype="<f8")
    return gwy_object(
        "GwyDataField",
        gwy_component("xres", "i", struct.pack("<i", nx)),
        gwy_component("yres", "i", struct.pack("<i", ny)),
        gwy_component("xreal", "d", struct.pack("<d", nx * PIXEL)),
        gwy_component("yreal", "d", struct.pack("<d", ny * PIXEL)),
        gwy_component("si_unit_xy", "o", gwy_unit("m")),
        gwy_component("si_unit_z", "o", gwy_unit(unit)),
        gwy_component("data", "D", struct.pack("<I", numbers.size) + numbers.tobytes()),
    )


def write_gwy(path, height, valid):
    container = gwy_object(
        "GwyContainer",
        gwy_component("/0/data", "o", gwy_field(1e-9 * np.where(valid, height, 0), "m")),
        gwy_component("/0/data/title", "s", gwy_text("Height")),
        gwy_component("/0/mask", "o", gwy_field(~valid, "")),
        gwy_component("/1/data", "o", gwy_field(1e-9 * height[:12, :16], "m")),
        gwy_component("/1/data/title", "s", gwy_text("Detail")),
    )
    path.write_bytes(b"GWYP" + container)


def write_sdf(path, height, valid):
    header = {
        "ManufacID": "asperity",
        "CreateDate": "010120200000",
        "ModDate": "010120200000",
        "NumPoints": SHAPE[1],
        "NumProfiles": SHAPE[0],
        "Xscale": PIXEL,
        "Yscale": PIXEL,
        "Zscale": 1e-9,
        "Zresolution": -1,
        "Compression": 0,
        "DataType": 6,
        "CheckType": 0,
    }
    lines = ["aISO-1.0", *(f"{name} = {value}" for name, value in header.items()), "*"]
    for row, known in zip(height, valid, strict=True):
        lines.append(" ".join(str(value) if good else "BAD" for value, good in zip(row, known, strict=True)))
    path.write_bytes("\r\n".join([*lines, "*", ""]).encode("ascii"))


def write_bcr_sdf(path, height, valid):
    header = struct.pack(
        "<8s10s12s12sHHddddBBB",
        b"bBCR-1.0",
        b"asperity".ljust(10),
        b"010120200000",
        b"010120200000",
        SHAPE[1],
        SHAPE[0],
        PIXEL,
        PIXEL,
        1e-9,
        -1.0,
        0,
        5,  # 16-bit integers
        0,
    )
    path.write_bytes(header + np.where(valid, height, -(2**15)).astype("<i2").tobytes())


def write_asc(path, height, valid):
    size = [f"{1e6 * PIXEL * n:g}" for n in SHAPE]
    header = f"# Channel: Height\n# Width: {size[1]} µm\n# Height: {size[0]} µm\n# Value units: nm\n"
    rows = (
        "\t".join(f"{v}" if k else "nan" for v, k in zip(*row, strict=True))
        for row in zip(height, valid, strict=True)
    )
    path.write_text(header + "\n".join(rows) + "\n", encoding="utf-8")


def write_netcdf(path, height, valid):
    with netcdf_file(path, "w", version=2) as file:
        for axis, points in (("x", SHAPE[1]), ("y", SHAPE[0])):
            file.createDimension(axis, points)
            variable = file.createVariable(axis, "f4", (axis,))
            variable[:] = 2.0 * np.arange(points)
            variable.length = 2.0 * points
            variable.unit = "um"
        heights = file.createVariable("heights", "f8", ("x", "y"))
        heights[:] = 1e-3 * np.where(valid, height, 0).T
        heights.unit = "um"
        mask = file.createVariable("mask", "i1", ("x", "y"))
        mask[:] = ~valid.T


def write_xyz(path, height, valid):
    lines = ["# Channel: Height", "# Lateral units: µm", "# Value units: nm"]
    for row, column in np.argwhere(valid):
        lines.append(f"{1e6 * PIXEL * column:.1f}\t{1e6 * PIXEL * row:.1f}\t{height[row, column]}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_npy(path, height, valid):
    stream = io.BytesIO()
    np.save(stream, np.where(valid, 1e-3 * height, np.nan).astype("<f4"))
    path.write_bytes(stream.getvalue())


WRITERS = {
    "steel.x3p": write_x3p,
    "steel.gwy": write_gwy,
    "steel.sdf": write_sdf,
    "steel_bcr.sdf": write_bcr_sdf,
    "steel.asc": write_asc,
    "steel.nc": write_netcdf,
    "steel.xyz": write_xyz,
    "steel.npy": write_npy,
}


def main():
    height, valid = ground_steel()
    for name, write in WRITERS.items():
        write(FOLDER / name, height, valid)


if __name__ == "__main__":
    main()
