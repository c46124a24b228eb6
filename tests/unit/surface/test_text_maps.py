"""Maps in text and grids: units and edges in their headings, and options that override them."""

import re

import foreign_files
import numpy as np
import pytest
import xarray as xr

from asperity.surface.description import describe_map, prepare_map
from asperity.surface.reading.height_map import MapError, MapOptions
from asperity.surface.reading.map_file import read_map

pytest.importorskip("SurfaceTopography")
tifffile = pytest.importorskip("tifffile")

HEIGHT = np.random.default_rng(3).normal(size=(8, 6)).round(3)
MATRIX = "\n".join(" ".join(f"{z:.3f}" for z in row) for row in HEIGHT)
POINTS = [(f"{0.5 * x:g}", f"{0.5 * y:g}", f"{HEIGHT[y, x]:g}") for y in range(8) for x in range(6)]


def assert_map(found, lateral, vertical, height=HEIGHT):
    """Eight by six pixels of half a unit."""
    assert found.length == pytest.approx((4 * lateral, 3 * lateral), rel=1e-6)
    np.testing.assert_allclose(found.height, vertical * height, rtol=1e-6)


@pytest.mark.parametrize("separator", [";", "\t", ","])
@pytest.mark.parametrize(
    ("heading", "lateral", "vertical"),
    [
        ("x [mm];y [mm];z [um]", 1e-3, 1e-6),
        ("X/mm;Y/mm;Z/um", 1e-3, 1e-6),
        ("x_mm;y_mm;z_nm", 1e-3, 1e-9),
        ("X in mm;Y in mm;Z in µm", 1e-3, 1e-6),
        ("Lateral mm;Lateral mm;Raw um", 1e-3, 1e-6),
        ("X_(microns);Y_(microns);Z_(nm)", 1e-6, 1e-9),
        ("X;Y;Z\nmm;mm;µm", 1e-3, 1e-6),
        ("# x [mm];y [um];z [um]", (1e-6, 1e-3), 1e-6),
        ("Lateral units: mm\nValue units: um", 1e-3, 1e-6),
        ("Scan length;2;5 um\nx [mm];y [mm];z [um]", 1e-3, 1e-6),
    ],
)
def test_each_column_has_its_unit(tmp_path, separator, heading, lateral, vertical):
    rows = "\n".join(separator.join(point) for point in POINTS)
    (tmp_path / "map.csv").write_text(f"{heading.replace(';', separator)}\n{rows}\n", encoding="utf-8")
    found = read_map(tmp_path / "map.csv")
    y, x = lateral if isinstance(lateral, tuple) else (lateral, lateral)
    assert found.length == pytest.approx((4 * y, 3 * x))
    np.testing.assert_allclose(found.height, vertical * HEIGHT, rtol=1e-12)


@pytest.mark.parametrize(
    ("heading", "asked", "answer"),
    [
        ("x [mm],y [mm],z\n", "unit: the file does not say the unit of its heights; set it", "um"),
        (
            "x,y,z [um]\n",
            "unit: the file does not say the unit of its edges, 4 x 3 (y, x); set it to the units",
            "mm um",
        ),
        ("", "unit: the file does not say its units; set it to the units of x and y and of z, for", "mm um"),
        (
            "x,y,z\n",
            "unit: the file does not say its units; set it to the units of x and y and of z, fo",
            "mm um",
        ),
    ],
)
def test_a_unit_that_is_not_stated_is_asked(tmp_path, heading, asked, answer):
    """It is not taken from the edges, or from the heights."""
    (tmp_path / "map.csv").write_text(heading + "\n".join(map(",".join, POINTS)))
    with pytest.raises(MapError) as caught:
        prepare_map(tmp_path / "map.csv", periodic="mirrored")
    assert str(caught.value).partition(": ")[2].startswith(asked)
    assert "Sdq" not in describe_map(tmp_path / "map.csv", MapOptions()).properties
    assert_map(read_map(tmp_path / "map.csv", unit=answer), 1e-3, 1e-6)
    if answer == "mm um":
        with pytest.raises(
            MapError, match=r"unit: the file does not say the unit of its edges, 4 x 3 \(y, x\)"
        ):
            read_map(tmp_path / "map.csv", unit="um")
        found = read_map(tmp_path / "map.csv", unit="um", physical_size=("4 mm", "3 mm"))
        assert_map(found, 1e-3, 1e-6)
        assert not found.notes


