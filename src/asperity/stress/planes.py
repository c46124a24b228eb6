"""Stress inside the solid, plane by plane, on grids no finer than the depth needs.

At depth d a mode of the contact pressure with wavenumber q has decayed to (1 + q d) e^(−q d) of its surface
value, so a deep plane is smooth and a coarse grid holds it (`asperity.stress.truncation`). `stress_planes`
streams named fields of the stress; `linear_planes` streams the parts from which they are made.

Conventions: `depth` is measured downward from the surface, tension is positive, stresses are in the unit of
the contact pressure, which is that of Young's modulus. The names of the fields:

- ``xx, yy, zz, yz, xz, xy``: the components;
- ``von_mises``: the equivalent stress of von Mises;
- ``largest_shear``: half the difference of the largest and smallest principal stress (Tresca);
- ``hydrostatic``: the mean of the three normal stresses;
- ``principal_1, principal_2, principal_3``: the principal stresses, the largest (most tensile) first.

Poisson's ratio
---------------
In a half-space the stress is A + ν B with fields A and B that do not depend on ν (only the uniform mode adds
a term in ν/(1 − ν)), and neither does the contact pressure over E* = E/(1 − ν²). At most eight inverse
transforms a plane therefore serve every Poisson's ratio. A layer of finite height has the ν of its contact
only.

Sliding
-------
With ``friction`` μ > 0 the solid also bears the shear traction t = μ p along ``sliding_direction``: full
sliding, with the traction on this solid in the direction in which the other body moves over it. The pressure
stays that of the contact without friction. This is exact if both bodies have equal elastic constants or are
incompressible, and against a rigid body if ν = 1/2; otherwise the effect of the traction on the pressure is
neglected. The uniform mode of the traction is σ_xz = t̄_x, σ_yz = t̄_y at every depth (z upward).

Precision
---------
Planes are computed in single precision where the tolerance is well above its rounding.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asperity.elasticity.layer import COMPONENTS, Layer
from asperity.finite import require_finite
from asperity.spectral import Fourier, Grid, Work
from asperity.stress.arguments import (
    FIELDS,
    boundary_of,
    checked_contact,
    checked_depths,
    checked_names,
    checked_ratios,
    checked_sliding,
    checked_threads,
    checked_tolerance,
)
from asperity.stress.free_boundary import FreePlanes
from asperity.stress.linear_plane import LinearPlane, components_for
from asperity.stress.parts import Part
from asperity.stress.periodic import PeriodicPlanes, Visit, aligned_array
from asperity.stress.pressed import ContactLike
from asperity.stress.truncation import envelope_of
from asperity.tasks import results_of
from asperity.types import Array, Progress

SINGLE_PRECISION_TOLERANCE = 3e-5
"""Smallest tolerance for which single precision will do: its transforms round to a few 1e-7 of the root mean
square."""

SINGLE_PRECISION_PRESSURES = (1e-10, 1e15)
"""Largest pressures for which single precision will do: squares of stresses stay within it."""


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
        Proven largest error of any field at any node from the modes that the grid drops, in the same unit.
    """

    depth: float
    grid: Grid
    poisson: tuple[float, ...]
    fields: dict[str, Array]
    bound: float

    def __repr__(self) -> str:
        ny, nx = self.grid.shape
        return f"<StressPlane of {ny} × {nx} nodes at depth {self.depth:.4g}: {', '.join(self.fields)}>"


Watch = Callable[[LinearPlane], Visit]
"""Takes a plane that is not yet filled, and returns what is called as its rows are filled."""


