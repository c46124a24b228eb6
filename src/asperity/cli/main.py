"""Entry point of the command line: runs one command, and answers every error with one line."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module

from asperity.errors import ConvergenceError, DatasetError, PreflightError, fail
from asperity.runtime.interrupts import COMMAND_LINE, Interrupted, interruptible
from asperity.runtime.preflight import BASE_PACKAGES, PACKAGES, REMEDY, require_packages


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the exit status.

    Parameters
    ----------
    arguments : sequence of str, optional
        By default those of this process, which then ends with the command.

    Returns
    -------
    status : int
        0 on success, 1 with one line on stderr otherwise, 130 after Ctrl-C and 143 after SIGTERM. Wrong usage
        ends the process with 2 and one line, as argparse does.
    """
    try:
        with interruptible(f"asperity: {COMMAND_LINE}", last=arguments is None):
            require_packages(BASE_PACKAGES)
            from asperity.cli.parser import make_parser

            options = make_parser().parse_args(arguments)
            import_module(f"asperity.cli.commands.{options.command}").run(options)
    except Interrupted as interrupted:
        return fail(COMMAND_LINE, interrupted.status)
    except ModuleNotFoundError as error:
        package = PACKAGES.get((error.name or "").split(".")[0])
        return fail(f"not installed: {package}; {REMEDY}" if package else str(error))
    except (ValueError, TypeError, OSError, ImportError, MemoryError) as error:
        return fail(str(error) or type(error).__name__)
    except (DatasetError, ConvergenceError, PreflightError) as error:
        return fail(str(error))
    return 0
