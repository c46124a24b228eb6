"""Cost and error bounds of a calculation before it is made, and the cheapest settings that reach a target.

A plan is chosen among all combinations of settings that were measured. For each parameter of accuracy the
error bound of an output is the largest error measured in any scene, at the next coarser setting measured,
times a margin, and raised by the error of the reference itself. The bounds of the parameters are added. For
the mean over surfaces of one kind, a 95 % confidence interval from the spread of the seeds is added.

Errors are arrays over the outputs of `asperity.study.cost.measured.OUTPUTS`, one for each of `SOURCES`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
import yaml

from asperity.core.errors import PlanError
from asperity.core.types import Array
from asperity.study.config.presets import PRESETS, AccuracySettings, overlay
from asperity.study.cost.measured import OUTPUTS, ErrorsBySetting, MeasuredTradeoff, at_area, load
from asperity.study.cost.measurement import CONVERGED
from asperity.study.cost.model import CALCULATION_STAGES, job_cost, minutes, time_factor
from asperity.study.cost.scene import Scene, solid_record
from asperity.study.cost.tables import percent

PEAKS = ("pressure_p90", "pressure_p99", "von_mises_p90", "von_mises_p99")
"""Outputs that a plan is made for if none is named."""

MAX_SEEDS = 1000
"""Largest number of seeds that is proposed."""


@dataclass(frozen=True)
class Target:
    """Limits that a plan has to keep; at least one of error, time and memory.

    Parameters
    ----------
    outputs : names
        Of `asperity.study.cost.measured.OUTPUTS`; all of them are to be within the error.
    error : float, optional
        Largest relative error; the settings that take least time are proposed.
    seconds : float, optional
        Processor time for all scenes and seeds on one thread. Without an error, the settings with the
        smallest error are proposed.
    memory : float, optional
        Bytes of one process.
    one_surface : bool
        Errors of the surface of one seed; otherwise of the mean over all surfaces of its kind.

    Raises
    ------
    ValueError
        If an output is unknown, or no limit is given.
    """

    outputs: Sequence[str] = PEAKS
    error: float | None = None
    seconds: float | None = None
    memory: float | None = None
    one_surface: bool = False

    def __post_init__(self) -> None:
        check_outputs(self.outputs)
        if self.error is None and self.seconds is None and self.memory is None:
            raise ValueError("a target is needed: an error, a time or a memory")


@dataclass(frozen=True)
class Proposal:
    """Settings of accuracy with their cost and error bounds.

    Parameters
    ----------
    accuracy : AccuracySettings
    seconds : float
        Processor time on one thread for all scenes and seeds.
    memory : float
        Peak memory of one process in bytes.
    errors : mapping
        Source → bound of the relative error of every output.
    """

    accuracy: AccuracySettings
    seconds: float
    memory: float
    errors: Mapping[str, Array]

    def error(self, outputs: Iterable[str]) -> float:
        """Largest total error bound of some outputs."""
        return float(np.sum([*self.errors.values()], axis=0)[_places(outputs)].max())


def check_outputs(outputs: Iterable[str]) -> None:
    """Raise `ValueError` for the first name that is not an output."""
    for name in outputs:
        if name not in OUTPUTS:
            raise ValueError(f"output = {name!r}: one of {', '.join(OUTPUTS)} is needed")


def _places(outputs: Iterable[str]) -> list[int]:
    """Places of some outputs in arrays over all of them."""
    return [OUTPUTS.index(name) for name in outputs]


def scene_cost(scene: Scene, accuracy: AccuracySettings, factor: float = 1.0) -> tuple[float, float]:
    """Processor time (s) and peak memory (bytes) of one surface and one seed, from the spectrum to the peaks.

    The stages are calculated one after the other; the start of their processes is not counted.

    Parameters
    ----------
    scene : Scene
    accuracy : AccuracySettings
    factor : float
        Time on this machine over that on the machine of the measurement.
    """
    nodes = accuracy.points(scene.wavelength_short) ** 2
    repetitions = {"contact": scene.number_of_loads, "stress": len(scene.poisson)}
    costs = [
        job_cost(stage, nodes, repetitions.get(stage, 1), accuracy, scene.area_fraction)
        for stage in CALCULATION_STAGES
    ]
    return factor * sum(cost.calculation_seconds for cost in costs), max(cost.memory for cost in costs)


def assess(
    scenes: Sequence[Scene],
    accuracy: AccuracySettings,
    one_surface: bool = False,
    factor: float | None = None,
) -> Proposal:
    """Cost of all scenes and seeds, one after the other, and the largest error bounds of any of them.

    Parameters
    ----------
    scenes : sequence of Scene
    accuracy : AccuracySettings
    one_surface : bool
        As in `Target`.
    factor : float, optional
        Time on this machine over that on the machine of the measurement; by default
        `asperity.study.cost.model.time_factor`.
    """
    factor = time_factor() if factor is None else factor
    costs = [scene_cost(scene, accuracy, factor) for scene in scenes]
    # Error bounds depend on these properties only.
    kinds = {(scene.wavelength_long, scene.area_fraction, scene.layer_height): scene for scene in scenes}
    bounds = [error_bounds(scene, accuracy, one_surface) for scene in kinds.values()]
    errors = {source: np.max([each[source] for each in bounds], axis=0) for source in SOURCES}
    seconds = accuracy.seeds * sum(seconds for seconds, _ in costs)
    return Proposal(accuracy, seconds, max(memory for _, memory in costs), errors)


def candidates() -> list[AccuracySettings]:
    """Every combination of settings that were measured, for one seed."""
    errors = next(iter(load().errors.values()))
    names = ("points_per_wavelength", "contact_tolerance", "depth_tolerance", "depth_spacing")
    settings: list[list[Any]] = [[float(setting) for setting in errors[name]] for name in names]
    settings.append(["float64", "float32"])
    return [
        replace(PRESETS["paper"], **dict(zip((*names, "precision"), chosen, strict=True)))
        for chosen in itertools.product(*settings)
    ]


def propose(scenes: Sequence[Scene], target: Target, factor: float | None = None) -> Proposal:
    """The cheapest settings within an error, or the most accurate within a time and a memory.

    Parameters
    ----------
    scenes : sequence of Scene
        One or more; the settings are the same for all of them.
    target : Target
    factor : float, optional
        As in `assess`.

    Raises
    ------
    PlanError
        If no measured settings reach the target.
    """
    factor = time_factor() if factor is None else factor
    seconds, memory = target.seconds or math.inf, target.memory or math.inf
    found = [assess(scenes, accuracy, target.one_surface, factor) for accuracy in candidates()]
    if not target.one_surface:
        found = [_with_seeds(single, _seeds_needed(single, target)) for single in found]
    affordable = [each for each in found if each.seconds <= seconds and each.memory <= memory]
    if not affordable:
        raise PlanError("not within this time and memory, even with the coarsest settings that were measured")
    best = min(affordable, key=lambda proposal: proposal.error(target.outputs))
    if target.error is None:
        return best
    accurate = [proposal for proposal in affordable if proposal.error(target.outputs) <= target.error]
    if not accurate:
        raise PlanError(
            f"error = {target.error:g}: {best.error(target.outputs):.2g} is the least that measured settings "
            f"reach in {', '.join(target.outputs)}"
        )
    return min(accurate, key=lambda proposal: proposal.seconds)


def _with_seeds(single: Proposal, seeds: int) -> Proposal:
    """A proposal for one seed, extended to several."""
    errors = {**single.errors, "seeds": single.errors["seeds"] / math.sqrt(seeds)}
    return Proposal(replace(single.accuracy, seeds=seeds), seeds * single.seconds, single.memory, errors)


def _seeds_needed(single: Proposal, target: Target) -> int:
    """Number of seeds that the error requires, or that the time allows."""
    if target.error is None:
        return 1 if target.seconds is None else max(1, min(MAX_SEEDS, int(target.seconds / single.seconds)))
    chosen = _places(target.outputs)
    seeds = single.errors["seeds"][chosen]
    left = target.error - (np.sum([*single.errors.values()], axis=0)[chosen] - seeds)
    if np.any(left <= 0):
        return MAX_SEEDS
    return int(np.clip(np.ceil(np.max(seeds / left) ** 2), 1, MAX_SEEDS))


def report(
    proposal: Proposal, scenes: Mapping[str, Scene], outputs: Sequence[str], one_surface: bool = False
) -> str:
    """Text of a proposal: its cost, its error bounds by source, and the configuration keys that set it.

    Parameters
    ----------
    proposal : Proposal
    scenes : mapping
        Name of each surface → its scene.
    outputs : names
    one_surface : bool
        As in `Target`.

    Raises
    ------
    ValueError
        If an output is unknown.
    """
    check_outputs(outputs)
    accuracy = proposal.accuracy
    largest = max(accuracy.points(scene.wavelength_short) for scene in scenes.values())
    subject = "this very surface" if one_surface else "the mean of its kind, to 95 %"
    wavelengths = {name: scene.wavelength_short for name, scene in scenes.items()}
    lines = [
        f"{len(scenes)} {'surface' if len(scenes) == 1 else 'surfaces'}, {accuracy.seeds} "
        f"{'seed' if accuracy.seeds == 1 else 'seeds'}, at most {largest} x {largest} nodes",
        f"about {minutes(proposal.seconds)} on one thread, {proposal.memory / 2**30:.2f} GiB; "
        f"errors of {subject}",
        "",
        *_error_table(proposal, outputs, one_surface),
        "",
        "settings, to lay over a configuration:",
        *_range_warnings(scenes.values()),
        yaml.safe_dump(overlay(accuracy, wavelengths), default_flow_style=None, sort_keys=False).rstrip(),
    ]
    return "\n".join(lines)


def _error_table(proposal: Proposal, outputs: Sequence[str], one_surface: bool) -> list[str]:
    """Lines of a table of the error bounds, one output a line and one source a column."""
    bounds = pd.DataFrame(proposal.errors, index=OUTPUTS).loc[[*outputs]]
    bounds["together"] = bounds.sum(axis=1)
    shown = bounds.drop(columns="seeds") if one_surface else bounds
    rows = [["error at most", *(str(name).replace("_", "-") for name in shown)]]
    rows += [[name, *map(percent, row)] for name, row in zip(shown.index, shown.to_numpy(), strict=True)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]


def _range_warnings(scenes: Iterable[Scene]) -> list[str]:
    """YAML comments on properties of the scenes outside the measured range, where bounds are not reliable."""
    warnings = {}
    for scene in scenes:
        for name in ("hurst", "area_fraction"):
            low, high = load().ranges[name]
            value = getattr(scene, name)
            if not low <= value <= high:
                warnings[name] = f"# {name} = {value:g} is outside what was measured, {low:g} to {high:g}"
    return list(warnings.values())


SOURCES = ("discretisation", "depths", "contact", "half_space", "seeds")
"""Sources of error: grid, planes in depth, contact solve, half-space for the layer, sample of surfaces."""

SAFETY_FACTOR = 1.5
"""Bound over the largest error that was measured."""

GRID_ORDER = 0.8
"""Order of convergence with the grid (0.6 to 0.9 in docs/stress.md), from which the error of the finest grid
follows."""

STUDENT_95 = 2.36
"""Half-width of a 95 % confidence interval over the standard deviation: Student's t for the 8 seeds that were
measured."""


def error_bounds(
    scene: Scene,
    accuracy: AccuracySettings,
    one_surface: bool = False,
    measured: MeasuredTradeoff | None = None,
) -> dict[str, Array]:
    """Bounds of the relative errors: source → bound of every output, infinite where nothing was measured.

    Parameters
    ----------
    scene : Scene
    accuracy : AccuracySettings
    one_surface : bool
        Errors of the surface of this seed; otherwise of the mean over all surfaces of its kind.
    measured : MeasuredTradeoff, optional
        By default that of the package.
    """
    measured = measured or load()
    errors = at_area(measured.errors, scene.area_fraction)
    deviation = at_area(measured.deviation, scene.area_fraction)
    if errors is None or deviation is None:
        return dict.fromkeys(SOURCES, np.full(len(OUTPUTS), math.inf))
    largest_wavelength = measured.ranges["wavelength_long"][1]
    interval = STUDENT_95 * scene.wavelength_long / largest_wavelength / math.sqrt(accuracy.seeds)
    finest = measured.ranges["points_per_wavelength"][1]
    contact = _next_coarser("contact_tolerance", accuracy.contact_tolerance, errors)
    if accuracy.precision == "float32":
        contact = contact + _of_outputs(errors["precision"]["float32"])
    planes = _depth_spacing(accuracy, errors)
    return {
        "discretisation": SAFETY_FACTOR * _discretisation(accuracy.points_per_wavelength, finest, errors),
        "depths": SAFETY_FACTOR
        * (planes + _next_coarser("depth_tolerance", accuracy.depth_tolerance, errors)),
        "contact": SAFETY_FACTOR * contact,
        "half_space": SAFETY_FACTOR * _half_space(scene, accuracy, errors),
        "seeds": (0.0 if one_surface else interval) * _of_outputs(deviation),
    }


def _of_outputs(errors: Mapping[str, float]) -> Array:
    return np.array([errors[name] for name in OUTPUTS])


def measured_errors(
    accuracy: AccuracySettings, area_fraction: float, measured: MeasuredTradeoff
) -> dict[str, dict[str, float]]:
    """Largest errors measured at settings that were measured, without factors: output → source → error.

    The error of the source ``seeds`` is the standard deviation of one surface from the mean of its kind.

    Raises
    ------
    ValueError
        If nothing was measured at this or a smaller area fraction.
    """
    errors, deviation = at_area(measured.errors, area_fraction), at_area(measured.deviation, area_fraction)
    if errors is None or deviation is None:
        raise ValueError(f"area_fraction = {area_fraction:g}: not measured")
    half_space = errors["half_space_tolerance"]
    highest_layer = half_space[min(half_space, key=float)]

    def at(parameter: str, output: str) -> float:
        value = getattr(accuracy, parameter)
        return next(found[output] for setting, found in errors[parameter].items() if float(setting) == value)

    return {
        name: {
            "discretisation": at("points_per_wavelength", name),
            "depths": at("depth_spacing", name) + at("depth_tolerance", name),
            "contact": at("contact_tolerance", name),
            "half_space": highest_layer[name],
            "seeds": deviation[name],
        }
        for name in OUTPUTS
    }


def _next_coarser(parameter: str, value: float, errors: ErrorsBySetting) -> Array:
    """Errors at the next coarser setting that was measured; infinite if there is none."""
    if value == 0:
        return np.zeros(len(OUTPUTS))
    coarser = [setting for setting in errors[parameter] if float(setting) >= value * (1 - 1e-9)]
    if not coarser:
        return np.full(len(OUTPUTS), math.inf)
    return _of_outputs(errors[parameter][min(coarser, key=float)])


def _discretisation(points: float, finest: float, errors: ErrorsBySetting) -> Array:
    """Errors on the next coarser grid that was measured, raised by the error of the finest grid."""
    grids = errors["points_per_wavelength"]
    coarser = [setting for setting in grids if float(setting) <= points * (1 + 1e-9)]
    if not coarser:
        return np.full(len(OUTPUTS), math.inf)
    chosen = max(coarser, key=float)
    return _of_outputs(grids[chosen]) / (1 - (float(chosen) / finest) ** GRID_ORDER)


def _depth_spacing(accuracy: AccuracySettings, errors: ErrorsBySetting) -> Array:
    """Errors of the distance between planes over the shortest wavelength, raised by that of the reference."""
    spacing = accuracy.depth_spacing * CONVERGED.points_per_wavelength / accuracy.points_per_wavelength
    within = max(spacing, min(map(float, errors["depth_spacing"])))
    raised = spacing / within / (1 - CONVERGED.depth_spacing / within)
    return raised * _next_coarser("depth_spacing", within, errors)


def _half_space(scene: Scene, accuracy: AccuracySettings, errors: ErrorsBySetting) -> Array:
    """Errors of the half-space where it replaces the layer; zero where the layer is kept."""
    record = solid_record(scene, accuracy)
    bound = float(record["solid_bound"]) if record["solid"] == "half-space" else 0.0
    return _next_coarser("half_space_tolerance", bound, errors)
