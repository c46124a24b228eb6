"""Values of pictures, and of planes for a depth slider, as data of a page."""

from __future__ import annotations

import base64
import json
import re
import zlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.core.types import Array
from asperity.core.units import shown_si

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from asperity.engineering.answer import Answer
    from asperity.fourier.grid import Grid
    from asperity.stress.planes.stream import LinearPlane

POINTS = 160
"""Most values along an edge of a panel: with two bytes each, at most 70 kB in base64."""

LEVELS = 4000
"""Steps between the smallest and the largest value of a panel."""

MOST_POINTS = 1000
"""Most points of lines with markers in a panel; the points with the largest x are kept."""

MISSING = 65535
"""Number of a missing value."""


def values_of(figure: Figure) -> list[dict[str, Any]]:
    """Values of the panels of a figure that was drawn, and the points of their lines with markers.

    Returns
    -------
    list of dict
        ``box``: left, top, right, bottom of the values in the figure, whose edges are 1 long; ``x``, ``y``:
        positions there; ``labels`` of x, y and the values; and `packed` values from the top down, or
        ``points``: place in the figure, and position, of each point.
    """
    bars = [axis for axis in figure.axes if axis.get_label() == "colour bar"]
    label = "".join(axis.get_xlabel() or axis.get_ylabel() for axis in bars[:1])
    found = []
    for axis in figure.axes:
        labels = axis.get_xlabel(), axis.get_ylabel(), label
        if bars and axis is not bars[0] and (shown := _field(axis)) is not None:
            values, x, y = shown
            box = _in_figure(axis, np.array([[x[0], y[0]], [x[1], y[1]]])).ravel().tolist()
            found.append({"box": box, "x": x, "y": y, "labels": labels, **packed(values)})
        elif not bars:
            marked = [line for line in axis.lines if line.get_marker() not in ("", "None", None)]
            lines = [np.asarray(line.get_xydata()) for line in marked]
            points = [np.hstack([_in_figure(axis, line), line]) for line in lines]
            rows = np.vstack([np.empty((0, 4)), *points])
            rows = rows[np.isfinite(rows).all(axis=1)]
            rows = rows[np.argsort(-rows[:, 2])][:MOST_POINTS]
            if rows.size:
                found.append({"points": [[float(f"{n:.4g}") for n in row] for row in rows], "labels": labels})
    return found


def packed(values: Array) -> dict[str, Any]:
    """Values [y, x] in steps of their range, as text: low bytes, then high bytes, by zlib in base64."""
    known = np.isfinite(values)
    low, high = (float(end) for end in (values[known].min(), values[known].max())) if known.any() else (0, 0)
    step = (high - low) / LEVELS
    steps = np.where(known, np.round((np.where(known, values, low) - low) / (step or 1.0)), MISSING)
    raw = np.ascontiguousarray(steps.astype("<u2")).view(np.uint8).reshape(-1, 2).T.tobytes()
    data = base64.b64encode(zlib.compress(raw, 9)).decode()
    return {"shape": list(values.shape), "low": low, "step": step, "data": data}


def spaced(count: int, most: int = POINTS) -> Array:
    """Indices of at most so many of `count` nodes, each in the middle of an equal part of the edge."""
    shown = min(count, most)
    return ((np.arange(shown) + 0.5) * count / shown).astype(int)


def _field(axis: Axes) -> tuple[Array, list[float], list[float]] | None:
    """Values of a panel from the top down, and the positions of its left and right, top and bottom edge."""
    for image in axis.images:
        left, right, bottom, top = map(float, image.get_extent())
        pixels = np.ma.filled(np.ma.asarray(image.get_array()).astype(float), np.nan)
        rows, columns = map(spaced, pixels.shape)
        return pixels[rows[::-1, None], columns], [left, right], [top, bottom]
    for mesh in axis.collections:
        if hasattr(mesh, "get_coordinates"):  # a section, whose planes are not at equal distances
            places = np.asarray(mesh.get_coordinates())
            along, depth = places[0, :, 0], places[:, 0, 1]
            values = np.asarray(mesh.get_array()).reshape(depth.size, along.size)
            evenly = (np.arange(POINTS) + 0.5) / POINTS * np.ptp(depth) + depth[0]
            place = np.interp(evenly, depth, np.arange(depth.size))
            above = np.minimum(place.astype(int), depth.size - 2)
            below = (place - above)[:, None]
            shown = (values[above] * (1 - below) + values[above + 1] * below)[:, spaced(along.size)]
            return shown, [float(along[0]), float(along[-1])], [float(depth[0]), float(depth[-1])]
    return None


