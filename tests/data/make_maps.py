"""The surface of the test maps, and its file in the format X3P.

All files `steel.*` hold this surface: steel, ground along y, 40 x 48 pixels of 2 µm, in whole nanometres,
with a tilt, spikes of an optical instrument, and points without data. The writer follows ISO 25178-72 (ZIP
archive of ``main.xml``, 16-bit heights, validity bits and an MD5 sum).
"""

import hashlib
import zipfile

import numpy as np

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


def write_x3p(path, height, valid, pixel=PIXEL):
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
      <CX><AxisType>I</AxisType><DataType>D</DataType><Increment>{pixel!r}</Increment><Offset>0</Offset></CX>
      <CY><AxisType>I</AxisType><DataType>D</DataType><Increment>{pixel!r}</Increment><Offset>0</Offset></CY>
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
    <MatrixDimension><SizeX>{height.shape[1]}</SizeX><SizeY>{height.shape[0]}</SizeY><SizeZ>1</SizeZ></MatrixDimension>
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
