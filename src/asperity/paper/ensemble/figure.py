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

    Points are measured from parts of the samples. The dashed lines fall as one over the root of the time;
    that of plain Monte Carlo has the variance of a seed on the finest grid that all levels show.

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
    axes[0].legend(loc="upper right")
    return figure


def _draw_panel(axis: Axes, data: xr.Dataset) -> None:
    value, bias = abs(float(data["estimate"])), abs(float(data["estimate_bias"] / data["estimate"]))
    reached, same = float(data["estimate_error"]) / value, float(data["plain_seconds_same_error"])
    kinds = (
        ("plain_course", "plain Monte Carlo", "s", "C1", same),
        ("course", "multilevel", "o", "C0", float(data["estimate_seconds"])),
    )
    for prefix, name, marker, colour, spent in kinds:
        seconds, error = data[f"{prefix}_seconds"].values, data[f"{prefix}_error"].values / value
        axis.plot(seconds, error, marker, color=colour, ms=4, label=name)
        line = np.array([seconds[0], max(spent * 1.5, seconds[-1])])
        axis.plot(line, reached * np.sqrt(spent / line), color=colour, lw=0.8, ls="--")
    axis.axhline(bias, color="0.6", lw=0.8)
    axis.annotate(
        "bias",
        (1, bias),
        xycoords=("axes fraction", "data"),
        xytext=(-2, 2),
        textcoords="offset points",
        ha="right",
        fontsize="x-small",
        color="0.4",
    )
    axis.set(xscale="log", yscale="log", xlabel="processor time, s", ylabel="standard error over value")
    for one, text in ((axis.xaxis, "{:g}"), (axis.yaxis, "{:g} %")):
        factor = 100 if one is axis.yaxis else 1
        one.set_major_locator(LogLocator(subs=(1, 2, 5)))
        one.set_major_formatter(FuncFormatter(lambda x, _, text=text, factor=factor: text.format(factor * x)))
        one.set_minor_formatter(NullFormatter())
