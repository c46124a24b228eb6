"""Data frames as tables for a reader: in Markdown, and on HTML pages that the report shows."""

from __future__ import annotations

import html
from collections.abc import Mapping

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
    """A data frame as a Markdown table, without its index; bars in cells are escaped."""
    rows = [list(frame.columns), *frame.to_numpy(dtype=object).tolist()]
    lines = ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(frame.columns), *lines[1:]])


def page(title: str, frames: Mapping[str, pd.DataFrame]) -> str:
    """An HTML page that shows data frames, without their index, under the given headings."""
    parts = []
    for heading, frame in frames.items():
        if heading:
            parts.append(f"<h2>{html.escape(heading)}</h2>")
        parts.append(frame.to_html(index=False, border=0, na_rep="", float_format="{:.4g}".format))
    return _PAGE.format(title=html.escape(title), style=_STYLE, content="\n".join(parts))
