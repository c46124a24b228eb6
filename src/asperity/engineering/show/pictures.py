"""Pictures of an answer: overviews of the map, and the place of the extreme stress close to it."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from io import BytesIO
from itertools import product
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from asperity.core.units import shown_si
from asperity.engineering.answer_data import FADED, ON_INTERFACE, AnswerData, asked_first
from asperity.engineering.drawing import (
    draw_framed,
    framed_part,
    map_of_contact,
    plane_maps,
    section_of,
    source_of,
    yield_at,
)
from asperity.engineering.question import Picture
from asperity.engineering.records import find
from asperity.results.variables import SI_UNITS
from asperity.views.maps import MAP_HEIGHT, PLASTIC_DEPTH, PRESSURE, draw_maps, map_of
from asperity.views.peak_plot import plot_peaks
from asperity.views.scales import STRESS, Look
from asperity.views.source import Source
from asperity.views.stress_plot import draw_sections, field_look, field_words, until_faded

MAPS = {
    "height": (MAP_HEIGHT, "Heights of the map, peaks bright, with the outlines of the contact"),
    "pressure": (PRESSURE, "Contact pressure, white where there is no contact"),
    "plastic_depth": (PLASTIC_DEPTH, "Plastic depth, by which the surface is flattened at the hardness"),
}
"""Field of the contact → its colours, and the caption of its picture."""

INTERFACE = {"shear": ("xz", "yz"), "tension": ("zz",)}
"""Picture of an interface → the components of the stress of which it is the size."""


def pictures(answer: AnswerData) -> Iterator[Picture]:
    """Pictures of an answer: height, contact pressure, the questions, and the stress in each body.

    The part around the extreme stress is beside each overview. The stress is drawn in a plane and in a
    section through the extreme value of each field, and as its peaks.
    """
    source = source_of(answer)
    for name, (look, caption) in MAPS.items():
        if name in source.fields and (name != "plastic_depth" or answer.contact.plastic_area):
            yield map_of_contact(answer, name, _upward(name, source), look, caption)
    for question in answer.case.questions.values():
        yield from question.pictures(answer)
    for body in answer.stress:
        suffix = f"_{body}" if len(answer.stress) > 1 else ""
        for field in answer.case.fields:
            yield from _of_stress(answer, source, body, field, suffix)
        yield from _of_interfaces(answer, source, body, suffix)


def lead_of(answer: AnswerData, of: Any = None) -> Picture | None:
    """The picture that stands at the top, of the pictures of the answer: that of the question asked.

    Parameters
    ----------
    answer : AnswerData
    of : iterable of Picture, optional
        By default they are drawn until it is found.
    """
    case = answer.case
    asked, implied = ([case.questions[name].LEAD for name in names] for names in asked_first(case))
    # Where the picture of a question asked for is missing, as of a closed gap, the contact answers it.
    names = [*reversed(asked), "interface", *(["pressure"] if any(asked) else reversed(implied)), "pressure"]
    names = [*filter(None, names)]
    best: tuple[int, Picture] | None = None
    for picture in pictures(answer) if of is None else of:
        rank = next((rank for rank, name in enumerate(names) if picture.name.startswith(name)), len(names))
        if rank < len(names) and (best is None or rank < best[0]):
            best = rank, picture
        if best is not None and best[0] == 0:
            break
    return None if best is None else best[1]


def compared_pictures(answers: Mapping[str, AnswerData]) -> Iterator[Picture]:
    """Heights, pressure and a section of the stress of several answers, each in one scale."""
    found = {name: source_of(answer, name) for name, answer in answers.items()}
    for field in ("height", "pressure"):
        look, caption = MAPS[field]
        maps = [
            map_of(
                replace(source, fields=source.fields | {field: _upward(field, source)}),
                field,
                answers[name].face.part_of(source.grid),
            )
            for name, source in found.items()
        ]
        yield Picture(field, f"{caption}.", draw_maps(maps, look, None))
    sections = []
    field = next(iter(answers.values())).case.fields[0]
    for name, answer in answers.items():
        if field in answer.case.fields and (part := framed_part(answer, field)) is not None:
            sections.append(section_of(answer, found[name], field, "lower", part))
    if sections:
        words = field_words(field)
        caption = f"{words[0].upper()}{words[1:]} in sections through its maximum"
        faded = FADED * max(float(np.abs(section.values).max()) for section in sections)
        drawn = draw_sections(until_faded(sections, faded), field_look(field), SI_UNITS, None)
        yield Picture("section", f"{caption}; bars are the contact, lines the yield stress.", drawn)


def png_of(figure: Figure) -> bytes:
    """A figure as an image, in a third of the time of the default."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas, file = FigureCanvasAgg(figure), BytesIO()
    canvas.draw()  # once, where savefig draws twice
    pixels = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    pixels.save(file, "PNG", dpi=(figure.dpi,) * 2, compress_level=1, compress_type=3)  # 3: Z_RLE
    return file.getvalue()


