"""Largest value of a peak on an area that was not measured, from the peaks of a few maps.

Peaks above a high threshold are independent, and their excesses follow a generalised Pareto distribution
(J. Pickands, Ann. Statist. 3 (1975) 119, https://doi.org/10.1214/aos/1176343003). With λ such peaks per area
the largest one on an area S is below x with probability exp(−λ S (1 − F(x))), where F is that distribution.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from asperity.core.types import Array
from asperity.core.units import shown_si

FEWEST = 20
"""Fewest peaks above the threshold."""

TAIL = 0.2
"""Largest share of the peaks above the threshold: lower ones are no tail."""

FURTHEST = 100
"""Largest area over that of the sample; `benchmarks/largest.py` measures the intervals up to it."""

SHAPES = -2.0, 0.5
"""Bounds of the shape ξ; above 1/2 its estimate by probability-weighted moments has no variance."""

SAMPLES, SEED = 1000, 1
"""Samples of the bootstrap, and its seed."""

QUANTILES = 0.5, 0.025, 0.975
"""Of the largest value: its median, and the ends of the interval."""


class Largest(NamedTuple):
    """Largest value on an area, with what it follows from.

    Attributes
    ----------
    value, low, high : float
        Median, and 95 % interval, of the largest value on one such area: it holds the scatter of the largest
        value from area to area and that of the maps. Of one map the interval is NaN.
    threshold, shape : float
        Threshold of the peaks, and shape ξ of the generalised Pareto distribution.
    peaks : int
        Peaks of the sample above the threshold.
    times : float
        Area over that of the sample.
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

    The threshold is the lowest one above which the shape is stable: it differs from those of all higher
    thresholds by less than twice their standard error. The interval is that of a bootstrap of the maps and of
    their peaks; it draws one map fewer than there are, since for a few it were too narrow else.

    Parameters
    ----------
    peaks : sequence of arrays
        Values of the peaks of each map.
    sample_area : float
        Of all maps together, in m².
    area : float
        In m², too; at most `FURTHEST` times that of the sample.

    Raises
    ------
    ValueError
        If the area is too large, or there are fewer than 2 `FEWEST` peaks.

    Examples
    --------
    Of exponential peaks, 100 on a unit of area, the largest of 10000 has the median log(10000 / log 2) = 9.6:

    >>> from asperity.engineering.largest import largest_on
    >>> random = np.random.default_rng(1)
    >>> found = largest_on([random.exponential(size=1000) for _ in range(4)], sample_area=40.0, area=100.0)
    >>> print(f"{found.value:.1f}, 95 % between {found.low:.1f} and {found.high:.1f}")
    8.4, 95 % between 6.3 and 12.5
    """
    from scipy.stats import genpareto

    check_area(area, sample_area)
    maps = [np.asarray(values, dtype=float) for values in peaks]
    ordered = np.sort(np.concatenate(maps))[::-1]
    if ordered.size < 2 * FEWEST:
        raise ValueError(f"area: {2 * FEWEST} peaks are needed, the maps have {ordered.size}")
    count, times = _stable_count(ordered), area / sample_area
    threshold = float(ordered[count])
    excesses = [values[values > threshold] - threshold for values in maps]
    random, samples, few = np.random.default_rng(SEED), [np.concatenate(excesses)], len(maps) - 1
    for _ in range(SAMPLES if few else 0):
        chosen = np.concatenate([excesses[index] for index in random.integers(len(maps), size=few)])
        samples.append(random.choice(chosen, random.poisson(chosen.size)) if chosen.size else chosen)
    shapes, scales = np.transpose([_shape_scale(sample) for sample in samples])
    counts = np.array([max(sample.size, 1) for sample in samples], dtype=float)
    counts[1:] *= len(maps) / max(few, 1)
    levels = np.append(QUANTILES[0], random.random(len(samples) - 1))
    beyond = np.minimum(-np.log(levels) / (times * counts), 1.0)
    found = threshold + genpareto.isf(beyond, shapes, scale=np.maximum(scales, np.finfo(float).tiny))
    low, high = np.quantile(found[1:], QUANTILES[1:]) if few else (np.nan, np.nan)
    return Largest(float(found[0]), float(low), float(high), threshold, float(shapes[0]), count, times)


def check_area(area: float, sample_area: float) -> None:
    """Raise `ValueError` for an area beyond what a sample of another area bears."""
    if not 0 < area <= FURTHEST * sample_area * (1 + 1e-9):
        given, most = (shown_si(value, "m^2") for value in (area, FURTHEST * sample_area))
        raise ValueError(
            f"area = {given}: an area > 0 and ≤ {most} is needed, {FURTHEST} times that of all maps together"
        )


def _stable_count(ordered: Array) -> int:
    """Number of the peaks above the threshold; ordered from the highest."""
    counts = np.unique(np.geomspace(FEWEST, max(int(TAIL * ordered.size), FEWEST + 1), 12).astype(int))
    shapes = np.array([_shape_scale(ordered[:count] - ordered[count])[0] for count in counts])
    errors = 2.4 / np.sqrt(counts)  # twice the standard error of ξ near 0 (Hosking and Wallis 1987, table 2)
    for last in range(counts.size - 1, 0, -1):
        if np.all(np.abs(shapes[:last] - shapes[last]) <= errors[:last]):
            return int(counts[last])
    return int(counts[0])


def _shape_scale(excesses: Array) -> tuple[float, float]:
    """Shape ξ and scale of the distribution of some excesses, by probability-weighted moments.

    J. R. M. Hosking, J. R. Wallis, Technometrics 29 (1987) 339, https://doi.org/10.1080/00401706.1987.10488243.
    """
    if excesses.size < 2 or excesses.max() <= 0:
        return 0.0, float(excesses.mean()) if excesses.size else 0.0
    ordered, ranks = np.sort(excesses), np.arange(excesses.size)
    mean, weighted = ordered.mean(), float(np.mean(ordered * (1 - (ranks + 0.65) / excesses.size)))
    shape = float(np.clip(2 - mean / (mean - 2 * weighted), *SHAPES))
    return shape, mean * (1 - shape)
