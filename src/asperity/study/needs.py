"""What the jobs of a study need: memory and processor time, by the size of the grid.

Fitted to the study of the paper, on grids of 512² to 4096²; `workflow/cost.py --declared` holds the
memory against a run.
"""

from __future__ import annotations

from typing import NamedTuple

WORKFLOW_MEMORY = 320.0
"""What Snakemake takes beside a job on a node of a cluster, in MB: the instance that holds the
allocation, and the one that runs the job."""


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
    "surface": _Line(144, 31, 2, 0.8),
    "map": _Line(250, 31, 5, 0.8),
    "contact": _Line(286, 98, 3, 4.7),
    "contact path": _Line(286, 163, 3, 4.7),
    "body": _Line(330, 261, 4, 7.5),
    "summary": _Line(212, 50, 3, 0.4),
    "statistics": _Line(238, 53, 3, 0.5),
    "verification": _Line(300, 262, 4, 2),
    "figure": _Line(200, 8, 5, 0.1),
    "map of elements": _Line(218, 306e3, 6, 0),
    "claims": _Line(380, 0, 10, 0),
    "validation": _Line(330, 0, 25, 0),
    "validation table": _Line(280, 0, 5, 0),
    "tradeoff": _Line(330, 300, 8, 95),
}
_AGAIN = {
    "contact": _Line(0, 0, 0.5, 1.5),
    "verification": _Line(0, 20, 1, 2),
}
"""What every further load or seed adds."""

_WRITTEN = {"surface": 7, "map": 7, "contact": 15, "body": 2}
"""Bytes in files for each node; the other stages write less than a megabyte."""


def need(stage: str, nodes: int = 0, times: int = 1) -> Need:
    """What one job needs.

    Parameters
    ----------
    stage : str
        A stage of the study, or ``map`` for a measured surface.
    nodes : int
        Nodes of the grid of its surface, of all fields that a figure holds, or elements of a mesh.
    times : int
        Loads of a contact's load-area curve, or seeds that a verification goes through.

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
        1 + _WRITTEN.get(stage, 0) * millions,
    )
