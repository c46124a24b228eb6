"""Stress in a vertical section through the solid."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Real
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.results.window import Span
from asperity.stress.depths import depth_grid
from asperity.stress.section import stress_section
from asperity.types import Array, Progress
from asperity.views.colours import Limits
from asperity.views.maps import Look
from asperity.views.measures import Measure, measure
from asperity.views.panels import add_colour_bar, canvas, finish_title
from asperity.views.source import Source
from asperity.views.stress_field import Stress, field_look, stresses

SECTION_SHAPE = 0.25
"""Largest depth of a section over its length, where no depth is given."""

FLATTEST = 0.12
"""Smallest depth of a section over its length, where no depth is given."""

FADED = 0.05
"""Where no depth is given, a section ends below the depth at which the stress has fallen to this share of its
largest, so that its small lower part does not fill the picture."""

MOST_POINTS = 2048
"""Most nodes drawn along a section; of a finer grid the largest magnitude of each block is drawn."""

SECTION_TOLERANCE = 1e-5
"""Largest relative error of the planes of a section."""


class Section(NamedTuple):
    """Stress in one vertical section.

    Parameters
    ----------
    title : str
    system : str or None
        Unit system.
    along : "x" | "y"
        Axis along the section.
    place : float
        Position of the section on the other axis.
    position, depth : arrays
    values : array [depth, position]
    contact : bool array
        True at positions in contact.
    """

    title: str
    system: str | None
    along: str
    place: float
    position: Array
    depth: Array
    values: Array
    contact: Array

    def down_to(self, bottom: float) -> Section:
        """The part above a depth."""
        kept = slice(0, int(np.searchsorted(self.depth, bottom)) + 1)
        return self._replace(depth=self.depth[kept], values=self.values[kept])


def plot_section(
    contact: Any,
    y: float | Span | None = None,
    x: float | Span | None = None,
    depth: float | None = None,
    field: str = "von_mises",
    poisson: float | None = None,
    *,
    body: str = "lower",
    friction: float | None = None,
    sliding_direction: str | float | None = None,
    axes: Axes | Sequence[Axes] | None = None,
    unit_system: str | None = None,
    progress: Progress | None = None,
) -> Figure:
    """Stress in a vertical section through the solid under a contact, with the contacts as bars above it.

    Parameters
    ----------
    contact : dataset, `Contact`, sequence of them, or mapping from titles to them
        Results of stage contact; sections of several are drawn below each other in the same colours.
    y, x : float or (first, last), optional
        A number for one of them is the place of the section, rounded to a node; a pair for the other the
        part that is drawn. By default the section runs along x through the largest contact pressure.
    depth : float, optional
        Lower end of the section. By default it is chosen so that the stress is seen, at most a quarter of
        the length and the height of the layer.
    field : str
        As for `asperity.stress_planes`.
    poisson : float, optional
        By default that of the contact.
    body : "lower" | "upper"
        The body whose stress is drawn, if the contact has two; depth counts from its surface.
    friction, sliding_direction : float, str or float, optional
        Full sliding, as for `asperity.stress_planes`, in the direction in which the upper body moves over the
        lower one; by default that of the result.
    axes, unit_system
        As for `asperity.plot_height`.
    progress : callable, optional
        Called as progress(done, total) for each result.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range, or the result does not describe a solid under a pressure.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> figure = asp.plot_section(contact, y=0.5, depth=0.1)
    >>> figure.savefig("section.png")  # doctest: +SKIP
    >>> len(figure.axes) >= 2
    True
    """
    found = stresses(contact, field, poisson, body, friction, sliding_direction, unit_system)
    sections = [_section(stress, y, x, depth, progress) for stress in found]
    look = field_look(field)
    limits = look.limits(section.values for section in sections)
    if depth is None:
        faded = FADED * max(abs(limits.low), limits.high)
        bottom = max(
            max(_faded_below(section, faded), FLATTEST * float(np.ptp(section.position)))
            for section in sections
        )
        sections = [section.down_to(bottom) for section in sections]
    system = sections[0].system
    unit = measure([limits.low, limits.high], "stress", system)
    length = measure([section.position[-1] for section in sections], "length", system)
    shape = max(float(np.ptp(section.depth) / np.ptp(section.position)) for section in sections)
    with canvas(len(sections), axes, shape, columns=1) as (figure, panels):
        for axis, section in zip(panels, sections, strict=True):
            _draw(axis, section, look, limits, unit, length)
        add_colour_bar(figure, panels, look.colours, limits, unit, look.label, below=True)
    return figure


def _section(
    stress: Stress,
    y: float | Span | None,
    x: float | Span | None,
    depth: float | None,
    progress: Progress | None,
) -> Section:
    source, solid = stress.source, stress.solid
    across, place, span = _cut(source, y, x)
    axis = "yx".index(across)
    along = "xy"[axis]
    node = round(place / solid.grid.spacing[axis]) % solid.grid.shape[axis]
    part = source.window(**{along: span})
    kept = part.columns if along == "x" else part.rows
    position = part.x if along == "x" else part.y
    exact = float(node * solid.grid.spacing[axis])
    found = stress_section(
        solid,
        along,
        exact,
        depth_grid(solid.grid, _bottom(source, solid.layer.height, depth, float(np.ptp(position)))),
        (stress.field,),
        stress.poisson,
        tolerance=SECTION_TOLERANCE,
        progress=progress,
        **stress.sliding,
    )
    values = found[stress.field].values[0][:, kept]
    touching = solid.pressure[node, kept] if along == "x" else solid.pressure[kept, node]
    return Section(
        source.title, source.system, along, exact, position, found["depth"].values, values, touching > 0
    )


def _cut(source: Source, y: float | Span | None, x: float | Span | None) -> tuple[str, float, Span | None]:
    """Axis across a section, the place of the section on it, and the part of the other axis."""
    given = {"y": y, "x": x}
    numbers = [name for name, value in given.items() if isinstance(value, Real)]
    pairs = [name for name, value in given.items() if value is not None and name not in numbers]
    if len(numbers) == 2 or len(pairs) == 2:
        raise ValueError("y, x: a number for one of them and at most a pair for the other are needed")
    across = numbers[0] if numbers else "x" if pairs == ["y"] else "y"
    span = given["x" if across == "y" else "y"]
    axis = "yx".index(across)
    if not numbers:
        largest = np.unravel_index(source.field("pressure").argmax(), source.grid.shape)[axis]
        return across, float(largest * source.grid.spacing[axis]), span  # type: ignore[return-value]
    place, edge = float(given[across]), source.grid.length[axis]  # type: ignore[arg-type]
    if not 0 <= place <= edge:
        raise ValueError(
            f"{across} = {source.told(place)}: a position from 0 to {source.told(edge)} is needed"
        )
    return across, place, span  # type: ignore[return-value]


def _bottom(source: Source, height: float | None, depth: float | None, length: float) -> float:
    """Depth of the lower end of a section of some length through a solid of some height."""
    if depth is None:
        return min(SECTION_SHAPE * length, height or np.inf)
    if not 0 < depth <= (height or np.inf):
        most = f" and at most {source.told(height)}" if height else ""
        raise ValueError(f"depth = {source.told(depth)}: a depth > 0{most} is needed")
    return depth


def _faded_below(section: Section, faded: float) -> float:
    """Depth of the plane below the deepest one with a stress above a magnitude."""
    seen = np.flatnonzero(np.abs(section.values).max(axis=1) > faded)
    below = min(int(seen.max(initial=0)) + 1, section.depth.size - 1)
    return float(section.depth[below])


def _draw(axis: Axes, section: Section, look: Look, limits: Limits, unit: Measure, length: Measure) -> None:
    position, values, contact = _thinned(section, look)
    axis.pcolormesh(
        position / length.factor,
        section.depth / length.factor,
        values / unit.factor,
        norm=limits.normalise(unit),
        cmap=look.colours,
        shading="gouraud",
        rasterized=True,
    )
    # The contacts are bars on the upper edge, as thick as two spines.
    bars = np.where(contact, 0.0, np.nan)
    axis.plot(position / length.factor, bars, color="k", lw=3, solid_capstyle="butt", clip_on=False, zorder=5)
    axis.set(
        xlim=(position[0] / length.factor, position[-1] / length.factor),
        ylim=(section.depth[-1] / length.factor, 0),
        xlabel=length.label(section.along),
        ylabel=length.label("depth"),
        aspect="equal",
    )
    across = "y" if section.along == "x" else "x"
    place = f"{across} = {length.text(section.place)}"
    title = ", ".join(line for line in (section.title, place) if line)
    finish_title(axis, title, limits.beyond(section.values, unit))


def _thinned(section: Section, look: Look) -> tuple[Array, Array, Array]:
    """Positions, values and contacts of a section of at most `MOST_POINTS` points."""
    count = section.position.size
    block = -(-count // MOST_POINTS)
    if block == 1:
        return section.position, section.values, section.contact
    kept = count // block * block
    values = section.values[:, :kept].reshape(section.depth.size, -1, block)
    position = section.position[:kept].reshape(-1, block).mean(axis=1)
    contact = np.asarray(section.contact[:kept].reshape(-1, block).any(axis=1))
    return position, look.reduce(values, axis=(2,)), contact
