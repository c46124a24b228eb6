"""Maps as instruments and programs write them: each kind is made here, with heights that are known."""

import re

import foreign_files
import numpy as np
import pandas as pd
import pytest
import xarray as xr

import asperity as asp
from asperity.engineering.face import read_face
from asperity.settings.map import CounterMap, Map
from asperity.surface.description import describe_map, map_doubts, prepare_map
from asperity.surface.reading.agreement import repeated_height
from asperity.surface.reading.height_map import MapError, MapOptions
from asperity.surface.reading.map_file import read_map

pytest.importorskip("SurfaceTopography")

HEIGHT = np.random.default_rng(3).normal(size=(8, 6)).round(3)
BARE = {"physical_size": (8, 6), "unit": "um", "orientation": "peaks up"}


RAW = np.random.default_rng(7).integers(-120, 120, size=(8, 6))
SIZE = (16e-6, 12e-6)


def assert_read(path, raw=RAW, size=SIZE, **options):
    found = read_map(path, **options)
    np.testing.assert_allclose(found.height, 1e-9 * raw, rtol=1e-6)  # single precision of some formats
    assert found.length == pytest.approx(size, rel=1e-6)


def quoted(rows, text, separator=","):
    return "\n".join(separator.join(f'"{text(value)}"' for value in row) for row in rows) + "\n"


def german(value):
    return f"{value:,.3f}".translate(str.maketrans(".,", ",."))


@pytest.mark.parametrize(
    ("text", "height"),
    [
        (quoted(4 + HEIGHT / 9, "{:.3f}".format), (4 + HEIGHT / 9).round(3)),
        # 3,917: as pandas writes with decimal=","
        (quoted(4 + HEIGHT / 9, german), (4 + HEIGHT / 9).round(3)),
        (quoted(HEIGHT, german, ";"), HEIGHT),
        (quoted(4 + HEIGHT.round(1), "{:.5g}".format).replace(".", ","), 4 + HEIGHT.round(1)),  # 4 and 3,9
        (quoted(4500 + HEIGHT, "{:,.1f}".format), (4500 + HEIGHT).round(1)),
        (quoted(4500 + HEIGHT, german, ";"), (4500 + HEIGHT).round(3)),
        (quoted(HEIGHT, "{:.3f}".format, " "), HEIGHT),
    ],
)
def test_quoted_numbers_are_split_as_csv(tmp_path, text, height):
    (tmp_path / "map.csv").write_text(text)
    np.testing.assert_allclose(read_map(tmp_path / "map.csv", **BARE).height, 1e-6 * height, rtol=1e-12)


def test_quoted_points_are_a_map(tmp_path):
    y, x = np.mgrid[:8, :6] * 0.5
    points = quoted(zip(x.flat, y.flat, HEIGHT.flat, strict=True), german)
    for heading, unit, lateral in (("", "um um", 1e-6), ('"x [mm]","y [mm]","z [um]"\n', None, 1e-3)):
        (tmp_path / "map.csv").write_text(heading + points)
        found = read_map(tmp_path / "map.csv", unit=unit)
        assert found.length == pytest.approx((4 * lateral, 3 * lateral))
        np.testing.assert_allclose(found.height, 1e-6 * HEIGHT, rtol=1e-12)


def wyko(real):
    sizes = [("X Size", "8"), ("Y Size", "6"), ("Pixel_size", "7", "4", "0.002")]
    sizes += [("Wavelength", "7", "4", "632.8"), ("Mult", "7", "4", "1")]
    return [("Wyko ASCII Data File Format 0", real, "1"), *sizes, ("RAW_DATA", "3", "192", "")]


NOVA = [
    "File Format = ASCII",
    "NX = 6",
    "NY = 8",
    "Unit X = um",
    "Unit Data = nm",
    "Scale X = 2",
    "Scale Y = 2",
]
GWYDDION = ["Channel: Topography", "Width: 12.0 µm", "Height: 16.0 µm", "Value units: nm"]
SECOND = {"wyko": [("Intensity", "6", "192", "")], "gwyddion": GWYDDION}


