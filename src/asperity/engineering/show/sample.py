"""A sample of maps as text, as a page and as a folder."""

import json
from collections.abc import Iterator
from pathlib import Path
from textwrap import fill
from typing import Any

import pandas as pd

from asperity.core.markup import table
from asperity.core.system import sha256_of
from asperity.core.units import shown_si
from asperity.engineering.answer_data import REPEATS, by_topic, case_in_words, without_repeats
from asperity.engineering.case_file import pool_text
from asperity.engineering.folder import CASE_FILE, MANIFEST, SAMPLE_DATA, locked, names_in, replacing
from asperity.engineering.questions.cycles import CRACKS, chance
from asperity.engineering.records import find
from asperity.engineering.sample import ONE_MAP, SampleData, label_of
from asperity.engineering.show.report import page_of
from asperity.engineering.show.tables import WIDEST, in_columns, tiles_of
from asperity.results.atomic import write_text
from asperity.results.tables import write_table, write_workbook
from asperity.surface.reading.height_map import HeightMap

SHOWN_MAPS = 3
"""Maps whose pictures are shown."""

QUANTITIES = {"von_mises": "von Mises stress", "dang_van": "Dang Van stress"}
"""Quantity of peaks → its name, if that is another one."""

MEANS = (
    "Means over the maps, extrapolated to zero pixel size where all maps are, ± half of the 95 % interval: "
    "Student's t over the maps, and the errors that all maps have in common."
)


def text(sample: SampleData) -> str:
    """The verdict, the means and the warnings as a block of text."""
    lines = [sample.title, f"maps: {', '.join(sample.names)}", "", *sample.verdict, *predicted(sample)]
    lines = [in_columns(_numbers(sample), [*(fill(each, WIDEST) for each in lines), ""])]
    lines += [f"\n{fill(f'warning: {each.subject}: {each.text}', WIDEST)}" for each in sample.warnings]
    return "\n".join(lines)


def page(sample: SampleData, folder: Path | None = None) -> str:
    """The sample as a page; names of files in its case file are relative to the folder."""
    shown = dict(list(sample.answers.items())[:SHOWN_MAPS])
    means = f"{ONE_MAP[0].upper()}{ONE_MAP[1:]}." if len(sample.names) == 1 else MEANS
    repeats = len(without_repeats(sample.records)) < len(sample.records)
    return page_of(
        [*sample.verdict, *predicted(sample)],
        _numbers(sample),
        sample.answers,
        shown,
        title=f"{', '.join(sample.names)}: contact and stress",
        heading=sample.heading,
        case=case_in_words(sample.case),
        tiles=tiles_of(sample.tiles),
        notes=[means, *([f"{REPEATS[0].upper()}{REPEATS[1:]}."] if repeats else [])],
        names=sample.names,
        case_file=_case_text(sample, folder or Path()),
    )


def tables(sample: SampleData) -> dict[str, pd.DataFrame]:
    """Name of a table → all means, peaks per area, and maxima on the area that is asked for."""
    found = {"sample": sample.frame(), "peaks_per_area": sample.peaks_per_area()}
    area = _area(sample)
    return found if area is None else found | {"maximum": sample.maximum(area)}


def preview(sample: SampleData) -> str:
    """The verdict and the numbers that decide, as a notebook shows them."""
    rows = [(each.quantity, each.best_text()) for each in sample.tiles]
    return table(sample.title, [*(("", each) for each in sample.verdict), *rows])


def write_sample(sample: SampleData, folder: Path) -> list[Path]:
    """Write tables, page and case file of a sample into the parent folder of the answers of its maps."""
    found = tables(sample)
    unwritten = (name for name, each in sample.answers.items() if each.folder is None)
    if missing := [name for name in sample.names if not (folder / name / MANIFEST).is_file()] or [*unwritten]:
        raise ValueError(f"{folder / missing[0]}: the answer of each map is needed there; write it first")
    with locked(folder), replacing(folder, kept=set()) as unfinished:
        for name, each in found.items():
            write_table(each, f"answer_{name}", unfinished / f"{name}.csv")
        write_workbook(found, unfinished / "sample.xlsx")
        write_text(unfinished / "sample.html", page(sample, folder))
        write_text(unfinished / CASE_FILE, _case_text(sample, folder))
        maps = {name: sha256_of(folder / name / MANIFEST) for name in sample.names}
        write_text(unfinished / SAMPLE_DATA, json.dumps({"maps": maps}))
    return [folder / name for name in sorted(names_in(folder))]


def predicted(sample: SampleData) -> Iterator[str]:
    """Sentences about maxima and cracks on the area that is asked for, or cracks on that of all maps."""
    area, bodies = _area(sample), [*sample.case.bodies.values()]
    alike = bodies[0].is_like(bodies[-1])
    maxima: list[Any] = [] if area is None else [*sample.maximum(area).itertuples()]
    for row in (each for each in maxima if each.body == "lower" or not alike):
        numbers: Any = row.low_Pa, row.value_Pa, row.high_Pa, row.threshold_Pa
        low, value, high, threshold = (shown_si(number, "Pa", 3) for number in numbers)
        between = "no interval of one map"
        if numbers[0] <= numbers[2]:
            between = "the hardness" if low == high else f"95 % between {low} and {high}"
        yield (
            f"Maximum {QUANTITIES.get(row.quantity, row.quantity)} in the {row.body} body on "
            f"{shown_si(row.area_m2, 'm^2')}: {value}, {between}; from {row.peaks} peaks above {threshold}, "
            f"{row.times:.3g} times the area of the maps."
        )
    cycles: Any = sample.case.questions.get("cycles")
    size = area or getattr(cycles, "area", None) or float(sample.areas.sum())
    for cracks in find(sample.records, CRACKS):
        times, where = size / float(sample.areas.sum()), f"{shown_si(size, 'm^2')} of the {cracks.body} body"
        text = f"Probability that a crack starts on {where}: {chance(cracks, size)}"
        text += "; differences between positions are not known" * (len(sample.names) == 1)
        text += f"; extrapolated to {times:.2g} times the area of the maps" * (times > 1)
        yield f"{text}; {cycles.lower_limits}."


def _area(sample: SampleData) -> float | None:
    """The area on which maxima are asked for."""
    asked = sample.case.questions.get("sample")
    return None if asked is None else asked.area


def _numbers(sample: SampleData) -> dict[str, pd.DataFrame]:
    """Heading → means and values of each map as texts."""
    found = {}
    for heading, records in by_topic(sample.case, without_repeats(sample.records)):
        rows = []
        for each in records:
            factor, symbol = each.scale()
            values = (
                f"{float(f'{value / factor:.3g}'):.15g} {symbol}".strip() for value in sample.values(each)
            )
            rows.append([label_of(each), each.best_text(), *values])
        found[heading] = pd.DataFrame(rows, columns=["", "mean", *sample.names])
    return found


def _case_text(sample: SampleData, folder: Path) -> str:
    """The case file of the maps; empty for maps that were given as arrays."""
    if any(isinstance(each.case.map.file, HeightMap) for each in sample.answers.values()):
        return ""
    return pool_text([(each.case, each.origin.files) for each in sample.answers.values()], folder)
