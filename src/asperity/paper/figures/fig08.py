"""Figure 8: load and area, and the distribution of the peaks of the contact pressure."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import erf

from asperity.paper.figures.cases import Datasets, bullets, finish_densities, of_surfaces, peak_density
from asperity.views.style import label, panels


def draw(statistics: Datasets) -> Figure:
    """Draw (a) the area fraction against load, with two theories, and (b) the density of the pressure peaks.

    Both are means over seeds with their bands.

    Notes
    -----
    Persson: a = erf(√2 P₀ / E* ḡ), doi 10.1063/1.1388626; Bush, Gibson and Thomas: a = √(2π) P₀ / E* ḡ,
    doi 10.1016/0043-1648(75)90145-3. Both are evaluated with the gradient of the real contact.
    """
    figure, (curve, peaks) = panels()
    _draw_load_area(curve, statistics)
    for case in of_surfaces(statistics):
        peak_density(peaks, case, "pressure", label=case.title)
    finish_densities(peaks, "t_3")
    return figure


def _draw_load_area(axis: Axes, statistics: Datasets) -> None:
    reach = 0.0
    for data, marker in zip(statistics.values(), "osD^", strict=False):
        load, low, high = (data[f"path_scaled_load{end}"].values for end in ("", "_low", "_high"))
        area = 100 * data["path_area_fraction"]
        band = [load - low, high - load] if np.isfinite(low).all() else None
        axis.errorbar(load, area, xerr=band, fmt=marker, mfc="none", capsize=2, label=label(data))
        reach = max(reach, float(load.max()))
    loads = np.linspace(0, reach, 200)
    axis.plot(loads, 100 * erf(np.sqrt(2) * loads), "k-", lw=0.9, label="Persson")
    axis.plot(loads, 100 * np.sqrt(2 * np.pi) * loads, "k--", lw=0.9, label="Bush, Gibson, Thomas")
    axis.set(
        xlabel=r"$P_0 / E^* \bar{g}_r$",
        ylabel="contact area fraction $a_r$ (%)",
        xlim=(0, None),
        ylim=(0, None),
    )
    axis.legend()


def caption(statistics: Datasets) -> str:
    """Ratio of area and load along the curve, and percentiles of the pressure peaks."""
    lines = []
    for case in of_surfaces(statistics):
        ratio = case.statistics["path_area_fraction"] / case.statistics["path_scaled_load"]
        lines.append(
            f"{case.name}: area fraction over scaled load from {float(ratio[0]):.3f} to "
            f"{float(ratio[-1]):.3f} (Persson 1.596, Bush, Gibson and Thomas 2.507, at small load); "
            f"{case.peak_percentiles('pressure')}"
        )
    return bullets(lines)
