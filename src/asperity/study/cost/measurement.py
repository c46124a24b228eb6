"""Measurement of errors and costs of all settings of accuracy (`make tradeoff`).

Errors are separated by source: one parameter at a time is varied from a converged reference, on the same
surface (a seed is the same surface on every grid), and the outputs are compared. The discretisation is
compared with the finest grid. The other parameters, whose errors are far smaller, are compared with a
converged reference on the grid of the paper, which makes them cheap to measure. Whole combinations of
settings, the presets among them, are compared with the finest grid. The differences between surfaces of one
kind are measured over several seeds.

`measure` makes the runs, `reduce_runs` the errors and laws that are stored. Cost is processor time on one
thread, which other work on the machine disturbs least; the time of a Fourier transform at that moment is
stored with it. Unlike the other results of the study, these contain processor times.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.optimize import least_squares

from asperity.contact import solve
from asperity.core.system import peak_memory, reset_peak_memory
from asperity.core.types import Array, Progress
from asperity.study.config.presets import PRESETS, AccuracySettings
from asperity.study.cost.measured import DISTRIBUTIONS, NUMBERS, OUTPUTS, PARAMETERS, MeasuredTradeoff
from asperity.study.cost.model import CALCULATION_STAGES, TIME_LAWS, law_seconds, transform_seconds
from asperity.study.cost.scene import POISSON, Scene, solid_record, stage_settings
from asperity.study.stages.contact import solve_contact
from asperity.study.stages.seed_numbers import LEVELS, seed_statistics
from asperity.study.stages.solid import solid
from asperity.study.stages.stress import compute_stress
from asperity.study.stages.surface import make_surface

CONVERGED = AccuracySettings(8.0, 1e-9, "float64", 1e-7, 0.125, 0.05, 1)
"""Settings of the converged reference on the grid of the paper: so fine that their errors are negligible
against those measured."""

VARIED: dict[str, tuple[Any, ...]] = {
    "contact_tolerance": (1e-3, 1e-4, 1e-6),
    "precision": ("float32",),
    "depth_tolerance": (1e-1, 1e-2, 1e-3, 1e-4, 1e-6),
    "depth_spacing": (4.0, 2.0, 1.0, 0.5, 0.25),
}
"""Parameters that are varied from the converged reference → their settings, coarsest first."""

SINGLE_PRECISION_TOLERANCE = 1e-6
"""Contact tolerance at which single precision is measured, the smallest that it accepts."""

LAYER_HEIGHTS = (0.5, 0.75, 1.0)
"""Heights, in cell lengths, of the layers that are replaced by a half-space."""

MIXTURES = {
    "coarse": replace(
        CONVERGED, contact_tolerance=1e-3, precision="float32", depth_tolerance=1e-2, depth_spacing=1.0
    ),
    "even": replace(CONVERGED, contact_tolerance=1e-4, depth_tolerance=1e-2, depth_spacing=0.5),
    "fine": replace(CONVERGED, contact_tolerance=1e-6, depth_tolerance=1e-4, depth_spacing=0.25),
}
"""Combinations of the settings other than the grid, each calculated on every grid."""

SEEDS = range(1, 9)
"""Seeds over which surfaces of one kind are compared."""

POISSON_RATIOS = (0.0, 0.25, 0.33, 0.5)
"""Poisson's ratios with which the cost of several is measured."""

LOADS = (0.02, 0.04, 0.07)
"""Further area fractions with which the cost of several loads is measured."""


Run = dict[str, Any]
"""A row of the measurement: what was varied and how, the scene, the settings, costs, outputs and errors."""


def measure(
    hurst: Sequence[float],
    area_fractions: Sequence[float],
    seeds: Sequence[int],
    wavelength_long: float,
    wavelength_short: float,
    points_per_wavelength: Sequence[float],
    sizes: Sequence[int],
    progress: Progress | None = None,
) -> xr.Dataset:
    """Measure errors and costs of every parameter, of combinations of settings, and of growing grids.

    The arguments but the last are a section ``tradeoff`` of the configuration.

    Parameters
    ----------
    hurst, area_fractions, seeds : sequences
        Scenes: every combination of them.
    wavelength_long, wavelength_short : float
        Of the scenes.
    points_per_wavelength : sequence of float
        Grids, rising; the last is the reference.
    sizes : sequence of int
        Nodes on an edge of growing cells, whose cost is measured at the settings of the paper.
    progress : callable, optional

    Returns
    -------
    dataset
        Along `run`, the parameter that was varied, all settings, and the cost; along `output`, values and
        errors.
    """
    kinds = [Scene(h, wavelength_long, wavelength_short, area) for h in hurst for area in area_fractions]
    _compile(hurst[0])
    groups = [_varied_settings(replace(kind, seed=n), points_per_wavelength) for kind in kinds for n in seeds]
    groups += [*map(_varied_seeds, kinds), _growing_cells(hurst, sizes, wavelength_long)]
    runs: list[Run] = []
    for number, group in enumerate(groups):
        runs += group
        if progress is not None:
            progress(number + 1, len(groups))
    columns = {name: [run[name] for run in runs] for name in runs[0]}
    return xr.Dataset(
        {name: (("run", "output")[: np.ndim(values)], values) for name, values in columns.items()},
        coords={"output": list(OUTPUTS)},
    )


