"""A small study with faults at random, finished after each and compared with an undisturbed run.

    python tests/workflow/soak.py --minutes 60 --seed 1

Faults: all processes are killed; the study is interrupted; its files may not grow beyond some size, as on a
full disk; results are lost; a result is damaged; a setting is changed and changed back. Prints a line for
each fault and a table by kind. Ends with exit status 1 if a study did not finish, if a damage was not
named, if an interrupt took too long, or if a result differs from that of the undisturbed run.
"""

import argparse
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from functools import partial
from pathlib import Path
from typing import NamedTuple

import psutil
from faults import COMPARED
from project import copy_project, environment

from asperity.results import dataset

RESULTS = "results/soak"
CONFIG = "tests/workflow/soak.yaml"
STUDY = ("snakemake", "--cores", "2", "--configfile", CONFIG)
VERIFY = ("python", "workflow/verify.py", RESULTS)

LONGEST_END = 10.0
"""Seconds in which an interrupted study must end."""

CHANGES = (
    "statistics: {bins: 7}",
    "contact: {area_fraction: 0.07}",
    "seeds: [2]",
    "stress: {depth_spacing: 1.0}",
    "surfaces: {one: {label: other}}",
    "layer: {poisson: 0.2}",
)
"""Overlays on the study."""


class Ran(NamedTuple):
    """How a run ended, and what it printed; the status is negative after a kill."""

    status: int
    text: str
    seconds_to_end: float = 0.0


def run(folder, command=STUDY, *, after=None, number=signal.SIGKILL, limit=None):
    """Run a command; `after` so many seconds send it a signal, SIGKILL to all its processes.

    With a `limit`, none of its processes can write files of more bytes.
    """
    log = folder / "soak.log"
    seconds = 0.0
    forbid = None
    if limit is not None:
        forbid = partial(resource.setrlimit, resource.RLIMIT_FSIZE, (limit, limit))
    with open(log, "w", encoding="utf-8") as file:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment(folder),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            preexec_fn=forbid,
            text=True,
        )
        if after is not None:
            try:
                process.wait(after)
            except subprocess.TimeoutExpired:
                began = time.monotonic()
                if number == signal.SIGKILL:
                    os.killpg(process.pid, number)
                else:
                    process.send_signal(number)
                process.wait()
                seconds = time.monotonic() - began
        text = process.communicate()[0]
        file.write(text)
    return Ran(process.returncode, text, seconds)


def files(folder):
    """Result files of the study, and unfinished ones."""
    place = folder / RESULTS
    return sorted(
        path
        for path in place.rglob("*")
        if path.suffix in (*COMPARED, ".html", ".md", ".txt", ".unfinished")
        and path.relative_to(place).parts[0] != "log"
    )


def differences(folder, reference):
    """Names of results that differ from those of the undisturbed run."""
    mine, other = ({path.relative_to(f / RESULTS): path for path in files(f)} for f in (folder, reference))
    differing = {str(name) for name in mine.keys() ^ other.keys()}
    for name in mine.keys() & other.keys():
        same = mine[name].read_bytes() == other[name].read_bytes()
        if not same and name.suffix == ".nc":
            same = dataset.read(mine[name]).identical(dataset.read(other[name]))
        if not same:
            differing.add(str(name))
    return sorted(differing)


def left_running(folder):
    """Numbers of processes that work in a folder."""
    found = []
    for process in psutil.process_iter():
        try:
            if process.cwd() == str(folder) and process.status() != psutil.STATUS_ZOMBIE:
                found.append(process.pid)
        except (psutil.AccessDenied, psutil.NoSuchProcess):
            continue
    return found


