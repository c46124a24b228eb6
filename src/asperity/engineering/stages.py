"""All stages from a map to an answer: map → contact → stress in the bodies → questions → answer.

Each stage returns new objects, which no later stage changes. A question gets the complete results of the
stages before it.
"""

from __future__ import annotations

import json
import math
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import datetime
from functools import partial
from hashlib import sha256
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from asperity.contact import Contact
from asperity.core.arguments import require_finite
from asperity.core.processes import side_by_side
from asperity.core.types import Progress
from asperity.core.units import shown_si
from asperity.core.version import __version__
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.engineering.advice import Compared, advise
from asperity.engineering.answer_data import ON_INTERFACE, AnswerData, Origin, asked_first
from asperity.engineering.body_stress import BodyStress, body_stress
from asperity.engineering.case import Case
from asperity.engineering.case_file import case_text
from asperity.engineering.contact_numbers import contact_numbers, contact_spots, gap_of
from asperity.engineering.continuum import solved_on_half
from asperity.engineering.face import RoughFace, processes_on, read_face
from asperity.engineering.numbers import (
    body_records,
    contact_records,
    elastic_record,
    hertz_records,
    plastic_records,
)
from asperity.engineering.places import Blocks, blocks_of
from asperity.engineering.press import imposed_load, press
from asperity.engineering.question import Findings, Pressed, Stages
from asperity.engineering.records import INPUTS, Record, find, per_cent
from asperity.engineering.scene import Scene
from asperity.results.atomic import write_text
from asperity.settings.model import Problem, SettingsError
from asperity.surface.treatment.treatment import TreatedMap

FEWEST_NODES = 3
"""Least nodes on an edge of a map, of which peaks of the stress are found."""

STRESS, SLIDING, LAYER, FREE = 3.5, 3.0, 0.8, 8.0
"""Work of the stress in a body, its factors for tractions and free edges, and what each layer adds to it."""

FILES = 4.0
"""Work of reading a map and of writing an answer, which computes planes for its pictures."""

BESIDE = 1.25
"""Time of a process beside others over its time alone: they share memory and caches."""

GAP_FRACTIONS = np.linspace(0, 1, 101)
"""Cumulative area fractions for which the gap is listed."""

PEAK_COLUMNS = {
    "value": "value_Pa",
    "depth": "depth_m",
    "y": "y_m",
    "x": "x_m",
    "interior": "in_solid",
    "under_contact": "under_contact",
    "weight": "counts_for",
}
"""Name of a property of peaks → its column in the table of peaks."""

PACKAGES = ("numpy", "numba", "xarray", "SurfaceTopography")
"""Packages whose versions an answer names; it also names the library of the Fourier transforms."""


