"""``python -m asperity.config``: check a configuration, or describe the settings.

``check FILE …`` checks a configuration with its overlays merged; status 1 and one line on stderr if it is not
accepted.
``results FILE …`` prints the folder of results that a study with these files has.
``describe`` prints tables of all settings; ``describe README`` writes them into that file.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from asperity.errors import ConfigError, PreflightError, one_line
from asperity.runtime.interrupts import Interrupted, interruptible
from asperity.runtime.preflight import require_packages

_INTERRUPTED = "config: interrupted; run the same command again"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; 0 on success, 1 with one line on stderr otherwise."""
    parser = argparse.ArgumentParser(prog="python -m asperity.config", allow_abbrev=False)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    checking = commands.add_parser("check", help="check a configuration, with its overlays merged")
    checking.add_argument("files", nargs="+", metavar="FILE", help="configuration, then overlays, in YAML")
    _add_results(checking)
    checking.set_defaults(run=_check)
    placing = commands.add_parser("results", help="folder of the results of a study")
    placing.add_argument(
        "files", nargs="*", metavar="FILE", help="configuration, then overlays; else the paper's"
    )
    _add_results(placing)
    placing.set_defaults(run=_print_results)
    describing = commands.add_parser("describe", help="tables of all settings, in Markdown")
    describing.add_argument("readme", nargs="?", help="file to write them into; otherwise they are printed")
    describing.set_defaults(run=_describe)
    options = parser.parse_args(arguments)
    try:
        with interruptible(_INTERRUPTED, last=arguments is None):
            require_packages(("jsonschema", "matplotlib", "yaml"))
            options.run(options)
    except Interrupted as interrupted:
        print(_INTERRUPTED, file=sys.stderr)
        return interrupted.status
    except (ConfigError, PreflightError, OSError) as error:
        print(f"config: {one_line(str(error))}", file=sys.stderr)
        return 1
    return 0


def _add_results(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--results", metavar="FOLDER", help="folder given on the command line of the study")


def _check(options: argparse.Namespace) -> None:
    _study(options)


def _print_results(options: argparse.Namespace) -> None:
    print(_study(options)["results"])


def _study(options: argparse.Namespace) -> dict[str, Any]:
    from asperity.config.study import read_study

    return read_study(options.files, {} if options.results is None else {"results": options.results})


def _describe(options: argparse.Namespace) -> None:
    from asperity.config.describe import describe, with_settings

    if options.readme is None:
        print(describe(), end="")
    else:
        readme = Path(options.readme)
        readme.write_text(with_settings(readme.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
