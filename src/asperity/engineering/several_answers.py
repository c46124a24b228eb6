"""The folder of several answers: side by side in a table and a page, or pooled to means with intervals.

The means and intervals are those of `asperity.engineering.sample`; differences between two surfaces, each of
one map or of a sample, have 95 % intervals.
"""

import json
import math
from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from textwrap import fill
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from asperity.core.errors import DatasetError
from asperity.core.markup import html_table, png, rendered, with_error
from asperity.core.system import sha256_of
from asperity.core.types import Array
from asperity.core.units import shown_si
from asperity.engineering.answer import REPEATS, Answer, case_in_words, tile_names, without_repeats
from asperity.engineering.case import Case
from asperity.engineering.case_file import case_of_answer, pool_text
from asperity.engineering.face import ReadFile
from asperity.engineering.folder import ANSWERS, CASE_FILE, COMPARISON, MANIFEST, SAMPLE, locked, replacing
from asperity.engineering.places import CONFIDENCE
from asperity.engineering.question import Row
from asperity.engineering.sample import ONE_MAP, SAME_PIXELS, Sample, SampleRow, shown_unit, warnings_by_kind
from asperity.engineering.values import in_one_scale, slider_of, values_in, values_of
from asperity.results.atomic import write_text
from asperity.results.tables import write_table, write_workbook

WIDEST = 100
"""Most characters of a line on the terminal."""

BETTER_IF_LESS = ("volume above", "share above", "largest", "peaks above")
"""Beginnings of the names of numbers that should be small."""

BETTER_IF_MORE = ("shakedown", "probability of no crack")
"""Beginnings of the names of numbers that should be large."""

SIGNIFICANT = 0.05
"""Probability of a difference by chance below which one surface is called better."""


def write_comparison(answers: Mapping[str, Answer], folder: Path) -> str:
    """Write ``comparison.csv`` and ``comparison.html`` into the parent folder of the answers.

    Parameters
    ----------
    answers : mapping
        Name of the folder of an answer → the answer.
    folder : Path

    Returns
    -------
    str
        The verdict on the better map, and the table, as text.
    """
    from asperity.engineering.pictures import compared_pictures

    rows = {name: without_repeats(answer.rows) for name, answer in answers.items()}
    shown: dict[str, dict[Any, str]] = {}
    for name, each in rows.items():
        shown[name] = {(group_of(row), row.name): row.value_and_place[0] for row in each}
    keys = dict.fromkeys(key for column in shown.values() for key in column)
    frame = pd.DataFrame([[*key, *(column.get(key, "") for column in shown.values())] for key in keys])
    frame.columns = pd.Index(["", "number", *shown])
    sentences = []
    if len(rows) == 2:
        found = differences(*rows.values())
        tiles = tile_names(next(iter(answers.values())).case)
        sentences = [text for text in [verdict(found, tuple(rows), tiles)] if text]  # type: ignore[arg-type]
        changes = {(each.group, each.name): each.shown[2] for each in found if each.error > 0}
        frame["difference"] = [changes.get(key, "") for key in keys]
    advice = {name: answer.advice_table() for name, answer in answers.items()}
    page = rendered(
        "asperity.engineering",
        "comparison.html.j2",
        title=" and ".join(answers),
        sentences=sentences,
        warnings=warnings_by_kind(advice),
        tables={"Numbers": html_table(frame)},
        pictures=[
            (each.caption, png(each.figure), values_of(each.figure)) for each in compared_pictures(answers)
        ],
        sliders=in_one_scale({name: slider_of(answer, "lower") for name, answer in answers.items()}),
        names=list(answers),
    )
    values = pd.concat([answer.frame().assign(map=name) for name, answer in answers.items()])
    with locked(folder), replacing(folder, kept=set()) as unfinished:
        write_table(values, "answer_comparison", unfinished / COMPARISON[0], float_format="%.8g")
        write_text(unfinished / COMPARISON[1], page)
    return "\n".join([*(fill(text, WIDEST) for text in sentences), "", *_lines(frame)])


