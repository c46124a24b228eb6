"""Continuum limits of κ and κ_r with their errors, and their regressions on the parameters of the surfaces.

κ = A E* ḡ / p̄ and κ_r = A E* ḡ_r / p̄, with the area fraction A, the rms gradient ḡ of the whole surface and
ḡ_r of the rough surface over the true contact, where it equals the deformed one. Integrals over the contact
are taken over its nodes, less a share of the strip of half squares along its boundary: V. A. Yastrebov, G.
Anciaux and J.-F. Molinari, Tribol. Int. 114 (2017) 161, doi 10.1016/j.triboint.2017.04.023.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from scipy.special import stdtrit

from asperity.paper.claims.continuum import ORDERS
from asperity.types import Array

STRIP = (math.pi - 1 + math.log(2)) / 24
"""Share of grid spacing times boundary length by which the nodes of contact overestimate its area."""

NUMBERS = {"kappa": "κ", "kappa_r": "κ_r"}
"""Column of the table → its symbol."""

_KEYS = ("area", *NUMBERS)

TERMS = {
    "ln_nayak": "ln α",
    "hurst": "H",
    "ln_ratio": "ln λ_l/λ_s",
    "ln_area": "ln A",
}
"""Column of the table that a regression may use → its symbol."""


class Limit(NamedTuple):
    """A mean over seeds at vanishing grid spacing, and its standard error over seeds."""

    value: float
    scatter: float


def proportionality(sample: xr.Dataset, spacing: float, corrected: bool = True) -> dict[str, xr.DataArray]:
    """Area fraction, κ and κ_r of each seed and load on one grid.

    Parameters
    ----------
    sample : dataset
        As of `asperity.paper.nayak.samples.sample`.
    spacing : float
        Grid spacing.
    corrected : bool
        Take the strip along the boundary off the integrals over the contact.
    """
    strip = STRIP * spacing * corrected
    area = sample["seed_area_fraction"] - strip * sample["seed_boundary_length"]
    squared = sample["seed_squared_gradient_contact"] - strip * sample["seed_squared_gradient_boundary"]
    per_load = area / sample["seed_mean_pressure"]
    return {
        "area": area,
        "kappa": per_load * sample["seed_rms_gradient"],
        "kappa_r": per_load * np.sqrt(squared / area),
    }


def means(levels: Sequence[Array]) -> Array:
    """Mean over seeds on nested grids: many seeds on coarse ones, their first on finer ones.

    The mean on a grid is that on the next coarser one plus the mean difference of the seeds that both have.

    Parameters
    ----------
    levels : sequence of (seeds,) arrays, coarse to fine
    """
    differences = [(fine - coarse[: fine.size]).mean() for coarse, fine in pairwise(levels)]
    return np.cumsum([levels[0].mean(), *differences])


def order_of(found: Sequence[Array]) -> float:
    """Order of convergence that the means of several numbers on the same grids show together.

    It is that of the sum of their relative changes over the last three grids, limited to
    `asperity.paper.claims.continuum.ORDERS`; it is one with two grids, or where the changes do not shrink.
    """
    relative = np.sum([np.diff(one) / one[-1] for one in found], axis=0)
    if relative.size < 2 or not relative[-2] or not 0 < relative[-1] / relative[-2] < 1:
        return 1.0
    return float(np.clip(-np.log2(relative[-1] / relative[-2]), *ORDERS))


def limit(levels: Sequence[Array], order: float) -> Limit:
    """Limit of a mean over seeds, from nested grids with half the spacing of the one before (Richardson).

    Parameters
    ----------
    levels : sequence of (seeds,) arrays, coarse to fine
    order : float
        Of convergence.
    """
    gain = 1 / (2**order - 1)
    found = means(levels)
    differences = [fine - coarse[: fine.size] for coarse, fine in pairwise(levels)]
    weights = [1.0] * len(differences) + [1 + gain]
    variances = [
        w**2 * v.var(ddof=1) / v.size for w, v in zip(weights, [levels[0], *differences], strict=True)
    ]
    return Limit(float(found[-1] + gain * (found[-1] - found[-2])), math.sqrt(sum(variances)))


def table(config: Mapping[str, Any], samples: Mapping[str, Mapping[float, xr.Dataset]]) -> pd.DataFrame:
    """Limits of κ, κ_r and the area of all surfaces under all loads, a row each.

    With and without the strip along the boundary the numbers converge in different ways to one limit. Each of
    the two has one order of convergence for all rows (`order_of`). The error of the grid is the difference of
    the two limits, and the error that of the grid and of the seeds together.

    Parameters
    ----------
    config : mapping
        Configuration of the surfaces.
    samples : mapping
        As of `asperity.paper.nayak.collection.collect`.
    """
    rows: list[dict[str, Any]] = []
    levels: dict[tuple[str, bool], list[list[Array]]] = {
        (key, corrected): [] for key in _KEYS for corrected in (True, False)
    }
    for name, of_grids in samples.items():
        surface, nodes = config["surfaces"][name], sorted(of_grids)
        short, coarsest = surface["wavelength_short"], of_grids[nodes[0]]
        nayak = coarsest["seed_nayak"].values
        for index in range(coarsest.sizes["load"]):
            rows.append(
                {
                    "surface": name,
                    "hurst": surface["hurst"],
                    "ratio": surface["wavelength_long"] / short,
                    "cell": 1 / surface["wavelength_long"],
                    "load": index + 1,
                    "pressure": config["nayak"]["loads"][index],
                    "nayak": nayak.mean(),
                    "nayak_error": nayak.std(ddof=1) / math.sqrt(nayak.size),
                    "seeds": "/".join(str(of_grids[n].sizes["seed"]) for n in nodes),
                }
            )
            for corrected in (True, False):
                numbers = [proportionality(of_grids[n], short / n, corrected) for n in nodes]
                for key in _KEYS:
                    levels[key, corrected].append([grid[key].values[:, index] for grid in numbers])
    for (key, corrected), of_rows in levels.items():
        order = order_of([means(one) for one in of_rows])
        for row, one in zip(rows, of_rows, strict=True):
            found, kind = limit(one, order), "" if corrected else "_uncorrected"
            row |= {f"{key}{kind}": found.value, f"{key}{kind}_order": order}
            row |= {f"{key}{kind}_coarsest": means(one)[0]}
            if corrected:
                row[f"{key}_scatter"] = found.scatter
    for row in rows:
        for key in _KEYS:
            row[f"{key}_error"] = math.hypot(row[f"{key}_scatter"], row[key] - row[f"{key}_uncorrected"])
    return with_logarithms(pd.DataFrame(rows))


def with_logarithms(rows: pd.DataFrame) -> pd.DataFrame:
    """The table with the columns that only regressions use."""
    return rows.assign(
        ln_nayak=np.log(rows["nayak"]), ln_ratio=np.log(rows["ratio"]), ln_area=np.log(rows["area"])
    )


class Regression(NamedTuple):
    """Least squares of a number on some terms and a constant.

    Parameters
    ----------
    terms : tuple of names
    slopes, errors : (terms,) arrays
        Slopes and half widths of their 95 % intervals.
    residual : float
        Root of the mean squared residual, per degree of freedom.
    explained : float
        Share of the weighted variance that the terms explain, R².
    """

    terms: tuple[str, ...]
    slopes: Array
    errors: Array
    residual: float
    explained: float


def regress(rows: pd.DataFrame, number: str, terms: Sequence[str], group: str = "surface") -> Regression:
    """Regression of a number on terms and a constant, weighted by its error.

    Rows of one group share their seeds and are not independent: the errors of the slopes are those of the
    leave-one-group-out jackknife (Student's t), which also holds what the terms do not explain.

    Raises
    ------
    ValueError
        If there are fewer groups than slopes and two.
    """
    names = rows[group].unique()
    if names.size < len(terms) + 2:
        raise ValueError(f"{names.size} groups: {len(terms) + 2} or more are needed for {len(terms)} slopes")
    whole, residual, explained = _fit(rows, number, terms)
    left_out = np.array([_fit(rows[rows[group] != name], number, terms)[0] for name in names])
    spread = (names.size - 1) / names.size * ((left_out - left_out.mean(axis=0)) ** 2).sum(axis=0)
    factor = float(stdtrit(names.size - len(terms) - 1, 0.975))
    return Regression(tuple(terms), whole[1:], factor * np.sqrt(spread)[1:], residual, explained)


def _fit(rows: pd.DataFrame, number: str, terms: Sequence[str]) -> tuple[Array, float, float]:
    """Constant and slopes, root mean squared residual, share of the variance explained."""
    weight = 1 / np.maximum(rows[f"{number}_error"].to_numpy(), 1e-3 * rows[number].abs().to_numpy())
    matrix = np.column_stack([np.ones(len(rows)), *(rows[term] for term in terms)])
    value = rows[number].to_numpy()
    found = np.linalg.lstsq(matrix * weight[:, None], value * weight, rcond=None)[0]
    left = value - matrix @ found
    mean = np.average(value, weights=weight**2)
    explained = 1 - np.sum((weight * left) ** 2) / np.sum((weight * (value - mean)) ** 2)
    residual = math.sqrt(np.average(left**2, weights=weight**2) * len(rows) / (len(rows) - matrix.shape[1]))
    return found, residual, float(explained)
