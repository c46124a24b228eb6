"""The parser of the command line, made from `commands.yaml` and the settings."""

import argparse
import math
import os
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

COMMANDS: dict[str, Any] = packaged_yaml("asperity.cli", "commands.yaml")
"""Name → description, usage, arguments and groups of arguments of each command."""

SHARED: dict[str, Any] = COMMANDS.pop("shared")
"""Name → a group of arguments that several commands share."""

WRONG_USAGE = 2
"""Exit status for refused arguments, the same as argparse's."""

DESCRIPTION = """\
Stress inside an elastic solid pressed against a rough surface: from a measured map, materials and a load with
their units to an answer. The steps of a calculation are functions of the library."""

EPILOG = """\
From a map to an answer: run; as a page in the browser: app; answers that exist, side by side: compare.
Pictures and tables of its results: view, export. Whether they hold: verify.
The study of the paper: study; its cost and error beforehand: plan."""

_PLACEHOLDERS = {"number": "NUMBER", "integer": "INTEGER", "string": "TEXT"} | {
    quantity: quantity.upper() for quantity in ("pressure", "force", "length", "area", "volume")
}
"""Format or type of a setting → placeholder of its value in the usage."""


class Parser(argparse.ArgumentParser):
    """Parser that takes options by their whole names, and answers wrong usage with one line."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options, allow_abbrev=False)
        # A negative quantity such as -3nm is a value, which the option refuses with the accepted range.
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def error(self, message: str) -> NoReturn:
        """End the process with status 2."""
        sys.exit(fail(f"{message} (see {self.prog} --help)", WRONG_USAGE))


_NUMBER = re.compile(r"(?:^|=)[+-]?(?:\d+[.,]?\d*|\.\d+)(?:[eE][+-]?\d+)?\Z")

_UNIT = re.compile(r"[pnuµμmckMGT]?(?:m|Pa|N|bar|psi)(?:[/^]?(?:m?m)?\^?[23²³]?)?|HV|HRC|HB|HBW|HK")
"""Units of quantities of the command line, which may stand as a word of their own after a number."""


def parse(words: Sequence[str] | None) -> argparse.Namespace:
    """The options of a command line; refuses repeated options, and suggests the nearest for unknown ones."""
    words = with_units(sys.argv[1:] if words is None else words)
    command = next((word for word in words if word in COMMANDS), "")
    entry = COMMANDS.get(command, {})
    known = {
        flag: given
        for each in (entry, *entry.get("groups", ()))
        for flag, given in arguments(each).items()
        if flag.startswith("--")
    }
    if not command and words and not words[0].startswith("-"):
        sys.exit(fail(_no_command(words[0]), WRONG_USAGE))
    rest = words[words.index(command) :] if command else ()
    given = Counter(word.partition("=")[0] for word in takewhile("--".__ne__, rest))
    # Refused before the parser is made, whose settings take a tenth of a second.
    unknown = [word for word in given if word.startswith("--") and word not in {*known, "--help"}]
    for flag, options in known.items():
        if given[flag] > 1 and options.get("action") != "append":
            sys.exit(fail(f"{flag}: given {given[flag]} times (see asperity {command} --help)", WRONG_USAGE))
    if not unknown:
        wants_help = not {"-h", "--help"}.isdisjoint(words)
        found, unknown = make_parser(command, wants_help).parse_known_args(words)
        if not unknown:
            return found
    near = did_you_mean(unknown[0], known)
    if not near and command in ("run", "app") and unknown[0].startswith("--"):
        from asperity.engineering.templates import hint

        key, how = hint(unknown[0])
        name = next((name for name, given in known.items() if given.get("key") == key), "")
        near = f"; did you mean {name}?" if name else f"; the key is {key}{how}" if key else ""
    sys.exit(fail(f"{' '.join(unknown)}: not accepted{near} (see asperity {command} --help)", WRONG_USAGE))


def _no_command(word: str) -> str:
    """Message on a first word that is no command, but perhaps a map or a question."""
    from asperity.engineering.templates import hint, templates

    key, how = hint(word)
    means = f"; the key is {key}{how}" if key else did_you_mean(word, COMMANDS)
    if os.path.exists(word):
        means = f"; did you mean asperity run {word}?"
    elif word in templates():
        means = f"; asperity case {word} writes a case file for asperity run"
    return f"{shown(word)}: one of {', '.join(COMMANDS)} is needed{means}"


def with_units(words: Sequence[str]) -> list[str]:
    """Words of a command line, in which a number and its unit after an option are one word."""
    joined: list[str] = []
    in_option = False
    for word in words:
        in_option = in_option or word.startswith("--")
        if (
            in_option
            and joined
            and _NUMBER.search(joined[-1])
            and _UNIT.fullmatch(word)
            and not os.path.exists(word)
        ):
            joined[-1] += f" {word}"
        else:
            joined.append(word)
    return joined


def make_parser(only: str | None = None, explained: bool = True) -> Parser:
    """Parser of the command line; its result names the command as ``command``.

    Parameters
    ----------
    only : str, optional
        The command whose arguments are needed; by default the arguments of all commands are made.
    explained : bool
        True if settings of a case are explained, for which all questions are imported.
    """
    parser = Parser(prog="asperity", description=DESCRIPTION, epilog=EPILOG)
    parser.add_argument("--version", action="version", version=f"asperity {__version__}")
    commands = parser.add_subparsers(title="commands", required=True, dest="command", metavar="COMMAND")
    for name, entry in COMMANDS.items():
        description = entry["description"]
        summary = description.split(". ")[0].rstrip(".")
        command = commands.add_parser(
            name,
            help=summary[0].lower() + summary[1:],
            description=description,
            usage=entry.get("usage"),
        )
        if only not in (None, name):
            continue
        if entry.get("formats"):
            from asperity.surface.reading.formats import formats_in_words

            command.epilog = formats_in_words()
        _add_arguments(command, entry, explained)
        for group in entry.get("groups", ()):
            titled = command.add_argument_group(group["title"], group.get("description"))
            _add_arguments(titled, group, explained)
    return parser


def arguments(entry: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Flag or name → description of the arguments of a command or group itself, without its groups."""
    found: dict[str, dict[str, Any]] = {}
    for key, given in entry.items():
        if key == "arguments":
            found |= given
        elif key == "case":
            found |= {name: {"key": each} if isinstance(each, str) else each for name, each in given.items()}
        elif key == "with":
            for shared in given:
                found |= arguments(SHARED[shared])
    return found


