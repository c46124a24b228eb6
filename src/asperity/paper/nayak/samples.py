"""Contact of many seeds of one surface on one grid, reduced to area, boundary, load and gradients.

The loads are given as mean pressures over E* ḡ, with ḡ the rms gradient of the sample. They are the same on
every grid, so that the area alone shows the error of the grid.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from asperity.contact import Contact, solve_path
from asperity.elasticity.layer import Layer
from asperity.pipeline.blocks import grid_points
from asperity.pipeline.surface import random_heights
from asperity.spectral import Fourier, Grid, gradient, mean_square
from asperity.types import Array, Progress

HALF_SPACE = Layer(young=1.0, poisson=0.0)
"""A solid with E* = 1; area over load does not depend on Poisson's ratio."""


def nayak_parameter(height: Array, grid: Grid) -> float:
    """Nayak's parameter α = m₀ m₄ / m₂² of an isotropic surface, 3/2 or more.

    The moments are those of a profile: ⟨h²⟩ = m₀, ⟨|∇h|²⟩ = 2 m₂ and ⟨(∇²h)²⟩ = 8 m₄ / 3 (P. R. Nayak, J.
    Lubr. Technol. 93 (1971) 398, doi 10.1115/1.3451608).
    """
    coefficients = Fourier(grid).forward(height - height.mean())
    squared = grid.wavenumber() ** 2
    heights, slopes, curvatures = (mean_square(coefficients, grid, squared**n) for n in (0, 1, 2))
    return 1.5 * heights * curvatures / slopes**2


def boundary_integral(touching: Array, values: Array, grid: Grid) -> float:
    """Integral of a field along the boundary of contact, which follows the edges of the grid's squares.

    The value on an edge is the mean of those of the two nodes beside it.
    """
    total = 0.0
    for axis, along in ((0, grid.spacing[1]), (1, grid.spacing[0])):
        edge = touching != np.roll(touching, 1, axis)
        total += along * float((values + np.roll(values, 1, axis))[edge].sum()) / 2
    return total


def sample(
    parameters: Mapping[str, Any],
    nodes: float,
    seeds: Sequence[int],
    loads: Sequence[float],
    progress: Progress | None = None,
) -> xr.Dataset:
    """Contact of some seeds of a surface on one grid.

    Parameters
    ----------
    parameters : mapping
        Entry of section ``surfaces`` of the configuration; its ``points`` are not used.
    nodes : float
        Nodes on the shortest wavelength.
    seeds : sequence of int
    loads : rising sequence of float
        Mean pressures over E* ḡ.
    progress : callable, optional

    Returns
    -------
    dataset
        Along `seed`, Nayak's parameter, rms gradient and processor time; along `seed` and `load`, mean
        pressure, area fraction and length of the boundary of contact, the rms gradient of the deformed
        surface over the contact, and the integrals of the squared gradient of the rough surface over the
        contact and along its boundary.

    Raises
    ------
    ConvergenceError
        If the contact under a load does not converge.
    """
    points = grid_points(parameters["wavelength_short"], nodes)
    grid = Grid((points, points))
    found = []
    for number, seed in enumerate(seeds):
        begin = time.process_time()
        height = random_heights(parameters, grid, seed)[1]
        slope_y, slope_x = gradient(Fourier(grid).forward(height), Fourier(grid))
        squared = slope_y**2 + slope_x**2
        rms_gradient = float(np.sqrt(squared.mean()))
        path = solve_path(height, HALF_SPACE, mean_pressures=[load * rms_gradient for load in loads])
        states = [_numbers(state, squared, grid) for state in path]
        numbers: dict[str, Any] = {name: ("load", [state[name] for state in states]) for name in states[0]}
        numbers |= {"seed_nayak": nayak_parameter(height, grid), "seed_rms_gradient": rms_gradient}
        found.append(xr.Dataset({**numbers, "seed_seconds": time.process_time() - begin}))
        if progress is not None:
            progress(number + 1, len(seeds))
    return xr.concat(found, "seed").assign_coords(seed=list(seeds), load=np.arange(len(loads)) + 1)


def _numbers(contact: Contact, squared: Array, grid: Grid) -> dict[str, float]:
    """Numbers of one contact, from the squared gradient of the rough surface."""
    touching = contact.pressure > 0
    return {
        "seed_mean_pressure": contact.mean_pressure,
        "seed_area_fraction": contact.area_fraction,
        "seed_boundary_length": boundary_integral(touching, np.ones_like(squared), grid),
        "seed_gradient_rms_contact": contact.gradient_rms_contact,
        "seed_squared_gradient_contact": float(squared[touching].sum()) / squared.size,
        "seed_squared_gradient_boundary": boundary_integral(touching, squared, grid),
    }
