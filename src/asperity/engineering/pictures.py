"""Pictures of an answer: overviews of the map, and the place of the largest stress close to it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray as xr

from asperity.core.types import Array
from asperity.core.units import shown_si
from asperity.engineering.answer import Answer, body_title
from asperity.engineering.close_up import CloseUp
from asperity.fourier.grid import Grid
from asperity.results.variables import SI_UNITS
from asperity.views.maps import HEIGHT, PRESSURE, Look, Map, draw_maps
from asperity.views.peak_plot import plot_peaks
from asperity.views.section_plot import draw_sections
from asperity.views.source import Part, Source, sources
from asperity.views.stress_field import POSITIVE, field_look, field_words
from asperity.views.style import plain_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


MAPS = (
    (
        "height",
        HEIGHT,
        "Heights as pressed face down, lowest first, with the outlines of the contact",
    ),
    ("pressure", PRESSURE, "Contact pressure, white where there is no contact"),
)
"""Field of the contact, its colours, and the caption of its picture."""

FRAMED, BESIDE = "framed part", "on the right close to the largest stress"
"""Title and caption of the second map."""


class Picture(NamedTuple):
    """A picture: the name of its file without the ending, its caption, the figure, and the body it shows.

    The body is empty for pictures of the contact.
    """

    name: str
    caption: str
    figure: Figure
    body: str = ""


def pictures(answer: Answer) -> Iterator[Picture]:
    """Pictures of an answer: height, contact pressure, and the stress in each body.

    Mirror images of the map are left out. Beside each overview stands the place of the largest stress, close
    to it. The stress is drawn in a plane and in a section through the extreme value of each field, and as its
    peaks.
    """
    source = _source(answer)
    near = _close_up(answer, "lower", answer.case.fields[0])
    for name, look, caption in MAPS:
        parts = [_whole(answer, source.grid), *_part(answer, near, source)]
        notes = "", FRAMED
        shown = [Map(source, part, _shown(source, name, part), notes[n]) for n, part in enumerate(parts)]
        figure = _drawn(shown, look)
        yield Picture(name, caption + ("." if near is None else f"; {BESIDE}."), figure)
    for body in answer.case.different_bodies:
        for field in answer.case.fields:
            yield from _of_stress(answer, source, body, field)


def _of_stress(answer: Answer, source: Source, body: str, field: str) -> Iterator[Picture]:
    """Pictures of one field of the stress in one body."""
    title = body_title(answer.case, body)
    suffix = ("" if field == "von_mises" else f"_{field}") + suffix_of(answer, body)
    word = field_words(field)
    capital, look = word[0].upper() + word[1:], field_look(field)
    level = answer.case.bodies[body].yield_stress if field == "von_mises" else None
    contour = "" if level is None else f"; the line is the yield stress, {shown_si(level, 'Pa')}"
    near = _close_up(answer, body, field)
    if near is not None:
        depth, grid, values = answer.kept[body].planes[field]
        here, (part,) = _whole(answer, grid), _part(answer, near, source)
        y, x = source.positions(part)
        overview = Map(replace(source, grid=grid, fields={}), here, values[here])
        shown = [overview, Map(source, part, near.plane(field, depth, y, x), FRAMED)]
        extreme = "largest" if field in POSITIVE else "extreme"
        caption = f"{capital} at the depth of its {extreme} value, {shown_si(depth, 'm', 3)}; {BESIDE}"
        yield Picture(f"plane{suffix}", f"{caption}{contour}; {title}.", _drawn(shown, look, level), body)
        section = _section(answer, source, body, field, near)
        figure = draw_sections([section], look, source.system, None, level)
        caption = f"{capital} close to its {extreme} value in a section; bars are the contact{contour}"
        yield Picture(f"section{suffix}", f"{caption}; {title}.", figure, body)
    stress = answer.stresses[body].assign_attrs(unit_system=source.system)
    if (stress["peak_quantity"] == field).any():
        images = ", with those of the mirror images of the map" if answer.face.is_mirrored else ""
        line = "" if level is None else f"; the upright line is the yield stress, {shown_si(level, 'Pa')}"
        figure = plot_peaks({source.title: stress}, field, yield_stress=level)
        caption = f"Peaks of the {word} and their depth{images}{line}; {title}."
        yield Picture(f"peaks{suffix}", caption, figure, body)


def suffix_of(answer: Answer, body: str) -> str:
    """End of the names of the files of one body, if there are two."""
    return f"_{body}" if len(answer.case.different_bodies) > 1 else ""


def _source(answer: Answer) -> Source:
    (source,) = sources({plain_text(answer.face.name): answer.contact}, SI_UNITS)
    return source


def _shown(source: Source, name: str, part: Part) -> Array:
    """A field on a part of the map; the pressure is missing where there is none."""
    values = source.field(name)[part]
    return np.where(values > 0, values, np.nan) if name == "pressure" else values


def _close_up(answer: Answer, body: str, field: str) -> CloseUp | None:
    """The close-up that holds the extreme value of a field, else that with the largest values."""
    found, boxes = answer.bodies[body].largest[field], answer.kept[body].close_ups

    def rank(box: CloseUp) -> tuple[bool, float]:
        largest = max(float(np.abs(values[field]).max()) for *_, values in box.planes)
        return box.holds(found.y, found.x), largest

    return max(boxes, key=rank, default=None)


def _whole(answer: Answer, grid: Grid) -> Part:
    """Nodes of the map on a grid of the cell."""
    rows, columns = (slice(0, count // answer.face.images) for count in grid.shape)
    return rows, columns


def _part(answer: Answer, near: CloseUp | None, source: Source) -> list[Part]:
    """Nodes of the map in a close-up, as a list of one; empty without one."""
    if near is None:
        return []
    found = []
    for (first, last), step, nodes in zip(
        near.spans, source.grid.spacing, _whole(answer, source.grid), strict=True
    ):
        found.append(slice(max(0, round(first / step)), min(nodes.stop, round(last / step) + 1)))
    return [(found[0], found[1])]


def _drawn(maps: list[Map], look: Look, level: float | None = None) -> Figure:
    """Maps in the same colours, with a frame in the first around what the second shows."""
    figure = draw_maps(maps, look, None, level)
    if len(maps) > 1:
        from matplotlib.patches import Rectangle

        overview, close = figure.axes[:2]
        (left, right), (low, high) = close.get_xlim(), close.get_ylim()
        overview.add_patch(Rectangle((left, low), right - left, high - low, fill=False, ec="C1", lw=1))
    return figure


def _section(answer: Answer, source: Source, body: str, field: str, near: CloseUp) -> xr.DataArray:
    """Vertical section across the patch, through the extreme value of a field if it is in the close-up."""
    found = answer.bodies[body].largest[field]
    place = (found.y, found.x) if near.holds(found.y, found.x) else near.middle
    axis = "yx".index(near.along)
    at = place[1 - axis]
    (part,) = _part(answer, near, source)
    node = round(at / source.grid.spacing[1 - axis]) % source.grid.shape[1 - axis]
    touching = source.field("pressure").take(node, 1 - axis)[part[axis]] > 0
    section = near.section(field, at, source.positions(part)[axis])
    title = f"{source.title}, {'yx'[1 - axis]} = {shown_si(at, 'm', 4)}"
    return section.assign_coords(contact=(near.along, touching)).rename(title)
