"""Scan lines, Gaussian filters, material ratio curve and line scans, compared with closed forms."""

import numpy as np
import pytest

import asperity as asp
from asperity.surface.description import describe_map
from asperity.surface.reading.height_map import HeightMap, MapError, MapOptions
from asperity.surface.reading.map_file import read_map
from asperity.surface.roughness import core_roughness
from asperity.surface.treatment.levelling import gaussian_filter, level_lines
from asperity.surface.treatment.treatment import make_periodic, treat_map

ROUGH = asp.self_affine((48, 64), 0.8, 0.1, 0.05, rms_height=1.0, seed=1, length=(0.75, 1.0))


def test_offsets_of_scan_lines_are_removed():
    """Lines of one distribution by their medians; a step on less than half of each line by matching."""
    rng = np.random.default_rng(1)
    lines = np.stack([rng.permutation(64) for _ in range(48)]).astype(float)
    offsets = 5 * rng.normal(size=48)
    offsets -= offsets.mean()
    found, removed = level_lines(lines + offsets[:, None], "median")
    np.testing.assert_allclose(found - found[0, 0], lines - lines[0, 0], atol=1e-12)
    np.testing.assert_allclose(removed, offsets, atol=1e-12)
    smooth = np.zeros((48, 64))
    smooth[20:30, :25] = 3.0
    found, removed = level_lines(smooth + offsets[:, None], "matched")
    np.testing.assert_allclose(found - found[0, 0], smooth, atol=1e-12)
    gaps = np.where(rng.random((48, 64)) < 0.2, np.nan, lines + offsets[:, None])
    gaps[7] = np.nan
    for how in ("median", "matched"):
        found, removed = level_lines(gaps, how)
        assert np.isfinite(removed).all()
        np.testing.assert_array_equal(np.isnan(found), np.isnan(gaps))


@pytest.mark.parametrize("length", [0.05, 0.1, 0.25])
@pytest.mark.parametrize("periodic", [True, False])
def test_gaussian_filters_halve_at_their_nesting_index(length, periodic):
    """ISO 16610-61; a cosine is even about the edge of a map half of a pixel before its first point."""
    grid = asp.Grid((40, 60), (1.0, 1.5), mirrored=not periodic)
    y = (np.arange(40) + (0 if periodic else 0.5)) / 40
    wave = np.cos(2 * np.pi * y / length)[:, None] * np.ones(60)
    share = 2 ** -((0.1 / length) ** 2)
    for s_filter, l_filter, expected in (
        (0.1, None, share),
        (None, 0.1, 1 - share),
        (0.1, 0.1, share * (1 - share)),
    ):
        found = gaussian_filter(wave, grid, s_filter, l_filter)
        np.testing.assert_allclose(found, expected * wave, atol=1e-13)


@pytest.mark.parametrize("periodic", ["declared", "mirrored", "none"])
def test_what_filters_leave_is_stated(periodic):
    surface = HeightMap(ROUGH, (0.75, 1.0))
    options = MapOptions(periodic=periodic, detrend="none")
    plain = treat_map(surface, options)
    filtered = treat_map(surface, options, s_filter=0.08, l_filter=0.5)
    record = filtered.treatment
    assert filtered.height.std() / plain.height.std() == pytest.approx(record.filtered_height, rel=1e-9)
    assert 0 < record.filtered_gradient < 1
    assert any(line.startswith("Gaussian S-filter of 0.08 and L-filter of 0.5: Sq") for line in filtered.done)
    if periodic != "none":  # in units of the cell
        edge = 2.0 if periodic == "mirrored" else 1.0
        scaled = make_periodic(surface, options, s_filter=0.08 / edge, l_filter=0.5 / edge)
        np.testing.assert_allclose(scaled.height * edge, filtered.height, atol=1e-12)
    with pytest.raises(MapError, match=r"s_filter = 0.5: less than l_filter = 0.5 is needed"):
        treat_map(surface, options, s_filter=0.5, l_filter=0.5)
    with pytest.raises(
        MapError, match=r"s_filter = 1000: a filter that leaves some of the heights is needed"
    ):
        treat_map(surface, options, s_filter=1000)


