"""Evidence for the claims: statistics of surfaces by their role, and datasets of the validation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import xarray as xr

from asperity.paper.claims.sources import SKEWED, role_of_delta

Options = Mapping[str, Any]
"""One reading of the paper: name of a choice → the option that is taken, as in section ``readings``."""


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
        Condition of the uniform mode other than that of the study → role → statistics under it.
    options : mapping
        The reading under which numbers are taken; choices that are left out have the study's own option.
    """

    surfaces: Mapping[str, xr.Dataset]
    validation: Mapping[str, xr.Dataset] = field(default_factory=dict)
    laterals: Mapping[str, Mapping[str, xr.Dataset]] = field(default_factory=dict)
    options: Options = field(default_factory=dict)

    def under(self, options: Options) -> Evidence:
        """The same evidence under a reading."""
        return replace(self, options=options)

    def statistics(self, role: str) -> xr.Dataset:
        """Statistics of the surface that has a role, under the reading's uniform mode and δ."""
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


Measure = Callable[[Evidence], xr.DataArray | Fixed]
"""Takes the number of a claim from the evidence: one for each seed along `seed`, or one for all.

Raises `MissingEvidenceError` if the evidence lacks a surface or a dataset. A measure with an attribute
``choices`` takes another number under another option of these choices."""
