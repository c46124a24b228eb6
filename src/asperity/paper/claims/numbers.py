"""Numbers of the claims that depend on random surfaces: statistics of them, one number for each seed.

Numbers of two surfaces are compared seed by seed: xarray aligns them along `seed`. The paper leaves choices
open; an *interpretation* takes one option of each, as in section ``interpretations`` of the configuration.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from asperity.paper.claims.sources import SKEWED, role_of_delta

Options = Mapping[str, Any]
"""One interpretation of the paper: name of a choice → the option that is taken."""

_OF_MEAN_MODE = ("von_mises", "xx")
"""Quantities that the condition of the mean (q = 0) mode changes."""

_OF_STRESS = ("seed_peak", "seed_mean_depth", "seed_depth_patch", "seed_largest", "seed_decay")
"""Beginnings of the variables that describe a stress; without a quantity, the von Mises stress."""


class MissingEvidenceError(LookupError):
    """The configuration has no surface, or the study no dataset, for a claim."""


class Fixed(NamedTuple):
    """A number that does not depend on a random surface, and its numerical uncertainty."""

    value: float
    uncertainty: float = 0.0


@dataclass(frozen=True)
class Evidence:
    """Datasets from which the numbers of the claims are taken.

    Parameters
    ----------
    surfaces : mapping
        Role of a surface (`asperity.paper.claims.sources.roles`) → result of stage statistics.
    validation : mapping
        Name → dataset of stage validation.
    laterals : mapping
        Condition of the mean (q = 0) mode other than that of the study → role → statistics under it.
    options : mapping
        The interpretation under which numbers are taken; choices that are left out have the study's own.
    """

    surfaces: Mapping[str, xr.Dataset]
    validation: Mapping[str, xr.Dataset] = field(default_factory=dict)
    laterals: Mapping[str, Mapping[str, xr.Dataset]] = field(default_factory=dict)
    options: Options = field(default_factory=dict)

    def under(self, options: Options) -> Evidence:
        """The same evidence under an interpretation."""
        return replace(self, options=options)

    def statistics(self, role: str) -> xr.Dataset:
        """Statistics of the surface that has a role, under the interpretation's mean mode and δ."""
        delta = self.options.get("delta")
        if role in SKEWED and delta is not None:
            role = role_of_delta(role, delta)
        if role not in self.surfaces:
            raise MissingEvidenceError(f"no surface as {role}")
        own, lateral = self.surfaces[role], self.options.get("lateral")
        if lateral is None or own.attrs.get("uniform_mode") == f"laterally {lateral}":
            return own
        if role not in self.laterals.get(lateral, {}):
            raise MissingEvidenceError(f"no stress under {role}, laterally {lateral}")
        return self.laterals[lateral][role]

    def dataset(self, name: str) -> xr.Dataset:
        """A dataset of the validation."""
        if name not in self.validation:
            raise MissingEvidenceError(f"no dataset {name}")
        return self.validation[name]


@dataclass(frozen=True)
class Number:
    """A variable of the statistics of one surface, or two of them compared.

    If `of`, `quantity` or `poisson` has two entries, the number is the value of the first over that of the
    second. If it has no level, quantiles of peaks are compared by their Kolmogorov distance.

    Parameters
    ----------
    variable : str
        Of stage statistics, along `seed`.
    of : tuple of str
        Roles of surfaces.
    quantity : tuple of str
        Quantities whose peaks are counted.
    poisson : tuple of str
        ``"contact"``, ``"smallest"`` or ``"largest"``: the Poisson's ratios at which it is taken.
    level : float, optional
        Share of the peaks below a quantile.
    unscaled : bool
        Multiply by ḡ, the rms gradient over the true contact: of stresses in units of E* instead of E* ḡ.
    factor : float
    follows : tuple of str
        Choices of the interpretation that the number follows besides ``lateral`` and ``delta``.
    """

    variable: str
    of: tuple[str, ...]
    quantity: tuple[str, ...] = ()
    poisson: tuple[str, ...] = ("contact",)
    level: float | None = None
    unscaled: bool = False
    factor: float = 1.0
    follows: tuple[str, ...] = ()

    @property
    def choices(self) -> tuple[str, ...]:
        """Choices on which the number depends."""
        stress = self.variable.startswith(_OF_STRESS)
        lateral = stress and (not self.quantity or set(self.quantity) & {*_OF_MEAN_MODE})
        skewed = set(self.of) & {*SKEWED}
        return (*(("lateral",) if lateral else ()), *self.follows, *(("delta",) if skewed else ()))

    def __call__(self, evidence: Evidence) -> xr.DataArray:
        """The number of each seed."""
        count = max(len(self.of), len(self.quantity), len(self.poisson))
        found = [self._value(evidence, term) for term in range(count)]
        if len(found) == 1:
            return self.factor * found[0]
        if "level" in found[0].dims:
            return _kolmogorov(*found)
        return self.factor * found[0] / found[1]

    def _value(self, evidence: Evidence, term: int) -> xr.DataArray:
        """The value of the first or the second term."""
        options = {name: evidence.options[name] for name in self.follows if name in evidence.options}
        statistics = evidence.statistics(self.of[term % len(self.of)])
        patches = options.get("patches", "every_peak")
        if patches == "every_peak":
            found = statistics[self.variable]
        else:
            found = statistics["seed_patch_correlation"].sel(patches=patches)
        if self.quantity:
            quantity = self.quantity[term % len(self.quantity)]
            quantity = options.get("shear", quantity) if quantity == "xz" else quantity
            if quantity not in statistics["quantity"].values:
                raise MissingEvidenceError(f"no peaks of quantity = {quantity}")
            found = found.sel(quantity=quantity)
        if self.level is not None:
            found = found.sel(level=self.level)
        if "poisson" in found.dims:
            ratios = statistics["poisson"].values
            ends = {"smallest": ratios.min(), "largest": ratios.max()}
            ends["contact"] = statistics.attrs["poisson_contact"]
            found = found.sel(poisson=ends[self.poisson[term % len(self.poisson)]])
        found = found.reset_coords(drop=True)
        unscaled = self.unscaled or options.get("scaling") == "absolute"
        return found * statistics["seed_gradient_rms_contact"] if unscaled else found


Measure = Callable[[Evidence], xr.DataArray | Fixed]
"""Takes the number of a claim from the evidence: one for each seed along `seed`, or one for all.

Raises `MissingEvidenceError` if the evidence lacks a surface or a dataset."""


def _kolmogorov(one: xr.DataArray, other: xr.DataArray) -> xr.DataArray:
    """Largest difference between the shares of peaks below a value, for each seed, from their quantiles.

    It is smaller than that of all peaks, by at most 0.0025 for ten thousand of them (`docs/claims.md`).
    """
    one, other = (found.transpose("seed", "level") for found in xr.align(one, other, join="inner"))
    levels = one["level"].values
    distances = []
    for curves in zip(one.values, other.values, strict=True):
        values = np.sort(np.concatenate(curves))
        shares = [np.interp(values, curve, levels, left=0.0, right=1.0) for curve in curves]
        distances.append(np.abs(shares[0] - shares[1]).max())
    return xr.DataArray(distances, coords={"seed": one["seed"]})
