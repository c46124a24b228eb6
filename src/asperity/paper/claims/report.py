"""Tables of the verdicts: for a reader, and as data frames from which they can be read again."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from asperity.core import markup
from asperity.paper.claims import verdicts
from asperity.paper.claims.sources import OPTIONS
from asperity.paper.claims.verdicts import Claim, Finding, Judgement
from asperity.results.tables import TABLES

COUNTED = {
    verdicts.HOLDS: "hold under every interpretation",
    verdicts.FAILS: "hold under none",
    verdicts.DEPENDS: "depend on the interpretation",
    verdicts.UNDECIDED: "are not decided",
    verdicts.UNTESTABLE: "cannot be tested here",
}
"""Verdict → words after the number of statements that have it."""

WORDS = {option: words for one in OPTIONS.values() if isinstance(one, dict) for option, words in one.items()}
"""Option of a choice → the interpretation in words."""


def frame(findings: Sequence[Finding]) -> pd.DataFrame:
    """Description, numbers and verdict of each claim, a row each."""
    rows = []
    for f in findings:
        words = {"the paper says": f.claim.sentence, "wanted": str(f.own.region), "found": found_in_words(f)}
        rows.append(_record(f.own) | vars(f.claim) | words | {"verdict": f.verdict})
    return pd.DataFrame(rows, columns=list(TABLES["claims"]["columns"]))


def frame_of_interpretations(findings: Sequence[Finding]) -> pd.DataFrame:
    """The judgement of every claim under every interpretation, a row each, the study's own first."""
    pairs = ((f.claim.identifier, one) for f in findings for one in f.judgements)
    return pd.DataFrame({"identifier": identifier, **_record(one)} for identifier, one in pairs)


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
        verdicts.conclude(claim, [Judgement(**row) for row in of_claim[claim.identifier].to_dict("records")])
        for claim in claims
        if claim.identifier in of_claim
    ]


def counted(findings: Sequence[Finding]) -> str:
    """Number of statements with each verdict, in words."""
    counts = verdicts.tally(findings)
    return ", ".join(f"{counts[verdict]} {text}" for verdict, text in COUNTED.items() if counts[verdict])


def tables(findings: Sequence[Finding]) -> dict[str, pd.DataFrame]:
    """The findings for a reader: a heading for each section of the paper → a table."""
    table = frame(findings)
    names = table["section"].str.split(", ")
    sections = names.map(lambda each: next((name for name in each if name[0].isdigit()), each[0]))
    table["verdict"] = "**" + table["verdict"].str.removesuffix(" on the interpretation") + "**"
    shown = table[["the paper says", "compared", "wanted", "found", "verdict"]]
    return {f"Section {name}": rows for name, rows in shown.groupby(sections)}


def markdown(findings: Sequence[Finding]) -> str:
    """The findings as text: their counts, and a table for each section of the paper."""
    parts = [f"**Of {len(findings)} statements {counted(findings)}.**"]
    for heading, table in tables(findings).items():
        parts += [f"## {heading}", markup.markdown(table)]
    return "\n\n".join(parts) + "\n"


def found_in_words(finding: Finding) -> str:
    """The number of a claim and its interval, under several interpretations if their verdicts differ."""
    if finding.verdict not in (verdicts.DEPENDS, verdicts.UNDECIDED) or not finding.choices:
        untestable = finding.claim.untestable if finding.verdict == verdicts.UNTESTABLE else ""
        reason = finding.own.missing or untestable
        return "; ".join(filter(None, (_number(finding.own), reason)))
    parts = []
    for one in finding.shown:
        words = []  # the options that tell the verdicts apart, and others that are not the study's own
        for choice, option in one.interpretation.items():
            if choice in finding.choices or option != finding.own.interpretation[choice]:
                if choice == "alike":
                    words.append(f"the same up to {100 * option:g} %")
                else:
                    words.append(f"δ = {option:g}" if choice == "delta" else WORDS.get(option, str(option)))
        parts.append(f"{', '.join(words)}: {_number(one)} {one.verdict}")
    return "; ".join(parts)


def _number(one: Judgement) -> str:
    """The number of a judgement with its interval; empty without data."""
    if not np.isfinite(one.value):
        return ""
    if not one.interval_low < one.interval_high:
        return f"{one.value:.3g}"
    return f"{one.value:.4g} ({one.interval_low:.4g} to {one.interval_high:.4g})"
