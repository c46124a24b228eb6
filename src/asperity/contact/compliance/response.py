"""Displacement of the surface of a solid under any pressure, with a periodic boundary.

The solvers know the solid only as a `Response`, which repeats the map in both directions; in
`asperity.contact.compliance.free_response` nothing surrounds it. In both, displacement is the product of the
Fourier coefficients of the pressure with real factors, so that the solvers are the same; what differs is
gathered in these classes.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import DTypeLike

from asperity.core.compiled import compiled
from asperity.core.parallel import in_parts, in_strips
from asperity.core.types import Array
from asperity.elasticity.two_bodies import Solid
from asperity.fourier.grid import Fourier, Grid, gradient, resample


class Response:
    """Downward displacement of the surface under any pressure that repeats with the cell.

    The convolution with the periodic Green's function is a product in Fourier space (Stanley & Kato 1997,
    10.1115/1.2833523; Campañá & Müser 2006, 10.1103/PhysRevB.74.075420).

    Parameters
    ----------
    solid : Layer or TwoBodies
    fourier : Fourier
        The grid, the precision of the fields, the number of threads, and the count of transforms.
    omits_mean : bool
        True if the mean displacement is left out: at a given load it is known, and for a tall layer far
        larger than all others.
    half_compliance : (ny // 2 + 1, nx // 2 + 1) array, optional
        Factors of the coefficients with ky ≥ 0, to which those of −ky are equal; by default the solid's.

    Attributes
    ----------
    boundary : str
        Name of the condition at the edge of the map.
    repeats : bool
        True if nodes at opposite edges are neighbours.
    transforms : type
        Transforms of the fields.
    """

    boundary: ClassVar[str] = "periodic"
    repeats: ClassVar[bool] = True
    transforms: ClassVar[type[Fourier]] = Fourier

    def __init__(
        self, solid: Solid, fourier: Fourier, omits_mean: bool = False, half_compliance: Array | None = None
    ) -> None:
        self.solid = solid
        self.omits_mean = omits_mean
        self.fourier = fourier
        self.grid = fourier.grid
        if half_compliance is not None:
            self.half_compliance = half_compliance

    def on_grid(self, grid: Grid) -> Self:
        """Response of the same solid on another grid; transforms are counted together."""
        outer = self.fourier
        fourier = self.transforms(grid, outer.real, outer.threads, outer.work)
        return type(self)(self.solid, fourier, self.omits_mean)

    def in_precision(self, dtype: DTypeLike) -> Self:
        """The same response for fields in another precision."""
        outer = self.fourier
        fourier = self.transforms(outer.grid, dtype, outer.threads, outer.work)
        return type(self)(self.solid, fourier, self.omits_mean, self.half_compliance.astype(fourier.real))

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
        """Real factors that turn coefficients of a pressure, ky ≥ 0, into those of its displacement."""
        modes = np.empty((self.grid.shape[0] // 2 + 1, self.grid.shape[1] // 2 + 1), self.fourier.real)

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
        return np.empty(self.mode_grid.half_shape, self.fourier.complex)

    def displacement(self, pressure: Array, out: Array | None = None) -> Array:
        """Downward displacement u[y, x] of the surface under `pressure`, by one pair of transforms."""
        self.fourier.forward(pressure, self._coefficients)
        multiply(self._coefficients, self.half_compliance, self.fourier.threads)
        return self.fourier.inverse(self._coefficients, out, overwrite=True)

    def on_cells(self, cells: Grid) -> tuple[Fourier, Array]:
        """Transforms on one thread, and factors in double precision, for fields on coarse cells of the map.

        The grid of the transforms may be larger than that of the cells; fields are zero there.
        """
        response = type(self)(self.solid, self.transforms(cells), self.omits_mean)
        return Fourier(response.mode_grid, np.float32, 1, self.fourier.work), response.compliance

    def coarsened(self, height: Array, shape: tuple[int, int]) -> tuple[Response, Array]:
        """The response and the surface, truncated in Fourier space, on a grid of half the nodes."""
        coarser = self.on_grid(Grid(shape, self.grid.length))
        coefficients = resample(self.fourier.forward(height), self.grid, coarser.grid)
        return coarser, coarser.fourier.inverse(coefficients, overwrite=True)

    def interpolated(self, field: Array, finer: Response) -> Array:
        """The Fourier interpolant of a field on a finer grid, of which this one was made by `coarsened`."""
        coefficients = resample(self.fourier.forward(field), self.grid, finer.grid)
        return finer.fourier.inverse(coefficients, overwrite=True)

    def gradient(self, pressure: Array, displacement: Array) -> tuple[Array, Array]:
        """∂u/∂y and ∂u/∂x of the surface by spectral differentiation of the displacement."""
        return gradient(self.fourier.forward(displacement), self.fourier)


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
    _multiply(coefficients.view(coefficients.real.dtype), factors)


@compiled
def _multiply(coefficients: Any, factors: Any) -> None:
    """Multiply coefficients, real and imaginary parts in turn, by real factors."""
    for j in range(factors.shape[0]):
        row, factor = coefficients[j], factors[j]
        for i in range(factor.size):
            row[2 * i] *= factor[i]
            row[2 * i + 1] *= factor[i]
