"""Stream of the basis fields A and B of the stress, one plane after the other, each on a grid of its own.

At depth d a mode of the contact pressure with wavenumber q has decayed to (1 + q d) e^(−q d) of its surface
value, so a deep plane is smooth and a coarse grid holds it (`asperity.stress.planes.truncation`).

Poisson's ratio
---------------
In a half-space the stress is A + ν B with basis fields A and B that do not depend on ν (only the mean mode
adds a term in ν/(1 − ν)), and neither does the contact pressure over E* = E/(1 − ν²). At most eight inverse
transforms a plane therefore serve every Poisson's ratio. A layer of finite height has the ν of its contact
only.

Precision
---------
Planes are computed in single precision where the tolerance is well above its rounding.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asperity.core.arguments import choices, number, real_array, whole_number
from asperity.core.types import Array, Progress
from asperity.elasticity.layer import COMPONENTS, Layer
from asperity.elasticity.loaded_solid import ContactLike, LoadedSolid
from asperity.fourier.grid import Grid, Work
from asperity.stress.planes.fields import (
    BASIS,
    FIELDS,
    MEASURES,
    Basis,
    BasisField,
    Fields,
    Formulas,
)
from asperity.stress.planes.free_boundary import FreePlanes
from asperity.stress.planes.periodic import PeriodicPlanes
from asperity.stress.planes.truncation import envelope_of

PLANE_TOLERANCE = 1e-6
"""Default error of a deep plane on a coarser grid, relative to the rms of σ_zz in it."""

SINGLE_PRECISION_TOLERANCE = 3e-5
"""Smallest tolerance for which single precision will do: its transforms round to a few 1e-7 of the root mean
square."""

SINGLE_PRECISION_PRESSURES = (1e-10, 1e15)
"""Largest pressures for which single precision will do: squares of stresses stay within it."""

MAX_PLANES = 10_000
"""Most planes of one stream. `depth_grid` makes about sixty; 8192 are half a spacing apart at 4096²."""

MAX_RATIOS = 1000
"""Most Poisson's ratios of one stream: steps of 0.0015 over the whole range from −1 to 0.5."""

MAX_THREADS = 1024
"""Most threads: more than any machine has cores, few enough to be started."""

MAX_DEPTH = 1e30
"""Largest depth over the longer edge of the cell. Modes vanish below a depth of 120; nothing overflows."""

MAX_FRICTION = 1000.0
"""Largest coefficient of friction: more than any pair of solids has, and squares of stresses stay finite."""


@dataclass(frozen=True)
class LinearPlane:
    """One plane of the stress as A + ν B, from which every field follows for every Poisson's ratio.

    Parameters
    ----------
    depth, grid, bound
        Of the plane, as in `asperity.stress.planes.planes.StressPlane`.
    basis : Basis
        Its arrays are used again: those of a plane hold the plane after the next when it is computed.
    fixed : bool
        True if A is the stress itself, for one Poisson's ratio.
    solid : LoadedSolid
    scale : float
        Root mean square of σ_zz or less, as far as it is known before the plane is computed.
    """

    depth: float
    grid: Grid
    bound: float
    basis: Basis
    fixed: bool
    solid: LoadedSolid
    scale: float

    def fields(self, names: Sequence[str], ratios: Sequence[float], uniforms: Sequence[float]) -> Fields:
        """Fields of these names and Poisson's ratios, given uniform parts over the mean pressure.

        All von Mises stresses stand before other names.
        """
        real, mean = self.basis.values.dtype, float(self.basis.mean_pressure)
        kinds = np.array([FIELDS.index(name) for name in names])
        slopes = np.array([0.0 if self.fixed else nu for nu in ratios], real)
        formulas = Formulas(kinds, slopes, np.array([mean * part for part in uniforms], real))
        return Fields(self.basis, formulas, self.solid.boundary == "periodic")

    def field(self, name: str, poisson: float) -> Array:
        """The field `name` for one Poisson's ratio, (ny, nx)."""
        return self._one(name, poisson).whole()[0]

    def field_at(self, name: str, poisson: float, nodes: Array) -> Array:
        """The field `name` at some nodes, given by their places in the flat array of the plane."""
        row, column = np.divmod(nodes, self.grid.shape[1])
        return self._one(name, poisson).at(np.zeros_like(nodes), row, column, self.grid.shape)[:, 0, 0]

    def named_fields(self, names: Sequence[str], ratios: Sequence[float]) -> dict[str, Array]:
        """Fields by name, (ratios, ny, nx)."""
        return {name: np.stack([self.field(name, nu) for nu in ratios]) for name in names}

    def _one(self, name: str, poisson: float) -> Fields:
        return self.fields([name], [poisson], [uniform_part(self.solid.layer, poisson)])


