"""Maps of one surface as a sample: every number as its mean over the maps, with a 95 % interval.

The maximum of a peak on an area that was not measured follows from the peaks of the maps
(`asperity.stress.statistics.largest`).
"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Self, TypeVar

import numpy as np
import pandas as pd

from asperity.core.types import Array
from asperity.core.units import shown_si
from asperity.engineering.answer_data import AnswerData, at_the_top, case_in_words, without_repeats
from asperity.engineering.answer_files import read_data
from asperity.engineering.folder import manifests_of_sample
from asperity.engineering.places import CONFIDENCE
from asperity.engineering.questions.cycles import CRACKS, known_to_a_factor, no_crack
from asperity.engineering.records import (
    CAUSES,
    DISCRETISATION,
    PLANES,
    POSITIONS,
    Advice,
    Bounds,
    Position,
    Record,
    find,
    frame,
    record_of,
)
from asperity.engineering.scene import Scene
from asperity.stress.statistics.largest import FEWEST_PEAKS, Largest, check_area, largest_on
from asperity.surface.treatment.treatment import TreatedMap

SAME = 1e-6
"""Relative difference by rounding of pixels, and of numbers that are equal on all maps."""

OTHER_UNIT = 100
"""Ratio of rms heights from which two maps have heights in different units, as nm and µm."""

OTHER_SURFACE = 1.3
"""Ratio of rms heights from which maps may be of different surfaces: those of a ground one differ by 13 %."""

VOLUME, FRACTION_ABOVE = "volume above yield per area", "volume fraction above yield"
DEEPEST = "maximum depth above yield"

STRESS_LEVELS = 20
"""Stresses above which peaks are counted."""

MAXIMA = {
    "pressure": "maximum pressure",
    "von_mises": "maximum von Mises stress",
    "dang_van": "maximum Dang Van stress over limit",
}
"""Quantity of peaks → quantity whose discretisation error is used for its maximum on an area."""

ONE_MAP = "one map: differences between positions are not known"

Kind = TypeVar("Kind", bound="SampleData")

Item = TypeVar("Item", bound="AnswerData | SampleData")

Key = tuple[str, str, str]
"""Topic, body and quantity of a record."""


def key_of(record: Record) -> Key:
    """Topic, body and quantity of a record."""
    return record.topic, record.body, record.quantity


def label_of(record: Record) -> str:
    """Name of a number in a table of several maps, with the depth to which a fraction refers."""
    is_referred = record.quantity == FRACTION_ABOVE and record.note
    return f"{record.quantity}, {record.note}" if is_referred else record.quantity


def decisive(case: Scene, records: Iterable[Record]) -> list[Record]:
    """Records that say which of two surfaces is better, the first one first.

    Volumes above yield can be compared, and stand before stresses and fractions.
    """
    known = [each for each in at_the_top(case, [*records]) if each.better]
    first = next((number for number, each in enumerate(known) if each.topic == "stress"), 0)
    return [*known[:first], *sorted(known[first:], key=lambda each: each.quantity != VOLUME)]


def to_one_depth(records: Sequence[Record], deepest: Mapping[str, float]) -> list[Record]:
    """Records whose fraction above yield refers to the volume down to a depth of each body."""
    volumes = {each.body: each for each in records if each.quantity == VOLUME}

    def referred(each: Record) -> Record:
        if each.quantity != FRACTION_ABOVE or each.body not in deepest:
            return each
        volume, depth = volumes[each.body], deepest[each.body]
        errors = {cause: error / depth for cause, error in volume.errors.items()}
        note = f"down to {shown_si(depth, 'm', 3)}"
        return replace(each, value=volume.value / depth, extrapolated=math.nan, errors=errors, note=note)

    return [referred(each) for each in records]


def deepest_of(answers: Iterable[AnswerData]) -> dict[str, float]:
    """Body → the deepest point above yield in all answers."""
    found: dict[str, float] = {}
    for answer in answers:
        for each in find(answer.records, DEEPEST):
            found[each.body] = max(found.get(each.body, 0.0), each.value)
    return found


def is_same(values: Array) -> bool:
    """True for values that are equal up to rounding."""
    return bool(np.ptp(values) <= SAME * np.abs(values).max())


def mean_of_maps(records: Sequence[Record]) -> tuple[Record, Array]:
    """Mean of a number over maps of one surface with its errors, and the values that it is the mean of.

    The mean is extrapolated to zero pixel size where all maps are. Half of the interval between positions
    follows from Student's t over the maps. The other errors have the same sign on all maps, so that they do
    not fall with their number.

    Parameters
    ----------
    records : sequence of Record
        The same quantity of each map.

    Examples
    --------
    >>> from asperity.engineering.records import DISCRETISATION, POSITIONS, Record
    >>> from asperity.engineering.sample import mean_of_maps
    >>> maps = [Record("gap", value, "m", errors={DISCRETISATION: 0.01}) for value in (0.29, 0.30, 0.31)]
    >>> found, _ = mean_of_maps(maps)
    >>> print(f"{found.value:.2f} ± {found.error:.3f}, between positions ± {found.errors[POSITIONS]:.3f}")
    0.30 ± 0.027, between positions ± 0.025
    """
    from scipy.special import stdtrit

    first, count = records[0], len(records)
    of_pixels = {cause for each in records for cause in each.errors} & {DISCRETISATION, PLANES}
    whole = all(math.isfinite(each.extrapolated) or of_pixels & {*each.errors} for each in records)
    values = np.array([each.best if whole else each.value for each in records])
    errors = {
        cause: float(np.mean([each.errors.get(cause, 0.0) for each in records]))
        for cause in CAUSES
        if cause != POSITIONS and (whole or cause not in of_pixels)
    }
    if count > 1:
        scatter = 0.0 if is_same(values) else float(values.std(ddof=1))
        errors[POSITIONS] = float(stdtrit(count - 1, (1 + CONFIDENCE) / 2) * scatter / np.sqrt(count))
    is_extrapolated = whole and any(math.isfinite(each.extrapolated) for each in records)
    low, high = min(each.bounds.low for each in records), max(each.bounds.high for each in records)
    mean = replace(
        first,
        value=float(np.mean([each.value for each in records])),
        extrapolated=float(values.mean()) if is_extrapolated else math.nan,
        errors=errors,
        bounds=Bounds(low, high, first.bounds.reason),
        position=Position(float(np.mean([each.position.depth for each in records]))),
        words=first.words if all(each.words == first.words for each in records) else "",
        note=first.note if all(each.note == first.note for each in records) else "",
        varies=first.varies and count == 1,
        lacks=tuple(dict.fromkeys(cause for each in records for cause in each.lacks)),
    )
    return mean, values


def pooled_cracks(mean: Record, records: Sequence[Record]) -> Record:
    """The mean of expected cracks with the ends of its interval, which are combined as logarithms.

    The factors by discretisation are common to all maps. The scatter between positions is added to each of
    them as its relative half-width.
    """
    values = np.array([each.value for each in records])
    if not values.all() or not np.isfinite([each.ends for each in records]).all():
        return replace(mean, ends=records[0].ends if is_same(values) else (math.nan, math.nan), errors={})
    common = np.log(np.maximum([np.divide(each.ends, each.value) for each in records], 1e-300)).mean(axis=0)
    both = np.array([-1, 1]) * np.hypot(common, np.nan_to_num(mean.error) / mean.value)
    low, high = (mean.value * np.exp(both)).tolist()
    return replace(mean, ends=(low, high), errors={})


def pooled(answers: Mapping[str, AnswerData], kind: type[Kind]) -> Kind:
    """The sample, as an object of a kind, of the answers of maps of one surface, in one case.

    Raises
    ------
    ValueError
        If there is no answer, or one twice, or maps, bodies or loads differ.
    """
    if not answers:
        raise ValueError("answers: at least one is needed")
    if len({answer.folder or id(answer) for answer in answers.values()}) < len(answers):
        raise ValueError("answers: one is given twice; each position is needed once")
    check_alike({name: answer.face for name, answer in answers.items()})
    cases = {name: case_in_words(answer.case) for name, answer in answers.items()}
    first, *_ = cases
    for name, case in cases.items():
        if case != cases[first]:
            raise ValueError(f"answers: {name} is of {case}, {first} of {cases[first]}; one case is needed")
    return kind(answers)


def named(items: Sequence[Item]) -> dict[str, Item]:
    """Answers and samples by names of folders or maps, with a number where several have one name."""
    names = []
    for each in items:
        own = each.folder.name if isinstance(each, AnswerData) and each.folder else ""
        names.append(own or (each.names[0] if isinstance(each, SampleData) else each.face.name))
    count = Counter(names)
    unique = [name if count[name] == 1 else f"{name} {number}" for number, name in enumerate(names, 1)]
    return dict(zip(unique, items, strict=True))


def check_alike(faces: Mapping[str, TreatedMap]) -> None:
    """Raise `ValueError` for maps of different pixels, or of heights in different units."""
    (first, known), *others = faces.items()
    for name, face in others:
        pixels = [each.grid.spacing for each in (face, known)]
        if any(abs(a / b - 1) > SAME for a, b in zip(*pixels, strict=True)):
            own, other = (f"{shown_si(x, 'm')} x {shown_si(y, 'm')}" for y, x in pixels)
            needed = "maps of the same pixels are needed"
            raise ValueError(f"pooled: {name} has pixels of {own}, {first} of {other}; {needed}")
        heights = [float(each.height.std()) for each in (face, known)]
        if max(heights) > OTHER_UNIT * min(heights):
            own, other = (shown_si(height, "m") for height in heights)
            raise ValueError(f"pooled: {name} has Sq = {own}, {first} has {other}; the same unit is needed")


def doubt_of_one_surface(heights: Mapping[str, float]) -> str:
    """A sentence about the rms heights of maps that are to be pooled; empty if they are alike."""
    low, high = (choose(heights, key=heights.__getitem__) for choose in (min, max))
    if heights[high] <= OTHER_SURFACE * heights[low]:
        return ""
    values = (f"{shown_si(heights[name], 'm', 3)} on {name}" for name in (low, high))
    return f"Sq is {' and '.join(values)}: pool positions of one surface, and compare different surfaces"


def warnings_by_kind(answers: Mapping[str, AnswerData]) -> list[Advice]:
    """Warnings of several maps, one of each subject: number of maps, and the text of the first."""
    kinds: dict[str, dict[str, str]] = {}
    for name, answer in answers.items():
        for each in answer.warnings:
            if each.warns:
                kinds.setdefault(each.subject, {}).setdefault(name, each.text)
    shown = {subject: f"{len(found)} of {len(answers)} maps" for subject, found in kinds.items()}
    firsts = {subject: next(iter(found.items())) for subject, found in kinds.items()}
    return [Advice(True, each, f"{shown[each]}; {': '.join(first)}") for each, first in firsts.items()]


@dataclass(frozen=True, eq=False, repr=False)
class SampleData:
    """Answers of several maps of one surface, and the means of their numbers.

    Attributes
    ----------
    answers : mapping
        Name of a map → its answer.
    deepest : mapping
        Body → depth to which the fraction above yield refers; by default the deepest point above yield.
    """

    answers: Mapping[str, AnswerData]
    deepest: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def read(cls, folder: Path, kind: type[AnswerData] = AnswerData) -> Self:
        """The sample in a folder, of the answers, as objects of a kind, in the folders of its maps."""
        names = manifests_of_sample(folder)
        return pooled({name: read_data(folder / name, kind) for name in names}, cls)

    @property
    def names(self) -> tuple[str, ...]:
        """Of the maps."""
        return tuple(self.answers)

    @property
    def case(self) -> Scene:
        """The case of the first map."""
        return next(iter(self.answers.values())).case

    @property
    def heading(self) -> str:
        """Number of maps."""
        return f"{len(self.names)} map{'s' * (len(self.names) > 1)} of one surface"

    @property
    def title(self) -> str:
        """Number of maps, and the case in words."""
        return f"{self.heading}: {case_in_words(self.case)}"

    @cached_property
    def _means(self) -> dict[Key, tuple[Record, Array]]:
        """Mean and values of the numbers that all maps have."""
        deepest = self.deepest or deepest_of(self.answers.values())
        maps = [
            {key_of(each): each for each in to_one_depth(answer.records, deepest)}
            for answer in self.answers.values()
        ]
        common = (key for key in maps[0] if all(key in each for each in maps))
        found = {key: mean_of_maps([each[key] for each in maps]) for key in common}
        for key, (mean, values) in [*found.items()]:
            if mean.quantity == CRACKS:
                mean = pooled_cracks(mean, [each[key] for each in maps])
                found[key] = known_to_a_factor(mean), values
                nominal = float(self.areas.mean())
                for where, area in self.case.questions["cycles"].areas(nominal).items():
                    none = no_crack(mean, where, area, nominal)
                    found[key_of(none)] = none, found[key_of(none)][1]
        return found

    @property
    def records(self) -> tuple[Record, ...]:
        """Means over the maps; errors between positions follow from the maps."""
        return tuple(mean for mean, _ in self._means.values())

    def values(self, record: Record) -> Array:
        """Values on each map whose mean is the best value of a record."""
        return self._means[key_of(record)][1]

    def __getitem__(self, quantity: str) -> Record:
        return self.record(quantity)

    def record(self, quantity: str, body: str | None = None) -> Record:
        """The mean of a quantity, of one body or of the first that has it; `KeyError` if there is none."""
        return record_of(self.records, quantity, body)

    @property
    def tiles(self) -> list[Record]:
        """Records at the top of a page: first those that decide."""
        shown = without_repeats(self.records)
        keys = {key_of(each): each for each in (*decisive(self.case, shown), *at_the_top(self.case, shown))}
        return list(keys.values())

    @property
    def verdict(self) -> tuple[str, ...]:
        """The number that decides, with its whole interval, the number of maps, and the largest cause."""
        found, count = [], len(self.names)
        yielding = [
            any(each.value > 0 for each in find(one.records, VOLUME)) for one in self.answers.values()
        ]
        above = [f"Above the yield stress on {sum(yielding)} of {count} map{'s' * (count > 1)}."]
        above *= "yielding" in self.case.questions
        maps = "on 1 map" if count == 1 else f"as the mean over {count} maps"
        for each in self.tiles:
            if each.best == 0 and not each.error > 0:
                found.append(f"{each.quantity[0].upper()}{each.quantity[1:]}: none {maps}.")
                continue
            text = f"{each.quantity[0].upper()}{each.quantity[1:]}: {each.best_text()} {maps}"
            if count == 1:
                text += "; differences between positions are not known"
            elif len(each.errors) > 1:
                text += f"; most of the interval comes from {cause_of(each)}"
            return *found, f"{text}.", *above
        return tuple(found)

    @property
    def warnings(self) -> list[Advice]:
        """Warnings of the maps, one of each subject."""
        doubt = doubt_of_one_surface({name: each["Sq"].value for name, each in self.answers.items()})
        found = [Advice(True, "different surfaces", doubt)] if doubt else []
        return [*found, *warnings_by_kind(self.answers)]

    def frame(self) -> pd.DataFrame:
        """All means, and the value of each map; the columns are described in ``docs/tables.md``."""
        of_maps = np.array([values for _, values in self._means.values()])
        columns = {f"map_{name}": of_maps[:, number] for number, name in enumerate(self.names)}
        return frame(self.records).assign(**columns)

    @cached_property
    def areas(self) -> Array:
        """Nominal area of each map in m²."""
        return np.array([answer.record("nominal area").value for answer in self.answers.values()])

    def _peaks(self) -> Iterator[tuple[str, str, list[Array]]]:
        """Body, quantity, and the sizes of its peaks on each map.

        The pressure acts on both bodies. Bodies of one material have the same von Mises stress, too; under
        friction, which has the opposite direction in the other body, this holds for its distribution.
        """
        bodies = [*self.case.bodies.values()]
        common = ["pressure", "von_mises"] if bodies[0].is_like(bodies[-1]) else ["pressure"]
        each_map = {name: answer.tables["peaks"] for name, answer in self.answers.items()}
        peaks = pd.concat([table.assign(map=name) for name, table in each_map.items()])
        peaks["value_Pa"] = peaks["value_Pa"].abs()
        for (body, quantity), part in peaks.groupby(["body", "quantity"]):
            if quantity in common:  # of the body with the largest peak
                part = peaks[peaks["quantity"] == quantity].reset_index()
                part = part[part["body"] == part.loc[part["value_Pa"].idxmax(), "body"]]
            if body == "lower" or quantity not in common:
                yield body, quantity, [_counted(part[part["map"] == name]) for name in each_map]

    def peaks_per_area(self) -> pd.DataFrame:
        """Peaks above a stress per nominal area, as means over the maps; columns as in ``docs/tables.md``."""
        found = []
        for body, quantity, sizes in self._peaks():
            highest = max((float(size.max()) for size in sizes if size.size), default=0.0)
            for level in highest * np.linspace(0, 1, STRESS_LEVELS, endpoint=False):
                each = np.array([np.count_nonzero(size > level) for size in sizes]) / (1e6 * self.areas)
                mean, _ = mean_of_maps([Record(quantity, value) for value in each.tolist()])
                error = mean.error if len(self.names) == 1 else mean.errors.get(POSITIONS, 0.0)
                found.append((body, quantity, level, mean.value, error, *each))
        columns = ["body", "quantity", "stress_Pa", "per_mm2", "error_per_mm2"]
        return pd.DataFrame(found, columns=[*columns, *(f"map_{name}" for name in self.names)])

    def maximum(self, area: float) -> pd.DataFrame:
        """Maximum pressure, stresses and Dang Van stress that are expected on an area, by their peaks.

        Parameters
        ----------
        area : float
            In m²; at most `MAX_AREA_RATIO` times the area of all maps together.

        Returns
        -------
        DataFrame
            Columns as in ``docs/tables.md``. The interval holds the discretisation error, too. There is no
            row for fewer than 40 peaks.

        Raises
        ------
        ValueError
            If the area is larger.
        """
        total, found = float(self.areas.sum()), []
        check_area(area, total)
        for body, quantity, sizes in self._peaks():
            if sum(size.size for size in sizes) >= 2 * FEWEST_PEAKS:
                value = largest_on(sizes, total, area)
                means = list(find(self.records, MAXIMA.get(quantity, "")))
                share = max((each.errors.get(DISCRETISATION, 0.0) / each.best for each in means), default=0.0)
                size = value.value
                low, high = size + np.hypot(np.subtract(value[1:3], size), share * size) * (-1, 1)
                of_hardness = (each.bounds.high for each in means if quantity == "pressure")
                highest = min(of_hardness, default=np.inf)
                ends = np.minimum((size, low, high), highest)
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
            Columns body, area_m2, no_crack, and low and high of its 95 % interval, NaN where the
            discretisation error of the stress is not known. No rows without a scatter of the fatigue limit.
        """
        found = []
        for each in find(self.records, CRACKS):
            ends = np.exp(-area * np.array([each.value, *reversed(each.ends)]))
            found.append((each.body, area, *ends))
        return pd.DataFrame(found, columns=["body", "area_m2", "no_crack", "low", "high"])

    def __repr__(self) -> str:
        return f"<Sample of {self.title}>"


def _counted(peaks: pd.DataFrame) -> Array:
    """Values of as many peaks of a map as they count for, the highest and then equally spaced ones."""
    falling = peaks.sort_values("value_Pa", ascending=False)
    number = np.ceil(falling["counts_for"].cumsum() - 1e-9)
    return falling["value_Pa"][number.diff().fillna(1) > 0].to_numpy()


def cause_of(record: Record) -> str:
    """The largest cause of the error of a mean."""
    largest = max(record.errors, key=lambda cause: record.errors[cause])
    return "differences " + largest if largest == POSITIONS else largest
