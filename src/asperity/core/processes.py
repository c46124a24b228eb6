"""A function side by side in processes, with its progress; results in order."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import (
    CancelledError,
    Future,
    InvalidStateError,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import ExitStack, suppress
from functools import partial
from multiprocessing import get_context, parent_process
from queue import Empty
from typing import Any
from warnings import catch_warnings, simplefilter

POLL = 0.05
"""Seconds between two looks for the progress and the results of other processes."""

HANDLERS: dict[signal.Signals, Any] = {
    signal.SIGINT: signal.default_int_handler,
    signal.SIGTERM: signal.SIG_DFL,
}
"""Signal → what ends another process."""

_queue: Any = None
_calls: tuple[Callable[..., Any], Sequence[tuple[Any, ...]]] | None = None


def side_by_side(
    function: Callable[..., Any],
    arguments: Sequence[tuple[Any, ...]],
    processes: int,
    progress: Callable[[list[float]], None],
    after: Sequence[int | None] = (),
) -> Iterator[Any]:
    """Results of a function for each of its arguments, in their order.

    On Linux the other processes are forks of this one if Python runs a single thread: they need neither
    import modules nor read arguments. Threads of ducc0, SciPy and OpenBLAS are prepared for a fork, those of
    FFTW are not: the function uses FFTW on one thread.

    Parameters
    ----------
    function : callable
        Of a module. Its last argument is its own progress, called as progress(done, total).
    arguments : sequence of tuple
        The other arguments of each call.
    processes : int
        This one, which calls the function too, and those that are started beside it.
    progress : callable
        Called with the parts of all calls that are done, from 0 to 1.
    after : sequence of int or None, optional
        Number of the earlier call that has to end before each one begins.
    """
    parts = [0.0] * len(arguments)
    found = [Future[Any]() for _ in arguments]
    needed = [[] if each is None else [found[each]] for each in after or [None] * len(arguments)]
    left = iter(range(len(arguments)))  # each process takes the next one

    def report(number: Any, done: float, total: float) -> None:
        parts[number] = max(parts[number], done / total if total else 1.0)  # others tell with a delay
        progress(parts)

    def hear(seconds: float, *own: float) -> None:
        """Report own progress, and that of other processes for which it waits for some seconds."""
        if own:
            report(*own)
        with suppress(Empty):
            while processes > 1:
                report(*told.get(timeout=seconds))
                seconds = 0.0

    def here(number: int) -> None:
        while not all(each.done() for each in needed[number]):
            hear(POLL)
        try:
            found[number].set_result(function(*arguments[number], partial(hear, 0.0, number)))
        except Exception as error:
            found[number].set_exception(error)

    def beside(pool: ProcessPoolExecutor, is_forked: bool) -> None:
        for number in left:
            wait(needed[number])
            given = () if is_forked else (function, arguments[number])
            try:
                found[number].set_result(pool.submit(_told, number, *given).result())
            except Exception as error:
                found[number].set_exception(error)

    def abandon() -> None:
        """Start no further call, and end those that wait for another one."""
        deque(left, 0)
        for each in found:
            with suppress(InvalidStateError):
                each.set_exception(CancelledError())

    with ExitStack() as stack:
        if processes > 1:
            is_forked = sys.platform == "linux" and threading.active_count() == 1
            context = get_context("fork" if is_forked else "spawn")
            told: Any = context.Queue()
            threads = stack.enter_context(ThreadPoolExecutor(processes - 1))
            given = told, (function, arguments) if is_forked else None
            pool = stack.enter_context(ProcessPoolExecutor(processes - 1, context, _begin, given))
            stack.callback(abandon)
            if is_forked:
                _fork(pool)
            for _ in range(processes - 1):
                threads.submit(beside, pool, is_forked)
        for number in range(len(arguments)):
            while not found[number].done():
                if (own := next(left, None)) is None:
                    hear(POLL)
                else:
                    here(own)
            yield found[number].result()
            found[number] = Future()  # the result may be large
            report(number, 1.0, 1.0)


def _fork(pool: ProcessPoolExecutor) -> None:
    """Fork all processes, before there are threads; a signal that ends this one waits until then."""
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, HANDLERS)
    try:
        with catch_warnings():  # threads of libraries, which are prepared for it
            simplefilter("ignore", DeprecationWarning)
            pool.submit(int)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _begin(queue: Any, calls: tuple[Callable[..., Any], Sequence[tuple[Any, ...]]] | None) -> None:
    """Take the queue for the progress of this process, which does not wait at its end until it is read."""
    global _queue, _calls
    _queue, _calls = queue, calls
    queue.cancel_join_thread()
    for number, handler in HANDLERS.items():  # in place of those of the command
        signal.signal(number, handler)
    if calls is not None:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, HANDLERS)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """End this process if the one that started it is killed."""
    parent = parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


def _told(number: int, function: Any = None, arguments: Any = None) -> Any:
    """Make a call in a process of its own, whose progress goes to a queue."""
    if _calls is not None:
        function, arguments = _calls[0], _calls[1][number]
    return function(*arguments, lambda done, total: _queue.put((number, done, total)))
