"""Figures of equal panels, one for each result, or the axes that the caller gives."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence

from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure

from asperity.views.scales import Scale
from asperity.views.style import MILLIMETRE, PAGE, style

SINGLE = 110 * MILLIMETRE
"""Width of a figure of one panel."""

LEAST_HEIGHT, MOST_HEIGHT = 30 * MILLIMETRE, 150 * MILLIMETRE
"""Limits of the height of a panel; longer or wider cells do not fill it."""

FLATTEST = 0.01
"""Smallest height of a panel over its width; that of a row of nodes would be 0."""

LABELS = 16 * MILLIMETRE
"""Width of the labels of a panel beside it, and height of those above and below it."""

BAR = 22 * MILLIMETRE
"""Width of the colour bar beside the panels with all labels, or its height below them."""


@contextlib.contextmanager
def canvas(
    shapes: Sequence[float], axes: Axes | Sequence[Axes] | None, columns: int = 3
) -> Iterator[tuple[Figure, list[Axes]]]:
    """A new figure in the style of the package with a panel for each result, or the figure of given axes.

    Parameters
    ----------
    shapes : sequence of float
        Height over width of each panel; those beside each other in one row have the same height.
    axes : Axes or sequence of Axes, optional
        Axes to use in place of new ones.
    columns : int
        Most panels beside each other; below a single column there is room for a colour bar.

    Raises
    ------
    ValueError
        If the number of axes is not that of the panels.
    """
    count = len(shapes)
    if axes is not None:
        given = [axes] if isinstance(axes, Axes) else list(axes)
        if len(given) != count:
            raise ValueError(f"axes: {count} are needed, one for each result, {len(given)} are given")
        figure = given[0].get_figure(root=True)
        assert figure is not None
        yield figure, given
        return
    # Four panels are two rows of two.
    across = min(count, columns) if count != 4 else min(2, columns)
    rows = -(-count // across)
    width = SINGLE if count == 1 and columns > 1 else PAGE
    tall = [max(shape, FLATTEST) for shape in shapes]
    widths = [1 / shape for shape in tall] if rows == 1 else [1 / max(tall)] * across
    height = min(max((width - BAR - across * LABELS) / sum(widths), LEAST_HEIGHT), MOST_HEIGHT)
    bar_below = BAR if columns == 1 else 0.0
    with style():
        figure = Figure(figsize=(width, rows * (height + LABELS) + bar_below), layout="compressed")
        grid = figure.add_gridspec(rows, across, width_ratios=widths)
        yield figure, [figure.add_subplot(grid[number]) for number in range(count)]


def add_colour_bar(figure: Figure, axes: Sequence[Axes], scale: Scale, below: bool = False) -> None:
    """Add the colour bar of some panels, beside or below them; arrows mean that values lie beyond its ends.

    A bar with both signs shows only the range of values that occur, although its colours are symmetric.
    """
    limits, unit = scale.limits, scale.unit
    bar = figure.colorbar(
        ScalarMappable(limits.normalise(unit), scale.look.colours),
        ax=list(axes),
        label=unit.label(scale.look.label),
        extend=limits.extend,
        location="bottom" if below else "right",
        aspect=40 if below else 20,
    )
    low, high = max(limits.low, limits.smallest), min(limits.high, limits.largest)
    if limits.low < 0 and low < max(high, 0):
        shown = low / unit.factor, max(high, 0) / unit.factor
        (bar.ax.set_xlim if below else bar.ax.set_ylim)(*shown)


def finish_title(axis: Axes, *lines: str) -> None:
    """Write the lines that are not empty above a panel."""
    axis.set_title("\n".join(line for line in lines if line), loc="left")
