"""Objects as small tables of HTML, by which a notebook shows them."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable
from importlib.util import find_spec
from io import BytesIO

import numpy as np

from asperity.types import Array

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


def picture(values: Array, words: str) -> str:
    """A field [y, x] as a small image, largest value of each block, y upward; empty without matplotlib."""
    if find_spec("matplotlib") is None:
        return ""
    from matplotlib.image import imsave

    step = max(1, -(-max(values.shape) // PICTURE))
    ny, nx = (max(1, nodes // step) for nodes in values.shape)
    blocks = (
        values[: ny * step, : nx * step].reshape(ny, step, nx, step) if min(values.shape) >= step else values
    )
    shown = blocks.max(axis=(1, 3)) if blocks.ndim == 4 else blocks
    file = BytesIO()
    imsave(file, np.asarray(shown, dtype=float), origin="lower", cmap="magma_r", format="png")
    data = base64.b64encode(file.getvalue()).decode()
    return f'<img alt="{html.escape(words)}" title="{html.escape(words)}" src="data:image/png;base64,{data}">'
