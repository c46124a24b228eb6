"""Stage statistics: all numbers of the peaks, profiles and decays of one surface, in one dataset.

`surface_statistics` joins the numbers of each seed (`seed_statistics`) along `seed` and adds numbers pooled
over seeds. Figures, captions, claims and the drift check read this dataset; none of them computes such a
number again. `verify_seed` and `verify_statistics` compare the results with laws that they must obey.

Stresses are divided by E* ḡ_r, ḡ_r being the rms gradient over the real contact. Lengths and depths are in
units of the longer edge of the cell. Variables ``continuum_…`` are, along `kind`, the estimate of a number at
zero grid spacing, and its relative error. NaN where there is nothing to measure or to estimate.
"""

from collections.abc import Iterable
from functools import partial
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from asperity.contact.patches import contact_patches
from asperity.core.types import Array
from asperity.fourier.grid import Grid
from asperity.results.dataset import grid_of, height_of, read_result, settings_of
from asperity.stress.peaks.selection import select_peaks, selection_for
from asperity.stress.statistics.extrapolation import OnGrid, extrapolated_numbers, numbers_on
from asperity.stress.statistics.pooling import (
    Bootstrap,
    bin_edges,
    mean,
    pool_peaks,
    pooled_density,
    with_bounds,
)
from asperity.study.stages.contact import SOLID_ATTRIBUTES

_HEIGHT_LIMITS = (-6.0, 6.0)
"""Largest height over the rms that is counted: a Gaussian surface has one node in 10⁹ beyond."""

PEAKS_PER_BIN = 20
"""Least number of peaks for each bin of their densities: an average bin then has an error of a fifth."""

FEWEST_BINS = 10
"""Smallest number of bins of the densities, however few the peaks."""

QUANTILES = np.concatenate([np.arange(100) / 100, np.arange(991, 1001) / 1000])
"""Fractions of the peaks at which quantiles are stored: every percent, above 99 % every tenth of it."""

EDGE_ROUNDING = 1e-6
"""Rounding of the position of a peak on a mirror line, over half of the spacing of the nodes."""

LARGE_PATCH = 30
"""A contact spot is large if it has more nodes than this."""

_SMALLEST_AREA = 0.01
"""Area fraction from which the load-area curve is fitted: below it the contacts have few nodes."""

_OF_CONTACT = ("contact_area_fraction", "gradient_rms_contact", "proportionality")
_STRESSES = ("peak_deviation", "peak_quantile", "maximum_von_mises")
_LENGTHS = ("mean_depth", "mean_depth_highest", "decay_length_depth", "decay_length_plane")
"""Numbers that have continuum estimates: of the contact, stresses, and lengths."""

LAW_BOUND = 1e-10
"""Bound for laws that hold exactly except for rounding."""

WORST_NODE = 100
"""Factor by which a single node may exceed the solver's tolerance, which is a norm over all nodes."""

REFINEMENT = 0.25
"""Fraction by which a peak between nodes may exceed the largest nodal value, with eight nodes on a wave."""

CERTIFIED = {
    "penetration": "penetration over its length scale",
    "contact_gap": "gap under contact over its length scale",
    "tension": "tension over the maximum pressure",
    "complementarity": "complementarity",
    "load_imbalance": "load balance",
}
"""Attribute of the certificate → the law that it measures."""

Checks = dict[str, tuple[float, float]]
"""Name of a law → amount by which a result breaks it, and the amount that is allowed."""


class SeedResults(NamedTuple):
    """Results of the stages surface, contact and stress for one seed of a surface."""

    seed: int
    surface: xr.Dataset
    contact: xr.Dataset
    stress: xr.Dataset

    @classmethod
    def read(cls, surface: str, contact: str, stress: str) -> "SeedResults":
        """Read the result files of one seed."""
        stages = [read_result(path) for path in (surface, contact, stress)]
        return cls(settings_of(stages[-1])["seed"], *stages)