@pytest.mark.filterwarnings("ignore:.*is m the unit", "ignore:.*is this right", "ignore:.*units")
@pytest.mark.parametrize(
    ("given", "edges", "vertical", "note"),
    [
        ({"unit": "nm"}, (4e-3, 3e-3), 1e-9, "unit: nm is given, the file says um"),
        ({"unit": "um um"}, (4e-6, 3e-6), 1e-6, "unit: um of x and y is given, the file says mm"),
        (
            {"physical_size": ("8 um", "6 um")},
            (8e-6, 6e-6),
            1e-6,
            "physical_size: 8 µm x 6 µm (y, x) is given, the file says 4 mm x 3 mm (y, x)",
        ),
        ({"height_factor": 2}, (4e-3, 3e-3), 2e-6, "height_factor: 2 is given, the file says heights in um"),
        ({"unit": "um", "physical_size": ("4 mm", "3 mm")}, (4e-3, 3e-3), 1e-6, None),
    ],
)
def test_an_option_overrides_the_file(tmp_path, given, edges, vertical, note):
    """The map, its treatment and its description note it."""
    (tmp_path / "map.csv").write_text("x [mm],y [mm],z [um]\n" + "\n".join(map(",".join, POINTS)))
    found = read_map(tmp_path / "map.csv", **given)
    assert found.length == pytest.approx(edges)
    np.testing.assert_allclose(found.height, vertical * HEIGHT, rtol=1e-12)
    assert found.notes == ((note,) if note else ())
    if note:
        assert note in prepare_map(tmp_path / "map.csv", periodic="mirrored", **given).done
        assert describe_map(tmp_path / "map.csv", MapOptions(**given)).properties["overridden"] == note


@pytest.mark.parametrize(
    ("heading", "length"),
    [
        ("Width: 6\nHeight: 8", None),  # numbers of points
        ("Image Width: 6 px\nImage Height: 8 px", None),
        ("Pulse Width: 5 us", None),
        ("R. Cursor,Pos: 100.0 um Width: 0.0 um", None),
        ("Pixel Width: 0.5 um\nPixel Height: 0.25 um", (2e-6, 3e-6)),
        ("Pixel Width: 0.5 um", (4e-6, 3e-6)),
        ("Width: 3 um\nHeight: 4 um", (4e-6, 3e-6)),
        ("% Scan Width: 3 um\n% Scan Height: 4 um\n% 3 4 by hand", (4e-6, 3e-6)),
    ],
)
def test_a_width_is_an_edge_where_it_is_one(tmp_path, heading, length):
    (tmp_path / "map.txt").write_text(f"{heading}\n{MATRIX}\n")
    said = {"unit": "nm", "orientation": "peaks up"}
    if length is None:
        with pytest.raises(MapError, match="physical_size: the file does not say the edges"):
            read_map(tmp_path / "map.txt", **said)
        length = (2e-6, 9e-6)
        said["physical_size"] = ("2 um", "9 um")
    found = read_map(tmp_path / "map.txt", **said)
    assert (found.length, found.notes) == (pytest.approx(length), ())
    np.testing.assert_allclose(found.height, 1e-9 * HEIGHT, rtol=1e-12)


