"""Validation table: what is compared with what, the error, its source and the bound that the tests guard."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from asperity import markup
from asperity.validation.convergence import convergence_order
from asperity.validation.finite_elements import FIELDS, largest_differences

BOUNDS = {
    "load_area": 0.01,
    "wave_pressure_rate": 0.8,
    "wave_approach": 5e-4,
    "slab_load": 5e-4,
    "elements_load": 5e-4,
    "elements_away": 3e-3,
    "elements_edge": 0.1,
    "calculix_load": 5e-3,
    "calculix_away": 0.02,
    "punch_peak": 0.01,
    "punch_depth": 0.01,
    "elliptic_pressure": 1e-4,
    "elliptic_stress": 2e-4,
    "elliptic_depth": 5e-4,
    "edge_tension": 3e-4,
    "layer_punch_load": 0.015,
    "layer_paraboloid_load": 3e-4,
    "layer_contact_radius": 0.01,
    "wave_small_contact": 5e-3,
    "wave_nearly_complete": 5e-3,
}
"""Upper bounds of the errors, and a lower bound of the convergence order ``wave_pressure_rate``.

Bound *b* is guarded by the test ``test_b`` of ``tests/physics/test_validation.py``."""


class Row(NamedTuple):
    """One line of the validation table."""

    quantity: str
    against: str
    grid: str
    source: str
    error: float
    bound: float
    test: str

    @property
    def holds(self) -> bool:
        """True if the error is at most its bound, or a convergence order at least its bound."""
        return self.error >= self.bound if self.source == "rate" else self.error <= self.bound


def table_rows(datasets: Mapping[str, xr.Dataset]) -> list[Row]:
    """Rows of the validation table.

    Parameters
    ----------
    datasets : mapping
        Results of the comparisons ``load_area``, ``grid_convergence``, ``elements``, ``calculix``, ``punch``,
        ``elliptic_contacts``, ``edge_tension``, ``layer_indentation`` and ``wave_asymptotes``, as many as
        were made; others are ignored.
    """
    rows: dict[str, Callable[[xr.Dataset], Iterable[Row]]] = {
        "load_area": lambda found: [_load_area_row(found)],
        "grid_convergence": _grid_convergence_rows,
        "elements": lambda found: _element_rows("elements", found),
        "calculix": lambda found: _element_rows("calculix", found),
        "punch": _punch_rows,
        "elliptic_contacts": _elliptic_rows,
        "edge_tension": lambda found: [_edge_tension_row(found)],
        "layer_indentation": _layer_rows,
        "wave_asymptotes": _wave_rows,
    }
    return [row for name, rows_of in rows.items() if name in datasets for row in rows_of(datasets[name])]


def frame(rows: Sequence[Row]) -> pd.DataFrame:
    """The table ``validation`` of `asperity.results.tables.TABLES`, with all digits."""
    columns = ["quantity", "against", "grid", "source", "error", "bound", "holds", "test"]
    return pd.DataFrame([[getattr(row, name) for name in columns] for row in rows], columns=columns)


def for_reader(rows: Sequence[Row]) -> pd.DataFrame:
    """The table as text: errors in percent; an error beyond its bound is marked."""
    table = []
    for row in rows:
        value = f"order {row.error:.2f}" if row.source == "rate" else f"{100 * row.error:.2g} %"
        limit = f"≥ {row.bound:g}" if row.source == "rate" else f"{100 * row.bound:g} %"
        verdict = limit if row.holds else f"{limit}, **exceeded**"
        table.append([row.quantity, row.against, row.grid, row.source, value, verdict, f"`{row.test}`"])
    head = ["quantity", "against", "grid; mesh", "error is of", "error", "bound", "guarded by"]
    return pd.DataFrame(table, columns=head)


def markdown(rows: Sequence[Row]) -> str:
    """The table in Markdown, for `docs/validation.md`."""
    return markup.markdown(for_reader(rows)) + "\n"


def _row(quantity: str, against: str, grid: str, source: str, error: xr.DataArray | float, bound: str) -> Row:
    """Row with the magnitude of an error and the bound of that name."""
    magnitude = float(np.abs(error))
    return Row(quantity, against, grid, source, magnitude, BOUNDS[bound], f"test_validation.py::test_{bound}")


def _load_area_row(found: xr.Dataset) -> Row:
    """Row of the contact radius against the periodic Hertz contact."""
    error = np.abs(found.solved_contact_radius / found.hertz_contact_radius - 1).max()
    return _row(
        "contact radius at given load",
        "periodic Hertz, Eq. 15",
        f"{found.attrs['grid_points']}²",
        "grid, Hertz's shape",
        error,
        "load_area",
    )


def _grid_convergence_rows(found: xr.Dataset) -> Iterator[Row]:
    """Rows of the wave and of the slab on the finest grid."""
    finest = found.isel(grid_points=-1)
    points = f"{int(finest.grid_points)}"
    order = convergence_order(found.grid_points, found.wave_pressure_error)
    yield _row("pressure, L2", "Westergaard", "all grids", "rate", order, "wave_pressure_rate")
    yield _row("approach", "Westergaard", points, "grid", finest.wave_approach_error, "wave_approach")
    yield _row(
        "load at given approach, slab",
        "twice the grid",
        f"{points}²",
        "grid",
        finest.slab_load_error,
        "slab_load",
    )


def _element_rows(name: str, found: xr.Dataset) -> Iterator[Row]:
    """Rows of the comparison with a finite-element code, ``elements`` or ``calculix``."""
    differences = largest_differences(found)
    mesh = f"{found.attrs['grid_points']}²; {found.attrs['elements']}"
    code = found.attrs["code"]
    yield _row(
        "load at given approach, slab", code, mesh, "mesh, grid", differences.difference_load, f"{name}_load"
    )
    for field in FIELDS:
        error = differences.difference_away.sel(field=field)
        yield _row(f"{_symbol(field)} away from the edge", code, mesh, "mesh, grid", error, f"{name}_away")
    if f"{name}_edge" in BOUNDS:
        for field in FIELDS:
            error = differences.difference_edge.sel(field=field)
            yield _row(f"{_symbol(field)} at the edge", code, mesh, "edge", error, f"{name}_edge")


def _punch_rows(found: xr.Dataset) -> Iterator[Row]:
    """Rows of the largest von Mises stress under the paraboloid, and of its depth."""
    grid, source = f"{found.attrs['grid_points']}²", "periodic cell, grid"
    for nu in found.poisson.values:
        one = found.sel(poisson=nu)
        error = one.peak_von_mises_array / one.peak_von_mises_closed_form - 1
        yield _row(f"largest von Mises stress, ν = {nu:g}", "Hertz, Huber", grid, source, error, "punch_peak")
        error = one.peak_depth_array / one.peak_depth_closed_form - 1
        yield _row(f"its depth, ν = {nu:g}", "Hertz, Huber", grid, source, error, "punch_depth")


def _elliptic_rows(found: xr.Dataset) -> Iterator[Row]:
    """Rows of the elliptic contacts, each the largest error of all ratios of the semi-axes."""
    ratios = found.axis_ratio.values
    grid, against = (
        f"{found.attrs['grid_points']}²",
        f"elliptic Hertz, b/a = {ratios.min():g}…{ratios.max():g}",
    )
    for quantity, name, bound in (
        ("largest pressure", "largest_pressure", "elliptic_pressure"),
        ("largest von Mises stress on the axis", "von_mises", "elliptic_stress"),
        ("its depth", "von_mises_depth", "elliptic_depth"),
        ("largest shear stress on the axis", "largest_shear", "elliptic_stress"),
        ("its depth", "largest_shear_depth", "elliptic_depth"),
    ):
        yield _row(quantity, against, grid, "grid", relative_error(found, name).max(), bound)


def _edge_tension_row(found: xr.Dataset) -> Row:
    """Row of the tension outside the edge of contact, relative to the largest pressure."""
    error = np.abs(found.solved_tension - found.exact_tension).max()
    grid = f"{found.attrs['grid_points']}²"
    return _row("tension at the edge, over p₀", "(1 − 2ν)/3 p₀ a²/r²", grid, "grid", error, "edge_tension")


def _layer_rows(found: xr.Dataset) -> Iterator[Row]:
    """Rows of the bonded layers, each the largest error of all layers."""
    grid, against = f"{found.attrs['grid_points']}²", "bonded layer, Fredholm equation"
    loads = relative_error(found, "load").max(("contact_ratio", "poisson"))
    for indenter, name in (("flat punch", "layer_punch_load"), ("paraboloid", "layer_paraboloid_load")):
        yield _row(f"load of a layer, {indenter}", against, grid, "grid", loads.sel(indenter=indenter), name)
    radius = relative_error(found, "contact_radius").max()
    yield _row("contact radius, paraboloid", against, grid, "grid", radius, "layer_contact_radius")


def _wave_rows(found: xr.Dataset) -> Iterator[Row]:
    """Rows of the bisinusoidal wave, at the load nearest to each asymptote."""
    grid, source = f"{found.attrs['grid_points']}²", "asymptote, grid"
    for quantity, name, load, end, bound in (
        ("contact radius", "contact_radius", "small_load", 0, "wave_small_contact"),
        ("mean gap", "mean_gap", "nearly_complete_load", -1, "wave_nearly_complete"),
    ):
        value = float(found[load][end])
        error = relative_error(found, name).isel({load: end})
        yield _row(f"{quantity} at p̄/p* = {value:g}", "bisinusoidal wave", grid, source, error, bound)


def relative_error(found: xr.Dataset, name: str) -> xr.DataArray:
    """Magnitude of the relative difference between ``solved_`` and ``exact_`` values of a quantity."""
    return abs(found[f"solved_{name}"] / found[f"exact_{name}"] - 1)


def _symbol(field: str) -> str:
    """Symbol of a field, σ_zz for ``stress_zz``."""
    quantity, component = field.split("_")
    return {"displacement": "u", "stress": "σ"}[quantity] + "_" + component
