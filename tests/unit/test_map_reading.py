"""Reading of maps: every file family gives one surface; orientation, units, points, all problems at once."""

import gzip
import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from asperity.cli.arguments import flag
from asperity.cli.main import main
from asperity.contact import solve
from asperity.elasticity.layer import Layer
from asperity.surface.description import describe_map
from asperity.surface.height_map import HeightMap, MapError
from asperity.surface.measured import prepare_map
from asperity.surface.reading import Reading, inspect_map, read_map
from asperity.surface.treatment import Treatment

pytest.importorskip("SurfaceTopography")

DATA = Path(__file__).parents[1] / "data"
_spec = importlib.util.spec_from_file_location("make_maps", DATA / "make_maps.py")
make_maps = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(make_maps)

HEIGHT, VALID = make_maps.ground_steel()
EDGES = tuple(make_maps.PIXEL * n for n in make_maps.SHAPE)
ARRAY = {"physical_size": ("80 um", "96 um"), "unit": "um", "orientation": "peaks up"}


def given(name):
    return ARRAY if name.endswith(".npy") else {}


@pytest.mark.parametrize("name", make_maps.WRITERS)
def test_every_family_of_files_gives_the_same_surface_in_metres(name):
    found = read_map(DATA / name, **given(name))
    expected = np.where(VALID, 1e-9 * HEIGHT, np.nan)
    # single precision of heights up to 16 µm in the NPY file, rounding in the others
    np.testing.assert_allclose(found.height, expected, atol=1e-12 if name.endswith(".npy") else 1e-19)
    assert found.length == pytest.approx(EDGES)
    assert found.missing == len(make_maps.MISSING)
    assert found.orientation == "peaks up"
    assert found.unit in ("m", "µm", "nm", "um")
    assert not found.periodic


@pytest.mark.parametrize("name", make_maps.WRITERS)
def test_the_maps_are_what_their_script_writes(name, tmp_path):
    make_maps.WRITERS[name](tmp_path / name, HEIGHT, VALID)
    assert (tmp_path / name).read_bytes() == (DATA / name).read_bytes()


def test_a_gzip_file_is_read_like_what_is_in_it(tmp_path):
    packed = tmp_path / "steel.x3p.gz"
    packed.write_bytes(gzip.compress((DATA / "steel.x3p").read_bytes()))
    np.testing.assert_array_equal(read_map(packed).height, read_map(DATA / "steel.x3p").height)


@pytest.mark.parametrize("place", [2, 40, -6], ids=["method", "content", "check sum"])
def test_a_damaged_gzip_file_is_named(tmp_path, place):
    content = bytearray(gzip.compress(b"".join(b"%d 2 3\n" % line for line in range(2000))))
    content[place] ^= 255
    packed = tmp_path / "map.txt.gz"
    packed.write_bytes(content)
    with pytest.raises(MapError, match=r"map\.txt\.gz: a gzip file without damage is needed"):
        read_map(packed)


def test_a_channel_is_chosen_by_name_or_number():
    detail = 1e-9 * HEIGHT[:12, :16]
    for channel in ("Detail", 1, "1"):
        np.testing.assert_allclose(read_map(DATA / "steel.gwy", channel=channel).height, detail, rtol=1e-15)
    with pytest.raises(
        MapError, match=re.escape("channel = 'Phase': one of 0 (Height), 1 (Detail) is needed")
    ):
        read_map(DATA / "steel.gwy", channel="Phase")


def test_an_array_gives_the_contact_that_solve_gives_for_it(tmp_path):
    """The same array pressed by `solve`, and read from a file as a lower face, or upside down as a map."""
    y, x = np.mgrid[:12, :16] / 16
    height = 1e-3 * (np.cos(2 * np.pi * x) + np.cos(2 * np.pi * (16 * y / 12 + 0.1 * x)))
    direct = solve(height, Layer(young=1.0, poisson=0.3), area_fraction=0.2)
    treatment = Treatment(detrend="none", periodic="declared")
    for name, array in (("lower face", height), ("peaks up", -height)):
        np.save(tmp_path / "map.npy", array)
        reading = Reading(physical_size=("0.75 m", "1 m"), unit="m", orientation=name)
        indenter = prepare_map(tmp_path / "map.npy", reading, treatment)
        np.testing.assert_allclose(indenter.height, height - height.mean(), atol=1e-17)
        contact = solve(indenter.height, Layer(young=1.0, poisson=0.3), area_fraction=0.2)
        np.testing.assert_array_equal(contact.pressure > 0, direct.pressure > 0)
        np.testing.assert_array_equal(
            read_map(tmp_path / "map.npy", ("0.75 m", "1 m"), unit="m", orientation=name).as_indenter(),
            height,
        )


