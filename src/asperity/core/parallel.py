"""Compiled loops on several threads, with results that do not depend on their number."""

from __future__ import annotations

import contextvars
import math
import threading
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

SMALLEST_PART = 16_384
"""Fewest elements for which another thread saves time."""

SUMMED_PART = 131_072
"""Fewest elements of a part of a sum."""

PARTS_OF_THREAD = 4
"""Most parts per thread: a thread that has finished early takes further parts."""

STRIP = 131_072
"""Elements of a strip: several arrays of this size fit in the processor's cache."""

CACHE_LINE = 64
"""Bytes of a cache line."""

_helpers = ThreadPoolExecutor(max_workers=256, thread_name_prefix="asperity")
"""Threads that help the calling one; they are started when they are first needed."""


class KeptArrays(threading.local):
    """Arrays that each thread reuses, because the system takes time to clear new memory."""

    def __init__(self) -> None:
        self._kept: dict[str, Any] = {}

    def array(self, name: str, shape: tuple[int, ...], dtype: Any) -> Any:
        """Uninitialised array in memory that is kept under this name."""
        size = math.prod(shape) * np.dtype(dtype).itemsize
        if name not in self._kept or self._kept[name].size < size:
            self._kept[name] = aligned_memory(size)
        return self._kept[name][:size].view(dtype).reshape(shape)


def aligned_memory(size: int) -> Any:
    """Uninitialised bytes, aligned to a cache line."""
    memory = np.empty(size + CACHE_LINE, np.uint8)
    start = -memory.ctypes.data % CACHE_LINE
    return memory[start : start + size]


def run_tasks(tasks: Sequence[Callable[[], Any]], threads: int) -> list[Any]:
    """Call functions without arguments on several threads, and return their results in order.

    Tasks start in order, with the caller's context variables such as `numpy.errstate`. The calling thread
    runs tasks too, so that a task may call this function. After an error no further task starts, and the
    error is raised when all running tasks have ended.
    """
    if threads == 1 or len(tasks) == 1:
        return [task() for task in tasks]
    left = enumerate(tasks)  # each thread takes the next one
    results = [None] * len(tasks)

    def take() -> None:
        try:
            for number, task in left:
                results[number] = task()
        except BaseException:
            deque(left, 0)  # leaves no task to the other threads
            raise

    contexts = [contextvars.copy_context() for _ in range(min(threads, len(tasks)) - 1)]
    helping = [_helpers.submit(context.run, take) for context in contexts]
    try:
        take()
    finally:
        errors = [helper.exception() for helper in helping if not helper.cancel()]  # waits for each
    for error in filter(None, errors):
        raise error
    return results


def in_parts(
    work: Callable[[slice], Any],
    size: int,
    threads: int,
    multiple: int = 1,
    smallest: int = SMALLEST_PART,
    meanwhile: Callable[[], object] | None = None,
) -> list[Any]:
    """Call a function for consecutive parts of `size` elements, at the same time; its results in order.

    The function has to compute the elements of a part independently of the others, and to release the
    interpreter's lock, as functions compiled with ``nogil=True`` do. The parts depend on the number of
    threads.

    Parameters
    ----------
    work : callable
        Called with the slice of a part.
    size, threads : int
    multiple : int
        Parts begin at multiples of this number.
    smallest : int
        Least number of elements of a part.
    meanwhile : callable, optional
        Called without arguments by one of the threads, at the same time.
    """
    first = [] if meanwhile is None else [meanwhile]
    if threads == 1:
        return run_tasks([*first, partial(work, slice(0, size))], 1)[len(first) :]
    parts = max(1, min(threads * PARTS_OF_THREAD, size // smallest))
    edges = [size * part // parts // multiple * multiple for part in range(parts)] + [size]
    tasks = first + [partial(work, slice(start, stop)) for start, stop in pairwise(edges)]
    return run_tasks(tasks, threads)[len(first) :]


def in_strips(work: Callable[[slice], object], shape: tuple[int, int], threads: int) -> None:
    """Call a function for strips of rows of an array, at the same time on several threads.

    A strip has about `STRIP` elements: intermediate results of the function stay in the cache.
    """
    rows, columns = shape
    strip = max(1, STRIP // columns)
    starts = range(0, rows, strip)
    run_tasks([partial(work, slice(start, min(start + strip, rows))) for start in starts], threads)


def apply(function: Callable[..., object], threads: int, *arguments: Any) -> None:
    """Call a function that changes arrays in place for consecutive parts of them, at the same time.

    Parameters
    ----------
    function : callable
        As for `in_parts`.
    threads : int
    *arguments
        Arrays of the same length, passed on part by part, and numbers.
    """
    size = max(argument.size for argument in arguments if isinstance(argument, np.ndarray))
    in_parts(lambda part: function(*_parts_of(arguments, part)), size, threads)


def map_parts(function: Callable[..., Any], threads: int, *arguments: Any) -> list[Any]:
    """Results of a function for consecutive parts of arrays, in order.

    The parts, and so the rounding of sums over them, are the same for any number of threads, and two or four
    threads have equal numbers of them. Arguments as for `apply`.
    """
    size = max(argument.size for argument in arguments if isinstance(argument, np.ndarray))
    count = size // SUMMED_PART
    if count < 2:
        return [function(*arguments)]
    count -= count % 4 if count > 4 else count % 2
    edges = [size * part // count for part in range(count + 1)]
    return run_tasks(
        [partial(function, *_parts_of(arguments, slice(*edge))) for edge in pairwise(edges)], threads
    )


def sum_parts(function: Callable[..., Any], threads: int, *arguments: Any) -> Any:
    """Sum of the results of `map_parts`, which are numbers or tuples of numbers."""
    found = map_parts(function, threads, *arguments)
    return tuple(map(sum, zip(*found, strict=True))) if isinstance(found[0], tuple) else sum(found)


def _parts_of(arguments: tuple[Any, ...], part: slice) -> list[Any]:
    return [argument[part] if isinstance(argument, np.ndarray) else argument for argument in arguments]
