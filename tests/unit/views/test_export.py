"""Exports: the table of peaks, and images read back by a parser of their own."""

import struct
import xml.etree.ElementTree as ET

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import asperity as asp
from asperity.cli.main import main
from asperity.views import export
from asperity.views.source import sources

EDGE, PRESSURE = (512e-6, 256e-6), 50e6
Q = 2 * np.pi / EDGE[1]


def wave(shape=(16, 32)):
    """Half-space under p (1 + cos q x), in SI."""
    grid = asp.Grid(shape, EDGE)
    field = np.tile(PRESSURE * (1 + np.cos(Q * grid.coordinates()[1])), (shape[0], 1))
    return asp.LoadedSolid(field, grid, asp.Solid(210e9, 0.3))


def read_image(path):
    """Positions x, y, z of the nodes and fields [z, y, x] of VTK image data with appended raw data."""
    head, data = path.read_bytes().split(b'<AppendedData encoding="raw">_', 1)
    root = ET.fromstring(head + b"</VTKFile>")
    assert root.get("type") == "ImageData"
    assert (root.get("byte_order"), root.get("header_type")) == ("LittleEndian", "UInt64")
    (image,) = root
    extent, origin, spacing = (
        [float(word) for word in image.get(n).split()] for n in ("WholeExtent", "Origin", "Spacing")
    )
    assert image.find("Piece").get("Extent") == image.get("WholeExtent")
    axes = [
        o + s * np.arange(first, last + 1)
        for o, s, first, last in zip(origin, spacing, extent[::2], extent[1::2], strict=True)
    ]
    shape = tuple(axis.size for axis in reversed(axes))
    fields = {}
    for array in image.find("Piece").find("PointData"):
        assert array.get("type") == "Float32"
        begin = int(array.get("offset"))
        (size,) = struct.unpack("<Q", data[begin : begin + 8])
        assert size == 4 * np.prod(shape)
        fields[array.get("Name")] = np.frombuffer(data[begin + 8 : begin + 8 + size], "<f4").reshape(shape)
    assert data[begin + 8 + size :] == b"\n</AppendedData></VTKFile>\n"
    return axes, fields


def write(path, solid, depth, y=None, x=None, spacing=None, fields=("von_mises",)):
    """Write a box of a solid in SI; its size."""
    depths = export.box_depths(sources(solid, "SI")[0], depth, spacing)
    box = asp.stress.stress_box(solid, depths, y, x, fields, tolerance=0.0)
    return export.write_box(box, path, export.ExportUnits.of("SI"))


def test_image_holds_the_stress_of_a_wave(tmp_path):
    """σ_zz = −p (1 + (1 + q d) exp(−q d) cos q x) and σ_xz = ±p q d exp(−q d) sin q x (Westergaard 1939)."""
    path = tmp_path / "wave.vti"
    assert write(path, wave(), (8e-6, 88e-6), spacing=16e-6, fields=("zz", "xz")) == path.stat().st_size
    (x, y, z), fields = read_image(path)
    np.testing.assert_allclose(x, np.arange(32) * 8)
    np.testing.assert_allclose(y, np.arange(16) * 32)
    np.testing.assert_allclose(z, np.arange(-88, 0, 16))
    depth, phase = Q * 1e-6 * -z[:, None, None] * np.ones((16, 1)), Q * 1e-6 * x
    decay = np.exp(-depth)
    assert list(fields) == ["zz_MPa", "xz_MPa"]
    zz, xz = -50 * (1 + (1 + depth) * decay * np.cos(phase)), 50 * depth * decay * np.sin(phase)
    np.testing.assert_allclose(fields["zz_MPa"], zz, rtol=2e-7, atol=1e-5)
    # The sign of a shear stress depends on the direction of z.
    np.testing.assert_allclose(np.abs(fields["xz_MPa"]), np.abs(xz), rtol=1e-6, atol=1e-5)


def contact_in_si():
    """A contact of a wave in SI, as stage contact writes it, and its source."""
    solid = wave()
    fields = {"pressure": solid.pressure, "gap": 1e-7 + 0 * solid.pressure}
    data = {name: (("y", "x"), values) for name, values in fields.items()}
    data = xr.Dataset(data, coords=solid.grid.dataset_coordinates(), attrs={"unit_system": "SI"})
    return solid, sources(data)[0]


def test_surface_fields_are_an_image_and_a_table(tmp_path):
    """The image has one layer."""
    solid, source = contact_in_si()
    image, table = tmp_path / "surface.vti", tmp_path / "surface.csv"
    part = export.surface_fields(source, source.part(y=(64e-6, 320e-6)))
    assert export.write_surface_image(image, part) == image.stat().st_size
    (x, y, z), found = read_image(image)
    np.testing.assert_allclose(x, 8.0 * np.arange(32), rtol=1e-12)
    np.testing.assert_allclose(y, 32.0 * np.arange(2, 11), rtol=1e-12)
    assert z.tolist() == [0.0]
    assert list(found) == ["pressure_MPa", "gap_um"]
    np.testing.assert_allclose(found["pressure_MPa"][0], solid.pressure[2:11] / 1e6, rtol=1e-6)
    assert found["gap_um"] == pytest.approx(0.1)
    count = export.write_surface_table(table, export.surface_fields(source, source.part()))
    frame = pd.read_csv(table)
    assert len(frame) == count == solid.grid.size
    assert list(frame) == ["y_um", "x_um", "pressure_MPa", "gap_um"]
    np.testing.assert_allclose(frame["pressure_MPa"], solid.pressure.ravel() / 1e6, rtol=1e-6)
    assert frame["x_um"][33] == pytest.approx(8.0)


def test_a_contact_writes_what_the_command_exports(tmp_path):
    height = asp.self_affine((32, 32), 0.8, 20e-6, 8e-6, rms_height=1e-7, seed=1, length=40e-6)
    grid = asp.Grid((32, 32), 40e-6)
    contact = asp.solve_contact(height, asp.Solid(210e9, 0.3), grid, contact_area_fraction=0.1)
    contact.to_netcdf(tmp_path / "contact.nc")
    asp.views.write_vtk(tmp_path / "surface.vti", contact)
    asp.views.write_vtk(tmp_path / "box.vti", contact, ("xx",), depth=(0, 2e-6), y=(0, 20e-6))
    command = ["export", str(tmp_path / "contact.nc")]
    assert main([*command, "--surface", str(tmp_path / "s.vti")]) == 0
    assert main([*command, "--field", "xx:0-2um", str(tmp_path / "b.vti"), "--y", "0-20um"]) == 0
    for mine, its in (("surface", "s"), ("box", "b")):
        written = [read_image(tmp_path / f"{name}.vti")[1] for name in (mine, its)]
        assert list(written[0]) == list(written[1])
        for name, values in written[0].items():
            np.testing.assert_allclose(values, written[1][name], rtol=1e-5, atol=1e-9)
    with pytest.raises(ValueError, match=r"depth = None: a pair"):
        asp.views.write_vtk(tmp_path / "box.vti", contact, ("xx",))
