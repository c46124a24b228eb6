"""Seeds of every grid that bring the error of a number below a target, planned in rounds.

The first round is a pilot on the coarsest grids. Every further round estimates the number, its standard error
and its bias from what there is, and plans the seeds of the next round: more seeds, or a finer grid where the
bias is too large. The last round asks for nothing new. Times are those of the cost model, not measured ones:
the same configuration has the same plan on every machine.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity.accuracy.allocation import allocate
from asperity.accuracy.multilevel import bias, multilevel_mean
from asperity.accuracy.tables import minutes
from asperity.paper.ensemble.samples import Samples
from asperity.pipeline.blocks import SURFACE_ALONE, SURFACE_SEEDS, block_size
from asperity.types import Array

FEWEST_COARSE = 16
"""Fewest seeds on the coarsest grid of the pilot, for the slopes on the numbers of the surfaces alone."""

PILOT_GRIDS = 3
"""Grids of the pilot: as many as show the order of convergence."""

MOST_ROUNDS = 9
"""Rounds after which the result is taken as it is."""

LARGEST_GROWTH = 8
"""Largest growth of the seeds of a grid in one round: the variances of a pilot are uncertain."""

BIAS_SHARE = 0.5
"""Share of the squared error that the bias may have before a finer grid is added."""


@dataclass(frozen=True)
class Plan:
    """Seeds of every grid after one round.

    Parameters
    ----------
    round : int
        0 for the pilot.
    nodes : tuple of float
        Nodes on the shortest wavelength of each level, coarse to fine; the first is the surface alone.
    seeds : tuple of int
        Number of seeds of each level; they are 1, 2, 3, …
    used : tuple of bool
        Levels of the estimate; the others are too badly correlated, and only tell the bias.
    done : bool
        True if the round before has all of these seeds, so that the result can be taken from them.
    seconds : float
        Processor time of all seeds of the plan by the cost model; NaN for the pilot.
    plain_seconds : float
        The same for plain Monte Carlo on the finest grid, to the same standard error.
    text : tuple of str
        What the round found and plans, in lines for a reader.
    """

    round: int
    nodes: tuple[float, ...]
    seeds: tuple[int, ...]
    used: tuple[bool, ...]
    done: bool = False
    seconds: float = math.nan
    plain_seconds: float = math.nan
    text: tuple[str, ...] = ()

    def write(self, path: str | Path) -> None:
        """Write the plan as JSON."""
        text = json.dumps(self.as_entries(), indent=1, ensure_ascii=False)
        Path(path).write_text(f"{text}\n", encoding="utf-8")

    @classmethod
    def read(cls, path: str | Path) -> Plan:
        """The plan of a file."""
        return cls.of_entries(json.loads(Path(path).read_text(encoding="utf-8")))

    def as_entries(self) -> dict[str, Any]:
        """The plan as plain values; unknown times are None."""
        entries = {name: list(v) if isinstance(v, tuple) else v for name, v in asdict(self).items()}
        return {name: None if v != v else v for name, v in entries.items()}

    @classmethod
    def of_entries(cls, entries: Mapping[str, Any]) -> Plan:
        """The plan of `as_entries`."""
        known = {name: math.nan if v is None else v for name, v in entries.items()}
        values: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in known.items()}
        return cls(**values)


def pilot(nodes: Sequence[float], seeds: int, wavelengths: Sequence[float]) -> Plan:
    """The first plan: some seeds on the finest grid of the pilot, twice as many on each coarser one.

    Parameters
    ----------
    nodes : sequence of float
        Setting ``ensemble.nodes``.
    seeds : int
        Setting ``ensemble.pilot``.
    wavelengths : sequence of float
        Shortest wavelengths of the surfaces, which decide how many seeds share a job.
    """
    used = (float(SURFACE_ALONE), *map(float, nodes[:PILOT_GRIDS]))
    numbers = [seeds * 2 ** (len(used) - 1 - level) for level in range(1, len(used))]
    numbers[0] = max(numbers[0], FEWEST_COARSE)
    seeds_of_levels = _whole_blocks(used, [SURFACE_SEEDS, *numbers], wavelengths)
    return Plan(0, used, seeds_of_levels, (True,) * len(used))


def next_plan(
    plan: Plan,
    samples: Samples,
    times: Mapping[float, float],
    error: float,
    settings: Mapping[str, Any],
    wavelengths: Sequence[float],
) -> Plan:
    """The plan of the next round.

    Parameters
    ----------
    plan : Plan
        Of the round before.
    samples : Samples
        The number on every level, for the seeds of that plan.
    times : mapping
        Nodes on the shortest wavelength → processor time of one seed, of all grids that may be used.
    error : float
        Root of the mean squared error to reach, over the value: standard error and bias together.
    settings : mapping
        Section ``ensemble`` of the configuration.
    wavelengths : sequence of float
    """
    shift = bias(samples.nodes[1:], samples.values[1:]).value
    target = error * abs(multilevel_mean(samples.values).value)
    allowed = math.sqrt(max(target**2 - shift**2, (1 - BIAS_SHARE) * target**2))
    seconds = [times[n] for n in plan.nodes]
    allocation = allocate(samples.values, seconds, allowed, settings["pilot"])
    used = allocation.seeds > 0
    found = multilevel_mean(samples.first(np.where(used, plan.seeds, 0).tolist()).values)
    nodes, seeds = list(plan.nodes), list(plan.seeds)
    finer = [float(n) for n in settings["nodes"] if n > nodes[-1]]
    reached = found.error <= allowed and abs(shift) <= math.sqrt(BIAS_SHARE) * target
    if plan.round + 1 < MOST_ROUNDS and not reached:
        if finer and abs(shift) > math.sqrt(BIAS_SHARE) * target:
            nodes.append(finer[0])
            seeds.append(settings["pilot"])
            seconds.append(times[nodes[-1]])
            used = np.append(used, True)
        elif found.error > allowed:
            seeds = _more_seeds(np.array(plan.seeds), allocation.seeds, (found.error / allowed) ** 2)
    whole = _whole_blocks(nodes, seeds, wavelengths)
    done = whole == plan.seeds
    lines = [
        f"round {plan.round + 1}: {found.value:.5g}, standard error {abs(found.error / found.value):.2%}, "
        f"bias {shift / found.value:+.2%}, target {error:.2%} for both together"
    ]
    total = float(np.dot(whole, seconds))
    plain = allocation.plain_seconds * seconds[-1] / seconds[len(plan.seeds) - 1]
    if done:
        lines.append("target reached" if reached else "target not reached on the finest grid allowed")
    else:
        missing = total - float(np.dot(plan.seeds, seconds[: len(plan.seeds)]))
        lines.append("seeds: " + ", ".join(f"{grid_name(n)} {k}" for n, k in zip(nodes, whole, strict=True)))
        lines.append(
            f"{minutes(missing)} of one processor ahead, {minutes(total)} in all; plain Monte Carlo on "
            f"{grid_name(nodes[-1])}: {minutes(plain)}"
        )
    return Plan(plan.round + 1, tuple(nodes), whole, tuple(map(bool, used)), done, total, plain, tuple(lines))


def _more_seeds(present: Array, wanted: Array, growth: float) -> list[int]:
    """Seeds of the next round: those of the allocation, or more of all if there are that many already."""
    if np.all(wanted <= present):
        wanted = np.where(wanted > 0, np.ceil(present * min(growth, 2.0)), 0).astype(int)
    grown = np.minimum(wanted, LARGEST_GROWTH * present)
    return np.maximum(grown, present).tolist()


def _whole_blocks(
    nodes: Sequence[float], seeds: Sequence[int], wavelengths: Sequence[float]
) -> tuple[int, ...]:
    """Seeds of each level rounded up to whole blocks, never fewer than on a finer level."""
    found: list[int] = []
    for level in reversed(range(len(nodes))):
        size = max(block_size(wavelength, nodes[level]) for wavelength in wavelengths)
        least = max(seeds[level], found[-1] if found else 0)
        found.append(math.ceil(least / size) * size)
    return tuple(reversed(found))


def grid_name(nodes: float) -> str:
    """A level in words."""
    return "surface alone" if nodes == SURFACE_ALONE else f"{nodes:g} nodes"
