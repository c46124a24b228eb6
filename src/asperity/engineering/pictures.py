"""Pictures of an answer for its folder and its report, drawn by `asperity.views`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from asperity.engineering.answer import Answer, body_title
from asperity.engineering.datasets import contact_dataset, stress_dataset
from asperity.units import shown_si
from asperity.views.maps import plot_height, plot_pressure
from asperity.views.peaks import plot_peaks
from asperity.views.plane import plot_plane
from asperity.views.section import plot_section
from asperity.views.stress_field import POSITIVE, field_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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

    Mirror images of the map are left out.
    """
    contact = {answer.indenter.name: contact_dataset(answer)}
    length_y, length_x = answer.indenter.map_length
    y, x = (0.0, length_y), (0.0, length_x)
    yield Picture(
        "height",
        "Heights as pressed face down, the lowest touch first, with the outlines of the real contact.",
        plot_height(contact, y=y, x=x),
    )
    yield Picture("pressure", "Contact pressure.", plot_pressure(contact, y=y, x=x))
    for name in answer.bodies:
        for field in answer.fields:
            yield from _inside(answer, name, field)


def _inside(answer: Answer, name: str, field: str) -> Iterator[Picture]:
    """Section and plane through the extreme value of a field in a body, and its peaks."""
    found = answer.bodies[name].largest[field]
    suffix = "" if field == "von_mises" else f"_{field}"
    suffix += "" if len(answer.bodies) == 1 else f"_{name}"
    length_y, length_x = answer.indenter.map_length
    y, x = (0.0, length_y), (0.0, length_x)
    pressed = {answer.indenter.name: contact_dataset(answer)}
    title = body_title(answer.case, name)
    images = ", with those of the mirror images of the map" if answer.indenter.is_mirrored else ""
    word = field_words(field)
    extreme = "largest" if field in POSITIVE else "extreme"
    if answer.numbers.contact_nodes:
        yield Picture(
            f"section{suffix}",
            f"{_capital(word)} in the vertical section at y = {shown_si(found.y, 'm', 4)}, through its "
            f"{extreme} value; {title}.",
            plot_section(pressed, y=found.y, x=x, field=field, body=name),
            name,
        )
        yield Picture(
            f"plane{suffix}",
            f"{_capital(word)} at the depth of its {extreme} value, {shown_si(found.depth, 'm', 3)}; "
            f"{title}.",
            plot_plane(pressed, found.depth, field, y=y, x=x, body=name),
            name,
        )
    if (answer.stresses[name]["peak_quantity"] == field).any():
        yield Picture(
            f"peaks{suffix}",
            f"Peaks of the {word} and their depth{images}; {title}.",
            plot_peaks({answer.indenter.name: stress_dataset(answer, name)}, field),
            name,
        )


def _capital(text: str) -> str:
    return text[0].upper() + text[1:]
