"""Requests about a map and a case, answered as by ``asperity run --check`` and ``asperity info``."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from asperity.core.errors import InputError
from asperity.core.types import Array
from asperity.core.units import shown_si
from asperity.engineering.case import Case
from asperity.engineering.case_file import MAP_FILES, at, case_of_map
from asperity.engineering.face import RoughFace, read_face
from asperity.fourier.grid import Grid
from asperity.settings.load import Hertz
from asperity.settings.map import CounterMap, Map, MapOptions
from asperity.settings.model import SettingsError
from asperity.surface.description import describe_map
from asperity.surface.reading.height_map import MapError
from asperity.surface.reading.map_file import open_map
from asperity.surface.roughness import spectrum

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
        from asperity.views.maps import blocks

        values = blocks(values, size, reduce)
    y, x = (float(axis[0]) - step / 2 for axis, step in zip(grid.coordinates(), grid.spacing, strict=True))
    edges = zip(values.shape, size, grid.spacing, strict=True)
    height, width = (count * block * step for count, block, step in edges)
    return {"values": values.astype(np.float32), "x": x, "y": y, "dw": width, "dh": height}


def along(shown: Mapping[str, Any], ends: Ends) -> tuple[Array, Array]:
    """Distances in m and values along a line between two places (x, y, x, y) of a picture."""
    from scipy.ndimage import map_coordinates

    x, y = np.linspace(ends[0], ends[2], POINTS), np.linspace(ends[1], ends[3], POINTS)
    rows, columns = shown["values"].shape
    place = [(y - shown["y"]) / shown["dh"] * rows - 0.5, (x - shown["x"]) / shown["dw"] * columns - 0.5]
    values = map_coordinates(shown["values"], place, order=1, mode="nearest")
    return np.hypot(x - x[0], y - y[0]), values


class MapJob:
    """Checks a case as ``asperity run --check`` does, and describes its map as ``asperity info`` does."""

    def __init__(self, reply: Callable[[str, Any], None]) -> None:
        self._reply = reply
        self._described: tuple[str, dict[str, str]] = ("", {})
        self._face: tuple[Any, RoughFace | None] = (None, None)
        self._shown: dict[str, Any] = {}

    def work_ahead(self) -> bool:
        return False

    def check(self, content: Mapping[str, Any], number: int) -> dict[str, Any]:
        """Problems of a case, constants and description of its map; heights are sent ahead."""
        found: dict[str, Any] = {"number": number, "problems": [], "doubts": [], "info": {}}
        content = case_of_map(content, 0)  # of a sample the first map is shown
        rough = self._of_map(content, found)
        try:
            case = Case.read(content)
        except SettingsError as error:
            found["problems"] += error.found
        else:
            found |= self._of_case(case)
            if rough is not None:
                from asperity.engineering.run import problems_on_map, work_of
                from asperity.study.cost.model import answer_cost, minutes, time_factor

                case, face = case.on_face(rough), rough.face
                found["problems"] += problems_on_map(case, rough)
                work = sum(work_of(case, face.grid.mirrored).values())
                cost = answer_cost(work, face.height.size, face.boundary)
                seconds = cost.fixed_seconds + time_factor() * cost.calculation_seconds
                found["cost"] = minutes(seconds), cost.memory
        found["problems"] = [*dict.fromkeys((each[0], each[1]) for each in found["problems"])]
        return found

    def _of_map(self, content: Mapping[str, Any], found: dict[str, Any]) -> RoughFace | None:
        """Add the description of a map, and its problems; the face that is pressed."""
        counter = at(content, MAP_FILES[1][:-1])
        try:
            options = Map.read(content.get("map", {}))
            counter = None if counter is None else CounterMap.read(counter)
        except SettingsError:  # said of the whole case
            return None
        if not os.path.exists(options.file):
            found["problems"].append(("map.file", f" = {options.file}: no such file"))
            return None
        rough = None
        try:
            rough = self._read(options, counter, found["number"])
            wavenumber, power = spectrum(rough.face.height, rough.face.grid.length)
            found["spectrum"] = 2 * np.pi / wavenumber[power > 0], power[power > 0]
            found |= {"doubts": rough.doubts, "done": rough.face.done}
            found["map_length"] = rough.face.grid.length
        except SettingsError as error:
            found["problems"] += error.found
        except (InputError, ValueError, OSError) as error:
            if isinstance(error, MapError):
                error = error.renamed(lambda name: f"map.{name}")
            found["problems"] += map(_split, getattr(error, "lines", None) or [str(error)])
            with suppress(InputError, ValueError, OSError):  # the heights as they are in the file
                surface = open_map(options.file, options).map
                grid = Grid(surface.height.shape, surface.length)
                self._show(np.nan_to_num(surface.height), grid, found["number"])
        with suppress(InputError, ValueError, OSError):  # reported above
            own = {name: getattr(options, name) for name in options.model_fields_set - {"file"}}
            reading = {name: text for name, text in own.items() if name not in TREATMENT}
            key = repr((options.file, os.stat(options.file).st_mtime_ns, sorted(reading.items())))
            if self._described[0] != key:
                self._described = key, describe_map(options.file, MapOptions(**own)).properties
            found["info"] = self._described[1]
        return rough

    def _read(self, options: Map, counter: CounterMap | None, number: int) -> RoughFace:
        """The face that is pressed, read and shown again only after a change."""
        files = [each.file for each in (options, counter) if each is not None and os.path.exists(each.file)]
        key = options, counter, [os.stat(each).st_mtime_ns for each in files]
        known, rough = self._face
        if rough is None or known != key:
            rough = read_face(options, counter)
            self._show(-rough.face.height, rough.face.grid, number)
            self._face = key, rough
        return rough

    def _show(self, height: Array, grid: Grid, number: int) -> None:
        """Send heights with peaks upward, and their distribution."""
        self._face = None, None
        self._shown = picture(height, grid, np.mean)
        density, steps = np.histogram(height, BINS, density=True)
        self._reply("heights", {"number": number, "picture": self._shown, "histogram": (density, steps)})

    def _of_case(self, case: Case) -> dict[str, Any]:
        """Constants of the bodies that are from the table, and the smooth Hertz contact."""
        constants = {}
        for name, body in case.groups_of_bodies.items():
            for each in body.from_material:
                value = getattr(body, each)
                constants[f"{name}.{each}"] = f"{value:g}" if each in PLAIN else shown_si(value, "Pa")
        found: dict[str, Any] = {"constants": constants}
        if (contact := case.hertz_contact) is not None and isinstance(case.load, Hertz):
            shear, depth = contact.largest_shear(case.body.poisson)
            half_widths = {"x": contact.half_width_x, "y": contact.half_width_y}
            found["hertz"] = half_widths | {"shear": shear, "depth": depth, "at": case.load.at}
            found["hertz"]["pressure"] = contact.largest_pressure
        return found

    def profile(self, ends: Ends) -> tuple[Array, Array]:
        """Distances in m and heights along a line on the map."""
        return along(self._shown, ends)


def _split(text: str) -> tuple[str, str]:
    """Dotted key and the rest of a message that names a setting of the map; else the key of its file."""
    found = re.search(r"\bmap\.([a-z_]+)", text)
    if found is None or found[1] not in Map.model_fields:
        return "map.file", f": {text}"
    return found[0], text[found.end() :]