def _compile(hurst: float) -> None:
    """Compile all functions on a small scene before anything is timed."""
    paper = PRESETS["paper"]
    for accuracy in (paper, replace(paper, precision="float32"), replace(paper, depth_tolerance=1e-8)):
        evaluate(Scene(hurst, 1 / 4, 1 / 8, 0.1), accuracy)


def _varied_settings(scene: Scene, grids: Sequence[float]) -> Iterator[Run]:
    """Every parameter varied by itself, then combinations of settings."""
    finest = evaluate(scene, replace(CONVERGED, points_per_wavelength=grids[-1]))
    yield _run("", "", finest)
    for points in grids[:-1]:
        accuracy = replace(CONVERGED, points_per_wavelength=points)
        yield _compared(finest, "points_per_wavelength", points, accuracy)
    converged = evaluate(scene, CONVERGED)
    yield _run("", "", converged)
    for parameter, settings in VARIED.items():
        for setting in settings:
            accuracy = replace(CONVERGED, **{parameter: setting})
            if setting == "float32":
                accuracy = replace(accuracy, contact_tolerance=SINGLE_PRECISION_TOLERANCE)
            yield _compared(converged, parameter, setting, accuracy)
    for height in LAYER_HEIGHTS:
        yield _half_space(replace(scene, layer_height=height))
    for name, preset in PRESETS.items():
        if preset.points_per_wavelength < grids[-1]:
            yield _compared(finest, "accuracy", name, preset)
    for points in grids[:-1]:
        for name, mixture in MIXTURES.items():
            accuracy = replace(mixture, points_per_wavelength=points)
            yield _compared(finest, "mixture", f"{name} {points:g}", accuracy)


def _compared(reference: Evaluation, parameter: str, setting: object, accuracy: AccuracySettings) -> Run:
    """The scene of a reference evaluated at other settings, and its errors against the reference."""
    evaluation = evaluate(reference.scene, accuracy, reference.mean_pressure)
    return _run(parameter, str(setting), evaluation, output_errors(evaluation, reference))


def _half_space(scene: Scene) -> Run:
    """The half-space in place of a layer; the setting is the smallest tolerance that allows it."""
    layer = evaluate(scene, replace(CONVERGED, half_space_tolerance=0.0))
    bound = float(solid_record(scene, CONVERGED)["solid_bound"])
    accuracy = replace(CONVERGED, half_space_tolerance=bound)
    return _compared(layer, "half_space_tolerance", f"{bound:.3g}", accuracy)


def _varied_seeds(scene: Scene) -> Iterator[Run]:
    """Surfaces of one kind, each compared with the mean over their seeds."""
    evaluations = [evaluate(replace(scene, seed=seed), PRESETS["paper"]) for seed in SEEDS]
    values = [evaluation.values() for evaluation in evaluations]
    means = {name: np.mean([value[name] for value in values], axis=0) for name in OUTPUTS}
    # All have the same area, and their loads differ. The relative difference of the load at a given area is
    # nearly that of the area at a given load.
    load = np.mean([evaluation.mean_pressure for evaluation in evaluations])
    for evaluation, value in zip(evaluations, values, strict=True):
        errors = {name: difference(value[name], means[name]) for name in OUTPUTS}
        errors["area_fraction"] = float(load / evaluation.mean_pressure - 1)
        yield _run("seeds", "1", evaluation, errors)


def _growing_cells(hurst: Sequence[float], sizes: Sequence[int], wavelength_long: float) -> Iterator[Run]:
    """Growing cells at the settings of the paper: one load and Poisson's ratio, then several of both."""
    paper = PRESETS["paper"]
    for points in sizes:
        # On the largest grid only the last Hurst exponent, to save time.
        for h in hurst if points < max(sizes) else hurst[-1:]:
            scene = Scene(h, wavelength_long, paper.points_per_wavelength / points, 0.1)
            several = replace(scene, loads=LOADS, poisson=POISSON_RATIOS)
            yield from (_run("size", str(points), evaluate(each, paper)) for each in (scene, several))


def _run(
    parameter: str, setting: str, evaluation: Evaluation, errors: Mapping[str, float] | None = None
) -> Run:
    """Row of an evaluation; parameter and setting are empty for a reference."""
    scene, accuracy = evaluation.scene, evaluation.accuracy
    values, errors = evaluation.values(), errors or {}
    return {
        "run_parameter": parameter,
        "run_setting": setting,
        "run_seed": scene.seed,
        "run_hurst": scene.hurst,
        "run_wavelength_long": scene.wavelength_long,
        "run_wavelength_short": scene.wavelength_short,
        "run_area_fraction": scene.area_fraction,
        "run_points": accuracy.points(scene.wavelength_short),
        "run_ratios": len(scene.poisson),
        "run_loads": scene.number_of_loads,
        **{name: getattr(accuracy, name) for name in PARAMETERS},
        **evaluation.costs,
        "output_value": [np.nan if name in DISTRIBUTIONS else values[name] for name in OUTPUTS],
        "output_error": [errors.get(name, np.nan) for name in OUTPUTS],
    }


