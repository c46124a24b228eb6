"""Green's function molecular dynamics: damped dynamics of the surface against a hard wall.

The displacement modes of the surface move under their elastic force −k(q) û(q), k = 1/G, with one mass
for all, by position Störmer–Verlet with centred damping,

    (1 + γ/2) û⁺ = 2 û − (1 − γ/2) û⁻ + τ² f̂,      γ = η τ,

and after each step every node that has passed through the indenter is put back on it, in real space.
The mass is uniform because a clamp in real space and a mass that depends on q have a fixed point that
is not equilibrium. The time step is a fraction of the stability limit 2/ω of the stiffest mode; the
damping is a fraction of the critical damping of the slowest,

    γ_critical = 2 √(κ − κ²/4),      κ = ω² τ².

The wall is at rest and the load pushes the solid against it, so that with an imposed load the uniform
mode has no elastic stiffness: its restoring force is the growth of contact, d(load)/d(gap) ≈ load over
half the rms height. With an imposed approach and no uniform displacement the mean is held at zero by a
spring and by a load that grows with what is left of the mean; what the load still lacks, by its last
change per change of the mean, counts as error.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

from asperity.contact.control import AreaControl
from asperity.contact.problem import Control, Problem, Reporter, State
from asperity.errors import ConvergenceError
from asperity.types import Array, Progress

# Time step over the stability limit, and damping over the critical damping of the slowest mode.
TIME_STEP = 0.9
DAMPING = 0.99

# Growth of the load that holds the mean displacement, over damping and spring.
HOLD = 0.25

# Steps between two looks at the residual, and before giving up.
STRIDE = 10
MOST_STEPS = 20_000


def solve(
    problem: Problem,
    control: Control,
    rtol: float,
    progress: Progress | None,
    initial: Array | None,
    damping: float = DAMPING,
) -> State:
    """Let the surface come to rest on the indenter.

    Parameters
    ----------
    problem : Problem
    control : Control
    rtol : float
        Traction off the contact and tension on it, relative to the norm of the pressure, to be reached.
    progress : callable, optional
    initial : (ny, nx) array, optional
        Start from the displacement under this pressure.
    damping : float
        Over the critical damping of the slowest mode.

    Raises
    ------
    ConvergenceError
        If the surface has not come to rest after `MOST_STEPS`.
    """
    grid, fourier, height = problem.grid, problem.fourier, problem.height
    stiffness = np.zeros_like(problem.compliance)
    np.divide(1, problem.compliance, out=stiffness, where=problem.compliance > 0)
    fixed_load = control.fixes_load
    without_uniform = problem.compliance[0, 0] == 0
    if fixed_load:
        stiffness[0, 0] = 0
    if control.kind == "mean_pressure":
        load = control.value
    elif initial is not None:
        load = float(np.mean(initial, dtype=float))
    elif control.kind == "approach":
        load = 0.0
    else:
        load = 0.5 * control.value * problem.modulus * _rms_gradient(problem)
    wall = (0.0 if fixed_load else control.value) - height
    elastic = stiffness[stiffness > 0]
    softest, stiffest = (float(elastic.min()), float(elastic.max())) if elastic.size else (1.0, 1.0)
    hold = 4 * softest if without_uniform and not fixed_load else 0.0
    if hold:
        stiffness[0, 0] = hold
    squared_step = TIME_STEP**2 * 4 / stiffest
    area = AreaControl(control.value, grid.size, rtol) if control.kind == "area_fraction" else None
    rms_height = float(np.std(height, dtype=float))

    if initial is not None and np.any(initial):
        displacement = problem.displacement(initial)
    else:
        displacement = np.zeros_like(height)
    if fixed_load:
        displacement += np.max(wall - displacement)
    np.maximum(displacement, wall, out=displacement)
    now = fourier.forward(displacement)
    before = now.copy()
    state = State(np.zeros_like(height), np.empty_like(height), control.value, load)
    report, waiting, held = Reporter(progress, rtol), 0, (0.0, 0.0)
    for step in range(1, MOST_STEPS + 1):
        slowest = softest
        if fixed_load and rms_height:
            slowest = min(softest, state.load / (0.5 * rms_height))
        kappa = min(slowest * squared_step, 2.0)
        gamma = damping * 2 * math.sqrt(kappa - kappa**2 / 4)
        if hold:
            state.load = max(state.load + HOLD * gamma * hold * float(now[0, 0].real), 0.0)
        _advance(now, before, stiffness, squared_step, gamma, squared_step * state.load)
        fourier.inverse(before, displacement)
        np.maximum(displacement, wall, out=displacement)
        now, before = fourier.forward(displacement, before), now
        state.iterations = step
        if step % STRIDE:
            continue
        traction = fourier.inverse(stiffness * now, overwrite=True)
        if state.load:
            traction += traction.dtype.type(state.load)
        state.pressure = np.where((displacement == wall) & (traction > 0), traction, 0)
        norm = math.sqrt(float(np.sum(np.square(state.pressure), dtype=float)))
        astray = math.sqrt(float(np.sum(np.square(traction - state.pressure), dtype=float)))
        if not math.isfinite(astray):
            break
        if hold:
            mean = float(now[0, 0].real)
            growth = abs((state.load - held[0]) / (mean - held[1])) if mean != held[1] else 0.0
            astray = max(astray, max(hold, growth) * abs(mean) * math.sqrt(grid.size))
            held = (state.load, mean)
        state.error = astray / norm if norm else (0.0 if astray == 0 else math.inf)
        report(state.error)
        # A load just changed takes effect within the relaxation time of the slowest mode.
        settled = state.error <= rtol and step >= waiting
        if area is not None and step >= waiting:
            load = state.load
            again = area.steer(state, settled)
            if state.load != load:
                waiting = step + math.ceil(3 / math.sqrt(kappa))
            if again:
                continue
        if settled:
            if fixed_load:
                state.pressure *= state.pressure.dtype.type(state.load / state.pressure.mean(dtype=float))
            return state
    raise ConvergenceError(
        f"damped dynamics on {grid.shape} nodes stopped", state.error, rtol, state.iterations, state.load
    )


def _rms_gradient(problem: Problem) -> float:
    coefficients = problem.fourier.forward(problem.height)
    power = np.abs(coefficients) ** 2 * problem.grid.wavenumber() ** 2
    return float(np.sqrt(np.sum(power @ problem.grid.multiplicity)))


@njit(cache=True, error_model="numpy")
def _advance(now: Any, before: Any, stiffness: Any, squared_step: float, gamma: float, push: float) -> None:
    """One step of every mode; the new ones replace `before`."""
    rows, columns = now.shape
    scale = 1 / (1 + gamma / 2)
    backward = (1 - gamma / 2) * scale
    uniform = now[0, 0]
    uniform_before = before[0, 0]
    for i in range(rows):
        for j in range(columns):
            forward = (2 - squared_step * stiffness[i, j]) * scale
            before[i, j] = forward * now[i, j] - backward * before[i, j]
    before[0, 0] = ((2 - squared_step * stiffness[0, 0]) * uniform - push) * scale - backward * uniform_before
