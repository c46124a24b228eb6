"""A function side by side in processes, with its progress; results in order."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from multiprocessing import get_context
from queue import Empty
from typing import Any

from asperity.core.system import available_memory

SMALLEST_PARALLEL = 65_536
"""Least nodes of the largest map for which processes save time: one takes about two seconds to start."""

POLL = 0.2
"""Seconds between two looks for the progress of other processes."""


def processes_for(count: int, nodes: int, memory: float, cores: int | None = None) -> int:
    """Number of processes for some tasks, each on a map of so many nodes and with so many bytes.

    All cores are used by default, within the memory that is available.
    """
    if count < 2 or cores == 1 or nodes < SMALLEST_PARALLEL:
        return 1
    available = 1e6 * available_memory()  # from MB to bytes
    return max(1, min(count, cores or os.cpu_count() or 1, int(available / memory)))


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
        With one, the function is called in this process.
    progress : callable
        Called with the parts of all calls that are done, from 0 to 1.
    """
    parts = [0.0] * len(arguments)

    def report(number: int, done: float, total: float) -> None:
        parts[number] = done / total if total else 1.0
        progress(parts)

    if processes == 1:
        for number, each in enumerate(arguments):
            yield function(*each, lambda done, total, number=number: report(number, done, total))
            report(number, 1.0, 1.0)
        return
    context = get_context("spawn")
    with context.Manager() as manager:
        told: Any = manager.Queue()
        with ProcessPoolExecutor(processes, context) as pool:
            futures = [
                pool.submit(_told, function, each, number, told) for number, each in enumerate(arguments)
            ]
            try:
                for number, future in enumerate(futures):
                    while not future.done():
                        with suppress(Empty):
                            report(*told.get(timeout=POLL))
                    yield future.result()
                    report(number, 1.0, 1.0)
            except BaseException:
                for future in futures:
                    future.cancel()
                raise


def _told(function: Callable[..., Any], arguments: tuple[Any, ...], number: int, told: Any) -> Any:
    """Call a function in a process of its own, whose progress goes to a queue."""
    return function(*arguments, lambda done, total: told.put((number, done, total)))
