"""Figure 12: von Mises stress under a Hertzian indenter for two Poisson's ratios."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.style import panels


def draw(validation: Mapping[str, xr.Dataset]) -> Figure:
    """Maps on the vertical plane through the axis, one panel a ratio, with Huber's closed form as lines.

    Parameters
    ----------
    validation : mapping of datasets
        ``punch``, of `asperity.validation.closed_forms.punch`.
    """
    data = validation["punch"]
    ratios = data.poisson.values
    figure, axes = panels(columns=len(ratios), height=52)
    radius = float(data.contact_radius)
    scale = float(data.gradient_rms_contact)
    highest = float(data.von_mises_spectral.max()) / scale
    levels = np.linspace(0, highest, 25)
    lines = np.linspace(0, highest, 9)[1:-1]
    shade = {"facecolor": "k", "alpha": 0.4, "linewidth": 0, "pad": 1.5}
    for axis, nu in zip(axes, ratios, strict=True):
        one = data.sel(poisson=nu)
        x, depth = one.x / radius, one.depth / radius
        image = axis.contourf(x, depth, one.von_mises_spectral / scale, levels=levels, cmap="viridis")
        image.set_edgecolor("face")
        image.set_rasterized(True)
        axis.contour(
            x,
            depth,
            one.von_mises_closed_form / scale,
            levels=lines,
            colors="w",
            linewidths=0.5,
            linestyles="--",
        )
        peak = float(one.peak_depth_closed_form) / radius
        axis.plot(0, peak, "+", color="k", ms=6)
        text = "\n".join(
            f"{who}: {float(one[f'peak_von_mises_{name}'] / one.largest_pressure):.3f} $p_0$"
            f" at {float(one[f'peak_depth_{name}']) / radius:.2f} $a$"
            for who, name in (("closed form", "closed_form"), ("cell", "confined"))
        )
        axis.text(
            0, 0.96 * float(depth.max()), text, ha="center", va="bottom", fontsize=7, color="w", bbox=shade
        )
        axis.set(xlabel="$x / a$", ylabel="depth $/ a$", aspect="equal", ylim=(float(depth.max()), 0))
        axis.set_title(rf"$\nu = {nu:g}$", loc="center")
    figure.colorbar(
        image,
        ax=axes,
        label=r"$\sigma_\mathrm{VM} / E^* \bar{g}_r$",
        shrink=0.8,
        ticks=np.linspace(0, 0.7, 8),
    )
    return figure
