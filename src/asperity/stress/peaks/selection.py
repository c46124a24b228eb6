"""Peaks by name, and their numbers, from the dataset of a stress analysis: only this module knows its layout.

The peaks of all quantities and Poisson's ratios stand one after the other along the dimension `peak`.
``peak_quantity`` is the name of the quantity, ``peak_poisson`` the Poisson's ratio of each peak. The ratio is
NaN where the quantity is the same for every one; `select_peaks` finds such peaks under any of the analysed
ratios.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from asperity.core.arguments import choice, number
from asperity.core.errors import shown
from asperity.core.types import Array, ArrayLike

SELECTIONS = ("all", "at_contact", "interior", "under_contact")
"""Names of the selections of `select_peaks`."""

LARGEST_AT_SURFACE = (
    "pressure",
    "xx",
    "yy",
    "zz",
    "hydrostatic",
    "principal_1",
    "principal_2",
    "principal_3",
)
"""Quantities whose magnitude is largest in the surface."""

SAME_RATIO = 1e-9
"""Poisson's ratios that differ by less are the same: room for numbers such as 0.1 + 0.2."""

ROUNDING = 1e-9
"""Rounding error of the number of peaks above a quantile."""

HIGHEST_SHARE = 0.1
"""Fraction of the peaks that are the highest ones."""

_LABELS = ("peak_quantity", "peak_poisson")


def select_peaks(
    stress: xr.Dataset, quantity: str, poisson: float | None = None, selection: str = "all"
) -> xr.Dataset:
    """Select the peaks of one quantity from the result of a stress analysis.

    Parameters
    ----------
    stress : dataset
        Result of `analyse_stress`, or a result file of stage stress.
    quantity : str
        One of the analysed quantities, ``stress["quantity"]``.
    poisson : float, optional
        One of the analysed Poisson's ratios, ``stress["poisson"]``. It may be left out if there is only one,
        or for a quantity that is the same for every one: the pressure, and in a half-space σ_zz, σ_yz and
        σ_xz.
    selection : str
        ``"all"``;
        ``"at_contact"``: the surface node nearest above the peak, or at it, carries pressure;
        ``"interior"``: the peak is below the surface;
        ``"under_contact"``: both.

    Returns
    -------
    dataset
        Variables along `peak` alone: ``peak_value``, ``peak_depth``, ``peak_y``, ``peak_x``,
        ``peak_interior``, ``peak_under_contact``; of a mirrored map also ``peak_on_image`` and
        ``peak_weight``; with the coordinates ``quantity`` and ``poisson``.

    Raises
    ------
    ValueError
        If an argument is not among those that the dataset has.

    Examples
    --------
    The von Mises peaks below the contacts, as a table of pandas:

    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.33), contact_area_fraction=0.1)
    >>> stress = asp.analyse_stress(contact, quantities=("von_mises",))
    >>> below = asp.stress.select_peaks(stress, "von_mises", poisson=0.33, selection="under_contact")
    >>> table = below.to_dataframe()
    >>> list(table.columns[:4]), bool(table["peak_depth"].min() > 0)
    (['peak_value', 'peak_depth', 'peak_y', 'peak_x'], True)
    """
    if not (isinstance(stress, xr.Dataset) and {*_LABELS, "quantity", "poisson"} <= set(stress.variables)):
        raise TypeError(f"stress = {shown(stress)}: the result of a stress analysis, a dataset, is needed")
    names, own_ratios = (stress[name].values for name in _LABELS)
    choice("quantity", quantity, [str(name) for name in stress["quantity"].values])
    choice("selection", selection, SELECTIONS)
    chosen = names == quantity
    ratios = [float(nu) for nu in stress["poisson"].values]
    if poisson is None and np.isnan(own_ratios[chosen]).all():
        ratio = np.nan
    else:
        ratio = checked_ratio(poisson, ratios)
    chosen &= (own_ratios == ratio) | np.isnan(own_ratios)
    chosen &= is_selected(stress, selection)
    columns = [name for name in stress.data_vars if stress[name].dims == ("peak",)]
    found = stress[columns].isel(peak=np.flatnonzero(chosen)).drop_vars(_LABELS).drop_attrs(deep=False)
    coordinates = {"quantity": quantity, "poisson": ratio}
    return found.assign_coords({name: ((), value, stress[name].attrs) for name, value in coordinates.items()})


