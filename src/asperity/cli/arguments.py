"""Arguments of the command line made from the schema of the settings, and their values by section."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import Any, NamedTuple, NoReturn

from asperity.config.check import needed_instead
from asperity.config.defaults import default
from asperity.config.schema import Entry, accepted, setting
from asperity.errors import fail, shown

_KINDS: dict[str, Callable[[str], Any]] = {"number": float, "integer": int, "string": str}
_PLACEHOLDERS = {"number": "NUMBER", "integer": "INTEGER", "string": "TEXT"}

POSITIVE: Entry = {"type": "number", "exclusiveMinimum": 0}
"""Accepted values of arguments that are no settings: times, errors, memory."""


class Refused(NamedTuple):
    """A value that a setting does not accept, kept until all arguments are read."""

    flag: str
    message: str


class Parser(argparse.ArgumentParser):
    """Parser that takes options by their whole names, and reports every refused value in one line."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options, allow_abbrev=False)

    def parse_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: None = None
    ) -> argparse.Namespace:
        """Read the arguments; end the process with status 2 if there are refused values."""
        options = super().parse_args(args, namespace)
        values = [v if isinstance(v, list) else [v] for v in vars(options).values()]
        refused = [value for listed in values for value in listed if isinstance(value, Refused)]
        for value in refused:
            fail(f"argument {value.flag}: {value.message} (see {self.prog} {options.command} --help)")
        if refused:
            sys.exit(2)
        return options

    def error(self, message: str) -> NoReturn:
        """End the process with status 2."""
        sys.exit(fail(f"{message} (see {self.prog} --help)", 2))


class _StoreList(argparse.Action):
    """Store a list of values that the schema accepts as a whole: their number, and that they are distinct."""

    def __call__(self, parser: Any, namespace: Any, values: Any, option_string: str | None = None) -> None:
        known = not any(isinstance(value, Refused) for value in values)
        if known and (needed := needed_instead(values, setting(self.dest))):
            values = Refused(self.option_strings[0], f"{shown(values)}: {needed} is needed")
        setattr(namespace, self.dest, values)


def add_setting(
    parser: argparse._ActionsContainer, flag: str, key: str, *, left_out: str | None = None, **options: Any
) -> None:
    """Add an argument for a setting: type, range, choices, default and help come from the schema.

    Parameters
    ----------
    parser : argument parser or group
    flag : str
        Such as ``--area-fraction``.
    key : str
        Dotted key of the setting; the value is found under it by `section`.
    left_out : str, optional
        What holds without the argument, if that is not the default of the setting: there is none then.
    **options
        Passed to `argparse`, in place of what the schema says.
    """
    entry = setting(key)
    items = entry.get("items", entry)
    value = None if left_out else default(key)
    if entry.get("type") == "array":
        fixed = entry.get("minItems") if entry.get("minItems") == entry.get("maxItems") else None
        options = {"nargs": fixed or "+", "action": _StoreList} | options
    without = left_out or entry.get("left_out") if value is None else str(value)
    made: dict[str, Any] = {
        "dest": key,
        "type": partial(_converted_or_refused, flag, items),
        "metavar": _placeholder(items),
        "default": value,
        "help": _help(entry, without),
    }
    parser.add_argument(flag, **made | options)


def section(options: argparse.Namespace, name: str) -> dict[str, Any]:
    """Values of the arguments that are settings of one section, without those that have no value."""
    prefix = f"{name}."
    values = {
        key.removeprefix(prefix): value for key, value in vars(options).items() if key.startswith(prefix)
    }
    return {key: value for key, value in values.items() if value is not None}


def sliding(options: argparse.Namespace) -> dict[str, Any]:
    """Friction and direction of sliding that are given, as arguments of `asperity.plot_section`."""
    given = section(options, "engineering")
    if "sliding_direction" in given:
        given["sliding_direction"] = direction(given["sliding_direction"])
    return given


def direction(text: str) -> str | float:
    """Direction of sliding from text that the schema accepts: ``x``, ``y`` or degrees."""
    return text if text in ("x", "y") else float(text)


def flag(name: str) -> str:
    """Argument of the command line that sets a parameter: ``--physical-size`` for ``physical_size``."""
    return f"--{name.replace('_', '-')}"


def converted(entry: Entry, text: str) -> Any:
    """Value of an argument, from its text.

    Raises
    ------
    argparse.ArgumentTypeError
        If the schema does not accept it.
    """
    kinds = entry.get("type", "string")
    value = None
    for kind in kinds if isinstance(kinds, list) else [kinds]:
        with suppress(ValueError):
            value = _KINDS[kind](text)
            break
    if needed := needed_instead(value, entry):
        raise argparse.ArgumentTypeError(f"{shown(text)}: {needed} is needed")
    return value


def _converted_or_refused(flag: str, entry: Entry, text: str) -> Any:
    try:
        return converted(entry, text)
    except argparse.ArgumentTypeError as error:
        return Refused(flag, str(error))


def _placeholder(entry: Entry) -> str:
    if "enum" in entry:
        return f"{{{','.join(entry['enum'])}}}"
    return "LENGTH" if entry.get("format") == "length" else _PLACEHOLDERS[entry["type"]]


def _help(entry: Entry, without: str | None) -> str:
    """Help of an argument. Text from the schema is escaped: argparse formats it with %."""
    facts = [] if "enum" in entry else [accepted(entry.get("items", entry))]
    if "unit" in entry:
        facts.append(f"unit: {entry['unit']}")
    if without:
        facts.append(f"default: {without}")
    text = entry["description"].rstrip(".") + (f" ({'; '.join(facts)})" if facts else "")
    return text.replace("`", "").replace("%", "%%")
