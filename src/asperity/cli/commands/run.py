"""``asperity run``: from a measured map, two materials and a load to an answer."""

import argparse
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from asperity.cli.parser import COMMANDS, arguments, converted, flag, with_flags
from asperity.core.errors import ConfigError, InputError, did_you_mean, fail, one_line, shown
from asperity.core.packages import require
from asperity.study.config.check import needed_instead
from asperity.study.config.reader import CASE_SUFFIXES, CHECKSUMS, PATHS, load, names_of_maps, pool_of
from asperity.study.config.schema import accepted, setting

WRONG_USAGE = 2
"""Exit status for refused arguments, the same as argparse's."""

OPTIONS = {
    entry["setting"].rpartition(".")[2]: entry["setting"]
    for group in COMMANDS["run"]["groups"]
    for entry in arguments(group).values()
    if "setting" in entry
}
"""Name of a setting that is an option → its dotted key."""

POOLING = ("pooled", "resume", "only")
"""Options of pooled maps."""


class Job(NamedTuple):
    """A case read from options and files.

    Case, rough face, output folder, problems, maps that are read, and area of a prediction.
    """

    case: Any
    rough: Any
    out: Path
    problems: list[str]
    read: list[str]
    area: str | None


def run(options: argparse.Namespace) -> None:
    """Compute the answers, print them, and write results, pictures and reports; compare or pool several."""
    require(("SurfaceTopography", "matplotlib"))  # before the computation, not after it
    from asperity.engineering.folder import COMPARISON, SAMPLE, locked

    pool = pool_of(options.map)
    maps, options.pooled = pool.get("map", options.map), options.pooled or pool.get("pooled", False)
    counters = getattr(options, OPTIONS["counter_map"]) or [None]
    files = {"--out": options.out, "--save": options.save, "--config": options.config}
    empty = [name for name, path in files.items() if path == ""] + ["MAP"] * ("" in options.map)
    empty += ["--counter-map"] * ("" in counters)
    if empty:
        sys.exit(fail(f"{empty[0]} = '': a name is needed", WRONG_USAGE))
    if len(counters) > 1 and not (options.pooled and len(counters) == len(maps)):
        words = f"one for each MAP is needed, with --pooled: {len(maps)}"
        sys.exit(fail(f"--counter-map: {len(counters)} files are given; one, or {words}", WRONG_USAGE))
    folder = None
    if len(maps) > 1 or options.pooled:
        folder = Path(options.out or pool.get("out") or ("pooled" if options.pooled else "comparison"))
    names, jobs = names_of_maps(maps), {}
    for number, name in enumerate(names):
        if not options.only or options.only == name:
            one = argparse.Namespace(**vars(options))
            setattr(one, OPTIONS["counter_map"], counters[number % len(counters)])
            path = options.map[0] if pool else maps[number]
            jobs[name] = _job(one, path, None if folder is None else folder / name, number)
    problems = [problem for job in jobs.values() for problem in job.problems]
    if options.only and options.only not in names:
        problems.append(f"--only {options.only}: one of {', '.join(names)} is needed")
    elif folder is not None and not options.only:
        problems += _problems_of(folder, {}, SAMPLE if options.pooled else COMPARISON)
        if len(set(names)) < len(names):
            problems.append("MAP: files of different names, or in folders of different names, are needed")
        if options.pooled and not problems:
            problems += _problems_of_pool(jobs)
    if options.save:
        problems += _problems_of_save(options, [*jobs.values()])
    if problems:
        sys.exit(max(fail(problem, WRONG_USAGE) for problem in dict.fromkeys(problems)))
    if options.check:
        return
    with ExitStack() as stack:
        of_all = [folder] if folder and not options.only else []
        for path in dict.fromkeys([*of_all, *(job.out for job in jobs.values())]):
            stack.enter_context(locked(path))
        if options.pooled and folder is not None:
            _pool_answers(options, folder, jobs)
            return
        answers = {job.out.name: _answered(job, options.save) for job in jobs.values()}
        if folder is not None:
            from asperity.engineering.several_answers import write_comparison

            print(write_comparison(answers, folder))


def _pool_answers(options: argparse.Namespace, folder: Path, jobs: Mapping[str, Job]) -> None:
    """Compute the answers of pooled maps, except for kept ones, and their means unless one map is asked for.

    The means are made from the tables in the folders: they do not depend on the process that wrote these.
    """
    from asperity.engineering.output import holds_answer
    from asperity.engineering.several_answers import read_sample, write_sample

    for job in jobs.values():
        if options.resume and holds_answer(job.out, job.case, job.rough.files):
            print(f"{one_line(str(job.out))}: kept")
        else:
            _answered(job, None)
    if not options.only:
        first, *_ = jobs.values()
        sample = read_sample(folder, list(jobs), first.case)
        cases = [(job.case, job.rough.files) for job in jobs.values()]
        print(write_sample(sample, folder, cases, first.area))


