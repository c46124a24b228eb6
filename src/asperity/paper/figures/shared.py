"""Pictures that several figures of the paper share: heights, densities, depth distributions, decays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from asperity.paper.figures.style import COLUMN, PAGE, panels, wavelength_short
from asperity.stress.selection import selection_for
from asperity.types import Array

Cases = Mapping[str, tuple[xr.Dataset, float]]
"""Label of a curve or panel → result of stage statistics and Poisson's ratio."""

OF_EITHER_SIGN = ("xz", "yz", "xy")
"""Quantities as often positive as negative, of which the magnitude is shown."""

_REACH = 6.0
_SHOWN_SHARE = 1e-4
_VISIBLE = 2e-3


def banded(axis: Axes, x: ArrayLike, data: xr.Dataset, name: str, factor: float = 1.0, **look: Any) -> None:
    """A curve with its confidence band, if it has one."""
    low, high = factor * data[f"{name}_low"].values, factor * data[f"{name}_high"].values
    _curve(axis, np.asarray(x), factor * data[name].values, low, high, **look)


def density(axis: Axes, data: xr.Dataset, quantity: str, poisson: float, sign: int = 1, **look: Any) -> None:
    """Probability density of the peaks of a quantity, of shear stresses that of their magnitude.

    `sign` −1 shows compression to the right.
    """
    chosen = data.sel(quantity=quantity, poisson=poisson, selection=selection_for(quantity))
    edges = chosen["bin_edge"].values
    curves = [chosen[f"peak_density{end}"].values for end in ("", "_low", "_high")]
    if quantity in OF_EITHER_SIGN:
        folded = np.linspace(0, np.abs(edges).max(), edges.size)
        curves = [folded_density(curve, edges, folded) for curve in curves]
        edges = folded
    _curve(axis, sign * (edges[1:] + edges[:-1]) / 2, *curves, **look)


def folded_density(values: Array, edges: Array, folded_edges: Array) -> Array:
    """Density of a magnitude, from the density of the signed quantity, constant in each bin."""
    below = np.concatenate([[0.0], np.cumsum(values * np.diff(edges))])
    share = np.interp(folded_edges, edges, below) - np.interp(-folded_edges, edges, below)
    return np.diff(share) / np.diff(folded_edges)


def height_density(axis: Axes, data: xr.Dataset, **look: Any) -> None:
    """Probability density of the heights over their rms, of one result of stage statistics."""
    edges = data["height_edge"].values
    axis.plot((edges[1:] + edges[:-1]) / 2, data["height_density"], **look)
    axis.set(xlabel=r"$h / h_\mathrm{rms}$", ylabel="probability density", xlim=(-4.5, 4.5), ylim=(0, None))


def depth_distributions(cases: Cases, unit: float | None = None, symbol: str = r"\lambda_s") -> Figure:
    """Joint probability density of the von Mises peaks over scaled value and depth, one panel a case.

    Parameters
    ----------
    cases : mapping
    unit, symbol : optional
        Unit of depth of all panels and what it is called; by default each surface's shortest wavelength.
    """
    figure, axes = panels(columns=len(cases), height=66, width=PAGE if len(cases) > 1 else COLUMN)
    shares = []
    for data, poisson in cases.values():
        chosen = data.sel(quantity="von_mises", poisson=poisson, selection=selection_for("von_mises"))
        value = chosen["bin_edge"].values
        depth = chosen["depth_edge"].values / (unit or wavelength_short(data))
        counts = chosen["joint_counts"].values
        share = counts / max(counts.sum(), 1) / (np.diff(value)[:, None] * np.diff(depth)[None, :])
        shares.append((value, depth, np.ma.masked_equal(share, 0)))
    highest = max(share.max() for _, _, share in shares)
    norm = LogNorm(max(highest * _SHOWN_SHARE, min(share.min() for _, _, share in shares)), highest)
    widest = max(value[1:][share.any(axis=1)].max() for value, _, share in shares)
    deepest = max(depth[1:][share.any(axis=0)].max() for _, depth, share in shares)
    for axis, title, (value, depth, share) in zip(axes, cases, shares, strict=True):
        image = axis.pcolormesh(value, depth, share.T, norm=norm, cmap="viridis_r", rasterized=True)
        axis.set(xlabel=r"$\sigma_\mathrm{VM}^\mathrm{lmax} / E^* \bar{g}_r$", ylabel=f"depth $/ {symbol}$")
        axis.set(xlim=(0, widest), ylim=(min(deepest, _REACH), 0))
        axis.set_title(title, loc="center")
    figure.colorbar(image, ax=axes, label="joint probability density")
    return figure


def decays(cases: Cases) -> Figure:
    """Eq. 22 along depth (a) and in the plane of the largest peak (b), over the variance there."""
    figure, (along_depth, in_plane) = panels()
    for title, (data, poisson) in cases.items():
        chosen = data.sel(poisson=poisson)
        unit = wavelength_short(data)
        variance = float(chosen["scaled_covariance_plane"][0])
        depth, lag = chosen["plane_depth"] / unit, chosen["lag"] / unit
        banded(along_depth, depth, chosen, "scaled_covariance_depth", 1 / variance, label=title)
        banded(in_plane, lag, chosen, "scaled_covariance_plane", 1 / variance, label=title)
    for axis in (along_depth, in_plane):
        axis.axhline(0, color="k", lw=0.4)
        axis.legend()
    along_depth.set(
        xlabel=r"depth $/ \lambda_s$", ylabel=r"$G_\mathrm{VM}(z) / G_\mathrm{VM}(z_\mathrm{peak})$"
    )
    along_depth.set(xlim=(0, _REACH))
    in_plane.set(
        xlabel=r"distance $/ \lambda_s$", ylabel=r"$G_\mathrm{VM}(r) / G_\mathrm{VM}(0)$", xlim=(0, _REACH)
    )
    return figure


def name_density(axis: Axes, symbol: str) -> None:
    """Axes of the probability density of the peaks of a scaled stress, as far as it can be seen."""
    scaled = rf"{symbol}^\mathrm{{lmax}} / E^* \bar{{g}}_r"
    lines = [(np.asarray(line.get_xdata()), np.asarray(line.get_ydata())) for line in axis.lines]
    visible = _VISIBLE * max(float(y.max()) for _, y in lines)
    largest = max(float(x[y > visible].max(initial=0.0)) for x, y in lines)
    axis.set(xlabel=f"${scaled}$", ylabel=rf"PDF$\,[{scaled}]$", xlim=(0, 1.02 * largest), ylim=(0, None))


def _curve(axis: Axes, x: Array, values: Array, low: Array, high: Array, **look: Any) -> None:
    line = axis.plot(x, values, **look)[0]
    if np.isfinite(low).all():
        axis.fill_between(x, low, high, color=line.get_color(), alpha=0.25, lw=0)