def stress_planes(
    contact: ContactLike,
    depths: ArrayLike,
    poisson: float | Sequence[float] | None = None,
    fields: Sequence[str] = ("von_mises",),
    tolerance: float = 1e-6,
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
        A `Contact`, or a `PressedSolid` with any finite pressure.
    depths : (planes,) array
        Rising depths ≥ 0, in a layer of at most its height.
    poisson : float or sequence, optional
        Poisson's ratios, on the half-space any number at once; by default that of the contact. In a layer
        of finite height only that of the contact, on which its pressure depends.
    fields : names
        Any of those in the description of the module. Only what they need is computed.
    tolerance : float
        Largest error of any field at any node where a plane is computed on a coarser grid, relative to the
        root mean square of σ_zz in that plane. 0 computes every plane on the grid of the contact.
    threads : int
        The result does not depend on it.
    progress : callable, optional
        Called as progress(done, total) after each plane; planes count by their nodes.
    work : Work, optional
        Where the transforms are counted.
    friction : float
        Coefficient of friction μ, from 0 to 1000: the shear traction is μ times the pressure. On a
        half-space, or a layer bonded to a rigid base.
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
    >>> contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), mean_pressure=1e-3)
    >>> for plane in asp.stress_planes(contact, depths=[0.0, 0.1, 0.5], fields=("zz", "von_mises")):
    ...     print(f"{plane.depth:.1f} {plane.fields['zz'].shape} {plane.fields['zz'].mean():.6f}")
    0.0 (1, 64, 64) -0.001000
    0.1 (1, 60, 60) -0.001000
    0.5 (1, 16, 16) -0.001000
    """
    names = checked_names("fields", fields, FIELDS)
    planes = linear_planes(
        contact,
        depths,
        poisson,
        names,
        tolerance,
        threads,
        work,
        friction=friction,
        sliding_direction=sliding_direction,
    )
    return _named_fields(planes, checked_ratios(poisson, contact.layer), names, progress)


def _named_fields(
    planes: Iterator[LinearPlane], ratios: list[float], names: tuple[str, ...], progress: Progress | None
) -> Iterator[StressPlane]:
    for plane in planes:
        fields = {}
        for name in names:
            fields[name] = np.empty((len(ratios), *plane.grid.shape), plane.dtype)
            for out, nu in zip(fields[name], ratios, strict=True):
                plane.field(name, nu, out)
        require_finite("stress_planes", fields)
        yield StressPlane(plane.depth, plane.grid, tuple(ratios), fields, plane.bound)
        if progress is not None:
            progress(plane.done, 1.0)


def linear_planes(
    contact: ContactLike,
    depths: ArrayLike,
    poisson: float | Sequence[float] | None = None,
    fields: Sequence[str] = ("von_mises",),
    tolerance: float = 1e-6,
    threads: int = 1,
    work: Work | None = None,
    *,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
    watch: Watch | None = None,
) -> Iterator[LinearPlane]:
    """Stream the parts A and B of the stress, one plane at a time.

    Arguments are as for `stress_planes`, and `watch` is called before a plane is computed.
    """
    pressure, largest = checked_contact(contact)
    tolerance = checked_tolerance(tolerance)
    low, high = SINGLE_PRECISION_PRESSURES
    boundary = boundary_of(contact)
    single = tolerance >= SINGLE_PRECISION_TOLERANCE and low <= largest <= high and boundary == "periodic"
    stream = _PlaneStream(
        grid=contact.grid,
        layer=contact.layer,
        depths=checked_depths(depths, contact),
        ratios=checked_ratios(poisson, contact.layer),
        components=components_for(checked_names("fields", fields, FIELDS)),
        tolerance=tolerance,
        dtype="float32" if single else "float64",
        threads=checked_threads(threads),
        work=Work() if work is None else work,
        traction=checked_sliding(friction, sliding_direction, contact.layer),
        boundary=boundary,
    )
    return stream.planes(pressure, watch)


@dataclass(frozen=True)
class _PlaneStream:
    """Checked arguments of `linear_planes`."""

    grid: Grid
    layer: Layer
    depths: Array
    ratios: list[float]
    components: tuple[str, ...]
    tolerance: float
    dtype: str
    threads: int
    work: Work
    traction: tuple[float, float]
    boundary: str

    def planes(self, pressure: Array, watch: Watch | None) -> Iterator[LinearPlane]:
        """The planes under a pressure, from the surface downward."""
        source = self._source(pressure)
        done = np.cumsum([each.grid.size for each in source.plan], dtype=float)
        done /= done[-1]
        mean = source.mean_pressure
        lateral = {
            nu: mean * float(replace(self.layer, poisson=nu).uniform_stress()[0]) for nu in self.ratios
        }
        constants, slopes = self._parts()
        parts = constants + slopes
        rooms = deque([np.empty(0, self.dtype)] * 2)

        def run(function: Callable[[Any], None], items: Sequence[Any]) -> None:
            results_of([partial(function, item) for item in items], self.threads)

        for depth, own, share in zip(self.depths, source.plan, done, strict=True):
            grid = own.grid
            rooms.rotate()
            rooms[0], values = _array_in(rooms[0], (grid.shape[0], len(parts), source.row_length(grid)))
            fields = [values[:, number, : grid.shape[1]] for number in range(len(parts))]
            constant = {part.component: field for part, field in zip(constants, fields, strict=False)}
            slope = {
                part.component: field for part, field in zip(slopes, fields[len(constants) :], strict=True)
            }
            plane = LinearPlane(
                float(depth),
                grid,
                own.bound,
                constant,
                slope,
                mean,
                lateral,
                float(share),
                values,
                own.scale,
            )
            visit = watch(plane) if watch is not None else lambda *_: None
            self.work.nodes += source.compute(depth, own, parts, values, run, visit)
            yield plane

    def _source(self, pressure: Array) -> PeriodicPlanes | FreePlanes:
        """Where the parts of the stress come from."""
        envelope = envelope_of(self.layer, min(self.ratios), float(np.hypot(*self.traction)))
        arguments = self.grid, self.layer, self.depths, self.tolerance, envelope, self.traction
        if self.boundary == "free":
            return FreePlanes(pressure, *arguments, self.threads, self.work)
        fourier = Fourier(self.grid, threads=self.threads, work=self.work)
        return PeriodicPlanes(pressure, fourier.forward(pressure), *arguments, self.dtype)

    def _parts(self) -> tuple[list[Part], list[Part]]:
        """The parts to transform: A and B for several Poisson's ratios, A + ν B for one."""
        if len(self.ratios) == 1:
            return [Part(name, 1.0, self.ratios[0]) for name in self.components], []
        sloping = ("xx", "xy") if self.components == COMPONENTS else ("xx", "yy", "xy")
        return (
            [Part(name, 1.0, 0.0) for name in self.components],
            [Part(name, 0.0, 1.0) for name in self.components if name in sloping],
        )


def _array_in(room: Array, shape: tuple[int, ...]) -> tuple[Array, Array]:
    """An array in memory that is kept if it is large enough, and that memory."""
    size = int(np.prod(shape))
    if room.size < size:
        room = aligned_array(size, room.dtype)
    return room, room[:size].reshape(shape)