def test_answer_says_what_a_filter_does():
    surface = HeightMap(1e-7 * ROUGH, (75e-6, 100e-6), unit="m", periodic=True)
    body, load = asp.Body(young=210e9, poisson=0.3), {"mean_pressure": 20e6}
    plain = asp.run(surface, body, **load)
    answer = asp.run({"file": surface, "s_filter": "10 um"}, body, **load)
    (note,) = [each for each in answer.warnings if each.subject == "filters"]
    assert f"{100 * answer.face.treatment.filtered_gradient:.0f} % of Sdq" in note.text
    area = plain["contact area fraction"].value
    assert answer["contact area fraction"].value > 1.5 * area
    assert f"a contact area fraction of {100 * area:.4g} %" in note.text
    assert not [each for each in plain.warnings if each.subject == "filters"]


def test_core_of_a_piecewise_straight_curve():
    """Core of slope 2; peaks of 5 above it over a tenth of the area, valleys of 3 below it over a fifth.

    There the curve is a parabola, whose area is a third of base times height: a triangle of this area has
    two thirds of its height.
    """
    ratio = (np.arange(100_000) + 0.5) / 100_000
    height = 1.0 - 2.0 * ratio
    peaks, valleys = ratio < 0.1, ratio > 0.8
    height[peaks] = 1.0 + 5.0 * (1 - ratio[peaks] / 0.1) ** 2
    height[valleys] = -1.0 - 3.0 * ((ratio[valleys] - 0.8) / 0.2) ** 2
    found = core_roughness(np.random.default_rng(1).permutation(height).reshape(250, 400))
    assert found.core == pytest.approx(2.0, rel=1e-3)  # classes of 1/5000
    assert found.peaks == pytest.approx(2 / 3 * 5, rel=5e-3)
    assert found.valleys == pytest.approx(2 / 3 * 3, rel=5e-3)


def write_wave(path, header, amplitude=2e-4, count=256):
    """One cosine wave of 1 mm in µm, its crest between two points."""
    x = np.arange(count) / count
    z = 1e3 * amplitude * np.cos(2 * np.pi * (x + 0.5 / count))
    path.write_text(
        header + "".join(f"{place:.9f} {height:.9f}\n" for place, height in zip(x, z, strict=True))
    )


def test_line_scan_is_pressed_in_plane_strain(tmp_path):
    """Contact of a wave with a half-space: H. M. Westergaard, J. Appl. Mech. 6 (1939) A49."""
    path = tmp_path / "line.txt"
    write_wave(path, "x [mm] z [um]\n")
    with pytest.raises(MapError, match="not a line scan of 2 columns; set format to profile to take it"):
        read_map(path)
    known = {"format": "profile", "orientation": "peaks up", "periodic": "declared", "detrend": "none"}
    options = MapOptions(**known)
    assert read_map(path, options).length == pytest.approx((4e-3 / 256, 1e-3))
    body = asp.Body(young=100e9, poisson=0.3)
    pressure = np.pi * asp.Solid(100e9, 0.3).effective_modulus * 2e-7 / 1e-3 * np.sin(np.pi * 0.15) ** 2
    answer = asp.run({"file": path, **known}, body, mean_pressure=pressure)
    assert answer["contact area fraction"].value == pytest.approx(0.3, abs=2 / 256)  # nodes at both ends
    largest = 2 * pressure / np.sin(np.pi * 0.15)  # in the middle of the contact
    # Discretisation, O(1 / nodes).
    assert answer["maximum pressure"].value == pytest.approx(largest, rel=5e-3)
    assert "line scan: the same heights for all y, which is plane strain" in answer.face.done
    shown = describe_map(path, options).properties
    assert shown["Rq"].startswith("141.4 nm")
    assert shown["Rz"].startswith("400 nm")
    assert not {"Sq", "Sal", "Str", "Ral"} & shown.keys()


def test_a_line_scan_without_positions_and_with_gaps(tmp_path):
    (tmp_path / "z.txt").write_text("\n".join(map(str, [0.1, 0.4, "nan", 0.2, 0.3])))
    said = {"format": "profile", "unit": "um", "orientation": "peaks up", "physical_size": ("4 um", "5 um")}
    found = read_map(tmp_path / "z.txt", **said)
    assert (found.height.shape, found.missing) == ((4, 5), 4)
    (tmp_path / "xz.txt").write_text("0 1\n1 2\n3 1\n4 2\n5 5\n")
    found = read_map(tmp_path / "xz.txt", **said | {"physical_size": None, "unit": "um um"})
    assert (found.height.shape, found.missing, found.length) == ((4, 6), 4, pytest.approx((4e-6, 6e-6)))