def _in_figure(axis: Axes, places: Array) -> Array:
    """Positions (x, y) in a panel as shares of the figure from its left and upper edge."""
    shares = axis.figure.transFigure.inverted().transform(axis.transData.transform(places))
    return np.column_stack([shares[:, 0], 1 - shares[:, 1]])


COLOURS = 17
"""Colours of the scale of the slider, between which the page interpolates."""

SLIDER_POINTS = 128
"""Most values along an edge of a plane of the slider."""

PLANES = 7
"""Planes of the slider, besides the plane with the largest magnitude."""

FADED = 0.1
"""The slider ends where the stress is below this share of its largest magnitude."""


class DepthPlanes:
    """Values of one field on the map, at few nodes of each plane of a stream.

    Parameters
    ----------
    grid : Grid
        Of the contact.
    field : str
    poisson : float
    """

    def __init__(self, grid: Grid, field: str, poisson: float) -> None:
        self._field, self._poisson = field, poisson
        self._places = [
            spaced(count, SLIDER_POINTS) * step for count, step in zip(grid.shape, grid.spacing, strict=True)
        ]
        self._found: list[tuple[float, Array]] = []

    def add(self, plane: LinearPlane) -> None:
        """Keep values of the next plane, each of the nearest of its nodes."""
        each = zip(self._places, plane.first_node, plane.grid.spacing, plane.grid.shape, strict=True)
        rows, columns = (
            np.clip(np.round((places - first) / step).astype(int), 0, count - 1)
            for places, first, step, count in each
        )
        nodes = rows[:, None] * plane.grid.shape[1] + columns
        values = plane.field_at(self._field, self._poisson, nodes.ravel()).reshape(nodes.shape)
        self._found.append((plane.depth, values.astype(np.float32)))

    def chosen(self) -> list[tuple[float, Array]]:
        """Depth and values of few planes from the surface down to where the stress has faded."""
        sizes = np.array([np.abs(values).max() for _, values in self._found])
        last = int(np.flatnonzero(sizes >= FADED * sizes.max())[-1])
        evenly = np.linspace(0, last, PLANES).round().astype(int).tolist()
        return [self._found[number] for number in sorted({*evenly, int(sizes.argmax())})]


_NAMED = re.compile(r'<script type="application/json" data-name="(\w+)">(.*?)</script>')


def values_in(report: str) -> dict[str, Any]:
    """Values in a report: name of a picture → its panels, and ``depths`` → the planes of the slider."""
    found = _NAMED.findall(report)
    return {name: json.loads(text) for name, text in reversed(found)}  # of several bodies the first


def in_one_scale(sliders: Mapping[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Sliders with the ends of all of them, as far as they have the same unit."""
    units: dict[str, list[float]] = {}
    for each in sliders.values():
        units.setdefault(each["labels"][2], []).extend(each["ends"])
    ends = {unit: [min(values), max(values)] for unit, values in units.items()}
    return {name: {**each, "ends": ends[each["labels"][2]]} for name, each in sliders.items()}


def slider_of(answer: Answer, body: str) -> dict[str, Any]:
    """Planes of the first field to be drawn in a body, for the depth slider of a page."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    from asperity.results.variables import SI_UNITS
    from asperity.views.scales import measure
    from asperity.views.stress_plot import field_look, field_words

    field, part, length = answer.case.fields[0], answer.bodies[body], answer.face.grid.length
    look = field_look(field)
    limits = look.limits(values for _, values in part.depth_planes)
    unit, edge = measure([limits.low, limits.high], "stress", SI_UNITS), measure(length, "length", SI_UNITS)
    colours = colormaps[look.colours](np.linspace(0, 1, COLOURS))
    return {
        "planes": [packed(values[::-1] / unit.factor) for _, values in part.depth_planes],
        "depths": [shown_si(depth, "m", 3) for depth, _ in part.depth_planes],
        "ends": [limits.low / unit.factor, limits.high / unit.factor],
        "colours": [to_hex(colour) for colour in colours],
        "name": field_words(field),
        "x": [0, length[1] / edge.factor],
        "y": [length[0] / edge.factor, 0],
        "labels": [edge.label("x"), edge.label("y"), unit.label(field_words(field))],
    }
