"""The report of an answer: one HTML page that a browser opens without a network."""

from __future__ import annotations

import base64
import platform
from collections.abc import Sequence
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from itertools import groupby

from asperity.core.units import shown_si
from asperity.core.version import __version__
from asperity.engineering.advice import WARNING
from asperity.engineering.answer import Answer, body_title, case_in_words
from asperity.engineering.pictures import Picture
from asperity.results.dataset import PAPER

HEADLINE = (
    *("real contact", "largest pressure"),
    *("largest von Mises stress", "at depth", "volume above yield"),
)
"""Numbers at the top of the report."""

SPOTS = 10
"""Patches of contact in the report."""

SPOT_COLUMNS = {
    "load_N": "N",
    "area_m2": "m^2",
    **dict.fromkeys(("x_m", "y_m", "length_m", "width_m"), "m"),
    "largest_pressure_Pa": "Pa",
}
"""Column of the table of patches in the report → its unit."""

GAP_SHARES = (0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99)
"""Shares of the area whose gap the report has."""

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
        case_file=case_file,
        date=datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        spots=spot_rows(answer),
        gaps=gap_rows(answer),
        versions=versions(),
        paper=PAPER,
        version=__version__,
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


def spot_rows(answer: Answer) -> list[list[str]]:
    """The patches of contact that bear most of the load, in words."""
    spots = answer.spots.head(SPOTS)
    return [
        [shown_si(float(size), unit, 3) for size, unit in zip(row, SPOT_COLUMNS.values(), strict=True)]
        for row in spots[[*SPOT_COLUMNS]].to_numpy()
    ]


def gap_rows(answer: Answer) -> list[tuple[str, str]]:
    """Shares of the area, and the gap that they have or are below."""
    gaps = answer.gaps().set_index("share")["gap_m"]
    return [(f"{100 * share:g} %", shown_si(gaps.loc[share], "m", 3)) for share in GAP_SHARES]


def versions() -> list[tuple[str, str]]:
    """Names and versions of what computed the answer."""
    found = [("asperity", __version__), ("Python", platform.python_version())]
    for package in PACKAGES:
        try:
            found.append((package, version(package)))
        except PackageNotFoundError:
            continue
    return found
