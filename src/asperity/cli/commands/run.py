"""``asperity run``: from a measured map, two materials and a load to an answer."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from asperity.cli.arguments import converted, direction, flag
from asperity.cli.run_options import RUN_MAP_OPTIONS, RUN_OPTIONS, Option
from asperity.config.check import needed_instead
from asperity.config.reader import is_file, load
from asperity.config.schema import setting
from asperity.errors import ConfigError, InputError, fail, shown
from asperity.packages import require
from asperity.units import shown_si, to_si

WRONG_USAGE = 2
"""Exit status for arguments that are not accepted, as argparse has it."""

_MAP_NAMES = (
    *(option.key.rpartition(".")[2] for option in RUN_MAP_OPTIONS),
    "boundary",
    "form",
    "cylinder_axis",
)
"""Settings that `MapSettings` takes as they are."""

_COUNTER_NAMES = tuple(f"counter_{name}" for name in ("young", "poisson", "yield", "layer_height", "bottom"))
"""Settings of an elastic counter body."""

_NEEDS = {
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
    values, problems = _values(options)
    refused = [problem.split(" ")[0] for problem in problems]
    problems += _contradictions(options, values)
    for problem in problems:  # at once: reading a map takes a second or more
        fail(problem)
    indenter, of_map = _indenter(options.map, values, refused)
    for problem in of_map:
        fail(problem)
    if problems or of_map:
        sys.exit(WRONG_USAGE)

    from asperity.cli.compiling import compile_visibly, run_small
    from asperity.engineering import run as answer_of
    from asperity.engineering import write_answer
    from asperity.runtime.progress import ProgressBar

    lower, upper = _bodies(values)
    settings, friction = _map_settings(values), values.get("friction", 0.0)
    compile_visibly("run", partial(run_small, lower, upper, settings, friction))
    with ProgressBar(f"run {options.map}") as progress:
        answer = answer_of(
            indenter,
            lower,
            upper,
            friction=friction,
            sliding_direction=direction(values.get("sliding_direction", "x")),
            counter_map=_counter_map(values),
            map_settings=settings,
            fields=values.get("fields", ("von_mises",)),
            progress=progress,
            **_load(values),
        )
    files = write_answer(answer, options.out)
    print(answer.text())
    pictures = " ".join(str(path) for path in files if path.suffix == ".png")
    results = " ".join(str(path) for path in files if path.suffix in (".nc", ".csv"))
    report = next(path for path in files if path.suffix == ".html")
    print(f"\npictures  {pictures}\nresults   {results}\nreport    {report}")


def _indenter(path: str, values: Mapping[str, Any], refused: Sequence[str]) -> tuple[Any, list[str]]:
    """The map as it is pressed, or both maps, and what is wrong with it.

    A map that needs an option whose value is `refused` already is not blamed for it again.
    """
    if not is_file(path) or not is_file(values.get("counter_map", path)):
        return None, []
    from asperity.engineering.indenter import read_indenter

    try:
        indenter = read_indenter(path, _map_settings(values), _counter_map(values))
    except InputError as error:
        told = zip(error.problems, error.lines, strict=True)
        return None, [line for problem, line in told if not problem.startswith(tuple(refused))]
    except ValueError as error:
        return None, [str(error)]
    problem = _too_deep(values, indenter)
    return indenter, [problem] if problem else []


def _too_deep(values: Mapping[str, Any], indenter: Any) -> str:
    """Message on an approach that no pressure on a periodic half-space causes; empty if there is none."""
    if "approach" not in values or "layer_height" in values or indenter.boundary == "free":
        return ""
    most = -float(indenter.height.min())
    if to_si(values["approach"], "length") < most:
        return ""
    return (
        f"--approach = {values['approach']}: less than {shown_si(most, 'm')} is needed, the height of the "
        "mean plane above the point that touches first; there a periodic half-space is in full contact"
    )


def _values(options: argparse.Namespace) -> tuple[dict[str, Any], list[str]]:
    """Values of all settings by name, and what is wrong with them; an option overrides the configuration."""
    problems: list[str] = []
    values = _configured(options.config, problems)
    for option in (*RUN_OPTIONS, *RUN_MAP_OPTIONS):
        given = getattr(options, option.key)
        if given is not None:
            name = option.key.rpartition(".")[2]
            values.pop(name, None)
            try:
                values[name] = _converted(option, given)
            except argparse.ArgumentTypeError as error:
                problems.append(f"{option.flag} {error}")
    return values, problems


def _converted(option: Option, given: str | list[str]) -> Any:
    entry = setting(option.key)
    if not isinstance(given, list):
        return converted(entry, given)
    values = [converted(entry["items"], text) for text in given]
    if needed := needed_instead(values, entry):
        raise argparse.ArgumentTypeError(f"{' '.join(given)}: {needed} is needed")
    return values


def _configured(path: str | None, problems: list[str]) -> dict[str, Any]:
    """Accepted values of section ``engineering`` of a configuration."""
    if path is None:
        return {}
    try:
        section = load(path).get("engineering", {})
    except ConfigError as error:
        problems.append(f"--config {error}")
        return {}
    entry = setting("engineering")
    if not isinstance(section, Mapping):
        problems.append(f"--config {path}: engineering = {shown(section)}: a group of keys is needed")
        return {}
    values = {}
    for name, value in section.items():
        if name not in entry["properties"]:
            known = ", ".join(entry["properties"])
            problems.append(f"--config {path}: engineering.{name}: unknown key; known here are {known}")
        elif needed := needed_instead(value, entry["properties"][name]):
            problems.append(f"--config {path}: engineering.{name} = {shown(value)}: {needed} is needed")
        else:
            values[name] = value
    return values


def _contradictions(options: argparse.Namespace, values: Mapping[str, Any]) -> list[str]:
    """What is missing, or does not go together."""
    from asperity.engineering.folder import folder_problem

    refused = {
        option.key.rpartition(".")[2]
        for option in RUN_OPTIONS
        if getattr(options, option.key) is not None and option.key.rpartition(".")[2] not in values
    }
    known = {*values, *refused}
    problems = []
    if not is_file(options.map):
        what = "a folder, a height map is needed" if os.path.isdir(options.map) else "no such file"
        problems.append(f"{options.map}: {what}")
    problems += [
        f"--{name}: missing; {setting(f'engineering.{name}')['accepts']} is needed"
        if name == "young"
        else f"--{name}: missing; a number > -1 and ≤ 0.5 is needed"
        for name in ("young", "poisson")
        if name not in known
    ]
    loads = [flag(name) for name in _LOADS if name in known]
    if len(loads) != 1:
        problems.append(
            f"{', '.join(map(flag, _LOADS))}: exactly one of them is needed, "
            f"{' and '.join(loads) if loads else 'none'} given"
        )
    counter = [name for name in _COUNTER_NAMES if name in known]
    if options.rigid and counter:
        problems.append(f"--rigid: not accepted together with {', '.join(map(flag, counter))}")
    elif counter:
        problems += [
            f"{flag(name)}: missing; it is needed together with {flag(counter[0])}"
            for name in ("counter_young", "counter_poisson")
            if name not in known
        ]
    for prefix in ("", "counter_"):
        height, bottom = flag(f"{prefix}layer_height"), flag(f"{prefix}bottom")
        if f"{prefix}bottom" in known and f"{prefix}layer_height" not in known:
            problems.append(f"{bottom}: needs {height}, a half-space has no far face")
        if values.get("friction") and values.get(f"{prefix}bottom") == "frictionless":
            problems.append(f"--friction: not accepted with {bottom} frictionless, which bears no shear")
        if values.get("boundary") == "free" and f"{prefix}layer_height" in known:
            problems.append(f"--boundary free: accepted for half-spaces only, not with {height}")
    for name, needs in _NEEDS.items():
        if name in known and needs not in known:
            problems.append(f"{flag(name)}: needs {flag(needs)}")
    if "cylinder_axis" in known and values.get("form") != "cylinder":
        problems.append("--cylinder-axis: needs --form cylinder")
    if "counter_map" in values and not is_file(values["counter_map"]):
        problems.append(f"--counter-map {values['counter_map']}: no such file")
    if options.out is None:
        problems.append("--out: missing; the name of a folder is needed")
    elif problem := folder_problem(options.out):
        problems.append(f"--out {options.out}: {problem}")
    return problems


def _bodies(values: Mapping[str, Any]) -> tuple[Any, Any]:
    """The body and the counter body, None if that is rigid."""
    return _body(values, ""), _body(values, "counter_") if "counter_young" in values else None


def _body(values: Mapping[str, Any], prefix: str) -> Any:
    """The body whose settings have names with this prefix."""
    from asperity.engineering import Body

    return Body(
        to_si(values[f"{prefix}young"], "pressure"),
        values[f"{prefix}poisson"],
        _si(values.get(f"{prefix}yield"), "pressure"),
        _si(values.get(f"{prefix}layer_height"), "length"),
        values.get(f"{prefix}bottom", "bonded"),
    )


def _counter_map(values: Mapping[str, Any]) -> Any:
    from asperity.engineering import CounterMap

    if "counter_map" not in values:
        return None
    shift = values.get("counter_shift", ("0 m", "0 m"))
    return CounterMap(
        values["counter_map"],
        turned_about=values.get("counter_turned_about", "y"),
        shift=(to_si(shift[0], "length"), to_si(shift[1], "length")),
    )


def _load(values: Mapping[str, Any]) -> dict[str, float]:
    """The imposed quantity as an argument of `asperity.engineering.run`."""
    name = next(name for name in _LOADS if name in values)
    argument, dimension = _LOADS[name]
    return {argument: values[name] if dimension is None else to_si(values[name], dimension)}


def _map_settings(values: Mapping[str, Any]) -> Any:
    from asperity.engineering.indenter import MapSettings

    size = values.get("physical_size")
    chosen = {name: values[name] for name in _MAP_NAMES if name in values}
    return MapSettings(
        physical_size=None if size is None else (to_si(size[0], "length"), to_si(size[1], "length")),
        wavelength_short=_si(values.get("wavelength_short"), "length"),
        radius=_si(values.get("radius"), "length"),
        option=flag,
        **chosen,
    )


def _si(value: str | None, dimension: str) -> float | None:
    return None if value is None else to_si(value, dimension)
