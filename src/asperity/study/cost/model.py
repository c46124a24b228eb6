"""Cost of every job of the study: memory, processor time and files written.

This is the only cost model. The rules of the workflow declare it as their resources, the study announces it
before it starts, and `asperity plan` chooses settings by it. Memory and files are linear in the nodes of the
grid; so is the time, except that of surface, contact and stress, which follows laws fitted to `make tradeoff`
(`asperity.study.cost.measurement`) and depends on the settings of accuracy. All numbers hold on the machine
of that measurement; `time_factor` compares this machine with it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any, NamedTuple

import numpy as np

from asperity.fourier.grid import Fourier, Grid
from asperity.study.config.presets import PRESETS, AccuracySettings
from asperity.study.cost.measured import MeasuredTradeoff, load

PAPER = PRESETS["paper"]

WORKFLOW_MEMORY = 320e6
"""Memory (bytes) of Snakemake beside a job on a node of a cluster: the instance that holds the allocation,
and the one that runs the job."""

COMPILER_MEMORY = 150e6
"""Memory (bytes) of compiling beside a job, on a node whose processor differs from the one compiled for."""

TIME_LAWS: dict[str, tuple[str, ...]] = {
    "surface": (),
    "contact": ("contact_digits", "single_precision", "area", "loads"),
    "stress": ("depth_digits", "spacing", "ratios"),
}
"""Stages whose time follows a measured law → the factors whose powers are in it, besides the grid."""

_FACTORS: dict[str, Callable[[Mapping[str, Any]], Any]] = {
    "contact_digits": lambda of: np.log10(of["contact_tolerance"]) / math.log10(PAPER.contact_tolerance),
    "single_precision": lambda of: np.where(of["precision"] == "float32", math.e, 1.0),
    "area": lambda of: of["area_fraction"] / 0.1,
    "loads": lambda of: of["loads"],
    "depth_digits": lambda of: (
        np.log10(np.maximum(of["depth_tolerance"], 1e-12) / 10) / math.log10(PAPER.depth_tolerance / 10)
    ),
    "spacing": lambda of: of["depth_spacing"] / PAPER.depth_spacing,
    "ratios": lambda of: of["ratios"],
}
"""Factors of the time laws, from settings relative to the paper's."""

CALCULATION_STAGES = tuple(TIME_LAWS)
"""Stages from the spectrum of a surface to the stress and its peaks."""


class Cost(NamedTuple):
    """Cost of one job.

    Parameters
    ----------
    memory : float
        Peak memory in bytes.
    fixed_seconds : float
        Processor time that does not depend on the input: start of Python, imports, drawing.
    calculation_seconds : float
        Processor time of the calculation, which grows with the input.
    disk : float
        Bytes of the files written.
    """

    memory: float
    fixed_seconds: float
    calculation_seconds: float
    disk: float

    @property
    def seconds(self) -> float:
        """Processor time of the whole job."""
        return self.fixed_seconds + self.calculation_seconds


class _Line(NamedTuple):
    """Cost as a straight line over the nodes of the grid: MB and seconds, bytes and microseconds per node."""

    memory: float
    memory_per_node: float = 0.0
    seconds: float = 0.0
    time_per_node: float = 0.0
    disk: float = 1.0
    disk_per_node: float = 0.0


# Fitted to the benchmarks of the paper's study, on grids of 512² to 4096² (docs/scaling.md). The seconds of
# surface, contact and stress are those of the imports; their calculation follows the time laws.
_LINES = {
    "surface": _Line(190, 39, seconds=2, disk_per_node=8.1),
    "measured surface": _Line(250, 31, seconds=5, time_per_node=0.8, disk_per_node=8.1),
    "contact": _Line(270, 78, seconds=2, disk_per_node=17.5),
    "load-area curve": _Line(270, 133, seconds=2, disk_per_node=17.5),
    "stress": _Line(280, 102, seconds=2, disk_per_node=2),
    "statistics": _Line(250, 105, seconds=3, time_per_node=0.7),
    "figure": _Line(240, 8, seconds=3, time_per_node=0.1),
    "figure of elements": _Line(265, 80e3, seconds=6),
    "tradeoff": _Line(330, 300, seconds=8, time_per_node=95),
    "tradeoff figures": _Line(300, seconds=8),
    "claims": _Line(380, seconds=10),
    "validation": _Line(400, seconds=60),
    "report page": _Line(260, seconds=5, disk=20),
}

# Memory and time added for every further Poisson's ratio of a stress, and every further seed of the others.
_FURTHER = {
    "stress": _Line(0, 22),
    "statistics": _Line(0, 20, seconds=2, time_per_node=0.6),
}


