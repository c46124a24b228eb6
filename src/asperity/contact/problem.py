"""The contact problem on one grid: the surface, the layer's compliance, and what is imposed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from asperity.elasticity.layer import Layer
from asperity.spectral import REAL_TYPES, Fourier, Grid, Work, resample
from asperity.types import Array, Progress

CONTROLS = ("area_fraction", "mean_pressure", "approach")


@dataclass(frozen=True)
class Control:
    """What is imposed: the name, one of `CONTROLS`, and its value."""

    kind: str
    value: float

    @property
    def fixes_load(self) -> bool:
        """Whether the mean pressure is given at every moment of the solution."""
        return self.kind != "approach"

    def lifts_off(self, height: Array) -> bool:
        """Whether the solid is not touched, or only just."""
        if self.kind == "approach":
            return self.value <= float(height.min())
        return self.value == 0


@dataclass
class State:
    """A pressure on its way to the solution.

    Attributes
    ----------
    pressure : (ny, nx) array
    gap : (ny, nx) array
        h + u, without the approach, at the last evaluation.
    approach : float
    load : float
        Mean pressure imposed, NaN if the approach is.
    error : float
        Estimated error of the pressure, relative to its norm.
    iterations : int
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
    layer : Layer
    grid : Grid
    dtype : "float64" or "float32"
    threads : int
    work : Work
        Where transforms are counted.
    """

    def __init__(self, height: Array, layer: Layer, grid: Grid, dtype: str, threads: int, work: Work) -> None:
        self.grid = grid
        self.layer = layer
        self.fourier = Fourier(grid, dtype, threads, work)
        self.height = np.ascontiguousarray(height, dtype=self.fourier.real)
        self.compliance = layer.grid_surface_compliance(grid, self.fourier.real)
        self.modulus = layer.effective_modulus
        self._coefficients = np.empty(grid.half_shape, self.fourier.complex)

    def displacement(self, pressure: Array, out: Array | None = None) -> Array:
        """Downward displacement u[y, x] of the surface under `pressure`: one pair of transforms."""
        self.fourier.forward(pressure, self._coefficients)
        self._coefficients *= self.compliance
        return self.fourier.inverse(self._coefficients, out, overwrite=True)

    def coarser(self, fewest: int) -> Problem | None:
        """The same problem on half the nodes of each axis, its surface truncated in Fourier space."""
        ny, nx = (n if n < 2 * fewest else (n + 1) // 2 for n in self.grid.shape)
        shape = (ny, nx)
        if shape == self.grid.shape:
            return None
        grid = Grid(shape, self.grid.length)
        fourier = Fourier(grid, self.fourier.real, self.fourier.threads, self.fourier.work)
        coefficients = resample(self.fourier.forward(self.height), self.grid, grid)
        height = fourier.inverse(coefficients, overwrite=True)
        return Problem(height, self.layer, grid, str(self.fourier.real), fourier.threads, self.fourier.work)

    def refine(self, pressure: Array, finer: Problem, approach: float) -> Array:
        """A pressure of this grid on a finer one.

        The Fourier interpolant rings where the contact ends. There the gap decides: it is held against the
        pressure as the indentation of a node.
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


class Reporter:
    """Turns errors on their way down to the tolerance into progress, on a logarithmic scale."""

    def __init__(self, progress: Progress | None, tolerance: float) -> None:
        self.progress = progress
        self.tolerance = tolerance
        self.first = 0.0
        self.least = math.inf

    def __call__(self, error: float) -> None:
        """Report the error."""
        if self.progress is None or not 0 < error < math.inf:
            return
        self.first = max(self.first, error, 2 * self.tolerance)
        self.least = max(min(self.least, error), self.tolerance)
        total = math.log(self.first / self.tolerance)
        self.progress(math.log(self.first / self.least), total)


def checked_height(height: ArrayLike) -> Array:
    """The surface as a real array [y, x] without holes."""
    values = np.asarray(height)
    if values.ndim != 2 or values.size == 0:
        raise ValueError(f"height has the shape {values.shape}: a two-dimensional array [y, x] is needed")
    if values.dtype.kind not in "fiu":
        raise TypeError(f"height has the type {values.dtype}: real numbers are needed")
    values = values.astype(float, copy=False)
    bad = int(np.count_nonzero(~np.isfinite(values)))
    if bad:
        raise ValueError(f"height: {bad} of {values.size} nodes are not finite numbers; all must be")
    return values


def checked_control(height: Array, layer: Layer, **imposed: float | None) -> Control:
    """The one quantity imposed, with its range."""
    given = {kind: value for kind, value in imposed.items() if value is not None}
    if len(given) != 1:
        raise ValueError(
            f"exactly one of {', '.join(CONTROLS)} is needed, got {', '.join(given) if given else 'none'}"
        )
    kind, raw = given.popitem()
    value = _real(kind, raw)
    if kind == "area_fraction" and not 0 < value <= 1:
        raise ValueError(f"area_fraction = {raw!r}: a number > 0 and ≤ 1 is needed")
    if kind == "mean_pressure" and value < 0:
        raise ValueError(f"mean_pressure = {raw!r}: a number ≥ 0 is needed")
    if kind == "approach" and layer.uniform_compliance() == 0 and value >= height.mean():
        raise ValueError(
            f"approach = {raw!r}: less than the mean height {height.mean():.6g} is needed, because this "
            "solid has no uniform displacement"
        )
    return Control(kind, value)


def checked_initial(pressure: ArrayLike, grid: Grid) -> Array:
    """A pressure to start from: finite, of the shape of the surface."""
    values = np.asarray(pressure, dtype=float)
    if values.shape != grid.shape:
        raise ValueError(f"initial has the shape {values.shape}: that of height, {grid.shape}, is needed")
    if not np.all(np.isfinite(values)):
        raise ValueError("initial: finite pressures are needed")
    return values


def checked_settings(dtype: object, rtol: object, threads: object) -> tuple[str, float, int]:
    """Precision, tolerance and number of threads within their ranges."""
    real = np.dtype(dtype)  # type: ignore[call-overload]
    if real not in REAL_TYPES:
        raise ValueError(f"dtype = {dtype!r}: float64 or float32 is needed")
    tolerance = _real("rtol", rtol)
    if not 0 < tolerance < 1:
        raise ValueError(f"rtol = {rtol!r}: a number between 0 and 1 is needed")
    if not isinstance(threads, (int, np.integer)) or threads < 1:
        raise ValueError(f"threads = {threads!r}: a whole number ≥ 1 is needed")
    return str(real), tolerance, int(threads)


def _real(name: str, value: object) -> float:
    if isinstance(value, (bool, str)) or np.ndim(value) != 0:  # type: ignore[arg-type]
        raise TypeError(f"{name} = {value!r}: a real number is needed")
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError) as error:
        raise TypeError(f"{name} = {value!r}: a real number is needed") from error
    if not np.isfinite(number):
        raise ValueError(f"{name} = {value!r}: a finite number is needed")
    return number
