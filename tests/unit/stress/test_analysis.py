"""`analyse_stress`: peaks, profiles and covariances against values from the planes, one by one."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from samples import refuses, spots

import asperity as asp
from asperity.fourier.grid import Fourier
from asperity.stress.analysis import QUANTITIES, analyse_lateral_conditions
from asperity.stress.planes import stream
from asperity.stress.planes.planes import depth_grid
from asperity.stress.statistics import covariance
from asperity.stress.statistics.covariance import decay_lengths

RATIOS = [0.0, 0.33, 0.5]
SETTINGS = {"poisson": RATIOS, "quantities": QUANTITIES, "tolerance": 1e-5}
COVARIANCES = {"poisson": RATIOS, "covariances": True}


def rough(points=96, layer=None):
    """A pressure with many spots of many sizes: what exceeds a threshold of a random field."""
    grid = asp.Grid((points, points))
    wavenumber = grid.wavenumber() / (2 * np.pi)
    band = np.where((wavenumber > 3) & (wavenumber < 14), np.maximum(wavenumber, 1) ** -1.8, 0)
    field = Fourier(grid).inverse(band * np.exp(2j * np.pi * np.random.default_rng(0).random(band.shape)))
    excess = np.maximum(field - np.quantile(field, 0.85), 0.0)
    layer = layer or asp.Solid(young=1.0, poisson=0.33)
    return asp.LoadedSolid(0.1 * np.sqrt(excess / excess.max()), grid, layer)


@pytest.fixture(scope="module")
def contact():
    return rough()


@pytest.fixture(scope="module")
def result(contact):
    return asp.analyse_stress(contact, **SETTINGS, covariances=True)


@pytest.fixture(scope="module")
def exact(contact):
    return asp.analyse_stress(contact, tolerance=0, **COVARIANCES)


def test_peaks_are_those_of_searched_planes(contact):
    """On one grid throughout, against the plain search through planes of each field."""
    depths = depth_grid(contact.grid, growth=0.3)
    data = asp.analyse_stress(contact, depths, RATIOS, QUANTITIES, tolerance=0, floor=0.0)
    for name in QUANTITIES[1:]:
        # Away from the contacts the hydrostatic stress of the surface is constant but for rounding.
        selection = "at_contact" if name == "hydrostatic" else "all"
        for nu in RATIOS[::2]:
            expected = asp.stress.find_peaks(
                asp.stress_planes(contact, depths, nu, (name,), tolerance=0), name
            )
            kept = np.abs(expected.value) > 1e-9
            if name == "hydrostatic":
                kept &= expected.under_contact(contact.pressure, contact.grid)
            mine = asp.stress.select_peaks(data, name, nu, selection)
            mine = mine.isel(peak=np.flatnonzero(np.abs(mine["peak_value"].values) > 1e-9))
            assert mine.sizes["peak"] == np.sum(kept), (name, nu)
            order, other = np.argsort(expected.value[kept]), np.argsort(mine["peak_value"].values)
            np.testing.assert_allclose(mine["peak_value"][other], expected.value[kept][order], rtol=1e-8)
            np.testing.assert_array_equal(mine["peak_interior"][other], expected.interior[kept][order])


def test_fields_searched_together_have_the_peaks_of_each(contact):
    """To the last bit, also where the grid changes and maxima of several fields match."""
    settings = {"poisson": RATIOS, "tolerance": 1e-3}
    together = asp.analyse_stress(contact, quantities=QUANTITIES, **settings)
    assert np.unique(together["plane_points"]).size > 4
    for name in ("von_mises", "xx", "xz", "principal_1"):
        alone = asp.analyse_stress(contact, quantities=[name], **settings)
        mine, expected = (asp.stress.select_peaks(data, name, RATIOS[1]) for data in (together, alone))
        assert expected.sizes["peak"] > 20
        xr.testing.assert_equal(mine, expected)


def test_profile_and_covariance_are_those_of_the_planes(contact, exact):
    """Eq. 22, on the full grid: against its definition."""
    depths = exact["plane_depth"].values
    fields = [plane.fields["von_mises"] for plane in asp.stress_planes(contact, depths, RATIOS, tolerance=0)]
    for number in range(len(RATIOS)):
        here, planes = exact.isel(poisson=number), np.stack([field[number] for field in fields])
        mean, largest = planes.mean(axis=(1, 2)), planes.max(axis=(1, 2))
        best = int(np.argmax(largest))
        covariance = np.mean(planes * planes[best], axis=(1, 2)) - mean * mean[best]
        lag, plane = asp.stress.autocorrelation(planes[best], contact.grid)
        np.testing.assert_allclose(here["mean_von_mises"], mean, rtol=1e-12)
        np.testing.assert_allclose(here["maximum_von_mises"], largest, rtol=1e-12)
        assert here["reference_depth"] == depths[best]
        np.testing.assert_allclose(here["covariance_depth"], covariance, rtol=1e-9, atol=1e-15)
        np.testing.assert_allclose(here["covariance_plane"], plane, rtol=1e-9, atol=1e-15)
        np.testing.assert_allclose(exact["lag"], lag)


@pytest.mark.parametrize("tolerance", [1e-5, 1e-4])
def test_coarse_planes_keep_the_statistics(contact, exact, tolerance):
    """At 1e-4 they are in single precision, and those above the reference are kept in 16 bits."""
    coarse = asp.analyse_stress(contact, tolerance=tolerance, **COVARIANCES)
    assert coarse["plane_points"][-1] < exact["plane_points"][-1]
    assert (exact["reference_depth"] > exact["plane_depth"][1]).all()
    np.testing.assert_array_equal(coarse["reference_depth"], exact["reference_depth"])
    scale, shares = float(exact["maximum_von_mises"].max()), [0.1, 0.5, 0.9, 0.99]
    # Coarse nodes miss the very top of a plane.
    largest = exact["maximum_von_mises"]
    np.testing.assert_allclose(coarse["maximum_von_mises"], largest, rtol=0.03, atol=1e-4 * scale)
    for name in ("mean_von_mises", "covariance_depth", "covariance_plane"):
        largest = float(np.abs(exact[name]).max())
        np.testing.assert_allclose(coarse[name], exact[name], rtol=0, atol=1e-4 * largest)
    for name in ("von_mises", "zz"):
        for nu in RATIOS:
            one, two = (
                asp.stress.select_peaks(each, name, nu)["peak_value"].values for each in (exact, coarse)
            )
            assert abs(one.size - two.size) <= max(2, 0.02 * one.size)
            np.testing.assert_allclose(np.quantile(one, shares), np.quantile(two, shares), atol=0.01 * scale)


def test_both_mean_modes_are_those_of_two_analyses(contact, result):
    conditions = "confined", "free"
    both = analyse_lateral_conditions(contact, conditions, result["plane_depth"], **SETTINGS)
    free = replace(contact, layer=replace(contact.layer, lateral="free"))
    xr.testing.assert_identical(both["confined"], result)
    xr.testing.assert_identical(both["free"], asp.analyse_stress(free, **SETTINGS, covariances=True))


def test_threads_change_no_bit(contact, result):
    """Progress rises to its total."""
    calls = []
    two = asp.analyse_stress(
        contact, **SETTINGS, covariances=True, threads=2, progress=lambda *call: calls.append(call)
    )
    xr.testing.assert_identical(two, result)
    done, total = np.array(calls).T
    assert np.all(np.diff(done) >= 0)
    assert done[-1] == pytest.approx(total[-1])


@pytest.mark.parametrize("kept_bytes", [stream.KEPT_BYTES, 1])
def test_covariances_change_nothing_else(contact, result, monkeypatch, kept_bytes):
    """Without them all other numbers are the same, to the last bit, and decay lengths are unknown."""
    monkeypatch.setattr(stream, "KEPT_BYTES", kept_bytes)
    without = asp.analyse_stress(contact, **SETTINGS)
    xr.testing.assert_identical(without, result.drop_dims("lag").drop_vars("covariance_depth"))
    assert np.isnan(decay_lengths(without)).all()
    assert np.isfinite(decay_lengths(result)).all()


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
def test_layer_is_followed_to_its_bottom(bottom):
    layer = asp.Solid(young=1.0, poisson=0.3, height=0.05, bottom=bottom)
    data = asp.analyse_stress(rough(64, layer), quantities=("zz", "xx"))
    assert data["plane_depth"][-1] == 0.05
    assert data["poisson"].values.tolist() == [0.3]
    assert set(data["peak_poisson"].values) == {0.3}


def test_no_pressure_has_no_peaks_and_no_stress(contact):
    data = asp.analyse_stress(replace(contact, pressure=0 * contact.pressure), poisson=RATIOS)
    assert data.sizes["peak"] == 0
    assert not data["maximum_von_mises"].any()
    assert asp.stress.select_peaks(data, "von_mises", 0.33, "under_contact").sizes["peak"] == 0


def test_floor_leaves_out_ripples_only(contact):
    """Nearly all peaks under a contact stay; of the surface, those above the floor times the rms pressure."""
    every, above, highest = (asp.analyse_stress(contact, floor=f, tolerance=1e-4) for f in (0.0, 0.01, 1.0))
    for selection, share in (("all", 1.0), ("under_contact", 0.02)):
        before, after = (
            asp.stress.select_peaks(d, "xz", None, selection).sizes["peak"] for d in (every, above)
        )
        assert (1 - share) * before < after < before + (share < 1)
    surface, kept = (
        d["peak_value"][(d["peak_quantity"] == "zz") & (d["peak_depth"] == 0)] for d in (every, highest)
    )
    lowest = np.sqrt(np.mean(contact.pressure**2))
    assert 0 < kept.size == pytest.approx((np.abs(surface) > lowest).sum(), abs=1)


def analysed(**settings):
    return asp.analyse_stress(spots((8, 8)), **settings)


test_wrong_argument_is_refused = refuses(
    (lambda: analysed(quantities=("vm",)), "quantities = 'vm': names from pressure, xx"),
    (lambda: analysed(quantities="von_mises"), "quantities = 'von_mises': a list of names"),
    (lambda: analysed(floor=-1.0), r"floor = -1\.0: a finite number ≥ 0"),
    (lambda: analysed(depths=[0.1, 0.2]), r"depths\[0\] = 0\.1: 0, the surface, is needed"),
    (lambda: analyse_lateral_conditions(spots(), ("slip",), [0.0]), "lateral = 'slip': one of confined"),
)


@pytest.mark.parametrize("limit", [(stream, "KEPT_BYTES"), (covariance, "MOST_KEPT")])
@pytest.mark.parametrize("tolerance", [1e-4, 1e-5])
def test_planes_are_computed_again(contact, monkeypatch, tolerance, limit):
    """If none or one are kept: the same peaks, and covariances to the steps of kept planes."""
    settings = COVARIANCES | {"tolerance": tolerance}
    both = asp.analyse_stress(contact, **settings)
    monkeypatch.setattr(*limit, 1)
    one = asp.analyse_stress(contact, **settings)
    packed = [name for name in both if name.startswith("covariance")]
    xr.testing.assert_identical(one.drop_vars(packed), both.drop_vars(packed))
    # The steps of 16 bits are 3e-5 of the largest value, of 32 bits 5e-10.
    steps = 1e-5 if tolerance == 1e-4 else 1e-10
    for name in packed:
        np.testing.assert_allclose(one[name], both[name], rtol=0, atol=steps * float(both[name].max()))
