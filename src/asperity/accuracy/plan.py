"""What a calculation will cost and how wrong it will be, before it is begun; and the cheapest that will do.

Errors are bounds from the measurement of `asperity.accuracy.measurement`: for each knob the largest error seen in any of
its scenes, at the next coarser setting that was measured, raised by a margin and by what the reference itself
was wrong. They are added up, and the spread of surfaces of one kind comes on top. Times follow laws
fitted to the same measurement, scaled to this machine by a transform that is timed on both.

`python -m asperity.accuracy.plan` prints what the presets of accuracy cost and how wrong they are.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from asperity.accuracy.measurement import EXACT, OUTPUTS, Scene, transform_seconds
from asperity.accuracy.model import (
    LAWS,
    SOURCES,
    Measured,
    describe_presets,
    features,
    load,
    nearest,
    percent,
    seconds_of,
)
from asperity.accuracy.resources import Need
from asperity.config.presets import PRESETS, AccuracySettings, overlay
from asperity.errors import PlanError
from asperity.pipeline.solid import solid

PEAKS = ("pressure_p90", "pressure_p99", "von_mises_p90", "von_mises_p99")
"""Outputs that a plan is made for if none is named."""

MARGIN = 1.5
"""Bounds are this much above the largest error that was measured."""

ORDER = 0.8
"""Order of convergence with the grid, from which the error of the finest grid follows; `docs/stress.md`."""

STUDENT = 2.36
"""Half-width of a 95 % interval over the deviation, known from as many seeds as were measured (Student)."""

MOST_SEEDS = 1000
"""More random surfaces than this are not proposed."""

Known = Mapping[str, Mapping[str, Mapping[str, float]]]


@dataclass(frozen=True)
class Cost:
    """Seconds of processor time on one thread, and bytes at the peak."""

    seconds: float
    memory: float


@dataclass(frozen=True)
class Proposal:
    """Settings, their cost for all surfaces and seeds, and the bound of every output's error by source."""

    knobs: AccuracySettings
    cost: Cost
    errors: Mapping[str, Mapping[str, float]]

    def error(self, outputs: Iterable[str]) -> float:
        """The largest total of some outputs."""
        return max(sum(self.errors[name].values()) for name in outputs)


def speed(measured: Measured | None = None) -> float:
    """Time of a transform here and now over that on the machine of the measurement."""
    points, seconds = (measured or load()).transform
    return transform_seconds(points, repetitions=7) / seconds


def predict_cost(
    scene: Scene,
    knobs: AccuracySettings,
    ratios: int = 1,
    measured: Measured | None = None,
    factor: float | None = None,
) -> Cost:
    """Processor time and memory of one surface and one seed, from its spectrum to its peaks.

    Parameters
    ----------
    scene : Scene
    knobs : AccuracySettings
    ratios : int
        Poisson's ratios analysed.
    measured : Measured, optional
        By default that of the package.
    factor : float, optional
        Time of a transform over that of the measurement, by default as timed here.
    """
    stages = stage_seconds(scene, knobs, ratios, measured, factor)
    base, slope = (measured or load()).memory
    return Cost(sum(stages.values()), base + slope * knobs.points(scene.wavelength_short) ** 2)


def stage_seconds(
    scene: Scene,
    knobs: AccuracySettings,
    ratios: int = 1,
    measured: Measured | None = None,
    factor: float | None = None,
) -> dict[str, float]:
    """The times of `predict_cost` stage by stage: surface, contact, stress."""
    laws = (measured or load()).laws
    settings = {
        **asdict(knobs),
        "area_fraction": scene.area_fraction,
        "loads": len({*scene.loads, scene.area_fraction}),
        "ratios": ratios,
    }
    points = knobs.points(scene.wavelength_short)
    factor = speed(measured) if factor is None else factor
    found = {}
    for name, needed in LAWS.items():
        powers = [laws[name][power] for power in ("start", "node", *needed)]
        powers_of = features(needed, settings) if needed else np.zeros(0)
        found[name.removesuffix("_seconds")] = factor * float(seconds_of(powers, points, powers_of))
    return found


