"""Figure of error against processor time: the multilevel method beside plain Monte Carlo."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from asperity.views.style import panels

_COLUMNS = 2


def draw(results: Mapping[str, xr.Dataset]) -> Figure:
    """Draw a panel for each result: standard error over the value against processor time.

    Parameters
    ----------
    results : mapping
        Title of a panel → dataset of `asperity.paper.ensemble.result.result`.
    """
    columns = min(_COLUMNS, len(results))
    figure, axes = panels(columns, -(-len(results) // columns))
    for axis in axes[len(results) :]:
        axis.remove()
    for axis, (title, data) in zip(axes, results.items(), strict=False):
        _draw_panel(axis, data)
        axis.set_title(title, fontsize="small")
    axes[0].legend(loc="lower left")
    return figure


def _draw_panel(axis: Axes, data: xr.Dataset) -> None:
    value = abs(float(data["estimate"]))
    kinds = (("plain_course", "plain Monte Carlo", "s", "C1"), ("course", "multilevel", "o", "C0"))
    end = max(float(data["plain_seconds_same_error"]), float(data["plain_seconds"])) * 1.5
    for prefix, name, marker, colour in kinds:
        seconds, error = data[f"{prefix}_seconds"].values, data[f"{prefix}_error"].values / value
        axis.plot(seconds, error, marker, color=colour, ms=4, label=name)
        line = np.array([seconds[-1], max(end, seconds[-1])]) if prefix == "plain_course" else seconds
        axis.plot(line, error[-1] * np.sqrt(seconds[-1] / line), color=colour, lw=0.8, ls="--")
    axis.axhline(abs(float(data["estimate_bias"])) / value, color="0.6", lw=0.8)
    axis.annotate(
        "bias",
        (1, abs(float(data["estimate_bias"])) / value),
        xycoords=("axes fraction", "data"),
        xytext=(-2, 2),
        textcoords="offset points",
        ha="right",
        fontsize="x-small",
        color="0.4",
    )
    axis.set(xscale="log", yscale="log", xlabel="processor time, s", ylabel="standard error over value")
    axis.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda part, _: f"{100 * part:g} %"))
    axis.yaxis.set_minor_formatter(NullFormatter())