@pytest.mark.parametrize("suffix", ["npy", "txt"])
def test_the_orientation_of_a_bare_array_is_asked_for(tmp_path, suffix):
    path = tmp_path / f"map.{suffix}"
    (np.save if suffix == "npy" else np.savetxt)(path, 1e-9 * HEIGHT)
    with pytest.raises(MapError, match="orientation: the file does not say which way is up"):
        read_map(path, physical_size=EDGES)
    assert inspect_map(path, Reading(physical_size=EDGES)).map.orientation is None
    with pytest.raises(MapError, match="orientation"):
        HeightMap(1e-9 * HEIGHT, EDGES, orientation=None).as_indenter()


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


@pytest.mark.parametrize(
    ("argument", "line"),
    [
        ({"unit": "mm"}, "unit = 'mm': the file says nm; leave it out"),
        ({"unit": "kg"}, "unit = 'kg': a unit of length is needed (nm, um, mm, m)"),
        (
            {"physical_size": ("1 mm", "1 mm")},
            "physical_size: the file itself says 80000 x 96000 nm (y, x); leave",
        ),
        ({"physical_size": (80000, -1)}, "physical_size = (80000, -1): two lengths > 0 (y, x) are needed"),
        ({"physical_size": ("80 um", "2 s")}, "physical_size = '2 s': a number with a unit of length"),
        ({"height_factor": 2.0}, "height_factor = 2: the file says heights in nm; leave it out"),
        ({"height_factor": -2.0}, "height_factor = -2.0: a number > 0 is needed"),
        ({"orientation": "up"}, "orientation = 'up': 'peaks up' or 'lower face' is needed"),
    ],
)
def test_an_argument_that_contradicts_the_file_is_refused(argument, line):
    with pytest.raises(MapError, match=re.escape(line)):
        read_map(DATA / "steel.asc", **argument)


def test_an_argument_that_repeats_the_file_is_accepted():
    found = read_map(DATA / "steel.asc", physical_size=("80 um", "96 um"), unit="nm")
    assert found.length == pytest.approx(EDGES)
    in_numbers = read_map(DATA / "steel.asc", physical_size=(80000, 96000), unit="nm")
    assert in_numbers.length == pytest.approx(EDGES)


def test_edges_and_heights_without_a_unit_stay_numbers():
    found = read_map(DATA / "steel.npy", physical_size=(80, 96), height_factor=2.0, orientation="peaks up")
    assert found.unit is None
    assert found.length == (80.0, 96.0)
    np.testing.assert_allclose(found.height[VALID], 2e-3 * HEIGHT[VALID], rtol=1e-6)


def test_all_problems_are_reported_at_once_with_the_names_of_the_interface():
    with pytest.raises(MapError) as caught:
        prepare_map(DATA / "steel.npy", Reading(), Treatment(), option=flag)
    starts = [problem.split(":")[0] for problem in caught.value.problems]
    assert starts == ["--physical-size", "--orientation", "--unit", "--periodic", "--undefined"]
    assert str(caught.value).splitlines()[1:] == [f"  {problem}" for problem in caught.value.problems]


def points(spots, values, header="", separator=" "):
    rows = (separator.join((f"{x:.4f}", f"{y:.4f}", str(z))) for (x, y), z in zip(spots, values, strict=True))
    return header + "\n".join(rows) + "\n"


SPOTS = [(0.3333 * column, 0.5 * row) for row in range(9) for column in range(7)]


