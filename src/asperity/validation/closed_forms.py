"""Comparisons with closed forms: Hertz on a half-space, alone and in a periodic array, and Huber's stress."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from asperity.contact import solve
from asperity.elasticity.layer import Layer
from asperity.reference.equivalent_stress import von_mises
from asperity.reference.hertz import Hertz
from asperity.reference.periodic_hertz import PeriodicHertz
from asperity.spectral import Grid
from asperity.types import Array, Progress
from asperity.validation.indenter import (
    CURVATURE_RADIUS,
    INDENTATION,
    bonded_slab,
    fitted_contact_radius,
    largest_sample,
    paraboloid,
)
from asperity.validation.pointwise import displacement_and_stress


def load_area(
    points: int = 128,
    poisson: Sequence[float] = (0.0, 0.33, 0.5),
    contact_radii: Sequence[float] = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3),
    method: str = "gfmd",
    rtol: float = 1e-6,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Contact area under the loads of the periodic Hertz contact, for several Poisson's ratios (figure 2a).

    Young's modulus is the same for all ratios and the unit of the pressures. The closed form assumes Hertz's
    pressure distribution, which is good for radii up to 0.3 cell edges.

    Parameters
    ----------
    points : int
        Nodes on an edge of the grid.
    poisson : sequence of float
    contact_radii : sequence of float
        Radii of the closed form, whose loads are imposed.
    method : str
        Solver.
    rtol : float
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    Dataset
        Contact radius and area fraction of the closed form (path) and of the solver (poisson, path), and the
        load-area curve of the closed form (poisson, curve).
    """
    grid = Grid((points, points))
    height = paraboloid(grid, CURVATURE_RADIUS)
    radii = np.asarray(contact_radii)
    curve = np.linspace(0.0, max(contact_radii) + 0.02, 61)[1:]
    layers = [Layer(1.0, nu) for nu in poisson]
    imposed = np.array([_periodic_pressures(radii, layer.effective_modulus) for layer in layers])
    area, radius = np.empty_like(imposed), np.empty_like(imposed)
    for done, at in enumerate(np.ndindex(imposed.shape), start=1):
        load = float(imposed[at])
        contact = solve(height, layers[at[0]], mean_pressure=load, method=method, rtol=rtol)
        area[at] = contact.area_fraction
        radius[at] = fitted_contact_radius(contact.pressure, grid)
        if progress:
            progress(done, imposed.size)
    return xr.Dataset(
        {
            "hertz_contact_radius": ("path", radii),
            "hertz_area_fraction": ("path", np.pi * radii**2),
            "imposed_mean_pressure_young": (("poisson", "path"), imposed),
            "solved_area_fraction": (("poisson", "path"), area),
            "solved_contact_radius": (("poisson", "path"), radius),
            "curve_area_fraction": ("curve", np.pi * curve**2),
            "curve_mean_pressure_young": (
                ("poisson", "curve"),
                np.array([_periodic_pressures(curve, layer.effective_modulus) for layer in layers]),
            ),
        },
        coords={"poisson": np.asarray(poisson, float)},
        attrs={"grid_points": points, "method": method, "rtol": rtol, "curvature_radius": CURVATURE_RADIUS},
    )


