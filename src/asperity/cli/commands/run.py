"""``asperity run``: from a measured map, two materials and a load to an answer."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Set
from dataclasses import fields
from pathlib import Path
from typing import Any

from asperity.cli.parser import COMMANDS, arguments, converted, direction, flag
from asperity.core.errors import ConfigError, InputError, fail, one_line, shown
from asperity.core.packages import require
from asperity.core.units import shown_si, to_si
from asperity.study.config.check import needed_instead
from asperity.study.config.reader import load
from asperity.study.config.schema import setting

WRONG_USAGE = 2
"""Exit status for arguments that are not accepted, as argparse has it."""

KEYS: dict[str, str] = {
    entry["setting"].rpartition(".")[2]: entry["setting"]
    for group in COMMANDS["run"]["groups"]
    for entry in arguments(group).values()
    if "setting" in entry
}
"""Name of a setting that is an option → its dotted key."""

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
    values, refused = _values(options)
    problems = [*refused.values(), *_contradictions(options, values, {*values, *refused})]
    for problem in problems:  # at once: reading a map takes a second or more
        fail(problem)
    face, of_map = _face(options.map, values, refused.keys())
    for problem in of_map:
        fail(problem)
    if problems or of_map:
        sys.exit(WRONG_USAGE)

    from asperity.cli.notice import progress_bar
    from asperity.engineering import run as answer_of
    from asperity.engineering import write_answer

    lower, upper = _body(values, ""), None
    if "counter_young" in values:
        upper = _body(values, "counter_")
    load = next(name for name in _LOADS if name in values)
    argument, dimension = _LOADS[load]
    case: dict[str, Any] = {
        argument: values[load] if dimension is None else to_si(values[load], dimension),
        "friction": values.get("friction", 0.0),
    }
    with progress_bar(f"run {options.map}") as progress:
        answer = answer_of(
            face,
            lower,
            upper,
            sliding_direction=direction(values.get("sliding_direction", "x")),
            counter_map=_counter_map(values),
            map_options=_map_options(values),
            fields=values.get("fields", ("von_mises",)),
            progress=progress,
            **case,
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
        face = read_face(path, _map_options(values), _counter_map(values))
    except MapError as error:
        problems = [text for text in error.problems if not text.startswith(tuple(refused))]
        return None, list(MapError(error.source, problems).renamed(flag).lines)
    except (InputError, ValueError) as error:
        return None, [str(error)]
    if "approach" in values and "layer_height" not in values and face.boundary == "periodic":
        most = -float(face.height.min())
        if to_si(values["approach"], "length") >= most:
            return None, [
                f"--approach = {values['approach']}: less than {shown_si(most, 'm')} is needed, the height "
                "of the mean plane above the point that touches first; there a periodic half-space is in "
                "full contact"
            ]
    return face, []


def _values(options: argparse.Namespace) -> tuple[dict[str, Any], dict[str, str]]:
    """Accepted values of all settings by name, and messages on refused ones; an option overrides the file."""
    values, refused = _configured(options.config)
    for name, key in KEYS.items():
        if (given := getattr(options, key)) is not None:
            values.pop(name, None)
            try:
                values[name] = _converted(key, given)
            except argparse.ArgumentTypeError as error:
                refused[name] = f"{flag(name)} {error}"
    return values, refused


def _converted(key: str, given: str | list[str]) -> Any:
    entry = setting(key)
    if not isinstance(given, list):
        return converted(entry, given)
    values = [converted(entry["items"], text) for text in given]
    if needed := needed_instead(values, entry):
        raise argparse.ArgumentTypeError(f"{' '.join(given)}: {needed} is needed")
    return values


def _configured(path: str | None) -> tuple[dict[str, Any], dict[str, str]]:
    """Accepted values of section ``engineering`` of a configuration, and messages on what is wrong."""
    if path is None:
        return {}, {}
    try:
        section = load(path).get("engineering", {})
    except ConfigError as error:
        return {}, {"--config": f"--config {error}"}
    known = setting("engineering")["properties"]
    if not isinstance(section, Mapping):
        return {}, {"--config": f"--config {path}: engineering = {shown(section)}: a group of keys is needed"}
    values, problems = {}, {}
    for name, value in section.items():
        key = f"--config {path}: engineering.{name}"
        if name not in known:
            problems[key] = f"{key}: unknown key; known here are {', '.join(known)}"
        elif needed := needed_instead(value, known[name]):
            problems[key] = f"{key} = {shown(value)}: {needed} is needed"
        else:
            values[name] = value
    return values, problems


def _contradictions(options: argparse.Namespace, values: Mapping[str, Any], known: Set[str]) -> list[str]:
    """What is missing, or does not go together; `known` are all settings given, also refused ones."""
    from asperity.engineering.output import folder_problem

    loads = [flag(name) for name in _LOADS if name in known]
    counter = [name for name in _COUNTER_NAMES if name in known]
    free, sliding = values.get("boundary") == "free", bool(values.get("friction"))
    folder = ""
    if options.out is not None:
        folder = folder_problem(options.out)
        maps = [Path(path).resolve() for path in (options.map, values.get("counter_map")) if path]
        if any(path.parent == Path(options.out).resolve() for path in maps):
            folder = "holds the map; another folder is needed"
    young = setting("engineering.young")["accepts"]
    checks: list[tuple[object, str]] = [
        ("young" not in known, f"--young: missing; {young} is needed"),
        ("poisson" not in known, "--poisson: missing; a number > -1 and ≤ 0.5 is needed"),
        (
            len(loads) != 1,
            f"{', '.join(map(flag, _LOADS))}: exactly one of them is needed, "
            f"{' and '.join(loads) if loads else 'none'} given",
        ),
        (
            options.rigid and counter,
            f"--rigid: not accepted together with {', '.join(map(flag, counter))}",
        ),
    ]
    for name in ("counter_young", "counter_poisson"):
        missing = counter and not options.rigid and name not in known
        together = flag(counter[0]) if counter else ""
        checks.append((missing, f"{flag(name)}: missing; it is needed together with {together}"))
    for prefix in ("", "counter_"):
        height, bottom = flag(f"{prefix}layer_height"), flag(f"{prefix}bottom")
        layer = f"{prefix}layer_height" in known
        shearless = sliding and values.get(f"{prefix}bottom") == "frictionless"
        checks += [
            (
                f"{prefix}bottom" in known and not layer,
                f"{bottom}: needs {height}, a half-space has no far face",
            ),
            (shearless, f"--friction: not accepted with {bottom} frictionless, which bears no shear"),
            (free and layer, f"--boundary free: accepted for half-spaces only, not with {height}"),
        ]
    checks += [
        (name in known and needs not in known, f"{flag(name)}: needs {flag(needs)}")
        for name, needs in _NEEDS.items()
    ]
    checks += [
        (
            free and "periodic" in known,
            "--periodic: not accepted with a free boundary, which takes the map as it is",
        ),
        (
            "cylinder_axis" in known and values.get("form") != "cylinder",
            "--cylinder-axis: needs --form cylinder",
        ),
        (options.out is None, "--out: missing; the name of a folder is needed"),
        (folder, f"--out {options.out}: {folder}"),
    ]
    return [message for wrong, message in checks if wrong]


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
    shift = values.get("counter_shift", ("0 m", "0 m"))
    return CounterMap(
        values["counter_map"],
        turned_about=values.get("counter_turned_about", "y"),
        shift=(to_si(shift[0], "length"), to_si(shift[1], "length")),
    )


def _map_options(values: Mapping[str, Any]) -> Any:
    from asperity.surface.reading.height_map import MapOptions

    given = {field.name: values[field.name] for field in fields(MapOptions) if field.name in values}
    if values.get("boundary") == "free":
        given["periodic"] = "none"
    return MapOptions(**given)
