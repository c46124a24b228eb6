"""``asperity run``: from a measured map, two materials and a load to an answer."""

import argparse
import math
import os
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from asperity.app.map_job import cost_of
from asperity.cli.commands import compare
from asperity.cli.parser import FLAGS, WRONG_USAGE
from asperity.core.errors import InputError, fail, one_line, shown
from asperity.engineering.case import Case
from asperity.engineering.case_file import (
    CHECKSUMS,
    MAP_FILES,
    SUFFIXES,
    at,
    case_of_map,
    load_case,
    put,
    save_case,
)
from asperity.engineering.folder import CASE_FILE, names_in
from asperity.engineering.jobs import Arrangement, arranged, computed, sample_of
from asperity.engineering.show.comparison import compared
from asperity.results.atomic import write_problem
from asperity.settings.model import Problem, entry_of, scalar
from asperity.settings.reader import parse
from asperity.study.progress_and_log import ProgressBar
from asperity.surface.reading.container import maps_in

GROUPS = {
    "body": "--material, or --young and --poisson",
    "load": "--mean-pressure, --hertz-pressure, --force, --normal-approach or --contact-area-fraction",
}
"""Group that every case has → flags that give it."""


def run(options: argparse.Namespace) -> None:
    """Compute the answers, print them, and write results, pictures and reports; compare or pool several."""
    files = {"--out": options.out, "--save": options.save, "--case": options.case}
    empty = [name for name, path in files.items() if path == ""] + ["MAP"] * ("" in options.map)
    empty += ["--counter-map"] * ("" in (options.counter_map or []))
    if empty:
        sys.exit(fail(f"{empty[0]} = '': a name is needed", WRONG_USAGE))
    if any(os.path.isdir(path) for path in options.map):
        own = {name: each for name, each in vars(options).items() if name not in ("command", "map", "out")}
        if wrong := [name for name, each in own.items() if each is not None and each is not False]:
            flag = f"--{wrong[0].replace('_', '-')}"
            sys.exit(fail(f"{flag}: maps are needed beside it, folders of answers are given", WRONG_USAGE))

        compare.run(argparse.Namespace(answers=options.map, out=options.out))
        return

    maps = [each for path in options.map for each in maps_in(path)]
    options.pooled, options.map = options.pooled or len(maps) > len(options.map), maps
    contents, sources, given, problems = _contents(options)
    pooled = options.pooled or any("sample" in content for content in contents)
    arrangement: Arrangement = arranged(contents, options.out, pooled=pooled, only=options.only or "")
    for job in arrangement.jobs:
        source = sources[min(len(sources) - 1, arrangement.jobs.index(job))]
        problems += [_in_words(problem, source, given, job.content) for problem in job.problems]
    problems += [problem.text for problem in arrangement.problems]
    swept = any("sweep" in job.content for job in arrangement.jobs)
    if options.only and not pooled:
        problems.append("--only: needs --pooled")
    if options.resume and not (pooled or swept):
        problems.append("--resume: needs --pooled, or a sweep")
    if options.save:
        problems += _problems_of_save(options, arrangement.jobs)
    if problems:
        sys.exit(max(fail(problem, WRONG_USAGE) for problem in dict.fromkeys(problems)))
    if options.check:
        shapes = [job.rough.face.grid.shape for job in arrangement.jobs if job.rough]
        (time, memory), (ny, nx) = cost_of(arrangement.jobs), max(shapes, key=math.prod)
        size = f"{len(shapes)} map{'s' * (len(shapes) > 1)}, {ny} × {nx} nodes"
        cost = f"about {time} and {memory / 1e9:.1f} GB"
        print(f"nothing wrong was found; {size}, {cost}")
        return
    _compute(options, arrangement)


def _contents(
    options: argparse.Namespace,
) -> tuple[list[dict[str, Any]], list[str], dict[str, Any], list[str]]:
    """Contents of the case of each map, the file of each, settings of the command line, and problems."""
    contents: list[dict[str, Any]] = []
    sources: list[str] = []
    problems: list[str] = []
    for path in options.map:
        is_case = Path(path).suffix in SUFFIXES
        file = path if is_case else options.case
        content = load_case(file) if file else {}
        if not is_case:
            put(content, MAP_FILES[0], path)
            content.get(CHECKSUMS, {}).pop("map", None)
        maps = at(content, MAP_FILES[0])
        contents += [
            case_of_map(content, number) for number in range(len(maps) if isinstance(maps, list) else 1)
        ]
        sources += [file or ""] * (len(contents) - len(sources))
    given: dict[str, Any] = {}
    for key, value in _given(options, problems):
        if key == "map.file" and any(Path(path).suffix not in SUFFIXES for path in options.map):
            problems.append("--set map.file: the map is given as MAP, too; leave one of them out")
        is_map = key in map(".".join, MAP_FILES)
        values = value if is_map and isinstance(value, list) else [value]
        if len(values) not in (1, len(contents)):
            words = f"one for each MAP is needed: {len(contents)}"
            problems.append(f"{FLAGS.get(key, key)}: {len(values)} files are given; one, or {words}")
            continue
        for number, content in enumerate(contents):
            if is_map and isinstance(checksums := content.get(CHECKSUMS), dict):
                checksums.pop("map" if key == "map.file" else "counter_map", None)
            put(content, key.split("."), values[number % len(values)])
        given[key] = value
    return contents, sources, given, problems


