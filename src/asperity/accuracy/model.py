"""The measurement of `asperity.accuracy.measurement` in short: errors of every setting, laws of time and memory.

It is kept with the package, as text that a person can read: `load`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from importlib.resources import files
from typing import Any, TypeVar

import numpy as np
import xarray as xr
from scipy.optimize import least_squares

from asperity.accuracy.measurement import EXACT, OUTPUTS
from asperity.config.presets import PRESETS, AccuracySettings
from asperity.types import Array

SOURCES = ("discretisation", "depths", "contact", "half_space", "seeds")
"""Where errors come from."""

T = TypeVar("T")

KNOBS = tuple(name for name in asdict(EXACT) if name != "seeds")
"""AccuracySettings of one surface, each a source of error that was measured."""

LAWS: dict[str, tuple[str, ...]] = {
    "surface_seconds": (),
    "contact_seconds": ("contact_digits", "single", "area", "loads"),
    "stress_seconds": ("depth_digits", "spacing", "ratios"),
}
"""What each time is a power of, besides the grid."""


@dataclass(frozen=True)
class Measured:
    """The measurement in short.

    Parameters
    ----------
    errors : mapping
        Area fraction → knob → setting → output → largest error.
    presets : mapping
        Preset → output → largest error of one surface at the largest area fraction, all knobs together; and
        ``seconds``, the mean time.
    deviation : mapping
        Area fraction → output → deviation of one surface from the mean of its kind.
    laws : mapping
        Time → logarithms of its part that does not depend on the grid and of that for a node, and powers.
    memory : (base, per node) in bytes
    transform : (points, seconds)
        Time of a pair of transforms on the machine of the measurement.
    scenes : mapping
        Ranges of what was measured.
    """

    errors: Mapping[str, Mapping[str, Mapping[str, Mapping[str, float]]]]
    presets: Mapping[str, Mapping[str, float]]
    deviation: Mapping[str, Mapping[str, float]]
    laws: Mapping[str, Mapping[str, float]]
    memory: tuple[float, float]
    transform: tuple[int, float]
    scenes: Mapping[str, Sequence[float]]


def fit(dataset: xr.Dataset) -> Measured:
    """Reduce the measurement to bounds and laws.

    Parameters
    ----------
    dataset : dataset
        Of `asperity.accuracy.measurement.measure`.
    """
    areas = dataset["run_area_fraction"].values
    pressed = {f"{area:g}": dataset.isel(run=areas == area) for area in np.unique(areas)}
    pressed = {area: part for area, part in pressed.items() if _settings(part, "contact_tolerance")}
    heaviest = list(pressed.values())[-1]
    scenes = {name: _range(dataset[f"run_{name}"]) for name in ("hurst", "area_fraction", "wavelength_long")}
    scenes["points_per_wavelength"] = _range(dataset["points_per_wavelength"])
    return Measured(
        errors={
            area: {name: _largest(part, name) for name in KNOBS if _settings(part, name)}
            for area, part in pressed.items()
        },
        presets={
            name: {**found, "seconds": _mean_seconds(heaviest, name)}
            for name, found in _largest(heaviest, "accuracy").items()
        },
        deviation={area: _deviation(part) for area, part in pressed.items()},
        laws={name: _law(dataset, name) for name in LAWS},
        memory=_memory_law(dataset),
        transform=_transform(dataset),
        scenes=scenes,
    )


def _range(column: xr.DataArray) -> list[float]:
    return [float(column.min()), float(column.max())]


def _settings(dataset: xr.Dataset, knob: str) -> list[str]:
    """Settings tried of a knob, in order."""
    return list(dict.fromkeys(map(str, dataset["run_setting"].values[dataset["run_knob"].values == knob])))


def _runs(dataset: xr.Dataset, knob: str, setting: str) -> xr.Dataset:
    rows = (dataset["run_knob"].values == knob) & (dataset["run_setting"].values == setting)
    return dataset.isel(run=rows)


def _largest(dataset: xr.Dataset, knob: str) -> dict[str, dict[str, float]]:
    """Setting → output → largest magnitude of the error in any scene."""
    found = {}
    for setting in _settings(dataset, knob):
        wrong = np.abs(_runs(dataset, knob, setting)["output_error"].values)
        found[setting] = dict(zip(OUTPUTS, _rounded(wrong.max(axis=0)), strict=True))
    return found


def _mean_seconds(dataset: xr.Dataset, preset: str) -> float:
    runs = _runs(dataset, "accuracy", preset)
    return _rounded(np.sum([runs[name].values for name in LAWS], axis=0).mean(keepdims=True))[0]


def _deviation(dataset: xr.Dataset) -> dict[str, float]:
    """Output → deviation of one surface from the mean over its seeds, the kinds of surface pooled."""
    members = _runs(dataset, "seeds", "1")
    kinds = np.unique(members["run_hurst"]).size
    squares = np.sum(members["output_error"].values ** 2, axis=0)
    spread = np.sqrt(squares / (members.sizes["run"] - kinds))
    return dict(zip(OUTPUTS, _rounded(spread), strict=True))


def _rounded(values: Array) -> list[float]:
    return [float(f"{value:.3g}") for value in values]


def features(names: Sequence[str], settings: Mapping[str, Any]) -> Array:
    """Logarithms of what a time is a power of, zero at the settings of the paper, (..., names)."""
    paper = PRESETS["paper"]
    of: dict[str, Callable[[], Any]] = {
        "contact_digits": lambda: (
            np.log10(settings["contact_tolerance"]) / math.log10(paper.contact_tolerance)
        ),
        "single": lambda: np.where(settings["precision"] == "float32", math.e, 1.0),
        "area": lambda: settings["area_fraction"] / 0.1,
        "loads": lambda: settings["loads"],
        "depth_digits": lambda: (
            np.log10(np.maximum(settings["depth_tolerance"], 1e-12) / 10)
            / math.log10(paper.depth_tolerance / 10)
        ),
        "spacing": lambda: settings["depth_spacing"] / paper.depth_spacing,
        "ratios": lambda: settings["ratios"],
    }
    return np.stack(np.broadcast_arrays(*(np.log(of[name]()) for name in names)), axis=-1)


def seconds_of(powers: Sequence[float] | Array, points: Any, features: Array) -> Array:
    """A time: what does not depend on the grid and its transforms, times the powers."""
    start, node, *rest = powers
    return (math.exp(start) + math.exp(node) * points**2 * np.log2(points)) * np.exp(
        features @ np.array(rest)
    )


def _law(dataset: xr.Dataset, name: str) -> dict[str, float]:
    """Powers of a time, by least squares of its logarithm over all runs."""
    settings = {
        "area_fraction": dataset["run_area_fraction"].values,
        "loads": dataset["run_loads"].values,
        "ratios": dataset["run_ratios"].values,
        **{knob: dataset[knob].values for knob in KNOBS},
    }
    powers_of = features(LAWS[name], settings) if LAWS[name] else np.zeros((dataset.sizes["run"], 0))
    points, seconds = dataset["run_points"].values.astype(float), np.maximum(dataset[name].values, 1e-4)

    def residual(powers: Array) -> Array:
        # The weak pull to zero holds powers of what did not vary.
        return np.append(np.log(seconds_of(powers, points, powers_of) / seconds), 1e-2 * powers[2:])

    begin = [math.log(1e-2), math.log(1e-7), *[0.0] * len(LAWS[name])]
    return dict(zip(("start", "node", *LAWS[name]), _rounded(least_squares(residual, begin).x), strict=True))


def _memory_law(dataset: xr.Dataset) -> tuple[float, float]:
    """Memory of a process and of each node, over the growing cells with several Poisson's ratios."""
    rows = (dataset["run_knob"].values == "size") & (dataset["run_ratios"].values > 1)
    nodes, used = dataset["run_points"].values[rows] ** 2.0, dataset["peak_memory"].values[rows]
    slope, base = np.polyfit(nodes, used, 1, w=1 / used)
    base, slope = _rounded(np.array([base, slope]))
    return base, slope


