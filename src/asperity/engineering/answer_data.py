"""The data of an answer: records, tables and datasets, and planes and sections of its stress.

`AnswerData` is the same after a computation and after it was written and opened again: planes and sections
are computed from the contact pressure that it holds.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import zip_longest
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from asperity.contact import Contact
from asperity.core.arguments import choice
from asperity.core.types import Array
from asperity.core.units import shown_si
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.engineering.body_stress import STRESS_TOLERANCE
from asperity.engineering.face import ReadFile
from asperity.engineering.records import LIMITED, Advice, Record, find, frame, record_of
from asperity.engineering.scene import Scene
from asperity.settings.load import UNITS
from asperity.stress.extremes import Extreme
from asperity.stress.planes.stream import PlaneStream
from asperity.stress.section import stress_box
from asperity.surface.treatment.treatment import TreatedMap

CONTACT_TILES = ("contact area fraction", "maximum pressure", "maximum von Mises stress")
"""Quantities of contact and stress at the top of the report."""

ON_INTERFACE = {"shear": "maximum shear stress on", "tension": "maximum tension across"}
"""Extreme value of an `Interface` → its quantity, before the name of the interface."""

ALIKE = 0.01
"""Relative difference up to which a number of the upper body is left out as equal to the lower body's."""

REPEATS = f"upper body: only numbers that differ from the lower body's by more than {ALIKE:.0%} are listed"

ONE_POSITION = (
    "the map shows one position of the surface: a discretisation error does not include how much other "
    "positions differ. An error between positions is estimated from parts of the map; several maps "
    "(--pooled) measure it"
)

UNCERTAINTIES = 3
"""Number of uncertainties shown above the answer, the largest ones."""

FADED = 0.1
"""A section ends where the stress is below this fraction of its largest magnitude, and below the limit of the
material if one is known."""


class Origin(NamedTuple):
    """How an answer was made: date, versions of packages, and the files that were read."""

    date: str
    versions: Mapping[str, str]
    files: tuple[ReadFile, ...]


NO_ORIGIN = Origin("", {}, ())


