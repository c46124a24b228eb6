"""Discrete Fourier transforms of periodic fields: grids, wavevectors, transforms, resampling.

The conventions of the whole package are stated here.

Fourier convention
------------------
A periodic field ``f[y, x]`` on a grid of ``shape = (ny, nx)`` nodes over a cell of
``length = (length_y, length_x)`` has the coefficients ``f̂[ky, kx]`` with

    f(r) = Σ_q f̂(q) exp(+i q·r),     f̂(q) = (1 / (ny nx)) Σ_r f(r) exp(−i q·r),

so that ``f̂(0)`` is the mean of f and ``Σ_q |f̂(q)|²`` its mean square. Pairs (shape, length, spacing) are in
array order, y before x. Fields are real, and only the coefficients with ``kx ≥ 0`` are stored, in arrays of
shape ``(ny, nx // 2 + 1)``. A sum over all q is a sum over the stored modes weighted with
`Grid.multiplicity`, which `Grid.sum_over_modes` computes.

Mirrored maps
-------------
A map that is continued by its mirror images repeats after twice its edges. Its `Grid` has the nodes and the
edges of the map alone; the mirror lines lie half a spacing beyond the outermost nodes. With distances from
these lines a field that is even along both axes is

    f(r) = Σ_q f̂(q) cos(qx x) cos(qy y),     q = π (kx / Lx, ky / Ly),     kx, ky of both signs,

with real coefficients, stored for kx, ky ≥ 0 in arrays of shape ``(ny, nx)``: cosine transforms of type 2 and
3. A derivative along an axis is odd along it, with a sine in place of the cosine and f̂ = 0 at k = 0. The wave
of two nodes is zero at all nodes, so that there is no Nyquist mode. A map that ends along one axis may be
mirrored along the other one alone; its fields are transformed on the `Grid.whole_cell`.

Nyquist rule
------------
On an axis with an even number of nodes, the coefficient at the Nyquist wavevector belongs to a cosine alone.
A factor that is odd in that component of q (a first derivative, a shear stress) is therefore set to zero
there: `Grid.odd_qx` and `Grid.odd_qy` are the wavevectors with this rule applied, ``qx`` and ``qy`` those
without. `resample` keeps exactly the modes strictly below the Nyquist wavevectors of both grids.

Transforms
----------
`Fourier` transforms in double or single precision, by one of the libraries of `asperity.fourier.engine`, and
counts the transforms. The result has the same bits for any number of threads.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.core.arguments import choice, finite_array, magnitude, real_array, whole_number
from asperity.core.errors import shown
from asperity.core.types import REAL_TYPES, Array, ArrayLike, DTypeLike
from asperity.fourier.engine import Engine, current_engine

if TYPE_CHECKING:
    import xarray as xr

MOST_NODES = 2**31 - 1
"""Largest number of nodes on an axis."""

CELL_EDGE, CELL_NODES, CELL_MIRRORED = "cell_edge", "cell_nodes", "cell_mirrored"
"""Attributes of a coordinate of a dataset: length of the cell along it, number of its nodes, and 1 if it is
mirrored."""

OFF_NODE = 1e-3
"""Largest distance of a coordinate from its node, in spacings: coordinates may be in single precision."""

ALL = slice(None)
"""All rows of an array."""

EVEN = False, False
"""Not odd along either axis."""

BOUNDARIES = {
    "periodic": (False, False),
    "free": (True, True),
    "free along y": (True, False),
    "free along x": (False, True),
}
"""Boundary of a map → whether the map ends along y and along x; along other axes it repeats."""


@dataclass(frozen=True)
class Grid:
    """A periodic rectangular grid.

    Parameters
    ----------
    shape : (ny, nx)
        Number of nodes on each axis, even or odd, from 1 to `MOST_NODES`.
    length : float or (length_y, length_x)
        Edges of the cell, any unit of length; one number for a square cell. A grid of the same shape is
        also accepted and gives its edges and whether it is mirrored, here and in every function that takes a
        `length`.
    mirrored : bool or (bool, bool)
        True for a map that is continued by its mirror images, about lines half a spacing beyond its outermost
        nodes; a pair if along y or along x alone. `shape` and `length` belong to the map alone.

    Raises
    ------
    TypeError, ValueError
        If `shape` is not a pair of whole numbers, or an edge is not a number from 1e-75 to 1e75.

    Examples
    --------
    >>> grid = asp.Grid((64, 128), (1e-3, 2e-3))  # 64 nodes on 1 mm along y, 128 on 2 mm along x
    >>> [f"{step:.4g}" for step in grid.spacing], grid.size
    (['1.563e-05', '1.563e-05'], 8192)
    >>> y, x = grid.coordinates()
    >>> y.shape, x.shape
    ((64,), (128,))
    """

    shape: tuple[int, int]
    length: tuple[float, float] = (1.0, 1.0)
    mirrored: bool | tuple[bool, bool] = False

    def __post_init__(self) -> None:
        accepted = f"a pair (ny, nx) of whole numbers from 1 to {MOST_NODES}"
        try:
            ny, nx = (
                whole_number("shape", nodes, accepted, lambda n: 1 <= n <= MOST_NODES) for nodes in self.shape
            )
        except (TypeError, ValueError) as error:
            raise type(error)(f"shape = {shown(self.shape)}: {accepted} is needed") from error
        object.__setattr__(self, "shape", (ny, nx))
        length: Any = self.length
        if isinstance(length, Grid):
            if length.shape != self.shape:
                raise ValueError(f"length = {length}: a grid of shape {self.shape} is needed")
            object.__setattr__(self, "mirrored", length.mirrored)
            length = length.length
        edges = real_array("length", length)
        if edges.shape not in ((), (1,), (2,)):
            raise ValueError(f"length = {shown(length)}: one number or a pair (length_y, length_x) is needed")
        pair = tuple(magnitude("length", float(edge)) for edge in np.broadcast_to(edges, (2,)))
        object.__setattr__(self, "length", pair)
        if isinstance(self.mirrored, tuple) and self.mirrored[0] == self.mirrored[1]:
            object.__setattr__(self, "mirrored", self.mirrored[0])

    @property
    def images(self) -> tuple[int, int]:
        """Number of maps in a period along y and x: one, or two where the map is mirrored."""
        along = self.mirrored if isinstance(self.mirrored, tuple) else (self.mirrored, self.mirrored)
        return 1 + bool(along[0]), 1 + bool(along[1])

    @property
    def size(self) -> int:
        """Number of nodes."""
        return self.shape[0] * self.shape[1]

    @property
    def of_heights(self) -> Grid:
        """Grid on which heights are transformed: mirrored along both axes if along one."""
        return replace(self, mirrored=True) if self.mirrored else self

    @property
    def map(self) -> tuple[slice, slice]:
        """The map in a field on its `whole_cell`."""
        return slice(self.shape[0]), slice(self.shape[1])

    @property
    def area(self) -> float:
        """Area of the cell, in the unit of `length` squared."""
        return self.length[0] * self.length[1]

    @property
    def spacing(self) -> tuple[float, float]:
        """Distances between neighbouring nodes along y and x."""
        return self.length[0] / self.shape[0], self.length[1] / self.shape[1]

    @property
    def period(self) -> tuple[float, float]:
        """Distances along y and x after which fields repeat: the edges, or twice the edges if mirrored."""
        return self.images[0] * self.length[0], self.images[1] * self.length[1]

    @cached_property
    def whole_cell(self) -> Grid:
        """Grid of a whole period: of a mirrored map and its three mirror images, as `with_mirror_images`."""
        if not self.mirrored:
            return self
        return Grid((self.images[0] * self.shape[0], self.images[1] * self.shape[1]), self.period)

    @property
    def mode_shape(self) -> tuple[int, int]:
        """Shape of the stored coefficients: (ny, nx // 2 + 1), or (ny, nx) of a mirrored map."""
        return self.shape[0], self.shape[1] if self.mirrored else self.shape[1] // 2 + 1

    @property
    def half_shape(self) -> tuple[int, int]:
        """Shape of the stored coefficients with ky ≥ 0: (ny // 2 + 1, nx // 2 + 1), or (ny, nx)."""
        return self.shape[0] if self.mirrored else self.shape[0] // 2 + 1, self.mode_shape[1]

    @cached_property
    def kx(self) -> Array:
        """Integer wavenumbers of the columns of coefficients."""
        return np.arange(self.mode_shape[1])

    @cached_property
    def ky(self) -> Array:
        """Integer wavenumbers of the rows, (ny,): zero, then the positive, then the negative ones."""
        rows = np.arange(self.shape[0])
        return np.where(rows < self.half_shape[0], rows, rows - self.shape[0])

    @cached_property
    def qx(self) -> Array:
        """Wavevector component along x of the columns, in radians per length."""
        return 2 * np.pi / self.period[1] * self.kx

    @cached_property
    def qy(self) -> Array:
        """Wavevector component along y of the rows, (ny,), in radians per length."""
        return 2 * np.pi / self.period[0] * self.ky

    @cached_property
    def odd_qx(self) -> Array:
        """`qx` with zero in the Nyquist column: for factors that are odd in qx."""
        return np.where(self._is_nyquist(self.kx, 1), 0.0, self.qx)

    @cached_property
    def odd_qy(self) -> Array:
        """`qy` with zero in the Nyquist row: for factors that are odd in qy."""
        return np.where(self._is_nyquist(self.ky, 0), 0.0, self.qy)

    def _is_nyquist(self, wavenumbers: Array, axis: int) -> Array:
        return (2 * wavenumbers == self.shape[axis]) & (not self.mirrored)

    @cached_property
    def multiplicity(self) -> tuple[Array, Array]:
        """Numbers of modes that each stored row and each stored column represents: one or two.

        A stored mode represents the product of both.
        """
        columns = np.where((self.kx == 0) | self._is_nyquist(self.kx, 1), 1.0, 2.0)
        rows = np.where((self.ky == 0) | (not self.mirrored), 1.0, 2.0)
        return rows, columns

    def sum_over_modes(self, values: Array) -> float:
        """Sum over all modes of a number of each stored mode."""
        rows, columns = self.multiplicity
        return float(np.sum((values @ columns) * rows))

    def wavenumber(self) -> Array:
        """|q| of every stored mode, of `mode_shape`."""
        return self.half_wavenumber()[np.abs(self.ky)]

    def half_wavenumber(self, rows: slice = ALL, columns: slice = ALL) -> Array:
        """|q| of the stored modes with ky ≥ 0, of `half_shape`, or of some rows and columns."""
        qy, qx = self.qy[: self.half_shape[0], None], self.qx[None, columns]
        out = qy[rows] ** 2 + qx**2  # neither overflows nor vanishes, see `magnitude`; faster than `np.hypot`
        return np.sqrt(out, out=out)

    def coordinates(self) -> tuple[Array, Array]:
        """Positions y, (ny,), and x, (nx,), of the nodes, with the first one at 0."""
        spacing_y, spacing_x = self.spacing
        return spacing_y * np.arange(self.shape[0]), spacing_x * np.arange(self.shape[1])

    def on_map(self, y: ArrayLike, x: ArrayLike) -> tuple[Array, Array]:
        """Positions in the `whole_cell`, which may lie in a mirror image of the map, as positions on the map.

        Those on a mirror line before the first node, half a spacing from it, are at 0.
        """
        found = []
        for place, edge, spacing, images in zip((y, x), self.length, self.spacing, self.images, strict=True):
            position = np.asarray(place)
            if images == 2:
                image = 2 * edge - spacing - position
                position = np.maximum(np.where(position < edge - spacing / 2, position, image), 0.0)
            found.append(position)
        return found[0], found[1]

    def at_mirror_line(self, y: float, x: float) -> bool:
        """True for a position on a mirrored map within a spacing of its mirror lines."""
        places = zip((y, x), self.length, self.spacing, self.images, strict=True)
        return any(
            images == 2 and min(place + step / 2, edge - step / 2 - place) < step
            for place, edge, step, images in places
        )

    def first_node(self, finest: Grid) -> tuple[float, float]:
        """Position y, x of the first node, relative to the first node of `finest`, a grid of the same cell.

        The first nodes of mirrored grids are half a spacing from the mirror lines; other grids share their
        first node.
        """
        steps = zip(self.images, self.spacing, finest.spacing, strict=True)
        y, x = (0.5 * (images - 1) * (own - other) for images, own, other in steps)
        return y, x

    def dataset_coordinates(self) -> dict[str, tuple[str, Array, dict[str, float]]]:
        """Coordinates y and x of a dataset, with the cell as attributes, for `grid_of`."""
        found = zip("yx", self.coordinates(), self.length, self.images, strict=True)
        return {
            axis: (
                axis,
                at,
                {CELL_EDGE: edge, CELL_NODES: at.size} | ({CELL_MIRRORED: 1} if images == 2 else {}),
            )
            for axis, at, edge, images in found
        }

    def field(self, name: str, values: Any) -> Array:
        """Values of a field at the nodes as an array of finite real numbers; `name` is used in the message.

        Raises
        ------
        TypeError, ValueError
            If they are not real numbers, or not finite, or do not have the shape of the grid.
        """
        array = finite_array(name, values)
        if array.shape != self.shape:
            raise ValueError(f"{name} has the shape {array.shape}: {self.shape}, as of its grid, is needed")
        return array


Boundary = str | tuple[str, str]
"""A name of `BOUNDARIES`, or "periodic" or "free" for y and x."""


def boundary_on(boundary: Boundary, grid: Grid) -> tuple[str, Grid]:
    """Name of a boundary, one of `BOUNDARIES`, and its grid, mirrored along the axes that repeat alone.

    Raises
    ------
    ValueError
        If the boundary is neither a name nor a pair of "periodic" and "free" for y and x, or if a map is
        mirrored and repeats along no axis.
    """
    if isinstance(boundary, tuple | list):
        names = {
            tuple("free" if ends else "periodic" for ends in free): name for name, free in BOUNDARIES.items()
        }
        boundary = names.get(tuple(boundary), boundary)
    name = choice("boundary", boundary, tuple(BOUNDARIES))
    if not grid.mirrored or name == "periodic":
        return name, grid
    along = tuple(
        images == 2 and not ends for images, ends in zip(grid.images, BOUNDARIES[name], strict=True)
    )
    if not any(along):
        raise ValueError(f"boundary = {name!r}: a grid without mirror images is needed")
    return name, replace(grid, mirrored=along)  # type: ignore[arg-type]


Edges = float | tuple[float, float] | Grid
"""Edges of a cell as arguments of functions: one number, (length_y, length_x), or a grid of the cell."""


@dataclass
class Work:
    """Transforms done so far, counted in nodes, so that transforms on different grids can be added."""

    nodes: int = 0

    def pairs(self, grid: Grid) -> float:
        """Number of pairs of a forward and an inverse transform of `grid` with as many nodes in total."""
        return self.nodes / (2 * grid.size)


@dataclass
class Fourier:
    """Transforms of real fields on one grid, in one precision.

    Parameters
    ----------
    grid : Grid
    dtype : "float64" or "float32"
        Precision of the fields; the coefficients are complex numbers of the same precision.
    threads : int
        Number of threads; the result does not depend on it.
    work : Work, optional
        Counter to which transforms are added; transforms on several grids may share one.
    engine : Engine, optional
        Library that transforms; by default the one in use when the object is made.

    Raises
    ------
    ValueError
        If `dtype` is another type.
    """

    grid: Grid
    dtype: DTypeLike = "float64"
    threads: int = 1
    work: Work = field(default_factory=Work)
    engine: Engine = field(default_factory=current_engine)

    def __post_init__(self) -> None:
        if isinstance(self.grid.mirrored, tuple):
            raise ValueError(f"grid = {self.grid}: one mirrored along both axes or none is needed")
        self.real: np.dtype[Any] = real_type(self.dtype)
        complex_type: np.dtype[Any] = np.result_type(self.real, np.complex64)
        self.coefficient_type = self.real if self.grid.mirrored else complex_type

    def forward(self, values: Array, out: Array | None = None, odd: tuple[bool, bool] = EVEN) -> Array:
        """Coefficients f̂ of the field ``values[y, x]``.

        Parameters
        ----------
        values : (ny, nx) array
        out : array, optional
            Array for the result, of the grid's `mode_shape` and of the type `coefficient_type`.
        odd : (bool, bool)
            On a mirrored grid: whether the field is odd along y and along x.
        """
        self.work.nodes += self.grid.size
        values = np.asarray(values, dtype=self.real)
        _require_shape("values", values, self.grid.shape)
        if out is None:
            out = np.empty(self.grid.mode_shape, self.coefficient_type)
        if self.grid.mirrored:
            for axis, source in (1, values), (0, out):
                self.engine.cosines(source, out, axis, odd[axis], True, self.threads)
            for lines in _odd_lines(out, odd):
                lines[1:], lines[0] = lines[:-1].copy(), 0
        else:
            self.engine.forward(values, out, self.threads)
        return out

    def inverse(
        self,
        coefficients: Array,
        out: Array | None = None,
        overwrite: bool = False,
        odd: tuple[bool, bool] = EVEN,
    ) -> Array:
        """Field ``f[y, x]``, (ny, nx), from its Fourier coefficients.

        Parameters
        ----------
        coefficients : array
            Of the grid's `mode_shape`.
        out : (ny, nx) array, optional
            Array for the result.
        overwrite : bool
            True if `coefficients` may be overwritten, which saves memory.
        odd : (bool, bool)
            On a mirrored grid: whether the field is odd along y and along x.
        """
        self.work.nodes += self.grid.size
        if out is None:
            out = np.empty(self.grid.shape, self.real)
        coefficients = np.asarray(coefficients, dtype=self.coefficient_type)
        _require_shape("coefficients", coefficients, self.grid.mode_shape)
        if self.grid.mirrored:
            coefficients = coefficients.copy() if any(odd) else coefficients
            for lines in _odd_lines(coefficients, odd):
                lines[:-1], lines[-1] = lines[1:].copy(), 0
            for axis, source in (0, coefficients), (1, out):
                self.engine.cosines(source, out, axis, odd[axis], False, self.threads)
            return out
        work = coefficients if overwrite else np.empty_like(coefficients)
        self.engine.inverse_along_y(coefficients, work, self.threads)
        self.engine.inverse_along_x(work, out, self.threads)
        return out


def _odd_lines(coefficients: Array, odd: tuple[bool, bool]) -> list[Array]:
    """Views of coefficients of sines, with the axis of the sines first."""
    return [lines for lines, is_odd in ((coefficients, odd[0]), (coefficients.T, odd[1])) if is_odd]


def real_type(dtype: DTypeLike) -> np.dtype[Any]:
    """The type float64 or float32; ValueError for any other."""
    try:
        real = np.dtype(dtype)
    except TypeError:
        real = np.dtype(object)
    if real not in REAL_TYPES:
        raise ValueError(f"dtype = {shown(dtype)}: float64 or float32 is needed")
    return real


def _require_shape(name: str, values: Array, shape: tuple[int, int]) -> None:
    if values.shape != shape:
        raise ValueError(f"{name} of shape {values.shape}: {shape}, as of the grid, is needed")


def resample(coefficients: Array, source: Grid, target: Grid) -> Array:
    """Coefficients of the same field on another grid of the same cell.

    Modes strictly below the Nyquist wavevectors of both grids are kept, all others are zero. On a finer grid
    a field without Nyquist modes stays the same; on a coarser grid its short waves are cut off.

    Parameters
    ----------
    coefficients : array
        Coefficients on the grid `source`, of its `mode_shape`.
    source, target : Grid
        On another mirrored grid the outermost nodes have another distance from the mirror lines.

    Raises
    ------
    ValueError
        If the grids are of different cells.
    """
    if source.length != target.length or source.mirrored != target.mirrored:
        raise ValueError(f"target of length {target.length}: {source.length}, as of the source, is needed")
    if source.shape == target.shape:
        return coefficients.copy()
    out = np.empty(target.mode_shape, coefficients.dtype)
    if source.mirrored:
        kept = tuple(slice(min(pair)) for pair in zip(source.shape, target.shape, strict=True))
        out[kept[0].stop :] = 0
        out[:, kept[1].stop :] = 0
        out[kept] = coefficients[kept]
        return out
    rows = (min(source.shape[0], target.shape[0]) - 1) // 2
    columns = (min(source.shape[1], target.shape[1]) - 1) // 2 + 1
    out[: rows + 1, :columns] = coefficients[: rows + 1, :columns]
    out[rows + 1 : target.shape[0] - rows, :columns] = 0
    out[target.shape[0] - rows :, :columns] = coefficients[source.shape[0] - rows :, :columns]
    out[:, columns:] = 0
    return out


def with_mirror_images(values: Array, grid: Grid) -> Array:
    """An even field on the `whole_cell` of its grid; on a grid that is not mirrored the field itself."""
    if not grid.mirrored:
        return values
    beyond = [(0, nodes * (images - 1)) for nodes, images in zip(grid.shape, grid.images, strict=True)]
    return np.pad(values, beyond, "symmetric")


def mean_square(coefficients: Array, grid: Grid, weight: ArrayLike = 1.0) -> float:
    """Mean square ⟨f²⟩ of the field with these coefficients, by Parseval's theorem.

    An optional `weight` multiplies the power of each stored mode: with |q|² the result is ⟨|∇f|²⟩.
    """
    power = (coefficients.real.astype(float) ** 2 + coefficients.imag.astype(float) ** 2) * weight
    return grid.sum_over_modes(power)


def gradient(coefficients: Array, fourier: Fourier) -> tuple[Array, Array]:
    """Fields ∂f/∂y and ∂f/∂x, (ny, nx) each, by spectral differentiation with the Nyquist rule."""
    grid = fourier.grid
    if grid.mirrored:
        along_y, along_x = -grid.qy[:, None] * coefficients, -grid.qx * coefficients
        return fourier.inverse(along_y, odd=(True, False)), fourier.inverse(along_x, odd=(False, True))
    slope_y = fourier.inverse(1j * grid.odd_qy[:, None] * coefficients, overwrite=True)
    slope_x = fourier.inverse(1j * grid.odd_qx[None, :] * coefficients, overwrite=True)
    return slope_y, slope_x


def radial_average(values: Array, grid: Grid) -> tuple[Array, Array]:
    """Average of a quantity of the modes over rings of equal |q|.

    Parameters
    ----------
    values : array
        One real number for each stored mode, of the grid's `mode_shape`.
    grid : Grid

    Returns
    -------
    wavenumber, average : (rings,) arrays
        Centre |q| of each ring, and the average over the modes in it. Rings are centred on the multiples of
        the fundamental wavenumber of the longer period and one such wavenumber wide, from the first multiple
        to the largest |q| that the grid holds in every direction. Rings without modes are left out.
    """
    width = 2 * np.pi / max(grid.period)
    rings = int(min(grid.qx[-1], np.abs(grid.qy).max()) / width + 1e-9)
    ring = np.rint(grid.wavenumber() / width).astype(np.int64)
    weight = np.outer(*grid.multiplicity)
    kept = ring <= rings
    count = np.bincount(ring[kept], weight[kept], minlength=rings + 1)
    total = np.bincount(ring[kept], (weight * values)[kept], minlength=rings + 1)
    filled = np.flatnonzero(count[1:]) + 1
    return width * filled, total[filled] / count[filled]


def grid_of(dataset: xr.Dataset) -> Grid:
    """The grid of a result with coordinates y and x, as of `Grid.dataset_coordinates`.

    Raises
    ------
    ValueError
        If the coordinates do not span a whole cell: all its nodes, equidistant, rising from zero to one
        spacing before the edge. Without the attribute `CELL_EDGE` the edge follows from two or more nodes.
    """
    edges = []
    for axis in ("y", "x"):
        nodes = dataset[axis].values.astype(float)
        spacing = float(nodes[1]) if nodes.size > 1 else np.nan
        edge = float(dataset[axis].attrs.get(CELL_EDGE, nodes.size * spacing))
        off = np.abs(nodes * nodes.size / edge - np.arange(nodes.size)).max(initial=0.0)
        is_whole = nodes.size == dataset[axis].attrs.get(CELL_NODES, nodes.size)
        if not (is_whole and edge > 0 and off < OFF_NODE):
            raise ValueError(
                f"{axis}: the nodes of a whole cell are needed, equidistant and rising from 0; a part of a "
                "result cannot be analysed alone, but drawn and exported by its positions y and x"
            )
        edges.append(edge)
    along_y, along_x = (bool(dataset[axis].attrs.get(CELL_MIRRORED, 0)) for axis in "yx")
    return Grid((dataset.sizes["y"], dataset.sizes["x"]), (edges[0], edges[1]), (along_y, along_x))
