"""Probability densities of the heights of rough surfaces, and a cross-section of each surface."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.paper.figures.cases import Datasets, bullets, curve_with_band, name
from asperity.views.style import label, panels


def draw(surface: Mapping[str, Any], statistics: Mapping[str, Any], offset: float = 0.0) -> Figure:
    """Draw the density of the heights of all seeds, and the section y = L/2 of one.

    With an offset, the distance between the sections as drawn in rms heights, there is a column of panels for
    each study (``skewness`` and ``kurtosis``); without one the panels of the only study are side by side.
    """
    if not offset:
        figure, (heights, section) = panels()
        _draw_heights(heights, statistics, {key: label(data) for key, data in statistics.items()})
        heights.legend()
        _draw_sections(section, surface, offset, lw=0.6)
        section.set(ylabel=r"$h / h_\mathrm{rms}$")
        section.legend(loc="upper right", ncols=len(surface))
        section.set_ylim(top=1.25 * section.get_ylim()[1])
        return figure
    figure, axes = panels(columns=len(statistics), rows=2, height=58)
    for study, heights, section in zip(statistics, axes, axes[len(statistics) :], strict=False):
        moment = "skewness" if study == "skewness" else "kurtosis"
        titles = {
            key: f"{label(data)}\n{moment} {float(data[f'seed_{moment}'].mean()):.2f}"
            for key, data in statistics[study].items()
        }
        _draw_heights(heights, statistics[study], titles)
        heights.legend(fontsize=6)
        heights.set_ylim(top=1.05 * heights.get_ylim()[1])
        _draw_sections(section, surface[study], offset, lw=0.5)
        section.set(ylabel=r"$h / h_\mathrm{rms}$, shifted", yticks=[])
    return figure


def _draw_heights(axis: Axes, statistics: Datasets, titles: Mapping[str, str]) -> None:
    """Draw the probability density of the heights over their rms, all seeds, a curve for each surface."""
    for key, data in statistics.items():
        edges = data["height_edge"].values
        curves = [data[f"height_density{end}"].values for end in ("", "_low", "_high")]
        curve_with_band(axis, (edges[1:] + edges[:-1]) / 2, *curves, label=titles[key])
    axis.set(xlabel=r"$h / h_\mathrm{rms}$", ylabel="probability density", xlim=(-4.5, 4.5), ylim=(0, None))


def _draw_sections(axis: Axes, surface: Datasets, offset: float, lw: float) -> None:
    """Draw the section y = L/2 of each surface, each lower than the one before."""
    for number, data in enumerate(surface.values()):
        profile = data["height"].isel(y=data.sizes["y"] // 2) / data["rms_height"]
        axis.plot(data["x"], profile - offset * number, lw=lw, label=label(data))
        if offset:
            axis.axhline(-offset * number, color="k", lw=0.3)
    axis.set(xlabel="$x / L$", xlim=(0, 1))


def caption(surface: Mapping[str, Any], statistics: Mapping[str, Any], offset: float = 0.0) -> str:
    """Moments of each surface; of several studies also the change of the kurtosis with the short waves."""
    if not offset:
        return bullets(_moments(surface, statistics))
    lines = [line for study in statistics for line in _moments(surface[study], statistics[study])]
    kurtosis = [float(data["seed_kurtosis"].mean()) for data in statistics["kurtosis"].values()]
    errors = [
        float(data["kurtosis_error"]) for data in surface["kurtosis"].values() if "kurtosis_error" in data
    ]
    change, scatter = max(kurtosis) - min(kurtosis), max(errors, default=float("nan"))
    compared = "less" if change < scatter else "not less"
    lines.append(
        f"From one shortest wavelength to another the kurtosis changes by {change:.3f}, {compared} than the "
        f"standard error of one sample ({scatter:.3f}): a Gaussian surface has a kurtosis of 3 "
        f"whatever its shortest wavelength."
    )
    return bullets(lines)


def _moments(surface: Datasets, statistics: Datasets) -> list[str]:
    """Skewness and kurtosis of each surface, means over seeds."""
    lines = []
    for key, data in statistics.items():
        one = surface[key]
        skewness, kurtosis = (_mean(data[f"seed_{moment}"]) for moment in ("skewness", "kurtosis"))
        text = f"{name(label(one))}: skewness {skewness}, kurtosis {kurtosis}"
        if "kurtosis_error" in one:
            text += (
                f" (standard errors of one Gaussian sample of this spectrum: "
                f"{float(one['skewness_error']):.3f} and {float(one['kurtosis_error']):.3f})"
            )
        lines.append(text)
    return lines


def _mean(seeds: xr.DataArray) -> str:
    """Mean over seeds, with its standard error if there are several."""
    values = np.asarray(seeds, dtype=float)
    if values.size == 1:
        return f"{values[0]:.3f}"
    return f"{values.mean():.3f} ± {values.std(ddof=1) / np.sqrt(values.size):.3f} ({values.size} samples)"
