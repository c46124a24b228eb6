"""How well scales of the contact bring height and depth of von Mises peaks of all surfaces onto one curve.

A number y over its scale s is one curve if ln(y/s) depends on Poisson's ratio alone. The *scatter* of a scale
is the root mean square of what is left of ln(y/s) after subtracting the mean of each Poisson's ratio, over
all surfaces and areas.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from asperity.reference.hertz import Hertz
from asperity.results.dataset import settings_of
from asperity.types import Array

HEIGHT_SCALES = {
    "height_gradient_contact": "E\\*ḡ_r, gradient of the contact",
    "height_gradient_whole": "E\\*ḡ, gradient of the whole surface",
    "height_contact_pressure": "p̄/A, mean pressure of the contact",
}
"""Column of the table → scale of the height."""

DEPTH_SCALES = {
    "depth_pressure_length": "ℓ_p, half width of the autocovariance of the pressure",
    "depth_hydraulic_radius": "area over half the boundary of contact",
    "depth_patch_radius": "area-weighted mean radius of the patches",
    "depth_curvature_length": "√(m₂/m₄) over the contact",
    "depth_height_length": "√(m₀/m₂) over the contact",
    "depth_wavelength": "λ_s",
}
"""Column of the table → scale of the depth."""

COLLAPSED = 0.05
"""Largest scatter of what is called one curve."""

REFERENCE = 0.33
"""Poisson's ratio to which the others are compared."""


class Scatter(NamedTuple):
    """Scatter of a scale and its standard error, from the jackknife over surfaces."""

    value: float
    error: float


def table(samples: Mapping[str, xr.Dataset]) -> pd.DataFrame:
    """Height and depth over every scale, a row for each surface, area and Poisson's ratio: means over seeds.

    Parameters
    ----------
    samples : mapping
        Surface → dataset of `asperity.paper.master_curve.samples.collect`.
    """
    rows = []
    for name, data in samples.items():
        surface = settings_of(data)["surface"]
        data = data.isel(quantity=0, level=0)
        scaled, depth = data["seed_peak_quantile"], data["seed_mean_depth_highest"]
        gradient, area = data["seed_gradient_rms_contact"], data["seed_area_fraction"]
        pressure = data["seed_mean_pressure"] / area
        numbers = {
            "height_gradient_contact": scaled,
            "height_gradient_whole": scaled * gradient / data["seed_rms_gradient"],
            "height_contact_pressure": scaled * gradient / pressure,
            "depth_wavelength": depth / surface["wavelength_short"],
        }
        for key in DEPTH_SCALES:
            if key not in numbers:
                numbers[key] = depth / data["seed_" + key.removeprefix("depth_")]
        for load in data["load"].values:
            for poisson in data["poisson"].values:
                row: dict[str, object] = {
                    "surface": name,
                    "hurst": surface["hurst"],
                    "ratio": surface["wavelength_long"] / surface["wavelength_short"],
                    "skewed": "johnson" in surface,
                    "area": float(area.sel(load=load).mean()),
                    "poisson": float(poisson),
                    "seeds": data.sizes["seed"],
                }
                for key, number in numbers.items():
                    each = np.log(number.sel(load=load, poisson=poisson).values)
                    row[key] = math.exp(each.mean())
                    row[f"{key}_error"] = row[key] * each.std(ddof=1) / math.sqrt(each.size)
                rows.append(row)
    return pd.DataFrame(rows)


def _left(rows: pd.DataFrame, key: str, terms: Sequence[str]) -> Array:
    """What is left of the logarithm of a number after a mean for each Poisson's ratio and some terms."""
    matrix, value = _design(rows, terms), np.log(rows[key].to_numpy())
    return value - matrix @ np.linalg.lstsq(matrix, value, rcond=None)[0]


def held_out(rows: pd.DataFrame, key: str, terms: Sequence[str]) -> float:
    """Root mean square error with which a fit to all other surfaces predicts the logarithm for a surface."""
    squares = []
    for name in rows["surface"].unique():
        chosen = (rows["surface"] == name).to_numpy()
        matrix, value = _design(rows, terms), np.log(rows[key].to_numpy())
        found = np.linalg.lstsq(matrix[~chosen], value[~chosen], rcond=None)[0]
        squares.append((value - matrix @ found)[chosen] ** 2)
    return float(np.sqrt(np.concatenate(squares).mean()))


