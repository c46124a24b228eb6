"""Several maps as jobs: arranged from the contents of cases, checked, and computed in parallel.

The command line and the page arrange, check and compute through this module.
"""

import os
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import xarray as xr

from asperity.core.errors import InputError, shown
from asperity.core.processes import side_by_side
from asperity.core.types import Progress
from asperity.engineering.answer import Answer, Sample, answer_to, pool, write_answer
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.answer_files import read_data
from asperity.engineering.case_file import (
    CHECKSUMS,
    MAP_FILES,
    OUT,
    at,
    changed_files,
    holds_answer,
    names_of_maps,
    read_case,
)
from asperity.engineering.face import RoughFace, memory_on, processes_on, read_face
from asperity.engineering.folder import (
    COMPARISON,
    KEPT,
    REPORT,
    SAMPLE,
    folder_problem,
    locked,
    names_in,
    remove_unfinished,
    stems_of,
)
from asperity.engineering.question import part_of
from asperity.engineering.sample import check_alike
from asperity.engineering.stages import check_edges, problems_on_map
from asperity.settings.map import CounterMap, Map
from asperity.settings.model import Problem, SettingsError
from asperity.stress.statistics.largest import check_area

ReadFace = Callable[..., RoughFace]

SMALL = 1e7
"""Bytes of the files of a map that are read in about a second."""


@dataclass(frozen=True, eq=False)
class Job:
    """One map: its case, its rough face, the folder of its answer, and everything that is wrong with it.

    Attributes
    ----------
    name : str
        Name of the map, and of its folder if there are several maps.
    content : mapping
        Groups of the case, as a file holds them.
    folder : Path
    case : Case or None
        None if the settings are not accepted.
    rough : RoughFace or None
        None if the map cannot be read.
    problems : tuple of Problem
        Dotted key and the message after it.
    is_kept : bool
        True if the answer that its folder held already was kept and not computed again.
    """

    name: str
    content: Mapping[str, Any]
    folder: Path
    case: Any
    rough: RoughFace | None
    problems: tuple[Problem, ...]
    is_kept: bool = False

    @property
    def memory(self) -> float:
        """Bytes that its computation takes."""
        assert self.rough is not None
        return memory_on(self.rough.face)

    @property
    def files(self) -> list[str]:
        """Names of the maps that are read."""
        return [each for keys in MAP_FILES if isinstance(each := at(self.content, keys), str)]


@dataclass(frozen=True, eq=False)
class Arrangement:
    """All jobs of one call, and what is made of their answers.

    Attributes
    ----------
    jobs : tuple of Job
    folder : Path or None
        Of the sample or the comparison; None for a single answer.
    pooled : bool
        True for a sample, False for a comparison or a single answer.
    problems : tuple of Problem
        Of all maps together, with an empty key.
    """

    jobs: tuple[Job, ...]
    folder: Path | None
    pooled: bool
    problems: tuple[Problem, ...]


def arranged(
    contents: Sequence[Mapping[str, Any]],
    folder: str | os.PathLike[str] | None = None,
    *,
    pooled: bool = False,
    only: str = "",
    read: ReadFace = read_face,
    small: float = SMALL,
) -> Arrangement:
    """The jobs of the contents of one or several cases, each with one map.

    Parameters
    ----------
    contents : sequence of mapping
        Groups of each case as `asperity.engineering.case_file.contents_of` gives them.
    folder : path, optional
        Of the answer, or of the answers of several maps, each in a folder of the name of its map.
    pooled : bool
        The maps are from several positions of one surface.
    only : str
        Name of the one map whose answer is computed.
    read : callable
        Reads the rough face of a map as `read_face` does.
    small : float
        Bytes up to which a map is read although its settings are wrong, to list all problems at once.
    """
    maps = [str(at(content, MAP_FILES[0]) or "map") for content in contents]
    several = len(contents) > 1 or pooled
    out, found = at(contents[0], (OUT,)), list[str]()
    if not isinstance(out, str | None):
        found.append(f"{OUT} = {shown(out)}: the name of a folder is needed")
        out = None
    given = folder or out or (("pooled" if pooled else "comparison") if several else None)
    whole = Path(given) if given and several else None
    jobs: list[Job] = []
    for name, file, content in zip(names_of_maps(maps), maps, contents, strict=True):
        own = whole / name if whole else Path(given or f"{Path(file).stem}_run")
        if not only or name == only:
            jobs.append(_job(name, dict(content), own, pooled, several, read, small))
    if pooled and all(job.case is not None for job in jobs):
        sliding = jobs[0].case.sliding if jobs else None  # all slide along the lay of the first map
        jobs = [replace(job, case=job.case.replaced(sliding=sliding)) for job in jobs]
    names = names_of_maps(maps)
    if only and only not in names:
        found.append(f"--only {only}: one of {', '.join(names)} is needed")
    elif whole and not only:
        found += _problems_of_several(jobs, names, whole, pooled)
    return Arrangement(tuple(jobs), whole, pooled, tuple(Problem("", text) for text in found))


