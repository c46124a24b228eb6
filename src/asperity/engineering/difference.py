"""Differences of numbers between two surfaces, each of one map or of a sample, with their 95 % intervals."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from asperity.core.markup import with_error
from asperity.core.types import Array
from asperity.engineering.places import CONFIDENCE
from asperity.engineering.question import Row
from asperity.engineering.sample import SAME_PIXELS, SampleRow, shown_unit

BETTER_IF_LESS = ("volume above", "share above", "largest", "peaks above")
"""Beginnings of the names of numbers that should be small."""

BETTER_IF_MORE = ("shakedown", "probability of no crack")
"""Beginnings of the names of numbers that should be large."""

SIGNIFICANT = 0.05
"""Probability of a difference by chance below which one surface is called better."""


class Difference(NamedTuple):
    """A number of two surfaces and its difference, second less first.

    Parameters
    ----------
    group, name, unit : str
        The group without the constants of a body, which differ between cases.
    first, second : float
    error : float
        Half of the 95 % interval of the difference: from place to place where that is known, and by the
        pixels.
    chance : float
        Probability of such a difference between maps of one surface; NaN where it is not known how places
        differ.
    """

    group: str
    name: str
    unit: str
    first: float
    second: float
    error: float
    chance: float

    @property
    def shown(self) -> tuple[str, str, str]:
        """Both numbers, and the difference with its interval, for a reader."""
        values = self.first, self.second
        factor, symbol = shown_unit(values, self.unit, self.name)
        first, second = (f"{float(f'{value / factor:.3g}'):.15g} {symbol}".strip() for value in values)
        if abs(self.second - self.first) <= SAME_PIXELS * abs(self.first):
            return first, second, "none"
        change = with_error((self.second - self.first) / factor, self.error / factor, signed=True)
        return first, second, f"{change} {symbol}".strip()

    @property
    def in_words(self) -> str:
        """The probability of the difference by chance."""
        if math.isnan(self.chance):
            return "from one place each: whether other places differ too is not known; add maps"
        return f"p = {self.chance:.2g}"


def differences(first: Sequence[Row | SampleRow], second: Sequence[Row | SampleRow]) -> list[Difference]:
    """Differences of all numbers that two answers, or two samples, have.

    The errors of two answers are taken to be normally distributed.
    """
    from scipy.stats import norm

    groups = {(group_of(row), row.name): row for row in second}
    found = []
    for row in first:
        other = groups.get((group_of(row), row.name))
        if isinstance(row, SampleRow) and isinstance(other, SampleRow):
            found.append(_of_samples(row, other))
        elif isinstance(row, Row) and isinstance(other, Row):
            values = [each.estimate if math.isfinite(each.estimate) else each.value for each in (row, other)]
            pixels = np.nan_to_num([each.error for each in (row, other)])
            places = np.array([each.error_of_places for each in (row, other)])
            error, chance = float(np.linalg.norm([*pixels, *np.nan_to_num(places)])), math.nan
            if np.isfinite(places).all() and error:
                size = abs(values[1] - values[0]) / error
                chance = 2 * float(norm.sf(norm.ppf((1 + CONFIDENCE) / 2) * size))
            numbers = group_of(row), row.name, row.unit, values[0], values[1]
            found.append(Difference(*numbers, error or math.nan, chance))
    return found


def group_of(row: Row | SampleRow) -> str:
    """Group of a row without the constants of a body, which differ between cases."""
    return row.group.partition(" (")[0]


def _of_samples(first: SampleRow, second: SampleRow) -> Difference:
    """Difference of the means of two samples by Welch's t test, with the errors of the pixels.

    B. L. Welch, Biometrika 34 (1947) 28, doi 10.1093/biomet/34.1-2.28.
    """
    from scipy.stats import t

    samples: list[Array] = [first.of_each, second.of_each]
    pixels = np.nan_to_num([first.mean.of_grid, second.mean.of_grid])
    found = group_of(first), first.name, first.unit, first.value, second.value
    if min(each.size for each in samples) < 2:
        return Difference(*found, float(np.linalg.norm(pixels)) or math.nan, math.nan)
    squares = [each.var(ddof=1) / each.size for each in samples]
    freedom = sum(squares) ** 2 / max(
        sum(square**2 / (each.size - 1) for square, each in zip(squares, samples, strict=True)), 1e-300
    )
    quantile = float(t.ppf((1 + CONFIDENCE) / 2, max(freedom, 1.0)))
    error = float(np.linalg.norm([quantile * math.sqrt(sum(squares)), *pixels]))
    if not error:
        return Difference(*found, math.nan, math.nan)
    size = abs(second.value - first.value) / error
    return Difference(*found, error, 2 * float(t.sf(quantile * size, max(freedom, 1.0))))


def verdict(found: Sequence[Difference], names: tuple[str, str], tiles: Sequence[str]) -> str:
    """One sentence: which of two surfaces is better, in the first of the tiles that can be judged."""
    judged = {each.name: each for each in found if each.name.startswith((*BETTER_IF_LESS, *BETTER_IF_MORE))}
    order = ["volume above yield per area", *tiles]
    each = next((judged[name] for name in order if name in judged), None)
    if each is None:
        return ""
    less = each.name.startswith(BETTER_IF_LESS)
    is_second = (each.second < each.first) == less
    own, other, _ = each.shown
    (best, worst), (value, against) = names, (own, other)
    if is_second:
        (worst, best), (against, value) = names, (own, other)
    if value == against:
        return f"{best} and {worst} have the same {each.name}, {value}."
    word = "not known to be better" if math.isnan(each.chance) else "no significant difference"
    if each.chance < SIGNIFICANT:
        word = "better"
    return f"{best}: {each.name} {value} against {against} of {worst}; {word}, {each.in_words}."
