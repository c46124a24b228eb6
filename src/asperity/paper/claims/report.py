"""Verdicts as tables for a reader, as data frames that can be read back, and as a picture."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import stdtrit

from asperity.core import markup
from asperity.paper.claims import verdicts
from asperity.paper.claims.sources import OPTIONS
from asperity.paper.claims.verdicts import Claim, Finding, Judgement
from asperity.results.tables import TABLES
from asperity.views.style import MILLIMETRE, PAGE

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


def beside(findings: Sequence[Finding], larger: Mapping[int, Sequence[Finding]]) -> pd.DataFrame:
    """Statements that a study leaves undecided, and what larger studies find of them, a row each.

    Parameters
    ----------
    findings : sequence of Finding
    larger : mapping
        Nodes on the shortest wave → findings of a study on such a grid. Under each interpretation the
        narrowest interval decides.
    """
    rows = []
    for before in findings:
        studies = {n: f for n, found in larger.items() for f in found if f.claim == before.claim}
        if before.verdict != verdicts.UNDECIDED or not studies:
            continue
        judged = [
            {n: one for n, f in studies.items() for one in f.judgements if one.interpretation == options}
            for options in (one.interpretation for one in studies[min(studies)].judgements)
        ]
        joined = verdicts.conclude(before.claim, [_narrowest(grids) for grids in judged])
        nodes = next(n for n, one in judged[0].items() if one is joined.own)
        verdict = joined.verdict.removesuffix(" on the interpretation")
        if joined.verdict == verdicts.UNDECIDED:
            still = [grids for grids in judged if _narrowest(grids).verdict == verdicts.UNDECIDED]
            verdict += f": {why_open(min(still, key=lambda grids: _distance(_narrowest(grids))))}"
        rows.append(
            {
                "the paper says": before.claim.sentence,
                "wanted": str(before.own.region),
                f"{before.own.seeds} seeds": found_in_words(before),
                "larger study": f"{joined.own.seeds} seeds, {nodes} nodes: {found_in_words(joined)}",
                "verdict": verdict,
            }
        )
    return pd.DataFrame(rows)


def _narrowest(grids: Mapping[int, Judgement]) -> Judgement:
    return min(grids.values(), key=lambda one: one.interval_high - one.interval_low)


def _distance(one: Judgement) -> float:
    """Distance of a number from the nearest edge of its region."""
    return float(np.abs(np.subtract(one.value, one.region)).min())


def why_open(grids: Mapping[int, Judgement]) -> str:
    """Why an interpretation is not decided, and how many nodes and seeds would decide it.

    Half of the variance is given to the grid, half to the seeds, and the number is taken to stay where it is.

    Parameters
    ----------
    grids : mapping
        Nodes on the shortest wave → judgement. The discretisation error is taken to fall as from the coarsest
        to the finest grid, or, on one grid, in proportion to the spacing.
    """
    one = _narrowest(grids)
    first, last = min(grids), max(grids)
    coarse, fine = grids[first], grids[last]
    distance = _distance(one)
    half = distance / np.sqrt(2)
    nodes = last
    if fine.grid_error > half:
        fall = coarse.grid_error / fine.grid_error
        order = np.log(fall) / np.log(last / first) if fall > 1 else 1.0
        nodes *= 2 ** int(np.ceil(np.log2(fine.grid_error / half) / order))
    seeds = np.arange(2, 10_000)
    scatter = one.standard_error * np.sqrt(one.seeds)
    enough = seeds[stdtrit(seeds - 1, 0.5 + verdicts.CONFIDENCE / 2) * scatter / np.sqrt(seeds) < half]
    needed = f"{enough[0]}" if enough.size else f"more than {seeds[-1]}"
    return (
        f"{distance:.2g} from the edge of the region, beside a discretisation error of {one.grid_error:.2g}; "
        f"{nodes} nodes and {needed} seeds are needed"
    )


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


_COLOUR = dict(zip(verdicts.VERDICTS, ("C0", "C1", "C2", "0.45", "0.6", "0.75"), strict=True))
_MARKER = dict(zip(verdicts.VERDICTS, "os^D+x", strict=True))
_ROW = 4.6
"""Height of a row, in millimetres."""

_LOW, _HIGH = 0.4, 2.5
"""Ends of the axis, in units of the edge or the middle of the region."""

_BESIDE = 0.25
"""Distance of other interpretations from the middle of a row, in rows."""

_WIDE = 1.5
"""Ratio of the edges of a region above which its lower edge is the unit, not its middle."""


def picture(findings: Sequence[Finding]) -> Figure:
    """Draw a row for each claim on a common axis: the number over the edge of its region, or its middle.

    A row shows the study's own interpretation, and in pale the others that show the verdict. Numbers beyond
    the axis are drawn at its end as triangles; every number is written at the right.
    """
    count = len(findings)
    figure = Figure(figsize=(PAGE, (count * _ROW + 22) * MILLIMETRE))
    axis = figure.add_subplot()
    for row, finding in enumerate(findings):
        low, high = finding.own.region
        unit = _unit(low, high)
        left, right = np.clip([low / unit, high / unit], _LOW, _HIGH)
        axis.barh(row, right - left, left=left, height=0.8, color="C4", alpha=0.25, lw=0)
        colour, marker = _COLOUR[finding.verdict], _MARKER[finding.verdict]
        if finding.verdict != verdicts.NO_DATA:
            for other in finding.shown:
                if other is not finding.own:
                    _draw_judgement(axis, row + _BESIDE, other, unit, colour, marker, alpha=0.4)
            _draw_judgement(axis, row, finding.own, unit, colour, marker)
        text = verdicts.NO_DATA if finding.verdict == verdicts.NO_DATA else f"{finding.own.value:.3g}"
        beside = axis.get_yaxis_transform()
        axis.text(1.01, row, text, transform=beside, va="center", fontsize=5.5, color=colour)
    axis.axvline(1.0, color="k", lw=0.5)
    axis.set(xscale="log", xlim=(_LOW, _HIGH), ylim=(count - 0.4, -0.6))
    axis.set_xticks([0.5, 0.7, 1, 1.5, 2], ["0.5", "0.7", "1", "1.5", "2"])
    axis.set_xticks([], minor=True)
    sentences = [f"{f.claim.sentence}  ({f.claim.section})" for f in findings]
    axis.set_yticks(range(count), sentences, fontsize=5.5)
    axis.tick_params(axis="y", length=0)
    axis.set_xlabel("measured over the edge or the middle\nof the region wanted (shaded)")
    for verdict, number in verdicts.tally(findings).items():
        if number:
            look: dict[str, Any] = {"marker": _MARKER[verdict], "color": _COLOUR[verdict], "ls": "none"}
            axis.plot([], [], **look, label=f"{verdict} ({number})")
    figure.legend(loc="outside upper right", ncols=3)
    return figure


def _draw_judgement(
    axis: Axes, row: float, one: Judgement, unit: float, colour: str, marker: str, alpha: float = 1.0
) -> None:
    """Draw the number and the interval under one interpretation."""
    value = one.value / unit
    shown = float(np.clip(value, _LOW * 1.02, _HIGH / 1.02))
    if value != shown:
        marker = ">" if value > shown else "<"
    elif np.isfinite(one.interval_low):
        interval = np.clip([one.interval_low / unit, one.interval_high / unit], _LOW, _HIGH)
        axis.plot(interval, [row, row], color=colour, alpha=alpha)
    axis.plot(shown, row, marker, color=colour, alpha=alpha, clip_on=False)


def _unit(low: float, high: float) -> float:
    """Unit of the number of a row: the edge of its region, or the geometric middle between two edges."""
    if low <= 0:
        return 1.0 if np.isinf(high) else high
    return low if high > _WIDE * low else float(np.sqrt(low * high))
