"""Progress of work, shown to the user: a bar on a terminal, a few lines in a log file.

The library reports progress to any callable ``progress(done, total)``. `ProgressBar` is the callable that the
study and the command line pass to it.
"""

from __future__ import annotations

import logging
import sys
import time

from tqdm import tqdm

logger = logging.getLogger("asperity")

SECONDS_BETWEEN_LINES = 10.0
"""Least time between two lines in a log file."""


class ProgressBar:
    """A progress bar if stderr is a terminal; in any case a log line at most every ten seconds.

    Parameters
    ----------
    label : str
        Name of the work, shown before the bar.
    """

    def __init__(self, label: str) -> None:
        self._label = label
        self._began = self._last = time.monotonic()
        self._bar = tqdm(
            desc=label,
            total=1.0,
            leave=False,
            dynamic_ncols=True,
            bar_format="{desc}: {percentage:3.0f}% |{bar}| {elapsed} < {remaining}",
            disable=not sys.stderr.isatty(),
        )

    def __enter__(self) -> ProgressBar:
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
            logger.info("%s: %3.0f %% after %.0f s", self._label, 100 * part, now - self._began)
