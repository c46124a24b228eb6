"""Figure 16: the heights of the skewed surfaces and of those with other cut-offs, and a section of each."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.captions import bullets, height_moments
from asperity.paper.figures.plots import height_densities
from asperity.views.style import label, panels

STAGES = ("surface", "statistics")
STUDIES = ("skewness", "kurtosis")

OFFSET = 7.0
"""Distance between the sections as drawn, in rms heights."""


def draw(
    surface: Mapping[str, Mapping[str, xr.Dataset]], statistics: Mapping[str, Mapping[str, xr.Dataset]]
) -> Figure:
    """Draw (a, b) the density of the heights over all seeds and (c, d) the section y = L/2 of one, shifted.

    Parameters
    ----------
    surface, statistics : mapping of mappings of datasets
        Study ``skewness`` (panels a, c) and study ``kurtosis`` (panels b, d), by surface.
    """
    figure, axes = panels(columns=len(statistics), rows=2, height=58)
    for study, heights, section in zip(statistics, axes, axes[len(statistics) :], strict=False):
        moment = "skewness" if study == "skewness" else "kurtosis"
        shown = statistics[study].values()
        height_densities(heights, [_with_moment(data, moment) for data in shown], shown)
        heights.legend(fontsize=6)
        heights.set_ylim(top=1.05 * heights.get_ylim()[1])
        for number, data in enumerate(surface[study].values()):
            profile = data["height"].isel(y=data.sizes["y"] // 2) / data["rms_height"]
            section.plot(data["x"], profile - OFFSET * number, lw=0.5, label=label(data))
            section.axhline(-OFFSET * number, color="k", lw=0.3)
        section.set(xlabel="$x / L$", ylabel=r"$h / h_\mathrm{rms}$, shifted", xlim=(0, 1), yticks=[])
    return figure


def caption(
    surface: Mapping[str, Mapping[str, xr.Dataset]], statistics: Mapping[str, Mapping[str, xr.Dataset]]
) -> str:
    """Moments of each surface, and the change of the kurtosis with the shortest wavelength."""
    kurtosis = [float(data["seed_kurtosis"].mean()) for data in statistics["kurtosis"].values()]
    errors = [
        float(data["kurtosis_error"]) for data in surface["kurtosis"].values() if "kurtosis_error" in data
    ]
    change = max(kurtosis) - min(kurtosis)
    scatter = max(errors, default=float("nan"))
    comparison = "less" if change < scatter else "not less"
    return bullets(
        [
            *height_moments(surface["skewness"], statistics["skewness"]),
            *height_moments(surface["kurtosis"], statistics["kurtosis"]),
            f"From one shortest wavelength to another the kurtosis changes by {change:.3f}, {comparison} "
            f"than the standard error of one sample ({scatter:.3f}): a Gaussian surface has a kurtosis of 3 "
            f"whatever its shortest wavelength.",
        ]
    )


def _with_moment(statistics: xr.Dataset, moment: str) -> str:
    """Label of a surface with its measured skewness or kurtosis, mean over seeds."""
    measured = float(statistics[f"seed_{moment}"].mean())
    return f"{label(statistics)}\n{moment} {measured:.2f}"
