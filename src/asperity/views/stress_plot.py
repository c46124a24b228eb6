"""Stress in a body under a contact, in a plane below its surface or in a vertical section."""

from collections.abc import Sequence
from numbers import Real
from typing import Any, NamedTuple, TypedDict, Unpack

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.core.types import Progress
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.stress.planes.planes import default_depths, depth_grid, stress_planes
from asperity.stress.section import stress_section
from asperity.views.maps import CONTOUR_COLOUR, Map, draw_contour, draw_maps
from asperity.views.panels import add_colour_bar, canvas, finish_title
from asperity.views.scales import SIGNED, STRESS, Look, Scale, blocks, largest_magnitude, measure
from asperity.views.source import Source, Span, sources

POSITIVE = ("von_mises", "maximum_shear")
"""Fields without a sign."""

_NAMES = {
    "von_mises": "von Mises stress",
    "maximum_shear": "maximum shear stress",
    "hydrostatic": "hydrostatic stress",
    "principal_1": "maximum principal stress",
    "principal_2": "middle principal stress",
    "principal_3": "minimum principal stress",
}


class Stress(NamedTuple):
    """A field of the stress in a body under a contact.

    Parameters
    ----------
    source : Source
    solid : LoadedSolid
    field : str
    settings : dict
        ``poisson``, ``friction`` and ``sliding_direction``, as arguments of `asperity.stress_planes`.
    """

    source: Source
    solid: LoadedSolid
    field: str
    settings: dict[str, Any]


class BodyView(TypedDict, total=False):
    """Arguments of the pictures of the stress in a body; `asperity.views.plot_section` describes them."""

    body: str
    friction: float | None
    sliding_direction: str | float | None
    unit_system: str | None


def stresses(
    contact: Any, field: str, poisson: float | None, unit_system: str | None = None, **body: Any
) -> list[Stress]:
    """The field in one of the bodies of each result; `body` are arguments of `Source.loaded`."""
    found = []
    for source in sources(contact, unit_system):
        solid, sliding = source.loaded(**body)
        found.append(Stress(source, solid, field, {"poisson": poisson, **sliding}))
    return found


def field_words(field: str) -> str:
    """Name of a field of the stress in plain text."""
    return _NAMES.get(field, f"stress σ_{field}")


def field_name(field: str) -> str:
    """Name of a field of the stress, or of the contact pressure, as pictures show it."""
    if field == "pressure":
        return "contact pressure"
    return _NAMES.get(field, rf"$\sigma_{{{field}}}$")


def field_look(field: str) -> Look:
    """Colours and label of a field of the stress."""
    name = field_name(field)
    if field in POSITIVE:
        return Look(name, "stress", STRESS, "white", np.max, low=0.0)
    return Look(name, "stress", SIGNED, "black", largest_magnitude, signed=True)


SEARCH_TOLERANCE = 1e-4
"""Largest relative error of the planes in which the depth of the maximum stress is sought."""

MAX_DEPTH = 100
"""Largest depth of a plane over the longer edge of the cell; all waves have vanished far above it."""


def plot_plane(
    contact: Any,
    depth: float | str = "max",
    field: str = "von_mises",
    poisson: float | None = None,
    *,
    y: Span | None = None,
    x: Span | None = None,
    axes: Axes | Sequence[Axes] | None = None,
    progress: Progress | None = None,
    **view: Unpack[BodyView],
) -> Figure:
    """Stress in a plane below the surface, with the outlines of the contacts above it.

    Parameters
    ----------
    contact : dataset, `Contact`, sequence of them, or mapping from titles to them
        Results of stage contact; several are drawn beside each other in the same colours.
    depth : float or "max"
        Depth of the plane; "max": the depth of the largest magnitude of the field, in each result.
    field, poisson, body, friction, sliding_direction, axes, unit_system, progress
        As for `plot_section`.
    y, x : (first, last), optional
        Part of the cell.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range, or the result does not describe a solid under a pressure.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> figure = asp.views.plot_plane(contact, depth=0.02, field="maximum_shear")
    >>> figure.savefig("plane.png")  # doctest: +SKIP
    >>> len(figure.axes)  # the map and its colour bar
    2
    """
    found = stresses(contact, field, poisson, **view)
    maps = [_plane(stress, depth, y, x, progress) for stress in found]
    return draw_maps(maps, field_look(field), axes)


def _plane(
    stress: Stress, depth: float | str, y: Span | None, x: Span | None, progress: Progress | None
) -> Map:
    source, solid, field = stress.source, stress.solid, stress.field
    part = source.part(y, x)
    label = "depth"
    if depth == "max":
        label = "depth of the maximum"
        depth = _largest(stress, progress)[0]
    place = float(depth)
    deepest = solid.layer.extent or MAX_DEPTH * max(solid.grid.length)
    if not 0 <= place <= deepest:
        needed = f"max or a depth from 0 to {source.shown(deepest)} is needed"
        raise ValueError(f"depth = {source.shown(place)}: {needed}")
    (plane,) = stress_planes(solid, [place], fields=(field,), tolerance=0.0, **stress.settings)
    note = f"{label}: {measure(place, 'length', source.system).text(place)}"
    return Map(source, part, plane.fields[field][0][part], note)


