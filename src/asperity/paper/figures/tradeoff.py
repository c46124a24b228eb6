"""The trade between speed and accuracy: error against time, the errors by source, and cost against size."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from asperity.accuracy.model import SOURCES, Measured, measured_errors
from asperity.config.presets import PRESETS
from asperity.paper.figures.style import MILLIMETRE, PAGE, panels
from asperity.types import Array

FRONT_OUTPUTS = {
    "von_mises_p99": "error of 99 %, von Mises peaks",
    "peak_depth": "error of the mean depth of peaks",
}
"""Outputs whose error is drawn against time."""

AREA_FRACTION = 0.1
"""At which the errors are drawn, that of the paper."""

NAMES = {
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
"""What figures and tables call the outputs."""

SOURCE_NAMES = {
    "discretisation": "discretisation",
    "depths": "planes in depth",
    "contact": "contact solve",
    "half_space": "half-space",
    "seeds": "one surface for its kind",
}
"""What figures and tables call the sources of error."""

_COLOURS = dict(zip(SOURCES, ("C0", "C1", "C2", "C4", "k"), strict=True))
_MARKS = dict(zip(SOURCES, ("o", "s", "^", "v", "D"), strict=True))
_MIXTURES = {"coarse": "v", "even": "o", "fine": "^"}
_PRESET_LOOK: dict[str, Any] = {"marker": "*", "ms": 9, "color": "k", "ls": "none"}
_LEAST = 1e-8


def draw(runs: xr.Dataset, measured: Measured) -> dict[str, Figure]:
    """All of them: name → figure.

    Parameters
    ----------
    runs : dataset
        Of `asperity.accuracy.measurement.measure`.
    measured : Measured
        Made from it.
    """
    paper = PRESETS["paper"]
    return {
        "front": draw_front(runs),
        "budget": draw_budget(measured_errors(paper, AREA_FRACTION, measured)),
        "growth": draw_growth(runs),
    }


def draw_front(runs: xr.Dataset) -> Figure:
    """Error against time of whole settings: mean of the magnitude over the scenes.

    Parameters
    ----------
    runs : dataset
        Of `asperity.accuracy.measurement.measure`.
    """
    figure, axes = panels(height=66)
    runs = runs.isel(run=runs["run_area_fraction"].values == AREA_FRACTION)
    seconds = runs["surface_seconds"] + runs["contact_seconds"] + runs["stress_seconds"]
    for axis, (output, title) in zip(axes, FRONT_OUTPUTS.items(), strict=True):
        wrong = np.abs(runs["output_error"].sel(output=output))
        found = {}
        for setting in _settings(runs, "mixture"):
            rows = _rows(runs, "mixture", setting)
            found[setting] = float(seconds[rows].mean()), float(wrong[rows].mean())
        for setting, place in found.items():
            name, points = setting.split()
            axis.plot(*place, _MIXTURES[name], color=_shade(float(points)), mec="none")
        for name in _settings(runs, "accuracy"):
            rows = _rows(runs, "accuracy", name)
            found[name] = place = float(seconds[rows].mean()), float(wrong[rows].mean())
            axis.plot(*place, **_PRESET_LOOK)
            axis.annotate(name, place, xytext=(4, 4), textcoords="offset points")
        best = np.array(sorted(found.values()))
        kept = best[:, 1] == np.minimum.accumulate(best[:, 1])
        axis.step(*best[kept].T, where="post", color="0.6", lw=0.8, zorder=0)
        axis.set(xscale="log", yscale="log", xlabel="processor time (s)", ylabel=title)
        # Less than two decades: labels of the powers of ten alone would be one or none.
        axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.xaxis.set_major_formatter("{x:g}")
        axis.xaxis.set_minor_formatter(NullFormatter())
    figure.legend(handles=_front_legend(runs), loc="outside lower center", ncols=5)
    return figure


def _front_legend(runs: xr.Dataset) -> list[Line2D]:
    shown = [
        Line2D([], [], marker=mark, color="0.4", ls="none", label=f"{name} depths and tolerances")
        for name, mark in _MIXTURES.items()
    ]
    points = sorted({float(setting.split()[1]) for setting in _settings(runs, "mixture")})
    shown += [
        Line2D([], [], marker="o", color=_shade(p), ls="none", label=rf"{p:g} points on $\lambda_s$")
        for p in points
    ]
    return [*shown, Line2D([], [], **_PRESET_LOOK, label="preset")]


def _shade(points: float) -> tuple[float, float, float, float]:
    """Grids from light to dark."""
    from matplotlib import colormaps

    return colormaps["viridis_r"](np.clip(np.log2(points / 2) / 4, 0.1, 1.0))


def draw_budget(errors: Mapping[str, Mapping[str, float]]) -> Figure:
    """Errors of every output by source, at one choice of settings; what is exactly zero is left out.

    Parameters
    ----------
    errors : mapping
        Output → source → error.
    """
    figure = Figure(figsize=(PAGE, 76 * MILLIMETRE))
    axis = figure.add_subplot()
    outputs = [name for name in NAMES if name in errors]
    for row, name in enumerate(outputs):
        for source, shift in zip(SOURCES, np.linspace(-0.24, 0.24, len(SOURCES)), strict=True):
            value = errors[name][source]
            if value > 0:
                axis.plot(max(value, _LEAST), row + shift, _MARKS[source], color=_COLOURS[source], ms=4)
    axis.set(xscale="log", xlim=(_LEAST, 1.0), xlabel="relative error", ylim=(len(outputs) - 0.5, -0.5))
    axis.set_yticks(range(len(outputs)), [NAMES[name] for name in outputs])
    axis.grid(axis="y", color="0.9", lw=0.6)
    axis.set_axisbelow(True)
    for source in SOURCES:
        axis.plot([], [], _MARKS[source], color=_COLOURS[source], ms=4, label=SOURCE_NAMES[source])
    figure.legend(loc="outside lower center", ncols=5)
    return figure


def draw_growth(runs: xr.Dataset) -> Figure:
    """Time of the stages (a) and memory (b) over the nodes on an edge, at the settings of the paper.

    Parameters
    ----------
    runs : dataset
        Of `asperity.accuracy.measurement.measure`.
    """
    figure, (time, memory) = panels(height=60)
    rows = runs["run_knob"].values == "size"
    ratios, loads = runs["run_ratios"].values, runs["run_loads"].values
    for several, line in ((False, "-"), (True, "--")):
        chosen = rows & ((ratios > 1) == several)
        label = f"{ratios[chosen].max()} ν, {loads[chosen].max()} loads" if several else "1 ν, 1 load"
        for stage, colour in (("contact", "C0"), ("stress", "C1")):
            place = _mean_by_points(runs, f"{stage}_seconds", chosen)
            time.plot(*place, "o", ls=line, color=colour, label=f"{stage}, {label}")
        points, used = _mean_by_points(runs, "peak_memory", chosen)
        memory.plot(points, used / 2**30, "o", ls=line, color="C2", label=label)
    _square_law(time, runs, rows)
    for axis in (time, memory):
        ticks = sorted(set(runs["run_points"].values[rows].tolist()))
        axis.set(xscale="log", xlabel="nodes on an edge")
        axis.set_xticks(ticks, [str(tick) for tick in ticks])
        axis.set_xticks([], minor=True)
        axis.legend(handlelength=3, loc="upper left")
    time.set(yscale="log", ylabel="processor time (s)")
    memory.set(ylim=(0, None), ylabel="peak memory of the process (GiB)")
    return figure


def _square_law(axis: Axes, runs: xr.Dataset, rows: Array) -> None:
    points = np.unique(runs["run_points"].values[rows])
    last = runs["contact_seconds"].values[rows & (runs["run_points"].values == points[-1])].min()
    law = points**2.0 * np.log(points)
    axis.plot(points, 0.6 * last * law / law[-1], color="0.6", lw=0.8, label=r"$N^2 \log N$")


def _mean_by_points(runs: xr.Dataset, name: str, chosen: Array) -> tuple[Array, Array]:
    points = runs["run_points"].values
    sizes = np.unique(points[chosen])
    return sizes, np.array([runs[name].values[chosen & (points == size)].mean() for size in sizes])


def _settings(runs: xr.Dataset, knob: str) -> list[str]:
    return list(dict.fromkeys(map(str, runs["run_setting"].values[runs["run_knob"].values == knob])))


def _rows(runs: xr.Dataset, knob: str, setting: str) -> Array:
    return (runs["run_knob"].values == knob) & (runs["run_setting"].values == setting)
