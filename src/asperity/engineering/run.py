"""All stages from a map to an answer: read, press, stress, and the additions of the questions to each."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from asperity.contact import Contact
from asperity.core.arguments import own_errors, require_finite
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
from asperity.surface.reading.height_map import HeightMap
from asperity.surface.treatment.treatment import TreatedMap

SEPARATE_SHARE = 0.4
"""Edge of a map over the smaller width of its Hertz contact up to which the pressure of the contact changes
by less than a tenth over the map."""


@own_errors
def run(
    map: Any, body: Any = None, counter_body: Any = None, *, progress: Progress | None = None, **groups: Any
) -> Answer:
    """Press a measured surface against a flat or rough body, and answer the questions of the case.

    Numbers are in SI units; texts have their units.

    Parameters
    ----------
    map : path, HeightMap, array, mapping or Case
        File of a map, a map in metres, or a group with options of its treatment. An array of heights in
        metres, peaks upward, needs `length`, its edges (y, x), as a keyword or beside `file` in the group. By
        default points without data are filled, and a map that is not declared periodic is mirrored. Or a
        whole case alone.
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
    map = _with_heights(map, groups.pop("length", None))
    groups = {name: group for name, group in groups.items() if group is not None}
    imposed = {name: groups.pop(name) for name in UNITS if name in groups}
    groups |= {"load": imposed} if imposed or "load" not in groups else {}
    groups |= {"counter_body": counter_body} if counter_body is not None else {}
    return answer_of(Case(map=map, body=body, **groups), progress=progress)


def _with_heights(map: Any, length: Any) -> Any:
    """A map, or its group, with heights of an array as a `HeightMap`."""
    group = dict(map) if isinstance(map, Mapping) else {"file": map}
    source, length = group.get("file"), group.pop("length", length)
    if isinstance(source, (np.ndarray, list, tuple)):
        if length is None:
            raise ValueError("length: the edges (y, x) of the map in m are needed with an array of heights")
        group["file"] = HeightMap(source, length, unit="m", name="map")  # type: ignore[arg-type]
    elif length is not None:
        raise ValueError("length: not accepted with a file or a HeightMap, which have their own")
    else:
        return map
    return group


def answer_of(
    case: Case,
    rough: RoughFace | None = None,
    progress: Progress | None = None,
    on_stage: Callable[[str], None] | None = None,
) -> Answer:
    """The answer of a case.

    Parameters
    ----------
    case : Case
    rough : RoughFace, optional
        The result of `read_face` for it; by default it is read here.
    progress : callable, optional
        Called as progress(done, total).
    on_stage : callable, optional
        Called with the name of each stage, a key of `work_of`, when it begins.

    Raises
    ------
    SettingsError, MapError, ConvergenceError
        As for `run`.
    """
    rough = rough or read_face(case.map, case.counter_map)
    case = case.on_face(rough)
    if wrong := problems_on_map(case, rough):
        raise SettingsError("", wrong)
    asked, found = case, {}
    part = _Parts(progress, work_of(case, rough.face.grid.mirrored), on_stage)
    for name, question in case.questions.items():
        case, rough, found[name] = question.before_contact(case, rough, part.next(f"before {name}"))
    face = rough.face
    contact = press(face, case, part.next("contact"))
    spots = contact_spots(face, contact)
    numbers = contact_numbers(rough, contact, spots)
    part.next("half of the nodes")
    answer = Answer(asked, case, rough, contact, solved_on_half(contact), spots, numbers, found)
    for name, question in case.questions.items():
        if (result := question.of_contact(answer, part.next(name))) is not None:
            found[name] = result
    for name in case.different_bodies:
        _analyse(answer, name, part.next(f"stress {name}"))
    for name in case.bodies:
        answer.bodies.setdefault(name, answer.bodies["lower"])
    for name, question in case.questions.items():
        if (result := question.after_stress(answer, part.next(f"after {name}"))) is not None:
            found[name] = result
    part.next("comparisons")
    if face.boundary == "periodic" and case.map.radius is not None and len(spots):
        answer.neighbours = neighbours_of(face, case, contact)
    answer.plastic = plastic_contact(face, case, contact)
    answer.unfiltered = None if rough.unfiltered is None else press(rough.unfiltered, case)
    for name, question in asked.questions.items():
        if others := question.other_cases(asked):
            answers = {key: answer_of(other) for key, other in others.items()}
            found[name] = question.of_other_cases(answer, answers)
    rows = (row for row in answer.rows if not row.shown.startswith(IN_FULL_CONTACT))
    require_finite("run", {f"{row.group}, {row.name}": row.value for row in rows})
    answer.advice = advise(answer)
    if progress is not None:
        progress(1.0, 1.0)
    return answer


STRESS, SLIP, FLOW = 2.0, 4.0, 2.0
"""Work of the stress in a body, of partial slip and of the flow of a film; the contact has a work of 1."""


