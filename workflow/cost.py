"""Table of the processor minutes and largest memory of every rule and surface, from the logs of a finished
study.

    python workflow/cost.py [results] [--declared [--configfile FILE]]

With --declared the memory that the rules declare stands beside the measured one, and the exit code is 1 if
they differ by more than a quarter in any job. Snakemake's benchmark files are not read: after sixteen seconds
they sample a job only every half minute, and miss its peak.
"""

import argparse
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

from asperity.results.markup import markdown

TOLERANCE = 0.25
"""Largest relative difference between measured and declared memory."""

TOOK = re.compile(r"took (\S+) s of processor time, (\S+) MB of memory$", re.MULTILINE)


class Job(NamedTuple):
    """Processor minutes and memory (MB) of a job, and the memory (MB) that its rule declares, if any."""

    minutes: float
    memory: float
    declared: float = 0.0


def measured_jobs(logs: Path) -> dict[Path, Job]:
    """Path of each log in a folder → the cost that its last line states."""
    jobs = {}
    for path in sorted(logs.rglob("*.log")):
        if found := TOOK.findall(path.read_text(encoding="utf-8")):
            seconds, memory = map(float, found[-1])
            jobs[path] = Job(seconds / 60, memory)
    return jobs


def declared_memory(configfile: str | None) -> dict[Path, float]:
    """Path of the log of every job → the resource mem_mb of its rule, from a dry run of the whole study."""
    overlay = ["--configfile", configfile] if configfile else []
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "--forceall", "--dry-run", *overlay]
    run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode:
        sys.exit(run.stdout + run.stderr)
    memory, log = {}, None
    for line in (run.stdout + run.stderr).splitlines():
        key, _, value = line.strip().partition(": ")
        if key == "log":
            log = Path(value)
        elif key == "resources" and log is not None and (found := re.search(r"\bmem_mb=(\d+)", value)):
            memory[log] = float(found[1])
    return memory


def table(jobs: dict[Path, Job], logs: Path, declared: bool) -> str:
    """Markdown table of the jobs, one row for each rule and surface, with their largest memory."""
    groups = defaultdict(list)
    for path, job in jobs.items():
        folders = path.relative_to(logs).parent.parts
        groups[" ".join(folders[:2] or [path.stem])].append(job)
    head = ["rule", "jobs", "processor minutes", "largest memory (MB)", "declared (MB)"]
    rows = []
    for name, group in [*sorted(groups.items()), ("all", list(jobs.values()))]:
        largest = max(group, key=lambda job: job.memory)
        minutes = sum(job.minutes for job in group)
        numbers = [f"{minutes:.1f}", f"{largest.memory:.0f}", f"{largest.declared:.0f}"]
        rows.append([name, str(len(group)), *numbers])
    columns = len(head) if declared else len(head) - 1
    return markdown([row[:columns] for row in [head, *rows]])


def wrongly_declared(jobs: dict[Path, Job], logs: Path) -> list[str]:
    """One line for every job whose measured memory differs from the declared one by more than a quarter."""
    lines = []
    for path, job in jobs.items():
        if abs(job.memory - job.declared) > TOLERANCE * job.declared:
            name = path.relative_to(logs).with_suffix("")
            lines.append(f"{name}: {job.memory:.0f} MB measured, {job.declared:.0f} MB declared")
    return lines


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", nargs="?", type=Path, default="results", help="folder of the results")
    parser.add_argument("--declared", action="store_true", help="declared memory beside the measured one")
    parser.add_argument("--configfile", help="overlay that the study was run with")
    options = parser.parse_args()
    logs = options.results / "log"
    jobs = measured_jobs(logs)
    if not jobs:
        sys.exit(f"{logs}: no finished job; run the study first")
    if options.declared:
        memory = declared_memory(options.configfile)
        jobs = {path: job._replace(declared=memory[path]) for path, job in jobs.items() if path in memory}
    print(table(jobs, logs, options.declared))
    if options.declared and (lines := wrongly_declared(jobs, logs)):
        sys.exit("\n".join([f"measured and declared memory differ by more than {TOLERANCE:.0%}:", *lines]))


if __name__ == "__main__":
    main()
