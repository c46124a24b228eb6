"""The report of a study: its figures, verdicts, checks and costs on one HTML page that needs no network."""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

import asperity
from asperity.accuracy.tables import errors_for_reader, presets_for_reader
from asperity.markup import html_table, inline
from asperity.paper.figures import Description
from asperity.results.atomic import atomic_write
from asperity.results.dataset import PAPER
from asperity.runtime.costs import cost_table, job_costs
from asperity.validation.table import Row, for_reader

CHAINS = (
    ("surface", "contact", "stress", "statistics", "figure"),
    ("validation",),
    ("tradeoff", "tradeoff_figures"),
)
"""Rules that follow each other; verification and claims are made from the results of the first chain too."""

WORDS = {
    "surface": "rough surfaces",
    "contact": "contacts",
    "stress": "stress inside the solid",
    "statistics": "statistics",
    "figure": "figures",
    "verification": "verification",
    "claims": "claims",
    "validation": "validation",
    "tradeoff": "speed and accuracy",
    "tradeoff_figures": "its figures",
}
"""Rule → what it makes, for a reader. Other rules prepare the work of these."""

GROUPS = ("Figures of the paper", "Figures", "Supplement")


class Picture(NamedTuple):
    """A picture with its caption.

    Parameters
    ----------
    name : str
        Of its files, and its anchor on the page.
    title, caption : str
        HTML.
    data : str
        The file as a data URI.
    """

    name: str
    title: str
    caption: str
    data: str


def write_page(
    path: Path, results: Path, figures: Mapping[str, Description], config: Mapping[str, Any]
) -> None:
    """Write the report of a finished study.

    Parameters
    ----------
    path : Path
        The page.
    results : Path
        Folder of the results. Parts that the study does not have are left out.
    figures : mapping
        Name → description, as of `asperity.paper.figures.describe_all`.
    config : mapping
        The configuration of the study.
    """
    from jinja2 import Environment, StrictUndefined

    text = files("asperity.paper").joinpath("page.html.j2").read_text(encoding="utf-8")
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    jobs = job_costs(results / "log")
    page = environment.from_string(text).render(
        title="Does the paper hold?" if config["claims"] else f"Study: {results.name}",
        config=config,
        groups=_groups(results, figures),
        claims=_claims(results),
        checks=_verification(results),
        validation=_validation(results),
        tradeoff=_tradeoff(results),
        chains=_chains(jobs),
        costs=_costs(jobs),
        minutes=float(jobs["processor_minutes"].sum()),
        memory=float(jobs["memory_MB"].max()) if len(jobs) else 0.0,
        jobs=len(jobs),
        paper=PAPER,
        version=asperity.__version__,
    )
    with atomic_write(path) as unfinished:
        unfinished.write_text(page, encoding="utf-8", newline="\n")


def order(figures: Mapping[str, Description]) -> list[Description]:
    """Figures as they are read: those of the paper by number, then those without, each with its variants."""
    return sorted(
        figures.values(), key=lambda one: (not one.in_paper, not one.number, int(one.number or 0), one.name)
    )


def _groups(results: Path, figures: Mapping[str, Description]) -> dict[str, list[Picture]]:
    """Heading → pictures, in their order."""
    groups: dict[str, list[Picture]] = {name: [] for name in GROUPS}
    for figure in order(figures):
        file = results / "figures" / f"{figure.name}.png"
        if file.exists():
            title, _, caption = file.with_suffix(".rst").read_text(encoding="utf-8").partition("\n\n")
            name = "" if figure.in_paper or figure.own else f" ({figure.name})"
            picture = Picture(figure.name, _html(title + name), _html(caption), _embedded(file))
            groups[figure.category].append(picture)
    return {name: pictures for name, pictures in groups.items() if pictures}


def _html(text: str) -> str:
    """ReStructuredText as HTML, mathematics as MathML."""
    from docutils.core import publish_parts

    settings = {
        "math_output": "MathML",
        "file_insertion_enabled": False,
        "raw_enabled": False,
        "report_level": 5,
    }
    return publish_parts(text, writer="html5", settings_overrides=settings)["fragment"].strip()


def _embedded(file: Path) -> str:
    return "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode()


