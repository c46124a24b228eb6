"""What the jobs of a study need: memory and processor time, by the size of the grid.

Fitted to the study of the paper, on grids of 512² to 4096²; `workflow/cost.py --declared` holds the
memory against a run. `python -m asperity.accuracy.resources POINTS …` prints the needs of any grids.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import NamedTuple

WORKFLOW_MEMORY = 320.0
"""What Snakemake takes beside a job on a node of a cluster, in MB: the instance that holds the
allocation, and the one that runs the job."""

COMPILER_MEMORY = 150.0
"""What compiling takes beside a job, in MB, on a node whose processor is not that for which it was done."""


class Need(NamedTuple):
    """Largest memory (MB), processor time (s) and files written (MB) of one job."""

    memory: float
    seconds: float
    disk: float


class _Line(NamedTuple):
    """Memory (MB) and time (s) of a job without a grid; bytes and microseconds for each node of one."""

    memory: float
    bytes: float
    seconds: float
    microseconds: float


_LINES = {
    "machine code": _Line(295, 0, 14, 0),
    "surface": _Line(144, 31, 2, 0.8),
    "map": _Line(250, 31, 5, 0.8),
    "contact": _Line(260, 85, 3, 1.3),
    "contact path": _Line(260, 130, 3, 1.3),
    "stress": _Line(270, 139, 4, 2.5),
    "summary": _Line(212, 50, 3, 0.4),
    "statistics": _Line(205, 53, 3, 0.5),
    "verification": _Line(300, 262, 4, 2),
    "figure": _Line(200, 8, 5, 0.1),
    "map of elements": _Line(235, 306e3, 6, 0),
    "figure of extremes": _Line(320, 0, 6, 0),
    "tradeoff figures": _Line(300, 0, 8, 0),
    "claims": _Line(380, 0, 10, 0),
    "validation": _Line(300, 0, 25, 0),
    "validation table": _Line(240, 0, 5, 0),
    "calculix": _Line(500, 0, 320, 0),
    "tradeoff": _Line(330, 300, 8, 95),
}
_AGAIN = {
    "contact": _Line(0, 0, 0.5, 0.75),
    "stress": _Line(0, 22, 0, 0.5),
    "statistics": _Line(0, 48, 2, 0.3),
    "verification": _Line(0, 8, 0.1, 0.3),
}
"""What every further load, Poisson's ratio or seed adds."""

_WRITTEN = {"surface": 7, "map": 7, "contact": 15, "stress": 2}
"""Bytes in files for each node; the other stages write less than a megabyte."""

_BESIDE = {"calculix": 3}
"""Megabytes in files of another program."""


def need(stage: str, nodes: int = 0, times: int = 1) -> Need:
    """What one job needs.

    Parameters
    ----------
    stage : str
        A stage of the study, or ``map`` for a measured surface.
    nodes : int
        Nodes of the grid of its surface, of all fields that a figure holds, or elements of a mesh.
    times : int
        Loads of a contact, Poisson's ratios of a stress, seeds of statistics and of a verification.

    Raises
    ------
    KeyError
        If there is no such stage.
    """
    line = _LINES["contact path" if stage == "contact" and times > 1 else stage]
    again = _AGAIN.get(stage, _Line(0, 0, 0, 0))
    millions = nodes / 1e6
    return Need(
        line.memory + line.bytes * millions + (times - 1) * (again.memory + again.bytes * millions),
        line.seconds
        + line.microseconds * millions
        + (times - 1) * (again.seconds + again.microseconds * millions),
        1 + _BESIDE.get(stage, 0) + _WRITTEN.get(stage, 0) * millions,
    )


def table(points: Iterable[int], ratios: int = 4) -> str:
    """Gigabytes and processor minutes of the stages on square grids, for a reader.

    Parameters
    ----------
    points : iterable of int
        Nodes on an edge.
    ratios : int
        Poisson's ratios of the stress.
    """
    stages = {"surface": 1, "contact": 1, "stress": ratios, "statistics": 1, "verification": 1}
    lines = [f"| points | {' | '.join(stages)} |", "|---" * (len(stages) + 1) + "|"]
    for edge in points:
        needs = [need(stage, edge**2, times) for stage, times in stages.items()]
        cells = [f"{each.memory / 1000:.1f} GB, {each.seconds / 60:.1f} min" for each in needs]
        lines.append(f"| {edge}² | {' | '.join(cells)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    print(table(map(int, sys.argv[1:])))