class Evaluation(NamedTuple):
    """Outputs and cost of one calculation from the surface to its statistics.

    Parameters
    ----------
    scene : Scene
    accuracy : AccuracySettings
        Settings of accuracy it was made with.
    statistics : dataset
        Of `asperity.study.stages.seed_numbers.seed_statistics`, at the Poisson's ratio `POISSON`.
    area_fraction : float
        Contact area fraction at the mean pressure of a reference, or that of the calculation itself.
    costs : mapping
        ``surface_seconds``, ``contact_seconds``, ``stress_seconds``, ``transform_seconds``,
        ``contact_pairs``, ``full_planes``, ``peak_memory``; described in `asperity.results.variables`.
    """

    scene: Scene
    accuracy: AccuracySettings
    statistics: xr.Dataset
    area_fraction: float
    costs: Mapping[str, float]

    @property
    def mean_pressure(self) -> float:
        """Load over nominal area."""
        return float(self.statistics["seed_mean_pressure"])

    def values(self) -> dict[str, Any]:
        """Every output: a number, or the quantiles of a distribution."""
        found = self.statistics
        values: dict[str, Any] = {
            name: float(found[variable].sel(where)) for name, (variable, where) in NUMBERS.items()
        }
        quantiles = found["seed_peak_quantile"]
        values |= {name: quantiles.sel(quantity=kind).values for name, kind in DISTRIBUTIONS.items()}
        return {"area_fraction": self.area_fraction, **values}


def evaluate(scene: Scene, accuracy: AccuracySettings, mean_pressure: float | None = None) -> Evaluation:
    """Calculate surface, contact, stress and statistics of a scene.

    Parameters
    ----------
    scene : Scene
    accuracy : AccuracySettings
    mean_pressure : float, optional
        Load at which the contact area is calculated too; its time is not counted in the cost.

    Raises
    ------
    ConvergenceError
        If the contact does not reach its tolerance.
    """
    settings = stage_settings(scene, accuracy)
    reset_peak_memory()
    clock = [time.process_time()]
    surface = make_surface(settings["surface"], scene.seed)
    clock.append(time.process_time())
    contact = solve_contact(surface, settings["layer"], settings["contact"])
    clock.append(time.process_time())
    stress = compute_stress(contact, settings["layer"], settings["stress"])
    clock.append(time.process_time())
    points = contact.sizes["x"]
    names = [f"{stage}_seconds" for stage in CALCULATION_STAGES]
    costs: dict[str, float] = dict(zip(names, np.diff(clock).tolist(), strict=True))
    costs["contact_pairs"] = contact.attrs["certificate_pairs"]
    costs["full_planes"] = float(np.sum((stress["plane_points"] / points) ** 2))
    costs["peak_memory"] = 1e6 * peak_memory()
    costs["transform_seconds"] = transform_seconds(points)
    area = float(contact["area_fraction"])
    if mean_pressure is not None:
        area = _area_at(mean_pressure, surface, contact, settings)
    statistics = seed_statistics(surface, contact, stress).sel(poisson=POISSON)
    return Evaluation(scene, accuracy, statistics, area, costs)


def output_errors(evaluation: Evaluation, reference: Evaluation) -> dict[str, float]:
    """Errors of all outputs against those of a reference, as of `difference`."""
    expected = reference.values()
    return {name: difference(value, expected[name]) for name, value in evaluation.values().items()}


def difference(found: Any, expected: Any) -> float:
    """Signed relative difference of two numbers, or the distance of two distributions.

    The distance is the mean one between equal quantiles, divided by the mean of the second distribution. The
    levels of the quantiles are `asperity.study.stages.seed_numbers.LEVELS`.
    """
    if np.ndim(found) == 0:
        return float(found / expected - 1)
    return float(np.trapezoid(np.abs(found - expected), LEVELS) / np.trapezoid(expected, LEVELS))


def _area_at(
    mean_pressure: float, surface: xr.Dataset, contact: xr.Dataset, settings: Mapping[str, Any]
) -> float:
    """Contact area fraction at a mean pressure, with a solved contact as the initial guess."""
    layer, _ = solid(settings["layer"])
    return solve(
        surface["height"].values,
        layer,
        mean_pressure=mean_pressure,
        rtol=settings["contact"]["tolerance"],
        dtype=settings["contact"]["precision"],
        initial=contact["pressure"].values,
    ).area_fraction


def reduce_runs(runs: xr.Dataset) -> MeasuredTradeoff:
    """Reduce the runs of `measure` to errors and laws."""
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


def _rounded(values: Any) -> list[float]:
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
