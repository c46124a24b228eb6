"""The report of an answer: one HTML page that a browser opens without a network."""

from __future__ import annotations

import base64
import json
import platform
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from typing import Any, NamedTuple

import asperity
from asperity.engineering.advice import WARNING
from asperity.engineering.answer import Answer, Row, body_title, case_in_words
from asperity.engineering.datasets import settings_of
from asperity.results.dataset import PAPER

PACKAGES = ("numpy", "numba", "ducc0", "xarray", "SurfaceTopography")
"""Packages whose versions the report names."""


class ReportPicture(NamedTuple):
    """A picture of the page.

    Parameters
    ----------
    body : str
        Body whose stress it shows; empty for pictures of the contact.
    wide : bool
        True if it takes the whole width.
    caption : str
    image : bytes
        Content of a PNG file.
    """

    body: str
    wide: bool
    caption: str
    image: bytes


def report_page(answer: Answer, pictures: Sequence[ReportPicture]) -> str:
    """The report as HTML.

    Parameters
    ----------
    answer : Answer
    pictures : sequence of ReportPicture
        They become part of the page.
    """
    from jinja2 import Environment, StrictUndefined

    text = files("asperity.engineering").joinpath("report.html.j2").read_text(encoding="utf-8")
    template = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    ).from_string(text)
    return template.render(
        name=answer.indenter.name,
        case=case_in_words(answer.case),
        warnings=[advice for advice in answer.advice if advice.level == WARNING],
        notes=[advice for advice in answer.advice if advice.level != WARNING],
        headline=headline(answer),
        groups=_groups(answer.rows),
        friction=answer.case.friction,
        boundary=answer.indenter.boundary,
        done=answer.indenter.done,
        picture_groups=[
            (
                body_title(answer.case, body) if body and len(answer.bodies) > 1 else "",
                [
                    (picture.wide, picture.caption, base64.b64encode(picture.image).decode())
                    for picture in pictures
                    if picture.body == body
                ],
            )
            for body in ("", *answer.bodies)
        ],
        settings=json.dumps(settings_of(answer), indent=2, ensure_ascii=False),
        versions=versions(),
        paper=PAPER,
        version=asperity.__version__,
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
    found = [("asperity", asperity.__version__), ("Python", platform.python_version())]
    for package in PACKAGES:
        try:
            found.append((package, version(package)))
        except PackageNotFoundError:
            continue
    return found


def _groups(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Rows by group."""
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(row.group, []).append(row)
    return [{"title": title, "rows": of_group} for title, of_group in groups.items()]
