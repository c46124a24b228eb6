"""Cases that figures compare: a surface at one Poisson's ratio, and its numbers in captions."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from asperity.stress.peaks.selection import selection_for
from asperity.views.style import label, wavelength_short

Datasets = Mapping[str, xr.Dataset]
"""Surface or name → dataset."""


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
    def name(self) -> str:
        """The title with its mathematics as reStructuredText has it."""
        return name(self.title)

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

    def peak_percentiles(self, quantity: str) -> str:
        """Number of the peaks of a quantity and percentiles of their magnitude, with their bands."""
        peaks = self.peaks(quantity)
        parts = []
        for percent in (50.0, 99.0):
            one = peaks.sel(percent=percent)
            text = f"{float(one['peak_percentile']):.3f}"
            if np.isfinite(one["peak_percentile_low"]):
                low, high = (float(one[f"peak_percentile_{end}"]) for end in ("low", "high"))
                text += f" [{low:.3f}, {high:.3f}]"
            parts.append(f"{text} E\\* ḡ_r at the {percent:g}th percentile")
        return f"{int(peaks['peak_counts'].sum())} peaks, {', '.join(parts)}"


def of_surfaces(statistics: Datasets) -> list[Case]:
    """A case for each surface, at the Poisson's ratio of its contact."""
    return [Case(label(data), data, data.attrs["poisson_contact"]) for data in statistics.values()]


def of_ratios(statistics: Datasets) -> list[Case]:
    """A case for each Poisson's ratio of a single surface."""
    (data,) = statistics.values()
    return [Case(rf"$\nu = {poisson:g}$", data, float(poisson)) for poisson in data["poisson"].values]


def extreme_ratios(statistics: Datasets) -> list[Case]:
    """The cases of the largest and of the smallest Poisson's ratio of a single surface."""
    cases = sorted(of_ratios(statistics), key=lambda case: case.poisson, reverse=True)
    return [cases[0], cases[-1]] if len(cases) > 1 else cases


def shortest_waves(statistics: Datasets) -> list[Case]:
    """The cases of the two surfaces with the shortest waves, the shorter one last."""
    return sorted(of_surfaces(statistics), key=lambda case: case.wavelength_short)[:2][::-1]


CASES = {
    "surfaces": of_surfaces,
    "ratios": of_ratios,
    "extreme ratios": extreme_ratios,
    "shortest waves": shortest_waves,
}
"""Option ``cases`` of a figure → the cases that it shows."""


def bullets(lines: Iterable[str]) -> str:
    """A list of sentences in reStructuredText."""
    return "\n".join(f"- {line}" for line in lines)


def name(title: str) -> str:
    """A title with its mathematics as reStructuredText has it."""
    return re.sub(r"\$(.*?)\$", r":math:`\1`", title)


def contact_area(data: xr.Dataset) -> str:
    """Area in contact, load, and rms gradient of a surface."""
    gradient = float(data["gradient_rms_contact"])
    return (
        f"{name(label(data))}: {100 * float(data['area_fraction']):.2f} % of the area in contact at a mean "
        f"pressure of {float(data['mean_pressure']) / gradient:.4f} E\\* ḡ_r, ḡ_r = {gradient:.4f}"
    )
