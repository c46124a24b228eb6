"""The fast solver on nested grids: the solution of each grid starts the iteration on the next finer one.

Each grid has half the nodes of the next finer one on each axis. Starts from coarser grids are known from
multigrid methods, and for rough surfaces from Bemporad & Paggi (2015, arXiv:1506.00532). New here are the
interpolation of the pressure, which keeps nodes out of contact free (`Iterate.refined`), and the prediction
of the load of the next grid if an area is imposed.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from asperity.contact.active_set import ActiveSet, StoppingRule
from asperity.contact.area_control import AREA_TOLERANCE
from asperity.contact.inner_solve import InnerSolver
from asperity.contact.iterate import Iterate
from asperity.contact.load_prediction import LoadPrediction
from asperity.contact.problem import Control, Problem, State
from asperity.errors import ConvergenceError
from asperity.types import Array, Progress

# The coarsest grid has at least this many nodes on each axis. Half and twice as many take the same number of
# transforms on the finest grid to 2 %.
MIN_POINTS = 32

# A coarse grid need not be solved better than its own discretisation error. Found by trial on rough surfaces
# of 1024² nodes: a fifth and four times the tolerance take as many transforms to 1 %, but the smaller one
# takes up to a fifth more steps.
COARSE_RULE = StoppingRule(
    tolerance=1e-2, area_tolerance=1e-2, max_outer_iterations=20, rounding_suffices=True
)

# On the finest grid, single precision is used down to this error, where rounding does not matter yet.
SINGLE_PRECISION_TOLERANCE = 2e-3

# Smaller loads are not solved in single precision: their pressures might vanish.
SMALLEST_SINGLE_LOAD = 1e-20

# On the finest grid. The problems of `asperity.validation.extremes` that are solved take at most 134.
MAX_OUTER_ITERATIONS = 400

# A given start replaces the coarse grids if its load, its area, or its approach measured from first contact
# differs from the imposed one by less than this fraction.
NEAR_START = 0.3


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
        Pressure to start from on the finest grid; ignored if it is far from the imposed quantity.

    Raises
    ------
    ConvergenceError
        If the outer loop on the finest grid gives up.
    """
    mean_compliance = 0.0
    if control.fixes_load:
        response, mean_compliance = problem.response.without_mean()
        problem = Problem(problem.height, response, problem.height_range)
    if initial is not None and not _is_near(problem, control, initial):
        initial = None
    iterate, inner = _start(problem, control, rtol, initial)
    rule = StoppingRule(rtol, AREA_TOLERANCE, MAX_OUTER_ITERATIONS)
    if not ActiveSet(problem, control, rule, inner).solve(iterate, progress):
        raise ConvergenceError(
            f"active set on {problem.grid.shape} nodes stopped",
            iterate.error,
            rtol,
            iterate.iterations,
            iterate.mean_pressure,
            "a larger rtol is needed, or numbers that differ less in magnitude",
        )
    problem.response.release()
    return iterate.state(mean_compliance)


def _first_iterate(problem: Problem, control: Control, initial: Array | None) -> Iterate:
    """Iterate of a given pressure, without tension, or else of the solutions on coarser grids."""
    if initial is None:
        return _start_from_coarse_grids(problem, control)
    load = {"area_fraction": float(np.maximum(initial, 0).mean(dtype=float)), "mean_pressure": control.value}
    return Iterate.of_field(problem, initial, control.value, load.get(control.kind, math.nan))


