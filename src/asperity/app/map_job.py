"""Requests about a map and a case, answered as by ``asperity run --check`` and ``asperity info``."""

import math
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
import xarray as xr
from scipy.ndimage import map_coordinates

from asperity.app.form import EXAMPLE, contents_of
from asperity.core.errors import InputError
from asperity.core.types import Array
from asperity.core.units import shown_si
from asperity.engineering.case import Case
from asperity.engineering.face import RoughFace, processes_on, read_face
from asperity.engineering.jobs import SMALL, Job, arranged
from asperity.engineering.sample import doubt_of_one_surface
from asperity.engineering.stages import BESIDE, FILES, FREE, work_of
from asperity.fourier.grid import Grid
from asperity.settings.load import Hertz
from asperity.settings.map import CounterMap, Map, MapOptions
from asperity.surface.description import describe_map
from asperity.surface.reading.map_file import open_map
from asperity.surface.roughness import spectrum
from asperity.surface.treatment.treatment import Doubt
from asperity.views.scales import blocks

PIXELS = 1024
"""Most values along an edge of a picture; of a finer grid a value stands for a block of nodes."""

BINS, POINTS = 60, 400
"""Bins of a histogram, and points of a profile."""

TREATMENT = ("despike", "detrend", "periodic", "scan_lines", "points", "wavelength_short")
"""Settings of a map on which its description does not depend."""

PLAIN = ("poisson", "conductivity", "resistivity")
"""Constants of a material that are numbers without a unit in a case."""

Ends = tuple[float, float, float, float]
"""Places x, y, x, y of the ends of a line, in m."""


