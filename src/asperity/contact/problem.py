"""The contact problem on one grid, the imposed quantity, and the iterate of a solver."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity.contact import kernels
from asperity.contact.response import Response
from asperity.parallel import apply, extremes
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
    """Fields and numbers of a solver's result.

    Attributes
    ----------
    pressure : (ny, nx) array
        Non-negative.
    approach : float
        Imposed, or that of the last evaluation.
    load : float
        Mean pressure, NaN under an imposed approach.
    error : float
        Estimated error of the pressure, relative to its norm.
    iterations : int
        Applications of the compliance so far, on all grids.
    displacement : (ny, nx) array, optional
        That of the pressure, if the solver knows it.
    """

    pressure: Array
    approach: float
    load: float
    error: float = np.inf
    iterations: int = 0
    displacement: Array | None = None


class Problem:
    """A surface and the response of a solid on one grid.

    Parameters
    ----------
    height : (ny, nx) array
    response : Response
    height_range : (lowest, highest), optional
        If it is known.
    """

    def __init__(
        self, height: Array, response: Response, height_range: tuple[float, float] | None = None
    ) -> None:
        self.response = response
        self.fourier = response.fourier
        self.grid = response.grid
        self.solid = response.solid
        self.modulus = response.solid.effective_modulus
        self.height = np.ascontiguousarray(height, dtype=response.fourier.real)
        if height_range is not None and self.height.dtype == np.float64:
            self.height_range = height_range

    @property
    def compliance(self) -> Array:
        """Factors of the coefficients, see `Response`."""
        return self.response.compliance

    @cached_property
    def height_range(self) -> tuple[float, float]:
        """Least and largest height."""
        return extremes(self.height, self.fourier.threads)

    @property
    def largest_height(self) -> float:
        """Largest distance of a height from zero."""
        lowest, highest = self.height_range
        return max(highest, -lowest)

    @property
    def nodal_compliance(self) -> float:
        """Unit of displacement per pressure: spacing / E*.

        On a half-space a node that alone is under pressure is displaced by 1.12 of it.
        """
        return min(self.grid.spacing) / self.modulus

    def displacement(self, pressure: Array, out: Array | None = None) -> Array:
        """Downward displacement u[y, x] of the surface under `pressure`, by one pair of transforms."""
        return self.response.displacement(pressure, out)

    def coarser(self, min_points: int) -> Problem | None:
        """The same problem on half the nodes of each axis, its surface smoothed.

        An axis is halved only down to `min_points` nodes; None if no axis can be halved.
        """
        ny, nx = (n if n < 2 * min_points else (n + 1) // 2 for n in self.grid.shape)
        if (ny, nx) == self.grid.shape:
            return None
        response, height = self.response.coarsened(self.height, (ny, nx))
        return Problem(height, response)

    def in_single_precision(self, datum: float) -> Problem:
        """The same problem in single precision, with heights measured from a datum."""
        height = np.empty(self.grid.shape, np.float32)
        heights = self.height.reshape(-1)
        apply(kernels.write_from_datum, self.fourier.threads, heights, datum, height.reshape(-1))
        return Problem(height, self.response.in_single_precision())
