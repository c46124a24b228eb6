"""Rough surfaces: spectrum, symmetry, moments, seeds, and refused arguments."""

import numpy as np
import pytest
from samples import refuses
from scipy.stats import norm

from asperity.fourier.grid import Fourier, Grid
from asperity.study.stages.surface import make_surface, moment_errors
from asperity.surface.heights import _fitted_curve, johnson, with_heights, with_moments
from asperity.surface.roughness import roughness_parameters, spectrum
from asperity.surface.self_affine import self_affine, target_spectrum

BAND = {"hurst": 0.8, "wavelength_long": 1 / 4, "wavelength_short": 1 / 16, "rms_height": 0.01}


@pytest.mark.parametrize("fine", [(96, 96), (65, 80), (256, 64)])
def test_a_seed_is_one_surface_at_every_resolution(fine):
    coarse = self_affine((64, 64), seed=7, **BAND)
    other = self_affine(fine, seed=7, **BAND)
    coarse_grid, fine_grid = Grid((64, 64)), Grid(fine)
    a, b = Fourier(coarse_grid).forward(coarse), Fourier(fine_grid).forward(other)
    rows = np.r_[0:17, -16:0]
    np.testing.assert_allclose(a[rows, :17], b[rows, :17], atol=1e-16)


@pytest.mark.parametrize(("hurst", "rms", "seed"), [(0, 1e-9, 2**63), (0.5, 1e3, 0), (1, 1.0, 3)])
def test_rms_height_is_exact_and_mean_zero(hurst, rms, seed):
    height = self_affine((33, 40), hurst, 0.5, 0.1, rms, seed)
    assert np.std(height) == pytest.approx(rms, rel=1e-12)
    assert abs(np.mean(height)) < 1e-12 * rms


def test_spectrum_of_an_ensemble_is_power_law():
    """40 samples, rings of at least 25 waves; bound: four standard errors."""
    grid, samples = Grid((128, 128)), 40
    q, target = target_spectrum(grid, 0.3, 1 / 4, 1 / 32, 0.01)
    surfaces = (self_affine((128, 128), 0.3, 1 / 4, 1 / 32, 0.01, seed) for seed in range(samples))
    mean = np.mean([spectrum(height)[1] for height in surfaces], axis=0)
    number = q / (2 * np.pi)
    inside, outside = (number > 4.5) & (number < 31.5), (number < 3.4) | (number > 32.6)
    error = np.abs(mean[inside] / target[inside] - 1)
    assert np.all(error < 4 / np.sqrt(samples * np.pi * number[inside]) + 0.02)
    assert mean[outside].max() < 1e-25
    slope = np.polyfit(np.log(q[inside]), np.log(mean[inside]), 1)[0]
    assert slope == pytest.approx(-2 * 0.3 - 2, abs=0.05)


def normal_heights():
    """Heights at the quantiles of the normal distribution: no statistical error."""
    return norm.ppf((np.arange(512**2) + 0.5) / 512**2).reshape(512, 512)


@pytest.mark.parametrize(("delta", "skewness", "kurtosis"), [(1.0, 0.919, 3.375), (2.0, 0.359, 2.854)])
def test_johnson_moments_are_those_of_a_transformed_normal(delta, skewness, kurtosis):
    found = roughness_parameters(johnson(normal_heights(), 1.25, delta))
    assert found.skewness == pytest.approx(skewness, abs=2e-3)
    assert found.kurtosis == pytest.approx(kurtosis, abs=2e-3)
    assert found.rms_height == pytest.approx(np.std(normal_heights()), rel=1e-12)


@pytest.mark.parametrize(("skewness", "kurtosis"), [(0, 2.2), (0.5, 4.5), (-0.8, 3.3), (0, 1.2), (2, 5.6)])
def test_given_moments_are_reached(skewness, kurtosis):
    """Bound: the quantiles end at about five standard deviations."""
    found = roughness_parameters(with_moments(normal_heights(), skewness, kurtosis))
    assert found.skewness == pytest.approx(skewness, abs=2e-3)
    assert found.kurtosis == pytest.approx(kurtosis, rel=1e-2)
    assert found.rms_height == pytest.approx(np.std(normal_heights()), rel=1e-12)


def test_errors_of_moments_are_scatter_of_samples():
    """80 samples give a standard deviation to 8 %; the formula is exact to first order."""
    samples = [make_surface({**BAND, "points": 64}, seed) for seed in range(80)]
    skewness, kurtosis = moment_errors(Grid((64, 64)), **BAND)
    assert np.std([float(s["skewness"]) for s in samples]) == pytest.approx(skewness, rel=0.3)
    assert np.std([float(s["kurtosis"]) for s in samples]) == pytest.approx(kurtosis, rel=0.35)
    assert abs(np.mean([float(s["kurtosis"]) for s in samples]) - 3) < 0.3


