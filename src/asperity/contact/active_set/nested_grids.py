"""The fast solver on nested grids: the solution of each grid starts the iteration on the next finer one.

Each grid has half the nodes of the next finer one on each axis. Starts from coarser grids are known from
multigrid methods, and for rough surfaces from Bemporad & Paggi (2015, arXiv:1506.00532). New here is the
interpolation of the pressure, which keeps nodes out of contact free (`Iterate.refined`).
"""

from __future__ import annotations

import math

import numpy as np

from asperity.contact.active_set.iterate import Pressure
from asperity.contact.active_set.outer_loop import StoppingRule, iterate_on
from asperity.contact.problem import Control, Problem, State
from asperity.core.errors import ConvergenceError
from asperity.core.types import Array, Progress

# The coarsest grid has at least this many nodes on each axis. Half and twice as many take the same number of
# transforms on the finest grid to 2 %.
MIN_POINTS = 32

# A coarse grid need not be solved better than its own discretisation error. Found by trial on rough surfaces
# of 1024² nodes: a fifth and four times the tolerance take as many transforms to 1 %, but the smaller one
# takes up to a fifth more steps.
COARSE_RULE = StoppingRule(tolerance=1e-2, area_tolerance=1e-2, max_steps=20, rounding_suffices=True)

# Smaller loads are not solved in single precision: their pressures might vanish.
SMALLEST_SINGLE_LOAD = 1e-20


def solve(
    problem: Problem, control: Control, rtol: float, progress: Progress | None, initial: Array | None
) -> State:
    """Solve a contact problem with the active-set method on nested grids.

    Parameters
    ----------
    problem : Problem
        On the finest grid.
    control : Control
    rtol : float
        Estimated error of the pressure to be reached, relative to its norm.
    progress : callable, optional
        Follows the error on the finest grid.
    initial : (ny, nx) array, optional
        Pressure to start from on the finest grid.

    Raises
    ------
    ConvergenceError
        If the outer loop on the finest grid gives up.
    """
    load = control.value if control.kind == "mean_pressure" else math.inf
    tiny = min(load, problem.hardness) < SMALLEST_SINGLE_LOAD
    problems = [problem]
    if not tiny and problem.height.dtype == np.float64:
        problems = [problem.in_single_precision(), problem]
    if initial is None:
        start, iterations = _start_from_coarse_grids(problems[0], control)
    else:
        load = control.value if control.kind == "mean_pressure" else float(initial.mean(dtype=float))
        start, iterations = Pressure.of_field(initial, load), 0
    found = iterate_on(problems, control, StoppingRule(rtol), start, progress)
    iterate, system = found.iterate, found.system
    iterations += found.iterations
    if not found.converged:
        raise ConvergenceError(
            f"active set on {problem.grid.shape} nodes stopped",
            system.error,
            rtol,
            iterations,
            float(iterate.pressure.sum(dtype=float)) / problem.grid.size,
            "a larger rtol is needed, or numbers that differ less in magnitude",
        )
    return State(
        iterate.pressure_field(),
        system.approach + iterate.problem.datum,
        iterate.load,
        system.error,
        iterations,
        iterate.displacement,
        iterate.reached_hardness,
    )


def _start_from_coarse_grids(problem: Problem, control: Control) -> tuple[Pressure, int]:
    """First guess on the coarsest grid, solved on one coarse grid after the other; and the work."""
    problems, iterations = [problem], 0
    while (coarser := problems[-1].coarser(MIN_POINTS)) is not None:
        problems.append(coarser)
    pressure = first_guess(problems[-1], control)
    while len(problems) > 1:
        coarse, finer = problems.pop(), problems[-1]
        found = iterate_on([coarse], control, COARSE_RULE, pressure)
        iterations += found.iterations
        pressure = found.iterate.refined(found.system.approach, finer, found.iterate.load)
    return pressure, iterations


def first_guess(problem: Problem, control: Control) -> Pressure:
    """Pressure in proportion to the overlap of the indenter with the undeformed solid.

    The factor is the stiffness of the longest wave of the cell. At an imposed approach the pressure is zero.
    """
    height, hardness = problem.height, problem.hardness
    stiffness = problem.response.solid.effective_modulus * 2 * math.pi / max(problem.grid.length)
    if control.kind == "approach":
        return Pressure.of_field(np.zeros_like(height), math.nan)
    if control.kind == "mean_pressure":
        level = _level_of_load(height, control.value, stiffness, hardness)
    else:
        # Twice the imposed area lies below this level, since the overlap exceeds the contact.
        least = height.min() + 1e-3 * np.std(height, dtype=float)
        level = float(max(np.quantile(height, min(0.999, 2 * control.value)), least))
    pressure = np.minimum(np.maximum(level - height, 0) * stiffness, hardness)
    if control.kind == "mean_pressure":
        return Pressure.of_field(pressure, control.value)
    if not pressure.any():
        pressure[:] = min(stiffness * min(problem.grid.spacing) * 1e-3, 0.5 * hardness)
    return Pressure.of_field(pressure, float(pressure.mean(dtype=float)))


def _level_of_load(height: Array, mean_pressure: float, stiffness: float, hardness: float) -> float:
    """Level at which the overlap times a stiffness, at most the hardness, has a given mean, by bisection."""
    low = float(height.min())
    high = float(height.max()) + mean_pressure / stiffness
    for _ in range(60):
        level = 0.5 * (low + high)
        if np.clip(level - height, 0, hardness / stiffness).mean() * stiffness > mean_pressure:
            high = level
        else:
            low = level
    return high
