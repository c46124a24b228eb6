"""``asperity run``: from a measured map, two materials and a load to an answer."""

import argparse
import gc
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, NamedTuple

from asperity.cli.parser import COMMANDS, arguments
from asperity.core.errors import InputError, fail, one_line, shown
from asperity.core.packages import require
from asperity.settings.model import Problem, SettingsError, entry_of, item_of, scalar
from asperity.settings.reader import parse

WRONG_USAGE = 2
"""Exit status for refused arguments, the same as argparse's."""

FLAGS = {each["key"]: name for group in COMMANDS["run"]["groups"] for name, each in arguments(group).items()}
"""Dotted key of a setting of a case → its flag."""

GROUPS = {
    "body": "--material, or --young and --poisson",
    "load": "--mean-pressure, --hertz-pressure, --force, --approach or --area-fraction",
}
"""Group that every case has → flags that give it."""


class Job(NamedTuple):
    """A case read from options and files.

    Case, rough face, folder of the answer, problems, and maps that are read.
    """

    case: Any
    rough: Any
    out: Path
    problems: list[str]
    read: list[str]


def run(options: argparse.Namespace) -> None:
    """Compute the answers, print them, and write results, pictures and reports; compare or pool several."""
    _check_names(options)
    if len(options.map) == 2 and all(os.path.isdir(path) for path in options.map):
        from asperity.engineering.several_answers import compare_samples

        print(compare_samples([Path(path) for path in options.map]))
        return
    require(("SurfaceTopography", "matplotlib"))  # before the computation, not after it
    from asperity.engineering.case_file import MAP_FILES, SUFFIXES, at, load_case, names_of_maps

    contents = [load_case(path) if Path(path).suffix in SUFFIXES else None for path in options.map]
    pool = contents[0] if len(contents) == 1 else None
    listed = at(pool, MAP_FILES[0]) if pool else None
    maps = listed if isinstance(listed, list) else options.map
    options.pooled = options.pooled or bool(pool and "sample" in pool)
    counters = options.counter_map or [None]
    if len(counters) > 1 and not (options.pooled and len(counters) == len(maps)):
        words = f"one for each MAP is needed, with --pooled: {len(maps)}"
        sys.exit(fail(f"--counter-map: {len(counters)} files are given; one, or {words}", WRONG_USAGE))
    folder = None
    if len(maps) > 1 or options.pooled:
        given = options.out or (pool or {}).get("out")
        folder = Path(given or ("pooled" if options.pooled else "comparison"))
    names, jobs = names_of_maps(maps), {}
    for number, name in enumerate(names):
        if not options.only or options.only == name:
            path = options.map[0] if listed else options.map[number]
            counter = counters[number % len(counters)]
            jobs[name] = _job(options, path, counter, None if folder is None else folder / name, number)
    if options.pooled and jobs and all(job.case is not None for job in jobs.values()):
        first, *_ = jobs.values()  # all slide along the lay of the first map
        sliding = first.case.sliding
        jobs = {name: job._replace(case=job.case.replaced(sliding=sliding)) for name, job in jobs.items()}
    problems = [problem for job in jobs.values() for problem in job.problems]
    problems += _problems_of_several(options, folder, names, jobs)
    if options.save:
        problems += _problems_of_save(options, [*jobs.values()])
    if problems:
        sys.exit(max(fail(problem, WRONG_USAGE) for problem in dict.fromkeys(problems)))
    if options.check:
        print(_cost_in_words([*jobs.values()]))
        return
    _compute(options, folder, jobs)


def _check_names(options: argparse.Namespace) -> None:
    """End with a line for a name that is empty, and for options that need another one."""
    files = {"--out": options.out, "--save": options.save, "--case": options.case}
    empty = [name for name, path in files.items() if path == ""] + ["MAP"] * ("" in options.map)
    empty += ["--counter-map"] * ("" in (options.counter_map or []))
    if empty:
        sys.exit(fail(f"{empty[0]} = '': a name is needed", WRONG_USAGE))


