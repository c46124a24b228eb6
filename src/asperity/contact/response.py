"""Displacement of the surface of a solid under any pressure on a map that repeats or ends along each axis.

The solvers know the solid only as a `Response`. With all boundaries the displacement is the product of the
Fourier coefficients of the pressure with real factors, so that the solvers are the same; all differences
are in these classes.
"""

from collections.abc import Callable
from functools import cached_property, partial
from typing import Any, ClassVar, Self

import numpy as np

from asperity.core.compiled import compiled, compiled_with_arrays
from asperity.core.parallel import in_parts, in_strips
from asperity.core.types import Array, DTypeLike
from asperity.elasticity.loaded_rectangle import (
    PaddedFourier,
    compliance_modes,
    padded_grid,
    rectangle_compliance,
    slope_modes,
    surface_influence,
)
from asperity.elasticity.two_bodies import Solids
from asperity.fourier.grid import BOUNDARIES, Boundary, Fourier, Grid, boundary_on, gradient


class Response:
    """Downward displacement of the surface under any pressure that repeats with the cell.

    The convolution with the periodic Green's function is a product in Fourier space (Stanley & Kato 1997,
    10.1115/1.2833523; Campañá & Müser 2006, 10.1103/PhysRevB.74.075420).

    Parameters
    ----------
    solid : Solid or TwoBodies
    fourier : Fourier
        The grid, the precision of the fields, the number of threads, and the count of transforms.
    omits_mean : bool
        True if the mean displacement is left out: at a given load it is known, and for a tall layer far
        larger than all others.
    twin : Response, optional
        The same response in another precision, whose factors are rounded when they are first needed.

    Attributes
    ----------
    boundary : str
        Name of the condition at the edges of the map.
    free : (bool, bool)
        Whether the map ends along y and along x.
    repeats : bool
        True if the map, or the map with its mirror images, repeats along both axes.
    transforms : callable
        Makes the transforms of the fields.
    """

    boundary: ClassVar[str] = "periodic"
    free: ClassVar[tuple[bool, bool]] = BOUNDARIES[boundary]
    repeats: ClassVar[bool] = True
    transforms: ClassVar[Callable[..., Fourier]] = Fourier

    def __init__(
        self, solid: Solids, fourier: Fourier, omits_mean: bool = False, twin: Self | None = None
    ) -> None:
        self.solid = solid
        self.omits_mean = omits_mean
        self.fourier = fourier
        self.grid = fourier.grid
        self._twin = twin

    def on_grid(self, grid: Grid) -> Self:
        """Response of the same solid on another grid; transforms are counted together."""
        outer = self.fourier
        fourier = self.transforms(grid, outer.real, outer.threads, outer.work)
        return type(self)(self.solid, fourier, self.omits_mean)

    def in_precision(self, dtype: DTypeLike) -> Self:
        """The same response for fields in another precision."""
        outer = self.fourier
        fourier = self.transforms(outer.grid, dtype, outer.threads, outer.work)
        return type(self)(self.solid, fourier, self.omits_mean, self)

    def coarser(self, min_points: int) -> Self | None:
        """Response on half the nodes of each axis that has at least twice a number; None if none has.

        A map grows by one spacing along an axis where it ends with an odd number of nodes.
        """
        shape = tuple(n if n < 2 * min_points else (n + 1) // 2 for n in self.grid.shape)
        if shape == self.grid.shape:
            return None
        axes = zip(shape, self.grid.shape, self.free, strict=True)
        growth = (2 * m / n if m != n and ends else 1 for m, n, ends in axes)
        length = tuple(edge * factor for edge, factor in zip(self.grid.length, growth, strict=True))
        return self.on_grid(Grid(shape, length, self.grid.mirrored))  # type: ignore[arg-type]

    @property
    def nodal_compliance(self) -> float:
        """Unit of displacement per pressure: spacing / E*.

        On a half-space a node that alone is under pressure is displaced by 1.12 of it.
        """
        return min(self.grid.spacing) / self.solid.effective_modulus

    @property
    def mode_grid(self) -> Grid:
        """Grid of the modes to which the factors belong."""
        return self.grid

    @cached_property
    def half_compliance(self) -> Array:
        """Real factors from coefficients of a pressure to those of its displacement; equal for ky and −ky."""
        factors = self._factors() if self._twin is None else self._twin.half_compliance
        return factors.astype(self.fourier.real, copy=False)

    def _factors(self) -> Array:
        modes = np.empty(self.grid.half_shape, self.fourier.real)

        def fill(strip: slice) -> None:
            wavenumber = self.grid.half_wavenumber(strip).astype(modes.dtype, copy=False)
            modes[strip] = self.solid.surface_compliance(wavenumber)

        in_strips(fill, modes.shape, self.fourier.threads)
        if self.omits_mean:
            modes[0, 0] = 0
        return modes

    @property
    def compliance(self) -> Array:
        """Factors of all coefficients."""
        return self.half_compliance[np.abs(self.mode_grid.ky)]

    @cached_property
    def own_compliance(self) -> float:
        """Displacement of a node per unit of a pressure on it alone, also on a mirrored map."""
        rows, columns = self.grid.multiplicity
        rows = np.bincount(np.abs(self.grid.ky), rows)
        return float(rows @ (self.half_compliance @ columns)) / self.grid.whole_cell.size

    @property
    def largest_own_compliance(self) -> float:
        """Largest displacement of any node per unit of a pressure on one node and on its mirror images."""
        return self.own_compliance * (self.grid.whole_cell.size / self.grid.size)

    @property
    def largest_compliance(self) -> float:
        """Largest of the factors."""
        return float(self.half_compliance.max())

    @property
    def uniform_compliance(self) -> float:
        """Largest displacement per unit of a pressure on the whole map; 0 where it is not defined."""
        return 0.0 if self.omits_mean else self.solid.uniform_compliance()

    @property
    def omitted_compliance(self) -> float:
        """Mean displacement per unit of the mean pressure that is left out."""
        return self.solid.uniform_compliance() if self.omits_mean else 0.0

    @cached_property
    def _coefficients(self) -> Array:
        return np.empty(self.mode_grid.mode_shape, self.fourier.coefficient_type)

    def release(self) -> None:
        """Free the working space, which the next displacement makes again."""
        self.__dict__.pop("_coefficients", None)

    def displacement(self, pressure: Array, out: Array | None = None) -> Array:
        """Downward displacement u[y, x] of the surface under `pressure`, by one pair of transforms."""
        if self.grid.mirrored:  # as many coefficients as nodes
            out = np.empty(self.grid.shape, self.fourier.real) if out is None else out
        coefficients = self._coefficients if out is None or not self.grid.mirrored else out
        self.fourier.forward(pressure, coefficients)
        multiply(coefficients, self.half_compliance, self.fourier.threads)
        return self.fourier.inverse(coefficients, out, overwrite=True)

    def on_cells(self, cells: Grid) -> tuple[Fourier, Array]:
        """Transforms on one thread, and factors in double precision, for fields on coarse cells of the map.

        The grid of the transforms may be larger than the grid of the cells; fields are zero there.
        """
        response = type(self)(self.solid, self.transforms(cells), self.omits_mean)
        return Fourier(response.mode_grid, np.float32, 1, self.fourier.work), response.compliance

    def resampled(self, field: Array, to: Grid) -> Array:
        """Linear interpolation of a field to a coarser or finer grid of the same map.

        The node is in the middle of its cell. On half the nodes this is the mean over pairs of nodes: no
        value lies outside the range of the field, so that flat parts stay flat.
        """
        places = []
        for axis, nodes in enumerate(field.shape):
            ratio = to.spacing[axis] / self.grid.spacing[axis]
            position = (np.arange(to.shape[axis]) + 0.5) * ratio - 0.5
            before = np.floor(position).astype(np.intp)
            ends = [before % nodes, (before + 1) % nodes]
            if self.grid.mirrored or self.free[axis]:
                ends = [np.clip(end, 0, nodes - 1) for end in (before, before + 1)]
            places.append((*ends, (position - before).astype(field.dtype)))
        (above, below, down), across = places
        out = np.empty(to.shape, field.dtype)

        def interpolate(rows: slice) -> None:
            _interpolate(field, above[rows], below[rows], down[rows], *across, out[rows])  # type: ignore[call-arg]

        in_strips(interpolate, out.shape, self.fourier.threads)
        return out

    def gradient(self, pressure: Array, displacement: Array) -> tuple[Array, Array]:
        """∂u/∂y and ∂u/∂x of the surface by spectral differentiation of the displacement."""
        return gradient(self.fourier.forward(displacement), self.fourier)


class FreeResponse(Response):
    """Response of half-spaces to a pressure on the map alone: nothing surrounds the map.

    The pressure is uniform on a rectangle of the size of the spacing around each node, and the response is
    exact for it; see `asperity.elasticity.loaded_rectangle`. Far from the map the
    displacement is zero.
    """

    boundary = "free"
    free = BOUNDARIES[boundary]
    repeats = False
    transforms: ClassVar[Callable[..., Fourier]] = PaddedFourier

    def _factors(self) -> Array:
        return compliance_modes(self.grid, self.solid.effective_modulus, self.free)

    @cached_property
    def mode_grid(self) -> Grid:
        """The padded grid, on which distances within the map do not wrap around."""
        return padded_grid(self.grid, self.free)

    @cached_property
    def own_compliance(self) -> float:
        here = np.zeros(1)
        return surface_influence(here, here, self.grid, self.solid.effective_modulus, self.free).item()

    @property
    def uniform_compliance(self) -> float:
        """The displacement in the middle of the map."""
        here, whole = np.zeros(1), Grid((1, 1), self.grid.length)
        return surface_influence(here, here, whole, self.solid.effective_modulus, self.free).item()

    @property
    def largest_compliance(self) -> float:
        """Largest of the factors: without a period the sum of a positive kernel over the padded grid."""
        if not all(self.free):
            return super().largest_compliance
        here, modulus = np.zeros(1), self.solid.effective_modulus
        return rectangle_compliance(here, here, self.mode_grid.length, modulus).item()

    def gradient(self, pressure: Array, displacement: Array) -> tuple[Array, Array]:
        """The exact slopes at the nodes under the same uniformly loaded rectangles."""
        fourier = PaddedFourier(
            self.grid, np.float64, self.fourier.threads, self.fourier.work, free=self.free
        )
        coefficients = fourier.forward(pressure)
        slope_y, slope_x = (
            fourier.inverse(coefficients * modes, overwrite=True)
            for modes in slope_modes(self.grid, self.solid.effective_modulus, self.free)
        )
        return slope_y, slope_x


class FreeAlongY(FreeResponse):
    """Response to a pressure that repeats along x, and of which nothing lies beside the map along y.

    The displacement is measured from the surface at a distance of the edge of the map along y.
    """

    boundary = "free along y"
    free = BOUNDARIES[boundary]
    transforms = staticmethod(partial(PaddedFourier, free=free))


class FreeAlongX(FreeResponse):
    """The same with x and y exchanged."""

    boundary = "free along x"
    free = BOUNDARIES[boundary]
    transforms = staticmethod(partial(PaddedFourier, free=free))


RESPONSES: dict[str, type[Response]] = {
    each.boundary: each for each in (Response, FreeResponse, FreeAlongY, FreeAlongX)
}


def response_on(
    boundary: Boundary,
    solid: Solids,
    grid: Grid,
    dtype: DTypeLike = "float64",
    threads: int = 1,
    omits_mean: bool = False,
) -> Response:
    """Response of a solid on a grid, with a condition at the edge of the map.

    Raises
    ------
    ValueError
        As of `checked_boundary`.
    """
    boundary, grid = checked_boundary(boundary, solid, grid)
    kind = RESPONSES[boundary]
    return kind(solid, kind.transforms(grid, dtype, threads), omits_mean)


def checked_boundary(boundary: Boundary, solid: Solids, grid: Grid) -> tuple[str, Grid]:
    """`boundary_on` a grid; a `ValueError` if it is not known for this solid."""
    name, grid = boundary_on(boundary, grid)
    if name != "periodic" and solid.height is not None:
        raise ValueError(
            f"boundary = {name!r}: half-spaces are needed, because the displacement of a layer, here of "
            f"height {solid.height:g}, under an isolated load has no closed form"
        )
    return name, grid


def multiply(coefficients: Array, half: Array, threads: int) -> None:
    """Multiply coefficients by factors that are the same for ky and −ky, and given for ky ≥ 0."""
    rows = half.shape[0]
    mirrored = half[1 : coefficients.shape[0] - rows + 1][::-1]

    def multiply_some(part: slice) -> None:
        for factors, first in ((half, 0), (mirrored, rows)):
            start, stop = (min(max(row, first), first + len(factors)) for row in (part.start, part.stop))
            multiply_rows(coefficients[start:stop], factors[start - first : stop - first])

    in_parts(multiply_some, coefficients.shape[0], threads, smallest=256)


def multiply_rows(coefficients: Array, factors: Array) -> None:
    """Multiply coefficients by real factors of the same shape."""
    if coefficients.dtype.kind == "c":
        _multiply(coefficients.view(coefficients.real.dtype), factors)
    else:
        coefficients *= factors


@compiled_with_arrays
def _interpolate(
    field: Any, above: Any, below: Any, down: Any, left: Any, right: Any, across: Any, out: Any
) -> None:
    """Interpolate a field between two of its rows and two of its columns, at fractions of the way."""
    between = np.empty(field.shape[1], field.dtype)
    for j in range(out.shape[0]):
        first, second = field[above[j]], field[below[j]]
        for i in range(between.size):
            between[i] = first[i] + (second[i] - first[i]) * down[j]
        for i in range(out.shape[1]):
            start = between[left[i]]
            out[j, i] = start + (between[right[i]] - start) * across[i]


@compiled
def _multiply(coefficients: Any, factors: Any) -> None:
    """Multiply coefficients, real and imaginary parts in turn, by real factors."""
    for j in range(factors.shape[0]):
        row, factor = coefficients[j], factors[j]
        for i in range(factor.size):
            row[2 * i] *= factor[i]
            row[2 * i + 1] *= factor[i]
