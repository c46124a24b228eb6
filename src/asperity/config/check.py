"""The study's configuration: checked against its schema, and described from it.

`python -m asperity.config.check SCHEMA` prints the description of every key,
`python -m asperity.config.check SCHEMA CONFIG OVERLAY ...` checks a configuration with its overlays.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from asperity.errors import ConfigError, shown
from asperity.runtime.preflight import PACKAGES, REMEDY

try:
    import jsonschema
    import yaml
except ModuleNotFoundError as error:
    if __name__ == "__main__" and error.name in PACKAGES:
        sys.exit(f"config: not installed: {PACKAGES[error.name]}; {REMEDY}")
    raise

from asperity.config.presets import complete
from asperity.config.reader import load, merged

_WORDS = {
    "number": "a number",
    "integer": "a whole number",
    "string": "text",
    "array": "a list",
    "object": "a group of keys",
}


_MOST_POINTS = 32768

_VALIDATOR = jsonschema.validators.extend(
    jsonschema.Draft202012Validator,
    type_checker=jsonschema.Draft202012Validator.TYPE_CHECKER.redefine(
        "integer", lambda _, value: isinstance(value, int) and not isinstance(value, bool)
    ),
)
"""A whole number is one that is written as one: 2048.0 is not."""


def load_schema(path: str | Path) -> dict[str, Any]:
    """The schema in the YAML file `path`."""
    with open(path, encoding="utf-8") as file:
        return yaml.safe_load(file)


def check_files(config: Mapping[str, Any]) -> None:
    """Raise `ConfigError` for the first measured surface whose file is not there."""
    for name, surface in config["measured"].items():
        if not Path(surface["file"]).is_file():
            raise ConfigError(f"measured.{name}.file = {shown(surface['file'])}: no such file")


def check(config: Mapping[str, Any], schema: Mapping[str, Any]) -> None:
    """Raise `ConfigError` for the first key that the schema or the physics does not accept."""
    _check_plain("", config)
    validator = _VALIDATOR(schema)
    error = min(validator.iter_errors(config), key=lambda e: (len(e.path), str(e.path)), default=None)
    if error is not None:
        raise ConfigError(_one_line(error))
    _check_grids(config)
    config = complete(config)
    _check_grids(config)
    for name, surface in config["surfaces"].items():
        _check_surface(f"surfaces.{name}", surface)
    for section in ("surfaces", "measured"):
        for name, surface in config[section].items():
            _check_label(f"{section}.{name}.label", surface["label"])
    for name in config["measured"]:
        if name in config["surfaces"]:
            raise ConfigError(f"measured.{name}: another name is needed, surfaces.{name} has it")
    known = {**config["surfaces"], **config["measured"]}
    for study, names in config["studies"].items():
        for name in names:
            if name not in known:
                raise ConfigError(
                    f"studies.{study} = {name!r}: the name of a surface is needed ({', '.join(known)})"
                )
    if config["contact"]["precision"] == "float32" and config["contact"]["tolerance"] < 1e-6:
        raise ConfigError(
            f"contact.tolerance = {config['contact']['tolerance']!r}: at least 1e-6 is needed in float32"
        )
    path = config["contact"]["path_area_fractions"]
    if path != sorted(path):
        raise ConfigError(f"contact.path_area_fractions = {path!r}: rising numbers are needed")
    if config["layer"]["poisson"] not in config["stress"]["poisson"]:
        raise ConfigError(
            f"stress.poisson = {config['stress']['poisson']!r}: "
            f"layer.poisson = {config['layer']['poisson']!r} must be one of them"
        )


def _check_grids(config: Mapping[str, Any]) -> None:
    for section in ("surfaces", "measured"):
        for name, surface in config[section].items():
            short, points = surface.get("wavelength_short", 1.0), surface.get("points", 0)
            key, least = f"{section}.{name}", 2 / _MOST_POINTS
            if short < least:
                raise ConfigError(f"{key}.wavelength_short = {short!r}: a number ≥ {least:g} is needed")
            if points > _MOST_POINTS:
                raise ConfigError(
                    f"{key}.points: {points} are too many for a grid of at most {_MOST_POINTS}; "
                    f"a longer wavelength_short or another accuracy is needed"
                )


def _check_label(key: str, label: str) -> None:
    if not label.isprintable():
        raise ConfigError(f"{key} = {shown(label)}: text that can be printed is needed")
    if label.count("$") % 2:
        raise ConfigError(f"{key} = {shown(label)}: mathematics between two dollar signs is needed")


def _check_plain(key: str, value: Any) -> None:
    """What a schema cannot say: keys are text, numbers are finite."""
    if isinstance(value, Mapping):
        for name, entry in value.items():
            if not isinstance(name, str):
                raise ConfigError(f"{key}{shown(name)}: a key that is text is needed")
            _check_plain(f"{key}{name}.", entry)
    elif isinstance(value, list):
        for entry in value:
            _check_plain(key, entry)
    elif isinstance(value, float) and not math.isfinite(value):
        raise ConfigError(f"{key.rstrip('.')} = {value!r}: a finite number is needed")


def _check_surface(key: str, surface: Mapping[str, Any]) -> None:
    short, long = surface["wavelength_short"], surface["wavelength_long"]
    if short > long:
        raise ConfigError(f"{key}.wavelength_short = {short!r}: at most wavelength_long = {long!r} is needed")
    if short * surface["points"] < 2 - 1e-9:
        raise ConfigError(
            f"{key}.points = {surface['points']!r}: at least {round(2 / short)} are needed, "
            f"two on wavelength_short = {short!r}"
        )
    if "moments" in surface:
        if "johnson" in surface:
            raise ConfigError(f"{key}.moments: only one of moments and johnson is accepted")
        skewness, kurtosis = surface["moments"]["skewness"], surface["moments"]["kurtosis"]
        if kurtosis <= 1 + skewness**2:
            raise ConfigError(
                f"{key}.moments.kurtosis = {kurtosis!r}: a number > {1 + skewness**2:g}, "
                f"1 + skewness², is needed"
            )


def _one_line(error: jsonschema.ValidationError) -> str:
    key = ".".join(map(_part, error.absolute_path)) or "the configuration"
    if error.validator == "additionalProperties":
        known = error.schema["properties"]
        unknown = next(name for name in error.instance if name not in known)
        prefix = f"{key}." if error.absolute_path else ""
        return f"{prefix}{_part(unknown)}: unknown key; known here are {', '.join(known)}"
    if error.validator == "required":
        missing = next(name for name in error.validator_value if name not in error.instance)
        prefix = f"{key}." if error.absolute_path else ""
        return f"{prefix}{missing}: missing; {accepted(error.schema['properties'][missing])} is needed"
    if error.validator == "pattern" and "accepts" not in error.schema:
        return (
            f"{key}: {shown(error.instance)} as a name; at most 40 lower-case letters, digits and "
            f"underscores are needed, a letter first"
        )
    text_for_number = error.schema.get("type") in ("number", "integer") and _is_number(error.instance)
    hint = " (YAML reads this as text; an exponent needs a decimal point: 1.0e-6)" if text_for_number else ""
    return f"{key} = {shown(error.instance)}: {accepted(error.schema)} is needed{hint}"


def _part(name: Any) -> str:
    """A key as it is shown in a message."""
    return str(name) if len(str(name)) <= 40 and str(name).isprintable() else shown(name)


def _is_number(text: Any) -> bool:
    try:
        return isinstance(text, str) and math.isfinite(float(text))
    except ValueError:
        return False


def accepted(schema: Mapping[str, Any]) -> str:
    """What a key accepts, in words."""
    if "accepts" in schema:
        return schema["accepts"]
    if "enum" in schema:
        return " or ".join(str(choice) for choice in schema["enum"])
    words = _WORDS[schema["type"]]
    if schema["type"] == "array":
        count = _range(schema.get("minItems"), None, schema.get("maxItems"), None)
        distinct = "distinct " if schema.get("uniqueItems") else ""
        return f"a list of {count + ' ' if count else ''}{distinct}items, each {accepted(schema['items'])}"
    if schema["type"] == "string":
        limits = (
            f"of {schema['minLength']} to {schema['maxLength']} characters" if "maxLength" in schema else ""
        )
    else:
        ends = ("minimum", "exclusiveMinimum", "maximum", "exclusiveMaximum")
        limits = _range(*(schema.get(end) for end in ends))
    return f"{words} {limits}".strip()


def _range(minimum: Any, above: Any, maximum: Any, below: Any) -> str:
    low = f"≥ {minimum}" if minimum is not None else f"> {above}" if above is not None else ""
    high = f"≤ {maximum}" if maximum is not None else f"< {below}" if below is not None else ""
    return " and ".join(part for part in (low, high) if part)


def describe(schema: Mapping[str, Any]) -> str:
    """The keys as a Markdown table."""
    rows = ["| key | accepts | unit | meaning |", "|---|---|---|---|"]
    for key, entry in _keys("", schema):
        rows.append(f"| `{key}` | {accepted(entry)} | {entry.get('unit', '')} | {entry['description']} |")
    return "\n".join(rows)


def _keys(prefix: str, schema: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    for name, entry in schema.get("properties", {}).items():
        yield prefix + name, entry
        yield from _keys(f"{prefix}{name}.", entry)
    if isinstance(named := schema.get("additionalProperties"), Mapping):
        yield from _keys(f"{prefix}NAME.", named)


def main(arguments: list[str]) -> int:
    """Describe the schema, or check a configuration; 1 and one line on stderr if it is not accepted."""
    schema, *paths = arguments
    if not paths:
        print(describe(load_schema(schema)))
        return 0
    try:
        config: dict[str, Any] = {}
        for path in paths:
            config = merged(config, load(path))
        check(config, load_schema(schema))
        check_files(config)
    except ConfigError as error:
        print(f"config: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
