"""Sections and boxes of the solid: fields of the stress on one grid, from planes on grids of their own.

The basis fields A and B of each plane are interpolated along y and x; the named fields are made from the
interpolated ones, never interpolated themselves. Over a periodic boundary the interpolation is the
trigonometric one, exact for the modes of the plane; a mirrored map is continued by its images. Over a free
boundary it is Lagrange's on the `LAGRANGE_NODES` nearest nodes. Where a plane has the nodes that are asked
for, they are taken as they are.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from asperity.core.arguments import choice, number, own_errors, pair, require_finite
from asperity.core.errors import shown
from asperity.core.types import Array, ArrayLike, Progress
from asperity.elasticity.loaded_solid import ContactLike, LoadedSolid
from asperity.fourier.grid import BOUNDARIES, EVEN, Grid
from asperity.stress.planes.fields import BASIS, ODD, lagrange_weights
from asperity.stress.planes.planes import depth_grid
from asperity.stress.planes.stream import LinearPlane, PlaneStream

LAGRANGE_NODES = 10
"""Nodes of the interpolation over a free boundary: its error is below 1e-4 for waves of seven nodes."""

LARGEST_DATASET = 2**31
"""Most bytes of a box as a dataset; a larger one can still be streamed."""

MOST_NODES = 100_000
"""Most nodes along an edge of the cell that a box may have."""

ON_A_NODE = 1e-9
"""A position nearer to a node than this fraction of a spacing is on it."""


class StressBox:
    """Fields of the stress in a box of the solid, computed plane by plane as they are asked for.

    Attributes
    ----------
    depth, y, x : (planes,), (ny,), (nx,) arrays
        The nodes of the box.
    poisson : tuple of float
    fields : tuple of str

    Notes
    -----
    `planes` holds one plane in memory, whatever the height of the box.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> box = asp.stress.stress_box(contact, [0.0, 0.01], y=(0, 0.5), x=(0, 0.25), fields=("von_mises",))
    >>> [plane["von_mises"].shape for plane in box.planes()]  # Poisson's ratios, y, x
    [(1, 33, 17), (1, 33, 17)]
    """

    def __init__(self, stream: PlaneStream, y: Array, x: Array) -> None:
        self._stream, self.depth, self.y, self.x = stream, stream.depths, y, x
        self.poisson, self.fields = tuple(stream.ratios), stream.names

    def __repr__(self) -> str:
        shape = " × ".join(str(axis.size) for axis in (self.depth, self.y, self.x))
        return f"<StressBox of {shape} nodes along depth, y, x: {', '.join(self.fields)}>"

    def planes(self, progress: Progress | None = None) -> Iterator[dict[str, Array]]:
        """The fields of one depth after the other: name → (ratios, ny, nx) array."""
        for plane in self._stream.planes(progress):
            fields = _interpolated(plane, self.y, self.x).named_fields(self.fields, self.poisson)
            require_finite("stress_box", fields)
            yield fields

    def dataset(self, progress: Progress | None = None) -> xr.Dataset:
        """All fields, along `poisson`, `depth`, `y` and `x`.

        Parameters
        ----------
        progress : callable, optional
            Called as progress(done, total) after each plane.

        Raises
        ------
        ValueError
            If they are larger than `LARGEST_DATASET`.
        """
        shape = len(self.poisson), self.depth.size, self.y.size, self.x.size
        size = 8 * len(self.fields) * int(np.prod(shape))
        if size > LARGEST_DATASET:
            raise ValueError(
                f"box of {self.depth.size} × {self.y.size} × {self.x.size} nodes: {size / 2**30:.1f} GiB, at "
                f"most {LARGEST_DATASET / 2**30:g} GiB are accepted; take fewer nodes, or one plane "
                "at a time by planes()"
            )
        values = {name: np.empty(shape) for name in self.fields}
        for index, plane in enumerate(self.planes(progress)):
            for name in self.fields:
                values[name][:, index] = plane[name]
        dimensions = ("poisson", "depth", "y", "x")
        return xr.Dataset(
            {name: (dimensions, array) for name, array in values.items()},
            coords={"poisson": list(self.poisson), "depth": self.depth, "y": self.y, "x": self.x},
        )


def stress_box(
    contact: ContactLike,
    depths: ArrayLike,
    y: tuple[float, float] | None = None,
    x: tuple[float, float] | None = None,
    fields: Sequence[str] = ("von_mises",),
    poisson: float | Sequence[float] | None = None,
    *,
    spacing: float | None = None,
    **settings: Any,
) -> StressBox:
    """Fields of the stress in a box of the solid, on one grid.

    Parameters
    ----------
    contact, depths, fields, poisson
        As for `stress_planes`.
    y, x : (first, last), optional
        Range along each axis within the cell; by default the whole cell.
    spacing : float, optional
        Distance of the nodes along y and x; by default the nodes of the contact.
    **settings
        ``tolerance``, ``threads``, ``work``, ``friction``, ``sliding_direction`` of `stress_planes`.

    Returns
    -------
    StressBox
        Stresses in the unit of the contact pressure; nothing is computed until its planes are asked for.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> depths = [0.0, 0.01, 0.02]
    >>> box = asp.stress.stress_box(contact, depths, y=(0.2, 0.5), x=(0.2, 0.5), fields=("zz", "von_mises"))
    >>> dict(box.dataset().sizes)
    {'poisson': 1, 'depth': 3, 'y': 20, 'x': 20}
    >>> for plane in box.planes():  # the same, one plane in memory
    ...     print(plane["zz"].shape)
    (1, 20, 20)
    (1, 20, 20)
    (1, 20, 20)
    """
    stream = PlaneStream(contact, depths, poisson, fields, **settings)
    grid = stream.solid.grid if stream.is_sheared else stream.map_grid
    at_y, at_x = (
        _positions(name, extent, grid, axis, spacing)
        for axis, (name, extent) in enumerate({"y": y, "x": x}.items())
    )
    return StressBox(stream, at_y, at_x)


@own_errors
def stress_section(
    contact: ContactLike,
    along: str = "x",
    at: float | None = None,
    depths: ArrayLike | None = None,
    fields: Sequence[str] = ("von_mises",),
    poisson: float | Sequence[float] | None = None,
    *,
    progress: Progress | None = None,
    **settings: Any,
) -> xr.Dataset:
    """Fields of the stress in a vertical section through the solid.

    Parameters
    ----------
    contact, fields, poisson
        As for `stress_planes`.
    along : "x" | "y"
        Horizontal axis of the section.
    at : float, optional
        Position of the section on the other axis, within the cell; by default through the maximum pressure.
    depths : (planes,) array, optional
        By default from `depth_grid`.
    progress : callable, optional
        Called as progress(done, total) after each plane.
    **settings
        As for `stress_box`.

    Returns
    -------
    dataset
        Variables named as the fields, along `poisson`, `depth` and the horizontal axis, at the nodes of the
        contact; the position on the other axis is a coordinate without a dimension.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> section = asp.stress_section(contact, along="x", depths=np.linspace(0, 0.1, 11), fields=("xx", "zz"))
    >>> dict(section.sizes)
    {'poisson': 1, 'depth': 11, 'x': 64}
    >>> bool(abs(section["zz"].min() + contact.maximum_pressure) < 1e-5)  # σ_zz = −p at the surface
    True
    """
    choice("along", along, ("x", "y"))
    solid, across = LoadedSolid.of(contact), 0 if along == "x" else 1
    if at is None:
        highest = np.unravel_index(int(np.argmax(solid.pressure)), solid.grid.shape)
        at = float(highest[across] * solid.grid.spacing[across])
    length = solid.grid.length[across]
    at = number("at", at, f"a position from 0 to {length:g}", lambda value: 0 <= value <= length)
    if depths is None:
        depths = depth_grid(solid.grid, solid.layer.extent, interface=solid.layer.interfaces)
    y, x = ((at, at), None) if along == "x" else (None, (at, at))
    box = stress_box(solid, depths, y, x, fields, poisson, **settings)
    return box.dataset(progress).isel({"y" if along == "x" else "x": 0})


def _positions(name: str, extent: Any, grid: Grid, axis: int, spacing: float | None) -> Array:
    """Positions of the nodes of a box along one axis."""
    length, step = grid.length[axis], grid.spacing[axis]
    if spacing is not None:
        least = length / MOST_NODES
        step = number("spacing", spacing, f"a number of at least {least:.3g}", lambda value: value >= least)
    if extent is None:
        first, last = 0.0, length - step if length > step else 0.0
    else:
        accepted = f"a pair (first, last) of rising positions from 0 to {length:g}"
        first, last = (
            number(name, edge, accepted, lambda value: 0 <= value <= length)
            for edge in pair(name, extent, accepted)
        )
        if last < first:
            raise ValueError(f"{name} = {shown(extent)}: {accepted} is needed")
    return first + step * np.arange(int((last - first) / step + 1 + ON_A_NODE))


def _interpolated(plane: LinearPlane, y: Array, x: Array) -> LinearPlane:
    """The plane with its basis fields at other positions."""
    values = plane.basis.values[:, :, : plane.basis.columns]
    places = [
        (positions - first) / step
        for positions, first, step in zip((y, x), plane.first_node, plane.grid.spacing, strict=True)
    ]
    if not plane.grid.mirrored:
        for axis, (positions, ends) in enumerate(zip(places, BOUNDARIES[plane.solid.boundary], strict=True)):
            values = _along(axis + 1, values, positions, periodic=not ends)
        return replace(plane, basis=plane.basis._replace(values=values, columns=x.size))
    out = np.empty((len(values), y.size, x.size), values.dtype)
    for (component, _), place in zip(BASIS, plane.basis.index, strict=True):
        if place >= 0:
            field = values[place][None]
            for axis, positions, is_odd in zip((1, 2), places, ODD.get(component, EVEN), strict=True):
                image = np.flip(field, axis)
                field = np.concatenate([field, -image if is_odd else image], axis)
                field = _along(axis, field, positions, periodic=True)
            out[place] = field[0]
    return replace(plane, basis=plane.basis._replace(values=out, columns=x.size))


def _along(axis: int, values: Array, positions: Array, periodic: bool) -> Array:
    """Values interpolated to positions along one axis, in spacings from the first node.

    Through the nodes of a period by trigonometric polynomials, else by Lagrange's on the nearest nodes.
    """
    nodes, nearest = values.shape[axis], np.rint(positions)
    inside = periodic or nearest.max() < nodes
    if inside and np.all(np.abs(positions - nearest) < ON_A_NODE):
        return values.take(nearest.astype(np.int64) % nodes, axis)
    if periodic:
        distance = positions[:, None] - np.arange(nodes)
        angle = np.pi * distance / nodes
        below = nodes * (np.sin(angle) if nodes % 2 else np.tan(angle))
        on_node = np.abs(distance - nodes * np.rint(distance / nodes)) < ON_A_NODE
        weights = np.where(on_node, 1.0, np.sin(np.pi * distance) / np.where(on_node, 1.0, below))
    else:
        count = min(LAGRANGE_NODES, nodes)
        first = np.clip(np.floor(positions).astype(np.int64) - (count - 1) // 2, 0, nodes - count)
        index = first[:, None] + np.arange(count)
        weights = np.zeros((positions.size, nodes))
        np.put_along_axis(weights, index, lagrange_weights(index, positions), axis=1)
    return weights @ values if axis == 1 else values @ weights.T