def work_of(case: Case, is_mirrored: bool = False) -> dict[str, float]:
    """Stages of the answer of a case → their work; the contact has a work of 1.

    The contact takes about equal time at all loads but the largest. The work of a stage is known to a factor
    of two: the numbers serve for the progress and for estimates of time. Of a mirrored map, moving faces need
    the cell of four images.
    """
    bodies, cycles, curve, leak = case.different_bodies, case.cycles, case.load_curve, case.leak
    work = {f"before {name}": 0.0 for name in case.questions}
    if case.run_in is not None:
        work["before run_in"] = case.run_in.loads + 1.0
    work |= {"contact": 1.0, "half of the nodes": 0.3}
    flow = FLOW if leak is not None and leak.viscosity is not None else 0.1 if leak is not None else 0.0
    work |= dict.fromkeys(case.questions, 0.0)
    work |= {"partial_slip": SLIP} if case.partial_slip is not None else {}
    work |= {"leak": flow} if leak is not None else {}
    images = 4.0 if is_mirrored else 1.0
    moved = 0.0 if cycles is None or cycles.shifts is None else 1.0 + 2.0 * images * cycles.shifts
    work |= {f"stress {name}": STRESS + moved for name in bodies}
    work |= {f"after {name}": 0.0 for name in case.questions}
    if curve is not None:
        one = 1.0 + STRESS * len(bodies)
        yields = sum(body.yield_stress is not None for body in bodies.values())
        work["after load_curve"] = len(curve.path(case)) * (one + flow) + 4.0 * yields * (1.0 + STRESS)
        work["after load_curve"] += 0.0 if leak is None else 10.0
    work["comparisons"] = 1.0 if case.hardness is None else 0.1
    return work


class _Parts:
    """Progress of stages one after the other, each a share of the whole by its work."""

    def __init__(
        self,
        progress: Progress | None,
        work: Mapping[str, float],
        on_stage: Callable[[str], None] | None = None,
    ) -> None:
        self._progress, self._work, self._done = progress, work, 0.0
        self._on_stage = on_stage
        self._total = sum(work.values())

    def next(self, name: str) -> Progress:
        """Progress of the next stage, which begins; those before it are done."""
        if self._on_stage is not None:
            self._on_stage(name)
        work = self._work.get(name, 0.0)  # film and run-in may change which questions are asked
        report = _part(self._progress, self._done / self._total, (self._done + work) / self._total)
        self._done += work
        report(0.0, 1.0)
        return report


def _analyse(answer: Answer, name: str, progress: Progress) -> None:
    """Add the stress in one body to an answer, with the results of the questions in this body."""
    questions = answer.case.questions.values()
    alone = STRESS / work_of(answer.case, answer.face.grid.mirrored)[f"stress {name}"]
    loaded, on_half = (answer.loaded_body(each, name) for each in (answer.contact, answer.half.contact))
    watched = [question.watch(answer, name, loaded) for question in questions]
    answer.bodies[name] = body_answer(
        loaded,
        on_half,
        answer,
        name,
        close_ups(answer.face, answer.contact, answer.numbers.typical_patch_width),
        [watch for watch in watched if watch is not None],
        _part(progress, 0.0, alone),
    )
    for question in questions:
        question.of_body(answer, name, _part(progress, alone, 1.0))


def problems_on_map(case: Case, rough: RoughFace) -> list[Problem]:
    """Settings of a case that do not go with its map."""
    found: list[tuple[str, str]] = []
    if (contact := case.hertz_contact) is not None:
        widths = 2 * contact.half_width_y, 2 * contact.half_width_x
        part = shown_si(SEPARATE_SHARE * 2 * contact.narrow, "m", 2)
        for axis, width, edge in zip("yx", widths, rough.face.grid.length, strict=True):
            if width < edge:
                given = f"{shown_si(width, 'm')} wide under {shown_si(contact.largest_pressure, 'Pa')}"
                text = (
                    f": a Hertz contact wider than the map, {shown_si(edge, 'm')} along {axis}, is needed; "
                )
                text += f'it is {given}. Use a part of the map, map.crop = "{part}", or press the whole form '
                text += "with its force or pressure: map.radius and map.radius_y with map.periodic = none"
                found.append((f"load.radius_{axis}", text))
    for question in case.questions.values():
        found += [*question.on_map(case, rough)]
    try:
        imposed_load(rough.face, case)
    except SettingsError as error:
        found += error.found
    return [Problem(*each) for each in found]


def neighbours_of(face: TreatedMap, case: Case, contact: Contact) -> tuple[float, Contact | None]:
    """Width of a contact over the distance between its periodic images, and the contact without them.

    None for layers, whose contact cannot be solved without images. The images of a cylinder along its axis
    continue it: its width is taken across the axis, and without images, where it would end, no contact is
    solved.
    """
    widths = np.ptp(np.argwhere(contact.pressure > 0), axis=0) + 1
    spans = dict(zip("yx", (widths / face.grid.shape).tolist(), strict=True))
    if case.map.form == "cylinder":
        return spans["x" if case.map.cylinder_axis == "y" else "y"], None
    return max(spans.values()), None if case.solid.height is not None else press(face.map_alone(), case)


def _part(progress: Progress | None, begin: float, end: float) -> Progress:
    """Progress of a part of the run."""

    def report(done: float, total: float) -> None:
        if progress is not None:
            progress(begin + (end - begin) * (done / total if total else 1.0), 1.0)

    return report