def predict_errors(
    scene: Scene, knobs: AccuracySettings, one_surface: bool = False, measured: Measured | None = None
) -> dict[str, dict[str, float]]:
    """Bounds of the relative errors: output → source → bound, infinite where nothing was measured.

    Parameters
    ----------
    scene : Scene
    knobs : AccuracySettings
    one_surface : bool
        Of this very surface; else of the mean over all surfaces of its kind.
    measured : Measured, optional
        By default that of the package.
    """
    measured = measured or load()
    known = nearest(measured.errors, scene.area_fraction)
    deviation = nearest(measured.deviation, scene.area_fraction)
    if known is None or deviation is None:
        return {name: dict.fromkeys(SOURCES, math.inf) for name in OUTPUTS}
    spread = STUDENT * scene.wavelength_long / measured.scenes["wavelength_long"][1] / math.sqrt(knobs.seeds)
    finest = measured.scenes["points_per_wavelength"][1]
    parts = {
        "discretisation": [_discretisation(knobs.points_per_wavelength, finest, known)],
        "depths": [_depth_spacing(knobs, known), _next("depth_tolerance", knobs.depth_tolerance, known)],
        "contact": [_next("contact_tolerance", knobs.contact_tolerance, known)],
        "half_space": [_half_space(scene, knobs, known)],
    }
    if knobs.precision == "float32":
        parts["contact"].append(known["precision"]["float32"])
    found = {}
    for name in OUTPUTS:
        bounds = {source: MARGIN * sum(part[name] for part in several) for source, several in parts.items()}
        bounds["seeds"] = 0.0 if one_surface else spread * deviation[name]
        found[name] = bounds
    return found


def _scaled(errors: Mapping[str, float], factor: float) -> dict[str, float]:
    return {name: factor * value for name, value in errors.items()}


def _unknown() -> dict[str, float]:
    return dict.fromkeys(OUTPUTS, math.inf)


def _next(knob: str, value: float, known: Known) -> Mapping[str, float]:
    """Errors at the next coarser setting that was measured."""
    if value == 0:
        return dict.fromkeys(OUTPUTS, 0.0)
    coarser = [setting for setting in known[knob] if float(setting) >= value * (1 - 1e-9)]
    return known[knob][min(coarser, key=float)] if coarser else _unknown()


def _discretisation(points: float, finest: float, known: Known) -> Mapping[str, float]:
    """Errors on the next coarser grid that was measured, and of the finest grid it was held against."""
    grids = known["points_per_wavelength"]
    coarser = [setting for setting in grids if float(setting) <= points * (1 + 1e-9)]
    if not coarser:
        return _unknown()
    chosen = max(coarser, key=float)
    return _scaled(grids[chosen], 1 / (1 - (float(chosen) / finest) ** ORDER))


def _depth_spacing(knobs: AccuracySettings, known: Known) -> Mapping[str, float]:
    """Errors of the distance of the planes, which counts relative to the shortest wavelength."""
    spacing = knobs.depth_spacing * EXACT.points_per_wavelength / knobs.points_per_wavelength
    finest = min(known["depth_spacing"], key=float)
    within = max(spacing, float(finest))
    errors = _next("depth_spacing", within, known)
    return _scaled(errors, spacing / within / (1 - EXACT.depth_spacing / within))


def _half_space(scene: Scene, knobs: AccuracySettings, known: Known) -> Mapping[str, float]:
    """Errors of taking the half-space, where it is taken."""
    layer = {"height": scene.layer_height, "bottom": "bonded", "poisson": 0.33, "lateral": "confined"}
    record = solid({**layer, "half_space_tolerance": knobs.half_space_tolerance})[1]
    if record["solid"] != "half-space":
        return dict.fromkeys(OUTPUTS, 0.0)
    return _next("half_space_tolerance", float(record["solid_bound"]), known)


def candidates(measured: Measured) -> list[AccuracySettings]:
    """Every combination of settings that were measured, for one seed."""
    known = next(iter(measured.errors.values()))
    half_space = PRESETS["paper"].half_space_tolerance
    numbers = [
        [float(setting) for setting in known[knob]]
        for knob in ("points_per_wavelength", "contact_tolerance", "depth_tolerance", "depth_spacing")
    ]
    return [
        AccuracySettings(points, contact, precision, depth, spacing, half_space, 1)
        for points, contact, depth, spacing in itertools.product(*numbers)
        for precision in ("float64", "float32")
    ]


