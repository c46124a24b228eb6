"""Numbers of claims that depend on random surfaces: statistics of them, one number for each seed.

A `Reading` is a variable of the statistics. It names the choices that it follows, such as which peaks are
counted, and becomes another variable under another option of them (`Reading.under`). Numbers of two surfaces
are compared seed by seed: xarray aligns them along `seed`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import xarray as xr

from asperity.paper.claims.evidence import Evidence, MissingEvidenceError, Options
from asperity.paper.claims.sources import SKEWED
from asperity.pipeline.statistics import DECAYS

QUARTILES = (0.25, 0.75)

_COUNTED = {
    "seed_peak_quantile": "seed_counted_quantile",
    "seed_peak_deviation": "seed_counted_deviation",
    "seed_mean_depth_highest": "seed_counted_depth_highest",
    "seed_depth_patch_correlation": "seed_counted_correlation",
}
"""Variable of the peaks below the surface → that of other choices of peaks."""

_DECAY = {"seed_decay_length_depth": "seed_decay_depth", "seed_decay_length_plane": "seed_decay_plane"}
"""Length over which Eq. 22 falls to half → that over which it falls to another share."""

_OF_UNIFORM_MODE = ("von_mises", "xx")
"""Quantities that the condition of the uniform mode changes."""


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
    choices : tuple of names
        Choices of section ``readings`` that the number follows.
    """

    variable: str
    where: Mapping[str, Any] = field(default_factory=dict)
    poisson: str = "contact"
    unscaled: bool = False
    choices: tuple[str, ...] = ()

    def of(self, statistics: xr.Dataset) -> xr.DataArray:
        """The reading of one surface, along `seed`."""
        missing = [
            f"{name} = {value}"
            for name, value in self.where.items()
            if isinstance(value, str) and value not in statistics[name].values
        ]
        if missing:
            raise MissingEvidenceError(f"no peaks of {', '.join(missing)}")
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
        if self.where.get("level") == list(QUARTILES):
            found = found.sel(level=QUARTILES[1], drop=True) - found.sel(level=QUARTILES[0], drop=True)
        return found * statistics["seed_gradient_rms_contact"] if self.unscaled else found

    def under(self, options: Options) -> Reading:
        """The reading with the options of the choices that it follows."""
        variable, where, unscaled = self.variable, dict(self.where), self.unscaled
        taken = {name: options[name] for name in self.choices if name in options}
        if "tail" in taken:
            where["level"] = taken["tail"]
        if "shear" in taken:
            where["quantity"] = taken["shear"]
        if "scaling" in taken:
            unscaled = taken["scaling"] == "absolute"
        if taken.get("breadth") == "quartiles":
            variable, where["level"] = "seed_peak_quantile", list(QUARTILES)
        counted = taken.get("peaks", "below_surface")
        if taken.get("patches", "every_peak") != "every_peak":
            counted = taken["patches"]
        if counted != "below_surface":
            variable = _COUNTED[variable]
            where.pop("quantity", None)
            where["counted"] = counted
        if taken.get("decay", "half") != "half":
            variable = _DECAY[variable]
            where["decay"] = DECAYS[taken["decay"]]
        return replace(self, variable=variable, where=where, unscaled=unscaled)

    def follows(self, role: str) -> tuple[str, ...]:
        """All choices that the number of a surface of a role depends on."""
        stress = self.where.get("quantity") in _OF_UNIFORM_MODE or "quantity" not in self.where
        lateral = stress and self.variable.startswith(
            ("seed_peak", "seed_mean_depth", "seed_depth_patch", "seed_largest", "seed_decay")
        )
        return (*(("lateral",) if lateral else ()), *self.choices, *(("delta",) if role in SKEWED else ()))


