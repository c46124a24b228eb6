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

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from dataclasses import field as dataclass_field
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asperity.core.arguments import choices, number, real_array, thread_count
from asperity.core.parallel import aligned_memory
from asperity.core.types import Array, Progress
from asperity.elasticity.loaded_solid import ContactLike, LoadedSolid, direction_cosines
from asperity.elasticity.solid import COMPONENTS, Solid
from asperity.fourier.grid import Grid, Work
from asperity.stress.planes.fields import (
    BASIS,
    FIELDS,
    MEASURES,
    Basis,
    BasisField,
    Formulas,
    PlaneFields,
    Visit,
    edges_of,
    image_sign,
    neighbour,
)
from asperity.stress.planes.free_boundary import FreePlanes
from asperity.stress.planes.periodic import PeriodicPlanes
from asperity.stress.planes.truncation import envelope_of

PLANE_TOLERANCE = 1e-6
"""Default error of a deep plane on a coarser grid, relative to the rms of σ_zz in it."""

SINGLE_PRECISION_TOLERANCE = 3e-5
"""Smallest tolerance at which planes are in single precision: its transforms round to a few 1e-7 of the root
mean square."""

SINGLE_PRECISION_PRESSURES = (1e-10, 1e15)
"""Range of the maximum pressure in which planes are in single precision: squares of stresses stay within its
range."""

KEPT_BYTES = 2 * 8 * 4096 * 4112 * 8
"""Memory in which the basis fields of two planes are kept side by side: eight fields of 4096² nodes in double
precision, in rows of 4112 numbers (`PeriodicPlanes.row_length`). Of larger planes one at a time is kept, and
the plane above is computed again for comparisons."""

MAX_PLANES = 10_000
"""Most planes of one stream. `depth_grid` makes about sixty; 8192 are half a spacing apart at 4096²."""

MAX_RATIOS = 1000
"""Most Poisson's ratios of one stream: steps of 0.0015 over the whole range from −1 to 0.5."""

MAX_DEPTH = 1e30
"""Largest depth over the longer period. Modes vanish below a depth of 120; nothing overflows."""

ROUNDED_SHEAR = 1e-12
"""Shear stress of a background over its maximum stress up to which it is a rounding error."""

