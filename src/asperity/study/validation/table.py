"""Comparisons of the study: the functions that make them, and the errors that they must keep.

`CHECKS` is the one list of errors with their bounds. The study writes them as a table
(``results/validation/table.csv``), and ``tests/physics/test_validation.py`` asserts each.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from asperity.study.validation.closed_forms import (
    edge_tension,
    elliptic_contacts,
    grid_convergence,
    layer_indentation,
    load_area,
    punch,
    slab_load_area,
    wave_asymptotes,
)
from asperity.study.validation.extremes import outcome_matrix
from asperity.study.validation.finite_elements import (
    FIELDS,
    compare_elements,
    largest_differences,
    mesh_convergence,
)
from asperity.study.validation.rounding import rounding_errors

COMPARISONS: Mapping[str, Callable[..., xr.Dataset]] = {
    "load_area": load_area,
    "slab_load_area": slab_load_area,
    "grid_convergence": grid_convergence,
    "elements": compare_elements,
    "mesh_convergence": mesh_convergence,
    "punch": punch,
    "elliptic_contacts": elliptic_contacts,
    "edge_tension": edge_tension,
    "layer_indentation": layer_indentation,
    "wave_asymptotes": wave_asymptotes,
    "stability": rounding_errors,
    "extremes": outcome_matrix,
}
"""Function of each comparison, by its key in section ``validation``; the keywords are the keys there."""


class Check(NamedTuple):
    """An error of a comparison that must be within a bound.

    Attributes
    ----------
    comparison, quantity, against, source : str
        Key of `COMPARISONS`, what is compared, with what, and where the error comes from.
    bound : float
        Largest error; smallest order of convergence if the source is ``"rate"``.
    error : callable
        Error from the dataset of the comparison.
    grid : str
        Grid and mesh; attributes of the dataset are inserted.
    """

    comparison: str
    quantity: str
    against: str
    source: str
    bound: float
    error: Callable[[xr.Dataset], Any]
    grid: str


def relative_error(found: xr.Dataset, name: str, exact: str = "exact") -> xr.DataArray:
    """Magnitude of the relative difference between ``solved_`` and ``exact_`` values of a quantity."""
    return abs(found[f"solved_{name}"] / found[f"{exact}_{name}"] - 1)


def convergence_order(points: xr.DataArray, error: xr.DataArray) -> float:
    """Order n of an error ~ points⁻ⁿ, fitted over all grids."""
    return float(-np.polyfit(np.log(points.values), np.log(error.values), 1)[0])


def _worst(name: str, exact: str = "exact", **selected: Any) -> Callable[[xr.Dataset], Any]:
    return lambda found: relative_error(found, name, exact).sel(**selected).max()


def _peak(name: str, nu: float) -> Callable[[xr.Dataset], Any]:
    return lambda found: (found[f"{name}_array"] / found[f"{name}_closed_form"] - 1).sel(poisson=nu)


def _difference(where: str, field: str) -> Callable[[xr.Dataset], Any]:
    return lambda found: largest_differences(found)[f"difference_{where}"].sel(field=field)


_SQUARE = "{grid_points}²"
_MESH = "{grid_points}²; {elements}"
_SYMBOLS = {"displacement_z": "u_z", "stress_zz": "σ_zz", "stress_xx": "σ_xx", "stress_xz": "σ_xz"}

_ERRORS: Mapping[tuple[str, str, str, str], Sequence[tuple[str, float, Callable[[xr.Dataset], Any]]]] = {
    ("load_area", "periodic Hertz, Eq. 15", "grid, Hertz's shape", _SQUARE): [
        ("contact radius at given load", 0.01, _worst("contact_radius", exact="hertz")),
    ],
    ("grid_convergence", "Westergaard", "rate", "all grids"): [
        ("pressure, L2", 0.8, lambda d: convergence_order(d.grid_points, d.wave_pressure_error)),
    ],
    ("grid_convergence", "Westergaard", "grid", "{grid_points}"): [
        ("approach", 5e-4, lambda d: d.wave_approach_error[-1]),
    ],
    ("grid_convergence", "twice the grid", "grid", _SQUARE): [
        ("load at given approach, slab", 5e-4, lambda d: d.slab_load_error[-1]),
    ],
    ("elements", "scikit-fem", "mesh, grid", _MESH): [
        ("load at given approach, slab", 5e-4, lambda d: largest_differences(d).difference_load),
        *((f"{_SYMBOLS[name]} away from the edge", 3e-3, _difference("away", name)) for name in FIELDS),
    ],
    ("elements", "scikit-fem", "edge", _MESH): [
        *((f"{_SYMBOLS[name]} at the edge", 0.1, _difference("edge", name)) for name in FIELDS),
    ],
    ("punch", "Hertz, Huber", "periodic cell, grid", _SQUARE): [
        ("largest von Mises stress, ν = 0", 0.01, _peak("peak_von_mises", 0)),
        ("its depth, ν = 0", 0.01, _peak("peak_depth", 0)),
        ("largest von Mises stress, ν = 0.5", 0.01, _peak("peak_von_mises", 0.5)),
        ("its depth, ν = 0.5", 0.01, _peak("peak_depth", 0.5)),
    ],
    ("elliptic_contacts", "elliptic Hertz, b/a = 0.2…1", "grid", _SQUARE): [
        ("largest pressure", 1e-4, _worst("largest_pressure")),
        ("largest von Mises stress on the axis", 2e-4, _worst("von_mises")),
        ("its depth", 5e-4, _worst("von_mises_depth")),
        ("largest shear stress on the axis", 2e-4, _worst("largest_shear")),
        ("its depth", 5e-4, _worst("largest_shear_depth")),
    ],
    ("edge_tension", "(1 − 2ν)/3 p₀ a²/r²", "grid", _SQUARE): [
        ("tension at the edge, over p₀", 3e-4, lambda d: abs(d.solved_tension - d.exact_tension).max()),
    ],
    ("layer_indentation", "bonded layer, Fredholm equation", "grid", _SQUARE): [
        ("load of a layer, flat punch", 0.015, _worst("load", indenter="flat punch")),
        ("load of a layer, paraboloid", 3e-4, _worst("load", indenter="paraboloid")),
        ("contact radius, paraboloid", 0.01, _worst("contact_radius")),
    ],
    ("wave_asymptotes", "bisinusoidal wave", "asymptote, grid", _SQUARE): [
        ("contact radius at p̄/p* = 0.001", 5e-3, _worst("contact_radius", small_load=0.001)),
        ("mean gap at p̄/p* = 0.99", 5e-3, _worst("mean_gap", nearly_complete_load=0.99)),
    ],
}
"""Comparison, what it is compared with, source of the error, grid → quantities, bounds and errors."""

CHECKS = [
    Check(comparison, quantity, against, source, bound, error, grid)
    for (comparison, against, source, grid), rows in _ERRORS.items()
    for quantity, bound, error in rows
]
"""Errors of the comparisons with closed forms and finite elements, and their bounds."""


def title(name: str) -> str:
    """Title of the dataset of a comparison: the first line of its function's docstring."""
    return f"Validation: {(COMPARISONS[name].__doc__ or name).splitlines()[0].removesuffix('.')}"


