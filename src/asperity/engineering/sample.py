"""Maps of one surface as a sample: every number as its mean over the maps, with a 95 % interval.

The largest value of a peak on an area that was not measured follows from the peaks of the maps
(`asperity.stress.statistics.largest`).
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import NamedTuple

import numpy as np
import pandas as pd

from asperity.core.markup import table, with_error
from asperity.core.types import Array, ArrayLike
from asperity.core.units import scaled_unit, shown_si
from asperity.engineering.answer import POSITION_NAMES, REPEATS, Answer, case_in_words, without_repeats
from asperity.engineering.places import CONFIDENCE
from asperity.engineering.question import IN_PER_CENT
from asperity.engineering.questions.cycles import CRACKS
from asperity.stress.statistics.largest import FEWEST_PEAKS, Largest, check_area, largest_on
from asperity.surface.treatment.treatment import TreatedMap

SAME_PIXELS = 1e-6
"""Relative difference by rounding of pixels, and of numbers that are equal on all maps."""

OTHER_UNIT = 100
"""Ratio of rms heights from which two maps have heights in different units, as nm and µm."""

VOLUME, DEEPEST_POINT = "volume above yield per area", "deepest point above yield"
"""Numbers from which the share above yield is computed."""

SCALED = "m", "m^2", "m^3", "Pa", "N"
"""Units that take prefixes."""

PER_AREA = "1/m^2"
"""Unit of numbers of peaks."""

STRESS_LEVELS = 20
"""Stresses above which peaks are counted."""

LARGEST = {
    "pressure": "largest pressure",
    "von_mises": "largest von Mises stress",
    "dang_van": "largest Dang Van stress over limit",
}
"""Quantity of peaks → number whose grid error is used for the largest value on an area."""

ONE_MAP = "one map: no interval, because parts of one map do not show how places of the surface differ"


def shown_unit(values: ArrayLike, unit: str, name: str) -> tuple[float, str]:
    """Factor and symbol of the unit in which values of a number are shown."""
    if unit == "1":
        return (0.01, "%") if name in IN_PER_CENT else (1.0, "")
    if unit == PER_AREA:
        return 1e6, "per mm²"
    return scaled_unit(values, unit) if unit in SCALED else (1.0, unit)


class Mean(NamedTuple):
    """Mean over the maps of a sample, half of its 95 % interval, and the two parts of the interval.

    Attributes
    ----------
    value : float
    error : float
        Root of the sum of the squares of both parts; NaN for one map.
    of_maps : float
        From Student's t over the maps; NaN for one map.
    of_grid : float
        Mean of the errors of the grid; NaN where no map has one.
    """

    value: float
    error: float
    of_maps: float
    of_grid: float


class SampleRow(NamedTuple):
    """One number of a sample: group, name, unit, its mean and interval, and its value on each map."""

    group: str
    name: str
    unit: str
    mean: Mean
    of_each: Array

    @property
    def value(self) -> float:
        """The mean."""
        return self.mean.value

    @property
    def shown(self) -> tuple[str, list[str]]:
        """The mean with half of its interval, and the value of each map, for a reader."""
        factor, symbol = shown_unit(self.of_each, self.unit, self.name)
        mean = with_error(self.mean.value / factor, self.mean.error / factor)
        each = [f"{float(f'{value / factor:.4g}'):.15g}" for value in self.of_each]
        return f"{mean} {symbol}".strip(), each


def mean_of_maps(values: ArrayLike, errors: ArrayLike = np.nan) -> Mean:
    """Mean of a number over maps of one surface, with its 95 % interval.

    Parameters
    ----------
    values : (maps,) array
    errors : (maps,) array, optional
        Error of the grid of each value, NaN where there is none. It has the same sign on all maps, so that it
        does not fall with their number.

    Examples
    --------
    >>> from asperity.engineering.sample import mean_of_maps
    >>> found = mean_of_maps([0.29, 0.30, 0.31], [0.01, 0.01, 0.01])
    >>> print(f"{found.value:.2f} ± {found.error:.3f}, without the grid ± {found.of_maps:.3f}")
    0.30 ± 0.027, without the grid ± 0.025
    """
    from scipy.stats import t

    values, known = np.asarray(values, dtype=float), np.ravel(errors)[np.isfinite(np.ravel(errors))]
    of_grid = float(np.abs(known).mean()) if known.size else np.nan
    of_maps = np.nan
    if values.size > 1:
        scatter = float(values.std(ddof=1)) if np.ptp(values) > SAME_PIXELS * np.abs(values).max() else 0.0
        of_maps = float(t.ppf((1 + CONFIDENCE) / 2, values.size - 1) * scatter / np.sqrt(values.size))
    return Mean(float(values.mean()), float(np.hypot(of_maps, np.nan_to_num(of_grid))), of_maps, of_grid)


def pool_answers(answers: Sequence[Answer]) -> "Sample":
    """The numbers of maps of one surface, in one case, as a sample.

    Parameters
    ----------
    answers : sequence of Answer
        Of `run`, for maps of different places, with the same pixels, bodies and load.

    Raises
    ------
    ValueError
        If there is no answer, or maps, bodies or loads differ.

    Examples
    --------
    >>> steel, edge = asp.Body(young=210e9, poisson=0.3), 2e-4
    >>> heights = [asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, 1e-7, seed, length=edge) for seed in range(3)]
    >>> maps = [asp.HeightMap(height, (edge, edge), periodic=True, name="ground") for height in heights]
    >>> sample = asp.pool_answers([asp.run(each, steel, mean_pressure=50e6) for each in maps])
    >>> area = sample.mean("contact", "real contact")
    >>> print(f"real contact {100 * area.value:.1f} ± {100 * area.error:.1f} %")
    real contact 5.1 ± 1.1 %
    """
    if not answers:
        raise ValueError("answers: at least one is needed")
    count = Counter(answer.face.name for answer in answers)
    names = [
        answer.face.name if count[answer.face.name] == 1 else f"{answer.face.name} {number}"
        for number, answer in enumerate(answers, 1)
    ]
    named = dict(zip(names, answers, strict=True))
    check_alike({name: answer.face for name, answer in named.items()})
    cases = {name: case_in_words(answer.case) for name, answer in named.items()}
    for name, case in cases.items():
        if case != cases[names[0]]:
            others = f"{names[0]} of {cases[names[0]]}"
            raise ValueError(f"answers: {name} is of {case}, {others}; one case is needed")
    kinds = Answer.frame, Answer.peaks, Answer.advice_table
    tables = [[table(answer).assign(map=name) for name, answer in named.items()] for table in kinds]
    return Sample(cases[names[0]], tuple(names), *(pd.concat(each, ignore_index=True) for each in tables))


def check_alike(faces: Mapping[str, TreatedMap]) -> None:
    """Raise `ValueError` for maps of different pixels, or of heights in different units."""
    (first, known), *others = faces.items()
    for name, face in others:
        pixels = [each.grid.spacing for each in (face, known)]
        if any(abs(a / b - 1) > SAME_PIXELS for a, b in zip(*pixels, strict=True)):
            own, other = (f"{shown_si(x, 'm')} x {shown_si(y, 'm')}" for y, x in pixels)
            needed = "maps of the same pixels are needed"
            raise ValueError(f"pooled: {name} has pixels of {own}, {first} of {other}; {needed}")
        heights = [float(each.height.std()) for each in (face, known)]
        if max(heights) > OTHER_UNIT * min(heights):
            own, other = (shown_si(height, "m") for height in heights)
            heights_of = f"{name} has an rms height of {own}, {first} of {other}"
            raise ValueError(f"pooled: {heights_of}; the same unit is needed")


def warnings_by_kind(advice: Mapping[str, pd.DataFrame]) -> list[str]:
    """Warnings of several maps, one line for each kind: number of maps, and the text of the first.

    `advice` is the name of a map → the table of `Answer.advice_table`.
    """
    kinds: dict[str, dict[str, str]] = {}
    for name, of_map in advice.items():
        for row in of_map[of_map["level"] == "warning"].itertuples():
            kinds.setdefault(row.subject, {}).setdefault(name, row.text)
    return [
        f"{subject}: {len(found)} of {len(advice)} maps; {next(iter(found))}: {next(iter(found.values()))}"
        for subject, found in kinds.items()
    ]


@dataclass(frozen=True, eq=False, repr=False)
class Sample:
    """Numbers of several maps of one surface; ``print`` shows their means, `frame` returns them as a table.

    Attributes
    ----------
    case : str
        Bodies and load in one line.
    names : tuple of str
        Of the maps.
    numbers : DataFrame
        Numbers of all maps as of `Answer.frame`, with the name of the ``map``.
    peaks : DataFrame
        Peaks of all maps as of `Answer.peaks`, with the name of the ``map``.
    advice : DataFrame
        Warnings and notes of all maps as of `Answer.advice_table`, with the name of the ``map``.
    """

    case: str
    names: tuple[str, ...]
    numbers: pd.DataFrame
    peaks: pd.DataFrame
    advice: pd.DataFrame

    @property
    def warnings(self) -> list[str]:
        """Warnings of the maps by kind."""
        return warnings_by_kind({name: self.advice[self.advice["map"] == name] for name in self.names})

    @cached_property
    def rows(self) -> list[SampleRow]:
        """Numbers that all maps have, line by line: estimates for vanishing pixels where all have one.

        The share above yield refers to the volume down to the deepest point above yield of all maps.
        """
        found: list[SampleRow] = []
        for (group, name), part in self.numbers.groupby(["group", "name"], sort=False):
            if len(part) < len(self.names):  # a percentile for which one of the maps has too few peaks
                continue
            of_maps = part.set_index("map").reindex(list(self.names))
            whole = of_maps["estimate"].notna().all()
            values = of_maps["estimate" if whole else "value"].to_numpy(dtype=float)
            errors = of_maps["error"] if whole else np.nan
            if name == "share above yield":
                volume = next(row for row in found if (row.group, row.name) == (group, VOLUME))
                deepest = (
                    self.numbers[self.numbers["name"] == DEEPEST_POINT].groupby("group")["value"].max()[group]
                )
                values, errors = volume.of_each / deepest, volume.mean.of_grid / deepest
            if name not in POSITION_NAMES[1:]:  # only a mean depth is meaningful
                found.append(
                    SampleRow(group, name, part["unit"].iloc[0], mean_of_maps(values, errors), values)
                )
        return found

    def mean(self, group: str, name: str) -> Mean:
        """Mean of a number, by its group and name as `frame` lists them.

        Raises
        ------
        KeyError
            If there is no such number.
        """
        for row in self.rows:
            if (row.group, row.name) == (group, name):
                return row.mean
        raise KeyError(f"{group}, {name}")

    def frame(self) -> pd.DataFrame:
        """All numbers as a table; the columns are described in ``docs/tables.md``."""
        columns = ["group", "name", "unit", "mean", "error", "error_of_maps", "error_of_grid"]
        columns += [f"map_{name}" for name in self.names]
        return pd.DataFrame([(*row[:3], *row.mean, *row.of_each) for row in self.rows], columns=columns)

    @cached_property
    def areas(self) -> Array:
        """Nominal area of each map in m²."""
        area = self.numbers[self.numbers["name"] == "nominal area"].set_index("map")["value"]
        return area[list(self.names)].to_numpy(dtype=float)

    def _peaks(self) -> Iterator[tuple[str, str, list[Array]]]:
        """Body, quantity, and the sizes of its peaks on each map.

        The pressure acts on both bodies. Bodies of one material have the same von Mises stress, too; under
        friction, which has the opposite direction in the other body, this holds for its distribution.
        """
        groups = set(self.numbers["group"])
        alike = any("upper" in group and group.replace("upper", "lower") in groups for group in groups)
        common = ["pressure", "von_mises"] if alike else ["pressure"]
        for (body, quantity), part in self.peaks.groupby(["body", "quantity"]):
            if body == "upper" and quantity in common:
                continue
            if quantity in common:  # of the body with the largest peak
                part = self.peaks[self.peaks["quantity"] == quantity]
                part = part[part["body"] == part.loc[part["value_Pa"].abs().idxmax(), "body"]]
            sizes = [part["value_Pa"][part["map"] == name].abs().to_numpy() for name in self.names]
            yield body, quantity, sizes

    def peaks_per_area(self) -> pd.DataFrame:
        """Peaks above a stress per nominal area, as means over the maps; columns as in ``docs/tables.md``."""
        found = []
        for body, quantity, sizes in self._peaks():
            highest = max((float(size.max()) for size in sizes if size.size), default=0.0)
            for level in highest * np.linspace(0, 1, STRESS_LEVELS, endpoint=False):
                each = np.array([np.count_nonzero(size > level) for size in sizes]) / (1e6 * self.areas)
                mean = mean_of_maps(each)
                found.append((body, quantity, level, mean.value, mean.error, *each))
        columns = ["body", "quantity", "stress_Pa", "per_mm2", "error_per_mm2"]
        return pd.DataFrame(found, columns=[*columns, *(f"map_{name}" for name in self.names)])

    def largest(self, area: float) -> pd.DataFrame:
        """Largest pressure, stresses and Dang Van stress that are expected on an area, by their peaks.

        Parameters
        ----------
        area : float
            In m²; at most `MAX_AREA_RATIO` times the area of all maps together.

        Returns
        -------
        DataFrame
            Columns as in ``docs/tables.md``. The interval holds the error of the grid, too. There is no row
            for fewer than 40 peaks.

        Raises
        ------
        ValueError
            If the area is larger.
        """
        total, found = float(self.areas.sum()), []
        check_area(area, total)
        least = self.numbers.groupby("name")["value"].min()
        hardness = np.inf if "plastic real contact" in least else float(least.get("hardness", np.inf))
        for body, quantity, sizes in self._peaks():
            if sum(size.size for size in sizes) >= 2 * FEWEST_PEAKS:
                value = largest_on(sizes, total, area)
                rows = [row.mean for row in self.rows if row.name == LARGEST.get(quantity)]
                share = max((row.of_grid / row.value for row in rows if row.of_grid > 0), default=0.0)
                size = value.value
                low, high = size + np.hypot(np.subtract(value[1:3], size), share * size) * (-1, 1)
                highest = hardness if quantity == "pressure" else np.inf
                ends = np.minimum((value.value, low, high), highest)
                found.append((body, quantity, area, *ends, *value[3:]))
        columns = ["body", "quantity", "area_m2", "value_Pa", "low_Pa", "high_Pa"]
        return pd.DataFrame(found, columns=[*columns, "threshold_Pa", *Largest._fields[4:]])

    def survival(self, area: float) -> pd.DataFrame:
        """Probability that no crack starts on an area, by the cracks expected per area; with its interval.

        Parameters
        ----------
        area : float
            In m².

        Returns
        -------
        DataFrame
            Columns group, area_m2, no_crack, and low and high of its 95 % interval, NaN for one map. No rows
            without a scatter of the fatigue limit.
        """
        found = []
        for row in self.rows:
            if row.name == CRACKS:
                mean, error = row.mean.value, row.mean.error if len(self.names) > 1 else np.nan
                ends = np.exp(-area * np.maximum([mean, mean + error, mean - error], 0))
                found.append((row.group, area, *ends))
        return pd.DataFrame(found, columns=["group", "area_m2", "no_crack", "low", "high"])

    def text(self) -> str:
        """The means as a block of text."""
        width = max(len(row.name) for row in self.rows)
        lines = [f"{len(self.names)} maps of one surface: {', '.join(self.names)}", self.case]
        lines += [ONE_MAP] if len(self.names) == 1 else []
        shown = without_repeats(self.rows)
        for group, rows in groupby(shown, key=lambda row: row.group):
            lines += ["", group]
            for row in rows:
                mean, each = row.shown
                lines.append(f"  {row.name:<{width}}  {mean:<24}  {'  '.join(each)}".rstrip())
        lines += ["", REPEATS] if len(shown) < len(self.rows) else []
        lines += [line for text in self.warnings for line in ("", f"warning: {text}")]
        return "\n".join(lines)

    __str__ = text

    def _repr_html_(self) -> str:
        return table(self.case, [(row.name, row.shown[0]) for row in self.rows])

    def __repr__(self) -> str:
        return f"<Sample of {len(self.names)} maps, {self.case}>"
