"""The stored measurement of errors and times that bounds, costs and plans are made from (`measured.json`).

`make tradeoff` measures it anew (`asperity.study.cost.measurement`). Every output whose error is measured
belongs to one surface at one load and is taken from the statistics of one seed
(`asperity.study.stages.seed_numbers.seed_statistics`).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cache
from importlib.resources import files
from typing import Any, TypeVar

from asperity.study.config.presets import AccuracySettings

PARAMETERS = tuple(field.name for field in fields(AccuracySettings) if field.name != "seeds")
"""Parameters of accuracy of a single surface, each a source of error that is measured by itself."""

NUMBERS: dict[str, tuple[str, dict[str, Any]]] = {
    "proportionality": ("seed_proportionality", {}),
    "gradient_rms_contact": ("seed_gradient_rms_contact", {}),
    "pressure_p90": ("seed_peak_quantile", {"quantity": "pressure", "level": 0.9}),
    "pressure_p99": ("seed_peak_quantile", {"quantity": "pressure", "level": 0.99}),
    "von_mises_p90": ("seed_peak_quantile", {"quantity": "von_mises", "level": 0.9}),
    "von_mises_p99": ("seed_peak_quantile", {"quantity": "von_mises", "level": 0.99}),
    "largest_von_mises": ("seed_largest_von_mises", {}),
    "peak_depth": ("seed_mean_depth", {"quantity": "von_mises"}),
    "decay_length_depth": ("seed_decay_length_depth", {}),
    "decay_length_plane": ("seed_decay_length_plane", {}),
}
"""Outputs that are single numbers → variable of the statistics, and the coordinates at which it is taken.
Their errors are relative differences."""

DISTRIBUTIONS = {"pressure_distribution": "pressure", "von_mises_distribution": "von_mises"}
"""Outputs that are distributions of peaks → their quantity. Their error is the mean distance between equal
quantiles, divided by the mean peak."""

OUTPUTS = ("area_fraction", *NUMBERS, *DISTRIBUTIONS)
"""All outputs. The area fraction is compared at the mean pressure of the reference."""

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
        Stage → parameters of `asperity.study.cost.model.law_seconds`.
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
    return from_json(files("asperity.study.cost").joinpath("measured.json").read_text(encoding="utf-8"))


def at_area(by_area: Mapping[str, T], area_fraction: float) -> T | None:
    """Entry of the largest measured area fraction not above the given one; None if all are above it.

    Errors grow as the area falls, so that this entry is on the safe side.
    """
    smaller = [area for area in by_area if float(area) <= area_fraction * (1 + 1e-9)]
    return by_area[max(smaller, key=float)] if smaller else None
