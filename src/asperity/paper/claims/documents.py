"""What README.md and docs/claims.md say of the readings and the verdicts, made from docs/ensemble.csv.

The table holds the judgement of every statement under every reading, of the ensemble that is kept with the
project. `update` writes the sections of the pages that stand between two marks.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from asperity.config.schema import accepted, schema
from asperity.paper.claims.conventions import CLEAR, CONVENTIONS, Support, support
from asperity.paper.claims.report import (
    findings_of,
    option_in_words,
    verdict_in_words,
    with_error,
)
from asperity.paper.claims.statements import CLAIMS
from asperity.paper.claims.verdicts import (
    DEPENDS,
    FAILS,
    HOLDS,
    NO_DATA,
    UNDECIDED,
    UNTESTABLE,
    Finding,
    tally,
)
from asperity.results import markup

TABLE = Path("docs/ensemble.csv")
PAGE = Path("docs/ensemble.md")

NOTABLE = (
    "same_area_load",
    "same_traction_peaks",
    "high_von_mises_small_hurst",
    "deeper_large_hurst",
    "slower_along_depth",
    "broader_compressible",
    "shallower_compressible",
    "skew_not_normalised",
    "cutoff_shallower",
)
"""Statements that README.md names if they hold under every reading."""


def findings(table: Path = TABLE) -> list[Finding]:
    """The findings of the ensemble that is kept with the project."""
    return findings_of(pd.read_csv(table), CLAIMS)


def readme(found: Sequence[Finding]) -> str:
    """Section of README.md: the tally, and the statements that do not simply hold."""
    counts = tally(found)
    words = {
        HOLDS: "hold under every reading",
        FAILS: "hold under none",
        DEPENDS: "depend on the reading",
        UNDECIDED: "are not decided",
        UNTESTABLE: "cannot be tested here",
        NO_DATA: "have no data",
    }
    told = ", ".join(f"{counts[verdict]} {text}" for verdict, text in words.items() if counts[verdict])
    seeds = max(f.own.seeds for f in found)
    lines = [
        f"`make claims`, {seeds} random surfaces of every kind, tests {len(found)} statements of the paper "
        f"under every reading that its text admits ([docs/claims.md](docs/claims.md)): **{told}**. "
        f"[docs/ensemble.md](docs/ensemble.md) has every number with its interval.",
        "",
    ]
    kept = {f.claim.identifier: f for f in found if f.verdict == HOLDS}
    notable = _listed([kept[name] for name in NOTABLE if name in kept])
    lines.append(f"- **Holds under every reading**, among others: {notable}")
    for verdict, title in ((FAILS, "Holds under none"), (DEPENDS, "Depends on the reading")):
        some = [f for f in found if f.verdict == verdict]
        if some:
            lines += [f"- **{title}**:", *(f"  - {_told(f)}" for f in some)]
    if undecided := [f for f in found if f.verdict == UNDECIDED]:
        lines.append(f"- **Not decided**: {_listed(undecided)}")
    return "\n".join(lines)


def _listed(some: Sequence[Finding]) -> str:
    return "; ".join(f"{f.claim.sentence} ({with_error(f.own.value, f.own.error)})" for f in some) + "."


def _told(finding: Finding) -> str:
    """One statement with its number, or with the readings on which it depends."""
    if finding.verdict == DEPENDS:
        return f"{finding.claim.sentence}: {verdict_in_words(finding).replace('**', '')}."
    wanted = f"predicted {finding.own.region}"
    return f"{finding.claim.sentence}: {with_error(finding.own.value, finding.own.error)}, {wanted}."


def choices() -> str:
    """Table of all choices with their options, the study's own first, from the schema of the settings."""
    rows = [["choice", "accepts", "default, own first", "meaning"]]
    for name, entry in schema()["properties"]["readings"]["properties"].items():
        own = entry.get("default", entry.get("left_out"))
        if isinstance(own, list):
            own = ", ".join(map(str, own))
        rows.append([f"`{name}`", accepted(entry.get("items", entry)), str(own), entry["description"]])
    return markup.markdown(rows)


