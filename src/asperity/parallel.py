"""Compiled loops on several threads, with results that do not depend on their number."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise

SMALLEST_PART = 16_384
"""Number of elements for which a thread of its own is worth while."""


def in_parts(
    work: Callable[[slice], object], size: int, threads: int, multiple: int = 1, smallest: int = SMALLEST_PART
) -> list[object]:
    """Call a function for consecutive parts of `size` elements, at the same time; its results in order.

    The function has to compute the elements of a part independently of the others, and to release the
    interpreter's lock, as functions compiled with ``nogil=True`` do.

    Parameters
    ----------
    work : callable
        Called with the slice of a part.
    size, threads : int
    multiple : int
        Parts begin at multiples of this number.
    smallest : int
        Least number of elements of a part.
    """
    parts = max(1, min(threads, size // smallest))
    if parts == 1:
        return [work(slice(0, size))]
    edges = [size * part // parts // multiple * multiple for part in range(parts)] + [size]
    return list(_pool(threads).map(work, [slice(start, stop) for start, stop in pairwise(edges)]))


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="asperity")


if hasattr(os, "register_at_fork"):
    # A copy of a process has none of its threads.
    os.register_at_fork(after_in_child=_pool.cache_clear)
