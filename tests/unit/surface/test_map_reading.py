"""Reading of maps: every file family gives one surface; orientation, units, points, sizes, all problems."""

import gzip
import os
import re
import struct
import subprocess
import sys
import zipfile
from itertools import product
from pathlib import Path

import make_maps
import numpy as np
import pytest
import xarray as xr

from asperity import Solid, solve_contact
from asperity.cli.main import main
from asperity.settings.model import SettingsError
from asperity.surface.description import describe_map, map_doubts, prepare_map, spectrum_summary
from asperity.surface.reading.formats import known_formats
from asperity.surface.reading.height_map import HeightMap, MapError, MapOptions
from asperity.surface.reading.map_file import read_map
from asperity.surface.roughness import finest_tip, moments, texture
from asperity.surface.self_affine import self_affine
from asperity.surface.treatment import levelling

pytest.importorskip("SurfaceTopography")
tifffile = pytest.importorskip("tifffile")
Image = pytest.importorskip("PIL.Image")

DATA = Path(__file__).parents[2] / "data"
HEIGHT, VALID = make_maps.ground_steel()
EDGES = tuple(make_maps.PIXEL * n for n in make_maps.SHAPE)
ARRAY = {"physical_size": ("80 um", "96 um"), "unit": "um", "orientation": "peaks up"}


@pytest.mark.parametrize("name", [path.name for path in sorted(DATA.glob("steel*"))])
def test_every_family_of_files_gives_one_surface(name):
    found = read_map(DATA / name, **(ARRAY if name.endswith(".npy") else {}))
    expected = np.where(VALID, 1e-9 * HEIGHT, np.nan)
    # single precision of heights up to 16 µm in the NPY file, rounding in the others
    np.testing.assert_allclose(found.height, expected, atol=1e-12 if name.endswith(".npy") else 1e-19)
    assert found.length == pytest.approx(EDGES)
    assert (found.missing, found.orientation, found.periodic) == (len(make_maps.MISSING), "peaks up", False)


@pytest.mark.parametrize("name", ["steel.x3p", "steel_bcr.sdf"])
def test_a_gzip_file_is_read_like_its_content(tmp_path, name):
    (tmp_path / "map.gz").write_bytes(gzip.compress((DATA / name).read_bytes()))
    np.testing.assert_array_equal(read_map(tmp_path / "map.gz").height, read_map(DATA / name).height)


def test_a_channel_is_chosen_by_name_or_number():
    detail = 1e-9 * HEIGHT[:12, :16]
    for channel in ("Detail", 1, "1"):
        np.testing.assert_allclose(read_map(DATA / "steel.gwy", channel=channel).height, detail, rtol=1e-15)
    with pytest.raises(MapError, match=r"channel = 'Phase': one of 0 \(Height\), 1 \(Detail\) is needed"):
        read_map(DATA / "steel.gwy", channel="Phase")


@pytest.mark.filterwarnings("ignore:.*is m the unit", "ignore:.*is this right", "ignore:.*units")
def test_an_array_is_pressed_as_its_orientation_says(tmp_path):
    """Read from a file as a lower face, or upside down as a map."""
    height = np.random.default_rng(1).normal(size=(12, 16))
    for name, array in (("lower face", height), ("peaks up", -height)):
        np.save(tmp_path / "map.npy", array)
        options = MapOptions(physical_size=("0.75 m", "1 m"), unit="m", orientation=name)
        indenter = prepare_map(tmp_path / "map.npy", options, detrend="none", periodic="declared")
        np.testing.assert_allclose(indenter.height, height - height.mean(), atol=1e-15)
        np.testing.assert_array_equal(read_map(tmp_path / "map.npy", options).as_indenter(), height)


