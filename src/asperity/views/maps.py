"""Height, contact pressure and gap over the cell, with the outlines of the contacts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.core.types import Array
from asperity.views.panels import add_colour_bar, canvas, finish_title
from asperity.views.scales import ON_WHITE, SEQUENTIAL, Limits, Measure, measure, robust_limits
from asperity.views.source import Source, Span, Window, sources

PIXELS = 1024
"""Most pixels along an edge; a pixel of a finer grid stands for a block of nodes."""


class Map(NamedTuple):
    """What a map shows of one result.

    Parameters
    ----------
    title : str
    system : str or None
        Unit system of the values.
    window : Window
        The nodes.
    values : array [y, x]
        At the nodes; missing values are left white.
    contacts : bool array [y, x] or None
        True at nodes in contact, which are outlined.
    """

    title: str
    system: str | None
    window: Window
    values: Array
    contacts: Array | None


class Look(NamedTuple):
    """Colours of a map.

    Parameters
    ----------
    label : str
        Name of the quantity.
    dimension : "length" | "stress"
    colours : str
        Colour map.
    outline : str
        Colour of the outlines of contacts.
    reduce : callable
        Value of a pixel from those of the nodes that it stands for.
    low : float or None
        Fixed lower limit.
    signed : bool
        True if zero is in the middle of the colours.
    """

    label: str
    dimension: str
    colours: str
    outline: str
    reduce: Callable[..., Array]
    low: float | None = None
    signed: bool = False

    def limits(self, values: Iterable[Array]) -> Limits:
        """Common limits of the colours of several results."""
        found = robust_limits(values, self.low)
        return found.symmetric() if self.signed else found


HEIGHT = Look("height of the rough face, lowest touches first", "length", SEQUENTIAL, "white", np.mean)
PRESSURE = Look("contact pressure", "stress", ON_WHITE, "0.5", np.fmax.reduce, low=0.0)
GAP = Look("gap", "length", SEQUENTIAL, "white", np.mean, low=0.0)


def plot_height(
    result: Any,
    *,
    y: Span | None = None,
    x: Span | None = None,
    axes: Axes | Sequence[Axes] | None = None,
    unit_system: str | None = None,
) -> Figure:
    """Map of the heights of the rough face, with the outlines of the contacts if the result has them.

    Parameters
    ----------
    result : dataset, `Contact`, sequence of them, or mapping from titles to them
        Results of stage surface or contact; several are drawn beside each other in the same colours.
    y, x : (first, last), optional
        Part of the cell, in the unit of the result.
    axes : Axes or sequence of Axes, optional
        Where to draw, one for each result; by default in a new figure.
    unit_system : "SI", optional
        Of results that do not say theirs, such as a `Contact`.

    Returns
    -------
    figure : matplotlib Figure
        Lengths and stresses are in units with sensible prefixes if the result is in SI, in cell lengths and
        E* if it is dimensionless. Colours leave single outliers out; the panel says how many, and their
        extreme.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> figure = asp.plot_height(contact, x=(0, 0.5))  # the left half
    >>> figure.savefig("height.png")  # doctest: +SKIP
    >>> len(figure.axes)  # the map and its colour bar
    2
    """
    return _plot(result, "height", HEIGHT, y, x, axes, unit_system)


def plot_pressure(
    result: Any,
    *,
    y: Span | None = None,
    x: Span | None = None,
    axes: Axes | Sequence[Axes] | None = None,
    unit_system: str | None = None,
) -> Figure:
    """Map of the contact pressure, white where there is no contact; arguments as for `plot_height`.

    Examples
    --------
    Two contacts beside each other, in the same colours:

    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> path = asp.solve_path(height, asp.Layer(young=1.0, poisson=0.3), area_fractions=[0.05, 0.1])
    >>> figure = asp.plot_pressure(dict(zip(("5 %", "10 %"), path)))
    >>> len(figure.axes)  # two maps and a colour bar
    3
    """
    return _plot(result, "pressure", PRESSURE, y, x, axes, unit_system)


def plot_gap(
    result: Any,
    *,
    y: Span | None = None,
    x: Span | None = None,
    axes: Axes | Sequence[Axes] | None = None,
    unit_system: str | None = None,
) -> Figure:
    """Map of the gap between the faces, with the outlines of the contacts; arguments as for `plot_height`.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> figure = asp.plot_gap(contact)
    >>> len(figure.axes)  # the map and its colour bar
    2
    """
    return _plot(result, "gap", GAP, y, x, axes, unit_system)


def draw_maps(maps: Sequence[Map], look: Look, axes: Axes | Sequence[Axes] | None) -> Figure:
    """Draw maps in common colours, and their colour bar."""
    system = maps[0].system
    limits = look.limits(shown.values for shown in maps)
    unit = measure([limits.low, limits.high], look.dimension, system)
    edges = [edge for shown in maps for edge in (shown.window.x[-1], shown.window.y[-1])]
    length = measure(edges, "length", system)
    tallest = max(np.ptp(shown.window.y) / np.ptp(shown.window.x) for shown in maps)
    with canvas(len(maps), axes, shape=float(tallest)) as (figure, panels):
        for axis, shown in zip(panels, maps, strict=True):
            _draw(axis, shown, look, limits, unit, length)
        add_colour_bar(figure, panels, look.colours, limits, unit, look.label)
    return figure


def blocks(values: Array, part: Window, reduce: Callable[..., Array]) -> tuple[Array, Array, Array]:
    """Values of blocks of nodes, at most `PIXELS` along an edge, and the positions y and x of their middles.

    Parameters
    ----------
    values : array [y, x]
        At the nodes of the window.
    part : Window
    reduce : callable
        Value of a block from those of its nodes, such as ``np.max``.
    """
    size = [max(1, -(-nodes // PIXELS)) for nodes in values.shape]
    y, x = (
        nodes[0] + spacing * (block * np.arange(-(-nodes.size // block)) + (block - 1) / 2)
        for nodes, spacing, block in zip((part.y, part.x), part.spacing, size, strict=True)
    )
    if size == [1, 1]:
        return values, y, x
    missing = [(0, -nodes % block) for nodes, block in zip(values.shape, size, strict=True)]
    padded = np.pad(values, missing, mode="edge")
    return reduce(padded.reshape(y.size, size[0], x.size, size[1]), axis=(1, 3)), y, x


def largest_magnitude(values: Array, axis: tuple[int, ...]) -> Array:
    """The value of largest magnitude along some axes, with its sign."""
    high, low = values.max(axis=axis), values.min(axis=axis)
    return np.where(high >= -low, high, low)


def _plot(
    result: Any,
    name: str,
    look: Look,
    y: Span | None,
    x: Span | None,
    axes: Axes | Sequence[Axes] | None,
    unit_system: str | None,
) -> Figure:
    return draw_maps([_map(source, name, y, x) for source in sources(result, unit_system)], look, axes)


def _map(source: Source, name: str, y: Span | None, x: Span | None) -> Map:
    part = source.window(y, x)
    values = part.of(source.field(name))
    pressure = source.fields.get("pressure")
    if name == "pressure":
        values = np.where(values > 0, values, np.nan)
    contacts = None if pressure is None else pressure > 0
    return Map(source.title, source.system, part, values, contacts)


def _draw(axis: Axes, shown: Map, look: Look, limits: Limits, unit: Measure, length: Measure) -> None:
    part = shown.window
    values, y, x = blocks(shown.values, part, look.reduce)
    dy, dx = y[1] - y[0], x[1] - x[0]
    extent = np.array([x[0] - dx / 2, x[-1] + dx / 2, y[0] - dy / 2, y[-1] + dy / 2]) / length.factor
    axis.imshow(
        np.ma.masked_invalid(values / unit.factor),
        origin="lower",
        extent=tuple(extent),
        norm=limits.normalise(unit),
        cmap=look.colours,
    )
    if shown.contacts is not None:
        contacts, y, x = blocks(part.of(shown.contacts).astype(np.float32), part, np.max)
        if contacts.min() < contacts.max():
            y, x = y / length.factor, x / length.factor
            axis.contour(x, y, contacts, levels=[0.5], colors=look.outline, linewidths=0.5)
    edge_y, edge_x = part.spacing[0] / 2, part.spacing[1] / 2
    axis.set(
        xlim=((part.x[0] - edge_x) / length.factor, (part.x[-1] + edge_x) / length.factor),
        ylim=((part.y[0] - edge_y) / length.factor, (part.y[-1] + edge_y) / length.factor),
        xlabel=length.label("x"),
        ylabel=length.label("y"),
        aspect="equal",
    )
    axis.spines[["top", "right"]].set_visible(True)
    finish_title(axis, shown.title, limits.beyond(shown.values, unit))
