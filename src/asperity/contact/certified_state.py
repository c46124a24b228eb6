"""State of a contact problem in its own units, from the start to the certificate."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asperity.contact import gfmd
from asperity.contact.active_set import nested_grids
from asperity.contact.certificate import Certificate, certificate_of_fields, rms_deviation
from asperity.contact.compliance import response_on
from asperity.contact.compliance.vectors import dot
from asperity.contact.problem import Control, Problem, State
from asperity.core.compiled import compiled
from asperity.core.errors import ConvergenceError
from asperity.core.parallel import total
from asperity.core.types import Array, Progress

METHODS = {"active_set": nested_grids.solve, "gfmd": gfmd.solve}

# Largest violation of the conditions of contact at a single node, in units of the tolerance, which bounds the
# norm over all nodes, and in units of the rounding of the heights.
MAX_VIOLATION = 100.0
MAX_ROUNDINGS = 10.0

# A given start is used if its load, its area, or its approach measured from first contact differs from the
# imposed one by less than this fraction: beyond, the coarse grids give a better one.
NEAR_START = 0.3

# Least square of the correlation between the heights and what a given start displaces them by.
LEAST_FIT = 0.5


@dataclass(frozen=True)
class Fields:
    """What follows from a pressure.

    Attributes
    ----------
    displacement, gap : (ny, nx) arrays
        The gap of plastic nodes is negative.
    approach, mean_pressure : float
    nodes : int
        Number of contact nodes.
    """

    displacement: Array
    gap: Array
    approach: float
    mean_pressure: float
    nodes: int


def state_of(
    problem: Problem,
    control: Control,
    method: str,
    rtol: float,
    progress: Progress | None,
    initial: Array | None,
) -> State:
    """The state under a load; an imposed area is at least that of the lowest nodes, which touch together."""
    lowest, _ = problem.height_range
    if control.kind == "approach" and control.value <= lowest:
        return State(np.zeros_like(problem.height), control.value, 0.0)
    if control.kind == "mean_pressure" and control.value == 0:
        return State(np.zeros_like(problem.height), lowest, 0.0)
    if control.kind == "area_fraction":
        together = np.count_nonzero(problem.height == lowest) / problem.grid.size
        control = replace(control, value=max(control.value, together))
        all_touch = round(control.value * problem.grid.size) == problem.grid.size
        if all_touch and problem.response.repeats and problem.height.any():
            full = _full_contact(problem)
            if (largest := float(full.pressure.max())) > problem.hardness:
                raise ValueError(
                    f"area_fraction = {control.value:g}: less is needed, because full contact takes "
                    f"{largest / problem.hardness:.4g} times the hardness"
                )
            return full
    start = None if initial is None else _near_start(problem, control, initial)
    state = METHODS[method](problem, control, rtol, progress, start)
    if state.reached_hardness and not (state.pressure >= problem.hardness).any():
        # The way to an elastic contact led through a plastic one: its rounding differs. Its load may, too, if
        # many loads have the imposed area.
        unbounded = Problem(problem.height, problem.response, problem.datum)
        elastic = METHODS[method](unbounded, control, rtol, progress, start)
        if elastic.pressure.max() <= problem.hardness:
            return elastic
    return state


def _full_contact(problem: Problem) -> State:
    """The least load at which all nodes touch: every mode but the uniform one has û = −ĥ."""
    compliance, fourier = problem.response.compliance, problem.fourier
    coefficients = fourier.forward(problem.height)
    np.divide(coefficients, -compliance, out=coefficients, where=compliance > 0)
    coefficients[0, 0] = 0
    pressure = fourier.inverse(coefficients, overwrite=True)
    # The last node to touch bears a pressure just above rounding.
    pressure += np.ptp(pressure) * 4 * np.finfo(pressure.dtype).eps - pressure.min()
    return State(pressure, 0.0, float(pressure.mean(dtype=float)))


def _near_start(problem: Problem, control: Control, initial: Array) -> Array | None:
    """A given pressure without tension, so large that the deformed surface in contact fits the indenter.

    None if its load, area or approach is then far from the imposed one.
    """
    contact = initial > 0
    if not contact.any():
        return None
    pressure = (np.maximum(initial, 0) / initial.max()).astype(problem.fourier.real)
    heights = problem.height[contact].astype(float)
    displaced = problem.response.displacement(pressure)[contact].astype(float)
    variance, lowest = float(np.var(displaced)), problem.height_range[0]
    covariance = -float(np.mean(displaced * (heights - heights.mean())))
    if not covariance**2 > LEAST_FIT * variance * float(np.var(heights)):
        return None
    factor = covariance / variance
    now, wanted = {
        "mean_pressure": (factor * float(pressure.mean(dtype=float)), control.value),
        "area_fraction": (heights.size / problem.grid.size, control.value),
        "approach": (float(np.mean(heights + factor * displaced)) - lowest, control.value - lowest),
    }[control.kind]
    if not (factor > 0 and abs(now - wanted) < NEAR_START * wanted):
        return None
    return pressure * pressure.dtype.type(factor)


def fields_of(problem: Problem, control: Control, state: State) -> Fields:
    """The fields of a state."""
    response, threads, displacement = problem.response, problem.fourier.threads, state.displacement
    if displacement is None:
        displacement = response.displacement(state.pressure)
    mean = response.omitted_compliance * state.load if response.omits_mean else 0.0
    if mean:
        displacement = displacement + displacement.dtype.type(mean)
    fields = (field.reshape(-1) for field in (state.pressure, problem.height, displacement))
    hardness = problem.fourier.real.type(problem.hardness)
    sums = total(_levels_of_contact, threads, *fields, hardness)
    total_level, elastic, nodes, total_pressure = sums
    approach = state.approach
    if control.kind != "approach":
        approach = state.approach + mean if elastic == 0 else total_level / elastic
    gap = problem.height + displacement
    gap -= gap.dtype.type(approach)
    return Fields(displacement, gap, approach, total_pressure / problem.grid.size, nodes)


def checked_certificate(
    problem: Problem, control: Control, state: State, fields: Fields, rtol: float, method: str
) -> Certificate:
    """The certificate of a state.

    Raises
    ------
    ConvergenceError
        If a field is not finite, or the certificate exceeds what the tolerance allows: a relative error of
        the pressure changes the gap by that fraction of the displacement that the pressure can cause, which
        is largest for the longest wave.
    """
    pressure, gap, height, solid = state.pressure, fields.gap, problem.height, problem.response.solid
    threads, grid = problem.fourier.threads, problem.grid
    load = state.load if control.kind == "mean_pressure" else None
    if pressure.dtype == np.float32:
        height, pressure = height.astype(float), pressure.astype(float)
        exact = response_on(problem.response.boundary, solid, grid, threads=threads)
        gap = exact.displacement(pressure) + height - fields.approach
    certificate = certificate_of_fields(height, pressure, gap, problem.unit, load, threads, problem.hardness)
    worst, allowed = certificate.worst, MAX_VIOLATION * rtol
    is_finite = math.isfinite(worst)
    if is_finite and worst > allowed and (rms_height := rms_deviation(height, threads)):
        values = pressure.reshape(-1)
        longest = float(solid.surface_compliance(2 * np.pi / max(grid.length)))
        allowed *= max(1.0, math.sqrt(dot(values, values) / values.size) * longest / rms_height)
        largest = max(map(abs, problem.height_range))
        allowed += MAX_ROUNDINGS * float(np.finfo(problem.fourier.real).eps) * largest / rms_height
    if worst > allowed:
        fault = "violates the conditions of contact" if is_finite else "is not finite"
        raise ConvergenceError(
            f"{method} on {grid.shape} nodes ended with a pressure that {fault}",
            worst,
            rtol,
            state.iterations,
            float(pressure.mean(dtype=float)),
        )
    return replace(certificate, iterations=state.iterations)


@compiled
def _levels_of_contact(
    pressure: Any, height: Any, displacement: Any, hardness: Any
) -> tuple[float, int, int, float]:
    """Sum of h + u over the elastic nodes, their number, that of contact nodes, and the sum of p."""
    total_level, elastic, count, total = 0.0, 0, 0, 0.0
    for i in range(pressure.size):
        total += np.float64(pressure[i])
        if pressure[i] > 0:
            count += 1
            if pressure[i] < hardness:
                total_level += np.float64(height[i] + displacement[i])
                elastic += 1
    return total_level, elastic, count, total