def test_a_surface_of_asperity_is_a_lower_face(tmp_path):
    y, x = (np.arange(n) * 1e-6 for n in (12, 16))
    text = {"units": "m", "long_name": "height of the indenter's lower face, measured upward, mean zero"}
    height = 1e-9 * HEIGHT[:12, :16]
    xr.Dataset({"height": (("y", "x"), height, text)}, {"y": y, "x": x}).to_netcdf(tmp_path / "s.nc")
    found = read_map(tmp_path / "s.nc")
    assert (found.orientation, found.periodic, found.unit) == ("lower face", True, "m")
    assert found.length == pytest.approx((12e-6, 16e-6))
    np.testing.assert_array_equal(found.as_indenter(), height)
    with pytest.raises(MapError, match="the file holds the lower face of an indenter; leave it out"):
        read_map(tmp_path / "s.nc", orientation="peaks up")
    xr.load_dataset(tmp_path / "s.nc").isel(y=slice(4, 12)).to_netcdf(tmp_path / "part.nc")
    with pytest.raises(MapError, match="y: the nodes of a whole cell are needed"):
        read_map(tmp_path / "part.nc")
    solve_contact(height, Solid(1e9, 0.3), 1e-4, contact_area_fraction=0.1).to_netcdf(tmp_path / "c.nc")
    with pytest.raises(MapError, match="a result of asperity without heights"):
        read_map(tmp_path / "c.nc")


@pytest.mark.parametrize(
    ("argument", "line"),
    [
        ({"physical_size": ("80 um", "2 s")}, "physical_size.1 = '2 s': a length > 0 with its unit"),
        ({"unit": "kg"}, "unit = 'kg': a unit of length is needed (nm, um, mm, m)"),
        ({"unit": "m m m"}, "unit = 'm m m': a unit of length such as nm"),
        ({"orientation": "up"}, "orientation = 'up': peaks up or lower face is needed"),
        ({"format": "jpeg"}, "format = 'jpeg': one of"),
        ({"format": "npy"}, "not a height map that can be read"),
    ],
)
def test_a_wrong_option_of_a_file_is_refused(argument, line):
    with pytest.raises((MapError, SettingsError), match=re.escape(line)):
        read_map(DATA / "steel.asc", **argument)


def test_all_problems_are_reported_at_once():
    with pytest.raises(MapError) as caught:
        prepare_map(DATA / "steel.npy")
    named = caught.value.renamed(lambda name: f"--{name}")
    starts = [problem.split(":")[0] for problem in named.problems]
    assert starts == ["--physical_size", "--orientation", "--unit", "--periodic", "--undefined"]
    assert str(named).splitlines()[1:] == [f"  {problem}" for problem in named.problems]


def test_bytes_are_a_map_only_if_asked(tmp_path):
    """A file of 2 n² bytes has the size of an SRTM tile, a format without a signature."""
    (tmp_path / "f").write_bytes(Path(sys.executable).read_bytes()[:5000])
    with pytest.raises(MapError, match="it looks like binary data without a known signature; known are"):
        read_map(tmp_path / "f", physical_size=(1, 1))
    assert read_map(tmp_path / "f", format="hgt", physical_size=(1, 1)).height.shape == (50, 50)


@pytest.mark.parametrize(
    ("content", "look"),
    [
        (bytes(2**22), "binary data without a known signature"),
        (b"\1\0" * 2**21, "binary data without a known signature"),
        (b"a\n" * 2**21, "text without a table of numbers"),
        (b"%PDF-1.7\nx", "a PDF document"),
        (b"\xff\xd8\xff\xe0", "a picture of the kind JPEG"),
        (b"", "an empty file"),
    ],
)
def test_first_block_tells_what_is_no_map(content, look, tmp_path):
    (tmp_path / "map.gz").write_bytes(gzip.compress(content))
    with pytest.raises(MapError, match=f"it looks like {look}; known are 001, 002"):
        read_map(tmp_path / "map.gz")


def test_table_of_formats_is_that_of_readers():
    from SurfaceTopography.IO import lookup_reader_by_format as readers

    line_scans = {"mitutoyo", "qep"}
    assert {*readers} - line_scans <= {*known_formats()}
    page = (DATA.parents[1] / "docs/formats.md").read_text(encoding="utf-8")
    table = [line for line in page.splitlines() if line.startswith("| `")]
    assert [line.split("`")[1] for line in table] == sorted(known_formats())
    for name, form in known_formats().items():
        assert f"| `{name}` | {form.program} | {', '.join(form.extensions)} |" in table
        assert name not in readers or {*form.extensions} >= {*readers[name].file_extensions()}
        assert not form.reader or readers[name].__module__.endswith(f".{form.reader}")


