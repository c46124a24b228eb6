"""Figure of κ and κ_r against Nayak's parameter."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from asperity.views.style import panels

_MARKERS = ("o", "s", "^", "D", "v", "P")
_SYMBOLS = {
    "kappa": r"$\kappa = A E^* \bar{g} / \bar{p}$",
    "kappa_r": r"$\kappa_r = A E^* \bar{g}_r / \bar{p}$",
}


def draw(rows: pd.DataFrame) -> Figure:
    """Draw κ and κ_r against α, a marker for each Hurst exponent and a colour for each load.

    Parameters
    ----------
    rows : DataFrame
        As of `asperity.paper.nayak.analysis.table`. Error bars are the standard errors.
    """
    figure, axes = panels(2, 1, height=75.0)
    low = min(float(rows[key].min()) for key in _SYMBOLS) - 0.05
    high = max(float(rows[key].max()) for key in _SYMBOLS) + 0.05
    for axis, (key, symbol) in zip(axes, _SYMBOLS.items(), strict=True):
        _draw_panel(axis, rows, key)
        axis.set(xscale="log", ylim=(low, high), xlabel=r"Nayak's parameter $\alpha$", ylabel=symbol)
        axis.set_xticks([2, 3, 5, 10, 20, 30])
        axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axis.xaxis.set_minor_formatter(NullFormatter())
    axes[1].legend(loc="upper right", ncols=2)
    return figure


def _draw_panel(axis: Axes, rows: pd.DataFrame, key: str) -> None:
    """Points with their errors, and the line of least squares of each load."""
    for colour, (_, of_load) in enumerate(rows.groupby("load")):
        name = f"$A$ = {of_load['area'].mean():.2g}"
        slope, constant = np.polyfit(of_load["ln_nayak"], of_load[key], 1)
        ends = of_load["nayak"].agg(["min", "max"]).to_numpy()
        axis.plot(ends, slope * np.log(ends) + constant, color=f"C{colour}", lw=0.8, label=name)
        for marker, (_, of_hurst) in zip(_MARKERS, of_load.groupby("hurst"), strict=False):
            axis.errorbar(
                of_hurst["nayak"],
                of_hurst[key],
                of_hurst[f"{key}_error"],
                fmt=marker,
                ms=3.5,
                color=f"C{colour}",
            )
    for marker, hurst in zip(_MARKERS, sorted(rows["hurst"].unique()), strict=False):
        axis.plot([], [], marker, color="0.4", ms=3.5, ls="none", label=f"$H$ = {hurst:g}")
