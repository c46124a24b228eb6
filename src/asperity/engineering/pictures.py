"""Pictures of an answer for its folder and its report, drawn by `asperity.views`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from asperity.engineering.answer import Answer, body_title
from asperity.engineering.datasets import contact_dataset, stress_dataset
from asperity.units import shown_si
from asperity.views.inside import plot_plane, plot_section
from asperity.views.maps import plot_height, plot_pressure
from asperity.views.peaks import plot_peaks

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Picture(NamedTuple):
    """A picture: the name of its file without the ending, its caption and the figure."""

    name: str
    caption: str
    figure: Figure


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
    for name, body in answer.bodies.items():
        suffix = "" if len(answer.bodies) == 1 else f"_{name}"
        if not np.isfinite(body.depth):
            continue
        if answer.indenter.boundary == "periodic" and not answer.case.friction:
            yield from _inside(answer, name)
        title = body_title(answer.case, name)
        yield Picture(
            f"peaks{suffix}",
            f"Peaks of the von Mises stress and their depth; {title}.",
            plot_peaks({answer.indenter.name: stress_dataset(answer, name)}),
        )


def _inside(answer: Answer, name: str) -> Iterator[Picture]:
    """Section and plane through the largest von Mises stress of a body.

    `asperity.views` draws them from the pressure of a periodic contact without friction.
    """
    body = answer.bodies[name]
    suffix = "" if len(answer.bodies) == 1 else f"_{name}"
    length_y, length_x = answer.indenter.map_length
    y, x = (0.0, length_y), (0.0, length_x)
    pressed = {answer.indenter.name: contact_dataset(answer, name)}
    title = body_title(answer.case, name)
    yield Picture(
        f"section{suffix}",
        f"Von Mises stress in the vertical section at y = {shown_si(body.y, 'm', 4)}, through its "
        f"largest value; {title}.",
        plot_section(pressed, y=body.y, x=x),
    )
    yield Picture(
        f"plane{suffix}",
        f"Von Mises stress at the depth of its largest value, {shown_si(body.depth, 'm', 3)}; {title}.",
        plot_plane(pressed, body.depth, y=y, x=x),
    )