def test_readers_are_imported_alone():
    """Whatever was imported before: reading gives the same, and leaves no part of the package behind."""
    code = f"""
import sys, warnings
from asperity import read_map
alone = read_map({str(DATA / "steel.x3p")!r})
assert not {{"SurfaceTopography", "NuMPI", "scipy.stats", "matplotlib"}} & sys.modules.keys()
warnings.simplefilter("ignore")
import SurfaceTopography
assert SurfaceTopography.Topography and SurfaceTopography.IO.readers
assert (read_map({str(DATA / "steel.x3p")!r}).height == alone.height)[~(alone.height != alone.height)].all()
"""
    subprocess.run([sys.executable, "-W", "error::ImportWarning", "-c", code], check=True)


def test_an_array_over_axes_is_read(tmp_path):
    place = {axis: (axis, 0.5 * np.arange(n), {"units": "um"}) for axis, n in (("y", 12), ("x", 16))}
    values = xr.DataArray(np.random.default_rng(1).normal(size=(12, 16)), place, ("y", "x"))
    values.attrs["units"] = "nm"
    found = read_map(values.T, orientation="peaks up")
    np.testing.assert_allclose(found.height, 1e-9 * values.values)
    assert found.length == pytest.approx((6e-6, 8e-6))
    for wrong in (values.rename(x="a"), values > 0, values.values):
        with pytest.raises(ValueError, match="a DataArray of real numbers over y and x, is needed"):
            read_map(wrong)


def test_a_name_that_is_not_utf_8_is_refused_before_anything(tmp_path):
    path = os.fsdecode(os.fsencode(tmp_path) + b"/m\xe4p.npy")
    try:
        np.save(path, np.zeros((8, 8)))
    except OSError:
        pytest.skip("this file system has names in UTF-8 only")
    with pytest.raises(MapError, match="its name is not UTF-8; rename it"):
        read_map(path)


def test_what_is_no_regular_file_is_named(tmp_path, capsys):
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    for path in (str(fifo), os.devnull):
        with pytest.raises(MapError, match="not a regular file"):
            read_map(path)
        with pytest.raises(SystemExit):
            main(["run", path, "--young", "1GPa", "--poisson", "0.3", "--force", "1N", "--out", "x"])
        assert main(["info", path]) == 1
        assert capsys.readouterr().err == 2 * f"asperity: {path}: not a regular file\n"


def points(spots, values, header="", separator=" "):
    rows = (separator.join((f"{x:.4f}", f"{y:.4f}", str(z))) for (x, y), z in zip(spots, values, strict=True))
    return header + "\n".join(rows) + "\n"


SPOTS = [(0.3333 * column, 0.5 * row) for row in range(9) for column in range(7)]


@pytest.mark.parametrize("separator", [" ", ",", ";", "\t"])
@pytest.mark.parametrize("header", ["", "X Y Z\n", "x [mm], y [mm], z [um]\n"])
def test_points_on_a_grid_are_a_map(tmp_path, separator, header):
    order = np.random.default_rng(1).permutation(len(SPOTS))[:-5]
    values = {spot: round(float(np.sin(3 * spot[0]) + spot[1]), 4) for spot in SPOTS}
    listed = [SPOTS[number] for number in order]
    heights = [values[spot] for spot in listed]
    heights[3] = "No Data"
    path = tmp_path / "points.txt"
    path.write_text(points(listed, heights, header, separator))
    found = read_map(path)
    lateral, vertical = (1e-3, 1e-6) if "mm" in header else (1.0, 1.0)
    assert found.unit == ("um" if "mm" in header else None)
    assert (found.height.shape, found.missing) == ((9, 7), 6)
    assert found.length == pytest.approx((4.5 * lateral, 7 * 0.3333 * lateral))
    expected = vertical * np.reshape([values[spot] for spot in SPOTS], (9, 7))
    known = np.isfinite(found.height)
    np.testing.assert_allclose(found.height[known], expected[known], rtol=1e-12)


TABLE = np.random.default_rng(2).normal(size=(7, 9)).round(6)
TABLE[3], TABLE[2, 3], TABLE[4, 0], TABLE[5, 8] = np.nan, np.nan, np.nan, np.nan