def test_edges_without_a_unit_are_asked_for(tmp_path):
    """Not taken in the unit of the heights, in which SurfaceTopography takes them."""
    for value_unit, unit in (("Value units: nm\n", "um nm"), ("", "um nm")):
        (tmp_path / "map.txt").write_text(f"Width: 30\nHeight: 40\n{value_unit}{MATRIX}\n")
        for given in ({}, {"unit": "nm"}):
            with pytest.raises(
                MapError, match=r"unit: the file does not say (the unit of its edges|its units)"
            ):
                prepare_map(tmp_path / "map.txt", periodic="mirrored", orientation="peaks up", **given)
        found = read_map(tmp_path / "map.txt", unit=unit, orientation="peaks up")
        assert found.length == pytest.approx((40e-6, 30e-6))
        np.testing.assert_allclose(found.height, 1e-9 * HEIGHT, rtol=1e-12)


def test_edges_keep_their_unit_without_one_of_heights(tmp_path):
    (tmp_path / "map.txt").write_text(f"Width: 3 um\nHeight: 4 um\n{MATRIX}\n")
    with pytest.raises(MapError, match="unit: the file does not say the unit of its heights; set it"):
        read_map(tmp_path / "map.txt")
    assert_map(read_map(tmp_path / "map.txt", unit="nm"), 1e-6, 1e-9)


def test_another_number_of_points_is_refused(tmp_path):
    for heading in ("Width: 7 px", "Image Height: 9 points"):
        (tmp_path / "map.txt").write_text(f"{heading}\n{MATRIX}\n")
        with pytest.raises(MapError, match=f"its heading says {heading}"):
            read_map(tmp_path / "map.txt")


def test_a_scan_of_unknown_size_asks_for_it(tmp_path):
    raw = np.random.default_rng(7).integers(-120, 120, size=(8, 6))
    foreign_files.write_bruker(tmp_path / "map.spm", raw, "0 0 ~m")
    with pytest.raises(MapError, match="physical_size: the file does not say the edges"):
        read_map(tmp_path / "map.spm")
    found = read_map(tmp_path / "map.spm", physical_size=("16 um", "12 um"))
    np.testing.assert_allclose(found.height, 1e-9 * raw[::-1], rtol=1e-6)


def test_decimal_commas_between_commas_and_blanks(tmp_path):
    """As in ``1,5, 2,5``, which are two numbers."""
    for end in ("", ", "):
        rows = (", ".join(f"{z:.1f}".replace(".", ",") for z in row) + end for row in HEIGHT)
        (tmp_path / "map.csv").write_text("\n".join(rows) + "\n")
        found = read_map(
            tmp_path / "map.csv", physical_size=("4 um", "3 um"), unit="um", orientation="peaks up"
        )
        assert_map(found, 1e-6, 1e-6, HEIGHT.round(1))


def test_separators_after_the_last_column_are_none(tmp_path):
    """As a profiler writes them, with positions of 0.156 µm rounded to 0.1 µm."""
    z = np.random.default_rng(1).normal(size=400).round(4)
    for step, digits in ((0.5, 1), (0.15625, 1), (0.0995, 4)):
        rows = "\r\n".join(f"{i * step:.{digits}f},{value:.4f},," for i, value in enumerate(z))
        heading = "ID,0\r\nLength,30.0 um\r\nR. Cursor,Pos: 100.0 um Width: 0.0 um\r\nScan Data\r\n"
        (tmp_path / "line.csv").write_text(f"{heading}Lateral um,Raw um,\r\n{rows}\r\n")
        found = read_map(tmp_path / "line.csv", format="profile")
        np.testing.assert_allclose(found.height, np.tile(1e-6 * z, (4, 1)), rtol=1e-12)
        assert found.length[1] == pytest.approx(400e-6 * step, rel=10**-digits / (400 * step))
        with pytest.raises(MapError, match="not a line scan of 2 columns; set format to profile"):
            read_map(tmp_path / "line.csv")


