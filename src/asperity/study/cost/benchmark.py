"""Processor time and memory that the jobs of a study took, from the files of their ``benchmark:``."""

from __future__ import annotations

import ast
from pathlib import Path

import pandas as pd


def job_costs(results: Path) -> pd.DataFrame:
    """Costs of every finished job of a study, a row each.

    Parameters
    ----------
    results : Path
        Folder of the results.

    Returns
    -------
    data frame
        rule; job, the rule with the surface; processor_minutes; memory_MB; and declared_MB, which the rule
        declares. Snakemake measures every half a second, and after a quarter of a minute every thirty.
    """
    rows = []
    for path in sorted((results / "benchmark").rglob("*.tsv")):
        measured = pd.read_csv(path, sep="\t").iloc[-1]
        wildcards = ast.literal_eval(measured["wildcards"])
        rows.append(
            {
                "rule": measured["rule_name"],
                "job": " ".join([measured["rule_name"], *list(wildcards.values())[:1]]),
                "processor_minutes": float(measured["cpu_time"]) / 60,
                "memory_MB": float(measured["max_rss"]),
                "declared_MB": float(ast.literal_eval(measured["resources"])["mem_mb"]),
            }
        )
    return pd.DataFrame(rows, columns=["rule", "job", "processor_minutes", "memory_MB", "declared_MB"])


def cost_table(jobs: pd.DataFrame, by: str = "job") -> pd.DataFrame:
    """Costs by rule and surface, or ``by="rule"``, the last row those of all jobs.

    Returns
    -------
    data frame
        The table ``costs`` of `asperity.results.tables.TABLES`.
    """
    groups = [*jobs.groupby(by), ("all", jobs)]
    return pd.DataFrame(
        {
            "job": str(name),
            "jobs": len(group),
            "processor_minutes": group["processor_minutes"].sum(),
            "largest_memory_MB": group["memory_MB"].max(),
            "declared_MB": group.loc[group["memory_MB"].idxmax(), "declared_MB"],
        }
        for name, group in groups
    )
