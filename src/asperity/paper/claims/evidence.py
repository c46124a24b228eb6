"""Evidence for the claims: statistics of surfaces by their role, and datasets of the validation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import xarray as xr


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
    """

    surfaces: Mapping[str, xr.Dataset]
    validation: Mapping[str, xr.Dataset] = field(default_factory=dict)

    def statistics(self, role: str) -> xr.Dataset:
        """Statistics of the surface that has a role."""
        if role not in self.surfaces:
            raise MissingEvidenceError(f"no surface as {role}")
        return self.surfaces[role]

    def dataset(self, name: str) -> xr.Dataset:
        """A dataset of the validation."""
        if name not in self.validation:
            raise MissingEvidenceError(f"no dataset {name}")
        return self.validation[name]


Measure = Callable[[Evidence], xr.DataArray | Fixed]
"""Takes the number of a claim from the evidence: one for each seed along `seed`, or one for all.

Raises `MissingEvidenceError` if the evidence lacks a surface or a dataset."""