def row_of(check: Check, found: xr.Dataset) -> dict[str, Any]:
    """Row of the table for a check of the dataset of its comparison.

    An order of convergence, of the source ``rate``, holds from its bound on, an error up to its bound.
    """
    error = float(np.abs(check.error(found)))
    return {
        "quantity": check.quantity,
        "against": check.against,
        "grid": check.grid.format(**found.attrs),
        "source": check.source,
        "error": error,
        "bound": check.bound,
        "holds": error >= check.bound if check.source == "rate" else error <= check.bound,
    }


def frame(datasets: Mapping[str, xr.Dataset]) -> pd.DataFrame:
    """The table ``validation`` of `asperity.results.tables.TABLES`, of some comparisons by name."""
    columns = ["quantity", "against", "grid", "source", "error", "bound", "holds"]
    made = [check for check in CHECKS if check.comparison in datasets]
    return pd.DataFrame([row_of(check, datasets[check.comparison]) for check in made], columns=columns)


def for_reader(table: pd.DataFrame) -> pd.DataFrame:
    """The table as text: errors in percent; an error beyond its bound is marked."""
    rows = []
    for row in table.itertuples():
        value = f"order {row.error:.2f}" if row.source == "rate" else f"{100 * row.error:.2g} %"
        limit = f"≥ {row.bound:g}" if row.source == "rate" else f"{100 * row.bound:g} %"
        limit = limit if row.holds else f"{limit}, **exceeded**"
        rows.append([row.quantity, row.against, row.grid, row.source, value, limit])
    head = ["quantity", "against", "grid; mesh", "error is of", "error", "bound"]
    return pd.DataFrame(rows, columns=head)
