from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.elasticity.layer import Layer
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.fourier.grid import Fourier, Grid
from asperity.stress.analysis import QUANTITIES, analyse_lateral_conditions, analyse_stress
from asperity.stress.peaks.finder import find_peaks, plane_peaks
from asperity.stress.planes.planes import depth_grid, stress_planes
from asperity.stress.statistics.covariance import autocorrelation

RATIOS = [0.0, 0.33, 0.5]


def rough(points=96, layer=None, seed=0):
    """A pressure with many spots of many sizes: what exceeds a threshold of a random field."""
    grid = Grid((points, points))
    draw = np.random.default_rng(seed)
    reference = Grid((64, 64))
    wavenumber = reference.wavenumber() / (2 * np.pi)
    band = np.where((wavenumber > 3) & (wavenumber < 14), np.maximum(wavenumber, 1) ** -1.8, 0)
    modes = np.zeros(grid.half_shape, complex)
    kept = np.abs(reference.ky) < 32
    random = band * np.exp(2j * np.pi * draw.random(band.shape))
    modes[np.ix_(reference.ky[kept], reference.kx[:32])] = random[kept, :32]
    field = Fourier(grid).inverse(modes)
    excess = np.maximum(field - np.quantile(field, 0.85), 0.0)
    return LoadedSolid(0.1 * np.sqrt(excess / excess.max()), grid, layer or Layer(young=1.0, poisson=0.33))


@pytest.fixture(scope="module")
def contact():
    return rough()


@pytest.fixture(scope="module")
def result(contact):
    return analyse_stress(contact, poisson=RATIOS, quantities=QUANTITIES, tolerance=1e-5)


def test_peaks_are_those_of_a_search_in_the_full_planes(contact):
    """On one grid throughout, against the plain search through planes of each field."""
    depths = depth_grid(contact.grid, growth=0.3)
    data = analyse_stress(contact, depths, RATIOS, QUANTITIES, tolerance=0, floor=0.0)
    for name in QUANTITIES[1:]:
        for number, nu in enumerate(RATIOS):
            planes = stress_planes(contact, depths, nu, (name,), tolerance=0)
            expected = find_peaks(planes, name)
            # Away from the contacts the hydrostatic stress of the surface is constant but for rounding.
            selection = "at_contact" if name == "hydrostatic" else "all"
            mine = asp.peaks(data, name, nu, selection)
            floor = 1e-9
            kept = np.abs(expected.value) > floor
            if name == "hydrostatic":
                kept &= expected.under_contact(contact.pressure, contact.grid)
            got = mine.isel(peak=np.flatnonzero(np.abs(mine["peak_value"].values) > floor))
            assert got.sizes["peak"] == np.sum(kept), (name, number)
            order, other = np.argsort(expected.value[kept]), np.argsort(got["peak_value"].values)
            np.testing.assert_allclose(
                got["peak_value"].values[other], expected.value[kept][order], rtol=1e-8
            )
            np.testing.assert_array_equal(got["peak_interior"].values[other], expected.interior[kept][order])


def test_fields_that_are_searched_together_have_the_peaks_of_each_alone(contact):
    """To the last bit, also where the grid changes and maxima of several fields match."""
    together = analyse_stress(contact, poisson=RATIOS, quantities=QUANTITIES, tolerance=1e-3)
    assert np.unique(together["plane_points"]).size > 4
    for name in ("von_mises", "xx", "xz", "principal_1"):
        alone = analyse_stress(contact, poisson=RATIOS, quantities=[name], tolerance=1e-3)
        mine, expected = (asp.peaks(data, name, RATIOS[1]) for data in (together, alone))
        assert expected.sizes["peak"] > 20
        xr.testing.assert_equal(mine, expected)


def test_pressure_peaks_are_those_of_the_surface(contact, result):
    expected = plane_peaks(contact.pressure, contact.grid)
    peaks = asp.peaks(result, "pressure", 0.5)
    np.testing.assert_allclose(peaks["peak_value"], expected.value)
    assert not peaks["peak_interior"].any()
    assert (peaks["peak_depth"] == 0).all()


def test_profile_and_covariance_are_those_of_the_planes(contact):
    """Eq. 22, on the full grid: against its definition."""
    data = analyse_stress(contact, poisson=RATIOS, quantities=("von_mises",), tolerance=0)
    depths = data["plane_depth"].values
    fields = [p.fields["von_mises"] for p in stress_planes(contact, depths, RATIOS, tolerance=0)]
    for number in range(len(RATIOS)):
        planes = np.stack([field[number] for field in fields])
        np.testing.assert_allclose(data["mean_von_mises"][number], planes.mean(axis=(1, 2)), rtol=1e-12)
        np.testing.assert_allclose(data["largest_von_mises"][number], planes.max(axis=(1, 2)), rtol=1e-12)
        best = int(np.argmax(planes.max(axis=(1, 2))))
        assert data["reference_depth"][number] == depths[best]
        covariance = (
            np.mean(planes * planes[best], axis=(1, 2)) - planes.mean(axis=(1, 2)) * planes[best].mean()
        )
        np.testing.assert_allclose(data["covariance_depth"][number], covariance, rtol=1e-9, atol=1e-15)
        lag, plane = autocorrelation(planes[best], contact.grid)
        np.testing.assert_allclose(data["covariance_plane"][number], plane, rtol=1e-9, atol=1e-15)
        np.testing.assert_allclose(data["lag"], lag)


