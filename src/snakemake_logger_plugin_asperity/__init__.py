"""Terminal output of the study: a line of progress and what went wrong, not all of Snakemake's messages.

A logger plugin of Snakemake, which finds it by the name of this package; `profiles/default` selects it.
With ``--verbose`` and in a dry run all messages are shown in Snakemake's own form. The complete messages of
every run are in any case in ``.snakemake/log``.

https://snakemake.github.io/snakemake-plugin-catalog describes logger plugins.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from logging import WARNING, LogRecord
from typing import Any

from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from asperity.runtime.logs import error_in, error_of

__all__ = ["LogHandler"]

PROGRESS_LINES = 10
"""Lines of progress that a run prints if there is no terminal."""

BAR_FORMAT = "study: {n_fmt} of {total_fmt} jobs |{bar}| {elapsed} < {remaining}{postfix}"

PREPARATION = ("Assuming unrestricted shared filesystem usage", "Building DAG of jobs", "Config file ")
"""Beginnings of messages before a run that are not shown."""

SHOWN = ("study:", "plan:", "Nothing to be done")
"""Beginnings of ordinary messages that are shown: those of the study, and one of Snakemake."""

ADVICE = "For further error details"
"""Beginning of what Snakemake adds to the reason for which a job failed on a cluster."""

REPEATED = (
    "CalledProcessError",
    "At least one job did not complete",
    "Exiting because a job execution failed",
)
"""Parts of Snakemake's messages that say no more than the line about the failed job."""


class LogHandler(LogHandlerBase):
    """Handler of the messages of one run of Snakemake."""

    writes_to_stream = True
    writes_to_file = False
    has_filter = False
    has_formatter = False
    needs_rulegraph = False

    def __post_init__(self) -> None:
        self._stream = sys.stdout if self.common_settings.stdout else sys.stderr
        self._complete = self.common_settings.verbose or self.common_settings.dryrun
        self._running = False
        self._active: dict[int, str] = {}
        self._total = 0
        self._lines = 0
        self._bar: Any = None
        self._failures: list[str] = []
        self._printed_last = ""

    def emit(self, record: LogRecord) -> None:
        """Show a message of Snakemake, or what the study says instead of it."""
        try:
            if self._complete:
                self._print(self.format(record))
            else:
                self._show(record)
        except Exception:
            self.handleError(record)

    def close(self) -> None:
        """End the output: the failures last, if anything has been printed after them."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None
        if self._failures and self._printed_last != self._failures[-1]:
            self._print(*self._failures)
        super().close()

    def _show(self, record: LogRecord) -> None:
        """Handle one message of a run."""
        event: str | None = getattr(record, "event", None)
        told: dict[str, Any] = record.__dict__
        if event == LogEvent.WORKFLOW_STARTED:
            self._running = True
        elif event == LogEvent.RUN_INFO:
            self._total = told["stats"]["total"]
        elif event == LogEvent.JOB_INFO:
            self._start(told)
        elif event == LogEvent.JOB_FINISHED:
            self._active.pop(told["job_id"], None)
        elif event == LogEvent.PROGRESS:
            self._advance(told["done"], told["total"])
        elif event == LogEvent.JOB_ERROR:
            if not told["indent"]:  # jobs of a group are told with their group
                self._fail([told], (told["rule_msg"] or "").partition(ADVICE)[0].strip())
        elif event == LogEvent.GROUP_ERROR:
            self._fail(told["job_error_info"], logs=told["aux_logs"])
        elif event in (None, LogEvent.ERROR) and self._is_shown(record):
            self._print(self.format(record))

    def _is_shown(self, record: LogRecord) -> bool:
        """True for warnings and errors, for messages of the study, and for other commands than a run."""
        text = record.getMessage()
        if record.levelno >= WARNING:
            return not any(words in text for words in REPEATED)
        return text.startswith(SHOWN) if self._running else not text.startswith(PREPARATION)

    def _start(self, job: dict[str, Any]) -> None:
        """Show that a job runs, and print the message of its rule if it has one."""
        if job["rule_msg"]:
            self._print(f"study: {job['rule_msg']}")
        self._active[job["jobid"]] = " ".join([job["rule_name"], *map(str, job["wildcards"].values())])
        if self._bar is None and self._stream.isatty():
            # Imported here: if it is missing, the checks before the run say so.
            from tqdm import tqdm

            self._bar = tqdm(
                total=self._total, file=self._stream, leave=False, dynamic_ncols=True, bar_format=BAR_FORMAT
            )
        self._refresh()

    def _advance(self, done: int, total: int) -> None:
        """Show that so many of all jobs are finished."""
        if self._bar is not None:
            self._bar.n, self._bar.total = done, total
            self._refresh()
        elif PROGRESS_LINES * done // total > self._lines:
            self._lines = PROGRESS_LINES * done // total
            self._print(f"study: {done} of {total} jobs done ({100 * done // total} %)")

    def _refresh(self) -> None:
        """Draw the bar with the names of the jobs that run."""
        if self._bar is not None:
            self._bar.set_postfix_str("; ".join(self._active.values()))

    def _fail(self, jobs: list[dict[str, Any]], reported: str = "", logs: Sequence[str] = ()) -> None:
        """Print why a job failed, or a group of jobs that ran one after another."""
        found = [error_in(job["log"], job["output"][0]) for job in jobs if job["output"]]
        lines = [line for line in found if line is not None]
        if not lines:
            first = jobs[0]
            lines = [error_of([*first["log"], *logs], ", ".join(first["output"][:1]), reported)]
        self._failures += [f"study: {line}" for line in lines]
        self._print(*self._failures[-len(lines) :])

    def _print(self, *lines: str) -> None:
        """Print lines above the bar."""
        for line in lines:
            if line not in ("", "None"):  # Snakemake's formatter has nothing to say of some messages
                if self._bar is None:
                    print(line, file=self._stream)
                else:
                    self._bar.write(line, file=self._stream)
                self._printed_last = line
        self._stream.flush()
