"""Gains of all numbers that the samples of an ensemble know, from allocations with measured times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import pandas as pd

from asperity.accuracy.allocation import allocate
from asperity.accuracy.multilevel import bias, multilevel_mean
from asperity.paper.ensemble.numbers import full_name, number, numbers
from asperity.paper.ensemble.result import correlation
from asperity.paper.ensemble.samples import Samples, read_samples
from asperity.types import Array

Files = Mapping[float, Mapping[str, Sequence[str]]]
"""Nodes on the shortest wavelength → surface → files of samples."""


def known_numbers(
    roles: Mapping[str, str], files: Files, laterals: Sequence[str]
) -> dict[str, dict[str, str]]:
    """Numbers whose surfaces have samples on all grids: name → role → surface.

    Parameters
    ----------
    roles : mapping
        Role → surface.
    files : mapping
    laterals : sequence of names
        Conditions of the uniform mode in the samples, besides that of the study.
    """
    sampled = set.intersection(*(set(of_surfaces) for of_surfaces in files.values()))
    found: dict[str, dict[str, str]] = {}
    for name, each in numbers().items():
        surfaces = {role: roles.get(role, "") for role in each.roles}
        if set(surfaces.values()) <= sampled:
            other = [f"lateral={lateral}" for lateral in laterals if "lateral" in each.measure.choices]
            found |= {full_name(name, options): surfaces for options in ([], *([each] for each in other))}
    return found


def gain_frame(
    known: Mapping[str, Mapping[str, str]], files: Files, error: float, fewest: int
) -> pd.DataFrame:
    """A table of numbers, one row each: scatter, correlations, and allocations for a standard error.

    Numbers that cannot be measured with every seed, or that are constant, are left out.

    Parameters
    ----------
    known : mapping
        As of `known_numbers`.
    files : mapping
    error : float
        Standard error over the value.
    fewest : int
        Fewest seeds of a level in use.
    """
    rows = []
    for name, surfaces in known.items():
        try:
            samples = _nested(read_samples(name, surfaces, files))
        except ValueError:
            continue
        if np.ptp(samples.values[-1]) > 0:
            rows.append({"number": name, **_row(name, samples, error, fewest)})
    columns = list(rows[0]) if rows else ["number", "gain at small errors"]
    return pd.DataFrame(rows, columns=columns).sort_values("gain at small errors", ascending=False)


def _nested(samples: Samples) -> Samples:
    """The seeds of each level that all coarser levels have."""
    return samples.first(np.minimum.accumulate([len(level) for level in samples.values]).tolist())


def _row(name: str, samples: Samples, error: float, fewest: int) -> dict[str, object]:
    value = multilevel_mean(samples.values).value
    found = allocate(samples.values, samples.seconds, error * abs(value), fewest)
    scatter = np.sqrt(found.variance) / abs(value)
    shift = bias(samples.nodes[1:], samples.values[1:]).value
    correlations = [correlation(coarse, fine) for coarse, fine in pairwise(samples.values)]
    return {
        "quantity": number(name).quantity,
        "value": value,
        "scatter of seeds %": 100 * scatter,
        "correlation with the coarser level": ", ".join(f"{each:.3f}" for each in correlations),
        "bias %": 100 * shift / value,
        "plain seeds": found.plain_seeds,
        "plain seconds": found.plain_seconds,
        "seeds": _seeds_text(found.seeds),
        "seconds": found.seconds,
        "gain": found.plain_seconds / found.seconds,
        "gain at small errors": found.gain,
    }


def _seeds_text(seeds: Array) -> str:
    """Seeds of the levels, a dash for a level without."""
    return ", ".join(str(number) if number else "–" for number in seeds)