def test_a_column_says_which_points_are_valid(tmp_path):
    z = np.random.default_rng(1).normal(size=40).round(4)
    valid = np.arange(40) % 7 != 3
    rows = "\n".join(
        f"{0.5 * i:.6f};{value:.6f};{int(ok)}" for i, (value, ok) in enumerate(zip(z, valid, strict=True))
    )
    (tmp_path / "line.hfm").write_text(f"X;Y;valid\n[mm];[mm];[1/0]\n{rows}\n")
    found = read_map(tmp_path / "line.hfm", format="profile")
    np.testing.assert_allclose(found.height[0], np.where(valid, 1e-3 * z, np.nan), rtol=1e-12)
    assert found.length[1] == pytest.approx(20e-3)


def test_an_uneven_line_scan_is_refused(tmp_path):
    """Points of a drawn curve, of which nine in ten would be filled on the grid of their smallest step."""
    place = np.cumsum(np.random.default_rng(1).integers(5, 15, size=60))
    np.savetxt(tmp_path / "line.txt", np.stack([1.159 * place, np.sin(place)], axis=1), fmt="%.7e")
    with pytest.raises(MapError, match="the positions x are not equally spaced"):
        read_map(tmp_path / "line.txt", format="profile", unit="um um")


GAPS = np.where(np.hypot(*np.mgrid[-4:4, -3:3]) < 1.5, np.nan, HEIGHT)


def test_grids_of_other_programs_are_maps(tmp_path):
    foreign_files.write_esri(tmp_path / "map.asc", GAPS, 0.5)
    foreign_files.write_surfer(tmp_path / "map.grd", GAPS, 0.5)
    for name in ("map.asc", "map.grd"):
        with pytest.raises(MapError, match="unit: the file does not say its units; set it"):
            prepare_map(tmp_path / name, periodic="mirrored", undefined="harmonic")
        assert_map(read_map(tmp_path / name, unit="mm um"), 1e-3, 1e-6, GAPS)
    foreign_files.write_keyence(tmp_path / "map.csv", HEIGHT, 500.0)
    assert_map(read_map(tmp_path / "map.csv"), 1e-6, 1e-6)
    foreign_files.write_zygo(tmp_path / "map.xyz", GAPS, 5e-7)
    assert_map(read_map(tmp_path / "map.xyz"), 1e-6, 1e-6, GAPS)
    for padding in range(4):
        foreign_files.write_gsf(tmp_path / "map.gsf", 1e-6 * GAPS, (4e-6, 3e-6), padding=padding)
        assert_map(read_map(tmp_path / "map.gsf"), 1e-6, 1e-6, GAPS)
    foreign_files.write_gsf(tmp_path / "map.gsf", GAPS, (4e-6, 3e-6), units=("m", "V"))
    with pytest.raises(MapError, match="unit: the file says 'V', which is no unit of length; set it"):
        read_map(tmp_path / "map.gsf")


def test_an_uncalibrated_lens_asks_for_edges(tmp_path):
    foreign_files.write_zygo(tmp_path / "map.xyz", HEIGHT, 0.0)
    with pytest.raises(MapError, match=r"unit: the file does not say the unit of its edges, 8 x 6 \(y, x\)"):
        read_map(tmp_path / "map.xyz")
    assert_map(read_map(tmp_path / "map.xyz", physical_size=("4 um", "3 um")), 1e-6, 1e-6)


def test_pictures_with_a_scale_have_edges(tmp_path):
    """Of ImageJ, and GeoTIFF in metres; a resolution for print is none."""
    heights = GAPS.astype("f4")
    tifffile.imwrite(
        tmp_path / "imagej.tif", heights, imagej=True, resolution=(2.0, 2.0), metadata={"unit": "um"}
    )
    keys = (1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, 9001)
    tags = [(33550, "d", 3, (0.5, 0.5, 0.0), True), (34735, "H", len(keys), keys, True)]
    gap = [(42113, "s", 6, "-9999", True)]
    tifffile.imwrite(tmp_path / "geo.tif", np.nan_to_num(heights, nan=-9999), extratags=[*tags, *gap])
    for name, lateral in (("imagej.tif", 1e-6), ("geo.tif", 1.0)):
        found = read_map(tmp_path / name, unit="nm", orientation="peaks up")
        assert_map(found, lateral, 1e-9, GAPS)
    tifffile.imwrite(tmp_path / "print.tif", heights, resolution=(72, 72), resolutionunit="INCH")
    with pytest.raises(MapError, match="physical_size: the file does not say the edges"):
        read_map(tmp_path / "print.tif", unit="nm", orientation="peaks up")


