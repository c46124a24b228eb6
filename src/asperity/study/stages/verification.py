"""Verification of the study's results: the laws that they must obey, computed anew from the fields.

`verify_seed` checks the results of one surface and one seed, `verify_statistics` those made from all seeds,
and `Verification` both, in stage statistics.
Residuals that a solver or a stage stored beside its numbers are not used. A check is a law by its name, the
amount by which a result breaks it, and the bound that this amount must not exceed; NaN exceeds every bound.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from asperity.contact import verify_contact
from asperity.core.types import Array
from asperity.elasticity.layer import Layer
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.fourier.grid import Fourier, Grid, gradient, mean_square, resample
from asperity.results.dataset import grid_of, settings_of
from asperity.stress.peaks.selection import peaks
from asperity.stress.planes.planes import stress_planes
from asperity.study.stages.solid import solid
from asperity.study.stages.statistics import SeedResults

ROUNDING = 1e-10
"""Bound for laws that hold exactly except for rounding."""

WORST_NODE = 100
"""Factor by which a single node may exceed the solver's tolerance, which is a norm over all nodes."""

REFINEMENT = 0.25
"""Part by which a peak refined between nodes may exceed the largest node, with eight nodes per wavelength."""

DEPTH_STEP = 1e-3
"""Step of the derivative along depth, over the shortest wavelength or the height of a thinner layer."""

EQUILIBRIUM = 1e-4
"""Bound for the divergence of the stress: the error of the central difference along depth."""


DECAY = 28.0
"""Modes with q · depth above this have decayed below rounding, e⁻²⁸ = 7 · 10⁻¹³."""

Checks = dict[str, tuple[float, float]]
"""Name of a law → amount by which a result breaks it, and the amount that is allowed."""


class VerificationError(RuntimeError):
    """Results that break a law; the message names the laws and the amounts."""


def require(checks: Checks, where: str) -> None:
    """Raise `VerificationError` if a check does not hold."""
    broken = [
        f"{name} {value:.3g} > {bound:.3g}" for name, (value, bound) in checks.items() if not value <= bound
    ]
    if broken:
        raise VerificationError(f"{where}: {'; '.join(broken)}")


class Verification:
    """Checks of all results of one surface, made while its statistics read them.

    Parameters
    ----------
    surface_name : str
    """

    def __init__(self, surface_name: str) -> None:
        self._surface = surface_name
        self._stresses: list[xr.Dataset] = []
        self._checks: dict[str, Checks] = {}

    def checked(self, results: Iterable[SeedResults]) -> Iterator[SeedResults]:
        """The same results, one seed after the other; raises `VerificationError` if a check does not hold."""
        for seed, *stages in results:
            self._add(f"seed {seed}", verify_seed(*stages))
            self._stresses.append(stages[-1])
            yield SeedResults(seed, *stages)

    def table(self, statistics: xr.Dataset) -> pd.DataFrame:
        """The table ``verification`` of `asperity.results.tables.TABLES`, with the checks of the statistics.

        Raises
        ------
        VerificationError
            If a check of the statistics does not hold.
        """
        self._add("all seeds", verify_statistics(statistics, self._stresses))
        return pd.DataFrame(
            {"surface": self._surface, "of": part, "check": name, "value": value, "bound": bound}
            for part, checks in self._checks.items()
            for name, (value, bound) in checks.items()
        )

    def _add(self, part: str, checks: Checks) -> None:
        require(checks, f"{self._surface}, {part}")
        self._checks[part] = checks


def verify_seed(surface: xr.Dataset, contact: xr.Dataset, stress: xr.Dataset) -> Checks:
    """Checks of the results of the stages surface, contact and stress for one surface and one seed."""
    layer, _ = solid(settings_of(contact)["layer"])
    return {
        **_of_contact(surface, contact, layer),
        **_of_path(contact),
        **_of_fields(contact, stress, layer),
        **_of_peaks(stress, grid_of(contact)),
    }


