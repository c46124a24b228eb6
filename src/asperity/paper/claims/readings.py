"""Numbers of claims that depend on random surfaces: readings of their statistics, one number for each seed.

Numbers of two surfaces are compared seed by seed: xarray aligns them along `seed`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import xarray as xr

from asperity.paper.claims.evidence import Evidence, Measure


@dataclass(frozen=True)
class Reading:
    """A variable of the statistics of one surface, reduced to one number for each seed.

    Parameters
    ----------
    variable : str
        Of stage statistics, along `seed`.
    where : mapping
        Coordinates at which it is taken, such as ``{"quantity": "xx", "level": 0.99}``.
    poisson : str
        ``"contact"``, ``"smallest"`` or ``"largest"``: the Poisson's ratio at which it is taken.
    unscaled : bool
        Multiply by ḡ, the rms gradient over the true contact: of stresses in units of E* instead of E* ḡ.
    """

    variable: str
    where: Mapping[str, Any] = field(default_factory=dict)
    poisson: str = "contact"
    unscaled: bool = False

    def of(self, statistics: xr.Dataset) -> xr.DataArray:
        """The reading of one surface, along `seed`."""
        found = statistics[self.variable]
        if "poisson" in found.dims:
            ratios = statistics["poisson"].values
            nu = {
                "contact": statistics.attrs["poisson_contact"],
                "smallest": ratios.min(),
                "largest": ratios.max(),
            }
            found = found.sel(poisson=nu[self.poisson])
        found = found.sel(self.where).reset_coords(drop=True)
        return found * statistics["seed_gradient_rms_contact"] if self.unscaled else found


def percentile(quantity: str, share: float = 0.99, unscaled: bool = False) -> Reading:
    """Magnitude that a share of the peaks of a quantity does not exceed, by default the 99th percentile."""
    return Reading("seed_peak_quantile", {"quantity": quantity, "level": share}, unscaled=unscaled)


def deviation(quantity: str) -> Reading:
    """Standard deviation of the magnitude of the peaks of a quantity."""
    return Reading("seed_peak_deviation", {"quantity": quantity})


def highest_depth(quantity: str) -> Reading:
    """Mean depth of the highest tenth of the peaks of a quantity."""
    return Reading("seed_mean_depth_highest", {"quantity": quantity})


def single(reading: Reading, role: str) -> Measure:
    """A reading of one surface."""
    return lambda evidence: reading.of(evidence.statistics(role))


def ratio(reading: Reading, over: str, under: str) -> Measure:
    """A reading of the surface of one role over that of another."""
    return lambda evidence: reading.of(evidence.statistics(over)) / reading.of(evidence.statistics(under))


def quotient(above: Reading, below: Reading, role: str) -> Measure:
    """One reading of a surface over another reading of it."""
    return lambda evidence: above.of(evidence.statistics(role)) / below.of(evidence.statistics(role))


def ratio_of_poisson(reading: Reading) -> Measure:
    """A reading at the smallest Poisson's ratio over that at the largest, in the study of compressibility."""
    return quotient(
        replace(reading, poisson="smallest"), replace(reading, poisson="largest"), "compressibility"
    )


def skewness_of_opposite_sign(evidence: Evidence) -> xr.DataArray:
    """Skewness of the heights for γ > 0 over minus that for γ < 0."""
    positive, negative = (evidence.statistics(f"skew_{sign}") for sign in ("positive", "negative"))
    return -positive["seed_skewness"] / negative["seed_skewness"]


def kolmogorov(quantity: str, one: str, other: str) -> Measure:
    """Kolmogorov distance between the peaks of a quantity on the surfaces of two roles."""
    peaks = Reading("seed_peak_quantile", {"quantity": quantity})
    return lambda evidence: _kolmogorov(
        peaks.of(evidence.statistics(one)), peaks.of(evidence.statistics(other))
    )


def kolmogorov_of_poisson(quantity: str) -> Measure:
    """Kolmogorov distance between the peaks of a quantity at the smallest and the largest Poisson's ratio."""
    low, high = (
        Reading("seed_peak_quantile", {"quantity": quantity}, end) for end in ("smallest", "largest")
    )

    def measure(evidence: Evidence) -> xr.DataArray:
        statistics = evidence.statistics("compressibility")
        return _kolmogorov(low.of(statistics), high.of(statistics))

    return measure


def _kolmogorov(one: xr.DataArray, other: xr.DataArray) -> xr.DataArray:
    """Largest difference between the shares of peaks below a value, for each seed, from their quantiles."""
    one, other = xr.align(one, other, join="inner")
    levels = one["level"].values
    distances = []
    for curves in zip(
        one.transpose("seed", "level").values, other.transpose("seed", "level").values, strict=True
    ):
        values = np.sort(np.concatenate(curves))
        shares = [np.interp(values, curve, levels, left=0.0, right=1.0) for curve in curves]
        distances.append(np.abs(shares[0] - shares[1]).max())
    return xr.DataArray(distances, coords={"seed": one["seed"]})
