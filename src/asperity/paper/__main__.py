"""Write the pages of the documentation that describe the results of the paper's study.

    python -m asperity.paper [RESULTS]

With the folder of its results, the table of all interpretations of the statements replaces docs/claims.csv.
The verdicts in docs/claims.md and their counts in README.md are written from the table.
"""

import re
import sys
import textwrap
from pathlib import Path

import pandas as pd

from asperity.paper.claims.report import counted, findings_of, markdown
from asperity.paper.claims.verdicts import CLAIMS

TABLE = Path("docs/claims.csv")


def main(results: Path | None = None) -> None:
    """Write the pages, from new results if there are such."""
    if results is not None:
        TABLE.write_bytes((results / "interpretations.csv").read_bytes())
    findings = findings_of(pd.read_csv(TABLE), CLAIMS)
    replace(Path("docs/claims.md"), markdown(findings))
    surfaces = max(finding.own.seeds for finding in findings)
    said = (
        f"`make study` presses {surfaces} random surfaces of every kind, corrects the numbers for the error "
        f"of the grid, and tests {len(findings)} statements of the paper under every interpretation that its "
        f"text admits. **{counted(findings)}.** [docs/claims.md](docs/claims.md) has each statement with its "
        "number, its interval and the interpretations on which it depends."
    )
    replace(Path("README.md"), textwrap.fill(said, 118, break_on_hyphens=False) + "\n")


def replace(path: Path, text: str) -> None:
    """Replace the text between the marks of generated text in a page."""
    marks = re.compile(r"(<!-- (?:make pages|python [^>]*) -->\n).*?(<!-- end -->)", re.DOTALL)
    page = path.read_text(encoding="utf-8")
    path.write_text(marks.sub(lambda m: f"{m[1]}\n{text}\n{m[2]}", page), encoding="utf-8")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
