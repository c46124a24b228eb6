"""Sweep: the numbers of the answer for several values of one or two settings.

Every value takes one more answer; the mechanism is that of `sensitivity`. The value at which a number meets
its limit is interpolated between the values that were computed.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import product
from textwrap import wrap
from typing import Annotated, Any

import numpy as np
import pandas as pd
from pydantic import PlainValidator, ValidationError, ValidationInfo, WithJsonSchema

from asperity.core.errors import did_you_mean
from asperity.core.errors import shown as shown_value
from asperity.core.types import Progress
from asperity.core.units import DIMENSIONS, shown_si, to_si
from asperity.engineering.answer_data import AnswerData, tile_names
from asperity.engineering.face import RoughFace
from asperity.engineering.numbers import EXTREMES
from asperity.engineering.question import Findings, Picture, Question, Stages
from asperity.engineering.records import FRACTION, NOT_KNOWN, SEARCH, UNBOUNDED, Advice, Record, find, frame
from asperity.engineering.scene import Scene
from asperity.settings.model import (
    NeededError,
    Settings,
    SettingsError,
    accepted,
    check_of,
    entry_of,
    optional,
    scalar,
    setting,
    value_at,
    with_value,
)

TOPIC, AT_LIMIT = "sweep", "value at the limit"

RANGE = {"from", "to", "steps"}
"""Keys of a range of values."""

MOST_KEYS, MOST = 2, 100
"""Most keys of a sweep, and most values of them together."""

COLUMNS = [
    *("topic", "body", "quantity", "value", "unit", "extrapolated"),
    *("error", "low", "high", "bound", "text"),
]
"""Columns of the table of numbers that the table of a sweep has, too."""

PANELS = 6
"""Most numbers in the picture."""

WIDE = 8
"""Maximum over minimum of an axis above which it is logarithmic."""

VALUES = "a list of values, or {from: …, to: …, steps: …}"
ACCEPTED = f"one or two dotted keys of settings, each with {VALUES}"


def _checked(values: Any, info: ValidationInfo) -> Any:
    """The values as they are given; a bare number in a file becomes a text, as its unit is not known."""

    def text(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {str(name): text(each) for name, each in value.items()}
        if isinstance(value, (list, tuple)):
            return [text(each) for each in value]
        return str(value) if (info.context or {}).get("units") else value

    if not (isinstance(values, Mapping) and 1 <= len(values) <= MOST_KEYS):
        raise NeededError(ACCEPTED)
    return text(values)


Swept = Annotated[
    Any, PlainValidator(_checked), WithJsonSchema({"type": "object", "minProperties": 1, "accepts": ACCEPTED})
]


class Sweep(Question):
    """The numbers of the answer for several values of any numeric setting, or of two.

    The case gives the settings, too: ``sweep: {values: {body.layers.0.thickness: [1 um, 2 um]}}``.
    """

    ASKS = "How does it change with a setting?"
    TILES = (AT_LIMIT,)
    LEAD = "sweep"
    FILES = ("sweep",)

    values: Swept = setting(..., example={"body.layers.0.thickness": ["1 um", "2 um"]})
    """Dotted key of a numeric setting → its values; of two keys all pairs of values are computed. A range has
    equal ratios between positive ends, else equal steps."""
    number: str | None = optional(
        "the maximum von Mises stress, below a coating", accepts="the name of a number of the answer"
    )
    """The number for which the value at its limit is found."""
    limit: str | float | None = optional(
        "the yield stress, of a von Mises stress",
        accepts="a number in SI units, or with its unit",
        example="1 GPa",
    )
    """The limit of the number."""

    def problems(self, case: Any, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """Keys that are unknown or not numeric, and values that they, or the whole case, do not accept."""
        if rough is not None:
            return
        if isinstance(self.limit, str) and _in_si(self.limit) is None:
            yield "sweep.limit", f" = {self.limit}: a number, or a number with its unit, is needed"
        paths = {}
        for key in self.values:
            try:
                paths[key] = self.path(case, key)
            except ValueError as error:
                yield f"sweep.values.{key}", str(error)
        if len(paths) < len(self.values):
            return
        if math.prod(map(len, paths.values())) > MOST:
            yield "sweep", f": at most {MOST} values, or pairs of values, are accepted"
            return
        alone = _alone(case)
        for key, path in paths.items():
            for value in path:
                try:
                    with_value(alone, key, _given(case, key, value))
                except SettingsError as error:
                    yield f"sweep.values.{key}", f" = {_shown(case, key, value)}: {error.found[0]}"

    def path(self, case: Scene, key: str) -> list[float]:
        """The values of a key in SI units; `ValueError` with the message after the key if one is refused."""
        given, read = self.values[key], partial(_read, case, key)
        if isinstance(given, list) and given:  # equal values once
            return [*{_shown(case, key, value, 15): value for value in map(read, given)}.values()]
        steps = str(given.get("steps")) if isinstance(given, Mapping) and given.keys() == RANGE else ""
        if not (steps.isdecimal() and 2 <= int(steps) <= MOST):
            raise ValueError(f" = {shown_value(given)}: {VALUES}, with 2 to {MOST} steps, is needed")
        first, last = read(given["from"]), read(given["to"])
        between = np.geomspace if first > 0 and last > 0 else np.linspace
        if _shown(case, key, first, 15) == _shown(case, key, last, 15):
            return [first]
        return [first, *between(first, last, int(steps))[1:-1].tolist(), last]

    def points(self, case: Scene) -> Iterator[dict[str, tuple[float, str]]]:
        """Key → value and its text, of each value or pair of values."""
        texts = list[list[tuple[float, str]]]()
        for key in self.values:
            path = self.path(case, key)
            digits = 4 if len({_shown(case, key, value) for value in path}) == len(path) else 15
            texts.append([(value, _shown(case, key, value, digits)) for value in path])
        yield from (dict(zip(self.values, point, strict=True)) for point in product(*texts))

    def other_cases(self, case: Any) -> dict[str, Any]:
        """The case at each value, or pair of values; names are keys and values in words."""
        found = {}
        for point in self.points(case):
            changed = _alone(case)
            for key, (value, _) in point.items():
                changed = with_value(changed, key, _given(case, key, value))
            found[", ".join(f"{key} = {text}" for key, (_, text) in point.items())] = changed
        return found

    def written_values(self, case: Scene) -> dict[str, list[str]]:
        """The values as a file holds them: as they are given, numbers and ranges with their units."""
        texts = {key: given for key, given in self.values.items() if not isinstance(given, Mapping)}
        texts = {key: given for key, given in texts.items() if all(isinstance(each, str) for each in given)}
        shown = {key: [_shown(case, key, each, 15) for each in self.path(case, key)] for key in self.values}
        return {key: [*texts.get(key, values)] for key, values in shown.items()}

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """All numbers at all values as a table, and the value at which the chosen number meets its limit."""
        case, (first, *second) = stages.asked, self.values
        cases = self.other_cases(case)
        found, curves = self._chosen(stages.records), dict[tuple[float, ...], dict[float, Any]]()
        shown = {name for names in tile_names(case) for name in names} | {found.quantity if found else ""}
        tables = list[pd.DataFrame]()
        for point, (name, records) in zip(self.points(case), stages.others.items(), strict=True):
            at = {f"at_{key}": value for key, (value, _) in point.items()}
            table = frame(records)[COLUMNS]
            best = [each.best_text() for each in records]
            known = pd.DataFrame(
                {**at, "case": name, "is_shown": table["quantity"].isin(shown), "best": best}
            )
            tables.append(known.join(table))
            for each in find(records, found.quantity, found.body) if found else ():
                if math.isfinite(each.best):
                    limit = self._limit(cases[name], each)
                    curves.setdefault((*at.values(),)[1:], {})[at[f"at_{first}"]] = (each, limit)
        numbers, verdict, warnings = list[Record](), list[str](), list[Advice]()
        for other, curve in curves.items():
            where = "".join(
                f" at {words_of(key)} {_shown(case, key, value)}"
                for key, value in zip(second, other, strict=True)
            )
            if len(curve) > 1:
                at_limit, text = _at_limit(curve, words_of(first), partial(_shown, case, first))
                if at_limit is not None:
                    unit = _unit(case, first)
                    numbers.append(replace(at_limit, quantity=f"{AT_LIMIT}{where}", unit=unit, topic=TOPIC))
                    text += numbers[-1].best_text()
                verdict.append(f"{text}{where}")
        if found is None:
            near = did_you_mean(str(self.number), {each.quantity for each in stages.records})
            text = f"the number of the sweep, {self.number}, is none of this answer{near}."
            warnings.append(Advice(True, "sweep", text))
        elif self.limit is not None and _in_si(self.limit, found.unit) is None:
            text = (
                f"the limit of the sweep, {self.limit}, is no limit of the {found.quantity}, in {found.unit}."
            )
            warnings.append(Advice(True, "sweep", text))
        table = pd.concat(tables, ignore_index=True)
        return Findings(
            records=numbers, verdict="; ".join(verdict), warnings=warnings, tables={"sweep": table}
        )

    def _chosen(self, records: Iterable[Record]) -> Record | None:
        """The number whose limit is looked for; None if the records have none of the name."""
        stress = "maximum von Mises stress"
        names = [self.number] if self.number else [f"{stress} in the base", stress]
        return next((each for name in names for each in find(records, name)), None)

    def _limit(self, case: Scene, record: Record) -> float:
        """Limit of a number of a case; NaN if there is none."""
        if self.limit is not None:
            limit = _in_si(self.limit, record.unit)
            return math.nan if limit is None else limit
        for name, part in case.bodies[record.body or "lower"].parts.items():
            if record.quantity == EXTREMES["von_mises"] + (f" in {name}" if name else ""):
                return part.yield_stress or math.nan
        return math.nan

    def pictures(self, answer: AnswerData) -> Iterator[Picture]:
        """The numbers at the top of the report against the values."""
        keys = [*self.values]
        table = answer.tables["sweep"].rename(columns={f"at_{key}": key for key in keys})
        caption = f"Sweep: numbers of the answer against the {words_of(keys[0])}, with their errors"
        caption += f"; a line for each {words_of(keys[1])}." if len(keys) > 1 else "."
        chosen = self._chosen(answer.records)
        limit = math.nan if chosen is None else self._limit(answer.case, chosen)
        if not math.isnan(limit):
            caption = f"{caption[:-1]}; the dotted line is the limit."
        yield Picture("sweep", caption, _drawn(answer.case, table, keys, chosen, limit))


def _alone(case: Any) -> Any:
    """The case without the questions that ask for further cases."""
    return case.replaced(sweep=None, sensitivity=None)


def _owner(case: Scene, key: str) -> tuple[type[Settings], str]:
    """Class of the group that has a setting, and the name of the setting; `ValueError` if there is none."""
    group, _, name = key.rpartition(".")
    owner = value_at(case, group) if group else None
    if isinstance(owner, tuple) or owner is None:
        group = group or key
        raise ValueError(f": the case has no group {group}, whose setting could be varied")
    known = type(owner).model_fields if isinstance(owner, Settings) else {}
    if name not in known:
        near = did_you_mean(name, known) or f"; known here are {', '.join(known)}"
        raise ValueError(f": unknown key{near}")
    return type(owner), name


def _read(case: Scene, key: str, given: Any) -> float:
    """A value of a setting in SI units; `ValueError` with the message after the key."""
    owner, name = _owner(case, key)
    entry = entry_of(owner, name)
    value = scalar(given, entry) if isinstance(given, str) else given
    try:
        found = check_of(owner, name).validate_python(value)
    except (ValidationError, ValueError):
        raise ValueError(f" = {shown_value(given)}: {accepted(entry)} is needed") from None
    if _is_length_or_number(entry):
        if not isinstance(found, str):
            raise ValueError(f" = {shown_value(given)}: a length with its unit is needed")
        return to_si(found, "length")
    if isinstance(found, bool) or not isinstance(found, (int, float)):
        raise ValueError(f" = {shown_value(given)}: a setting that is a number is needed, and {name} is none")
    return found


def _is_length_or_number(entry: Mapping[str, Any]) -> bool:
    """True for a length of a map, whose bare number is in the unit of the map."""
    return [each.get("format", each["type"]) for each in entry.get("anyOf", ())] == ["number", "length"]


def _given(case: Scene, key: str, value: float) -> float | str:
    """A value in SI units as its setting takes it: a length of a map with its unit."""
    return f"{value!r} m" if _is_length_or_number(entry_of(*_owner(case, key))) else value


def _unit(case: Scene, key: str) -> str:
    """SI unit of a setting; "1" without one."""
    entry = entry_of(*_owner(case, key))
    kinds = [each.get("format", "") for each in entry.get("anyOf", [entry])]
    return next((DIMENSIONS[kind].unit for kind in kinds if kind in DIMENSIONS), entry.get("unit", "1"))


def _shown(case: Scene, key: str, value: float, digits: int = 4) -> str:
    """A value of a setting as text with its unit."""
    unit = _unit(case, key)
    if unit in (each.unit for each in DIMENSIONS.values()):
        return shown_si(value, unit, digits)
    return f"{value:.{digits}g}" + (f" {unit}" if digits < 15 and unit != "1" else "")


def words_of(key: str) -> str:
    """A dotted key in words: its last part."""
    return key.rpartition(".")[2].replace("_", " ")


def _in_si(limit: str | float, unit: str | None = None) -> float | None:
    """A limit in SI units; None if it is no quantity, or none in a given SI unit."""
    if not isinstance(limit, str):
        return float(limit)
    for name, dimension in DIMENSIONS.items():
        if unit in (None, dimension.unit):
            with suppress(ValueError):
                return to_si(limit, name)
    return None


def _at_limit(
    curve: Mapping[float, tuple[Record, float]], name: str, shown: Callable[[float], str]
) -> tuple[Record | None, str]:
    """The value of a setting at which a number meets its limit, and the sentence about it.

    It is interpolated by cubics that keep the data monotone, of logarithms where all of them exist. The error
    of the interpolation is the difference from straight lines; errors of the number follow from its slope.

    Parameters
    ----------
    curve : mapping
        Value of the setting → the number there, and its limit.
    name : str
        The setting in words.
    shown : callable
        Value of the setting → text with its unit.
    """
    from scipy.interpolate import PchipInterpolator
    from scipy.optimize import brentq

    values = np.array(sorted(curve))
    numbers, limits = zip(*(curve[value] for value in values), strict=True)
    first, last = numbers[0], numbers[-1]
    span = f"{name} from {shown(values[0])} to {shown(values[-1])}"
    if not all(map(math.isfinite, limits)):
        return (
            None,
            f"with the {span} the {first.quantity} goes from {first.best_text()} to {last.best_text()}",
        )
    best = np.array([each.best for each in numbers])
    is_log = bool(values[0] > 0 and best.min() > 0 and min(limits) > 0)
    along = np.log(values) if is_log else values
    excess = np.log(best / limits) if is_log else best - limits
    crossed = np.flatnonzero(np.diff(excess > 0))
    met = replace(first, value=limits[0], errors={}, extrapolated=math.nan).number(digits=3)
    if not crossed.size:
        side = "above" if excess[0] > 0 else "below"
        return None, f"the {first.quantity} stays {side} its limit, {met}, for the {span}"
    near = slice(int(crossed[0]), int(crossed[0]) + 2)
    slope = float(np.diff(excess[near])[0] / np.diff(along[near])[0])
    straight = along[near.start] - excess[near.start] / slope
    cubics, ends = PchipInterpolator(along, excess), along[near].tolist()
    root = float(brentq(lambda at: float(cubics(at)), *ends))
    value = math.exp(root) if is_log else root
    safe = "above" if first.better == "more" else "below"
    side = "above" if (slope > 0) == (safe == "above") else "below"
    sentence = f"the {first.quantity} is {safe} its limit, {met}, for a {name} {side} "
    note = f"of the {name}, where the {first.quantity} meets {met}"
    if not all(each.errors for each in numbers[near]):
        return Record(AT_LIMIT, value, note=f"{note}; its error is {NOT_KNOWN}"), sentence
    found, unit = Record(AT_LIMIT, value, note=note, varies=first.varies), value if is_log else 1.0
    found = found.with_error(SEARCH, unit * abs(root - straight))
    for cause in {*numbers[near.start].errors, *numbers[near.stop - 1].errors}:
        sizes = [each.errors.get(cause, 0.0) / (each.best if is_log else 1.0) for each in numbers[near]]
        size = unit * max(sizes) / abs(slope)
        found = found.with_error(cause, math.hypot(found.errors.get(cause, 0.0), size))
    return found, sentence


def _drawn(case: Scene, table: pd.DataFrame, keys: list[str], chosen: Record | None, limit: float) -> Any:
    """Shown numbers of a sweep against the values of its first key, a line for each value of the second."""
    from asperity.engineering.drawing import plain_logarithms
    from asperity.views.panels import canvas

    shown = table[table["is_shown"] & np.isfinite(table["value"].astype(float))]
    first = [] if chosen is None else [(chosen.quantity, chosen.body)]
    varying = shown[shown["value"] != 0]  # of a number that is 0 everywhere there is nothing to draw
    names = [*dict.fromkeys([*first, *zip(varying["quantity"], varying["body"], strict=True)])][:PANELS]
    per, symbol = Record("", table[keys[0]].max(), _unit(case, keys[0])).scale()
    several = len(case.different_bodies) > 1
    with canvas([0.8] * len(names), None) as (figure, axes, _):
        for axis, (quantity, body) in zip(axes, names, strict=True):
            rows = shown[(shown["quantity"] == quantity) & (shown["body"] == body)].sort_values(keys[0])
            bounds = FRACTION if (rows["bound"] == FRACTION.reason).all() else UNBOUNDED
            factor, of = Record("", rows["value"].abs().max(), rows["unit"].iloc[0], bounds=bounds).scale()
            for _, line in rows.groupby(keys[1:]) if len(keys) > 1 else [((), rows)]:
                best = line["extrapolated"].fillna(line["value"])
                ends = np.nan_to_num(np.abs(line[["low", "high"]].to_numpy().T - best.to_numpy()))
                other = [_shown(case, key, line[key].iloc[0]) for key in keys[1:]]
                label = " ".join([words_of(keys[-1]), *other])
                settings: Any = {"fmt": "-o", "ms": 3, "capsize": 2, "label": label}
                axis.errorbar(line[keys[0]] / per, best / factor, ends / factor, **settings)
            if (quantity, body) in first:
                axis.axhline(limit / factor, color="0.4", ls=":", lw=1)  # NaN draws nothing
            title = f"{quantity}, {body} body" if body and several else quantity
            axis.set_title("\n".join(wrap(title, 26)), loc="left", fontsize="medium")
            axis.set(xlabel=f"{words_of(keys[0])} ({symbol})" if symbol else words_of(keys[0]), ylabel=of)
            for values, along in ((rows[keys[0]], axis.xaxis), (rows["value"], axis.yaxis)):
                if values.min() > 0 and values.max() > WIDE * values.min():
                    plain_logarithms(along)
            if axis.get_yscale() == "linear" and rows["value"].min() >= 0:
                axis.set_ylim(bottom=0)
        if len(keys) > 1:
            axes[0].legend()
    return figure