def job_cost(
    job: str,
    nodes: int = 0,
    repetitions: int = 1,
    accuracy: AccuracySettings = PAPER,
    area_fraction: float = 0.1,
) -> Cost:
    """Cost of one job on the machine of the measurement.

    Parameters
    ----------
    job : str
        A stage of the study, ``measured surface``, or another job of the table in this module.
    nodes : int
        Nodes of the grid; of a figure, those of all fields that it holds, or finite elements.
    repetitions : int
        Loads of a contact, Poisson's ratios times lateral conditions of a stress, seeds of statistics.
    accuracy : AccuracySettings
        Tolerances, precision and depth spacing of contact and stress; the grid is that of `nodes`.
    area_fraction : float
        Of the contact.

    Raises
    ------
    KeyError
        If there is no such job.
    """
    line = _LINES["load-area curve" if job == "contact" and repetitions > 1 else job]
    more, further = repetitions - 1, _FURTHER.get(job, _Line(0))
    per_node = line.memory_per_node + more * further.memory_per_node
    if job in TIME_LAWS:
        settings = asdict(accuracy) | {
            "area_fraction": area_fraction,
            "loads": repetitions,
            "ratios": repetitions,
        }
        calculation = float(law_seconds(load().time_laws[job], nodes, settings))
    else:
        time_per_node = line.time_per_node + more * further.time_per_node
        calculation = 1e-6 * nodes * time_per_node + more * further.seconds
    return Cost(
        memory=1e6 * line.memory + nodes * per_node,
        fixed_seconds=line.seconds,
        calculation_seconds=calculation,
        disk=1e6 * line.disk + nodes * line.disk_per_node,
    )


def law_seconds(law: Mapping[str, float], nodes: Any, settings: Mapping[str, Any]) -> Any:
    """Processor time of a stage by its measured law, or array of times.

    ``(exp(log_constant) + exp(log_per_node) n log2(√n)) × Π factor^power`` for n nodes, with the factors of
    `TIME_LAWS`, which are one at the settings of the paper.

    Parameters
    ----------
    law : mapping
        ``log_constant``, ``log_per_node``, and the power of every factor.
    nodes : int or array
        Nodes of the square grid.
    settings : mapping
        Settings of accuracy, ``area_fraction``, ``loads`` and ``ratios``: numbers or arrays.
    """
    nodes = np.maximum(nodes, 1)
    seconds = np.exp(law["log_constant"]) + np.exp(law["log_per_node"]) * nodes * np.log2(nodes) / 2
    for name, factor in _FACTORS.items():
        if name in law:
            seconds = seconds * factor(settings) ** law[name]
    return seconds


def transform_seconds(points: int, repetitions: int = 3) -> float:
    """Processor time now of a pair of Fourier transforms of a square grid, the least of some repetitions."""
    fourier = Fourier(Grid((points, points)))
    values, coefficients = np.ones((points, points)), np.empty(fourier.grid.half_shape, complex)
    times = []
    for _ in range(repetitions):
        start = time.process_time()
        fourier.inverse(fourier.forward(values, coefficients), values, overwrite=True)
        times.append(time.process_time() - start)
    return min(times)


def time_factor(measured: MeasuredTradeoff | None = None) -> float:
    """Time of a Fourier transform on this machine now, divided by that on the machine of the measurement."""
    points, seconds = (measured or load()).transform
    return transform_seconds(points, repetitions=7) / seconds


def announce(costs: Sequence[Cost], cores: int, factor: float | None = None) -> str:
    """Number of jobs, minutes and memory of a run of the study, in one line.

    Parameters
    ----------
    costs : sequence of Cost
        Of all jobs of the run.
    cores : int
    factor : float, optional
        Time on this machine over that on the machine of the measurement; by default `time_factor`.
    """
    factor = time_factor() if factor is None else factor
    total = factor * sum(cost.seconds for cost in costs)
    longest = factor * max(cost.seconds for cost in costs)
    return (
        f"plan: {len(costs)} jobs, about {minutes(total)} of one processor, "
        f"{minutes(max(total / cores, longest))} on {cores} {'core' if cores == 1 else 'cores'}, "
        f"at most {max(cost.memory for cost in costs) / 2**30:.1f} GiB in one job"
    )


def minutes(seconds: float) -> str:
    """A time as whole minutes, or as whole seconds below a minute and a half."""
    return f"{seconds / 60:.0f} min" if seconds >= 90 else f"{math.ceil(seconds)} s"