def two_gaussians(peaks, valleys, ratio):
    """Skewness and kurtosis of ISO 13565-3's curve of a lower face, by a sum over the normal variable."""
    normal = np.linspace(-8, 8, 400001)
    weight = norm.pdf(normal) / norm.pdf(normal).sum()
    height = np.where(normal < norm.ppf(ratio / 100), peaks, valleys) * (normal - norm.ppf(ratio / 100))
    centred = height - weight @ height
    second, third, fourth = (weight @ centred**power for power in (2, 3, 4))
    return third / second**1.5, fourth / second**2


NODES = ((0, 0), (5, 3), (40, 17), (-1, -1))

GAUSSIAN = self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
OBLONG = self_affine((96, 64), 0.3, 0.5, 0.125, rms_height=1e-3, seed=7, length=(1.5, 1.0))
MOMENTS = with_moments(GAUSSIAN, skewness=0.5, kurtosis=3.5)
JOHNSON = johnson(GAUSSIAN, gamma=-1.0, delta=2.0)


@pytest.mark.parametrize(
    ("height", "kept"),
    [
        (GAUSSIAN, (-8.013507012107e-05, -0.0005666137202627, 0.001011018936736, 0.0001685427755742)),
        (OBLONG, (9.140337036648e-05, -0.0006875475432636, -0.001141259980401, -7.985680229927e-05)),
        (MOMENTS, (-0.000157749237419, -0.0006089798220698, 0.0009948557297628, 8.684304304785e-05)),
        (JOHNSON, (-2.491424816625e-05, -0.0005473411137005, 0.001029413145712, 0.0002321716431317)),
    ],
    ids=["gaussian", "oblong", "moments", "johnson"],
)
def test_seed_is_one_surface_in_every_version(height, kept):
    """Heights at `NODES`. A change here is a change of every random surface that was published."""
    tolerance = 1e-9 if height is not MOMENTS else 1e-6  # with_moments solves for its parameters
    assert [height[node] for node in NODES] == pytest.approx(kept, rel=tolerance)


def drawn(**changes):
    return self_affine((64, 64), **({"seed": 1} | BAND | changes))


def bounded(gamma=1.25, delta=1.0, **bounds):
    return johnson(np.eye(4), gamma, delta, **bounds)


def fitted(skewness, kurtosis, points=8):
    """Of one high node; with 1024² it is 1024 standard deviations high, and the sinh of a curve overflows."""
    height = np.zeros((points, points))
    height[3, 4] = 1.0
    return with_moments(height, skewness, kurtosis)


FLAT = np.full((5, 7), 0.1)


test_a_wrong_argument_is_named = refuses(
    (lambda: drawn(hurst=1.5), "hurst = 1.5: a number from 0 to 1"),
    (lambda: drawn(wavelength_short=0.5), ".*at most 0.25"),
    (lambda: drawn(wavelength_short=1 / 40), ".*at least two nodes"),
    (lambda: drawn(seed=-1), "seed = -1"),
    (lambda: drawn(wavelength_long=0.26, wavelength_short=0.255), ".*no wave of this band"),
    (lambda: bounded(lam=-8.0), "lam = -8.0"),
    (lambda: bounded(1e3, 0.01), "gamma = 1000.0, delta = 0.01: .* all heights are mapped to one"),
    (lambda: fitted(1, 1.5), r"skewness = 1\.0, kurtosis = 1\.5: no Johnson curve .* from about 2\.3 to"),
    (lambda: fitted(0, 0.5), r"kurtosis = 0\.5: a number from 1 to 1e\+06"),
    (lambda: fitted(0, 1e4, 1024), "height: a surface without extreme peaks"),
    (lambda: roughness_parameters(np.eye(4) * 1j), "height = .*: real numbers are needed"),
    (lambda: with_moments(np.diag([1.0, np.nan]), 0.5, 3.0), "height: 1 of 4 nodes are not finite"),
    (lambda: roughness_parameters(FLAT), ".*heights that differ by at least 1e-75 are needed, this"),
    (lambda: with_heights(GAUSSIAN), "no distribution: exactly one of moments, plateau, sample is needed"),
    (lambda: with_heights(GAUSSIAN, moments=(0, 3), plateau=(1, 2, 80)), "moments, plateau: exactly one of"),
    (lambda: with_heights(GAUSSIAN, moments=0.5), r"moments = 0.5: 2 numbers \(skewness, kurtosis\) are"),
    (lambda: with_heights(GAUSSIAN, plateau=(1, 2, 100)), "plateau Rmq = 100: a number between 0 and 100"),
    (lambda: with_heights(GAUSSIAN, sample=np.zeros(5)), "sample: heights are needed that differ in more"),
    (
        lambda: with_heights((-1.0) ** np.add.outer(range(8), range(8)), moments=(0, 3)),
        "height: waves below the N",
    ),
)