def _compute(options: argparse.Namespace, folder: Path | None, jobs: Mapping[str, Job]) -> None:
    """Compute and write the answers of all jobs, and the comparison or the means of several."""
    from asperity.engineering.folder import locked

    with ExitStack() as stack:
        of_all = [folder] if folder and not options.only else []
        for path in dict.fromkeys([*of_all, *(job.out for job in jobs.values())]):
            stack.enter_context(locked(path))
        if options.pooled and folder is not None:
            _pool_answers(options, folder, jobs)
            return
        answers = {}
        for number, job in enumerate(jobs.values(), 1):
            place = f"{number} of {len(jobs)} " if len(jobs) > 1 else ""
            answers[job.out.name] = _answered(job, options.save, place)
        if folder is not None:
            from asperity.engineering.several_answers import write_comparison

            print(write_comparison(answers, folder))


def _pool_answers(options: argparse.Namespace, folder: Path, jobs: Mapping[str, Job]) -> None:
    """Compute the answers of pooled maps, except for kept ones, and their means unless one map is asked for.

    The means are made from the tables in the folders: they do not depend on the process that wrote these.
    """
    from asperity.engineering.case_file import holds_answer
    from asperity.engineering.several_answers import read_sample, write_sample

    for number, job in enumerate(jobs.values(), 1):
        if options.resume and holds_answer(job.out, job.case, job.rough.files):
            print(f"{one_line(str(job.out))}: kept")
        else:
            _answered(job, None, f"{number} of {len(jobs)} ")
    if not options.only:
        first, *_ = jobs.values()
        sample = read_sample(folder, list(jobs), first.case)
        cases = [(job.case, job.rough.files) for job in jobs.values()]
        print(write_sample(sample, folder, cases))


def _answered(job: Job, save: str | None, place: str) -> Any:
    """The answer of a case, printed and written; `place` is its number among several answers."""
    from asperity.engineering.case_file import save_case
    from asperity.engineering.output import write_answer
    from asperity.engineering.run import answer_of
    from asperity.study.progress_and_log import ProgressBar

    if place:
        gc.collect()  # pictures of the map before, whose objects refer to each other
    if save and not _is_written(save, job.out):
        save_case(job.case, Path(save), job.out, job.rough.files)
    with ProgressBar(one_line(f"run {place}{job.case.map.file}")) as progress:
        answer = answer_of(job.case, job.rough, progress)
    print(answer.text(), end="\n\n", flush=True)
    files = write_answer(answer, job.out)
    kinds = {"pictures": [".png"], "results": [".nc", ".csv", ".yaml"], "report": [".html"]}
    for kind, suffixes in kinds.items():
        names = " ".join(str(path) for path in files if path.suffix in suffixes)
        print(f"{kind:<10}{one_line(names)}")
    return answer


def _cost_in_words(jobs: Sequence[Job]) -> str:
    """Nodes, time and memory of some cases, as far as they are known before."""
    from asperity.engineering.run import work_of
    from asperity.study.cost.model import answer_cost, minutes, time_factor

    costs = []
    for job in jobs:
        face = job.rough.face
        work = sum(work_of(job.case, face.grid.mirrored).values())
        costs.append(answer_cost(work, face.height.size, face.boundary))
    ny, nx = max((job.rough.face.grid.shape for job in jobs), key=lambda shape: shape[0] * shape[1])
    seconds = sum(cost.fixed_seconds + time_factor() * cost.calculation_seconds for cost in costs)
    maps = "1 map" if len(jobs) == 1 else f"{len(jobs)} maps"
    return (
        f"nothing wrong was found; {maps}, {ny} × {nx} nodes, about "
        f"{minutes(seconds)} of one processor and {max(cost.memory for cost in costs) / 1e9:.1f} GB"
    )


def _is_written(save: str, out: Path) -> bool:
    """True if `save` is the case file that is written into the folder of the answer anyway."""
    from asperity.engineering.folder import CASE_FILE

    return Path(save).resolve() == (out / CASE_FILE).resolve()


