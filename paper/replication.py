"""Build paper/replication.pdf from its text, its metadata, and tables of the supplement."""

import re
from pathlib import Path

import jinja2
import pandas as pd
import pypandoc
import typst
import yaml

from asperity.paper.claims.report import counted, findings_of, tables
from asperity.paper.claims.verdicts import CLAIMS

FOLDER = Path(__file__).parent
WIDTHS = {"the paper says": 30, "compared": 30, "found": 40}
"""Column of a table of statements → its width, relative to the others."""

TABLES = """```{=typst}
#show figure: set block(breakable: true)
#show table: set text(size: 8.5pt)
#show table: set par(justify: false)
```

"""


def main() -> None:
    """Write the PDF."""
    text = (FOLDER / "replication.md").read_text(encoding="utf-8")
    metadata = yaml.safe_load((FOLDER / "metadata.yaml").read_text(encoding="utf-8"))
    findings = findings_of(pd.read_csv(FOLDER / "supplement/claims.csv"), CLAIMS)
    statements = pd.concat(tables(findings).values())

    def table(verdict: str, columns: list[str]) -> str:
        rows = statements.loc[statements["verdict"] == f"**{verdict}**", columns]
        cells = rows.replace({r"([*|])": r"\\\1"}, regex=True).to_numpy().tolist()
        lines = [columns, [f":{'-' * WIDTHS[name]}" for name in columns], *cells]
        return "\n".join(f"| {' | '.join(line)} |" for line in lines)

    method = (FOLDER / "supplement/method.md").read_text(encoding="utf-8")
    (errata,) = re.findall(r"^\| equation \|.*?(?=\n\n|\Z)", method, re.DOTALL | re.MULTILINE)
    lines = errata.splitlines()
    lines[1] = f"|:{'-' * 15}|:{'-' * 15}|:{'-' * 70}|"
    values = {
        "count": len(findings),
        "counted": counted(findings),
        "table": table,
        "errata": "\n".join(lines),
    }
    article = jinja2.Environment(undefined=jinja2.StrictUndefined).from_string(text).render(values)
    heading = {
        "title": metadata["title"],
        "author": [{"name": author["name"]} for author in metadata["authors"]],
        "abstract": metadata["abstract"],
        "section-numbering": "1.1",
        "papersize": "a4",
        "fontsize": "10pt",
        "margin": {"x": "20mm", "y": "22mm"},
    }
    front = f"---\n{yaml.safe_dump(heading, allow_unicode=True)}---\n\n{TABLES}"
    front += f"**Keywords.** {metadata['keywords']}\n\n"
    options = ["--standalone", "--citeproc", f"--bibliography={FOLDER / metadata['bibliography']}"]
    source = pypandoc.convert_text(front + article, "typst", "markdown", extra_args=options)
    (FOLDER / "replication.pdf").write_bytes(typst.compile(source.encode()))


if __name__ == "__main__":
    main()
