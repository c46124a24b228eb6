"""Processor time and memory that the jobs of a study took, from the last lines of their logs."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

TOOK = re.compile(r"took (\S+) s of processor time, (\S+) MB of memory$", re.MULTILINE)
"""Last line of the log of a finished job."""


def job_costs(logs: Path, declared: Mapping[Path, float] | None = None) -> pd.DataFrame:
    """Costs of every finished job, a row each.

    Parameters
    ----------
    logs : Path
        Folder of the logs, ``log`` among the results.
    declared : mapping, optional
        Log → memory in MB that the rule declares.

    Returns
    -------
    data frame
        log (a path); rule; job, the rule with the surface; processor_minutes; memory_MB; and declared_MB if
        given; then jobs without it are left out.
    """
    rows = []
    for path in sorted(logs.rglob("*.log")):
        found = TOOK.findall(path.read_text(encoding="utf-8"))
        if found:
            seconds, memory = map(float, found[-1])
            folders = path.relative_to(logs).parent.parts
            rows.append(
                (
                    path,
                    (folders or (path.stem,))[0],
                    " ".join(folders[:2] or [path.stem]),
                    seconds / 60,
                    memory,
                )
            )
    frame = pd.DataFrame(rows, columns=["log", "rule", "job", "processor_minutes", "memory_MB"])
    if declared is not None:
        frame = frame[[path in declared for path in frame["log"]]].reset_index(drop=True)
        frame["declared_MB"] = [declared[path] for path in frame["log"]]
    return frame


def cost_table(jobs: pd.DataFrame, by: str = "job") -> pd.DataFrame:
    """Costs by rule and surface, or ``by="rule"``, the last row those of all jobs.

    Returns
    -------
    data frame
        The table ``costs`` of `asperity.results.tables.TABLES`.
    """
    rows = [_row(str(name), group) for name, group in jobs.groupby(by)]
    return pd.DataFrame([*rows, _row("all", jobs)])


def _row(name: str, jobs: pd.DataFrame) -> dict[str, object]:
    largest = jobs.loc[jobs["memory_MB"].idxmax()]
    row = {
        "job": name,
        "jobs": len(jobs),
        "processor_minutes": float(jobs["processor_minutes"].sum()),
        "largest_memory_MB": float(largest["memory_MB"]),
    }
    return row | ({"declared_MB": float(largest["declared_MB"])} if "declared_MB" in jobs else {})
