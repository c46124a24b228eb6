"""Numbers of certified contacts that theories predict: areas, gap, stiffness, spectra, percolation, profiles.

Pressures are in units of E*ḡ, lengths in rms heights or λ_s. Names end in ``_half`` for numbers on half of
the nodes along both edges.
"""

from collections.abc import Callable, Mapping
from typing import Any

import closed_forms
import numpy as np
import xarray as xr
from scipy import ndimage

import asperity as asp
from asperity.contact import Contact
from asperity.contact.half_grid import on_half_the_nodes
from asperity.core.types import Array
from asperity.engineering.continuum import continuum_on_grids, solved_on_half
from asperity.fourier.grid import Fourier
from asperity.stress.statistics.extrapolation import BOUNDARY_SHARE

NODES = 8
"""Nodes on λ_s."""

SHARES = (0.5, 0.9, 0.99)
"""Percentiles of the von Mises stress in a plane."""


def surface_of(config: Mapping[str, Any], name: str, seed: int) -> tuple[Array, float]:
    """Heights of rms 1e-3, and their rms gradient."""
    band = {key: value for key, value in config["surfaces"][name].items() if key not in ("points", "loads")}
    points = config["surfaces"][name]["points"]
    height = asp.self_affine((points, points), rms_height=1e-3, seed=seed, **band)
    return height, asp.roughness_parameters(height).rms_gradient


def elastic(config: Mapping[str, Any], height: Array, gradient: float) -> xr.Dataset:
    """Area with its estimate and error, mean gap, stiffness and pressure spectrum under every load."""
    rows, rms_height = [], float(height.std())
    solid = asp.Solid(1.0, 0.0)
    for contact in asp.solve_load_path(height, solid, mean_pressures=[gradient * p for p in config["loads"]]):
        half = solved_on_half(contact)
        area = continuum_on_grids(contact, half, None, "lower")["contact_area_fraction"]
        wavenumber, power = asp.surface.spectrum(contact.pressure / gradient)
        row = {
            "area": area.sel(kind="estimate", drop=True),
            "area_error": area.sel(kind="error", drop=True),
            "area_grid": contact.contact_area_fraction,
            "pressure_spectrum": ("wavenumber", power),
            "certificate": contact.certificate.worst,
        }
        for ending, one in (("", contact), ("_half", half.contact)):
            row[f"gap{ending}"] = float(one.gap.mean()) / rms_height
            row[f"stiffness{ending}"] = one.stiffness * rms_height / one.mean_pressure
        rows.append(xr.Dataset(row, coords={"wavenumber": wavenumber}))
    found = xr.concat(rows, xr.Variable("load", config["loads"]))
    rings, power = rings_of(height)
    theory = [
        [closed_forms.mean_gap(load * gradient, rings, power, gamma) for gamma in (closed_forms.GAMMA, 1.0)]
        for load in config["loads"]
    ]
    gap = np.array(theory) / rms_height
    return found.assign(
        persson_gap=(("load", "gamma"), gap[..., 0]),
        persson_stiffness=(("load", "gamma"), 1 / gap[..., 1]),
        height_spectrum=("wavenumber", asp.surface.spectrum(height)[1] / rms_height**2),
    ).assign_coords(gamma=[closed_forms.GAMMA, 1.0])


def rings_of(field: Array) -> tuple[Array, Array]:
    """Wavenumbers of the waves of a field in a cell of edge 1, and the sum of the squares of each."""
    grid = asp.Grid(field.shape)
    squared = np.abs(Fourier(grid).forward(field)) ** 2 * grid.multiplicity[1]
    power = np.bincount(np.rint((grid.wavenumber() / (2 * np.pi)) ** 2).astype(int).ravel(), squared.ravel())
    power[0] = 0
    held = power > 1e-20 * power.max()
    return 2 * np.pi * np.sqrt(np.flatnonzero(held)), power[held]


def plastic(config: Mapping[str, Any], height: Array, gradient: float) -> xr.Dataset:
    """Elastic and plastic area under every load below each hardness, estimated from both grids.

    Nodes count with their whole pixels. Therefore a strip along its boundary is subtracted from the area of
    contact, as in `asperity.continuum_limit`, and a strip of the same width is added to the plastic area,
    whose nodes are those whose whole pixel would bear the hardness.
    """
    loads, hardnesses = config["plastic"]["loads"], config["plastic"]["hardness"]
    half = on_half_the_nodes(height, asp.Grid(height.shape))[0]
    areas = np.full((2, 2, len(hardnesses), len(loads)), np.nan)
    for number, hardness in enumerate(hardnesses):
        below = [gradient * load for load in loads if load < 0.9 * hardness]
        for grid, heights in enumerate((height, half)):
            path = asp.solve_load_path(
                heights, asp.Solid(1.0, 0.0), mean_pressures=below, hardness=hardness * gradient
            )
            for place, contact in enumerate(path):
                whole, yielded = (
                    mask.mean() + sign * BOUNDARY_SHARE * boundary(mask)
                    for mask, sign in ((contact.pressure > 0, -1), (contact.pressure >= contact.hardness, 1))
                )
                areas[grid, :, number, place] = whole - yielded, yielded
    names = ("elastic_area", "plastic_area")
    return xr.Dataset(
        {
            f"{n}{e}": (("hardness", "load"), areas[g, k])
            for g, e in enumerate(("", "_half"))
            for k, n in enumerate(names)
        },
        coords={"hardness": hardnesses, "load": loads},
    )


