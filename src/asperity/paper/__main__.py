"""Write the pages of the documentation that describe the results of the paper's study.

    python -m asperity.paper [RESULTS [LARGER_STUDY]]

With the folder of its results, the table of all interpretations of the statements replaces docs/claims.csv.
With the folder of the study of config/decide.yaml, its table replaces docs/decided.csv. The verdicts in
docs/claims.md and their counts in README.md are written from the two tables.
"""

import re
import sys
import textwrap
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from asperity.core import markup
from asperity.paper.claims.report import beside, counted, findings_of, markdown
from asperity.paper.claims.verdicts import CLAIMS, UNDECIDED, Finding

TABLE = Path("docs/claims.csv")
LARGER = Path("docs/decided.csv")


def main(results: Path | None = None, larger_study: Path | None = None) -> None:
    """Write the pages, from new results if there are such."""
    if larger_study is not None:
        LARGER.write_bytes((larger_study / "interpretations.csv").read_bytes())
    if results is not None:
        TABLE.write_bytes((results / "interpretations.csv").read_bytes())
    findings = findings_of(pd.read_csv(TABLE), CLAIMS)
    larger = findings_of(pd.read_csv(LARGER), CLAIMS)
    replace(Path("docs/claims.md"), f"{markdown(findings)}\n{with_more_seeds(findings, larger)}")
    surfaces = max(finding.own.seeds for finding in findings)
    said = (
        f"`make study` presses {surfaces} random surfaces of every kind, corrects the numbers for the error "
        f"of the grid, and tests {len(findings)} statements of the paper under every interpretation that its "
        f"text admits. **{counted(findings)}.** [docs/claims.md](docs/claims.md) has each statement with its "
        "number, its interval and the interpretations on which it depends."
    )
    replace(Path("README.md"), textwrap.fill(said, 118, break_on_hyphens=False) + "\n")


def with_more_seeds(findings: Sequence[Finding], larger: Sequence[Finding]) -> str:
    """The statements that the study leaves undecided, in a section with the verdicts of a larger one."""
    table = beside(findings, larger)
    still = table["verdict"].str.contains(UNDECIDED).sum()
    seeds = max(finding.own.seeds for finding in larger)
    text = (
        f"Of the {len(table)} statements that the study leaves undecided, {len(table) - still} are decided "
        f"by {seeds} seeds (`config/decide.yaml`), and {still} are not. "
        "[`decided.csv`](decided.csv) holds every interpretation."
    )
    return f"## With more seeds\n\n{text}\n\n{markup.markdown(table)}\n"


def replace(path: Path, text: str) -> None:
    """Replace the text between the marks of generated text in a page."""
    marks = re.compile(r"(<!-- (?:make pages|python [^>]*) -->\n).*?(<!-- end -->)", re.DOTALL)
    page = path.read_text(encoding="utf-8")
    path.write_text(marks.sub(lambda m: f"{m[1]}\n{text}\n{m[2]}", page), encoding="utf-8")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:3]))
