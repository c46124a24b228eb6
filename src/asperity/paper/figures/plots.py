"""Plots that several figures share: densities of heights and peaks, joint densities over depth, decays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from asperity.paper.figures.cases import Case
from asperity.types import Array
from asperity.views.style import COLUMN, PAGE, panels

SHEAR_STRESSES = ("xz", "yz", "xy")
"""Quantities as often positive as negative, of which the magnitude is shown."""

LARGEST_DISTANCE = 6.0
"""Largest depth or distance drawn, in units of the shortest wavelength."""

SMALLEST_SHARE = 1e-4
"""Smallest joint density drawn, over the largest: the range of the colours."""

SMALLEST_DENSITY = 2e-3
"""Smallest density, over the largest, to which the axis of a density extends."""


LARGEST_OVER_MEDIAN = 10.0
"""Largest value of a peak drawn, over the largest median of the cases. Spikes of a measured map have peaks
far above, which would flatten all curves; those of random surfaces stay below 6."""


def height_densities(axis: Axes, titles: Iterable[str], statistics: Iterable[xr.Dataset]) -> None:
    """Draw the probability density of the heights over their rms, all seeds, one curve for each title."""
    for title, data in zip(titles, statistics, strict=True):
        edges = data["height_edge"].values
        axis.plot((edges[1:] + edges[:-1]) / 2, data["height_density"], label=title)
    axis.set(xlabel=r"$h / h_\mathrm{rms}$", ylabel="probability density", xlim=(-4.5, 4.5), ylim=(0, None))


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
    _curve_with_band(axis, sign * (edges[1:] + edges[:-1]) / 2, *curves, **look)


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
    limit = LARGEST_OVER_MEDIAN * max(_median(x, y) for x, y in lines)
    largest = max(float(x[(y > visible) & (x <= limit)].max(initial=0.0)) for x, y in lines)
    axis.set(xlabel=f"${scaled}$", ylabel=rf"PDF$\,[{scaled}]$", xlim=(0, 1.02 * largest), ylim=(0, None))
    beyond = max(float(y[x > 1.02 * largest].sum() / max(y.sum(), 1e-300)) for x, y in lines)
    spikes = any(np.any((y > visible) & (x > limit)) for x, y in lines)
    axis.legend(title=_beyond(beyond) if spikes else None)


def _median(values: Array, weights: Array) -> float:
    """Median of the positive values, each with its weight; zero if there are none."""
    order = np.argsort(values)
    order = order[values[order] > 0]
    cumulative = np.cumsum(weights[order])
    if not cumulative.size or not cumulative[-1] > 0:
        return 0.0
    return float(values[order][np.searchsorted(cumulative, 0.5 * cumulative[-1])])


def _beyond(share: float) -> str:
    """Text on the share of the peaks that lie beyond an axis."""
    return f"{100 * share:.2g} % beyond the axis"


def von_mises_densities(axis: Axes, cases: Sequence[Case]) -> None:
    """Draw the probability density of the von Mises peaks, one curve for each case."""
    for case in cases:
        peak_density(axis, case, "von_mises", label=case.title)
    finish_densities(axis, r"\sigma_\mathrm{VM}")


def depth_distributions(
    cases: Sequence[Case], unit: float | None = None, symbol: str = r"\lambda_s"
) -> Figure:
    """Joint probability density of the von Mises peaks over scaled value and depth, one panel for each case.

    Parameters
    ----------
    cases : sequence of Case
    unit, symbol : optional
        Unit of depth of all panels and its symbol; by default the shortest wavelength of each surface.
    """
    figure, axes = panels(columns=len(cases), height=66, width=PAGE if len(cases) > 1 else COLUMN)
    densities = [_joint_density(case, unit or case.wavelength_short) for case in cases]
    shown = [(value, depth, density) for value, depth, density in densities if density.count()]
    if not shown:
        return _without_peaks(figure, axes, cases)
    highest = max(density.max() for _, _, density in shown)
    lowest = min(density.min() for _, _, density in shown)
    norm = LogNorm(max(highest * SMALLEST_SHARE, lowest if lowest < highest else 0), highest)
    limit = LARGEST_OVER_MEDIAN * max(
        _median(value[1:], density.sum(axis=1).filled(0)) for value, _, density in shown
    )
    reached = [value[1:][density.any(axis=1)] for value, _, density in shown]
    widest = max(float(values[values <= limit].max(initial=0.0)) for values in reached)
    deepest = max(depth[1:][density.any(axis=0)].max() for _, depth, density in shown)
    for axis, case, (value, depth, density) in zip(axes, cases, densities, strict=True):
        image = axis.pcolormesh(value, depth, density.T, norm=norm, cmap="viridis_r", rasterized=True)
        axis.set(xlabel=r"$\sigma_\mathrm{VM}^\mathrm{lmax} / E^* \bar{g}_r$", ylabel=f"depth $/ {symbol}$")
        axis.set(xlim=(0, widest), ylim=(min(deepest, LARGEST_DISTANCE), 0))
        axis.set_title(case.title, loc="center")
    figure.colorbar(image, ax=axes, label="joint probability density")
    return figure


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


def decays(cases: Sequence[Case]) -> Figure:
    """Eq. 22 along depth (a) and in the plane of the largest peak (b), over the variance in that plane."""
    figure, (along_depth, in_plane) = panels()
    for case in cases:
        profiles, unit = case.profiles, case.wavelength_short
        factor = 1 / float(profiles["scaled_covariance_plane"][0])
        for axis, distance, name in (
            (along_depth, "plane_depth", "scaled_covariance_depth"),
            (in_plane, "lag", "scaled_covariance_plane"),
        ):
            curves = [factor * profiles[f"{name}{end}"].values for end in ("", "_low", "_high")]
            _curve_with_band(axis, profiles[distance] / unit, *curves, label=case.title)
    for axis in (along_depth, in_plane):
        axis.axhline(0, color="k", lw=0.4)
        axis.legend()
    along_depth.set(
        xlabel=r"depth $/ \lambda_s$",
        ylabel=r"$G_\mathrm{VM}(z) / G_\mathrm{VM}(z_\mathrm{peak})$",
        xlim=(0, LARGEST_DISTANCE),
    )
    in_plane.set(
        xlabel=r"distance $/ \lambda_s$",
        ylabel=r"$G_\mathrm{VM}(r) / G_\mathrm{VM}(0)$",
        xlim=(0, LARGEST_DISTANCE),
    )
    return figure


def _curve_with_band(axis: Axes, x: ArrayLike, values: Array, low: Array, high: Array, **look: Any) -> None:
    """Draw a curve, and its confidence band if it has one."""
    line = axis.plot(x, values, **look)[0]
    if np.isfinite(low).all():
        axis.fill_between(np.asarray(x), low, high, color=line.get_color(), alpha=0.25, lw=0)