@pytest.mark.parametrize("dialect", [" .", " ,", "\t.", "\t,", ";.", ";,", ",."])
def test_a_table_is_read_in_every_dialect(tmp_path, dialect):
    separator, decimal = dialect
    path = tmp_path / "map.csv"
    headers = ("", "# made 2 3\n", "Height [um]\n", "sample 7;;\n\n")
    ends = (("\n", "utf-8-sig"), ("\r\n", "utf-16"), (f"{separator}\n", "latin-1"))
    words = ("nan", "No Data", "---", "#N/A", "1.#QNAN", *([""] if separator != " " else []))
    for missing, header, (end, encoding) in [
        *product(words[:1], headers, ends),
        *product(words, headers[:1], ends[-1:]),
    ]:
        rows = [
            separator.join(missing if np.isnan(z) else f"{z:.6f}".replace(".", decimal) for z in row)
            for row in TABLE
        ]
        path.write_bytes((header + end.join([*rows, ""])).encode(encoding))
        unit = {} if "[um]" in header else {"unit": "um"}
        found = read_map(path, physical_size=("7 um", "9 um"), orientation="peaks up", **unit)
        np.testing.assert_allclose(found.height, 1e-6 * TABLE, rtol=1e-12)


def test_arrays_and_pictures_are_maps_with_a_scale(tmp_path):
    grey = np.arange(30, dtype=np.uint16).reshape(5, 6) ** 2
    height = 1e-9 * grey
    np.save(tmp_path / "array.npy", height)
    np.savez_compressed(tmp_path / "arrays.npz", time=np.zeros(3), height=height)
    tifffile.imwrite(tmp_path / "height.tif", height.astype(np.float32))
    for name in ("array.npy", "arrays.npz", "height.tif"):
        found = read_map(tmp_path / name, physical_size=(5e-6, 6e-6), unit="m", orientation="peaks up")
        np.testing.assert_allclose(found.height, height, rtol=1e-6)  # single precision in the picture
    Image.fromarray(grey).save(tmp_path / "grey.png")
    tifffile.imwrite(tmp_path / "grey.tif", grey)
    for name in ("grey.png", "grey.tif"):
        said = {"physical_size": ("5 um", "6 um"), "unit": "nm", "orientation": "peaks up"}
        np.testing.assert_allclose(read_map(tmp_path / name, **said, height_factor=1).height, height)
        with pytest.raises(MapError, match="height_factor: the file holds grey levels"):
            read_map(tmp_path / name, **said)
    Image.fromarray(np.zeros((5, 6, 3), np.uint8)).save(tmp_path / "colours.png")
    with pytest.raises(MapError, match="not one in colours or several"):
        read_map(tmp_path / "colours.png", **said)


MATRIX = "# Channel: Height\n# Width: 4 µm\n# Height: 80 µm\n# Value units: nm\n"


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (points([(x**1.5, y) for x, y in SPOTS], range(63)), "the positions x are not equally spaced"),
        (
            points([*SPOTS, SPOTS[0]], range(64)),
            "points in lines 1 and 64 have the same position; delete one",
        ),
        (points([(x, x) for x in range(40)], range(40)), "its points lie on one line"),
        (points([(n % 99, n % 97) for n in range(300)], range(300)), "300 points are too few for a grid"),
        (points(SPOTS, [0, "1.2.3", *range(61)]), "line 2: '1.2.3' is no number"),
        ("time,height\n0,1.0\n1,1.5\n2,1.2\n", "not a line scan of 2 columns"),
        (MATRIX + "1 2 3 4\n2 -- x 5\n3 4 5 6\n4 5 6 8\n5 6 8 8\n", "line 6: 'x' is no number"),
        (MATRIX + "1 2 3 4\n***\n3 4 5 6\n4 5 6 8\n5 6 8 8\n", "line 6: 4 numbers are needed, not 1"),
        ("1 2 3 4\n2 3 4 5\n3 4 5 6\n4 5 6 8\n5 6 x 8\n", "line 5: 'x' is no number"),
        (",0,1,2,3\n0,7,5,6,1\n1,2,3,9,6\n2,0,1,1,4\n", "its first row holds numbers or positions"),
        (
            "1,5, 2,5, 3,5, 4,5\n2,5, 1,5, 4,5, 3,5\n1,0, 2,0, 1,0, 2,5\n2,5, 1,5, 4,5, 3,5\n",
            "its first row, read with decimal commas, holds numbers or positions",
        ),
        ("\n".join("1 2 3 4" for _ in range(400)), "a list of points or a log, not a map"),
    ],
)
def test_a_text_that_is_no_map_is_refused(tmp_path, content, line):
    (tmp_path / "points.xyz").write_text(content)
    with pytest.raises(MapError, match=re.escape(line)):
        read_map(tmp_path / "points.xyz")