def uniform_part(layer: Layer, poisson: float) -> float:
    """Uniform part of σ_xx and σ_yy over the mean pressure."""
    return float(replace(layer, poisson=poisson).uniform_stress()[0])


class PlaneStream:
    """Planes of the stress in a solid, from the surface downward.

    The arguments are those of `asperity.stress_planes`, and are checked here.

    Attributes
    ----------
    solid : LoadedSolid
    depths : (planes,) array
    ratios : list of float
        Poisson's ratios.
    names : names
        Fields that are asked for; only the basis fields that they need are computed.
    threads : int
    work : Work
    friction, sliding_direction
        As they were given.
    """

    def __init__(
        self,
        contact: ContactLike,
        depths: ArrayLike,
        poisson: float | Sequence[float] | None,
        fields: Sequence[str],
        tolerance: float = PLANE_TOLERANCE,
        threads: int = 1,
        work: Work | None = None,
        friction: float = 0.0,
        sliding_direction: str | float = "x",
    ) -> None:
        self.solid = LoadedSolid.of(contact)
        self._traction = shear_traction(friction, sliding_direction, self.solid.layer)
        self.depths = _checked_depths(depths, self.solid)
        self.ratios = checked_ratios(poisson, self.solid.layer)
        self.names = choices("fields", fields, FIELDS)
        self._tolerance = number(
            "tolerance", tolerance, "a number from 0 to below 1", lambda size: 0 <= size < 1
        )
        accepted = f"a whole number from 1 to {MAX_THREADS}"
        self.threads = whole_number("threads", threads, accepted, lambda count: 1 <= count <= MAX_THREADS)
        self.work = Work() if work is None else work
        self.friction, self.sliding_direction = float(friction), sliding_direction

    def planes(self, progress: Progress | None = None, count: int | None = None) -> Iterator[LinearPlane]:
        """The planes one after the other, or the first `count` of them."""
        depths, (basis_fields, place) = self.depths[:count], self._basis_fields()
        source = self._source(depths)
        done = np.cumsum([each.grid.size for each in source.plan], dtype=float)
        memory = deque([np.empty(0, source.dtype)] * 2)
        for depth, own, share in zip(depths, source.plan, done / done[-1], strict=True):
            memory.rotate()
            shape = len(basis_fields), own.grid.shape[0], source.row_length(own.grid)
            size = math.prod(shape)
            if memory[0].size < size:
                memory[0] = np.empty(size, source.dtype)
            values = memory[0][:size].reshape(shape)
            source.compute(depth, own, basis_fields, values)
            basis = Basis(values, own.grid.shape[1], place, source.dtype.type(source.mean_pressure))
            fixed = len(self.ratios) == 1
            yield LinearPlane(float(depth), own.grid, own.bound, basis, fixed, self.solid, own.scale)
            if progress is not None:
                progress(float(share), 1.0)

    def _source(self, depths: Array) -> PeriodicPlanes | FreePlanes:
        """Where the basis fields come from."""
        solid, tolerance = self.solid, self._tolerance
        envelope = envelope_of(solid.layer, min(self.ratios), float(np.hypot(*self._traction)))
        low, high = SINGLE_PRECISION_PRESSURES
        fits = low <= float(np.abs(solid.pressure).max()) <= high
        single = fits and tolerance >= SINGLE_PRECISION_TOLERANCE
        arguments = solid, depths, tolerance, envelope, self._traction, self.threads, self.work
        if solid.boundary == "free":
            return FreePlanes(*arguments)
        return PeriodicPlanes(*arguments, "float32" if single else "float64")

    def _basis_fields(self) -> tuple[list[BasisField], Array]:
        """The fields to transform, A and B, or A + ν B for one Poisson's ratio, and their `Basis.place`."""
        needed = set(self.names)
        if "hydrostatic" in needed:
            needed.update(("xx", "yy", "zz"))
        every = not needed.isdisjoint(MEASURES)
        fixed = self.ratios[0] if len(self.ratios) == 1 else None
        fields: list[BasisField] = []
        place = np.full(len(BASIS), -1)
        for entry, (name, part) in enumerate(BASIS):
            if not (every or name in needed):
                continue
            if part == "slope" and fixed is not None:
                place[entry] = place[COMPONENTS.index(name)]
            elif not (every and (name, part) == ("yy", "slope")):
                slope = float(part == "slope") if fixed is None else fixed
                place[entry] = len(fields)
                fields.append(BasisField(name, float(part == "constant"), slope))
        return fields, place


