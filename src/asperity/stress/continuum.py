"""Limits of vanishing grid spacing, from a contact and the same contact on half as many nodes.

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
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr

from asperity.contact import Contact, solve
from asperity.core.types import Array, Progress
from asperity.fourier.grid import Fourier, Grid, mean_square, resample
from asperity.stress.analysis import analyse_stress
from asperity.stress.peaks.selection import peaks, selection_for
from asperity.stress.statistics.covariance import decay_lengths

BOUNDARY_SHARE = 0.102
"""Area over spacing and boundary that nodes in contact count too much."""

SECOND_ORDER = "gradient_rms_contact", "number", "mean_depth", "mean_depth_highest"
"""Numbers whose error falls with the square of the spacing."""

SHARE_OF_CORRECTION = {"area_fraction": 0.12, "gradient_rms_contact": 0.27, "mean_depth": 0.66}
"""Output → error that remains over the correction."""

OF_BOUNDARY = {
    "p90": (0.07, 3),
    "p99": (0.058, 5),
    "largest": (0.075, 6),
    "mean_depth_highest": (0.2, 3),
    "decay_length_depth": (0.057, 2),
    "decay_length_plane": (0.14, 1),
}
"""Output → factor and power of the boundary per contact node that give the relative error that remains."""

LEAST_NODES = 200
"""Contact nodes below which there is no estimate."""

LOST_GRADIENT = 0.02
"""Share of the squared gradient in waves shorter than four nodes above which there is no estimate."""

HIGHEST = 0.1
"""Share of the peaks that are the highest."""

KINDS = ("on_grid", "estimate", "error")


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

    @classmethod
    def of(cls, contact: Contact, stress: xr.Dataset | None) -> OnGrid:
        """Results of a contact and of the analysis of its stress."""
        load = contact.mean_pressure / contact.layer.effective_modulus
        return cls(contact.pressure, load, contact.gradient_rms_contact, contact.grid, stress)


def continuum(
    contact: Contact, stress: xr.Dataset | None = None, *, progress: Progress | None = None
) -> xr.Dataset:
    """Area, slope, peaks and decay lengths at vanishing grid spacing, each with the error that remains.

    The contact is solved again on half as many nodes along both edges, under the same load, and its stress
    is analysed, which costs about a quarter of what the contact and its stress cost.

    Parameters
    ----------
    contact : Contact
        With a periodic boundary. The limit is that of the band-limited surface through its nodes.
    stress : dataset, optional
        Result of `analyse_stress` for this contact. Without it, only numbers of the contact are estimated.
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    dataset
        Along `kind`, the value ``on_grid``, the ``estimate`` at vanishing spacing, and the relative ``error``
        of the estimate: ``area_fraction``, ``gradient_rms_contact``, and ``proportionality`` κ, their product
        times the effective modulus over the mean pressure. With a stress, also along `quantity` and `poisson`
        the percentiles ``p90`` and ``p99`` of the peaks, the ``largest`` one, and ``mean_depth`` and
        ``mean_depth_highest``, of all peaks and of the highest tenth; along `poisson` the
        ``decay_length_depth`` and ``decay_length_plane``. Stresses are in the unit of the contact pressure.
        Where the grid allows no estimate, it is NaN, and the attribute ``reason`` says why.

    Raises
    ------
    ValueError, TypeError
        If an argument is none of these.

    Examples
    --------
    The area at eight nodes on the shortest wavelength is too large by a tenth of its value:

    >>> height = asp.self_affine((128, 128), 0.8, 1 / 4, 1 / 16, rms_height=1e-3, seed=1)
    >>> contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.33), area_fraction=0.05)
    >>> area = asp.continuum(contact)["area_fraction"]
    >>> print(f"{float(area.sel(kind='on_grid')):.4f}, better {float(area.sel(kind='estimate')):.4f}")
    0.0500, better 0.0448
    """
    if not isinstance(contact, Contact):
        raise TypeError(f"contact = {type(contact).__name__}: a Contact is needed")
    fine = OnGrid.of(contact, stress)
    reason = reason_against(contact)
    if reason:
        found = _numbers(fine)
        unknown = found * np.nan
        return _joined(found, unknown, unknown).assign_attrs(reason=reason)
    half = on_half_the_nodes(contact)
    if progress is not None:
        progress(0.2, 1.0)
    coarse = None
    if stress is not None:
        coarse = analyse_stress(
            half,
            poisson=stress["poisson"].values.tolist(),
            quantities=[str(name) for name in stress["quantity"].values],
            friction=stress.attrs["friction"],
            sliding_direction=stress.attrs["sliding_direction"],
        )
    if progress is not None:
        progress(1.0, 1.0)
    return extrapolate(fine, OnGrid.of(half, coarse))


def reason_against(contact: Contact) -> str:
    """Why a contact allows no estimate; empty if it does."""
    nodes = np.count_nonzero(contact.pressure)
    if contact.boundary != "periodic":
        return "the boundary is free, and the estimate is made for periodic cells"
    if nodes < LEAST_NODES:
        return f"{nodes} nodes are in contact, and {LEAST_NODES} are needed"
    grid, coarse = contact.grid, _half(contact.grid)
    modes = Fourier(grid).forward(contact.height)
    weight = grid.wavenumber() ** 2
    kept = mean_square(resample(resample(modes, grid, coarse), coarse, grid), grid, weight)
    lost = 1 - kept / mean_square(modes, grid, weight)
    if lost > LOST_GRADIENT:
        return (
            f"waves shorter than four nodes have {100 * lost:.0f} % of the squared gradient, at most "
            f"{100 * LOST_GRADIENT:g} % is accepted: the surface goes on below its nodes, or has steps"
        )
    return ""


def _half(grid: Grid) -> Grid:
    """The grid with half as many nodes along both edges."""
    return Grid((max(grid.shape[0] // 2, 4), max(grid.shape[1] // 2, 4)), grid.length)


def on_half_the_nodes(contact: Contact) -> Contact:
    """The same contact under the same load on half as many nodes along both edges."""
    grid = contact.grid
    half = _half(grid)
    height = Fourier(half).inverse(resample(Fourier(grid).forward(contact.height), grid, half))
    return solve(height, contact.solid, half.length, mean_pressure=contact.mean_pressure, rtol=contact.rtol)


def extrapolate(fine: OnGrid, coarse: OnGrid) -> xr.Dataset:
    """The dataset of `continuum` from the results on two grids under the same load."""
    found, other = _numbers(fine), _numbers(coarse)
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
    errors = {
        name: abs(share * (best[name] / found[name] - 1))
        for name, share in SHARE_OF_CORRECTION.items()
        if name in found
    }
    errors["proportionality"] = np.hypot(errors["area_fraction"], errors["gradient_rms_contact"])
    for name, (factor, power) in OF_BOUNDARY.items():
        if name in found:
            errors[name] = xr.full_like(found[name], factor * unresolved**power)
    return _joined(found, best, xr.Dataset(errors))


def _joined(found: xr.Dataset, best: xr.Dataset, error: xr.Dataset) -> xr.Dataset:
    """Values on the grid, estimates and errors of all outputs along `kind`."""
    outputs = [name for name in found if name not in ("boundary", "number")]
    joined = xr.concat([kind[outputs] for kind in (found, best, error)], "kind", coords="minimal")
    return joined.assign_coords(kind=list(KINDS))


def _numbers(results: OnGrid) -> xr.Dataset:
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
    lengths = np.array([_decay(stress.sel(poisson=ratio)) for ratio in stress["poisson"].values])
    numbers["decay_length_depth"] = "poisson", lengths[:, 0]
    numbers["decay_length_plane"] = "poisson", lengths[:, 1]
    return numbers.merge(_depths(stress)).merge(_percentiles(stress))


def _decay(stress: xr.Dataset) -> tuple[float, float]:
    """Decay lengths along the depth and in the plane for one Poisson's ratio."""
    names = "plane_depth", "covariance_depth", "lag", "covariance_plane"
    return decay_lengths(*(stress[name].values for name in names), float(stress["reference_depth"]))


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
        high = size >= np.quantile(size, 1 - HIGHEST) if size.size else []
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
