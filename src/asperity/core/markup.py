"""Tables for a reader: data frames in Markdown and HTML, and objects as a notebook shows them.

Numbers are written with four digits. Texts may hold Markdown: bold text and code.
"""

import base64
import html
import re
from collections.abc import Iterable
from functools import cache, partial
from importlib.util import find_spec
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.core.units import shown_si
from asperity.core.version import __version__

if TYPE_CHECKING:
    import pandas as pd
    from jinja2 import Environment
    from matplotlib.figure import Figure


def markdown(frame: "pd.DataFrame") -> str:
    """A table in Markdown, without the index; ``|`` in cells is escaped."""
    head, *rows = (
        "| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in _cells(frame)
    )
    return "\n".join([head, "|" + "---|" * len(frame.columns), *rows])


def html_table(frame: "pd.DataFrame") -> str:
    """A table in HTML, without the index, with the Markdown of its cells as HTML."""
    head, *rows = _cells(frame)
    lines = ["<table>", f"<tr>{''.join(f'<th>{inline(cell)}</th>' for cell in head)}</tr>"]
    for row in rows:  # on a narrow screen the name of a column stands before each of its cells
        names = map(html.escape, head)
        cells = (
            f'<td data-column="{name}">{inline(cell)}</td>' for name, cell in zip(names, row, strict=True)
        )
        lines.append(f"<tr>{''.join(cells)}</tr>")
    return "\n".join([*lines, "</table>"])


def rendered(package: str, template: str, **values: Any) -> str:
    """An HTML page from a template beside the modules of a package, which may extend `base.html.j2`."""
    return _environment(package).get_template(template).render(version=__version__, **values)


@cache  # keeps the templates, which take longer to compile than to fill
def _environment(package: str) -> "Environment":
    """Templates of a package."""
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

    loader = ChoiceLoader([PackageLoader(name, "") for name in (package, "asperity.core")])
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {"inline": inline, "si": partial(shown_si, digits=3)}
    return environment


def inline(text: str) -> str:
    """A text with the bold text and code of Markdown as HTML, all else escaped."""
    text = re.sub(r"`(.+?)`", r"<code>\1</code>", html.escape(text))
    return re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", text)


def with_error(value: float, error: float, signed: bool = False) -> str:
    """A number with its error to two digits: ``1.445 ± 0.012``; three digits where there is no error."""
    return " ± ".join(filter(None, rounded(value, error, "+" if signed else "")))


def rounded(value: float, error: float, sign: str = "") -> tuple[str, str]:
    """The two texts of `with_error`: the number, and its error; empty where there is none."""
    if np.isnan(value):
        return "", ""
    if np.isnan(error) or error == 0:
        return f"{value:{sign}.3g}", ""
    digits = min(1 - int(np.floor(np.log10(error))), 12)
    decimals = max(digits, 0)
    return f"{round(value, digits):{sign}.{decimals}f}", f"{round(error, digits):.{decimals}f}"


def _cells(frame: "pd.DataFrame") -> list[list[str]]:
    """Names of the columns, and rows of cells as text: numbers with four digits, nothing for missing ones."""

    def text(cell: object) -> str:
        if isinstance(cell, float | np.floating):
            return "" if np.isnan(cell) else f"{cell:.4g}"
        return str(cell)

    rows = frame.itertuples(index=False, name=None)
    return [[str(name) for name in frame.columns], *([text(cell) for cell in row] for row in rows)]


def png(figure: "Figure") -> str:
    """A figure as an image of a page, in base64."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    file = BytesIO()
    FigureCanvasAgg(figure).print_png(file, metadata={"Software": None}, pil_kwargs={"compress_level": 2})
    return base64.b64encode(file.getvalue()).decode()


PICTURE = 160
"""Most pixels along an edge of a small picture."""


def table(title: str, rows: Iterable[tuple[str, str]], picture: str = "") -> str:
    """A title and two columns of text as HTML, with a picture beside them if there is one."""
    cells = "".join(
        f'<tr><td style="text-align:left">{html.escape(name)}</td>'
        f'<td style="text-align:left">{html.escape(value)}</td></tr>'
        for name, value in rows
    )
    head = f'<tr><th colspan="2" style="text-align:left">{html.escape(title)}</th></tr>'
    text = f"<table><thead>{head}</thead>{cells}</table>"
    if not picture:
        return f"<div>{text}</div>"
    return f'<div style="display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start">{text}{picture}</div>'


def picture(values: np.ndarray, words: str) -> str:
    """A field [y, x] as a small image of block maxima, y upward; empty without matplotlib."""
    if find_spec("matplotlib") is None:
        return ""
    from matplotlib.image import imsave

    step = min(-(-max(values.shape) // PICTURE), *values.shape)
    ny, nx = (nodes // step for nodes in values.shape)
    shown = values[: ny * step, : nx * step].reshape(ny, step, nx, step).max(axis=(1, 3))
    file = BytesIO()
    imsave(file, np.asarray(shown, dtype=float), origin="lower", cmap="magma_r", format="png")
    data = base64.b64encode(file.getvalue()).decode()
    return f'<img alt="{html.escape(words)}" title="{html.escape(words)}" src="data:image/png;base64,{data}">'
