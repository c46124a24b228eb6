"""The report of an answer: one HTML page that a browser opens without a network."""

from __future__ import annotations

import base64
import json
import platform
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from typing import Any

import asperity
from asperity.engineering.advice import WARNING
from asperity.engineering.answer import Answer, Row, case_in_words
from asperity.engineering.datasets import settings_of
from asperity.results.dataset import PAPER

PACKAGES = ("numpy", "numba", "ducc0", "xarray", "SurfaceTopography")
"""Packages whose versions the report names."""


def report_page(answer: Answer, pictures: Sequence[tuple[str, bytes]]) -> str:
    """The report as HTML.

    Parameters
    ----------
    answer : Answer
    pictures : sequence of (caption, PNG file)
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
        pictures=[
            (caption, "data:image/png;base64," + base64.b64encode(image).decode())
            for caption, image in pictures
        ],
        settings=json.dumps(settings_of(answer), indent=2, ensure_ascii=False),
        versions=versions(),
        paper=PAPER,
        version=asperity.__version__,
    )


def headline(answer: Answer) -> list[tuple[str, str]]:
    """The four numbers that are asked for first: name and value."""
    shown = {(row.group, row.name): row.shown for row in answer.rows}
    first = next(row.group for row in answer.rows if row.name == "largest von Mises stress")
    numbers = [
        ("real contact", f"{100 * answer.numbers.area_fraction:.3g} %"),
        ("largest pressure", shown["contact", "largest pressure"]),
        ("largest von Mises stress", shown[first, "largest von Mises stress"]),
        ("at depth", shown[first, "at depth"]),
    ]
    if (first, "share above yield") in shown:
        numbers.append(("above yield", shown[first, "volume above yield"]))
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
