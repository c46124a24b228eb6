"""The public functions: `run` computes an answer, `open_answer` opens one, `pool` makes a sample."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asperity.core.arguments import own_errors
from asperity.core.errors import DatasetError
from asperity.core.types import Progress
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.answer_files import read_data, write_data
from asperity.engineering.case import Case
from asperity.engineering.folder import (
    COMPARISON_DATA,
    SAMPLE_DATA,
    locked,
    names_in,
    replacing,
)
from asperity.engineering.sample import SampleData, named, pooled
from asperity.engineering.show import sample as show_sample
from asperity.engineering.show.comparison import Comparison, compared
from asperity.engineering.show.report import preview, report, write_report
from asperity.engineering.show.tables import text
from asperity.engineering.stages import answer_of
from asperity.settings.load import UNITS
from asperity.surface.reading.height_map import HeightMap


class Answer(AnswerData):
    """The answer of a case: ``print`` shows it, ``answer["maximum pressure"]`` is one of its numbers.

    Attributes as of `AnswerData`: ``case``, ``records``, ``verdict``, ``warnings``, ``contact``, ``stress``,
    ``tables``, ``datasets``; ``plane`` and ``section`` compute the stress anywhere.

    Examples
    --------
    >>> height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    >>> answer = asp.run(surface, asp.Body(young=210e9, poisson=0.3), mean_pressure=50e6)
    >>> record = answer["maximum pressure"]
    >>> record.unit, "peaks" in answer.tables
    ('Pa', True)
    """

    def __str__(self) -> str:
        return text(self)

    def _repr_html_(self) -> str:
        return preview(self)

    def write(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write the answer into a folder: first the results and tables, then the pictures and the report.

        If the process is killed, the folder holds either the whole earlier answer or the new results, perhaps
        without pictures and report. If it is killed while files are moved to their places, the next call
        moves the rest.

        Parameters
        ----------
        folder : path
            Made if it is not there; a symbolic link is followed. An earlier answer in it is replaced, other
            files stay.

        Returns
        -------
        list of Path
            The files.

        Raises
        ------
        ValueError
            If a file would replace one that no earlier answer wrote, or that is read-only, or the folder
            holds a sample or a comparison.
        DatasetError
            If it cannot be written, or another process writes into it; the earlier answer is still there
            then, or the results of the new one without pictures and report.
        """
        return write_answer(self, Path(folder))

    def report(self) -> str:
        """The answer as a page that needs no other file."""
        return report(self)

    def compare(self, *others: Answer | Sample) -> Comparison:
        """Compare the answer with others and with samples, in their order."""
        return compared([self, *others])


def write_answer(answer: AnswerData, folder: Path, data: bool = True, pictures: bool = True) -> list[Path]:
    """As `Answer.write`, or the results alone, or the pictures and the report of results that are written."""
    try:
        with locked(folder):
            if data:
                with replacing(folder, kept=set()) as unfinished:
                    write_data(answer, unfinished, folder)
            if pictures:
                try:
                    with replacing(folder, kept=names_in(folder)) as unfinished:
                        write_report(answer, unfinished)
                except Exception as error:  # drawing may raise errors of any type
                    message = f"{folder}: results are written, pictures and report not ({error})"
                    raise DatasetError(message) from error
            answer.__dict__["folder"] = folder.absolute()
            return [folder / name for name in sorted(names_in(folder))]
    except OSError as error:
        raise DatasetError(f"{folder}: cannot be written ({error.strerror or error})") from error


