"""Maps as instruments and programs write them: each kind is made here, with heights that are known."""

import re

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.surface.reading.height_map import MapError, MapOptions
from asperity.surface.reading.map_file import read_map

pytest.importorskip("SurfaceTopography")

HEIGHT = np.random.default_rng(3).normal(size=(8, 6)).round(3)
BARE = {"physical_size": (8, 6), "unit": "um", "orientation": "peaks up"}


def quoted(rows, text, separator=","):
    return "\n".join(separator.join(f'"{text(value)}"' for value in row) for row in rows) + "\n"


def german(value):
    return f"{value:,.3f}".translate(str.maketrans(".,", ",."))


@pytest.mark.parametrize(
    ("text", "height"),
    [
        (quoted(4 + HEIGHT / 9, "{:.3f}".format), (4 + HEIGHT / 9).round(3)),
        (
            quoted(4 + HEIGHT / 9, german),
            (4 + HEIGHT / 9).round(3),
        ),  # 3,917: as pandas writes with decimal=","
        (quoted(HEIGHT, german, ";"), HEIGHT),
        (quoted(4500 + HEIGHT, "{:,.1f}".format), (4500 + HEIGHT).round(1)),
        (quoted(1000 + 500 * HEIGHT, "{:,.0f}".format), (1000 + 500 * HEIGHT).round()),
        (quoted(4500 + HEIGHT, "{:,.3f}".format, ";"), (4500 + HEIGHT).round(3)),
        (quoted(4500 + HEIGHT, german, ";"), (4500 + HEIGHT).round(3)),
        (quoted(4500 + HEIGHT, german, "\t"), (4500 + HEIGHT).round(3)),
        (quoted(HEIGHT, "{:.3f}".format, " "), HEIGHT),
    ],
    ids=range(9),
)
def test_quoted_numbers_are_split_as_csv(tmp_path, text, height):
    (tmp_path / "map.csv").write_text(text)
    np.testing.assert_allclose(read_map(tmp_path / "map.csv", **BARE).height, 1e-6 * height, rtol=1e-12)


def test_quoted_points_are_a_map(tmp_path):
    y, x = np.mgrid[:8, :6] * 0.5
    (tmp_path / "map.csv").write_text(quoted(zip(x.flat, y.flat, HEIGHT.flat, strict=True), german))
    found = read_map(tmp_path / "map.csv", unit="um")
    assert found.length == pytest.approx((4e-6, 3e-6))
    np.testing.assert_allclose(found.height, 1e-6 * HEIGHT, rtol=1e-12)


def wyko(real):
    sizes = [
        ("X Size", "8"),
        ("Y Size", "6"),
        ("Pixel_size", "7", "4", "0.002"),
        ("Wavelength", "7", "4", "632.8"),
    ]
    return [
        ("Wyko ASCII Data File Format 0", real, "1"),
        *sizes,
        ("Mult", "7", "4", "1"),
        ("RAW_DATA", "3", "192", ""),
    ]


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


@pytest.mark.parametrize("separator", ["\t", " ", ";"])
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
def test_headings_are_read_with_every_separator(tmp_path, separator, header, factor, second):
    """Also if another block follows, whose channel is another one."""

    def block(lines, rows):
        words = [line if isinstance(line, str) else separator.join(line) for line in lines]
        return "\n".join([*words, *(separator.join(f"{z:.3f}" for z in row) for row in rows)]) + "\n"

    for more in ("", block(second, 1000 + HEIGHT) if second else ""):
        (tmp_path / "map.asc").write_text(block(header, HEIGHT) + more)
        found = read_map(tmp_path / "map.asc", channel="0")
        np.testing.assert_allclose(found.height, 1e-9 * factor * HEIGHT, rtol=1e-12)
        assert found.length == pytest.approx((16e-6, 12e-6))
    if second:
        found = read_map(tmp_path / "map.asc", channel="1")
        np.testing.assert_allclose(found.height, 1e-9 * factor * (1000 + HEIGHT), rtol=1e-12)


def test_a_wrong_row_below_a_heading_is_refused(tmp_path):
    (tmp_path / "map.asc").write_text("\n".join([*GWYDDION, "1 2 3 4", "1 x 3 4", "1 2 3 4"]))
    with pytest.raises(MapError, match=re.escape("line 6: 'x' is no number")):
        read_map(tmp_path / "map.asc")


@pytest.mark.parametrize(
    ("names", "chosen"),
    [
        (["mask", "height"], "height"),
        (["X", "Y", "Z"], "Z"),
        (["intensity", "topography"], "topography"),
        (["Error", "Channel 2"], "Channel 2"),
        (["HeightRetrace", "DeflectionRetrace", "HeightTrace"], "HeightTrace"),
        (
            ["Scan forward (Deflection)", "Scan backward (Z-Axis)", "Scan forward (Z-Axis)"],
            "Scan forward (Z-Axis)",
        ),
        (["vDeflection", "measuredHeight"], "measuredHeight"),
        (["height_error", "height"], "height"),
        (["a", "b"], None),
        (["Height Sensor", "Peak Force Error", "Height"], None),
        (["Topography", "Topography 2"], None),
        (["Phase", "Error"], None),
    ],
    ids=range(12),
)
def test_the_channel_of_the_heights_is_found_by_its_name(tmp_path, names, chosen):
    arrays = {name: HEIGHT + number for number, name in enumerate(names)}
    np.savez(tmp_path / "map.npz", **arrays)
    if chosen is None:
        with pytest.raises(MapError, match=r"channel: .*; set it$"):
            read_map(tmp_path / "map.npz", **BARE)
    else:
        assert read_map(tmp_path / "map.npz", **BARE).channel == chosen
    found = read_map(tmp_path / "map.npz", **BARE, channel="1")
    np.testing.assert_allclose(found.height, 1e-6 * arrays[names[1]], rtol=1e-15)


def test_the_channel_is_named_in_the_answer_and_every_file(tmp_path):
    pytest.importorskip("matplotlib")
    np.savez(tmp_path / "map.npz", mask=HEIGHT, z=HEIGHT)
    options = MapOptions(physical_size=("8 um", "6 um"), unit="nm")
    load = {"mean_pressure": 1e6, "map_options": options}
    answer = asp.run(tmp_path / "map.npz", asp.Body(young=1e9, poisson=0.3), **load)
    assert "channel of the file: z" in answer.text()
    asp.write_answer(answer, tmp_path / "out")
    assert "channel: z" in (tmp_path / "out/case.yaml").read_text()
    assert "channel of the file: z" in (tmp_path / "out/report.html").read_text()
    assert "channel of the file: z" in xr.load_dataset(tmp_path / "out/surface.nc").attrs["map_treatment"]
    for name in ("surface", "contact", "stress"):
        assert '"channel": "z"' in xr.load_dataset(tmp_path / f"out/{name}.nc").attrs["settings"]


def test_a_channel_that_is_not_there_is_refused_for_text_too(tmp_path):
    np.savetxt(tmp_path / "map.txt", HEIGHT)
    with pytest.raises(MapError, match=re.escape("channel = '5': one of 0 (Default) is needed")):
        read_map(tmp_path / "map.txt", **BARE, channel="5")