def _start(
    problem: Problem, control: Control, rtol: float, initial: Array | None
) -> tuple[Iterate, InnerSolver | None]:
    """Start from a solution in single precision, and the inner solver that found it.

    The solution in single precision starts from a given pressure, or from the coarse grids without one.
    """
    tiny = control.kind == "mean_pressure" and control.value < SMALLEST_SINGLE_LOAD
    if tiny or problem.height.dtype == np.float32:
        return _first_iterate(problem, control, initial), None
    datum = 0.5 * sum(problem.height_range)
    single = problem.in_single_precision(datum)
    within = control if control.fixes_load else replace(control, value=control.value - datum)
    iterate = _first_iterate(single, within, initial)
    inner = InnerSolver(single)
    rule = replace(COARSE_RULE, tolerance=max(SINGLE_PRECISION_TOLERANCE, rtol), goal=rtol)
    ActiveSet(single, within, rule, inner).solve(iterate)
    single.response.release()
    pressure = iterate.pressure.astype(problem.fourier.real)
    start = Iterate(problem, iterate.nodes, pressure, iterate.approach + datum, iterate.load)
    start.iterations, start.expected_motion = iterate.iterations, iterate.expected_motion
    return start, inner


def _start_from_coarse_grids(problem: Problem, control: Control) -> Iterate:
    """First guess on the coarsest grid, solved on one coarse grid after the other and refined."""
    problems = [problem]
    while (coarser := problems[-1].coarser(MIN_POINTS)) is not None:
        problems.append(coarser)
    iterate = first_guess(problems[-1], control)
    coarse_control, loads = control, LoadPrediction(control.value)
    while len(problems) > 1:
        coarse, finer = problems.pop(), problems[-1]
        ActiveSet(coarse, coarse_control, COARSE_RULE).solve(iterate)
        load = iterate.load
        if control.kind == "area_fraction":
            touching = max(1, int(np.count_nonzero(iterate.pressure))) / coarse.grid.size
            coarse_control, load = loads.next_control(load, touching, finer.grid.size, len(problems) == 1)
        iterate = iterate.refined(finer, load)
    return iterate


def first_guess(problem: Problem, control: Control) -> Iterate:
    """Pressure in proportion to the overlap of the indenter with the undeformed solid.

    The factor is the stiffness of the longest wave of the cell. At an imposed approach the pressure is zero.
    """
    height = problem.height
    stiffness = problem.modulus * 2 * math.pi / max(problem.grid.length)
    if control.kind == "approach":
        pressure, load = np.zeros_like(height), math.nan
    elif control.kind == "mean_pressure":
        level = _level_of_load(height, control.value, stiffness)
        pressure, load = np.maximum(level - height, 0) * stiffness, control.value
    else:
        pressure = np.maximum(_level_of_area(height, control.value) - height, 0) * stiffness
        if not pressure.any():
            pressure[:] = stiffness * min(problem.grid.spacing) * 1e-3
        load = float(pressure.mean(dtype=float))
    return Iterate.of_field(problem, pressure, control.value, load)


def _level_of_area(height: Array, area_fraction: float) -> float:
    """Level below which lies twice the imposed area, since the overlap exceeds the contact."""
    fraction = min(0.999, 2 * area_fraction)
    return float(max(np.quantile(height, fraction), height.min() + 1e-3 * np.std(height, dtype=float)))


def _level_of_load(height: Array, mean_pressure: float, stiffness: float) -> float:
    """Level at which the overlap times a stiffness has a given mean, by bisection."""
    low = float(height.min())
    high = float(height.max()) + mean_pressure / stiffness
    for _ in range(60):
        level = 0.5 * (low + high)
        if np.maximum(level - height, 0).mean() * stiffness > mean_pressure:
            high = level
        else:
            low = level
    return high


def _is_near(problem: Problem, control: Control, pressure: Array) -> bool:
    """True if a pressure is a better start than the solution of a coarser grid."""
    if control.kind == "area_fraction":
        now = float(np.count_nonzero(pressure > 0)) / problem.grid.size
    elif control.kind == "mean_pressure":
        now = float(np.maximum(pressure, 0).mean())
    else:
        pressure = np.maximum(pressure, 0).astype(problem.fourier.real)
        gap = problem.displacement(pressure) + problem.height
        contact = pressure > 0
        now = float(gap[contact].mean()) - problem.height.min() if contact.any() else 0.0
        return abs(now - (control.value - problem.height.min())) < NEAR_START * abs(now)
    return abs(now - control.value) < NEAR_START * control.value
