"""What the study cost: processor minutes and largest memory of every rule, from the last lines of its logs.

python workflow/cost.py [results] [--declared [--configfile FILE]]

With --declared: the memory of every job beside what its rule declares, and exit 1 if a quarter lies between.
Benchmark files are not read: after sixteen seconds they sample a job every half minute, and miss its peak.
"""

import argparse
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

TOLERANCE = 0.25
TOOK = re.compile(r"took (\S+) s of processor time, (\S+) MB of memory$", re.MULTILINE)


class Cost(NamedTuple):
    """What a job took: processor minutes, and memory in MB."""

    minutes: float
    memory: float


def measured(results: Path) -> dict[Path, Cost]:
    """The cost of every job that has a log below `results`, by the path of its log."""
    costs = {}
    for path in sorted((results / "log").rglob("*.log")):
        if found := TOOK.findall(path.read_text(encoding="utf-8")):
            seconds, memory = map(float, found[-1])
            costs[path] = Cost(seconds / 60, memory)
    return costs


def declared(dry_run: str) -> dict[Path, float]:
    """The resource mem_mb of every job in the text of a dry run, by the path of its log."""
    memory, log = {}, None
    for line in dry_run.splitlines():
        key, _, value = line.strip().partition(": ")
        if key == "log":
            log = Path(value)
        elif key == "resources" and log is not None and (found := re.search(r"\bmem_mb=(\d+)", value)):
            memory[log] = float(found[1])
    return memory


def plan(configfile: str | None) -> str:
    """The text of a dry run of the whole study."""
    overlay = ["--configfile", configfile] if configfile else []
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "--forceall", "--dry-run", *overlay]
    found = subprocess.run(command, capture_output=True, text=True)
    if found.returncode:
        sys.exit(found.stdout + found.stderr)
    return found.stdout + found.stderr


def name_of(log: Path, results: Path) -> str:
    """Rule and surface of a job, or its rule alone."""
    rule, *rest = log.relative_to(results / "log").with_suffix("").parts
    return f"{rule} {rest[0]}" if len(rest) > 1 else rule


def cost_table(costs: dict[Path, Cost], results: Path) -> str:
    """Processor minutes and largest memory of every rule and surface."""
    groups = defaultdict(list)
    for log, cost in costs.items():
        groups[name_of(log, results)].append(cost)
    lines = ["| rule | jobs | processor minutes | largest memory (GB) |", "|---|---|---|---|"]
    for name, group in [*sorted(groups.items()), ("all", list(costs.values()))]:
        minutes, memory = zip(*group, strict=True)
        lines.append(f"| {name} | {len(group)} | {sum(minutes):.1f} | {max(memory) / 1000:.1f} |")
    return "\n".join(lines)


def memory_table(costs: dict[Path, Cost], memory: dict[Path, float], results: Path) -> tuple[str, list[str]]:
    """Memory of every job measured and declared, and the jobs more than a quarter apart."""
    lines, offenders = (
        ["| job | measured (MB) | declared (MB) | measured / declared |", "|---|---|---|---|"],
        [],
    )
    for log, cost in costs.items():
        job = str(log.relative_to(results / "log").with_suffix(""))
        if log not in memory:
            offenders.append(f"{job}: its rule declares no memory")
            continue
        ratio = cost.memory / memory[log]
        lines.append(f"| {job} | {cost.memory:.0f} | {memory[log]:.0f} | {ratio:.2f} |")
        if abs(ratio - 1) > TOLERANCE:
            offenders.append(f"{job}: {cost.memory:.0f} MB measured, {memory[log]:.0f} MB declared")
    return "\n".join(lines), offenders


def main() -> None:
    """Print one of the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", nargs="?", type=Path, default="results", help="folder of the results")
    parser.add_argument("--declared", action="store_true", help="memory measured beside memory declared")
    parser.add_argument("--configfile", help="overlay that the study was run with")
    chosen = parser.parse_args()
    costs = measured(chosen.results)
    if not costs:
        sys.exit(f"{chosen.results}/log: no job has said what it took; run the study first")
    if not chosen.declared:
        print(cost_table(costs, chosen.results))
        return
    table, offenders = memory_table(costs, declared(plan(chosen.configfile)), chosen.results)
    print(table)
    if offenders:
        sys.exit("\n".join([f"more than {TOLERANCE:.0%} between measured and declared memory:", *offenders]))


if __name__ == "__main__":
    main()
