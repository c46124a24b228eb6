"""The report of an answer: one HTML page that a browser opens without a network."""

from __future__ import annotations

import base64
import platform
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from itertools import groupby
from typing import TYPE_CHECKING, NamedTuple

from asperity.core.version import __version__
from asperity.engineering.advice import WARNING
from asperity.engineering.answer import Answer, body_title, case_in_words
from asperity.results.dataset import PAPER

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PACKAGES = ("numpy", "numba", "ducc0", "xarray", "SurfaceTopography")
"""Packages whose versions the report names."""


class Picture(NamedTuple):
    """A picture: the name of its file without the ending, its caption, the figure, and the body it shows.

    The body is empty for pictures of the contact.
    """

    name: str
    caption: str
    figure: Figure
    body: str = ""


def report_page(answer: Answer, pictures: Sequence[tuple[Picture, bytes]], settings: str) -> str:
    """The report as HTML.

    Parameters
    ----------
    answer : Answer
    pictures : sequence of (Picture, content of its PNG file)
        They become part of the page.
    settings : str
        Settings of the answer as text.
    """
    from jinja2 import Environment, StrictUndefined

    text = files("asperity.engineering").joinpath("report.html.j2").read_text(encoding="utf-8")
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    groups: dict[str, list[tuple[Picture, str]]] = {}
    for picture, image in pictures:
        title = body_title(answer.case, picture.body) if picture.body and len(answer.bodies) > 1 else ""
        groups.setdefault(title, []).append((picture, base64.b64encode(image).decode()))
    return environment.from_string(text).render(
        answer=answer,
        case=case_in_words(answer.case),
        warnings=[advice for advice in answer.advice if advice.level == WARNING],
        notes=[advice for advice in answer.advice if advice.level != WARNING],
        headline=headline(answer),
        groups=groupby(answer.rows, key=lambda row: row.group),
        picture_groups=groups,
        settings=settings,
        versions=versions(),
        paper=PAPER,
        version=__version__,
    )


def headline(answer: Answer) -> list[tuple[str, str]]:
    """The numbers that are asked for first, of the contact and of every elastic body: name and value."""
    shown = {(row.group, row.name): row.shown for row in answer.rows}
    numbers = [
        ("real contact", f"{100 * answer.numbers.area_fraction:.3g} %"),
        ("largest pressure", shown["contact", "largest pressure"]),
    ]
    for name in answer.bodies:
        group = body_title(answer.case, name)
        where = f", {name} body" if len(answer.bodies) > 1 else ""
        numbers += [
            (f"largest von Mises stress{where}", shown[group, "largest von Mises stress"]),
            (f"at depth{where}", shown[group, "at depth"]),
        ]
        if (group, "share above yield") in shown:
            numbers.append((f"above yield{where}", shown[group, "volume above yield"]))
    return numbers


def versions() -> list[tuple[str, str]]:
    """Names and versions of what computed the answer."""
    found = [("asperity", __version__), ("Python", platform.python_version())]
    for package in PACKAGES:
        try:
            found.append((package, version(package)))
        except PackageNotFoundError:
            continue
    return found