@pytest.mark.parametrize("separator", [" ", ",", ";", "\t"])
@pytest.mark.parametrize("header", ["", "X Y Z\n", "x [mm], y [mm], z [um]\n"])
def test_points_on_a_grid_are_a_map_with_points_missing(tmp_path, separator, header):
    order = np.random.default_rng(1).permutation(len(SPOTS))[:-5]
    values = {spot: round(float(np.sin(3 * spot[0]) + spot[1]), 4) for spot in SPOTS}
    listed = [SPOTS[number] for number in order]
    heights = [values[spot] for spot in listed]
    heights[3] = "No Data" if separator != " " else "nan"
    path = tmp_path / "points.txt"
    path.write_text(points(listed, heights, header, separator))
    found = read_map(path)
    lateral, vertical = (1e-3, 1e-6) if "mm" in header else (1.0, 1.0)
    assert found.unit == ("um" if "mm" in header else None)
    assert found.height.shape == (9, 7)
    assert found.missing == 6
    assert found.length == pytest.approx((4.5 * lateral, 7 * 0.3333 * lateral))
    expected = vertical * np.reshape([values[spot] for spot in SPOTS], (9, 7))
    known = np.isfinite(found.height)
    np.testing.assert_allclose(found.height[known], expected[known], rtol=1e-12)


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (points([(x**1.5, y) for x, y in SPOTS], range(63)), "the positions x are not equally spaced"),
        (points([*SPOTS, SPOTS[0]], range(64)), "two points have the same position"),
        (points([(0, y) for y in range(9)], range(9)), "all points have the same x"),
        (points([(x, x) for x in range(40)], range(40)), "40 points are too few for a grid of 40 x 40 nodes"),
    ],
)
def test_other_points_are_no_map(tmp_path, content, line):
    path = tmp_path / "points.xyz"
    path.write_text(content)
    with pytest.raises(MapError, match=re.escape(f"no points x, y, z on a regular grid ({line})")):
        read_map(path)


@pytest.mark.parametrize("columns", [3, 4, 6])
def test_a_table_of_few_columns_is_no_map(tmp_path, columns):
    table = np.random.default_rng(0).normal(size=(400, columns))
    np.save(tmp_path / "log.npy", table)
    np.savetxt(tmp_path / "log.txt", table)
    for path in (tmp_path / "log.npy", tmp_path / "log.txt"):
        with pytest.raises(MapError, match=r"a list of points or a log, not a map|no points x, y, z"):
            read_map(path)
    wide = {"physical_size": (400.0, columns), "orientation": "peaks up"}
    if columns > 3:
        assert read_map(tmp_path / "log.npy", **wide).height.shape == (400, columns)


def test_a_matrix_of_three_columns_with_a_header_is_a_map(tmp_path):
    path = tmp_path / "strip.asc"
    header = "# Channel: Height\n# Width: 3 µm\n# Height: 80 µm\n# Value units: nm\n"
    path.write_text(header + "\n".join(f"{i} {i + 1} {i % 7}" for i in range(80)))
    assert read_map(path).height.shape == (80, 3)


def test_the_description_says_what_a_map_is_and_what_is_needed():
    found = describe_map(DATA / "steel.x3p", option=flag)
    assert (found.missing, found.spikes) == (7, 4)
    assert np.degrees(found.tilt) == pytest.approx(np.degrees(np.hypot(12e-9, 5e-9) / 2e-6), abs=0.3)
    assert found.rms_height == pytest.approx(400e-9, rel=0.1)  # the script sets 400 nm before the tilt
    text = "\n".join(found.lines())
    for words in ("80 µm x 96 µm", "7 points (0.36 %)", "4 points (0.21 %)", "--undefined", "--periodic"):
        assert words in text
    bare = "\n".join(describe_map(DATA / "steel.npy").lines())
    assert "size:         not in the file" in bare
    assert "nan" not in bare


def test_the_command_info_prints_the_description_or_one_line(capsys):
    assert main(["info", str(DATA / "steel.gwy"), "--channel", "Detail"]) == 0
    printed = capsys.readouterr().out
    assert "12 x 16 (y, x)" in printed
    assert "shown: Detail" in printed
    assert main(["info", str(DATA / "steel.asc"), "--unit", "kg", "--physical-size", "1", "2"]) == 0
    assert "--physical-size: the file itself says 80000 x 96000 nm" in capsys.readouterr().out
    assert main(["info", str(DATA / "README.md")]) == 1
    assert capsys.readouterr().err.count("\n") == 1


def test_the_spectrum_of_a_self_affine_map_has_its_exponent():
    from asperity.surface.description import _spectrum_summary
    from asperity.surface.self_affine import self_affine

    whole = self_affine(
        (512, 512), seed=3, hurst=0.8, wavelength_long=0.25, wavelength_short=0.004, rms_height=1e-3
    )
    part = whole[:256, :256]  # not periodic
    *_, hurst = _spectrum_summary(part, HeightMap(part, (0.5, 0.5)))
    assert hurst == pytest.approx(0.8, abs=0.1)  # scatter of one sample
