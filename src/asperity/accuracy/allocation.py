"""Seeds of each level of a multilevel mean for a given standard error, in the least processor time.

References are those of `asperity.accuracy.multilevel`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from asperity.accuracy.multilevel import FEWEST_FOR_SLOPE, Spread, checked_levels, next_level, regressors
from asperity.errors import shown
from asperity.types import Array

SAVING = 0.2
"""Least share of the processor time that leaving out levels has to save."""


class Allocation(NamedTuple):
    """Seeds of each level for a given standard error.

    Parameters
    ----------
    seeds : (levels,) int array
        Seeds of each level; 0 for a level that does not help.
    seconds : float
        Processor time of all levels.
    plain_seeds : int
        Seeds of plain Monte Carlo on the finest level for the same standard error.
    plain_seconds : float
        Their processor time.
    gain : float
        Processor time of plain Monte Carlo over that of this method for a small error, where neither the
        rounding to whole seeds nor `fewest` matters.
    variance : float
        Of one seed on the finest level.
    """

    seeds: Array
    seconds: float
    plain_seeds: int
    plain_seconds: float
    gain: float
    variance: float


def allocate(samples: Sequence[ArrayLike], seconds: Sequence[float], error: float, fewest: int) -> Allocation:
    """Seeds of each level that reach a standard error in the least processor time.

    With the variance V[l] of what remains of level l after regression on the coarser one, carried to the
    finest level, and its time C[l] a seed, the numbers of seeds are those of Giles (2008), proportional to
    √(V/C). Levels that are badly correlated are left out if that saves more than `SAVING` for a small error:
    the first level, or coarse grids. More choices, or smaller savings, would favour whatever a few seeds
    happen to fit well, and the standard error would be judged too small.

    Parameters
    ----------
    samples : sequence of arrays
        As of `multilevel_mean`, of a pilot; one quantity on all levels but the first.
    seconds : sequence of float
        Processor time of one seed on each level.
    error : float
        Standard error to reach.
    fewest : int
        Least number of seeds of a level in use.
    """
    if not error > 0:
        raise ValueError(f"error = {shown(error)}: a number > 0 is needed")
    levels, times = checked_levels(samples), np.asarray(seconds, float)
    finest = len(levels) - 1
    grids = [list(range(start, finest + 1)) for start in range(1, max(finest, 2))]
    below = [[0, *rest] for rest in grids if _enough(levels[0], levels[rest[0]]) or rest[0] == 1]
    choices = below + grids if finest else [[0]]
    variances = [_remaining_variances([levels[level] for level in used])[0] for used in choices]
    shares = [_proportions(each, times[used]) for each, used in zip(variances, choices, strict=True)]
    # Time times variance, from which the time for any error follows.
    work = [
        float((share @ times[used]) * (each / share).sum())
        for each, share, used in zip(variances, shares, choices, strict=True)
    ]
    best = int(np.argmin(work))
    best = best if work[best] < (1 - SAVING) * work[0] else 0
    used, share = choices[best], shares[best]
    wanted = np.ceil(share * (variances[best] / share).sum() / error**2 - 1e-9)
    number = np.zeros(finest + 1, int)
    number[used] = np.maximum(wanted, fewest)
    variance = finest_variance(samples).variance
    plain = max(math.ceil(variance / error**2 - 1e-9), 2)
    gain = variance * times[-1] / max(work[best], 1e-300)
    return Allocation(number, float(number @ times), plain, plain * float(times[-1]), gain, variance)


def _enough(coarse: Array, fine: Array) -> bool:
    """Whether the finer level has as many seeds as a plan needs for its slopes on the coarser one."""
    return len(fine) >= FEWEST_FOR_SLOPE + regressors(coarse, fine)


def finest_variance(samples: Sequence[ArrayLike]) -> Spread:
    """Variance of one seed on the finest level, from the seeds of all levels.

    It is what the regressions explain, with the variance of the coarse levels, and what they leave over: more
    certain than the variance of the few seeds of the finest level. Parameters are those of `multilevel_mean`,
    with one quantity on all levels but the first.
    """
    variances, freedoms = _remaining_variances(checked_levels(samples))
    total = float(variances.sum())
    return Spread(
        total, total**2 / float((variances**2 / freedoms).sum()) if total else float(freedoms.min())
    )


def _proportions(variances: Array, times: Array) -> Array:
    """Numbers of seeds √(V/C) of levels, up to a factor, never rising from coarse to fine.

    Levels for which they would rise share the number that is best for them together.
    """
    groups: list[tuple[float, float, int]] = []
    for variance, time in zip(variances, times, strict=True):
        group = float(variance), float(time), 1
        while groups and groups[-1][0] * group[1] <= group[0] * groups[-1][1]:
            before = groups.pop()
            group = before[0] + group[0], before[1] + group[1], before[2] + group[2]
        groups.append(group)
    share = np.concatenate([np.full(size, np.sqrt(v / t)) for v, t, size in groups])
    return np.maximum(share, 1e-12 * max(share.max(), 1e-300))


def _remaining_variances(levels: Sequence[Array]) -> tuple[Array, Array]:
    """Variance of each level that the coarser one does not explain, carried to the finest by the slopes.

    With the degrees of freedom of each.
    """
    remaining = [float(np.var(levels[0], axis=0, ddof=1).sum())]
    freedoms = [len(levels[0]) - 1]
    for number, (coarse, fine) in enumerate(pairwise(levels)):
        _, part, slope = next_level(coarse[: len(fine)], fine, coarse.mean(axis=0))
        if number == 0:
            remaining = [float(np.var(coarse @ slope, ddof=1))]
        else:
            remaining = [value * float(slope[0, 0]) ** 2 for value in remaining]
        freedoms.append(len(fine) - part.parameters)
        remaining.append(float((part.residuals**2).sum() / freedoms[-1]))
    return np.array(remaining), np.array(freedoms, float)
