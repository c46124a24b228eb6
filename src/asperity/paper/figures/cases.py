"""Cases that figures compare: a surface at one Poisson's ratio, with the name that the figure gives it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import xarray as xr

from asperity.stress.peak_kinds import selection_for
from asperity.views.style import label, wavelength_short


@dataclass(frozen=True)
class Case:
    """A curve or a panel: statistics of one surface at one Poisson's ratio.

    Parameters
    ----------
    title : str
        Name of the case in the figure, mathematics between dollar signs.
    statistics : dataset
        Result of stage statistics.
    poisson : float
    """

    title: str
    statistics: xr.Dataset
    poisson: float

    @property
    def wavelength_short(self) -> float:
        """Shortest wavelength of the surface, the unit of depths and distances."""
        return wavelength_short(self.statistics)

    @property
    def profiles(self) -> xr.Dataset:
        """Profiles, covariances and decay lengths at the Poisson's ratio of the case."""
        return self.statistics.sel(poisson=self.poisson)

    def peaks(self, quantity: str) -> xr.Dataset:
        """Statistics of the peaks of a quantity, of those peaks that figures and claims count."""
        return self.profiles.sel(quantity=quantity, selection=selection_for(quantity))


def of_surfaces(statistics: Mapping[str, xr.Dataset]) -> list[Case]:
    """A case for each surface, at the Poisson's ratio of its contact."""
    return [Case(label(data), data, data.attrs["poisson_contact"]) for data in statistics.values()]


def of_ratios(statistics: Mapping[str, xr.Dataset]) -> list[Case]:
    """A case for each Poisson's ratio of a single surface."""
    (data,) = statistics.values()
    return [Case(rf"$\nu = {poisson:g}$", data, float(poisson)) for poisson in data["poisson"].values]


def extreme_ratios(statistics: Mapping[str, xr.Dataset]) -> list[Case]:
    """The cases of the largest and of the smallest Poisson's ratio of a single surface."""
    cases = sorted(of_ratios(statistics), key=lambda case: case.poisson, reverse=True)
    return [cases[0], cases[-1]] if len(cases) > 1 else cases


def shortest_waves(statistics: Mapping[str, xr.Dataset]) -> list[Case]:
    """The cases of the two surfaces with the shortest waves, the shorter one last."""
    return sorted(of_surfaces(statistics), key=lambda case: case.wavelength_short)[:2][::-1]
