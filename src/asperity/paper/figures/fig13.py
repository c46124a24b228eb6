"""Figure 13: how compressibility changes the distributions of the stress peaks."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.shared import density, name_density
from asperity.paper.figures.style import panels


def draw(statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Panel a: von Mises peaks; panel b: peaks of the compressions −σ_xx and −σ_zz.

    Parameters
    ----------
    statistics : mapping of datasets
        Result of stage statistics of one surface, at several Poisson's ratios.

    Notes
    -----
    σ_zz does not depend on Poisson's ratio in a half-space and has one curve; in a layer that of the
    contact's ratio is shown.
    """
    (data,) = statistics.values()
    figure, (von_mises, components) = panels()
    for poisson in data["poisson"].values:
        name = rf"$\nu = {poisson:g}$"
        density(von_mises, data, "von_mises", poisson, label=name)
        density(components, data, "xx", poisson, sign=-1, label=rf"$-\sigma_{{xx}}$, {name}")
    density(
        components,
        data,
        "zz",
        data.attrs["poisson_contact"],
        sign=-1,
        c="k",
        ls="--",
        label=r"$-\sigma_{zz}$",
    )
    name_density(von_mises, r"\sigma_\mathrm{VM}")
    name_density(components, r"-\sigma_{ii}")
    for axis in (von_mises, components):
        axis.legend()
    return figure