def workbook(path):
    """First bytes of a compound document, and the name of the stream of a workbook."""
    path.write_bytes(
        b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(2000) + "Workbook".encode("utf-16le") + bytes(99)
    )


def cube(path):
    xr.Dataset({"t": (("time", "y", "x"), np.zeros((3, 8, 6)))}).to_netcdf(path)


@pytest.mark.parametrize(
    ("name", "content", "line"),
    [
        ("m.xls", workbook, "it looks like a workbook of Excel; save the table of heights as CSV"),
        ("m.nc", cube, "its variable t lies over time, y, x: a map over two axes is needed"),
        ("m.grd", "DSRB\4\0\0\0", "it looks like a binary grid of Surfer; save it as"),
        ("m.asc", "Zygo ASCII Data File - Format 2\n1 2 3\n", "it looks like phase data of Zygo in ASCII"),
        ("m.grd", "DSAA\n6 8\n0 1\n0 1\n0 1\n1 2 3\n", "its heading says 8 x 6 heights"),
        ("m.asc", "ncols 6\nnrows 8\n1 2 3\n", "its heading has no cellsize"),
        ("m.gsf", "Gwyddion Simple Field 1.0\nXRes = 6\n", "its heading has no YRes"),
        ("m.txt", "1.25 " * 2**18, "a line of text has more than 900,000 characters"),
    ],
)
def test_other_formats_are_named_in_a_line(tmp_path, name, content, line):
    if callable(content):
        content(tmp_path / name)
    else:
        (tmp_path / name).write_text(content)
    with pytest.raises(MapError, match=re.escape(line)) as caught:
        read_map(tmp_path / name)
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize(
    ("heading", "unit"),
    [
        *(("Z [um]", "um"), ("Height map (nm)", "nm"), ("# Höhe [µm]", "µm"), ("height data in nm", "nm")),
        *(("Value units: um", "um"), ("X [mm]\nHeight [um]", "um"), ("\\Exported image units: nm", "nm")),
        *(("Wavelength [nm] 632.8", None), ("Wavelength [nm]", None), ("Z range [um] 5.2", None)),
        *(("Breite: 3 µm\nWerte in nm", "nm"), ("Pixel size: 0.5 um\nZ-unit: nm", "nm")),
        *(("Step [um]", None), ("Scan size [mm]", None), ("Height [um]\nData [nm]", None)),
        *(("Width[mm] Height[mm]\n1.5 2.5", None), ("Sample height [mm]", None)),
    ],
)
def test_a_unit_is_that_of_the_heights_where_the_heading_says_so(tmp_path, heading, unit):
    (tmp_path / "map.txt").write_text(f"{heading}\n{MATRIX}\n", encoding="utf-8")
    said = {"physical_size": ("4 um", "3 um"), "orientation": "peaks up"}
    if unit is None:
        with pytest.raises(MapError, match="unit: the file does not say"):
            prepare_map(tmp_path / "map.txt", periodic="mirrored", **said)
    else:
        assert read_map(tmp_path / "map.txt", **said).unit == unit


LARGE = np.random.default_rng(4).normal(size=(30, 40))
PLACES = {
    "rounded": lambda n: np.round(np.arange(n) * 0.0225, 2),
    "falling": lambda n: np.round(np.arange(n)[::-1] * 0.0225, 2),
    "printed": lambda n: np.arange(n) * 3e-7,
    "uneven": lambda n: np.cumsum(np.random.default_rng(0).uniform(0.5, 1.5, n)),
}


