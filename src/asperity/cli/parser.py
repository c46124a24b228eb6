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
    rest = words[words.index(command) :] if command else ()
    given = Counter(word.partition("=")[0] for word in takewhile("--".__ne__, rest))
    # Refused before the parser is made, whose settings take a tenth of a second.
    unknown = [word for word in given if word.startswith("--") and word not in {*known, "--help"}]
    for flag, options in known.items():
        if given[flag] > 1 and options.get("action") != "append":
            sys.exit(fail(f"{flag}: given {given[flag]} times (see asperity {command} --help)", 2))
    if not unknown:
        wants_help = not {"-h", "--help"}.isdisjoint(words)
        found, unknown = make_parser(command, wants_help).parse_known_args(words)
        if not unknown:
            return found
    near = did_you_mean(unknown[0], known)
    sys.exit(fail(f"{' '.join(unknown)}: not accepted{near} (see asperity {command} --help)", 2))


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
        elif key == "settings":
            pairs = ((section, name) for section, names in given.items() for name in names)
            found |= {flag(name): {"setting": f"{section}.{name}"} for section, name in pairs}
        elif key == "case":
            each_key = {name: {"key": each} for name, each in given.items() if isinstance(each, str)}
            found |= given | each_key
        elif key == "with":
            for shared in given:
                found |= arguments(SHARED[shared])
    return found


def _add_arguments(parser: argparse._ActionsContainer, entry: Mapping[str, Any], explained: bool) -> None:
    """Add the arguments of a command or group; settings of a case are explained only where help is wanted."""
    for flag, given in arguments(entry).items():
        options = dict(given)
        if isinstance(options.get("metavar"), list):
            options["metavar"] = tuple(options["metavar"])
        own = ("setting", "default_text", "accepts")
        key, default_text, words = (options.pop(name, None) for name in own)
        if (of_case := options.pop("key", None)) is not None:
            parser.add_argument(flag, **_of_case(of_case) | options if explained else options)
            continue
        if "type" in options:
            options["type"] = TYPES[options["type"]]
        if key is not None:
            options = _of_setting(key, default_text, words, "type" in options) | options
        elif "help" in options:
            options["help"] = options["help"].replace("%", "%%")
        parser.add_argument(flag, **options)


def _of_case(key: str) -> dict[str, Any]:
    """Keywords of `add_argument` for a setting of a case, which `asperity run` checks itself."""
    from asperity.engineering.case import Case
    from asperity.settings.model import entry_of

    entry = entry_of(Case, key)
    return {"metavar": _placeholder(entry), "help": _help(entry, entry.get("default_text"))}


def _placeholder(entry: Mapping[str, Any]) -> str:
    """Placeholder of a value in the usage."""
    if "enum" in entry:
        return f"{{{','.join(entry['enum'])}}}"
    kinds = entry.get("anyOf", [entry])
    kind = kinds[0] if kinds[0] == {"type": "string"} else kinds[-1]  # a name or a number is a text
    types = kind["type"] if isinstance(kind["type"], list) else [kind["type"]]
    return _PLACEHOLDERS.get(kind.get("format", "")) or _PLACEHOLDERS.get(types[-1], "VALUE")


def _help(entry: Mapping[str, Any], default_text: str | None, words: str | None = None) -> str:
    """Description of a setting with its accepted values and its default, as argparse takes it."""
    from asperity.settings.model import accepted

    facts = [] if "enum" in entry else [words or accepted(entry.get("items", entry))]
    if "unit" in entry and not words:
        facts.append(f"unit: {entry['unit']}")
    if default_text:
        facts.append(f"default: {default_text}")
    text = entry["description"].rstrip(".") + (f" ({'; '.join(facts)})" if facts else "")
    return text.replace("`", "").replace("%", "%%")


def _of_setting(key: str, default_text: str | None, words: str | None, as_text: bool) -> dict[str, Any]:
    """Keywords of `add_argument` for a setting of the study; its value is stored under its key.

    `default_text` and `words`, the accepted values, replace the texts of the setting. With `as_text` the
    command itself checks the value.
    """
    from asperity.settings.model import entry_of, item_of

    group, name = _place_of(key)
    entry = entry_of(group, name)
    items, value = item_of(entry), None
    if not (default_text or as_text):
        value = entry.get("default") if name != key else _default_of_study(key)
        default_text = entry.get("default_text") if value is None else str(value)
    if key.startswith("measured."):  # the map knows its defaults; those that are given are for maps alone
        value = None
    made: dict[str, Any] = {"dest": key, "default": value, "metavar": _placeholder(items)}
    if is_list := items is not entry:
        fewest = entry.get("minItems")
        made["nargs"] = fewest if fewest and fewest == entry.get("maxItems") else "+"
    if not as_text:
        made |= {"action": _StoreList} if is_list else {"type": partial(value_of, key)}
    return made | {"help": _help(entry, default_text or entry.get("default_text"), words)}


def _default_of_study(key: str) -> Any:
    from asperity.settings.check import default  # a slow import that options of a map do not need

    return default(key)


def _place_of(key: str) -> tuple[Any, str]:
    """Class that holds a setting of the study, and the key of the setting in it.

    Options that say how a map is read are in `FileOptions`, which is imported in a third of the time.
    """
    from asperity.settings.map import FileOptions

    of_file = key.removeprefix("measured.NAME.")
    if of_file != key and of_file in FileOptions.model_fields:
        return FileOptions, of_file
    from asperity.settings.configuration import Configuration

    return Configuration, key


class _StoreList(argparse.Action):
    """Store a list of values that the setting accepts, each and as a whole."""

    def __call__(self, parser: Any, namespace: Any, values: Any, option_string: str | None = None) -> None:
        try:
            setattr(namespace, self.dest, value_of(self.dest, values))
        except argparse.ArgumentTypeError as error:
            raise argparse.ArgumentError(self, str(error)) from error


def value_of(key: str, given: str | list[str]) -> Any:
    """Value of a setting, from the text or texts of an argument.

    Raises
    ------
    argparse.ArgumentTypeError
        If it is not accepted.
    """
    from asperity.settings.model import NeededError, converted

    try:
        return converted(*_place_of(key), given)
    except NeededError as error:
        refused = error.given
        if isinstance(refused, str):
            text = shown(refused)
        else:
            more = f" ... ({len(refused)} values)" if len(refused) >= MANY else ""
            text = " ".join(refused[:MANY]) + more
        raise argparse.ArgumentTypeError(f"{text}: {error} is needed") from None


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


def _figure_number(text: str) -> int:
    """Number of a figure that can be drawn, from text such as ``9`` or ``fig09``."""
    from asperity.paper.figures import known

    drawn = sorted(figure.number for figure in known().values() if figure.number)
    number = text.lower().removeprefix("fig").removesuffix(".py")
    if not (number.isdecimal() and int(number) in drawn):
        raise argparse.ArgumentTypeError(f"{text[:60]!r}: one of {', '.join(map(str, drawn))} is needed")
    return int(number)


def _port(text: str) -> int:
    if not (text.isdecimal() and int(text) < 2**16):
        raise argparse.ArgumentTypeError(f"{shown(text)}: a number from 0 to {2**16 - 1} is needed")
    return int(text)


TYPES: dict[str, Callable[[str], Any]] = {
    "text": str,
    "number": _number,
    "positive": partial(_number, above=0),
    "port": _port,
    "seed": lambda text: value_of("seeds", [text])[0],
    "direction": _direction,
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
