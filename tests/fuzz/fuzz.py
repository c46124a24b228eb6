"""Random search for input that is answered wrongly: python tests/fuzz/fuzz.py --minutes 10 --seed 1

Prints a table of every property of `properties.py` and what became of the inputs that were tried: a result,
or the exception by which they were refused; and for every defect how often it was met, a smallest example,
and where it was raised. The exit status is 1 if there is one.

Results must be finite and keep their promises. Wrong input must be refused by an exception of the package, or
by a ValueError or TypeError that the package itself raises. No input may take longer than `TIMES` contacts of
64 × 64 nodes, measured on the machine as it is at that moment, or more than four gigabytes of memory.
"""

import argparse
import contextlib
import faulthandler
import gc
import os
import random
import re
import signal
import sys
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
import psutil
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis.errors import Flaky
from inputs import LONGEST_MESSAGE, PromiseError
from properties import PROPERTIES

import asperity as asp
from asperity import errors
from asperity.surface.height_map import MapError

try:
    import resource
except ImportError:  # Windows, where inputs are tried without limits
    resource = None

EXAMPLES = 40
"""Inputs that one round tries of each property."""

LARGEST_SHARE = 0.2
"""Part of the whole time that one round may take to find the smallest example of a defect."""

TIMES = 3000
"""Time that one input may take, in times of one contact of 64 × 64 nodes."""

LEAST_SECONDS = 30
"""The same, at least: compiling a function takes longer than a contact."""

BYTES = 4 * 2**30
"""Memory that one input may take."""

PACKAGE = str(Path(asp.__file__).parent)
OWN = (
    errors.ConfigError,
    errors.ConvergenceError,
    errors.DatasetError,
    errors.PlanError,
    errors.PreflightError,
)


class DefectError(AssertionError):
    """Base of the exceptions that stand for a defect each."""


class SlowError(BaseException):
    """An input that takes too long; not an `Exception`, which the package might take for a refusal."""


def stop(*_):
    """Signal handler that ends an input that takes too long."""
    raise SlowError("longer than is accepted")


def accepted_seconds():
    """Seconds that one input may take while the machine is as busy as it is now."""
    height = np.random.default_rng(0).standard_normal((64, 64))
    begin = time.perf_counter()
    asp.solve(height, asp.Layer(1.0, 0.3), area_fraction=0.1)
    return max(LEAST_SECONDS, TIMES * (time.perf_counter() - begin))


