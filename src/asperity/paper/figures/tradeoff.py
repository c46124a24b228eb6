"""Figures of speed and accuracy: error against time, errors by source, cost against grid size."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from asperity.core.types import Array
from asperity.study.config.presets import PRESETS
from asperity.study.cost.measured import MeasuredTradeoff
from asperity.study.cost.measurement import runs_at, seconds_of, settings_of
from asperity.study.cost.plan import SOURCES, measured_errors
from asperity.views.style import MILLIMETRE, PAGE, panels

FRONT_OUTPUTS = {
    "von_mises_p99": "error of 99 %, von Mises peaks",
    "peak_depth": "error of the mean depth of peaks",
}
"""Outputs whose error is drawn against time → label of the axis."""

AREA_FRACTION = 0.1
"""Area fraction at which the errors are drawn, that of the paper."""

OUTPUT_LABELS = {
    "area_fraction": "area at given load",
    "proportionality": r"$\kappa$",
    "gradient_rms_contact": r"$\bar{g}_r$",
    "pressure_p90": "pressure peaks, 90 %",
    "pressure_p99": "pressure peaks, 99 %",
    "pressure_distribution": "pressure peaks, distribution",
    "von_mises_p90": "von Mises peaks, 90 %",
    "von_mises_p99": "von Mises peaks, 99 %",
    "von_mises_distribution": "von Mises peaks, distribution",
    "largest_von_mises": "largest von Mises stress",
    "peak_depth": "mean depth of peaks",
    "decay_length_depth": "decay along depth (Eq. 22)",
    "decay_length_plane": "decay in the plane (Eq. 22)",
}

SOURCE_LABELS = {
    "discretisation": "discretisation",
    "depths": "planes in depth",
    "contact": "contact solve",
    "half_space": "half-space",
    "seeds": "one surface for its kind",
}

SMALLEST_ERROR = 1e-8
"""Left end of the axis of errors; smaller ones are drawn there."""

_COLOURS = dict(zip(SOURCES, ("C0", "C1", "C2", "C4", "k"), strict=True))
_MARKERS = dict(zip(SOURCES, ("o", "s", "^", "v", "D"), strict=True))
_MIXTURE_MARKERS = {"coarse": "v", "even": "o", "fine": "^"}
_PRESET_STYLE: dict[str, Any] = {"marker": "*", "ms": 9, "color": "k", "ls": "none"}


def draw(runs: xr.Dataset, measured: MeasuredTradeoff) -> dict[str, Figure]:
    """All figures by name: ``front``, ``budget`` and ``growth``.

    Parameters
    ----------
    runs : dataset
        Of `asperity.study.cost.measurement.measure`.
    measured : MeasuredTradeoff
        Reduced from it.
    """
    return {
        "front": draw_front(runs),
        "budget": draw_budget(measured_errors(PRESETS["paper"], AREA_FRACTION, measured)),
        "growth": draw_growth(runs),
    }


def draw_front(runs: xr.Dataset) -> Figure:
    """Error against time of combinations of settings and of presets, mean magnitude over the scenes.

    Parameters
    ----------
    runs : dataset
        Of `asperity.study.cost.measurement.measure`.
    """
    figure, axes = panels(height=66)
    runs = runs.isel(run=runs["run_area_fraction"].values == AREA_FRACTION)
    for axis, (output, label) in zip(axes, FRONT_OUTPUTS.items(), strict=True):
        mixtures = {
            name: _time_and_error(runs, "mixture", name, output) for name in settings_of(runs, "mixture")
        }
        presets = {
            name: _time_and_error(runs, "accuracy", name, output) for name in settings_of(runs, "accuracy")
        }
        for setting, place in mixtures.items():
            name, points = setting.split()
            axis.plot(*place, _MIXTURE_MARKERS[name], color=_shade(float(points)), mec="none")
        for name, place in presets.items():
            axis.plot(*place, **_PRESET_STYLE)
            axis.annotate(name, place, xytext=(4, 4), textcoords="offset points")
        by_time = np.array(sorted([*mixtures.values(), *presets.values()]))
        best = by_time[by_time[:, 1] == np.minimum.accumulate(by_time[:, 1])]
        axis.step(*best.T, where="post", color="0.6", lw=0.8, zorder=0)
        axis.set(xscale="log", yscale="log", xlabel="processor time (s)", ylabel=label)
        # The times span less than two decades: labels at powers of ten only would be one or none.
        axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.xaxis.set_major_formatter("{x:g}")
        axis.xaxis.set_minor_formatter(NullFormatter())
    figure.legend(handles=_front_legend(runs), loc="outside lower center", ncols=5)
    return figure


def _time_and_error(runs: xr.Dataset, parameter: str, setting: str, output: str) -> tuple[float, float]:
    """Mean processor time, and mean magnitude of the error of an output, at one setting."""
    chosen = runs_at(runs, parameter, setting)
    errors = np.abs(chosen["output_error"].sel(output=output).values)
    return float(seconds_of(chosen).mean()), float(errors.mean())


def _front_legend(runs: xr.Dataset) -> list[Line2D]:
    handles = [
        Line2D([], [], marker=marker, color="0.4", ls="none", label=f"{name} depths and tolerances")
        for name, marker in _MIXTURE_MARKERS.items()
    ]
    points = sorted({float(setting.split()[1]) for setting in settings_of(runs, "mixture")})
    handles += [
        Line2D([], [], marker="o", color=_shade(p), ls="none", label=rf"{p:g} points on $\lambda_s$")
        for p in points
    ]
    return [*handles, Line2D([], [], **_PRESET_STYLE, label="preset")]


def _shade(points: float) -> tuple[float, float, float, float]:
    """Colour of a grid: the finer, the darker."""
    return colormaps["viridis_r"](np.clip(np.log2(points / 2) / 4, 0.1, 1.0))


def draw_budget(errors: Mapping[str, Mapping[str, float]]) -> Figure:
    """Errors of every output by source at one choice of settings; errors that are exactly zero are left out.

    Parameters
    ----------
    errors : mapping
        Output → source → error.
    """
    figure = Figure(figsize=(PAGE, 76 * MILLIMETRE))
    axis = figure.add_subplot()
    outputs = [name for name in OUTPUT_LABELS if name in errors]
    for row, name in enumerate(outputs):
        for source, shift in zip(SOURCES, np.linspace(-0.24, 0.24, len(SOURCES)), strict=True):
            error = errors[name][source]
            if error > 0:
                place = max(error, SMALLEST_ERROR), row + shift
                axis.plot(*place, _MARKERS[source], color=_COLOURS[source], ms=4)
    axis.set(
        xscale="log", xlim=(SMALLEST_ERROR, 1.0), xlabel="relative error", ylim=(len(outputs) - 0.5, -0.5)
    )
    axis.set_yticks(range(len(outputs)), [OUTPUT_LABELS[name] for name in outputs])
    axis.grid(axis="y", color="0.9", lw=0.6)
    axis.set_axisbelow(True)
    for source in SOURCES:
        axis.plot([], [], _MARKERS[source], color=_COLOURS[source], ms=4, label=SOURCE_LABELS[source])
    figure.legend(loc="outside lower center", ncols=5)
    return figure


def draw_growth(runs: xr.Dataset) -> Figure:
    """Time of the stages (a) and memory (b) against the nodes on an edge, at the settings of the paper.

    Parameters
    ----------
    runs : dataset
        Of `asperity.study.cost.measurement.measure`.
    """
    figure, (time, memory) = panels(height=60)
    growing = runs.isel(run=runs["run_parameter"].values == "size")
    for several, line in ((False, "-"), (True, "--")):
        part = growing.isel(run=(growing["run_ratios"].values > 1) == several)
        ratios, loads = int(part["run_ratios"].max()), int(part["run_loads"].max())
        label = f"{ratios} ν, {loads} loads" if several else "1 ν, 1 load"
        for stage, colour in (("contact", "C0"), ("stress", "C1")):
            means = _mean_by_points(part, f"{stage}_seconds")
            time.plot(*means, "o", ls=line, color=colour, label=f"{stage}, {label}")
        points, used = _mean_by_points(part, "peak_memory")
        memory.plot(points, used / 2**30, "o", ls=line, color="C2", label=label)
    _plot_square_law(time, growing)
    for axis in (time, memory):
        ticks = np.unique(growing["run_points"].values).tolist()
        axis.set(xscale="log", xlabel="nodes on an edge")
        axis.set_xticks(ticks, [str(tick) for tick in ticks])
        axis.set_xticks([], minor=True)
        axis.legend(handlelength=3, loc="upper left")
    time.set(yscale="log", ylabel="processor time (s)")
    memory.set(ylim=(0, None), ylabel="peak memory of the process (GiB)")
    return figure


def _plot_square_law(axis: Axes, growing: xr.Dataset) -> None:
    """A line N² log N below the times of the contact."""
    points = np.unique(growing["run_points"].values)
    largest = growing.isel(run=growing["run_points"].values == points[-1])
    law = points**2.0 * np.log(points)
    line = 0.6 * float(largest["contact_seconds"].min()) * law / law[-1]
    axis.plot(points, line, color="0.6", lw=0.8, label=r"$N^2 \log N$")


def _mean_by_points(runs: xr.Dataset, name: str) -> tuple[Array, Array]:
    """Nodes on an edge, and the mean of a variable over the runs on each grid."""
    points = runs["run_points"].values
    sizes = np.unique(points)
    return sizes, np.array([runs[name].values[points == size].mean() for size in sizes])
