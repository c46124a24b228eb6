"""Largest peak on an area that was not measured, from the peaks of maps of the same surface.

Excesses of peaks over a high threshold follow a generalised Pareto distribution (J. Pickands, Ann. Statist. 3
(1975) 119, https://doi.org/10.1214/aos/1176343003). With λ such peaks per area the largest one on an area S
is below x with probability exp(−λ S (1 − F(x))), where F is that distribution. Median and interval belong to
the predictive distribution: this probability, averaged over all shapes, scales and rates by their likelihood.
With the most likely ones alone both are too low.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # whose parts are loaded when they are first used

from asperity.core.types import Array, ArrayLike
from asperity.core.units import shown_si

FEWEST_PEAKS, MOST_PEAKS = 20, 200
"""Fewest and most peaks above the threshold."""

TAIL = 0.15
"""Fraction of the peaks above the threshold, between these numbers."""

MAX_AREA_RATIO = 100
"""Largest area over the area of the sample; `benchmarks/largest.py` measures the intervals up to 39."""

SHAPE_PRIOR = -0.1, 0.2, 0.2
"""Mean and standard deviation of the shape ξ before any peak is known, since tails of stresses are nearly
exponential, and the probability that ξ is anywhere in `SHAPES`: under a hardness tails end abruptly. Chosen
on cells of surfaces that `benchmarks/largest.py` does not use."""

SHAPES = -2 + 0.0325 * (np.arange(80) + 0.5)
"""Shapes over which the average is taken."""

SCALES = np.exp(np.linspace(-1.6, 1.6, 81))
"""Scales over the mean excess of which the average is taken, their logarithms with the same weight
beforehand."""

BEYOND = np.exp(np.linspace(-14, 5, 120))
"""Distance of the end of a bounded tail from the largest excess, over this excess: for shapes below 0 the
average is taken over these. Equal steps of the scale miss the end, which many peaks determine closely."""

NEGLIGIBLE_WEIGHT = 1e-6
"""Likelihood over the largest one below which shape and scale are left out."""

QUANTILES = 0.5, 0.025, 0.975
"""Probabilities of the median of the largest value, and of the ends of its interval."""


class Largest(NamedTuple):
    """Largest value on an area, with its interval and the fitted tail of the peaks.

    Attributes
    ----------
    value, low, high : float
        Median, and 95 % interval, of the largest value on one such area: it holds the scatter of the largest
        value from area to area and the scatter of the maps. Of one map the interval is NaN.
    threshold, shape : float
        Threshold of the peaks, and mean shape ξ of the generalised Pareto distribution.
    peaks : int
        Peaks of the sample above the threshold.
    times : float
        Area over the area of the sample.
    """

    value: float
    low: float
    high: float
    threshold: float
    shape: float
    peaks: int
    times: float


def largest_on(peaks: Sequence[ArrayLike], sample_area: float, area: float) -> Largest:
    """Largest peak on an area, from the peaks of maps of the same surface.

    Peaks of one map are alike. The likelihood is therefore reduced to fewer independent peaks, by the ratio
    of the variances of number and sum of the excesses over the maps to the variances for independent peaks.
    On an area as large as the maps or larger, median and upper end are not below the largest peak of the
    maps.

    Parameters
    ----------
    peaks : sequence of arrays
        Values of the peaks of each map.
    sample_area : float
        Of all maps together, in m².
    area : float
        In m², too; at most `MAX_AREA_RATIO` times the area of the sample.

    Raises
    ------
    ValueError
        If the area is too large, or there are fewer than 2 `FEWEST_PEAKS` peaks.

    Examples
    --------
    For exponential peaks, 100 per unit area, the median of the largest of 10000 is log(10000 / log 2) = 9.6:

    >>> from asperity.stress.statistics.largest import largest_on
    >>> random = np.random.default_rng(1)
    >>> found = largest_on([random.exponential(size=1000) for _ in range(4)], sample_area=40.0, area=100.0)
    >>> print(f"{found.value:.1f}, 95 % between {found.low:.1f} and {found.high:.1f}")
    8.7, 95 % between 7.2 and 12.8
    """
    check_area(area, sample_area)
    maps = [np.asarray(values, dtype=float) for values in peaks]
    ordered = np.sort(np.concatenate(maps))[::-1]
    if ordered.size < 2 * FEWEST_PEAKS:
        raise ValueError(f"area: {2 * FEWEST_PEAKS} peaks are needed, the maps have {ordered.size}")
    count, times = int(np.clip(TAIL * ordered.size, FEWEST_PEAKS, MOST_PEAKS)), area / sample_area
    threshold, observed = float(ordered[count]), float(ordered[0])
    excesses = ordered[:count] - threshold
    unit = float(excesses.mean())
    if unit <= 1e-9 * abs(threshold):  # all at the hardness
        return Largest(observed, observed, observed, threshold, 0.0, count, times)
    dependence = 1.0
    if len(maps) > 1:
        above = [values[values > threshold] - threshold for values in maps]
        numbers, sums = np.array([(some.size, some.sum()) for some in above]).T
        of_numbers = numbers.var(ddof=1) / numbers.mean()
        of_sums = sums.var(ddof=1) / np.square(excesses).sum() * len(maps)
        dependence = max(1.0, of_numbers, of_sums)
    shapes, scales, weights = _posterior(excesses / unit, dependence)

    def below(excess: float) -> float:
        beyond = np.maximum(1 + shapes * excess / scales, 0) ** (-1 / shapes)
        # The mean over the rate, which has a Gamma distribution after `count` independent peaks.
        return float(weights @ (1 + times * dependence * beyond) ** (-count / dependence))

    most = 1.0
    while below(most) < max(QUANTILES):
        most *= 2
    value, low, high = (
        threshold + unit * scipy.optimize.brentq(lambda excess, level=level: below(excess) - level, 0, most)
        if below(0) < level
        else threshold
        for level in QUANTILES
    )
    if times >= 1:
        value, high = max(value, observed), max(high, observed)
    if len(maps) == 1:
        low = high = np.nan
    return Largest(value, low, high, threshold, float(weights @ shapes), count, times)


def _posterior(excesses: Array, dependence: float) -> tuple[Array, Array, Array]:
    """Shapes and scales of the distribution of excesses, and their weights, which add up to one."""
    bounded, others = SHAPES[SHAPES < 0], SHAPES[SHAPES > 0]
    ends = -bounded[:, None] * excesses.max() * (1 + BEYOND)
    shapes = np.concatenate([np.repeat(bounded, BEYOND.size), np.repeat(others, SCALES.size)])
    scales = np.concatenate([ends.ravel(), np.tile(SCALES, others.size)])
    # Steps of the logarithm of the scale.
    steps = np.tile(BEYOND / (1 + BEYOND) * np.log(BEYOND[1] / BEYOND[0]), bounded.size)
    steps = np.append(steps, np.full(others.size * SCALES.size, np.log(SCALES[1] / SCALES[0])))
    held = (scales >= SCALES[0]) & (scales <= SCALES[-1])
    shapes, scales, steps = shapes[held], scales[held], steps[held]
    argument = 1 + shapes[:, None] * excesses / scales[:, None]
    likelihood = -(1 + 1 / shapes) * np.log(argument).sum(axis=1) - excesses.size * np.log(scales)
    mean, deviation, share = SHAPE_PRIOR
    nearly_exponential = np.exp(-0.5 * ((shapes - mean) / deviation) ** 2) / (deviation * np.sqrt(2 * np.pi))
    prior = (1 - share) * nearly_exponential + share / np.ptp(SHAPES)
    weights = prior * steps * np.exp((likelihood - likelihood.max()) / dependence)
    kept = weights > NEGLIGIBLE_WEIGHT * weights.max()
    return shapes[kept], scales[kept], weights[kept] / weights[kept].sum()


def check_area(area: float, sample_area: float) -> None:
    """Raise `ValueError` for an area too large to predict from a sample."""
    if not 0 < area <= MAX_AREA_RATIO * sample_area * (1 + 1e-9):
        given, most = (shown_si(value, "m^2") for value in (area, MAX_AREA_RATIO * sample_area))
        raise ValueError(
            f"area = {given}: an area > 0 and ≤ {most} is needed, {MAX_AREA_RATIO} times the area of all "
            "maps together"
        )
