"""Processor time and memory that the jobs of a study took, from the files of their ``benchmark:``."""

import ast
import re
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import nnls

from asperity.core.types import Array
from asperity.study.cost.model import LARGE_GRID


def job_costs(results: Path) -> pd.DataFrame:
    """Costs of every finished job of a study, a row each.

    Parameters
    ----------
    results : Path
        Folder of the results.

    Returns
    -------
    data frame
        rule; job, the rule with the surface; grid_nodes and repetitions; processor_minutes; memory_MB; and
        declared_MB, which the rule declares. Snakemake measures every half a second, and after a quarter of a
        minute every thirty.
    """
    rows = []
    for path in sorted((results / "benchmark").rglob("*.tsv")):
        measured = pd.read_csv(path, sep="\t").iloc[-1]
        wildcards, resources = (ast.literal_eval(measured[name]) for name in ("wildcards", "resources"))
        rows.append(
            {
                "rule": re.sub("^figures_.*", "figure", measured["rule_name"]),
                "job": " ".join([measured["rule_name"], *list(wildcards.values())[:1]]),
                "grid_nodes": resources.get("grid_nodes", 0),
                "repetitions": resources.get("repetitions", 1),
                "processor_minutes": float(measured["cpu_time"]) / 60,
                "memory_MB": float(measured["max_rss"]),
                "declared_MB": float(resources["mem_mb"]),
            }
        )
    columns = ["rule", "job", "grid_nodes", "repetitions", "processor_minutes", "memory_MB", "declared_MB"]
    return pd.DataFrame(rows, columns=columns)


def cost_table(jobs: pd.DataFrame, by: str = "job") -> pd.DataFrame:
    """Costs by rule and surface, or ``by="rule"``, the last row for all jobs.

    Returns
    -------
    data frame
        The table ``costs`` of `asperity.results.tables.TABLES`.
    """
    groups = [*jobs.groupby(by), ("all", jobs)]
    columns = ["job", "jobs", "processor_minutes", "largest_memory_MB", "declared_MB"]
    rows = []
    for name, group in groups:
        largest = group.loc[group["memory_MB"].idxmax()]
        costs = group["processor_minutes"].sum(), largest["memory_MB"], largest["declared_MB"]
        rows.append((str(name), len(group), *costs))
    return pd.DataFrame(rows, columns=columns)


def fitted(jobs: pd.DataFrame) -> pd.DataFrame:
    """Memory and time of every rule as functions of nodes and further repetitions.

    Least squares of the relative error with coefficients ≥ 0. The memory is raised to the largest that was
    measured.

    Returns
    -------
    data frame
        Coefficients of `asperity.study.cost.model.job_cost`; index the job. Left out are the coefficients of
        the disk, and those for grids above `LARGE_GRID` of rules that computed no such grid.
    """
    several = (jobs["rule"] == "contact") & (jobs["repetitions"] > 1)
    named = jobs.assign(rule=jobs["rule"].mask(several, "load-area curve"))
    rows = {}
    for rule, group in named.groupby("rule"):
        nodes, further = group["grid_nodes"].to_numpy(float), group["repetitions"].to_numpy() - 1
        small, one = np.minimum(nodes, LARGE_GRID), np.ones(nodes.size)
        bent = [small, small * further, nodes - small, (nodes - small) * further]
        if nodes.max() <= LARGE_GRID:
            bent = bent[:2]
        measured = 1e6 * group["memory_MB"].to_numpy()
        memory = _least_squares(np.column_stack([one, *bent]), measured, covers=True)
        terms = np.column_stack([one, nodes, nodes * further])
        if rule == "figure":
            terms[:, 0] = group["repetitions"]
        seconds = _least_squares(terms, 60 * group["processor_minutes"].to_numpy())
        per = {"memory": memory * ([1e-6] + [1] * len(bent)), "seconds": seconds * [1, 1e6, 1e6]}
        suffixes = "", "_per_node", "_per_further", "_per_node_large", "_per_further_large"
        rows[str(rule)] = {
            f"{name}{suffix}": float(f"{value:.3g}")
            for name, values in per.items()
            for suffix, value in zip(suffixes, values, strict=False)
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("job")


def _least_squares(terms: Array, values: Array, covers: bool = False) -> Array:
    """Coefficients ≥ 0 of the terms, so large that no value is above the sum if it `covers` all."""
    found = nnls(terms / values[:, None], np.ones(values.size))[0]
    return found * max(1.0, float(np.max(values / (terms @ found)))) if covers else found