def _compute(options: argparse.Namespace, arrangement: Any) -> None:
    """Compute and write the answers of all jobs, and the comparison or the sample of several."""
    jobs = arrangement.jobs
    if options.save and not _is_written(options.save, jobs[0].folder):
        save_case(jobs[0].case, Path(options.save), jobs[0].folder, jobs[0].rough.files)
    label = f"run {jobs[0].case.map.file}" if len(jobs) == 1 else f"run {len(jobs)} maps"
    answers = {}
    with ProgressBar(one_line(label)) as bar:
        for job, answer in computed(arrangement, lambda done, stage: bar(done, 1.0), resume=options.resume):
            answers[job.name] = answer
            if job.is_kept:
                print(f"{one_line(str(job.folder))}: kept", flush=True)
                continue
            whole = answer if arrangement.folder is None else f"{job.name}: {' '.join(answer.verdict)}"
            print(f"{whole}\n", flush=True)
            print(f"report  {one_line(str(job.folder / 'report.html'))}\n", flush=True)
    if arrangement.folder is None or options.only:
        return
    if arrangement.pooled:
        print(sample_of(arrangement, answers))
        print(f"\nreport  {one_line(str(arrangement.folder / 'sample.html'))}")
        return
    comparison = compared(answers)
    comparison.write(arrangement.folder)
    print(comparison.text())
    print(f"\nreport  {one_line(str(arrangement.folder / 'comparison.html'))}")


def _in_words(problem: Problem, source: str, given: Mapping[str, Any], content: Mapping[str, Any]) -> str:
    """A problem with its key as the user gave it: a flag, or a key of the file."""
    key = problem.key
    if not source:
        problem = problem._replace(text=_with_flags(problem.text))
    if not key:
        return problem.text
    if key in ("map", "map.file") and not source:
        return problem.text.lstrip(" =:")
    if key in GROUPS and not source and ": missing" in problem.text:
        return f"{GROUPS[key]}: missing"
    if not source and ", " in key:  # of which one is needed
        group, _, names = key.partition(".")
        return ", ".join(FLAGS.get(f"{group}.{name}", name) for name in names.split(", ")) + problem.text
    in_file = bool(source) and key not in given
    if key == "out" or (key in FLAGS and not (in_file and at(content, key.split(".")) is not None)):
        return f"{FLAGS.get(key, f'--{key}')}{problem.text}"
    return f"{source}: {key}{problem.text}" if in_file else f"{key}{problem.text}"


def _with_flags(text: str) -> str:
    """A text in which flags stand for the keys that it names, with the values that it gives to them."""

    def written(found: re.Match[str]) -> str:
        key, value = found["key"], found["value"]
        if not entry_of(Case, key):  # the name of a file, such as map.npy
            return found[0]
        return f"{FLAGS[key]} {value or ''}".strip() if key in FLAGS else f"--set {key}={value or '…'}"

    return re.sub(
        rf"\b(?P<key>(?:{'|'.join(Case.model_fields)})(?:\.\w+)+)(?:(?:: | = )(?P<value>\w+))?", written, text
    )


def _is_written(save: str, out: Path) -> bool:
    """True if `save` is the case file that is written into the folder of the answer anyway."""
    return Path(save).resolve() == (out / CASE_FILE).resolve()


def _problems_of_save(options: argparse.Namespace, jobs: Sequence[Any]) -> Iterator[str]:
    """Reasons why a case cannot be saved."""
    save = Path(options.save)
    if len(jobs) > 1:
        yield "--save: one MAP is needed, several are given"
    elif problem := write_problem(save):
        yield f"--save {save}: {problem}"
    elif _is_written(options.save, jobs[0].folder):
        return
    elif save.suffix not in SUFFIXES:
        yield f"--save {save}: a name that ends in {' or '.join(SUFFIXES)} is needed"
    elif save.exists():
        read = [options.map[0], options.case, *jobs[0].files]
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


def _given(options: argparse.Namespace, problems: list[str]) -> Iterator[tuple[str, Any]]:
    """Dotted key and value of each setting on the command line; problems are added to the list."""
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
        given = getattr(options, name[2:].replace("-", "_"))
        if given is not None:
            yield key, scalar(given, entry_of(Case, key))