def surface_statistics(
    results: Iterable[SeedResults], bins: int, resamples: int, confidence: float
) -> xr.Dataset:
    """Statistics of one surface over its seeds.

    Parameters
    ----------
    results : iterable of SeedResults
        One seed after the other; the fields of a seed are not kept.
    bins, resamples, confidence
        Section ``statistics`` of the configuration. Few peaks have fewer bins (`PEAKS_PER_BIN`).

    Returns
    -------
    dataset
        Variables of `seed_statistics` along `seed`, variables of
        `asperity.stress.statistics.pooling.pool_peaks`, the distribution of the heights of all seeds, and the
        mean load along the load-area curve.
    """
    edges = bin_edges(np.empty(0), bins, _HEIGHT_LIMITS)
    seeds, each, stresses, heights, loads = [], [], [], [], []
    for seed, surface, contact, stress in results:
        heights.append(np.histogram((surface["height"] / surface["rms_height"]).values, edges)[0])
        loads.append((contact["path_mean_pressure"] / contact["path_gradient_rms_contact"]).values)
        each.append(seed_statistics(surface, contact, stress))
        seeds.append(seed)
        stresses.append(stress)
    of_seeds = xr.concat(each, "seed").assign_coords(seed=seeds)
    gradients = of_seeds["seed_gradient_rms_contact"].values.tolist()
    counted = of_seeds["seed_peak_count"].sum("seed")
    bins = min(bins, max(FEWEST_BINS, int(counted.min()) // PEAKS_PER_BIN))
    pooled = pool_peaks(stresses, gradients, bins, resamples, confidence).assign_coords(seed=seeds)
    bootstrap = Bootstrap(len(seeds), resamples, confidence)
    density = partial(pooled_density, edges=edges)
    pooled = pooled.assign(
        with_bounds("height_density", ("height_bin",), bootstrap.banded(density, np.stack(heights)))
        | with_bounds("path_scaled_load", ("load",), bootstrap.banded(mean, np.stack(loads)))
        | {
            "path_contact_area_fraction": contact["path_contact_area_fraction"],
            "height_edge": ("height_edge", edges),
            "height_counts": ("height_bin", np.sum(heights, axis=0)),
        }
    )
    return pooled.merge(of_seeds).assign_attrs({name: stresses[0].attrs[name] for name in SOLID_ATTRIBUTES})


def seed_statistics(surface: xr.Dataset, contact: xr.Dataset, stress: xr.Dataset) -> xr.Dataset:
    """Numbers of one surface and one seed.

    Parameters
    ----------
    surface, contact, stress : datasets
        Results of the stages of these names. The numbers of the stress are taken from the dataset of the
        stress if it has them.

    Returns
    -------
    dataset
        Variables ``seed_…`` of surface and contact, and the variables of `stress_numbers`.
    """
    names = ("contact_area_fraction", "mean_pressure", "gradient_rms_contact", "approach")
    area, pressure, gradient, approach = (float(contact[name]) for name in names)
    outside = max(float(surface["rms_gradient"]) ** 2 - area * gradient**2, 0) / max(1 - area, 1e-12)
    # Exponent of the area over the scaled load, and change of their ratio, up to the area of the study.
    exponent = change = np.nan
    path = contact["path_contact_area_fraction"].values
    kept = (path >= _SMALLEST_AREA * (1 - 1e-3)) & (path <= 1.001 * area)
    if kept.sum() >= 3:
        load = (contact["path_mean_pressure"] / contact["path_gradient_rms_contact"]).values[kept]
        exponent = float(np.polyfit(np.log(load), np.log(path[kept]), 1)[0])
        change = float(path[kept][-1] / load[-1] / (path[kept][0] / load[0]))
    radii = contact_patches(contact["pressure"].values > 0).radii
    spacing = np.sqrt(np.prod(grid_of(contact).spacing))
    numbers = {
        **{f"seed_{name}": float(surface[name]) for name in ("rms_gradient", "skewness", "kurtosis")},
        "seed_contact_area_fraction": area,
        "seed_mean_pressure": pressure,
        "seed_approach": approach,
        "seed_gradient_rms_contact": gradient,
        "seed_gradient_rms_outside": float(np.sqrt(outside)),
        "seed_proportionality": area * gradient / pressure,
        "seed_load_exponent": exponent,
        "seed_proportionality_change": change,
        "seed_patches": radii.size,
        "seed_patch_radius": float(spacing * np.average(radii, weights=radii**2)),
    }
    of_stress = [name for name in stress if str(name).startswith(("seed_", "continuum_"))]
    return xr.Dataset(numbers).merge(stress[of_stress] if of_stress else stress_numbers(contact, stress))


def stress_numbers(
    contact: xr.Dataset, stress: xr.Dataset, half: tuple[xr.Dataset, xr.Dataset] | None = None
) -> xr.Dataset:
    """Numbers of the stress of one seed, and the continuum estimates of stress and contact.

    Parameters
    ----------
    contact, stress : datasets
        Results of the stages of these names.
    half : pair of datasets, optional
        Contact and stress on half the nodes. Without them there are no estimates.

    Returns
    -------
    dataset
        Along `quantity` and `poisson`, numbers of the peaks that figures and claims count; along `level`,
        quantiles of their magnitude. Along `patches` and `poisson`, correlations that interpretations of the
        claims take.
    """
    if half is not None:
        lost = half[0].attrs["lost_gradient"]
        on_half = numbers_on(_on_grid(*half))
        found, best, error = extrapolated_numbers(_on_grid(contact, stress), on_half, lost, QUANTILES)
    else:
        found = numbers_on(_on_grid(contact, stress), QUANTILES)
        best = error = found * np.nan
    found[["peak_mean", *_STRESSES]] /= found["gradient_rms_contact"]
    best[[*_STRESSES]] /= best["gradient_rms_contact"]
    for name in _STRESSES:
        error[name] = np.hypot(error[name], error["gradient_rms_contact"])
    on_grid = found[["peak_count", "peak_mean", *_STRESSES, *_LENGTHS]]
    continuum = xr.concat([kind[[*_OF_CONTACT, *_STRESSES, *_LENGTHS]] for kind in (best, error)], "kind")
    numbers = on_grid.rename({name: f"seed_{name}" for name in on_grid}).merge(
        continuum.rename({name: f"continuum_{name}" for name in continuum})
    )
    numbers["seed_reference_depth"] = stress["reference_depth"]
    patches, radii, *_ = contact_patches(contact["pressure"].values > 0)
    ratios, grid = stress["poisson"].values.tolist(), grid_of(contact)
    correlations = np.array([_patch_correlations(stress, ratio, grid, patches, radii) for ratio in ratios])
    numbers["seed_depth_patch_correlation"] = ("poisson", correlations[:, 0])
    numbers["seed_patch_correlation"] = (("patches", "poisson"), correlations[:, 1:].T)
    return numbers.assign_coords(kind=["estimate", "error"], patches=["highest_of_patch", "large_patches"])


def _on_grid(contact: xr.Dataset, stress: xr.Dataset) -> OnGrid:
    """Results of the stages contact and stress, whose effective modulus is one."""
    load, gradient = float(contact["mean_pressure"]), float(contact["gradient_rms_contact"])
    pressure, height = contact["pressure"].values, height_of(contact).values
    return OnGrid(pressure, load, gradient, grid_of(contact), stress, height=height)


def _patch_correlations(
    stress: xr.Dataset, ratio: float, grid: Grid, patches: Array, radii: Array
) -> list[float]:
    """Rank correlations of the depth of von Mises peaks with the radius of the contact spot above.

    One for all peaks, one for the highest peak below each spot, and one for the highest below large spots.
    """
    found = select_peaks(stress, "von_mises", ratio, selection_for("von_mises"))
    row, column = (
        np.rint(found[f"peak_{axis}"].values / step).astype(int)
        for axis, step in zip("yx", grid.spacing, strict=True)
    )
    patch = patches[row % grid.shape[0], column % grid.shape[1]]  # from 1; 0 outside contact
    by_patch = pd.Series(np.abs(found["peak_value"].values)).groupby(patch)
    highest = np.sort(by_patch.idxmax().drop(0, errors="ignore").to_numpy(int))
    large = highest[radii[patch[highest] - 1] > np.sqrt(LARGE_PATCH / np.pi) * (1 + 1e-12)]
    depth = found["peak_depth"].values
    return [
        depth_patch_correlation(depth[some], row[some], column[some], patches, radii)
        for some in (np.arange(depth.size), highest, large)
    ]


def depth_patch_correlation(depth: Array, row: Array, column: Array, patches: Array, radii: Array) -> float:
    """Rank correlation (Spearman) between the depth of peaks and the radius of the spot above them.

    Parameters
    ----------
    depth, row, column : (peaks,) arrays
        Depth of each peak, and the node above it.
    patches, radii : arrays
        As of `contact_patches`. Peaks that are not under a spot are left out.

    Returns
    -------
    float
        NaN with fewer than two different depths or radii.
    """
    ny, nx = patches.shape
    above = patches[row % ny, column % nx]
    touched = above > 0
    depth, radius = depth[touched], radii[above[touched] - 1]
    if np.unique(depth).size < 2 or np.unique(radius).size < 2:
        return float("nan")
    return float(np.corrcoef(pd.Series(radius).rank(), pd.Series(depth).rank())[0, 1])


class VerificationError(RuntimeError):
    """Results that break a law; the message names the laws and the amounts."""


def verification_table(surface: str, parts: dict[str, Checks]) -> pd.DataFrame:
    """The table ``verification`` of `asperity.results.tables.TABLES`.

    A check is a law by its name, the amount by which a result breaks it, and the bound that this amount must
    not exceed; NaN exceeds every bound.

    Parameters
    ----------
    surface : str
        Name of the surface.
    parts : dict
        Seed, or all seeds → its checks.

    Raises
    ------
    VerificationError
        If a check does not hold.
    """
    rows, broken = [], []
    for part, checks in parts.items():
        for name, (value, bound) in checks.items():
            rows.append((surface, part, name, value, bound))
            if not value <= bound:
                broken.append(f"{part}, {name} {value:.3g} > {bound:.3g}")
    if broken:
        raise VerificationError(f"{surface}: {'; '.join(broken)}")
    return pd.DataFrame(rows, columns=["surface", "of", "check", "value", "bound"])


def verify_seed(contact: xr.Dataset, stress: xr.Dataset) -> Checks:
    """Checks of the contact and the stress of one seed: certificate, load path and peaks.

    The conditions of contact come from the certificate, which stage contact computes from the pressure alone.
    """
    tolerance = WORST_NODE * settings_of(contact)["contact"]["tolerance"]
    violations = {law: float(contact.attrs[f"certificate_{name}"]) for name, law in CERTIFIED.items()}
    checks = {law: (value, tolerance) for law, value in violations.items()}
    for name, variable in {"area": "path_contact_area_fraction", "load": "path_mean_pressure"}.items():
        falls = float(np.sum(np.diff(contact[variable]) <= 0))
        checks[f"falls of the {name} along the load path"] = falls, 0
    grid = grid_of(contact)
    reach = {"depth": (0.0, float(stress["plane_depth"].max()))}
    for axis, edge, spacing in zip("yx", grid.length, grid.spacing, strict=True):
        least = -0.5 * spacing if grid.mirrored else 0.0  # the mirror line
        reach[axis] = (1 + EDGE_ROUNDING) * least, edge + (1 - EDGE_ROUNDING) * least
    outside = [
        np.sum((stress[f"peak_{axis}"] < low) | (stress[f"peak_{axis}"] > high))
        for axis, (low, high) in reach.items()
    ]
    excess = [
        float(select_peaks(stress, "von_mises", ratio)["peak_value"].max() / largest.max() - 1)
        for ratio, largest in stress["maximum_von_mises"].groupby("poisson")
    ]
    return checks | {
        "peaks outside the solid": (float(sum(outside)), 0),
        "largest von Mises peak over the largest node": (max(0.0, *excess), REFINEMENT),
        "peaks that are not finite": (float(np.sum(~np.isfinite(stress["peak_value"]))), 0),
    }


def verify_statistics(statistics: xr.Dataset) -> Checks:
    """Checks of the statistics of one surface: densities integrate to one, and every peak is counted."""
    width = np.diff(statistics["bin_edge"].values, axis=1)[None, :, None, :]
    integral = np.sum(statistics["peak_density"].values * width, axis=-1)
    counts = statistics["peak_counts"].sum("bin")
    integral = np.where(counts.sum("seed") > 0, integral, 1.0)
    heights = np.sum(statistics["height_density"].values * np.diff(statistics["height_edge"].values))
    found = statistics["seed_peak_count"]
    found = found.isel(lateral=0) if "lateral" in found.dims else found
    lost = 0.0
    for name in statistics["quantity"].values:
        counted = counts.sel(quantity=name, selection=selection_for(str(name)))
        lost += float(np.abs(counted - found.sel(quantity=name)).sum())
    unlike = np.abs(statistics["joint_counts"].sum(("bin", "depth_bin")) - counts.sum("seed")).sum()
    worst = float(np.abs(integral - 1).max())
    return {
        "densities of the peaks against an integral of one": (worst, LAW_BOUND),
        "density of the heights against an integral of one": (abs(float(heights) - 1), LAW_BOUND),
        "peaks not counted": (lost, 0),
        "peaks by value and depth against peaks by value": (float(unlike), 0),
    }