def checked_ratios(poisson: float | Sequence[float] | None, layer: Layer) -> list[float]:
    """Poisson's ratios that the layer allows, by default its own."""
    if poisson is None:
        return [layer.poisson]
    array = np.atleast_1d(real_array("poisson", poisson)).astype(float)
    if array.ndim != 1 or not 1 <= array.size <= MAX_RATIOS:
        raise ValueError(
            f"poisson has the shape {array.shape}: one number or a list of 1 to {MAX_RATIOS} is needed"
        )
    ratios = array.tolist()
    for nu in ratios:
        if not -1 < nu <= 0.5:
            raise ValueError(f"poisson = {nu!r}: a number > -1 and ≤ 0.5 is needed")
        if ratios.count(nu) > 1:
            raise ValueError(f"poisson = {nu!r}: given {ratios.count(nu)} times, every ratio is needed once")
        if layer.height is not None and nu != layer.poisson:
            raise ValueError(
                f"poisson = {nu!r}: {layer.poisson!r}, that of the contact, is needed in a layer of finite "
                "height, because the pressure depends on it"
            )
    return ratios


def shear_traction(friction: Any, direction: Any, layer: Layer) -> tuple[float, float]:
    """Shear traction over pressure along x and y under full sliding, see `asperity.stress_planes`."""
    accepted = f"a number from 0 to {MAX_FRICTION:g}"
    friction = number("friction", friction, accepted, lambda size: 0 <= size <= MAX_FRICTION)
    accepted = '"x", "y" or an angle in degrees from x towards y'
    degrees = {"x": 0.0, "y": 90.0}.get(direction) if isinstance(direction, str) else None
    if degrees is None:
        degrees = number("sliding_direction", direction, accepted, lambda angle: True)
    if friction and layer.height is not None and layer.bottom != "bonded":
        raise ValueError(
            f"friction = {friction:g}: 0 is needed in a layer with a {layer.bottom} bottom, which bears no "
            "shear"
        )
    if degrees % 90 == 0:  # exact zeros
        cosine, sine = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(degrees % 360) // 90]
    else:
        cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return float(friction * cosine), float(friction * sine)


def _checked_depths(depths: ArrayLike, solid: LoadedSolid) -> Array:
    """Rising depths within the solid as an array, a single depth as an array of one."""
    array = np.atleast_1d(real_array("depths", depths)).astype(float)
    if array.ndim != 1 or not 1 <= array.size <= MAX_PLANES:
        raise ValueError(f"depths has the shape {array.shape}: 1 to {MAX_PLANES} depths are needed")
    height = solid.layer.height
    deepest = MAX_DEPTH * max(solid.grid.length) if height is None else height
    outside = np.flatnonzero(~((array >= 0) & (array <= deepest * (1 + 1e-12))))
    if outside.size:
        number = outside[0]
        raise ValueError(f"depths[{number}] = {array[number]:g}: a depth from 0 to {deepest:g} is needed")
    falling = np.flatnonzero(np.diff(array) <= 0)
    if falling.size:
        here = falling[0] + 1
        raise ValueError(
            f"depths[{here}] = {array[here]:g}: more than depths[{here - 1}] = {array[here - 1]:g} is needed"
        )
    return np.minimum(array, deepest)
