"""Displacement of the surface of a solid under any pressure, for each condition at the edge of the map.

The solvers know the solid only as a `Response`. `PeriodicResponse` repeats the map in both directions, in
`asperity.contact.free_response` nothing surrounds it. In both, displacement is the product of the Fourier
coefficients of the pressure with real factors, so that the solvers are the same; what differs is gathered in
these classes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

from asperity.elasticity.two_bodies import Solid
from asperity.spectral import Fourier, Grid, gradient, resample
from asperity.types import Array


class Response(ABC):
    """Downward displacement of the surface under any pressure, on one grid.

    Parameters
    ----------
    solid : Layer or TwoBodies
    fourier : Fourier
        The grid, the precision of the fields, the number of threads, and the count of transforms.
    compliance : array, optional
        Factors of the coefficients; by default those of the solid.
    holds_mean : bool
        True if the mean displacement is left out: at a given load it is known, and for a tall layer far
        larger than all others.

    Attributes
    ----------
    boundary : str
        Name of the condition at the edge of the map.
    repeats : bool
        True if nodes at opposite edges are neighbours.
    """

    boundary: ClassVar[str]
    repeats: ClassVar[bool]

    def __init__(
        self, solid: Solid, fourier: Fourier, compliance: Array | None = None, holds_mean: bool = False
    ) -> None:
        self.solid = solid
        self.holds_mean = holds_mean
        self.fourier = fourier
        self.grid = fourier.grid
        if compliance is not None:
            self.compliance = compliance

    @property
    def mode_grid(self) -> Grid:
        """Grid of the modes to which the factors belong."""
        return self.grid

    @cached_property
    def compliance(self) -> Array:
        """Real factors that turn the coefficients of a pressure into those of its displacement."""
        return self._modes()

    @cached_property
    def _coefficients(self) -> Array:
        return np.empty(self.compliance.shape, self.fourier.complex)

    def displacement(self, pressure: Array, out: Array | None = None) -> Array:
        """Downward displacement u[y, x] of the surface under `pressure`, by one pair of transforms."""
        self.fourier.forward(pressure, self._coefficients)
        self._coefficients *= self.compliance
        return self.fourier.inverse(self._coefficients, out, overwrite=True)

    def in_single_precision(self, unit: float = 1.0) -> Self:
        """The same response for fields in single precision, with displacements in units of `unit`."""
        outer = self.fourier
        fourier = type(outer)(outer.grid, np.float32, outer.threads, outer.work)
        compliance = np.empty(self.compliance.shape, np.float32)
        np.multiply(self.compliance, 1 / unit, out=compliance, casting="same_kind")
        return type(self)(self.solid, fourier, compliance, self.holds_mean)

    def without_mean(self) -> tuple[Response, float]:
        """The same response without the mean displacement, and what that is per unit of the mean pressure."""
        return self, 0.0

    def in_double_precision(self) -> Self:
        """The same response for fields in double precision."""
        outer = self.fourier
        return type(self)(self.solid, type(outer)(outer.grid, np.float64, outer.threads, outer.work))

    @classmethod
    @abstractmethod
    def on(cls, solid: Solid, grid: Grid, dtype: object, threads: int = 1) -> Self:
        """Response of a solid on a grid, with a precision and a number of threads."""

    @abstractmethod
    def _modes(self) -> Array: ...

    @property
    @abstractmethod
    def uniform_compliance(self) -> float:
        """Largest displacement per unit of a pressure on the whole map; 0 where it is not defined."""

    @abstractmethod
    def on_cells(self, cells: Grid) -> tuple[Fourier, Array]:
        """Transforms and factors in double precision for fields on coarse cells of the map.

        The grid of the transforms may be larger than that of the cells; fields are zero there.
        """

    @abstractmethod
    def coarsened(self, height: Array, shape: tuple[int, int]) -> tuple[Response, Array]:
        """The response and the surface on a grid of half the nodes, along one or both axes."""

    @abstractmethod
    def refined(self, pressure: Array, stiffness: float, finer: Response) -> Array:
        """Pressure less its displacement × a stiffness, interpolated on a finer grid, made by `coarsened`."""

    @abstractmethod
    def gradient(self, pressure: Array, displacement: Array) -> tuple[Array, Array]:
        """∂u/∂y and ∂u/∂x of the surface under a pressure, of which the displacement is known."""


class PeriodicResponse(Response):
    """Response to a pressure that repeats with the cell.

    The convolution with the periodic Green's function is a product in Fourier space (Stanley & Kato 1997,
    10.1115/1.2833523; Campañá & Müser 2006, 10.1103/PhysRevB.74.075420).
    """

    boundary = "periodic"
    repeats = True

    @classmethod
    def on(cls, solid: Solid, grid: Grid, dtype: object, threads: int = 1) -> Self:
        return cls(solid, Fourier(grid, dtype, threads))  # type: ignore[arg-type]

    def _modes(self) -> Array:
        modes = self.solid.grid_surface_compliance(self.grid, self.fourier.real)
        if self.holds_mean:
            modes[0, 0] = 0
        return modes

    def without_mean(self) -> tuple[Response, float]:
        compliance = self.compliance.copy()
        compliance[0, 0] = 0
        response = PeriodicResponse(self.solid, self.fourier, compliance, holds_mean=True)
        return response, float(self.compliance[0, 0])

    @property
    def uniform_compliance(self) -> float:
        return float(self.compliance[0, 0])

    def on_cells(self, cells: Grid) -> tuple[Fourier, Array]:
        fourier = Fourier(cells, np.float32, self.fourier.threads, self.fourier.work)
        response = PeriodicResponse(self.solid, Fourier(cells), holds_mean=self.holds_mean)
        return fourier, response.compliance

    def coarsened(self, height: Array, shape: tuple[int, int]) -> tuple[Response, Array]:
        """The surface is truncated in Fourier space."""
        outer, grid = self.fourier, Grid(shape, self.grid.length)
        fourier = Fourier(grid, outer.real, outer.threads, outer.work)
        coefficients = resample(outer.forward(height), self.grid, grid)
        coarser = PeriodicResponse(self.solid, fourier, holds_mean=self.holds_mean)
        return coarser, fourier.inverse(coefficients, overwrite=True)

    def refined(self, pressure: Array, stiffness: float, finer: Response) -> Array:
        """The Fourier interpolant, of which the pressure oscillates about zero outside the contact."""
        coefficients = self.fourier.forward(pressure)
        coefficients *= 1 - self.compliance.dtype.type(stiffness) * self.compliance
        return finer.fourier.inverse(resample(coefficients, self.grid, finer.grid), overwrite=True)

    def gradient(self, pressure: Array, displacement: Array) -> tuple[Array, Array]:
        """By spectral differentiation of the displacement."""
        return gradient(self.fourier.forward(displacement), self.fourier)
