"""Contact of an elastic solid with a rigid rough surface: no friction, no adhesion, a hard wall.

The indenter's height ``h[y, x]`` is its lower face measured upward, so the lowest points touch first. Under
a pressure p ≥ 0 the surface of the solid moves down by u, and the gap is ``g = h + u − δ ≥ 0`` with the
approach δ of the indenter. Where the solid has no uniform displacement (half-space, free bottom,
confined and incompressible) u has mean zero and δ is measured from the solid's mean plane.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from asperity.contact import active_set, gfmd
from asperity.contact.certificate import Certificate, verify_contact
from asperity.contact.problem import (
    Problem,
    State,
    checked_control,
    checked_height,
    checked_initial,
    checked_settings,
)
from asperity.elasticity.layer import Layer
from asperity.errors import ConvergenceError
from asperity.spectral import Fourier, Grid, Work, gradient
from asperity.types import Array, Progress

__all__ = ["Certificate", "Contact", "ConvergenceError", "solve", "solve_path", "verify_contact"]

METHODS = {"active_set": active_set.solve, "gfmd": gfmd.solve}


@dataclass(frozen=True, eq=False)
class Contact:
    """A solved contact.

    Attributes
    ----------
    height, pressure, displacement, gap : (ny, nx) arrays
        Indenter, contact pressure, downward displacement of the surface, and gap.
    grid : Grid
    layer : Layer
    area_fraction : float
        Nodes under pressure over all nodes.
    mean_pressure : float
        Load over the area of the cell.
    approach : float
    certificate : Certificate
        Recomputed from the pressure.
    method : str
    rtol : float
    """

    height: Array
    pressure: Array
    displacement: Array
    gap: Array
    grid: Grid
    layer: Layer
    area_fraction: float
    mean_pressure: float
    approach: float
    certificate: Certificate
    method: str
    rtol: float

    @cached_property
    def gradient_rms_contact(self) -> float:
        """Root-mean-square gradient of the deformed surface over the nodes under pressure (the paper's ḡ_r).

        By spectral differentiation; NaN without contact.
        """
        touching = self.pressure > 0
        if not touching.any():
            return float("nan")
        fourier = Fourier(self.grid, self.displacement.dtype)
        slope_y, slope_x = gradient(fourier.forward(self.displacement), fourier)
        return float(np.sqrt((slope_y[touching] ** 2 + slope_x[touching] ** 2).mean(dtype=float)))


def solve(
    height: ArrayLike,
    layer: Layer,
    length: float | tuple[float, float] = 1.0,
    *,
    area_fraction: float | None = None,
    mean_pressure: float | None = None,
    approach: float | None = None,
    method: str = "active_set",
    rtol: float = 1e-6,
    dtype: DTypeLike = "float64",
    threads: int = 1,
    progress: Progress | None = None,
    initial: Contact | ArrayLike | None = None,
) -> Contact:
    """Press a rigid rough surface against an elastic solid.

    Exactly one of `area_fraction`, `mean_pressure` and `approach` is given.

    Parameters
    ----------
    height : (ny, nx) array
        Lower face of the indenter, measured upward, in the unit of `length`.
    layer : Layer
    length : float or (length_y, length_x)
        Edges of the periodic cell.
    area_fraction : float
        Contact nodes over all nodes, met to 1e-4 of itself, or to the nearest number of nodes that the
        surface allows.
    mean_pressure : float
        Load over the area of the cell, in the unit of Young's modulus.
    approach : float
        Position of the indenter, in the unit of `length`.
    method : "active_set" | "gfmd"
        The fast solver, or the damped dynamics of the paper; they reach the same solution.
    rtol : float
        Error of the pressure relative to its norm, as estimated by the solver.
    dtype : "float64" or "float32"
        Precision of the fields.
    threads : int
        For the transforms; the solution does not depend on it.
    progress : callable, optional
        Called as progress(done, total).
    initial : Contact or (ny, nx) array, optional
        A pressure to start from.

    Returns
    -------
    Contact

    Raises
    ------
    ConvergenceError
        If the tolerance is not reached.
    ValueError, TypeError
        If an argument is out of range.

    Notes
    -----
    `gfmd` is section 2 of the paper with position Störmer–Verlet and a uniform mass.
    """
    values = checked_height(height)
    grid = Grid(values.shape, length)  # type: ignore[arg-type]
    if not isinstance(layer, Layer):
        raise TypeError(f"layer = {layer!r}: a Layer is needed")
    if method not in METHODS:
        raise ValueError(f"method = {method!r}: one of {', '.join(METHODS)} is needed")
    precision, tolerance, workers = checked_settings(dtype, rtol, threads)
    control = checked_control(
        values, layer, area_fraction=area_fraction, mean_pressure=mean_pressure, approach=approach
    )
    start = initial.pressure if isinstance(initial, Contact) else initial
    pressure = None if start is None else checked_initial(start, grid)
    begin = time.perf_counter()
    work = Work()
    problem = Problem(values, layer, grid, precision, workers, work)
    if control.lifts_off(values):
        state = State(np.zeros_like(problem.height), problem.height, float(values.min()), 0.0, 0.0)
        if control.kind == "approach":
            state.approach = control.value
    else:
        state = METHODS[method](problem, control, tolerance, progress, pressure)
    return _contact(problem, control.kind, state, method, tolerance, time.perf_counter() - begin)


def solve_path(
    height: ArrayLike,
    layer: Layer,
    length: float | tuple[float, float] = 1.0,
    *,
    area_fractions: Sequence[float] | None = None,
    mean_pressures: Sequence[float] | None = None,
    approaches: Sequence[float] | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> Iterator[Contact]:
    """Solve for one load after the other, each starting from the one before.

    Parameters
    ----------
    height, layer, length
        As for `solve`.
    area_fractions, mean_pressures, approaches : sequence of float
        Exactly one of them.
    progress : callable, optional
        Counts the loads.
    **settings
        Passed to `solve`.

    Yields
    ------
    Contact
    """
    paths = {"area_fraction": area_fractions, "mean_pressure": mean_pressures, "approach": approaches}
    given = {kind: list(values) for kind, values in paths.items() if values is not None}
    if len(given) != 1:
        raise ValueError(
            "exactly one of area_fractions, mean_pressures, approaches is needed, "
            f"got {', '.join(given) if given else 'none'}"
        )
    ((kind, values),) = given.items()
    return _path(height, layer, length, kind, values, progress, settings)


def _path(
    height: ArrayLike,
    layer: Layer,
    length: float | tuple[float, float],
    kind: str,
    values: Sequence[float],
    progress: Progress | None,
    settings: dict[str, Any],
) -> Iterator[Contact]:
    previous: Contact | None = None
    for index, value in enumerate(values):

        def step(done: float, total: float, index: int = index) -> None:
            assert progress is not None
            progress(index + done / total, len(values))

        contact = solve(
            height,
            layer,
            length,
            **{kind: value},  # type: ignore[arg-type]
            initial=previous,
            progress=None if progress is None else step,
            **settings,
        )
        previous = contact if contact.area_fraction > 0 else None
        if progress is not None:
            progress(index + 1, len(values))
        yield contact


def _contact(problem: Problem, kind: str, state: State, method: str, rtol: float, seconds: float) -> Contact:
    """Everything that follows from the pressure, and its certificate."""
    grid, layer, pressure = problem.grid, problem.layer, state.pressure
    pairs = problem.fourier.work.pairs(grid)
    displacement = problem.displacement(pressure)
    gap = problem.height + displacement
    contact = pressure > 0
    if kind == "approach" or not contact.any():
        approach = state.approach
    else:
        approach = float(gap[contact].mean(dtype=float))
    certificate = verify_contact(
        problem.height,
        pressure,
        layer,
        grid.length,
        approach=approach,
        mean_pressure=state.load if kind == "mean_pressure" else None,
        iterations=state.iterations,
        pairs=pairs,
        seconds=seconds,
        threads=problem.fourier.threads,
    )
    gap -= gap.dtype.type(approach)
    return Contact(
        height=problem.height,
        pressure=pressure,
        displacement=displacement,
        gap=gap,
        grid=grid,
        layer=layer,
        area_fraction=float(contact.mean()),
        mean_pressure=float(pressure.mean(dtype=float)),
        approach=approach,
        certificate=certificate,
        method=method,
        rtol=rtol,
    )
