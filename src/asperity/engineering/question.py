"""A question about a case: its methods in each stage of an answer, and the display of its part.

`asperity.engineering.run` carries out the stages, and asks every question of the case in each of them. A
question is one file in `asperity.engineering.questions`, which imports what it computes with only where it
computes: a question that is not asked costs nothing.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from asperity.core.markup import with_error
from asperity.core.units import scaled_unit, shown_si
from asperity.settings.model import Settings

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from asperity.contact import Contact
    from asperity.core.types import Progress
    from asperity.elasticity.loaded_solid import LoadedSolid
    from asperity.engineering.answer import Answer
    from asperity.engineering.case import Case
    from asperity.engineering.face import RoughFace
    from asperity.stress.planes.stream import LinearPlane


IN_FULL_CONTACT = "infinite, as the bodies touch everywhere"
"""Text in place of an infinite stiffness or conductance."""

IN_PER_CENT = (
    *("real contact", "plastic real contact", "share above yield"),
    *("area at the hardness", "load at the hardness"),
)
"""Dimensionless numbers that are shown in per cent."""

DIFFER_BETWEEN_PLACES = ("largest", "shakedown", "real contact", "share above", "volume above", "peaks")
"""Beginnings of the names of numbers that differ from place to place of the surface."""

NOT_KNOWN = "from place to place: not known"

RESOLUTION_CHANGE = 0.1
"""Change on doubling the pixels from which a number is called limited by the grid."""


HARDNESS_OVER_YIELD = 3.0
"""Indentation hardness over yield stress (D. Tabor, The Hardness of Metals, 1951)."""


MOST_SHIFTS = 10_000
"""Most positions of moving bodies."""

_NUMBER = re.compile(r"(.*?)(?:,? ((?:at|of|in|on|by|if|without) .*))?")
"""A number with its unit, and the text after it."""


class Row(NamedTuple):
    """One line of the answer: group, name, value in SI, its unit, and all numbers for a reader.

    The estimate for vanishing pixels and its error are NaN where there is none. ``error_of`` says what causes
    the error, ``error_of_places`` is half of the 95 % interval from place to place, and
    ``error_of_inputs`` the error by the tolerances of the inputs.
    """

    group: str
    name: str
    value: float
    unit: str
    shown: str
    estimate: float = float("nan")
    error: float = float("nan")
    error_of: str = ""
    error_of_places: float = float("nan")
    error_of_inputs: float = float("nan")

    @property
    def with_error(self) -> str:
        """The estimate and its error as text; empty where there is none."""
        return self._shown_with(self.estimate, self.error) if self.error > 0 else ""

    @property
    def value_and_place(self) -> tuple[str, str]:
        """The number with its unit, and the text after it, such as the depth."""
        number, place = _NUMBER.fullmatch(self.shown.partition("; ")[0]).groups(default="")  # type: ignore[union-attr]
        return number, place

    @property
    def between_places(self) -> str:
        """The error from place to place as text, from its ±; empty for numbers that do not depend on it."""
        if not self.error_of_places > 0:
            return NOT_KNOWN if self.name.startswith(DIFFER_BETWEEN_PLACES) else ""
        shown = self._shown_with(self.value, self.error_of_places)
        return f"{shown[shown.index('±') :]} from place to place"

    def in_unit(self, factor: float, symbol: str) -> tuple[str, list[str]]:
        """The number in a unit, and its errors as text, each with its cause.

        Shares are shown in per cent, and numbers without a unit as they are.
        """
        if self.name in IN_PER_CENT:
            factor, symbol = 0.01, "%"
        elif self.unit == "1":
            factor, symbol = 1.0, ""

        def text(error: float) -> str:
            shown = with_error(self.value / factor, error / factor)
            return f"{shown[shown.index('±') :]} {symbol}".strip()

        errors = []
        if self.error > 0 and self.estimate != self.value:
            shown = with_error(self.estimate / factor, self.error / factor)
            errors.append(f"{shown} {symbol} for vanishing pixels")
        elif self.error > 0:
            errors.append(f"{text(self.error)} by {self.error_of}")
        if self.error_of_places > 0:
            errors.append(f"{text(self.error_of_places)} from place to place")
        elif self.between_places:
            errors.append(self.between_places)
        if self.error_of_inputs > 0:
            errors.append(f"{text(self.error_of_inputs)} by the inputs")
        return f"{self.value / factor:.4g} {symbol}".strip(), errors

    def _shown_with(self, value: float, error: float) -> str:
        """A number and its error in the unit of the row."""
        factor, symbol = (1.0, "") if self.unit == "1" else scaled_unit(max(abs(value), error), self.unit)
        if self.name in IN_PER_CENT:
            factor, symbol = 0.01, "%"
        return f"{with_error(value / factor, error / factor)} {symbol}".strip()

    def by(self, error: float, source: str = "the pixels") -> Row:
        """The row with the error of its value and the cause of the error, if the error is known."""
        if not (math.isfinite(self.value) and error > 0):
            return self
        row = self._replace(estimate=self.value, error=error, error_of=source)
        return row._replace(shown=f"{self.shown}; {row.with_error[row.with_error.index('±') :]} by {source}")

    def of_inputs(self, relative: float) -> Row:
        """The row with its relative error by the tolerances of the inputs, if there are any."""
        if not relative > 0:
            return self
        row = self._replace(error_of_inputs=relative * abs(self.value))
        shown = self._shown_with(self.value, row.error_of_inputs)
        return row._replace(shown=f"{self.shown}; {shown[shown.index('±') :]} by the inputs")

    def of_places(self, relative: float) -> Row:
        """The row with its relative error from place to place, if known."""
        if not relative > 0:
            return self
        row = self._replace(error_of_places=relative * self.value)
        return row._replace(shown=f"{self.shown}; {row.between_places}")


class Advice(NamedTuple):
    """A warning or a note.

    Attributes
    ----------
    warns : bool
        True if a number of the answer must not be used without a check; a note adds information.
    subject : str
        Short heading.
    text : str
        One or two sentences.
    short : str
        The uncertainty of the answer in a few words; empty if there is none.
    size : float
        Relative size of that uncertainty.
    """

    warns: bool
    subject: str
    text: str
    short: str = ""
    size: float = 0.0

    @property
    def level(self) -> str:
        """``"warning"`` or ``"note"``."""
        return "warning" if self.warns else "note"


class Picture(NamedTuple):
    """A picture: the name of its file without the ending, its caption, the figure, and the body it shows.

    The body is empty for pictures of the contact.
    """

    name: str
    caption: str
    figure: Figure
    body: str = ""


class Question(Settings):
    """A group of settings of a case that asks a question. Every method does nothing by default."""

    TILES: ClassVar[tuple[str, ...]] = ()
    """Names of the rows that answer it, which stand at the top of the report."""
    LEAD: ClassVar[str] = ""
    """Name of the picture that stands beside them."""
    TEMPLATE: ClassVar[str] = ""
    """Template of its part of the report beside its module, which gets its result as `found`."""

    @classmethod
    def is_implied(cls, case: Case) -> bool:
        """True if a case asks the question without its group."""
        return False

    def check(self, case: Case) -> Iterator[tuple[str, str]]:
        """Settings that exclude each other or are missing: dotted key, and the message after it."""
        return iter(())

    def files(self, case: Case) -> list[str]:
        """Names of the files of its part of an answer."""
        return []

    def before_contact(self, case: Case, rough: RoughFace, progress: Progress) -> tuple[Case, RoughFace, Any]:
        """Case and surface that are pressed, and the result of this stage."""
        return case, rough, None

    def of_contact(self, answer: Answer, progress: Progress) -> Any:
        """Result that follows from the contact; `Answer.found` keeps it."""
        return None

    def on_map(self, case: Case, rough: RoughFace) -> Iterator[tuple[str, str]]:
        """Settings that do not go with the map: dotted key, and the message after it."""
        return iter(())

    def loaded(self, answer: Answer, contact: Contact, body: str) -> LoadedSolid | None:
        """A body as a contact loads it under this question; None if the contact's pressure alone loads it.

        The contact is the contact of the answer, or the contact on half of its nodes.
        """
        return None

    def watch(self, answer: Answer, body: str, loaded: LoadedSolid) -> Callable[[LinearPlane], None] | None:
        """A function that is called with each plane of the stress in a body."""
        return None

    def of_body(self, answer: Answer, body: str, progress: Progress) -> None:
        """Add the numbers that follow from the stress in a body to the result."""

    def after_stress(self, answer: Answer, progress: Progress) -> Any:
        """Result that needs the whole answer."""
        return None

    def other_cases(self, case: Case) -> dict[str, Case]:
        """Cases whose answers it needs too, by names."""
        return {}

    def of_other_cases(self, answer: Answer, others: Mapping[str, Answer]) -> Any:
        """Result that needs the whole answer and the answers of `other_cases`."""
        return None

    def verdict(self, answer: Answer) -> str:
        """The answer to the question in one sentence."""
        return ""

    def rows(self, answer: Answer) -> Iterator[Row]:
        """Lines of the answer about the contact."""
        return iter(())

    def rows_of_body(self, answer: Answer, body: str) -> Iterator[Row]:
        """Lines of the answer about a body."""
        return iter(())

    def advice(self, answer: Answer) -> Iterator[Advice]:
        """Warnings and notes."""
        return iter(())

    def assumption(self, answer: Answer) -> str:
        """The assumptions, in a sentence."""
        return ""

    def peaks(self, answer: Answer, body: str) -> pd.DataFrame | None:
        """Rows of its own in the table of peaks."""
        return None

    def tables(self, answer: Answer) -> Mapping[str, pd.DataFrame]:
        """Name of a file without its ending → the table in it."""
        return {}

    def datasets(self, answer: Answer) -> Iterator[tuple[str, xr.Dataset, str]]:
        """Name of a file, the dataset in it, and its title."""
        return iter(())

    def attributes(self, answer: Answer, body: str) -> Mapping[str, Any]:
        """Numbers of a body for the result of its stress."""
        return {}

    def fields(self, answer: Answer) -> Mapping[str, Any]:
        """Fields on the nodes of the cell, for the result of the contact and its pictures."""
        return {}

    def pictures(self, answer: Answer) -> Iterator[Picture]:
        """Pictures of the contact."""
        return iter(())

    def pictures_of_body(self, answer: Answer, body: str) -> Iterator[Picture]:
        """Pictures of a body."""
        return iter(())


def row(group: str, name: str, value: float, unit: str, shown: str = "") -> Row:
    """A line whose number is shown in SI units where no other text is given."""
    return Row(group, name, value, unit, shown or shown_si(value, unit))


def per_cent(share: float) -> str:
    """A share as text in per cent."""
    return f"{100 * share:.2g} %" if share < 0.1 else f"{100 * share:.0f} %"


def advice_on_pixels(what: str, fine: Mapping[str, float], coarse: Mapping[str, float]) -> Advice:
    """Change of numbers with the pixels, from a solution with pixels twice as large."""
    pairs = {name: (fine[name], value) for name, value in coarse.items() if name in fine}
    ratios = {name: a / b if b else (math.inf if a else 1.0) for name, (a, b) in pairs.items()}
    most = max(ratios.values(), key=lambda ratio: abs(ratio - 1))
    changed = ", ".join(f"{name} by a factor of {ratio:.3g}" for name, ratio in ratios.items())
    size, factor = abs(most - 1), 1 / most if most else math.inf
    text = f"pixels as they are, instead of twice as large ones, changed {changed} (from a second solution)."
    short = f"pixels: those twice as large change {what} by a factor of {factor:.3g}"
    return Advice(size > RESOLUTION_CHANGE, "pixels of the interface", text, short, size)
