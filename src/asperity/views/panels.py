"""Figures of equal panels, one for each result, or the axes that the caller gives."""

import contextlib
import re
from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure

from asperity.core.types import Array
from asperity.views.scales import Scale
from asperity.views.style import MILLIMETRE, PAGE, style

SINGLE = 110 * MILLIMETRE
"""Width of a figure of one panel."""

LEAST_HEIGHT, MOST_HEIGHT = 30 * MILLIMETRE, 150 * MILLIMETRE
"""Limits of the height of a panel; longer or wider cells do not fill it."""

FLATTEST = 0.01
"""Smallest height of a panel over its width; a single row of nodes would have height 0."""

DIGIT, LINE = 1.6 * MILLIMETRE, 3.4 * MILLIMETRE
"""Width of a digit of a tick label, and height of a line of a title, in the sizes of the style."""

BESIDE, BELOW, ABOVE = 8 * MILLIMETRE, 10.5 * MILLIMETRE, 3 * MILLIMETRE
"""Room left of a panel without the digits of its ticks, below it, and above it without its title."""

APART = 3.5 * MILLIMETRE
"""Distance of a panel from the next panel on its right, and from the colour bar."""

BAR = 3.5 * MILLIMETRE
"""Thickness of a colour bar."""


@contextlib.contextmanager
def canvas(
    shapes: Sequence[float], axes: Axes | Sequence[Axes] | None, columns: int = 3, bar: str = ""
) -> Iterator[tuple[Figure, list[Axes], Axes | None]]:
    """A new figure in the style of the package with a panel for each result, or the figure of given axes.

    The panels of a new figure are placed at the end of the block, by the length of their tick labels: the
    constrained layout of matplotlib finds the same places in half of the time of a picture.

    Parameters
    ----------
    shapes : sequence of float
        Height over width of each panel; panels in one row have the same height.
    axes : Axes or sequence of Axes, optional
        Axes to use in place of new ones.
    columns : int
        Most panels beside each other.
    bar : "", "right" or "bottom"
        Where a new figure has a colour bar, whose axes are the last of the three results.

    Raises
    ------
    ValueError
        If the number of axes is not the number of panels.
    """
    count = len(shapes)
    if axes is not None:
        given = [axes] if isinstance(axes, Axes) else list(axes)
        if len(given) != count:
            raise ValueError(f"axes: {count} are needed, one for each result, {len(given)} are given")
        figure = given[0].get_figure(root=True)
        assert figure is not None
        yield figure, given, None
        return
    # Four panels are two rows of two.
    across = min(count, columns) if count != 4 else min(2, columns)
    tall = np.full((-(-count // across), across), FLATTEST)
    tall.flat[:count] = np.maximum(shapes, FLATTEST)
    with style():
        figure = Figure(figsize=(SINGLE if count == 1 and columns > 1 else PAGE, PAGE))
        figure.set_layout_engine("none")
        panels = [figure.add_axes((0.0, 0.0, 1.0, 1.0), label=f"panel {number}") for number in range(count)]
        bar_axis = figure.add_axes((0.0, 0.0, 1.0, 1.0), label="colour bar") if bar else None
        yield figure, panels, bar_axis
    # Outside the style, as it is drawn: ticks depend on its size of letters, and on the size of the panel.
    for _ in range(3):
        _place(figure, tall, panels, bar, bar_axis)


def _place(figure: Figure, shapes: Array, panels: Sequence[Axes], bar: str, bar_axis: Axes | None) -> None:
    """Choose the height of a figure, and place panels of shapes [row, column], and a colour bar."""
    width = float(figure.get_figwidth())
    (rows, across), single_row = shapes.shape, len(shapes) == 1
    beside = BESIDE + DIGIT * max(_digits(axis.yaxis) for axis in panels)
    above = ABOVE + LINE * max(_lines(axis.get_title("left")) for axis in panels)
    bar_beside = BAR + BESIDE + DIGIT * _digits(bar_axis.yaxis) if bar_axis and bar == "right" else 0.0
    bar_below = APART + BAR + BELOW if bar == "bottom" else 0.0
    widths = 1 / shapes[0] if single_row else np.full(across, 1 / shapes.max())
    height = min((width - bar_beside - across * (beside + APART)) / float(widths.sum()), MOST_HEIGHT)
    row = max(height, LEAST_HEIGHT)
    total = rows * (above + row + BELOW) + bar_below
    figure.set_size_inches(width, total)
    # A group of narrow panels is in the middle.
    free = width - bar_beside - across * (beside + APART) - height * float(widths.sum())
    lefts = free / 2 + np.cumsum([beside, *(height * widths + beside + APART)])
    for number, axis in enumerate(panels):
        down, column = divmod(number, across)
        wide = height * widths[column]
        high = wide * shapes[down, column]
        bottom = total - (down + 1) * (above + row) - down * BELOW + (row - high) / 2
        axis.set_position((lefts[column] / width, bottom / total, wide / width, high / total))
    if bar_axis is None:
        return
    if bar == "right":
        box = (lefts[-1] - beside, bar_below + BELOW, BAR, total - above - BELOW - bar_below)
    else:
        box = (lefts[0], BELOW, lefts[-1] - beside - APART - lefts[0], BAR)
    bar_axis.set_position((box[0] / width, box[1] / total, box[2] / width, box[3] / total))


def _digits(axis: Axis) -> int:
    """Characters of the longest tick label."""
    labels = axis.get_major_formatter().format_ticks(list(axis.get_majorticklocs()))
    return max((len(re.sub(r"\\mathdefault|[${}^]", "", label)) for label in labels), default=0)


def _lines(title: str) -> int:
    return title.count("\n") + bool(title)


def add_colour_bar(figure: Figure, axes: Sequence[Axes], scale: Scale, where: str, bar: Axes | None) -> None:
    """Add the colour bar of some panels; arrows mean that values lie beyond its ends.

    A bar with both signs shows only the range of values that occur, although its colours are symmetric.

    Parameters
    ----------
    figure : Figure
    axes : sequence of Axes
    scale : Scale
    where : "right" or "bottom"
        Its side of the panels.
    bar : Axes, optional
        Its axes; by default they take room from the panels.
    """
    limits, unit = scale.limits, scale.unit
    below = where == "bottom"
    room = {"ax": list(axes), "aspect": 40 if below else 20} if bar is None else {"cax": bar}
    drawn = figure.colorbar(
        ScalarMappable(limits.normalise(unit), scale.look.colours),
        label=unit.label(scale.look.label),
        extend=limits.extend,
        location=where,
        **room,
    )
    low, high = max(limits.low, limits.smallest), min(limits.high, limits.largest)
    if limits.low < 0 and low < max(high, 0):
        shown = low / unit.factor, max(high, 0) / unit.factor
        (drawn.ax.set_xlim if below else drawn.ax.set_ylim)(*shown)


def finish_title(axis: Axes, *lines: str) -> None:
    """Write the lines that are not empty above a panel."""
    axis.set_title("\n".join(line for line in lines if line), loc="left")
