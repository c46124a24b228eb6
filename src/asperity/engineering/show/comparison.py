"""Answers and samples beside each other: their numbers, differences with intervals, and the better one."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from pathlib import Path
from textwrap import fill
from typing import NamedTuple

import numpy as np
import pandas as pd
from markupsafe import escape

from asperity.core.markup import html_table, with_error
from asperity.core.types import Array
from asperity.engineering.answer_data import AnswerData, case_in_words, heading, without_repeats
from asperity.engineering.case_file import leaves
from asperity.engineering.folder import COMPARISON, COMPARISON_DATA, locked, replacing
from asperity.engineering.places import CONFIDENCE
from asperity.engineering.records import POSITIONS, Record
from asperity.engineering.sample import (
    SAME,
    Key,
    SampleData,
    cause_of,
    decisive,
    deepest_of,
    is_same,
    key_of,
    label_of,
    named,
    to_one_depth,
)
from asperity.engineering.show.report import page_of
from asperity.engineering.show.tables import TILES, WIDEST, in_columns
from asperity.results.atomic import write_text
from asperity.results.tables import write_table

SIGNIFICANT = 0.05
"""Probability of a difference by chance below which one surface is called better."""

SHOWN_SURFACES = 4
"""Surfaces whose pictures are shown."""

LEAST_CHANCE = 1e-3
"""Smallest probability that is shown: a smaller one depends on the tails of the assumed distribution."""

OF_FILES = {"file", "channel", "unit", "physical_size", "height_factor", "missing"} | {
    *("mask", "orientation", "format", "max_memory", "periodic")
}
"""Settings of a map that say how to read its file, in which surfaces may differ."""

STAR = " *"
"""Mark of a number whose error is not whole, which the footnote explains."""

SHOWN_KEYS = 4
"""Keys that are named of those in which cases differ."""


class Difference(NamedTuple):
    """Difference of a number of two surfaces, second less first.

    Attributes
    ----------
    first, second : Record
    error : float
        Half of the 95 % interval of the difference, by all known causes; NaN without any, 0 of numbers that
        are equal on all maps of a sample.
    chance : float
        Probability of such a difference between maps of one surface; NaN unless there are several maps of
        each.
    """

    first: Record
    second: Record
    error: float
    chance: float

    @property
    def value(self) -> float:
        """The difference."""
        return self.second.best - self.first.best

    @property
    def is_complete(self) -> bool:
        """False if the difference has no interval although the numbers differ."""
        return not math.isnan(self.error) or math.isnan(self.value) or self.number == "none"

    @property
    def text(self) -> str:
        """The difference with its interval, or that this is not known."""
        return self.number if self.is_complete else f"{self.number} (± not known)"

    @property
    def number(self) -> str:
        """The difference with its interval where it has one."""
        if abs(self.value) <= SAME * abs(self.first.best):
            return "none"
        if math.isnan(self.value):
            return ""
        factor, symbol = max(self.first, self.second, key=lambda each: abs(each.best)).scale()
        return f"{with_error(self.value / factor, self.error / factor, signed=True)} {symbol}".strip()


def compared(items: Mapping[str, AnswerData | SampleData] | Sequence[AnswerData | SampleData]) -> Comparison:
    """Answers and samples beside each other, in their order; a sequence is named by its folders or maps.

    Raises
    ------
    ValueError
        If there are fewer than two.
    """
    if len(items) < 2:
        raise ValueError("answers: at least two are needed to compare them")
    each = [*items.values()] if isinstance(items, Mapping) else [*items]
    loads = [item.case.load for item in each if isinstance(item, SampleData)]
    if any(load != loads[0] for load in loads):
        raise ValueError("answers: samples under one load are needed to compare them")
    return Comparison(dict(items) if isinstance(items, Mapping) else named(items))


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """Answers and samples beside each other: ``print`` shows them, `frame` returns them as a table.

    Attributes
    ----------
    items : mapping
        Name → answer or sample.
    """

    items: Mapping[str, AnswerData | SampleData]

    @cached_property
    def _maps(self) -> dict[str, AnswerData]:
        """The answer of each map, those of a sample with the name of the sample before their own."""
        found: dict[str, AnswerData] = {}
        for name, item in self.items.items():
            each = item.answers if isinstance(item, SampleData) else {"": item}
            found |= {f"{name} {own}".strip(): answer for own, answer in each.items()}
        return found

    @cached_property
    def _items(self) -> dict[str, AnswerData | SampleData]:
        """The items; fractions above yield of samples refer to the depth of all items."""
        return {
            name: SampleData(item.answers, self._deepest) if isinstance(item, SampleData) else item
            for name, item in self.items.items()
        }

    @cached_property
    def _deepest(self) -> dict[str, float]:
        return deepest_of(self._maps.values())

    @cached_property
    def records(self) -> dict[str, dict[Key, Record]]:
        """Name → its records by topic, body and quantity; fractions above yield refer to one depth."""
        return {
            name: {key_of(each): each for each in without_repeats(to_one_depth(item.records, self._deepest))}
            for name, item in self._items.items()
        }

    def difference(self, key: Key, first: str, second: str) -> Difference:
        """Difference of a number of two of the items, which both have it."""
        one, other = (self.records[name][key] for name in (first, second))
        samples = [each for each in map(self._items.get, (first, second)) if isinstance(each, SampleData)]
        if len(samples) == 2 and all(len(sample.names) > 1 for sample in samples):
            values = [sample.values(each) for sample, each in zip(samples, (one, other), strict=True)]
            return _of_samples(one, other, values)
        return _of_errors(one, other)

    @cached_property
    def decisive(self) -> list[Record]:
        """Numbers of the first item that say which is the best, which all items have and not all as 0."""
        first, *_ = self.records.values()
        every = ((each, [of.get(key_of(each)) for of in self.records.values()]) for each in first.values())
        comparable = [each for each, known in every if all(known) and any(one.best for one in known if one)]
        return decisive(next(iter(self.items.values())).case, comparable)

    @cached_property
    def verdict(self) -> str:
        """The best of the items in the first number that decides, and what differs in their cases.

        It is empty if no number can decide.
        """
        if not self.decisive:
            return ""
        record = self.decisive[0]
        values = {name: records[key_of(record)].best for name, records in self.records.items()}
        order = sorted(values, key=lambda name: values[name], reverse=record.better == "more")
        return f"{self._judged(key_of(record), order)} {self._different}".strip()

    def _judged(self, key: Key, order: Sequence[str]) -> str:
        """Sentence about the best of the items, which are in falling order."""
        best, second, *_ = order
        found = self.difference(key, best, second)
        counts = {name: len(getattr(self.items[name], "names", [name])) for name in order}
        maps = {name: "1 map" if count == 1 else f"{count} maps" for name, count in counts.items()}
        known = {name: self.records[name][key] for name in order}
        first, *others = (f"{known[name].best_text(whole=False)} of {name} ({maps[name]})" for name in order)
        lacks = ", ".join(dict.fromkeys(each.lacking for each in known.values() if each.lacking))
        numbers = f"{found.first.quantity} {first}, against {' and '.join(others)}"
        numbers += f", {lacks}" if lacks else ""
        if found.text == "none":
            return f"{best} and {second} are equal: {numbers}."
        if math.isnan(found.chance):
            single = [name for name in (best, second) if counts[name] == 1]
            of = "one map each" if len(single) == 2 else f"{' and '.join(single)} is one map"
            parts = any(POSITIONS in known[name].errors for name in single)
            how = "estimated only from parts of one map" if parts else "not known"
            why = f"; {of}: differences between positions are {how}" if single else ""
            return f"Not known whether {best} is better: {numbers}{why}."
        # The pair of the best was chosen of all pairs (Bonferroni).
        chance = min(1.0, found.chance * math.comb(len(order), 2))
        judged = f"{best} is better" if chance < SIGNIFICANT else "No significant difference"
        wider = max(found.first, found.second, key=lambda each: each.error)
        shown = f"p = {chance:.2g}" if chance >= LEAST_CHANCE else f"p < {LEAST_CHANCE:g}"
        return f"{judged}: {numbers}; {shown}; most of the interval comes from {cause_of(wider)}."

    @cached_property
    def _different(self) -> str:
        """Sentence about keys in which the cases differ, the map apart; empty if there are none."""
        each = [
            dict(leaves(item.case.model_dump(mode="json", exclude={"map": OF_FILES, "materials": True})))
            for item in self.items.values()
        ]
        keys = dict.fromkeys(key for settings in each for key in settings)
        found = [key for key in keys if any(of.get(key) != each[0].get(key) for of in each)]
        if not found:
            return ""
        more = f" and {len(found) - SHOWN_KEYS} more" if len(found) > SHOWN_KEYS else ""
        named = ", ".join(found[:SHOWN_KEYS])
        return f"The cases differ in {named}{more}: the difference is not one of the surfaces alone."

    def frame(self) -> pd.DataFrame:
        """All numbers, and differences to the first; the columns are described in ``docs/tables.md``."""
        first, *others = self.records
        rows = []
        for key in dict.fromkeys(key for records in self.records.values() for key in records):
            known = {name: records.get(key) for name, records in self.records.items()}
            unit = next(each.unit for each in known.values() if each is not None)
            row: dict[str, object] = {"topic": key[0], "body": key[1], "quantity": key[2], "unit": unit}
            row |= {f"value_{name}": each.best if each else np.nan for name, each in known.items()}
            row |= {f"error_{name}": each.error if each else np.nan for name, each in known.items()}
            found = {
                name: self.difference(key, first, name) if known[first] and known[name] else None
                for name in others
            }
            row |= {f"difference_{name}": each.value if each else np.nan for name, each in found.items()}
            row |= {f"interval_{name}": each.error if each else np.nan for name, each in found.items()}
            row |= {f"chance_{name}": each.chance if each else np.nan for name, each in found.items()}
            rows.append(row)
        return pd.DataFrame(rows)

    def _numbers(self) -> dict[str, pd.DataFrame]:
        """Heading → the numbers as texts, of two items with their differences."""
        case, groups = self.items[next(iter(self.items))].case, dict[str, list[Key]]()
        for key in dict.fromkeys(key for records in self.records.values() for key in records):
            title = f"stress, {key[1]} body" if key[0] == "stress" else heading(case, *key[:2])
            groups.setdefault(title, []).append(key)
        return {title: self._table(keys) for title, keys in groups.items()}

    def _table(self, keys: Sequence[Key]) -> pd.DataFrame:
        """Some of the numbers as texts."""
        names, rows = [*self.records], []
        for key in keys:
            known = [self.records[name].get(key) for name in names]
            texts = [
                "" if each is None else f"{each.best_text(whole=False)}{STAR * bool(each.lacking)}"
                for each in known
            ]
            if len(names) == 2:
                found = self.difference(key, *names) if all(known) else None
                texts.append(f"{found.number}{STAR * (not found.is_complete)}" if found else "")
            rows.append([label_of(next(filter(None, known))), *texts])
        return pd.DataFrame(rows, columns=["", *names, *(["difference"] if len(names) == 2 else [])])

    def text(self) -> str:
        """The verdict and the numbers as lines of at most `WIDEST` characters."""
        lines = [fill(self.verdict, WIDEST), ""] if self.verdict else []
        return "\n".join([in_columns(self._numbers(), lines), *([self.footnote] if self.footnote else [])])

    @cached_property
    def footnote(self) -> str:
        """What the stars in the tables stand for; empty if there are none."""
        each_lacks = (each.lacking for records in self.records.values() for each in records.values())
        lacks = dict.fromkeys(filter(None, each_lacks))
        return f"* {' or '.join(lacks)}" if lacks else ""

    __str__ = text

    def _repr_html_(self) -> str:
        tables = [f"<p>{title}</p>{html_table(rows)}" for title, rows in self._numbers().items()]
        return f"<p><b>{escape(self.verdict)}</b></p>{''.join(tables)}<p>{self.footnote}</p>"

    def page(self, folder: Path | None = None) -> str:
        """The comparison as a page for a folder, with pictures of its first maps in one scale."""
        firsts = (next(iter(getattr(each, "answers", {"": each}).values())) for each in self.items.values())
        shown = dict([*zip(self.items, firsts, strict=True)][:SHOWN_SURFACES])
        cases = {name: case_in_words(item.case) for name, item in self.items.items()}
        same = len({*cases.values()}) == 1
        top = [key_of(each) for each in self.decisive][:TILES]
        return page_of(
            [self.verdict] if self.verdict else [],
            {"": self._table(top), **self._numbers()} if top else self._numbers(),
            self._maps,
            shown,
            title=" and ".join(self.items),
            heading=" and ".join(self.items),
            footnote=self.footnote,
            case=cases[next(iter(cases))] if same else "; ".join(f"{n}: {c}" for n, c in cases.items()),
            notes=["Numbers extrapolated to zero pixel size where they can be, ± their whole known error."],
            names=[name for name in self.items if folder and (folder / name / "report.html").is_file()],
        )

    def write(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write the table and the page into a folder, and the names of the folders of the answers.

        Raises
        ------
        ValueError
            If an answer has not been written, or the folder holds an answer or a sample.
        """
        folder = Path(folder)
        kept = {
            name: {own: _folder_of(each, folder) for own, each in item.answers.items()}
            if isinstance(item, SampleData)
            else _folder_of(item, folder)
            for name, item in self.items.items()
        }
        for one, other in combinations(self._maps.values(), 2):
            if one.folder == other.folder and one.records != other.records:
                raise ValueError(f"{one.folder}: holds one answer, two that are compared were written there")
        with locked(folder), replacing(folder, kept=set()) as unfinished:
            write_table(self.frame(), "answer_comparison", unfinished / COMPARISON[0])
            write_text(unfinished / COMPARISON[1], self.page(folder))
            write_text(unfinished / COMPARISON_DATA, json.dumps(kept))
        return [folder / name for name in COMPARISON]