def test_coarse_planes_change_the_statistics_by_no_more_than_the_tolerance(contact):
    exact, coarse = (analyse_stress(contact, poisson=RATIOS, tolerance=t) for t in (0, 1e-5))
    assert coarse["plane_points"][-1] < exact["plane_points"][-1]
    scale = float(exact["largest_von_mises"].max())
    for name in ("mean_von_mises", "reference_depth"):
        np.testing.assert_allclose(coarse[name], exact[name], rtol=0, atol=1e-4 * scale)
    # Coarse nodes miss the very top of a plane.
    np.testing.assert_allclose(coarse["largest_von_mises"], exact["largest_von_mises"], rtol=0.03)
    for name in ("covariance_depth", "covariance_plane"):
        largest = float(np.abs(exact[name]).max())
        np.testing.assert_allclose(coarse[name], exact[name], rtol=0, atol=1e-4 * largest)
    for name in ("von_mises", "zz"):
        for nu in RATIOS:
            one, two = (np.sort(asp.peaks(d, name, nu)["peak_value"].values) for d in (exact, coarse))
            assert abs(one.size - two.size) <= max(2, 0.02 * one.size)
            for share in (0.1, 0.5, 0.9, 0.99):
                assert np.quantile(one, share) == pytest.approx(np.quantile(two, share), abs=0.01 * scale)


def test_planes_in_single_precision_have_the_covariances_of_full_planes(contact):
    """Those above the reference are kept in 16 bits."""
    exact, single = (analyse_stress(contact, poisson=RATIOS, tolerance=t) for t in (0, 1e-4))
    np.testing.assert_array_equal(single["reference_depth"], exact["reference_depth"])
    assert (exact["reference_depth"] > exact["plane_depth"][1]).all()  # some planes are above it
    for name in ("covariance_depth", "covariance_plane"):
        largest = float(np.abs(exact[name]).max())
        np.testing.assert_allclose(single[name], exact[name], rtol=0, atol=3e-5 * largest)


def test_planes_above_the_reference_that_are_not_kept_are_computed_again(contact, result, monkeypatch):
    monkeypatch.setattr("asperity.stress.statistics.covariance.MOST_KEPT", 1)
    again = analyse_stress(contact, poisson=RATIOS, quantities=QUANTITIES, tolerance=1e-5)
    name = "covariance_depth"
    np.testing.assert_allclose(again[name], result[name], rtol=1e-10)
    xr.testing.assert_identical(again.drop_vars(name), result.drop_vars(name))


def test_largest_peak_is_no_lower_than_its_plane(result):
    for number, nu in enumerate(RATIOS):
        peaks = asp.peaks(result, "von_mises", nu)
        largest = float(result["largest_von_mises"][number].max())
        assert largest <= peaks["peak_value"].max() <= 1.05 * largest


def test_both_uniform_modes_in_one_stream_are_those_of_two_analyses(contact, result):
    both = analyse_lateral_conditions(
        contact, ("confined", "free"), result["plane_depth"], RATIOS, QUANTITIES, tolerance=1e-5
    )
    free = replace(contact, layer=replace(contact.layer, lateral="free"))
    alone = analyse_stress(free, poisson=RATIOS, quantities=QUANTITIES, tolerance=1e-5)
    xr.testing.assert_identical(both["confined"], result)
    xr.testing.assert_identical(both["free"], alone)
    with pytest.raises(ValueError, match="'confined', the layer's, must be one of them"):
        analyse_lateral_conditions(contact, ("free",), [0.0])


def test_the_same_on_two_threads(contact, result):
    two = analyse_stress(contact, poisson=RATIOS, quantities=QUANTITIES, tolerance=1e-5, threads=2)
    xr.testing.assert_identical(two, result)


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
def test_a_layer_is_followed_to_its_bottom(bottom):
    layer = Layer(young=1.0, poisson=0.3, height=0.05, bottom=bottom)
    data = analyse_stress(rough(64, layer), quantities=("zz", "xx"))
    assert data["plane_depth"][-1] == 0.05
    assert data["poisson"].values.tolist() == [0.3]
    assert set(data["peak_poisson"].values) == {0.3}


def test_progress_ends_at_its_total(contact):
    calls = []
    analyse_stress(contact, [0.0, 0.01, 0.02, 0.1], progress=lambda *c: calls.append(c))
    done, total = np.array(calls).T
    assert np.all(np.diff(done) >= 0)
    assert done[-1] == pytest.approx(total[-1])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"quantities": ("vm",)}, "quantities = 'vm': names from pressure, xx"),
        ({"quantities": "von_mises"}, "quantities = 'von_mises': a list of names"),
        ({"floor": -1.0}, r"floor = -1\.0: a finite number ≥ 0"),
        ({"depths": [0.1, 0.2]}, r"depths\[0\] = 0\.1: 0, the surface, is needed"),
    ],
)
def test_bad_input_names_argument_value_and_range(contact, arguments, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        analyse_stress(contact, **arguments)


def test_no_pressure_has_no_peaks_and_no_stress(contact):
    data = analyse_stress(replace(contact, pressure=0 * contact.pressure), poisson=RATIOS)
    assert data.sizes["peak"] == 0
    assert not data["largest_von_mises"].any()
    assert asp.peaks(data, "von_mises", 0.33, "under_contact").sizes["peak"] == 0


def test_floor_leaves_out_ripples_and_no_peak_under_a_contact(contact):
    every, above, highest = (analyse_stress(contact, floor=f, tolerance=1e-4) for f in (0.0, 0.01, 1.0))
    for selection, share in (("all", 1.0), ("under_contact", 0.02)):
        before, after = (asp.peaks(d, "xz", None, selection).sizes["peak"] for d in (every, above))
        assert (1 - share) * before < after < before + (share < 1)
    surface, kept = (
        d["peak_value"][(d["peak_quantity"] == "zz") & (d["peak_depth"] == 0)] for d in (every, highest)
    )
    lowest = np.sqrt(np.mean(contact.pressure**2))
    assert 0 < kept.size == pytest.approx((np.abs(surface) > lowest).sum(), abs=1)
