"""Requests that a worker answers: check a case and its map, compute an answer, show an answer of a folder."""

from __future__ import annotations

import html
import os
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from asperity.core.errors import InputError
from asperity.core.types import Array
from asperity.core.units import shown_si
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.engineering.answer import LIMITS
from asperity.engineering.case import Case
from asperity.engineering.case_file import CHECKSUMS, OUT, load_case
from asperity.engineering.face import read_face
from asperity.engineering.folder import CASE_FILE, names_in
from asperity.engineering.run import answer_of, problems_on_map
from asperity.fourier.grid import Grid, grid_of
from asperity.settings.load import Hertz
from asperity.settings.map import Map, MapOptions
from asperity.settings.model import SettingsError
from asperity.stress.planes.planes import StressPlane, stress_planes
from asperity.study.cost.model import job_cost, time_factor
from asperity.surface.description import describe_map
from asperity.surface.reading.height_map import MapError
from asperity.surface.reading.map_file import open_map
from asperity.surface.roughness import spectrum
from asperity.views.maps import PIXELS, blocks, largest_magnitude
from asperity.views.source import sources

PLANE_TOLERANCE = 1e-3
"""Error of a plane that is only looked at, relative to the rms of σ_zz in it."""

MOST_KEPT = 2**30
"""Bytes of planes that are kept for the depth slider."""

BINS, POINTS, ROWS = 60, 400, 160
"""Bins of a histogram, points of a profile, rows of a section."""

TREATMENT = ("despike", "detrend", "periodic", "scan_lines", "points", "wavelength_short")
"""Settings of a map on which its description does not depend."""

PLAIN = ("poisson", "conductivity", "resistivity")
"""Constants of a material that are numbers without a unit in a case."""

Edges = tuple[float, float]
Ends = tuple[float, float, float, float]

FADED = 0.05
"""A section ends where the stress is below this share of its largest value."""


