"""Figures of speed and accuracy: error against time, errors by source, cost against grid size."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from asperity.study.config.presets import PRESETS
from asperity.study.cost.measured import MeasuredTradeoff
from asperity.study.cost.measurement import runs_at, seconds_of, settings_of
from asperity.study.cost.plan import measured_errors
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

SOURCE_LOOKS = {
    "discretisation": ("discretisation", "C0", "o"),
    "depths": ("planes in depth", "C1", "s"),
    "contact": ("contact solve", "C2", "^"),
    "half_space": ("half-space", "C4", "v"),
    "seeds": ("one surface for its kind", "k", "D"),
}
"""Source of error → its name, colour and marker."""

SMALLEST_ERROR = 1e-8
"""Left end of the axis of errors; smaller ones are drawn there."""

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
    shifts = np.linspace(-0.24, 0.24, len(SOURCE_LOOKS))
    for shift, (source, (label, colour, marker)) in zip(shifts, SOURCE_LOOKS.items(), strict=True):
        axis.plot([], [], marker, color=colour, ms=4, label=label)
        for row, name in enumerate(outputs):
            if (error := errors[name][source]) > 0:
                axis.plot(max(error, SMALLEST_ERROR), row + shift, marker, color=colour, ms=4)
    axis.set(
        xscale="log", xlim=(SMALLEST_ERROR, 1.0), xlabel="relative error", ylim=(len(outputs) - 0.5, -0.5)
    )
    axis.set_yticks(range(len(outputs)), [OUTPUT_LABELS[name] for name in outputs])
    axis.grid(axis="y", color="0.9", lw=0.6)
    axis.set_axisbelow(True)
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
    growing = runs.isel(run=runs["run_parameter"].values == "size").set_coords("run_points")
    for several, line in ((False, "-"), (True, "--")):
        part = growing.isel(run=(growing["run_ratios"].values > 1) == several)
        ratios, loads = int(part["run_ratios"].max()), int(part["run_loads"].max())
        label = f"{ratios} ν, {loads} loads" if several else "1 ν, 1 load"
        means = part.groupby("run_points").mean()
        for stage, colour in (("contact", "C0"), ("stress", "C1")):
            seconds = means[f"{stage}_seconds"]
            time.plot(means["run_points"], seconds, "o", ls=line, color=colour, label=f"{stage}, {label}")
        memory.plot(means["run_points"], means["peak_memory"] / 2**30, "o", ls=line, color="C2", label=label)
    points = np.unique(growing["run_points"].values)
    fastest = growing["contact_seconds"].values[growing["run_points"].values == points[-1]].min()
    law = points**2.0 * np.log(points)
    time.plot(points, 0.6 * fastest * law / law[-1], color="0.6", lw=0.8, label=r"$N^2 \log N$")
    for axis in (time, memory):
        axis.set(xscale="log", xlabel="nodes on an edge")
        axis.set_xticks(points, [str(tick) for tick in points])
        axis.set_xticks([], minor=True)
        axis.legend(handlelength=3, loc="upper left")
    time.set(yscale="log", ylabel="processor time (s)")
    memory.set(ylim=(0, None), ylabel="peak memory of the process (GiB)")
    return figure