@dataclass(frozen=True)
class Number:
    """A number of a claim, made from readings of the surfaces of some roles.

    Parameters
    ----------
    parts : tuple of (Reading, role)
    combine : callable
        Takes the readings, arrays along `seed` and perhaps `level`, and returns the number along `seed`.
    """

    parts: tuple[tuple[Reading, str], ...]
    combine: Callable[..., xr.DataArray]

    def __call__(self, evidence: Evidence) -> xr.DataArray:
        options = evidence.options
        return self.combine(
            *(reading.under(options).of(evidence.statistics(role)) for reading, role in self.parts)
        )

    @property
    def roles(self) -> tuple[str, ...]:
        """Roles of the surfaces on which the number depends, each once."""
        return tuple(dict.fromkeys(role for _, role in self.parts))

    @property
    def choices(self) -> tuple[str, ...]:
        """Choices on which the number depends, each once."""
        return tuple(dict.fromkeys(name for reading, role in self.parts for name in reading.follows(role)))


def _peaks_of(quantity: str) -> tuple[str, ...]:
    """Which peaks are counted is a choice for the von Mises stress alone."""
    return ("peaks",) if quantity == "von_mises" else ()


def percentile(quantity: str, share: float = 0.99, unscaled: bool = False) -> Reading:
    """Magnitude that a share of the peaks of a quantity does not exceed, by default the 99th percentile."""
    where = {"quantity": quantity, "level": share}
    return Reading("seed_peak_quantile", where, unscaled=unscaled, choices=(*_peaks_of(quantity), "tail"))


def deviation(quantity: str) -> Reading:
    """Width of the distribution of the magnitude of the peaks of a quantity, its standard deviation."""
    return Reading("seed_peak_deviation", {"quantity": quantity}, choices=(*_peaks_of(quantity), "breadth"))


def highest_depth(quantity: str) -> Reading:
    """Mean depth of the highest tenth of the peaks of a quantity."""
    return Reading("seed_mean_depth_highest", {"quantity": quantity}, choices=_peaks_of(quantity))


def decay(direction: str) -> Reading:
    """Distance over which Eq. 22 decays, along ``"depth"`` or in the ``"plane"``."""
    return Reading(f"seed_decay_length_{direction}", choices=("decay",))


def following(reading: Reading, *choices: str) -> Reading:
    """A reading that follows further choices."""
    return replace(reading, choices=(*reading.choices, *choices))


def single(reading: Reading, role: str) -> Number:
    """A reading of one surface."""
    return Number(((reading, role),), lambda value: value)


def ratio(reading: Reading, over: str, under: str) -> Number:
    """A reading of the surface of one role over that of another."""
    return Number(((reading, over), (reading, under)), lambda above, below: above / below)


def quotient(above: Reading, below: Reading, role: str) -> Number:
    """One reading of a surface over another reading of it."""
    return Number(((above, role), (below, role)), lambda above, below: above / below)


def ratio_of_poisson(reading: Reading) -> Number:
    """A reading at the smallest Poisson's ratio over that at the largest, in the study of compressibility."""
    return quotient(
        replace(reading, poisson="smallest"), replace(reading, poisson="largest"), "compressibility"
    )


def skewness_of_opposite_sign() -> Number:
    """Skewness of the heights for γ > 0 over minus that for γ < 0."""
    parts = ((Reading("seed_skewness"), "skew_positive"), (Reading("seed_skewness"), "skew_negative"))
    return Number(parts, lambda positive, negative: -positive / negative)


def _distribution(quantity: str, poisson: str = "contact", choices: tuple[str, ...] = ()) -> Reading:
    """Quantiles of the peaks of a quantity at all levels."""
    return Reading(
        "seed_peak_quantile", {"quantity": quantity}, poisson, choices=(*_peaks_of(quantity), *choices)
    )


def kolmogorov(quantity: str, one: str, other: str) -> Number:
    """Kolmogorov distance between the peaks of a quantity on the surfaces of two roles."""
    peaks = _distribution(quantity)
    return Number(((peaks, one), (peaks, other)), _kolmogorov)


def kolmogorov_of_poisson(quantity: str, *choices: str) -> Number:
    """Kolmogorov distance between the peaks of a quantity at the smallest and the largest Poisson's ratio."""
    ends = ("smallest", "largest")
    parts = tuple((_distribution(quantity, end, choices), "compressibility") for end in ends)
    return Number(parts, _kolmogorov)


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