ON_LINE = 1e-6
"""Distance from a mirror line, over the spacing, up to which a place is on the line."""

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
        Its arrays are used again: see `PlaneStream.planes`.
    fixed : bool
        True if A is the stress itself, for one Poisson's ratio.
    solid : LoadedSolid
    scale : float
        A lower bound of the root mean square of σ_zz, known before the plane is computed.
    refresh : callable
        Computes the basis fields again if another plane has overwritten them, and calls its argument
        `visit`, a `Visit`, for the rows.
    """

    depth: float
    grid: Grid
    bound: float
    basis: Basis
    fixed: bool
    solid: LoadedSolid
    scale: float
    refresh: Callable[..., None]
    _known: dict[tuple[str, float], Array] = dataclass_field(default_factory=dict, init=False, repr=False)

    @property
    def first_node(self) -> tuple[float, float]:
        """Position y, x of the first node, relative to the first node of the grid of the contact."""
        return self.grid.first_node(self.solid.grid)

    def fields(self, names: Sequence[str], ratios: Sequence[float], uniforms: Sequence[float]) -> PlaneFields:
        """Fields of these names and Poisson's ratios, given uniform parts over the mean pressure.

        All von Mises stresses stand before other names.
        """
        real, mean = self.basis.values.dtype, float(self.basis.mean_pressure)
        kinds = np.array([FIELDS.index(name) for name in names])
        slopes = np.array([0.0 if self.fixed else nu for nu in ratios], real)
        formulas = Formulas(kinds, slopes, np.array([mean * part for part in uniforms], real))
        return PlaneFields(self.basis, formulas, edges_of(self.solid.boundary, self.grid))

    def field(self, name: str, poisson: float) -> Array:
        """The field `name` for one Poisson's ratio, (ny, nx).

        It is computed once for all that ask for it, and must not be changed.
        """
        if (name, poisson) not in self._known:
            self._known[name, poisson] = np.ascontiguousarray(self._one(name, poisson).whole()[0])
        return self._known[name, poisson]

    def forget_fields(self) -> None:
        """Release the memory of the fields that `field` has computed."""
        self._known.clear()

    def field_at(self, name: str, poisson: float, nodes: Array) -> Array:
        """The field `name` at some nodes, given by their places in the flat array of the plane."""
        row, column = np.divmod(nodes, self.grid.shape[1])
        return self._one(name, poisson).at(row, column)

    def field_around(self, name: str, poisson: float, rows: Array, columns: Array) -> Array:
        """The field `name`, (rows, columns), at nodes that may lie beyond the edges, see `neighbour`."""
        edges, (ny, nx), kind = edges_of(self.solid.boundary, self.grid), self.grid.shape, FIELDS.index(name)
        row = np.array([neighbour(node, ny, edges[0]) for node in rows.tolist()])
        column = np.array([neighbour(node, nx, edges[1]) for node in columns.tolist()])
        along_y = [image_sign(kind, node, 0, (ny, nx), edges) for node in rows.tolist()]
        along_x = [image_sign(kind, 0, node, (ny, nx), edges) for node in columns.tolist()]
        values = self.field_at(name, poisson, (row[:, None] * nx + column).ravel())
        return values.reshape(row.size, column.size) * np.outer(along_y, along_x).astype(values.dtype)

    def named_fields(self, names: Sequence[str], ratios: Sequence[float]) -> dict[str, Array]:
        """Fields by name, (ratios, ny, nx), for the caller to keep: `field` would hold each of them twice."""
        return {name: np.stack([self._one(name, nu).whole()[0] for nu in ratios]) for name in names}

    def _one(self, name: str, poisson: float) -> PlaneFields:
        return self.fields([name], [poisson], [uniform_part(self.solid.layer, poisson, self.depth)])


def uniform_part(layer: Solid, poisson: float, depth: float) -> float:
    """Uniform part of σ_xx and σ_yy at a depth over the mean pressure."""
    return float(replace(layer, poisson=poisson).uniform_stress(depth)[0])


class PlaneStream:
    """Planes of the stress in a solid, from the surface downward.

    Arguments as for `asperity.stress_planes`; they are checked here.

    Attributes
    ----------
    solid : LoadedSolid
        On the whole cell where its stress on a mirrored map is no mirror image: under friction, or with a
        background of shear; and of a map that is mirrored along one axis alone.
    map_grid : Grid
        Grid of the contact.
    is_sheared : bool
        True under friction, or with a background of shear.
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
        has_shear, self.map_grid = False, self.solid.grid
        if (background := self.solid.background) is not None:
            sizes = np.abs([background(depth) for depth in self.depths])
            has_shear = bool(sizes[:, 3:].max() > ROUNDED_SHEAR * sizes.max())
        self.is_sheared = any(self._traction) or has_shear
        if self.is_sheared or isinstance(self.map_grid.mirrored, tuple):
            self.solid = self.solid.with_mirror_images()
        self.ratios = checked_ratios(poisson, self.solid.layer)
        if self.solid.background is not None and len(self.ratios) > 1:
            raise ValueError(f"poisson has {len(self.ratios)} values: one is needed with a background")
        self.names = choices("fields", fields, FIELDS)
        self._tolerance = number(
            "tolerance", tolerance, "a number from 0 to below 1", lambda size: 0 <= size < 1
        )
        self.threads = thread_count(threads)
        self.work = Work() if work is None else work
        self.friction, self.sliding_direction = float(friction), sliding_direction
        low, high = SINGLE_PRECISION_PRESSURES
        fits = low <= max(self.solid.pressure.max(), -self.solid.pressure.min()) <= high
        single = fits and self._tolerance >= SINGLE_PRECISION_TOLERANCE and self.solid.boundary == "periodic"
        self.dtype = np.dtype("float32" if single else "float64")

    def images(self, y: Array, x: Array) -> tuple[Array, Array]:
        """Of places in the planes of a mirrored map: whether they lie on an image that slides in another
        direction than the map, and their number for each map: 1/2 on a mirror line, 1/4 at a corner, 0 where
        the map has the same place.
        """
        moves = direction_cosines(self.sliding_direction)[::-1]
        on_image, weight = np.zeros(y.shape, bool), np.ones(y.shape)
        grid = self.map_grid
        axes = zip((y, x), moves, grid.length, grid.spacing, grid.images, strict=True)
        for place, moved, edge, step, images in axes:
            from_line = (place + step / 2) % (2 * edge)
            if images == 1:
                continue
            if not self.is_sheared:
                from_line = np.minimum(from_line, 2 * edge - from_line)
                near = ON_LINE if self.solid.grid.mirrored else 0.5  # by rounding, or by a coarse plane
                on_line = np.minimum(from_line, edge - from_line) < near * step
                beyond = (place + step / 2 > edge) & (not self.solid.grid.mirrored)
                weight = np.where(on_line, weight / 2, np.where(beyond, 0.0, weight))
            else:  # a cell of two or four maps
                on_image |= (from_line >= edge) & (moved != 0)
                weight = weight / 2
        return on_image, weight

    @property
    def keeps_planes(self) -> bool:
        """True if the basis fields of two planes are kept side by side at all depths."""
        source = PeriodicPlanes if self.solid.boundary == "periodic" else FreePlanes
        fields, grid = len(self._basis_fields()[0]), self.solid.grid
        size = fields * grid.shape[0] * source.row_length(grid)
        return 2 * size <= KEPT_BYTES // self.dtype.itemsize // 16 * 16

    def planes(
        self,
        progress: Progress | None = None,
        count: int | None = None,
        watch: Callable[[LinearPlane], Visit] | None = None,
        at: Sequence[float] | None = None,
    ) -> Iterator[LinearPlane]:
        """The planes one after the other, or the first `count` of them, or planes at some other depths.

        `watch` is called with every plane before it is computed, and returns a function that is called when
        some of its rows are computed. The basis fields of a plane stay in memory while the next plane is
        computed, unless they exceed `KEPT_BYTES`; `LinearPlane.refresh` computes them again.
        """
        depths = self.depths[:count] if at is None else _checked_depths(at, self.solid)
        source, (basis_fields, indices) = self._source, self._basis_fields()
        plan = [source.choose(depth) for depth in depths]
        done = np.cumsum([each.grid.size for each in plan], dtype=float)
        sizes = [len(basis_fields) * own.grid.shape[0] * source.row_length(own.grid) for own in plan]
        memory = _Memory(sizes, source.dtype)
        for index, (depth, own) in enumerate(zip(depths, plan, strict=True)):
            shape = len(basis_fields), own.grid.shape[0], source.row_length(own.grid)
            values = memory.array(index, shape)
            if (layer := self.solid.layer).base is not None:
                slope = layer.part_at(depth).poisson
                basis_fields = [field._replace(slope=slope) for field in basis_fields]
            compute = partial(source.compute, depth, own, basis_fields, values)
            basis = Basis(values, own.grid.shape[1], indices, source.dtype.type(source.mean_pressure))
            plane = LinearPlane(
                float(depth),
                own.grid,
                own.bound,
                basis,
                len(self.ratios) == 1,
                self.solid,
                own.scale,
                partial(memory.use, index, compute),
            )
            memory.use(index, compute, None if watch is None else watch(plane))
            yield plane
            if progress is not None:
                progress(float(done[index] / done[-1]), 1.0)

    @cached_property
    def _source(self) -> PeriodicPlanes | FreePlanes:
        """Source of the basis fields; it keeps the modes of the pressure."""
        solid, tolerance = self.solid, self._tolerance
        envelope = partial(envelope_of, solid.layer, min(self.ratios), float(np.hypot(*self._traction)))
        arguments = solid, tolerance, envelope, self._traction, self.threads, self.work
        if solid.boundary == "periodic":
            return PeriodicPlanes(*arguments, self.dtype.name)
        return FreePlanes(*arguments)

    def _basis_fields(self) -> tuple[list[BasisField], Array]:
        """The fields to transform, A and B, or A + ν B for one Poisson's ratio, and their `Basis.index`."""
        needed = set(self.names)
        if "hydrostatic" in needed:
            needed.update(("xx", "yy", "zz"))
        every = not needed.isdisjoint(MEASURES)
        fixed = self.ratios[0] if len(self.ratios) == 1 else None
        fields: list[BasisField] = []
        indices = np.full(len(BASIS), -1)
        for entry, (name, part) in enumerate(BASIS):
            if not (every or name in needed):
                continue
            if part == "slope" and fixed is not None:
                indices[entry] = indices[COMPONENTS.index(name)]
            elif not (every and (name, part) == ("yy", "slope")):
                slope = float(part == "slope") if fixed is None else fixed
                indices[entry] = len(fields)
                fields.append(BasisField(name, float(part == "constant"), slope))
        return fields, indices


