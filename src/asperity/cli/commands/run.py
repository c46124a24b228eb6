"""``asperity run``: from a measured map, two materials and a load to an answer."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping, Set
from dataclasses import fields
from pathlib import Path
from typing import Any

from asperity.cli.parser import COMMANDS, arguments, converted, direction, flag
from asperity.core.errors import ConfigError, InputError, fail, one_line, shown
from asperity.core.packages import require
from asperity.core.units import to_si
from asperity.study.config.check import needed_instead
from asperity.study.config.reader import load
from asperity.study.config.schema import accepted, setting

WRONG_USAGE = 2
"""Exit status for arguments that are not accepted, as argparse has it."""

KEYS: dict[str, str] = {
    entry["setting"].rpartition(".")[2]: entry["setting"]
    for group in COMMANDS["run"]["groups"]
    for entry in arguments(group).values()
    if "setting" in entry
}
"""Name of a setting that is an option → its dotted key."""

_NEEDS = {
    "bottom": "layer_height",
    "counter_young": "counter_poisson",
    "counter_poisson": "counter_young",
    "counter_yield": "counter_young",
    "counter_layer_height": "counter_young",
    "counter_bottom": "counter_layer_height",
    "form": "radius",
    "counter_turned_about": "counter_map",
    "counter_shift": "counter_map",
    "sliding_direction": "friction",
}
"""Setting → the one without which it has no meaning."""

_LOADS = {
    "pressure": ("mean_pressure", "pressure"),
    "force": ("force", "force"),
    "approach": ("approach", "length"),
    "area_fraction": ("area_fraction", None),
}
"""Setting → argument of `asperity.engineering.run` and dimension."""


def run(options: argparse.Namespace) -> None:
    """Compute the answer, print it, and write results, pictures and report."""
    require(("SurfaceTopography", "matplotlib"))  # before the computation, not after it
    values, refused = _values(options)
    problems = [*refused.values(), *_contradictions(options, values, {*values, *refused})]
    face, of_map = _face(options.map, values, refused.keys())
    if problems or of_map:
        sys.exit(max(fail(problem, WRONG_USAGE) for problem in [*problems, *of_map]))

    from asperity.cli.notice import progress_bar
    from asperity.engineering import run as answer_of
    from asperity.engineering import write_answer

    load = next(name for name in _LOADS if name in values)
    argument, dimension = _LOADS[load]
    imposed = {argument: values[load] if dimension is None else to_si(values[load], dimension)}
    with progress_bar(f"run {options.map}") as progress:
        answer = answer_of(
            face,
            _body(values, ""),
            _body(values, "counter_") if "counter_young" in values else None,
            friction=values.get("friction", 0.0),
            sliding_direction=direction(values.get("sliding_direction", "x")),
            counter_map=_counter_map(values),
            map_options=_map_options(values),
            fields=values.get("fields", ("von_mises",)),
            progress=progress,
            **imposed,
        )
    print(answer.text(), end="\n\n", flush=True)
    files = write_answer(answer, options.out)
    for kind, suffixes in (("pictures", [".png"]), ("results", [".nc", ".csv"]), ("report", [".html"])):
        names = " ".join(str(path) for path in files if path.suffix in suffixes)
        print(f"{kind:<10}{one_line(names)}")


def _face(path: str, values: Mapping[str, Any], refused: Set[str]) -> tuple[Any, list[str]]:
    """The map as it is pressed, or both maps, and what is wrong with it.

    A map that needs an option whose value is `refused` already is not blamed for it again.
    """
    from asperity.engineering.case import read_face
    from asperity.surface.reading.height_map import MapError

    try:
        return read_face(path, _map_options(values), _counter_map(values)), []
    except InputError as error:
        problems = [text for text in error.problems if not text.startswith(tuple(refused))]
        return None, list(MapError(error.source, problems).renamed(flag).lines)
    except ValueError as error:
        return None, [str(error)]


def _values(options: argparse.Namespace) -> tuple[dict[str, Any], dict[str, str]]:
    """Accepted values of all settings by name, and messages on refused ones; an option overrides the file."""
    values: dict[str, Any] = {}
    refused = {}
    known = setting("engineering")["properties"]
    for name, value in _configured(options.config).items():
        key = f"--config {options.config}: engineering.{name}"
        if name not in known:
            refused[key] = f"{key}: unknown key; known here are {', '.join(known)}"
        elif needed := needed_instead(value, known[name]):
            refused[key] = f"{key} = {shown(value)}: {needed} is needed"
        else:
            values[name] = value
    for name, key in KEYS.items():
        given, entry = getattr(options, key), setting(key)
        if given is None:
            continue
        values.pop(name, None)
        try:
            if isinstance(given, list):
                values[name] = [converted(entry["items"], text) for text in given]
            else:
                values[name] = converted(entry, given)
        except argparse.ArgumentTypeError as error:
            refused[name] = f"{flag(name)} {error}"
        if name in values and (needed := needed_instead(values[name], entry)):
            refused[name] = f"{flag(name)} {' '.join(given)}: {needed} is needed"
            del values[name]
    return values, refused


def _configured(path: str | None) -> Mapping[str, Any]:
    """Section ``engineering`` of a configuration."""
    try:
        section = load(path).get("engineering", {}) if path else {}
    except ConfigError as error:
        raise ConfigError(f"--config {error}") from error
    if not isinstance(section, Mapping):
        raise ConfigError(f"--config {path}: engineering = {shown(section)}: a group of keys is needed")
    return section


def _contradictions(options: argparse.Namespace, values: Mapping[str, Any], known: Set[str]) -> Iterator[str]:
    """What is missing, or does not go together; `known` are all settings given, also refused ones."""
    from asperity.engineering.output import folder_problem

    for name in ("young", "poisson"):
        if name not in known:
            yield f"{flag(name)}: missing; {accepted(setting(f'engineering.{name}'))} is needed"
    loads = [flag(name) for name in _LOADS if name in known]
    if len(loads) != 1:
        given = " and ".join(loads) or "none"
        yield f"{', '.join(map(flag, _LOADS))}: exactly one of them is needed, {given} given"
    if options.rigid and "counter_young" in known:
        yield f"--rigid: not accepted together with {flag('counter_young')}"
    for name, needed in _NEEDS.items():
        if name in known and needed not in known:
            yield f"{flag(name)}: needs {flag(needed)}"
    if "cylinder_axis" in known and values.get("form") != "cylinder":
        yield "--cylinder-axis: needs --form cylinder"
    if values.get("boundary") == "free":
        excluded = [name for name in ("periodic", "layer_height", "counter_layer_height") if name in known]
        yield from (f"--boundary free: not accepted together with {flag(name)}" for name in excluded)
    if options.out is None:
        yield "--out: missing; the name of a folder is needed"
    elif problem := folder_problem(options.out):
        yield f"--out {options.out}: {problem}"
    else:
        maps = [Path(path).resolve() for path in (options.map, values.get("counter_map")) if path]
        if any(path.parent == Path(options.out).resolve() for path in maps):
            yield f"--out {options.out}: holds the map; another folder is needed"


def _body(values: Mapping[str, Any], prefix: str) -> Any:
    """The body whose settings have names with this prefix."""
    from asperity.engineering import Body

    def si(name: str, dimension: str) -> float | None:
        text = values.get(f"{prefix}{name}")
        return None if text is None else to_si(text, dimension)

    return Body(
        to_si(values[f"{prefix}young"], "pressure"),
        values[f"{prefix}poisson"],
        si("yield", "pressure"),
        si("layer_height", "length"),
        values.get(f"{prefix}bottom", "bonded"),
    )


def _counter_map(values: Mapping[str, Any]) -> Any:
    from asperity.engineering import CounterMap

    if "counter_map" not in values:
        return None
    shift_y, shift_x = (to_si(text, "length") for text in values.get("counter_shift", ("0 m", "0 m")))
    return CounterMap(
        values["counter_map"],
        turned_about=values.get("counter_turned_about", "y"),
        shift=(shift_y, shift_x),
    )


def _map_options(values: Mapping[str, Any]) -> Any:
    from asperity.surface.reading.height_map import MapOptions

    given = {field.name: values[field.name] for field in fields(MapOptions) if field.name in values}
    if values.get("boundary") == "free":
        given["periodic"] = "none"
    return MapOptions(**given)