def _design(rows: pd.DataFrame, terms: Sequence[str]) -> Array:
    """Columns of least squares: one for each Poisson's ratio, then the terms."""
    ratios = np.sort(rows["poisson"].unique())
    constants = (rows["poisson"].to_numpy()[:, None] == ratios[None, :]).astype(float)
    return np.column_stack([constants, *(_TERMS[term](rows) for term in terms)])


def _logarithm_of_length(key: str) -> Callable[[pd.DataFrame], Array]:
    """Function for the logarithm of a length over λ_s, from the depth over both."""
    return lambda rows: np.log((rows["depth_wavelength"] / rows[key]).to_numpy())


_TERMS: Mapping[str, Callable[[pd.DataFrame], Array]] = {
    "ln A": lambda rows: np.log(rows["area"].to_numpy()),
    "H": lambda rows: rows["hurst"].to_numpy(),
    "ln λ_l/λ_s": lambda rows: np.log(rows["ratio"].to_numpy()),
    **{f"ln {key}": _logarithm_of_length(key) for key in DEPTH_SCALES},
}
"""Terms of a fit by name; ``"ln depth_…"`` is the logarithm of that length over λ_s."""


def _jackknife(rows: pd.DataFrame, function: Callable[[pd.DataFrame], Array]) -> tuple[Array, Array]:
    """A function of the rows and its standard errors, leaving one surface out at a time."""
    names = rows["surface"].unique()
    if names.size < 3:
        raise ValueError(f"{names.size} surfaces: 3 or more are needed")
    found = np.array([function(rows[rows["surface"] != name]) for name in names])
    spread = (names.size - 1) / names.size * ((found - found.mean(axis=0)) ** 2).sum(axis=0)
    return function(rows), np.sqrt(spread)


def scatter(rows: pd.DataFrame, key: str, terms: Sequence[str] = ()) -> Scatter:
    """Scatter of a number over its scale, after terms that are fitted too.

    Parameters
    ----------
    rows : DataFrame
        As of `table`.
    key : str
        Column.
    terms : sequence of names
        ``"ln A"``, ``"H"``, ``"ln λ_l/λ_s"``, or ``"ln "`` and a key of `DEPTH_SCALES`: that length over λ_s.
    """

    def root_mean_square(some: pd.DataFrame) -> Array:
        return np.array([np.sqrt(np.mean(_left(some, key, terms) ** 2))])

    value, error = _jackknife(rows, root_mean_square)
    return Scatter(float(value[0]), float(error[0]))


def exponents(rows: pd.DataFrame, key: str, terms: Sequence[str]) -> dict[str, Scatter]:
    """Slopes of the logarithm of a number with each term, and their standard errors."""

    def slopes(some: pd.DataFrame) -> Array:
        matrix, value = _design(some, terms), np.log(some[key].to_numpy())
        return np.linalg.lstsq(matrix, value, rcond=None)[0][-len(terms) :]

    value, error = _jackknife(rows, slopes)
    return {name: Scatter(float(v), float(e)) for name, v, e in zip(terms, value, error, strict=True)}


def of_poisson(rows: pd.DataFrame, key: str) -> dict[float, Scatter]:
    """Geometric mean of a number over surfaces and areas at each Poisson's ratio, and its standard error."""
    ratios = np.sort(rows["poisson"].unique())

    def means(some: pd.DataFrame) -> Array:
        return np.array([np.exp(np.log(some.loc[some["poisson"] == nu, key]).mean()) for nu in ratios])

    value, error = _jackknife(rows, means)
    return {float(nu): Scatter(float(v), float(e)) for nu, v, e in zip(ratios, value, error, strict=True)}


def hertz_peak(poisson: float) -> tuple[float, float]:
    """Largest von Mises stress on the axis of a Hertzian contact over its mean pressure, and depth over a."""
    contact = Hertz.from_approach(1e-2, 1.0)
    radius = math.sqrt(1e-2)
    depth = np.linspace(0, 1.5, 3001) * radius
    stress = contact.stress(np.zeros_like(depth), depth, poisson).von_mises
    top = int(np.argmax(stress))
    return float(stress[top] / contact.mean_contact_pressure), float(depth[top] / radius)
