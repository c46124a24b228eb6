"""The contact problem on one grid, the imposed quantity, and the result of a method."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity.contact.compliance.response import Response
from asperity.core.types import Array, Progress


@dataclass(frozen=True)
class Control:
    """The imposed quantity: "area_fraction", "mean_pressure" or "approach", and its value."""

    kind: str
    value: float

    @property
    def fixes_load(self) -> bool:
        """True if the mean pressure of an iterate is known; control by area changes it between iterations."""
        return self.kind != "approach"


@dataclass(frozen=True)
class State:
    """Result of a method.

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
        Applications of the compliance, on all grids.
    displacement : (ny, nx) array, optional
        That of the pressure, if the method knows it.
    reached_hardness : bool
        True if a pressure was at the hardness on the way.
    """

    pressure: Array
    approach: float
    load: float
    error: float = 0.0
    iterations: int = 0
    displacement: Array | None = None
    reached_hardness: bool = False


class Problem:
    """A surface and the response of a solid on one grid.

    Parameters
    ----------
    height : (ny, nx) array
    response : Response
    datum : float
        Level from which the heights are measured: approach and gaps on this grid are relative to it.
    hardness : float
        Largest pressure, rounded to the precision of the fields.
    """

    def __init__(
        self, height: Array, response: Response, datum: float = 0.0, hardness: float = math.inf
    ) -> None:
        self.response = response
        self.fourier = response.fourier
        self.grid = response.grid
        self.height = np.ascontiguousarray(height, dtype=response.fourier.real)
        self.datum = datum
        self.hardness = float(response.fourier.real.type(hardness))

    @cached_property
    def height_range(self) -> tuple[float, float]:
        """Least and largest height."""
        return float(self.height.min()), float(self.height.max())

    @property
    def unit(self) -> float:
        """Unit of displacement per pressure, see `Response.nodal_compliance`."""
        return self.response.nodal_compliance

    def coarser(self, min_points: int) -> Problem | None:
        """The same problem on half the nodes of each axis, its surface smoothed.

        An axis is halved only down to `min_points` nodes; None if no axis can be halved.
        """
        ny, nx = (n if n < 2 * min_points else (n + 1) // 2 for n in self.grid.shape)
        if (ny, nx) == self.grid.shape:
            return None
        response, height = self.response.coarsened(self.height, (ny, nx))
        return Problem(height, response, self.datum, self.hardness)

    def in_single_precision(self) -> Problem:
        """The same problem in single precision, with heights measured from the middle of their range."""
        datum = 0.5 * sum(self.height_range)
        height = np.empty(self.grid.shape, np.float32)
        np.subtract(self.height, datum, height, dtype=float, casting="same_kind")
        return Problem(height, self.response.in_precision("float32"), self.datum + datum, self.hardness)


class ConvergenceProgress:
    """Reports the decrease of an error to its tolerance as progress, on a logarithmic scale.

    The progress never decreases, although the error may grow.
    """

    def __init__(self, progress: Progress | None, tolerance: float) -> None:
        self._progress = progress
        self._tolerance = tolerance
        self._largest = 0.0
        self._smallest = math.inf

    def __call__(self, error: float) -> None:
        """Report an error."""
        if self._progress is None or not 0 < error < math.inf:
            return
        self._largest = max(self._largest, error, 2 * self._tolerance)
        self._smallest = max(min(self._smallest, error), self._tolerance)
        total = math.log(self._largest / self._tolerance)
        self._progress(math.log(self._largest / self._smallest), total)
