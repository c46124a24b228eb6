"""Comparisons of the study: the functions that make them, and the bounds of their errors.

`CHECKS`, read from `checks.yaml`, is the one list of errors with their bounds. The study writes them as a
table (``results/validation/table.csv``), and ``tests/workflow/test_validation.py`` asserts each.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from asperity.core.data import packaged_yaml
from asperity.results.tables import TABLES
from asperity.study.validation import closed_forms, finite_elements

CHECKS: list[dict[str, Any]] = [
    {"grid": "{grid_points}²", **block, "row": row}
    for block in packaged_yaml("asperity.study.validation", "checks.yaml")
    for row in block["rows"]
]
"""Errors of the comparisons with closed forms and finite elements; `checks.yaml` explains the keys."""


def comparison(name: str) -> Callable[..., xr.Dataset]:
    """Function of a comparison, by its key in section ``validation``; its keywords are the keys there."""
    return finite_elements.elements if name == "elements" else getattr(closed_forms, name)


def title(name: str) -> str:
    """Title of the dataset of a comparison: the first line of its function's docstring."""
    return f"Validation: {(comparison(name).__doc__ or name).splitlines()[0].removesuffix('.')}"


def row_of(check: Mapping[str, Any], found: xr.Dataset) -> dict[str, Any]:
    """A check of the dataset of its comparison, with the columns of the table.

    An order of convergence, of the source ``rate``, holds from its bound on, an error up to its bound.
    """
    quantity, bound, variable, exact, at = (*check["row"], None, None)[:5]
    grid = check["grid"].format(**found.attrs)
    values = found[variable]
    if exact:
        values = values - found[exact] if "absolute" in check else values / found[exact] - 1
    if check["source"] == "rate":
        error = -np.polyfit(np.log(found.grid_points), np.log(values), 1)[0]
    else:
        finest = values.isel(mesh=-1) if "mesh" in values.dims else values
        error = abs(finest.sel(at)).max()
    error = float(abs(error))
    holds = error >= bound if check["source"] == "rate" else error <= bound
    return {**check, "quantity": quantity, "grid": grid, "error": error, "bound": bound, "holds": holds}


def frame(datasets: Mapping[str, xr.Dataset]) -> pd.DataFrame:
    """The table ``validation`` of `asperity.results.tables.TABLES`, of some comparisons by name."""
    made = [check for check in CHECKS if check["comparison"] in datasets]
    rows = [row_of(check, datasets[check["comparison"]]) for check in made]
    return pd.DataFrame(rows, columns=list(TABLES["validation"]["columns"]))


def for_reader(table: pd.DataFrame) -> pd.DataFrame:
    """The table as text: errors in percent; an error beyond its bound is marked."""
    rows = []
    for row in table.itertuples():
        value = f"order {row.error:.2f}" if row.source == "rate" else f"{100 * row.error:.2g} %"
        limit = f"≥ {row.bound:g}" if row.source == "rate" else f"{100 * row.bound:g} %"
        limit = limit if row.holds else f"{limit}, **exceeded**"
        rows.append([row.quantity, row.against, row.grid, row.source, value, limit])
    head = ["quantity", "against", "grid; mesh", "source of the error", "error", "bound"]
    return pd.DataFrame(rows, columns=head)
