"""Entry point of the command line: runs one command, and answers every error with one line."""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence
from importlib import import_module

from asperity.errors import ConvergenceError, DatasetError, InputError, PreflightError, fail
from asperity.packages import BASE, NAMES, PACKAGES, MissingPackageError, message, require
from asperity.runtime.interrupts import COMMAND_LINE, Interrupted, interruptible


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the exit status.

    Parameters
    ----------
    arguments : sequence of str, optional
        By default those of this process, which then ends with the command.

    Returns
    -------
    status : int
        0 on success, 1 with a line for each problem on stderr otherwise, 130 after Ctrl-C and 143 after
        SIGTERM. Wrong usage ends the process with 2, as argparse does.
    """
    for stream in (sys.stdout, sys.stderr):  # a console that cannot show µ or ² shows ? there
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        with interruptible(f"asperity: {COMMAND_LINE}", last=arguments is None):
            require(PACKAGES[BASE])
            from asperity.cli.engine import chosen_engine
            from asperity.cli.parser import make_parser

            options = make_parser().parse_args(arguments)
            with chosen_engine(options):
                import_module(f"asperity.cli.commands.{options.command}").run(options)
    except InputError as error:
        return max(map(fail, error.lines), default=1)
    except Interrupted as interrupted:
        return fail(COMMAND_LINE, interrupted.status)
    except MissingPackageError as error:
        return fail(str(error))
    except ModuleNotFoundError as error:
        module = (error.name or "").split(".")[0]
        return fail(message([module]) if module in NAMES else str(error))
    except (ValueError, TypeError, OSError, ImportError, MemoryError) as error:
        return fail(str(error) or type(error).__name__)
    except (DatasetError, ConvergenceError, PreflightError) as error:
        return fail(str(error))
    return 0
