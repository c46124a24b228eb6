"""What README.md and docs/claims.md say of the readings and the verdicts, made from docs/ensemble.csv.

The table holds the judgement of every statement under every reading, of the ensemble that is kept with the
project. `update` writes the sections of the pages that stand between two marks.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from asperity import markup
from asperity.config.schema import accepted, schema
from asperity.paper.claims.conventions import CLEAR, CONVENTIONS, Support, support
from asperity.paper.claims.report import (
    findings_of,
    option_in_words,
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


TALLY = {
    HOLDS: "hold under every reading",
    FAILS: "hold under none",
    DEPENDS: "depend on the reading",
    UNDECIDED: "are not decided",
    UNTESTABLE: "cannot be tested here",
    NO_DATA: "have no data",
}
"""Verdict → what README.md says of the number of statements that have it."""


def findings(table: Path = TABLE) -> list[Finding]:
    """The findings of the ensemble that is kept with the project."""
    return findings_of(pd.read_csv(table), CLAIMS)


def readme(found: Sequence[Finding]) -> str:
    """Section of README.md: the tally, and the statements that do not simply hold."""
    counts = tally(found)
    told = ", ".join(f"{counts[verdict]} {text}" for verdict, text in TALLY.items() if counts[verdict])
    seeds = max(f.own.seeds for f in found)
    of = {verdict: [f for f in found if f.verdict == verdict] for verdict in TALLY}
    notable = [f for f in of[HOLDS] if f.claim.identifier in NOTABLE]
    rows = [["depends on the reading", "holds", "does not hold"]]
    rows += [[f.claim.sentence, *(_shortest(f, verdict) for verdict in (HOLDS, FAILS))] for f in of[DEPENDS]]
    paragraphs = [
        f"`make claims`, {seeds} random surfaces of every kind, tests {len(found)} statements of the paper "
        f"under every reading that its text admits ([docs/claims.md](docs/claims.md)): **{told}**. "
        "[docs/ensemble.md](docs/ensemble.md) has every number with its interval.",
        f"**Among those that hold**: {'; '.join(map(_numbered, notable))}.",
        f"**Under no reading**: {'; '.join(map(_numbered, of[FAILS]))}.",
    ]
    text = "\n\n".join(textwrap.fill(part, 118, break_on_hyphens=False) for part in paragraphs)
    return f"{text}\n\n{markup.markdown(_frame(rows))}"


def _numbered(finding: Finding) -> str:
    return f"{finding.claim.sentence} ({with_error(finding.own.value, finding.own.error)})"


def _shortest(finding: Finding, verdict: str) -> str:
    """The number under the reading nearest to the study's own that has a verdict, and its options."""
    (one, *_) = [one for one in finding.shown if one.verdict == verdict]
    options = (
        option if isinstance(option, str) else f"{name} {option}"
        for name, option in ((name, _plain(one.options[name])) for name in finding.choices)
    )
    return f"{one.value:.3g}: {', '.join(options)}"


def _plain(option: object) -> object:
    return option.replace("_", " ") if isinstance(option, str) else option


def _frame(rows: Sequence[Sequence[str]]) -> pd.DataFrame:
    """Rows of text, the first the head, as a data frame."""
    return pd.DataFrame(rows[1:], columns=rows[0])


def choices() -> str:
    """Table of all choices with their options, the study's own first, from the schema of the settings."""
    rows = [["choice", "accepts", "default, own first", "meaning"]]
    for name, entry in schema()["properties"]["readings"]["properties"].items():
        own = entry.get("default", entry.get("left_out"))
        if isinstance(own, list):
            own = ", ".join(map(str, own))
        rows.append([f"`{name}`", accepted(entry.get("items", entry)), str(own), entry["description"]])
    return markup.markdown(_frame(rows))


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
    return (
        markup.markdown(_frame(rows))
        + "\n\n"
        + " ".join(_advice(every, name) for name in CONVENTIONS).strip()
    )


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
    return f"{markup.markdown(_frame(rows))}\n\n{'; '.join(each)}: {end}.".replace("'", "*")


def with_sections(text: str, sections: Mapping[str, str]) -> str:
    """A page with sections, each between its marks ``<!-- NAME: … -->`` and ``<!-- end of NAME -->``."""
    for name, section in sections.items():
        marks = re.compile(rf"(<!-- {name}: .*? -->\n).*?(<!-- end of {name} -->)", re.DOTALL)
        found = marks.search(text)
        if not found:
            raise ValueError(f"no marks of section {name}")
        text = f"{text[: found.end(1)]}\n{section}\n\n{text[found.start(2) :]}"
    return text


def pages(root: Path = Path()) -> dict[Path, str]:
    """The pages that hold a generated section, with it as it should be."""
    found = findings(root / TABLE)
    start = (root / "README.md").read_text(encoding="utf-8")
    claims = (root / "docs/claims.md").read_text(encoding="utf-8")
    sections = {"choices": choices(), "conventions": conventions(found), "shapes": shapes(found)}
    return {
        Path("README.md"): with_sections(start, {"verdicts": readme(found)}),
        Path("docs/claims.md"): with_sections(claims, sections),
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
