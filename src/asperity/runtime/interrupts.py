"""Ctrl-C (SIGINT) and SIGTERM: commands and studies end in seconds, with one line that says how to go on.

Python runs a handler of a signal between two of its own instructions only, in the main thread. A command
therefore ends after the call of a compiled function that is under way. A study does not wait for its jobs.
"""

from __future__ import annotations

import _thread
import ctypes
import os
import signal
import sys
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any, NoReturn

SIGNALS = (signal.SIGINT, signal.SIGTERM)

GRACE = 5.0
"""Seconds in which a command ends; then its process is ended where it is."""

AGAIN = 1.0
"""Seconds after which the exception is raised again, if a library has ignored it."""

JOB_GRACE = 2.0
"""Seconds in which the jobs of a study delete their unfinished files; then they are killed."""

COMMAND_LINE = "interrupted, nothing is written; run the same command again to start over"

STUDY_LINE = "study: interrupted; finished results are kept, run the same command again to go on"


class Interrupted(KeyboardInterrupt):
    """Raised at a signal that ends a command.

    Attributes
    ----------
    status : int
        Exit status, as shells give it: 128 and the number of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.status = status_after(number)


def status_after(number: int) -> int:
    """Exit status of a process that a signal has ended, as shells give it."""
    return 128 + number


@contextmanager
def interruptible(line: str, *, last: bool = False) -> Iterator[None]:
    """Raise `Interrupted` at Ctrl-C and SIGTERM, as long as the block lasts.

    Whatever exception a library makes of it, `Interrupted` leaves the block; where a library ignores it, it
    is raised again. A process that has not ended some seconds later, as a long call is under way, deletes its
    unfinished files, prints the line and ends.

    Parameters
    ----------
    line : str
    last : bool, optional
        The process only ends after the block: then it ignores the signals.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    ended = threading.Event()
    came: list[int] = []
    earlier = {number: signal.getsignal(number) for number in SIGNALS}
    hook = sys.unraisablehook

    def watch(number: int) -> None:
        for _ in range(int(GRACE / AGAIN)):
            if ended.wait(AGAIN):
                return
            _thread.interrupt_main(signal.Signals(number))
        if not ended.wait(AGAIN):
            _end_process(line, number)

    def interrupt(number: int, _: FrameType | None) -> NoReturn:
        if not came:
            came.append(number)
            sys.unraisablehook = lambda _: None
            threading.Thread(target=watch, args=(number,), daemon=True).start()
        raise Interrupted(came[0])

    for number in SIGNALS:
        signal.signal(number, interrupt)
    try:
        yield
    except BaseException:
        if came:
            raise Interrupted(came[0]) from None
        raise
    finally:
        for number, handler in earlier.items():
            signal.signal(number, signal.SIG_IGN if came or last else handler)
        ended.set()
        sys.unraisablehook = hook
        if not last:
            for number, handler in earlier.items():
                signal.signal(number, handler)


@contextmanager
def terminable() -> Iterator[None]:
    """End a job at SIGTERM by `SystemExit`, which deletes its unfinished files, while the block lasts."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def end(number: int, _: FrameType | None) -> NoReturn:
        raise SystemExit(status_after(number))

    earlier = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, earlier)


def end_study_with_jobs() -> None:
    """From now on, end this process and its jobs at Ctrl-C and SIGTERM, whatever it is doing then.

    A thread waits for the signals, whose numbers Python writes into a pipe at once. The jobs that the process
    starts do not see Ctrl-C: they are ended by the thread.
    """
    if sys.platform == "win32" or threading.current_thread() is not threading.main_thread():
        return
    _adopt_orphans()
    incoming, outgoing = os.pipe()
    os.set_blocking(outgoing, False)
    signal.set_wakeup_fd(outgoing, warn_on_full_buffer=False)
    for number in SIGNALS:
        signal.signal(number, lambda *_: None)
    threading.Thread(target=_wait_for_signal, args=(incoming,), daemon=True).start()
    # Threads started later, and the programs they start, inherit this.
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})


def _adopt_orphans() -> None:
    """From now on, be the parent of programs of jobs whose own parent has ended, as Linux allows.

    A job that begins while the others are ended could otherwise not be found.
    """
    if sys.platform == "linux":
        set_child_subreaper = 36  # number of the option in <linux/prctl.h>
        ctypes.CDLL(None).prctl(set_child_subreaper, 1)


def leave_jobs_to_cluster() -> None:
    """From now on, raise `KeyboardInterrupt` at both signals: Snakemake then cancels its cluster jobs."""
    if sys.platform == "win32" or threading.current_thread() is not threading.main_thread():
        return

    def interrupt(number: int, frame: FrameType | None) -> None:
        print(STUDY_LINE, file=sys.stderr, flush=True)
        signal.default_int_handler(number, frame)

    signal.set_wakeup_fd(-1)
    for number in SIGNALS:
        signal.signal(number, interrupt)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def _wait_for_signal(incoming: int) -> None:
    """Read the numbers of signals from a pipe, and end the process and its jobs at the first that counts."""
    while number := os.read(incoming, 1):
        if number[0] in SIGNALS:
            shown = os.dup(2)
            _silence()  # first: the main thread may be printing
            _say(STUDY_LINE, shown)
            _end_jobs()
            os._exit(status_after(number[0]))


def _end_process(line: str, number: int) -> NoReturn:
    """Print a line, delete unfinished files and end this process where it is."""
    _say(line)
    if (results := sys.modules.get("asperity.results.atomic")) is not None:
        results.delete_unfinished()
    os._exit(status_after(number))


def _say(line: str, stream: int = 2) -> None:
    """Print a line on stderr or what stands for it, after the end of a line that is there on a terminal."""
    with suppress(OSError, ValueError):
        os.write(stream, f"{chr(10) if os.isatty(stream) else ''}{line}\n".encode())


def _silence() -> None:
    """Discard what this process prints from now on: that its jobs have failed."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nowhere, stream)


def _end_jobs() -> None:
    """End all programs that this process and its programs have started, also if their parents end first."""
    import psutil  # a part of Snakemake; single calculations do not need it

    deadline = time.monotonic() + JOB_GRACE
    found: set[psutil.Process] = set()
    told: set[int] = set()
    while True:
        found.update(psutil.Process().children(recursive=True))
        programs = _running(found)
        late = time.monotonic() - deadline
        for program in programs:
            with suppress(psutil.NoSuchProcess):
                if late > 0:
                    program.kill()
                elif program.pid not in told:
                    program.terminate()
                    told.add(program.pid)
        if not programs or late > JOB_GRACE:
            return
        time.sleep(0.05)


def _running(programs: Iterable[Any]) -> list[Any]:
    """Programs that have not ended, without those of which only the exit status is kept."""
    found = []
    for program in programs:
        with suppress(Exception):  # of any kind, if it ends meanwhile
            if program.status() != "zombie":
                found.append(program)
    return found