def answer_of(
    case: Case,
    rough: RoughFace | None = None,
    progress: Progress | None = None,
    on_stage: Callable[[str], None] | None = None,
    *,
    start: Contact | None = None,
    cores: int = 1,
    kept: Path | None = None,
) -> AnswerData:
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
    start : Contact, optional
        Of a similar case, from which the contact is solved.
    cores : int
        Most processes in which the cases of a question and the loads of a curve run side by side.
    kept : Path, optional
        Folder in which the records of each case of a question are kept until `kept` is deleted; those that it
        holds already are not computed again.

    Raises
    ------
    SettingsError, MapError, ConvergenceError
        As for `asperity.run`.
    """
    rough = rough or read_face(case.pressed_map, case.counter_map, check=partial(check_edges, case))
    asked = case.on_face(rough)
    if wrong := problems_on_map(asked, rough):
        raise SettingsError("", wrong)
    processes = processes_on([rough.face], cores, cores)
    parts = _Parts(progress, work_of(asked, bool(rough.face.grid.mirrored), processes), on_stage)
    pressed = _pressed(asked, rough, parts, start, cores)
    bodies = {name: _analysed(pressed, name, parts) for name in pressed.case.different_bodies}
    # Two equal bodies share one result.
    bodies = {name: bodies.get(name, bodies["lower"]) for name in pressed.case.bodies}
    parts.next("comparisons")
    compared = _compared(pressed)
    records = _records(pressed, bodies, compared)
    stages = Stages(**vars(pressed), bodies=bodies, records=records, elastic=compared.elastic)
    found = dict[str, Findings]()
    for name, question in asked.questions.items():
        if cases := question.other_cases(asked):
            same = _completed(stages.records, found)
            others = _others(
                cases, asked.replaced(**{name: None}), same, pressed, parts.next(f"cases of {name}"), kept
            )
            stages = replace(stages, others=others)
        found[name] = question.compute(stages, parts.next(name))
        stages = replace(stages, records=[*stages.records, *found[name].records])
    records = _completed(stages.records, found)
    known = {each.quantity: each.value for each in records if not each.words}
    require_finite("run", known)
    warnings = advise(stages, compared, records, [each for one in found.values() for each in one.warnings])
    datasets = {name: own for name, (own, _) in pressed.tractions.items() if own is not None}
    answer = AnswerData(
        asked,
        pressed.face,
        pressed.contact,
        tuple(records),
        tuple(_verdict(stages, found)),
        tuple(warnings),
        tuple(each.assumption for each in found.values() if each.assumption),
        {name: _stress(stages, name, found) for name in asked.different_bodies},
        _tables(stages, found),
        datasets | {name: each for one in found.values() for name, each in one.datasets.items()},
        _origin(rough, pressed.contact),
    )
    parts.end()
    return answer


def _others(
    cases: Mapping[str, Case],
    asked: Case,
    same: Sequence[Record],
    pressed: Pressed,
    progress: Progress,
    kept: Path | None,
) -> dict[str, Sequence[Record]]:
    """Records of further cases by name, computed side by side; of the case itself those that are known."""
    rough, maps = pressed.read, (asked.map, asked.counter_map)
    files, found = dict[str, Path | None](), dict[str, Sequence[Record]]()
    for name, case in cases.items():
        text = "" if kept is None else __version__ + case_text(case, Path(), files=rough.files)
        files[name] = None if kept is None else kept / f"{sha256(text.encode()).hexdigest()}.json"
        if case == asked:
            found[name] = same
    left = [name for name in cases if name not in found]
    given = [
        (
            cases[name],
            rough if (cases[name].map, cases[name].counter_map) == maps else None,
            pressed.contact,
            files[name],
        )
        for name in left
    ]
    processes = processes_on([rough.face], len(left), pressed.cores)
    each = side_by_side(_records_of, given, processes, lambda parts: progress(sum(parts), len(parts)))
    found |= dict(zip(left, each, strict=True))
    return {name: found[name] for name in cases}


def _records_of(
    case: Case, rough: RoughFace | None, start: Contact, file: Path | None, progress: Progress
) -> Sequence[Record]:
    """Records of a case, from a file if it holds them, else written into it."""
    if file is not None and file.exists():
        return [Record.from_plain(each) for each in json.loads(file.read_text("utf-8"))]
    records = answer_of(case, rough, progress, start=start).records
    if file is not None:
        file.parent.mkdir(parents=True, exist_ok=True)
        write_text(file, json.dumps([each.as_plain() for each in records]))
    return records


def _pressed(asked: Case, rough: RoughFace, parts: _Parts, start: Contact | None, cores: int) -> Pressed:
    """The contact of a case, on its nodes and on half of them, and what follows from it alone."""
    case, read, prepared = asked, rough, {}
    for name, question in asked.questions.items():
        case, rough, prepared[name] = question.prepare(case, rough, parts.next(f"before {name}"))
    contact = press(rough.face, case, parts.next("contact"), start=start)
    spots = contact_spots(rough.face, contact)
    parts.next("half of the nodes")
    coarse = solved_on_half(contact)
    tractions = {
        name: (question.tractions(asked, contact), question.tractions(asked, coarse.contact))
        for name, question in asked.questions.items()
    }
    return Pressed(
        asked=asked,
        case=case,
        read=read,
        rough=rough,
        contact=contact,
        coarse=coarse,
        spots=spots,
        numbers=contact_numbers(rough, contact, spots),
        blocks=_blocks(asked, rough.face, contact),
        prepared=prepared,
        tractions=tractions,
        cores=cores,
    )


def _blocks(case: Case, face: TreatedMap, contact: Contact) -> Blocks | None:
    """Blocks of the map, whose scatter gives the error between positions.

    None if the map holds too few, has a form (``map.radius``) or a free boundary, with adhesion, or if an
    approach or contact area is imposed: the numbers then do not follow the load on a block.
    """
    imposed = case.load.kind in ("normal_approach", "contact_area_fraction")
    if imposed or case.adhesion is not None or case.map.radius is not None or face.boundary != "periodic":
        return None
    return blocks_of(face, contact.pressure)


def _analysed(pressed: Pressed, name: str, parts: _Parts) -> BodyStress:
    """The stress in one body, seen by the observers of the questions."""
    asked, contacts = pressed.asked, (pressed.contact, pressed.coarse.contact)

    def under(number: int) -> LoadedSolid:
        loaded = asked.loaded_body(contacts[number], name)
        for each, question in asked.questions.items():
            loaded = question.loaded(loaded, contacts[number], pressed.tractions[each][number])
        return loaded

    loaded, on_half = under(0), under(1)
    observed = {
        each: observer
        for each, question in asked.questions.items()
        if (observer := question.observer(pressed, name, loaded)) is not None
    }
    progress = parts.next(f"stress {name}")
    return body_stress(
        asked, pressed.face, pressed.contact, pressed.coarse, name, (loaded, on_half), observed, progress
    )


def _compared(pressed: Pressed) -> Compared:
    """Contacts to compare the answer with: without periodic images, elastic, without filters."""
    face, case, contact = pressed.face, pressed.case, pressed.contact
    neighbours = None
    if face.boundary == "periodic" and case.map.radius is not None and len(pressed.spots):
        neighbours = neighbours_of(face, case, contact)
    unfiltered = None if pressed.rough.unfiltered is None else press(pressed.rough.unfiltered, case)
    elastic = None
    if pressed.asked.hardness_is_estimated and contact.plastic_area:
        elastic = press(face, case, hardness=np.inf)
    return Compared(neighbours, elastic, unfiltered)


def _records(pressed: Pressed, bodies: Mapping[str, BodyStress], compared: Compared) -> list[Record]:
    """The records that no question asks for."""
    numbers, blocks, contact = pressed.numbers, pressed.blocks, pressed.contact
    of_positions = np.nan if blocks is None else blocks.error(blocks.means(contact.pressure > 0))
    found = [*contact_records(numbers, bodies["lower"].limits, contact, of_positions, pressed.asked)]
    found += hertz_records(pressed.asked)
    if np.isfinite(contact.hardness):
        found += plastic_records(pressed.asked, contact, numbers.rms_gradient)
    if (elastic := compared.elastic) is not None:
        found += elastic_record("contact area fraction", elastic.contact_area_fraction, found)
        found += elastic_record("maximum pressure", elastic.maximum_pressure, found)
    for name in pressed.asked.different_bodies:
        found += body_records(pressed.asked, name, bodies[name], contact)
    return found


def _completed(records: Sequence[Record], found: Mapping[str, Findings]) -> list[Record]:
    """The records, those of a topic together, with the bounds and input errors that the questions found."""
    relative = {key: error for one in found.values() for key, error in one.input_errors.items()}
    bounds = {quantity: each for one in found.values() for quantity, each in one.bounds.items()}
    completed = []
    for each in records:
        if (limit := bounds.get(each.quantity)) is not None:  # which the solver exceeds by its tolerance
            each = replace(each, bounds=limit, value=min(each.value, limit.high))
        if (error := relative.get((each.quantity, each.body))) is not None:
            each = each.with_error(INPUTS, error * abs(each.value))
        completed.append(each)
    topics = list(dict.fromkeys((each.topic, each.body) for each in completed))
    return sorted(completed, key=lambda each: topics.index((each.topic, each.body)))


def _verdict(stages: Stages, found: Mapping[str, Findings]) -> list[str]:
    """A sentence for each question, those that are asked for first, then about interfaces and the contact.

    The force of friction, which decides nothing, is last.
    """
    asked, implied = asked_first(stages.asked)
    texts = [found[name].verdict for name in (*asked, *implied) if name != "sliding"]
    for name in stages.asked.different_bodies:
        body = stages.bodies[name]
        for face, stresses in zip(body.body.interfaces, body.interfaces, strict=True):
            shear, tension = (
                next(find(stages.records, f"{words} {face}", name)).best_text()
                for words in ON_INTERFACE.values()
            )
            pulled = "no tension" if stresses.tension.value <= 0 else f"a tension of up to {tension}"
            of = "coating" if len(body.interfaces) == 1 else "layers"
            texts.append(f"{face} of the {of} of the {name} body bears shear of up to {shear} and {pulled}")
    pressure = shown_si(stages.numbers.maximum_pressure, "Pa", 3)
    contact = f"the bodies are in contact on {per_cent(stages.numbers.contact_area_fraction)} of the area"
    texts.append(f"{contact}, under a pressure of up to {pressure}")
    texts += [each.verdict for name, each in found.items() if name == "sliding"]
    return [f"{text[0].upper()}{text[1:]}." for text in texts if text]


def _stress(stages: Stages, name: str, found: Mapping[str, Findings]) -> xr.Dataset:
    """The result of the stress in a body, with its extreme values."""
    part, attributes = stages.bodies[name], dict[str, Any]()
    for each in found.values():
        attributes |= each.attributes.get(name, {})
    extremes = {f"extreme_{field}": [*each[:4]] for field, each in part.extremes.items()}
    return part.stress.assign_attrs(extremes | attributes)


def _tables(stages: Stages, found: Mapping[str, Findings]) -> dict[str, pd.DataFrame]:
    """All tables of an answer by name."""
    gaps = np.quantile(gap_of(stages.contact), GAP_FRACTIONS)
    tables = {
        "peaks": _peaks(stages, found),
        "contact_spots": stages.spots,
        "gaps": pd.DataFrame({"cumulative_area_fraction": GAP_FRACTIONS, "gap_m": gaps}),
    }
    for each in found.values():
        tables |= each.tables
    return tables


def _peaks(stages: Stages, found: Mapping[str, Findings]) -> pd.DataFrame:
    """Peaks of the contact pressure and of the fields of the case, the largest magnitudes first."""
    tables = [rows for each in found.values() for rows in each.peaks]
    for body in stages.asked.different_bodies:
        stress = stages.bodies[body].stress
        names = [str(name) for name in stress.variables if stress[name].dims == ("peak",)]
        table = pd.DataFrame({name.removeprefix("peak_"): stress[name].values for name in names})
        table = table.rename(columns=PEAK_COLUMNS).assign(body=body)
        tables.insert(0, table[table["quantity"].isin(("pressure", *stages.asked.fields))])
    columns = ["body", "quantity", *PEAK_COLUMNS.values()]
    peaks = pd.concat(tables, ignore_index=True).reindex(columns=columns)
    peaks = peaks.assign(size=peaks["value_Pa"].abs(), counts_for=peaks["counts_for"].fillna(1.0))
    order = {"body": True, "quantity": False, "size": False}
    return peaks.sort_values([*order], ascending=[*order.values()], ignore_index=True)[columns]


def _origin(rough: RoughFace, contact: Contact) -> Origin:
    """How the answer was made."""
    versions = {"asperity": __version__, "Python": platform.python_version()}
    versions |= {package: version(package) for package in PACKAGES if find_spec(package)}
    engine, _, number = contact.fft_engine.partition(" ")
    date = datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z")
    return Origin(date, versions | {engine: number}, rough.files)


def work_of(case: Case, is_mirrored: bool = False, processes: int = 1) -> dict[str, float]:
    """Stages of the answer of a case → their work, side by side in processes where they can be.

    The unit is the time of a contact of the study per node (`asperity.study.cost.model`). The work of a stage
    is known to a factor of two: the numbers serve for progress and estimates of time.
    """
    costs = {name: question.cost(case, is_mirrored) for name, question in case.questions.items()}
    work = {f"before {name}": before for name, (before, _) in costs.items()}
    work |= {"contact": 0.5, "half of the nodes": 0.5}
    stress = STRESS * (FREE if case.map.free_edges else SLIDING if case.friction else 1)
    for name, body in case.different_bodies.items():
        work[f"stress {name}"] = stress * (1 + LAYER * len(body.layers))
    work["comparisons"] = 0.5 if case.hardness_is_estimated else 0.1
    gain = processes / BESIDE if processes > 1 else 1.0
    for name, (_, after) in costs.items():
        question = case.questions[name]
        others = sum(sum(work_of(each, is_mirrored).values()) for each in question.other_cases(case).values())
        work |= {f"cases of {name}": others / gain, name: after / gain if question.SIDE_BY_SIDE else after}
    return work


class _Parts:
    """Progress of stages one after the other, each a part of the whole by its work."""

    def __init__(
        self,
        progress: Progress | None,
        work: Mapping[str, float],
        on_stage: Callable[[str], None] | None = None,
    ) -> None:
        self._progress, self._work, self._done = progress, work, 0.0
        self._on_stage, self._total = on_stage, sum(work.values())

    def next(self, name: str) -> Progress:
        """Progress of the next stage, which begins; those before it are done."""
        if self._on_stage is not None:
            self._on_stage(name)
        begin, work = self._done, self._work.get(name, 0.0)
        self._done += work

        def report(done: float, total: float) -> None:
            if self._progress is not None:
                self._progress((begin + work * (done / total if total else 1.0)) / self._total, 1.0)

        report(0.0, 1.0)
        return report

    def end(self) -> None:
        """Report that everything is done."""
        if self._progress is not None:
            self._progress(1.0, 1.0)


def check_edges(case: Case, edges: Sequence[float]) -> None:
    """Raise `SettingsError` if the load of a case is incompatible with the edges (y, x) of its map."""
    found: list[tuple[str, str]] = []
    if (contact := case.hertz_contact) is not None:
        widths = 2 * contact.half_width_y, 2 * contact.half_width_x
        for axis, width, edge in zip("yx", widths, edges, strict=True):
            if width < edge:
                given = f"{shown_si(width, 'm')} wide under {shown_si(contact.maximum_pressure, 'Pa')}"
                part = case.part_in_hertz_contact["yx".index(axis)]
                size = shown_si(edge, "m")
                text = f": a Hertz contact wider than the map, {size} along {axis}, is needed; "
                text += f"it is {given}. Use a part of the map, map.crop = fit, which is {part} along {axis}"
                form = "map.radius and map.radius_y with map.periodic = none"
                if math.inf in widths:
                    across = "y" if widths[0] == math.inf else "x"
                    form = f"map.radius with map.form = cylinder and map.cylinder_axis = {across}"
                text += f", or press the whole form with its force or mean pressure: {form}"
                found.append((f"load.radius_{axis}", text))
    elif case.load.kind == "force":
        found += case.problems_of_pressure(case.load.value / math.prod(edges))
    if found:
        raise SettingsError("", found)


def problems_on_map(case: Case, rough: RoughFace) -> list[Problem]:
    """Settings of a case that are incompatible with its map."""
    found: list[tuple[str, str]] = []
    ny, nx = rough.face.grid.shape
    if min(ny, nx) < FEWEST_NODES:
        found.append(("map", f": at least {FEWEST_NODES} nodes on each edge are needed, it has {ny} × {nx}"))
    for name, question in case.questions.items():
        found += [*question.problems(case, rough)]
        for other, each in question.other_cases(case).items():
            if each.map == case.map:
                found += [(f"{name}.{other}", f": {wrong}") for wrong in problems_on_map(each, rough)]
    for check in (
        partial(check_edges, case, rough.face.grid.length),
        partial(imposed_load, rough.face, case),
    ):
        try:
            check()
        except SettingsError as error:
            found += error.found
    return [Problem(*each) for each in dict.fromkeys(map(tuple, found))]


def neighbours_of(face: TreatedMap, case: Scene, contact: Contact) -> tuple[float, Contact | None]:
    """Width of a contact over the distance between its periodic images, and the contact without them.

    None for layers, whose contact cannot be solved without images. The images of a cylinder along its axis
    continue it: its width is taken across the axis, and without images, where it would end, no contact is
    solved.
    """
    widths = np.ptp(np.argwhere(contact.touching), axis=0) + 1
    spans = dict(zip("yx", (widths / face.grid.shape).tolist(), strict=True))
    if case.map.form == "cylinder":
        return spans["x" if case.map.cylinder_axis == "y" else "y"], None
    return max(spans.values()), None if case.solid.height is not None else press(face.map_alone(), case)
