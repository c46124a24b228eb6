"""Check of a configuration against the schema, and of its settings against each other."""

import math
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from functools import partial
from typing import Any

import jsonschema

from asperity.core.errors import ConfigError, shown
from asperity.core.packages import absent
from asperity.study.config.schema import LOAD_LABELS, Entry, accepted, complete, number, schema, setting

_LONGEST_KEY = 40
"""Characters of a key that are shown as they are; longer keys are shortened like values."""

TWO_NODES_SLACK = 1e-9
"""Amount by which a grid may miss two nodes on the shortest wavelength: 1/3 has no finite decimals."""

_FEWEST_PLANES = 4
"""Planes of the stress that a layer must hold: verification needs one away from both faces."""

_FORMATS = jsonschema.FormatChecker(formats=())


def _is_whole(_: Any, value: object) -> bool:
    """True for a whole number that is written as one: 2048.0 is none."""
    return isinstance(value, int) and not isinstance(value, bool)


_STANDARD = jsonschema.Draft202012Validator
_Validator = jsonschema.validators.extend(
    _STANDARD,
    type_checker=_STANDARD.TYPE_CHECKER.redefine("integer", _is_whole).redefine(
        "number", lambda _, value: _is_whole(_, value) or (isinstance(value, float) and math.isfinite(value))
    ),
)


def check(config: Mapping[str, Any]) -> dict[str, Any]:
    """A configuration with all settings that it leaves out; `ConfigError` for the first that is not accepted.

    Parameters
    ----------
    config : mapping
        A configuration, with its overlays merged.

    Returns
    -------
    dict
        As of `asperity.study.config.schema.complete`.

    Raises
    ------
    ConfigError
        For an unknown key, a value outside its range, a missing key, or settings that contradict each other.
        The message names the key, its value and what is accepted.
    """
    _check_schema(config)
    whole = complete(config)
    for line in _contradictions(whole):
        raise ConfigError(line)
    _check_schema(whole)
    return whole


AS_SAMPLE = {"periodic": "none", "undefined": "harmonic"}
"""Treatment of a map of which the distribution of heights is taken, without the points that are filled."""


def check_files(config: Mapping[str, Any]) -> None:
    """Raise `ConfigError` for the first measured map whose file does not exist."""
    for key, entry in maps_of(config).items():
        if not os.path.isfile(entry["file"]):
            raise ConfigError(f"{key}.file = {shown(entry['file'])}: no such file")


def maps_of(config: Mapping[str, Any]) -> dict[str, Any]:
    """Dotted key → settings of every measured map, of a surface or of the heights of one."""
    maps = {f"measured.{name}": entry for name, entry in config.get("measured", {}).items()}
    for name, surface in config.get("surfaces", {}).items():
        if "map" in (heights := surface.get("heights", {})):
            maps[f"surfaces.{name}.heights.map"] = AS_SAMPLE | heights["map"]
    return maps


def needed_instead(value: Any, entry: Entry) -> str:
    """Accepted values of a setting in words, if the schema refuses this value; otherwise empty."""
    error = next(_Validator(entry, format_checker=_FORMATS).iter_errors(value), None)
    return "" if error is None else _needed(error)


def check_section(name: str, values: Mapping[str, Any], option: Callable[[str], str]) -> None:
    """Raise `ConfigError` for the first value that one section of a configuration does not accept.

    Parameters
    ----------
    name : str
        Of the section, such as ``contact``.
    values : mapping
    option : callable
        Gives the name of a setting in the interface of the user, for the message.
    """
    errors = _Validator(setting(name), format_checker=_FORMATS).iter_errors(values)
    error = next((error for error in errors if error.absolute_path), None)
    if error is not None:
        raise ConfigError(
            f"{option(str(error.absolute_path[0]))} = {shown(error.instance)}: {_needed(error)} is needed"
        )


@_FORMATS.checks("label", raises=ValueError)
def _is_label(text: object) -> bool:
    """True for a label that a figure can show; a `ValueError` says what is needed instead."""
    if not isinstance(text, str):
        return True
    if not text.isprintable():
        raise ValueError("text that can be printed")
    if text.count("$") % 2:
        raise ValueError("mathematics between two dollar signs")
    if "$" in text and not absent(["matplotlib"]):
        from matplotlib.mathtext import MathTextParser  # takes time, and not every command has matplotlib

        try:
            MathTextParser("path").parse(text)
        except ValueError as error:
            raise ValueError("mathematics that matplotlib can draw") from error
    return True


def _is_quantity(dimension: str, text: object) -> bool:
    """True for a positive number with a unit of a dimension; a `ValueError` says what is needed instead."""
    if not isinstance(text, str):
        return True
    from asperity.core.units import DIMENSIONS, misread, to_si  # need numpy; the help of a command does not

    with suppress(ValueError):
        if to_si(text, dimension) > 0:
            return True
    units = ", ".join(DIMENSIONS[dimension].examples)
    article = "an" if dimension == "area" else "a"
    raise ValueError(f"{article} {dimension} > 0 with its unit ({units}{misread(text, dimension)})")


for _dimension in ("pressure", "force", "length", "area", "volume"):
    _FORMATS.checks(_dimension, raises=ValueError)(partial(_is_quantity, _dimension))