def boundary(mask: Array) -> float:
    """Edges between nodes inside and outside, over all nodes."""
    return sum(np.count_nonzero(mask != np.roll(mask, 1, axis)) for axis in (0, 1)) / mask.size


def percolates(contact: Contact, axis: int) -> bool:
    """True if a path through the gap leads from one edge of the cell to the opposite one along an axis."""
    label, _ = ndimage.label(contact.pressure == 0)
    first, last = (np.take(label, place, axis) for place in (0, -1))
    return bool(np.intersect1d(first[first > 0], last).size)


def percolation(config: Mapping[str, Any], height: Array, gradient: float) -> xr.Dataset:
    """Area, on the grid and estimated, at which the gap ceases to percolate along each axis, by bisection."""
    settings = config["percolation"]
    found = []
    for axis in (0, 1):
        low, high = settings["areas"]
        closed = None
        for _ in range(settings["steps"]):
            middle = (low + high) / 2
            contact = asp.solve_contact(height, asp.Solid(1.0, 0.0), contact_area_fraction=middle)
            if percolates(contact, axis):
                low = middle
            else:
                high, closed = middle, contact
        best = asp.continuum_limit(closed)["contact_area_fraction"] if closed else None
        found.append([high, np.nan if best is None else float(best.sel(kind="estimate"))])
    critical = np.array(found)
    return xr.Dataset({"critical_grid": ("axis", critical[:, 0]), "critical_area": ("axis", critical[:, 1])})


def profile(config: Mapping[str, Any], height: Array, gradient: float) -> xr.Dataset:
    """Rms and percentiles of the von Mises stress over E*ḡ in planes, computed and in closed form.

    ``gaussian`` and ``sparse`` take the spectrum of the computed pressure, the latter the area of contact,
    too; ``spectrum`` takes the spectrum of the heights alone.
    """
    settings, poisson = config["profile"], config["poisson"]
    depths = np.array(settings["depths"]) * NODES / height.shape[0]
    solid = asp.Solid(1.0, poisson)
    unit, rows = solid.effective_modulus * gradient, []
    rings, power = rings_of(height)
    for load in settings["loads"]:
        contact = asp.solve_contact(height, solid, mean_pressure=load * unit)
        planes = asp.stress_planes(contact, depths, tolerance=0)
        fields = [plane.fields["von_mises"][0].ravel() / unit for plane in planes]
        row = {"computed": np.array([[np.sqrt(np.mean(f**2)), *np.quantile(f, SHARES)] for f in fields])}
        waves, pressure = rings_of(contact.pressure / unit)
        ours = closed_forms.stress_covariance(waves, pressure, poisson, depths)
        theirs = closed_forms.pressure_power(load * gradient, rings, power) / gradient**2
        theory = closed_forms.stress_covariance(rings, theirs, poisson, depths)
        row["gaussian"] = closed_forms.von_mises_profile(ours, load, poisson, SHARES)
        row["sparse"] = closed_forms.von_mises_profile(
            ours, load, poisson, SHARES, contact.contact_area_fraction
        )
        area = float(closed_forms.elastic_area(load))
        row["spectrum"] = closed_forms.von_mises_profile(theory, load, poisson, SHARES, area)
        found = {name: (("depth", "number"), values) for name, values in row.items()}
        rows.append(xr.Dataset(found | {"area": contact.contact_area_fraction}))
    names = ["rms", *(f"p{100 * share:g}" for share in SHARES)]
    coordinates = {"load": settings["loads"], "depth": settings["depths"], "number": names}
    return xr.concat(rows, "load").assign_coords(coordinates)


PARTS: dict[str, Callable[[Mapping[str, Any], Array, float], xr.Dataset]] = {
    "elastic": elastic,
    "plastic": plastic,
    "percolation": percolation,
    "profile": profile,
}
"""Part of the study → its function."""


def part_of(config: Mapping[str, Any], part: str, surface: str) -> xr.Dataset:
    """Dataset of a part and a surface along `seed`."""
    config = {**config, "loads": config["surfaces"][surface].get("loads", config["loads"])}
    seeds = [PARTS[part](config, *surface_of(config, surface, seed)) for seed in config["seeds"]]
    return xr.concat(seeds, xr.Variable("seed", config["seeds"]))
