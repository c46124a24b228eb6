"""Checks of the arguments of `asperity.contact.solve`; messages name argument, value and range."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity.contact.problem import Control
from asperity.contact.response import Response
from asperity.elasticity.layer import Layer
from asperity.elasticity.two_bodies import Solid, TwoBodies
from asperity.errors import shown
from asperity.spectral import REAL_TYPES, Grid
from asperity.types import Array


def checked_height(height: ArrayLike) -> Array:
    """Return the surface as a real array [y, x] of finite numbers."""
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


def checked_solid(solid: object) -> Solid:
    """Return the solid, a `Layer` or `TwoBodies`."""
    if not isinstance(solid, (Layer, TwoBodies)):
        raise TypeError(f"solid = {shown(solid)}: a Layer or TwoBodies is needed")
    return solid


def checked_control(height: Array, response: Response, **imposed: float | None) -> Control:
    """Return the one quantity that is imposed, within its range; a force as the mean pressure it causes."""
    given = {kind: value for kind, value in imposed.items() if value is not None}
    if len(given) != 1:
        raise ValueError(
            f"exactly one of {', '.join(imposed)} is needed, got {', '.join(given) if given else 'none'}"
        )
    kind, raw = given.popitem()
    value = _real(kind, raw)
    if kind == "area_fraction" and not 0 < value <= 1:
        raise ValueError(f"area_fraction = {raw!r}: a number > 0 and ≤ 1 is needed")
    if kind in ("mean_pressure", "force") and value < 0:
        raise ValueError(f"{kind} = {raw!r}: a number ≥ 0 is needed")
    if kind == "force":
        return Control("mean_pressure", value / response.grid.area)
    if kind == "approach" and response.uniform_compliance == 0 and value >= height.mean():
        raise ValueError(
            f"approach = {raw!r}: less than the mean height {height.mean():.6g} is needed, because this "
            "solid has no uniform displacement"
        )
    return Control(kind, value)


def checked_initial(pressure: ArrayLike, grid: Grid) -> Array:
    """Return the pressure to start from, finite and of the shape of the surface."""
    values = np.asarray(pressure, dtype=float)
    if values.shape != grid.shape:
        raise ValueError(f"initial has the shape {values.shape}: that of height, {grid.shape}, is needed")
    if not np.all(np.isfinite(values)):
        raise ValueError("initial: finite pressures are needed")
    return values


def checked_settings(dtype: object, rtol: object, threads: object) -> tuple[str, float, int]:
    """Return precision, tolerance and number of threads, within their ranges."""
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
    """Return a finite real number."""
    if isinstance(value, (bool, str)) or np.ndim(value) != 0:  # type: ignore[arg-type]
        raise TypeError(f"{name} = {value!r}: a real number is needed")
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError) as error:
        raise TypeError(f"{name} = {value!r}: a real number is needed") from error
    if not np.isfinite(number):
        raise ValueError(f"{name} = {value!r}: a finite number is needed")
    return number