def slab_load_area(
    points: int = 128,
    heights: Sequence[float] = (0.1, 0.25, 0.5, 1.0),
    poisson: float = 0.33,
    steps: int = 6,
    method: str = "gfmd",
    rtol: float = 1e-6,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Load and contact area of bonded slabs of several heights, against the half-space (figure 2b, c).

    Each slab is indented to the paper's depth. That depth, 0.02 (slab height × cell edge) / R, is reached in
    steps that are even in the contact radius; the first is at half of the last radius. The stiffening is the
    load divided by that of a single Hertz contact with a half-space at the same approach: at the same
    contact area the loads of slab and half-space nearly agree.

    Parameters
    ----------
    points : int
        Nodes on an edge of the grid.
    heights : sequence of float
        Slab heights in cell edges.
    poisson : float
    steps : int
    method : str
        Solver.
    rtol : float
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    Dataset
        Approach, area fraction, contact radius, mean pressure and stiffening (slab, step), and the load-area
        curve of the periodic Hertz contact on a half-space (curve).
    """
    grid = Grid((points, points))
    height = paraboloid(grid, CURVATURE_RADIUS)
    part = np.linspace(0.5, 1.0, steps) ** 2
    approach = np.array([INDENTATION * slab_height / CURVATURE_RADIUS * part for slab_height in heights])
    area, radius, pressure, hertz_load = (np.empty_like(approach) for _ in range(4))
    for done, at in enumerate(np.ndindex(approach.shape), start=1):
        layer, depth = bonded_slab(poisson, heights[at[0]]), float(approach[at])
        contact = solve(height, layer, approach=depth, method=method, rtol=rtol)
        area[at], pressure[at] = contact.area_fraction, contact.mean_pressure
        radius[at] = fitted_contact_radius(contact.pressure, grid)
        hertz_load[at] = Hertz.from_approach(depth, CURVATURE_RADIUS).load
        if progress:
            progress(done, approach.size)
    curve = np.geomspace(0.9 * radius.min(), 1.1 * radius.max(), 61)
    return xr.Dataset(
        {
            "slab_approach": (("slab", "step"), approach),
            "slab_area_fraction": (("slab", "step"), area),
            "slab_contact_radius": (("slab", "step"), radius),
            "slab_mean_pressure": (("slab", "step"), pressure),
            "slab_stiffening": (("slab", "step"), pressure / hertz_load),
            "curve_area_fraction": ("curve", np.pi * curve**2),
            "curve_mean_pressure": ("curve", _periodic_pressures(curve)),
        },
        coords={"slab_height": ("slab", np.asarray(heights, float))},
        attrs={
            "grid_points": points,
            "method": method,
            "rtol": rtol,
            "poisson": poisson,
            "curvature_radius": CURVATURE_RADIUS,
        },
    )


def punch(
    points: int = 512,
    contact_radius: float = 0.1,
    poisson: Sequence[float] = (0.0, 0.5),
    reach: float = 2.0,
    samples: int = 81,
    rtol: float = 1e-8,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Von Mises stress under the paraboloid on a half-space, against Huber's closed form (figure 12).

    The closed form is a single contact, the spectral solution a periodic one whose uniform lateral stress is
    a choice: laterally confined, ``σ_xx = σ_yy = −ν/(1 − ν) p̄``, or free, zero. A sum of single contacts
    has ``−(½ + ν) p̄``, the mean over all directions of the kernels' limit q → 0. With this value ("array")
    the largest stress differs from that of one contact only by the effect of the neighbours on the pressure,
    and the two choices differ from it by known amounts.

    Parameters
    ----------
    points : int
        Nodes on an edge of the grid.
    contact_radius : float
        Radius of the closed form, whose load in the periodic array is imposed.
    poisson : sequence of float
    reach : float
        Extent of the drawn plane to each side and in depth, in contact radii.
    samples : int
        Depths of the drawn plane.
    rtol : float
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    Dataset
        Von Mises stress of both on a vertical plane through the axis (poisson, depth, x); its largest value
        on the axis and the depth of that, for the uniform modes "confined", "free" and "array" and for the
        closed form (poisson).
    """
    grid = Grid((points, points))
    array = PeriodicHertz(contact_radius, CURVATURE_RADIUS)
    single = Hertz.from_load(array.load, CURVATURE_RADIUS)
    height = paraboloid(grid, CURVATURE_RADIUS)
    contact = solve(height, Layer(1.0, 0.0), mean_pressure=array.mean_pressure, rtol=rtol)
    width = int(reach * contact_radius * points)
    x = np.arange(-width, width + 1) / points
    depth = np.linspace(0.0, reach * contact_radius, samples)
    axis_depth = np.linspace(0.2, 0.8, 61) * contact_radius
    solved, exact = np.empty((2, len(poisson), len(depth), len(x)))
    peaks: dict[str, list[tuple[float, float]]] = {
        name: [] for name in ("confined", "free", "array", "closed_form")
    }
    for row, nu in enumerate(poisson):
        layer = Layer(1 - nu**2, nu, lateral="free")
        _, stress = displacement_and_stress(contact.pressure, grid, layer, 0.5, 0.5, axis_depth)
        for name, lateral in (("free", 0.0), ("confined", nu / (1 - nu)), ("array", 0.5 + nu)):
            uniform = -lateral * array.mean_pressure * np.array([1, 1, 0, 0, 0, 0])
            peaks[name].append(largest_sample(von_mises(stress[:, 0] + uniform), axis_depth))
        peaks["closed_form"].append(largest_sample(single.stress(0.0, axis_depth, nu).von_mises, axis_depth))
        layer = Layer(1 - nu**2, nu)
        middle = np.full(len(x), 0.5)
        _, stress = displacement_and_stress(contact.pressure, grid, layer, middle, x + 0.5, depth)
        solved[row] = von_mises(stress)
        exact[row] = single.stress(np.abs(x), depth[:, None], nu).von_mises
        if progress:
            progress(row + 1, len(poisson))
    variables: dict[str, object] = {
        "von_mises_spectral": (("poisson", "depth", "x"), solved),
        "von_mises_closed_form": (("poisson", "depth", "x"), exact),
        "contact_radius": single.contact_radius,
        "largest_pressure": single.largest_pressure,
        "largest_pressure_spectral": float(contact.pressure.max()),
        "gradient_rms_contact": single.contact_radius / (np.sqrt(2) * CURVATURE_RADIUS),
    }
    for name, found in peaks.items():
        values, depths = np.transpose(found)
        variables[f"peak_von_mises_{name}"] = "poisson", values
        variables[f"peak_depth_{name}"] = "poisson", depths
    return xr.Dataset(
        variables,
        coords={"poisson": np.asarray(poisson, float), "depth": depth, "x": x},
        attrs={"grid_points": points, "rtol": rtol, "curvature_radius": CURVATURE_RADIUS},
    )


def _periodic_pressures(radii: Array, effective_modulus: float = 1.0) -> Array:
    """Mean pressure of the periodic Hertz contact at each contact radius."""
    contacts = (PeriodicHertz(radius, CURVATURE_RADIUS, 1.0, effective_modulus) for radius in radii)
    return np.array([contact.mean_pressure for contact in contacts])
