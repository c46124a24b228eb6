"""The report of an answer: one HTML page that a browser opens without a network."""

from __future__ import annotations

import base64
import platform
from collections.abc import Sequence
from datetime import datetime
from importlib.metadata import version
from importlib.util import find_spec
from itertools import groupby

from asperity.core.markup import rendered
from asperity.core.version import __version__
from asperity.engineering.advice import WARNING
from asperity.engineering.answer import Answer, body_title, case_in_words
from asperity.engineering.pictures import Picture
from asperity.results.dataset import PAPER

HEADLINE = ("real contact", "largest pressure", "largest von Mises stress", "at depth", "volume above yield")
"""Numbers at the top of the report."""

SPOTS = 10
"""Patches of contact in the report."""

PACKAGES = ("numpy", "numba", "ducc0", "xarray", "SurfaceTopography")
"""Packages whose versions the report names."""


def report_page(answer: Answer, pictures: Sequence[tuple[Picture, bytes]], case_file: str) -> str:
    """The report as HTML.

    Parameters
    ----------
    answer : Answer
    pictures : sequence of (Picture, content of its PNG file)
        They become part of the page.
    case_file : str
        Content of the case file that repeats the answer.
    """
    installed = [package for package in PACKAGES if find_spec(package)]
    versions = {"asperity": __version__, "Python": platform.python_version()}
    versions |= {package: version(package) for package in installed}
    groups: dict[str, list[tuple[Picture, str]]] = {}
    for picture, image in pictures:
        title = body_title(answer.case, picture.body) if picture.body and len(answer.bodies) > 1 else ""
        groups.setdefault(title, []).append((picture, base64.b64encode(image).decode()))
    return rendered(
        "asperity.engineering",
        "report.html.j2",
        title=f"{answer.face.name}: contact and stress",
        answer=answer,
        case=case_in_words(answer.case),
        warnings=[advice for advice in answer.advice if advice.level == WARNING],
        notes=[advice for advice in answer.advice if advice.level != WARNING],
        headline=headline(answer),
        groups=groupby(answer.rows, key=lambda row: row.group),
        picture_groups=groups,
        case_file=case_file,
        date=datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        spots=answer.spots.head(SPOTS),
        gaps=answer.gaps().set_index("share")["gap_m"],
        versions=versions,
        paper=PAPER,
    )


def headline(answer: Answer) -> list[tuple[str, str, str]]:
    """The numbers that are asked for first: name, value and estimate."""
    several = len(answer.case.different_bodies) > 1
    found = []
    for row in answer.rows:
        if row.name in HEADLINE:
            value, _, estimate = row.shown.partition("; ")
            body = row.group.removeprefix("stress in the ").partition(" (")[0]
            of_body = several and row.group != "contact"
            found.append((f"{row.name}, {body}" if of_body else row.name, value, estimate))
    return found
