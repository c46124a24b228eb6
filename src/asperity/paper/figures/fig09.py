"""Figure 9: distributions of the peaks of the von Mises stress and of two components."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.shared import density, name_density
from asperity.paper.figures.style import label, panels


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Panel a: von Mises peaks; panel b: peaks of the compression −σ_xx and of |σ_xz|.

    Parameters
    ----------
    statistics : mapping of datasets
        Results of stage statistics, by surface.

    Notes
    -----
    A peak of a signed component is a maximum of its magnitude. σ_xx is compressive under a contact, so
    −σ_xx is shown; σ_xz is as often positive as negative, so |σ_xz| is.
    """
    figure, (von_mises, components) = panels()
    for number, data in enumerate(statistics.values()):
        poisson = data.attrs["poisson_contact"]
        density(von_mises, data, "von_mises", poisson, label=label(data))
        for quantity, symbol, line in (("xx", r"-\sigma_{xx}", "-"), ("xz", r"|\sigma_{xz}|", "--")):
            density(
                components,
                data,
                quantity,
                poisson,
                sign=-1 if quantity == "xx" else 1,
                ls=line,
                color=f"C{number}",
                label=f"${symbol}$, {label(data)}",
            )
    name_density(von_mises, r"\sigma_\mathrm{VM}")
    name_density(components, r"\sigma_{ij}")
    for axis in (von_mises, components):
        axis.legend()
    return figure
