"""The stored measurement of errors and times that bounds, costs and plans are made from (`measured.json`).

`make tradeoff` measures it anew (`asperity.accuracy.measurement`, `asperity.accuracy.reduction`).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cache
from importlib.resources import files
from typing import TypeVar

from asperity.config.presets import AccuracySettings

PARAMETERS = tuple(field.name for field in fields(AccuracySettings) if field.name != "seeds")
"""Parameters of accuracy of a single surface, each a source of error that is measured by itself."""

T = TypeVar("T")

ErrorsBySetting = Mapping[str, Mapping[str, Mapping[str, float]]]
"""Parameter → setting → output → largest error."""


@dataclass(frozen=True)
class MeasuredTradeoff:
    """Errors and times of the settings of accuracy, reduced from all runs of the measurement.

    Parameters
    ----------
    errors : mapping
        Area fraction → parameter → setting → output → largest error of any scene.
    presets : mapping
        Preset → output → largest error of one surface at the largest area fraction, from all sources
        together; and ``seconds``, the mean processor time of one surface.
    deviation : mapping
        Area fraction → output → relative standard deviation of one surface from the mean over its seeds.
    time_laws : mapping
        Stage → parameters of `asperity.accuracy.resources.law_seconds`.
    memory : (bytes, bytes per node)
        Peak memory of one process that calculates all stages, with several loads and Poisson's ratios.
    transform : (points, seconds)
        Grid, and the time of a pair of transforms on it on the machine of the measurement.
    ranges : mapping
        Property of a scene → least and largest value measured.
    """

    errors: Mapping[str, ErrorsBySetting]
    presets: Mapping[str, Mapping[str, float]]
    deviation: Mapping[str, Mapping[str, float]]
    time_laws: Mapping[str, Mapping[str, float]]
    memory: tuple[float, float]
    transform: tuple[int, float]
    ranges: Mapping[str, Sequence[float]]


def as_json(measured: MeasuredTradeoff) -> str:
    """The measurement as JSON text; `from_json` reads it back."""
    return json.dumps(asdict(measured), indent=1) + "\n"


def from_json(text: str) -> MeasuredTradeoff:
    """The measurement from the text that `as_json` wrote."""
    return MeasuredTradeoff(**json.loads(text))


@cache
def load() -> MeasuredTradeoff:
    """The measurement that is stored in the package."""
    return from_json(files("asperity.accuracy").joinpath("measured.json").read_text(encoding="utf-8"))


def at_area(by_area: Mapping[str, T], area_fraction: float) -> T | None:
    """Entry of the largest measured area fraction not above the given one; None if all are above it.

    Errors grow as the area falls, so that this entry is on the safe side.
    """
    smaller = [area for area in by_area if float(area) <= area_fraction * (1 + 1e-9)]
    return by_area[max(smaller, key=float)] if smaller else None
