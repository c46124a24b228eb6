"""Solution of contact problems: checks the arguments, chooses the method, and certifies the result."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from inspect import unwrap
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from asperity.contact import active_set, gfmd
from asperity.contact import adhesion as adhesive
from asperity.contact.adhesion import Adhesion
from asperity.contact.certificate import (
    certificate_with_adhesion,
    checked_certificate,
    field_in_double,
    rms_deviation,
    verify_contact,
)
from asperity.contact.problem import Control, Problem, State, Units
from asperity.contact.response import checked_boundary, response_on
from asperity.contact.solution import Contact
from asperity.core.arguments import (
    LARGEST,
    SMALLEST,
    choice,
    finite_array,
    is_finite,
    number,
    own_errors,
    require_finite,
    thread_count,
)
from asperity.core.compiled import compiled
from asperity.core.errors import ConvergenceError, did_you_mean, shown
from asperity.core.parallel import in_strips, map_parts
from asperity.core.types import Array, ArrayLike, DTypeLike, Progress
from asperity.elasticity.solid import SMALLEST_IN_PASCAL, Solid
from asperity.elasticity.two_bodies import Solids, TwoBodies
from asperity.fourier.grid import Boundary, Edges, Grid, real_type, with_mirror_images

METHODS = {"active_set": active_set.solve, "gfmd": gfmd.solve}

FULL_CONTACT = (
    "the height of the mean plane above the point that touches first; there a periodic half-space is in full "
    "contact"
)
"""Limit of the approach since first touch of a solid without uniform displacement."""

# Random surfaces of 3 × 200, 64² and 200 × 3 nodes in contact on 1 to 50 % are solved up to this ratio, in at
# most 10,000 iterations; with a ratio of 1000 some are not.
MAX_SPACING_RATIO = 300.0

_LEAST_LOAD, _LARGEST_LOAD = 1e-150, 1e150
_LOAD = (
    f"0 or a number from {_LEAST_LOAD:g} to {_LARGEST_LOAD:g}",
    lambda value: value == 0 or _LEAST_LOAD <= value <= _LARGEST_LOAD,
)
_CONTROLS: dict[str, tuple[str, Callable[[float], bool]]] = {
    "contact_area_fraction": ("a number > 0 and ≤ 1", lambda value: 0 < value <= 1),
    "mean_pressure": _LOAD,
    "force": _LOAD,
    "approach": (f"a number from {-LARGEST:g} to {LARGEST:g}", lambda value: abs(value) <= LARGEST),
}


@own_errors
def solve_contact(
    height: ArrayLike,
    solid: Solids,
    length: Edges | None = None,
    *,
    contact_area_fraction: float | None = None,
    mean_pressure: float | None = None,
    force: float | None = None,
    approach: float | None = None,
    hardness: float | None = None,
    adhesion: Adhesion | None = None,
    boundary: Boundary | None = None,
    method: str = "active_set",
    rtol: float = 1e-6,
    dtype: DTypeLike = "float64",
    threads: int = 1,
    progress: Progress | None = None,
    initial: Contact | ArrayLike | None = None,
) -> Contact:
    """Press a rough surface against an elastic solid: a rigid one, or one of two elastic bodies.

    Exactly one of `contact_area_fraction`, `mean_pressure`, `force` and `approach` is given.

    Parameters
    ----------
    height : (ny, nx) array, or map
        Lower face of the indenter, measured upward, in the unit of `length`; for two bodies the lower face of
        the upper one less the upper face of the lower one. Or a map as `asperity.prepare_map` returns it,
        which has its grid and boundary.
    solid : Solid or TwoBodies
        One elastic solid under a rigid indenter, or two elastic bodies.
    length : float or (length_y, length_x), optional
        Edges of the map, number of nodes × spacing, and of the cell if it repeats; needed with an array in SI
        units, else 1 by default. A map that its mirror
        images continue needs ``asp.Grid(shape, length, mirrored=True)``: its three images are in contact,
        too.
    contact_area_fraction : float
        Contact nodes over all nodes, met to a relative error of 1e-4, or to the nearest number of nodes
        that the surface allows.
    mean_pressure : float
        Load over the area of the map, in the unit of Young's modulus.
    force : float
        Mean pressure times the area of the map.
    approach : float
        Position δ of the indenter, in the unit of `length`: depth of its plane of height 0 below the
        undeformed surface. It first touches at ``height.min()``, and ``approach - height.min()`` is the
        approach since first touch. With a free boundary the undeformed surface is the solid's surface far
        from the map; for a periodic solid without uniform displacement, such as a half-space, the depth is
        measured from the mean plane of its deformed surface instead. Where the map ends along one axis alone
        the displacement has no limit far away: the depth is measured from the surface beside a line of load,
        at a distance of the edge of the map along that axis.
    hardness : float, optional
        Maximum pressure that the softer surface bears, in the unit of Young's modulus. Where it is reached
        that surface is flattened by the depth of the overlap. By default, and if it is infinite, the contact
        is elastic everywhere. Needs method "active_set".
    adhesion : Adhesion, optional
        Attraction of the faces, whose cohesive zone the grid has to resolve; see
        `asperity.contact.adhesion`. Of several contacts it finds the one of first approach, or with
        `initial` the one that follows from that contact.
    boundary : "periodic" | "free" | (str, str), optional
        By default that of a map, and "periodic" for an array. "periodic": the map, or the map with its mirror
        images, repeats in both directions. "free": nothing surrounds the map, whose solid is a half-space, or
        each of two bodies is one; each node is a rectangle under uniform pressure. ("periodic", "free"): the
        map repeats along y, mirrored if its grid is, and ends along x, as a roller whose axis is y;
        ("free", "periodic"): with the axis x.
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
        A pressure to start from; with adhesion a Contact with adhesion, which is then a part of the path.

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

    >>> steel = asp.Solid(young=210e9, poisson=0.3)  # Pa
    >>> height = asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)  # m
    >>> contact = asp.solve_contact(height, steel, length=2e-4, mean_pressure=20e6)
    >>> print(f"area {contact.contact_area_fraction:.3f}, at most {contact.maximum_pressure / 1e9:.2f} GPa")
    area 0.024, at most 1.91 GPa

    >>> ball = asp.surface.add_sphere(np.zeros((64, 64)), 3e-4, radius=10e-3)
    >>> contact = asp.solve_contact(ball, steel, 3e-4, force=20.0, boundary="free")
    >>> hertz = (6 * 20.0 * steel.effective_modulus**2 / (np.pi**3 * 10e-3**2)) ** (1 / 3)
    >>> bool(abs(contact.maximum_pressure / hertz - 1) < 0.01)
    True
    """
    begin = time.perf_counter()
    if dtype is None:
        raise ValueError("dtype = None: float64 or float32 is needed")
    precision = real_type(dtype)
    rtol = number("rtol", rtol, "a number between 0 and 1", lambda value: 0 < value < 1)
    threads = thread_count(threads)
    if not isinstance(solid, (Solid, TwoBodies)):
        raise TypeError(f"solid = {shown(solid)}: a Solid or TwoBodies is needed")
    height, length, boundary = _on_grid(height, solid, length, boundary)
    values = _checked_height(height)
    boundary, grid = checked_boundary(boundary, solid, Grid(values.shape, length))  # type: ignore[arg-type]
    narrow = max(grid.spacing) / min(grid.spacing)
    if boundary == "periodic" and min(grid.shape) > 1 and narrow > MAX_SPACING_RATIO:
        raise ValueError(
            f"length = {shown(grid.length)}: spacings of the nodes that differ by a factor of at most "
            f"{MAX_SPACING_RATIO:g} are needed in a periodic cell, and here by {narrow:.3g}: waves along the "
            "longer ones are so much softer that rounding hides the others; resample the heights"
        )
    choice("method", method, tuple(METHODS))
    imposed: dict[str, Any] = {
        "contact_area_fraction": contact_area_fraction,
        "mean_pressure": mean_pressure,
        "force": force,
        "approach": approach,
    }
    settings: dict[str, Any] = {"boundary": boundary, "rtol": rtol, "dtype": dtype, "threads": threads}
    control = _checked_control(*_only_one(imposed), grid)
    limit = np.inf if hardness is None else _checked_hardness(hardness, control)
    hardness = None if limit == np.inf else limit
    if method == "gfmd" and hardness is not None:
        raise ValueError(f"method = 'gfmd': active_set is needed with hardness = {shown(hardness)}")
    if method == "gfmd" and boundary != "periodic":
        raise ValueError(f"method = 'gfmd': active_set is needed for boundary = {boundary!r}")
    if adhesion is not None:
        _check_adhesion(adhesion, control, method, precision, solid, grid)
    if isinstance(grid.mirrored, tuple):
        whole = partial(with_mirror_images, grid=grid)
        if initial is not None:
            given = initial.pressure if isinstance(initial, Contact) else initial
            initial = whole(grid.field("initial", given))
        settings |= imposed | {"force": None if force is None else 2 * force}
        settings |= {"hardness": hardness, "adhesion": adhesion, "initial": initial, "progress": progress}
        return _of_map(solve_contact(whole(values), solid, grid.whole_cell, **settings), grid)
    solid_units = Units.of_solid(solid, grid)
    solid_and_grid = solid_units.solid(solid), solid_units.grid(grid)
    response = response_on(boundary, *solid_and_grid, precision, threads, control.fixes_load)
    most = approach_of_full_contact(values, solid, boundary)
    if control.kind == "approach" and control.value >= most:
        most = most if abs(most) > 1e-12 * np.ptp(values) else 0.0
        raise ValueError(
            f"approach = {shown(control.value)}: less than {most:.6g}, the mean height, is needed, where a "
            "periodic half-space is in full contact; impose a mean pressure in place of the approach"
        )
    units = solid_units.for_problem(values, control, limit, response)
    if method == "gfmd":  # whose time step depends on the heights out of reach
        units = replace(units, below=np.inf, above=np.inf)
    if adhesion is not None:
        units = solid_units.for_adhesion(values, adhesion.range)
        problem = Problem(units.heights(values), response, limit / units.stress)
        asked = _Asked(grid, solid, method, control.value if approach is not None else None, rtol, begin)
        try:
            return _adhesive_contact(problem, adhesion, control, values, units, asked, progress, initial)
        except ConvergenceError as error:
            raise error.in_units(units.stress) from None
    scaled = units.control(control)
    start = None
    if initial is not None:
        start = grid.field("initial", initial.pressure if isinstance(initial, Contact) else initial)
        start = start.astype(float) / units.stress
    # A given start may overflow: the result is checked in the end.
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        problem, state = Problem(units.heights(values), response, limit / units.stress), None
        try:
            try:
                state = _state_of(problem, scaled, method, rtol, progress, start)
            except ConvergenceError:
                if precision == np.float64 or rtol < np.finfo(precision).eps:
                    raise
            # Not in the block above, so that the fields of the first attempt are released.
            if state is None:
                double = response.in_precision("float64")
                exact = Problem(units.heights(values), double, limit / units.stress, problem.plastic)
                state = _state_of(exact, scaled, method, rtol, progress, start)
                state = replace(state, pressure=state.pressure.astype(precision), displacement=None)
            reached = None if approach is None else control.value
            asked = _Asked(grid, solid, method, reached, rtol, begin)
            contact = _contact_of(problem, scaled, state, values, units, asked)
        except ConvergenceError as error:
            raise error.in_units(units.stress) from None
    met_hardness = hardness is not None and (
        problem.plastic.is_set() or units != solid_units.for_problem(values, control, np.inf, response)
    )
    if met_hardness and contact.maximum_pressure < contact.hardness:
        # An earlier iterate was plastic: the solution without a hardness has other rounding errors.
        elastic = solve_contact(values, solid, grid, initial=initial, **imposed, **settings)
        if elastic.maximum_pressure <= limit:
            return replace(elastic, hardness=contact.hardness, plastic_depth=np.zeros_like(elastic.gap))
    return contact


def _on_grid(
    height: Any, solid: Any, length: Edges | None, boundary: Boundary | None
) -> tuple[Any, Edges, Boundary]:
    """Heights, edges and boundary, which a map has, and an array has not."""
    if hasattr(height, "height") and hasattr(height, "grid"):
        if length is not None:
            raise ValueError(f"length = {shown(length)}: not accepted with a map, which has its grid")
        own = getattr(height, "boundary", "periodic")
        return height.height, height.grid, own if boundary is None else boundary
    if length is None and getattr(solid, "effective_modulus", 0.0) >= SMALLEST_IN_PASCAL:
        raise ValueError("length: the edges of the map in m are needed with an array of heights")
    length = 1.0 if length is None else length
    return height, length, "periodic" if boundary is None else boundary


def _check_adhesion(
    adhesion: Adhesion, control: Control, method: str, precision: np.dtype[Any], solid: Solids, grid: Grid
) -> None:
    """Raise an error for what adhesion excludes."""
    if not isinstance(adhesion, Adhesion):
        raise TypeError(f"adhesion = {shown(adhesion)}: an Adhesion is needed")
    if control.kind == "contact_area_fraction":
        raise ValueError(
            "contact_area_fraction: an approach, a force or a mean_pressure is needed with adhesion"
        )
    if method != "active_set":
        raise ValueError(f"method = {method!r}: active_set is needed with adhesion")
    if precision != np.float64:
        raise ValueError(f"dtype = {precision.name!r}: float64 is needed with adhesion")
    adhesion.check_resolved(solid, grid)


def _adhesive_contact(
    problem: Problem,
    adhesion: Adhesion,
    control: Control,
    values: Array,
    units: Units,
    asked: _Asked,
    progress: Progress | None,
    initial: Contact | ArrayLike | None,
) -> Contact:
    """The certified contact with adhesion, in the units of the caller."""
    start, response, hardness = None, problem.response, problem.hardness * units.stress
    if isinstance(initial, Contact) and initial.attraction is not None:
        fields = initial.pressure + initial.attraction, initial.attraction
        reaction, attraction = (asked.grid.field("initial", each) / units.stress for each in fields)
        start = np.maximum(reaction, 0), attraction
    law, scaled = adhesion.in_units(units.height, units.stress), units.control(control)
    found, stability = adhesive.solve(problem, law, scaled, asked.rtol, progress, start)
    pulling, pulled = found.attraction * units.stress, found.pulled * units.height
    mean = float(found.attraction.mean())
    if scaled.kind == "mean_pressure":
        scaled = replace(scaled, value=scaled.value + mean)
    contact = _contact_of(found.problem, scaled, found.state, values - pulled, units, asked)
    pressure = contact.pressure - pulling
    if hardness < np.inf:
        pressure[contact.pressure >= contact.hardness] = hardness
    mean *= response.omitted_compliance * units.height
    flat = contact.gap if contact.plastic_depth is None else contact.gap - contact.plastic_depth
    scales = rms_deviation(values), min(asked.grid.spacing) / asked.solid.effective_modulus
    certificate = replace(
        certificate_with_adhesion(pressure, flat, adhesion, *scales, None, hardness),
        stability=stability,
        iterations=contact.certificate.iterations,
        pairs=contact.certificate.pairs,
        seconds=contact.certificate.seconds,
    )
    return replace(
        contact,
        height=values,
        pressure=pressure,
        displacement=contact.displacement - pulled - mean,
        mean_pressure=float(pressure.mean()),
        approach=contact.approach - mean if asked.approach is None else asked.approach,
        certificate=certificate,
        hardness=hardness,
        adhesion=adhesion,
        attraction=pulling,
    )


def solve_load_path(
    height: ArrayLike,
    solid: Solids,
    length: Edges | None = None,
    *,
    contact_area_fractions: Sequence[float] | None = None,
    mean_pressures: Sequence[float] | None = None,
    forces: Sequence[float] | None = None,
    approaches: Sequence[float] | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> Iterator[Contact]:
    """Solve for one load after the other, each when it is asked for.

    Parameters
    ----------
    height, solid, length
        As for `solve_contact`.
    contact_area_fractions, mean_pressures, forces, approaches : sequence of float
        Exactly one of them. With a hardness they rise: each contact is a first loading. With adhesion they
        may rise and fall: each contact follows from the last one, and with a hardness, too, the surface that
        was flattened there is pressed.
    progress : callable, optional
        Called as progress(done, total), in loads.
    **settings
        Passed to `solve_contact`.

    Yields
    ------
    Contact

    Raises
    ------
    ValueError
        If the values fall, and there is a hardness. A flattened surface unloads elastically:
        `asperity.Contact.flattened_height` without a hardness is pressed under the smaller loads.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> solid = asp.Solid(young=1.0, poisson=0.3)
    >>> for contact in asp.solve_load_path(height, solid, mean_pressures=[1e-4, 2e-4, 4e-4]):
    ...     print(f"load {contact.mean_pressure:.0e}, area {contact.contact_area_fraction:.3f}")
    load 1e-04, area 0.016
    load 2e-04, area 0.026
    load 4e-04, area 0.050
    """
    paths = {
        "contact_area_fractions": contact_area_fractions,
        "mean_pressures": mean_pressures,
        "forces": forces,
        "approaches": approaches,
    }
    name, values = _only_one(paths)
    kind = dict(zip(paths, _CONTROLS, strict=True))[name]
    known = unwrap(solve_contact).__kwdefaults__ or {}
    for unknown in (word for word in settings if word not in known):
        raise TypeError(f"{unknown}: not an argument of solve_load_path{did_you_mean(unknown, known)}")
    if not isinstance(values, Iterable):
        raise TypeError(f"{name} = {shown(values)}: a list of loads is needed")
    values, hardness = list(values), settings.get("hardness")
    height, length, settings["boundary"] = _on_grid(height, solid, length, settings.get("boundary"))
    grid = Grid(_checked_height(height).shape, length)  # type: ignore[arg-type]
    for value in values:  # all of them before the first is solved
        control = _checked_control(kind, value, grid)
        if hardness is not None:
            _checked_hardness(hardness, control)
    rises = not any(later < earlier for earlier, later in pairwise(values))
    if hardness is not None and settings.get("adhesion") is None and not rises:
        raise ValueError(
            f"{name} = {shown(values)}: rising values are needed with a hardness, because a flattened "
            "surface unloads elastically; press contact.flattened_height() without a hardness to unload"
        )
    return _solve_each(height, {"solid": solid, "length": length, **settings}, kind, values, progress)


def _solve_each(
    height: ArrayLike,
    settings: Mapping[str, Any],
    kind: str,
    values: Sequence[float],
    progress: Progress | None,
) -> Iterator[Contact]:
    """Contacts under loads; with adhesion each follows from the last one, and from its flattened surface."""
    report, own = progress or (lambda done, total: None), dict[str, Any]()
    for index, value in enumerate(values):
        told = partial(_report_part, report, index, len(values))
        contact = solve_contact(height, **{**settings, **own, kind: value}, progress=told)
        if contact.adhesion is not None:
            own, height = {"initial": contact}, contact.flattened_height()
        yield contact
        report(index + 1, len(values))


def _report_part(report: Progress, index: int, of: int, done: float, total: float) -> None:
    """Report the progress of one of several solutions."""
    report(index + done / total, of)


# Arguments


def _checked_height(height: ArrayLike) -> Array:
    """Return the surface as a real array [y, x] of finite numbers."""
    values = field_in_double("height", finite_array("height", height))
    # The difference in one row suffices, and takes a fraction of the time.
    if np.ptp(values[0]) < SMALLEST and 0 < (difference := float(np.ptp(values))) < SMALLEST:
        raise ValueError(
            f"height: heights that differ by {SMALLEST:g} or more, or not at all, are needed; they differ by "
            f"{difference:.3g}"
        )
    return values


def _only_one(imposed: Mapping[str, Any]) -> tuple[str, Any]:
    """Return name and value of the one argument that is given."""
    given = {name: value for name, value in imposed.items() if value is not None}
    if len(given) != 1:
        raise ValueError(
            f"exactly one of {', '.join(imposed)} is needed, got {', '.join(given) if given else 'none'}"
        )
    return next(iter(given.items()))


def _checked_control(kind: str, value: Any, grid: Grid) -> Control:
    """Return the imposed quantity, within its range; a force as the mean pressure it causes."""
    value = number(kind, value, *_CONTROLS[kind])
    return Control("mean_pressure", value / grid.area) if kind == "force" else Control(kind, value)


def _checked_hardness(hardness: float, control: Control) -> float:
    """Return the hardness, above an imposed mean pressure."""
    if isinstance(hardness, float) and hardness == np.inf:
        return np.inf
    accepted = f"a number > 0, from {SMALLEST:g} to {LARGEST:g}, or inf for an elastic contact,"
    value = number("hardness", hardness, accepted, lambda value: SMALLEST <= value <= LARGEST)
    if control.kind == "mean_pressure" and control.value >= value:
        raise ValueError(
            f"hardness = {shown(hardness)}: more than the mean pressure {control.value:.6g} is needed"
        )
    return value


def approach_of_full_contact(height: Array, solid: Solids, boundary: str = "periodic") -> float:
    """Mean height, out of reach of a periodic solid without uniform displacement; infinite for others."""
    has_limit = boundary == "periodic" and solid.uniform_compliance() == 0
    return float(height.mean()) if has_limit else np.inf


# The solution in its own units


def _state_of(
    problem: Problem,
    control: Control,
    method: str,
    rtol: float,
    progress: Progress | None,
    initial: Array | None,
) -> State:
    """The state under a load; an imposed area includes at least the lowest nodes, which touch together."""
    if control.kind == "approach" and control.value <= (lowest := problem.lowest):
        return State(np.zeros_like(problem.height), control.value, 0.0)
    if control.kind == "mean_pressure" and control.value == 0:
        return State(np.zeros_like(problem.height), problem.lowest, 0.0)
    if control.kind == "contact_area_fraction":
        lowest, size = problem.lowest, problem.grid.size
        together = np.count_nonzero(problem.height == lowest) / size
        control = replace(control, value=max(control.value, together))
        if round(control.value * size) == size and problem.response.repeats and together < 1:
            full = problem.full_contact()
            if (largest := float(full.pressure.max())) > problem.hardness:
                raise ValueError(
                    f"contact_area_fraction = {control.value:g}: less is needed, because full contact takes "
                    f"{largest / problem.hardness:.4g} times the hardness"
                )
            return full
    if (load := _load_beyond_full_contact(problem, control)) is not None:
        # The mean pressure may be far larger than its differences, which are then below a tolerance.
        full = problem.full_contact(load)
        if full.pressure.min() > 0 and full.pressure.max() < problem.hardness:
            return full
    start = None if initial is None else problem.near_start(control, initial)
    return METHODS[method](problem, control, rtol, progress, start)


class _Asked(NamedTuple):
    """Arguments of the call that a contact states, in the units of the caller, and the time of its start."""

    grid: Grid
    solid: Solids
    method: str
    approach: float | None
    rtol: float
    begin: float


def _load_beyond_full_contact(problem: Problem, control: Control) -> float | None:
    """Mean pressure that displaces the longest wave by the rms height or more; None if it is smaller."""
    response, load = problem.response, control.value
    if not response.repeats or control.kind == "contact_area_fraction":
        return None
    if control.kind == "approach":
        if response.uniform_compliance == 0:
            return None
        load = (load - float(problem.height.mean(dtype=float))) / response.uniform_compliance
    largest = response.largest_compliance
    return load if load * largest >= rms_deviation(problem.height, problem.fourier.threads) else None


def _contact_of(
    problem: Problem, control: Control, state: State, values: Array, units: Units, asked: _Asked
) -> Contact:
    """The certified contact in the units of the caller; an error if the certificate is not fulfilled."""
    response, threads, hardness = problem.response, problem.fourier.threads, problem.hardness
    displacement = state.displacement
    if displacement is None:
        displacement = response.displacement(state.pressure)
    response.release()
    fields = (field.reshape(-1) for field in (state.pressure, problem.height, displacement))
    parts = map_parts(_levels_of_contact, threads, *fields, problem.fourier.real.type(hardness))
    total_level, elastic, nodes, total_pressure, squares = (sum(part[i] for part in parts) for i in range(5))
    mean_pressure, approach = total_pressure / problem.grid.size, state.approach
    if control.kind != "approach" and elastic:
        approach = total_level / elastic
    # Problem and state are not needed any more. New arrays in place of their arrays would raise the peak of
    # the memory of `solve_contact` on 2048² nodes from 0.51 to 0.57 GB.
    gap, exact_gap = _gap_of(problem, state.pressure, displacement, approach)
    norm, largest = math.sqrt(squares), max(part[5] for part in parts)
    load = state.load if control.kind == "mean_pressure" else None
    rms_height = rms_deviation(values, threads) / units.height
    certificate = replace(
        checked_certificate(problem, state, exact_gap, load, rms_height, norm, largest, asked.rtol),
        pairs=response.fourier.work.pairs(asked.grid),
        seconds=time.perf_counter() - asked.begin,
    )
    mean = response.omitted_compliance * state.load if response.omits_mean else 0.0
    if mean:
        displacement = displacement + displacement.dtype.type(mean)
    plastic = state.pressure >= hardness if hardness < np.inf else None
    state.pressure[:] *= state.pressure.dtype.type(units.stress)
    for field in (displacement, gap):
        field *= field.dtype.type(units.height)
    clipped = units.clipped_by(values)
    if clipped is not None:
        gap += clipped.astype(gap.dtype, copy=False)
    plastic_depth = None
    if plastic is not None:
        plastic_depth = np.where(plastic, np.maximum(-gap, 0), 0)
        gap += plastic_depth
    contact = Contact(
        height=values.astype(gap.dtype, copy=False),
        pressure=state.pressure,
        displacement=displacement,
        gap=gap,
        grid=asked.grid,
        solid=asked.solid,
        boundary=response.boundary,
        contact_area_fraction=nodes / problem.grid.size,
        mean_pressure=mean_pressure * units.stress,
        approach=(approach + mean) * units.height + units.datum if asked.approach is None else asked.approach,
        certificate=certificate,
        control_error=_control_error(control, nodes / problem.grid.size, mean_pressure),
        method=asked.method,
        rtol=asked.rtol,
        hardness=hardness * units.stress,
        plastic_depth=plastic_depth,
    )
    _require_held(contact, units, nodes)
    return contact


def _of_map(contact: Contact, grid: Grid) -> Contact:
    """The contact of a map from that of the map and its mirror images along one axis."""
    changes: dict[str, Any] = {
        name: values[grid.map].copy()
        for name, values in vars(contact).items()
        if isinstance(values, np.ndarray)
    }
    changes["mean_pressure"] = float(changes["pressure"].mean(dtype=float))
    found = replace(contact, grid=grid, **changes)
    # The halves of the cell agree to the tolerance alone: the violations are those of the map's own half.
    conditions: dict[str, Any] = {name: getattr(found, name) for name in ("approach", "adhesion")}
    conditions |= {"mean_pressure": found.mean_pressure, "boundary": found.boundary}
    conditions["hardness"] = None if found.hardness == np.inf else found.hardness
    anew = verify_contact(found.height, found.pressure, found.solid, grid, **conditions)
    kept = ("load_imbalance", "iterations", "seconds", "stability")
    solved = {name: getattr(found.certificate, name) for name in kept}
    certificate = replace(anew, **solved)
    area = np.count_nonzero(found.touching) / grid.size
    return replace(found, contact_area_fraction=area, certificate=certificate)


def _gap_of(problem: Problem, pressure: Array, displacement: Array, approach: float) -> tuple[Array, Array]:
    """The gap, in place of the height of a problem, and the gap in double precision."""
    response, gap, exact = problem.response, problem.height, None
    if gap.dtype == np.float32:
        exact = response.in_precision("float64").displacement(pressure.astype(float))
        exact += gap
        exact -= approach
    level = gap.dtype.type(approach)

    def write_gap(rows: slice) -> None:
        gap[rows] += displacement[rows]
        gap[rows] -= level

    in_strips(write_gap, gap.shape, problem.fourier.threads)
    return gap, gap if exact is None else exact


def _control_error(imposed: Control, contact_area_fraction: float, mean_pressure: float) -> float:
    """Relative difference between the imposed and the reached load or area."""
    reached = {"contact_area_fraction": contact_area_fraction, "mean_pressure": mean_pressure}
    if imposed.kind not in reached or imposed.value == 0:
        return 0.0
    return abs(reached[imposed.kind] / imposed.value - 1)


def _require_held(contact: Contact, units: Units, nodes: int) -> None:
    """Require that a result is finite, and that its precision holds it in the units given."""
    held, names = True, ["mean_pressure", "approach", "contact_area_fraction", "control_error"]
    if not all(2.0**-60 < unit < 2.0**60 for unit in (units.height, units.stress)):
        held = np.count_nonzero(contact.pressure) == nodes and is_finite(contact.pressure)
        names += ["pressure", "displacement", "gap"]
    if not held or (contact.height.dtype == np.float32 and not is_finite(contact.height)):
        precision = contact.pressure.dtype
        other = "float64 or other units" if precision == np.float32 else "other units"
        raise ValueError(
            f"dtype = {precision.name!r}: cannot hold heights of about {units.height:.0e} and pressures of "
            f"about {units.stress:.0e}; {other} are needed"
        )
    require_finite("solve", {name: getattr(contact, name) for name in names})


@compiled
def _levels_of_contact(
    pressure: Any, height: Any, displacement: Any, hardness: Any
) -> tuple[float, int, int, float, float, float]:
    """Σ (h + u) of elastic nodes, their number, and that of contact nodes, Σ p, Σ p², largest |h| + |u|."""
    total_level, elastic, count, total, squares, largest = 0.0, 0, 0, 0.0, 0.0, 0.0
    for i in range(pressure.size):
        total += np.float64(pressure[i])
        squares += np.float64(pressure[i]) ** 2
        if pressure[i] > 0:
            count += 1
            largest = max(largest, np.float64(abs(height[i]) + abs(displacement[i])))
            if pressure[i] < hardness:
                total_level += np.float64(height[i] + displacement[i])
                elastic += 1
    return total_level, elastic, count, total, squares, largest
