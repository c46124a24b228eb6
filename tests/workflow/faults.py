"""A small study killed at random times and run again: python tests/workflow/faults.py --kills 50

Prints a table with a row for every kill, and saves it as results/faults.md. Ends with exit status 1 if a run
did not finish, if a finished job was repeated, or if a result differs from that of an undisturbed run.
"""

import argparse
import random
import shutil
import subprocess
import sys
import tempfile
import time
from base64 import urlsafe_b64decode, urlsafe_b64encode
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import psutil
from project import TINY, copy_project, environment

from asperity.results import dataset

RESULTS = "results/tiny"
TARGETS = (
    f"{RESULTS}/figures/fig09.png",
    f"{RESULTS}/verification/hurst_08.csv",
)
COMPARED = (".nc", ".json", ".csv", ".png", ".pdf", ".rst")


def study(*options, cores=2):
    """Command that runs the small study."""
    return ("snakemake", "--cores", str(cores), *TINY, *options, "--", *TARGETS)


class Kill(NamedTuple):
    """A kill, the finished and unfinished outputs at that moment, and what the next run did."""

    number: int
    seconds: float
    finished: int
    unfinished: int
    repeated: tuple[str, ...]
    differing: tuple[str, ...]


class Run(NamedTuple):
    """How a run ended, how long it took, and what it printed."""

    killed: bool
    seconds: float
    text: str


def kill_with_programs(number):
    """Kill a process and all that it has started, at any depth."""
    process = psutil.Process(number)
    for one in (process, *process.children(recursive=True)):
        with suppress(psutil.NoSuchProcess):
            one.kill()


def run_study(folder, kill_when=None, cores=2):
    """Run the study, which is killed with all its processes as soon as `kill_when(seconds)` is true."""
    log = folder / "study.log"
    began = time.monotonic()
    killed = False
    with open(log, "w", encoding="utf-8") as file:
        process = subprocess.Popen(
            study(cores=cores),
            cwd=folder,
            env=environment(folder),
            stdout=file,
            stderr=subprocess.STDOUT,
        )
        while process.poll() is None:
            if kill_when is not None and kill_when(time.monotonic() - began):
                kill_with_programs(process.pid)
                process.wait()
                killed = True
            time.sleep(0.01)
    text = log.read_text(encoding="utf-8")
    if not killed and process.returncode:
        sys.exit(f"the study did not finish:\n{text}")
    return Run(killed, time.monotonic() - began, text)


def recorded(folder, kind):
    """Outputs in the records of Snakemake 9: kind "metadata" if finished, "incomplete" if not."""
    records = folder / ".snakemake" / kind
    names = (
        path.relative_to(records).as_posix().replace("/@", "").lstrip("@") for path in records.rglob("*")
    )
    return {urlsafe_b64decode(name).decode() for name in names if name != "migration_underway"}


def mark_unfinished(folder, name):
    """Record an output as Snakemake does while its job runs, until it has seen that the job has ended."""
    record = folder / ".snakemake/incomplete" / urlsafe_b64encode(name.encode()).decode()
    record.parent.mkdir(parents=True, exist_ok=True)
    record.write_text('{"external_jobid": null}', encoding="utf-8")


def finished(folder):
    """Finished outputs → time at which each was written."""
    done = recorded(folder, "metadata") - recorded(folder, "incomplete")
    return {name: (folder / name).stat().st_mtime_ns for name in done if (folder / name).exists()}


def differences(folder, reference):
    """Names of results that differ from those of the undisturbed run."""
    one, two = ({p.relative_to(f / RESULTS) for p in results(f)} for f in (folder, reference))
    differing = {str(name) for name in one ^ two}
    for name in one & two:
        mine, other = folder / RESULTS / name, reference / RESULTS / name
        same = (
            dataset.read(mine).identical(dataset.read(other))
            if name.suffix == ".nc"
            else mine.read_bytes() == other.read_bytes()
        )
        if not same:
            differing.add(str(name))
    return tuple(sorted(differing))


def results(folder):
    """All result files of the study, and unfinished ones."""
    return [
        path
        for path in (folder / RESULTS).rglob("*")
        if path.suffix in (*COMPARED, ".unfinished") and "log" not in path.parts
    ]


def kill_and_run_again(folder, reference, conditions):
    """Kill the study under each condition, each time running it again, and anew whenever it has finished.

    `folder` is a copy of the project without results, `reference` one in which the study has run undisturbed;
    conditions are as of `run_study`. Yields a `Kill` for each.
    """
    conditions = iter(conditions)
    number = 0
    for condition in conditions:
        for name in ("results", ".snakemake"):
            shutil.rmtree(folder / name, ignore_errors=True)
        kills = []
        run = run_study(folder, condition)
        while run.killed:
            number += 1
            before, unfinished, seconds = finished(folder), recorded(folder, "incomplete"), run.seconds
            run = run_study(folder, next(conditions, None))
            now = finished(folder)
            repeated = sorted(name for name, written in before.items() if now.get(name) != written)
            kills.append(Kill(number, seconds, len(before), len(unfinished), tuple(repeated), ()))
        differing = differences(folder, reference)
        yield from (kill._replace(differing=differing) for kill in kills)


def random_times(number, generator, duration):
    """Conditions that hold after random times, of a study that takes so long."""
    for _ in range(number):
        until = generator.uniform(0.0, duration)
        yield lambda seconds, until=until: seconds > until


def table(kills):
    """Kills as a Markdown table."""
    lines = [
        "| kill | after (s) | finished | unfinished | repeated needlessly | differences |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {k.number} | {k.seconds:.2f} | {k.finished} | {k.unfinished} "
        f"| {', '.join(k.repeated) or 0} | {', '.join(k.differing) or 0} |"
        for k in kills
    ]
    return "\n".join(lines)


def main():
    """Run the kills asked for, print the table, save it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1, help="of the random times (%(default)s)")
    parser.add_argument("--out", type=Path, default=Path("results/faults.md"))
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        reference = copy_project(Path(scratch) / "reference")
        folder = copy_project(Path(scratch) / "killed", compiled=False)  # kills also hit the compiler
        duration = run_study(reference).seconds
        kills = []
        times = random_times(chosen.kills, random.Random(chosen.seed), duration)
        for kill in kill_and_run_again(folder, reference, times):
            kills.append(kill)
            print(table([kill]).splitlines()[-1], flush=True)
    bad = [kill for kill in kills if kill.repeated or kill.differing]
    told = (
        f"{len(kills)} kills between {min(k.seconds for k in kills):.1f} s and "
        f"{max(k.seconds for k in kills):.1f} s of a study of {duration:.1f} s (seed {chosen.seed}): "
        f"{sum(k.unfinished for k in kills)} unfinished outputs, "
        f"{sum(len(k.repeated) for k in kills)} finished outputs repeated, "
        f"{sum(len(k.differing) for k in kills)} differences"
    )
    chosen.out.parent.mkdir(parents=True, exist_ok=True)
    chosen.out.write_text(f"{told}\n\n{table(kills)}\n", encoding="utf-8")
    print(told)
    sys.exit(bool(bad))


if __name__ == "__main__":
    main()
