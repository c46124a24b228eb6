"""Figure 13: how compressibility changes the distributions of the stress peaks."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.captions import bullets, name, peak_percentiles
from asperity.paper.figures.cases import Case, extreme_ratios, of_ratios, of_surfaces
from asperity.paper.figures.plots import finish_densities, peak_density, von_mises_densities
from asperity.views.style import panels

STAGES = ("statistics",)
STUDIES = ("compressibility",)
OWN = "poisson_peaks"
SEVERAL_RATIOS = True


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the densities of (a) the von Mises peaks and (b) the peaks of the compressions −σ_xx and −σ_zz.

    Parameters
    ----------
    statistics : mapping of datasets
        One surface, at several Poisson's ratios.

    Notes
    -----
    σ_zz does not depend on Poisson's ratio in a half-space and has one curve; in a layer that of the
    contact's ratio is shown.
    """
    cases = of_ratios(statistics)
    figure, (von_mises, components) = panels()
    von_mises_densities(von_mises, cases)
    for case in cases:
        peak_density(components, case, "xx", compression=True, label=rf"$-\sigma_{{xx}}$, {case.title}")
    (own,) = of_surfaces(statistics)
    peak_density(components, own, "zz", compression=True, c="k", ls="--", label=r"$-\sigma_{zz}$")
    finish_densities(components, r"-\sigma_{ii}")
    return figure


def caption(statistics: Mapping[str, xr.Dataset]) -> str:
    """Percentiles of the peaks for each Poisson's ratio, and the ratio between the extreme ones."""
    lines = [
        f"{name(case.title)}, σ_VM: {peak_percentiles(case, 'von_mises')}; "
        f"\\|σ_xx\\|: {peak_percentiles(case, 'xx')}"
        for case in of_ratios(statistics)
    ]
    extremes = extreme_ratios(statistics)
    return bullets([*lines, _compared(extremes[-1], extremes[0])])


def _compared(low: Case, high: Case) -> str:
    """The von Mises peaks at the smallest Poisson's ratio over those at the largest, for each percentile."""
    above, below = (case.peaks("von_mises")["peak_percentile"] for case in (low, high))
    values = ", ".join(
        f"{one:.2f} at the {percent:g}th percentile"
        for one, percent in zip(above.values / below.values, above["percent"].values, strict=True)
    )
    return f"von Mises peaks at ν = {low.poisson:g} over those at ν = {high.poisson:g}: {values}"