def _of_contact(surface: xr.Dataset, contact: xr.Dataset, layer: Layer) -> Checks:
    """Check the conditions of contact, the load balance and Parseval's theorem."""
    tolerance = WORST_NODE * settings_of(contact)["contact"]["tolerance"]
    grid = grid_of(contact)
    pressure = contact["pressure"].values.astype(float)
    found = verify_contact(
        surface["height"].values,
        pressure,
        layer,
        grid.length,
        approach=float(contact["approach"]),
        mean_pressure=float(contact["mean_pressure"]),
    )
    square = mean_square(Fourier(grid).forward(pressure), grid)
    touching = float(np.mean(pressure > 0))
    return {
        "penetration over its length scale": (found.penetration, tolerance),
        "gap under contact over its length scale": (found.contact_gap, tolerance),
        "tension over the largest pressure": (found.tension, tolerance),
        "complementarity": (found.complementarity, tolerance),
        "load balance": (found.load_imbalance, ROUNDING),
        "area fraction against the nodes in contact": (abs(touching - float(contact["area_fraction"])), 0),
        "Parseval's theorem, pressure": (_relative(square, float(np.mean(pressure**2))), ROUNDING),
    }


def _of_path(contact: xr.Dataset) -> Checks:
    """Check that area and load rise along the load path."""
    names = {"area": "path_area_fraction", "load": "path_mean_pressure"}
    return {
        f"falls of the {name} along the load path": (float(np.sum(np.diff(contact[variable]) <= 0)), 0)
        for name, variable in names.items()
    }


def _of_fields(contact: xr.Dataset, stress: xr.Dataset, layer: Layer) -> Checks:
    """Check equilibrium in one plane, and that plane of the analysis at the same nodes without truncation."""
    nu = float(contact.attrs["poisson_contact"])
    tolerance = settings_of(stress)["stress"]["tolerance"]
    short = settings_of(contact)["surface"]["wavelength_short"]
    depths = stress["plane_depth"].values
    scale = min(short, depths[-1])  # a layer may be thinner than the shortest wavelength
    number = int(np.argmin(np.abs(depths - min(3 * short, depths[-1] / 2))))
    step = DEPTH_STEP * scale
    triple = depths[number] + step * np.array([-1.0, 0.0, 1.0])
    solid_below = LoadedSolid(contact["pressure"].values.astype(float), grid_of(contact), layer)
    (plane,) = stress_planes(solid_below, depths[[number]], [nu], ("zz",), tolerance)
    loaded, every = _without_decayed(solid_below, plane.grid, triple[0])
    names = ("xx", "zz", "xz", "yz", "xy", "von_mises")
    above, middle, below = stress_planes(loaded, triple, [nu], names, tolerance=0)
    mean = float(stress["mean_von_mises"].sel(poisson=nu).isel(plane=number))
    largest = float(stress["largest_von_mises"].sel(poisson=nu).isel(plane=number))
    von_mises, zz = middle.fields["von_mises"][0, ::every, ::every], middle.fields["zz"][0]
    scale_of_stress, bound = float(np.sqrt(np.mean(zz**2))), max(tolerance, ROUNDING)
    load = float(np.mean(zz)) + float(contact["mean_pressure"])
    planes = above.fields, middle.fields, below.fields
    imbalance = {axis: _imbalance(axis, *planes, step, loaded.grid) for axis in ("x", "z")}
    of_mean, of_largest = (
        abs(found - expected) / scale_of_stress
        for found, expected in ((mean, von_mises.mean()), (largest, von_mises.max()))
    )
    return {
        "load carried by a plane against that of the contact": (abs(load), ROUNDING),
        **{f"equilibrium along {axis}": (value, EQUILIBRIUM) for axis, value in imbalance.items()},
        "mean von Mises stress of a plane, computed again": (of_mean, bound),
        "largest von Mises stress of a plane, computed again": (of_largest, bound),
    }


def _without_decayed(loaded: LoadedSolid, plane: Grid, depth: float) -> tuple[LoadedSolid, int]:
    """The solid under its pressure without the modes that have decayed at a depth.

    Returns
    -------
    loaded : LoadedSolid
        On a grid that holds the nodes of the grid `plane` and all other modes.
    every : int
        Its nodes on each of the grid `plane`, along both axes.
    """
    needed = [DECAY * edge / (np.pi * depth) for edge in plane.length]
    both = zip(needed, loaded.grid.shape, plane.shape, strict=True)
    every = max(math.ceil(min(nodes, full) / own) for nodes, full, own in both)
    grid = Grid((every * plane.shape[0], every * plane.shape[1]), plane.length)
    spectrum = resample(Fourier(loaded.grid).forward(loaded.pressure), loaded.grid, grid)
    return LoadedSolid(Fourier(grid).inverse(spectrum, overwrite=True), grid, loaded.layer), every


