"""Tables and figure of docs/multilevel.md, from the results of an ensemble."""

from __future__ import annotations

import shutil
from pathlib import Path

from asperity.paper.claims.documents import with_sections

PAGE = Path("docs/multilevel.md")
PICTURE = Path("docs/multilevel.png")
SECTIONS = {"run": "table.md", "gains": "gains.md"}
"""Section of the page → table of the ensemble."""


def page(text: str, results: Path) -> str:
    """The page with the tables of a folder of results.

    Parameters
    ----------
    text : str
        The page, with the marks of all `SECTIONS`.
    results : Path
    """
    tables = results / "ensemble"
    return with_sections(
        text, {name: (tables / table).read_text(encoding="utf-8") for name, table in SECTIONS.items()}
    )


def keep(results: Path, root: Path = Path()) -> None:
    """Write the tables of a folder of results to the page, and its figure beside the page."""
    place = root / PAGE
    place.write_text(page(place.read_text(encoding="utf-8"), results), encoding="utf-8")
    shutil.copyfile(results / "ensemble/cost.png", root / PICTURE)
