"""Fields of an answer as the views draw them: maps beside a framed part, and sections."""

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from asperity.core.types import Array
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.contact_numbers import typical_width
from asperity.engineering.question import Picture
from asperity.fourier.grid import Grid
from asperity.results.variables import SI_UNITS
from asperity.settings.body import Body
from asperity.views.maps import Map, draw_maps, map_of
from asperity.views.scales import Look, measure
from asperity.views.source import Part, Source, sources
from asperity.views.style import plain_text

LONGEST_TITLE = 28
"""Most characters of the name of a map in the title of a picture beside another one."""

FRAMED = "framed part"
"""Title of the second map."""

WIDTHS = 2
"""Half of the edge of the framed part over the typical width of a contact spot."""

FEWEST_PIXELS, MOST_PIXELS = 12, 64
"""Limits of half of this edge, in pixels."""

SECTION_DEPTH = 0.6
"""Depth of a section over the edge of the framed part."""


def source_of(answer: AnswerData, title: str = "") -> Source:
    """The contact of an answer as the views take it; its title is by default the name of the map."""
    name = title or answer.face.name
    name = name if len(name) <= LONGEST_TITLE else f"{name[: LONGEST_TITLE - 3]}..."
    (source,) = sources({plain_text(name): answer.contact}, SI_UNITS)
    return source


def framed_part(answer: AnswerData, field: str, body: str = "lower") -> Part | None:
    """Nodes of the map around the extreme value of a field of the stress; None without a contact."""
    grid = answer.face.grid
    typical = typical_width(answer.tables["contact_spots"]) / max(grid.spacing)
    if not typical:
        return None
    half, found = round(min(max(WIDTHS * typical, FEWEST_PIXELS), MOST_PIXELS)), answer.extreme(field, body)
    each = zip((found.y, found.x), grid.spacing, answer.face.height.shape, strict=True)
    middle = [(min(round(at / step), nodes - 1), nodes) for at, step, nodes in each]
    rows, columns = (slice(max(0, node - half), min(nodes, node + half + 1)) for node, nodes in middle)
    return rows, columns


def map_of_contact(answer: AnswerData, name: str, values: Array, look: Look, caption: str) -> Picture:
    """Picture of a field on the nodes of the map, with the part around the extreme stress beside it."""
    source, part = source_of(answer), framed_part(answer, answer.case.fields[0])
    source = replace(source, fields=source.fields | {name: values})
    maps = [map_of(source, name, answer.face.part_of(source.grid))]
    if part is not None:
        maps.append(map_of(source, name, part, FRAMED))
        caption += "; on the right close to the maximum stress"
    return Picture(name, f"{caption}.", draw_framed(maps, look))


def plane_maps(answer: AnswerData, source: Source, plane: xr.DataArray, part: Part, note: str) -> list[Map]:
    """A plane of the stress over the map, and its framed part, with outlines of the contact if possible."""
    (y, x), nodes = (plane[axis].values for axis in "yx"), source.positions(part)
    grid = Grid((y.size, x.size), (y.size * (y[1] - y[0]), x.size * (x[1] - x[0])))
    whole = slice(0, y.size), slice(0, x.size)
    alone = replace(source, grid=grid, fields={})
    rows, columns = (
        slice(int(np.searchsorted(at, own[0] - step / 2)), int(np.searchsorted(at, own[-1] + step / 2)))
        for at, own, step in zip((y, x), nodes, source.grid.spacing, strict=True)
    )
    close = source if plane.shape == answer.face.height.shape else alone
    values = plane.values
    return [
        Map(alone, whole, values, note),
        Map(close, (rows, columns), values[rows, columns], FRAMED),
    ]


def draw_framed(maps: list[Map], look: Look, level: float | None = None) -> Figure:
    """Maps in the same colours, with a frame in the first around the part that the second shows.

    The name has the first line of both titles, so that a long one overlaps nothing.
    """
    if len(maps) > 1:
        first, second = (each._replace(source=replace(each.source, title="")) for each in maps)
        title = f"{maps[0].source.title}\n{first.note or ' '}"
        maps = [first._replace(note=title), second._replace(note=f" \n{second.note}")]
    figure = draw_maps(maps, look, None, level)
    if len(maps) > 1:
        overview, close = figure.axes[:2]
        (left, right), (low, high) = close.get_xlim(), close.get_ylim()
        overview.add_patch(Rectangle((left, low), right - left, high - low, fill=False, ec="C1", lw=1))
    return figure


def section_of(answer: AnswerData, source: Source, field: str, body: str, part: Part) -> xr.DataArray:
    """Vertical section through the extreme value of a field, along the larger gradient of the pressure.

    So it runs across the lay, also of several ridges. The coordinate ``contact`` says where the surface
    touches, ``limit`` is the yield stress of the von Mises stress at each depth, if there is one. The stress
    is computed once for all pictures.
    """
    pressure, nodes = source.field("pressure"), source.positions(part)
    spacing = source.grid.spacing
    steps = (np.diff(pressure[part], axis=axis) / step for axis, step in enumerate(spacing))
    along = int(np.argmax([float(np.square(step).sum()) for step in steps]))
    axis, across, found = "yx"[along], "xy"[along], answer.extreme(field, body)
    at = min(round((found.x, found.y)[along] / spacing[1 - along]), pressure.shape[1 - along] - 1)
    place = float(at * spacing[1 - along])
    edge = max(own.size * step for own, step in zip(nodes, spacing, strict=True))
    between = float(nodes[along][0]), float(nodes[along][-1])
    if (section := answer.framed_sections.get((field, body))) is None:
        section = answer.section(axis, place, field, body, between, SECTION_DEPTH * edge)
        answer.framed_sections[field, body] = section
    touching = pressure.take(at, 1 - along)[part[along]] > 0
    where = measure(max(source.grid.length), "length", source.system).text(place)
    section = section.assign_coords(contact=(axis, touching))
    limit = yield_at(answer.case.bodies[body], section["depth"].values)
    if field == "von_mises" and np.isfinite(limit).any():
        section = section.assign_coords(limit=("depth", limit))
    return section.rename(f"{source.title}, {across} = {where}")


def yield_at(body: Body, depth: Array) -> Array:
    """Yield stress of the material at each depth; infinite where none is given."""
    limits = [np.inf if part.yield_stress is None else part.yield_stress for part in body.parts.values()]
    return np.array(limits)[np.searchsorted([*body.interfaces.values()], depth)]


def plain_logarithms(axis: Any) -> None:
    """Make an axis logarithmic, with plain numbers at 1, 2 and 5 times powers of ten."""
    getattr(axis.axes, f"set_{axis.axis_name}scale")("log")
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())
