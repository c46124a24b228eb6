"""Figure 12: von Mises stress under a Hertzian indenter for two Poisson's ratios."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure

from asperity.core.types import Array
from asperity.paper.figures.cases import Datasets, bullets
from asperity.views.style import panels


def draw(validation: Datasets) -> Figure:
    """Draw the vertical plane through the axis for each ratio, with Huber's closed form as lines."""
    data = validation["punch"]
    ratios = data.poisson.values
    figure, axes = panels(columns=len(ratios), height=52)
    highest = float(data.von_mises_spectral.max()) / float(data.gradient_rms_contact)
    for axis, nu in zip(axes, ratios, strict=True):
        image = _draw_plane(axis, data.sel(poisson=nu), np.linspace(0, highest, 25))
        axis.set_title(rf"$\nu = {nu:g}$", loc="center")
    figure.colorbar(
        image,
        ax=axes,
        label=r"$\sigma_\mathrm{VM} / E^* \bar{g}_r$",
        shrink=0.8,
        ticks=np.linspace(0, 0.7, 8),
    )
    return figure


def caption(validation: Datasets) -> str:
    """Largest stress under the paraboloid, by Fourier series and in closed form."""
    data = validation["punch"]
    scale, radius = data["largest_pressure"], data["contact_radius"]
    lines = []
    for nu in data["poisson"].values:
        one = data.sel(poisson=nu)
        largest, depth = one["von_mises_spectral"].max() / scale, one["peak_depth_closed_form"] / radius
        lines.append(
            f"ν = {nu:g}: largest von Mises stress {float(largest):.4f} p₀ in the periodic cell, "
            f"{float(one['peak_von_mises_closed_form'] / scale):.4f} p₀ for a single contact, at a depth of "
            f"{float(depth):.3f} a"
        )
    return bullets(lines)


def _draw_plane(axis: Axes, one: xr.Dataset, levels: Array) -> ContourSet:
    """Draw the stress at one Poisson's ratio: a map, contours of the closed form, and the largest values."""
    radius, scale = float(one.contact_radius), float(one.gradient_rms_contact)
    x, depth = one.x / radius, one.depth / radius
    image = axis.contourf(x, depth, one.von_mises_spectral / scale, levels=levels, cmap="viridis")
    # Contour bands leave hairlines in vector formats.
    image.set_edgecolor("face")
    image.set_rasterized(True)
    axis.contour(
        x,
        depth,
        one.von_mises_closed_form / scale,
        levels=np.linspace(0, levels[-1], 9)[1:-1],
        colors="w",
        linewidths=0.5,
        linestyles="--",
    )
    axis.plot(0, float(one.peak_depth_closed_form) / radius, "+", color="k", ms=6)
    text = "\n".join(
        f"{who}: {float(one[f'peak_von_mises_{name}'] / one.largest_pressure):.3f} $p_0$"
        f" at {float(one[f'peak_depth_{name}']) / radius:.2f} $a$"
        for who, name in (("closed form", "closed_form"), ("cell", "confined"))
    )
    bottom = float(depth.max())
    shade = {"facecolor": "k", "alpha": 0.4, "linewidth": 0, "pad": 1.5}
    axis.text(0, 0.96 * bottom, text, ha="center", va="bottom", fontsize=7, color="w", bbox=shade)
    axis.set(xlabel="$x / a$", ylabel="depth $/ a$", aspect="equal", ylim=(bottom, 0))
    return image
