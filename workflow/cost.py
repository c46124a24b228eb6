"""Table of the processor minutes and largest memory of every rule and surface, from the logs of a finished
study.

    python workflow/cost.py [results] [--csv FILE] [--declared [--configfile FILE]]

With --csv the table is written as CSV or Parquet too. With --declared the memory that the rules declare
stands beside the measured one, and the exit code is 1 if they differ by more than a quarter in any job.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

import pandas as pd

from asperity.markup import markdown
from asperity.results.tables import write_table
from asperity.runtime.costs import cost_table, job_costs

TOLERANCE = 0.25
"""Largest relative difference between measured and declared memory."""


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


def for_reader(table: pd.DataFrame) -> pd.DataFrame:
    """The table of costs as text."""
    digits = {"processor_minutes": "{:.1f}", "largest_memory_MB": "{:.0f}", "declared_MB": "{:.0f}"}
    shown = table.assign(
        **{name: table[name].map(form.format) for name, form in digits.items() if name in table}
    )
    return shown.rename(
        columns={
            "job": "rule",
            "processor_minutes": "processor minutes",
            "largest_memory_MB": "largest memory (MB)",
            "declared_MB": "declared (MB)",
        }
    )


def wrongly_declared(jobs: pd.DataFrame, logs: Path) -> list[str]:
    """One line for every job whose measured memory differs from the declared one by more than a quarter."""
    wrong = jobs[abs(jobs["memory_MB"] - jobs["declared_MB"]) > TOLERANCE * jobs["declared_MB"]]
    return [
        f"{job.log.relative_to(logs).with_suffix('')}: {job.memory_MB:.0f} MB measured, "
        f"{job.declared_MB:.0f} MB declared"
        for job in wrong.itertuples()
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", nargs="?", type=Path, default="results", help="folder of the results")
    parser.add_argument("--csv", metavar="FILE", help="write the table too, .csv or .parquet")
    parser.add_argument("--declared", action="store_true", help="declared memory beside the measured one")
    parser.add_argument("--configfile", help="overlay that the study was run with")
    options = parser.parse_args()
    logs = options.results / "log"
    jobs = job_costs(logs, declared_memory(options.configfile) if options.declared else None)
    if jobs.empty:
        sys.exit(f"{logs}: no finished job; run the study first")
    table = cost_table(jobs)
    print(markdown(for_reader(table)))
    if options.csv:
        write_table(table, "costs", options.csv)
    if options.declared and (lines := wrongly_declared(jobs, logs)):
        sys.exit("\n".join([f"measured and declared memory differ by more than {TOLERANCE:.0%}:", *lines]))


if __name__ == "__main__":
    main()
