"""Surroundings of a job: its progress, its log file, and the engine of its Fourier transforms.

The library reports progress to any callable ``progress(done, total)``. `ProgressBar` is the callable that the
study and the command line pass to it: a bar on a terminal, a few lines in a log file.
"""

import logging
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

from tqdm import tqdm

from asperity.fourier import fft_engine

logger = logging.getLogger("asperity")

SECONDS_BETWEEN_LINES = 10.0
"""Least time between two lines in a log file."""


class ProgressBar:
    """A progress bar if stderr is a terminal; otherwise or in a log a line at most every ten seconds.

    Parameters
    ----------
    label : str
        Name of the work, shown before the bar.
    """

    def __init__(self, label: str) -> None:
        self._label = label
        self._began = self._last = time.monotonic()
        tqdm.monitor_interval = 0  # no thread that watches bars: a process with threads is not forked
        self._bar = tqdm(
            desc=label,
            total=1.0,
            leave=False,
            dynamic_ncols=True,
            bar_format="{desc}: {percentage:3.0f}% |{bar}| {elapsed} < {remaining}",
            disable=not sys.stderr.isatty(),
        )

    def __enter__(self) -> "ProgressBar":
        logger.info("%s: begun", self._label)
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        self._bar.close()
        outcome = "done" if kind is None else "failed"
        elapsed, processor = time.monotonic() - self._began, time.process_time()
        logger.info("%s: %s after %.1f s, %.1f s of processor time", self._label, outcome, elapsed, processor)

    def __call__(self, done: float, total: float) -> None:
        """Report that `done` of `total` is finished."""
        part = min(max(done / total, 0.0), 1.0) if total > 0 else 1.0
        self._bar.update(part - self._bar.n)
        now = time.monotonic()
        if now - self._last >= SECONDS_BETWEEN_LINES:
            self._last = now
            elapsed = now - self._began
            line = f"{self._label}: {100 * part:3.0f} % after {elapsed:.0f} s"
            if part > 0:
                line += f", about {elapsed * (1 - part) / part:.0f} s left"
            if logger.isEnabledFor(logging.INFO):
                logger.info(line)
            elif self._bar.disable:  # of a command whose output is not a terminal
                print(line, file=sys.stderr, flush=True)


@contextmanager
def job(snakemake: Any) -> Iterator[ProgressBar]:
    """Run the block as a job of Snakemake, and give it its progress to report to.

    Parameters
    ----------
    snakemake : snakemake.script.Snakemake
        Object of a script; the job has a log, and may have a parameter ``fft_engine``.
    """
    log_to(snakemake.log[0])
    engine = snakemake.params.get("fft_engine")
    with (
        ProgressBar(" ".join([snakemake.rule, *snakemake.wildcards])) as progress,
        fft_engine(engine) if engine else nullcontext(),
    ):
        yield progress


def log_to(path: str | os.PathLike[str]) -> None:
    """Send everything that this process and its programs print, log and warn of to a file, until it ends."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        for stream in filter(None, (sys.stdout, sys.stderr)):  # None is closed
            stream.flush()
            os.dup2(file.fileno(), stream.fileno())
    logging.basicConfig(stream=sys.stderr, format="%(asctime)s %(levelname)s %(message)s")
    logging.getLogger("asperity").setLevel(logging.INFO)
    logging.captureWarnings(True)
