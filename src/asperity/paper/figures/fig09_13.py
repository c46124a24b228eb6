"""Distributions of the peaks of the von Mises stress and of components."""

from __future__ import annotations

from matplotlib.figure import Figure

from asperity.paper.figures.cases import (
    CASES,
    Datasets,
    bullets,
    extreme_ratios,
    finish_densities,
    of_surfaces,
    peak_density,
    von_mises_densities,
)
from asperity.views.style import panels


def draw(statistics: Datasets, cases: str) -> Figure:
    """Draw the densities of (a) the von Mises peaks and (b) the peaks of −σ_xx and of another component.

    The other one is |σ_xz| of each surface, or −σ_zz of the only surface at several Poisson's ratios.

    Notes
    -----
    A peak of a signed component is a maximum of its magnitude. σ_xx is compressive under a contact, so
    −σ_xx is shown; σ_xz is as often positive as negative, so |σ_xz| is. σ_zz does not depend on Poisson's
    ratio in a half-space and has one curve; in a layer that of the contact's ratio is shown.
    """
    compared = CASES[cases](statistics)
    figure, (von_mises, components) = panels()
    von_mises_densities(von_mises, compared)
    for number, case in enumerate(compared):
        name = rf"$-\sigma_{{xx}}$, {case.title}"
        peak_density(components, case, "xx", compression=True, label=name, color=f"C{number}")
        if cases == "surfaces":
            name = rf"$|\sigma_{{xz}}|$, {case.title}"
            peak_density(components, case, "xz", label=name, ls="--", color=f"C{number}")
    if cases == "ratios":
        (own,) = of_surfaces(statistics)
        peak_density(components, own, "zz", compression=True, c="k", ls="--", label=r"$-\sigma_{zz}$")
    finish_densities(components, r"\sigma_{ij}" if cases == "surfaces" else r"-\sigma_{ii}")
    return figure


def caption(statistics: Datasets, cases: str) -> str:
    """Percentiles of the peaks of each case, and the ratio between the extreme Poisson's ratios."""
    if cases == "surfaces":
        return bullets(
            f"{case.name}, {symbol}: {case.peak_percentiles(quantity)}"
            for case in of_surfaces(statistics)
            for quantity, symbol in (("von_mises", "σ_VM"), ("xx", "\\|σ_xx\\|"), ("xz", "\\|σ_xz\\|"))
        )
    lines = [
        f"{case.name}, σ_VM: {case.peak_percentiles('von_mises')}; \\|σ_xx\\|: {case.peak_percentiles('xx')}"
        for case in CASES[cases](statistics)
    ]
    extremes = extreme_ratios(statistics)
    low, high = extremes[-1], extremes[0]
    above, below = (case.peaks("von_mises")["peak_percentile"] for case in (low, high))
    values = ", ".join(
        f"{one:.2f} at the {percent:g}th percentile"
        for one, percent in zip(above.values / below.values, above["percent"].values, strict=True)
    )
    lines.append(f"von Mises peaks at ν = {low.poisson:g} over those at ν = {high.poisson:g}: {values}")
    return bullets(lines)
