"""Fields of the stress inside the solid, plane by plane, on grids no finer than the depth needs.

Conventions: `depth` is measured downward from the surface, tension is positive, stresses are in the unit of
the contact pressure, which is also the unit of Young's modulus. The names of the fields:

- ``xx, yy, zz, yz, xz, xy``: the components;
- ``von_mises``: the equivalent stress of von Mises;
- ``maximum_shear``: half the difference of the largest and smallest principal stress (Tresca);
- ``hydrostatic``: the mean of the three normal stresses;
- ``principal_1, principal_2, principal_3``: the principal stresses, the largest (most tensile) first.

Sliding
-------
With ``friction`` μ > 0 the solid also bears the shear traction t = μ p along ``sliding_direction``: full
sliding, with the traction on this solid in the direction in which the other body moves over it. The pressure
stays as in the contact without friction. This is exact for two equal bodies, and for incompressible
half-spaces against each other or a rigid body. Otherwise, and on a bonded layer or a coating for every ν, the
normal displacement by the traction is neglected: `asperity.elasticity.two_bodies.sliding_coupling` says how
large it is. The mean (q = 0) mode of the traction is σ_xz = t̄_x, σ_yz = t̄_y at every depth (z upward).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from asperity.core.arguments import number, own_errors, require_finite
from asperity.core.types import Array, Progress
from asperity.elasticity.loaded_solid import ContactLike, LoadedSolid
from asperity.fourier.grid import Grid, Work
from asperity.stress.planes.stream import MAX_PLANES, PLANE_TOLERANCE, PlaneStream

COATING_PLANES = 4
"""Fewest planes in a coating above its interface, in which a thin one is stretched, sheared and bent."""

DEEP_GROWTH = 0.06
"""Distance between planes below the depth of the cell, relative to their depth, where only a background
changes: a plane meets the maximum stress of a Hertz contact to 0.1 %."""


@dataclass(frozen=True, repr=False)
class StressPlane:
    """Fields of the stress in one plane.

    Parameters
    ----------
    depth : float
    grid : Grid
        Of the same cell as the contact, no finer.
    poisson : tuple of float
        Poisson's ratios, along the first axis of every field.
    fields : dict
        Name → array (ratios, ny, nx) in the unit of the contact pressure.
    bound : float
        Bound of the error of any field at any node from the modes that the grid drops, in the same unit.
    first_node : (y, x)
        Its position, where the first node of the contact is at 0; not 0 on a coarser grid of a mirrored map.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> plane = next(iter(asp.stress_planes(contact, [0.02], fields=("von_mises",))))
    >>> plane.depth, plane.fields["von_mises"].shape  # Poisson's ratios, y, x
    (0.02, (1, 64, 64))
    """

    depth: float
    grid: Grid
    poisson: tuple[float, ...]
    fields: dict[str, Array]
    bound: float
    first_node: tuple[float, float] = (0.0, 0.0)

    def __repr__(self) -> str:
        ny, nx = self.grid.shape
        return f"<StressPlane of {ny} × {nx} nodes at depth {self.depth:.4g}: {', '.join(self.fields)}>"


def stress_planes(
    contact: ContactLike,
    depths: ArrayLike,
    poisson: float | Sequence[float] | None = None,
    fields: Sequence[str] = ("von_mises",),
    tolerance: float = PLANE_TOLERANCE,
    threads: int = 1,
    progress: Progress | None = None,
    work: Work | None = None,
    *,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
) -> Iterator[StressPlane]:
    """Stream fields of the stress, one plane at a time.

    Parameters
    ----------
    contact : object with ``pressure``, ``grid`` and ``layer``
        A `Contact`, or a `LoadedSolid` with any finite pressure.
    depths : (planes,) array
        Rising depths ≥ 0, in a layer of at most its height. `Solid.interface` is the lower face of a coating,
        the next larger number (`numpy.nextafter`) the upper face of its base.
    poisson : float or sequence, optional
        Poisson's ratios, on the half-space any number at once; by default the contact's. In a layer of finite
        height only the contact's, on which the pressure depends. With a coating the ratio of the coating; the
        base keeps its own.
    fields : names
        Any names in the description of the module. Only the basis fields that they need are computed.
    tolerance : float
        Largest error of any field at any node where a plane is computed on a coarser grid, relative to the
        root mean square of σ_zz in that plane. 0 computes every plane on the grid of the contact.
    threads : int
        The result does not depend on it.
    progress : callable, optional
        Called as progress(done, total) after each plane; in proportion to the nodes of the planes.
    work : Work, optional
        Where the transforms are counted.
    friction : float
        Coefficient of friction μ, from 0 to 1000: the shear traction is μ times the pressure. On a
        half-space, coated or not, or a layer bonded to a rigid base. The traction of a mirrored map is no
        mirror image: the stress is computed in the cell of the map and its three images, which slide the
        same way, and the planes are cut to the map. Their grids are not mirrored; `find_peaks` takes them
        with ``boundary="free"`` and finds no peaks at the mirror lines, which `analyse_stress` finds.
    sliding_direction : "x", "y" or float
        Direction of the traction on this solid; a number is an angle in degrees from x towards y.

    Yields
    ------
    StressPlane

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), mean_pressure=1e-3)
    >>> for plane in asp.stress_planes(contact, depths=[0.0, 0.1, 0.5], fields=("zz", "von_mises")):
    ...     print(f"{plane.depth:.1f} {plane.fields['zz'].shape} {plane.fields['zz'].mean():.6f}")
    0.0 (1, 64, 64) -0.001000
    0.1 (1, 60, 60) -0.001000
    0.5 (1, 16, 16) -0.001000
    """
    stream = PlaneStream(
        contact, depths, poisson, fields, tolerance, threads, work, friction, sliding_direction
    )
    following = own_errors(partial(next, named_fields(stream, progress), None))
    return (plane for plane in iter(following, None))  # a generator, which can be closed


def named_fields(
    stream: PlaneStream, progress: Progress | None = None, at: Sequence[float] | None = None
) -> Iterator[StressPlane]:
    """The fields of a stream of planes, or of planes at some other depths under the same pressure."""
    for plane in stream.planes(progress, at=at):
        fields, grid = plane.named_fields(stream.names, stream.ratios), plane.grid
        if stream.map_grid.mirrored and not grid.mirrored:
            ny, nx = (n // images for n, images in zip(grid.shape, stream.map_grid.images, strict=True))
            grid = Grid((ny, nx), stream.map_grid.length)
            fields = {name: field[:, :ny, :nx] for name, field in fields.items()}
        require_finite("stress_planes", fields)
        yield StressPlane(plane.depth, grid, tuple(stream.ratios), fields, plane.bound, plane.first_node)


def depth_grid(
    grid: Grid,
    height: float | None = None,
    spacing: float = 0.5,
    growth: float = 0.125,
    interface: float | Sequence[float] | None = None,
) -> Array:
    """Depths of planes from the surface to the bottom, close near the surface and farther apart below.

    A contact spot of radius a has its maximum von Mises stress at 0.38–0.55 a, and the stress changes over
    lengths of about a. A feature at depth d is at least about 2 d wide, because shorter modes have decayed.
    Planes are therefore `spacing` grid spacings apart at first, and `growth` × depth apart below.

    Parameters
    ----------
    grid : Grid
        Of the contact pressure.
    height : float, optional
        Depth of the last plane, by default the longer period.
    spacing : float
        Distance between the planes nearest to the surface, in spacings of the grid.
    growth : float
        Largest distance between planes, relative to their depth.
    interface : float or sequence of float, optional
        Depths of the interfaces between layers, `Solid.interfaces`: planes lie on both faces of each, the
        lower one at the next larger number, and in each layer are at least `COATING_PLANES`.

    Returns
    -------
    depths : (planes,) array
        Rising from 0 to the height.

    Raises
    ------
    ValueError, TypeError
        If an argument is not a positive finite number, or more than `MAX_PLANES` planes would be needed.

    Examples
    --------
    >>> depths = asp.stress.depth_grid(asp.Grid((64, 64)), height=0.5)
    >>> depths[:4] * 64  # in spacings of the grid
    array([0. , 0.5, 1. , 1.5])
    >>> depths.size, float(depths[-1])
    (27, 0.5)
    """
    positive = "a positive finite number"
    spacing = number("spacing", spacing, positive, lambda value: value > 0)
    growth = number("growth", growth, positive, lambda value: value > 0)
    bottom = max(grid.period)
    if height is not None:
        bottom = number("height", height, "a positive finite length", lambda value: value > 0)
    finest = spacing * min(grid.spacing)
    depths = [0.0]
    while depths[-1] < bottom:
        if len(depths) == MAX_PLANES:
            raise ValueError(
                f"spacing = {spacing:g}, growth = {growth:g}: larger values are needed, these make more than "
                f"{MAX_PLANES} planes to the depth {bottom:g}"
            )
        depths.append(depths[-1] + max(finest, growth * depths[-1]))
    depths[-1] = bottom
    if len(depths) > 2 and bottom - depths[-2] < 0.5 * (depths[-2] - depths[-3]):
        del depths[-2]
    found = np.array(depths)
    start, near = 0.0, 1 + 0.5 * growth
    for given in () if interface is None else np.ravel(interface).tolist():
        face = number("interface", given, f"a depth above {start:g}", start.__lt__)
        inside = found[(found >= start) & (found < face / near)]
        if inside.size < COATING_PLANES:
            inside = np.linspace(start, face, COATING_PLANES, endpoint=False)
        below = float(np.nextafter(face, np.inf))
        outside = (found > face * near) | ((found == height) & (found > below))
        found = np.concatenate([found[found < start], inside, [face, below], found[outside]])
        start = below
    require_finite("depth_grid", {"depths": found})
    return found


def default_depths(solid: LoadedSolid) -> Array:
    """Depths of `depth_grid` for a solid, and below them depths down to `LoadedSolid.deepest`."""
    depths = depth_grid(solid.grid, solid.layer.extent, interface=solid.layer.interfaces)
    if solid.deepest <= depths[-1]:
        return depths
    count = int(np.log(solid.deepest / depths[-1]) / np.log1p(DEEP_GROWTH)) + 2
    return np.append(depths, np.geomspace(depths[-1], solid.deepest, count)[1:])