FLAGS = {each["key"]: name for group in COMMANDS["run"]["groups"] for name, each in arguments(group).items()}
"""Dotted key of a setting of a case → its flag of ``asperity run``."""


def _add_arguments(parser: argparse._ActionsContainer, entry: Mapping[str, Any], explained: bool) -> None:
    """Add the arguments of a command or group; settings are explained only where help is wanted."""
    for flag, given in arguments(entry).items():
        options = {
            name: value for name, value in given.items() if name not in ("key", "setting", "default_text")
        }
        if isinstance(options.get("metavar"), list):
            options["metavar"] = tuple(options["metavar"])
        if "type" in options:
            options["type"] = TYPES[options["type"]]
        if "help" in options:
            options["help"] = options["help"].replace("%", "%%")
        if explained and ("key" in given or "setting" in given):
            options = _of_field(given) | options
        parser.add_argument(flag, **options)


def _of_field(given: Mapping[str, Any]) -> dict[str, Any]:
    """Placeholder and help of a setting of a case or of the study."""
    from asperity.engineering.case import Case
    from asperity.settings.configuration import Configuration
    from asperity.settings.model import accepted, entry_of

    entry = entry_of(Case, given["key"]) if "key" in given else entry_of(Configuration, given["setting"])
    facts = [] if "enum" in entry else [accepted(entry)]
    if "unit" in entry:
        facts.append(f"unit: {entry['unit']}")
    if default := given.get("default_text") or entry.get("default_text") or entry.get("default"):
        facts.append(f"default: {default}")
    text = entry["description"].rstrip(".") + (f" ({'; '.join(facts)})" if facts else "")
    kinds = entry.get("anyOf", [entry])
    kind = kinds[0] if kinds[0] == {"type": "string"} else kinds[-1]  # a name or a number is a text
    types = kind["type"] if isinstance(kind["type"], list) else [kind["type"]]
    value = _PLACEHOLDERS.get(kind.get("format", "")) or _PLACEHOLDERS.get(types[-1], "VALUE")
    value = f"{{{','.join(entry['enum'])}}}" if "enum" in entry else value
    return {"metavar": value, "help": text.replace("`", "").replace("%", "%%")}


def _number(text: str, above: float = -math.inf) -> float:
    """A finite number."""
    with suppress(ValueError):
        if above < (value := float(text)) < math.inf:
            return value
    limit = "" if above == -math.inf else f" > {above:g}"
    raise argparse.ArgumentTypeError(f"{shown(text)}: a number{limit} is needed")


def _direction(text: str) -> str | float:
    """An axis, or an angle in degrees."""
    if text in ("x", "y"):
        return text
    with suppress(argparse.ArgumentTypeError):
        return _number(text)
    raise argparse.ArgumentTypeError(f"{shown(text)}: x, y or an angle in degrees from x towards y is needed")


def _port(text: str) -> int:
    if not (text.isdecimal() and int(text) < 2**16):
        raise argparse.ArgumentTypeError(f"{shown(text)}: a number from 0 to {2**16 - 1} is needed")
    return int(text)


TYPES: dict[str, Callable[[str], Any]] = {
    "number": _number,
    "positive": partial(_number, above=0),
    "port": _port,
    "direction": _direction,
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


def with_flags(message: str, command: str) -> str:
    """A message that begins with arguments of the library, with the options of a command in their place."""
    entry = COMMANDS[command]
    known = {key for each in (entry, *entry.get("groups", ())) for key in arguments(each)}
    names = {name.removeprefix("--").replace("-", "_") for name in known if name.startswith("--")}
    head, colon, rest = f"{message}".partition(":")
    given = re.compile(rf"(?:^|(?<=, ))({'|'.join(names)})(?= = |, |$)")
    return given.sub(lambda found: flag(found[0]), head) + colon + rest


def flag(name: str) -> str:
    """Argument of the command line that sets a parameter: ``--physical-size`` for ``physical_size``."""
    return f"--{name.replace('_', '-')}"
