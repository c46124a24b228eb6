"""Write what README, guide and supplement of the paper say about the results of its study.

    python -m asperity.paper [RESULTS [MORE_SEEDS MORE_NODES]]

With the folder of its results, the table of all interpretations of the statements replaces claims.csv
of `paper/supplement`.
With the folders of the studies of config/decide.yaml and config/decide_nodes.yaml, their tables replace
decided.csv there. The verdicts in claims.md and their counts in README.md are written from the two files.
"""

import re
import sys
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from asperity.core import markup
from asperity.paper.claims.report import beside, counted, findings_of, markdown
from asperity.paper.claims.verdicts import CLAIMS, NO_DATA, UNDECIDED, Finding

FOLDER = Path("paper/supplement")
TABLE, LARGER = FOLDER / "claims.csv", FOLDER / "decided.csv"
NODES = 8, 16
"""Nodes on the shortest wave of the surfaces of the statements in the two larger studies."""


def main(results: Path | None = None, *larger: Path) -> None:
    """Write the pages, from new results if there are such."""
    if larger:
        tables = [pd.read_csv(path / "interpretations.csv", dtype=str) for path in larger]
        joined = pd.concat(tables, keys=NODES, names=["nodes"]).reset_index("nodes")
        joined[joined["verdict"] != NO_DATA].to_csv(LARGER, index=False)
    if results is not None:
        TABLE.write_bytes((results / "interpretations.csv").read_bytes())
        replace(Path("docs/validation.md"), validated(pd.read_csv(results / "validation/table.csv")))
    findings = findings_of(pd.read_csv(TABLE), CLAIMS)
    by_nodes = pd.read_csv(LARGER).groupby("nodes")
    larger_studies = {nodes: findings_of(table.drop(columns="nodes"), CLAIMS) for nodes, table in by_nodes}
    replace(FOLDER / "claims.md", f"{markdown(findings)}\n{undecided(findings, larger_studies)}")
    surfaces = max(finding.own.seeds for finding in findings)
    said = (
        f"`make study` presses {surfaces} random surfaces of every kind, corrects the numbers for the "
        f"discretisation error, and tests {len(findings)} statements of the paper under every interpretation "
        f"that its text admits. **{counted(findings)}.** [A table](paper/supplement/claims.md) has each "
        "statement with its number, its interval and the interpretations on which it depends."
    )
    replace(Path("README.md"), textwrap.fill(said, 118, break_on_hyphens=False) + "\n")


def validated(table: pd.DataFrame) -> str:
    """The comparisons of a study with their errors."""
    rates = table["source"] == "rate"
    error = (
        table["error"].map("order {:.3g}".format).where(rates, (100 * table["error"]).map("{:.2g} %".format))
    )
    return markup.markdown(table[["quantity", "against"]].assign(error=error))


def undecided(findings: Sequence[Finding], larger: Mapping[int, Sequence[Finding]]) -> str:
    """The statements that the study leaves undecided, in a section with the verdicts of larger studies."""
    table = beside(findings, larger)
    still = table["verdict"].str.contains(UNDECIDED).sum()
    text = (
        f"The study leaves {len(table)} statements undecided. Two larger studies, one with more seeds and "
        f"one with more nodes on λ_s, decide {len(table) - still} of them; of two intervals the narrower "
        "counts. What the others need is estimated for numbers that stay where they are. "
        "[`decided.csv`](decided.csv) holds every interpretation."
    )
    return f"## With more seeds and more nodes\n\n{text}\n\n{markup.markdown(table)}\n"


def replace(path: Path, text: str) -> None:
    """Replace the text between the marks of generated text in a page."""
    marks = re.compile(r"(<!-- (?:make pages|python [^>]*) -->\n).*?(<!-- end -->)", re.DOTALL)
    page = path.read_text(encoding="utf-8")
    path.write_text(marks.sub(lambda m: f"{m[1]}\n{text.rstrip()}\n\n{m[2]}", page), encoding="utf-8")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:4]))