def _problems_of_several(
    options: argparse.Namespace, folder: Path | None, names: Sequence[str], jobs: Mapping[str, Job]
) -> Iterator[str]:
    """Reasons why the answers of several maps cannot be written, or maps cannot be pooled."""
    from asperity.engineering.folder import COMPARISON, SAMPLE
    from asperity.engineering.sample import check_alike
    from asperity.stress.statistics.largest import check_area

    if not options.pooled:
        names_given = (name for name in ("--resume", "--only") if getattr(options, name[2:]))
        yield from (f"{name}: needs --pooled" for name in names_given)
        if any(job.case is not None and job.case.sample is not None for job in jobs.values()):
            yield "sample: needs --pooled"
    if options.only and options.only not in names:
        yield f"--only {options.only}: one of {', '.join(names)} is needed"
    if folder is None or options.only:
        return
    yield from _problems_of(folder, [], SAMPLE if options.pooled else COMPARISON)
    if len(set(names)) < len(names):
        yield "MAP: files of different names, or in folders of different names, are needed"
    for name in names:
        if name.startswith(".") or name in (*SAMPLE, *COMPARISON):
            yield f"MAP: {shown(name)} cannot be the name of the folder of its answer; rename the map"
    if options.pooled and not any(job.problems for job in jobs.values()):
        of_checksum: dict[str, str] = {}
        for name, job in jobs.items():
            other = of_checksum.setdefault(job.rough.files[0].sha256, name)
            if other != name:
                yield f"--pooled: {name} and {other} are the same map; each place is needed once"
        faces = {name: job.rough.face for name, job in jobs.items()}
        try:
            check_alike(faces)
            for job in jobs.values():
                if job.case.sample is not None and job.case.sample.area is not None:
                    check_area(job.case.sample.area, sum(face.grid.area for face in faces.values()))
        except ValueError as error:
            yield str(error)


def _problems_of_save(options: argparse.Namespace, jobs: Sequence[Job]) -> Iterator[str]:
    """Reasons why a case cannot be saved."""
    from asperity.engineering.case_file import CHECKSUMS, SUFFIXES, load_case
    from asperity.engineering.folder import names_in
    from asperity.results.atomic import write_problem

    save = Path(options.save)
    if len(jobs) > 1:
        yield "--save: one MAP is needed, several are given"
    elif _is_written(options.save, jobs[0].out):
        return
    elif problem := write_problem(save):
        yield f"--save {save}: {problem}"
    elif save.suffix not in SUFFIXES:
        yield f"--save {save}: a name that ends in {' or '.join(SUFFIXES)} is needed"
    elif save.exists():
        read = [options.map[0], options.case, *jobs[0].read]
        try:
            own = CHECKSUMS in load_case(save)  # as `--save` writes it
        except InputError:
            own = False
        if any(save.samefile(path) for path in read if path and Path(path).exists()):
            yield f"--save {save}: is read too, another name is needed"
        elif save.name in names_in(save.parent):
            yield f"--save {save}: belongs to the answer in its folder, another name is needed"
        elif not own:
            yield f"--save {save}: asperity has not written this file, another name is needed"