@pytest.mark.parametrize(
    ("header", "factor", "second"),
    [
        (wyko("1"), 1.0, SECOND["wyko"]),
        (wyko("0"), 632.8, SECOND["wyko"]),  # heights in wavelengths
        (NOVA, 1.0, None),
        (GWYDDION, 1.0, SECOND["gwyddion"]),
        ([f"# {line}" for line in GWYDDION], 1.0, [f"# {line}" for line in GWYDDION]),
    ],
    ids=["wyko", "waves", "nova", "gwyddion", "gwyddion #"],
)
def test_headings_are_read_with_every_separator(tmp_path, header, factor, second):
    """Also if another block follows, whose channel is another one."""

    def block(lines, rows, separator):
        words = [line if isinstance(line, str) else separator.join(line) for line in lines]
        return "\n".join([*words, *(separator.join(f"{z:.3f}" for z in row) for row in rows)]) + "\n"

    for separator in "\t ;":
        for channel, more in ((0, None), (0, second), *([(1, second)] if second else [])):
            text = block(header, HEIGHT, separator) + (block(more, 1000 + HEIGHT, separator) if more else "")
            (tmp_path / "map.asc").write_text(text)
            expected = 1e-9 * factor * (HEIGHT + 1000 * channel)
            assert_read(tmp_path / "map.asc", 1e9 * expected, channel=channel)


def test_a_wrong_row_below_a_heading_is_refused(tmp_path):
    (tmp_path / "map.asc").write_text("\n".join([*GWYDDION, "1 2 3 4", "1 x 3 4", "1 2 3 4"]))
    with pytest.raises(MapError, match=re.escape("line 6: 'x' is no number")):
        read_map(tmp_path / "map.asc")


@pytest.mark.parametrize(
    ("names", "chosen"),
    [
        (["mask", "height"], "height"),
        (["intensity", "topography"], "topography"),
        (["HeightRetrace", "DeflectionRetrace", "HeightTrace"], "HeightTrace"),
        (
            ["Scan forward (Deflection)", "Scan backward (Z-Axis)", "Scan forward (Z-Axis)"],
            "Scan forward (Z-Axis)",
        ),
        (["vDeflection", "measuredHeight"], "measuredHeight"),
        (["a", "b"], None),
        (["Height Sensor", "Peak Force Error", "Height"], None),
        (["Topography", "Topography 2"], None),
        (["Phase", "Error"], None),
    ],
)
def test_channel_of_heights_is_found_by_name(tmp_path, names, chosen):
    arrays = {name: HEIGHT + number for number, name in enumerate(names)}
    np.savez(tmp_path / "map.npz", **arrays)
    if chosen is None:
        with pytest.raises(MapError, match=r"channel: .*; set it$"):
            read_map(tmp_path / "map.npz", **BARE)
    else:
        assert read_map(tmp_path / "map.npz", **BARE).channel == chosen
    found = read_map(tmp_path / "map.npz", **BARE, channel="1")
    np.testing.assert_allclose(found.height, 1e-6 * arrays[names[1]], rtol=1e-15)


def test_absent_channel_of_text_is_refused(tmp_path):
    np.savetxt(tmp_path / "map.txt", HEIGHT)
    with pytest.raises(MapError, match=re.escape("channel = '5': one of 0 (Default) is needed")):
        read_map(tmp_path / "map.txt", **BARE, channel="5")


X3P = [
    *({"revision": "ISO5436 – 2000"}, {"revision": "ISO25178-72:2017"}, {"folder": "scan/"}),
    *({"folder": "Scan 1\\", "member": "bindata\\data.bin"}, {"link": "./bindata/data.bin"}),
    *({"member": "BinData/Data.bin"}, {"listed": "{:.9e}"}, {"type": "I", "axis": "I", "increment": "1e-9"}),
    *({"type": "I", "increment": "1,0E-09", "pixel": "2,0E-06"}, {"type": "F", "increment": "0"}),
    *({"prefix": ""}, {"md5": ""}, {"md5": "not available"}),
]


@pytest.mark.parametrize("kind", X3P, ids=str)
def test_x3p_of_every_writer_is_read(tmp_path, kind):
    foreign_files.write_x3p(tmp_path / "map.x3p", RAW, **kind)
    assert_read(tmp_path / "map.x3p")


