"""Cost and error bounds of a calculation before it is made, and the cheapest settings that reach a target.

A plan is chosen among all combinations of settings that were measured, with the error bounds of
`asperity.accuracy.bounds` and the costs of `asperity.accuracy.resources`.

`python -m asperity.accuracy.plan` prints the presets of accuracy with their measured times and errors.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from asperity.accuracy.bounds import SOURCES, error_bounds
from asperity.accuracy.evaluation import Scene
from asperity.accuracy.measured import load
from asperity.accuracy.outputs import OUTPUTS
from asperity.accuracy.resources import CALCULATION_STAGES, job_cost, time_factor
from asperity.accuracy.tables import describe_presets, minutes, percent
from asperity.config.presets import PRESETS, AccuracySettings, overlay
from asperity.errors import PlanError

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
        Of `asperity.accuracy.outputs.OUTPUTS`; all of them are to be within the error.
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
        Output → source → bound of the relative error.
    """

    accuracy: AccuracySettings
    seconds: float
    memory: float
    errors: Mapping[str, Mapping[str, float]]

    def error(self, outputs: Iterable[str]) -> float:
        """Largest total error bound of some outputs."""
        return max(sum(self.errors[name].values()) for name in outputs)


def check_outputs(outputs: Iterable[str]) -> None:
    """Raise `ValueError` for the first name that is not an output."""
    for name in outputs:
        if name not in OUTPUTS:
            raise ValueError(f"output = {name!r}: one of {', '.join(OUTPUTS)} is needed")


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
        `asperity.accuracy.resources.time_factor`.
    """
    factor = time_factor() if factor is None else factor
    costs = [scene_cost(scene, accuracy, factor) for scene in scenes]
    # Error bounds depend on these properties only.
    kinds = {(scene.wavelength_long, scene.area_fraction, scene.layer_height): scene for scene in scenes}
    bounds = [error_bounds(scene, accuracy, one_surface) for scene in kinds.values()]
    errors = {
        name: {source: max(each[name][source] for each in bounds) for source in SOURCES} for name in OUTPUTS
    }
    seconds = accuracy.seeds * sum(seconds for seconds, _ in costs)
    return Proposal(accuracy, seconds, max(memory for _, memory in costs), errors)


def candidates() -> list[AccuracySettings]:
    """Every combination of settings that were measured, for one seed."""
    errors = next(iter(load().errors.values()))
    half_space = PRESETS["paper"].half_space_tolerance
    numbers = [
        [float(setting) for setting in errors[parameter]]
        for parameter in ("points_per_wavelength", "contact_tolerance", "depth_tolerance", "depth_spacing")
    ]
    return [
        AccuracySettings(points, contact, precision, depth, spacing, half_space, 1)
        for points, contact, depth, spacing in itertools.product(*numbers)
        for precision in ("float64", "float32")
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
    affordable: list[Proposal] = []
    for accuracy in candidates():
        single = assess(scenes, accuracy, target.one_surface, factor)
        proposal = single if target.one_surface else _with_seeds(single, _seeds_needed(single, target))
        if proposal.seconds <= (target.seconds or math.inf) and proposal.memory <= (
            target.memory or math.inf
        ):
            affordable.append(proposal)
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
    errors = {
        name: {**sources, "seeds": sources["seeds"] / math.sqrt(seeds)}
        for name, sources in single.errors.items()
    }
    return Proposal(replace(single.accuracy, seeds=seeds), seeds * single.seconds, single.memory, errors)


def _seeds_needed(single: Proposal, target: Target) -> int:
    """Number of seeds that the error requires, or that the time allows."""
    if target.error is None:
        return 1 if target.seconds is None else max(1, min(MAX_SEEDS, int(target.seconds / single.seconds)))
    needed = 1
    for name in target.outputs:
        sources = single.errors[name]
        left = target.error - sum(bound for source, bound in sources.items() if source != "seeds")
        if left <= 0:
            return MAX_SEEDS
        needed = max(needed, math.ceil((sources["seeds"] / left) ** 2))
    return min(needed, MAX_SEEDS)


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
        *_yaml(overlay(accuracy, wavelengths)),
    ]
    return "\n".join(lines)


def _error_table(proposal: Proposal, outputs: Sequence[str], one_surface: bool) -> list[str]:
    """Lines of a table of the error bounds, one output a line and one source a column."""
    sources = [source for source in SOURCES if not (one_surface and source == "seeds")]
    rows = [["error at most", *(source.replace("_", "-") for source in sources), "together"]]
    for name in outputs:
        bounds = [proposal.errors[name][source] for source in sources]
        rows.append([name, *(percent(bound) for bound in [*bounds, sum(bounds)])])
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


def _yaml(keys: Mapping[str, Any]) -> list[str]:
    """Keys as lines of YAML, with the decimal point that YAML 1.1 requires before an exponent."""

    def text(value: Any) -> str:
        if isinstance(value, Mapping):
            return "{" + ", ".join(f"{key}: {text(entry)}" for key, entry in value.items()) + "}"
        if isinstance(value, float) and "e" in repr(value):
            mantissa, exponent = repr(value).split("e")
            return f"{mantissa if '.' in mantissa else mantissa + '.0'}e{exponent}"
        return str(value)

    return [f"{key}: {text(value)}" for key, value in keys.items()]


if __name__ == "__main__":
    print(describe_presets(load()))
