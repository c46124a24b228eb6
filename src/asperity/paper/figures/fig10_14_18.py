"""How the von Mises peaks are distributed over value and depth, one panel for each case."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from asperity.core.types import Array
from asperity.paper.figures.cases import CASES, LARGEST_OVER_MEDIAN, Case, Datasets, bullets, median
from asperity.views.style import COLUMN, PAGE, panels

LARGEST_DEPTH = 6.0
"""Largest depth drawn, in units of the shortest wavelength."""

SMALLEST_SHARE = 1e-4
"""Smallest joint density drawn, over the largest: the range of the colours."""


def draw(statistics: Datasets, cases: str) -> Figure:
    """Draw the joint probability density of the von Mises peaks, on a logarithmic scale of colour.

    The unit of depth is the shortest wavelength of each surface; of cases ``shortest waves`` that of the
    first one, λ_sn, in all panels.
    """
    compared = CASES[cases](statistics)
    symbol = r"\lambda_{sn}" if cases == "shortest waves" else r"\lambda_s"
    figure, axes = panels(columns=len(compared), height=66, width=PAGE if len(compared) > 1 else COLUMN)
    densities = [
        _joint_density(case, unit) for case, unit in zip(compared, _units(compared, cases), strict=True)
    ]
    shown = [(value, depth, density) for value, depth, density in densities if density.count()]
    if not shown:
        return _without_peaks(figure, axes, compared)
    highest = max(density.max() for _, _, density in shown)
    lowest = min(density.min() for _, _, density in shown)
    norm = LogNorm(max(highest * SMALLEST_SHARE, lowest if lowest < highest else 0), highest)
    limit = LARGEST_OVER_MEDIAN * max(
        median(value[1:], density.sum(axis=1).filled(0)) for value, _, density in shown
    )
    reached = [value[1:][density.any(axis=1)] for value, _, density in shown]
    widest = max(float(values[values <= limit].max(initial=0.0)) for values in reached)
    deepest = max(depth[1:][density.any(axis=0)].max() for _, depth, density in shown)
    for axis, case, (value, depth, density) in zip(axes, compared, densities, strict=True):
        image = axis.pcolormesh(value, depth, density.T, norm=norm, cmap="viridis_r", rasterized=True)
        axis.set(xlabel=r"$\sigma_\mathrm{VM}^\mathrm{lmax} / E^* \bar{g}_r$", ylabel=f"depth $/ {symbol}$")
        axis.set(xlim=(0, widest), ylim=(min(deepest, LARGEST_DEPTH), 0))
        axis.set_title(case.title, loc="center")
    figure.colorbar(image, ax=axes, label="joint probability density")
    return figure


def caption(statistics: Datasets, cases: str) -> str:
    """Median depths of the peaks of each case."""
    compared = CASES[cases](statistics)
    symbol = "λ_sn" if cases == "shortest waves" else "λ_s"
    lines = []
    for case, unit in zip(compared, _units(compared, cases), strict=True):
        peaks = case.peaks("von_mises")
        every, highest = (float(peaks[f"median_depth{which}"]) / unit for which in ("", "_highest"))
        lines.append(
            f"{case.name}: median depth of the peaks {every:.3f} {symbol}, "
            f"of the highest tenth {highest:.3f} {symbol}"
        )
    return bullets(lines)


def _units(compared: Sequence[Case], cases: str) -> list[float]:
    """Unit of depth of each case."""
    units = [case.wavelength_short for case in compared]
    return units[:1] * len(units) if cases == "shortest waves" else units


def _without_peaks(figure: Figure, axes: Sequence[Axes], cases: Sequence[Case]) -> Figure:
    """The figure of surfaces under whose contacts no peak was found, as in contacts of a few nodes."""
    for axis, case in zip(axes, cases, strict=True):
        axis.set_title(case.title, loc="center")
        axis.text(0.5, 0.5, "no peaks", ha="center", transform=axis.transAxes)
        axis.set(xticks=[], yticks=[])
    return figure


def _joint_density(case: Case, unit: float) -> tuple[Array, Array, np.ma.MaskedArray]:
    """Edges of value and of depth in a unit, and the density of the von Mises peaks, masked where zero."""
    peaks = case.peaks("von_mises")
    value, depth = peaks["bin_edge"].values, peaks["depth_edge"].values / unit
    counts = peaks["joint_counts"].values
    area = np.diff(value)[:, None] * np.diff(depth)[None, :]
    return value, depth, np.ma.masked_equal(counts / max(counts.sum(), 1) / area, 0)