def _job(
    name: str,
    content: dict[str, Any],
    folder: Path,
    pooled: bool,
    shared: bool,
    read: ReadFace,
    small: float,
) -> Job:
    """The job of one map, with everything that is wrong with its settings, its map and its folder."""
    changed = [*changed_files(content)]
    content = {key: group for key, group in content.items() if key not in (OUT, CHECKSUMS)}
    if pooled:
        content.setdefault("sample", {})
    case, rough, found = None, None, list[Problem]()
    try:
        case = read_case(content)
    except SettingsError as error:
        found += error.found
    files = {keys: each for keys in MAP_FILES if isinstance(each := at(content, keys), str)}
    missing = [
        Problem(".".join(keys), f" = {each}: no such file")
        for keys, each in files.items()
        if not os.path.exists(each)
    ]
    surface: Map | None = None if case is None else case.pressed_map
    counter: CounterMap | None = None if case is None else case.counter_map
    if case is None and not missing and sum(map(os.path.getsize, files.values())) <= small:
        with suppress(SettingsError):
            surface = Map.read(content.get("map", {}))
            surface = surface.replaced(crop=None, crop_at=None) if surface.crop == "fit" else surface
    if surface is not None and not missing:
        try:
            check = None if case is None else partial(check_edges, case)
            rough = read(surface, counter, shared, check)
            if case is not None:
                case = case.on_face(rough)
                found += problems_on_map(case, rough)
        except SettingsError as error:
            found += error.found
        except InputError as error:
            found += [
                Problem(f"map.{key}", text) if key else Problem("map", f": {line}")
                for (key, text), line in zip(error.found, error.lines, strict=True)
            ]
        except ValueError as error:
            found.append(Problem("", str(error)))
    if problem := folder_problem(folder, stems=() if case is None else stems_of(case)):
        found.append(Problem("out", f" = {folder}: {problem}"))
    elif not missing and os.path.realpath(folder) in [
        os.path.dirname(os.path.realpath(each)) for each in files.values()
    ]:
        found.append(Problem("out", f" = {folder}: holds the map; another folder is needed"))
    return Job(name, content, folder, case, rough, (*dict.fromkeys([*found, *changed, *missing]),))


def _problems_of_several(
    jobs: Sequence[Job], names: Sequence[str], folder: Path, pooled: bool
) -> Iterator[str]:
    """Reasons why the answers of several maps cannot be written, or maps cannot be pooled."""
    if problem := folder_problem(folder, SAMPLE if pooled else COMPARISON):
        yield f"out = {folder}: {problem}"
    if len(set(names)) < len(names):
        yield "maps: files of different names, or in folders of different names, are needed"
    for name in names:
        if name.startswith(".") or name in (*SAMPLE, *COMPARISON):
            yield f"maps: {shown(name)} cannot be the name of the folder of its answer; rename the map"
    if not pooled or any(job.problems or job.rough is None for job in jobs):
        return
    faces, of_checksum = {}, dict[str, str]()
    for job in jobs:
        assert job.rough is not None
        faces[job.name] = job.rough.face
        if job.rough.files:
            other = of_checksum.setdefault(job.rough.files[0].sha256, job.name)
            if other != job.name:
                yield f"maps: {job.name} and {other} are copies of one file; give each position once"
    try:
        check_alike(faces)
        for job in jobs:
            if job.case.sample is not None and job.case.sample.area is not None:
                check_area(job.case.sample.area, sum(face.grid.area for face in faces.values()))
    except ValueError as error:
        yield str(error)