def test_the_description_says_what_a_map_is():
    found = describe_map(DATA / "steel.x3p", MapOptions())
    tilt = float(found.properties["tilt"].rstrip("°"))
    assert tilt == pytest.approx(np.degrees(np.hypot(12e-9, 5e-9) / 2e-6), abs=0.3)
    height, without_spikes = re.match(r"(\S+) nm, without spikes (\S+) nm", found.properties["Sq"]).groups()
    assert float(without_spikes) == pytest.approx(400, rel=0.1)  # the script sets 400 nm before the tilt
    steps = np.array(make_maps.SPIKES).shape[0] * 15000**2 / HEIGHT.size  # by 15 µm in four of the points
    assert float(height) == pytest.approx(np.sqrt(400**2 + steps), rel=0.1)
    assert found.properties["size"] == "80 µm x 96 µm (y, x)"
    assert found.properties["non-measured"] == "7 points (0.36 %)"
    assert found.properties["spikes"].startswith("4 points (0.21 %) in 3 spikes of up to 15.")
    assert found.properties["Str"].endswith("lay at 90° from x towards y")  # ground along y
    assert [text.split(":")[0] for text in found.choices] == ["periodic", "undefined"]


def test_roughness_is_that_of_measured_points(tmp_path):
    """Waves of rms height 0.2 µm with a tilt of 0.5°, whose corner, or all outside a circle, is missing."""
    y, x = np.mgrid[:200, :200] * 5.0
    waves = 0.4 * np.sin(x / 20) * np.sin(y / 20)
    tilted = waves + np.tan(np.radians(0.5)) * (x + y) / np.sqrt(2)
    said = {"physical_size": ("1 mm", "1 mm"), "unit": "um", "orientation": "peaks up"}
    for missing in (x + y > 1500, np.hypot(x - 500, y - 500) > 450):
        np.save(tmp_path / "map.npy", np.where(missing, np.nan, tilted))
        found = describe_map(tmp_path / "map.npy", MapOptions(**said)).properties
        assert found["tilt"] == "0.5°"
        rms = float(found["Sq"].split(" nm")[0])
        assert rms == pytest.approx(1e3 * waves[~missing].std(), rel=2e-3)  # their own tilt
        assert rms == pytest.approx(200, rel=0.01)


def test_lengths_of_the_texture_are_positive():
    """Also of ridges along a diagonal, along which the autocorrelation does not fall to 0.2 on the map."""
    y, x = np.mgrid[:40, :40].astype(float)
    for height in (np.sin((x - y) / 3), np.sin(x + y), np.abs(x - y)):
        shortest, ratio, _ = texture(height, (1.0, 1.0))
        assert 0 < shortest <= np.hypot(20, 20) + 1
        assert 0 < ratio <= 1


def test_doubts_about_a_map_name_their_option():
    rough = self_affine((64, 64), 0.8, 5e-5, 1e-5, rms_height=1e-7, seed=1, length=1e-4)
    x = np.linspace(-5e-5, 5e-5, 64)
    curved = rough - x**2 / (2 * 1e-3)  # a bow of 1.25 µm
    curved[20:22, 30] += 5e-6
    found = map_doubts(HeightMap(curved, (1e-4, 1e-4), unit="m"), MapOptions())
    assert [(each.option, each.proposed) for each in found] == [("despike", "8"), ("detrend", "curvature")]
    assert "1 spike of up to 5" in found[0].text
    assert "a form of 1.2" in found[1].text
    answered = MapOptions(despike=8, detrend="curvature")
    assert map_doubts(HeightMap(curved, (1e-4, 1e-4), unit="m"), answered) == []
    (doubt,) = map_doubts(HeightMap(1e-3 * curved, (1e-7, 1e-7), unit="mm"), answered)
    assert str(doubt).startswith("unit: Sq of")
    (repeated,) = map_doubts(HeightMap(np.where(rough > 0, rough, -2e-6), (1e-4, 1e-4), unit="m"), answered)
    assert str(repeated).endswith("exactly; set it to -2e-06 if they are non-measured")


