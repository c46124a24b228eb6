"""Solution of one contact problem: checks the arguments, chooses the method, and certifies the result."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from asperity.arguments import choice
from asperity.contact import gfmd, kernels, nested_grids
from asperity.contact.arguments import (
    checked_control,
    checked_height,
    checked_initial,
    checked_settings,
    checked_solid,
)
from asperity.contact.boundaries import response_on
from asperity.contact.certificate import certificate_of_fields, rms_deviation, verify_contact
from asperity.contact.problem import Control, Problem, State
from asperity.contact.solution import Contact
from asperity.contact.units import Units, units_of
from asperity.elasticity.two_bodies import Solid
from asperity.errors import ConvergenceError
from asperity.finite import is_finite, require_finite
from asperity.parallel import apply, total
from asperity.spectral import Grid
from asperity.types import Array, Progress

# Largest violation of the conditions of contact at a single node, in units of the tolerance, which bounds the
# norm over all nodes, and in units of the rounding of the heights.
MAX_VIOLATION = 100.0
MAX_ROUNDINGS = 10.0

METHODS = {"active_set": nested_grids.solve, "gfmd": gfmd.solve}


def solve(
    height: ArrayLike,
    solid: Solid,
    length: float | tuple[float, float] = 1.0,
    *,
    area_fraction: float | None = None,
    mean_pressure: float | None = None,
    force: float | None = None,
    approach: float | None = None,
    boundary: str = "periodic",
    method: str = "active_set",
    rtol: float = 1e-6,
    dtype: DTypeLike = "float64",
    threads: int = 1,
    progress: Progress | None = None,
    initial: Contact | ArrayLike | None = None,
) -> Contact:
    """Press a rough surface against an elastic solid: a rigid one, or one of two elastic bodies.

    Exactly one of `area_fraction`, `mean_pressure`, `force` and `approach` is given.

    Parameters
    ----------
    height : (ny, nx) array
        Lower face of the indenter, measured upward, in the unit of `length`; for two bodies the lower face of
        the upper one less the upper face of the lower one.
    solid : Layer or TwoBodies
        One elastic solid under a rigid indenter, or two elastic bodies.
    length : float or (length_y, length_x)
        Edges of the map, number of nodes × spacing: those of the cell if it repeats.
    area_fraction : float
        Contact nodes over all nodes, met to 1e-4 of itself, or to the nearest number of nodes that the
        surface allows.
    mean_pressure : float
        Load over the area of the map, in the unit of Young's modulus.
    force : float
        Mean pressure times the area of the map.
    approach : float
        Position of the indenter, in the unit of `length`. The indenter first touches at the approach
        ``height.min()``. With a free boundary it is measured from the solid's surface far from the map, so
        that ``approach - height.min()`` is the displacement of the indenter from first touch.
    boundary : "periodic" | "free"
        "periodic": the map repeats in both directions. "free": nothing surrounds the map, whose solid is a
        half-space, or each of two bodies is one; each node is a rectangle under uniform pressure.
    method : "active_set" | "gfmd"
        The fast solver, or the damped dynamics of the paper; both converge to the same solution.
    rtol : float
        Error of the pressure relative to its norm, as estimated by the solver.
    dtype : "float64" or "float32"
        Precision of the fields. If the tolerance is not reached in single precision, the problem is solved
        again in double precision, and the fields are rounded at the end.
    threads : int
        The solution does not depend on it.
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
    The methods are described in `asperity.contact.active_set` and `asperity.contact.gfmd`.

    Examples
    --------
    A rough surface on steel, in SI units, and a ball on a flat, which compare with Hertz:

    >>> steel = asp.Layer(young=210e9, poisson=0.3)  # Pa
    >>> height = asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)  # m
    >>> contact = asp.solve(height, steel, length=2e-4, mean_pressure=20e6)
    >>> print(f"{contact.area_fraction:.3f} of the area, at most {contact.max_pressure / 1e9:.2f} GPa")
    0.024 of the area, at most 1.91 GPa

    >>> ball = asp.add_sphere(np.zeros((64, 64)), 3e-4, radius=10e-3)
    >>> contact = asp.solve(ball, steel, 3e-4, force=20.0, boundary="free")
    >>> hertz = (6 * 20.0 * steel.effective_modulus**2 / (np.pi**3 * 10e-3**2)) ** (1 / 3)
    >>> bool(abs(contact.max_pressure / hertz - 1) < 0.01)
    True
    """
    precision, tolerance, workers = checked_settings(dtype, rtol, threads)
    values, height_range = checked_height(height, workers)
    grid = Grid(values.shape, length)  # type: ignore[arg-type]
    solid = checked_solid(solid)
    choice("method", method, tuple(METHODS))
    response = response_on(boundary, solid, grid, precision, workers)
    if method == "gfmd" and boundary != "periodic":
        raise ValueError(f"method = 'gfmd': active_set is needed for boundary = {boundary!r}")
    control = checked_control(
        values,
        response,
        area_fraction=area_fraction,
        mean_pressure=mean_pressure,
        force=force,
        approach=approach,
    )
    start = initial.pressure if isinstance(initial, Contact) else initial
    pressure = None if start is None else checked_initial(start, grid)
    begin = time.perf_counter()
    units = units_of(height_range, solid, grid, control)
    if units != Units():
        response = response_on(boundary, units.solid(solid), units.grid(grid), precision, workers)
        pressure = None if pressure is None else pressure / units.stress
    heights, control = units.heights(values), units.control(control)
    problem = Problem(heights, response, height_range if units == Units() else None)
    # A given start may overflow: what comes of it is checked in the end.
    with np.errstate(over="ignore", invalid="ignore"):
        if control.lifts_off(problem.height):
            position = control.value if control.kind == "approach" else problem.height_range[0]
            state = State(np.zeros_like(problem.height), position, 0.0, 0.0)
        else:
            state = _solved(problem, heights, control, method, tolerance, progress, pressure)
        found = _certified(problem, control, state, method, tolerance, time.perf_counter() - begin)
    restored = units.restored(found, values, solid, grid)
    # The certificate is finite only if the fields are, which are those of the result unless units differ.
    known = restored is found and values.dtype == found.pressure.dtype
    require_finite(
        "solve", {name: one for name, one in vars(restored).items() if not known or np.ndim(one) == 0}
    )
    return restored


def _solved(
    problem: Problem,
    heights: Array,
    control: Control,
    method: str,
    rtol: float,
    progress: Progress | None,
    initial: Array | None,
) -> State:
    """The state under a load, found in double precision if single precision does not reach the tolerance."""
    within_reach, precision = _within_reach(control, heights), problem.fourier.real
    try:
        return METHODS[method](problem, within_reach, rtol, progress, initial)
    except ConvergenceError:
        if precision == np.float64 or rtol < np.finfo(precision).eps:
            raise
    # Not in the block above, so that the fields of the first attempt are released.
    in_double = Problem(heights, problem.response.in_double_precision())
    state = METHODS[method](in_double, within_reach, rtol, progress, initial)
    state.pressure = state.pressure.astype(precision)
    if not is_finite(state.pressure):
        raise ConvergenceError(
            f"{method} on {problem.grid.shape} nodes found a pressure beyond single precision",
            state.error,
            rtol,
            state.iterations,
            state.load,
            "dtype = 'float64' or another start is needed",
        )
    return state


def _within_reach(control: Control, height: Array) -> Control:
    """The control; an imposed area is at least that of the lowest nodes, which all touch at any load."""
    if control.kind != "area_fraction":
        return control
    lowest = np.count_nonzero(height == height.min())
    return replace(control, value=max(control.value, lowest / height.size))


def _certified(
    problem: Problem, control: Control, state: State, method: str, rtol: float, seconds: float
) -> Contact:
    """Evaluate the fields that follow from the pressure of a state, and certify it."""
    grid, pressure, displacement = problem.grid, state.pressure, state.displacement
    threads = problem.fourier.threads
    if displacement is None or displacement.dtype != pressure.dtype:
        displacement = problem.displacement(pressure)
    pairs = problem.fourier.work.pairs(grid)
    gap = np.empty_like(problem.height)
    flat = [field.reshape(-1) for field in (pressure, problem.height, displacement, gap)]
    total_gap, nodes, total_pressure = total(kernels.gap_of_contact, threads, *flat[:3])
    approach = state.approach if control.kind == "approach" or nodes == 0 else total_gap / nodes
    apply(kernels.write_gap, threads, *flat[1:3], gap.dtype.type(approach), flat[3])
    load = state.load if control.kind == "mean_pressure" else None
    if pressure.dtype == np.float64:
        certificate = certificate_of_fields(
            problem.height, pressure, gap, problem.nodal_compliance, load, threads
        )
    else:
        certificate = verify_contact(
            problem.height,
            pressure,
            problem.solid,
            grid.length,
            approach=approach,
            mean_pressure=load,
            boundary=problem.response.boundary,
            threads=threads,
        )
    mean_pressure, area_fraction = total_pressure / grid.size, nodes / grid.size
    reached = {"area_fraction": area_fraction, "mean_pressure": mean_pressure}
    found = Contact(
        height=problem.height,
        pressure=pressure,
        displacement=displacement,
        gap=gap,
        grid=grid,
        solid=problem.solid,
        boundary=problem.response.boundary,
        **reached,
        approach=approach,
        certificate=replace(certificate, iterations=state.iterations, pairs=pairs, seconds=seconds),
        control_error=_control_error(
            control, {"area_fraction": area_fraction, "mean_pressure": mean_pressure}
        ),
        method=method,
        rtol=rtol,
    )
    _require_certificate(found, threads)
    return found


def _control_error(control: Control, reached: dict[str, float]) -> float:
    """Relative difference between the imposed quantity and the one that is reached; 0 for an approach."""
    if control.kind == "approach" or control.value == 0:
        return 0.0
    return abs(reached[control.kind] / control.value - 1)


def _require_certificate(contact: Contact, threads: int) -> None:
    """Raise `ConvergenceError` if a field is not finite or the certificate exceeds what the tolerance allows.

    A relative error of the pressure changes the gap by that fraction of the displacement that the pressure
    can cause, which is largest for the longest wave.
    """
    allowed = MAX_VIOLATION * contact.rtol
    if contact.certificate.worst <= allowed:
        return
    finite = is_finite(contact.pressure) and is_finite(contact.gap)
    rms_height = rms_deviation(contact.height, threads)
    if finite and rms_height:
        pressure = contact.pressure.reshape(-1)
        rms_pressure = math.sqrt(kernels.dot(pressure, pressure) / pressure.size)
        longest = float(contact.solid.surface_compliance(2 * np.pi / max(contact.grid.length)))
        allowed *= max(1.0, rms_pressure * longest / rms_height)
        largest = max(float(contact.height.max()), -float(contact.height.min()))
        allowed += MAX_ROUNDINGS * float(np.finfo(contact.pressure.dtype).eps) * largest / rms_height
    if finite and contact.certificate.worst <= allowed:
        return
    raise ConvergenceError(
        f"{contact.method} on {contact.grid.shape} nodes ended with a pressure that "
        + ("violates the conditions of contact" if finite else "is not finite"),
        contact.certificate.worst,
        contact.rtol,
        contact.certificate.iterations,
        contact.mean_pressure,
    )
