"""Checks of the arguments of `asperity.contact.solve`; messages name argument, value and range."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asperity.arguments import LARGEST, SMALLEST, finite_array, number, real_array, whole_number
from asperity.contact.problem import Control
from asperity.contact.response import Response
from asperity.elasticity.layer import Layer
from asperity.elasticity.two_bodies import Solid, TwoBodies
from asperity.errors import shown
from asperity.parallel import extremes
from asperity.spectral import Grid
from asperity.types import REAL_TYPES, Array

_PRESSURES = (1e-150, 1e150)
_LOAD = f"0 or a number from {_PRESSURES[0]:g} to {_PRESSURES[1]:g}"

MAX_THREADS = 1024
"""Most threads: more than any machine has cores, few enough to be started."""

_CONTROLS: dict[str, tuple[str, Callable[[float], bool]]] = {
    "area_fraction": ("a number > 0 and ≤ 1", lambda value: 0 < value <= 1),
    "mean_pressure": (_LOAD, lambda value: value == 0 or _PRESSURES[0] <= value <= _PRESSURES[1]),
    "force": (_LOAD, lambda value: value == 0 or _PRESSURES[0] <= value <= _PRESSURES[1]),
    "approach": (f"a number from {-LARGEST:g} to {LARGEST:g}", lambda value: abs(value) <= LARGEST),
}
"""Imposed quantity → accepted numbers, for the message and as a function."""


def checked_height(height: ArrayLike, threads: int) -> tuple[Array, tuple[float, float]]:
    """Return the surface as a real array [y, x] of finite numbers, and its least and largest height."""
    values = real_array("height", height)
    if values.ndim != 2 or values.size == 0:
        raise ValueError(f"height has the shape {values.shape}: a two-dimensional array [y, x] is needed")
    values = values.astype(float, copy=False)
    lowest, highest = extremes(values, threads)
    if not (math.isfinite(lowest) and math.isfinite(highest)):
        bad = np.count_nonzero(~np.isfinite(values))
        raise ValueError(f"height: {bad} of {values.size} nodes are not finite numbers; all must be")
    if max(-lowest, highest) > LARGEST:
        raise ValueError(f"height: numbers from {-LARGEST:g} to {LARGEST:g} are needed")
    if 0 < highest - lowest < SMALLEST:
        raise ValueError(
            f"height: heights that differ by {SMALLEST:g} or more, or not at all, are needed; they differ by "
            f"{highest - lowest:.3g}"
        )
    return values, (lowest, highest)


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
    value = number(kind, raw, *_CONTROLS[kind])
    if kind == "force":
        return Control("mean_pressure", value / response.grid.area)
    if kind == "approach" and response.uniform_compliance == 0 and value >= height.mean():
        raise ValueError(
            f"approach = {shown(raw)}: less than the mean height {height.mean():.6g} is needed, because this "
            "solid has no uniform displacement"
        )
    return Control(kind, value)


def checked_initial(pressure: ArrayLike, grid: Grid) -> Array:
    """Return the pressure to start from, finite and of the shape of the surface."""
    values = finite_array("initial", pressure).astype(float, copy=False)
    if values.shape != grid.shape:
        raise ValueError(f"initial has the shape {values.shape}: that of height, {grid.shape}, is needed")
    return values


def checked_settings(dtype: Any, rtol: Any, threads: Any) -> tuple[str, float, int]:
    """Return precision, tolerance and number of threads, within their ranges."""
    try:
        real = np.dtype(dtype)
    except (TypeError, ValueError):
        real = None
    if dtype is None or real not in REAL_TYPES:
        raise ValueError(f"dtype = {shown(dtype)}: float64 or float32 is needed")
    tolerance = number("rtol", rtol, "a number between 0 and 1", lambda value: 0 < value < 1)
    workers = whole_number(
        "threads",
        threads,
        f"a whole number from 1 to {MAX_THREADS}",
        lambda count: 1 <= count <= MAX_THREADS,
    )
    return str(real), tolerance, workers
