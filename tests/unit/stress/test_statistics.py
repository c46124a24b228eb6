"""Statistics of peaks and planes: densities, autocorrelation, patches, and pooling over seeds."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from samples import refuses
from scipy.stats import spearmanr

import asperity as asp
from asperity.contact.patches import contact_patches
from asperity.stress.statistics.covariance import autocorrelation, decay_lengths, half_length
from asperity.stress.statistics.pooling import PERCENTS, pool_peaks, probability_density
from asperity.study.stages.statistics import depth_patch_correlation


@settings(max_examples=30)
@given(hnp.arrays(float, st.integers(1, 200), elements=st.floats(-1e6, 1e6)), st.integers(1, 120))
@example(1.0 + np.spacing(1.0) * np.arange(4), 100)
def test_density_counts_every_value_and_integrates_to_one(values, bins):
    counts, edges, density = probability_density(values, bins)
    assert counts.sum() == values.size
    assert counts.shape == density.shape == (bins,)
    assert edges[0] <= values.min()
    assert edges[-1] >= values.max()
    assert np.sum(density * np.diff(edges)) == pytest.approx(1.0, rel=1e-9)


def test_density_within_limits_counts_only_inside():
    counts, edges, density = probability_density(np.array([-5.0, 0.1, 0.2, 0.9, 7.0]), 2, (0.0, 1.0))
    assert counts.tolist() == [2, 1]
    assert edges.tolist() == [0.0, 0.5, 1.0]
    np.testing.assert_allclose(density, [4 / 3, 2 / 3])
    assert probability_density(np.empty(0), 3, (0.0, 1.0)).density.tolist() == [0, 0, 0]


def test_autocorrelation_is_the_ring_average_of_products():
    grid = asp.Grid((20, 26), (1.0, 1.3))
    field = np.random.default_rng(2).standard_normal(grid.shape) + 3.0
    lag, covariance = autocorrelation(field, grid)
    rest, rings = field - field.mean(), [[] for _ in range(20)]
    for j, i in np.ndindex(grid.shape):
        product = np.mean(rest * np.roll(rest, (-j, -i), (0, 1)))
        rings[int(np.rint(np.hypot(min(j, 20 - j), min(i, 26 - i))))].append(product)
    np.testing.assert_allclose(lag, 0.05 * np.arange(11), atol=1e-12)
    np.testing.assert_allclose(covariance, [np.mean(ring) for ring in rings[:11]], atol=1e-12)
    assert covariance[0] == pytest.approx(field.var(), rel=1e-12)


def test_lengths_are_interpolated_between_nodes():
    """They count from the reference plane."""
    assert half_length(np.array([0.0, 1.0, 2.0]), np.array([1.0, 0.75, 0.25])) == pytest.approx(1.5)
    assert np.isnan(half_length(np.array([0.0, 1.0]), np.array([1.0, 0.9])))
    profiles = {
        "covariance_depth": (("poisson", "plane"), [[9.0, 2.0, 1.5, 0.5]]),
        "covariance_plane": (("poisson", "lag"), [[2.0, 0.0]]),
        "plane_depth": ("plane", [0.0, 0.1, 0.3, 0.5]),
        "reference_depth": ("poisson", [0.1]),
    }
    lengths = decay_lengths(xr.Dataset(profiles, {"lag": [0.0, 0.2]}))
    assert [length.item() for length in lengths] == pytest.approx([0.3, 0.1])


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("rms", [0.0, 1e-9])
def test_full_smooth_contact_has_no_decay(rms):
    """A flat, and a wave whose stress is too small beside the mean for single precision."""
    wave = np.sin(2 * np.pi * np.arange(32) / 32)
    layer = asp.Solid(young=1.0, poisson=0.3)
    contact = asp.solve_contact(rms * (wave[:, None] + wave), layer, mean_pressure=1.0)
    stress = asp.analyse_stress(contact, quantities=("von_mises",), covariances=True)
    assert contact.contact_area_fraction == 1
    assert np.isnan(decay_lengths(stress)).all()


@pytest.mark.parametrize("load", [{"mean_pressure": 1e2}, {"mean_pressure": 1e6}, {"approach": 1.0}])
@pytest.mark.parametrize("rms", [1e-9, 1e-3])
def test_differences_of_pressure_far_beyond_full_contact(rms, load):
    """p − p̄ = E* q h / 2 of a wave; a tolerance relative to the mean pressure would hide it."""
    wave = rms * np.sin(2 * np.pi * np.arange(32) / 32) + np.zeros((32, 1))
    solid = asp.Solid(young=1.0, poisson=0.0, height=1.0)
    contact = asp.solve_contact(wave, solid, **load)
    amplitude = rms / float(solid.surface_compliance(np.array([2 * np.pi]))[0])
    found = contact.pressure - contact.pressure.mean()
    rounding = 1e-15 * contact.mean_pressure
    np.testing.assert_allclose(found, -amplitude * wave / rms, atol=1e-9 * amplitude + rounding * 10)


def test_patches_are_joined_across_edges_and_corners():
    contact = np.zeros((8, 16), bool)
    contact[0, 0] = contact[7, 15] = contact[7, 0] = True  # one patch through three corners of the cell
    contact[0, 6] = contact[7, 7] = contact[0, 11] = contact[7, 10] = True  # two over edges and corners
    contact[3, 3] = contact[4, 4] = True  # one over a corner of a square
    number, radii, *_ = contact_patches(contact)
    assert sorted(np.pi * radii**2) == pytest.approx([2, 2, 2, 3])
    assert number[0, 0] == number[7, 15] == number[7, 0] > 0
    assert number[0, 6] == number[7, 7] != number[0, 11] == number[7, 10]
    assert number[3, 3] == number[4, 4] != number[0, 0]
    assert contact_patches(np.zeros((4, 4), bool)).radii.size == 0


def test_depth_patch_correlation_is_spearmans_under_patches():
    draw = np.random.default_rng(3)
    patches, radii = draw.integers(0, 5, (16, 16)), np.array([1.0, 2.0, 2.0, 3.0])
    row, column = draw.integers(0, 16, (2, 300))
    above = patches[row, column]
    depth = draw.random(300) + np.append(0.0, radii)[above]
    touched = above > 0
    expected = spearmanr(radii[above[touched] - 1], depth[touched]).statistic
    found = depth_patch_correlation(depth, row, column, patches, radii)
    assert found == pytest.approx(expected, rel=1e-12)
    assert np.isnan(depth_patch_correlation(depth[:1], row[:1], column[:1], patches, radii))


def stress(seed=0, peaks=4000, scale=1.0):
    """An analysis in shape, with values from a known distribution: 1 + ν times an exponential."""
    draw = np.random.default_rng(seed)
    ratios, names = np.array([0.0, 0.5]), np.array(["von_mises", "xz"])
    quantity = draw.integers(0, 2, peaks)
    ratio = np.where(quantity == 0, ratios[draw.integers(0, 2, peaks)], np.nan)
    value = scale * draw.exponential(1.0, peaks) * (1 + np.nan_to_num(ratio))
    value[quantity == 1] *= draw.choice([-1, 1], np.sum(quantity == 1))
    planes = np.array([0.0, 0.1, 0.3, 1.0])
    profile = scale * (1 + 0.1 * draw.standard_normal((2, 4)))
    return xr.Dataset(
        {
            "peak_value": ("peak", value),
            "peak_depth": ("peak", draw.random(peaks)),
            "peak_interior": ("peak", draw.integers(0, 2, peaks).astype(bool)),
            "peak_under_contact": ("peak", draw.integers(0, 2, peaks).astype(bool)),
            "plane_depth": ("plane", planes),
            "mean_von_mises": (("poisson", "plane"), profile),
            "maximum_von_mises": (("poisson", "plane"), 5 * profile),
            "covariance_depth": (("poisson", "plane"), scale * profile),
            "covariance_plane": (("poisson", "lag"), scale * profile[:, :3]),
            "reference_depth": ("poisson", planes[[1, 2]]),
        },
        coords={
            "quantity": names,
            "poisson": ratios,
            "lag": [0.0, 0.1, 0.2],
            "peak_quantity": ("peak", names[quantity]),
            "peak_poisson": ("peak", ratio),
        },
    )


def test_seeds_are_pooled_over_their_gradients():
    """The same in every run."""
    gradients = [0.5, 1.0, 2.0]
    stresses = [stress(seed, scale=gradient) for seed, gradient in enumerate(gradients)]
    result = pool_peaks(stresses, gradients, bins=50, resamples=50)
    xr.testing.assert_identical(result, pool_peaks(stresses, gradients, bins=50, resamples=50))
    pairs = list(zip(stresses, gradients, strict=True))
    for quantity in ("von_mises", "xz"):
        for poisson in (0.0, 0.5):
            found = [
                asp.stress.select_peaks(b, quantity, poisson, "interior")["peak_value"].values / g
                for b, g in pairs
            ]
            values = np.concatenate(found)
            here = result.sel(selection="interior", quantity=quantity, poisson=poisson)
            edges = result["bin_edge"].sel(quantity=quantity).values
            expected = probability_density(values, 50, (edges[0], edges[-1]))
            np.testing.assert_array_equal(here["peak_counts"].sum("seed"), expected.counts)
            np.testing.assert_allclose(here["peak_density"], expected.density, rtol=1e-12)
            np.testing.assert_array_equal(here["joint_counts"].sum("depth_bin"), expected.counts)
            expected = np.percentile(np.abs(values), PERCENTS)
            expected[[values.size < count for count in (2, 10, 100, 1000)]] = np.nan  # the largest peaks
            np.testing.assert_allclose(here["peak_percentile"], expected)
    for name, power in (("covariance_depth", 2), ("mean_von_mises", 1)):
        each = [b[name] / g**power for b, g in pairs]
        np.testing.assert_allclose(result[f"scaled_{name}"], np.mean(each, axis=0))


def test_median_depths_of_all_and_highest_peaks():
    """Depths spread evenly: to 0.1 for nine tenths of the peaks, from 0.65 to 1 for the highest tenth."""
    data = stress(peaks=20_000)
    values = asp.stress.select_peaks(data, "von_mises", 0.5)["peak_value"].values
    share = np.random.default_rng(4).random(data.sizes["peak"])
    high = data["peak_value"].values > np.quantile(values, 0.9)
    data["peak_depth"] = ("peak", np.where(high, 0.65 + 0.35 * share, 0.1 * share))
    here = pool_peaks([data], [1.0], bins=2000).sel(selection="all", quantity="von_mises", poisson=0.5)
    assert float(here["median_depth"]) == pytest.approx(0.1 * 0.5 / 0.9, abs=0.003)
    assert float(here["median_depth_highest"]) == pytest.approx(0.825, abs=0.03)  # 500 peaks


def test_band_of_two_seeds_is_exact():
    """Of the resamples of two seeds a quarter each holds one of them twice, and half holds both."""
    low, high = stress(0, 50), stress(0, 50)
    high["mean_von_mises"] = 3 * high["mean_von_mises"]
    high["peak_value"] = 3 * high["peak_value"]
    for confidence, factors in ((0.4, (2, 2)), (0.6, (1, 3))):
        pooled = pool_peaks([low, high], [1, 1], 10, 400, confidence=confidence)
        for side, factor in zip(("low", "high"), factors, strict=True):
            band = pooled[f"scaled_mean_von_mises_{side}"]
            np.testing.assert_allclose(band, factor * low["mean_von_mises"], rtol=1e-12)


def test_nothing_to_count_gives_nan():
    """One seed has an estimate without a band; a selection without peaks has no percentiles."""
    one = pool_peaks([stress()], [1.0], bins=10)
    assert np.isfinite(one["peak_density"]).all()
    assert np.isnan(one["peak_density_low"]).all()
    assert np.isnan(one["scaled_covariance_plane_high"]).all()
    stresses = [stress(seed).assign(peak_interior=("peak", np.zeros(4000, bool))) for seed in (0, 1)]
    none = pool_peaks(stresses, [1.0, 1.0], bins=10, resamples=20).sel(selection="interior")
    assert np.isnan(none["peak_percentile"]).all()
    assert np.isnan(none["median_depth"]).all()
    assert (none["peak_density"] == 0).all()


TWO = [stress(), stress(1)]


def pooled(stresses=TWO, gradients=(1.0, 1.0), **settings):
    return pool_peaks(stresses, gradients, **settings)


test_wrong_arguments_are_refused = refuses(
    (lambda: probability_density([1.0, np.nan]), "values"),
    (lambda: probability_density([1.0], 2.5), "bins"),
    (lambda: probability_density([1.0], 2, (0.0, np.inf)), "limits"),
    (lambda: pooled(gradients=[1.0]), "gradients"),
    (lambda: pooled(resamples=0), "resamples = 0: a whole number from 1 to 1000000 is needed"),
    (lambda: pooled(confidence=1.0), r"confidence = 1\.0: a number between 0 and 1 is needed"),
    (lambda: pooled(seed=-1), "seed = -1: a whole number ≥ 0 is needed"),
    (lambda: pooled([stress(), stress().assign_coords(lag=[0.0, 0.1, 0.3])]), "stresses.*lag"),
    (lambda: pooled([stress(1), stress(1)]), "stresses: numbers 1 and 2 have the same peaks; every seed"),
)