@contextlib.contextmanager
def limits(seconds, size):
    """Raise `SlowError` or `MemoryError` in a block that takes more time, or more memory than before."""
    if resource is None:
        yield
        return
    used = psutil.Process().memory_info().vms
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    resource.setrlimit(resource.RLIMIT_AS, (used + size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (hard, hard))
        signal.setitimer(signal.ITIMER_REAL, 0)


class Search:
    """The search of one property: outcomes, defects, and a smallest example of each."""

    def __init__(self, name):
        self.name = name
        self.strategy, self.function = PROPERTIES[name]
        self.outcomes = Counter()
        self.defects = Counter()
        self.examples = {}
        self.kinds = {}  # a class of exception for each defect: hypothesis tells defects apart by it
        self.known = set()
        self.ends = 0.0
        self.seconds = float(LEAST_SECONDS)

    def round(self, number, ends):
        """Try some inputs, and find the smallest that show defects which no earlier round has shown."""
        self.ends = ends
        self.known = set(self.defects)
        self.seconds = accepted_seconds()
        seen = {}

        @seed(number)
        @settings(
            max_examples=EXAMPLES,
            deadline=None,
            database=None,
            derandomize=False,
            phases=(Phase.generate, Phase.shrink),
            suppress_health_check=list(HealthCheck),
            print_blob=False,
        )
        @given(self.strategy)
        def probe(case):
            text = repr(case)
            if text not in seen:
                # After the time is over only the examples found are shown again, which ends the shrinking.
                seen[text] = self.attempt(case) if time.monotonic() < self.ends else None
            if (defect := seen[text]) is not None and defect not in self.known:
                self.keep(defect, text)
                raise self.kinds.setdefault(defect, type("DefectError", (DefectError,), {}))(defect)

        with warnings.catch_warnings(), open(os.devnull, "w") as nowhere:
            warnings.simplefilter("ignore")
            with contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
                try:
                    probe()
                except* (DefectError, Flaky):
                    pass

    def keep(self, defect, text):
        """Keep the shortest example of a defect."""
        if len(text) < len(self.examples.get(defect, text + " ")):
            self.examples[defect] = text

    def attempt(self, case):
        """Try an input; its defect as one line, or None."""
        try:
            with limits(self.seconds, BYTES), np.errstate(all="ignore"):
                outcome = self.function(case)
        except (Exception, SlowError) as error:
            defect = defect_of(error)
            if defect is None:
                self.outcomes[type(error).__name__] += 1
                return None
            if isinstance(error, MemoryError):
                gc.collect()
            self.outcomes["DEFECT"] += 1
            self.defects[defect] += 1
            return defect
        self.outcomes[outcome] += 1
        return None


def defect_of(error):
    """A defect as one line: its kind, and where it was raised; None for a refusal of the package's own.

    A ValueError or TypeError is the package's own if one of its lines raises it: those of compiled functions
    of Python and NumPy have a line of the package as their last one too, which calls them.
    """
    last = traceback.extract_tb(error.__traceback__)[-1]
    ours = last.filename.startswith(PACKAGE) and (last.line or "").startswith("raise ")
    if isinstance(error, OWN) or (
        type(error) in (ValueError, TypeError, MapError) and ours and is_message(error)
    ):
        return None
    if isinstance(error, PromiseError):
        return f"{error}"
    frames = [
        frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename.startswith(PACKAGE)
    ]
    place = f"{Path(frames[-1].filename).relative_to(PACKAGE)}:{frames[-1].name}" if frames else "outside"
    first = re.sub(r"[0-9]+", "0", str(error).splitlines()[0])[:80] if str(error) else ""
    return f"{type(error).__name__} in {place}: {first}"


def is_message(error):
    """True for one line that is not too long, as all messages of the package are, or one for each problem."""
    lines = error.lines if isinstance(error, errors.InputError) else [str(error)]
    return all(line.isprintable() and 0 < len(line) < LONGEST_MESSAGE for line in lines)


def report(searches):
    """Outcomes and defects as text."""
    outcomes = sum((search.outcomes for search in searches), Counter())
    columns = [name for name, _ in outcomes.most_common()]
    widths = [max(len(name), 6) for name in columns]
    lines = [
        "  ".join(["property   ", " tried", *(f"{c:>{w}}" for c, w in zip(columns, widths, strict=True))])
    ]
    for search in [*searches, None]:
        counts = outcomes if search is None else search.outcomes
        cells = (f"{counts[c] or '':>{w}}" for c, w in zip(columns, widths, strict=True))
        name = "all" if search is None else search.name
        lines.append("  ".join([f"{name:11}", f"{sum(counts.values()):6}", *cells]))
    for search in searches:
        for defect, count in search.defects.most_common():
            lines += [
                "",
                f"{search.name}, {count} times: {defect}",
                f"    {search.examples.get(defect, '')[:1500]}",
            ]
    return "\n".join(lines)


def main():
    """Search for so many minutes, and print the report."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--seed", type=int, help="by default a random one, which is printed")
    parser.add_argument("--only", nargs="+", choices=PROPERTIES, default=list(PROPERTIES))
    chosen = parser.parse_args()
    number = random.randrange(10**6) if chosen.seed is None else chosen.seed
    print(f"fuzz: {chosen.minutes:g} minutes, seed {number}", flush=True)
    faulthandler.enable()
    searches = [Search(name) for name in chosen.only]
    ends = time.monotonic() + 60 * chosen.minutes
    rounds = 0
    with contextlib.suppress(KeyboardInterrupt):
        while time.monotonic() < ends:
            for search in searches:
                share = time.monotonic() + LARGEST_SHARE * 60 * chosen.minutes
                search.round(1000 * number + rounds, min(ends, share))
            rounds += 1
    print(report(searches))
    sys.exit(any(search.defects for search in searches))


if __name__ == "__main__":
    main()
