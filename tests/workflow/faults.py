"""A small study killed at random times and run again: python tests/workflow/faults.py --kills 50

Prints a table with a row for every kill, and saves it as results/faults.md. Ends with 1 if a run did not
finish, if a finished job was repeated, or if a result differs from that of an undisturbed run.
"""

import argparse
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from base64 import urlsafe_b64decode
from pathlib import Path
from typing import NamedTuple

from project import TINY, copy_project, environment

from asperity.results import dataset

RESULTS = "results/tiny"
TARGETS = (
    f"{RESULTS}/figures/fig09.png",
    f"{RESULTS}/verification/hurst_08.csv",
)
STUDY = ("snakemake", "--cores", "2", *TINY, "--", *TARGETS)
COMPARED = (".nc", ".json", ".csv", ".png", ".pdf", ".rst")


class Kill(NamedTuple):
    """One kill, and what the next run of the same command did."""

    number: int
    seconds: float
    finished: int
    broken: int
    rerun: int
    repeated: tuple[str, ...]
    differing: tuple[str, ...]


class Run(NamedTuple):
    """How a run ended, and the first output of each job that it began."""

    killed: bool
    seconds: float
    begun: tuple[str, ...]
    text: str


def run_study(folder, kill_after=None):
    """Run the study in a process group of its own; kill the group after so many seconds."""
    log = folder / "study.log"
    began = time.monotonic()
    with open(log, "w", encoding="utf-8") as file:
        process = subprocess.Popen(
            STUDY,
            cwd=folder,
            env=environment(folder),
            stdout=file,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        try:
            process.wait(kill_after)
            killed = False
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            killed = True
    text = log.read_text(encoding="utf-8")
    if not killed and process.returncode:
        sys.exit(f"the study did not finish:\n{text}")
    begun = re.findall(r"^    output: ([^,\s]+)", text, re.MULTILINE)
    return Run(killed, time.monotonic() - began, tuple(begun), text)


def recorded(folder, kind):
    """The outputs of which Snakemake's own record says that they are finished, or not."""
    records = folder / ".snakemake" / kind
    names = (
        path.relative_to(records).as_posix().replace("/@", "").lstrip("@") for path in records.rglob("*")
    )
    return {urlsafe_b64decode(name).decode() for name in names if name != "migration_underway"}


def finished(folder):
    """Finished outputs, and when each was written."""
    done = recorded(folder, "metadata") - recorded(folder, "incomplete")
    return {name: (folder / name).stat().st_mtime_ns for name in done if (folder / name).exists()}


def differences(folder, reference):
    """Results that are not those of the undisturbed run, by name."""
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
    """All result files of the study, unfinished ones too."""
    return [
        path
        for path in (folder / RESULTS).rglob("*")
        if path.suffix in (*COMPARED, ".unfinished") and "log" not in path.parts
    ]


def kill_and_run_again(folder, reference, kills, generator, duration):
    """Kill the study at random times, each time running it again; start anew whenever it has finished.

    `folder` is a copy of the project without results, `reference` one in which the study has run
    undisturbed, within `duration` seconds. Yields a `Kill` for each.
    """
    number = 0
    while number < kills:
        subprocess.run(["rm", "-rf", str(folder / "results"), str(folder / ".snakemake")], check=True)
        pending = []
        run = run_study(folder, generator.uniform(0.0, duration))
        while run.killed:
            number += 1
            before, broken = finished(folder), recorded(folder, "incomplete")
            at = run.seconds
            after = generator.uniform(0.0, duration) if number < kills else None
            run = run_study(folder, after)
            now = finished(folder)
            repeated = {name for name, written in before.items() if now.get(name) != written}
            repeated |= before.keys() & set(run.begun)
            pending.append(
                Kill(
                    number,
                    at,
                    len(before),
                    len(broken),
                    len(broken & set(run.begun)),
                    tuple(sorted(repeated)),
                    (),
                )
            )
        differing = differences(folder, reference)
        yield from (kill._replace(differing=differing) for kill in pending)


def table(kills):
    """The kills for a reader."""
    lines = [
        "| kill | after (s) | finished | cut off | begun again | repeated needlessly | differences |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {k.number} | {k.seconds:.2f} | {k.finished} | {k.broken} | {k.rerun} "
        f"| {', '.join(k.repeated) or 0} | {', '.join(k.differing) or 0} |"
        for k in kills
    ]
    return "\n".join(lines)


def main():
    """Kill so many times, print, save."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1, help="of the times (%(default)s)")
    parser.add_argument("--out", type=Path, default=Path("results/faults.md"))
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        reference = copy_project(Path(scratch) / "reference")
        folder = copy_project(Path(scratch) / "killed", compiled=False)  # kills meet the compiler too
        duration = run_study(reference).seconds
        kills = []
        for kill in kill_and_run_again(folder, reference, chosen.kills, random.Random(chosen.seed), duration):
            kills.append(kill)
            print(table([kill]).splitlines()[-1], flush=True)
    bad = [kill for kill in kills if kill.repeated or kill.differing]
    told = (
        f"{len(kills)} kills between {min(k.seconds for k in kills):.1f} s and "
        f"{max(k.seconds for k in kills):.1f} s of a study of {duration:.1f} s (seed {chosen.seed}): "
        f"{sum(k.broken for k in kills)} outputs cut off, "
        f"{sum(len(k.repeated) for k in kills)} finished outputs repeated, "
        f"{sum(len(k.differing) for k in kills)} differences"
    )
    chosen.out.parent.mkdir(parents=True, exist_ok=True)
    chosen.out.write_text(f"{told}\n\n{table(kills)}\n", encoding="utf-8")
    print(told)
    sys.exit(bool(bad))


if __name__ == "__main__":
    main()
