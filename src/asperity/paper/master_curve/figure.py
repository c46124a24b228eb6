"""Figure of height and depth of the von Mises peaks over scales of the contact."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from asperity.paper.master_curve.analysis import DEPTH_SCALES, HEIGHT_SCALES, scatter
from asperity.views.style import panels

_MARKERS = ("o", "s", "^", "D")
_SHORT = {
    "height_gradient_contact": r"height / $E^*\bar{g}_r$",
    "height_gradient_whole": r"height / $E^*\bar{g}$",
    "height_contact_pressure": r"height / ($\bar{p}/A$)",
    "depth_pressure_length": r"depth / $\ell_p$",
    "depth_hydraulic_radius": "depth / (area / half boundary)",
    "depth_patch_radius": "depth / patch radius",
    "depth_curvature_length": r"depth / $\sqrt{m_2/m_4}$",
    "depth_height_length": r"depth / $\sqrt{m_0/m_2}$",
    "depth_wavelength": r"depth / $\lambda_s$",
}


def draw(rows: pd.DataFrame) -> Figure:
    """Draw height over E*ḡ_r, depth over λ_s and over ℓ_p against the area, and the scatter of all scales.

    Parameters
    ----------
    rows : DataFrame
        As of `asperity.paper.master_curve.analysis.table`. Error bars are standard errors over seeds.
    """
    figure, axes = panels(2, 2)
    shown = ("height_gradient_contact", "depth_wavelength", "depth_pressure_length")
    for axis, key in zip(axes, shown, strict=False):
        _draw_panel(axis, rows, key)
    axes[0].legend(loc="best", ncols=2, fontsize="x-small")
    _draw_scatter(axes[3], {key: 100 * scatter(rows, key).value for key in _SHORT}, rows)
    return figure


def _draw_panel(axis: Axes, rows: pd.DataFrame, key: str) -> None:
    """One number against the area: a colour for each Poisson's ratio, a marker for each kind of surface."""
    kinds = [(f"$H$ = {hurst:g}", (rows["hurst"] == hurst) & ~rows["skewed"]) for hurst in (0.2, 0.5, 0.8)]
    kinds.append(("skewed", rows["skewed"]))
    ratios = sorted(rows["poisson"].unique())
    for marker, (name, chosen) in zip(_MARKERS, kinds, strict=True):
        for colour, poisson in enumerate(ratios):
            some = rows[chosen & (rows["poisson"] == poisson)]
            axis.errorbar(
                some["area"], some[key], some[f"{key}_error"], fmt=marker, ms=3, lw=0.7, color=f"C{colour}"
            )
        axis.plot([], [], marker, color="0.4", ms=3, ls="none", label=name)
    for colour, poisson in enumerate(ratios):
        axis.plot([], [], color=f"C{colour}", label=rf"$\nu$ = {poisson:g}")
    axis.set(xscale="log", xlabel="area fraction $A$", ylabel=_SHORT[key])
    axis.set_ylim(bottom=0)
    axis.set_xticks([0.02, 0.05, 0.1, 0.2])
    axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())


def _draw_scatter(axis: Axes, values: Mapping[str, float], rows: pd.DataFrame) -> None:
    """Scatter of every scale as a bar, with its standard error."""
    order = [*HEIGHT_SCALES, *DEPTH_SCALES]
    errors = [100 * scatter(rows, key).error for key in order]
    colours = ["C0"] * len(HEIGHT_SCALES) + ["C1"] * len(DEPTH_SCALES)
    axis.barh(
        range(len(order)), [values[key] for key in order], xerr=errors, color=colours, alpha=0.7, height=0.7
    )
    axis.set_yticks(range(len(order)), [_SHORT[key] for key in order], fontsize="x-small")
    axis.invert_yaxis()
    axis.set_xlabel("scatter, %")
