"""A question about a case: what it needs, what it computes, and its display; one file for each question.

The stages of `asperity.engineering.stages` carry out the methods in the order in which they stand here. A
question imports what it computes with only where it computes: a question that is not asked costs nothing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import pandas as pd
import xarray as xr

from asperity.contact import Contact
from asperity.core.types import Array, Progress
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.body_stress import BodyStress, Observer
from asperity.engineering.contact_numbers import ContactNumbers
from asperity.engineering.continuum import HalfGrid
from asperity.engineering.face import RoughFace
from asperity.engineering.places import Blocks
from asperity.engineering.records import Advice, Bounds, Record
from asperity.engineering.scene import Scene
from asperity.results.variables import SI_UNITS
from asperity.settings.model import Settings
from asperity.surface.treatment.treatment import TreatedMap

if TYPE_CHECKING:
    from matplotlib.figure import Figure


IN_FULL_CONTACT = "infinite, as the bodies are in full contact"
"""Text in place of an infinite stiffness or conductance."""

RESOLUTION_CHANGE = 0.1
"""Change on doubling the pixels from which a number is called limited by the grid."""


class Picture(NamedTuple):
    """A picture: the name of its file without the suffix, its caption, the figure, and the body it shows.

    The body is empty for pictures of the contact.
    """

    name: str
    caption: str
    figure: Figure
    body: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Pressed:
    """The contact of a case and everything that follows from it alone, in SI units.

    Attributes
    ----------
    asked, case : Scene
        `asked` is the case of the user; `case` is the one whose contact is solved, after `Question.prepare`
        of every question, which may change load and hardness.
    read, rough : RoughFace
        The rough face of the map, and the one that was pressed.
    contact : Contact
    coarse : HalfGrid
        The contact on half of the nodes.
    spots : DataFrame
        Contact spots on the map.
    numbers : ContactNumbers
    blocks : Blocks or None
        Blocks of the map, whose scatter gives the error between measurement positions.
    prepared : mapping
        Name of a question → result of its `prepare`.
    tractions : mapping
        Name of a question → its tractions on the contact, and on the contact on half of the nodes.
    cores : int
        Most processes in which a question runs tasks side by side.
    """

    asked: Scene
    case: Scene
    read: RoughFace
    rough: RoughFace
    contact: Contact
    coarse: HalfGrid
    spots: pd.DataFrame
    numbers: ContactNumbers
    blocks: Blocks | None
    prepared: Mapping[str, Any]
    tractions: Mapping[str, tuple[xr.Dataset | None, xr.Dataset | None]]
    cores: int = 1

    @property
    def face(self) -> TreatedMap:
        """The rough surface that was pressed."""
        return self.rough.face


@dataclass(frozen=True, eq=False, kw_only=True)
class Stages(Pressed):
    """The contact of a case, the stress in its bodies, and the records of both.

    Attributes
    ----------
    bodies : mapping
        ``lower`` and, if it is elastic, ``upper`` → `BodyStress`; the same for two bodies of equal stress.
    records : sequence of Record
        Of the contact, of the stress, and of the questions before.
    elastic : Contact or None
        The contact without the hardness that a yield stress suggests, where that is reached.
    others : mapping
        Name of each of the `other_cases` of the question that is answered → the records of that case.
    """

    bodies: Mapping[str, BodyStress]
    records: Sequence[Record]
    elastic: Contact | None = None
    others: Mapping[str, Sequence[Record]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class Findings:
    """What a question found: everything that an answer keeps of it.

    Attributes
    ----------
    records : sequence of Record
    verdict : str
        The answer to the question in one sentence, without a full stop; empty for none.
    warnings : sequence of Advice
    assumption : str
        The assumptions, as sentences.
    tables : mapping
        Name of a file without its suffix → the table in it.
    datasets : mapping
        Name of a file without its suffix → the dataset in it, with its attribute ``title``.
    peaks : sequence of DataFrame
        Rows of its own in the table of peaks.
    attributes : mapping
        Body → attributes that are added to the dataset of its stress.
    input_errors : mapping
        Quantity and body of a record → its relative error by the tolerances of the inputs.
    bounds : mapping
        Quantity of a record → bounds in place of its own while this question is asked.
    """

    records: Sequence[Record] = ()
    verdict: str = ""
    warnings: Sequence[Advice] = ()
    assumption: str = ""
    tables: Mapping[str, pd.DataFrame] = field(default_factory=dict)
    datasets: Mapping[str, xr.Dataset] = field(default_factory=dict)
    peaks: Sequence[pd.DataFrame] = ()
    attributes: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    input_errors: Mapping[tuple[str, str], float] = field(default_factory=dict)
    bounds: Mapping[str, Bounds] = field(default_factory=dict)


class Question(Settings):
    """A group of settings of a case that asks a question. Every method does nothing by default."""

    ASKS: ClassVar[str] = ""
    """How the form asks it; empty for `sliding` and `sample`, which stand elsewhere in the form."""
    TILES: ClassVar[tuple[str, ...]] = ()
    """Quantities that answer it, which stand at the top of the report."""
    BY_MATERIAL: ClassVar[bool] = False
    """True if a material of the table implies it, so that other questions are answered first."""
    LEAD: ClassVar[str] = ""
    """Name of the picture that stands beside them."""
    SIDE_BY_SIDE: ClassVar[bool] = False
    """True if `compute` divides its work between processes."""
    FILES: ClassVar[tuple[str, ...]] = ()
    """Beginnings of the names of its files, without ``_lower`` or ``_upper`` and the suffix."""

    @classmethod
    def is_implied(cls, case: Scene) -> bool:
        """True if a case asks the question without its group."""
        return False

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """Settings that exclude each other or are missing: dotted key, and the message after it.

        With the rough face, the settings that are incompatible with it.
        """
        return iter(())

    def cost(self, case: Scene, is_mirrored: bool) -> tuple[float, float]:
        """Work of `prepare` and `tractions` together, and of `compute`, as of `stages.work_of`."""
        return 0.0, 0.0

    def prepare(self, case: Any, rough: RoughFace, progress: Progress) -> tuple[Any, RoughFace, Any]:
        """Case and surface that are pressed, and a result that `compute` takes."""
        return case, rough, None

    def tractions(self, case: Scene, contact: Contact) -> xr.Dataset | None:
        """Fields over the map that `loaded` needs beside the pressure, for a contact of the case."""
        return None

    def loaded(self, loaded: LoadedSolid, contact: Contact, tractions: xr.Dataset | None) -> LoadedSolid:
        """A body under this question, from the body under the contact."""
        return loaded

    def observer(self, pressed: Pressed, body: str, loaded: LoadedSolid) -> Observer | None:
        """An object whose `add` gets every plane of the stress in a body.

        `compute` finds it in ``stages.bodies[body].observed``, under the name of the question.
        """
        return None

    def other_cases(self, case: Any) -> dict[str, Any]:
        """Cases whose records it needs too, by names."""
        return {}

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """The answer to the question, from the results of all stages."""
        return Findings()

    def pictures(self, answer: AnswerData) -> Iterator[Picture]:
        """Pictures of the contact and of the bodies."""
        return iter(())


def on_map(contact: Contact, title: str, **fields: Array) -> xr.Dataset:
    """Fields on the nodes of the map as a dataset."""
    variables = {name: (("y", "x"), values) for name, values in fields.items()}
    attributes = {"title": title, "unit_system": SI_UNITS}
    return xr.Dataset(variables, contact.grid.dataset_coordinates(), attributes)


def part_of(progress: Progress, begin: float, end: float, total: float, done: float, of: float) -> None:
    """Report the progress of a part, from `begin` to `end`, of a work of a total."""
    progress(begin + (end - begin) * (done / of if of else 1.0), total)


def advice_on_pixels(what: str, fine: Mapping[str, float], coarse: Mapping[str, float]) -> Advice:
    """Change of numbers with the pixels, from a solution with pixels twice as large."""
    pairs = {name: (fine[name], value) for name, value in coarse.items() if name in fine}
    ratios = {name: a / b if b else (math.inf if a else 1.0) for name, (a, b) in pairs.items()}
    most = max(ratios.values(), key=lambda ratio: abs(ratio - 1))
    changed = ", ".join(f"{name} by a factor of {ratio:.3g}" for name, ratio in ratios.items())
    size, factor = abs(most - 1), 1 / most if most else math.inf
    text = f"the pixels, instead of pixels twice as large, changed {changed} (found by solving with both)."
    short = f"pixels: those twice as large change {what} by a factor of {factor:.3g}"
    return Advice(size > RESOLUTION_CHANGE, "pixels of the interface", text, short, size)
