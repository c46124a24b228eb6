"""Keep the verdicts of an ensemble, and write what README.md says of them.

    python -m asperity.paper.claims [FOLDER]

With the folder of results of an ensemble its tables replace docs/ensemble.csv and docs/ensemble.md first.
"""

import re
import sys
import textwrap
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from asperity.core import markup
from asperity.core.markup import with_error
from asperity.paper.claims.paper import CLAIMS
from asperity.paper.claims.report import findings_of, option_in_words
from asperity.paper.claims.verdicts import DEPENDS, FAILS, HOLDS, UNDECIDED, UNTESTABLE, Finding

TABLE = Path("docs/ensemble.csv")

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
"""Statements that README.md names if they hold under every interpretation."""

COUNTED = {
    HOLDS: "hold under every interpretation",
    FAILS: "hold under none",
    DEPENDS: "depend on the interpretation",
    UNDECIDED: "are not decided",
    UNTESTABLE: "cannot be tested here",
}
"""Verdict → what README.md says of the number of statements that have it."""


def keep(results: Path) -> None:
    """Keep the tables of an ensemble in docs/."""
    TABLE.write_bytes((results / "interpretations.csv").read_bytes())
    title, _, rest = (results / "claims.md").read_text(encoding="utf-8").partition("\n\n")
    page = f"{title}\n\n*Made by `make claims`.*\n\n{rest}"
    TABLE.with_suffix(".md").write_text(page, encoding="utf-8")


def section(found: Sequence[Finding]) -> str:
    """Section of README.md: the tally, and the statements that do not simply hold."""
    of = {verdict: [f for f in found if f.verdict == verdict] for verdict in COUNTED}
    counts = ", ".join(f"{len(of[verdict])} {text}" for verdict, text in COUNTED.items() if of[verdict])
    of[HOLDS] = [f for f in of[HOLDS] if f.claim.identifier in NOTABLE]
    named = {
        verdict: "; ".join(
            f"{f.claim.sentence} ({with_error(f.own.value, f.own.standard_error)})" for f in of[verdict]
        )
        for verdict in (HOLDS, FAILS)
    }
    paragraphs = [
        f"`make claims`, {max(f.own.seeds for f in found)} random surfaces of every kind, tests {len(found)} "
        "statements of the paper under every interpretation that its text admits "
        f"([docs/claims.md](docs/claims.md)): **{counts}**. [docs/ensemble.md](docs/ensemble.md) has every "
        "number with its interval.",
        f"**Among those that hold**: {named[HOLDS]}.",
        f"**Under no interpretation**: {named[FAILS]}.",
    ]
    head = ["depends on the interpretation", "holds", "does not hold"]
    rows = [[f.claim.sentence, _nearest(f, HOLDS), _nearest(f, FAILS)] for f in of[DEPENDS]]
    text = [textwrap.fill(part, 118, break_on_hyphens=False) for part in paragraphs]
    return "\n\n".join([*text, markup.markdown(pd.DataFrame(rows, columns=head))])


def _nearest(finding: Finding, verdict: str) -> str:
    """The number under the interpretation nearest to the study's own that has a verdict, and its options."""
    one = next(one for one in finding.shown if one.verdict == verdict)
    options = ((name, one.interpretation[name]) for name in finding.choices)
    words = (option_in_words(o) if isinstance(o, str) else f"{name} {o:g}" for name, o in options)
    return f"{one.value:.3g}: {', '.join(words)}"


if __name__ == "__main__":
    for folder in sys.argv[1:2]:
        keep(Path(folder))
    readme = Path("README.md")
    written = section(findings_of(pd.read_csv(TABLE), CLAIMS))
    marks = re.compile(r"(<!-- verdicts: .*? -->\n).*?(<!-- end of verdicts -->)", re.DOTALL)
    text = marks.sub(lambda m: f"{m[1]}\n{written}\n\n{m[2]}", readme.read_text(encoding="utf-8"))
    readme.write_text(text, encoding="utf-8")