def compare_samples(folders: Sequence[Path]) -> str:
    """Verdict on the better of two samples, and the differences of their means, of folders of pooled answers.

    Raises
    ------
    DatasetError
        If a folder does not hold pooled answers.
    """
    samples, cases = [], []
    for folder in folders:
        if not (folder / ANSWERS).is_file():
            raise DatasetError(f"{folder}: a folder of pooled answers is needed (--pooled)")
        names = list(json.loads((folder / ANSWERS).read_text(encoding="utf-8")))
        cases.append(Case.read(case_of_answer(folder / names[0])))
        samples.append(read_sample(folder, names, cases[-1]))
    first, second = (folder.name for folder in folders)
    found = differences(*(without_repeats(sample.rows) for sample in samples))
    width = max(len(each.name) for each in found) + 2
    cells = [("", first, second, "difference"), *((each.name, *each.shown) for each in found)]
    wide = [max(len(row[column]) for row in cells) + 2 for column in (1, 2)]
    lines = [f"{name:<{width}}{own:<{wide[0]}}{other:<{wide[1]}}{more}" for name, own, other, more in cells]
    sentence = verdict(found, (first, second), tile_names(cases[0]))
    return "\n".join([*([fill(sentence, WIDEST), ""] if sentence else []), *lines])


def _lines(frame: pd.DataFrame) -> list[str]:
    """The table as lines of at most `WIDEST` characters: further maps stand below, with the names again."""
    names, columns = list(frame["number"]), [*frame.columns[2:]]
    width = max(map(len, names)) + 4
    wide = {name: max(len(name), *(len(text) for text in frame[name])) + 2 for name in columns}
    found: list[str] = []
    while columns:
        here = [columns.pop(0)]
        while columns and width + sum(wide[name] for name in [*here, columns[0]]) <= WIDEST:
            here.append(columns.pop(0))
        found.append(" " * width + "".join(f"{name:<{wide[name]}}" for name in here))
        for group, part in frame.groupby("", sort=False):
            found.append(str(group))
            for row in part.to_dict("records"):
                cells = "".join(f"{row[name]:<{wide[name]}}" for name in here)
                found.append(f"  {row['number']:<{width - 2}}{cells}".rstrip()[:WIDEST])
        found.append("")
    return [line.rstrip() for line in found[:-1]]


POOLED_PICTURES = ("height", "pressure", "plane", "plane_lower", "cycles", "cycles_lower")
"""Pictures of the maps that stand beside each other, where there are such."""

SHOWN_MAPS = 3
"""Maps whose pictures are shown."""

QUANTITIES = {"pressure": "pressure", "von_mises": "von Mises stress", "dang_van": "Dang Van stress"}


def read_sample(folder: Path, names: Sequence[str], case: Case | None = None) -> Sample:
    """The sample of answers of maps in the folders of these names, with the words of their case."""

    def pooled(table: str) -> pd.DataFrame:
        each = [pd.read_csv(folder / name / f"{table}.csv").assign(map=name) for name in names]
        return pd.concat(each, ignore_index=True)

    words = "" if case is None else case_in_words(case)
    return Sample(words, tuple(names), *map(pooled, ("answer", "peaks", "advice")))


