"""Height, contact pressure and gap over the cell, with the outlines of the contacts."""

from collections.abc import Sequence
from typing import Any, NamedTuple, TypedDict, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.core.types import Array
from asperity.views.panels import add_colour_bar, canvas, finish_title
from asperity.views.scales import FALLING, SEQUENTIAL, Look, Scale, blocks, measure
from asperity.views.source import Part, Source, Span, sources

CONTOUR_COLOUR = "C4"
"""Colour of a contour."""

PIXELS = 1024
"""Most pixels along an edge; a pixel of a finer grid stands for a block of nodes."""


class Map(NamedTuple):
    """A field of one result, as a map shows it.

    Parameters
    ----------
    source : Source
    part : Part
        The nodes that are shown.
    values : array [y, x]
        At these nodes; missing values are left white.
    note : str
        Second part of the title.
    """

    source: Source
    part: Part
    values: Array
    note: str = ""


class View(TypedDict, total=False):
    """Arguments of the pictures of a field over the cell; `plot_height` describes them."""

    y: Span | None
    x: Span | None
    axes: Axes | Sequence[Axes] | None
    unit_system: str | None


HEIGHT = Look("height, lowest touches first", "length", FALLING, "black", np.mean)
MAP_HEIGHT = Look("height, peaks up", "length", SEQUENTIAL, "black", np.mean)
PRESSURE = Look("contact pressure", "stress", SEQUENTIAL, "", np.fmax.reduce, low=0.0)
PLASTIC_DEPTH = Look("plastic depth", "length", SEQUENTIAL, "", np.fmax.reduce, low=0.0)
SHEAR_TRACTION = Look("shear traction", "stress", SEQUENTIAL, "", np.fmax.reduce, low=0.0)
SLIP = Look("slip", "length", SEQUENTIAL, "black", np.fmax.reduce, low=0.0)
GAP = Look("gap", "length", SEQUENTIAL, "white", np.mean, low=0.0)


def plot_height(result: Any, **view: Unpack[View]) -> Figure:
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
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> figure = asp.views.plot_height(contact, x=(0, 0.5))  # the left half
    >>> figure.savefig("height.png")  # doctest: +SKIP
    >>> len(figure.axes)  # the map and its colour bar
    2
    """
    return _plot(result, "height", HEIGHT, **view)


def plot_pressure(result: Any, **view: Unpack[View]) -> Figure:
    """Map of the contact pressure, white where there is no contact; arguments as for `plot_height`.

    Returns
    -------
    Figure

    Examples
    --------
    Two contacts beside each other, in the same colours:

    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> solid, areas = asp.Solid(young=1.0, poisson=0.3), [0.05, 0.1]
    >>> path = asp.solve_load_path(height, solid, contact_area_fractions=areas)
    >>> figure = asp.views.plot_pressure(dict(zip(("5 %", "10 %"), path)))
    >>> len(figure.axes)  # two maps and a colour bar
    3
    """
    return _plot(result, "pressure", PRESSURE, **view)


def plot_gap(result: Any, **view: Unpack[View]) -> Figure:
    """Map of the gap between the faces, with the outlines of the contacts; arguments as for `plot_height`.

    Returns
    -------
    Figure

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> figure = asp.views.plot_gap(contact)
    >>> len(figure.axes)  # the map and its colour bar
    2
    """
    return _plot(result, "gap", GAP, **view)


def _plot(
    result: Any,
    name: str,
    look: Look,
    y: Span | None = None,
    x: Span | None = None,
    axes: Axes | Sequence[Axes] | None = None,
    unit_system: str | None = None,
) -> Figure:
    found = sources(result, unit_system)
    return draw_maps([map_of(source, name, source.part(y, x)) for source in found], look, axes)


def map_of(source: Source, name: str, part: Part, note: str = "") -> Map:
    """Map of one of the fields of a result; pressure and slip are left white outside of the contact."""
    values = source.field(name)[part]
    shown = values if name in ("height", "gap") else np.where(values > 0, values, np.nan)
    return Map(source, part, shown, note)


DENSE, THINNEST = 8, 0.3
"""Crossings of a row with a contour above which its line is thinner, and its smallest relative width."""


def draw_maps(
    maps: Sequence[Map], look: Look, axes: Axes | Sequence[Axes] | None, level: float | None = None
) -> Figure:
    """Draw maps in common colours, and their colour bar; `level` is the value of a contour."""
    system = maps[0].source.system
    limits = look.limits(shown.values for shown in maps)
    unit = measure([limits.low, limits.high], look.dimension, system)
    nodes = [shown.source.positions(shown.part) for shown in maps]
    length = measure([edge for y, x in nodes for edge in (x[-1], y[-1])], "length", system)
    scale = Scale(look, limits, unit, length, level)
    edges = [np.multiply(shown.values.shape, shown.source.grid.spacing) for shown in maps]
    with canvas([float(y / x) for y, x in edges], axes, bar="right") as (figure, panels, bar):
        for axis, shown in zip(panels, maps, strict=True):
            _draw(axis, shown, scale)
        add_colour_bar(figure, panels, scale, "right", bar)
    return figure


def _draw(axis: Axes, shown: Map, scale: Scale) -> None:
    look, unit, length = scale.look, scale.unit, scale.length
    size = [max(1, -(-nodes // PIXELS)) for nodes in shown.values.shape]
    # Edges of the nodes that are shown, and of the pixels, which are blocks of nodes and may reach further.
    steps = np.array(shown.source.grid.spacing) / length.factor
    first = np.array([nodes.start for nodes in shown.part])
    begin = (first - 0.5) * steps
    end = begin + steps * shown.values.shape
    pixels = blocks(shown.values, size, look.reduce)
    last = begin + steps * size * pixels.shape
    place: dict[str, Any] = {"origin": "lower", "extent": (begin[1], last[1], begin[0], last[0])}
    values = np.ma.masked_invalid(pixels / unit.factor)
    axis.imshow(values, norm=scale.limits.normalise(unit), cmap=look.colours, **place)
    draw_contour(axis, pixels, scale.level, CONTOUR_COLOUR, 0.8, **place)
    if look.outline and "pressure" in shown.source.fields:
        pressed = shown.source.fields["pressure"][shown.part] > 0
        contacts = blocks(pressed.astype(np.float32), size, np.max)
        draw_contour(axis, contacts, 0.5, look.outline, 0.5, **place)
    axis.set(
        xlim=(begin[1], end[1]),
        ylim=(begin[0], end[0]),
        xlabel=length.label("x"),
        ylabel=length.label("y"),
        aspect="equal",
    )
    axis.spines[["top", "right"]].set_visible(True)
    title = ", ".join(text for text in (shown.source.title, shown.note) if text)
    finish_title(axis, title, scale.limits.beyond(shown.values, unit))


def draw_contour(
    axis: Axes, values: Array, level: float | None, colour: str, width: float, *nodes: Array, **place: Any
) -> None:
    """Draw the contour of a value, if there is one and it occurs."""
    if level is not None and min(values.shape) > 1 and values.min() < level < values.max():
        crossings = np.count_nonzero(np.diff(values > level, axis=1)) / values.shape[0]
        width *= min(1.0, max(THINNEST, DENSE / max(crossings, 1.0)))
        axis.contour(*nodes, values, levels=[level], colors=colour, linewidths=width, **place)
