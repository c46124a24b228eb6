"""Stability: rounding errors of the formulas of the layer, over q · height."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from asperity.core.types import Array
from asperity.views.style import panels

_COLOURS = {"printed": "#D55E00", "direct": "#56B4E9", "layer": "#000000"}
_NAMES = {
    "printed": "Eq. A.3, misprints corrected",
    "direct": "Eqs. 5–7 solved numerically",
    "layer": "this library",
}
_QUANTITIES = {"compliance": "compliance, free bottom", "bonded_stress": "stress, bonded bottom"}
_PRECISIONS = {"float64": "double precision", "float32": "single precision"}
_LIMITS = (1e-17, 1e5)
_LOST = 1.0
"""Relative error from which no digit is right; larger ones are drawn at it."""


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the largest error of each formula: a band for all Poisson's ratios, lines for two of them.

    Marks above an error of one show where a formula gives no finite number.
    """
    figure, axes = panels(columns=2, rows=2, height=58)
    quantities = [str(name) for name in dataset["quantity"].values]
    precisions = [str(name) for name in dataset["precision"].values]
    cells = [(quantity, precision) for quantity in quantities for precision in precisions]
    for axis, (quantity, precision) in zip(axes, cells, strict=True):
        _panel(axis, dataset["error"].sel(quantity=quantity, precision=precision))
        axis.set_title(f"{_QUANTITIES[quantity]}, {_PRECISIONS[precision]}", loc="center")
    for axis in axes[2:]:
        axis.set_xlabel(r"$q\, z_m$")
    for axis in axes[::2]:
        axis.set_ylabel("largest relative error")
    handles: list[Artist] = [Patch(color=_COLOURS[name], label=_NAMES[name]) for name in _COLOURS]
    # Two rows, filled column by column: an empty place keeps the Poisson's ratios together.
    handles.append(Patch(color="none", label=" "))
    for ratio, line, mark in _shown(dataset["poisson"].values):
        label = rf"$\nu = {ratio:g}$; mark: no finite number"
        handles.append(
            Line2D([], [], color="0.35", linestyle=line, marker=mark, ms=3.5, mew=0.8, label=label)
        )
    figure.legend(handles=handles, loc="outside lower center", ncols=3, handlelength=2.4)
    return figure


def caption(dataset: xr.Dataset) -> str:
    """Largest error of this library's formulas in both precisions."""
    error = dataset["error"].sel(formula="layer")
    return "\n".join(
        f"- largest error of this library in {precision}: {float(error.sel(precision=precision).max()):.1e}"
        for precision in map(str, error["precision"].values)
    )


def _panel(axis: Axes, error: xr.DataArray) -> None:
    """Draw the errors of one quantity in one precision."""
    x = error["scaled_wavenumber"].values
    level = 10 * _LOST
    for name, colour in _COLOURS.items():
        values = error.sel(formula=name).transpose("poisson", "scaled_wavenumber").values
        if np.isnan(values).all():
            continue
        # Where nothing is finite there is no band.
        floor = np.where(np.isnan(values), np.inf, values).min(axis=0)
        peak = np.where(np.isnan(values), -np.inf, values).max(axis=0)
        seen = np.isfinite(floor)
        low, high = np.clip(floor, _LIMITS[0], _LOST), np.clip(peak, _LIMITS[0], _LOST)
        axis.fill_between(x, low, high, where=seen, color=colour, alpha=0.18, linewidth=0)
        for ratio, line, mark in _shown(error["poisson"].values):
            curve = values[error["poisson"].values == ratio][0]
            axis.plot(x, np.clip(curve, _LIMITS[0], _LOST), color=colour, linestyle=line, linewidth=1.0)
            lost = x[np.isnan(curve)]
            if lost.size:
                axis.plot(lost, np.full(lost.size, level), mark, color=colour, ms=2.4, mew=0.6)
                level *= 10
    axis.set(xscale="log", yscale="log", ylim=_LIMITS, xlim=(x[0], x[-1]))
    axis.set_yticks([1e-16, 1e-12, 1e-8, 1e-4, 1.0])
    axis.axhline(_LOST, color="0.7", linewidth=0.5)


def _shown(ratios: Array) -> list[tuple[float, Any, Any]]:
    """The Poisson's ratio nearest to 0.33 and the largest one, with their lines and marks."""
    chosen = (ratios[np.argmin(np.abs(ratios - 0.33))], ratios.max())
    return [(float(r), line, mark) for r, line, mark in zip(chosen, ("-", "--"), ("x", "+"), strict=True)]