def write_sample(sample: Sample, folder: Path, cases: Sequence[tuple[Case, Sequence[ReadFile]]]) -> str:
    """Write tables, page and case file of pooled answers into the parent folder of the maps' answers.

    Parameters
    ----------
    sample : Sample
    folder : Path
    cases : sequence of (Case, files)
        Of each map.

    Returns
    -------
    str
        The means as text.
    """
    tables = {"answer_sample": sample.frame(), "answer_peaks_per_area": sample.peaks_per_area()}
    asked = cases[0][0].sample
    area = None if asked is None else asked.area
    largest = None if area is None else sample.largest(area)
    if largest is not None:
        tables["answer_largest"] = largest
    rows = without_repeats(sample.rows)
    repeats = REPEATS if len(rows) < len(sample.rows) else ""
    of_area = () if largest is None else largest.itertuples()
    predicted = [largest_in_words(row) for row in of_area if row.body == "lower" or not repeats]
    size = sample.areas.sum() if area is None else area
    predicted += [survival_in_words(row) for row in sample.survival(size).itertuples()]
    shown = {
        name: values_in((folder / name / "report.html").read_text(encoding="utf-8"))
        for name in sample.names[:SHOWN_MAPS]
    }
    page = rendered(
        "asperity.engineering",
        "sample.html.j2",
        title=f"{', '.join(sample.names)}: contact and stress",
        sample=sample,
        headline=[(row.name, row.shown[0]) for row in rows if row.name in tile_names(cases[0][0])],
        groups=groupby(rows, key=lambda row: row.group),
        predicted=predicted,
        one_map=ONE_MAP,
        repeats=repeats,
        pictures=[
            [(f"{name}/{picture}.png", values.get(picture)) for name, values in shown.items()]
            for picture in POOLED_PICTURES
            if (folder / sample.names[0] / f"{picture}.png").exists()
        ],
        sliders=in_one_scale({name: each["depths"] for name, each in shown.items() if "depths" in each}),
        case_file=(case := pool_text(cases, folder)),
    )
    with locked(folder), replacing(folder, kept=set()) as unfinished:
        for (table, frame), name in zip(tables.items(), SAMPLE, strict=False):
            write_table(frame, table, unfinished / name, float_format="%.8g")
        sheets = {name.removeprefix("answer_"): frame for name, frame in tables.items()}
        write_workbook(sheets, unfinished / "sample.xlsx")
        write_text(unfinished / "sample.html", page)
        write_text(unfinished / CASE_FILE, case)
        manifests = {name: sha256_of(folder / name / MANIFEST) for name in sample.names}
        write_text(unfinished / ANSWERS, json.dumps(manifests))
    return "\n".join([sample.text(), *([""] if predicted else []), *predicted])


def survival_in_words(row: Any) -> str:
    """One line about the probability that a crack starts, of a row of `Sample.survival`."""
    between = f"95 % between {1 - row.high:.2g} and {1 - row.low:.2g}"
    if not row.low <= row.high:
        between = "no interval of one map"
    area = shown_si(row.area_m2, "m^2")
    return f"probability that a crack starts on {area}: {1 - row.no_crack:.2g}, {between} ({row.group})"


def largest_in_words(row: Any) -> str:
    """One line about the largest value on an area, of a row of `Sample.largest`."""
    low, value, high, threshold = (
        shown_si(number, "Pa", 3) for number in (row.low_Pa, row.value_Pa, row.high_Pa, row.threshold_Pa)
    )
    between = f"95 % between {low} and {high}"
    if not row.low_Pa < row.high_Pa:
        between = "the hardness" if row.low_Pa == row.high_Pa else "no interval of one map"
    return (
        f"largest {QUANTITIES.get(row.quantity, row.quantity)} in the {row.body} body on "
        f"{shown_si(row.area_m2, 'm^2')}: {value}, {between}; from {row.peaks} peaks above {threshold}, "
        f"{row.times:.3g} times the area of the maps"
    )


class Difference(NamedTuple):
    """A number of two surfaces and its difference, second less first.

    Parameters
    ----------
    group, name, unit : str
        The group without the constants of a body, which differ between cases.
    first, second : float
    error : float
        Half of the 95 % interval of the difference: from place to place where that is known, and by the
        pixels.
    chance : float
        Probability of such a difference between maps of one surface; NaN where it is not known how places
        differ.
    """

    group: str
    name: str
    unit: str
    first: float
    second: float
    error: float
    chance: float

    @property
    def shown(self) -> tuple[str, str, str]:
        """Both numbers, and the difference with its interval, for a reader."""
        values = self.first, self.second
        factor, symbol = shown_unit(values, self.unit, self.name)
        first, second = (f"{float(f'{value / factor:.3g}'):.15g} {symbol}".strip() for value in values)
        if abs(self.second - self.first) <= SAME_PIXELS * abs(self.first):
            return first, second, "none"
        change = with_error((self.second - self.first) / factor, self.error / factor, signed=True)
        return first, second, f"{change} {symbol}".strip()

    @property
    def in_words(self) -> str:
        """The probability of the difference by chance."""
        if math.isnan(self.chance):
            return "from one place each: whether other places differ too is not known; add maps"
        return f"p = {self.chance:.2g}"