def picture(values: Array, grid: Grid, reduce: Callable[..., Array]) -> dict[str, Any]:
    """A field on the map as the page draws it: at most `PIXELS` values along an edge, and its frame in m."""
    size = [-(-count // PIXELS) for count in values.shape]
    if max(size) > 1:
        values = blocks(values, size, reduce)
    y, x = (float(axis[0]) - step / 2 for axis, step in zip(grid.coordinates(), grid.spacing, strict=True))
    edges = zip(values.shape, size, grid.spacing, strict=True)
    height, width = (count * block * step for count, block, step in edges)
    return {"values": values.astype(np.float32), "x": x, "y": y, "dw": width, "dh": height}


def along(shown: Mapping[str, Any], ends: Ends) -> tuple[Array, Array]:
    """Distances in m and values along the part of a line (x, y, x, y) that lies on a picture."""
    first, last = 0.0, 1.0
    rows, columns = shown["values"].shape
    halves = shown["dw"] / columns / 2, shown["dh"] / rows / 2
    for start, end, edge, width, half in zip(
        ends[:2], ends[2:], (shown["x"], shown["y"]), (shown["dw"], shown["dh"]), halves, strict=True
    ):
        if start == end and -half <= start - edge <= width + half:  # planes have pixels of several sizes
            continue
        step = (end - start) or 1e-300
        near, far = sorted(((edge - start) / step, (edge + width - start) / step))
        first, last = max(first, near), min(last, far)
    if not first < last or ends[:2] == ends[2:]:
        raise InputError("line", ["x, y, x, y of two places are needed between which it crosses the map"])
    at_line = np.linspace(first, last, POINTS)
    x, y = (start + at_line * (end - start) for start, end in zip(ends[:2], ends[2:], strict=True))
    place = [(y - shown["y"]) / shown["dh"] * rows - 0.5, (x - shown["x"]) / shown["dw"] * columns - 0.5]
    values = map_coordinates(shown["values"], place, order=1, mode="nearest")
    return np.hypot(x - x[0], y - y[0]), values


class MapJob:
    """Checks a case as ``asperity run --check`` does, and describes its map as ``asperity info`` does."""

    def __init__(self, reply: Callable[[str, Any], None]) -> None:
        self._reply = reply
        self._described: tuple[str, dict[str, str]] = ("", {})
        self._known: dict[str, RoughFace] = {}
        self._faces: dict[str, RoughFace] = {}
        self._drawn: Any = None
        self._shown: dict[str, Any] = {}
        self._is_warm = False

    def work_ahead(self) -> bool:
        """Check a small case before anything is asked for: what that imports takes half a second."""
        if not self._is_warm:
            self._is_warm = True
            xr.Dataset(coords={"x": [0.0]})  # an index of xarray imports pint
            with suppress(Exception):  # the first map says what is wrong
                MapJob(lambda *_: None).check({"map": {"file": EXAMPLE}}, "", 0)
        return False

    def check(self, content: Mapping[str, Any], out: str, number: int) -> dict[str, Any]:
        """Problems of a case, constants and description of its map; heights are sent ahead.

        Of a sample the first map is described and drawn.
        """
        self._known, self._faces = self._faces, {}
        found: dict[str, Any] = {"number": number, "problems": [], "doubts": [], "info": {}}
        for small in (SMALL, math.inf):  # problems of the settings before a large map is read
            contents = contents_of({"map": {}, **content})
            arrangement = arranged(contents, out, pooled="sample" in content, read=self._read, small=small)
            first, jobs = arrangement.jobs[0], arrangement.jobs
            problems = [*(each for job in jobs for each in job.problems), *arrangement.problems]
            found["problems"] = [*dict.fromkeys(map(tuple, problems))]
            if first.case is not None or first.rough is not None:
                break
            self._reply("check", found)
        if first.rough is not None:
            face = first.rough.face
            if self._drawn is not first.rough:
                self._show(-face.height, face.grid, number)
                self._drawn = first.rough
            wavenumber, power = spectrum(face.height, face.grid.length)
            found["spectrum"] = 2 * np.pi / wavenumber[power > 0], power[power > 0]
            doubts = list(first.rough.doubts)
            heights = {job.name: float(job.rough.face.height.std()) for job in jobs if job.rough}
            if arrangement.pooled and (doubt := doubt_of_one_surface(heights)):
                doubts.append(Doubt("file", doubt))
            found |= {"doubts": doubts, "done": face.done, "map_length": face.grid.length}
        with suppress(InputError, ValueError, OSError):  # reported above
            options = Map.read(first.content["map"])
            found["info"] = self._description(options)
            if first.rough is None:  # the heights as they are in the file
                surface = open_map(options.file, options).map
                self._show(np.nan_to_num(surface.height), Grid(surface.height.shape, surface.length), number)
        if first.case is not None:
            found |= _of_case(first.case)
        if not problems:
            found["cost"] = cost_of(jobs)
        return found

    def _description(self, options: Map) -> dict[str, str]:
        """Properties of a map, described again only after a change."""
        own = {name: getattr(options, name) for name in options.model_fields_set - {"file"}}
        reading = {name: text for name, text in own.items() if name not in TREATMENT}
        key = repr((options.file, os.stat(options.file).st_mtime_ns, sorted(reading.items())))
        if self._described[0] != key:
            self._described = key, describe_map(options.file, MapOptions(**own)).properties
        return self._described[1]

    def _read(self, options: Map, counter: CounterMap | None, shared: bool, _: Any) -> RoughFace:
        """The face that is pressed, read again only after a change."""
        times = [os.stat(each.file).st_mtime_ns for each in (options, counter) if each is not None]
        key = repr((options, counter, shared, times))
        self._faces[key] = self._known.get(key) or read_face(options, counter, shared)
        return self._faces[key]

    def _show(self, height: Array, grid: Grid, number: int) -> None:
        """Send heights with peaks upward, and their distribution."""
        self._drawn, self._shown = None, picture(height, grid, np.mean)
        density, steps = np.histogram(height, BINS, density=True)
        self._reply("heights", {"number": number, "picture": self._shown, "histogram": (density, steps)})

    def profile(self, ends: Ends) -> tuple[Array, Array]:
        """Distances in m and heights along a line on the map."""
        return along(self._shown, ends)


def _of_case(case: Case) -> dict[str, Any]:
    """Constants of the bodies that are from the table, and the smooth Hertz contact."""
    constants = {}
    for name, body in case.groups_of_bodies.items():
        if body.material is not None:
            constants[f"{name}.material"] = body.materials[0].state
        for each in body.from_material:
            value = getattr(body, each)
            constants[f"{name}.{each}"] = f"{value:g}" if each in PLAIN else shown_si(value, "Pa")
    found: dict[str, Any] = {"constants": constants}
    if (contact := case.hertz_contact) is not None and isinstance(case.load, Hertz):
        shear, depth = contact.maximum_shear(case.body.poisson)
        half_widths = {"x": contact.half_width_x, "y": contact.half_width_y}
        found["hertz"] = half_widths | {"shear": shear, "depth": depth, "at": case.load.at}
        found["hertz"]["pressure"] = contact.maximum_pressure
    return found


def cost_of(jobs: Sequence[Job]) -> tuple[str, float]:
    """Time and processors in words, and memory of the largest job in bytes."""
    from asperity.study.cost.model import START_SECONDS, answer_seconds, minutes, time_factor

    faces = [job.rough.face for job in jobs if job.rough]
    sizes, processes = [face.height.size for face in faces], processes_on(faces, len(jobs))
    cores = os.cpu_count() or 1
    beside = max(cores // processes, 1)

    files = FILES * (FREE if jobs[0].case.map.free_edges else 1.0)

    def works(cores: int) -> list[float]:
        pairs = zip(jobs, faces, strict=True)
        return [
            files + sum(work_of(job.case, bool(face.grid.mirrored), cores).values()) for job, face in pairs
        ]

    divided = works(processes_on(faces, beside, beside))
    rounds = len(jobs) / processes * (BESIDE if processes > 1 else 1.0)
    seconds = START_SECONDS + rounds * float(np.mean([*map(answer_seconds, divided, sizes)]))
    seconds += answer_seconds(files, max(sizes)) if len(jobs) > 1 else 0.0  # the sample, or the comparison
    words = f"on {cores} processors" if processes > 1 or divided < works(1) else "of one processor"
    return f"{minutes(time_factor() * seconds)} {words}", max(job.memory for job in jobs)
