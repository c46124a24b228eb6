"""``asperity run``: from a measured map, two materials and a load to an answer."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from asperity.cli.parser import COMMANDS, arguments, converted, flag
from asperity.core.errors import ConfigError, InputError, did_you_mean, fail, one_line, shown
from asperity.core.packages import require
from asperity.study.config.check import needed_instead
from asperity.study.config.reader import load
from asperity.study.config.schema import accepted, setting

WRONG_USAGE = 2
"""Exit status for arguments that are not accepted, as argparse has it."""

OPTIONS = {
    entry["setting"].rpartition(".")[2]: entry["setting"]
    for group in COMMANDS["run"]["groups"]
    for entry in arguments(group).values()
    if "setting" in entry
}
"""Name of a setting that is an option → its dotted key."""

PATHS = ("map", "counter_map", "out")
"""Settings that are names of files, relative to the folder of the case file that gives them."""


class Job(NamedTuple):
    """A case as options and files describe it: case, face that is pressed, folder, and what is wrong."""

    case: Any
    rough: Any
    out: Path
    problems: list[str]


def run(options: argparse.Namespace) -> None:
    """Compute the answers, print them, and write results, pictures and reports; compare several."""
    require(("SurfaceTopography", "matplotlib"))  # before the computation, not after it
    from asperity.engineering.folder import COMPARISON

    folder = Path(options.out or "comparison") if len(options.map) > 1 else None
    jobs = [_job(options, path, folder) for path in options.map]
    problems = [problem for job in jobs for problem in job.problems]
    if folder is not None:
        problems += _problems_of(folder, {}, COMPARISON)
        if len({job.out for job in jobs}) < len(jobs):
            problems.append("MAP: files of different names are needed")
        if options.save:
            problems.append("--save: one MAP is needed, several are given")
    if problems:
        sys.exit(max(fail(problem, WRONG_USAGE) for problem in dict.fromkeys(problems)))
    answers = {job.out.name: _answered(job, options.save) for job in jobs}
    if folder is not None:
        from asperity.engineering.comparison import write_comparison

        print(write_comparison(answers, folder))


def _answered(job: Job, save: str | None) -> Any:
    """The answer of a case, printed and written."""
    from asperity.engineering import answer_of, save_case, write_answer
    from asperity.study.job import ProgressBar

    if save:
        save_case(job.case, Path(save), job.out)
    with ProgressBar(one_line(f"run {job.case.source}")) as progress:
        answer = answer_of(job.case, job.rough, progress)
    print(answer.text(), end="\n\n", flush=True)
    files = write_answer(answer, job.out)
    kinds = {"pictures": [".png"], "results": [".nc", ".csv", ".yaml"], "report": [".html"]}
    for kind, suffixes in kinds.items():
        names = " ".join(str(path) for path in files if path.suffix in suffixes)
        print(f"{kind:<10}{one_line(names)}")
    return answer


def _job(options: argparse.Namespace, path: str, folder: Path | None) -> Job:
    """The case of one map or case file; its answer goes below `folder`, if that is given.

    A map that needs an option whose value is refused already is not blamed for it again.
    """
    from asperity.engineering.case import Case
    from asperity.engineering.face import counter_map_of, options_of, read_face
    from asperity.surface.reading.height_map import MapError

    values, refused = _values(options, path)
    stem = Path(values.get("map", path)).stem
    out = Path(values.pop("out", None) or f"{stem}_run") if folder is None else folder / stem
    known = {**values, **refused}
    problems = [*refused.values(), *_contradictions(options, values, known)]
    case, rough = None, None
    if not problems:
        try:
            case = Case.of(values)
        except ValueError as error:
            option = re.compile(rf"^({'|'.join(OPTIONS)})\b")
            problems.append(option.sub(lambda found: flag(found[0]), str(error)))
    problems += _problems_of(out, values)
    if "map" in values:
        try:
            several = folder is not None
            rough = read_face(values["map"], options_of(values), counter_map_of(values), shared=several)
            case = case and replace(case, options=rough.options or case.options)
        except InputError as error:
            texts = [text for text in error.problems if not text.startswith(tuple(refused))]
            problems += MapError(error.source, texts).renamed(flag).lines
        except ValueError as error:
            problems.append(str(error))
    return Job(case, rough, out, problems)


def _values(options: argparse.Namespace, given_map: str) -> tuple[dict[str, Any], dict[str, str]]:
    """Accepted values of all settings by name, and messages on refused ones.

    An option overrides the file of ``--config``, and that the case file in place of a map.
    """
    values: dict[str, Any] = {}
    refused: dict[str, str] = {}
    is_case = Path(given_map).suffix in (".yaml", ".yml")
    for path, name in ((given_map if is_case else None, ""), (options.config, "--config ")):
        if path:
            _add_file(Path(path), name, values, refused)
    values |= {} if is_case else {"map": given_map}
    values |= {} if options.out is None else {"out": options.out}
    if is_case and "map" not in values:
        refused["map"] = f"{given_map}: map: missing; the name of a height map is needed"
    for name, key in OPTIONS.items():
        given, entry = getattr(options, key), setting(key)
        if given is None:
            continue
        values.pop(name, None)
        try:
            values[name] = converted(entry, given)
        except argparse.ArgumentTypeError as error:
            refused[name] = f"{flag(name)} {error}"
    return values, refused


def _add_file(path: Path, option: str, values: dict[str, Any], refused: dict[str, str]) -> None:
    """Add the settings of a case file, or of section ``engineering`` of a configuration."""
    try:
        content = load(path)
    except ConfigError as error:
        raise ConfigError(f"{option}{error}") from error
    section = content.get("engineering", content)
    if not isinstance(section, Mapping):
        raise ConfigError(f"{option}{path}: engineering = {shown(section)}: a group of keys is needed")
    for name, value in section.items():
        key, text = f"{option}{path}: {name}", {"type": "string", "minLength": 1, "accepts": "a file name"}
        if name not in (*OPTIONS, *PATHS):
            near = did_you_mean(str(name), (*OPTIONS, *PATHS))
            refused[key] = (
                f"{key}: unknown key{near or '; those of a case file are the options of asperity run'}"
            )
        elif needed := needed_instead(value, text if name in PATHS else setting(OPTIONS[name])):
            refused[name] = f"{key} = {shown(value)}: {needed} is needed"
        else:
            values[name] = str(path.parent / value) if name in PATHS else value


def _contradictions(
    options: argparse.Namespace, values: Mapping[str, Any], known: Mapping[str, Any]
) -> Iterator[str]:
    """What is missing, or does not go together; `known` are all settings given, also refused ones."""
    from asperity.engineering.case import LOAD_QUANTITIES

    for name in ("young", "poisson"):
        if name not in known:
            yield f"{flag(name)}: missing; {accepted(setting(f'engineering.{name}'))} is needed"
    loads = [flag(name) for name in LOAD_QUANTITIES if name in known]
    if len(loads) != 1:
        given = " and ".join(loads) or "none"
        yield f"{', '.join(map(flag, LOAD_QUANTITIES))}: exactly one of them is needed, {given} given"
    if options.rigid and "counter_young" in known:
        yield f"--rigid: not accepted together with {flag('counter_young')}"
    for name, needed in COMMANDS["run"]["needs"].items():
        if name in known and needed not in known:
            yield f"{flag(name)}: needs {flag(needed)}"
    if "cylinder_axis" in known and values.get("form") != "cylinder":
        yield "--cylinder-axis: needs --form cylinder"
    if values.get("boundary") == "free":
        excluded = [name for name in ("periodic", "layer_height", "counter_layer_height") if name in known]
        yield from (f"--boundary free: not accepted together with {flag(name)}" for name in excluded)


def _problems_of(out: Path, values: Mapping[str, Any], names: Sequence[str] = ()) -> Iterator[str]:
    """Why the answer, or files of some names, cannot be written into a folder."""
    from asperity.engineering.folder import ALWAYS_WRITTEN, folder_problem

    if problem := folder_problem(out, names or ALWAYS_WRITTEN):
        yield f"--out {out}: {problem}"
    elif out.resolve() in [Path(values[name]).resolve().parent for name in PATHS[:2] if name in values]:
        yield f"--out {out}: holds the map; another folder is needed"