def assess(
    scenes: Sequence[Scene],
    knobs: AccuracySettings,
    ratios: int = 1,
    one_surface: bool = False,
    measured: Measured | None = None,
    factor: float | None = None,
) -> Proposal:
    """Cost of all scenes and seeds, one after the other, and the largest errors of any of them."""
    costs = [predict_cost(scene, knobs, ratios, measured, factor) for scene in scenes]
    # Errors depend on nothing else of a scene.
    kinds = {(scene.wavelength_long, scene.area_fraction, scene.layer_height): scene for scene in scenes}
    bounds = [predict_errors(scene, knobs, one_surface, measured) for scene in kinds.values()]
    errors = {
        name: {source: max(each[name][source] for each in bounds) for source in SOURCES} for name in OUTPUTS
    }
    seconds = knobs.seeds * sum(cost.seconds for cost in costs)
    return Proposal(knobs, Cost(seconds, max(cost.memory for cost in costs)), errors)


def propose(
    scenes: Sequence[Scene],
    outputs: Sequence[str] = PEAKS,
    error: float | None = None,
    seconds: float | None = None,
    memory: float | None = None,
    ratios: int = 1,
    one_surface: bool = False,
    measured: Measured | None = None,
) -> Proposal:
    """The cheapest settings within an error, or the most accurate within a time and a memory.

    Parameters
    ----------
    scenes : sequence of Scene
        One or more; the settings serve all of them.
    outputs : names
        Of `asperity.accuracy.measurement.OUTPUTS`; all of them are to be within the error.
    error : float, optional
        Largest relative error; the least time is sought.
    seconds : float, optional
        Processor time for all scenes and seeds on one thread. Without an error the least error is sought.
    memory : float, optional
        Bytes of one process.
    ratios : int
        Poisson's ratios analysed.
    one_surface : bool
        As in `predict_errors`; one seed then.
    measured : Measured, optional
        By default that of the package.

    Raises
    ------
    PlanError
        If nothing that was measured reaches the target.
    ValueError
        If an output is unknown, or no target is given.
    """
    _check_outputs(outputs)
    if error is None and seconds is None and memory is None:
        raise ValueError("a target is needed: an error, a time or a memory")
    measured = measured or load()
    factor = speed(measured)
    affordable: list[Proposal] = []
    for knobs in candidates(measured):
        single = assess(scenes, knobs, ratios, one_surface, measured, factor)
        number = 1 if one_surface else _seeds(single, outputs, error, seconds)
        found = _with_seeds(single, number)
        if found.cost.seconds <= (seconds or math.inf) and found.cost.memory <= (memory or math.inf):
            affordable.append(found)
    if not affordable:
        raise PlanError("not within this time and memory, even with the coarsest settings that were measured")
    best = min(affordable, key=lambda proposal: proposal.error(outputs))
    if error is None:
        return best
    good = [proposal for proposal in affordable if proposal.error(outputs) <= error]
    if not good:
        raise PlanError(
            f"error = {error:g}: {best.error(outputs):.2g} is the least that measured settings reach in "
            f"{', '.join(outputs)}"
        )
    return min(good, key=lambda proposal: proposal.cost.seconds)


def _check_outputs(outputs: Iterable[str]) -> None:
    for name in outputs:
        if name not in OUTPUTS:
            raise ValueError(f"output = {name!r}: one of {', '.join(OUTPUTS)} is needed")


def _with_seeds(single: Proposal, number: int) -> Proposal:
    """The same for several seeds."""
    errors = {
        name: {**sources, "seeds": sources["seeds"] / math.sqrt(number)}
        for name, sources in single.errors.items()
    }
    cost = replace(single.cost, seconds=number * single.cost.seconds)
    return Proposal(replace(single.knobs, seeds=number), cost, errors)


def _seeds(single: Proposal, outputs: Sequence[str], error: float | None, seconds: float | None) -> int:
    """As many seeds as the error needs, or as the time allows."""
    if error is None:
        return 1 if seconds is None else max(1, min(MOST_SEEDS, int(seconds / single.cost.seconds)))
    needed = 1
    for name in outputs:
        sources = single.errors[name]
        left = error - sum(value for source, value in sources.items() if source != "seeds")
        if left <= 0:
            return MOST_SEEDS
        needed = max(needed, math.ceil((sources["seeds"] / left) ** 2))
    return min(needed, MOST_SEEDS)