def _transform(dataset: xr.Dataset) -> tuple[int, float]:
    """The largest grid of at most 512 nodes, and the median time of a pair of transforms on it."""
    points = dataset["run_points"].values
    chosen = int(points[points <= 512].max())
    return chosen, float(f"{np.median(dataset['transform_seconds'].values[points == chosen]):.3g}")


def as_json(measured: Measured) -> str:
    """The measurement as text; `load` reads it."""
    return json.dumps(asdict(measured), indent=1) + "\n"


@cache
def load() -> Measured:
    """The measurement that comes with the package."""
    return Measured(
        **json.loads(files("asperity.accuracy").joinpath("measured.json").read_text(encoding="utf-8"))
    )


def nearest(by_area: Mapping[str, T], area_fraction: float) -> T | None:
    """What was measured at the next smaller area fraction, where errors are larger; none below the least."""
    smaller = [area for area in by_area if float(area) <= area_fraction * (1 + 1e-9)]
    return by_area[max(smaller, key=float)] if smaller else None


def measured_errors(
    knobs: AccuracySettings, area_fraction: float, measured: Measured
) -> dict[str, dict[str, float]]:
    """The largest errors seen at settings that were measured, without margin: output → source → error.

    The seeds' is the deviation of one surface from the mean of its kind.
    """
    known, deviation = nearest(measured.errors, area_fraction), nearest(measured.deviation, area_fraction)
    assert known is not None
    assert deviation is not None
    half_space = min(known["half_space_tolerance"], key=float)

    def at(knob: str, name: str) -> float:
        value = getattr(knobs, knob)
        return next(found[name] for setting, found in known[knob].items() if float(setting) == value)

    return {
        name: {
            "discretisation": at("points_per_wavelength", name),
            "depths": at("depth_spacing", name) + at("depth_tolerance", name),
            "contact": at("contact_tolerance", name),
            "half_space": known["half_space_tolerance"][half_space][name],
            "seeds": deviation[name],
        }
        for name in OUTPUTS
    }


