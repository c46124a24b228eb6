"""``asperity app``: the instrument as a page in the browser."""

import argparse
import os
import re
import sys

from asperity.cli.parser import FLAGS, WRONG_USAGE
from asperity.core.errors import fail, shown

SECONDS = {"s": 1, "min": 60, "h": 3600}
"""Unit of a time → its seconds."""

MEMORY_SHARE = 0.75
"""Fraction of the memory of this computer that a computation may use."""


def run(options: argparse.Namespace) -> None:
    """Serve the page until Ctrl-C."""
    if options.open is not None and not os.path.exists(options.open):
        sys.exit(fail(f"{options.open}: no such file or folder", WRONG_USAGE))
    import psutil

    from asperity.app.worker import Worker

    for name in [name for name in os.environ if name.startswith("BOKEH_")]:
        del os.environ[name]  # the page sets what it needs
    reader = Worker("reader")  # it imports what it needs while this process imports the server
    from asperity.app.server import serve

    memory = MEMORY_SHARE * psutil.virtual_memory().total
    try:
        serve(
            options.open,
            FLAGS,
            reader,
            port=options.port,
            out=options.out,
            stop_after=None if options.stop_after is None else _seconds(options.stop_after),
            memory=memory if options.memory is None else options.memory * 2**30,
            show=not options.no_browser,
            host_header=options.host_header,
        )
    except OSError as error:
        sys.exit(fail(f"--port {options.port}: cannot be used ({error.strerror}); another one is needed"))


def _seconds(text: str) -> float:
    """Seconds of a time with its unit."""
    found = re.fullmatch(r"(\d+(?:\.\d+)?) ?(s|min|h)", text.strip())
    if found is None or not float(found[1]):
        words = f"--stop-after = {shown(text)}: a time > 0 with its unit (s, min, h) is needed"
        sys.exit(fail(words, WRONG_USAGE))
    return float(found[1]) * SECONDS[found[2]]
