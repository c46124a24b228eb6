"""Pictures of an answer: overviews of the map, and the place of the largest stress close to it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from asperity.core.units import shown_si
from asperity.engineering.body_stress import CloseUp
from asperity.engineering.question import Picture
from asperity.results.variables import SI_UNITS
from asperity.views.maps import MAP_HEIGHT, PLASTIC_DEPTH, PRESSURE, Map, draw_maps, map_of
from asperity.views.peak_plot import plot_peaks
from asperity.views.scales import STRESS, Look, measure
from asperity.views.source import Source, sources
from asperity.views.stress_plot import draw_sections, field_look, field_words, until_faded
from asperity.views.style import plain_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from asperity.engineering.answer import Answer


MAPS = {
    "height": (MAP_HEIGHT, "Heights of the map, peaks bright, with the outlines of the contact"),
    "pressure": (PRESSURE, "Contact pressure, white where there is no contact"),
    "plastic_depth": (PLASTIC_DEPTH, "Plastic depth, by which the surface is flattened at the hardness"),
}
"""Field of the contact → its colours, and the caption of its picture."""

FADED = 0.1
"""A section ends where the stress is below the limit of the material and this share of the largest stress."""

FRAMED = "framed part"
"""Title of the second map."""


def pictures(answer: Answer) -> Iterator[Picture]:
    """Pictures of an answer: height, contact pressure, the questions, and the stress in each body.

    A close-up of the largest stress is beside each overview. The stress is drawn in a plane and in a section
    through the extreme value of each field, and as its peaks.
    """
    source = source_of(answer)
    for name, (look, caption) in MAPS.items():
        if name in source.fields and (name != "plastic_depth" or answer.contact.plastic_area):
            sign = -1 if name == "height" else 1  # the contact has the lower face
            yield map_of_contact(answer, name, sign * source.fields[name], look, caption)
    for question in answer.case.questions.values():
        yield from question.pictures(answer)
    for body in answer.case.different_bodies:
        for field in answer.case.fields:
            yield from _of_stress(answer, source, body, field)
        if (interface := answer.bodies[body].interface) is not None:
            for name, words in {"shear": "shear stress on", "tension": "tension across"}.items():
                (grid, values), largest = interface.planes[name], interface.largest[name]
                if not largest.value > 0:
                    continue
                whole = answer.face.part_of(grid)
                look = Look(f"{words} the interface", "stress", STRESS, "white", np.max, low=0.0)
                shown = Map(replace(source, grid=grid, fields={}), whole, np.maximum(values[whole], 0.0))
                figure = _drawn([shown], look)
                axis = figure.axes[0]
                factor = grid.spacing[1] * values[whole].shape[1] / float(np.diff(axis.get_xlim())[0])
                axis.plot(
                    largest.x / factor, largest.y / factor, "+", color="C4", ms=9, mew=1.5, clip_on=False
                )
                caption = (
                    f"{words[0].upper()}{words[1:]} the interface of the coating; the cross is its largest"
                )
                title = answer.case.stress_title(body)
                yield Picture(
                    f"interface_{name}{answer.suffix_of(body)}", f"{caption} value; {title}.", figure, body
                )
        for question in answer.case.questions.values():
            yield from question.pictures_of_body(answer, body)


def compared_pictures(answers: Mapping[str, Answer]) -> Iterator[Picture]:
    """Heights, pressure and a section of the stress of several answers, each in one scale."""
    found = {name: replace(source_of(answer), title=name) for name, answer in answers.items()}
    wholes = {name: answer.face.part_of(found[name].grid) for name, answer in answers.items()}
    for field, (look, caption) in MAPS.items():
        if field != "plastic_depth":
            maps = [map_of(source, field, wholes[name]) for name, source in found.items()]
            sign = -1 if field == "height" else 1
            maps = [each._replace(values=sign * each.values) for each in maps]
            yield Picture(field, f"{caption}.", draw_maps(maps, look, None))
    sections = []
    for name, answer in answers.items():
        field = answer.case.fields[0]
        if (near := _close_up(answer, "lower", field)) is not None:
            section = _section(answer, found[name], "lower", field, near)
            limit = answer.bodies["lower"].yield_at(section["depth"].values)
            if field == "von_mises" and np.isfinite(limit).any():
                section = section.assign_coords(limit=("depth", limit))
            sections.append(section)
    if sections:
        words = field_words(field)
        caption = f"{words[0].upper()}{words[1:]} in sections through its largest magnitude"
        drawn = draw_sections(sections, field_look(field), SI_UNITS, None)
        yield Picture("section", f"{caption}; bars are the contact, lines the yield stress.", drawn)


def source_of(answer: Answer) -> Source:
    """The contact of an answer as the views take it."""
    (source,) = sources({plain_text(answer.face.name): answer.contact}, SI_UNITS)
    return source


def map_of_contact(answer: Answer, name: str, values: Any, look: Look, caption: str) -> Picture:
    """Picture of a field on the nodes of the map, with a close-up near the largest stress."""
    source, field = source_of(answer), answer.case.fields[0]
    source = replace(source, fields=source.fields | {name: values})
    near = _close_up(answer, "lower", field)
    maps = [map_of(source, name, answer.face.part_of(source.grid))]
    if near is not None:
        maps.append(map_of(source, name, near.part, FRAMED))
        caption += "; on the right close to the largest stress"
    return Picture(name, f"{caption}.", _drawn(maps, look))


def _of_stress(answer: Answer, source: Source, body: str, field: str) -> Iterator[Picture]:
    """Pictures of one field of the stress in one body."""
    end = f"; {answer.case.stress_title(body)}."
    part, level = answer.bodies[body], None
    limits = [each.body.yield_stress for each in part.materials.values()] if field == "von_mises" else []
    if known := [limit for limit in limits if limit is not None]:
        level = min(known)
        values_of = " and ".join(
            f"{shown_si(limit, 'Pa')}{f' of the {material}' if material else ''}"
            for material, limit in zip(part.materials, limits, strict=True)
            if limit is not None
        )
        end = f"; the line is the yield stress, {values_of}{end}"
    suffix = ("" if field == "von_mises" else f"_{field}") + answer.suffix_of(body)
    word = field_words(field)
    capital, look = word[0].upper() + word[1:], field_look(field)
    near = _close_up(answer, body, field)
    if near is not None:
        depth, grid, values = answer.bodies[body].planes[field]
        whole = answer.face.part_of(grid)
        close = near.planes[int(np.abs(np.subtract(near.depths, depth)).argmin())][field]
        at = f"depth {shown_si(depth, 'm', 3)}"
        overview = Map(replace(source, grid=grid, fields={}), whole, values[whole], at)
        own = float(part.yield_at(depth)) if level is not None else np.inf
        shown = [overview, Map(source, near.part, close, f"{FRAMED}, {at}")]
        figure = _drawn(shown, look, own if own < np.inf else None)
        caption = f"{capital} at the depth of its largest magnitude; on the right close to it"
        yield Picture(f"plane{suffix}", caption + end, figure, body)
        section = _section(answer, source, body, field, near)
        faded = min(FADED * float(np.abs(section.values).max()), level or np.inf)
        if level is not None:
            section = section.assign_coords(limit=("depth", part.yield_at(section["depth"].values)))
        figure = draw_sections(until_faded([section], faded), look, source.system, None)
        caption = f"{capital} in a section through its largest magnitude; bars are the contact"
        yield Picture(f"section{suffix}", caption + end, figure, body)
    stress = answer.bodies[body].stress.assign_attrs(unit_system=source.system)
    if (stress["peak_quantity"] == field).any():
        line: Any = level
        if level is not None and part.layer.interface is not None:
            depths = np.array([0.0, part.layer.interface, np.nextafter(part.layer.interface, 1), 1e3])
            line = depths, np.where(np.isinf(limit := part.yield_at(depths)), np.nan, limit)
        figure = plot_peaks({source.title: stress}, field, yield_stress=line)
        yield Picture(f"peaks{suffix}", f"Peaks of the {word} and their depth{end}", figure, body)


def _close_up(answer: Answer, body: str, field: str) -> CloseUp | None:
    """The close-up that holds the extreme value of a field; None without a contact."""
    found = answer.bodies[body].largest[field]

    boxes = answer.bodies[body].close_ups
    return next((box for box in boxes if box.node(found.y, found.x) is not None), None)


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
    at = measure(max(source.grid.length), "length", source.system).text(float(nodes[1 - axis][across]))
    title = f"{source.title}, {'yx'[1 - axis]} = {at}"
    return xr.DataArray(
        values.take(across, 2 - axis),
        {"depth": near.depths, near.along: nodes[axis], "contact": (near.along, touching)},
        ("depth", near.along),
        title,
    )