@dataclass(frozen=True, eq=False, repr=False)
class AnswerData:
    """The answer of a case as data, in SI units.

    Attributes
    ----------
    case : Case
    face : TreatedMap
        The rough surface that was pressed, with the treatment of its map.
    contact : Contact
    records : tuple of Record
        All numbers.
    verdict : tuple of str
        The answer to each question in a sentence, then sentences about interfaces and the contact.
    warnings : tuple of Advice
        Warnings and notes, warnings first.
    assumptions : tuple of str
    stress : mapping
        ``lower`` and, if its stress differs, ``upper`` → result of `asperity.analyse_stress`; its attribute
        ``extreme_`` and a field holds the extreme value of the field with its depth, y and x.
    tables : mapping
        ``peaks``, ``contact_spots``, ``gaps`` and the tables of the questions.
    datasets : mapping
        The datasets of the questions.
    origin : Origin
    folder : Path or None
        Absolute path of its folder; None before it is written.
    """

    case: Scene
    face: TreatedMap
    contact: Contact
    records: tuple[Record, ...]
    verdict: tuple[str, ...]
    warnings: tuple[Advice, ...]
    assumptions: tuple[str, ...]
    stress: Mapping[str, xr.Dataset]
    tables: Mapping[str, pd.DataFrame]
    datasets: Mapping[str, xr.Dataset] = field(default_factory=dict)
    origin: Origin = NO_ORIGIN
    folder: Path | None = None

    def __getattr__(self, name: str) -> Any:
        """A part of an opened answer, read when it is first asked for; `read_data` sets `_later`."""
        later = self.__dict__.get("_later", {})
        if name not in later:
            raise AttributeError(f"{type(self).__name__} has no attribute {name}")
        object.__setattr__(self, name, later[name](self))
        return self.__dict__[name]

    def __getstate__(self) -> dict[str, Any]:
        """All parts of the answer, those of an opened one read from its folder."""
        for name in self.__dict__.get("_later", {}):
            getattr(self, name)
        parts = {name: part for name, part in self.__dict__.items() if name != "_later"}
        return parts | {name: dict(parts[name]) for name in ("stress", "tables", "datasets")}

    def __getitem__(self, quantity: str) -> Record:
        return self.record(quantity)

    def record(self, quantity: str, body: str | None = None) -> Record:
        """The record of a quantity, such as ``maximum von Mises stress``.

        Parameters
        ----------
        quantity : str
        body : "lower" or "upper", optional
            By default the first body that has it.

        Raises
        ------
        KeyError
            If there is none.
        """
        return record_of(self.records, quantity, body)

    def frame(self) -> pd.DataFrame:
        """All numbers as a table; the columns are described in ``docs/tables.md``."""
        return frame(self.records)

    @property
    def title(self) -> str:
        """Name of the map, and the case in words."""
        return f"{self.face.name}: {case_in_words(self.case)}"

    @property
    def tiles(self) -> list[Record]:
        """Records at the top of a page: answers to the questions, then numbers of the contact."""
        return at_the_top(self.case, without_repeats(self.records))

    @property
    def uncertainties(self) -> list[Advice]:
        """Warnings and notes that state the largest uncertainties, one of a subject, the largest first."""
        sized = sorted((advice for advice in self.warnings if advice.short), key=lambda advice: advice.size)
        of_subject = {advice.subject: advice for advice in sized}
        return sorted(of_subject.values(), key=lambda advice: -advice.size)[:UNCERTAINTIES]

    def warnings_table(self) -> pd.DataFrame:
        """Verdicts, warnings and notes: level, subject, text."""
        found = [("verdict", "", text) for text in self.verdict]
        found += [(each.level, each.subject, each.text) for each in self.warnings]
        return pd.DataFrame(found, columns=["level", "subject", "text"])

    def extreme(self, field: str, body: str = "lower") -> Extreme:
        """The extreme value of a field of the case in a body, and its place."""
        attributes = self.stress[self._of(body)].attrs
        known = [name.removeprefix("extreme_") for name in attributes if name.startswith("extreme_")]
        choice("field", field, known)
        value, depth, y, x = map(float, attributes[f"extreme_{field}"])
        return Extreme(value, depth, y, x)

    def depths(self, body: str = "lower") -> Array:
        """Depths of the planes of the stress in a body."""
        return self.stress[self._of(body)]["plane_depth"].values

    def _of(self, body: str) -> str:
        """``lower`` if the stress of both bodies is equal and kept once, else the body itself."""
        return body if body in self.stress else "lower"

    def loaded(self, body: str = "lower") -> LoadedSolid:
        """A body under everything that loads it, for `asperity.stress_planes` and others."""
        loaded = self.case.loaded_body(self.contact, body)
        for name, question in self.case.questions.items():
            loaded = question.loaded(loaded, self.contact, self.datasets.get(name))
        return loaded

    def plane(
        self, depth: float | None = None, field: str = "von_mises", body: str = "lower"
    ) -> xr.DataArray:
        """A field of the stress on the map at a depth, by default the depth of its extreme value.

        Parameters
        ----------
        depth : float, optional
            In m.
        field : str
        body : "lower" or "upper"

        Returns
        -------
        DataArray
            In Pa, along `y` and `x`.
        """
        depth = self.extreme(field, body).depth if depth is None else depth
        loaded = self.loaded(body)
        sliding = self.case.sliding_of(body)
        stream = PlaneStream(loaded, [depth], None, (field,), STRESS_TOLERANCE, **sliding)
        plane = next(stream.planes())
        rows, columns = self.face.part_of(plane.grid)
        y, x = plane.grid.coordinates()
        values = plane.field(field, loaded.layer.poisson)[rows, columns]
        coords = {"y": y[rows], "x": x[columns], "depth": depth}
        return xr.DataArray(values, coords, ("y", "x"), field)

    def section(
        self,
        along: str = "x",
        at: float | None = None,
        field: str = "von_mises",
        body: str = "lower",
        between: tuple[float, float] | None = None,
        deepest: float | None = None,
    ) -> xr.DataArray:
        """A field of the stress in a vertical section.

        Parameters
        ----------
        along : "x" or "y"
            Horizontal axis of the section.
        at : float, optional
            Position on the other axis in m, by default that of the extreme value.
        field : str
        body : "lower" or "upper"
        between : (first, last), optional
            Part of the horizontal axis, in m.
        deepest : float, optional
            Depth at which the section ends, in m.

        Returns
        -------
        DataArray
            In Pa, along `depth` and the horizontal axis, with the position as a coordinate.
        """
        choice("along", along, ("x", "y"))
        extreme, loaded = self.extreme(field, body), self.loaded(body)
        at = (extreme.y if along == "x" else extreme.x) if at is None else at
        depths = self.depths(body)
        if deepest is not None:
            depths = depths[: max(int(np.searchsorted(depths, deepest)) + 1, 2)]
        y, x = ((at, at), between) if along == "x" else (between, (at, at))
        box = stress_box(
            loaded, depths, y, x, (field,), tolerance=STRESS_TOLERANCE, **self.case.sliding_of(body)
        )
        found = box.dataset()[field].isel({"poisson": 0, "y" if along == "x" else "x": 0})
        return found.drop_vars("poisson")

    @cached_property
    def framed_sections(self) -> dict[tuple[str, str], xr.DataArray]:
        """Field and body → the section that pictures show, when one of them has been drawn."""
        return {}

    def __repr__(self) -> str:
        return f"<{type(self).__name__.removesuffix('Data')} of {self.title}>"


