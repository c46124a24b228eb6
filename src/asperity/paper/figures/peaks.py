"""Statistics of rough surfaces: loads, and distributions and decay of the stress peaks."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from scipy.special import erf

from asperity.core.types import Array
from asperity.paper.figures.cases import (
    CASES,
    LARGEST_OVER_MEDIAN,
    Datasets,
    FigureCase,
    curve_with_band,
    distinct,
    extreme_ratios,
    finish_densities,
    median,
    of_surfaces,
    peak_density,
    title_panel,
    von_mises_densities,
    with_band,
)
from asperity.views.style import COLUMN, PAGE, label, panels

LARGEST_DISTANCE = 6.0
"""Largest depth or distance drawn, in units of the shortest wavelength."""

MOST = 0.999
"""Fraction of the peaks that an axis, of value or of depth, shows."""

DEPARTURE = 0.05
"""Difference between decay curves, over the variance, above which it is marked: the paper finds none."""

SMALLEST_SHARE = 1e-4
"""Smallest joint density drawn, over the largest: the range of the colours."""


def draw_load_area(statistics: Datasets) -> Figure:
    """Draw (a) the area fraction against load, with two theories, and (b) the density of the pressure peaks.

    Both are means over seeds with their bands.

    Notes
    -----
    Persson: a_r = erf(√2 p̄ / E* ḡ_r), doi 10.1063/1.1388626; Bush, Gibson and Thomas: a_r = √(2π) p̄ / E* ḡ_r,
    doi 10.1016/0043-1648(75)90145-3. Both are evaluated with the gradient of the real contact.
    """
    figure, (curve, peaks) = panels()
    reach = 0.0
    for data, marker in zip(distinct(statistics).values(), "osD^", strict=False):
        load, low, high = with_band(data, "path_scaled_load")
        area = 100 * data["path_contact_area_fraction"]
        band = [load - low, high - load] if np.isfinite(low).all() else None
        curve.errorbar(load, area, xerr=band, fmt=marker, mfc="none", capsize=2, label=label(data))
        reach = max(reach, float(load.max()))
    loads = np.linspace(0, reach, 200)
    curve.plot(loads, 100 * erf(np.sqrt(2) * loads), "k-", lw=0.9, label="Persson")
    curve.plot(loads, 100 * np.sqrt(2 * np.pi) * loads, "k--", lw=0.9, label="Bush, Gibson, Thomas")
    curve.set(xlabel=r"$P_0 / E^* \bar{g}_r$", ylabel="contact area fraction $a_r$ (%)")
    curve.set(xlim=(0, None), ylim=(0, None))
    curve.legend()
    for case in of_surfaces(statistics):
        peak_density(peaks, case, "pressure", label=case.title)
    finish_densities(peaks, "t_3")
    return figure


def caption_load_area(statistics: Datasets) -> Iterator[str]:
    """Ratio of area and load along the curve, and percentiles of the pressure peaks."""
    for case in of_surfaces(statistics):
        ratio = case.statistics["path_contact_area_fraction"] / case.statistics["path_scaled_load"]
        yield (
            f"{case.name}: area fraction over scaled load from {float(ratio[0]):.3f} to "
            f"{float(ratio[-1]):.3f} (Persson 1.596, Bush, Gibson and Thomas 2.507, at small load); "
            f"{case.peak_percentiles('pressure')}"
        )


def draw_stresses(statistics: Datasets, cases: str) -> Figure:
    """Draw the densities of (a) the von Mises peaks and (b) the peaks of −σ_xx and of another component.

    The other one is |σ_xz| of each surface, or −σ_zz of the only surface at several Poisson's ratios.

    Notes
    -----
    A peak of a signed component is a maximum of its magnitude. σ_xx is compressive under a contact, so
    −σ_xx is shown; σ_xz is as often positive as negative, so |σ_xz| is. σ_zz does not depend on Poisson's
    ratio in a half-space and has one curve; in a layer the curve of the contact's ratio is shown.
    """
    compared = CASES[cases](statistics)
    figure, (von_mises, components) = panels()
    von_mises_densities(von_mises, compared)
    for number, case in enumerate(compared):
        name = rf"$-\sigma_{{xx}}$, {case.title}"
        peak_density(components, case, "xx", compression=True, label=name, color=f"C{number}")
        if cases == "surfaces":
            name = rf"$|\sigma_{{xz}}|$, {case.title}"
            peak_density(components, case, "xz", label=name, ls="--", color=f"C{number}")
    if cases == "ratios":
        (own,) = of_surfaces(statistics)
        alike = r", the same for every $\nu$" if own.statistics.attrs["solid"] == "half-space" else ""
        label = rf"$-\sigma_{{zz}}${alike}"
        peak_density(components, own, "zz", compression=True, c="k", ls="--", label=label)
    finish_densities(components, r"\sigma_{ij}" if cases == "surfaces" else r"-\sigma_{ii}")
    return figure


def caption_stresses(statistics: Datasets, cases: str) -> Iterator[str]:
    """Percentiles of the peaks of each case, and the ratio between the extreme Poisson's ratios."""
    if cases == "surfaces":
        for case in of_surfaces(statistics):
            for quantity, symbol in (("von_mises", "σ_VM"), ("xx", "\\|σ_xx\\|"), ("xz", "\\|σ_xz\\|")):
                yield f"{case.name}, {symbol}: {case.peak_percentiles(quantity)}"
        return
    for case in CASES[cases](statistics):
        von_mises, lateral = (case.peak_percentiles(quantity) for quantity in ("von_mises", "xx"))
        yield f"{case.name}, σ_VM: {von_mises}; \\|σ_xx\\|: {lateral}"
    peaks = [case.peaks("von_mises")["peak_percentile"] for case in extreme_ratios(statistics)]
    high, low = peaks[0], peaks[-1]
    values = [f"{float(one):.2f} at the {float(one['percent']):g}th percentile" for one in low / high]
    ends = (f"ν = {float(one['poisson']):g}" for one in (low, high))
    yield f"von Mises peaks at {' over those at '.join(ends)}: {', '.join(values)}"