@pytest.mark.parametrize("name", PLACES)
@pytest.mark.parametrize("axis", ["row", "column", "both", "last column"])
def test_positions_beside_heights_are_refused(tmp_path, name, axis):
    heights = LARGE
    if axis in ("column", "both"):
        heights = np.c_[PLACES[name](30), heights]
    if axis == "last column":
        heights = np.c_[heights, PLACES[name](30)]
    elif axis != "column":
        heights = np.vstack([[0.0] * (axis == "both") + [*PLACES[name](40)], heights])
    np.savetxt(tmp_path / "map.txt", heights, fmt="%.4g")
    line = {"column": "first column", "last column": "last column"}.get(axis, "first row")
    with pytest.raises(MapError, match=f"its {line} holds numbers or positions of points; delete it"):
        read_map(tmp_path / "map.txt", physical_size=(1, 1), unit="um", orientation="peaks up")


def test_positions_under_a_word_are_named(tmp_path):
    rows = ["y\\x " + " ".join(f"{x:.2f}" for x in PLACES["rounded"](40))]
    rows += [f"{y:.2f} " + " ".join(map(str, row)) for y, row in zip(range(30), LARGE, strict=True)]
    (tmp_path / "map.txt").write_text("\n".join(rows))
    with pytest.raises(MapError, match="line 1: positions; delete them, in the first column too"):
        read_map(tmp_path / "map.txt")


@pytest.mark.parametrize("waves", [0.2, 0.7, 1.3])
def test_lines_of_smooth_surfaces_are_no_positions(tmp_path, waves):
    """The first row rises, as does the one beside it, or nearly so."""
    y, x = np.mgrid[:30, :40]
    heights = np.sin(waves * x / 40 + y / 5) + 0.3 * x + 1e-3 * LARGE
    np.savetxt(tmp_path / "map.txt", heights, fmt="%.3f")
    found = read_map(tmp_path / "map.txt", physical_size=(1, 1), unit="m", orientation="peaks up")
    np.testing.assert_allclose(found.height, heights, atol=6e-4)


@pytest.mark.parametrize(
    "word",
    [
        *("-nan(ind)", "NaNQ", "nan(snan)", "1.#QNAN", "#DIV/0!", "#N/A", "-", "---", "?", "...", "*"),
        *("NoData", "void", "-3.4028235E+38", "1.70141e38", "n.a.", "N/D", "k.A.", "#WERT!", "#NV", "undef"),
        *("<empty>", "_", "not_measured"),
    ],
)
@pytest.mark.parametrize("separator", ["\t", ";", " "])
def test_words_and_marks_of_programs_are_points_without_data(tmp_path, word, separator):
    rows, gaps = [[f"{z:.3f}" for z in row] for row in HEIGHT], ((0, 0), (3, 2), (4, 2))
    expected = HEIGHT.copy()
    for y, x in gaps:
        rows[y][x], expected[y, x] = word, np.nan
    (tmp_path / "map.txt").write_text("\n".join(map(separator.join, rows)))
    said = {"physical_size": ("4 um", "3 um"), "unit": "nm", "orientation": "peaks up"}
    assert_map(read_map(tmp_path / "map.txt", **said), 1e-6, 1e-9, expected)


CLOUD = "VERSION .7\nFIELDS {}\nWIDTH 48\nHEIGHT 1\nPOINTS 48\nDATA ascii\n"


