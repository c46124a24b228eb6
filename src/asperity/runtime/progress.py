"""How long work will take, told to a person: a bar on a terminal, sparse lines in a log file.

The library reports progress to any callable ``progress(done, total)``; `Progress` is the one the
study and the command line use. `record` gives a job its log file.
"""

from __future__ import annotations

import contextlib
import logging
import os
import resource
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

from tqdm import tqdm

logger = logging.getLogger("asperity")

_SECONDS_BETWEEN_LINES = 10.0


class Progress:
    """A bar with the remaining time if the terminal is one, else a log line every ten seconds.

    Parameters
    ----------
    label : str
        What is under way.
    """

    def __init__(self, label: str) -> None:
        self._label = label
        self._began = self._last = time.monotonic()
        self._bar: tqdm | None = None

    def __enter__(self) -> Progress:
        terminal = _terminal()
        if terminal is not None:
            self._bar = tqdm(
                desc=self._label,
                total=1.0,
                file=terminal,
                leave=False,
                dynamic_ncols=True,
                bar_format="{desc}: {percentage:3.0f}% |{bar}| {elapsed} < {remaining}",
            )
        logger.info("%s: begun", self._label)
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()
        outcome = "done" if kind is None else "failed"
        logger.info("%s: %s after %.1f s", self._label, outcome, time.monotonic() - self._began)

    def __call__(self, done: float, total: float) -> None:
        """Report that `done` of `total` is finished."""
        part = min(max(done / total, 0.0), 1.0) if total > 0 else 1.0
        if self._bar is not None:
            self._bar.n = part
            self._bar.refresh()
        now = time.monotonic()
        if now - self._last >= _SECONDS_BETWEEN_LINES:
            self._last = now
            remaining = (now - self._began) * (1 / part - 1) if part else float("nan")
            logger.info("%s: %3.0f %%, about %.0f s left", self._label, 100 * part, remaining)


_terminal_stream: TextIO | None = None


def _terminal() -> TextIO | None:
    """The person's terminal, kept aside by `record`, or stderr if that is one."""
    if _terminal_stream is not None:
        return _terminal_stream
    return sys.stderr if sys.stderr.isatty() else None


def _peak_memory() -> float:
    """Largest resident memory of this process so far, in MB; NaN where the system does not tell.

    That of the largest program it has run is added, where it is the larger one: a smaller one cannot be told
    from the copy of this process as which it began.
    """
    try:
        status = Path("/proc/self/status").read_text(encoding="utf-8")
    except OSError:
        return float("nan")
    (line,) = (line for line in status.splitlines() if line.startswith("VmHWM:"))
    own, other = int(line.split()[1]), resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    return (own + other if other > own else own) * 1024 / 1e6


def _processor_time() -> float:
    """Processor time of this process and of the programs it has run, in seconds."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


@contextlib.contextmanager
def record(log: str | os.PathLike[str]) -> Iterator[None]:
    """Send all this process prints, logs and warns of to the file `log`; errors go to both.

    A terminal stays in view for progress bars. An exception is written to the log whole, and as one
    line to where stderr was. The last line says what the process took.
    """
    global _terminal_stream
    path = Path(log)
    path.parent.mkdir(parents=True, exist_ok=True)
    sys.stdout.flush()
    sys.stderr.flush()
    outer = os.dup(2)
    with open(path, "w", encoding="utf-8") as file, os.fdopen(outer, "w", closefd=True) as screen:
        stdout = os.dup(1)
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
        _terminal_stream = screen if screen.isatty() else None
        handler = logging.StreamHandler(sys.stderr)
        handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
        logging.captureWarnings(True)
        logging.getLogger("py.warnings").addHandler(handler)
        try:
            yield
        except Exception as error:
            logger.exception("the job failed")
            print(f"{type(error).__name__}: {error} (whole story in {path})", file=screen, flush=True)
            raise SystemExit(1) from None
        finally:
            logger.info("took %.1f s of processor time, %.0f MB of memory", _processor_time(), _peak_memory())
            logging.captureWarnings(False)
            logging.getLogger("py.warnings").removeHandler(handler)
            logger.removeHandler(handler)
            sys.stdout.flush()
            sys.stderr.flush()
            os.dup2(stdout, 1)
            os.dup2(screen.fileno(), 2)
            os.close(stdout)
            _terminal_stream = None
