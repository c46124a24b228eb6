"""Multilevel Monte Carlo against closed forms, brute force, and coverage of its intervals."""

from itertools import product

import numpy as np
import pytest

from asperity.accuracy.allocation import allocate
from asperity.accuracy.multilevel import bias, multilevel_mean, ratio

RATE, VOLATILITY = 0.3, 0.4


def euler(seeds, steps, stream=1, volatility=VOLATILITY):
    """Geometric Brownian motion at time 1 by Euler's method, on 2, 4, … steps with the same noise.

    The mean on n steps is exactly (1 + RATE/n)^n, its limit exp(RATE).
    """
    noise = np.random.default_rng(stream).normal(size=(max(seeds), max(steps))) / np.sqrt(max(steps))
    found = []
    for number, step in zip(seeds, steps, strict=True):
        increments = noise[:number].reshape(number, step, -1).sum(axis=2)
        found.append(np.prod(1 + RATE / step + volatility * increments, axis=1))
    return found


def gaussian(rng, seeds, correlations):
    """A chain of Gaussian levels of mean 1, 2, …, each correlated with the next coarser one."""
    values = rng.normal(size=seeds[0])
    found = [1 + values]
    for level, (number, rho) in enumerate(zip(seeds[1:], correlations, strict=True)):
        values = rho * values[:number] + np.sqrt(1 - rho**2) * rng.normal(size=number)
        found.append(2 + level + values)
    return found


def test_one_level_is_the_plain_mean():
    values = np.random.default_rng(3).normal(size=9)
    found = multilevel_mean([values])
    assert found.value == pytest.approx(values.mean(), rel=1e-14)
    assert found.error == pytest.approx(values.std(ddof=1) / 3, rel=1e-12)
    assert found.degrees == 8


@pytest.mark.parametrize("stream", range(1, 6))
def test_the_mean_is_that_of_the_finest_level(stream):
    seeds, steps = (4000, 600, 100, 20), (2, 4, 8, 16)
    found = multilevel_mean(euler(seeds, steps, stream))
    exact = (1 + RATE / 16) ** 16
    assert abs(found.value - exact) < 3.5 * found.error
    plain = multilevel_mean(euler((20,), (16,), stream))
    assert found.error < 0.25 * plain.error


def test_the_bias_is_that_of_the_closed_form():
    shift = bias((2, 4, 8), euler((4000, 4000, 4000), (2, 4, 8), volatility=0.05))
    exact = np.exp(RATE) - (1 + RATE / 8) ** 8
    assert shift.value == pytest.approx(exact, rel=0.25)
    assert 0.7 < shift.order < 1.3


@pytest.mark.parametrize("order", [0.5, 1.0, 1.7])
def test_a_power_of_the_spacing_is_extrapolated_exactly(order):
    nodes = (4, 6, 12)
    shift = bias(nodes, [np.full(5, 3 - 2 * node**-order) for node in nodes])
    assert shift.value == pytest.approx(2 * 12**-order, rel=1e-9)
    assert shift.order == pytest.approx(order, rel=1e-9)


def test_the_bias_is_not_below_what_the_coarser_grids_show():
    shift = bias((8, 16, 32), [np.full(5, v) for v in (1.0, 2.0, 2.0 + 1e-9)])
    assert shift.value >= 0.25 / 3


@pytest.mark.parametrize(
    ("seeds", "correlations"),
    [((60, 20, 6), (0.9, 0.98)), ((40, 4), (0.95,)), ((200, 30, 8), (0.3, 0.99)), ((12, 12), (0.8,))],
)
def test_intervals_cover_the_mean_as_often_as_they_say(seeds, correlations):
    """1500 repetitions: the share covered has a standard deviation of 0.006."""
    rng = np.random.default_rng(11)
    hits, inside = 1500, 0
    for _ in range(hits):
        low, high = multilevel_mean(gaussian(rng, seeds, correlations)).interval()
        inside += low < len(seeds) < high
    assert 0.93 < inside / hits < 0.99


def test_the_standard_error_is_the_spread_of_repeated_estimates():
    rng = np.random.default_rng(5)
    found = [multilevel_mean(gaussian(rng, (120, 40, 12), (0.9, 0.97))) for _ in range(800)]
    spread = np.std([each.value for each in found])
    assert np.sqrt(np.mean([each.error**2 for each in found])) == pytest.approx(spread, rel=0.1)


