"""Extrapolation to vanishing grid spacing, from a contact and the same contact on half as many nodes.

The largest error of a contact on a grid is usually that of the grid. Each of its parts is corrected by what
theory gives and many random surfaces show (``docs/continuum.md``):

Area
    A node in contact counts with the whole of its pixel, so that every patch is too wide by a share of the
    spacing along its boundary. The boundary, counted in edges between nodes inside and outside, times
    `BOUNDARY_SHARE` is subtracted. (Yastrebov, Anciaux and Molinari 2017,
    https://doi.org/10.1016/j.triboint.2017.04.023, derive a share of 0.118 for random cuts.)
Slopes and depths
    The rms gradient over the contact and the depths of peaks converge with the square of the spacing:
    Richardson's extrapolation of second order.
Percentiles of peaks
    A coarse grid misses the lowest peaks and hardly changes the high ones. The number of peaks is
    extrapolated, and the percentile of all of them is the peak of the same rank among those found.

The error that remains is a share of the correction, or grows with the boundary per contact node, which
measures how well patches are resolved: `SHARE_OF_CORRECTION` and `OF_BOUNDARY` hold the measured factors.
A surface with waves shorter than four nodes loses them on half of the nodes, and its corrections err more.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from asperity.core.types import Array
from asperity.fourier.grid import Grid
from asperity.stress.peaks.selection import peaks, selection_for
from asperity.stress.statistics.covariance import decay_lengths_of
from asperity.stress.statistics.pooling import HIGHEST_SHARE

BOUNDARY_SHARE = 0.102
"""Area over spacing and boundary that nodes in contact count too much."""

SECOND_ORDER = "gradient_rms_contact", "number", "mean_depth", "mean_depth_highest"
"""Numbers whose error falls with the square of the spacing."""

SHARE_OF_CORRECTION = {
    "area_fraction": (0.14, 1.3),
    "gradient_rms_contact": (0.4, 5.5),
    "mean_depth": (0.66, 6.5),
}
"""Output → error that remains over the correction, and what the squared gradient that is lost on half of the
nodes, as a share of all, adds to this."""

OF_BOUNDARY = {
    "p90": (0.095, 3, 0.12),
    "p99": (0.1, 3, 0.12),
    "largest": (0.085, 4, 0.12),
    "mean_depth_highest": (0.235, 3, 0.2),
    "decay_length_depth": (0.07, 1.5, 0.14),
    "decay_length_plane": (0.14, 1, 0.14),
}
"""Output → factor and power of the boundary per contact node that give the relative error that remains, and
the factor of the boundary that is its most."""

KINDS = ("on_grid", "on_half", "estimate", "error")


class OnGrid(NamedTuple):
    """Results on one grid.

    Parameters
    ----------
    pressure : (ny, nx) array
    load : float
        Mean pressure over the effective modulus.
    gradient : float
        Root-mean-square gradient over the contact.
    grid : Grid
    stress : dataset, optional
    """

    pressure: Array
    load: float
    gradient: float
    grid: Grid
    stress: xr.Dataset | None = None


def extrapolate(fine: OnGrid, coarse: OnGrid, lost: float = 0.0, reason: str = "") -> xr.Dataset:
    """The dataset of `asperity.continuum` from the results on two grids under the same load.

    Parameters
    ----------
    fine, coarse : OnGrid
        On all nodes, and on half as many along both edges.
    lost : float
        Share of the squared gradient of the surface in waves that the coarse grid does not hold.
    reason : str
        Why there is no estimate; empty if there is one.
    """
    found, other = numbers_on(fine), numbers_on(coarse)
    if reason:
        return _joined(found, other, found * np.nan, found * np.nan).assign_attrs(reason=reason)
    to_come = (found - other) / ((coarse.grid.spacing[0] / fine.grid.spacing[0]) ** 2 - 1)
    best = found.copy()
    for name in SECOND_ORDER:
        if name in best:
            best[name] = found[name] + to_come[name]
    best["area_fraction"] = found["area_fraction"] - BOUNDARY_SHARE * found["boundary"]
    best["proportionality"] = best["area_fraction"] * best["gradient_rms_contact"] / fine.load
    if fine.stress is not None:
        best.update(_percentiles(fine.stress, best["number"]))
    unresolved = float(found["boundary"] / found["area_fraction"])
    errors: dict[str, Any] = {
        name: abs((share + more * lost) * (best[name] / found[name] - 1))
        for name, (share, more) in SHARE_OF_CORRECTION.items()
        if name in found
    }
    errors["proportionality"] = np.hypot(errors["area_fraction"], errors["gradient_rms_contact"])
    for name, (factor, power, most) in OF_BOUNDARY.items():
        if name in found:
            errors[name] = xr.full_like(found[name], min(factor * unresolved**power, most * unresolved))
    return _joined(found, other, best, xr.Dataset(errors))


def _joined(*kinds: xr.Dataset) -> xr.Dataset:
    """Values on the grid and on half of the nodes, estimates and errors of all outputs along `kind`."""
    outputs = [name for name in kinds[0] if name not in ("boundary", "number")]
    joined = xr.concat([kind[outputs] for kind in kinds], "kind", coords="minimal")
    return joined.assign_coords(kind=list(KINDS))


def numbers_on(results: OnGrid) -> xr.Dataset:
    """Numbers of the contact, and those of the peaks and the decay of its stress, on one grid."""
    touching = results.pressure > 0
    edges = sum(np.count_nonzero(touching != np.roll(touching, 1, axis)) for axis in (0, 1))
    area = float(touching.mean())
    numbers = xr.Dataset(
        {
            "area_fraction": area,
            "boundary": edges / touching.size,
            "gradient_rms_contact": results.gradient,
            "proportionality": area * results.gradient / results.load,
        }
    )
    if results.stress is None:
        return numbers
    stress = results.stress
    along_depth, in_plane = decay_lengths_of(stress)
    numbers["decay_length_depth"] = "poisson", along_depth
    numbers["decay_length_plane"] = "poisson", in_plane
    return numbers.merge(_depths(stress)).merge(_percentiles(stress))


def _of_peaks(
    stress: xr.Dataset, measure: Callable[[Array, Array, int, int], dict[str, float]]
) -> xr.Dataset:
    """What `measure` takes from the sizes and depths of the peaks of each quantity and Poisson's ratio."""
    quantities, ratios = stress["quantity"].values, stress["poisson"].values
    rows = []
    for q, p in np.ndindex(len(quantities), len(ratios)):
        name = str(quantities[q])
        some = peaks(stress, name, float(ratios[p]), selection_for(name))
        size, depth = np.abs(some["peak_value"].values), some["peak_depth"].values
        rows.append(measure(size, depth, q, p))
    shape = len(quantities), len(ratios)
    return xr.Dataset(
        {name: (("quantity", "poisson"), np.reshape([row[name] for row in rows], shape)) for name in rows[0]},
        coords={"quantity": quantities, "poisson": ratios},
    )