def differences(first: Sequence[Row | SampleRow], second: Sequence[Row | SampleRow]) -> list[Difference]:
    """Differences of all numbers that two answers, or two samples, have.

    The errors of two answers are taken to be normally distributed.
    """
    from scipy.stats import norm

    groups = {(group_of(row), row.name): row for row in second}
    found = []
    for row in first:
        other = groups.get((group_of(row), row.name))
        if isinstance(row, SampleRow) and isinstance(other, SampleRow):
            found.append(_of_samples(row, other))
        elif isinstance(row, Row) and isinstance(other, Row):
            values = [each.estimate if math.isfinite(each.estimate) else each.value for each in (row, other)]
            pixels = np.nan_to_num([each.error for each in (row, other)])
            places = np.array([each.error_of_places for each in (row, other)])
            error, chance = float(np.linalg.norm([*pixels, *np.nan_to_num(places)])), math.nan
            if np.isfinite(places).all() and error:
                size = abs(values[1] - values[0]) / error
                chance = 2 * float(norm.sf(norm.ppf((1 + CONFIDENCE) / 2) * size))
            numbers = group_of(row), row.name, row.unit, values[0], values[1]
            found.append(Difference(*numbers, error or math.nan, chance))
    return found


def group_of(row: Row | SampleRow) -> str:
    """Group of a row without the constants of a body, which differ between cases."""
    return row.group.partition(" (")[0]


def _of_samples(first: SampleRow, second: SampleRow) -> Difference:
    """Difference of the means of two samples by Welch's t test, with the errors of the pixels.

    B. L. Welch, Biometrika 34 (1947) 28, doi 10.1093/biomet/34.1-2.28.
    """
    from scipy.stats import t

    samples: list[Array] = [first.of_each, second.of_each]
    pixels = np.nan_to_num([first.mean.of_grid, second.mean.of_grid])
    found = group_of(first), first.name, first.unit, first.value, second.value
    if min(each.size for each in samples) < 2:
        return Difference(*found, float(np.linalg.norm(pixels)) or math.nan, math.nan)
    squares = [each.var(ddof=1) / each.size for each in samples]
    freedom = sum(squares) ** 2 / max(
        sum(square**2 / (each.size - 1) for square, each in zip(squares, samples, strict=True)), 1e-300
    )
    quantile = float(t.ppf((1 + CONFIDENCE) / 2, max(freedom, 1.0)))
    error = float(np.linalg.norm([quantile * math.sqrt(sum(squares)), *pixels]))
    if not error:
        return Difference(*found, math.nan, math.nan)
    size = abs(second.value - first.value) / error
    return Difference(*found, error, 2 * float(t.sf(quantile * size, max(freedom, 1.0))))


def verdict(found: Sequence[Difference], names: tuple[str, str], tiles: Sequence[str]) -> str:
    """One sentence: which of two surfaces is better, in the first of the tiles that can be judged."""
    judged = {each.name: each for each in found if each.name.startswith((*BETTER_IF_LESS, *BETTER_IF_MORE))}
    order = ["volume above yield per area", *tiles]
    each = next((judged[name] for name in order if name in judged), None)
    if each is None:
        return ""
    less = each.name.startswith(BETTER_IF_LESS)
    is_second = (each.second < each.first) == less
    own, other, _ = each.shown
    (best, worst), (value, against) = names, (own, other)
    if is_second:
        (worst, best), (against, value) = names, (own, other)
    if value == against:
        return f"{best} and {worst} have the same {each.name}, {value}."
    word = "not known to be better" if math.isnan(each.chance) else "no significant difference"
    if each.chance < SIGNIFICANT:
        word = "better"
    return f"{best}: {each.name} {value} against {against} of {worst}; {word}, {each.in_words}."
