"""Answers and samples beside each other: their numbers, differences with intervals, and the better one."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from textwrap import fill
from typing import NamedTuple

import numpy as np
import pandas as pd
from markupsafe import Markup, escape

from asperity.core.markup import html_table, rendered, with_error
from asperity.core.types import Array
from asperity.engineering.answer_data import AnswerData, case_in_words, heading, without_repeats
from asperity.engineering.folder import COMPARISON, COMPARISON_DATA, locked, replacing
from asperity.engineering.places import CONFIDENCE
from asperity.engineering.records import POSITIONS, Record
from asperity.engineering.sample import (
    SAME,
    Key,
    SampleData,
    decisive,
    deepest_of,
    is_same,
    key_of,
    named,
    to_one_depth,
    warnings_by_kind,
)
from asperity.engineering.show.pictures import compared_pictures, png_of
from asperity.engineering.show.report import Drawn
from asperity.results.atomic import write_text
from asperity.results.tables import write_table

WIDEST = 100
"""Most characters of a line on the terminal."""

SIGNIFICANT = 0.05
"""Probability of a difference by chance below which one surface is called better."""

SHOWN_SURFACES = 4
"""Surfaces whose pictures are shown."""


class Difference(NamedTuple):
    """Difference of a number of two surfaces, second less first.

    Attributes
    ----------
    first, second : Record
    error : float
        Half of the 95 % interval of the difference, by all known causes; NaN without any, 0 of numbers that
        are equal on all maps of a sample.
    chance : float
        Probability of such a difference between maps of one surface; NaN where it is not known how positions
        differ.
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
    def text(self) -> str:
        """The difference with its interval; empty without an interval."""
        if abs(self.value) <= SAME * abs(self.first.best):
            return "none"
        if math.isnan(self.error):
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
    loads = [next(iter(item.answers.values())).case.load for item in each if isinstance(item, SampleData)]
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
    def verdict(self) -> str:
        """The best of the items in the first number that decides; empty if no number can."""
        first, *_ = self.records
        for record in decisive(self.items[first].case, self.records[first].values()):
            key = key_of(record)
            known = [name for name, records in self.records.items() if key in records]
            values = {name: self.records[name][key].best for name in known}
            if len(known) == len(self.items) and any(values.values()):
                order = sorted(known, key=lambda name: values[name], reverse=record.better == "more")
                return self._judged(key, order)
        return ""

    def _judged(self, key: Key, order: Sequence[str]) -> str:
        """Sentence about the best of the items, which are in falling order."""
        best, second, *_ = order
        found = self.difference(key, best, second)
        texts = {name: self.records[name][key].best_text() for name in order}
        quantity = found.first.quantity
        others = " and ".join(f"{texts[name]} of {name}" for name in order[1:])
        if found.text == "none":
            rest = others.partition(" and ")[2]
            same = f"{best} and {second} have the same {quantity}, {texts[best]}"
            return f"{same}, against {rest}." if rest else f"{same}."
        # The pair of the best was chosen of all pairs (Bonferroni).
        chance = min(1.0, found.chance * math.comb(len(order), 2))
        if math.isnan(found.chance):
            single = [name for name in (best, second) if len(self._maps_of(name)) == 1]
            of = "one map each" if len(single) == 2 else f"{' and '.join(single)} is one map"
            judged = "not known to be better"
            judged += f"; {of}: differences between positions are not known" if single else ""
        else:
            judged = f"{'better' if chance < SIGNIFICANT else 'no significant difference'}, p = {chance:.2g}"
        return f"{best}: {quantity} {texts[best]} against {others}; {judged}."

    def _maps_of(self, name: str) -> Sequence[str]:
        item = self.items[name]
        return item.names if isinstance(item, SampleData) else [name]

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
        names, groups = [*self.records], dict[str, list[list[str]]]()
        for key in dict.fromkeys(key for records in self.records.values() for key in records):
            known = [self.records[name].get(key) for name in names]
            texts = ["" if each is None else each.best_text() for each in known]
            if len(names) == 2:
                texts.append(self.difference(key, *names).text if all(known) else "")
            title = "stress" if key[0] == "stress" else heading(self.items[names[0]].case, *key[:2])
            title = f"stress, {key[1]} body" if key[0] == "stress" else title
            groups.setdefault(title, []).append([key[2], *texts])
        columns = ["", *names, *(["difference"] if len(names) == 2 else [])]
        return {title: pd.DataFrame(rows, columns=columns) for title, rows in groups.items()}

    def text(self) -> str:
        """The verdict and the numbers as lines of at most `WIDEST` characters."""
        numbers = self._numbers()
        every = pd.concat(numbers.values())
        names, *columns = every.columns
        width = max(map(len, every[names])) + 4
        wide = {name: max(len(name), *map(len, every[name])) + 2 for name in columns}
        lines = [*([fill(self.verdict, WIDEST), ""] if self.verdict else [])]
        while columns:  # further columns stand below, with the names again
            here = [columns.pop(0)]
            while columns and width + sum(wide[name] for name in [*here, columns[0]]) <= WIDEST:
                here.append(columns.pop(0))
            lines.append(" " * width + "".join(f"{name:<{wide[name]}}" for name in here).rstrip())
            for title, table in numbers.items():
                lines.append(title)
                for row in table.to_dict("records"):
                    cells = "".join(f"{row[name]:<{wide[name]}}" for name in here)
                    lines.append(f"  {row['']:<{width - 2}}{cells}".rstrip())
            lines.append("")
        return "\n".join(lines[:-1])

    __str__ = text

    def _repr_html_(self) -> str:
        tables = [f"<p>{title}</p>{html_table(rows)}" for title, rows in self._numbers().items()]
        return f"<p><b>{escape(self.verdict)}</b></p>{''.join(tables)}"

    def page(self, folder: Path | None = None) -> str:
        """The comparison as a page for a folder, with pictures of its first maps in one scale."""
        shown = {name: self._first(name) for name in [*self.items][:SHOWN_SURFACES]}
        cases = {name: case_in_words(item.case) for name, item in self.items.items()}
        same = len({*cases.values()}) == 1
        return rendered(
            "asperity.engineering.show",
            "several.html.j2",
            title=" and ".join(self.items),
            heading=" and ".join(self.items),
            case=cases[next(iter(cases))] if same else "; ".join(f"{n}: {c}" for n, c in cases.items()),
            verdicts=[self.verdict] if self.verdict else [],
            tiles=[],
            warnings=warnings_by_kind(self._maps),
            notes=["Numbers extrapolated to zero pixel size where they can be, ± their whole known error."],
            tables={title: Markup(html_table(rows)) for title, rows in self._numbers().items()},
            pictures=[Drawn(each, png_of(each.figure)) for each in compared_pictures(shown)],
            names=[name for name in self.items if folder and (folder / name / "report.html").is_file()],
            case_file="",
        )

    def _first(self, name: str) -> AnswerData:
        item = self.items[name]
        return next(iter(item.answers.values())) if isinstance(item, SampleData) else item

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
    """Difference of two numbers, whose errors are taken to be normally distributed."""
    from scipy.stats import norm

    error = float(np.linalg.norm(np.nan_to_num([first.error, second.error]))) or math.nan
    chance = math.nan
    if all(POSITIONS in each.errors for each in (first, second)):
        size = abs(second.best - first.best) / error
        chance = 2 * float(norm.sf(norm.ppf((1 + CONFIDENCE) / 2) * size))
    return Difference(first, second, error, chance)


def _of_samples(first: Record, second: Record, values: Sequence[Array]) -> Difference:
    """Difference of the means of two samples by Welch's t test, with the errors that maps have in common.

    B. L. Welch, Biometrika 34 (1947) 28, doi 10.1093/biomet/34.1-2.28.
    """
    from scipy.stats import t

    common = [replace(each, errors=dict(each.errors) | {POSITIONS: 0.0}).error for each in (first, second)]
    squares = [0.0 if is_same(each) else each.var(ddof=1) / each.size for each in values]
    freedom = sum(squares) ** 2 / max(
        sum(square**2 / (each.size - 1) for square, each in zip(squares, values, strict=True)), 1e-300
    )
    quantile = float(t.ppf((1 + CONFIDENCE) / 2, max(freedom, 1.0)))
    error = float(np.linalg.norm([quantile * math.sqrt(sum(squares)), *np.nan_to_num(common)]))
    if not error:
        return Difference(first, second, 0.0, math.nan)
    size = abs(second.best - first.best) / error
    return Difference(first, second, error, 2 * float(t.sf(quantile * size, max(freedom, 1.0))))
