"""Random search for input that is answered wrongly: python tests/fuzz/fuzz.py --minutes 10 --seed 1

Tries every property of `properties.py` in rounds, and prints a table of what became of the inputs: a result,
or the exception by which they were refused. A property that fails is reported with a smallest example and
left out of further rounds; the exit status is 1 then.

Results must be finite and keep their promises. Wrong input must be refused by an exception of the package, or
by a ValueError or TypeError that the package itself raises; input within the documented ranges must not be,
unless the documentation says which arguments do not go together (`DOCUMENTED`). No input may take longer than
`SECONDS` or more than `BYTES` of memory in all (Windows: without these limits).
"""

import argparse
import contextlib
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
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from inputs import LONGEST_MESSAGE, odd
from properties import DOCUMENTED, PROPERTIES

import asperity as asp
from asperity.core import errors

EXAMPLES = 40
"""Inputs that one round tries of each property."""

SECONDS = 60
BYTES = 6 * 2**30

PACKAGE = str(Path(asp.__file__).parent)
OWN = tuple(kind for kind in vars(errors).values() if isinstance(kind, type) and issubclass(kind, Exception))


class SlowError(BaseException):
    """An input that takes too long; not an `Exception`, which the package might take for a refusal."""


def stop(*_):
    """Signal handler that ends an input that takes too long."""
    raise SlowError(f"longer than {SECONDS} s")


def is_refusal(error):
    """True for a refusal of the package's own, in printable lines that are not too long.

    A ValueError or TypeError is the package's own if the last line of its traceback is a ``raise`` of the
    package: errors of compiled functions have a line of the package as their last one too, which calls them.
    """
    last = traceback.extract_tb(error.__traceback__)[-1]
    is_raised = last.filename.startswith(PACKAGE) and (last.line or "").startswith("raise ")
    lines = getattr(error, "lines", [str(error)])
    is_short = all(line.isprintable() and 0 < len(line) < LONGEST_MESSAGE for line in lines)
    return is_short and (isinstance(error, OWN) or (isinstance(error, (ValueError, TypeError)) and is_raised))


def is_documented(name, error):
    """True for a refusal that arguments within their ranges may meet."""
    if name not in DOCUMENTED or not isinstance(error, (ValueError, TypeError)):
        return True
    begins = "|".join(filter(None, DOCUMENTED[name].splitlines()))
    problems = error.problems if isinstance(error, errors.InputError) else [str(error)]
    return all(re.match(f"(.*: )?({begins})", problem, re.DOTALL) for problem in problems)


def searched(name, number, ends, outcomes):
    """Try some inputs of a property and count their outcomes; the report of a defect, empty without one."""
    strategy, function = PROPERTIES[name]

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
    @given(st.tuples(odd, strategy))
    def probe(drawn):
        is_odd, case = drawn
        if time.monotonic() > ends:
            return
        if hasattr(signal, "setitimer"):
            signal.setitimer(signal.ITIMER_REAL, SECONDS)
        try:
            with np.errstate(all="ignore"):
                outcomes[function(case) or "kept"] += 1
        except Exception as error:
            outcomes[type(error).__name__] += 1
            if not is_refusal(error) or not (is_odd or is_documented(name, error)):
                error.add_note(repr(case)[:1500])
                raise
        finally:
            if hasattr(signal, "setitimer"):
                signal.setitimer(signal.ITIMER_REAL, 0)

    with warnings.catch_warnings(), open(os.devnull, "w") as nowhere:
        warnings.simplefilter("ignore")
        with contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
            try:
                probe()
            except (Exception, SlowError) as error:
                return "".join(traceback.format_exception(error, limit=-4))
    return ""


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
    if os.name != "nt":
        import resource

        signal.signal(signal.SIGALRM, stop)
        resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    ends, rounds, defects = time.monotonic() + 60 * chosen.minutes, 0, {}
    outcomes = {name: Counter() for name in chosen.only}
    with contextlib.suppress(KeyboardInterrupt):
        while time.monotonic() < ends and len(defects) < len(chosen.only):
            for name in [name for name in chosen.only if name not in defects]:
                if report := searched(name, 1000 * number + rounds, ends, outcomes[name]):
                    defects[name] = report
            rounds += 1
    print(pd.DataFrame(outcomes).T.fillna(0).astype(int).to_string())
    for name, report in defects.items():
        print(f"\n{name}: {report}")
    sys.exit(bool(defects))


if __name__ == "__main__":
    main()