@pytest.mark.parametrize(
    ("kind", "line"),
    [
        ({"md5": "0" * 32}, "its heights do not have the checksum that it states"),
        ({"main_md5": "0" * 32}, "its main.xml do not have the checksum that it states"),
        ({"feature": "PCL"}, "a map is needed (FeatureType SUR, SizeZ 1), not PCL of SizeZ 1"),
        ({"member": "data.bin"}, "its member bindata/data.bin is missing"),
    ],
)
def test_damaged_x3p_is_refused(tmp_path, kind, line):
    foreign_files.write_x3p(tmp_path / "map.x3p", RAW, **kind)
    with pytest.raises(MapError, match=re.escape(line)):
        read_map(tmp_path / "map.x3p")


@pytest.mark.parametrize(
    ("size", "kind", "expected"),
    [
        ("16 8 ~m", {"aspect": "2:1"}, (8e-6, 16e-6)),
        ("16 16 ~m", {}, (16e-6, 16e-6)),  # fewer lines than points, but of a square
        ("16 ~m", {"listed": 16}, (8e-6, 16e-6)),  # captured early
        ("16 16 ~m", {"listed": 16, "aspect": "4:1"}, (2e-6, 16e-6)),
        ("16 4 ~m", {"listed": 16, "aspect": "4:1"}, (2e-6, 16e-6)),
        ("16 16 ~m", {"listed": 16, "slow": "8000 nm"}, (4e-6, 2e-6)),
        ("16 16 ~m", {"lines": 64, "aspect": "8:1", "listed": 2}, (2e-6, 16e-6)),
        ("16 16 ~m", {"aspect": "2:1", "keys": str.lower}, (8e-6, 16e-6)),
    ],
)
def test_scans_that_are_not_square_have_their_size(tmp_path, size, kind, expected):
    foreign_files.write_bruker(tmp_path / "map.spm", RAW, size, **kind)
    assert_read(tmp_path / "map.spm", RAW[::-1], expected)  # the last line of the scan is the lowest y


LOWEST = {3: np.finfo("f4").min, 4: -128, 5: -32768, 7: np.finfo("f8").min}


def test_sdf_of_every_version_is_read(tmp_path):
    """Every heading, text and binary, with every type of numbers."""
    expected = RAW.astype(float)
    expected[0, 0] = np.nan
    headings = "aISO-1.0 aBCR-1.0 aNPL-V1.0 aBC-1.0 aBCR-0.0 \r\naISO-2.0 bISO-1.0 bBCR-1.0 bISO-2.0"
    for number, heading in enumerate(headings.split(" ")):
        for data_type in LOWEST if number in (0, 6) else [[*LOWEST][number % 4]]:
            kind = {"heading": heading, "data_type": data_type, "gap": LOWEST[data_type]}
            foreign_files.write_sdf(tmp_path / "map.sdf", RAW, **kind)
            assert_read(tmp_path / "map.sdf", expected)


@pytest.mark.parametrize(
    "comment", [b"", b"a", b"Created by something with a long name" * 3, b"x".ljust(23, b"\0")]
)
def test_a_truemap_with_any_comment_is_read(tmp_path, comment):
    foreign_files.write_tmd(tmp_path / "map.tmd", RAW, comment, end=b"\n")
    assert_read(tmp_path / "map.tmd")


@pytest.mark.parametrize("packed", [0, 1, 3])
def test_surf_is_read_in_every_form(tmp_path, packed):
    for unit in (b"\xb5m", "µm".encode(), "μm".encode(), b"um", b"\xe6m"):
        foreign_files.write_sur(tmp_path / "map.sur", RAW, unit=unit, packed=packed)
        assert_read(tmp_path / "map.sur")
    with pytest.raises(MapError, match=r"the file holds .* GiB of data"):
        read_map(tmp_path / "map.sur", max_memory=1e-9)


def test_heights_without_unit_take_the_option(tmp_path):
    foreign_files.write_sur(tmp_path / "map.sur", RAW, z_unit=b"%")
    foreign_files.write_gwy(tmp_path / "map.gwy", [("Height", "m", "", RAW)])
    for name, unit in (("map.sur", "nm"), ("map.gwy", "m")):
        with pytest.raises(MapError, match="unit: the file does not say the unit of its heights; set it"):
            prepare_map(tmp_path / name, periodic="mirrored")
        assert_read(tmp_path / name, unit=unit)