def _claims(results: Path) -> dict[str, Any] | None:
    """The verdicts: their numbers, the overview picture and a table for each section of the paper."""
    if not (results / "claims.csv").exists():
        return None
    table = pd.read_csv(
        results / "claims.csv", keep_default_na=False, na_values={"value": [""], "standard error": [""]}
    )
    tally = table["verdict"].value_counts(sort=False).to_dict()
    sections: dict[str, list[dict[str, Any]]] = {}
    for row in table.to_dict("records"):
        names = str(row["section"]).split(", ")
        section = next((name for name in names if name[:1].isdigit()), names[0])
        readings = [reading for reading in str(row.get("readings", "")).split("; ") if reading]
        sections.setdefault(section, []).append(
            {
                "sentence": inline(str(row["the paper says"])),
                "measured": inline(str(row["measured"])),
                "predicted": row["predicted"],
                "value": _with_error(row["value"], row["standard error"]),
                "verdict": row["verdict"],
                "choices": row.get("choices", ""),
                "readings": readings if len(readings) > 1 else [],
                "missing": row["missing"],
            }
        )
    picture = results / "claims.png"
    return {
        "tally": tally,
        "sections": dict(sorted(sections.items())),
        "picture": _embedded(picture) if picture.exists() else "",
    }


def _with_error(value: float, error: float) -> str:
    """A number with its error to two digits."""
    if math.isnan(value):
        return ""
    if math.isnan(error) or error == 0:
        return f"{value:.3g}"
    digits = min(max(0, 1 - math.floor(math.log10(error))), 12)
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def _verification(results: Path) -> dict[str, Any] | None:
    """Number of checks and surfaces, and the table of each law where it was broken most."""
    tables = [pd.read_csv(path) for path in sorted((results / "verification").glob("*.csv"))]
    if not tables:
        return None
    checks = pd.concat(tables, ignore_index=True)
    share = (checks["value"] / checks["bound"]).where(checks["bound"] > 0, checks["value"])
    worst = checks.loc[share.groupby(checks["check"], sort=False).idxmax()]
    shown = worst[["check", "value", "bound", "surface", "of"]].rename(
        columns={"value": "largest value", "of": "seed"}
    )
    return {"count": len(checks), "surfaces": checks["surface"].nunique(), "table": html_table(shown)}


def _validation(results: Path) -> str:
    """The table of the validation, as HTML."""
    path = results / "validation/table.csv"
    if not path.exists():
        return ""
    table = pd.read_csv(path, keep_default_na=False).drop(columns="holds")
    return html_table(for_reader([Row(**row) for row in table.to_dict("records")]))


def _tradeoff(results: Path) -> dict[str, Any] | None:
    """Presets and errors, as HTML, and the pictures of the measurement."""
    folder = results / "tradeoff/reduced"
    if not (folder / "presets.csv").exists():
        return None
    errors = pd.read_csv(folder / "errors.csv", dtype={"setting": str})
    return {
        "presets": html_table(presets_for_reader(pd.read_csv(folder / "presets.csv"))),
        "errors": html_table(errors_for_reader(errors)),
        "pictures": [_embedded(path) for path in sorted(folder.glob("*.png"))],
    }


def _chains(jobs: pd.DataFrame) -> list[list[dict[str, Any]]]:
    """The rules that made something for a reader, in their order, with what they took."""
    of_rule = {str(name): group for name, group in jobs.groupby("rule")}
    first, *others = ([_step(name, of_rule[name]) for name in chain if name in of_rule] for chain in CHAINS)
    first += [_step(name, of_rule[name]) for name in ("verification", "claims") if name in of_rule]
    return [chain for chain in (first, *others) if chain]


def _step(name: str, jobs: pd.DataFrame) -> dict[str, Any]:
    return {
        "name": WORDS[name],
        "jobs": len(jobs),
        "minutes": _minutes(jobs["processor_minutes"].sum()),
        "after": name in ("verification", "claims"),
    }


def _minutes(minutes: float) -> str:
    return f"{minutes:.1f} min" if minutes >= 1 else f"{60 * minutes:.0f} s"


def _costs(jobs: pd.DataFrame) -> str:
    """Table of the costs by rule, as HTML."""
    if jobs.empty:
        return ""
    table = cost_table(jobs, "rule")
    shown = pd.DataFrame(
        {
            "rule": table["job"].str.replace("_", " "),
            "jobs": table["jobs"],
            "processor time": table["processor_minutes"].map(_minutes),
            "largest memory": table["largest_memory_MB"].map("{:.0f} MB".format),
        }
    )
    return html_table(shown)
