"""The report of a study: its figures, verdicts, checks and costs on one HTML page that needs no network."""

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from asperity.core.markup import html_table, rendered
from asperity.paper import PAPER
from asperity.paper.claims.report import counted, findings_of, tables
from asperity.paper.claims.verdicts import CLAIMS, tally
from asperity.paper.figures import Description
from asperity.results.atomic import write_text
from asperity.study.cost.benchmark import cost_table, job_costs
from asperity.study.cost.model import minutes
from asperity.study.validation.table import for_reader

GROUPS = ("Figures of the paper", "Figures", "Supplement")


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
        Name → description, as of `asperity.paper.figures.figures_of`.
    config : mapping
        The configuration of the study.
    """
    jobs, costs = job_costs(results), ""
    if len(jobs):
        table = cost_table(jobs, "rule")[["job", "jobs", "processor_minutes", "largest_memory_MB"]]
        table["job"] = table["job"].str.replace("_", " ")
        table["processor_minutes"] = (60 * table["processor_minutes"]).map(minutes)
        table["largest_memory_MB"] = table["largest_memory_MB"].map("{:.0f} MB".format)
        costs = html_table(table.set_axis(["rule", "jobs", "processor time", "largest memory"], axis=1))
    laws_of_seeds = [pd.read_csv(path) for path in sorted((results / "verification").glob("*.csv"))]
    checks = None
    if laws_of_seeds:
        laws = pd.concat(laws_of_seeds, ignore_index=True)
        share = (laws["value"] / laws["bound"]).where(laws["bound"] > 0, laws["value"])
        worst = laws.loc[share.groupby(laws["check"], sort=False).idxmax()]
        columns = {"value": "largest value", "of": "seed"}
        table = worst[["check", "value", "bound", "surface", "of"]].rename(columns=columns)
        checks = {"count": len(laws), "surfaces": laws["surface"].nunique(), "table": html_table(table)}
    validation, claims = "", None
    if (errors := results / "validation/table.csv").exists():
        validation = html_table(for_reader(pd.read_csv(errors, keep_default_na=False)))
    if (interpretations := results / "interpretations.csv").exists():
        findings = findings_of(pd.read_csv(interpretations), CLAIMS)
        claims = {
            "count": len(findings),
            "counted": counted(findings),
            "tally": tally(findings),
            "sections": {head: rows.to_dict("records") for head, rows in tables(findings).items()},
            "picture": _embedded(results / "claims.png"),
        }
    page = rendered(
        "asperity.paper",
        "page.html.j2",
        title="Does the paper hold?" if config["claims"] else f"Study: {results.name}",
        config=config,
        groups=_groups(results, figures),
        claims=claims,
        checks=checks,
        validation=validation,
        costs=costs,
        minutes=float(jobs["processor_minutes"].sum()),
        memory=float(jobs["memory_MB"].max()) if len(jobs) else 0.0,
        jobs=len(jobs),
        paper=PAPER,
    )
    write_text(path, page)


def _groups(results: Path, figures: Mapping[str, Description]) -> dict[str, list[dict[str, str]]]:
    """Heading → pictures, in their order: name, title and caption as HTML, and the file as a data URI.

    Figures of the paper are sorted by number; figures without a number follow, each with its variants.
    """
    groups: dict[str, list[dict[str, str]]] = {name: [] for name in GROUPS}
    for figure in sorted(figures.values(), key=lambda one: (not one.number, one.number or 0, one.name)):
        file = results / "figures" / f"{figure.name}.png"
        if file.exists():
            title, _, caption = file.with_suffix(".rst").read_text(encoding="utf-8").partition("\n\n")
            title += f" ({figure.name})" if figure.category == "Supplement" else ""
            picture = {"title": _html(title), "caption": _html(caption), "data": _embedded(file)}
            groups[figure.category].append({"name": figure.name, **picture})
    return {name: pictures for name, pictures in groups.items() if pictures}


def _html(text: str) -> str:
    """ReStructuredText as HTML, mathematics as MathML."""
    from docutils.core import publish_parts

    settings = {"math_output": "MathML", "report_level": 5}
    unsafe = {"file_insertion_enabled": False, "raw_enabled": False}
    return publish_parts(text, writer="html5", settings_overrides=settings | unsafe)["fragment"].strip()


def _embedded(file: Path) -> str:
    return "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode()