def _folder_of(answer: AnswerData, folder: Path) -> str:
    """Name of the folder of an answer, relative to another one."""
    if answer.folder is None:
        raise ValueError(f"{folder}: the answer of {answer.face.name} is needed in a folder; write it first")
    return Path(os.path.relpath(answer.folder, folder)).as_posix()


def _of_errors(first: Record, second: Record) -> Difference:
    """Difference of two numbers by their errors; one map does not show the chance of a difference."""
    error = float(np.linalg.norm(np.nan_to_num([first.error, second.error]))) or math.nan
    return Difference(first, second, error, math.nan)


def _of_samples(first: Record, second: Record, values: Sequence[Array]) -> Difference:
    """Difference of the means of two samples by Welch's t test, with the errors that maps have in common.

    B. L. Welch, Biometrika 34 (1947) 28, doi 10.1093/biomet/34.1-2.28.
    """
    from scipy.special import stdtr, stdtrit

    common = [replace(each, errors=dict(each.errors) | {POSITIONS: 0.0}).error for each in (first, second)]
    squares = [0.0 if is_same(each) else each.var(ddof=1) / each.size for each in values]
    freedom = sum(squares) ** 2 / max(
        sum(square**2 / (each.size - 1) for square, each in zip(squares, values, strict=True)), 1e-300
    )
    quantile = float(stdtrit(max(freedom, 1.0), (1 + CONFIDENCE) / 2))
    error = float(np.linalg.norm([quantile * math.sqrt(sum(squares)), *np.nan_to_num(common)]))
    if not error:
        return Difference(first, second, 0.0, math.nan)
    size = abs(second.best - first.best) / error
    return Difference(first, second, error, 2 * float(stdtr(max(freedom, 1.0), -quantile * size)))