def describe_presets(measured: Measured) -> str:
    """What each preset sets, what it costs and how wrong it is, as a Markdown table."""
    names = [name for name in PRESETS if name in measured.presets]
    settings = [
        [_KNOB_NAMES[knob], *(_text(getattr(PRESETS[name], knob)) for name in names)]
        for knob in asdict(EXACT)
    ]
    times = [_text(measured.presets[name]["seconds"]) for name in names]
    errors = [
        [f"error of `{output}`", *(percent(measured.presets[name][output]) for name in names)]
        for output in OUTPUTS
    ]
    head = ["", *(f"`{name}`" for name in names)]
    return markdown([head, *settings, ["processor time of one surface (s)", *times], *errors])


def describe_errors(measured: Measured) -> str:
    """The largest error that each setting made, one knob off the reference, as a Markdown table."""
    rows = [["area fraction", "knob", "setting", *(f"`{name}`" for name in OUTPUTS)]]
    for area, knobs in measured.errors.items():
        for knob, settings in knobs.items():
            for setting, found in settings.items():
                rows.append([area, knob, setting, *(percent(found[name]) for name in OUTPUTS)])
        deviation = measured.deviation[area]
        rows.append([area, "seeds (deviation)", "1", *(percent(deviation[name]) for name in OUTPUTS)])
    return markdown(rows)


def markdown(rows: Sequence[Sequence[str]]) -> str:
    """A table, its first row the head."""
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:]])


def percent(value: float) -> str:
    """A relative error for a reader, two digits."""
    if not math.isfinite(value):
        return "not measured"
    return "0" if value == 0 else f"{float(f'{100 * value:.2g}'):g} %"


def _text(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


_KNOB_NAMES = {
    "points_per_wavelength": "`points` on `wavelength_short`",
    "contact_tolerance": "`contact.tolerance`",
    "precision": "`contact.precision`",
    "depth_tolerance": "`stress.tolerance`",
    "depth_spacing": "`stress.depth_spacing`",
    "half_space_tolerance": "`layer.half_space_tolerance`",
    "seeds": "number of `seeds`",
}