def _problems_of_pool(jobs: Mapping[str, Job]) -> Iterator[str]:
    """Reasons why maps cannot be pooled."""
    from asperity.core.units import to_si
    from asperity.engineering.sample import check_alike
    from asperity.stress.statistics.largest import check_area

    faces = {name: job.rough.face for name, job in jobs.items()}
    areas = {job.area for job in jobs.values() if job.area}
    try:
        check_alike(faces)
        for area in areas:
            check_area(to_si(area, "area"), sum(face.map_area for face in faces.values()))
    except ValueError as error:
        yield with_flags(str(error), "run")


def _answered(job: Job, save: str | None) -> Any:
    """The answer of a case, printed and written."""
    from asperity.engineering import answer_of, save_case, write_answer
    from asperity.study.progress_and_log import ProgressBar

    if save and not _is_written(save, job.out):
        save_case(job.case, Path(save), job.out, job.rough.files)
    with ProgressBar(one_line(f"run {job.case.source}")) as progress:
        answer = answer_of(job.case, job.rough, progress)
    print(answer.text(), end="\n\n", flush=True)
    files = write_answer(answer, job.out)
    kinds = {"pictures": [".png"], "results": [".nc", ".csv", ".yaml"], "report": [".html"]}
    for kind, suffixes in kinds.items():
        names = " ".join(str(path) for path in files if path.suffix in suffixes)
        print(f"{kind:<10}{one_line(names)}")
    return answer


def _is_written(save: str, out: Path) -> bool:
    """True if `save` is the case file that is written into the folder of the answer anyway."""
    from asperity.engineering.folder import CASE_FILE

    return Path(save).resolve() == (out / CASE_FILE).resolve()


def _problems_of_save(options: argparse.Namespace, jobs: Sequence[Job]) -> Iterator[str]:
    """Reasons why a case cannot be saved."""
    from asperity.results.atomic import write_problem

    save = Path(options.save)
    if len(jobs) > 1:
        yield "--save: one MAP is needed, several are given"
    elif _is_written(options.save, jobs[0].out):
        return
    elif problem := write_problem(save):
        yield f"--save {save}: {problem}"
    elif save.suffix not in CASE_SUFFIXES:
        yield f"--save {save}: a name that ends in {' or '.join(CASE_SUFFIXES)} is needed"
    elif save.exists():
        read = [options.map[0], options.config, *jobs[0].read]
        values: dict[str, Any] = {}
        refused: dict[str, str] = {}
        try:
            _add_file(save, "", values, refused)
        except ConfigError as error:
            refused[""] = str(error)
        if any(save.samefile(path) for path in read if path and Path(path).exists()):
            yield f"--save {save}: is read too, another name is needed"
        elif refused or "map" not in values:
            yield f"--save {save}: is not a case file, another name is needed"


def _job(options: argparse.Namespace, path: str, folder: Path | None, number: int = 0) -> Job:
    """The case of one map; `number` selects the map in a case file of several.

    The answer goes into `folder`. A refused option is not also reported as missing.
    """
    values, refused = _values(options, path, number)
    out = folder or Path(values.get("out") or f"{Path(values.get('map', path)).stem}_run")
    values.pop("out", None)
    checksums = {name: values.pop(name) for name in CHECKSUMS if name in values}
    read = [values[name] for name in PATHS[:2] if name in values]
    known = {**values, **refused, **{name: True for name in POOLING if getattr(options, name)}}
    problems = [*refused.values(), *_contradictions(options, values, known)]
    missing = [
        f"{flag(name) if name != 'map' else ''} {values[name]}: no such file".strip()
        for name in PATHS[:2]
        if name in values and not os.path.exists(values[name])
    ]
    if missing:  # reported without the packages that the calculation needs
        return Job(None, None, out, [*problems, *_problems_of(out, values), *missing], read, None)
    from asperity.engineering.case import Case
    from asperity.engineering.face import counter_map_of, options_of, read_face
    from asperity.engineering.folder import names_of
    from asperity.engineering.run import check_cell
    from asperity.surface.reading.height_map import MapError

    case, rough = None, None
    if not problems:
        try:
            case = Case.of(values)
        except ValueError as error:
            problems.append(with_flags(str(error), "run"))
    problems += _problems_of(out, values, None if case is None else names_of(case))
    if "map" in values:
        try:
            several = folder is not None
            rough = read_face(values["map"], options_of(values), counter_map_of(values), shared=several)
            case = case and replace(case, options=rough.options or case.options)
            if case:
                check_cell(case, rough)
        except InputError as error:
            texts = [text for text in error.problems if not text.startswith(tuple(refused))]
            problems += MapError(error.source, texts).renamed(flag).lines
        except ValueError as error:
            problems.append(with_flags(str(error), "run"))
    found = dict(zip(read, rough.files if rough else (), strict=False))
    for key, checksum in checksums.items():
        file = values[CHECKSUMS[key]]
        if file in found and found[file].sha256 != checksum:
            problems.append(
                f"{path}: {key}: {one_line(file)} has changed since; delete the key to run it as it is now"
            )
    return Job(case, rough, out, problems, read, values.get("area"))


