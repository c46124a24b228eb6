"""Errors against the number of grid points and against the number of finite elements."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from asperity.contact import solve
from asperity.elasticity.layer import Layer
from asperity.reference.westergaard import Westergaard
from asperity.spectral import Grid
from asperity.types import Array, Progress
from asperity.validation.finite_elements import APPROACH, compare_elements, largest_differences
from asperity.validation.indenter import CURVATURE_RADIUS, slab_contact

WAVE_AMPLITUDE = 1e-5
"""Amplitude of the wave of `grid_convergence`, in wavelengths."""


def grid_convergence(
    points: Sequence[int] = (32, 64, 128, 256),
    loads: Sequence[float] = (0.15, 0.27, 0.4, 0.52, 0.66),
    indentations: Sequence[float] = (0.012, 0.015, 0.018, 0.021, 0.024),
    poisson: float = 0.33,
    rtol: float = 1e-8,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Error of the contact solution against the number of grid points (figure 2d).

    A wave on a half-space is compared with Westergaard's closed form, a paraboloid on the bonded cubic slab
    with a grid twice as fine as the finest. Errors are root mean squares over several loads, since the edge
    of contact can be anywhere between two nodes.

    Parameters
    ----------
    points : sequence of int
        Nodes on an edge of the grids, rising.
    loads : sequence of float
        Mean pressures of the wave over that of complete contact.
    indentations : sequence of float
        Approaches of the paraboloid, in units of (cell edge)² / R.
    poisson : float
    rtol : float
    progress : callable, optional
        Called as progress(done, total) with the number of nodes solved so far.

    Returns
    -------
    Dataset
        Relative errors of pressure, approach and contact area of the wave and of the load of the slab
        (grid_points).
    """
    grids = [*points, 2 * points[-1]]
    work = np.cumsum(np.square(grids, dtype=float))
    wave: list[list[Array]] = []
    load: list[list[float]] = []
    for row, n in enumerate(grids):
        if row < len(points):
            wave.append([_wave_errors(n, part, poisson, rtol) for part in loads])
        load.append(
            [slab_contact(n, depth / CURVATURE_RADIUS, poisson, rtol).mean_pressure for depth in indentations]
        )
        if progress:
            progress(work[row], work[-1])
    pressure, approach, area = np.sqrt(np.mean(np.square(wave), axis=1)).T
    slab_load = np.array(load)
    return xr.Dataset(
        {
            "wave_pressure_error": ("grid_points", pressure),
            "wave_approach_error": ("grid_points", approach),
            "wave_area_error": ("grid_points", area),
            "slab_load_error": (
                "grid_points",
                np.sqrt(np.mean((slab_load[:-1] / slab_load[-1] - 1) ** 2, axis=1)),
            ),
        },
        coords={"grid_points": np.asarray(points)},
        attrs={"rtol": rtol, "poisson": poisson, "curvature_radius": CURVATURE_RADIUS},
    )


def _wave_errors(points: int, load: float, poisson: float, rtol: float) -> Array:
    """Relative errors of pressure (L2), approach and contact area of the wave, (3,)."""
    mean_pressure = load * (np.pi * WAVE_AMPLITUDE)
    exact = Westergaard(mean_pressure, WAVE_AMPLITUDE)
    line = Grid((8, points), (8 / points, 1.0))
    x = line.coordinates()[1] - 0.5
    height = np.tile(exact.height(x), (8, 1))
    layer = Layer(1 - poisson**2, poisson)
    contact = solve(height, layer, line.length, mean_pressure=mean_pressure, rtol=rtol)
    pressure = exact.pressure(x)
    return np.array(
        [
            np.linalg.norm(contact.pressure[0] - pressure) / np.linalg.norm(pressure),
            contact.approach / exact.approach - 1,
            contact.area_fraction / exact.area_fraction - 1,
        ]
    )


def mesh_convergence(
    meshes: Sequence[tuple[int, int]] = ((8, 7), (12, 10), (16, 13), (24, 20)),
    points: int = 512,
    approach: float = APPROACH,
    poisson: float = 0.33,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Differences between finite elements of several meshes and one fine spectral grid.

    Parameters
    ----------
    meshes : sequence of (int, int)
        Hexahedra along half an edge of the cell and along its height, coarse to fine.
    points : int
        Nodes on an edge of the spectral grid.
    approach, poisson : float
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    Dataset
        Result of `largest_differences` for every mesh, along ``mesh``.
    """
    contact = slab_contact(points, approach, poisson)
    differences = []
    for done, elements in enumerate(meshes, start=1):
        compared = compare_elements(elements, approach=approach, poisson=poisson, contact=contact)
        differences.append(largest_differences(compared))
        if progress:
            progress(done, len(meshes))
    dataset = xr.concat(differences, "mesh")
    return dataset.assign_coords(mesh_elements=("mesh", [across for across, _ in meshes])).assign_attrs(
        grid_points=points, poisson=poisson, approach=approach, curvature_radius=CURVATURE_RADIUS
    )


def convergence_order(points: xr.DataArray, error: xr.DataArray) -> float:
    """Order n of an error ~ points⁻ⁿ, fitted over all grids."""
    return float(-np.polyfit(np.log(points.values), np.log(error.values), 1)[0])
