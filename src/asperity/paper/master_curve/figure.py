"""Figure of height and depth of the von Mises peaks over scales of the contact."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from asperity.paper.master_curve.analysis import DEPTH_SCALES, HEIGHT_SCALES, exponents, scatter
from asperity.views.style import panels

_MARKERS = ("o", "s", "^", "D")
_LENGTH = "ln depth_curvature_length"
_SHORT = {
    "height_gradient_contact": r"height / $E^*\bar{g}_r$",
    "height_gradient_whole": r"height / $E^*\bar{g}$",
    "height_contact_pressure": r"height / ($\bar{p}/A$)",
    "depth_pressure_length": r"depth / $\ell_p$",
    "depth_hydraulic_radius": r"depth / (2$A/\partial A$)",
    "depth_patch_radius": "depth / patch radius",
    "depth_curvature_length": r"depth / $\sqrt{m_2/m_4}$",
    "depth_height_length": r"depth / $\sqrt{m_0/m_2}$",
    "depth_wavelength": r"depth / $\lambda_s$",
}


def draw(rows: pd.DataFrame) -> Figure:
    """Draw height over E*ḡ_r, depth over λ_s, the curve of the depth, and the scatter of all scales.

    Parameters
    ----------
    rows : DataFrame
        As of `asperity.paper.master_curve.analysis.table`. Error bars are standard errors over seeds.
    """
    figure, axes = panels(2, 2)
    _draw_panel(axes[0], rows, "height_gradient_contact")
    _draw_panel(axes[1], rows, "depth_wavelength")
    _draw_curve(axes[2], rows)
    axes[0].legend(loc="lower right", ncols=2, fontsize="x-small")
    _draw_scatter(axes[3], rows)
    return figure


def _draw_panel(axis: Axes, rows: pd.DataFrame, key: str) -> None:
    """One number against the area."""
    _draw_points(axis, rows, rows["area"], key)
    axis.set(xscale="log", xlabel="area fraction $A$", ylabel=_SHORT[key])
    axis.set_ylim(bottom=0)
    axis.set_xticks([0.02, 0.05, 0.1, 0.2])
    _plain(axis.xaxis)


def _draw_curve(axis: Axes, rows: pd.DataFrame) -> None:
    """Depth over λ_s against √(m₂/m₄)_r over λ_s, with the power law that all Poisson's ratios share."""
    length = rows["depth_wavelength"] / rows["depth_curvature_length"]
    _draw_points(axis, rows, length, "depth_wavelength")
    power = exponents(rows, "depth_wavelength", [_LENGTH])[_LENGTH].value
    ends = np.array([length.min(), length.max()])
    for colour, (_, some) in enumerate(rows.groupby("poisson")):
        factor = np.exp(np.log(some["depth_wavelength"] / length[some.index] ** power).mean())
        axis.plot(ends, factor * ends**power, color=f"C{colour}", lw=0.8)
    axis.set(xscale="log", yscale="log", xlabel=r"$\sqrt{m_2/m_4}$ over contact / $\lambda_s$")
    axis.set_ylabel(_SHORT["depth_wavelength"])
    axis.set_xticks([0.12, 0.15, 0.2, 0.25, 0.3])
    axis.set_yticks([0.1, 0.15, 0.2, 0.25, 0.3])
    for one in (axis.xaxis, axis.yaxis):
        _plain(one)


def _draw_points(axis: Axes, rows: pd.DataFrame, along: pd.Series, key: str) -> None:
    """Points with their errors: a colour for each Poisson's ratio, a marker for each kind of surface."""
    kinds = [(f"$H$ = {hurst:g}", (rows["hurst"] == hurst) & ~rows["skewed"]) for hurst in (0.2, 0.5, 0.8)]
    kinds.append(("skewed", rows["skewed"]))
    ratios = sorted(rows["poisson"].unique())
    for marker, (name, chosen) in zip(_MARKERS, kinds, strict=True):
        for colour, poisson in enumerate(ratios):
            some = rows[chosen & (rows["poisson"] == poisson)]
            axis.errorbar(
                along[some.index],
                some[key],
                some[f"{key}_error"],
                fmt=marker,
                ms=3,
                lw=0.7,
                color=f"C{colour}",
            )
        axis.plot([], [], marker, color="0.4", ms=3, ls="none", label=name)
    for colour, poisson in enumerate(ratios):
        axis.plot([], [], color=f"C{colour}", label=rf"$\nu$ = {poisson:g}")


def _plain(axis: Axis) -> None:
    """Numbers in plain digits at the chosen ticks of a logarithmic axis alone."""
    axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def _draw_scatter(axis: Axes, rows: pd.DataFrame) -> None:
    """Scatter of every scale as a bar, with its standard error; pale with a fitted power of ℓ/λ_s."""
    order = [*HEIGHT_SCALES, *DEPTH_SCALES]
    for place, key in enumerate(order):
        colour = "C0" if key in HEIGHT_SCALES else "C1"
        found = scatter(rows, key)
        axis.barh(
            place - 0.2,
            100 * found.value,
            xerr=100 * found.error,
            color=colour,
            height=0.4,
            error_kw={"lw": 1},
        )
        if key in DEPTH_SCALES and key != "depth_wavelength":
            found = scatter(rows, "depth_wavelength", [f"ln {key}"])
            axis.barh(
                place + 0.2,
                100 * found.value,
                xerr=100 * found.error,
                color=colour,
                alpha=0.4,
                height=0.4,
                error_kw={"lw": 1},
            )
    axis.set_yticks(range(len(order)), [_SHORT[key] for key in order], fontsize="x-small")
    axis.invert_yaxis()
    axis.set_xlabel("scatter, %")
    axis.set_xlim(0, 60)
