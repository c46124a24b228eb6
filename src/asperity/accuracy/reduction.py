"""Reduction of the runs of a measurement to the largest errors and to laws of time and memory."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import xarray as xr
from scipy.optimize import least_squares

from asperity.accuracy.measured import PARAMETERS, MeasuredTradeoff
from asperity.accuracy.outputs import OUTPUTS
from asperity.accuracy.resources import CALCULATION_STAGES, TIME_LAWS, law_seconds
from asperity.types import Array


def reduce_runs(runs: xr.Dataset) -> MeasuredTradeoff:
    """Reduce the runs of `asperity.accuracy.measurement.measure` to errors and laws."""
    areas = runs["run_area_fraction"].values
    by_area = {f"{area:g}": runs.isel(run=areas == area) for area in np.unique(areas)}
    by_area = {area: part for area, part in by_area.items() if settings_of(part, "contact_tolerance")}
    largest_area = list(by_area.values())[-1]
    ranges = {name: _range(runs[f"run_{name}"]) for name in ("hurst", "area_fraction", "wavelength_long")}
    ranges["points_per_wavelength"] = _range(runs["points_per_wavelength"])
    return MeasuredTradeoff(
        errors={
            area: {name: _largest_errors(part, name) for name in PARAMETERS if settings_of(part, name)}
            for area, part in by_area.items()
        },
        presets={
            name: {**errors, "seconds": _mean_seconds(largest_area, name)}
            for name, errors in _largest_errors(largest_area, "accuracy").items()
        },
        deviation={area: _deviation(part) for area, part in by_area.items()},
        time_laws={stage: _time_law(runs, stage) for stage in CALCULATION_STAGES},
        memory=_memory_law(runs),
        transform=_transform_time(runs),
        ranges=ranges,
    )


def settings_of(runs: xr.Dataset, parameter: str) -> list[str]:
    """Settings of a varied parameter, in the order of the runs."""
    return list(
        dict.fromkeys(map(str, runs["run_setting"].values[runs["run_parameter"].values == parameter]))
    )


def runs_at(runs: xr.Dataset, parameter: str, setting: str) -> xr.Dataset:
    """Runs in which a parameter was varied to one setting."""
    rows = (runs["run_parameter"].values == parameter) & (runs["run_setting"].values == setting)
    return runs.isel(run=rows)


def seconds_of(runs: xr.Dataset) -> Array:
    """Processor time of every run, from the surface to the stress."""
    return np.sum([runs[f"{stage}_seconds"].values for stage in CALCULATION_STAGES], axis=0)


def _range(column: xr.DataArray) -> list[float]:
    return [float(column.min()), float(column.max())]


def _largest_errors(runs: xr.Dataset, parameter: str) -> dict[str, dict[str, float]]:
    """Setting → output → largest magnitude of the error in any scene."""
    largest = {}
    for setting in settings_of(runs, parameter):
        errors = np.abs(runs_at(runs, parameter, setting)["output_error"].values)
        largest[setting] = dict(zip(OUTPUTS, _rounded(errors.max(axis=0)), strict=True))
    return largest


def _mean_seconds(runs: xr.Dataset, preset: str) -> float:
    return _rounded(seconds_of(runs_at(runs, "accuracy", preset)).mean(keepdims=True))[0]


def _deviation(runs: xr.Dataset) -> dict[str, float]:
    """Output → standard deviation of one surface from the mean over its seeds, all kinds pooled."""
    several = runs_at(runs, "seeds", "1")
    kinds = np.unique(several["run_hurst"]).size
    squares = np.sum(several["output_error"].values ** 2, axis=0)
    deviation = np.sqrt(squares / (several.sizes["run"] - kinds))
    return dict(zip(OUTPUTS, _rounded(deviation), strict=True))


def _rounded(values: Array) -> list[float]:
    """Values rounded to three digits."""
    return [float(f"{value:.3g}") for value in values]


def _time_law(runs: xr.Dataset, stage: str) -> dict[str, float]:
    """Parameters of the law of a time, by least squares of its logarithm over all runs."""
    names = ("log_constant", "log_per_node", *TIME_LAWS[stage])
    nodes = runs["run_points"].values.astype(float) ** 2
    seconds = np.maximum(runs[f"{stage}_seconds"].values, 1e-4)
    settings: Mapping[str, Array] = {
        "area_fraction": runs["run_area_fraction"].values,
        "loads": runs["run_loads"].values,
        "ratios": runs["run_ratios"].values,
        **{name: runs[name].values for name in PARAMETERS},
    }

    def residual(parameters: Array) -> Array:
        expected = law_seconds(dict(zip(names, parameters, strict=True)), nodes, settings)
        # The second part, with its small weight, makes powers of what was not varied zero.
        return np.append(np.log(expected / seconds), 1e-2 * parameters[2:])

    start = [math.log(1e-2), math.log(1e-7), *[0.0] * len(TIME_LAWS[stage])]
    return dict(zip(names, _rounded(least_squares(residual, start).x), strict=True))


def _memory_law(runs: xr.Dataset) -> tuple[float, float]:
    """Peak memory of a process and of every node, from the growing cells with several Poisson's ratios."""
    rows = (runs["run_parameter"].values == "size") & (runs["run_ratios"].values > 1)
    nodes, memory = runs["run_points"].values[rows] ** 2.0, runs["peak_memory"].values[rows]
    slope, base = np.polyfit(nodes, memory, 1, w=1 / memory)
    base, slope = _rounded(np.array([base, slope]))
    return base, slope


def _transform_time(runs: xr.Dataset) -> tuple[int, float]:
    """Largest grid of at most 512 nodes on an edge, and the median time of a pair of transforms on it."""
    points = runs["run_points"].values
    chosen = int(points[points <= 512].max())
    return chosen, float(f"{np.median(runs['transform_seconds'].values[points == chosen]):.3g}")