def _depths(stress: xr.Dataset) -> xr.Dataset:
    """Number of peaks, mean depth of all and of the highest ones."""

    def measure(size: Array, depth: Array, q: int, p: int) -> dict[str, float]:
        high = size >= np.quantile(size, 1 - HIGHEST_SHARE) if size.size else []
        return {
            "number": float(size.size),
            "mean_depth": float(depth.mean()) if size.size else np.nan,
            "mean_depth_highest": float(depth[high].mean()) if size.size else np.nan,
        }

    return _of_peaks(stress, measure)


def _percentiles(stress: xr.Dataset, number: xr.DataArray | None = None) -> xr.Dataset:
    """Percentiles of `number` peaks, of which only the highest were found, and the largest one."""

    def measure(size: Array, depth: Array, q: int, p: int) -> dict[str, float]:
        if not size.size:
            return dict.fromkeys(("p90", "p99", "largest"), np.nan)
        all_over_found = 1.0 if number is None else float(number[q, p]) / size.size
        levels = np.clip([1 - 0.1 * all_over_found, 1 - 0.01 * all_over_found], 0, 1)
        p90, p99 = np.quantile(size, levels)
        return {"p90": float(p90), "p99": float(p99), "largest": float(size.max())}

    return _of_peaks(stress, measure)
