"""Requests about an answer: open the folder that holds it, compute it, and show planes of its stress."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from asperity.app.form import contents_of
from asperity.app.map_job import Ends, MapJob, along, picture
from asperity.core.errors import InputError
from asperity.core.types import Array
from asperity.engineering.answer import Answer, Sample, opened
from asperity.engineering.answer_data import AnswerData, by_topic, load_in_words, without_repeats
from asperity.engineering.jobs import arranged, computed, sample_of
from asperity.engineering.records import Record
from asperity.engineering.show.comparison import compared
from asperity.engineering.show.sample import predicted
from asperity.engineering.show.tables import TILES
from asperity.results.atomic import locked
from asperity.stress.planes.planes import StressPlane, named_fields
from asperity.stress.planes.stream import PlaneStream
from asperity.views.scales import largest_magnitude

SHOWN_TOLERANCE = 1e-3
"""Error of a plane that is only looked at, relative to the rms of σ_zz in it."""

MOST_KEPT = 2**30
"""Bytes of planes of fields that are not looked at, above which these are deleted."""

ROWS = 160
"""Rows of a section."""

FADED = 0.05
"""A section ends where the stress is below this fraction of its largest value."""

PEAKS = {"x": "x_m", "y": "y_m", "depth": "depth_m", "value": "value_Pa"}
"""Name of a number of a peak on the page → its column in the table of an answer."""

DRAWN, LEAST = 200, 0.05
"""Most peaks in pictures, and the least value of a peak over the largest."""


class Reader(MapJob):
    """Reads what stands in files: maps and cases, and answers without planes of their stress."""

    def open(self, folder: str, number: int) -> dict[str, Any]:
        """What a folder holds, and the number of the answer on the page."""
        return {"number": number} | summary_of(opened(folder))

    def compare(self, names: Sequence[str], folders: Sequence[str]) -> dict[str, Any]:
        """Verdict, and differences of all numbers, of the answers of two folders."""
        found = compared(dict(zip(names, map(opened, folders), strict=True)))
        first, second = (found.records[name] for name in names)
        differences = [found.difference(key, *names) for key in first if key in second]
        return {"names": list(names), "verdict": found.verdict, "differences": differences}


class AnswerJob:
    """Computes an answer or a sample into a folder, and shows planes of the stress of an answer.

    Planes are computed for the depths of the answer, ahead of the slider that asks for them.
    """

    def __init__(self, reply: Callable[[str, Any], None]) -> None:
        self._reply = reply
        self._answers: Mapping[str, AnswerData] = {}
        self._look_at("")

    def run(self, content: Mapping[str, Any], out: str, memory: float) -> dict[str, Any]:
        """Compute the answer of a case into a new folder below another, or the sample of several maps.

        Jobs run in parallel within some bytes of memory. The folder is locked from its first moment on.
        """
        for number in count(1):
            folder = Path(out, f"answer_{number}")
            try:
                folder.mkdir(parents=True)
                break
            except FileExistsError:
                continue
        with locked(folder):
            self._reply("folder", folder)
            arrangement = arranged(contents_of(content), folder, pooled="sample" in content)
            problems = [*(each for job in arrangement.jobs for each in job.problems), *arrangement.problems]
            if problems:
                raise InputError("", dict.fromkeys(problems))
            beside = int(memory / max(job.memory for job in arrangement.jobs))
            cores = max(1, min(beside, os.cpu_count() or 1))
            made = computed(arrangement, lambda *state: self._reply("progress", state), cores=cores)
            answers = {job.name: answer for job, answer in made}
            if arrangement.pooled:
                sample_of(arrangement, answers)
        found = opened(folder)
        self._answers = _answers_in(found)
        self._look_at(next(iter(self._answers)))
        return summary_of(found)

    def look(self, folder: str, name: str) -> None:
        """Take the answer of one map from a folder."""
        self._answers = _answers_in(opened(folder))
        self._look_at(name)

    def map(self, name: str) -> dict[str, Any]:
        """The answer of another map, as of `drawn_of`."""
        self._look_at(name)
        return drawn_of(name, self._answer)

    def _look_at(self, name: str) -> None:
        """Forget the planes of the answer of another map."""
        self._name = name
        self._planes: dict[tuple[str, str], dict[float, dict[str, Any]]] = {}
        self._wanted: tuple[str, str] | None = None
        self._stream: PlaneStream | None = None
        self._ahead: Iterator[StressPlane] = iter(())

    @property
    def _answer(self) -> AnswerData:
        return self._answers[self._name]

    def _want(self, body: str, field: str) -> dict[float, dict[str, Any]]:
        """Planes of a field that are known. The stream of planes that is kept is that of this field."""
        if self._wanted != (body, field):
            self._wanted = body, field
            kept = (plane["values"].nbytes for planes in self._planes.values() for plane in planes.values())
            if sum(kept) > MOST_KEPT:
                self._planes = {}
            known = self._planes.setdefault(self._wanted, {})
            left = [depth for depth in _depths(self._answer, body) if depth not in known]
            sliding = self._answer.case.sliding_of(body)
            loaded = self._answer.loaded(body)
            self._stream = PlaneStream(loaded, left or [0.0], None, (field,), SHOWN_TOLERANCE, **sliding)
            self._ahead = named_fields(self._stream) if left else iter(())
        return self._planes[body, field]

    def _keep(self, plane: StressPlane) -> dict[str, Any]:
        assert self._wanted is not None
        shown = picture(plane.fields[self._wanted[1]][0], plane.grid, largest_magnitude)
        self._planes[self._wanted][plane.depth] = shown
        return shown

    def work_ahead(self) -> bool:
        """Compute the next plane of the field that is looked at; False if there is none left."""
        if (plane := next(self._ahead, None)) is None:
            return False
        self._keep(plane)
        return True

    def plane(self, body: str, field: str, depth: float) -> dict[str, Any]:
        """A field of the stress in a plane."""
        shown = self._want(body, field).get(depth)
        if shown is None:
            assert self._stream is not None
            shown = self._keep(next(named_fields(self._stream, at=[depth])))
        return {"picture": shown, "depth": depth}

    def section(self, body: str, field: str, ends: Ends) -> dict[str, Any]:
        """A field of the stress in the vertical section along a line, from all planes of the field."""
        planes = self._want(body, field)
        while self.work_ahead():
            pass
        depths = _depths(self._answer, body)
        found = [along(planes[depth], ends) for depth in depths]
        distance, values = found[0][0], np.array([each[1] for each in found])
        largest = np.abs(values).max(axis=1)
        last = int(np.flatnonzero(largest > FADED * largest.max()).max(initial=0))
        bottom = min(depths[-1], max(depths[last], distance[-1] / 10))
        even = np.linspace(0, bottom, ROWS)
        section: Array = np.array([np.interp(even, depths, column) for column in values.T]).T
        frame = {"x": 0.0, "y": 0.0, "dw": float(distance[-1]), "dh": bottom}
        return {"picture": {"values": section.astype(np.float32), **frame}}


def summary_of(found: Answer | Sample) -> dict[str, Any]:
    """An answer or a sample in words and numbers, with the pictures of its answer or of its first map."""
    answers = _answers_in(found)
    names = found.face.name if isinstance(found, Answer) else ", ".join(answers)
    return {
        "title": (names, " ".join(load_in_words(found.case))),
        "whole": _described(found),
        "maps": {name: _described(answer) for name, answer in answers.items() if answer is not found},
        "drawn": drawn_of(*next(iter(answers.items()))),
    }


def drawn_of(name: str, answer: AnswerData) -> dict[str, Any]:
    """Contact and peaks of the answer of one map, and everything that can be chosen for its planes."""
    contact = answer.contact
    fields = {"pressure": np.where(contact.pressure > 0, contact.pressure, np.nan), "gap": contact.gap}
    return {name: picture(values, contact.grid, np.fmax.reduce) for name, values in fields.items()} | {
        "name": name,
        "bodies": [*answer.stress],
        "fields": [*answer.case.fields],
        "depths": {body: _depths(answer, body) for body in answer.stress},
        "yield": {name: body.yield_stress for name, body in answer.case.bodies.items()},
        "peaks": {
            key: _largest(peaks) for key, peaks in answer.tables["peaks"].groupby(["body", "quantity"])
        },
    }


def _largest(peaks: pd.DataFrame) -> dict[str, Array]:
    """Numbers of the largest peaks of one field in a body; the table begins with the largest."""
    size = peaks["value_Pa"].abs()
    shown = peaks[size >= LEAST * size.max()][:DRAWN]
    return {name: shown[column].to_numpy() for name, column in PEAKS.items()}


def _answers_in(found: Answer | Sample) -> Mapping[str, AnswerData]:
    """Name of each map → its answer; the name is empty if there is one map."""
    return {"": found} if isinstance(found, Answer) else found.answers


def _depths(answer: AnswerData, body: str) -> list[float]:
    depths = answer.depths(body)
    return depths[depths <= max(answer.contact.grid.length)].tolist()


def _described(found: AnswerData | Sample) -> dict[str, Any]:
    """Words and records of an answer or a sample, as the page shows them; values are those of the maps."""
    shown: list[Record] = without_repeats(found.records)
    sample = found if isinstance(found, Sample) else None
    return {
        "maps": sample.names if sample else (),
        "uncertainties": [] if isinstance(found, Sample) else found.uncertainties,
        "warnings": found.warnings,
        "title": found.title,
        "verdict": [*found.verdict, *(predicted(sample) if sample else ())],
        "tiles": found.tiles[:TILES],
        "topics": [
            (
                heading,
                [(each, sample.values(each) if sample else ()) for each in records],
            )
            for heading, records in by_topic(found.case, shown)
        ],
    }
