"""Estimates at vanishing grid spacing, from a second solution on half as many nodes."""

from __future__ import annotations

import numpy as np
import xarray as xr

from asperity.contact import Contact, solve
from asperity.core.types import Array, Progress
from asperity.fourier.grid import Fourier, Grid, mean_square, resample
from asperity.stress.analysis import analyse_stress
from asperity.stress.statistics.continuum import OnGrid, extrapolate, joined, numbers_on

TOLERANCE = 1e-4
"""Of the second solution and of the planes of its stress: far below the error of the grid."""

LEAST_NODES = 200
"""Contact nodes below which there is no estimate."""

LOST_GRADIENT = 0.02
"""Share of the squared gradient in waves shorter than four nodes above which there is no estimate."""


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
    TypeError, ValueError
        If `contact` is no `Contact`, or `stress` no result of `analyse_stress`.

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
    if stress is not None and "peak_quantity" not in stress:
        raise ValueError("stress: a result of analyse_stress is needed, it has no peaks")
    fine = _on_grid(contact, stress)
    reason = reason_against(contact)
    if reason:
        found = numbers_on(fine)
        unknown = found * np.nan
        return joined(found, unknown, unknown).assign_attrs(reason=reason)
    height, grid = on_half_the_nodes(contact.height, contact.grid)
    half = solve(height, contact.solid, grid.length, mean_pressure=contact.mean_pressure, rtol=TOLERANCE)
    if progress is not None:
        progress(0.2, 1.0)
    coarse = None
    if stress is not None:
        coarse = analyse_stress(
            half,
            poisson=stress["poisson"].values.tolist(),
            quantities=[str(name) for name in stress["quantity"].values],
            tolerance=TOLERANCE,
            friction=stress.attrs["friction"],
            sliding_direction=stress.attrs["sliding_direction"],
        )
    if progress is not None:
        progress(1.0, 1.0)
    return extrapolate(fine, _on_grid(half, coarse))


def reason_against(contact: Contact) -> str:
    """Why a contact allows no estimate; empty if it does."""
    nodes = np.count_nonzero(contact.pressure)
    if contact.boundary != "periodic":
        return "the boundary is free, and the estimate is made for periodic cells"
    if nodes < LEAST_NODES:
        return f"{nodes} nodes are in contact, and {LEAST_NODES} are needed"
    grid = contact.grid
    modes = Fourier(grid).forward(contact.height)
    half = half_of(grid)
    squares = [
        mean_square(some, own, own.wavenumber() ** 2)
        for some, own in ((modes, grid), (resample(modes, grid, half), half))
    ]
    if squares[0] == 0:
        return "the heights are flat, and the contact has no size of its own"
    lost = 1 - squares[1] / squares[0]
    if lost > LOST_GRADIENT:
        return (
            f"waves shorter than four nodes have {100 * lost:.0f} % of the squared gradient, at most "
            f"{100 * LOST_GRADIENT:g} % is accepted: the surface goes on below its nodes, or has steps"
        )
    return ""


def half_of(grid: Grid) -> Grid:
    """The grid with half as many nodes along both edges."""
    return Grid((max(grid.shape[0] // 2, 4), max(grid.shape[1] // 2, 4)), grid.length)


def on_half_the_nodes(height: Array, grid: Grid) -> tuple[Array, Grid]:
    """The long waves of periodic heights on half as many nodes along both edges, and their grid."""
    half = half_of(grid)
    return Fourier(half).inverse(resample(Fourier(grid).forward(height), grid, half)), half


def _on_grid(contact: Contact, stress: xr.Dataset | None) -> OnGrid:
    """Results of a contact and of the analysis of its stress."""
    load = contact.mean_pressure / contact.layer.effective_modulus
    return OnGrid(contact.pressure, load, contact.gradient_rms_contact, contact.grid, stress)
