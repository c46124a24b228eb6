"""The numbers of one surface and one seed, taken from its results: what claims and the drift check read.

A summary is a flat mapping from dotted names to numbers, and the quantiles of the peaks. Stresses are scaled
by E* ḡ as in the statistics; lengths and depths are in cell lengths. Names that depend on Poisson's ratio
carry it last: ``von_mises.p99@0.33``.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy import ndimage

from asperity.errors import DatasetError
from asperity.results.dataset import FINGERPRINT, atomic_write, digest, settings_of
from asperity.stress.selection import peaks, selection_for
from asperity.types import Array

LEVELS = np.concatenate([np.linspace(0, 0.99, 100), np.linspace(0.991, 1, 10)])
"""Shares of the peaks at which quantiles are kept: every percent, above 99 % every tenth of one."""

HIGH = 0.9
"""A high peak is above this share of the peaks of its kind."""

QUANTITIES = ("pressure", "xx", "zz", "xz", "von_mises")
"""Quantities whose peaks are summarised."""

_PATH_BEGIN = 0.01


@dataclass(frozen=True)
class Summary:
    """Numbers of one surface and one seed.

    Parameters
    ----------
    settings : mapping
        What the results were made from, all stages.
    values : mapping
        Name → number; NaN where there is nothing to measure.
    quantiles : mapping
        ``quantity@poisson`` → magnitudes of the scaled peaks at `LEVELS`.
    """

    settings: Mapping[str, Any]
    values: Mapping[str, float]
    quantiles: Mapping[str, Array] = field(default_factory=dict)

    def __getitem__(self, name: str) -> float:
        return self.values[name]

    def exceeded(self, name: str, share: float) -> float:
        """The magnitude that the given share of the peaks of ``quantity@poisson`` does not reach."""
        return float(np.interp(share, LEVELS, self.quantiles[name]))


def summarise(surface: xr.Dataset, contact: xr.Dataset, stress: xr.Dataset) -> Summary:
    """Reduce the results of one surface and one seed to its numbers.

    Parameters
    ----------
    surface, contact, stress : datasets
        Results of the stages of these names.

    Returns
    -------
    Summary
    """
    values = {f"surface.{name}": float(surface[name]) for name in ("rms_gradient", "skewness", "kurtosis")}
    values |= _of_contact(contact)
    gradient = float(contact["gradient_rms_contact"])
    patches, radii = contact_patches(contact["pressure"].values > 0)
    spacing = float(contact["x"][1])
    values["contact.patches"] = float(radii.size)
    values["contact.patch_radius"] = spacing * float(np.average(radii, weights=radii**2))
    quantiles: dict[str, Array] = {}
    for ratio in stress["poisson"].values:
        for quantity in QUANTITIES:
            found = peaks(stress, quantity, ratio, selection_for(quantity))
            name = f"{quantity}@{ratio:g}"
            magnitude = np.abs(found["peak_value"].values) / gradient
            quantiles[name] = np.quantile(magnitude, LEVELS)
            measured = _of_peaks(magnitude, found["peak_depth"].values)
            if quantity == "von_mises":
                measured["depth_patch_correlation"] = _depth_follows_size(found, patches, radii, spacing)
            values |= {f"{quantity}.{short}@{ratio:g}": value for short, value in measured.items()}
        values |= {
            f"{short}@{ratio:g}": v for short, v in _of_planes(stress.sel(poisson=ratio), gradient).items()
        }
    return Summary(settings_of(stress), values, quantiles)


def contact_patches(contact: Array) -> tuple[Array, Array]:
    """Connected patches of a periodic cell, nodes joined across edges and corners of the grid squares.

    Parameters
    ----------
    contact : (ny, nx) boolean array

    Returns
    -------
    number : (ny, nx) array
        Number of the patch at each node, from 1; 0 outside.
    radii : (patches,) array
        Radius of the disc of the same area, in grid spacings.
    """
    number, count = ndimage.label(contact, structure=np.ones((3, 3)))
    parent = np.arange(count + 1)

    def root(i: int) -> int:
        while parent[i] != i:
            i = parent[i]
        return i

    for first, last in ((number[0], number[-1]), (number[:, 0], number[:, -1])):
        for shift in (-1, 0, 1):
            moved = np.roll(last, shift)
            for one, other in zip(first, moved, strict=True):
                if one and other:
                    parent[root(one)] = root(other)
    roots = np.array([root(i) for i in range(count + 1)])
    merged = np.unique(roots, return_inverse=True)[1][number] if count else number
    area = np.bincount(merged.ravel())[1:]
    return merged, np.sqrt(area / np.pi)


def write(summary: Summary, path: str | os.PathLike[str]) -> None:
    """Write a summary as JSON, whole or not at all, with a fingerprint of what it holds."""
    tree = asdict(summary) | {"quantiles": {name: list(q) for name, q in summary.quantiles.items()}}
    tree[FINGERPRINT] = digest(tree)
    with atomic_write(path) as unfinished:
        unfinished.write_text(json.dumps(tree, indent=1, sort_keys=True) + "\n", encoding="utf-8")


def read(path: str | os.PathLike[str]) -> Summary:
    """Read what `write` wrote.

    Raises
    ------
    DatasetError
        If the file is missing or damaged, or not as it was written.
    """
    try:
        tree = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise DatasetError(f"{path}: damaged or missing ({error}); delete it and run again") from error
    if not isinstance(tree, dict) or tree.pop(FINGERPRINT, None) != digest(tree):
        raise DatasetError(
            f"{path}: changed since it was written, or by another version; delete it and run again"
        )
    quantiles = {name: np.array(values) for name, values in tree["quantiles"].items()}
    return Summary(tree["settings"], tree["values"], quantiles)


def _of_contact(contact: xr.Dataset) -> dict[str, float]:
    """Load, area and slope, and how straight the load-area curve is."""
    names = ("area_fraction", "mean_pressure", "gradient_rms_contact", "approach")
    values = {f"contact.{name}": float(contact[name]) for name in names}
    area, gradient = values["contact.area_fraction"], values["contact.gradient_rms_contact"]
    values["contact.proportionality"] = area * gradient / values["contact.mean_pressure"]
    path = contact["path_area_fraction"].values
    kept = (path >= _PATH_BEGIN * (1 - 1e-3)) & (path <= 1.001 * area)
    values["contact.load_exponent"] = values["contact.proportionality_change"] = np.nan
    if kept.sum() >= 3:
        load = (contact["path_mean_pressure"] / contact["path_gradient_rms_contact"]).values[kept]
        ratio = path[kept] / load
        values["contact.load_exponent"] = float(np.polyfit(np.log(load), np.log(path[kept]), 1)[0])
        values["contact.proportionality_change"] = float(ratio[-1] / ratio[0])
    return values


def _of_peaks(magnitude: Array, depth: Array) -> dict[str, float]:
    """Size, spread and depth of one kind of peak."""
    high = magnitude >= np.quantile(magnitude, HIGH)
    return {
        "count": float(magnitude.size),
        "mean": float(magnitude.mean()),
        "deviation": float(magnitude.std()),
        "p50": float(np.quantile(magnitude, 0.5)),
        "p90": float(np.quantile(magnitude, 0.9)),
        "p99": float(np.quantile(magnitude, 0.99)),
        "largest": float(magnitude.max()),
        "depth": float(depth.mean()),
        "depth_high": float(depth[high].mean()),
    }


def _depth_follows_size(peaks: xr.Dataset, patches: Array, radii: Array, spacing: float) -> float:
    """Rank correlation of the depth of peaks with the radius of the patch of contact above them."""
    ny, nx = patches.shape
    row = np.rint(peaks["peak_y"].values / spacing).astype(int) % ny
    column = np.rint(peaks["peak_x"].values / spacing).astype(int) % nx
    above = patches[row, column]
    touched = above > 0
    from scipy.stats import spearmanr  # takes a second to import, and the workflow imports this module

    return float(spearmanr(radii[above[touched] - 1], peaks["peak_depth"].values[touched]).statistic)


def _of_planes(stress: xr.Dataset, gradient: float) -> dict[str, float]:
    """Depth profile and the lengths over which the von Mises stress decays to half (Eq. 22)."""
    depth, reference = stress["plane_depth"].values, float(stress["reference_depth"])
    variance = float(stress["covariance_plane"][0])
    below = depth >= reference
    along = stress["covariance_depth"].values[below] / variance
    return {
        "profile.largest": float(stress["largest_von_mises"].max()) / gradient,
        "profile.reference_depth": reference,
        "decay.depth": half_length(depth[below] - reference, along),
        "decay.plane": half_length(stress["lag"].values, stress["covariance_plane"].values / variance),
    }


def half_length(distance: Array, correlation: Array) -> float:
    """Distance at which a correlation first falls to one half, by linear interpolation; NaN if never."""
    fallen = np.flatnonzero(correlation <= 0.5)
    if not fallen.size or fallen[0] == 0:
        return float("nan")
    i = int(fallen[0])
    return float(np.interp(0.5, correlation[[i, i - 1]], distance[[i, i - 1]]))
