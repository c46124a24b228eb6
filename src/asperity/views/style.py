"""Style of pictures and figures: sizes, panels, labels, and files that are the same bytes in every run.

matplotlib is imported when it is needed: labels are needed without it too.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from asperity.core.errors import one_line
from asperity.results.atomic import atomic_write
from asperity.results.dataset import settings_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MILLIMETRE = 1 / 25.4
PAGE = 170 * MILLIMETRE
COLUMN = 85 * MILLIMETRE

_FORMATS = (".png", ".pdf", ".svg")


@contextlib.contextmanager
def style() -> Iterator[None]:
    """Draw with the style file of the package."""
    from matplotlib import rc_context

    with rc_context(_parameters()):
        yield


@cache
def _parameters() -> dict[Any, Any]:
    """Parameters of the style file, and matplotlib's defaults of all others but the backend.

    The function `matplotlib.style.use` would read all styles that come with matplotlib.
    """
    from matplotlib import rc_params_from_file

    parameters = rc_params_from_file(str(files("asperity.views") / "style.mplstyle"))
    return {name: value for name, value in parameters.items() if name != "backend"}


def panels(
    columns: int = 2, rows: int = 1, height: float = 62.0, width: float = PAGE
) -> tuple[Figure, list[Axes]]:
    """A figure with lettered panels, row by row; `height` of a row in millimetres, `width` in inches."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, rows * height * MILLIMETRE))
    axes = [figure.add_subplot(rows, columns, number + 1) for number in range(rows * columns)]
    for letter, axis in zip("abcdefgh", axes, strict=False):
        axis.set_title(f"({letter})", loc="left", fontweight="bold")
    return figure, axes


def label(data: xr.Dataset) -> str:
    """Label of the surface of a result: attribute ``label``, which the study adds, or else from its settings.

    A result of the study does not hold the label of its surface. Without a label the name is used.
    """
    settings = settings_of(data)
    return data.attrs.get("label") or settings["surface"].get("label") or settings["name"]


def plain_text(name: str) -> str:
    """A name, such as a file's, as pictures show it: its dollar signs begin no mathematics."""
    return one_line(name).replace("$", r"\$")


def wavelength_short(data: xr.Dataset) -> float:
    """Shortest wavelength of the surface of a result, the unit of depths and distances."""
    return settings_of(data)["surface"]["wavelength_short"]


def require_picture(*paths: str | os.PathLike[str]) -> None:
    """Raise `ValueError` for the first path whose suffix names no picture format."""
    for path in map(Path, paths):
        if path.suffix not in _FORMATS:
            raise ValueError(f"{path}: the name of a picture is needed, ending in {', '.join(_FORMATS)}")


def save(figure: Figure, *paths: str | os.PathLike[str]) -> None:
    """Write the figure to each path, in the format of its suffix, without dates or versions.

    It is laid out for the first path, and the others have the same layout.

    Raises
    ------
    ValueError
        If a suffix names no picture format.
    """
    from matplotlib import rcParams
    from matplotlib.backend_bases import get_registered_canvas_class

    require_picture(*paths)
    engine, dpi, canvas = figure.get_layout_engine(), figure.dpi, figure.canvas
    if rcParams["savefig.dpi"] != "figure":
        figure.dpi = rcParams["savefig.dpi"]
    for path in map(Path, paths):
        metadata = {".pdf": {"CreationDate": None, "Producer": None}, ".svg": {"Date": None}}
        with atomic_write(path) as unfinished:
            # Draws once, where savefig draws twice.
            kind = path.suffix.removeprefix(".")
            write = getattr(get_registered_canvas_class(kind)(figure), f"print_{kind}")
            write(unfinished, metadata=metadata.get(path.suffix, {"Software": None}))
        figure.set_layout_engine("none")
    figure.set_layout_engine(engine)
    figure.dpi = dpi
    figure.set_canvas(canvas)
