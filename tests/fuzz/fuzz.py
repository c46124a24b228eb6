"""Random search for input that is answered wrongly: python tests/fuzz/fuzz.py --minutes 10 --seed 1

Prints a table of every property of `properties.py` and what became of the inputs that were tried: a result,
or the exception by which they were refused; and for every defect how often it was met, a smallest example,
and where it was raised. The exit status is 1 if there is one.

Results must be finite and keep their promises. Wrong input must be refused by an exception of the package, or
by a ValueError or TypeError that the package itself raises. No input may take longer than `SECONDS` or more
than `BYTES` of memory (Windows: without these limits).
"""

import argparse
import contextlib
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
import pandas as pd
import psutil
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis.errors import Flaky
from inputs import LONGEST_MESSAGE, PromiseError
from properties import PROPERTIES

import asperity as asp
from asperity.core import errors

try:
    import resource
except ImportError:  # Windows
    resource = None

EXAMPLES = 40
"""Inputs that one round tries of each property."""

SECONDS = 60
BYTES = 4 * 2**30

PACKAGE = str(Path(asp.__file__).parent)
OWN = tuple(kind for kind in vars(errors).values() if isinstance(kind, type) and issubclass(kind, Exception))


class DefectError(AssertionError):
    """Base of the exceptions that stand for a defect each: hypothesis tells defects apart by their class."""


class SlowError(BaseException):
    """An input that takes too long; not an `Exception`, which the package might take for a refusal."""


def stop(*_):
    """Signal handler that ends an input that takes too long."""
    raise SlowError(f"longer than {SECONDS} s")


@contextlib.contextmanager
def limits():
    """Raise `SlowError` or `MemoryError` in a block that takes more time, or more memory than before."""
    if resource is None:
        yield
        return
    used = psutil.Process().memory_info().vms
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, SECONDS)
    resource.setrlimit(resource.RLIMIT_AS, (used + BYTES, hard))
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
        self.outcomes, self.defects = Counter(), Counter()
        self.examples, self.kinds = {}, {}

    def round(self, number, ends):
        """Try some inputs, and find the smallest that show defects which no earlier round has shown."""
        known, seen = set(self.defects), {}

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
                seen[text] = self.attempt(case) if time.monotonic() < ends else None
            if (defect := seen[text]) is not None and defect not in known:
                self.examples[defect] = min(self.examples.get(defect, text), text, key=len)
                raise self.kinds.setdefault(defect, type("DefectError", (DefectError,), {}))(defect)

        with warnings.catch_warnings(), open(os.devnull, "w") as nowhere:
            warnings.simplefilter("ignore")
            with contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
                try:
                    probe()
                except* (DefectError, Flaky):
                    pass

    def attempt(self, case):
        """Try an input; its defect as one line, or None."""
        try:
            with limits(), np.errstate(all="ignore"):
                outcome, defect = self.function(case), None
        except (Exception, SlowError) as error:
            defect = defect_of(error)
            outcome = type(error).__name__ if defect is None else "DEFECT"
            gc.collect()
        self.outcomes[outcome] += 1
        if defect is not None:
            self.defects[defect] += 1
        return defect


def defect_of(error):
    """A defect as one line: its kind, and where it was raised; None for a refusal of the package's own.

    A ValueError or TypeError is the package's own if the last line of its traceback is a ``raise`` of the
    package: those of compiled functions have a line of the package as their last one too, which calls them.
    """
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if frame.filename.startswith(PACKAGE)]
    is_raised = ours and frames[-1] is ours[-1] and (frames[-1].line or "").startswith("raise ")
    if isinstance(error, OWN) or (isinstance(error, (ValueError, TypeError)) and is_raised):
        lines = getattr(error, "lines", [str(error)])
        if all(line.isprintable() and 0 < len(line) < LONGEST_MESSAGE for line in lines):
            return None
    if isinstance(error, PromiseError):
        return str(error)
    origin = f"{Path(ours[-1].filename).relative_to(PACKAGE)}:{ours[-1].name}" if ours else "outside"
    first = re.sub(r"[0-9]+", "0", str(error).splitlines()[0])[:80] if str(error) else ""
    return f"{type(error).__name__} in {origin}: {first}"


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
    searches = [Search(name) for name in chosen.only]
    ends, rounds = time.monotonic() + 60 * chosen.minutes, 0
    with contextlib.suppress(KeyboardInterrupt):
        while time.monotonic() < ends:
            for search in searches:
                # Finding the smallest example of a defect may take a fifth of the time.
                search.round(1000 * number + rounds, min(ends, time.monotonic() + 12 * chosen.minutes))
            rounds += 1
    table = pd.DataFrame({search.name: search.outcomes for search in searches}).T.fillna(0).astype(int)
    print(table.to_string())
    for search in searches:
        for defect, times in search.defects.most_common():
            print(f"\n{search.name}, {times} times: {defect}\n    {search.examples.get(defect, '')[:1500]}")
    sys.exit(any(search.defects for search in searches))


if __name__ == "__main__":
    main()