def tile_names(case: Scene) -> list[tuple[str, ...]]:
    """Quantities at the top of a page: of each question, of the interfaces, and of the contact."""
    asked, implied = ([case.questions[name].TILES for name in names] for names in asked_first(case))
    faces = [face for body in case.bodies.values() for face in body.interfaces]
    of_faces = tuple(f"{words} {face}" for face in faces for words in ON_INTERFACE.values())
    return [*asked, of_faces, *implied, CONTACT_TILES]


def asked_first(case: Scene) -> tuple[list[str], list[str]]:
    """Names of the questions that a case asks, and of those that a material alone implies."""
    given = case.model_fields_set
    implied = [name for name, each in case.questions.items() if each.BY_MATERIAL and name not in given]
    return [name for name in case.questions if name not in implied], implied


def at_the_top(case: Scene, records: Sequence[Record]) -> list[Record]:
    """Records at the top of a page: two of the first question that is asked, and one of each in turn.

    A stress that the hardness limits does not come first.
    """
    found = []
    for names in tile_names(case):
        if any(LIMITED in each.note for name in names[:1] for each in find(records, name)):
            names = (*names[1:2], *names[:1], *names[2:])
        found.append([each for name in names for each in find(records, name)])
    count = len(asked_first(case)[0])
    if asked := [*filter(None, found[:count])]:
        found = [asked[0][:1], asked[0][1:], *asked[1:], *found[count:]]
    in_turn = [each for one in zip_longest(*found) for each in one if each is not None]
    return list({(each.quantity, each.body): each for each in in_turn}.values())


def without_repeats(records: Any) -> list[Any]:
    """Records without those numbers of the upper body that equal the lower body's."""
    known = {each.quantity: each.value for each in records if each.body == "lower"}

    def is_repeated(each: Any) -> bool:
        lower = known.get(each.quantity) if each.body == "upper" else None
        return lower is not None and abs(each.value - lower) <= ALIKE * abs(lower)

    return [each for each in records if not is_repeated(each)]


def by_topic(case: Scene, records: Any) -> Iterator[tuple[str, list[Any]]]:
    """Heading of each part of an answer, and its records."""
    groups: dict[str, list[Any]] = {}
    for each in records:
        groups.setdefault(heading(case, each.topic, each.body), []).append(each)
    yield from groups.items()


def heading(case: Scene, topic: str, body: str) -> str:
    """Heading of the records of a topic about a body."""
    if topic == "stress":
        return case.stress_title(body)
    return f"{topic}, {body} body" if body and len(case.different_bodies) > 1 else topic


def load_in_words(case: Scene) -> tuple[str, str]:
    """Name and value of the imposed quantity."""
    load = case.load
    if load.kind == "contact_area_fraction":
        return "contact area fraction", f"{100 * load.value:.4g} %"
    return load.kind.replace("_", " ").replace("hertz", "Hertz"), shown_si(load.value, UNITS[load.kind])


def case_in_words(case: Scene) -> str:
    """Bodies and load in one line."""
    kind, value = load_in_words(case)
    counter = case.elastic_counter_body
    upper = "a rigid body" if counter is None else counter.in_words
    sliding = f", sliding along {case.along} with friction {case.friction:g}" if case.friction else ""
    if (slip := case.questions.get("partial_slip")) is not None:
        moved = "tangential force " + shown_si(slip.tangential_force or 0.0, "N")
        if slip.tangential_displacement is not None:
            moved = "tangential displacement " + shown_si(slip.tangential_displacement, "m")
        sliding = f", {moved} along {case.along} with friction {case.friction:g}"
    return f"{case.body.in_words} against {upper}, {kind} imposed: {value}{sliding}"
