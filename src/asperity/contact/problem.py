"""The contact problem on one grid, the imposed quantity, and the iterate of a solver."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.elasticity.two_bodies import Solid
from asperity.spectral import Fourier, Grid, resample
from asperity.types import Array


@dataclass(frozen=True)
class Control:
    """The imposed quantity: "area_fraction", "mean_pressure" or "approach", and its value."""

    kind: str
    value: float

    @property
    def fixes_load(self) -> bool:
        """True if every iterate has a given mean pressure.

        Area control changes that mean pressure between iterations, see `asperity.contact.area_control`.
        """
        return self.kind != "approach"

    def lifts_off(self, height: Array) -> bool:
        """True if the indenter presses on no node of the solid."""
        if self.kind == "approach":
            return self.value <= float(height.min())
        return self.value == 0


@dataclass
class State:
    """The current iterate of a solver.

    Attributes
    ----------
    pressure : (ny, nx) array
        Non-negative.
    gap : (ny, nx) array
        h + u at the last evaluation, without the approach.
    approach : float
        Imposed, or that of the last evaluation.
    load : float
        Mean pressure of the iterate, NaN under an imposed approach.
    error : float
        Estimated error of the pressure, relative to its norm.
    iterations : int
        Applications of the compliance so far, on all grids.
    """

    pressure: Array
    gap: Array
    approach: float
    load: float
    error: float = np.inf
    iterations: int = 0


class Problem:
    """A surface and a solid on one grid.

    Parameters
    ----------
    height : (ny, nx) array
    solid : Layer or TwoBodies
    fourier : Fourier
        The grid, the precision of the fields, the number of threads, and the count of transforms.
    """

    def __init__(self, height: Array, solid: Solid, fourier: Fourier) -> None:
        self.grid = fourier.grid
        self.solid = solid
        self.fourier = fourier
        self.height = np.ascontiguousarray(height, dtype=fourier.real)
        self.compliance = solid.grid_surface_compliance(self.grid, fourier.real)
        self.modulus = solid.effective_modulus
        self._coefficients = np.empty(self.grid.half_shape, fourier.complex)

    @property
    def nodal_compliance(self) -> float:
        """Unit of displacement per pressure: spacing / E*.

        On a half-space a node that alone is under pressure is displaced by 1.12 of it.
        """
        return min(self.grid.spacing) / self.modulus

    def displacement(self, pressure: Array, out: Array | None = None) -> Array:
        """Downward displacement u[y, x] of the surface under `pressure`, by one pair of transforms.

        The convolution with the periodic Green's function is a product in Fourier space (Stanley & Kato 1997,
        10.1115/1.2833523; Campañá & Müser 2006, 10.1103/PhysRevB.74.075420).
        """
        self.fourier.forward(pressure, self._coefficients)
        self._coefficients *= self.compliance
        return self.fourier.inverse(self._coefficients, out, overwrite=True)

    def coarser(self, min_points: int) -> Problem | None:
        """The same problem on half the nodes of each axis, its surface truncated in Fourier space.

        An axis is halved only down to `min_points` nodes; None if no axis can be halved.
        """
        ny, nx = (n if n < 2 * min_points else (n + 1) // 2 for n in self.grid.shape)
        if (ny, nx) == self.grid.shape:
            return None
        grid, outer = Grid((ny, nx), self.grid.length), self.fourier
        fourier = Fourier(grid, outer.real, outer.threads, outer.work)
        coefficients = resample(outer.forward(self.height), self.grid, grid)
        return Problem(fourier.inverse(coefficients, overwrite=True), self.solid, fourier)

    def refine(self, pressure: Array, finer: Problem, approach: float) -> Array:
        """Start for a finer grid: the interpolated pressure less the interpolated gap / nodal compliance.

        The Fourier interpolant of the pressure oscillates about zero outside the contact. The gap is
        positive there, and subtracting it before negative values are set to zero keeps those nodes free.
        """
        coefficients = self.fourier.forward(pressure)
        out = finer.fourier.inverse(resample(coefficients, self.grid, finer.grid), overwrite=True)
        coefficients *= self.compliance
        gap = finer.fourier.inverse(resample(coefficients, self.grid, finer.grid), overwrite=True)
        gap += finer.height
        gap -= gap.dtype.type(approach)
        gap *= gap.dtype.type(finer.modulus / min(finer.grid.spacing))
        out -= gap
        return np.maximum(out, 0, out=out)