class Soak:
    """A study under faults.

    Parameters
    ----------
    folder, reference : path
        Copies of the project, in both of which the study has run; the second stays as it is.
    generator : random.Random
    duration : float
        Seconds that the study takes.
    """

    def __init__(self, folder, reference, generator, duration):
        self.folder, self.reference = folder, reference
        self.generator, self.duration = generator, duration

    def lose(self, share):
        """Delete a random part of the results; at share 1 everything, with Snakemake's records."""
        if share >= 1:
            for name in ("results", ".snakemake"):
                shutil.rmtree(self.folder / name, ignore_errors=True)
            return
        paths = files(self.folder)
        for path in self.generator.sample(paths, max(1, int(share * len(paths)))):
            path.unlink()

    def killed(self):
        """All processes of the study end at once."""
        self.lose(self.generator.choice([0.2, 0.6, 1]))
        run(self.folder, after=self.generator.uniform(0, self.duration))
        return []

    def interrupted(self):
        """Ctrl-C or SIGTERM; what else happened than that the study ended with its line."""
        self.lose(self.generator.choice([0.2, 0.6, 1]))
        number = self.generator.choice([signal.SIGINT, signal.SIGTERM])
        ran = run(self.folder, after=self.generator.uniform(4, 4 + self.duration), number=number)
        wrong = []
        if ran.seconds_to_end:
            last = (ran.text.splitlines() or [""])[-1]
            if ran.status == 128 + number:
                wrong += [] if last.startswith("study: interrupted; ") else [f"last line {last!r}"]
            elif ran.status not in (0, -number):  # it had ended, or not yet read its Snakefile
                wrong.append(f"status {ran.status}: {last!r}")
            wrong += (
                ["unfinished files"] if any(p.suffix == ".unfinished" for p in files(self.folder)) else []
            )
        if ran.seconds_to_end > LONGEST_END:
            wrong.append(f"ended after {ran.seconds_to_end:.1f} s")
        if left := left_running(self.folder):
            wrong.append(f"processes left: {left}")
        return wrong

    def full_disk(self):
        """No file can be written beyond some size."""
        self.lose(self.generator.choice([0.2, 0.6, 1]))
        sizes = [path.stat().st_size for path in files(self.reference)]
        run(self.folder, limit=self.generator.randint(500, max(sizes)))
        return []

    def lost(self):
        """Results are deleted."""
        self.lose(self.generator.uniform(0, 0.9))
        return []

    def damaged(self):
        """A byte of a result is changed, or all are gone; it must be named, and is then deleted."""
        path = self.generator.choice(files(self.folder))
        content = bytearray(path.read_bytes())
        if self.generator.random() < 0.3:
            content = b""
        else:
            content[self.generator.randrange(len(content))] ^= 1 << self.generator.randrange(8)
        path.write_bytes(content)
        name = path.relative_to(self.folder)
        said = run(self.folder, VERIFY)
        path.unlink()
        named = any(line.startswith(f"verify: {name}: ") for line in said.text.splitlines())
        return [] if named else [f"{name}: not named: {said.text!r}"]

    def changed(self):
        """A setting is changed in the same folder, and changed back; results of another seed are deleted."""
        (self.folder / "changed.yaml").write_text(
            f"{self.generator.choice(CHANGES)}\nresults: {RESULTS}\n", encoding="utf-8"
        )
        ran = run(self.folder, (*STUDY, "changed.yaml"))
        for path in files(self.folder):
            if not (self.reference / path.relative_to(self.folder)).exists():
                path.unlink()
        return [f"status {ran.status}: {ran.text[-300:]!r}"] if ran.status else []

    def round(self, kind):
        """One fault, then the study to its end; what went wrong."""
        wrong = getattr(self, kind)()
        ran = run(self.folder)
        if ran.status:
            wrong.append(f"not finished: {ran.text.splitlines()[-1:]}")
        wrong += [f"{name} differs" for name in differences(self.folder, self.reference)]
        ran = run(self.folder, (*STUDY, "--dry-run"))
        if "Nothing to be done" not in ran.text:
            wrong.append("not everything was made")
        return wrong


KINDS = ("killed", "interrupted", "full_disk", "lost", "damaged", "changed")


def main():
    """Make faults for the time given, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    generator = random.Random(chosen.seed)
    until = time.monotonic() + 60 * chosen.minutes
    counts, failures = Counter(), Counter()
    with tempfile.TemporaryDirectory() as scratch:
        reference, folder = Path(scratch) / "reference", Path(scratch) / "project"
        copy_project(reference)
        began = time.monotonic()
        if (ran := run(reference)).status:
            sys.exit(f"the study did not finish:\n{ran.text}")
        soak = Soak(shutil.copytree(reference, folder), reference, generator, time.monotonic() - began)
        print(f"seed {chosen.seed}; the study takes {soak.duration:.0f} s", flush=True)
        kinds = []
        while time.monotonic() < until:
            kinds = kinds or generator.sample(KINDS, len(KINDS))
            kind = kinds.pop()
            wrong = soak.round(kind)
            counts[kind] += 1
            failures[kind] += bool(wrong)
            print(f"{kind}: {'; '.join(wrong) or 'as undisturbed'}", flush=True)
            if wrong:
                shutil.rmtree(folder)
                shutil.copytree(reference, folder)
    print("\n| fault | number | failures |\n|---|---|---|")
    print("\n".join(f"| {kind.replace('_', ' ')} | {counts[kind]} | {failures[kind]} |" for kind in KINDS))
    sys.exit(bool(sum(failures.values())))


if __name__ == "__main__":
    main()