def draw_von_mises(statistics: Mapping[str, Datasets]) -> Figure:
    """Draw the densities of the von Mises peaks, a panel for each study."""
    figure, axes = panels(columns=len(statistics))
    for axis, study in zip(axes, statistics.values(), strict=True):
        von_mises_densities(axis, of_surfaces(study))
    return figure


def caption_von_mises(statistics: Mapping[str, Datasets]) -> Iterator[str]:
    """Percentiles over E* ḡ_r, and the gradients and medians that show the effect of this scaling."""
    for case in [case for study in statistics.values() for case in of_surfaces(study)]:
        gradients = (case.statistics[f"seed_gradient_rms_{where}"] for where in ("contact", "outside"))
        contact, outside = (float(gradient.mean()) for gradient in gradients)
        middle = contact * float(case.peaks("von_mises")["peak_percentile"].sel(percent=50.0))
        yield (
            f"{case.name}: {case.peak_percentiles('von_mises')}; "
            f"rms gradient {contact:.4f} in contact, {outside:.4f} outside; "
            f"median peak {1e3 * middle:.2f} · 10⁻³ E\\*"
        )


def draw_depths(statistics: Datasets, cases: str) -> Figure:
    """Draw the joint probability density of the von Mises peaks, on a logarithmic scale of colour.

    The unit of depth is the shortest wavelength of each surface; for the cases ``shortest waves`` it is the
    shortest wavelength of the first surface, λ_sn, in all panels.
    """
    compared = CASES[cases](statistics)
    symbol = r"\lambda_{sn}" if cases == "shortest waves" else r"\lambda_s"
    figure, axes = panels(columns=len(compared), height=66, width=PAGE if len(compared) > 1 else COLUMN)
    for axis, case in zip(axes, compared, strict=True):
        title_panel(axis, case.title)
    densities: list[tuple[Array, Array, np.ma.MaskedArray]] = []
    every = [case.peaks("von_mises")["joint_counts"].values for case in compared]
    for case, unit, counts in zip(compared, _units(compared, cases), every, strict=True):
        value, depth = (case.peaks("von_mises")[edges].values for edges in ("bin_edge", "depth_edge"))
        area = np.diff(value)[:, None] * np.diff(depth / unit)[None, :]
        densities.append((value, depth / unit, np.ma.masked_equal(counts / max(counts.sum(), 1) / area, 0)))
    shown = [(value, depth, density) for value, depth, density in densities if density.count()]
    if not shown:  # as under contacts of a few nodes
        for axis in axes:
            axis.text(0.5, 0.5, "no peaks", ha="center", transform=axis.transAxes)
            axis.set(xticks=[], yticks=[])
        return figure
    highest = max(density.max() for _, _, density in shown)
    lowest = min(density.min() for _, _, density in shown)
    norm = LogNorm(max(highest * SMALLEST_SHARE, lowest if lowest < highest else 0), highest)
    medians = [median(value[1:], density.sum(axis=1).filled(0)) for value, _, density in shown]
    limit = LARGEST_OVER_MEDIAN * max(medians)
    reached = [value[1:][density.any(axis=1)] for value, _, density in shown]
    widest = max(float(values[values <= limit].max(initial=0.0)) for values in reached)
    ends = [
        (_end_of_most(value, counts.sum(axis=1)), _end_of_most(depth, counts.sum(axis=0)))
        for (value, depth, _), counts in zip(densities, every, strict=True)
    ]
    widest, deepest = min(widest, max(end for end, _ in ends)), max(end for _, end in ends)
    for axis, counts, (value, depth, density) in zip(axes, every, densities, strict=True):
        beyond = counts.sum() - counts[np.ix_(value[1:] <= widest, depth[1:] <= deepest)].sum()
        text = f"{int(beyond)} of {int(counts.sum())} peaks\nbeyond the axes"
        pale = {"facecolor": "w", "alpha": 0.7, "lw": 0, "pad": 1}
        axis.text(0.98, 0.02, text, ha="right", va="bottom", fontsize=6, transform=axis.transAxes, bbox=pale)
        image = axis.pcolormesh(value, depth, density.T, norm=norm, cmap="viridis_r", rasterized=True)
        axis.set(xlabel=r"$\sigma_\mathrm{VM}^\mathrm{lmax} / E^* \bar{g}_r$", ylabel=f"depth $/ {symbol}$")
        axis.set(xlim=(0, widest), ylim=(deepest, 0))
    figure.colorbar(image, ax=axes, label="joint probability density")
    return figure


