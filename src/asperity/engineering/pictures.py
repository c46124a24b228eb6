"""Pictures of an answer: overviews of the map, and the place of the largest stress close to it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from asperity.core.units import shown_si
from asperity.engineering.body_stress import CloseUp
from asperity.engineering.question import Picture
from asperity.fourier.grid import Grid
from asperity.results.variables import SI_UNITS
from asperity.views.maps import HEIGHT, PLASTIC_DEPTH, PRESSURE, Map, draw_maps, map_of
from asperity.views.peak_plot import plot_peaks
from asperity.views.scales import Look
from asperity.views.source import Part, Source, sources
from asperity.views.stress_plot import draw_sections, field_look, field_words, until_faded
from asperity.views.style import plain_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from asperity.engineering.answer import Answer


MAPS = {
    "height": (HEIGHT, "Heights as pressed face down, lowest first, with the outlines of the contact"),
    "pressure": (PRESSURE, "Contact pressure, white where there is no contact"),
    "plastic_depth": (PLASTIC_DEPTH, "Plastic depth, by which the surface is flattened at the hardness"),
}
"""Field of the contact → its colours, and the caption of its picture."""

FADED = 0.1
"""A section ends where the stress is below the yield stress and this share of the largest stress."""

FRAMED = "framed part"
"""Title of the second map."""


def pictures(answer: Answer) -> Iterator[Picture]:
    """Pictures of an answer: height, contact pressure, those of the questions, and the stress in each body.

    A close-up of the largest stress is beside each overview. The stress is drawn in a plane and in a section
    through the extreme value of each field, and as its peaks.
    """
    source = source_of(answer)
    for name, (look, caption) in MAPS.items():
        if name in source.fields and (name != "plastic_depth" or answer.contact.plastic_area):
            yield map_of_contact(answer, name, source.fields[name], look, caption)
    for question in answer.case.questions.values():
        yield from question.pictures(answer)
    for body in answer.case.different_bodies:
        for field in answer.case.fields:
            yield from _of_stress(answer, source, body, field)
        for question in answer.case.questions.values():
            yield from question.pictures_of_body(answer, body)


def source_of(answer: Answer) -> Source:
    """The contact of an answer as the views take it."""
    (source,) = sources({plain_text(answer.face.name): answer.contact}, SI_UNITS)
    return source


def map_of_contact(answer: Answer, name: str, values: Any, look: Look, caption: str) -> Picture:
    """Picture of a field on the nodes of the map, with a close-up near the largest stress."""
    source, field = source_of(answer), answer.case.fields[0]
    source = replace(source, fields=source.fields | {name: values})
    near = _close_up(answer, "lower", field)
    maps = [map_of(source, name, whole_map(answer, source.grid))]
    if near is not None:
        maps.append(map_of(source, name, near.part, FRAMED))
        caption += f"; on the right close to {_shown(answer, 'lower', field, near)}"
    return Picture(name, f"{caption}.", _drawn(maps, look))


def _of_stress(answer: Answer, source: Source, body: str, field: str) -> Iterator[Picture]:
    """Pictures of one field of the stress in one body."""
    end = f"; {answer.case.stress_title(body)}."
    level = answer.case.bodies[body].yield_stress if field == "von_mises" else None
    if level is not None:
        below = "" if answer.case.bodies[body].coating is None else " below the coating"
        end = f"; the line is the yield stress{below}, {shown_si(level, 'Pa')}{end}"
    suffix = ("" if field == "von_mises" else f"_{field}") + answer.suffix_of(body)
    word = field_words(field)
    capital, look = word[0].upper() + word[1:], field_look(field)
    near = _close_up(answer, body, field)
    if near is not None:
        depth, grid, values = answer.bodies[body].planes[field]
        whole = whole_map(answer, grid)
        close = near.planes[int(np.abs(np.subtract(near.depths, depth)).argmin())][field]
        overview = Map(replace(source, grid=grid, fields={}), whole, values[whole])
        figure = _drawn([overview, Map(source, near.part, close, FRAMED)], look, level)
        place = _shown(answer, body, field, near)
        at_depth = f"at the depth of its largest magnitude, {shown_si(depth, 'm', 3)}"
        caption = f"{capital} {at_depth}; on the right close to {place}"
        yield Picture(f"plane{suffix}", caption + end, figure, body)
        section = _section(answer, source, body, field, near)
        faded = min(FADED * float(np.abs(section.values).max()), level or np.inf)
        figure = draw_sections(until_faded([section], faded), look, source.system, None, level)
        caption = f"{capital} in a section close to {place}; bars are the contact"
        yield Picture(f"section{suffix}", caption + end, figure, body)
    stress = answer.bodies[body].stress.assign_attrs(unit_system=source.system)
    if (stress["peak_quantity"] == field).any():
        figure = plot_peaks({source.title: stress}, field, yield_stress=level)
        yield Picture(f"peaks{suffix}", f"Peaks of the {word} and their depth{end}", figure, body)


def _close_up(answer: Answer, body: str, field: str) -> CloseUp | None:
    """The close-up that holds the extreme value of a field, else that with the largest values."""
    found = answer.bodies[body].largest[field]

    def rank(box: CloseUp) -> tuple[bool, float]:
        largest = max(float(np.abs(plane[field]).max()) for plane in box.planes)
        return box.node(found.y, found.x) is not None, largest

    return max(answer.bodies[body].close_ups, key=rank, default=None)


def _shown(answer: Answer, body: str, field: str, near: CloseUp) -> str:
    """Description of the place that a close-up shows."""
    found = answer.bodies[body].largest[field]
    return "one of the highest pressures" if near.node(found.y, found.x) is None else "the largest stress"


def whole_map(answer: Answer, grid: Grid) -> Part:
    """Nodes of the map on a grid of the map, or of a mirrored map and its images."""
    images = 2 if answer.face.grid.mirrored and not grid.mirrored else 1
    rows, columns = (slice(0, count // images) for count in grid.shape)
    return rows, columns


def _drawn(maps: list[Map], look: Look, level: float | None = None) -> Figure:
    """Maps in the same colours, with a frame in the first around the part that the second shows."""
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
    values = np.array([plane[field] for plane in near.planes])
    place = near.node(found.y, found.x) or np.unravel_index(np.abs(values).argmax(), values.shape)[1:]
    axis = "yx".index(near.along)
    across = int(place[1 - axis])
    touching = source.field("pressure")[near.part].take(across, 1 - axis) > 0
    nodes = source.positions(near.part)
    title = f"{source.title}, {'yx'[1 - axis]} = {shown_si(float(nodes[1 - axis][across]), 'm', 4)}"
    return xr.DataArray(
        values.take(across, 2 - axis),
        {"depth": near.depths, near.along: nodes[axis], "contact": (near.along, touching)},
        ("depth", near.along),
        title,
    )