class _Memory:
    """Memory for the basis fields of one plane after the other.

    Planes of even numbers begin at its start, planes of odd numbers end at its end. Neighbours lie side by
    side up to `KEPT_BYTES`; larger ones share memory.
    """

    def __init__(self, sizes: Sequence[int], dtype: np.dtype[Any]) -> None:
        most = max(sizes)
        size = max(most, min(2 * most, KEPT_BYTES // dtype.itemsize // 16 * 16))
        self._block = aligned_memory(size * dtype.itemsize).view(dtype)
        self._sizes = sizes
        self._intact: set[int] = set()

    def array(self, number: int, shape: tuple[int, ...]) -> Array:
        """Memory of a plane."""
        start, stop = self._part(number)
        return self._block[start:stop].reshape(shape)

    def use(self, number: int, compute: Callable[..., None], visit: Visit | None = None) -> None:
        """Compute a plane, unless it is there."""
        if number not in self._intact:
            start, stop = self._part(number)
            parts = {other: self._part(other) for other in self._intact}
            self._intact = {other for other, (a, b) in parts.items() if b <= start or stop <= a} | {number}
            compute(visit=visit)

    def _part(self, number: int) -> tuple[int, int]:
        size = self._sizes[number]
        return (self._block.size - size, self._block.size) if number % 2 else (0, size)


def checked_ratios(poisson: float | Sequence[float] | None, layer: Solid) -> list[float]:
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
                f"poisson = {nu!r}: {layer.poisson!r}, as in the contact, is needed in a layer of finite "
                "height, because the pressure depends on it"
            )
    return ratios


def shear_traction(friction: Any, direction: Any, layer: Solid) -> tuple[float, float]:
    """Shear traction over pressure along x and y under gross sliding, see `asperity.stress_planes`."""
    accepted = f"a number from 0 to {MAX_FRICTION:g}"
    friction = number("friction", friction, accepted, lambda size: 0 <= size <= MAX_FRICTION)
    cosine, sine = direction_cosines(direction)
    bottom = layer.parts[-1].bottom
    if friction and layer.extent is not None and bottom != "bonded":
        raise ValueError(
            f"friction = {friction:g}: 0 is needed in a layer with a {bottom} bottom, which bears no shear"
        )
    return friction * cosine, friction * sine


def _checked_depths(depths: ArrayLike, solid: LoadedSolid) -> Array:
    """Rising depths within the solid as an array, a single depth as an array of one."""
    array = np.atleast_1d(real_array("depths", depths)).astype(float)
    if array.ndim != 1 or not 1 <= array.size <= MAX_PLANES:
        raise ValueError(f"depths has the shape {array.shape}: 1 to {MAX_PLANES} depths are needed")
    height = solid.layer.extent
    deepest = MAX_DEPTH * max(solid.grid.period) if height is None else height
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
