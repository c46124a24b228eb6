"""Tasks that the calling thread and its helpers take in turn.

The helpers are threads that wait for work as long as the process lives. A caller that finds none of them free
does all tasks by itself, so that tasks may have tasks of their own.
"""

from __future__ import annotations

import contextvars
import os
import threading
from collections import deque
from collections.abc import Callable, Sequence
from queue import SimpleQueue
from typing import Any

Task = Callable[[], Any]


def results_of(tasks: Sequence[Task], threads: int) -> list[Any]:
    """What functions without arguments return, in their order, which several threads call at the same time.

    They are begun in their order, and see the caller's context variables, such as `numpy.errstate`. An error
    is raised when no thread is at work any more; no further task is begun after it.
    """
    if threads == 1 or len(tasks) == 1:
        return [task() for task in tasks]
    return _Shared(tasks).done_by(min(threads, len(tasks)))


class _Shared:
    """Tasks that several threads take in turn."""

    def __init__(self, tasks: Sequence[Task]) -> None:
        self._left = deque(enumerate(tasks))
        self._results: list[Any] = [None] * len(tasks)
        self._context = contextvars.copy_context()
        self._invitations: deque[None] = deque()
        self._ended: SimpleQueue[BaseException | None] = SimpleQueue()

    def done_by(self, threads: int) -> list[Any]:
        """Results of the tasks, of which the calling thread does those that its helpers do not."""
        helpers = threads - 1
        self._invitations.extend([None] * helpers)
        _start(helpers)
        for _ in range(helpers):
            _invited.put(self)
        try:
            self._take()
        finally:
            self._left.clear()
            errors = [self._ended.get() for _ in range(helpers) if not self._takes_invitation()]
        for error in filter(None, errors):
            raise error
        return self._results

    def help(self) -> None:
        """Take tasks, unless the caller has ended."""
        if not self._takes_invitation():
            return
        error = None
        try:
            self._context.copy().run(self._take)
        except BaseException as raised:
            self._left.clear()
            error = raised
        self._ended.put(error)

    def _takes_invitation(self) -> bool:
        """True if one was left: a helper follows it, or the caller takes it back."""
        try:
            self._invitations.pop()
        except IndexError:
            return False
        return True

    def _take(self) -> None:
        while True:
            try:
                number, task = self._left.popleft()
            except IndexError:
                return
            self._results[number] = task()


_invited: SimpleQueue[_Shared] = SimpleQueue()
_helpers: list[threading.Thread] = []
_starting = threading.Lock()


def _start(helpers: int) -> None:
    """Start threads until there are so many helpers."""
    if len(_helpers) >= helpers:
        return
    with _starting:
        while len(_helpers) < helpers:
            helper = threading.Thread(target=_help, name=f"asperity-{len(_helpers)}", daemon=True)
            helper.start()
            _helpers.append(helper)


def _help() -> None:
    while True:
        # Not kept in a variable: it would hold the tasks and their arrays while the thread waits.
        _invited.get().help()


def _forget_helpers() -> None:
    global _invited, _starting
    _invited, _starting = SimpleQueue(), threading.Lock()
    _helpers.clear()


if hasattr(os, "register_at_fork"):
    # A copy of a process has none of its threads.
    os.register_at_fork(after_in_child=_forget_helpers)
