"""All stages from a map to an answer: read, press, stress, and what the questions of the case add in each."""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.contact import Contact
from asperity.core.arguments import require_finite
from asperity.core.types import Progress
from asperity.core.units import shown_si
from asperity.engineering.advice import advise
from asperity.engineering.answer import Answer
from asperity.engineering.body_stress import body_answer, close_ups
from asperity.engineering.case import Case
from asperity.engineering.contact_numbers import contact_numbers, contact_spots
from asperity.engineering.continuum import solved_on_half
from asperity.engineering.face import RoughFace, read_face
from asperity.engineering.press import imposed_load, plastic_contact, press
from asperity.engineering.question import IN_FULL_CONTACT
from asperity.settings.load import UNITS
from asperity.settings.model import Problem, SettingsError
from asperity.surface.treatment.treatment import TreatedMap


def run(
    map: Any, body: Any = None, counter_body: Any = None, *, progress: Progress | None = None, **groups: Any
) -> Answer:
    """Press a measured surface against a flat or rough body, and answer the questions of the case.

    Numbers are in SI units; texts have their units.

    Parameters
    ----------
    map : path, HeightMap, mapping or Case
        File of a map, a map in metres, or a group with options of its treatment. By default points without
        data are filled, and a map that is not declared periodic is mirrored. Or a whole case alone.
    body : Body or mapping
    counter_body : Body or mapping, optional
        By default the other body is rigid. Which of the two is rough does not matter, as long as the slopes
        are small.
    progress : callable, optional
        Called as progress(done, total).
    **groups
        The load by its quantity: `mean_pressure`, `force`, `approach` or `area_fraction`, or as the group
        `load`; and all other groups of `asperity.Case`, the questions among them.

    Returns
    -------
    Answer

    Raises
    ------
    SettingsError, MapError
        With everything that is not accepted, or that the map lacks.
    ConvergenceError
        If the contact does not converge.

    Examples
    --------
    A rough surface of 0.2 mm, made here instead of read from a file, on steel under 50 MPa:

    >>> height = asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    >>> steel = asp.Body(young="210 GPa", poisson=0.3, yield_stress="1.5 GPa")
    >>> answer = asp.run(surface, steel, mean_pressure="50 MPa", sliding={"friction": 0.1})
    >>> print(f"real contact {100 * answer.numbers.area_fraction:.1f} % of the area")
    real contact 5.5 % of the area
    """
    if isinstance(map, Case):
        return answer_of(map, progress=progress)
    groups = {name: group for name, group in groups.items() if group is not None}
    imposed = {name: groups.pop(name) for name in UNITS if name in groups}
    groups |= {"load": imposed} if imposed or "load" not in groups else {}
    groups |= {"counter_body": counter_body} if counter_body is not None else {}
    return answer_of(Case(map=map, body=body, **groups), progress=progress)


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
    SettingsError, MapError, ConvergenceError
        As for `run`.
    """
    rough = rough or read_face(case.map, case.counter_map)
    case = case.replaced(map=rough.options or case.map)
    if wrong := problems_on_map(case, rough):
        raise SettingsError("", wrong)
    asked, found = case, {}
    for name, question in case.questions.items():
        case, rough, found[name] = question.before_contact(case, rough, _part(progress, 0.0, 0.1))
    face = rough.face
    contact = press(face, case, _part(progress, 0.1, 0.4))
    spots = contact_spots(face, contact)
    numbers = contact_numbers(rough, contact, spots)
    answer = Answer(asked, case, rough, contact, solved_on_half(contact), spots, numbers, found)
    for name, question in case.questions.items():
        if (result := question.of_contact(answer, _part(progress, 0.45, 0.5))) is not None:
            found[name] = result
    share = (0.1 if case.load_curve else 0.5) / len(case.different_bodies)
    for number, name in enumerate(case.different_bodies):
        _analyse(answer, name, _part(progress, 0.5 + share * number, 0.5 + share * (number + 1)))
    for name in case.bodies:
        answer.bodies.setdefault(name, answer.bodies["lower"])
    for name, question in case.questions.items():
        if (result := question.after_stress(answer, _part(progress, 0.6, 1.0))) is not None:
            found[name] = result
    if face.boundary == "periodic" and case.map.radius is not None and len(spots):
        answer.neighbours = neighbours_of(face, case, contact)
    answer.plastic = plastic_contact(face, case, contact)
    answer.unfiltered = unfiltered_contact(case)
    rows = (row for row in answer.rows if not row.shown.startswith(IN_FULL_CONTACT))
    require_finite("run", {f"{row.group}, {row.name}": row.value for row in rows})
    answer.advice = advise(answer)
    if progress is not None:
        progress(1.0, 1.0)
    return answer


def _analyse(answer: Answer, name: str, progress: Progress) -> None:
    """Add the stress in one body to an answer, and what the questions find in it."""
    questions = answer.case.questions.values()
    loaded, on_half = (answer.loaded_body(each, name) for each in (answer.contact, answer.half.contact))
    watched = [question.watch(answer, name, loaded) for question in questions]
    answer.bodies[name] = body_answer(
        loaded,
        on_half,
        answer,
        name,
        close_ups(answer.face, answer.contact, answer.numbers.typical_patch_width),
        [watch for watch in watched if watch is not None],
        _part(progress, 0.0, 0.8),
    )
    for question in questions:
        question.of_body(answer, name, _part(progress, 0.8, 1.0))


def problems_on_map(case: Case, rough: RoughFace) -> list[Problem]:
    """Settings of a case that do not go with its map."""
    found = [*_outside_hertz(case, rough.face)]
    for question in case.questions.values():
        found += [*question.on_map(case, rough)]
    try:
        imposed_load(rough.face, case)
    except SettingsError as error:
        found += error.found
    return [Problem(*each) for each in found]


def _outside_hertz(case: Case, face: TreatedMap) -> Any:
    """A map that is wider than its Hertz contact."""
    if (contact := case.hertz_contact) is None:
        return
    widths = 2 * contact.half_width_y, 2 * contact.half_width_x
    for axis, width, edge in zip("yx", widths, face.map_length, strict=True):
        if width < edge:
            yield (
                f"load.radius_{axis}",
                (
                    f": a Hertz contact wider than the map, {shown_si(edge, 'm')} along {axis}, is needed; it"
                    f" is {shown_si(width, 'm')} wide under {shown_si(contact.largest_pressure, 'Pa')}. A"
                    " form that the map resolves is pressed with map.radius, map.periodic = none and a force"
                    " or pressure"
                ),
            )


def unfiltered_contact(case: Case) -> Contact | None:
    """The contact of a case without its Gaussian filters; None if it has none."""
    if case.map.s_filter is None and case.map.l_filter is None:
        return None
    plain = case.map.replaced(s_filter=None, l_filter=None)
    return press(read_face(plain, case.counter_map).face, case)


def neighbours_of(face: TreatedMap, case: Case, contact: Contact) -> tuple[float, Contact | None]:
    """Width of a contact over the distance between its periodic images, and the contact without them.

    None for layers, whose contact cannot be solved without images. The images of a cylinder along its axis
    continue it: its width is taken across the axis, and without images, where it would end, no contact is
    solved.
    """
    widths = np.ptp(np.argwhere(face.part(contact.pressure) > 0), axis=0) + 1
    spans = dict(zip("yx", (widths / face.map_shape).tolist(), strict=True))
    if case.map.form == "cylinder":
        return spans["x" if case.map.cylinder_axis == "y" else "y"], None
    return max(spans.values()), None if case.solid.height is not None else press(face.map_alone(), case)


def _part(progress: Progress | None, begin: float, end: float) -> Progress:
    """Progress of a part of the run."""

    def report(done: float, total: float) -> None:
        if progress is not None:
            progress(begin + (end - begin) * (done / total if total else 1.0), 1.0)

    return report
