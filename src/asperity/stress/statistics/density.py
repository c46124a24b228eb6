"""Probability densities of one set of values."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from asperity.core.arguments import LARGEST, finite_array, number, pair, require_finite, whole_number
from asperity.core.errors import shown
from asperity.core.types import Array

NARROWEST_BIN = 1e-300
"""Smallest width of a bin whose density is still finite."""

MOST_BINS = 10_000_000
"""Most bins of a density."""


class Density(NamedTuple):
    """A histogram and its probability density.

    Parameters
    ----------
    counts : (bins,) integer array
    edges : (bins + 1,) array
    density : (bins,) array
        Counts divided by their sum and by the width of their bin; zero if nothing was counted.
    """

    counts: Array
    edges: Array
    density: Array


def probability_density(values: Array, bins: int = 100, limits: tuple[float, float] | None = None) -> Density:
    """Probability density of values in bins of equal width.

    Parameters
    ----------
    values : array
    bins : int
    limits : (lowest, highest), optional
        By default the smallest and the largest value. Values outside the limits are not counted.

    Raises
    ------
    ValueError
        If `bins` is out of range, a value is not finite or larger than 1e75, or the limits do not rise.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1.0, seed=1)
    >>> density = asp.stress.probability_density(height, bins=20)
    >>> density.density.size, round(float(np.sum(density.density * np.diff(density.edges))), 12)
    (20, 1.0)
    """
    values = finite_array("values", values).ravel()
    edges = bin_edges(values, bins, limits)
    counts = np.histogram(values, edges)[0]
    found = Density(counts, edges, normalised(counts, edges))
    require_finite("probability_density", found._asdict())
    return found


def bin_edges(values: Array, bins: int, limits: tuple[float, float] | None = None) -> Array:
    """Edges of bins of equal width between limits, by default from the smallest to the largest value.

    Values so close together that bins between them would have no width count as equal.
    """
    bins = whole_number(
        "bins", bins, f"a whole number from 1 to {MOST_BINS}", lambda count: 1 <= count <= MOST_BINS
    )
    if limits is None:
        width = max(NARROWEST_BIN, float(np.spacing(np.abs(values).max()))) if values.size else 0.0
        alike = values.size and np.ptp(values) < 2 * bins * width
        if not alike:
            return np.histogram_bin_edges(values, bins)
        half = max(0.5, bins * width)
        return np.linspace(values[0] - half, values[0] + half, bins + 1)
    accepted = "a pair of finite rising numbers, farther apart than their rounding,"
    first, last = (
        number("limits", limit, accepted, lambda size: abs(size) <= LARGEST)
        for limit in pair("limits", limits, accepted)
    )
    if not last - first > 2 * bins * max(NARROWEST_BIN, float(np.spacing(max(abs(first), abs(last))))):
        raise ValueError(f"limits = {shown(limits)}: {accepted} is needed")
    return np.linspace(first, last, bins + 1)


def normalised(counts: Array, edges: Array) -> Array:
    """Probability density from counts in bins, along the last axis; zero where nothing was counted."""
    total = counts.sum(axis=-1, keepdims=True)
    return counts / (np.maximum(total, 1) * np.diff(edges))
