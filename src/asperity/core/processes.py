"""A function side by side in processes, with its progress; results in order."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor, wait
from contextlib import ExitStack, suppress
from functools import partial
from multiprocessing import get_context
from queue import Empty
from typing import Any

POLL = 0.2
"""Seconds between two looks for the progress of other processes."""

_queue: Any = None


def side_by_side(
    function: Callable[..., Any],
    arguments: Sequence[tuple[Any, ...]],
    processes: int,
    progress: Callable[[list[float]], None],
) -> Iterator[Any]:
    """Results of a function for each of its arguments, in their order.

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
    """
    parts = [0.0] * len(arguments)
    left, found = iter(range(len(arguments))), dict[int, Future[Any]]()  # each process takes the next one

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
        found[number] = Future()
        try:
            found[number].set_result(function(*arguments[number], partial(hear, 0.0, number)))
        except Exception as error:
            found[number].set_exception(error)

    def beside(pool: ProcessPoolExecutor) -> None:
        for number in left:
            found[number] = future = pool.submit(_told, function, arguments[number], number)
            wait([future])

    with ExitStack() as stack:
        if processes > 1:
            context = get_context("spawn")
            told: Any = context.Queue()
            threads = stack.enter_context(ThreadPoolExecutor(processes - 1))
            others = ProcessPoolExecutor(processes - 1, context, _tell_to, (told,))
            pool = stack.enter_context(others)
            for _ in range(processes - 1):
                threads.submit(beside, pool)
        stack.callback(deque, left, 0)  # after an error no further call starts
        for number in range(len(arguments)):
            while number not in found or not found[number].done():
                if (own := next(left, None)) is None:
                    hear(POLL)
                else:
                    here(own)
            yield found.pop(number).result()
            report(number, 1.0, 1.0)


def _tell_to(queue: Any) -> None:
    """Take the queue for the progress of this process, which does not wait at its end until it is read."""
    global _queue
    _queue = queue
    queue.cancel_join_thread()


def _told(function: Callable[..., Any], arguments: tuple[Any, ...], number: int) -> Any:
    """Call a function in a process of its own, whose progress goes to a queue."""
    return function(*arguments, lambda done, total: _queue.put((number, done, total)))
