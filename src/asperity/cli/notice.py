"""Progress bar of a command, and a line on stderr when functions are compiled at the first use."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from numba.core import event
from tqdm import tqdm

from asperity.core.errors import one_line
from asperity.study.runtime.progress import ProgressBar

NOTICE = "asperity: compiling, at the first use only, about 30 s"


@contextmanager
def progress_bar(label: str) -> Iterator[ProgressBar]:
    """Progress bar while a command computes."""
    with event.install_listener("numba:compile", _Notice()), ProgressBar(one_line(label)) as progress:
        yield progress


class _Notice(event.Listener):
    """Prints that functions are compiled when the first one is."""

    def __init__(self) -> None:
        self._printed = False

    def on_start(self, event: event.Event) -> None:
        if not self._printed:
            tqdm.write(NOTICE, file=sys.stderr)
            self._printed = True

    def on_end(self, event: event.Event) -> None:
        pass