def _upward(name: str, source: Source) -> Any:
    """A field of the contact; heights with peaks upward, where the contact has the lower face."""
    return -source.fields[name] if name == "height" else source.fields[name]


def _of_stress(
    answer: AnswerData, source: Source, body: str, field: str, end_of_name: str
) -> Iterator[Picture]:
    """Pictures of one field of the stress in one body."""
    end = f"; {answer.case.stress_title(body)}."
    own = answer.case.bodies[body]
    limits = {name: part.yield_stress for name, part in own.parts.items()}
    known = {name: limit for name, limit in limits.items() if limit is not None and field == "von_mises"}
    if known:
        texts = (f"{shown_si(limit, 'Pa')}{f' of {name}' if name else ''}" for name, limit in known.items())
        end = f"; the line is the yield stress, {' and '.join(texts)}{end}"
    suffix = ("" if field == "von_mises" else f"_{field}") + end_of_name
    word, look = field_words(field), field_look(field)
    capital = word[0].upper() + word[1:]
    part = framed_part(answer, field, body)
    if part is not None:
        plane = answer.plane(field=field, body=body)
        depth = float(plane["depth"])
        limit = float(yield_at(own, np.array(depth))) if known else np.inf
        maps = plane_maps(answer, source, plane, part, f"depth {shown_si(depth, 'm', 3)}")
        figure = draw_framed(maps, look, limit if limit < np.inf else None)
        caption = f"{capital} at the depth of its extreme value; on the right close to it"
        yield Picture(f"plane{suffix}", caption + end, figure, body)
        section = section_of(answer, source, field, body, part)
        faded = min(FADED * float(np.abs(section.values).max()), *known.values(), np.inf)
        figure = draw_sections(until_faded([section], faded), look, source.system, None)
        caption = f"{capital} in a section through its extreme value; bars are the contact"
        yield Picture(f"section{suffix}", caption + end, figure, body)
    stress = answer.stress[body].assign_attrs(unit_system=source.system)
    if (stress["peak_quantity"] == field).any():
        line: Any = min(known.values(), default=None)
        if known and own.interfaces:
            faces = [*own.interfaces.values()]
            depths = np.sort([0.0, *faces, *np.nextafter(faces, 1), 1e3])
            line = depths, np.where(np.isinf(at := yield_at(own, depths)), np.nan, at)
        figure = plot_peaks({source.title: stress}, field, yield_stress=line)
        yield Picture(f"peaks{suffix}", f"Peaks of the {word} and their depth{end}", figure, body)


def _of_interfaces(answer: AnswerData, source: Source, body: str, suffix: str) -> Iterator[Picture]:
    """Shear and tension on each interface; a cross is at the maximum."""
    faces, part = answer.case.bodies[body].interfaces, framed_part(answer, answer.case.fields[0], body)
    for (face, depth), (name, components) in product(faces.items(), INTERFACE.items()):
        record = next(find(answer.records, f"{ON_INTERFACE[name]} {face}", body), None)
        if record is None or record.words or part is None:
            continue
        planes = [answer.plane(depth, each, body) for each in components]
        size = planes[0].clip(0)
        if len(planes) == 2:
            size = size.copy(data=np.hypot(planes[0].values, planes[1].values))
        words = f"{ON_INTERFACE[name].removeprefix('maximum ')} {face}"
        figure = draw_framed(
            plane_maps(answer, source, size, part, "")[:1],
            Look(words, "stress", STRESS, "white", np.max, low=0.0),
        )
        axis = figure.axes[0]
        scale = (source.grid.spacing[1] * answer.face.height.shape[1]) / float(np.diff(axis.get_xlim())[0])
        at = record.position
        axis.plot(at.x / scale, at.y / scale, "+", color="w", ms=9, mew=1.5, clip_on=False, zorder=6)
        below = f", {shown_si(depth, 'm')} deep; the cross is its maximum"
        caption = f"{words[0].upper()}{words[1:]}{below}; {answer.case.stress_title(body)}."
        number = "_".join(["", *face.split()[1:]]) if len(faces) > 1 else ""
        yield Picture(f"interface{number}_{name}{suffix}", caption, figure, body)
