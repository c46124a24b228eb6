"""A number of an answer as a record: quantity, value, unit, position, errors by cause, and bounds.

Every reader (terminal, report, page, tables, sample, comparison) takes numbers from records. Text, rounding
and unit of a number are made here, and nowhere else.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from difflib import get_close_matches
from typing import Any, NamedTuple

import pandas as pd

from asperity.core.errors import shown
from asperity.core.markup import rounded, with_error
from asperity.core.units import scaled_unit, shown_si

DISCRETISATION = "discretisation"
PLANES = "discretisation and planes"
SEARCH = "the search"
POSITIONS = "between measurement positions"
INPUTS = "the inputs"
MODEL = "the model"

CAUSES = (DISCRETISATION, PLANES, SEARCH, POSITIONS, INPUTS, MODEL)
"""Causes of errors, in the order in which they are shown."""

EXTRAPOLATED = "extrapolated to zero pixel size"

NOT_KNOWN = "not known"

PER_AREA = "1/m^2"
"""Unit of numbers per area, which are shown per mm²."""

PER_WIDTH = "m^2/s"
"""Unit of leakages per width, which are shown per minute and mm."""

FLOW_RATE = "m^3/s"
"""Unit of flow rates, which are shown in ml/min or a smaller unit."""

SCALED = ("m", "m^2", "m^3", "Pa", "N", "Ω")
"""Units that take prefixes."""

STIFFNESS = "Pa/m"
"""Unit of stiffnesses, which are shown per µm."""


class Position(NamedTuple):
    """Where a number holds, in m; NaN for a coordinate that it does not have."""

    depth: float = math.nan
    y: float = math.nan
    x: float = math.nan


class Bounds(NamedTuple):
    """Interval in which a number lies whatever its error, and the reason."""

    low: float = -math.inf
    high: float = math.inf
    reason: str = ""


ANYWHERE, UNBOUNDED = Position(), Bounds()

FRACTION = Bounds(0.0, 1.0, "a fraction")
"""Bounds of a fraction; a number with them is shown in per cent."""

LEAST_FRACTION = 1e-8
"""Smallest fraction that is shown as a number."""

POSITIVE = Bounds(0.0, math.inf, "a size")

LIMITED = "limited by the hardness"
"""Note on a stress below a pressure that reaches the hardness."""


@dataclass(frozen=True)
class Record:
    """One number of an answer, in SI units.

    Attributes
    ----------
    quantity : str
        Its name, the same in every file.
    value : float
    unit : str
        SI unit of the value; "1" for a plain number.
    topic : str
        Part of the answer to which it belongs, such as ``contact`` or ``stress``.
    body : str
        ``lower`` or ``upper``; empty for a number of the contact.
    position : Position
    extrapolated : float
        Estimate at zero pixel size; NaN where there is none.
    errors : mapping
        Cause, a member of `CAUSES`, → half-width of the 95 % interval, in the unit. The discretisation error
        belongs to `extrapolated` where that is given, else to `value`.
    bounds : Bounds
    words : str
        Text in place of the number, such as ``none``; empty for the number itself.
    note : str
        Text after the number.
    varies : bool
        True if it differs between measurement positions, so that its error is incomplete without the cause
        `POSITIONS`.
    lacks : tuple of str
        Other causes that add to its error, but whose part could not be estimated.
    better : "less", "more" or ""
        Direction in which the surface with this number is better.
    ends : (low, high)
        The 95 % interval of a number that is known to a factor, in place of `errors`; NaN for any other.

    Examples
    --------
    >>> height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    >>> surface = asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")
    >>> answer = asp.run(surface, asp.Body(young=210e9, poisson=0.3), mean_pressure=50e6)
    >>> record = answer["contact area fraction"]
    >>> record.quantity, record.unit, record.bounds.high
    ('contact area fraction', '1', 1.0)
    """

    quantity: str
    value: float
    unit: str = "1"
    topic: str = "contact"
    body: str = ""
    position: Position = ANYWHERE
    extrapolated: float = math.nan
    errors: Mapping[str, float] = field(default_factory=dict)
    bounds: Bounds = UNBOUNDED
    words: str = ""
    note: str = ""
    varies: bool = False
    better: str = ""
    lacks: tuple[str, ...] = ()
    ends: tuple[float, float] = (math.nan, math.nan)

    def __post_init__(self) -> None:
        low, high, _ = self.bounds
        plain = {
            "value": _plain(self.value),
            "extrapolated": _plain(min(max(self.extrapolated, low), high)),
            "position": Position(*map(_plain, self.position)),
            "lacks": tuple(self.lacks),
            "ends": tuple(map(_plain, self.ends)),
            "errors": {
                cause: float(self.errors[cause]) for cause in CAUSES if self.errors.get(cause, 0.0) > 0
            },
        }
        for name, value in plain.items():
            object.__setattr__(self, name, value)

    def __eq__(self, other: object) -> bool:
        """True for equal fields; tuples take the one NaN of all records as equal, dataclasses do not."""
        if not isinstance(other, Record):
            return NotImplemented
        return all((getattr(self, each.name),) == (getattr(other, each.name),) for each in fields(self))

    @property
    def best(self) -> float:
        """The value extrapolated to zero pixel size, or the value where there is none."""
        return self.extrapolated if math.isfinite(self.extrapolated) else self.value

    @property
    def error(self) -> float:
        """Half-width of the interval by all known causes together; NaN without any."""
        return math.hypot(*self.errors.values()) if self.errors else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """Ends of the interval by all known causes, within the bounds; NaN without an error."""
        return self._within(self.error) if math.isnan(self.ends[0]) else self.ends

    def _within(self, error: float) -> tuple[float, float]:
        low, high, _ = self.bounds
        ends = (self.best - error, self.best + error)
        if math.isnan(error):
            return ends
        return min(max(ends[0], low), high), min(max(ends[1], low), high)

    def with_error(self, cause: str, error: float) -> Record:
        """The record with the error of a cause, in its unit; if it is NaN, the record lacks it."""
        if math.isnan(error) and cause not in self.errors and cause != POSITIONS:  # which `varies` says
            return replace(self, lacks=(*self.lacks, cause))
        return replace(self, errors={**self.errors, cause: error}) if error > 0 else self

    @property
    def unknown(self) -> list[str]:
        """Causes that add to the error of the number, but whose part was not estimated."""
        causes = [*self.lacks, *([POSITIONS] if self.varies else [])]
        return [cause for cause in dict.fromkeys(causes) if cause not in self.errors]

    def scale(self, units: Any = None) -> tuple[float, str]:
        """Factor and symbol of the unit in which it is shown.

        Parameters
        ----------
        units : callable, optional
            Value and SI unit → factor and symbol, in place of prefixes that suit the value.
        """
        if self.bounds == FRACTION:
            return 0.01, "%"
        if self.unit == PER_AREA:
            return 1e6, "per mm²"
        largest = max(abs(self.value), self.error if self.error > 0 else 0.0)
        if self.unit == STIFFNESS:
            factor, symbol = scaled_unit(1e-6 * largest, "Pa")
            return 1e6 * factor, f"{symbol}/µm"
        if self.unit == PER_WIDTH:
            factor, symbol = _per_minute(1e-3 * largest)
            return 1e3 * factor, f"{symbol} per mm"
        if self.unit == FLOW_RATE:
            return _per_minute(largest)
        if self.unit not in SCALED:
            return 1.0, "" if self.unit == "1" else self.unit
        return (units or scaled_unit)(largest, self.unit)

    def number(self, units: Any = None, digits: int = 4) -> str:
        """The value with its unit and the digits that its error leaves; at most three if it is not known."""
        if self.words:
            return self.words
        if self.bounds == FRACTION and 0 < self.value < LEAST_FRACTION:
            return f"less than {per_cent(LEAST_FRACTION)}"
        factor, symbol = self.scale(units)
        text = _digits(self.value / factor, min(digits, 3) if self.unknown and not self.errors else digits)
        if 1e-3 * abs(self.value) < self.error < abs(self.value):
            text = min(rounded(self.value / factor, self.error / factor)[0], text, key=len)
        return f"{text} {symbol}".strip()

    def place(self, units: Any = None) -> str:
        """Its position as text; empty without one."""
        found = ""
        if self.position.depth == 0:
            found = "in the surface"
        elif math.isfinite(self.position.depth):
            found = f"at a depth of {_length(self.position.depth, units)}"
        shown = [
            f"{axis} = {_length(at, units)}"
            for axis, at in (("x", self.position.x), ("y", self.position.y))
            if math.isfinite(at)
        ]
        if shown:
            found = f"{found}, " if found else "at "
        return found + ", ".join(shown)

    def error_texts(self, units: Any = None) -> list[str]:
        """Each error with its cause as text, and the `unknown` causes."""
        factor, symbol = self.scale(units)
        found = []
        for cause, error in self.errors.items():
            if cause == DISCRETISATION and math.isfinite(self.extrapolated):
                is_cut = self._within(error) != (self.best - error, self.best + error)
                known = self.bounds in (FRACTION, POSITIVE)
                limited = f", limited by {self.bounds.reason}," if is_cut and not known else ""
                found.append(f"{self._best_text(error, factor, symbol)}{limited} {EXTRAPOLATED}")
            elif self._within(error) != (self.best - error, self.best + error):
                ends = (_digits(end / factor, 2) for end in self._within(error))
                found.append(f"{' to '.join(ends)} {symbol}".strip() + f" by {cause}")
            else:
                size = rounded(self.best / factor, error / factor)[1]
                found.append(f"± {size} {symbol}".strip() + f" by {cause}")
        # The cause `POSITIONS` reads without "by".
        return [*(text.replace("by between", "between") for text in found)] + [
            f"{cause}: {NOT_KNOWN}" for cause in self.unknown
        ]

    def _best_text(self, error: float, factor: float, symbol: str) -> str:
        """The best value with an error or, where the interval is cut at the bounds, with its ends."""
        low, high = self._within(error)
        if low > self.best - error or high < self.best + error:
            best, *ends = (_digits(end / factor, 3) for end in (self.best, low, high))
            text = best if ends[0] == ends[1] else f"{best} ({ends[0]} to {ends[1]})"
            return f"{text} {symbol}".strip()
        return f"{with_error(self.best / factor, error / factor)} {symbol}".strip()

    @property
    def lacking(self) -> str:
        """What its error does not include, positions apart; empty if that is nothing."""
        missing = [cause for cause in self.unknown if cause != POSITIONS]
        if self.words or not missing:
            return ""
        return f"± without {' and '.join(missing)}" if self.errors else "± not known"

    def best_text(self, units: Any = None, whole: bool = True) -> str:
        """The best value with its whole known error, as a sentence shows it; `whole` with what that lacks."""
        if self.words:
            return self.words
        text = self._best_text(self.error, *self.scale(units)) if self.errors else self.number(units, 3)
        return f"{text} ({self.lacking})" if whole and self.lacking else text

    def text(self, units: Any = None) -> str:
        """The number, its position, its note and its known errors, in one line."""
        first = " ".join(filter(None, [self.number(units), self.place(units)]))
        # The position is left out: the terminal states once that it is not known, not for each number.
        known = [each for each in self.error_texts(units) if each != f"{POSITIONS}: {NOT_KNOWN}"]
        return "; ".join(filter(None, [", ".join(filter(None, [first, self.note])), *known]))

    def as_plain(self) -> dict[str, Any]:
        """The record as plain values for a file; `from_plain` gives it back."""
        found = asdict(self)
        return found | {"position": list(self.position), "bounds": list(self.bounds)}

    @classmethod
    def from_plain(cls, plain: Mapping[str, Any]) -> Record:
        """The record of the plain values of `as_plain`."""
        known = {each.name: plain[each.name] for each in fields(cls) if each.name in plain}
        return cls(**known | {"position": Position(*plain["position"]), "bounds": Bounds(*plain["bounds"])})


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


def per_cent(share: float) -> str:
    """A fraction as text in per cent."""
    return f"{100 * share:.2g} %" if share < 0.1 else f"{100 * share:.0f} %"


def _plain(value: float) -> float:
    """A Python float; NaN is always the object `math.nan`, so that tuples and dicts with it compare equal."""
    return math.nan if math.isnan(value) else float(value)


def _length(value: float, units: Any) -> str:
    if units is None:
        return shown_si(value, "m")
    factor, symbol = units(value, "m")
    return f"{value / factor:.4g} {symbol}"


def _per_minute(rate: float) -> tuple[float, str]:
    """Factor and symbol of a unit for a flow rate; without nl/min, which reads as norm litres."""
    litres = 6e4 * rate
    fits = (each for each in ((1e-3, "ml/min"), (1e-6, "µl/min")) if not 0 < litres < 1e-4 * each[0])
    factor, symbol = next(fits, (1e-12, "pl/min"))
    return factor / 6e4, symbol


def _digits(value: float, digits: int) -> str:
    """A number with significant digits: 40000 in place of 4e+04."""
    return f"{float(f'{value:.{digits}g}'):.7g}"


def fraction(quantity: str, value: float, **settings: Any) -> Record:
    """A record of a fraction, between 0 and 1, which is shown in per cent."""
    return Record(quantity, value, bounds=FRACTION, **settings)


def find(records: Iterable[Record], quantity: str, body: str | None = None) -> Iterator[Record]:
    """Records of a quantity, of one body or of all."""
    return (each for each in records if each.quantity == quantity and body in (None, each.body))


def record_of(records: Sequence[Record], quantity: str, body: str | None = None) -> Record:
    """The first record of a quantity, of one body or of any; `KeyError` if there is none."""
    if (found := next(find(records, quantity, body), None)) is None:
        near = get_close_matches(str(quantity), {each.quantity for each in records}, 3, 0.5)
        if body and quantity in near:
            near = [f"{quantity} of the {each.body} body" for each in find(records, quantity) if each.body]
        names = f"; near are {', '.join(near)}" if near else "; see the attribute `records`"
        of = f" of the {body} body" if body else ""
        raise KeyError(f"{shown(quantity)}{of}: no number of this answer{names}")
    return found


def frame(records: Iterable[Record]) -> pd.DataFrame:
    """Records as a table; the columns are described in ``docs/tables.md``."""
    causes = {cause: f"error_{cause.replace('the ', '').replace(' ', '_')}" for cause in CAUSES}
    own = ("topic", "body", "quantity", "value", "unit", "extrapolated", "error")
    rows = []
    for each in records:
        row: dict[str, Any] = {name: getattr(each, name) for name in own}
        row |= {name: each.errors.get(cause, math.nan) for cause, name in causes.items()}
        row |= {"low": each.interval[0], "high": each.interval[1], "bound": each.bounds.reason}
        row["not_known"] = ", ".join(each.unknown)
        row |= {f"{name}_m": place for name, place in each.position._asdict().items()}
        rows.append(row | {"text": each.text()})
    return pd.DataFrame(rows)