@pytest.mark.parametrize(
    ("heading", "more"),
    [
        *(
            ("48\n", ""),
            ("6 8\n", ""),
            ("48\ncomment\n", ""),
            ("6\n8\n", ""),
            ("6 8 1\n", ""),
            ("x y z intensity\n", " {}"),
        ),
        *(("X Y Z R G B\n", " {0} 1 {0}"), (CLOUD.format("x y z"), "")),
        *((CLOUD.format("x y z intensity"), " {}"), ("ply\nproperty float x\nend_header\n", "")),
    ],
)
@pytest.mark.parametrize("edges", [{}, {"physical_size": (4, 3)}])
def test_a_list_of_points_is_recognised(tmp_path, heading, more, edges):
    rows = [" ".join(point) + more.format(number % 7) for number, point in enumerate(POINTS)]
    (tmp_path / "points.txt").write_text(heading + "\n".join(rows))
    assert_map(read_map(tmp_path / "points.txt", **edges), 1, 1)


def test_one_row_is_no_map(tmp_path):
    (tmp_path / "row.txt").write_text("1 2 4 " * 40)
    with pytest.raises(MapError, match="a rectangular map is needed, not a line scan of 120 points"):
        read_map(tmp_path / "row.txt")


def test_a_list_of_points_without_a_heading_is_no_map_of_four_columns(tmp_path):
    points = [(0.5 * x, 0.5 * y, LARGE[y, x], y % 3) for y in range(30) for x in range(40)]
    np.savetxt(tmp_path / "points.txt", points)
    found = read_map(tmp_path / "points.txt", physical_size=(15, 20))
    np.testing.assert_allclose(found.height, LARGE)
    np.save(tmp_path / "points.npy", points)
    with pytest.raises(MapError, match="a table of 1200 x 4 numbers is a list of points or a log, not a map"):
        read_map(tmp_path / "points.npy", physical_size=(15, 20), unit="um", orientation="peaks up")


@pytest.mark.parametrize(
    ("heading", "separator", "mark", "numbered"),
    [
        ("Objective,50\nX Resolution,0.5,um\nY Resolution,0.5,um\nLine,a,b,c,d,e,f\nz in nm", ",", ".", True),
        ("X Pitch;0,5;um\nY Pitch;0,5;um\nZ unit;nm", ";", ",", True),
        ("numCols\tnumRows\tpixelSize (um)\n6\t8\t0.5\nheight data (nm)", "\t", ".", False),
        (
            '"XY-Justierung";"500,0";"nm"\n"Horizont.";"6"\n"Vertikal";"8"\n"Einheit";"nm"\n"Höhe"',
            ";",
            ",",
            False,
        ),
        ('"Calibrage XY";"500,0";"nm"\n"Unité";"nm"\n"Hauteur"', ";", ",", False),
        ("# Pixel size [nm]: 500\n# heights (nm)", " ", ".", False),
        ("Pixelgröße [µm]: 0,5\nEinheit der Höhe: nm", "\t", ",", False),
        ("dx = 0.5 um\ndy = 0.5 um\nz (nm)\n6\n8", "\t", ".", False),
        ("Columns: 6\nPixel size: 0.5 um\nValue units: nm", " ", ".", False),
    ],
)
def test_a_pixel_in_the_heading_gives_the_edges(tmp_path, heading, separator, mark, numbered):
    rows = [[str(y)] * numbered + [f"{z:.3f}".replace(".", mark) for z in HEIGHT[y]] for y in range(8)]
    (tmp_path / "map.csv").write_bytes("\r\n".join([heading, *map(separator.join, rows)]).encode("cp1252"))
    found = read_map(tmp_path / "map.csv")
    assert_map(found, 1e-6, 1e-9)
    assert (found.unit, found.orientation) == ("nm", "peaks up")


