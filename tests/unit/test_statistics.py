import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.stats import spearmanr

import asperity as asp
from asperity.fourier.grid import Fourier, Grid
from asperity.stress.statistics.covariance import autocorrelation, decay_lengths, half_length
from asperity.stress.statistics.density import probability_density
from asperity.stress.statistics.patches import contact_patches, depth_patch_correlation
from asperity.stress.statistics.pooling import PERCENTS, pool_peaks

ROUNDING = 1e-12


@settings(max_examples=30, deadline=None)
@given(hnp.arrays(float, st.integers(1, 200), elements=st.floats(-1e6, 1e6)), st.integers(1, 120))
def test_density_counts_every_value_and_integrates_to_one(values, bins):
    counts, edges, density = probability_density(values, bins)
    assert counts.sum() == values.size
    assert counts.shape == density.shape == (bins,)
    assert edges[0] <= values.min()
    assert edges[-1] >= values.max()
    assert np.sum(density * np.diff(edges)) == pytest.approx(1.0, rel=1e-9)


def test_density_within_limits_counts_only_what_is_inside():
    counts, edges, density = probability_density(np.array([-5.0, 0.1, 0.2, 0.9, 7.0]), 2, (0.0, 1.0))
    assert counts.tolist() == [2, 1]
    assert edges.tolist() == [0.0, 0.5, 1.0]
    np.testing.assert_allclose(density, [4 / 3, 2 / 3])
    assert probability_density(np.empty(0), 3, (0.0, 1.0)).density.tolist() == [0, 0, 0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([1.0, np.nan],), "values"),
        (([1.0], 0), "bins"),
        (([1.0], 2.5), "bins"),
        (([1.0], 2, (1.0, 1.0)), "limits"),
        (([1.0], 2, (0.0, np.inf)), "limits"),
    ],
)
def test_density_refuses_what_it_cannot_count(arguments, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        probability_density(*arguments)


def test_autocorrelation_is_the_ring_average_of_shifted_products():
    grid = Grid((20, 26), (1.0, 1.3))
    field = np.random.default_rng(2).standard_normal(grid.shape) + 3.0
    lag, covariance = autocorrelation(field, grid)
    rest = field - field.mean()
    rings: dict[int, list[float]] = {}
    for j in range(20):
        for i in range(26):
            y, x = 0.05 * min(j, 20 - j), 0.05 * min(i, 26 - i)
            product = np.mean(rest * np.roll(rest, (-j, -i), (0, 1)))
            rings.setdefault(int(np.rint(np.hypot(y, x) / 0.05)), []).append(product)
    np.testing.assert_allclose(lag, 0.05 * np.arange(11), atol=ROUNDING)
    np.testing.assert_allclose(covariance, [np.mean(rings[k]) for k in range(11)], atol=ROUNDING)
    assert covariance[0] == pytest.approx(field.var(), rel=ROUNDING)


def test_autocorrelation_on_a_finer_grid_has_the_same_variance():
    coarse, fine = Grid((16, 16)), Grid((48, 48))
    modes = np.zeros(coarse.half_shape, complex)
    modes[1, 2], modes[3, 0], modes[-3, 0] = 0.5 + 0.1j, 0.3, 0.3
    field = Fourier(coarse).inverse(modes)
    lag, covariance = autocorrelation(field, coarse, fine)
    assert lag[1] == pytest.approx(1 / 48)
    assert covariance[0] == pytest.approx(field.var(), rel=ROUNDING)
    same = autocorrelation(Fourier(fine).inverse(_lift(modes, coarse, fine)), fine)
    np.testing.assert_allclose(covariance, same[1], atol=ROUNDING)


def _lift(modes, coarse, fine):
    out = np.zeros(fine.half_shape, complex)
    out[: coarse.shape[0] // 2, : modes.shape[1]] = modes[: coarse.shape[0] // 2]
    out[-(coarse.shape[0] // 2 - 1) :, : modes.shape[1]] = modes[-(coarse.shape[0] // 2 - 1) :]
    return out


def test_half_length_is_interpolated_between_nodes():
    assert half_length(np.array([0.0, 1.0, 2.0]), np.array([1.0, 0.75, 0.25])) == pytest.approx(1.5)
    assert np.isnan(half_length(np.array([0.0, 1.0]), np.array([1.0, 0.9])))


def test_decay_lengths_count_from_the_reference_plane():
    depth, lag = np.array([0.0, 0.1, 0.3, 0.5]), np.array([0.0, 0.2])
    lengths = decay_lengths(depth, np.array([9.0, 2.0, 1.5, 0.5]), lag, np.array([2.0, 0.0]), reference=0.1)
    assert lengths == pytest.approx((0.3, 0.1))


def test_patches_are_joined_across_the_edges_of_the_cell_and_across_corners():
    contact = np.zeros((8, 16), bool)
    contact[0, 0] = contact[7, 15] = contact[7, 0] = True  # one patch through three corners of the cell
    contact[0, 6] = contact[7, 7] = contact[0, 11] = contact[7, 10] = True  # two over edges and corners
    contact[3, 3] = contact[4, 4] = True  # one over a corner of a square
    number, radii = contact_patches(contact)
    assert sorted(np.pi * radii**2) == pytest.approx([2, 2, 2, 3])
    assert number[0, 0] == number[7, 15] == number[7, 0] > 0
    assert number[0, 6] == number[7, 7] != number[0, 11] == number[7, 10]
    assert number[3, 3] == number[4, 4] != number[0, 0]
    assert contact_patches(np.zeros((4, 4), bool))[1].size == 0


def test_depth_patch_correlation_is_spearman_s_of_the_peaks_under_patches():
    draw = np.random.default_rng(3)
    patches = draw.integers(0, 5, (16, 16))
    radii = np.array([1.0, 2.0, 2.0, 3.0])
    row, column = draw.integers(0, 16, (2, 300))
    above = patches[row, column]
    depth = draw.random(300) + np.append(0.0, radii)[above]
    touched = above > 0
    expected = spearmanr(radii[above[touched] - 1], depth[touched]).statistic
    found = depth_patch_correlation(depth, row, column, patches, radii)
    assert found == pytest.approx(expected, rel=ROUNDING)
    assert np.isnan(depth_patch_correlation(depth[:1], row[:1], column[:1], patches, radii))


def stress(seed=0, peaks=4000, scale=1.0):
    """An analysis in shape, with values from a known distribution: 1 + ν times an exponential."""
    draw = np.random.default_rng(seed)
    ratios = np.array([0.0, 0.5])
    quantity = draw.integers(0, 2, peaks)
    poisson = np.where(quantity == 0, draw.integers(0, 2, peaks), -1)
    value = scale * draw.exponential(1.0, peaks) * (1 + ratios[np.maximum(poisson, 0)])
    names = np.array(["von_mises", "xz"])
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
            "largest_von_mises": (("poisson", "plane"), 5 * profile),
            "covariance_depth": (("poisson", "plane"), scale * profile),
            "covariance_plane": (("poisson", "lag"), scale * profile[:, :3]),
            "reference_depth": ("poisson", planes[[1, 2]]),
        },
        coords={
            "quantity": names,
            "poisson": ratios,
            "lag": [0.0, 0.1, 0.2],
            "peak_quantity": ("peak", names[quantity]),
            "peak_poisson": ("peak", np.where(poisson < 0, np.nan, ratios[poisson])),
        },
    )


def test_ensemble_pools_the_seeds_and_normalises_each_by_its_gradient():
    stresses = [stress(seed, scale=gradient) for seed, gradient in enumerate((0.5, 1.0, 2.0))]
    result = pool_peaks(stresses, [0.5, 1.0, 2.0], bins=50, resamples=200)
    for quantity in ("von_mises", "xz"):
        for poisson in (0.0, 0.5):
            values = np.concatenate(
                [
                    asp.peaks(b, quantity, poisson, "interior")["peak_value"].values / g
                    for b, g in zip(stresses, (0.5, 1.0, 2.0), strict=True)
                ]
            )
            here = {"selection": "interior", "quantity": quantity, "poisson": poisson}
            edges = result["bin_edge"].sel(quantity=quantity).values
            counts = result["peak_counts"].sel(here)
            expected = probability_density(values, 50, (edges[0], edges[-1]))
            np.testing.assert_array_equal(counts.sum("seed"), expected.counts)
            np.testing.assert_allclose(result["peak_density"].sel(here), expected.density, rtol=1e-12)
            np.testing.assert_array_equal(result["joint_counts"].sel(here).sum("depth_bin"), expected.counts)
            np.testing.assert_allclose(
                result["peak_percentile"].sel(here), np.percentile(np.abs(values), PERCENTS)
            )
    for name, power in (("covariance_depth", 2), ("mean_von_mises", 1)):
        each = [b[name] / g**power for b, g in zip(stresses, (0.5, 1, 2), strict=True)]
        np.testing.assert_allclose(result[f"scaled_{name}"], np.mean(each, axis=0))


def test_median_depths_are_those_of_all_and_of_the_highest_peaks():
    """Depths spread evenly: to 0.1 for nine tenths of the peaks, from 0.65 to 1 for the highest tenth."""
    data = stress(peaks=20_000)
    values = asp.peaks(data, "von_mises", 0.5)["peak_value"].values
    share = np.random.default_rng(4).random(data.sizes["peak"])
    high = data["peak_value"].values > np.quantile(values, 0.9)
    data["peak_depth"] = ("peak", np.where(high, 0.65 + 0.35 * share, 0.1 * share))
    result = pool_peaks([data], [1.0], bins=2000)
    here = result.sel(selection="all", quantity="von_mises", poisson=0.5)
    assert float(here["median_depth"]) == pytest.approx(0.1 * 0.5 / 0.9, abs=0.003)
    assert float(here["median_depth_highest"]) == pytest.approx(0.825, abs=0.03)  # 500 peaks


def test_the_same_seed_twice_is_refused():
    with pytest.raises(
        ValueError, match="stresses: numbers 1 and 3 have the same peaks; every seed is needed"
    ):
        pool_peaks([stress(1), stress(2), stress(1)], [1.0] * 3)


def test_bands_hold_the_estimate_and_narrow_with_the_seeds():
    few = pool_peaks([stress(s, 2000) for s in range(4)], [1.0] * 4, bins=20, resamples=200)
    many = pool_peaks([stress(s, 2000) for s in range(16)], [1.0] * 16, bins=20, resamples=200)
    for data in (few, many):
        for name in ("peak_percentile", "scaled_mean_von_mises"):
            middle = data[name].values
            assert np.all(data[f"{name}_low"] <= middle * (1 + 1e-3))
            assert np.all(data[f"{name}_high"] >= middle * (1 - 1e-3))

    def width(data):
        return float((data["scaled_mean_von_mises_high"] - data["scaled_mean_von_mises_low"]).mean())

    assert 0.3 < width(many) / width(few) < 0.8  # one half expected
    # The true value of the median, ln 2 (1 + ν), lies in the band (95 %).
    band = many.sel(selection="all", quantity="von_mises", percent=50.0)
    true = np.log(2) * (1 + band["poisson"])
    assert np.all((band["peak_percentile_low"] < 1.02 * true) & (band["peak_percentile_high"] > 0.98 * true))


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


def test_bootstrap_is_the_same_every_time():
    stresses = [stress(s, 500) for s in range(3)]
    xr.testing.assert_identical(
        pool_peaks(stresses, [1, 1, 1], 10, 50), pool_peaks(stresses, [1, 1, 1], 10, 50)
    )


def test_one_seed_has_an_estimate_and_no_band():
    result = pool_peaks([stress()], [1.0], bins=10)
    assert np.isfinite(result["peak_density"]).all()
    assert np.isnan(result["peak_density_low"]).all()
    assert np.isnan(result["scaled_covariance_plane_high"]).all()


def test_a_selection_without_peaks_has_no_percentiles():
    stresses = [stress(seed).assign(peak_interior=("peak", np.zeros(4000, bool))) for seed in (0, 1)]
    result = pool_peaks(stresses, [1.0, 1.0], bins=10, resamples=20)
    assert np.isnan(result["peak_percentile"].sel(selection="interior")).all()
    assert np.isnan(result["median_depth"].sel(selection="interior")).all()
    assert (result["peak_density"].sel(selection="interior") == 0).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"stresses": []}, "gradients"),
        ({"gradients": [1.0]}, "gradients"),
        ({"gradients": [1.0, 0.0]}, "gradients"),
        ({"resamples": 0}, "resamples = 0: a whole number from 1 to 1000000 is needed"),
        ({"resamples": 2**60}, "resamples = 1152921504606846976"),
        ({"confidence": 1.0}, r"confidence = 1\.0: a number between 0 and 1 is needed"),
        ({"confidence": None}, "confidence = None: a number between 0 and 1 is needed"),
        ({"seed": -1}, "seed = -1: a whole number ≥ 0 is needed"),
        ({"seed": "1"}, "seed = '1': a whole number ≥ 0 is needed"),
        ({"bins": 0}, "bins"),
        ({"stresses": [stress(), stress().assign_coords(lag=[0.0, 0.1, 0.3])]}, "stresses.*lag"),
    ],
)
def test_ensemble_refuses_what_does_not_fit(changes, message):
    with pytest.raises((ValueError, TypeError), match=f"^{message}"):
        pool_peaks(**({"stresses": [stress(), stress(1)], "gradients": [1.0, 1.0]} | changes))