def _check_schema(config: Mapping[str, Any]) -> None:
    """Raise `ConfigError` for the error nearest to the top of the configuration."""
    errors = _Validator(schema(), format_checker=_FORMATS).iter_errors(config)
    error = min(errors, key=lambda error: (len(error.path), str(error.path)), default=None)
    if error is None:
        return
    path = [_part(part) for part in error.absolute_path]
    if error.validator == "required":
        missing = next(key for key in error.schema["required"] if key not in error.instance)
        needed = accepted(error.schema["properties"][missing])
        raise ConfigError(f"{'.'.join([*path, missing])}: missing; {needed} is needed")
    if error.validator == "additionalProperties":
        unknown = next(name for name in error.instance if name not in error.schema["properties"])
        key = ".".join([*path, _part(unknown)])
        if unknown in (renamed := error.schema.get("renamed", {})):
            raise ConfigError(f"{key}: is called {'.'.join([*path, renamed[unknown]])} now")
        if unknown in (removed := error.schema.get("removed", {})):
            raise ConfigError(f"{key}: does not exist any more; {removed[unknown]}")
        known = ", ".join(error.schema["properties"])
        raise ConfigError(f"{key}: unknown key; known here are {known}")
    if "propertyNames" in error.absolute_schema_path:
        name = ".".join([*path, shown(error.instance)])
        raise ConfigError(f"{name}: {accepted(error.schema)} is needed")
    key = ".".join(path) or "the configuration"
    raise ConfigError(f"{key} = {shown(error.instance)}: {_needed(error)} is needed")


def _contradictions(config: Mapping[str, Any]) -> Iterator[str]:
    """What settings of a complete configuration contradict each other, a line each."""
    surfaces, measured, layer = config["surfaces"], config["measured"], config["layer"]
    known = {**surfaces, **measured}
    if not known:
        yield (
            "surfaces: missing; at least one is needed, here or under measured, or the paper's by "
            "based_on: config/config.yaml"
        )
    for name in measured.keys() & surfaces.keys():
        yield f"measured.{name}: another name is needed, surfaces.{name} has it"
    for name, surface in surfaces.items():
        key, points = f"surfaces.{name}", surface["points"]
        short, long = surface["wavelength_short"], surface["wavelength_long"]
        if short > long:
            yield f"{key}.wavelength_short = {short!r}: at most wavelength_long = {long!r} is needed"
        if short * points < 2 - TWO_NODES_SLACK:
            yield (
                f"{key}.points = {points!r}: at least {round(2 / short)} are needed, "
                f"two on wavelength_short = {short!r}"
            )
        given = [kind for kind in ("johnson", "moments", "heights") if kind in surface]
        if len(given) > 1:
            yield f"{key}.{given[1]}: only one of {given[1]} and {given[0]} is accepted"
        for place, group in (("", surface), ("heights.", surface.get("heights", {}))):
            moments = group.get("moments", {"skewness": 0.0, "kurtosis": 3.0})
            least, kurtosis = 1 + moments["skewness"] ** 2, moments["kurtosis"]
            if kurtosis <= least:
                needed = f"a number > {number(least)}, 1 + skewness²,"
                yield f"{key}.{place}moments.kurtosis = {kurtosis!r}: {needed} is needed"
    most = setting("surfaces.NAME.points")["maximum"]
    for section in ("surfaces", "measured"):
        for name, surface in config[section].items():
            if surface.get("points", 0) > most:
                yield (
                    f"{section}.{name}.points: {surface['points']} are too many for a grid of at most "
                    f"{most}; a longer wavelength_short or another accuracy is needed"
                )
    for study, names in config.get("studies", {}).items():
        for name in names:
            if name not in known:
                yield f"studies.{study} = {shown(name)}: the name of a surface is needed ({', '.join(known)})"
    if config["claims"] and config["figures"] != "paper":
        yield "claims = true needs figures = 'paper': the claims are statements about the paper's surfaces"
    for name, surface in known.items():
        least = _FEWEST_PLANES * config["stress"]["depth_spacing"] / surface.get("points", math.inf)
        if layer["height"] < least and "base" not in layer:
            yield (
                f"layer.height = {layer['height']!r}: at least {number(least)} is needed for {name}, "
                f"{_FEWEST_PLANES} planes at its depth_spacing"
            )
    if "base" in layer and layer["bottom"] != "bonded":
        yield f"layer.bottom = {layer['bottom']!r}: bonded is needed with layer.base"
    contact = config["contact"]
    loads = [name for name in LOAD_LABELS if name in contact]
    if len(loads) > 1:
        yield (
            f"contact.{loads[1]} = {shown(contact[loads[1]])}: not accepted together with {loads[0]}; "
            f"one of {', '.join(LOAD_LABELS)} is needed"
        )
    if layer["poisson"] not in (listed := config["stress"]["poisson"]):
        yield f"stress.poisson = {shown(listed)}: layer.poisson = {layer['poisson']!r} must be one of them"


def _needed(error: jsonschema.ValidationError) -> str:
    if error.validator == "maxItems":
        return f"a list of at most {error.validator_value} values"
    return str(error.cause) if error.validator == "format" else accepted(error.schema)


def _part(name: Any) -> str:
    """One part of a dotted key, as a message shows it."""
    return str(name) if len(str(name)) <= _LONGEST_KEY and str(name).isprintable() else shown(name)
