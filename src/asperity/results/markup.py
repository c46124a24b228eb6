"""Tables for a reader, in Markdown and on HTML pages that the report of the workflow shows.

A table is a list of rows of text, its first row the head. Cells may hold Markdown: bold text and code.
"""

from __future__ import annotations

import html
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

Rows = Sequence[Sequence[str]]

_STYLE = """\
body { font: 14px sans-serif; margin: 2em; color: #222; }
table { border-collapse: collapse; margin-bottom: 2em; }
th, td { padding: 0.3em 0.8em; text-align: left; vertical-align: top; }
th { border-bottom: 2px solid #888; }
td { border-bottom: 1px solid #ddd; font-variant-numeric: tabular-nums; }"""

_PAGE = """\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{title}</title>
<style>
{style}
</style>
</head>
<body>
<h1>{title}</h1>
{content}
</body>
</html>
"""


def rows_of(frame: pd.DataFrame) -> Rows:
    """A data frame as a table without its index, numbers with four digits."""
    values = frame.to_numpy(dtype=object).tolist()
    return [
        [str(name) for name in frame.columns],
        *([f"{cell:.4g}" if isinstance(cell, float) else str(cell) for cell in row] for row in values),
    ]


def markdown(rows: Rows) -> str:
    """A table in Markdown; bars in cells are escaped."""
    lines = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:]])


def page(title: str, tables: Mapping[str, Rows]) -> str:
    """An HTML page with tables under their headings; an empty heading is left out."""
    parts = []
    for heading, rows in tables.items():
        if heading:
            parts.append(f"<h2>{html.escape(heading)}</h2>")
        lines = [_line(row, "td" if number else "th") for number, row in enumerate(rows)]
        parts.append("\n".join(["<table>", *lines, "</table>"]))
    return _PAGE.format(title=html.escape(title), style=_STYLE, content="\n".join(parts))


def _line(row: Sequence[str], tag: str) -> str:
    """A row of an HTML table, with the Markdown of its cells as HTML."""
    cells = []
    for cell in row:
        text = re.sub(r"`(.+?)`", r"<code>\1</code>", html.escape(cell))
        text = re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", text)
        cells.append(f"<{tag}>{text}</{tag}>")
    return f"<tr>{''.join(cells)}</tr>"