def test_smooth_high_peaks_are_no_spikes(tmp_path):
    """A smooth skewed surface, with eight nodes on its shortest wave."""
    wave = self_affine((256, 256), 0.8, 1 / 4, 1 / 32, rms_height=1.0, seed=2)
    high = 1e-7 * np.exp(0.45 * wave)
    np.save(tmp_path / "high.npy", high)
    options = MapOptions(physical_size=("100 um", "100 um"), unit="m", orientation="peaks up")
    found = describe_map(tmp_path / "high.npy", options)
    assert found.properties["spikes"].startswith("no points")
    level = levelling.subtract_trend(high, "tilt", (1e-4, 1e-4))[0]
    _, _, kurtosis = moments(level.ravel(), np.full(high.size, 1 / high.size))
    assert kurtosis > 5
    assert found.properties["Sku"].startswith(f"{kurtosis:.3g},")


def test_info_prints_description_or_one_line(capsys):
    assert main(["info", str(DATA / "steel.gwy"), "--channel", "Detail"]) == 0
    printed = capsys.readouterr().out
    assert "12 x 16 (y, x)" in printed
    assert "shown: Detail" in printed
    assert main(["info", str(DATA / "steel.asc"), "--unit", "kg", "--physical-size", "1", "2"]) == 0
    printed = capsys.readouterr().out
    assert "overridden:   physical_size: 1 nm x 2 nm (y, x) is given, the file says 80 µm x 96 µm" in printed
    assert "--unit = 'kg': a unit of length is needed" in printed
    assert main(["info", str(DATA / "steel.npy")]) == 0
    printed = capsys.readouterr().out
    assert "size:         not in the file" in printed
    assert "nan" not in printed
    assert main(["info", str(DATA / "README.md")]) == 1
    assert capsys.readouterr().err.count("\n") == 1


def test_info_ends_quietly_when_its_reader_does():
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "asperity", "info", str(DATA / "steel.npy")]
    ended = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, check=True)
    os.close(write)
    assert ended.stderr == b""


def test_texture_of_waves_and_tip_of_a_sphere():
    """Waves correlate by 0.2 at a phase of acos(0.2); a tip fits in a bowl of twice its radius."""
    y, x = np.mgrid[:256, :256]
    wave = np.cos(2 * np.pi * (x * np.cos(np.pi / 6) + y * np.sin(np.pi / 6)) / 32)
    shortest, ratio, lay = texture(wave, (1.0, 1.0))
    assert shortest == pytest.approx(32 * np.arccos(0.2) / (2 * np.pi), rel=1e-3)
    assert ratio < 0.1
    assert lay == pytest.approx(120, abs=3)  # the map ends after eight waves
    rough = self_affine((256, 256), 0.8, 0.1, 0.02, rms_height=1e-3, seed=1)
    assert texture(rough, (1.0, 1.0))[1] > 0.8
    assert texture(rough, (4.0, 1.0))[1:] == pytest.approx((0.25, 90), rel=0.15)  # one sample
    assert finest_tip(-(x**2 + y**2) / 2000, (1.0, 1.0)) == pytest.approx(500)


@pytest.mark.parametrize("shape", [(64, 512), (512, 64), (60, 240)])
@pytest.mark.parametrize("wavelength", [20, 100, 200])
def test_grooves_across_the_short_edge_have_a_lay(shape, wavelength):
    """The correlation along them does not end at half of the short edge."""
    y, x = np.mgrid[: shape[0], : shape[1]]
    place, direction = (x, 90) if shape[0] < shape[1] else (y, 0)
    noise = 0.1 * np.random.default_rng(1).normal(size=shape)
    shortest, ratio, lay = texture(np.cos(2 * np.pi * place / wavelength) + noise, (1.0, 1.0))
    assert shortest == pytest.approx(0.215 * wavelength, rel=0.1)  # of a cosine: arccos(0.2) / 2 pi
    assert ratio < 0.1
    assert abs((lay - direction + 90) % 180 - 90) < 2