def _job(
    options: argparse.Namespace, path: str, counter: str | None, folder: Path | None, number: int = 0
) -> Job:
    """The case of one map, whose answer goes into `folder`; `number` selects it in a case file of several."""
    from asperity.engineering import case_file
    from asperity.engineering.case import Case
    from asperity.engineering.case_file import CHECKSUMS, MAP_FILES, OUT, at, put
    from asperity.engineering.face import read_face
    from asperity.engineering.folder import names_of
    from asperity.engineering.run import problems_on_map
    from asperity.settings.map import Map

    is_case = Path(path).suffix in case_file.SUFFIXES
    file = path if is_case else options.case
    content = case_file.case_of_map(case_file.load_case(file), number) if file else {}
    if not is_case:
        put(content, MAP_FILES[0], path)
    problems: list[str] = []
    given: dict[str, Any] = {}
    for key, text in _given(options, counter, problems):
        if key in map(".".join, MAP_FILES):
            content.get(CHECKSUMS, {}).pop("map" if key == "map.file" else "counter_map", None)
        put(content, key.split("."), text)
        given[key] = text
    named_by_map = f"{Path(at(content, MAP_FILES[0]) or path).stem}_run"
    out = folder or Path(options.out or content.get(OUT) or named_by_map)
    content.pop(OUT, None)
    checksums = content.pop(CHECKSUMS, {})
    if options.pooled:
        content.setdefault("sample", {})
    read = [each for keys in MAP_FILES if isinstance(each := at(content, keys), str)]
    missing = [f"{each}: no such file" for each in read if not os.path.exists(each)]

    def name_of(key: str) -> str:
        """A key as the user gave it: a flag, or a key of the file."""
        in_file = file and at(content, key.split(".")) is not None and key not in given
        if key in FLAGS and not in_file:
            return FLAGS[key]
        return f"{file}: {key}" if in_file or (file and key not in given) else key

    def named(problem: Problem) -> str:
        if problem.key in GROUPS and not file and ": missing" in problem.text:
            return f"{GROUPS[problem.key]}: missing"
        return f"{name_of(problem.key)}{problem.text}"

    case, rough = None, None
    try:
        case = Case.read(content)
    except SettingsError as error:
        problems += map(named, error.found)
    surface: Any = None if case is None else case.map
    if case is None:  # problems of map and case are reported together
        with suppress(SettingsError):
            surface = Map.read(content.get("map", {}))
    problems += _problems_of(out, read, None if case is None else names_of(case))
    if surface is not None and not missing:
        try:
            counter_map = None if case is None else case.counter_map
            rough = read_face(surface, counter_map, shared=folder is not None)
            if case is not None:
                case = case.on_face(rough)
                problems += map(named, problems_on_map(case, rough))
        except SettingsError as error:
            problems += map(named, error.found)
        except InputError as error:
            problems += error.renamed(lambda name: name_of(f"map.{name}")).lines  # type: ignore[attr-defined]
        except ValueError as error:
            problems.append(str(error))
    files = rough.files if rough else ()
    for name, path, each in zip(("map", "counter_map"), read, files, strict=False):
        if checksums.get(name, each.sha256) != each.sha256:
            changed = f"{file}: {CHECKSUMS}.{name}: {one_line(path)} has changed since"
            problems.append(f"{changed}; delete the key to run it as it is now")
    return Job(case, rough, out, [*problems, *missing], read)


def _given(
    options: argparse.Namespace, counter: str | None, problems: list[str]
) -> Iterator[tuple[str, Any]]:
    """Dotted key and value of each setting on the command line; problems are added to the list."""
    from asperity.engineering.case import Case

    for text in options.set or ():
        key, equals, value = text.partition("=")
        if not equals or not key:
            problems.append(f'--set {shown(text)}: KEY=VALUE is needed, such as body.hardness="7 GPa"')
            continue
        try:
            yield key.strip(), parse(f"value: {value.strip() or '{}'}", f"--set {key}")["value"]
        except InputError as error:
            problems += error.lines
    for key, name in FLAGS.items():
        given = counter if name == "--counter-map" else getattr(options, name[2:].replace("-", "_"))
        if given is not None:
            entry = entry_of(Case, key)
            is_list = isinstance(given, list)
            yield key, [scalar(each, item_of(entry)) for each in given] if is_list else scalar(given, entry)


def _problems_of(out: Path, read: Sequence[str], names: Sequence[str] | None = None) -> Iterator[str]:
    """Reasons why the answer, or files of some names, cannot be written into a folder."""
    from asperity.engineering.folder import folder_problem

    if problem := folder_problem(out, names):
        yield f"--out {out}: {problem}"
    elif out.resolve() in [Path(each).resolve().parent for each in read]:
        yield f"--out {out}: holds the map; another folder is needed"
