"""Cost of every job of the study: memory, processor time and files written.

This is the only cost model. The rules of the workflow declare it as their resources, the study announces it
before it starts, and `asperity plan` states it. Memory and time are linear in the nodes of the grid and in
the repetitions of a job (loads, Poisson's ratios, seeds); the memory has other slopes above `LARGE_GRID`.
`jobs.csv` holds the coefficients, which ``python workflow/cost.py --store`` fits to the files of
``benchmark:`` of a finished study (`asperity.study.cost.benchmark.fitted`). Times hold for the machine of
that study; `time_factor` compares this machine with it.
"""

import csv
import math
import time
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files
from typing import NamedTuple

WORKFLOW_MEMORY = 320e6
"""Memory (bytes) of Snakemake beside a job on a node of a cluster: the instance that holds the allocation,
and the one that runs the job."""

COMPILER_MEMORY = 150e6
"""Memory (bytes) of compiling beside a job, on a node whose processor differs from the one compiled for."""

TRANSFORM_POINTS = 512
"""Grid of the Fourier transform by which machines are compared: row ``transform`` of `jobs.csv`."""

SPACING_POWER = -0.76
"""Power of the distance between planes with which the time of the stress grows (``make tradeoff``)."""

PAPER_SPACING = 0.5
"""Distance between planes, in grid spacings, to which the times of `jobs.csv` belong."""

LARGE_GRID = 4096**2
"""Nodes above which the memory of a job may grow more slowly: on larger planes the stress keeps one, not two
(`asperity.stress.planes.stream.KEPT_BYTES`)."""


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


@cache
def coefficients() -> Mapping[str, Mapping[str, float]]:
    """Job → coefficients: MB and seconds, bytes and microseconds per node and further repetition."""
    lines = files("asperity.study.cost").joinpath("jobs.csv").read_text(encoding="utf-8").splitlines()
    rows = csv.DictReader(lines)
    return {row.pop("job"): {key: float(value) for key, value in row.items()} for row in rows}


def job_cost(job: str, nodes: int = 0, repetitions: int = 1, depth_spacing: float = PAPER_SPACING) -> Cost:
    """Cost of one job on the machine of the measurement.

    Parameters
    ----------
    job : str
        A rule of the workflow, or ``load-area curve`` for a contact with several loads.
    nodes : int
        Nodes of the grid; for figures, the nodes of all fields that one figure shows.
    repetitions : int
        Loads of a contact, Poisson's ratios times lateral conditions of a stress, seeds of statistics,
        figures that one job draws.
    depth_spacing : float
        Distance between the upper planes of a stress, in grid spacings.

    Raises
    ------
    KeyError
        If there is no such job.
    """
    of = coefficients()[job]
    further = nodes * (repetitions - 1)
    calculation = 1e-6 * (nodes * of["seconds_per_node"] + further * of["seconds_per_further"])
    if job == "stress":
        calculation *= (depth_spacing / PAPER_SPACING) ** SPACING_POWER
    memory = 1e6 * of["memory"]
    for suffix, some in (("", min(nodes, LARGE_GRID)), ("_large", max(nodes - LARGE_GRID, 0))):
        per_node = of[f"memory_per_node{suffix}"] + (repetitions - 1) * of[f"memory_per_further{suffix}"]
        memory += some * per_node
    return Cost(
        memory=memory,
        fixed_seconds=of["seconds"] * (repetitions if job == "figure" else 1),
        calculation_seconds=calculation,
        disk=1e6 * of["disk"] + nodes * of["disk_per_node"],
    )


START_SECONDS, ANSWER_SECONDS = 1.7, 0.8
"""Time of imports and of compiled code; of pictures and report."""


def answer_seconds(work: float, nodes: int) -> float:
    """Time of an answer after the start, on the machine of the measurement.

    Parameters
    ----------
    work : float
        As of `asperity.engineering.stages.work_of`, with `FILES`.
    nodes : int
        Nodes of the grid; of a mirrored map without its images.
    """
    per_node = 1e-6 * coefficients()["contact"]["seconds_per_node"]
    return ANSWER_SECONDS + per_node * work * nodes


def transform_seconds() -> float:
    """Processor time now of a pair of Fourier transforms of a square grid, the least of seven."""
    import numpy as np  # the resources of the rules are read where only Snakemake is installed

    from asperity.fourier.grid import Fourier, Grid

    grid = Grid((TRANSFORM_POINTS, TRANSFORM_POINTS))
    fourier, values, spectrum = Fourier(grid), np.ones(grid.shape), np.empty(grid.mode_shape, complex)
    times = []
    for _ in range(7):
        start = time.process_time()
        fourier.inverse(fourier.forward(values, spectrum), values, overwrite=True)
        times.append(time.process_time() - start)
    return min(times)


def time_factor() -> float:
    """Time of a Fourier transform on this machine now, over its time on the machine of the measurement."""
    return transform_seconds() / coefficients()["transform"]["seconds"]


def announce(costs: Sequence[Cost], cores: int) -> str:
    """Number of jobs, minutes and memory of a run of the study, in one line.

    Parameters
    ----------
    costs : sequence of Cost
        Of all jobs of the run.
    cores : int
    """
    factor = time_factor()
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


def describe(points: Sequence[int] = (1024, 2048, 4096, 8192, 16384)) -> str:
    """Memory and processor time of the stages of one seed on square grids, in Markdown."""
    stages = {"contact": 1, "stress": 4, "statistics": 1}
    rows = []
    for edge in points:
        costs = (job_cost(job, edge**2, repetitions) for job, repetitions in stages.items())
        rows.append([f"{edge}²", *(f"{cost.memory / 1e9:.1f} GB, {minutes(cost.seconds)}" for cost in costs)])
    return "\n".join(f"| {' | '.join(row)} |" for row in [["nodes", *stages], ["---"] * 4, *rows])


if __name__ == "__main__":
    print(describe())
