"""The parser of the command line, made from `commands.yaml` and the schema of the settings."""

import argparse
import re
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from itertools import takewhile
from typing import Any, NoReturn

from asperity.core.data import packaged_yaml
from asperity.core.errors import did_you_mean, fail, shown
from asperity.core.version import __version__
from asperity.paper.figures import known
from asperity.study.config.check import needed_instead
from asperity.study.config.schema import Entry, accepted, default, setting
from asperity.surface.reading.formats import formats_in_words

COMMANDS: dict[str, Any] = packaged_yaml("asperity.cli", "commands.yaml")
"""Name → description, usage, arguments and groups of arguments of each command."""

SHARED: dict[str, Any] = COMMANDS.pop("shared")
"""Name → a group of arguments that several commands share."""

MANY = 8
"""Most values of a list that a message shows."""

DESCRIPTION = """\
Stress inside an elastic solid pressed against a rough surface. The command run takes a measured map,
materials and a load with their units. The others have lengths in units of the longer edge of the periodic
cell, stresses in units of the effective modulus E/(1 - poisson^2)."""

EPILOG = """\
From a map to an answer: run. The steps of a calculation: surface, solve, stress, peaks, plot. Its cost and
error beforehand: plan. Pictures and tables of its results: view, export. Whether they
hold: verify. The study of the paper: study."""

_PLACEHOLDERS = {"number": "NUMBER", "integer": "INTEGER", "string": "TEXT"} | {
    quantity: quantity.upper() for quantity in ("pressure", "force", "length", "area", "volume")
}
"""Format or type of a setting → placeholder of its value in the usage."""


class Parser(argparse.ArgumentParser):
    """Parser that takes options by their whole names, and answers wrong usage with one line."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options, allow_abbrev=False)

    def error(self, message: str) -> NoReturn:
        """End the process with status 2."""
        sys.exit(fail(f"{message} (see {self.prog} --help)", 2))


def parse(words: Sequence[str] | None) -> argparse.Namespace:
    """The options of a command line; refuses repeated options, and suggests the nearest for unknown ones."""
    found, unknown = make_parser().parse_known_args(words)
    entry = COMMANDS[found.command]
    known = {
        flag: given
        for each in (entry, *entry.get("groups", ()))
        for flag, given in arguments(each).items()
        if flag.startswith("--")
    }
    given = Counter(word.partition("=")[0] for word in takewhile("--".__ne__, words or sys.argv[1:]))
    for flag, options in known.items():
        if given[flag] > 1 and options.get("action") != "append":
            sys.exit(fail(f"{flag}: given {given[flag]} times (see asperity {found.command} --help)", 2))
    if unknown:
        near = did_you_mean(unknown[0], known)
        fail(f"{' '.join(unknown)}: not accepted{near} (see asperity {found.command} --help)")
        sys.exit(2)
    return found


def make_parser() -> Parser:
    """Parser of the command line; its result names the command as ``command``."""
    parser = Parser(prog="asperity", description=DESCRIPTION, epilog=EPILOG)
    parser.add_argument("--version", action="version", version=f"asperity {__version__}")
    commands = parser.add_subparsers(title="commands", required=True, dest="command", metavar="COMMAND")
    for name, entry in COMMANDS.items():
        description = entry["description"]
        summary = description.split(".")[0]
        command = commands.add_parser(
            name,
            help=summary[0].lower() + summary[1:],
            description=description,
            usage=entry.get("usage"),
            epilog=formats_in_words() if entry.get("formats") else None,
        )
        _add_arguments(command, entry, False)
        for group in entry.get("groups", ()):
            titled = command.add_argument_group(group["title"], group.get("description"))
            _add_arguments(titled, group, entry.get("checks", False))
    return parser


def arguments(entry: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Flag or name → description of all arguments of a command or group, without those of its groups."""
    found: dict[str, dict[str, Any]] = {}
    for key, given in entry.items():
        if key == "arguments":
            found |= given
        elif key == "settings":
            pairs = ((section, name) for section, names in given.items() for name in names)
            found |= {flag(name): {"setting": f"{section}.{name}"} for section, name in pairs}
        elif key == "with":
            for shared in given:
                found |= arguments(SHARED[shared])
    return found


def _add_arguments(parser: argparse._ActionsContainer, entry: Mapping[str, Any], checks: bool) -> None:
    for flag, given in arguments(entry).items():
        options = dict(given)
        if isinstance(options.get("metavar"), list):
            options["metavar"] = tuple(options["metavar"])
        key, default_text, words = (
            options.pop(name, None) for name in ("setting", "default_text", "accepts")
        )
        if "type" in options:
            options["type"] = TYPES[options["type"]]
        if key is not None:
            options = _of_setting(key, default_text, words, checks or "type" in options) | options
        elif "help" in options:
            options["help"] = options["help"].replace("%", "%%")
        parser.add_argument(flag, **options)


