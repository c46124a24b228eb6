"""Families: outcome and work of contacts of every family of surfaces with every level of every setting."""

import numpy as np
import pandas as pd
import xarray as xr
from extremes import FAILED, NOT_CONVERGED, OUTCOMES, REFUSED, WARNED, WRONG
from family_outcomes import SOLVED
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from asperity.views.style import MILLIMETRE, PAGE

_HEIGHT = 150 * MILLIMETRE
_COLOURS = {
    NOT_CONVERGED: ("#D55E00", "ConvergenceError"),
    WRONG: ("#000000", "silently wrong"),
    WARNED: ("#CC79A7", "floating-point warning"),
    FAILED: ("#E69F00", "another exception"),
    REFUSED: ("#BBBBBB", "refused by name"),
}
_AXES = {
    "shape": "nodes",
    "relief": "relief",
    "offset": "offset",
    "imposed": "imposed",
    "boundary": "boundary",
    "solid": "solid",
    "hardness": "hardness",
    "precision": "precision",
}
MOST = 10.0
"""Allowed multiple of the median time per node on the same grid."""


def draw(data: xr.Dataset) -> Figure:
    """Draw outcomes and relative times of all contacts, and below them the time per node on each grid."""
    figure = Figure(figsize=(PAGE, _HEIGHT))
    axis, times = figure.subplots(2, 1, height_ratios=(3, 2))
    outcome, solved = data["outcome"].values, np.isin(data["outcome"].values, SOLVED)
    image = axis.pcolormesh(
        np.ma.masked_array(data["multiple"].values, ~solved),
        cmap="cividis",
        norm=LogNorm(1 / MOST, MOST),
        rasterized=True,
    )
    handles = []
    for number, (colour, text) in _COLOURS.items():
        found = outcome == number
        handles.append(Patch(color=colour, label=f"{text}: {found.sum()}"))
        for row, column in np.argwhere(found):
            axis.add_patch(Rectangle((column, row), 1, 1, color=colour, linewidth=0))
    _name_levels(axis, data)
    bar = figure.colorbar(image, ax=axis, pad=0.01, aspect=30, extend="both")
    bar.set_label("time per node over the median", fontsize=6)
    bar.ax.tick_params(labelsize=5)
    shapes = shapes_by_size(data)
    for place, shape in enumerate(shapes):
        values = data["microseconds"].values[solved & (data["shape"].values == shape)]
        median = np.median(values)
        across = place + np.linspace(-0.3, 0.3, values.size)
        times.plot(across, values, ".", color="#0072B2", markersize=1.5, rasterized=True)
        for multiple, line in ((1, "-"), (MOST, "--")):
            times.plot(
                [place - 0.4, place + 0.4], [multiple * median] * 2, line, color="black", linewidth=0.8
            )
        times.annotate(f"{float(f'{median:.2g}'):g}", (place + 0.42, median), fontsize=5, va="center")
    times.set(yscale="log", ylabel="µs per node", xlim=(-0.6, len(shapes) - 0.2), xlabel="nodes")
    names = [shape.replace(" ", " × ") for shape in shapes]
    times.set_xticks(range(len(shapes)), names, fontsize=6)
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def caption(data: xr.Dataset) -> str:
    """Numbers of outcomes; no times, which differ from run to run."""
    outcome, on_sheet = data["outcome"].values, data["solid"].values == "sheet"
    found = {"contacts": outcome >= 0, "solved, and confirmed": np.isin(outcome, SOLVED)}
    found |= {OUTCOMES[number]: outcome == number for number in _COLOURS}
    lines = []
    for name, which in found.items():
        sheets = f", {np.sum(which & on_sheet)} of them on the sheet" if which.any() else ""
        lines.append(f"{name}: {which.sum()}{sheets}")
    return "\n".join(f"- {line}" for line in lines)


def times_by_grid(data: xr.Dataset) -> pd.DataFrame:
    """Number of solved contacts, median and largest time per node, and their ratio, of each grid."""
    solved, shapes = np.isin(data["outcome"].values, SOLVED), data["shape"].values
    rows = []
    for shape in shapes_by_size(data):
        times = data["microseconds"].values[solved & (shapes == shape)]
        median, largest = np.median(times), times.max()
        rows.append((shape, times.size, median, largest, largest / median))
    names = ["nodes", "contacts", "median_microseconds_per_node", "largest_microseconds_per_node"]
    return pd.DataFrame(rows, columns=[*names, "largest_over_median"])


def shapes_by_size(data: xr.Dataset) -> list[str]:
    """Shapes of the grids, from the fewest nodes to the most."""
    shapes, first = np.unique(data["shape"].values, return_index=True)
    return [str(shape) for shape in shapes[np.argsort(data["nodes"].values.ravel()[first])]]


def _name_levels(axis: Axes, data: xr.Dataset) -> None:
    """Write families and levels along the edges, and the names of the settings, with lines between them."""
    families, levels = data.sizes["family"], data.sizes["level"]
    axis.set(xlim=(0, levels), ylim=(families, 0))
    axis.set_xticks(np.arange(levels) + 0.5, data["level_value"].values, rotation=90)
    axis.set_yticks(np.arange(families) + 0.5, data["family"].values)
    axis.tick_params(length=0, labelsize=4.6, pad=1)
    axis.spines[["top", "right"]].set_visible(True)
    settings = [str(name) for name in data["level_axis"].values]
    for name in dict.fromkeys(settings):
        first = settings.index(name)
        last = first + settings.count(name)
        axis.axvline(last, color="0.3", linewidth=0.4)
        axis.text(0.5 * (first + last), -0.4, _AXES[name], ha="center", va="bottom", fontsize=6)