def _imbalance(
    axis: str,
    above: Mapping[str, Array],
    middle: Mapping[str, Array],
    below: Mapping[str, Array],
    step: float,
    grid: Grid,
) -> float:
    """Root mean square of the divergence of the stress over that of its part along depth.

    z points upward, opposite to depth; the derivative along z is a central difference.
    """
    along_x, along_y, along_z = {"x": ("xx", "xy", "xz"), "z": ("xz", "yz", "zz")}[axis]
    fourier = Fourier(grid)
    _, slope_x = gradient(fourier.forward(middle[along_x][0]), fourier)
    slope_y, _ = gradient(fourier.forward(middle[along_y][0]), fourier)
    slope_z = (above[along_z][0] - below[along_z][0]) / (2 * step)
    divergence = _without_nyquist(slope_x + slope_y + slope_z, fourier)
    return float(np.std(divergence) / np.std(slope_z))


def _without_nyquist(field: Array, fourier: Fourier) -> Array:
    """A field without its modes at the Nyquist wavenumbers, which have no derivative on the grid."""
    modes = fourier.forward(field)
    rows, columns = field.shape
    if rows % 2 == 0:
        modes[rows // 2] = 0
    if columns % 2 == 0:
        modes[:, columns // 2] = 0
    return fourier.inverse(modes, overwrite=True)


def _of_peaks(stress: xr.Dataset, grid: Grid) -> Checks:
    """Check that peaks are finite, lie in the solid, and exceed the largest node only by their refinement."""
    outside = 0
    reach = {"depth": float(stress["plane_depth"].max()), "y": grid.length[0], "x": grid.length[1]}
    for name, limit in reach.items():
        place = stress[f"peak_{name}"].values
        outside += int(np.sum((place < 0) | (place > limit)))
    excess = 0.0
    for nu in stress["poisson"].values:
        found = peaks(stress, "von_mises", nu)
        largest = float(stress["largest_von_mises"].sel(poisson=nu).max())
        excess = max(excess, float(found["peak_value"].max()) / largest - 1)
    infinite = float(np.sum(~np.isfinite(stress["peak_value"].values)))
    return {
        "peaks outside the solid": (outside, 0),
        "largest von Mises peak over the largest node": (excess, REFINEMENT),
        "peaks that are not finite": (infinite, 0),
    }


def verify_statistics(statistics: xr.Dataset, stresses: Sequence[xr.Dataset]) -> Checks:
    """Checks of the statistics of one surface against the analyses of its seeds."""
    width = np.diff(statistics["bin_edge"].values, axis=1)[None, :, None, :]
    counted = statistics["peak_counts"].values.sum(axis=-1) > 0
    integral = np.sum(statistics["peak_density"].values * width, axis=-1)
    integral = np.where(counted.any(axis=0), integral, 1.0)
    heights = np.sum(statistics["height_density"].values * np.diff(statistics["height_edge"].values))
    ratio = float(statistics["poisson"][0])
    found = statistics["peak_counts"].sel(selection="all", poisson=ratio).sum("bin").values
    names = map(str, statistics["quantity"].values)
    expected = [[peaks(stress, name, ratio).sizes["peak"] for stress in stresses] for name in names]
    lost = float(np.abs(found - np.transpose(expected)).sum())
    joint = statistics["joint_counts"].sum(("bin", "depth_bin")).values
    unlike = float(np.abs(joint - statistics["peak_counts"].sum(("seed", "bin")).values).sum())
    off = float(np.abs(integral - 1).max())
    return {
        "densities of the peaks against an integral of one": (off, ROUNDING),
        "density of the heights against an integral of one": (abs(float(heights) - 1), ROUNDING),
        "peaks not counted": (lost, 0),
        "peaks by value and depth against peaks by value": (unlike, 0),
    }


def _relative(value: float, expected: float) -> float:
    return abs(value - expected) / abs(expected)
