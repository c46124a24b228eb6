"""Several answers beside each other: one table and one page."""

from __future__ import annotations

import html
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from asperity.core.markup import page
from asperity.engineering.answer import Answer
from asperity.engineering.folder import COMPARISON, locked, replacing
from asperity.results.atomic import write_text
from asperity.results.tables import write_table

IMAGE = '<img src="{0}" alt="{0}" width="49%" style="vertical-align: top">'

PICTURES = ("height", "pressure", "plane", "section", "peaks")
"""Pictures that stand beside each other."""


def write_comparison(answers: Mapping[str, Answer], folder: Path) -> str:
    """Write ``comparison.csv`` and ``comparison.html`` into the folder that holds those of the answers.

    Parameters
    ----------
    answers : mapping
        Name of the folder of an answer → the answer.
    folder : Path

    Returns
    -------
    str
        The table as text.
    """
    shown = {
        name: {(row.group, row.name): row.shown for row in answer.rows} for name, answer in answers.items()
    }
    keys = dict.fromkeys(key for column in shown.values() for key in column)
    rows = [[*key, *(column.get(key, "") for column in shown.values())] for key in keys]
    frame = pd.DataFrame(rows, columns=["", "number", *shown])
    values = pd.concat([answer.frame().assign(map=name) for name, answer in answers.items()])
    tables = {
        "Numbers": frame,
        "Largest uncertainties": pd.DataFrame(
            {name: pd.Series(answer.uncertainties, dtype=str) for name, answer in answers.items()}
        ),
    }
    pictures = ["<h2>Pictures</h2>"]
    for picture in PICTURES:
        files = [f"{name}/{picture}.png" for name in answers if (folder / name / f"{picture}.png").exists()]
        pictures += [IMAGE.format(html.escape(file)) for file in files]
    links = (f'<a href="{html.escape(name)}/report.html">{html.escape(name)}</a>' for name in answers)
    below = "\n".join([*pictures, f"<p>Reports: {', '.join(links)}</p>"])
    text = page(" and ".join(answers), tables).replace("</body>", f"{below}\n</body>")
    with locked(folder), replacing(folder, kept=set()) as unfinished:
        write_table(values, "answer_comparison", unfinished / COMPARISON[0], float_format="%.8g")
        write_text(unfinished / COMPARISON[1], text)
    return frame.to_string(index=False)
