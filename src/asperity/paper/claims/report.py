"""Tables of the verdicts, as a data frame and for a reader."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

import asperity
from asperity.paper.claims.continuum import continuum
from asperity.paper.claims.evidence import Evidence, Measure
from asperity.paper.claims.verdicts import CONFIDENCE, Finding, tally
from asperity.results import markup

_RULE = f"""\
A statement holds if the {100 * CONFIDENCE:g} % interval of the mean over seeds (Student's t, paired by
seed) lies inside the region predicted; it does not hold if the interval lies outside; otherwise this ensemble
does not decide it. One seed decides nothing. Values without seeds are those of closed forms and finite
elements, with their numerical uncertainty. One in twenty intervals of 95 % is expected to miss the truth.

*Continuum* is what vanishing grid spacing adds to the value: the same statement on the same surfaces in a
smaller cell at 8, 16 and 32 nodes on the shortest wavelength, extrapolated."""

_HEAD = ("the paper says", "measured", "predicted", "value", "verdict", "continuum")


def frame(findings: Sequence[Finding], nodes: float) -> pd.DataFrame:
    """All that is known of each claim, a row each; `nodes` on the shortest wavelength in the study."""
    return pd.DataFrame(
        {
            "identifier": f.claim.identifier,
            "section": f.claim.section,
            "the paper says": f.claim.sentence,
            "measured": f.claim.quantity,
            "predicted": str(f.claim.region),
            "value": f.value,
            "standard error": f.error,
            "interval low": f.low,
            "interval high": f.high,
            "seeds": f.seeds,
            "verdict": f.verdict,
            "nodes per shortest wavelength": nodes if f.seeds else np.nan,
            "continuum shift": f.shift,
            "continuum shift error": f.shift_error,
            "missing": f.missing,
        }
        for f in findings
    )


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
                f.claim.quantity,
                str(f.claim.region),
                with_error(f.value, f.error),
                f"**{f.verdict}**" + (f" ({f.missing})" if f.missing else ""),
                with_error(f.shift, f.shift_error, signed=True),
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
        f"asperity {asperity.__version__}.",
        _RULE,
    ]
    for heading, table in tables(findings, limits).items():
        parts += [f"## {heading}", markup.markdown(table)]
    return "\n\n".join(parts) + "\n"


def page(findings: Sequence[Finding], limits: pd.DataFrame | None = None) -> str:
    """The findings as an HTML page, for the report of the workflow."""
    return markup.page("Does the paper hold?", tables(findings, limits))


def with_error(value: float, error: float, signed: bool = False) -> str:
    """A number with its error to two digits: ``1.445 ± 0.012``; three digits where there is no error."""
    if np.isnan(value):
        return ""
    sign = "+" if signed else ""
    if np.isnan(error) or error == 0:
        return f"{value:{sign}.3g}"
    digits = min(max(0, 1 - int(np.floor(np.log10(error)))), 12)
    return f"{value:{sign}.{digits}f} ± {error:.{digits}f}"