def in_cell(found: xr.Dataset) -> tuple[xr.Dataset, int]:
    """Selected peaks as often as a period of the stress holds them, and the number of maps in it.

    It is the cell of four maps of a mirrored one, otherwise one map. Percentiles of the peaks are those of
    the period; their number on the map is the number in the period over the number of maps.
    """
    if "peak_weight" not in found:
        return found, 1
    copies = np.rint(4 * found["peak_weight"].values).astype(int)
    return found.isel(peak=np.repeat(np.arange(copies.size), copies)), 4


def is_selected(stress: xr.Dataset, selection: str) -> Array:
    """True for every peak of an analysis, or of a result of `select_peaks`, that a selection holds."""
    chosen = np.ones(stress.sizes["peak"], bool)
    if selection in ("interior", "under_contact"):
        chosen &= stress["peak_interior"].values
    if selection in ("at_contact", "under_contact"):
        chosen &= stress["peak_under_contact"].values
    return chosen


def selection_for(quantity: str) -> str:
    """The selection of `select_peaks` that figures and claims count for a quantity.

    They count peaks under a contact, in the surface only for quantities that are largest there.
    """
    return "at_contact" if quantity in LARGEST_AT_SURFACE else "under_contact"


def has_percentile(count: ArrayLike, share: ArrayLike) -> Any:
    """True where one of `count` peaks or more lies above the quantile at `share`: 100 at 99 %.

    Of fewer peaks the quantile is the largest one, or lies between the two largest.
    """
    return np.asarray(count) * (1 - np.asarray(share)) >= 1 - ROUNDING


def checked_ratio(poisson: float | None, known: Sequence[float]) -> float:
    """The known Poisson's ratio nearest to the given one, which may be left out if only one is known."""
    accepted = f"one of {', '.join(f'{nu:g}' for nu in known)}"
    if poisson is None:
        if len(known) > 1:
            raise ValueError(f"poisson: {accepted} is needed, there are several")
        return known[0]
    ratio = number(
        "poisson", poisson, accepted, lambda size: any(abs(size - nu) <= SAME_RATIO for nu in known)
    )
    return min(known, key=lambda nu: abs(nu - ratio))


def peak_numbers(
    stress: xr.Dataset, levels: Sequence[float] | Array, all_peaks: xr.DataArray | None = None
) -> xr.Dataset:
    """Number, size and depth of the peaks that figures and claims count.

    Parameters
    ----------
    stress : dataset
        Result of `asperity.stress.analysis.analyse_stress`.
    levels : sequence of float
        Fractions of the peaks at which quantiles are taken.
    all_peaks : data array, optional
        Along `quantity` and `poisson`, the number of all peaks, for the quantiles: the peaks found are the
        highest of them, and the others are taken as equal to the smallest one.

    Returns
    -------
    dataset
        Along `quantity` and `poisson`: ``peak_count``, the ``peak_mean`` and ``peak_deviation`` of the
        magnitudes, ``mean_depth`` and ``mean_depth_highest``, of all peaks and of the highest tenth; also
        along `level`: ``peak_quantile``. NaN without peaks.
    """
    quantities, ratios = [str(name) for name in stress["quantity"].values], stress["poisson"].values
    levels, shape = np.asarray(levels), (len(quantities), len(ratios))
    number, mean, deviation, depth, depth_highest = np.full((5, *shape), np.nan)
    quantile = np.full((*shape, levels.size), np.nan)
    for q, p in np.ndindex(shape):
        found = select_peaks(stress, quantities[q], float(ratios[p]), selection_for(quantities[q]))
        found, maps = in_cell(found)
        size, depths = np.abs(found["peak_value"].values), found["peak_depth"].values
        number[q, p] = size.size / maps
        if not size.size:
            continue
        depth[q, p] = depths.mean()
        depth_highest[q, p] = depths[size >= np.quantile(size, 1 - HIGHEST_SHARE)].mean()
        all_over_found = 1.0 if all_peaks is None else float(all_peaks[q, p]) / number[q, p]
        quantile[q, p] = np.quantile(size, np.clip(1 - (1 - levels) * all_over_found, 0, 1))
        mean[q, p], deviation[q, p] = size.mean(), size.std()
    kinds = ("quantity", "poisson")
    return xr.Dataset(
        {
            "peak_count": (kinds, number),
            "peak_mean": (kinds, mean),
            "peak_deviation": (kinds, deviation),
            "peak_quantile": ((*kinds, "level"), quantile),
            "mean_depth": (kinds, depth),
            "mean_depth_highest": (kinds, depth_highest),
        },
        coords={"quantity": quantities, "poisson": ratios, "level": levels},
    )
