"""Requests about an answer: compute it, open the folder that holds it, and show planes of its stress."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace
from typing import Any, get_type_hints

import numpy as np
import pandas as pd
import xarray as xr

from asperity.app.map_job import Ends, along, picture
from asperity.core.errors import InputError
from asperity.core.types import Array
from asperity.engineering.answer import case_in_words, tile_names
from asperity.engineering.case import Case
from asperity.engineering.case_file import case_of_answer
from asperity.engineering.face import read_face
from asperity.engineering.folder import CASE_FILE, names_in
from asperity.engineering.question import Row
from asperity.engineering.run import answer_of
from asperity.fourier.grid import Grid, grid_of
from asperity.results.dataset import settings_of
from asperity.stress.planes.planes import StressPlane, named_fields
from asperity.stress.planes.stream import PlaneStream
from asperity.views.maps import largest_magnitude
from asperity.views.source import sources

PLANE_TOLERANCE = 1e-3
"""Error of a plane that is only looked at, relative to the rms of σ_zz in it."""

MOST_KEPT = 2**30
"""Bytes of planes that are kept for the depth slider."""

ROWS = 160
"""Rows of a section."""

FADED = 0.05
"""A section ends where the stress is below this share of its largest value."""

ADVICE = ["level", "subject", "text"]
"""Columns of the advice that are shown."""

PEAKS = {"body": str, "quantity": str} | dict.fromkeys(("value_Pa", "depth_m", "y_m", "x_m"), float)
"""Columns of the peaks that are shown, with their types."""


class AnswerJob:
    """Computes an answer into a folder, and shows the answer of a folder.

    Planes are computed for the depths of the answer, ahead of the slider that asks for them.
    """

    def __init__(self, reply: Callable[[str, Any], None]) -> None:
        self._reply = reply
        self._planes: dict[tuple[str, str, float], dict[str, Any]] = {}
        self._streams: dict[tuple[str, str], tuple[PlaneStream, Iterator[StressPlane]]] = {}
        self._wanted: tuple[str, str] | None = None
        self.folder = Path()

    def run(self, contents: Mapping[str, Mapping[str, Any]], folder: str) -> dict[str, Any]:
        """Compute the answer of a case, write it into a folder, and show it.

        Of the cases of several maps, each answer has a folder of the name of the map, as after
        ``asperity run --pooled``, and the first is shown.
        """
        from asperity.engineering.output import write_answer
        from asperity.engineering.sample import check_alike
        from asperity.engineering.several_answers import read_sample, write_sample

        cases, is_sample = {}, len(contents) > 1
        for name, content in contents.items():
            case = Case.read(content)
            cases[name] = case, read_face(case.map, case.counter_map, shared=is_sample)
        if is_sample:
            check_alike({name: rough.face for name, (_, rough) in cases.items()})
        read = []
        for number, (name, (case, rough)) in enumerate(cases.items()):
            place = f"map {number + 1} of {len(cases)}, " if is_sample else ""

            def report(done: float, total: float, before: int = number) -> None:
                self._reply("progress", 0.95 * (before + done / total) / len(cases))

            def on_stage(stage: str, place: str = place) -> None:
                self._reply("stage", f"{place}{stage.replace('_', ' ')}")

            answer = answer_of(case, rough, report, on_stage)
            on_stage("pictures and report")
            write_answer(answer, Path(folder, name) if is_sample else folder)
            read.append((answer.case, rough.files))
        if not is_sample:
            return self.open(folder)
        means = write_sample(read_sample(Path(folder), list(cases), read[0][0]), Path(folder), read)
        return self.open(os.path.join(folder, next(iter(cases)))) | {"sample": str(means)}

    def open(self, folder: str) -> dict[str, Any]:
        """Tables, contact and advice of an answer, which the page shows before a plane is asked for."""
        self.folder = Path(folder)
        if CASE_FILE not in names_in(self.folder):
            raise InputError(str(self.folder), ["the folder of an answer of asperity run is needed"])
        case = self._case = Case.read(case_of_answer(self.folder))
        self._contact = xr.load_dataset(self.folder / "contact.nc")
        bodies = list(case.different_bodies)
        try:
            rows = rows_in(self.folder)
            advice = pd.read_csv(self.folder / "advice.csv", usecols=ADVICE, keep_default_na=False)
            peaks = pd.read_csv(self.folder / "peaks.csv", usecols=[*PEAKS], dtype=PEAKS)
        except (OSError, ValueError, KeyError) as error:
            needed = f"a complete answer of this version of asperity is needed ({error}); compute it again"
            raise InputError(str(self.folder), [needed]) from None
        return {
            "title": settings_of(self._contact)["name"],
            "case": case_in_words(case),
            "rows": rows,
            "tiles": tile_names(case),
            "advice": advice.to_dict("records"),
            **{
                name: picture(self._contact[name].values, self._grid, np.fmax.reduce)
                for name in ("pressure", "gap")
            },
            "bodies": bodies,
            "fields": list(case.fields),
            "depths": {body: self._depths(body) for body in bodies},
            "yield": {name: body.yield_stress for name, body in case.bodies.items()},
            "peaks": {name: values.to_numpy() for name, values in peaks.items()},
        }

    @cached_property
    def _grid(self) -> Grid:
        return grid_of(self._contact)

    def _depths(self, body: str) -> list[float]:
        suffix = f"_{body}" if len(self._case.different_bodies) > 1 else ""
        with xr.open_dataset(self.folder / f"stress{suffix}.nc") as stress:
            depths = stress["plane_depth"].values
        return depths[depths <= max(self._grid.length)].tolist()

    def _stream(self) -> tuple[PlaneStream, Iterator[StressPlane]]:
        """The planes of the field that is looked at: the modes of the pressure are kept with them."""
        body, field = self._wanted or ("", "")
        if (body, field) not in self._streams:
            sliding = self._case.sliding_of(body)
            (source,) = sources(self._contact)
            contact: Any = SimpleNamespace(
                in_body=lambda name: source.loaded(name)[0],
                mean_pressure=float(self._contact["mean_pressure"]),
            )
            answer: Any = SimpleNamespace(case=self._case)
            film = self._case.film
            solid = None if film is None else film.loaded(answer, contact, body)
            solid = self._case.loaded_body(contact, body) if solid is None else solid
            stream = PlaneStream(solid, self._depths(body), None, (field,), PLANE_TOLERANCE, **sliding)
            self._streams[body, field] = stream, named_fields(stream)
        return self._streams[body, field]

    def _keep(self, plane: StressPlane) -> dict[str, Any]:
        body, field = self._wanted or ("", "")
        shown = picture(plane.fields[field][0], plane.grid, largest_magnitude)
        self._planes[body, field, plane.depth] = shown
        return shown

    def work_ahead(self) -> bool:
        """Compute the next plane of the field that is looked at; False if there is none left."""
        if self._wanted is None or sum(each["values"].nbytes for each in self._planes.values()) > MOST_KEPT:
            return False
        if (plane := next(self._stream()[1], None)) is None:
            return False
        self._keep(plane)
        return True

    def plane(self, body: str, field: str, depth: float) -> dict[str, Any]:
        """A field of the stress in a plane."""
        self._wanted = body, field
        shown = self._planes.get((body, field, depth))
        if shown is None:
            shown = self._keep(next(named_fields(self._stream()[0], at=[depth])))
        return {"picture": shown, "depth": depth}

    def section(self, body: str, field: str, ends: Ends) -> dict[str, Any]:
        """A field of the stress in the vertical section along a line, from the planes that are kept."""
        depths = [depth for depth in self._depths(body) if (body, field, depth) in self._planes]
        found = [along(self._planes[body, field, depth], ends) for depth in depths]
        distance, values = found[0][0], np.array([each[1] for each in found])
        largest = np.abs(values).max(axis=1)
        last = int(np.flatnonzero(largest > FADED * largest.max()).max(initial=0))
        bottom = min(depths[-1], max(depths[last], distance[-1] / 10))
        even = np.linspace(0, bottom, ROWS)
        section: Array = np.array([np.interp(even, depths, column) for column in values.T]).T
        frame = {"x": 0.0, "y": 0.0, "dw": float(distance[-1]), "dh": bottom}
        return {"picture": {"values": section.astype(np.float32), **frame}}


def rows_in(folder: Path) -> list[dict[str, Any]]:
    """Numbers of an answer without columns of later versions; those that earlier ones lack are left out."""
    known = get_type_hints(Row)
    del known["shown"]
    rows = pd.read_csv(folder / "answer.csv", usecols=lambda name: name in known, dtype=known)
    _ = rows[["group", "name", "value", "unit"]]  # without them there is no number
    return rows.fillna({"error_of": "", "unit": ""}).to_dict("records")