def _largest(stress: Stress, progress: Progress | None) -> tuple[float, tuple[int, int]]:
    """Depth and node (y, x) of the largest magnitude of the field on the default planes."""
    found: tuple[float, float, int] = (-1.0, 0.0, 0)
    for plane in stress_planes(
        stress.solid,
        default_depths(stress.solid),
        fields=(stress.field,),
        tolerance=SEARCH_TOLERANCE,
        progress=progress,
        **stress.settings,
    ):
        values = np.abs(plane.fields[stress.field][0])
        node = int(values.argmax())
        found = max(found, (float(values.flat[node]), -plane.depth, node))
    y, x = divmod(found[2], stress.solid.grid.shape[1])
    return -found[1], (y, x)


MAX_SHAPE = 0.25
"""Largest depth of a section over its length, where no depth is given."""

FLATTEST_SECTION = 0.25
"""Height over width of the picture of a section; depths of flatter ones are stretched."""

MIN_SHAPE = 0.12
"""Smallest depth of a section over its length, where no depth is given."""

FADED = 0.05
"""Where no depth is given, a section ends below the depth at which the stress is this fraction of its
maximum, so that its small lower part does not fill the picture."""

MAX_POINTS = 2048
"""Most nodes drawn along a section; of a finer grid the largest magnitude of each block is drawn."""

SECTION_TOLERANCE = 1e-5
"""Largest relative error of the planes of a section."""


def plot_section(
    contact: Any,
    y: float | str | Span | None = None,
    x: float | str | Span | None = None,
    depth: float | None = None,
    field: str = "von_mises",
    poisson: float | None = None,
    *,
    axes: Axes | Sequence[Axes] | None = None,
    progress: Progress | None = None,
    **view: Unpack[BodyView],
) -> Figure:
    """Stress in a vertical section through the solid under a contact, with the contacts as bars above it.

    Parameters
    ----------
    contact : dataset, `Contact`, sequence of them, or mapping from titles to them
        Results of stage contact; sections of several are drawn below each other in the same colours.
    y, x : float, "max" or (first, last), optional
        A number for one of them is the place of the section, rounded to a node, "max" the place of the
        largest magnitude of the field; a pair for the other is the part that is drawn. By default the section
        runs along x through the maximum contact pressure.
    depth : float, optional
        Lower end of the section. By default it is chosen so that the stress is seen, at most a quarter of
        the length and the height of the layer.
    field : str
        As for `asperity.stress_planes`.
    poisson : float, optional
        By default the ratio of the contact.
    body : "lower" | "upper"
        The body whose stress is drawn, if the contact has two; depths are from its surface.
    friction, sliding_direction : float, str or float, optional
        Gross sliding, as for `asperity.stress_planes`, in the direction in which the upper body moves over
        the lower body; by default as in the result.
    axes, unit_system
        As for `asperity.views.plot_height`.
    progress : callable, optional
        Called as progress(done, total) for each result.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range, or the result does not describe a solid under a pressure.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> figure = asp.views.plot_section(contact, y=0.5, depth=0.1)
    >>> figure.savefig("section.png")  # doctest: +SKIP
    >>> len(figure.axes) >= 2
    True
    """
    found = stresses(contact, field, poisson, **view)
    sections = [_section(stress, y, x, depth, progress) for stress in found]
    look = field_look(field)
    limits = look.limits(section.values for section in sections)
    if depth is None:
        sections = until_faded(sections, FADED * max(abs(limits.low), limits.high))
    return draw_sections(sections, look, found[0].source.system, axes)


def draw_sections(
    sections: Sequence[xr.DataArray],
    look: Look,
    system: str | None,
    axes: Axes | Sequence[Axes] | None,
) -> Figure:
    """Draw stresses (depth, along) below each other in common colours; their names are the titles.

    The coordinate ``contact`` says where the surface above touches; a contour is drawn where the stress
    reaches the coordinate ``limit`` (depth), if there is one.
    """
    limits = look.limits(section.values for section in sections)
    unit = measure([limits.low, limits.high], "stress", system)
    positions = [section[section.dims[1]].values for section in sections]
    length = measure([nodes[-1] for nodes in positions], "length", system)
    shapes = [
        float(np.ptp(section["depth"].values) / np.ptp(nodes))
        for section, nodes in zip(sections, positions, strict=True)
    ]
    scale, stretch = Scale(look, limits, unit, length), max(1.0, FLATTEST_SECTION / max(shapes))
    tall = [stretch * shape for shape in shapes]
    with canvas(tall, axes, columns=1, bar="bottom") as (figure, panels, bar):
        for axis, section in zip(panels, sections, strict=True):
            _draw(axis, section, scale, stretch)
        add_colour_bar(figure, panels, scale, "bottom", bar)
    return figure