def _values(
    options: argparse.Namespace, given_map: str, number: int = 0
) -> tuple[dict[str, Any], dict[str, str]]:
    """Accepted values of all settings by name, and messages on refused ones.

    Options override the file of ``--config``, which overrides a case file given in place of a map.
    """
    values: dict[str, Any] = {}
    refused: dict[str, str] = {}
    is_case = Path(given_map).suffix in CASE_SUFFIXES
    for path, name in ((given_map if is_case else None, ""), (options.config, "--config ")):
        if path:
            _add_file(Path(path), name, values, refused, number)
    values |= {} if is_case else {"map": given_map}
    values |= {} if options.out is None else {"out": options.out}
    if is_case and "map" not in values:
        refused["map"] = f"{given_map}: map: missing; the name of a height map is needed"
    for name, key in OPTIONS.items():
        given, entry = getattr(options, key), setting(key)
        if given is None:
            continue
        values.pop(name, None)
        values.pop(f"{name}_sha256", None)
        try:
            values[name] = converted(entry, given)
        except argparse.ArgumentTypeError as error:
            refused[name] = f"{flag(name)} {error}"
    return values, refused


def _add_file(
    path: Path, option: str, values: dict[str, Any], refused: dict[str, str], number: int = 0
) -> None:
    """Add settings of a case file or of section ``engineering`` of a configuration, for one of its maps."""
    try:
        content = load(path)
    except ConfigError as error:
        raise ConfigError(f"{option}{error}") from error
    section = content.get("engineering", content)
    if not isinstance(section, Mapping):
        raise ConfigError(f"{option}{path}: engineering = {shown(section)}: a group of keys is needed")
    for name in section.keys() & set(CHECKSUMS.values()):
        values.pop(f"{name}_sha256", None)
    for name, given in section.items():
        value = given[number] if isinstance(given, list) and name in (*PATHS, *CHECKSUMS) else given
        key, text = f"{option}{path}: {name}", {"type": "string", "minLength": 1, "accepts": "a file name"}
        if name == "pooled":
            continue
        if name in CHECKSUMS:
            values[name] = value
        elif name not in (*OPTIONS, *PATHS):
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
    """Settings that are missing or exclude each other; `known` holds all given ones, also refused ones."""
    for name in ("young", "poisson"):
        if name not in known:
            yield f"{flag(name)}: missing; {accepted(setting(f'engineering.{name}'))} is needed"
    quantities = COMMANDS["run"]["loads"]
    loads = [flag(name) for name in quantities if name in known]
    if len(loads) != 1:
        given = " and ".join(loads) or "none"
        yield f"{', '.join(map(flag, quantities))}: exactly one of them is needed, {given} given"
    if options.rigid and "counter_young" in known:
        yield f"--rigid: not accepted together with {flag('counter_young')}"
    for name, needed in COMMANDS["run"]["needs"].items():
        if name in known and needed not in known:
            yield f"{flag(name)}: needs {flag(needed)}"
    if "cylinder_axis" in known and values.get("form") != "cylinder":
        yield "--cylinder-axis: needs --form cylinder"
    excluded = {f"{body}coating": [f"{body}layer_height", f"{body}bottom"] for body in ("", "counter_")}
    pairs = [(flag(name), others) for name, others in excluded.items() if name in known]
    if values.get("boundary") == "free":
        pairs.append(
            (
                "--boundary free",
                ["periodic", "layer_height", "counter_layer_height", "coating", "counter_coating"],
            )
        )
    for option, others in pairs:
        yield from (f"{option}: not accepted together with {flag(name)}" for name in others if name in known)


def _problems_of(out: Path, values: Mapping[str, Any], names: Sequence[str] | None = None) -> Iterator[str]:
    """Reasons why the answer, or files of some names, cannot be written into a folder."""
    from asperity.engineering.folder import folder_problem

    if problem := folder_problem(out, names):
        yield f"--out {out}: {problem}"
    elif out.resolve() in [Path(values[name]).resolve().parent for name in PATHS[:2] if name in values]:
        yield f"--out {out}: holds the map; another folder is needed"