@pytest.mark.parametrize("separator", [";", "\t", " "])
@pytest.mark.parametrize("mark", [",", "."])
def test_a_mark_between_thousands_or_decimals_is_asked(tmp_path, separator, mark):
    numbers = np.rint(2e4 * np.abs(LARGE)) + 1  # some below a thousand
    rows = [separator.join(f"{z:,.0f}".replace(",", mark) for z in row) for row in numbers]
    (tmp_path / "map.txt").write_text("\n".join(rows))
    with pytest.raises(MapError, match=f"'{mark}' may separate thousands or decimals"):
        read_map(tmp_path / "map.txt")
    said = {"physical_size": (1, 1), "unit": "m", "orientation": "peaks up"}
    for form in ("{:.3f}", "{:.5g}"):  # decimals only
        texts = [[form.format(z) for z in row] for row in np.abs(LARGE)]
        (tmp_path / "map.txt").write_text("\n".join(separator.join(row).replace(".", mark) for row in texts))
        np.testing.assert_array_equal(read_map(tmp_path / "map.txt", **said).height, np.array(texts, float))


def test_pictures_in_big_and_ome_tiff(tmp_path):
    tifffile.imwrite(tmp_path / "map.tif", HEIGHT, bigtiff=True)
    said = {"physical_size": ("4 um", "3 um"), "unit": "um", "orientation": "peaks up"}
    assert_map(read_map(tmp_path / "map.tif", **said), 1e-6, 1e-6)
    sizes = {"PhysicalSizeX": 500.0, "PhysicalSizeXUnit": "nm", "PhysicalSizeY": 0.5}  # µm where none is said
    tifffile.imwrite(tmp_path / "map.ome.tif", HEIGHT, ome=True, metadata={"axes": "YX", **sizes})
    del said["physical_size"]
    assert_map(read_map(tmp_path / "map.ome.tif", **said), 1e-6, 1e-6)
    tifffile.imwrite(tmp_path / "map.ome.tif", HEIGHT, ome=True, metadata={"axes": "YX"})
    with pytest.raises(MapError, match="physical_size: the file does not say the edges"):
        read_map(tmp_path / "map.ome.tif", **said)


def test_a_quoted_field_of_any_length_is_a_field(tmp_path):
    """The csv module refuses those of more than 131,072 characters."""
    rows = ['"1","2","3"'] * 5
    (tmp_path / "map.csv").write_text("\n".join([*rows, f'"{"1" * 140_000}","2","3"']))
    with pytest.raises(MapError, match="a point has no position"):
        read_map(tmp_path / "map.csv")


def test_values_in_a_heading_are_no_units(tmp_path):
    """The unit of a length beside a number is not the unit of a column."""
    for heading in ("Length: 30 mm", "Length,30.0 mm", "Stylus,Radius: 2.5 um"):
        (tmp_path / "line.csv").write_text(f"{heading}\n" + "".join(f"{i},{i % 3}\n" for i in range(9)))
        with pytest.raises(MapError, match="unit: the file does not say its units"):
            prepare_map(tmp_path / "line.csv", format="profile", periodic="mirrored")
        (tmp_path / "line.csv").write_text(
            f"{heading.partition(',')[0]}\n" + "".join(f"{i % 3}\n" for i in range(9))
        )
        with pytest.raises(MapError, match="unit: the file does not say the unit of its heights"):
            prepare_map(tmp_path / "line.csv", format="profile", periodic="mirrored", physical_size=(1, 1))


def test_a_name_of_points_has_an_extension(tmp_path):
    np.save(tmp_path / "map.npy", HEIGHT)
    (tmp_path / "map.npy").rename(tmp_path / "...txt")
    with pytest.raises(
        MapError, match="its name is of format asc or xyz or profile or esri, its content of npy"
    ):
        read_map(tmp_path / "...txt")


def test_axes_of_one_point_are_dropped(tmp_path):
    place = {
        axis: (axis, 0.5 * np.arange(n), {"units": "um"}) for axis, n in zip("yx", HEIGHT.shape, strict=True)
    }
    data = xr.Dataset({"z": (("time", "y", "x"), HEIGHT[None], {"units": "nm"})}, place)
    data.to_netcdf(tmp_path / "map.nc")
    assert_map(read_map(tmp_path / "map.nc", orientation="peaks up"), 1e-6, 1e-9)
