"""Log files of jobs: written by the job, and read again for the error that ended it."""

from __future__ import annotations

import contextlib
import logging
import os
import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from asperity.runtime.interrupts import terminable
from asperity.runtime.written import lines_about
from asperity.system import peak_memory_with_programs, processor_time

logger = logging.getLogger("asperity")

_ERROR = re.compile(r"^([\w.]*(?:Error|Exception|Warning|Interrupt)): (.+(?:\n  \S.*)*)$", re.MULTILINE)
"""End of a traceback: the name of the exception, and its message, of which further lines are indented."""

_STOPPED = "its job was stopped; memory, disk space or the time allowed may have run out"


@contextlib.contextmanager
def log_to(path: str | os.PathLike[str], outputs: Iterable[str | os.PathLike[str]] = ()) -> Iterator[None]:
    """Send to the file `path` everything that this process and its programs print, log and warn of.

    At the end, the fingerprints of the outputs that the job has written are added. An exception is written
    with its traceback and ends the process with exit status 1; SIGTERM ends it with 143. The last line states
    the processor time and the memory of the process.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    sys.stdout.flush()
    sys.stderr.flush()
    streams = {1: os.dup(1), 2: os.dup(2)}
    with open(path, "w", encoding="utf-8") as file:
        for stream in streams:
            os.dup2(file.fileno(), stream)
        handler = logging.StreamHandler(sys.stderr)
        handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
        loggers = (logger, logging.getLogger("py.warnings"))
        for each in loggers:
            each.addHandler(handler)
        logger.setLevel(logging.INFO)
        logging.captureWarnings(True)
        try:
            with terminable():
                yield
                for line in lines_about(outputs, path):
                    logger.info(line)
        except Exception:
            logger.exception("the job failed")
            raise SystemExit(1) from None
        finally:
            logger.info(
                "took %.1f s of processor time, %.0f MB of memory",
                processor_time(),
                peak_memory_with_programs(),
            )
            logging.captureWarnings(False)
            for each in loggers:
                each.removeHandler(handler)
            sys.stdout.flush()
            sys.stderr.flush()
            for stream, kept in streams.items():
                os.dup2(kept, stream)
                os.close(kept)


def error_in(logs: Iterable[str | os.PathLike[str]], output: str) -> str | None:
    """Last error in the first log that names one, as one line with the log's path; None without an error.

    An error of this package is stated by its message, other errors also by their name. The output of the job
    comes first, except before an error about another file.
    """
    for log in filter(os.path.exists, logs):
        text = Path(log).read_text(encoding="utf-8", errors="replace")
        if errors := _ERROR.findall(text):
            name, message = errors[-1]
            first, *further = message.split("\n  ")
            message = f"{first} {'; '.join(further)}".rstrip()
            stated = message if name.startswith("asperity.") else f"{message} ({name})"
            return f"{stated} [{log}]" if name.endswith(".DatasetError") else f"{output}: {stated} [{log}]"
    return None


def error_of(logs: Iterable[str], output: str, reported: str = "") -> str:
    """Reason for which a job failed, in one line.

    Parameters
    ----------
    logs : iterable of paths
        Logs of the job, its own first.
    output : path
        First file that the job makes.
    reported : str, optional
        Reason given by Snakemake or the cluster, used if the logs name no error.
    """
    logs = list(logs)
    written = [f" [{log}]" for log in logs if os.path.exists(log)]
    return error_in(logs, output) or f"{output}: {reported or _STOPPED}{''.join(written[-1:])}"
