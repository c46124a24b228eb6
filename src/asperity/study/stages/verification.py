"""Verification of the study's results: the laws that the results of one surface must obey.

A check is a law by its name, the amount by which a result breaks it, and the bound that this amount must not
exceed; NaN exceeds every bound. The conditions of contact are those of the certificate, which stage contact
computed anew from the pressure alone.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
import xarray as xr

from asperity.results.dataset import grid_of, settings_of
from asperity.stress.peaks.selection import peaks, selection_for

ROUNDING = 1e-10
"""Bound for laws that hold exactly except for rounding."""

WORST_NODE = 100
"""Factor by which a single node may exceed the solver's tolerance, which is a norm over all nodes."""

REFINEMENT = 0.25
"""Part by which a peak refined between nodes may exceed the largest node, with eight nodes per wavelength."""

CERTIFIED = {
    "penetration": "penetration over its length scale",
    "contact_gap": "gap under contact over its length scale",
    "tension": "tension over the largest pressure",
    "complementarity": "complementarity",
    "load_imbalance": "load balance",
}
"""Attribute of the certificate → the law that it measures."""

Checks = dict[str, tuple[float, float]]
"""Name of a law → amount by which a result breaks it, and the amount that is allowed."""


class VerificationError(RuntimeError):
    """Results that break a law; the message names the laws and the amounts."""


def table(surface: str, parts: dict[str, Checks]) -> pd.DataFrame:
    """The table ``verification`` of `asperity.results.tables.TABLES`.

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
    """Checks of the contact and the stress of one seed: certificate, load path and peaks."""
    tolerance = WORST_NODE * settings_of(contact)["contact"]["tolerance"]
    checks = {
        law: (float(contact.attrs[f"certificate_{name}"]), tolerance) for name, law in CERTIFIED.items()
    }
    for name, variable in {"area": "path_area_fraction", "load": "path_mean_pressure"}.items():
        falls = float(np.sum(np.diff(contact[variable]) <= 0))
        checks[f"falls of the {name} along the load path"] = falls, 0
    height, width = grid_of(contact).length
    reach = {"depth": float(stress["plane_depth"].max()), "y": height, "x": width}
    outside = [
        np.sum((stress[f"peak_{axis}"] < 0) | (stress[f"peak_{axis}"] > reach[axis])) for axis in reach
    ]
    excess = [
        float(peaks(stress, "von_mises", ratio)["peak_value"].max() / largest.max() - 1)
        for ratio, largest in stress["largest_von_mises"].groupby("poisson")
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
    return {
        "densities of the peaks against an integral of one": (float(np.abs(integral - 1).max()), ROUNDING),
        "density of the heights against an integral of one": (abs(float(heights) - 1), ROUNDING),
        "peaks not counted": (lost, 0),
        "peaks by value and depth against peaks by value": (float(unlike), 0),
    }
