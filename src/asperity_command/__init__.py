"""Entry point of the command ``asperity``.

A package of its own, because importing anything from `asperity` imports that package first: Ctrl-C and
SIGTERM end the process with one line from here on, also while that lasts.
"""

import os
import signal
from types import FrameType
from typing import NoReturn

LINE = "asperity: interrupted, nothing is written; run the same command again to start over"


def end(number: int, _: FrameType | None) -> NoReturn:
    """Signal handler: print the line, and end the process, which has not yet begun anything."""
    os.write(2, f"{LINE}\n".encode())
    os._exit(128 + number)


def main() -> int:
    """Run one command, and return the exit status."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, end)
    from asperity.cli.main import main as run

    return run()
