"""``python -m asperity.study.config``: check a configuration, or describe the settings.

``check FILE …`` checks a configuration with its overlays merged; status 1 and one line on stderr if it is not
accepted.
``results FILE …`` prints the folder of results that a study with these files has.
``describe`` prints tables of all settings; ``describe README`` writes them into that file.
"""

import argparse
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from asperity.core.errors import ConfigError, one_line
from asperity.core.packages import MissingPackageError, require
from asperity.study.config.schema import Entry, accepted, schema, settings

MARK = "<!-- settings: python -m asperity.study.config describe config/README.md -->\n"
"""Line of the README after which everything is generated."""

_HEAD = ["| key | accepts | unit | default | meaning |", "|---|---|---|---|---|"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; 0 on success, 1 with one line on stderr otherwise."""
    parser = argparse.ArgumentParser(prog="python -m asperity.study.config", allow_abbrev=False)
    commands = parser.add_subparsers(required=True, metavar="COMMAND", dest="command")
    for name, many, text in (
        ("check", "+", "check a configuration, with its overlays merged"),
        ("results", "*", "folder of the results of a study, by default the paper's"),
    ):
        command = commands.add_parser(name, help=text)
        command.add_argument(
            "files", nargs=many, help="configuration, then overlays, in YAML", metavar="FILE"
        )
        command.add_argument("--results", help="folder given on the command line of the study")
    describing = commands.add_parser("describe", help="tables of all settings, in Markdown")
    describing.add_argument("readme", nargs="?", help="file to write them into; otherwise they are printed")
    options = parser.parse_args(arguments)
    try:
        require(("jsonschema", "matplotlib", "yaml"))
        _run(options)
    except (ConfigError, MissingPackageError, OSError) as error:
        print(f"config: {one_line(str(error))}", file=sys.stderr)
        return 1
    return 0


def _run(options: argparse.Namespace) -> None:
    if options.command != "describe":
        from asperity.study.config.study import read_study

        given = {} if options.results is None else {"results": options.results}
        study = read_study(options.files, given)
        if options.command == "results":
            print(study["results"])
    elif options.readme is None:
        print(describe(), end="")
    else:
        readme = Path(options.readme)
        readme.write_text(with_settings(readme.read_text(encoding="utf-8")), encoding="utf-8")


def describe() -> str:
    """All settings: a table for each section of a configuration, and one for settings outside sections."""
    sections = schema()["properties"]
    alone = {key: entry for key, entry in sections.items() if entry.get("type") != "object"}
    tables = [_table("Settings of the whole study", schema()["description"], alone.items())]
    for key, entry in sections.items():
        if key not in alone:
            tables.append(_table(f"`{key}`", entry["description"], _rows(key, entry)))
    return "\n\n".join(tables) + "\n"


def with_settings(text: str) -> str:
    """Text of a README with the tables of `describe` after its `MARK`."""
    return text.split(MARK)[0] + MARK + "\n" + describe()


def _table(title: str, description: str, rows: Iterable[tuple[str, Entry]]) -> str:
    lines = []
    for key, entry in rows:
        default_text = entry.get("default_text", "")
        if "default" in entry:
            value = entry["default"]
            default_text = f"`{str(value).lower() if isinstance(value, bool) else value}`"
        cells = (f"`{key}`", accepted(entry), entry.get("unit", ""), default_text, entry["description"])
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([f"### {title}", "", description, "", *_HEAD, *lines])


def _rows(section: str, entry: Entry) -> Iterator[tuple[str, Entry]]:
    """Key and description of all settings of a section; a group that repeats another refers to it."""
    groups: dict[str, Entry] = {}
    repeated = ""
    for key, below in settings(entry, f"{section}."):
        if repeated and key.startswith(repeated):
            continue
        if "properties" in below:
            twin = next((other for other, known in groups.items() if known == below["properties"]), None)
            if twin:
                repeated = f"{key}."
                below = {**below, "description": f"{below['description']} Settings as in `{twin}`."}
            groups[key] = below["properties"]
        yield key, below


if __name__ == "__main__":
    sys.exit(main())