def test_a_ratio_of_means_has_the_error_of_the_delta_method():
    """Against the spread of repeated estimates; the two means are correlated by 0.9."""
    rng, found = np.random.default_rng(7), []
    for _ in range(600):
        common = rng.normal(size=(60, 1))
        coarse = 4 + 0.9 * common + 0.4 * rng.normal(size=(60, 2))
        fine = 5 + 2 * (coarse[:15] - 4) + 0.1 * rng.normal(size=(15, 2))
        found.append(multilevel_mean([coarse, fine], ratio))
    values = np.array([each.value for each in found])
    assert values.mean() == pytest.approx(1, abs=4 * values.std() / np.sqrt(600))
    assert np.sqrt(np.mean([each.error**2 for each in found])) == pytest.approx(values.std(), rel=0.1)


def test_other_numbers_of_the_same_seeds_are_a_level_too():
    """Two controls that explain 96 % of the variance, of which only the sampled mean is known."""
    rng = np.random.default_rng(2)
    controls = rng.normal(size=(5000, 2))
    fine = 7 + controls[:50] @ [2.0, -1.0] + 0.45 * rng.normal(size=50)
    found = multilevel_mean([controls, fine])
    assert abs(found.value - 7) < 3 * found.error
    assert found.error < 0.4 * multilevel_mean([fine]).error


def exact_samples(covariance, number=400):
    """Samples of all levels whose sample covariance is exactly this one."""
    raw = np.random.default_rng(1).normal(size=(number, len(covariance)))
    raw -= raw.mean(axis=0)
    raw = raw @ np.linalg.inv(np.linalg.cholesky(np.cov(raw, rowvar=False))).T
    return list((raw @ np.linalg.cholesky(np.array(covariance)).T).T)


def test_two_levels_are_allocated_as_the_closed_form_has_it():
    """Peherstorfer, Willcox and Gunzburger (2016): m_coarse/m_fine = √(w ρ²/(1 − ρ²)), w = cost."""
    rho, cost, error = 0.97, 20.0, 0.005
    found = allocate(exact_samples([[1, rho], [rho, 1]]), [1.0, cost], error, 4)
    assert found.seeds[0] / found.seeds[1] == pytest.approx(np.sqrt(cost * rho**2 / (1 - rho**2)), rel=0.01)
    exact = (np.sqrt(cost * (1 - rho**2)) + rho) ** 2 / error**2
    assert found.seconds == pytest.approx(exact, rel=0.01)
    assert found.gain == pytest.approx(cost / error**2 / exact, rel=0.01)


def test_no_other_numbers_of_seeds_are_cheaper():
    """Brute force over three levels of a Markov chain: none within the error costs less by a hundredth."""
    one, two, times, error = 0.9, 0.98, np.array([1.0, 5.0, 25.0]), 0.12
    covariance = [[1, one, one * two], [one, 1, two], [one * two, two, 1]]
    found = allocate(exact_samples(covariance), times, error, 4)
    explained = np.array([0.0, (one * two) ** 2, two**2, 1.0])
    best = min(
        float(np.dot(seeds, times))
        for seeds in product(range(20, 160, 2), range(8, 80, 2), range(4, 40))
        if seeds[0] >= seeds[1] >= seeds[2] and np.dot(np.diff(explained), 1 / np.array(seeds)) <= error**2
    )
    assert np.dot(np.diff(explained), 1 / found.seeds) <= 1.02 * error**2
    assert found.seconds <= 1.06 * best


def test_a_level_without_correlation_is_left_out():
    found = allocate(exact_samples([[1, 0.02, 0.02], [0.02, 1, 0.99], [0.02, 0.99, 1]]), [4, 5, 60], 0.05, 4)
    assert found.seeds[0] == 0
    assert found.seeds[1] > found.seeds[2] >= 4


@pytest.mark.parametrize(
    ("samples", "message"),
    [
        ([], "one level or more"),
        ([[1.0, np.nan, 2.0]], r"samples\[0\]: finite numbers"),
        ([[1.0, 2.0], [1.0, 2.0, 3.0]], "3 seeds; at most the 2"),
        ([[1.0, 2.0, 4.0], [1.0]], "1 seeds; at least 2"),
        ([np.ones((4, 2))], "function: missing"),
    ],
)
def test_samples_that_cannot_be_used_are_refused(samples, message):
    with pytest.raises(ValueError, match=message):
        multilevel_mean(samples)
