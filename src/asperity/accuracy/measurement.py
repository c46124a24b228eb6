"""Measurement of errors and costs of all settings of accuracy (`make tradeoff`).

Errors are separated by source: one parameter at a time is varied from a converged reference, on the same
surface (a seed is the same surface on every grid), and the outputs are compared. The discretisation is
compared with the finest grid. The other parameters, whose errors are far smaller, are compared with a
converged reference on the grid of the paper, which makes them cheap to measure. Whole combinations of
settings, the presets among them, are compared with the finest grid. The differences between surfaces of one
kind are measured over several seeds.

Unlike the other results of the study, these contain processor times.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import xarray as xr

from asperity.accuracy.evaluation import Evaluation, Scene, distance, evaluate, output_errors, solid_record
from asperity.accuracy.measured import PARAMETERS
from asperity.accuracy.outputs import NUMBERS, OUTPUTS
from asperity.config.presets import PRESETS, AccuracySettings
from asperity.types import Progress

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


@dataclass(frozen=True)
class Run:
    """One evaluation of the measurement.

    Parameters
    ----------
    parameter, setting : str
        Parameter that is varied and its setting; empty for a reference.
    evaluation : Evaluation
    errors : mapping
        Output → error; empty without a reference.
    """

    parameter: str
    setting: str
    evaluation: Evaluation
    errors: Mapping[str, float] = field(default_factory=dict)


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
    groups = [
        *(
            _varied_settings(replace(kind, seed=seed), points_per_wavelength)
            for kind in kinds
            for seed in seeds
        ),
        *(_varied_seeds(kind) for kind in kinds),
        _growing_cells(hurst, sizes, wavelength_long),
    ]
    runs: list[Run] = []
    for number, group in enumerate(groups):
        runs += group
        if progress is not None:
            progress(number + 1, len(groups))
    return _dataset(runs)


def _compile(hurst: float) -> None:
    """Compile all functions on a small scene before anything is timed."""
    paper = PRESETS["paper"]
    for accuracy in (paper, replace(paper, precision="float32"), replace(paper, depth_tolerance=1e-8)):
        evaluate(Scene(hurst, 1 / 4, 1 / 8, 0.1), accuracy)


def _varied_settings(scene: Scene, grids: Sequence[float]) -> Iterator[Run]:
    """Every parameter varied by itself, then combinations of settings."""
    finest = evaluate(scene, replace(CONVERGED, points_per_wavelength=grids[-1]))
    yield Run("", "", finest)
    for points in grids[:-1]:
        accuracy = replace(CONVERGED, points_per_wavelength=points)
        yield _compared(finest, "points_per_wavelength", points, accuracy)
    converged = evaluate(scene, CONVERGED)
    yield Run("", "", converged)
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
    mean_pressure = reference.mean_pressure
    evaluation = evaluate(reference.scene, accuracy, mean_pressure)
    return Run(parameter, str(setting), evaluation, output_errors(evaluation, reference))


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
    means = {name: float(np.mean([value[name] for value in values])) for name in NUMBERS}
    # All have the same area, and their loads differ. The relative difference of the load at a given area is
    # nearly that of the area at a given load.
    loads = [evaluation.mean_pressure for evaluation in evaluations]
    quantiles = [evaluation.quantiles() for evaluation in evaluations]
    mean_quantiles = {name: np.mean([each[name] for each in quantiles], axis=0) for name in quantiles[0]}
    for number, evaluation in enumerate(evaluations):
        errors = {name: values[number][name] / mean - 1 for name, mean in means.items()}
        errors["area_fraction"] = float(np.mean(loads)) / loads[number] - 1
        for name, mean in mean_quantiles.items():
            errors[name] = distance(quantiles[number][name], mean)
        yield Run("seeds", "1", evaluation, errors)


def _growing_cells(hurst: Sequence[float], sizes: Sequence[int], wavelength_long: float) -> Iterator[Run]:
    """Growing cells at the settings of the paper: one load and Poisson's ratio, then several of both."""
    paper = PRESETS["paper"]
    for points in sizes:
        # On the largest grid only the last Hurst exponent, to save time.
        for h in hurst if points < max(sizes) else hurst[-1:]:
            scene = Scene(h, wavelength_long, paper.points_per_wavelength / points, 0.1)
            yield Run("size", str(points), evaluate(scene, paper))
            several = replace(scene, loads=LOADS, poisson=POISSON_RATIOS)
            yield Run("size", str(points), evaluate(several, paper))


_COLUMNS: dict[str, Callable[[Run], Any]] = {
    "run_parameter": lambda run: run.parameter,
    "run_setting": lambda run: run.setting,
    "run_seed": lambda run: run.evaluation.scene.seed,
    "run_hurst": lambda run: run.evaluation.scene.hurst,
    "run_wavelength_long": lambda run: run.evaluation.scene.wavelength_long,
    "run_wavelength_short": lambda run: run.evaluation.scene.wavelength_short,
    "run_area_fraction": lambda run: run.evaluation.scene.area_fraction,
    "run_points": lambda run: run.evaluation.accuracy.points(run.evaluation.scene.wavelength_short),
    "run_ratios": lambda run: len(run.evaluation.scene.poisson),
    "run_loads": lambda run: run.evaluation.scene.number_of_loads,
}


def _dataset(runs: Sequence[Run]) -> xr.Dataset:
    """All runs as one dataset."""
    columns = {name: [value_of(run) for run in runs] for name, value_of in _COLUMNS.items()}
    for name in PARAMETERS:
        columns[name] = [getattr(run.evaluation.accuracy, name) for run in runs]
    for name in runs[0].evaluation.costs:
        columns[name] = [run.evaluation.costs[name] for run in runs]
    values = [list(run.evaluation.values().values()) for run in runs]
    errors = [[run.errors.get(name, np.nan) for name in OUTPUTS] for run in runs]
    return xr.Dataset(
        {
            **{name: ("run", column) for name, column in columns.items()},
            "output_value": (("run", "output"), values),
            "output_error": (("run", "output"), errors),
        },
        coords={"output": list(OUTPUTS)},
    )