def test_a_mask_is_no_gap_unless_asked(tmp_path):
    """A mask of grains is named; one over a single number hides non-measured points."""
    path, mask = tmp_path / "map.gwy", RAW > 60
    foreign_files.write_gwy(path, [("Height", "m", "m", RAW)], mask)
    assert_read(path)
    assert_read(path, np.where(mask, np.nan, RAW), mask="excluded")
    kept, left_out = (read_map(path, mask=each).notes for each in (None, "excluded"))
    assert kept == (
        f"mask: {mask.sum()} points that the file marks are kept; set it to excluded to leave them out",
    )
    assert left_out == (f"mask: {mask.sum()} points that the file marks are left out",)
    assert describe_map(path, MapOptions()).properties["mask"] == kept[0]
    assert kept[0] in prepare_map(path, periodic="mirrored").done
    foreign_files.write_gwy(path, [("Height", "m", "m", np.where(mask, 0, RAW))], mask)
    assert_read(path, np.where(mask, np.nan, RAW))
    foreign_files.write_gwy(path, [("Height", "m", "m", RAW)])
    with pytest.raises(MapError, match="mask = 'excluded': the file has no mask; leave it out"):
        read_map(path, mask="excluded")


def test_void_pixels_are_points_without_data(tmp_path):
    void = RAW > 60
    foreign_files.write_spip(tmp_path / "map.asc", RAW, void)
    assert_read(tmp_path / "map.asc", np.where(void, np.nan, RAW))
    text = (tmp_path / "map.asc").read_text("ascii")
    rows = text.splitlines()
    rows[-8:] = (row.replace("0", "0.0").replace("1", "1.0") for row in rows[-8:])
    (tmp_path / "decimals.asc").write_text("\n".join(rows), encoding="ascii")
    assert_read(tmp_path / "decimals.asc", np.where(void, np.nan, RAW))
    (tmp_path / "map.asc").write_text(text.replace("voidpixels", "offset"), encoding="ascii")
    with pytest.raises(MapError, match="rows") as caught:
        read_map(tmp_path / "map.asc")
    assert "object at" not in str(caught.value)


def test_heights_that_are_no_lengths_ask_for_their_unit(tmp_path):
    foreign_files.write_fringes(tmp_path / "map.datx", RAW)
    with pytest.raises(MapError, match="unit: the file says 'Fringes', which is no unit of length; set it"):
        prepare_map(tmp_path / "map.datx", periodic="mirrored", physical_size=("16 um", "12 um"))
    given = {"unit": "nm", "height_factor": 316.4, "physical_size": ("16 um", "12 um")}
    expected = np.where(RAW.max() == RAW, np.nan, 316.4 * RAW)
    assert_read(tmp_path / "map.datx", expected, orientation="peaks up", **given)


MASK = (HEIGHT > 0.3).astype(float)


