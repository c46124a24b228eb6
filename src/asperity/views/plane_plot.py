"""Stress in a plane below the surface."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.core.types import Progress
from asperity.stress.planes.planes import depth_grid, stress_planes
from asperity.views.maps import Map, draw_maps
from asperity.views.scales import measure
from asperity.views.source import Span
from asperity.views.stress_field import BodyView, Stress, field_look, stresses

SEARCH_TOLERANCE = 1e-4
"""Largest relative error of the planes in which the depth of the largest stress is sought."""

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
        Depth of the plane; "max": that of the largest magnitude of the field, of each result.
    field, poisson, body, friction, sliding_direction, axes, unit_system, progress
        As for `plot_section`.
    y, x : (first, last), optional
        Part of the cell.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range, or the result does not describe a solid under a pressure.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> figure = asp.plot_plane(contact, depth=0.02, field="largest_shear")
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
        label = "depth of the largest"
        depths = depth_grid(solid.grid, solid.layer.extent, interface=solid.layer.interface)
        planes = stress_planes(
            solid, depths, fields=(field,), tolerance=SEARCH_TOLERANCE, progress=progress, **stress.settings
        )
        depth = -max((float(np.abs(plane.fields[field]).max()), -plane.depth) for plane in planes)[1]
    place = float(depth)
    deepest = solid.layer.extent or MAX_DEPTH * max(solid.grid.length)
    if not 0 <= place <= deepest:
        raise ValueError(
            f"depth = {source.shown(place)}: max or a depth from 0 to {source.shown(deepest)} is needed"
        )
    (plane,) = stress_planes(solid, [place], fields=(field,), tolerance=0.0, **stress.settings)
    note = f"{label}: {measure(place, 'length', source.system).text(place)}"
    return Map(source, part, plane.fields[field][0][part], note)
