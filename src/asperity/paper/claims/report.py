"""Tables of the verdicts: for a reader, and as data frames from which they can be read again."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from asperity.core import markup
from asperity.core.markup import with_error
from asperity.core.version import __version__
from asperity.paper.claims.continuum import continuum
from asperity.paper.claims.numbers import Evidence, Measure
from asperity.paper.claims.paper import Claim
from asperity.paper.claims.verdicts import (
    CONFIDENCE,
    DEPENDS,
    UNDECIDED,
    UNTESTABLE,
    Finding,
    Judgement,
    conclude,
    tally,
)
from asperity.results.tables import TABLES

_RULE = f"""\
Under one interpretation of the paper a statement holds if the {100 * CONFIDENCE:g} % interval of the mean
over seeds (Student's t, paired by seed) lies inside the region predicted; it does not hold if the interval
lies outside; otherwise this ensemble does not decide it. Over all interpretations that the paper's text
admits (docs/claims.md) it *holds* or *does not hold* if it does under every one, and *depends on* a choice if
it holds under one option and not under another. One seed decides nothing. Values without seeds are those of
closed forms and finite elements, with their numerical uncertainty. One in twenty intervals of 95 % is
expected to miss the truth.

The value is that of the study's own interpretation: the continuum limit, where it is known and differs from
the number on the study's grid by more than the standard error. *Shift* is what vanishing grid spacing adds:
the same statement on the same surfaces in a smaller cell at 8, 16 and 32 nodes on the shortest wavelength,
extrapolated."""

_HEAD = ("the paper says", "measured", "predicted", "value", "verdict", "shift")


def frame(findings: Sequence[Finding], nodes: float) -> pd.DataFrame:
    """All that is known of each claim, a row each; `nodes` on the shortest wavelength in the study."""
    rows = [
        _record(f.own)
        | {
            "identifier": f.claim.identifier,
            "section": f.claim.section,
            "the paper says": f.claim.sentence,
            "measured": f.claim.measured,
            "predicted": str(f.own.region),
            "verdict": f.verdict,
            "choices": ", ".join(f.choices),
            "interpretations": "; ".join(in_words(one, f.choices) for one in f.shown),
            "nodes per shortest wavelength": nodes if f.own.seeds else np.nan,
        }
        for f in findings
    ]
    return pd.DataFrame(rows, columns=list(TABLES["claims"]["columns"]))


def frame_of_interpretations(findings: Sequence[Finding]) -> pd.DataFrame:
    """The judgement of every claim under every interpretation, a row each, the study's own first."""
    return pd.DataFrame(
        {"identifier": f.claim.identifier, **_record(one)} for f in findings for one in f.judgements
    )


def _record(one: Judgement) -> dict[str, Any]:
    """A judgement as a row of a table."""
    row = {name.replace("_", " "): value for name, value in vars(one).items()}
    return row | {"interpretation": json.dumps(dict(one.interpretation))}


def findings_of(table: pd.DataFrame, claims: Sequence[Claim]) -> list[Finding]:
    """The findings from the table of `frame_of_interpretations`, in the order of the claims."""
    table = table.astype({"missing": object}).fillna({"missing": ""})
    table = table.rename(columns=lambda name: name.replace(" ", "_"))
    table["interpretation"] = table["interpretation"].map(json.loads)
    of_claim = {name: rows.drop(columns="identifier") for name, rows in table.groupby("identifier")}
    return [
        conclude(claim, [Judgement(**row) for row in of_claim[claim.identifier].to_dict("records")])
        for claim in claims
        if claim.identifier in of_claim
    ]


def in_words(one: Judgement, choices: Sequence[str]) -> str:
    """A judgement under the options of some choices: ``lateral free: 1.56 (1.54 to 1.59) holds``."""
    options = ", ".join(f"{name} {option_in_words(one.interpretation[name])}" for name in choices)
    interval = (
        f" ({one.interval_low:.4g} to {one.interval_high:.4g})" if np.isfinite(one.interval_low) else ""
    )
    return f"{options}: {one.value:.4g}{interval} {one.verdict}".removeprefix(": ")


def option_in_words(option: object) -> str:
    """An option of a choice as text: numbers in few characters, names without underscores."""
    return f"{option:g}" if isinstance(option, float | int) else str(option).replace("_", " ")


def verdict_in_words(finding: Finding) -> str:
    """The verdict of a claim with the choices and the interpretations that show it."""
    if finding.verdict == DEPENDS:
        head = f"**depends on {', '.join(finding.choices)}**"
    elif finding.verdict == UNDECIDED and finding.choices:
        head = f"**{UNDECIDED}** under every option of {', '.join(finding.choices)}"
    else:
        reason = finding.own.missing or (finding.claim.untestable if finding.verdict == UNTESTABLE else "")
        return f"**{finding.verdict}**" + (f" ({reason})" if reason else "")
    return f"{head}: " + "; ".join(in_words(one, _named(finding, one)) for one in finding.shown)


def _named(finding: Finding, one: Judgement) -> tuple[str, ...]:
    """Choices to name with a judgement: those of the verdict, and those with another option than own."""
    own = finding.own.interpretation
    return tuple(name for name in own if name in finding.choices or one.interpretation[name] != own[name])


def tables(findings: Sequence[Finding], limits: pd.DataFrame | None = None) -> dict[str, pd.DataFrame]:
    """The findings for a reader: a heading for each section of the paper → a table.

    A last table shows `limits`, the result of `continuum_table`, unless it is empty.
    """
    found: dict[str, list[list[str]]] = {}
    for f in findings:
        names = f.claim.section.split(", ")
        section = next((name for name in names if name[0].isdigit()), names[0])
        found.setdefault(f"Section {section}", []).append(
            [
                f.claim.sentence,
                f.claim.measured,
                str(f.own.region),
                with_error(f.own.value, f.own.standard_error),
                verdict_in_words(f),
                with_error(f.own.continuum_shift, f.own.continuum_shift_error, signed=True),
            ]
        )
    every = {heading: pd.DataFrame(found[heading], columns=list(_HEAD)) for heading in sorted(found)}
    if limits is not None and not limits.empty:
        every["Towards the continuum"] = limits
    return every


def continuum_table(headlines: Mapping[str, Measure], finer: Mapping[float, Evidence]) -> pd.DataFrame:
    """Headline numbers on finer and finer grids and their limits; empty without such grids."""
    rows = []
    for name, measure in headlines.items() if len(finer) > 1 else ():
        found = continuum(measure, finer)
        values = {
            f"{n:g} nodes": f"{value:.4g}" for n, value in zip(sorted(finer), found.values, strict=True)
        }
        rows.append({"": name, **values, "limit": with_error(found.limit, found.error)})
    return pd.DataFrame(rows)


def markdown(
    findings: Sequence[Finding], seeds: Sequence[int], nodes: float, limits: pd.DataFrame | None = None
) -> str:
    """The findings as a document: the tally, the rule, and a table for each section of the paper.

    Parameters
    ----------
    findings : sequence of Finding
    seeds : sequence of int
    nodes : float
        On the shortest wavelength in the study.
    limits : data frame, optional
        As of `continuum_table`.
    """
    counts = ", ".join(f"{count} {verdict}" for verdict, count in tally(findings).items() if count)
    parts = [
        "# Does the paper hold?",
        f"{len(findings)} statements: {counts}.",
        f"Seeds {', '.join(map(str, seeds))}; {nodes:g} nodes on the shortest wavelength; "
        f"asperity {__version__}.",
        _RULE,
    ]
    for heading, table in tables(findings, limits).items():
        parts += [f"## {heading}", markup.markdown(table)]
    return "\n\n".join(parts) + "\n"