def _section(
    stress: Stress,
    y: float | str | Span | None,
    x: float | str | Span | None,
    depth: float | None,
    progress: Progress | None,
) -> xr.DataArray:
    """Stress (depth, along), with the nodes in contact as coordinate ``contact``, and its title as name."""
    source, solid = stress.source, stress.solid
    given = {"y": y, "x": x}
    across = "x" if isinstance(x, (Real, str)) or not (y is None or isinstance(y, (Real, str))) else "y"
    along = "x" if across == "y" else "y"
    place, span = given[across], given[along]
    if isinstance(span, (Real, str)) or not (place in (None, "max") or isinstance(place, Real)):
        raise ValueError("y, x: a number or max for one of them and at most a pair for the other are needed")
    axis, other = "yx".index(across), "yx".index(along)
    kept = source.part(**{along: span})[other]  # type: ignore[arg-type]
    if place is None:
        node = int(np.unravel_index(source.field("pressure").argmax(), source.grid.shape)[axis])
    elif isinstance(place, str):
        node = _largest(stress, progress)[1][axis]
    else:
        node = source.node(across, place)
    height = solid.layer.extent or np.inf
    if depth is None:
        depth = min(MAX_SHAPE * solid.grid.spacing[other] * (kept.stop - kept.start - 1), height)
    elif not 0 < depth <= height:
        most = f" and at most {source.shown(height)}" if solid.layer.extent else ""
        raise ValueError(f"depth = {source.shown(depth)}: a depth > 0{most} is needed")
    at = float(node * solid.grid.spacing[axis])
    faces = [face for face in solid.layer.interfaces if face < depth]
    found = stress_section(
        solid,
        along,
        at,
        depth_grid(solid.grid, depth, interface=faces),
        (stress.field,),
        tolerance=SECTION_TOLERANCE,
        progress=progress,
        **stress.settings,
    )
    text = f"{across} = {measure(max(source.grid.length), 'length', source.system).text(at)}"
    section = found[stress.field].isel({"poisson": 0, along: kept})
    contact = solid.pressure.take(node, axis)[kept] > 0
    title = ", ".join(line for line in (source.title, text) if line)
    return section.assign_coords(contact=(along, contact)).rename(title)


def until_faded(sections: Sequence[xr.DataArray], faded: float) -> list[xr.DataArray]:
    """Sections down to the plane below the deepest one with a stress above a magnitude, or `MIN_SHAPE`."""
    bottoms = []
    for section in sections:
        above = np.flatnonzero(np.abs(section.values).max(axis=1) > faded)
        below = min(int(above.max(initial=0)) + 1, section.sizes["depth"] - 1)
        length = float(np.ptp(section[section.dims[1]].values))
        bottoms.append(max(float(section["depth"][below]), MIN_SHAPE * length))
    ends = [np.searchsorted(section["depth"], max(bottoms)) + 1 for section in sections]
    return [section.isel(depth=slice(end)) for section, end in zip(sections, ends, strict=True)]


def _draw(axis: Axes, section: xr.DataArray, scale: Scale, stretch: float) -> None:
    along, length, unit = str(section.dims[1]), scale.length, scale.unit
    starts = np.arange(0, section.sizes[along], -(-section.sizes[along] // MAX_POINTS))
    block = int(starts[1]) if starts.size > 1 else 1
    values = blocks(section.values, (1, block), scale.look.reduce)
    position, depth = section[along].values[starts] / length.factor, section["depth"].values / length.factor
    axis.pcolormesh(
        position,
        depth,
        values / unit.factor,
        norm=scale.limits.normalise(unit),
        cmap=scale.look.colours,
        shading="gouraud",
        rasterized=True,
    )
    at_face = np.diff(section["depth"].values) <= np.spacing(section["depth"].values[:-1])
    for face in depth[:-1][at_face]:
        axis.axhline(face, color="0.6", lw=0.6)  # an interface
    if "limit" in section.coords:
        over = values / section["limit"].values[:, None]
        ends = np.append(np.flatnonzero(at_face), depth.size - 1)
        for first, last in zip([0, *(ends[:-1] + 1)], ends + 1, strict=True):  # each material
            draw_contour(axis, over[first:last], 1.0, CONTOUR_COLOUR, 0.8, position, depth[first:last])
    # The contacts are bars on the upper edge, as thick as two spines.
    touching = np.flatnonzero(np.maximum.reduceat(section["contact"].values, starts))
    ends = np.append(position, 2 * position[-1] - position[-2])
    half = (ends[touching + 1] - ends[touching]) / 2
    first, last = (np.clip(position[touching] + side * half, *position[[0, -1]]) for side in (-1, 1))
    axis.hlines(0 * half, first, last, "k", lw=3, clip_on=False, zorder=5, capstyle="butt")
    axis.set(
        xlim=(position[0], position[-1]),
        ylim=(depth[-1], 0),
        xlabel=length.label(along),
        ylabel=length.label("depth"),
        aspect=stretch,
    )
    stretched = f"depth drawn {stretch:.2g} times as large" if stretch > 1 else ""
    finish_title(axis, str(section.name), stretched, scale.limits.beyond(section.values, unit))