def _of_setting(key: str, default_text: str | None, words: str | None, as_text: bool) -> dict[str, Any]:
    """Keywords of `add_argument` for a setting, from the schema; its value is stored under its key.

    Parameters
    ----------
    key : str
        Dotted key.
    default_text : str, optional
        Behaviour if the argument is left out, in place of the default of the setting.
    words : str, optional
        Accepted values, in place of those of the schema.
    as_text : bool
        The command itself checks the value.
    """
    entry = setting(key)
    items = entry.get("items", entry)
    value = None if default_text or as_text else default(key)
    if "enum" in items:
        placeholder = f"{{{','.join(items['enum'])}}}"
    else:
        placeholder = _PLACEHOLDERS.get(items.get("format", "")) or _PLACEHOLDERS[items["type"]]
    made: dict[str, Any] = {"dest": key, "default": value, "metavar": placeholder}
    is_list = "items" in entry
    if is_list:
        fixed = entry.get("minItems") if entry.get("minItems") == entry.get("maxItems") else None
        made["nargs"] = fixed or "+"
    if not as_text:
        made |= {"action": _StoreList} if is_list else {"type": partial(converted, entry)}
    facts = [] if "enum" in entry else [words or accepted(items)]
    if "unit" in entry and not words:
        facts.append(f"unit: {entry['unit']}")
    if default_text := default_text or (str(value) if value is not None else entry.get("default_text")):
        facts.append(f"default: {default_text}")
    text = entry["description"].rstrip(".") + (f" ({'; '.join(facts)})" if facts else "")
    return made | {"help": text.replace("`", "").replace("%", "%%")}


class _StoreList(argparse.Action):
    """Store a list of values that the schema accepts, each and as a whole."""

    def __call__(self, parser: Any, namespace: Any, values: Any, option_string: str | None = None) -> None:
        try:
            setattr(namespace, self.dest, converted(setting(self.dest), values))
        except argparse.ArgumentTypeError as error:
            raise argparse.ArgumentError(self, str(error)) from error


def converted(entry: Entry, given: str | list[str]) -> Any:
    """Value of a setting, from the text or texts of an argument.

    Raises
    ------
    argparse.ArgumentTypeError
        If the schema does not accept it.
    """
    if isinstance(given, list):
        value = [converted(entry["items"], each) for each in given]
        text = " ".join(given) if len(given) < MANY else f"{' '.join(given[:MANY])} ... ({len(given)} values)"
    else:
        kinds, value, text = entry.get("type", "string"), None, shown(given)
        for kind in kinds if isinstance(kinds, list) else [kinds]:
            with suppress(ValueError):
                value = {"number": float, "integer": int, "string": str}[kind](given)
                break
    if needed := needed_instead(value, entry):
        raise argparse.ArgumentTypeError(f"{text}: {needed} is needed")
    return value


def _figure_number(text: str) -> int:
    """Number of a figure that can be drawn, from text such as ``9`` or ``fig09``."""
    drawn = sorted(figure.number for figure in known().values() if figure.number)
    number = text.lower().removeprefix("fig").removesuffix(".py")
    if not (number.isdecimal() and int(number) in drawn):
        raise argparse.ArgumentTypeError(f"{text[:60]!r}: one of {', '.join(map(str, drawn))} is needed")
    return int(number)


TYPES: dict[str, Callable[[str], Any]] = {
    "text": str,
    "positive": partial(converted, {"type": "number", "exclusiveMinimum": 0}),
    "seed": partial(converted, setting("seeds")["items"]),
    "figure": _figure_number,
}
"""Types of arguments by the names that `commands.yaml` uses."""


def section(options: argparse.Namespace, name: str) -> dict[str, Any]:
    """Values of the arguments that are settings of one section, without those that have no value."""
    prefix = f"{name}."
    return {
        key.removeprefix(prefix): value
        for key, value in vars(options).items()
        if key.startswith(prefix) and value is not None
    }


def sliding(options: argparse.Namespace) -> dict[str, Any]:
    """Friction and direction of sliding that are given, as arguments of `asperity.plot_section`."""
    given = section(options, "engineering")
    if given.get("sliding_direction", "x") not in ("x", "y"):
        given["sliding_direction"] = float(given["sliding_direction"])  # degrees
    return given


def with_flags(message: str, command: str) -> str:
    """A message that begins with arguments of the library, with the options of a command in their place."""
    entry = COMMANDS[command]
    known = {key for each in (entry, *entry.get("groups", ())) for key in arguments(each)}
    names = {name.removeprefix("--").replace("-", "_") for name in known if name.startswith("--")}
    head, colon, rest = f"{message}".partition(":")
    if "pressure" in names:
        head = re.sub("^mean_pressure ", "pressure ", head)
    given = re.compile(rf"(?:^|(?<=, ))({'|'.join(names)})(?= = |, |$)")
    return given.sub(lambda found: flag(found[0]), head) + colon + rest


def flag(name: str) -> str:
    """Argument of the command line that sets a parameter: ``--physical-size`` for ``physical_size``."""
    return f"--{name.replace('_', '-')}"