def caption_depths(statistics: Datasets, cases: str) -> Iterator[str]:
    """Median depths of the peaks of each case."""
    compared = CASES[cases](statistics)
    symbol = "λ_sn" if cases == "shortest waves" else "λ_s"
    for case, unit in zip(compared, _units(compared, cases), strict=True):
        peaks = case.peaks("von_mises")
        every, highest = (float(peaks[f"median_depth{which}"]) / unit for which in ("", "_highest"))
        yield (
            f"{case.name}: median depth of the peaks {every:.3f} {symbol}, "
            f"of the highest tenth {highest:.3f} {symbol}"
        )


def draw_decay(statistics: Datasets, cases: str) -> Figure:
    """Draw Eq. 22 (a) along depth and (b) in the plane of the largest peak, over the variance there."""
    figure, axes = panels()
    drawn: list[list[Array]] = [[], []]
    for case in CASES[cases](statistics):
        data, unit = case.statistics, case.wavelength_short
        factor = 1 / float(data["scaled_covariance_plane"][0])
        for axis, distance, along in zip(axes, ("plane_depth", "lag"), ("depth", "plane"), strict=True):
            curves = [factor * curve for curve in with_band(data, f"scaled_covariance_{along}")]
            curve_with_band(axis, data[distance] / unit, *curves, label=case.title)
            drawn[along == "plane"].append(curves[0])
    for axis, distance, curves in zip(axes, ("plane_depth", "lag"), drawn, strict=True):
        if cases == "ratios" and np.ptp(curves, axis=0).max() > DEPARTURE:
            apart = np.ptp(curves, axis=0) > DEPARTURE
            text = f"curves differ by more than {DEPARTURE:g}\n(the paper: no effect)"
            axis.fill_between(
                data[distance] / unit,
                0,
                1,
                where=apart,
                transform=axis.get_xaxis_transform(),
                facecolor="0.9",
                edgecolor="0.6",  # so that its sample in the legend is seen, which may lie on it
                lw=0.4,
                zorder=0,
                label=text,
            )
    peaks = (r"z_\mathrm{peak}", "0")
    for axis, distance, place, peak in zip(axes, ("depth", "distance"), "zr", peaks, strict=True):
        axis.axhline(0, color="k", lw=0.4)
        axis.legend()
        covariance = rf"$G_\mathrm{{VM}}({place}) / G_\mathrm{{VM}}({peak})$"
        axis.set(xlabel=rf"{distance} $/ \lambda_s$", ylabel=covariance, xlim=(0, LARGEST_DISTANCE))
    return figure


def caption_decay(statistics: Datasets, cases: str) -> Iterator[str]:
    """Depth of the maximum von Mises stress, and where the covariance of Eq. 22 has fallen to half."""
    for case in CASES[cases](statistics):
        reference, down, across = (
            float(case.statistics[length]) / case.wavelength_short
            for length in ("reference_depth", "decay_length_depth", "decay_length_plane")
        )
        yield (
            f"{case.name}: maximum von Mises stress at a depth of {reference:.3f} λ_s; covariance "
            f"halved at a depth of {reference + down:.3f} λ_s, and at a distance of {across:.3f} λ_s "
            f"in the plane"
        )


def _units(compared: Sequence[FigureCase], cases: str) -> list[float]:
    """Unit of depth of each case."""
    units = [case.wavelength_short for case in compared]
    return units[:1] * len(units) if cases == "shortest waves" else units


def _end_of_most(edges: Array, counts: Array) -> float:
    """Upper edge of the bin in which the fraction `MOST` of the counts is reached."""
    return float(edges[1:][np.searchsorted(np.cumsum(counts), MOST * counts.sum())])
