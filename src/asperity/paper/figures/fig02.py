"""Figure 2: load and area of a periodic Hertzian indenter, solver and closed form."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator, ScalarFormatter

from asperity.paper.figures.style import panels

MARKERS = "os^Dv"


def draw(validation: Mapping[str, xr.Dataset]) -> Figure:
    """Area against load (a), of slabs (b), their stiffness (c), and the error of the grid (d).

    Parameters
    ----------
    validation : mapping of datasets
        ``load_area``, ``slab_load_area`` and ``grid_convergence``, of the functions of `asperity.validation.comparisons`
        of these names. Lines in (a) and (b) are the closed form of a half-space (Eqs. 11–16).
    """
    figure, (ratios, slabs, stiffening, grids) = panels(rows=2, height=60)
    data = validation["load_area"]
    scale = data.attrs["curvature_radius"]
    for marker, nu in zip(MARKERS, data.poisson.values, strict=False):
        one = data.sel(poisson=nu)
        line = ratios.plot(scale * one.curve_mean_pressure_young, 100 * one.curve_area_fraction)[0]
        ratios.plot(
            scale * one.imposed_mean_pressure_young,
            100 * one.solved_area_fraction,
            ls="",
            marker=marker,
            color=line.get_color(),
            label=rf"$\nu = {nu:g}$",
        )
    ratios.set(xlabel=r"mean pressure $\bar{p} R / (E L)$", ylabel="contact area (% of cell)")
    ratios.legend(title="line: closed form")

    data = validation["slab_load_area"]
    scale = data.attrs["curvature_radius"]
    slabs.loglog(
        scale * data.curve_mean_pressure, 100 * data.curve_area_fraction, "k", lw=0.8, label="closed form"
    )
    for marker, number in zip(MARKERS, range(data.sizes["slab"]), strict=False):
        one = data.isel(slab=number)
        tall = float(one.slab_height)
        look: dict[str, Any] = {"marker": marker, "label": f"$L_z = {tall:g} L$"}
        area = 100 * np.pi * one.slab_contact_radius**2
        slabs.loglog(scale * one.slab_mean_pressure, area, ls="", **look)
        indentation = scale * one.slab_approach / tall
        stiffening.plot(indentation, one.slab_stiffening, lw=0.8, **look)
    slabs.set(xlabel=r"mean pressure $\bar{p} R / (E^* L)$", ylabel="contact area (% of cell)")
    slabs.legend()
    stiffening.axhline(1, color="k", lw=0.8)
    stiffening.set(xlabel=r"indentation $u_z^0 R / (L L_z)$", ylabel="load / Hertz at same indentation")
    stiffening.legend()

    data = validation["grid_convergence"]
    for marker, (name, text) in zip(
        MARKERS,
        {
            "wave_pressure_error": "wave: pressure ($L^2$)",
            "wave_approach_error": "wave: approach",
            "slab_load_error": "slab: load",
        }.items(),
        strict=False,
    ):
        rate = -np.polyfit(np.log(data.grid_points), np.log(data[name]), 1)[0]
        grids.loglog(data.grid_points, data[name], marker=marker, lw=0.8, label=f"{text}, order {rate:.1f}")
    grids.set(xlabel="nodes on an edge", ylabel="relative error", xticks=data.grid_points.values)
    grids.xaxis.set_major_formatter(ScalarFormatter())
    grids.xaxis.set_minor_locator(NullLocator())
    grids.legend()
    ratios.set(xlim=(0, None), ylim=(0, None))
    return figure
