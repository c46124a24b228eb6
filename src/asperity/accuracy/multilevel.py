"""Multilevel Monte Carlo: means over random surfaces from many coarse grids and few fine ones.

The mean on the finest grid is that on the coarsest one, taken over many seeds, and corrections from grid to
grid, each taken over fewer seeds (M. B. Giles, Oper. Res. 56 (2008) 607, doi 10.1287/opre.1070.0496, and
Acta Numer. 24 (2015) 259, doi 10.1017/S096249291500001X; for the contact area of rough surfaces R. Rey,
S. Krumscheid and F. Nobile, Int. J. Eng. Sci. 138 (2019) 50, doi 10.1016/j.ijengsci.2019.02.003).

Two things differ from these papers. The seeds are nested: those of a grid are the first of the next coarser
one, so that no surface is computed twice on one grid. And a coarser value enters with the slope of a linear
regression in place of one, as in the multifidelity method (B. Peherstorfer, K. Willcox and M. Gunzburger,
SIAM J. Sci. Comput. 38 (2016) A3163, doi 10.1137/15M1046472): a coarse grid then helps if it is correlated
with the next finer one, whatever its mean and its scale. The coarsest level may therefore be any other number
of the same seed, such as the gradient of the surface, or several of them.

In the mean m of level l, with slope b between levels l − 1 and l, both over the n seeds of level l::

    m[l] = mean(P[l]) + b (m[l-1] − mean(P[l-1])),    m[0] = mean(P[0])

Standard errors are those of the linearised estimator (delta method), with the error of the slopes (W. G.
Cochran, Sampling Techniques, 1977, section 12.6). Intervals are Student's t, with the degrees of freedom of
Welch and Satterthwaite.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import fdtri, stdtrit

from asperity.errors import shown
from asperity.types import Array

FEWEST_FOR_SLOPE = 8
"""Seeds from which a slope is fitted; with fewer it is one between equal quantities."""

CLEAR = 2.0
"""A difference between grids shows the order of convergence if it is this many times its standard error."""

ORDERS = (0.5, 2.0)
"""Smallest and largest order of convergence by which the bias is judged."""


@dataclass(frozen=True)
class Estimate:
    """A mean over surfaces on the finest grid, or a function of such means.

    Parameters
    ----------
    value, error : float
        The estimate and its standard error.
    degrees : float
        Degrees of freedom of the standard error.
    """

    value: float
    error: float
    degrees: float

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """Interval that holds the mean on the finest grid with this confidence."""
        half = float(stdtrit(self.degrees, 0.5 + confidence / 2)) * self.error
        return self.value - half, self.value + half


def multilevel_mean(
    samples: Sequence[ArrayLike], function: Callable[[Array], float] | None = None
) -> Estimate:
    """Mean of the last level from the samples of all levels, or a function of several means.

    Parameters
    ----------
    samples : sequence of (seeds,) or (seeds, quantities) arrays, coarse to fine
        One row a seed. The seeds of a level are the first ones of the level before.
    function : callable, optional
        Takes the means of the quantities and returns a number, such as the ratio of two means; needed if the
        last level has several quantities.

    Raises
    ------
    ValueError
        If a level has more seeds than a coarser one, or too few for its regression, or if a value is not
        finite.
    """
    levels = checked_levels(samples)
    mean = levels[0].mean(axis=0)
    parts = [_Part(levels[0] - mean, 1, 1.0)]
    for coarse, fine in pairwise(levels):
        mean, part, slope = next_level(coarse[: len(fine)], fine, mean)
        parts = [_Part(p.residuals @ slope, p.parameters, p.inflation) for p in parts] + [part]
    if function is None:
        if mean.size > 1:
            raise ValueError(f"function: missing; it is needed for the means of {mean.size} quantities")
        value, gradient = float(mean[0]), np.ones(1)
    else:
        value, gradient = float(function(mean)), _gradient(function, mean)
    return Estimate(value, *_error([p._replace(residuals=p.residuals @ gradient) for p in parts]))


class Spread(NamedTuple):
    """Variance of one seed, and its degrees of freedom."""

    variance: float
    degrees: float

    @classmethod
    def of(cls, values: ArrayLike) -> Spread:
        """Variance of some seeds."""
        seeds = np.asarray(values, float)
        return cls(float(seeds.var(ddof=1)), float(seeds.size - 1))

    def over(self, estimate: Estimate, confidence: float = 0.95) -> tuple[float, float, float]:
        """Seeds of plain Monte Carlo for the standard error of an estimate, with the ends of an interval.

        The interval is that of a ratio of two independent variances (F distribution). Here both grow and
        shrink together, so that it is somewhat too wide.
        """
        seeds = self.variance / estimate.error**2
        tail = (1 - confidence) / 2
        ends = (float(fdtri(self.degrees, estimate.degrees, p)) for p in (1 - tail, tail))
        low, high = (seeds / end for end in ends)
        return seeds, low, high


def ratio(means: Array) -> float:
    """First of two means over the second: a function for `multilevel_mean`."""
    return float(means[0] / means[1])


class _Part(NamedTuple):
    """Residuals of one level, number of fitted parameters, and inflation of the variance by the slopes."""

    residuals: Array
    parameters: int
    inflation: float


def checked_levels(samples: Sequence[ArrayLike]) -> list[Array]:
    """Samples of every level as arrays (seeds, quantities), checked as for `multilevel_mean`."""
    levels = [np.asarray(level, float) for level in samples]
    levels = [level[:, None] if level.ndim == 1 else level for level in levels]
    if not levels:
        raise ValueError("samples = []: one level or more is needed")
    for number, level in enumerate(levels):
        if not np.isfinite(level).all():
            raise ValueError(f"samples[{number}]: finite numbers are needed")
        if number and len(level) > len(levels[number - 1]):
            raise ValueError(
                f"samples[{number}]: {len(level)} seeds; at most the {len(levels[number - 1])} of the "
                f"coarser level are needed"
            )
        before = levels[number - 1] if number else level
        slopes = regressors(before, level) if number else 0
        if len(level) < slopes + 2:
            raise ValueError(f"samples[{number}]: {len(level)} seeds; at least {slopes + 2} are needed")
    return levels


def regressors(coarse: Array, fine: Array) -> int:
    """Number of slopes fitted for one quantity of the finer level."""
    if coarse.shape[1] != fine.shape[1]:
        return coarse.shape[1]
    return 1 if len(fine) >= FEWEST_FOR_SLOPE else 0


def next_level(coarse: Array, fine: Array, coarse_mean: Array) -> tuple[Array, _Part, Array]:
    """Means of a level from those of the coarser one, what its own seeds add, and the slopes."""
    x, y = coarse - coarse.mean(axis=0), fine - fine.mean(axis=0)
    gap = coarse_mean - coarse.mean(axis=0)
    if coarse.shape[1] != fine.shape[1]:
        slope = np.linalg.lstsq(x, y, rcond=None)[0]
        inflation = 1 + len(fine) * float(gap @ np.linalg.pinv(x.T @ x) @ gap)
        parameters = 1 + x.shape[1]
    elif len(fine) >= FEWEST_FOR_SLOPE:
        squares = (x**2).sum(axis=0)
        known = np.where(squares > 0, squares, 1.0)
        slope = np.diag((x * y).sum(axis=0) / known)
        inflation = 1 + len(fine) * float(np.max(gap**2 * (squares > 0) / known))
        parameters = 2
    else:
        slope, inflation, parameters = np.eye(x.shape[1]), 1.0, 1
    return fine.mean(axis=0) + gap @ slope, _Part(y - x @ slope, parameters, inflation), slope


def _gradient(function: Callable[[Array], float], mean: Array, step: float = 1e-5) -> Array:
    """Derivatives of a function of means, by central differences of a relative step."""
    steps = step * np.where(mean == 0, 1.0, np.abs(mean))
    return np.array([(function(mean + d) - function(mean - d)) / (2 * d.sum()) for d in np.diag(steps)])


def _error(parts: Sequence[_Part]) -> tuple[float, float]:
    """Standard error of the sum of the parts, and its degrees of freedom.

    A seed that is in several levels counts once, with the sum of its residuals.
    """
    influence = np.zeros(max(len(part.residuals) for part in parts))
    squares, freedoms = [], []
    for part in parts:
        seeds, free = len(part.residuals), len(part.residuals) - part.parameters
        scaled = part.residuals * np.sqrt(part.inflation * seeds / free) / seeds
        influence[:seeds] += scaled
        squares.append(float(scaled @ scaled))
        freedoms.append(free)
    total = sum(squares)
    if total == 0:
        return 0.0, float(min(freedoms))
    degrees = total**2 / sum(v**2 / f for v, f in zip(squares, freedoms, strict=True))
    return float(np.sqrt(influence @ influence)), degrees


class Bias(NamedTuple):
    """What vanishing grid spacing adds to the mean on the finest grid.

    Parameters
    ----------
    value : float
    order : float
        Order of convergence that the differences show, limited to `ORDERS`; one where they show none.
    """

    value: float
    order: float


def bias(nodes: Sequence[float], samples: Sequence[ArrayLike]) -> Bias:
    """Bias of the finest grid from the differences between grids, by Richardson's extrapolation.

    The difference between the two finest grids is that of the seeds of both. It is not taken smaller than
    the difference before it lets one expect, as Giles (2015, section 3) does, nor than its own standard
    error. The order is the smallest within one standard error of both differences, since a bias that is
    judged too small is worse than one judged too large.

    Parameters
    ----------
    nodes : (grids,) rising numbers
        Nodes on the shortest wavelength.
    samples : sequence of (seeds,) arrays
        Of these grids, seeds nested.
    """
    levels = [level[:, 0] for level in checked_levels(samples)]
    if len(levels) != len(nodes) or len(levels) < 2 or np.any(np.diff(nodes) <= 0):
        raise ValueError(
            f"nodes = {shown(list(nodes))}: {len(levels)} rising numbers are needed, two or more"
        )
    differences = [fine - coarse[: len(fine)] for coarse, fine in pairwise(levels)]
    means = [abs(float(difference.mean())) for difference in differences]
    errors = [float(each.std(ddof=1) / np.sqrt(len(each))) for each in differences]
    size, order = max(means[-1], errors[-1]), 1.0
    if len(means) > 1:
        if means[-2] > CLEAR * errors[-2]:
            decay = (means[-1] + errors[-1]) / (means[-2] - errors[-2])
            order = float(np.clip(_order(nodes[-3:], decay), *ORDERS))
        size = max(size, means[-2] * _decay(nodes[-3:], order))
    sign = np.sign(differences[-1].mean()) or 1.0
    return Bias(float(sign * size / ((nodes[-1] / nodes[-2]) ** order - 1)), order)


def _decay(nodes: Sequence[float], order: float) -> float:
    """Second of two differences between three grids over the first, at an order of convergence."""
    first, middle, last = (node**-order for node in nodes)
    return (middle - last) / (first - middle)


def _order(nodes: Sequence[float], decay: float) -> float:
    """Order of convergence at which two differences have this ratio, by bisection."""
    low, high = 1e-3, 10.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if _decay(nodes, middle) > decay else (low, middle)
    return (low + high) / 2