def computed(
    arrangement: Arrangement,
    progress: Callable[[float, str], None],
    *,
    resume: bool = False,
    cores: int | None = None,
) -> Iterator[tuple[Job, Answer]]:
    """Compute and write the answers of all jobs; each is given when it is written, in their order.

    Jobs run in parallel, each in a process, on all cores and within the memory that is available.

    Parameters
    ----------
    arrangement : Arrangement
        Without problems.
    progress : callable
        Called with the part that is done, and the stage.
    resume : bool
        Keep answers of the same case that are already in their folders.
    cores : int, optional
        Most processes; by default all cores.
    """
    jobs, first = arrangement.jobs, arrangement.jobs[0].folder
    with locked(first if len(jobs) == 1 else arrangement.folder or first):
        held = [
            bool(resume and job.rough and holds_answer(job.folder, job.case, job.rough.files)) for job in jobs
        ]
        done = [is_held and REPORT in names_in(job.folder) for job, is_held in zip(jobs, held, strict=True)]
        left = [n for n, is_done in enumerate(done) if not is_done]
        for n in left:
            if not resume:
                shutil.rmtree(jobs[n].folder / KEPT, ignore_errors=True)
        processes = processes_on([rough.face for n in left if (rough := jobs[n].rough)], len(left), cores)
        beside, state = max((cores or os.cpu_count() or 1) // processes, 1), list[Any]([0.0, ""])
        steps = _steps(left, [n for n in left if held[n]], processes)

        def report(parts: list[float]) -> None:
            if processes > 1:
                ended = sum(part >= 1 and step[2] for part, step in zip(parts, steps, strict=True))
                state[1] = f"{ended} of {len(left)} maps done"
            state[0] = sum(parts) / len(parts)
            progress(*state)

        def on_stage(n: int, name: str) -> None:
            place = f"map {left.index(n) + 1} of {len(left)}, " if len(left) > 1 else ""
            state[1] = f"{place}{name.replace('_', ' ')}"
            progress(*state)

        given = [
            (jobs[n], data, pictures, beside, partial(on_stage, n) if processes == 1 else None)
            for n, data, pictures in steps
        ]
        after = [None if data or held[n] else steps.index((n, True, False)) for n, data, _ in steps]
        made = side_by_side(_written, given, processes, report, after)
        for n, job in enumerate(jobs):
            if done[n]:
                remove_unfinished(job.folder)
            answer: Any = None if done[n] else next(each for each in made if each is not None)
            if not isinstance(answer, Answer):
                sections, answer = answer or {}, read_data(job.folder, Answer)
                answer.framed_sections.update(sections)
            yield replace(job, is_kept=done[n]), answer


def _steps(left: Sequence[int], held: Sequence[int], processes: int) -> list[tuple[int, bool, bool]]:
    """Number of each map, and if its results are computed and if its pictures are drawn in this step.

    Several processes draw pictures after the next results, so that the last map leaves none without work.
    """
    if processes == 1:
        return [(n, n not in held, True) for n in left]
    order = [(place, False, n) for place, n in enumerate(left) if n not in held]
    order += [(place + processes, True, n) for place, n in enumerate(left)]
    return [(n, not pictures, pictures) for _, pictures, n in sorted(order)]


def _written(
    job: Job,
    data: bool,
    pictures: bool,
    cores: int,
    on_stage: Callable[[str], None] | None,
    progress: Progress,
) -> Answer | dict[tuple[str, str], xr.DataArray] | None:
    """Compute an answer and write its results, draw the pictures and the report of results, or both.

    Returns the answer if its stages are asked for, as in this process, else the sections of the pictures.
    """
    if data:
        report, kept = partial(part_of, progress, 0.0, 0.95, 1.0), job.folder / KEPT
        answer = answer_to(job.case, job.rough, report, on_stage, cores=cores, kept=kept)
    else:
        answer = read_data(job.folder, Answer)
        vars(answer)["case"] = job.case  # names files as they were given
    if on_stage is not None:
        on_stage("pictures and report")
    write_answer(answer, job.folder, data, pictures)
    shutil.rmtree(job.folder / KEPT, ignore_errors=True)
    if on_stage is not None:
        return answer
    return answer.framed_sections if pictures else None


def sample_of(arrangement: Arrangement, answers: Mapping[str, AnswerData]) -> Sample:
    """The sample of the answers of pooled maps, written into their folder."""
    assert arrangement.folder is not None
    sample = pool(answers)
    sample.write(arrangement.folder)
    return sample