def conventions(found: Sequence[Finding]) -> str:
    """Table of the support of every option of the conventions, and what it says of the study's own."""
    every = support(found)
    rows = [["choice", "option", "statements reproduced", "relative likelihood", "favoured by"]]
    rows += [
        [
            f"`{one.choice}`",
            option_in_words(one.option) + (" (the study's)" if one.own else ""),
            f"{one.expected:.1f} of {one.statements}",
            f"{one.relative:.2g}",
            ", ".join(f"`{name}`" for name in one.favoured_by),
        ]
        for one in every
    ]
    return markup.markdown(rows) + "\n\n" + " ".join(_advice(every, name) for name in CONVENTIONS).strip()


def _advice(every: Sequence[Support], choice: str) -> str:
    """What the likelihoods say of a choice, in a sentence; empty where no statement depends on it."""
    ranked = sorted((one for one in every if one.choice == choice), key=lambda one: -one.relative)
    if not ranked:
        return ""
    first, second = ranked[:2]
    if first.relative < CLEAR * second.relative:
        return f"`{choice}`: not decided by the statements."
    verdict = "as in the study" if first.own else "against the study's own option"
    return f"`{choice}`: **{option_in_words(first.option)}**, {verdict}."


SHAPE = ("skewness_alone", "skew_normalised", "skew_not_normalised")
"""Statements whose numbers the study of δ shows."""


def shapes(found: Sequence[Finding]) -> str:
    """Table of the numbers of the skewed surfaces against δ, and which δ reproduces their statements."""
    of_claim = {f.claim.identifier: f for f in found}
    known = {name: of_claim[name] for name in SHAPE}
    rows = [["δ", *(f.claim.quantity for f in known.values())]]
    reproduced: dict[str, list[str]] = {}
    for delta in {one.options["delta"]: None for one in known[SHAPE[0]].judgements}:
        cells = []
        for name, finding in known.items():
            own = {**finding.own.options, "delta": delta}
            some = [one for one in finding.judgements if one.options["delta"] == delta]
            shown = next(one for one in some if one.options == own)
            cells.append(f"{with_error(shown.value, shown.error)} ({shown.low:.3f} to {shown.high:.3f})")
            if any(one.verdict == HOLDS for one in some):
                reproduced.setdefault(name, []).append(f"{delta:g}")
        rows.append([f"{delta:g}", *cells])
    each = [
        f"{finding.claim.sentence!r} holds for δ = {', '.join(reproduced[name])}"
        if name in reproduced
        else f"{finding.claim.sentence!r} holds for no δ"
        for name, finding in known.items()
    ]
    common = set.intersection(*(set(reproduced.get(name, [])) for name in SHAPE))
    end = f"all three for δ = {', '.join(sorted(common))}" if common else "**no δ reproduces all three**"
    return f"{markup.markdown(rows)}\n\n{'; '.join(each)}: {end}.".replace("'", "*")


def with_section(text: str, name: str, section: str) -> str:
    """A page with a section between its marks ``<!-- NAME: … -->`` and ``<!-- end of NAME -->``."""
    marks = re.compile(rf"(<!-- {name}: .*? -->\n).*?(<!-- end of {name} -->)", re.DOTALL)
    if not marks.search(text):
        raise ValueError(f"no marks of section {name}")
    return marks.sub(lambda match: f"{match[1]}\n{section}\n\n{match[2]}", text, count=1)


def pages(root: Path = Path()) -> dict[Path, str]:
    """The pages that hold a generated section, with it as it should be."""
    found = findings(root / TABLE)
    start = (root / "README.md").read_text(encoding="utf-8")
    claims = (root / "docs/claims.md").read_text(encoding="utf-8")
    for name, section in (
        ("choices", choices()),
        ("conventions", conventions(found)),
        ("shapes", shapes(found)),
    ):
        claims = with_section(claims, name, section)
    return {
        Path("README.md"): with_section(start, "verdicts", readme(found)),
        Path("docs/claims.md"): claims,
    }


def keep(results: Path) -> None:
    """Keep the tables of an ensemble in docs/."""
    TABLE.write_bytes((results / "readings.csv").read_bytes())
    text = (results / "claims.md").read_text(encoding="utf-8")
    title, _, rest = text.partition("\n\n")
    PAGE.write_text(f"{title}\n\n*Made by `make claims`.*\n\n{rest}", encoding="utf-8")


def update() -> None:
    """Write the generated sections of README.md and docs/claims.md."""
    for path, text in pages().items():
        path.write_text(text, encoding="utf-8")
