"""Result of an ensemble: the estimate with its errors, every level, and the same by plain Monte Carlo."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pandas as pd
import xarray as xr

from asperity.accuracy.allocation import finest_variance
from asperity.accuracy.multilevel import Estimate, Spread, bias, multilevel_mean
from asperity.accuracy.tables import minutes
from asperity.paper.ensemble.planning import Plan, grid_name
from asperity.paper.ensemble.samples import Samples
from asperity.types import Array

PARTS = (1 / 8, 1 / 4, 1 / 2, 1.0)
"""Parts of the samples from which the course of the error is taken."""

FEWEST = 3
"""Fewest seeds on the finest grid in such a part."""


def result(plan: Plan, samples: Samples) -> xr.Dataset:
    """The estimate of a number with its errors and costs.

    Parameters
    ----------
    plan : Plan
        Of the last round.
    samples : Samples
        All seeds of the plan; the finest grid may have more, which then belong to plain Monte Carlo alone.

    Returns
    -------
    dataset
        Along `grid`, the levels; along `course` and `plain_course`, errors and times of parts of the samples.
        Plain Monte Carlo is the mean over the seeds of the finest grid. Its time for the standard error of
        the estimate follows from the measured time of a seed and its variance: that which all levels show,
        and in variables ``…_fine`` that of the seeds of the finest grid alone. ``gain`` is that time over the
        time of the estimate, with a 95 % interval.
    """
    kept = samples.first(plan.seeds)
    used = [number if use else 0 for number, use in zip(plan.seeds, plan.used, strict=True)]
    chosen = samples.first(used)
    found = multilevel_mean(chosen.values)
    shift = bias(kept.nodes[1:], kept.values[1:])
    low, high = found.interval()
    finest, times = samples.values[-1], samples.times[-1]
    plain = multilevel_mean([finest])
    seconds = sum(float(level.sum()) for level in chosen.times)
    spreads = {"": finest_variance(chosen.values), "_fine": Spread.of(finest)}
    same = {kind: float(times.mean()) * np.array(each.over(found)) for kind, each in spreads.items()}
    course = [point for part in PARTS if (point := _part(chosen, part)) is not None]
    counts = _halvings(len(finest))
    return xr.Dataset(
        {
            **_levels(kept, plan.used),
            "estimate": found.value,
            "estimate_error": found.error,
            "estimate_low": low,
            "estimate_high": high,
            "estimate_bias": shift.value,
            "estimate_order": shift.order,
            "estimate_total_error": float(np.hypot(found.error, shift.value)),
            "estimate_seconds": seconds,
            "plain_estimate": plain.value,
            "plain_error": plain.error,
            "plain_seconds": float(times.sum()),
            **{f"plain_seconds_same_error{kind}": each[0] for kind, each in same.items()},
            **{
                f"gain{end}{kind}": each[number] / seconds
                for kind, each in same.items()
                for number, end in enumerate(("", "_low", "_high"))
            },
            "course_seeds": ("course", [point[0] for point in course]),
            "course_seconds": ("course", [point[1] for point in course]),
            "course_error": ("course", [point[2].error for point in course]),
            "plain_course_seeds": ("plain_course", counts),
            "plain_course_seconds": ("plain_course", [float(times[:n].sum()) for n in counts]),
            "plain_course_error": ("plain_course", [multilevel_mean([finest[:n]]).error for n in counts]),
        }
    )


def _levels(samples: Samples, used: Sequence[bool]) -> dict[str, tuple[str, object]]:
    """Numbers of every level; NaN where a level has none."""
    pairs = list(pairwise(samples.values))
    differences = [
        fine - coarse[: len(fine)] if coarse.ndim == 1 else np.full(2, np.nan) for coarse, fine in pairs
    ]
    alone = [values.ndim > 1 for values in samples.values]
    columns: dict[str, object] = {
        "grid_nodes": list(samples.nodes),
        "grid_used": [int(use) for use in used],
        "grid_seeds": [len(values) for values in samples.values],
        "grid_mean": [np.nan if a else v.mean() for a, v in zip(alone, samples.values, strict=True)],
        "grid_deviation": [
            np.nan if a else v.std(ddof=1) for a, v in zip(alone, samples.values, strict=True)
        ],
        "grid_difference": [np.nan, *(d.mean() for d in differences)],
        "grid_difference_error": [np.nan, *(d.std(ddof=1) / np.sqrt(len(d)) for d in differences)],
        "grid_correlation": [np.nan, *(correlation(coarse, fine) for coarse, fine in pairs)],
        "grid_seconds": samples.seconds,
    }
    return {name: ("grid", column) for name, column in columns.items()}


def correlation(coarse: Array, fine: Array) -> float:
    """Correlation of two levels over their common seeds; multiple correlation with several coarse numbers."""
    x = np.reshape(coarse, (len(coarse), -1))[: len(fine)]
    x, y = x - x.mean(axis=0), fine - fine.mean()
    fitted = x @ np.linalg.lstsq(x, y, rcond=None)[0]
    sign = np.sign(x[:, 0] @ y) if x.shape[1] == 1 else 1.0
    return float(sign * np.sqrt((fitted @ fitted) / (y @ y)))


def _part(samples: Samples, part: float) -> tuple[int, float, Estimate] | None:
    """Seeds of the finest grid, time and estimate of a part of the samples; None if it has too few."""
    seeds = [int(len(values) * part) for values in samples.values]
    alone = samples.values[0].shape[1] if samples.values[0].ndim > 1 else 0
    if seeds[-1] < FEWEST or seeds[min(1, len(seeds) - 1)] < alone + FEWEST:
        return None
    some = samples.first(seeds)
    return seeds[-1], sum(float(level.sum()) for level in some.times), multilevel_mean(some.values)


def _halvings(number: int) -> list[int]:
    """A number of seeds and its halves, rising, down to `FEWEST`."""
    found = [number]
    while found[-1] // 2 >= FEWEST:
        found.append(found[-1] // 2)
    return found[::-1]


def level_frame(data: xr.Dataset) -> pd.DataFrame:
    """A table of the levels of a result."""
    return pd.DataFrame(
        {
            "level": [grid_name(nodes) for nodes in data["grid_nodes"].values],
            "in the estimate": np.where(data["grid_used"].values.astype(bool), "yes", "no"),
            "seeds": data["grid_seeds"].values,
            "mean": data["grid_mean"].values,
            "deviation": data["grid_deviation"].values,
            "difference": data["grid_difference"].values,
            "its error": data["grid_difference_error"].values,
            "correlation": data["grid_correlation"].values,
            "seconds a seed": data["grid_seconds"].values,
        }
    )


def summary_frame(results: dict[str, xr.Dataset]) -> pd.DataFrame:
    """A table of several results, one row each; levels that only tell the bias stand in brackets."""
    rows = []
    for name, data in results.items():
        value = float(data["estimate"])
        spent, plain = float(data["estimate_seconds"]), float(data["plain_seconds_same_error"])
        rows.append(
            {
                "number": name,
                "estimate": value,
                "standard error %": 100 * float(data["estimate_error"]) / abs(value),
                "bias %": 100 * float(data["estimate_bias"]) / value,
                "total error %": 100 * float(data["estimate_total_error"]) / abs(value),
                "levels: seeds": ", ".join(
                    f"{grid_name(nodes)}: {number}" if used else f"({grid_name(nodes)}: {number})"
                    for nodes, number, used in zip(
                        data["grid_nodes"].values,
                        data["grid_seeds"].values,
                        data["grid_used"].values,
                        strict=True,
                    )
                ),
                "plain estimate": float(data["plain_estimate"]),
                "its error %": 100 * float(data["plain_error"]) / abs(value),
                "seconds": spent,
                "plain seconds for the same error": plain,
                "gain": gain_text(data, ""),
                "gain by the variance of the finest grid alone": gain_text(data, "_fine"),
            }
        )
    return pd.DataFrame(rows)


def gain_text(data: xr.Dataset, kind: str) -> str:
    """Time of plain Monte Carlo over that of the estimate, with its interval."""
    value, low, high = (float(data[f"gain{end}{kind}"]) for end in ("", "_low", "_high"))
    return f"{value:.2g} ({low:.2g} to {high:.2g})"


def sentences(name: str, quantity: str, data: xr.Dataset) -> str:
    """The result in a few lines for a reader."""
    value, finest = float(data["estimate"]), grid_name(float(data["grid_nodes"][-1]))
    spent, plain = float(data["estimate_seconds"]), float(data["plain_seconds_same_error"])
    return "\n".join(
        [
            f"{name}: {quantity}",
            f"  {value:.5g} ± {float(data['estimate_error']):.2g} on {finest} (standard error; 95 %: "
            f"{float(data['estimate_low']):.5g} to {float(data['estimate_high']):.5g})",
            f"  vanishing grid spacing adds {float(data['estimate_bias']):+.2g}; total error "
            f"{float(data['estimate_total_error']) / abs(value):.2%}",
            f"  {minutes(spent)} of one processor; plain Monte Carlo on {finest} to the same standard error: "
            f"{minutes(plain)}, {gain_text(data, '')} times as long; by the variance of the seeds of that "
            f"grid alone {gain_text(data, '_fine')} times",
        ]
    )
