"""Data frames as tables for a reader, in Markdown and in HTML.

Numbers are written with four digits. Texts may hold Markdown: bold text and code.
"""

from __future__ import annotations

import html
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import pandas as pd

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


def markdown(frame: pd.DataFrame) -> str:
    """A table in Markdown, without the index; bars in cells are escaped."""
    head, *rows = _rows(frame)
    lines = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in (head, *rows)]
    return "\n".join([lines[0], "|" + "---|" * len(head), *lines[1:]])


def html_table(frame: pd.DataFrame) -> str:
    """A table in HTML, without the index, with the Markdown of its cells as HTML."""
    lines = [_line(row, "td" if number else "th") for number, row in enumerate(_rows(frame))]
    return "\n".join(["<table>", *lines, "</table>"])


def page(title: str, tables: Mapping[str, pd.DataFrame]) -> str:
    """An HTML page with tables under their headings; an empty heading is left out."""
    parts = []
    for heading, frame in tables.items():
        if heading:
            parts.append(f"<h2>{html.escape(heading)}</h2>")
        parts.append(html_table(frame))
    return _PAGE.format(title=html.escape(title), style=_STYLE, content="\n".join(parts))


def inline(text: str) -> str:
    """A text with the bold text and code of Markdown as HTML, all else escaped."""
    text = re.sub(r"`(.+?)`", r"<code>\1</code>", html.escape(text))
    return re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", text)


def _rows(frame: pd.DataFrame) -> list[list[str]]:
    """The names of the columns and the cells of each row as text."""
    return [
        [str(name) for name in frame.columns],
        *([_text(cell) for cell in row] for row in frame.itertuples(index=False, name=None)),
    ]


def _text(cell: object) -> str:
    """A cell as text: numbers with four digits, nothing where a number is missing."""
    if isinstance(cell, float | np.floating):
        return "" if np.isnan(cell) else f"{cell:.4g}"
    return str(cell)


def _line(row: Sequence[str], tag: str) -> str:
    """A row of an HTML table."""
    return f"<tr>{''.join(f'<{tag}>{inline(cell)}</{tag}>' for cell in row)}</tr>"