@pytest.mark.parametrize(
    ("distribution", "expected"),
    [
        # Moments of the distribution, and the largest residual: what the band leaves of tails and bends.
        ({"moments": (-1.0, 4.0)}, (-1.0, 4.0, 0.005)),
        ({"moments": (0.0, 2.2)}, (0.0, 2.2, 0.005)),
        ({"moments": (0.0, 6.0)}, (0.0, 6.0, 0.02)),
        ({"plateau": (1.0, 1.0, 70.0)}, (0.0, 3.0, 0.005)),
        ({"plateau": (0.2, 0.6, 60.0)}, (*two_gaussians(0.2, 0.6, 60.0), 0.01)),
        ({"sample": norm.ppf(np.linspace(0.001, 0.999, 999)) ** 3}, (0.0, None, 0.1)),
    ],
)
def test_heights_of_a_distribution_at_one_spectrum(distribution, expected):
    """Amplitudes stay to rounding; moments are missed by no more than the residual of the heights allows."""
    gaussian = self_affine((128, 128), 0.8, 1 / 4, 1 / 32, rms_height=1e-3, seed=1)
    shaped = with_heights(gaussian, **distribution)
    before, after = (np.abs(np.fft.rfft2(height)) for height in (gaussian, shaped.height))
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-12 * before.max())
    found = roughness_parameters(shaped.height)
    skewness, kurtosis, residual = expected
    assert shaped.heights_residual < residual
    assert found.skewness == pytest.approx(skewness, abs=3 * residual)
    assert kurtosis is None or found.kurtosis == pytest.approx(kurtosis, abs=20 * residual)


@pytest.mark.parametrize("fine", [(96, 96), (250, 128)])
def test_given_heights_are_one_surface_at_every_resolution(fine):
    """Waves of a coarse grid at which four nodes are not on the shortest wave, too; rounding grows tenfold
    with each ten iterations at most."""
    coarse, other = (
        with_heights(self_affine(shape, seed=7, **BAND), moments=(1.0, 4.0)).height
        for shape in ((48, 48), fine)
    )
    a, b = Fourier(Grid((48, 48))).forward(coarse), Fourier(Grid(fine)).forward(other)
    np.testing.assert_allclose(b[:17, :17], a[:17, :17], rtol=0, atol=1e-9 * np.abs(a).max())


def test_residual_of_heights_is_that_of_the_surface():
    """The grid of the iteration has 128 nodes on an edge. The distribution is the exponential one."""
    gaussian = self_affine((512, 512), 0.8, 1 / 4, 1 / 32, rms_height=1e-3, seed=1)
    wanted = -np.log1p(-(np.arange(512**2) + 0.5) / 512**2)
    shaped = with_heights(gaussian, sample=wanted)
    wanted = (wanted - wanted.mean()) * (np.std(shaped.height) / np.std(wanted))
    residual = np.sqrt(np.mean((np.sort(shaped.height, axis=None) - wanted) ** 2)) / np.std(wanted)
    assert shaped.heights_residual == pytest.approx(residual, rel=1e-9)


@pytest.mark.parametrize(
    ("skewness", "kurtosis"),
    [(2, 7.5), (2, 9), (-2, 9), (2, 10.8), (1.5, 6), (3, 11.5), (4, 40), (10, 300), (20, 1300), (2, 11)],
)
def test_curves_of_any_moments_are_found(skewness, kurtosis):
    """Bounded up to the lognormal distribution (10.86 at a skewness of 2), unbounded beyond. Moments of the
    transformed normal distribution by a sum over 20001 nodes, equally spaced within ten deviations."""
    normal = np.linspace(-10, 10, 20001)
    curve, position, width = _fitted_curve(skewness, kurtosis)
    values, weights = curve((normal - position) / width), np.exp(-(normal**2) / 2)
    centred = values - np.average(values, weights=weights)
    second, third, fourth = (np.average(centred**n, weights=weights) for n in (2, 3, 4))
    assert third / second**1.5 == pytest.approx(skewness, rel=1e-6, abs=1e-9)
    assert fourth / second**2 == pytest.approx(kurtosis, rel=1e-6)