class Sample(SampleData):
    """Answers of several maps of one surface: ``print`` shows their means; see `asperity.pool`.

    Examples
    --------
    >>> steel, edge = asp.Body(young=210e9, poisson=0.3), 2e-4
    >>> heights = [asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, 1e-7, seed, length=edge) for seed in range(2)]
    >>> maps = [asp.HeightMap(height, (edge, edge), periodic=True, name="ground") for height in heights]
    >>> sample = asp.pool([asp.run(each, steel, mean_pressure=50e6) for each in maps])
    >>> sample["maximum pressure"].unit
    'Pa'
    """

    def __str__(self) -> str:
        return show_sample.text(self)

    def _repr_html_(self) -> str:
        return show_sample.preview(self)

    def report(self) -> str:
        """The sample as a page that needs no other file."""
        return show_sample.page(self)

    def compare(self, *others: Answer | Sample) -> Comparison:
        """Compare the sample with others and with answers, in their order."""
        return compared([self, *others])

    def write(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write tables, page and case file into the parent folder of the answers of the maps.

        Raises
        ------
        ValueError
            If the answer of a map is not in the folder of its name there.
        DatasetError
            If it cannot be written, or another process writes into it.
        """
        return show_sample.write_sample(self, Path(folder))


def open_answer(folder: str | os.PathLike[str]) -> Answer | Sample | Comparison:
    """The answer, sample or comparison that a folder holds: the same data as after the computation.

    Parameters
    ----------
    folder : path
        As its ``write`` or ``asperity run`` wrote it; it may have been moved, a comparison with its answers.

    Returns
    -------
    Answer, Sample or Comparison

    Raises
    ------
    DatasetError
        If it holds none, or one of another format.

    Examples
    --------
    >>> import tempfile
    >>> height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    >>> answer = asp.run(surface, asp.Body(young=210e9, poisson=0.3), mean_pressure=50e6)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     names = {path.name for path in answer.write(f"{folder}/ground")}
    ...     again = asp.open_answer(f"{folder}/ground")["maximum pressure"]
    >>> names >= {"report.html", "answer.csv", "peaks.csv", "contact.nc"}
    True
    >>> again == answer["maximum pressure"]
    True
    """
    folder = Path(folder)
    if COMPARISON_DATA not in names_in(folder):
        return opened(folder)

    def answer(each: str) -> Answer:
        return read_data(Path(os.path.normpath(folder / each)), Answer)

    try:
        kept = json.loads((folder / COMPARISON_DATA).read_text(encoding="utf-8"))
        items = {
            name: pool({own: answer(at) for own, at in each.items()})
            if isinstance(each, dict)
            else answer(each)
            for name, each in kept.items()
        }
    except DatasetError:
        raise
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise DatasetError(f"{folder / COMPARISON_DATA}: damaged ({error})") from error
    return compared(items)


def opened(folder: str | os.PathLike[str]) -> Answer | Sample:
    """The answer or the sample that a folder holds; `DatasetError` if it holds none."""
    folder = Path(folder)
    return Sample.read(folder, Answer) if SAMPLE_DATA in names_in(folder) else read_data(folder, Answer)


def pool(answers: Mapping[str, Any] | Sequence[Any]) -> Sample:
    """The numbers of maps of one surface, in one case, as a sample.

    Parameters
    ----------
    answers : sequence or mapping of Answer or path
        Of maps of different positions, with the same pixels, bodies and load; paths are opened. Where no
        direction of friction was given, all slide along the lay of the first map: answers in another
        direction are computed again.

    Returns
    -------
    Sample

    Raises
    ------
    ValueError
        If there is no answer, or one twice, or maps, bodies or loads differ.

    Examples
    --------
    >>> steel, edge = asp.Body(young=210e9, poisson=0.3), 2e-4
    >>> heights = [asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, 1e-7, seed, length=edge) for seed in range(3)]
    >>> maps = [asp.HeightMap(height, (edge, edge), periodic=True, name="ground") for height in heights]
    >>> sample = asp.pool([asp.run(each, steel, mean_pressure=50e6) for each in maps])
    >>> area = sample["contact area fraction"]
    >>> print(f"contact area fraction {area.best_text()}")
    contact area fraction 5.1 ± 1.1 % (± without discretisation)
    """

    def answer(each: Any) -> AnswerData:
        return each if isinstance(each, AnswerData) else read_data(Path(each), Answer)

    if isinstance(answers, (AnswerData, str, os.PathLike)):
        raise TypeError("answers: a list or a mapping of answers or folders is needed")
    if isinstance(answers, Mapping):
        found = {name: answer(each) for name, each in answers.items()}
    else:
        found = named([*map(answer, answers)])
    asked: dict[str, Any] = {name: each.case.questions.get("sliding") for name, each in found.items()}
    first = next(iter(asked.values()), None)
    for name, own in asked.items():
        if own and first and (sliding := own.along(first)).direction != own.direction:
            case: Any = found[name].case
            found[name] = answer_to(case.replaced(sliding=sliding))
    return pooled(found, Sample)


@own_errors
def run(
    map: Any, body: Any = None, counter_body: Any = None, *, progress: Progress | None = None, **groups: Any
) -> Answer:
    """Press a measured surface against a flat or rough body, and answer the questions of the case.

    Numbers are in SI units; texts have their units.

    Parameters
    ----------
    map : path, HeightMap, array, mapping or Case
        File of a map, a map in metres, or a group with options of its treatment. An array of heights in
        metres, peaks upward, needs `length`, its edges (y, x), as a keyword or beside `file` in the group. By
        default non-measured points are filled, and a map that is not declared periodic is mirrored. Or a
        whole case alone.
    body : Body or mapping
    counter_body : Body or mapping, optional
        By default the other body is rigid. Which of the two is rough does not matter, as long as the slopes
        are small.
    progress : callable, optional
        Called as progress(done, total).
    **groups
        The load by its quantity: `mean_pressure` (Pa), `force` (N), `normal_approach` (m) or
        `contact_area_fraction`, or the group `load`, which also places the map in a Hertz contact.
        Questions, each a mapping of its settings, or ``{}`` for their defaults: `film`, `running_in`,
        `sliding`, `conduction`, `leak`, `partial_slip`, `load_curve`, `yielding`, `strength`, `cycles`,
        `adhesion`, `sensitivity`, `sweep` and `sample`. The `fields` of the stress, such as
        ``["von_mises"]``, and own `materials`. ``help(asp.Case)`` and `docs/cases.md` describe all.

    Returns
    -------
    Answer
        Its `verdict`, `warnings` and `records`, of which ``answer["maximum pressure"]`` is one; `tables`,
        `datasets`, `contact` and `stress`; `plane` and `section` anywhere in a body; `frame`, `report`,
        `write` and `compare`.

    Raises
    ------
    SettingsError, MapError
        With everything that is not accepted, or that the map lacks.
    ConvergenceError
        If the contact does not converge.

    Examples
    --------
    A rough surface of 0.2 mm, made here instead of read from a file, on steel under 50 MPa:

    >>> height = asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    >>> steel = asp.Body(young="210 GPa", poisson=0.3, yield_stress="1.5 GPa")
    >>> answer = asp.run(surface, steel, mean_pressure="50 MPa", sliding={"friction": 0.1})
    >>> print(answer["contact area fraction"].number(digits=2))
    5.5 %
    """
    if isinstance(map, Case):
        case = map
    else:
        map = _with_heights(map, groups.pop("length", None))
        groups = {name: group for name, group in groups.items() if group is not None}
        imposed = {name: groups.pop(name) for name in UNITS if name in groups}
        groups |= {"load": imposed} if imposed or "load" not in groups else {}
        groups |= {"counter_body": counter_body} if counter_body is not None else {}
        case = Case(map=map, body=body, **groups)
    return answer_to(case, progress=progress)


def answer_to(case: Case, *given: Any, **options: Any) -> Answer:
    """The answer of a case; arguments as of `asperity.engineering.stages.answer_of`."""
    return Answer(**vars(answer_of(case, *given, **options)))


def _with_heights(map: Any, length: Any) -> Any:
    """A map, or its group, with heights of an array as a `HeightMap`."""
    group = dict(map) if isinstance(map, Mapping) else {"file": map}
    source, length = group.get("file"), group.pop("length", length)
    if isinstance(source, (np.ndarray, list, tuple)):
        if length is None:
            raise ValueError("length: the edges (y, x) of the map in m are needed with an array of heights")
        group["file"] = HeightMap(source, length, unit="m", name="map")  # type: ignore[arg-type]
    elif length is not None:
        raise ValueError("length: not accepted with a file or a HeightMap, which have their own")
    else:
        return map
    return group
