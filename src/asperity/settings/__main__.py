"""``python -m asperity.settings``: check a configuration of the study, or name its folder of results.

``check FILE …`` checks a configuration with its overlays merged; status 1 and a line for each problem on
stderr if it is not accepted.
``results FILE …`` prints the folder of results that a study with these files has.
"""

import argparse
import sys
from collections.abc import Sequence

from asperity.core.errors import InputError, one_line
from asperity.core.packages import MissingPackageError, require


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; 0 on success, 1 with a line for each problem on stderr otherwise."""
    parser = argparse.ArgumentParser(prog="python -m asperity.settings", allow_abbrev=False)
    commands = parser.add_subparsers(required=True, metavar="COMMAND", dest="command")
    for name, many, text in (
        ("check", "+", "check a configuration, with its overlays merged"),
        ("results", "*", "folder of the results of a study, by default the paper's"),
    ):
        command = commands.add_parser(name, help=text)
        files = "configuration, then overlays, in YAML"
        command.add_argument("files", nargs=many, help=files, metavar="FILE")
        command.add_argument("--results", help="folder given on the command line of the study")
    options = parser.parse_args(arguments)
    try:
        require(("matplotlib", "pydantic", "yaml"))
        from asperity.settings.study import read_study

        given = {} if options.results is None else {"results": options.results}
        study = read_study(options.files, given)
        if options.command == "results":
            print(study["results"])
    except InputError as error:
        print(*(f"config: {one_line(line)}" for line in error.lines), sep="\n", file=sys.stderr)
        return 1
    except (MissingPackageError, OSError) as error:
        print(f"config: {one_line(str(error))}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
