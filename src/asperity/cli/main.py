"""Entry point of the command line: runs one command, and answers every refusal with one line."""

import gc
import io
import os
import signal
import sys
import threading
import traceback
from collections.abc import Sequence
from contextlib import nullcontext, suppress
from importlib import import_module
from types import FrameType
from typing import NoReturn

from asperity.core.errors import (
    ConvergenceError,
    DatasetError,
    InputError,
    PreflightError,
    fail,
    is_refusal,
)
from asperity.core.packages import BASE, NAMES, NEEDED, PACKAGES, MissingPackageError, message, require

INTERRUPTED = "interrupted; run the same command again to start over"
OWN_FAULT = (
    "an error of asperity itself, or a result file that asperity has not written; please report it with the "
    "lines above and the output of asperity --version"
)

NEEDED_BY = {"run": ("SurfaceTopography", "matplotlib"), "app": ("SurfaceTopography", "matplotlib", "bokeh")}
"""Command → modules without which it cannot end, beside those that every command needs."""

RARELY = 1_000_000
"""Allocations between two garbage collections, twice as many as `asperity run` makes; those of imports stay.
With Python's default of 700, `asperity run` on 512² points takes a tenth longer."""


class Interrupted(KeyboardInterrupt):
    """Raised at Ctrl-C and SIGTERM; its argument is the number of the signal."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the exit status.

    Parameters
    ----------
    arguments : sequence of str, optional
        By default the arguments of this process.

    Returns
    -------
    status : int
        0 on success, 1 with a line for each problem on stderr otherwise, after a traceback if the error is
        one of asperity itself, 130 after Ctrl-C and 143 after SIGTERM. Wrong usage ends the process with 2,
        as argparse does.
    """
    for name in ("stdin", "stdout", "stderr"):
        if getattr(sys, name) is None:  # closed, as by `>&-`: a result file would take its place
            setattr(sys, name, open(os.devnull, "r" if name == "stdin" else "w"))  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):  # a console that cannot show µ or ² shows ? there
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    signals = (signal.SIGINT, signal.SIGTERM) if threading.current_thread() is threading.main_thread() else ()
    earlier = {number: signal.signal(number, _interrupt) for number in signals}
    if arguments is None:
        os.environ["MPLBACKEND"] = "agg"  # a notebook sets one that may not be installed here
        # They are looked for in all installed packages, which takes a tenth of a second.
        os.environ["PYDANTIC_DISABLE_PLUGINS"] = "true"
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # waiting threads took a fifth of a seal's time
        gc.set_threshold(RARELY, 50, 50)
    try:
        _run(arguments)
        sys.stdout.flush()
    except Interrupted as interrupted:
        status = fail(INTERRUPTED, 128 + interrupted.args[0])
        if arguments is None:  # ends now: running threads and modules would be waited for, for seconds
            with suppress(OSError, ValueError):
                sys.stdout.flush()
            os._exit(status)
        return status
    except InputError as error:
        return max(map(fail, error.lines), default=1)
    except MissingPackageError as error:
        return fail(str(error))
    except ModuleNotFoundError as error:
        module = (error.name or "").split(".")[0]
        return fail(message([module]) if module in NAMES else str(error))
    except BrokenPipeError:  # a reader such as head has closed the pipe
        _drop_output()
    except OSError as error:
        if error.filename is None:
            try:
                print(flush=True)
            except OSError:  # nothing can be written to stdout
                _drop_output()
                return fail(f"standard output: cannot be written ({error.strerror})")
        return fail(str(error))
    except (ImportError, MemoryError, DatasetError, ConvergenceError, PreflightError) as error:
        return fail(str(error) or type(error).__name__)
    except Exception as error:
        if is_refusal(error):
            return fail(str(error))
        traceback.print_exc()
        return fail(OWN_FAULT)
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)
        if arguments is None:
            gc.freeze()  # else Python searches all objects once more as it ends, which takes half a second
    return 0


def _drop_output() -> None:
    """Discard further output to stdout, also when the process ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _interrupt(number: int, _: FrameType | None) -> NoReturn:
    """Signal handler: end the command and delete its unfinished files; a second signal kills the process."""
    signal.signal(number, signal.SIG_DFL)
    raise Interrupted(number)


def _run(arguments: Sequence[str] | None) -> None:
    require(module for module in PACKAGES[BASE] if module in NEEDED)
    from asperity.cli.parser import parse, with_flags

    options = parse(arguments)
    require(NEEDED_BY.get(options.command, ()))  # before the computation, not after it
    from asperity.fourier import fft_engine  # a slow import that help and usage errors do not need

    engine = getattr(options, "fft_engine", None)
    try:
        with fft_engine(engine) if engine else nullcontext():
            import_module(f"asperity.cli.commands.{options.command}").run(options)
    except InputError:
        raise
    except ValueError as error:
        if not is_refusal(error):
            raise
        raise ValueError(with_flags(str(error), options.command)) from error
