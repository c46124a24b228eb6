"""The command line, for one-off use without the study: ``asperity solve | stress | peaks | plot | plan``.

Nothing is imported here that may be missing: the commands themselves are in `asperity.cli.commands`.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from asperity.errors import PreflightError, fail
from asperity.runtime.preflight import BASE_PACKAGES, PACKAGES, REMEDY, require_packages


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; 0 if it did what it says, 1 with one line on stderr if it could not.

    Usage errors end the process with 2, as argparse does.
    """
    try:
        require_packages(BASE_PACKAGES)
    except PreflightError as error:
        return fail(str(error))
    from asperity.cli.commands import run
    from asperity.errors import ConvergenceError, DatasetError

    try:
        run(arguments)
    except KeyboardInterrupt:
        return fail("interrupted", 130)
    except ModuleNotFoundError as error:
        package = PACKAGES.get((error.name or "").split(".")[0])
        return fail(f"not installed: {package}; {REMEDY}" if package else str(error))
    except (ValueError, TypeError, OSError, ImportError, MemoryError) as error:
        return fail(str(error) or type(error).__name__)
    except (DatasetError, ConvergenceError) as error:
        return fail(str(error))
    return 0


if __name__ == "__main__":
    sys.exit(main())
