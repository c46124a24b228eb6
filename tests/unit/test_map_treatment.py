"""Treatment of maps: spikes, gaps, levels, windows, waves in metres, and the record of all of it."""

import re

import numpy as np
import pytest

from asperity.spectral import Grid
from asperity.surface.height_map import HeightMap, MapError
from asperity.surface.levelling import edge_step, fill_harmonic, find_spikes, low_pass_bounded
from asperity.surface.self_affine import self_affine
from asperity.surface.treatment import DESPIKE, Treatment, treat_map

EDGE = 256e-6


def steel(points=64, hurst=0.8, seed=1):
    """A part of a self-affine surface, so that it is not periodic, on 4 µm pixels."""
    band = {"hurst": hurst, "wavelength_long": 0.25, "wavelength_short": 0.03, "rms_height": 1e-3}
    return EDGE * self_affine((2 * points, 2 * points), seed=seed, **band)[:points, :points]


def as_map(height, **said):
    return HeightMap(height, (EDGE, EDGE), unit="m", **said)


@pytest.mark.parametrize("hurst", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("shortest", [0.004, 0.03])
def test_a_gaussian_surface_has_no_spikes(hurst, shortest):
    band = {"hurst": hurst, "wavelength_long": 0.25, "wavelength_short": shortest, "rms_height": 1e-3}
    assert not find_spikes(self_affine((512, 512), seed=2, **band), DESPIKE).any()


def test_spikes_are_found_and_scratches_stay():
    height = steel()
    spots = [(5, 5), (5, 6), (30, 40), (0, 63), (63, 20)]
    spiky = height.copy()
    for spot in spots:
        spiky[spot] += 20 * height.std()
    spiky[40, :] -= 20 * height.std()  # a scratch across the map
    spiky[10:20, 50:60] += 20 * height.std()  # a particle
    found = find_spikes(spiky, DESPIKE)
    assert {(int(i), int(j)) for i, j in np.argwhere(found)} == set(spots)


def test_a_spike_beside_a_gap_is_found_and_gaps_are_no_spikes():
    height = steel()
    height[20:30, 20:30] = np.nan
    height[31, 25] += 20 * np.nanstd(height)
    assert np.argwhere(find_spikes(height, DESPIKE)).tolist() == [[31, 25]]


def test_quantised_heights_are_no_spikes():
    height = np.round(steel() / 2e-7)  # half of the points equal their neighbours
    assert not find_spikes(height, DESPIKE).any()
    assert not find_spikes(np.zeros((16, 16)), DESPIKE).any()


def test_a_gap_is_filled_by_a_harmonic_function():
    y, x = np.mgrid[:20, :24].astype(float)
    harmonic = x**2 - y**2 + 3 * x * y  # also harmonic for differences between neighbours
    missing = np.zeros(harmonic.shape, bool)
    missing[5:9, 6:12] = missing[15, 3] = True
    filled = fill_harmonic(np.where(missing, np.nan, harmonic), missing)
    np.testing.assert_allclose(filled, harmonic, atol=1e-9)  # rounding of a linear solve


def test_the_record_says_what_was_done():
    height = steel()
    y, x = (np.arange(64) + 0.5)[:, None] / 64, (np.arange(64) + 0.5)[None, :] / 64
    bow = 3e-6 * (2 * x - 1) ** 2
    tilted = height + EDGE * (0.03 * x - 0.04 * y) + bow
    tilted[10, 11] += 1e-4
    tilted[50:52, 7] = np.nan
    settings = Treatment("curvature", "windowed", "harmonic", DESPIKE, wavelength_short=20e-6, points=32)
    record = treat_map(as_map(tilted), settings).treatment
    assert (record.missing, record.spikes) == (2, 1)
    assert record.filled_fraction == 3 / 64**2
    own = np.polyfit(x[0], height.mean(axis=0), 1)[0], np.polyfit(y[:, 0], height.mean(axis=1), 1)[0]
    slope = np.hypot(0.03 + own[0] / EDGE, -0.04 + own[1] / EDGE)
    assert np.tan(record.tilt) == pytest.approx(slope, rel=0.02)  # the filled points
    assert record.bow == pytest.approx(np.ptp(bow), rel=0.3)  # the curvature of the roughness itself
    assert record.altered_fraction == pytest.approx(1 - 0.8**2, abs=0.03)  # nodes at the ends of the taper
    assert (record.points_y, record.points_x, record.length_y) == (32, 32, EDGE)
    text = "\n".join(record.lines())
    for words in (
        "turned upside down",
        "1 points (0.024 %) beyond 8",
        "2 points (0.049 %)",
        "tilt of 2.",
        "% of the area",
        "waves shorter than 20 µm",
        "resampled to 32 x 32",
    ):
        assert words in text
    attributes = record.attributes()
    assert attributes["map_spikes"] == 1
    assert all(isinstance(value, (int, float, str)) for value in attributes.values())


def test_an_untouched_map_says_so():
    height = np.cos(2 * np.pi * np.arange(32) / 32)[:, None] * np.ones(32)
    treated = treat_map(as_map(height, periodic=True, orientation="lower face"), Treatment("none"))
    np.testing.assert_allclose(treated.height, height, atol=1e-15)
    assert treated.treatment.lines() == [
        "used as it is: the heights are those of an indenter's lower face",
        "levelled: mean height removed",
        f"taken as one period, as the file states: edge step {edge_step(height):.3g} times that between "
        "neighbouring points",
    ]


@pytest.mark.parametrize("periodic", ["declared", "mirrored", "windowed", "none"])
def test_a_wavelength_means_the_same_for_every_way_to_a_period(periodic):
    """A wave of 16 µm is kept by a limit of 15 µm and removed by one of 17 µm, mirrored or not."""
    x = (np.arange(64) + 0.5) * 4e-6
    long, short = np.cos(2 * np.pi * x / 64e-6), np.cos(2 * np.pi * x / 16e-6)
    surface = as_map(np.ones((64, 1)) * (long + 0.1 * short)[None, :])
    middle = slice(16, 48)
    # The window spreads each wave over its neighbours.
    for limit, share in ((15e-6, 0.1), (17e-6, 0.0)):
        treated = treat_map(surface, Treatment("none", periodic, wavelength_short=limit))
        profile = -treated.height[32, middle]
        fit = np.linalg.lstsq(
            np.column_stack([long[middle], short[middle], np.ones(32)]), profile, rcond=None
        )[0]
        assert fit[:2] == pytest.approx([1.0, share], abs=0.01 if periodic == "windowed" else 1e-12)


def test_a_map_that_stays_bounded_keeps_its_edges():
    height = steel() + np.linspace(0, 1e-5, 64)[:, None]
    treated = treat_map(as_map(height), Treatment("none", "none"))
    np.testing.assert_allclose(treated.height, height.mean() - height, atol=1e-18)
    grid = Grid((64, 64), (EDGE, EDGE))
    finer = Grid((128, 192), (EDGE, EDGE))
    fine = low_pass_bounded(height, grid, finer, None)
    np.testing.assert_allclose(low_pass_bounded(fine, finer, grid, None), height - height.mean(), atol=1e-18)
    step = np.abs(fine[-1] - fine[0]).mean()
    assert step == pytest.approx(np.abs(height[-1] - height[0]).mean(), rel=0.02)


def test_settings_out_of_range_and_missing_are_reported_together():
    height = steel()
    height[0, 0] = np.nan
    with pytest.raises(MapError) as caught:
        treat_map(as_map(height, orientation=None), Treatment("slope", despike=1.0))
    assert [problem.split(":")[0] for problem in caught.value.problems] == [
        "detrend = 'slope'",
        "despike = 1.0",
        "orientation",
        "periodic",
        "undefined",
    ]


def test_problems_of_a_map_without_a_name_are_counted():
    surface = HeightMap(steel(), (1.0, 1.0), True)
    with pytest.raises(MapError, match=r"^2 problems:\n  detrend = 'slope': .*\n  despike = 1.0: "):
        treat_map(surface, Treatment("slope", despike=1.0))


def test_a_wavelength_out_of_range_is_shown_with_its_unit():
    line = "wavelength_short = 1 µm: a number ≥ 8 µm (two nodes), ≤ 512 µm is needed"
    with pytest.raises(MapError, match=re.escape(line)):
        treat_map(as_map(steel()), Treatment("tilt", "mirrored", wavelength_short=1e-6))


def test_a_wavelength_that_no_number_holds_is_refused():
    with pytest.raises(MapError, match=r"wavelength_short = 1000.*: a number ≥ 8 µm"):
        treat_map(as_map(steel()), Treatment("tilt", "mirrored", wavelength_short=10**400))