def report(
    proposal: Proposal, scenes: Mapping[str, Scene], outputs: Sequence[str], one_surface: bool = False
) -> str:
    """A proposal for a reader: cost, error by source, and the keys that set it.

    Parameters
    ----------
    proposal : Proposal
    scenes : mapping
        Name of each surface → its scene.
    outputs : names
    one_surface : bool
        What the errors are of.

    Raises
    ------
    ValueError
        If an output is unknown.
    """
    _check_outputs(outputs)
    knobs, cost = proposal.knobs, proposal.cost
    largest = max(knobs.points(scene.wavelength_short) for scene in scenes.values())
    of = "this very surface" if one_surface else "the mean of its kind, to 95 %"
    sources = [source for source in SOURCES if not (one_surface and source == "seeds")]
    rows = [["error at most", *(source.replace("_", "-") for source in sources), "together"]]
    for name in outputs:
        bounds = [proposal.errors[name][source] for source in sources]
        rows.append([name, *(percent(bound) for bound in [*bounds, sum(bounds)])])
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = [
        f"{len(scenes)} {'surface' if len(scenes) == 1 else 'surfaces'}, {knobs.seeds} "
        f"{'seed' if knobs.seeds == 1 else 'seeds'}, at most {largest} x {largest} nodes",
        f"about {_minutes(cost.seconds)} on one thread, {cost.memory / 2**30:.2f} GiB; errors of {of}",
        "",
        *("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows),
        "",
        "settings, to lay over a configuration:",
        *(_doubts(scenes.values())),
        *_yaml(overlay(knobs, {name: scene.wavelength_short for name, scene in scenes.items()})),
    ]
    return "\n".join(lines)


def _doubts(scenes: Iterable[Scene]) -> list[str]:
    """What of the scenes lies outside the measurement, where a bound is none."""
    found = {}
    for scene in scenes:
        for name in ("hurst", "area_fraction"):
            low, high = load().scenes[name]
            value = getattr(scene, name)
            if not low <= value <= high:
                found[name] = f"# {name} = {value:g} is outside what was measured, {low:g} to {high:g}"
    return list(found.values())


def _yaml(keys: Mapping[str, Any]) -> list[str]:
    """Keys as one line each; a number with an exponent has its decimal point."""

    def text(value: Any) -> str:
        if isinstance(value, Mapping):
            return "{" + ", ".join(f"{key}: {text(entry)}" for key, entry in value.items()) + "}"
        if isinstance(value, float) and "e" in repr(value):
            mantissa, exponent = repr(value).split("e")
            return f"{mantissa if '.' in mantissa else mantissa + '.0'}e{exponent}"
        return str(value)

    return [f"{key}: {text(value)}" for key, value in keys.items()]


def scene_of(config: Mapping[str, Any], name: str) -> Scene:
    """What the study presses, of an entry of ``surfaces`` of a complete configuration."""
    surface, contact = config["surfaces"][name], config["contact"]
    return Scene(
        hurst=surface["hurst"],
        wavelength_long=surface["wavelength_long"],
        wavelength_short=surface["wavelength_short"],
        area_fraction=contact["area_fraction"],
        layer_height=config["layer"]["height"],
        loads=tuple(contact["path_area_fractions"] if name in config["studies"]["hurst"] else ()),
    )


def announce(jobs: Sequence[tuple[str, Need]], cores: int) -> str:
    """What a run of the study will take: jobs, minutes and memory, in a few lines.

    Parameters
    ----------
    jobs : sequence of (rule, Need)
        All that is to be run, and what each needs on the machine of the measurement.
    cores : int
    """
    factor = speed()
    costs: dict[str, list[Cost]] = {}
    for rule, need in jobs:
        costs.setdefault(rule, []).append(Cost(factor * need.seconds, 1e6 * need.memory))
    every = [cost for several in costs.values() for cost in several]
    total, longest = sum(cost.seconds for cost in every), max(cost.seconds for cost in every)
    lines = [
        f"plan: {len(every)} jobs, about {_minutes(total)} of one processor, "
        f"{_minutes(max(total / cores, longest))} on {cores} {'core' if cores == 1 else 'cores'}, "
        f"at most {max(cost.memory for cost in every) / 2**30:.1f} GiB in one job"
    ]
    for rule, several in sorted(costs.items(), key=lambda item: -sum(cost.seconds for cost in item[1])):
        minutes = _minutes(sum(cost.seconds for cost in several))
        memory = max(cost.memory for cost in several) / 2**30
        lines.append(f"plan:   {rule:18}{len(several):5} jobs {minutes:>9} {memory:6.1f} GiB")
    return "\n".join(lines)


def _minutes(seconds: float) -> str:
    return f"{seconds / 60:.0f} min" if seconds >= 90 else f"{math.ceil(seconds)} s"


if __name__ == "__main__":
    print(describe_presets(load()))
