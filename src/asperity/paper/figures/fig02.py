"""Figure 2: load and area of a periodic Hertzian indenter, solver and closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator, ScalarFormatter

from asperity.paper.figures.cases import Datasets, bullets
from asperity.views.style import panels

MARKERS = "os^Dv"

ERRORS = {
    "wave_pressure_error": "wave: pressure ($L^2$)",
    "wave_approach_error": "wave: approach",
    "slab_load_error": "slab: load",
}
"""Errors of the grid that are drawn, with their names."""


def draw(validation: Datasets) -> Figure:
    """Draw area against load of (a) a half-space and (b) slabs, (c) their stiffness, (d) errors of the grid.

    Lines in (a) and (b) are the closed form of a half-space (Eqs. 11–16).
    """
    figure, (half_space, slabs, stiffening, grids) = panels(rows=2, height=60)
    _draw_half_space(half_space, validation["load_area"])
    _draw_slabs(slabs, stiffening, validation["slab_load_area"])
    _draw_grid_errors(grids, validation["grid_convergence"])
    return figure


def caption(validation: Datasets) -> str:
    """Error of the contact radius against the closed form, and stiffening of slabs."""
    data, slabs = validation["load_area"], validation["slab_load_area"]
    error = np.abs(data["solved_contact_radius"] / data["hertz_contact_radius"] - 1)
    return bullets(
        [
            f"contact radius at given load within {100 * float(error.max()):.2f} % of the closed form, "
            f"for Poisson's ratios {', '.join(f'{nu:g}' for nu in data['poisson'].values)} on "
            f"{data.attrs['grid_points']} nodes along an edge",
            *(
                f"a bonded slab of height {float(tall):g} L carries {float(load):.3f} times the load of a "
                f"half-space at the deepest indentation"
                for tall, load in zip(slabs["slab_height"], slabs["slab_stiffening"][:, -1], strict=True)
            ),
        ]
    )


def _draw_half_space(axis: Axes, data: xr.Dataset) -> None:
    """Draw contact area against load for each Poisson's ratio."""
    scale = data.attrs["curvature_radius"]
    for marker, nu in zip(MARKERS, data.poisson.values, strict=False):
        one = data.sel(poisson=nu)
        line = axis.plot(scale * one.curve_mean_pressure_young, 100 * one.curve_area_fraction)[0]
        look: dict[str, Any] = {"marker": marker, "color": line.get_color(), "label": rf"$\nu = {nu:g}$"}
        axis.plot(scale * one.imposed_mean_pressure_young, 100 * one.solved_area_fraction, ls="", **look)
    axis.set(xlabel=r"mean pressure $\bar{p} R / (E L)$", ylabel="contact area (% of cell)")
    axis.set(xlim=(0, None), ylim=(0, None))
    axis.legend(title="line: closed form")


def _draw_slabs(area: Axes, stiffening: Axes, data: xr.Dataset) -> None:
    """Draw contact area against load, and load against indentation, of slabs of several heights."""
    scale = data.attrs["curvature_radius"]
    area.loglog(
        scale * data.curve_mean_pressure, 100 * data.curve_area_fraction, "k", lw=0.8, label="closed form"
    )
    for marker, number in zip(MARKERS, range(data.sizes["slab"]), strict=False):
        one = data.isel(slab=number)
        tall = float(one.slab_height)
        look: dict[str, Any] = {"marker": marker, "label": f"$L_z = {tall:g} L$"}
        area.loglog(scale * one.slab_mean_pressure, 100 * np.pi * one.slab_contact_radius**2, ls="", **look)
        stiffening.plot(scale * one.slab_approach / tall, one.slab_stiffening, lw=0.8, **look)
    area.set(xlabel=r"mean pressure $\bar{p} R / (E^* L)$", ylabel="contact area (% of cell)")
    area.legend()
    stiffening.axhline(1, color="k", lw=0.8)
    stiffening.set(xlabel=r"indentation $u_z^0 R / (L L_z)$", ylabel="load / Hertz at same indentation")
    stiffening.legend()


def _draw_grid_errors(axis: Axes, data: xr.Dataset) -> None:
    """Draw errors against the number of nodes, with their order of convergence."""
    for marker, (name, text) in zip(MARKERS, ERRORS.items(), strict=False):
        order = -np.polyfit(np.log(data.grid_points), np.log(data[name]), 1)[0]
        axis.loglog(data.grid_points, data[name], marker=marker, lw=0.8, label=f"{text}, order {order:.1f}")
    axis.set(xlabel="nodes on an edge", ylabel="relative error", xticks=data.grid_points.values)
    axis.xaxis.set_major_formatter(ScalarFormatter())
    axis.xaxis.set_minor_locator(NullLocator())
    axis.legend()
