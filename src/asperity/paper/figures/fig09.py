"""Figure 9: distributions of the peaks of the von Mises stress and of two components."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.captions import bullets, name, peak_percentiles
from asperity.paper.figures.cases import of_surfaces
from asperity.paper.figures.plots import finish_densities, peak_density, von_mises_densities
from asperity.views.style import panels

STAGES = ("statistics",)
STUDIES = ("hurst",)
SUPPLEMENT = ("moments", "measured")
OWN = "peaks"


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the densities of (a) the von Mises peaks and (b) the peaks of the compression −σ_xx and of |σ_xz|.

    Notes
    -----
    A peak of a signed component is a maximum of its magnitude. σ_xx is compressive under a contact, so
    −σ_xx is shown; σ_xz is as often positive as negative, so |σ_xz| is.
    """
    cases = of_surfaces(statistics)
    figure, (von_mises, components) = panels()
    von_mises_densities(von_mises, cases)
    for number, case in enumerate(cases):
        look: dict[str, Any] = {"color": f"C{number}"}
        peak_density(
            components, case, "xx", compression=True, label=rf"$-\sigma_{{xx}}$, {case.title}", ls="-", **look
        )
        peak_density(components, case, "xz", label=rf"$|\sigma_{{xz}}|$, {case.title}", ls="--", **look)
    finish_densities(components, r"\sigma_{ij}")
    return figure


def caption(statistics: Mapping[str, xr.Dataset]) -> str:
    """Percentiles of the peaks of each surface."""
    return bullets(
        f"{name(case.title)}, {symbol}: {peak_percentiles(case, quantity)}"
        for case in of_surfaces(statistics)
        for quantity, symbol in (("von_mises", "σ_VM"), ("xx", "\\|σ_xx\\|"), ("xz", "\\|σ_xz\\|"))
    )