@pytest.mark.parametrize("shape", [(128, 128), (64, 200), (200, 64)])
def test_lay_is_not_turned_towards_diagonals(shape):
    """Ridges that the map cuts; the bound is four times the scatter of the samples."""
    generator, (y, x) = np.random.default_rng(1), np.mgrid[: shape[0], : shape[1]]
    for lay in (0, 20, 50, 75, 105, 160):
        across = y * np.cos(np.radians(lay)) - x * np.sin(np.radians(lay))
        heights = np.convolve(generator.standard_normal(500), np.hanning(20), "same")
        ridges = np.interp(across, np.arange(-250, 250), heights)
        noisy = ridges + 0.3 * ridges.std() * generator.standard_normal(shape)
        for map_of_ridges in (np.cos(across / 4), ridges, noisy):
            turned = texture(map_of_ridges, (1.0, 1.0))[2] - lay
            assert abs((turned + 90) % 180 - 90) < 2


def test_long_waves_have_height_short_ones_slope():
    """Gradients of 1 · 8 and 0.3 · 64; a Hann window spreads a wave over its neighbours."""
    x = np.arange(256) / 256
    waves = np.ones((256, 1)) * (np.cos(2 * np.pi * 8 * x) + 0.3 * np.cos(2 * np.pi * 64 * x))
    long, short, unresolved, _ = spectrum_summary(waves, HeightMap(waves, (1.0, 1.0)))
    assert (1 / long, 1 / short) == pytest.approx((8, 64), abs=1)
    assert unresolved == pytest.approx(0.3**2 * 64**2 / (8**2 + 0.3**2 * 64**2), rel=0.05)


def zip_of_zeros(path):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("main.xml", "")
        archive.writestr("bindata/data.bin", bytes(40 * 2**20))


def gzip_that_declares_less(path):
    """Its last member, whose size is at the end of the file, is small."""
    path.write_bytes(gzip.compress(b"1 2 3 4\n" * 5 * 2**20, mtime=0) + gzip.compress(b"end", mtime=0))


@pytest.mark.parametrize(
    ("name", "write", "line"),
    [
        ("bomb.x3p", zip_of_zeros, "the file holds 0.0391 GiB of data or more"),
        ("liar.asc.gz", gzip_that_declares_less, "the file holds 0.02 GiB of data or more"),
    ],
)
def test_a_file_that_unpacks_to_much_is_refused(tmp_path, name, write, line):
    write(tmp_path / name)

    with pytest.raises(MapError, match=line):
        read_map(tmp_path / name, max_memory=0.02)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("array.gwy", b"GWYPGwyContainer\0" + struct.pack("<I", 2**31) + b"/0/data\0D\0\0\0\x40"),
        ("broken.x3p", (DATA / "steel.x3p").read_bytes().replace(b"PK\x01\x02", b"PK\x01\x03", 1)),
        ("short.h5", b"\x89HDF\r\n\x1a\n"),
    ],
)
def test_a_damaged_container_is_refused_in_one_line(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(MapError) as caught:
        read_map(tmp_path / name)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("aspect", "bow", "is_said"), [(1.0, 0.0, True), (6.0, 0.0, False), (1.0, 3e-6, False)]
)
def test_hurst_exponent_is_left_out_where_lay_or_form_change_it(tmp_path, aspect, bow, is_said):
    """A self-affine map of exponent 0.8, stretched along x, or on a paraboloid."""
    edge, nodes = 240e-6, 512
    height = self_affine((nodes, nodes), 0.8, 60e-6, 1e-6, 1e-7, seed=1, length=edge)
    at = np.linspace(0, nodes - 1, nodes) / aspect
    stretched = np.array([np.interp(at, np.arange(nodes), row) for row in height])
    stretched += bow * np.linspace(-1, 1, nodes) ** 2
    np.save(tmp_path / "map.npy", stretched)
    options = MapOptions(unit="m", physical_size=(edge, edge))
    words = describe_map(tmp_path / "map.npy", options).properties["waves"]
    assert ("Hurst exponent of" in words) == is_said