@pytest.mark.parametrize("write", ["npz", "h5", "nc"])
@pytest.mark.parametrize(
    ("arrays", "chosen"),
    [
        ({"roi": MASK, "height_image": HEIGHT}, "height_image"),
        ({"grain_masks": MASK, "image": HEIGHT}, "image"),
        ({"above": MASK, "image": HEIGHT}, "image"),
        ({"labels": np.arange(48).reshape(8, 6) // 12, "scan": HEIGHT}, "scan"),
        ({"selected": MASK, "heightmap": HEIGHT}, "heightmap"),
        ({"laser": HEIGHT + 1, "laser_topo": HEIGHT}, "laser_topo"),
        ({"above": MASK, "light": HEIGHT}, None),
        ({"above": HEIGHT + 1, "image": HEIGHT}, None),
    ],
)
def test_a_mask_is_never_taken_for_heights(tmp_path, write, arrays, chosen):
    path = tmp_path / f"map.{write}"
    if write == "npz":
        np.savez(path, **arrays)
    elif write == "h5":
        with pytest.importorskip("h5py").File(path, "w") as file:
            for name, values in arrays.items():
                file[f"scan/{name}"] = values
    else:
        xr.Dataset({name: (("y", "x"), values) for name, values in arrays.items()}).to_netcdf(path)
    if chosen is None:
        with pytest.raises(MapError, match=r"channel: .*; set it$"):
            read_map(path, **BARE)
    else:
        np.testing.assert_allclose(read_map(path, **BARE).height, 1e-6 * HEIGHT, rtol=1e-12)


def test_attributes_of_hdf5_are_used(tmp_path):
    h5py, edges = pytest.importorskip("h5py"), ("8 um", "6 um")
    numbers = np.rint(1e4 * HEIGHT).astype("i4")
    for unit in ("um", np.bytes_("um")):
        with h5py.File(tmp_path / "map.h5", "w") as file:
            file["height"] = numbers
            file["height"].attrs.update(units=unit, scale_factor=1e-4, _FillValue=numbers[2, 3])
        found = read_map(tmp_path / "map.h5", physical_size=edges, orientation="peaks up")
        expected = np.where(numbers == numbers[2, 3], np.nan, 1e-6 * HEIGHT)
        np.testing.assert_allclose(found.height, expected, rtol=1e-9)


def test_an_array_of_objects_beside_heights_is_left_out(tmp_path):
    meta = np.array({"pixel": 1.0}, dtype=object)
    np.savez(tmp_path / "map.npz", meta=meta, height=HEIGHT)
    np.testing.assert_allclose(read_map(tmp_path / "map.npz", **BARE).height, 1e-6 * HEIGHT, rtol=1e-15)
    np.savez(tmp_path / "map.npz", meta=meta)
    with pytest.raises(MapError, match="it holds no array of real numbers with two dimensions"):
        read_map(tmp_path / "map.npz", **BARE)


@pytest.mark.parametrize("write", ["mat", "h5"])
def test_arrays_of_other_kinds_are_no_heights(tmp_path, write):
    h5py, path = pytest.importorskip("h5py"), tmp_path / f"map.{write}"
    kinds = {"logical": HEIGHT > 0, "complex": HEIGHT + 1j, "words": np.full((8, 6), b"1")}
    for name, values in kinds.items():
        for beside in ({}, {"b": HEIGHT}):
            arrays = {"a": values, **beside}
            if write == "mat":
                pytest.importorskip("scipy.io").savemat(path, arrays)
            else:
                with h5py.File(path, "w") as file:
                    file.update(arrays)
            if beside:
                np.testing.assert_array_equal(read_map(path, **BARE).height, 1e-6 * HEIGHT, err_msg=name)
            else:
                with pytest.raises(MapError, match=r"none of 0 \(a\) holds heights|not a height map"):
                    read_map(path, **BARE)


def test_masked_points_are_without_data():
    masked, gaps = np.ma.masked_greater(HEIGHT, 1.0), np.where(HEIGHT > 1.0, np.nan, HEIGHT)
    expected = asp.prepare_map(asp.HeightMap(gaps, (8, 6)), periodic="mirrored", undefined="harmonic")
    found = asp.prepare_map(asp.HeightMap(masked, (8, 6)), periodic="mirrored", undefined="harmonic")
    np.testing.assert_array_equal(found.height, expected.height)
    steel, given = asp.Body(young="210 GPa", poisson=0.3), {"length": (8e-6, 6e-6), "mean_pressure": "1 GPa"}
    pressed = [asp.run(1e-8 * each, steel, **given).contact for each in (masked, gaps)]
    assert pressed[0].maximum_pressure == pressed[1].maximum_pressure
    with pytest.raises(ValueError, match="height: an array without masked elements is needed"):
        asp.solve_contact(masked, asp.Solid(1.0, 0.3), mean_pressure=1e-3)
    for wrong in (HEIGHT > 0, HEIGHT.astype(str), HEIGHT + 0j, np.ma.masked_equal(HEIGHT > 0, True)):
        with pytest.raises(MapError, match="height"):
            asp.run(wrong, steel, **given)


def test_force_curves_beside_a_map_are_left_out(tmp_path):
    curves = np.zeros((3, 40))
    forward, deflection = ("Z-Axis", "m", "m", RAW), ("Deflection", "m", "m", 5 * RAW)
    for channels in (
        [deflection, forward],
        [("Deflection", "V", "m", curves), forward],
        [forward, ("Z", "s", "m", curves)],
    ):
        foreign_files.write_nid(tmp_path / "map.nid", channels)
        found = read_map(tmp_path / "map.nid")
        np.testing.assert_allclose(found.height, 1e-9 * RAW, rtol=1e-6, atol=1e-15)
        assert found.channel == "Scan forward (Z-Axis)"
    foreign_files.write_nid(tmp_path / "map.nid", [("Deflection", "V", "m", curves)])
    with pytest.raises(MapError, match="it has no channel that is a map of heights"):
        read_map(tmp_path / "map.nid")


@pytest.mark.parametrize("pixel", [2000.0, 0.002])
def test_a_nanofocus_pixel_is_in_nm_or_mm(tmp_path, pixel):
    foreign_files.write_nms(tmp_path / "map.nms", RAW + 500, pixel)
    assert_read(tmp_path / "map.nms", RAW + 500)


@pytest.mark.parametrize(
    ("kind", "name"),
    [("virtual", "map.h5"), ("virtual without its source", "map.nc"), ("external", "map.h5")],
)
def test_numbers_in_another_file_are_refused(tmp_path, kind, name):
    """They would be read as zeros where the other file is missing."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["height"] = HEIGHT
    with h5py.File(tmp_path / name, "w") as file:
        if kind == "external":
            HEIGHT.tofile(tmp_path / "raw")
            file.create_dataset("height", HEIGHT.shape, "f8", external=[(tmp_path / "raw", 0, HEIGHT.nbytes)])
        else:
            layout = h5py.VirtualLayout(HEIGHT.shape, "f8")
            layout[:] = h5py.VirtualSource(tmp_path / "other.h5", "height", HEIGHT.shape)
            file.create_virtual_dataset("height", layout)
        for axis, n in zip("yx", HEIGHT.shape, strict=True):
            file[axis] = np.arange(n)
            file[axis].make_scale(axis)
            file["height"].dims["yx".index(axis)].attach_scale(file[axis])
    if "without" in kind:
        (tmp_path / "other.h5").unlink()
    with pytest.raises(MapError, match="the numbers of its dataset height lie in other files"):
        read_map(tmp_path / name, **BARE)


def test_a_chunk_that_unpacks_to_much_is_refused(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "map.h5", "w") as file:
        shape = {"shape": (8, 6), "maxshape": (None, None), "chunks": (2000, 2000), "compression": "gzip"}
        file.create_dataset("height", dtype="f8", **shape)[:] = HEIGHT
    with pytest.raises(MapError, match=r"max_memory = 0\.01 GiB: the file holds 0\.0298 GiB of data or more"):
        read_map(tmp_path / "map.h5", **BARE, max_memory=0.01)
    np.testing.assert_array_equal(read_map(tmp_path / "map.h5", **BARE).height, 1e-6 * HEIGHT)


def of_axes(y="y", x="x", units="mm", height="height", step=2e-3):
    places = {
        axis: (axis, step * np.arange(n), {"units": units})
        for axis, n in zip((y, x), HEIGHT.shape, strict=True)
    }
    return xr.Dataset({height: ((y, x), HEIGHT, {"units": "um"})}, places)


@pytest.mark.parametrize(
    "dataset",
    [
        of_axes(),
        of_axes().assign(height=of_axes().height.assign_attrs(orientation="peaks up")),
        of_axes("lat", "lon", height="elevation"),
        of_axes("row", "col", "um", step=2.0).isel(row=slice(None, None, -1)),
        of_axes().assign(mask=(("y", "x"), HEIGHT)),
    ],
)
def test_netcdf_has_named_axes_with_units(tmp_path, dataset):
    for version in ("NETCDF4", "NETCDF3_64BIT"):
        dataset.to_netcdf(tmp_path / f"{version}.nc", format=version)
        assert_read(tmp_path / f"{version}.nc", 1e3 * HEIGHT, orientation="peaks up")


def test_netcdf_without_edges_asks_for_them(tmp_path):
    for name, dataset in (
        ("degrees", of_axes("lat", "lon", "degrees")),
        ("numbers", of_axes(units="", step=1)),
    ):
        dataset.to_netcdf(tmp_path / f"{name}.nc")
        with pytest.raises(MapError, match="physical_size: the file does not say the edges"):
            read_map(tmp_path / f"{name}.nc", orientation="peaks up")
    uneven = of_axes().assign_coords(y=np.arange(8) ** 2.0)
    uneven.to_netcdf(tmp_path / "uneven.nc")
    with pytest.raises(MapError, match="the positions y are not equally spaced"):
        read_map(tmp_path / "uneven.nc", orientation="peaks up")


def test_arrays_are_taken_by_their_axes():
    """DataArrays and DataFrames give what the plain array gives."""
    expected = asp.solve_contact(HEIGHT, asp.Solid(1.0, 0.3), 1.0, mean_pressure=0.1).pressure
    array = xr.DataArray(HEIGHT, dims=("y", "x"), coords={"y": np.arange(8), "x": np.arange(6)})
    frame = pd.DataFrame(HEIGHT, columns=[f"{0.5 * n}" for n in range(6)])
    mixed = frame.iloc[::-1, [3, 0, 5, 1, 4, 2]]
    for given in (
        array.T,
        array[::-1],
        array[[3, 1, 0, 2, 5, 4, 7, 6]].rename(y="Y", x="X").T,
        array.rename(y="row", x="col").T,
        array.drop_vars(["y", "x"]).rename(y="dim_0", x="dim_1"),
        frame,
        mixed,
    ):
        found = asp.solve_contact(given, asp.Solid(1.0, 0.3), 1.0, mean_pressure=0.1).pressure
        np.testing.assert_array_equal(found, expected)
        np.testing.assert_array_equal(asp.HeightMap(given, (8.0, 6.0)).height, HEIGHT)
    with pytest.raises(ValueError, match="height over a and b: an array over the axes y and x is needed"):
        asp.solve_contact(array.rename(y="a", x="b"), asp.Solid(1.0, 0.3), 1.0, mean_pressure=0.1)
    with pytest.raises(ValueError, match="height: a position is given to several columns"):
        asp.solve_contact(
            frame.set_axis([0, 1, 1, 2, 3, 4], axis=1), asp.Solid(1.0, 0.3), 1.0, mean_pressure=0.1
        )


@pytest.mark.parametrize(
    ("value", "dtype"),
    [(-9999.0, "f8"), (-32768.0, "f4"), (65535.0, "f4"), (1e30, "f8"), (1e20, "f4"), (0.0, "f8")],
)
def test_missing_points_are_named_and_set(tmp_path, value, dtype):
    """A round hole in heights of about 100 µm."""
    rough = 100 + np.random.default_rng(2).normal(size=(30, 40))
    array = np.where(np.hypot(*np.mgrid[-15:15, -18:22]) < 6, value, rough).astype(dtype)
    np.save(tmp_path / "map.npy", array)
    options = {"physical_size": ("3 mm", "4 mm"), "unit": "um", "orientation": "peaks up"}
    count = int(np.sum(array == array.dtype.type(value)))
    found = describe_map(tmp_path / "map.npy", MapOptions(**options))
    (doubt,) = [text for text in (*map(str, found.doubts), *found.needed) if text.startswith("missing")][-1:]
    assert doubt.startswith(f"missing: {count} points")
    assert f"have the height {value:.9g}" in doubt.replace(f"{float(np.float32(value)):.9g}", f"{value:.9g}")
    said = read_map(tmp_path / "map.npy", **options, missing=value)
    assert said.missing == count
    assert np.nanmax(np.abs(said.height - 1e-4)) < 1e-5
    assert not describe_map(tmp_path / "map.npy", MapOptions(**options, missing=value)).doubts
    with pytest.raises(MapError, match=r"missing = 7: no point has this height; leave it out"):
        read_map(tmp_path / "map.npy", **options, missing=7)


@pytest.mark.parametrize("levels", [3, 20, 2000])
def test_quantised_maps_have_no_missing_points(levels):
    heights = np.random.default_rng(2).normal(size=(300, 400))
    for height in (np.round(levels * heights), np.cos(np.arange(400) * 2 * np.pi / 16) * np.ones((300, 1))):
        assert repeated_height(height) is None


def test_doubts_about_edges_are_named():
    rough = asp.self_affine((64, 64), 0.8, 5e-5, 1e-5, rms_height=1e-7, seed=1, length=1e-4)
    for length, words in (
        ((1e-4, 1e-4), []),
        ((0.9, 0.9), ["Sdq of"]),
        ((2.0, 2.0), ["an edge of 2 m", "Sdq of"]),
        ((3e-4, 1e-4), ["pixels of 4.69 µm x 1.56 µm (y, x), 3 to 1"]),
        ((1e-7, 1e-7), ["Sdq of"]),
    ):
        found = map_doubts(asp.HeightMap(rough, length, unit="m"), MapOptions())
        assert [each.text[: len(word)] for each, word in zip(found, words, strict=True)] == words
        assert all(each.option == "physical_size" for each in found)


def test_shared_options_fill_what_files_omit(tmp_path):
    """Also options of a map and its counter map, and a channel that only one of the files has."""
    own, bare = tmp_path / "a.x3p", tmp_path / "b.npz"
    foreign_files.write_x3p(own, RAW)
    np.savez(bare, z=1e-3 * RAW, mask=RAW)
    known = {"physical_size": ("16 um", "12.1 um"), "unit": "um"}
    options = Map(file=bare, **known, channel="z")
    assert read_face(options.replaced(file=own), shared=True).options == Map(file=own)
    assert read_face(Map(file=bare, **known), shared=True).options == options
    alone = read_face(Map(file=own, **known)).face
    assert [line.partition(":")[0] for line in alone.done if " is given, the" in line] == [
        "unit",
        "physical_size",
    ]
    turned = read_face(Map(file=own, **known), CounterMap(file=bare))
    assert not any(" is given, the" in line for line in turned.face.done)
    assert turned.counter == CounterMap(file=bare, **known)  # a case that is written needs them
    pair = read_face(options, CounterMap(file=own))
    assert pair.options == options
    assert pair.face.name == "b on a"
    assert not any(" is given, the" in line for line in pair.face.done)


def test_options_of_the_counter_map_itself_override_its_file(tmp_path):
    """With a note, as for the map."""
    own, bare = tmp_path / "a.x3p", tmp_path / "b.npz"
    foreign_files.write_x3p(own, RAW)
    np.savez(bare, z=1e-3 * RAW[::-1])
    edges = "16 um", "12.1 um"
    other = Map(file=bare, channel="z", unit="um", physical_size=edges, periodic="windowed")
    one, three = (
        read_face(other, CounterMap(file=own, **given)).face for given in ({}, {"height_factor": 3})
    )
    alone = read_face(other, CounterMap(file=own, height_factor=1e-12)).face
    np.testing.assert_allclose(three.height - alone.height, 3 * (one.height - alone.height), atol=1e-12)
    assert "counter map: height_factor: 3 is given, the file says 1" in three.done
    with pytest.raises(MapError, match="channel = 'z'"):
        read_face(other, CounterMap(file=own, channel="z"))


@pytest.mark.parametrize(
    ("name", "write", "line"),
    [
        ("m.csv", lambda path: path.write_text("1 2 3 4\n1 #x 3 4\n1 2 3 4\n"), "line 2: '#x' is no number"),
        ("m.sdf", lambda path: foreign_files.write_sdf(path, RAW[:1]), "not a line scan of 6 points"),
        ("m.x3p", lambda path: foreign_files.write_x3p(path, RAW[:1]), "not a line scan of 6 points"),
        (
            "m.nc",
            lambda path: path.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(400)),
            "a file without damage is needed",
        ),
    ],
)
def test_file_without_map_is_refused(tmp_path, name, write, line):
    write(tmp_path / name)
    with pytest.raises(MapError, match=re.escape(line)) as caught:
        read_map(tmp_path / name)
    assert len(caught.value.problems) == 1


def test_line_scans_of_instruments_can_be_declared(tmp_path):
    """Such as the softgauges of NPL, and profiles in X3P."""
    line = RAW[:1]
    foreign_files.write_sdf(tmp_path / "a.sdf", line, heading="aNPL-V1.0", y_scale=0.0, data_type=7)
    foreign_files.write_x3p(tmp_path / "b.x3p", line, feature="PRF")
    for name in ("a.sdf", "b.x3p"):
        with pytest.raises(MapError, match="not a line scan of 6 points; set format to profile to take it"):
            read_map(tmp_path / name)
        assert_read(tmp_path / name, np.tile(line, (4, 1)), (4 * 2e-6, 6 * 2e-6), format="profile")
    foreign_files.write_x3p(tmp_path / "map.x3p", RAW)
    with pytest.raises(
        MapError, match=r"format = 'profile': a line scan is needed, not a map of \(8, 6\) points"
    ):
        read_map(tmp_path / "map.x3p", format="profile")