def picture(values: Array, grid: Grid, edges: Edges, reduce: Callable[..., Array]) -> dict[str, Any]:
    """A field on the map as the page draws it: at most `PIXELS` values along an edge, and its frame in m."""
    rows, columns = (
        min(count, round(edge / step))
        for edge, step, count in zip(edges, grid.spacing, values.shape, strict=True)
    )
    values = values[:rows, :columns]
    size = [max(1, -(-count // PIXELS)) for count in values.shape]
    shown = blocks(values, size, reduce).astype(np.float32)
    first = [float(axis[0]) - step / 2 for axis, step in zip(grid.coordinates(), grid.spacing, strict=True)]
    height, width = (
        count * block * step for count, block, step in zip(shown.shape, size, grid.spacing, strict=True)
    )
    return {"values": shown, "x": first[1], "y": first[0], "dw": width, "dh": height}


def along(shown: Mapping[str, Any], ends: Ends) -> tuple[Array, Array]:
    """Distances in m and values along a line between two places (x, y, x, y) of a picture."""
    from scipy.ndimage import map_coordinates

    x, y = np.linspace(ends[0], ends[2], POINTS), np.linspace(ends[1], ends[3], POINTS)
    rows, columns = shown["values"].shape
    at = [(y - shown["y"]) / shown["dh"] * rows - 0.5, (x - shown["x"]) / shown["dw"] * columns - 0.5]
    values = map_coordinates(shown["values"], at, order=1, mode="nearest")
    return np.hypot(x - x[0], y - y[0]), values


class MapJob:
    """Checks a case as ``asperity run --check`` does, and describes its map as ``asperity info`` does."""

    def __init__(self, reply: Callable[[str, Any], None]) -> None:
        self._reply = reply
        self._described: tuple[str, dict[str, str]] = ("", {})
        self._shown: dict[str, Any] = {}
        self._time_factor: float | None = None

    def work_ahead(self) -> bool:
        """Nothing is done ahead."""
        return False

    def check(self, content: Mapping[str, Any], number: int) -> dict[str, Any]:
        """Problems of a case, its map as it is pressed, and what follows from both before a computation."""
        found: dict[str, Any] = {"number": number, "problems": [], "doubts": [], "info": {}}
        given = dict(content)
        maps = given.get("map", {}).get("file")
        if isinstance(maps, list):  # of a sample the first map is shown
            given["map"] = {**given["map"], "file": maps[0]}
        case, surface = None, None
        try:
            case = Case.read(given)
            surface = case.map
        except SettingsError as error:
            found["problems"] += error.found
            with suppress(SettingsError):
                surface = Map.read(given.get("map", {}))
        if case is not None:
            found |= self._of_case(case)
        if surface is not None:
            self._of_map(surface, case, found)
        found["problems"] = [*dict.fromkeys((each[0], each[1]) for each in found["problems"])]
        return found

    def _of_map(self, options: Map, case: Case | None, found: dict[str, Any]) -> None:
        """Add the description of a map, its heights, and problems of the case on it."""
        if not os.path.exists(options.file):
            found["problems"].append(("map.file", f" = {options.file}: no such file"))
            return
        try:
            rough = read_face(options, None if case is None else case.counter_map)
            face = rough.face
            found |= self._of_heights(-face.height, face.grid, face.grid.length, found["number"])
            found |= {"doubts": rough.doubts, "done": face.done, "map_length": face.grid.length}
            wavenumber, power = spectrum(face.height, face.grid.length)
            found["spectrum"] = 2 * np.pi / wavenumber[power > 0], power[power > 0]
            if case is not None:
                found["problems"] += problems_on_map(case.replaced(map=rough.options or case.map), rough)
                found["cost"] = self._cost(case, face.height.size)
        except SettingsError as error:
            found["problems"] += error.found
        except (InputError, ValueError, OSError) as error:
            if isinstance(error, MapError):
                error = error.renamed(lambda name: f"map.{name}")
            found["problems"] += map(_split, getattr(error, "lines", None) or [str(error)])
            with suppress(InputError, ValueError, OSError):  # the heights as they are in the file
                surface = open_map(options.file, options).map
                height, grid = np.nan_to_num(surface.height), Grid(surface.height.shape, surface.length)
                found |= self._of_heights(height, grid, surface.length, found["number"])
        with suppress(InputError, ValueError, OSError):  # reported above
            own = {name: getattr(options, name) for name in options.model_fields_set - {"file"}}
            reading = {name: text for name, text in own.items() if name not in TREATMENT}
            key = repr((options.file, os.stat(options.file).st_mtime_ns, sorted(reading.items())))
            if self._described[0] != key:  # takes half of the time of a check
                self._described = key, describe_map(options.file, MapOptions(**own)).properties
            found["info"] = self._described[1]

    def _of_heights(self, height: Array, grid: Grid, edges: Edges, number: int) -> dict[str, Any]:
        """Heights with peaks upward and their distribution, which are sent ahead."""
        counts, steps = np.histogram(height, BINS)
        self._shown = picture(height, grid, edges, np.mean)
        density = counts / max(counts.sum(), 1) / np.diff(steps)
        heights = {"number": number, "picture": self._shown, "histogram": (density, steps)}
        self._reply("heights", heights)
        return heights

    def _of_case(self, case: Case) -> dict[str, Any]:
        """Constants of the bodies that are from the table, and the smooth Hertz contact."""
        constants = {}
        for name, body in case.groups_of_bodies.items():
            for each in body.of_table:
                value = getattr(body, each)
                constants[f"{name}.{each}"] = f"{value:g}" if each in PLAIN else shown_si(value, "Pa")
        found: dict[str, Any] = {"constants": constants}
        if (contact := case.hertz_contact) is not None and isinstance(case.load, Hertz):
            shear, depth = contact.largest_shear(case.body.poisson)
            half_widths = {"x": contact.half_width_x, "y": contact.half_width_y}
            found["hertz"] = half_widths | {"shear": shear, "depth": depth, "at": case.load.at}
            found["hertz"]["pressure"] = contact.largest_pressure
        return found

    def _cost(self, case: Case, nodes: int) -> tuple[float, float]:
        """Seconds of processor time and bytes, by the cost model of the study; most questions take more."""
        if self._time_factor is None:
            self._time_factor = time_factor()
        loads = 1 if case.load_curve is None else 1 + len(case.load_curve.loads)
        contact, stress = job_cost("contact", nodes), job_cost("stress", nodes)
        seconds = contact.seconds * loads + stress.seconds * len(case.different_bodies)
        return self._time_factor * seconds, max(contact.memory, stress.memory)

    def profile(self, ends: Ends) -> dict[str, Any]:
        """Heights along a line on the map."""
        distance, values = along(self._shown, ends)
        return {"distance": distance, "values": values}


def _split(text: str) -> tuple[str, str]:
    """Dotted key and the rest of a message that names a setting of the map; else the key of its file."""
    found = re.search(r"\bmap\.([a-z_]+)", text)
    if found is None or found[1] not in Map.model_fields:
        return "map.file", f": {text}"
    return found[0], text[found.end() :]


class AnswerJob:
    """Computes an answer into a folder, and shows the answer that a folder holds.

    Planes are computed for the depths of the answer, ahead of the slider that asks for them.
    """

    def __init__(self, reply: Callable[[str, Any], None]) -> None:
        self._reply = reply
        self._planes: dict[tuple[str, str, float], dict[str, Any]] = {}
        self._streams: dict[tuple[str, str], Iterator[StressPlane]] = {}
        self._bodies: dict[str, LoadedSolid] = {}
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
            rough = read_face(case.map, case.counter_map, shared=is_sample)
            cases[name] = case.replaced(map=rough.options), rough
        if is_sample:
            check_alike({name: rough.face for name, (_, rough) in cases.items()})
        for number, (name, (case, rough)) in enumerate(cases.items()):

            def report(done: float, total: float, before: int = number) -> None:
                self._reply("progress", 0.95 * (before + done / total) / len(contents))

            write_answer(answer_of(case, rough, report), Path(folder, name) if is_sample else folder)
        if not is_sample:
            return self.open(folder)
        read = [(case, rough.files) for case, rough in cases.values()]
        means = write_sample(read_sample(Path(folder), list(cases), read[0][0]), Path(folder), read)
        return self.open(os.path.join(folder, next(iter(cases)))) | {"sample": str(means)}

    def open(self, folder: str) -> dict[str, Any]:
        """What the page shows of an answer before a plane is asked for."""
        self.folder = Path(folder)
        if CASE_FILE not in names_in(self.folder):
            raise InputError(str(self.folder), ["the folder of an answer of asperity run is needed"])
        content = load_case(self.folder / CASE_FILE)
        content.pop(OUT, None)
        content.pop(CHECKSUMS, None)
        self._case = Case.read(content)
        self._contact = xr.load_dataset(self.folder / "contact.nc")
        rows = pd.read_csv(self.folder / "answer.csv")
        report = (self.folder / "report.html").read_text(encoding="utf-8")
        pressure, gap = (
            picture(self._contact[name].values, self._grid, self._grid.length, np.fmax.reduce)
            for name in ("pressure", "gap")
        )
        advice = re.findall(r'<div class="advice (\w+)"><b>(.*?)</b>(.*?)</div>', report, re.DOTALL)
        return {
            "title": html.unescape(" ".join(re.findall(r"<h1>(.*?)</h1>", report, re.DOTALL)[:1])),
            "case": html.unescape(" ".join(re.findall(r'<p class="case">(.*?)</p>', report, re.DOTALL)[:1])),
            "rows": rows.assign(of_limit=rows["name"].isin(LIMITS)).to_dict("records"),
            "verdicts": list(
                map(html.unescape, re.findall(r'<p class="verdict">(.*?)</p>', report, re.DOTALL))
            ),
            "advice": [tuple(map(html.unescape, each)) for each in advice],
            "pressure": pressure,
            "gap": gap,
            "bodies": list(self._case.different_bodies),
            "fields": list(self._case.fields),
            "depths": {body: self._depths(body) for body in self._case.different_bodies},
            "yield": {name: body.yield_stress for name, body in self._case.bodies.items()},
            "peaks": pd.read_csv(self.folder / "peaks.csv").to_dict("list"),
        }

    @cached_property
    def _grid(self) -> Grid:
        return grid_of(self._contact)

    def _depths(self, body: str) -> list[float]:
        suffix = f"_{body}" if len(self._case.different_bodies) > 1 else ""
        with xr.open_dataset(self.folder / f"stress{suffix}.nc") as stress:
            depths = stress["plane_depth"].values
        return depths[depths <= max(self._grid.length)].tolist()

    def _loaded(self, body: str) -> LoadedSolid:
        """A body under the pressure of the answer, with what film and Hertz contact add."""
        (source,) = sources(self._contact)
        contact: Any = SimpleNamespace(
            in_body=lambda name: source.loaded(name)[0], mean_pressure=float(self._contact["mean_pressure"])
        )
        if (film := self._case.film) is not None:
            answer: Any = SimpleNamespace(case=self._case)
            if (loaded := film.loaded(answer, contact, body)) is not None:
                return loaded
        return self._case.loaded_body(contact, body)

    def _stream(self, body: str, field: str, depths: list[float]) -> Iterator[StressPlane]:
        sliding = self._case.sliding_of(body)
        if body not in self._bodies:
            self._bodies[body] = self._loaded(body)
        return stress_planes(self._bodies[body], depths, None, (field,), PLANE_TOLERANCE, **sliding)

    def _keep(self, body: str, field: str, plane: StressPlane) -> dict[str, Any]:
        shown = picture(plane.fields[field][0], plane.grid, self._grid.length, largest_magnitude)
        self._planes[body, field, plane.depth] = shown
        return shown

    def work_ahead(self) -> bool:
        """Compute the next plane of the field that is looked at; False if there is none left."""
        if self._wanted is None or sum(each["values"].nbytes for each in self._planes.values()) > MOST_KEPT:
            return False
        if self._wanted not in self._streams:
            body, field = self._wanted
            self._streams[self._wanted] = self._stream(body, field, self._depths(body))
        plane = next(self._streams[self._wanted], None)
        if plane is None:
            return False
        self._keep(*self._wanted, plane)
        return True

    def plane(self, body: str, field: str, depth: float) -> dict[str, Any]:
        """A field of the stress in a plane."""
        self._wanted = body, field
        shown = self._planes.get((body, field, depth))
        if shown is None:
            shown = self._keep(body, field, next(self._stream(body, field, [depth])))
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
        section = np.array([np.interp(even, depths, column) for column in values.T]).T
        frame = {"x": 0.0, "y": 0.0, "dw": float(distance[-1]), "dh": bottom}
        return {"picture": {"values": section.astype(np.float32), **frame}}
