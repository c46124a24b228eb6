"""All stages from a map to an answer: read, press, stress, yield, limits of vanishing pixels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from asperity.contact import Contact, solve
from asperity.contact.gap import check_film_grid, percolation
from asperity.contact.solve import FULL_CONTACT, approach_of_full_contact
from asperity.core.arguments import require_finite
from asperity.core.packages import require
from asperity.core.types import FilePath, Progress
from asperity.core.units import shown_si
from asperity.engineering.advice import advise
from asperity.engineering.answer import Answer
from asperity.engineering.body_stress import body_answer, close_ups
from asperity.engineering.case import (
    LARGEST_LOAD,
    Body,
    Case,
    CounterMap,
    HertzPlace,
    Load,
    suggested_hardness,
)
from asperity.engineering.contact_numbers import (
    IN_FULL_CONTACT,
    contact_numbers,
    contact_spots,
    cycle_table,
    flow_of,
    interface_on_half,
    slip_of,
)
from asperity.engineering.continuum import solved_on_half
from asperity.engineering.face import RoughFace, read_face
from asperity.engineering.load_curve import AnswerCurve, largest_von_mises, load_curve, yield_load
from asperity.engineering.moving import MovingContact
from asperity.surface.reading.height_map import HeightMap, MapOptions
from asperity.surface.treatment.treatment import TreatedMap

SMALLEST_APPROACH = 1e-7
"""Least approach over the range of heights; their rounding is 1e-16 of it."""


def run(
    source: FilePath | HeightMap,
    lower: Body,
    upper: Body | None = None,
    *,
    mean_pressure: float | Sequence[float] | None = None,
    force: float | Sequence[float] | None = None,
    approach: float | Sequence[float] | None = None,
    area_fraction: float | Sequence[float] | None = None,
    hertz_pressure: float | Sequence[float] | None = None,
    hertz: HertzPlace | None = None,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
    counter_map: FilePath | HeightMap | CounterMap | None = None,
    map_options: MapOptions | None = None,
    fields: Sequence[str] = ("von_mises",),
    progress: Progress | None = None,
    shifts: int | None = None,
    slide_to_roll: float = 0.0,
    fatigue_scatter: float | None = None,
    fatigue_volume: float | None = None,
    tangential_force: float | None = None,
    tangential_displacement: float | None = None,
    flow_direction: str | None = None,
    viscosity: float | None = None,
    pressure_difference: float | None = None,
) -> Answer:
    """Press a measured surface against a flat or rough body and analyse the stress in every elastic body.

    Exactly one of `mean_pressure`, `force`, `approach`, `area_fraction` and `hertz_pressure` is given.
    Several rising values are a load curve, and the answer is that of the last one. All numbers are in SI
    units.

    Parameters
    ----------
    source : path or HeightMap
        File of a map, or a map in metres.
    lower : Body
    upper : Body, optional
        By default the other body is rigid. The map is that of the lower body, but if the other one is flat
        it does not matter which of the two is rough, as long as the slopes are small.
    mean_pressure : float
        Load over the nominal area, in Pa.
    force : float
        Load on the area of the map, in N.
    approach : float
        Approach of the bodies since their first touch, in m.
    area_fraction : float
        Real over nominal contact area.
    hertz_pressure : float
        Largest pressure of a Hertz contact, in Pa.
    hertz : HertzPlace, optional
        Place of the map in a Hertz contact, whose force or largest pressure is given.
    friction, sliding_direction : float, str or float
        Coefficient and direction of full sliding, for the stress; see `Case`.
    counter_map : path, HeightMap or CounterMap, optional
        Map of the upper body, with its peaks upward as measured. It is turned over and laid on the other one;
        see `CounterMap`.
    map_options : MapOptions, optional
        By default points without data are filled, and a map that is not declared periodic is mirrored. With
        ``periodic="none"`` nothing surrounds the map. `points` counts the points of the map, also if it is
        mirrored.
    fields : names
        Fields of `asperity.stress_planes` whose peaks are listed and that are drawn.
    progress : callable, optional
        Called as progress(done, total).
    shifts, slide_to_roll : int, float
        Motion of two rough faces, or passage through the Hertz contact; see `Case`.
    fatigue_scatter, fatigue_volume : float
        For the probability that no crack starts; see `Case`.
    tangential_force, tangential_displacement : float, optional
        In N or m, for partial slip instead of full sliding; see `Case`.
    flow_direction, viscosity, pressure_difference : str, float, float, optional
        Direction of a leak through the gap, Pa s and Pa; see `Case`.

    Returns
    -------
    Answer

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range or the map cannot be used.
    ConvergenceError
        If the contact does not converge.

    Examples
    --------
    A rough surface of 0.2 mm, made here instead of read from a file, on steel under 50 MPa:

    >>> height = asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    >>> steel = asp.Body(young=210e9, poisson=0.3, yield_stress=1.5e9)
    >>> answer = asp.run(surface, steel, mean_pressure=50e6)
    >>> print(f"real contact {100 * answer.numbers.area_fraction:.1f} % of the area")
    real contact 5.5 % of the area
    >>> lower = answer.bodies["lower"]
    >>> print(f"{lower.largest_von_mises / 1e9:.2f} GPa at a depth of {lower.depth * 1e6:.1f} µm")
    1.58 GPa at a depth of 4.0 µm
    """
    load = Load.chosen(
        mean_pressure=mean_pressure,
        force=force,
        approach=approach,
        area_fraction=area_fraction,
        hertz_pressure=hertz_pressure,
    )
    options = map_options or MapOptions()
    counter = counter_map if isinstance(counter_map, CounterMap | None) else CounterMap(counter_map)
    case = Case(
        *(source, lower, upper, load, friction, sliding_direction, options, counter, fields, hertz),
        *(tangential_force, tangential_displacement, flow_direction, viscosity, pressure_difference),
        *(shifts, slide_to_roll, fatigue_scatter, fatigue_volume),
    )
    return answer_of(case, progress=progress)


def answer_of(case: Case, rough: RoughFace | None = None, progress: Progress | None = None) -> Answer:
    """The answer of a case.

    Parameters
    ----------
    case : Case
    rough : RoughFace, optional
        The result of `read_face` for it; by default it is read here.
    progress : callable, optional
        Called as progress(done, total).

    Raises
    ------
    ValueError, TypeError, ConvergenceError
        As for `run`.
    """
    rough = rough or read_face(case.source, case.options, case.counter_map)
    case, face = replace(case, options=rough.options or case.options), rough.face
    check_cell(case, rough)
    if case.load.kind == "mean_pressure":
        case.check_tangential_force(case.load.value * face.map_area)
    if case.viscosity is not None:
        require(["reynoldsflow"])
        check_film_grid(face.grid)
    contact = press(face, case, _part(progress, 0.1, 0.5))
    slip, flow = slip_of(case, face, contact), flow_of(case, face, contact)
    spots = contact_spots(face, contact)
    numbers = contact_numbers(rough, contact, spots)
    form_repeats = face.boundary == "periodic" and case.options.radius is not None
    half, moving = solved_on_half(contact, slip), moving_contact(case, rough, contact.mean_pressure)
    share, bodies = (0.1 if case.load.path else 0.5) / len(case.different_bodies), {}
    for number, name in enumerate(case.different_bodies):
        begin, near = 0.5 + share * number, close_ups(face, contact, numbers.typical_patch_width)
        bodies[name] = body_answer(
            slip or contact, half, case, name, face, near, _part(progress, begin, begin + share), moving
        )
    answer = Answer(
        case,
        rough,
        contact,
        spots,
        numbers,
        {name: bodies.get(name, bodies["lower"]) for name in case.bodies},
        neighbours_of(face, case, contact) if form_repeats and len(spots) else None,
        plastic_contact(face, case, contact),
        unfiltered=unfiltered_contact(case),
        coarse=interface_on_half(case, face, half),
        paths=None if case.flow_direction is None else percolation(contact),
        flow=flow,
        slip=slip,
        cycle=None if slip is None else cycle_table(slip, face.map_area),
    )
    if case.load.path:
        answer = replace(answer, curve=answer_curve(answer, _part(progress, 0.6, 1.0)))
    rows = (row for row in answer.rows if not row.shown.startswith(IN_FULL_CONTACT))
    values = {f"{row.group}, {row.name}": row.value for row in rows}
    require_finite("run", values)
    if progress is not None:
        progress(1.0, 1.0)
    return replace(answer, advice=advise(answer))


def check_cell(case: Case, rough: RoughFace) -> None:
    """Raise `ValueError` if the Hertz contact of a case is not wider than the map, or shifts are too few."""
    moving_contact(case, rough, 1.0)
    if (contact := case.hertz_contact) is None:
        return
    widths = 2 * contact.half_width_y, 2 * contact.half_width_x
    for axis, width, edge in zip("yx", widths, rough.face.map_length, strict=True):
        if width < edge:
            raise ValueError(
                f"radius: a Hertz contact wider than the map, {shown_si(edge, 'm')} along {axis}, is needed; "
                f"it is {shown_si(width, 'm')} wide under {shown_si(contact.largest_pressure, 'Pa')}. A form "
                "that the map resolves is pressed with boundary = 'free' and a force or pressure"
            )


def moving_contact(case: Case, rough: RoughFace, mean_pressure: float) -> MovingContact | None:
    """The faces of a case as they move against each other; None without shifts."""
    if case.shifts is None:
        return None
    height = rough.face.height
    upper = np.zeros_like(height) if rough.upper is None else rough.upper
    return MovingContact(
        upper - height,
        upper,
        case.solid,
        rough.face.grid.length,
        shifts=case.shifts,
        sliding_direction=case.sliding_direction,
        mean_pressure=mean_pressure if case.hertz is None else None,
        hertz=case.hertz_contact,
        at=(0.0, 0.0) if case.hertz is None else case.hertz.at,
        slide_to_roll=case.slide_to_roll,
        friction=case.friction,
        hardness=case.hardness,
        wavelength_short=rough.face.wavelength_short,
    )


def press(face: TreatedMap, case: Case, progress: Progress | None = None) -> Contact:
    """The contact of the case."""
    load, lowest = case.load, float(face.height.min())
    imposed: dict[str, Any] = {load.kind: load.value}
    if case.hertz is not None:
        imposed = {"mean_pressure": case.cell_pressure}
    elif load.kind == "force":
        imposed = {"mean_pressure": load.value / face.map_area}
        case.check_pressure(imposed["mean_pressure"])
    elif load.kind == "approach":
        least, furthest = SMALLEST_APPROACH * np.ptp(face.height), LARGEST_LOAD * max(face.grid.length)
        if not least < load.value < furthest:
            raise ValueError(
                f"approach = {shown_si(load.value, 'm')}: a length from {shown_si(least, 'm')}, which is "
                f"{SMALLEST_APPROACH:g} of the range of heights, to {shown_si(furthest, 'm')} is needed"
            )
        most = approach_of_full_contact(face.height, case.solid, face.boundary) - lowest
        if load.value >= most:
            accepted = f"less than {shown_si(most, 'm')} is needed, {FULL_CONTACT}"
            raise ValueError(f"approach = {shown_si(load.value, 'm')}: {accepted}")
        imposed = {"approach": lowest + load.value}
    return solve(
        face.height,
        case.solid,
        face.grid.length,
        hardness=case.hardness,
        boundary=face.boundary,
        progress=progress,
        **imposed,
    )


def answer_curve(answer: Answer, progress: Progress) -> AnswerCurve:
    """The load curve of an answer, and the loads where yield begins."""
    case, face = answer.case, answer.face
    path, last = case.load.path, case.load.value

    def contacts() -> Iterator[Contact]:
        for number, load in enumerate(path):
            part = _part(progress, number / len(path), (number + 1) / len(path))
            one = replace(case, load=Load(case.load.kind, load))
            yield answer.contact if load == last else press(face, one, part)

    names = list(case.different_bodies)
    sliding: dict[str, Any] = {"friction": case.friction, "sliding_direction": case.sliding_direction}
    curve = load_curve(contacts(), names, case.resistivities, case.loaded_body, **sliding)
    begins = {}
    for name in names:
        if (limit := case.bodies[name].yield_stress) is not None:

            def stress_under(load: float, name: str = name) -> float:
                under_load = press(face, replace(case, load=Load("mean_pressure", load)))
                return largest_von_mises(case.loaded_body(under_load, name), name, **sliding)

            stresses = curve["largest_von_mises_stress"].sel(body=name).values
            begins[name] = yield_load(curve["mean_pressure"].values, stresses, limit, stress_under)
    lowest = float(answer.contact.height.min())
    return AnswerCurve(curve.assign(approach=curve["approach"] - lowest), begins)


def plastic_contact(face: TreatedMap, case: Case, contact: Contact) -> Contact | None:
    """The contact of a case under its hardness, or under the one that its yield stresses suggest.

    None without a hardness, if the elastic pressure stays below the suggested one, or if the load exceeds it.
    """
    if case.hardness is not None:
        return contact
    hardness = suggested_hardness(case)
    if hardness is None or not contact.mean_pressure < hardness < contact.max_pressure:
        return None
    lower, load = replace(case.lower, hardness=hardness), Load("mean_pressure", contact.mean_pressure)
    return press(
        face, replace(case, lower=lower, load=load, tangential_force=None, tangential_displacement=None)
    )


def unfiltered_contact(case: Case) -> Contact | None:
    """The contact of a case without its Gaussian filters; None if it has none."""
    if case.options.s_filter is None and case.options.l_filter is None:
        return None
    plain = replace(case.options, s_filter=None, l_filter=None)
    return press(read_face(case.source, plain, case.counter_map).face, case)


def neighbours_of(face: TreatedMap, case: Case, contact: Contact) -> tuple[float, Contact | None]:
    """Width of a contact over the distance between its periodic images, and the contact without them.

    None for layers, whose contact cannot be solved without images. The images of a cylinder along its axis
    continue it: its width is taken across the axis, and without images, where it would end, no contact is
    solved.
    """
    widths = np.ptp(np.argwhere(face.part(contact.pressure) > 0), axis=0) + 1
    spans = dict(zip("yx", (widths / face.map_shape).tolist(), strict=True))
    if case.options.form == "cylinder":
        return spans["x" if case.options.cylinder_axis == "y" else "y"], None
    return max(spans.values()), None if case.solid.height is not None else press(face.map_alone(), case)


def _part(progress: Progress | None, begin: float, end: float) -> Progress:
    """Progress of a part of the run."""

    def report(done: float, total: float) -> None:
        if progress is not None:
            progress(begin + (end - begin) * (done / total if total else 1.0), 1.0)

    return report
