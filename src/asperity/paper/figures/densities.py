"""Probability densities of stress peaks, and curves with a confidence band."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from asperity.core.types import Array
from asperity.paper.figures.cases import Case

SHEAR_STRESSES = ("xz", "yz", "xy")
"""Quantities as often positive as negative, of which the magnitude is shown."""

SMALLEST_DENSITY = 2e-3
"""Smallest density, over the largest, to which the axis of a density extends."""

LARGEST_OVER_MEDIAN = 10.0
"""Largest value of a peak drawn, over the largest median of the cases. Spikes of a measured map have peaks
far above, which would flatten all curves; those of random surfaces stay below 6."""


def von_mises_densities(axis: Axes, cases: Sequence[Case]) -> None:
    """Draw the probability density of the von Mises peaks, one curve for each case."""
    for case in cases:
        peak_density(axis, case, "von_mises", label=case.title)
    finish_densities(axis, r"\sigma_\mathrm{VM}")


def peak_density(axis: Axes, case: Case, quantity: str, compression: bool = False, **look: Any) -> None:
    """Draw the probability density of the peaks of a quantity; of a shear stress that of the magnitude.

    With `compression`, compressive stresses are drawn to the right.
    """
    peaks = case.peaks(quantity)
    edges = peaks["bin_edge"].values
    curves = [peaks[f"peak_density{end}"].values for end in ("", "_low", "_high")]
    if quantity in SHEAR_STRESSES:
        folded = np.linspace(0, np.abs(edges).max(), edges.size)
        curves = [folded_density(curve, edges, folded) for curve in curves]
        edges = folded
    sign = -1 if compression else 1
    curve_with_band(axis, sign * (edges[1:] + edges[:-1]) / 2, *curves, **look)


def folded_density(values: Array, edges: Array, folded_edges: Array) -> Array:
    """Density of a magnitude, from the density of the signed quantity, constant in each bin."""
    below = np.concatenate([[0.0], np.cumsum(values * np.diff(edges))])
    share = np.interp(folded_edges, edges, below) - np.interp(-folded_edges, edges, below)
    return np.diff(share) / np.diff(folded_edges)


def finish_densities(axis: Axes, symbol: str) -> None:
    """Label the axes of densities of scaled peaks, limit them to what can be seen, and add the legend.

    If peaks lie beyond the axis (`LARGEST_OVER_MEDIAN`), the legend says which share of them.
    """
    scaled = rf"{symbol}^\mathrm{{lmax}} / E^* \bar{{g}}_r"
    lines = [(np.asarray(line.get_xdata()), np.asarray(line.get_ydata())) for line in axis.lines]
    visible = SMALLEST_DENSITY * max(float(y.max()) for _, y in lines)
    limit = LARGEST_OVER_MEDIAN * max(median(x, y) for x, y in lines)
    largest = max(float(x[(y > visible) & (x <= limit)].max(initial=0.0)) for x, y in lines)
    axis.set(xlabel=f"${scaled}$", ylabel=rf"PDF$\,[{scaled}]$", xlim=(0, 1.02 * largest), ylim=(0, None))
    beyond = max(float(y[x > 1.02 * largest].sum() / max(y.sum(), 1e-300)) for x, y in lines)
    spikes = any(np.any((y > visible) & (x > limit)) for x, y in lines)
    axis.legend(title=f"{100 * beyond:.2g} % beyond the axis" if spikes else None)


def median(values: Array, weights: Array) -> float:
    """Median of the positive values, each with its weight; zero if there are none."""
    order = np.argsort(values)
    order = order[values[order] > 0]
    cumulative = np.cumsum(weights[order])
    if not cumulative.size or not cumulative[-1] > 0:
        return 0.0
    return float(values[order][np.searchsorted(cumulative, 0.5 * cumulative[-1])])


def curve_with_band(axis: Axes, x: ArrayLike, values: Array, low: Array, high: Array, **look: Any) -> None:
    """Draw a curve, and its confidence band if it has one."""
    line = axis.plot(x, values, **look)[0]
    if np.isfinite(low).all():
        axis.fill_between(np.asarray(x), low, high, color=line.get_color(), alpha=0.25, lw=0)
