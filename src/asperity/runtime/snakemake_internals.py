"""Facts about a run that Snakemake (9.x) knows but does not publish: the only place where they are looked up.

Snakemake documents `config`, `workflow.cores`, `workflow.source_path` and the handlers `onstart`, `onsuccess`
and `onerror` for use in a Snakefile. The study also needs the facts below. Every function here reads one
attribute of Snakemake's `Workflow` object or names one of its files, and imports nothing of Snakemake. If one
of them moves in a later version, `tests/workflow/test_snakemake_internals.py` fails and names the function to
repair.
"""

from __future__ import annotations

from base64 import urlsafe_b64encode
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

_LONGEST_NAME = 255
"""Characters of a file name on common file systems."""


class Job(NamedTuple):
    """A job that Snakemake will run."""

    rule: str
    wildcards: Any
    input: tuple[str, ...]
    output: tuple[str, ...]
    resources: Mapping[str, float]


def overlays(workflow: Any) -> list[str]:
    """Configuration files given on the command line by ``--configfile``."""
    return [str(path) for path in workflow.overwrite_configfiles]


def settings_given(workflow: Any) -> dict[str, Any]:
    """Settings given on the command line by ``--config``."""
    return dict(workflow.config_settings.config)


def jobs_to_run(workflow: Any) -> list[Job]:
    """Jobs that the run is made of; known in the handler `onstart`."""
    return [
        Job(
            job.rule.name,
            job.wildcards,
            tuple(map(str, job.input)),
            tuple(map(str, job.output)),
            {name: value for name, value in job.resources.items() if isinstance(value, int | float)},
        )
        for job in workflow.dag.needrun_jobs()
    ]


def is_main_process(workflow: Any) -> bool:
    """True in the process that the user has started, False in those of Snakemake for single jobs."""
    return workflow.is_main_process


def runs_locally(workflow: Any) -> bool:
    """True if jobs run on this machine, False if they are sent to a cluster."""
    return workflow.local_exec


def jobs_at_once(workflow: Any) -> int:
    """Jobs that may run at the same time: cores of this machine, or jobs on the cluster."""
    return workflow.cores if runs_locally(workflow) else workflow.nodes


def memory_limit(workflow: Any) -> float | None:
    """Memory in MB that ``--resources mem_mb=…`` allows the jobs; None without such a limit."""
    limit = getattr(workflow.global_resources.get("mem_mb"), "value", None)
    return None if limit is None else float(limit)


def record_of(output: Path) -> Path | None:
    """File in which Snakemake records how an output was made; None if its name would need several folders.

    Snakemake is run in this folder, and names the output as it is named here.
    """
    name = urlsafe_b64encode(str(output).encode()).decode()
    return Path(".snakemake", "metadata", name) if len(name) < _LONGEST_NAME else None
