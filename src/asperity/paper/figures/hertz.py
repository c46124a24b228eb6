"""Hertzian contacts in a periodic cell: load, area and stress beside closed forms and finite elements."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, NullLocator, ScalarFormatter

from asperity.core.types import Array, ArrayLike
from asperity.paper.figures.cases import Datasets
from asperity.views.style import panels

MARKERS = "os^Dv"

ERRORS = {
    "wave_pressure_error": "wave: pressure ($L^2$)",
    "wave_approach_error": "wave: approach",
    "slab_load_error": "slab: load",
}
"""Errors of the grid that are drawn, with their names."""

SMALLEST, LARGEST = 1e-3, 10.0
"""Limits between which differences are drawn, in percent of the field's largest magnitude."""


def draw_load_area(validation: Datasets) -> Figure:
    """Draw area against load of (a) a half-space and (b) slabs, (c) their stiffness, (d) errors of the grid.

    Lines in (a) and (b) are the closed form of a half-space (Eqs. 11–16).
    """
    figure, (half_space, area, stiffening, grids) = panels(rows=2, height=60)
    data = validation["load_area"]
    scale = data.attrs["curvature_radius"]
    for marker, nu in zip(MARKERS, data.poisson.values, strict=False):
        one, text = data.sel(poisson=nu), rf"$\nu = {nu:g}$"
        line = half_space.plot(scale * one.curve_mean_pressure_young, 100 * one.curve_contact_area_fraction)[
            0
        ]
        load, color = scale * one.imposed_mean_pressure_young, line.get_color()
        half_space.plot(load, 100 * one.solved_contact_area_fraction, marker, color=color, label=text)
    half_space.set(xlabel=r"mean pressure $\bar{p} R / (E L)$", ylabel="contact area (% of cell)")
    half_space.set(xlim=(0, None), ylim=(0, None))
    half_space.legend(title="line: closed form")
    _draw_slabs(area, stiffening, validation["slab_load_area"])
    data = validation["grid_convergence"]
    for marker, (name, text) in zip(MARKERS, ERRORS.items(), strict=False):
        order = -np.polyfit(np.log(data.grid_points), np.log(data[name]), 1)[0]
        grids.loglog(data.grid_points, data[name], marker=marker, lw=0.8, label=f"{text}, order {order:.1f}")
    grids.set(xlabel="nodes on an edge", ylabel="relative error", xticks=data.grid_points.values)
    grids.xaxis.set_major_formatter(ScalarFormatter())
    grids.xaxis.set_minor_locator(NullLocator())
    grids.legend()
    return figure


def _draw_slabs(area: Axes, stiffening: Axes, data: xr.Dataset) -> None:
    """Draw contact area against load, and load against indentation, of slabs of several heights.

    Slabs are stiffer, which shows at equal indentation, not at equal load: a thin line joins the deepest
    point of each slab with the half-space at the same indentation, an open marker.
    """
    scale = data.attrs["curvature_radius"]
    load, half_space = scale * data.curve_mean_pressure, 100 * data.curve_contact_area_fraction
    area.loglog(load, half_space, "k", lw=0.8, label="closed form")
    for marker, number in zip(MARKERS, range(data.sizes["slab"]), strict=False):
        one = data.isel(slab=number)
        tall = float(one.slab_height)
        load, label = scale * one.slab_mean_pressure, f"$L_z = {tall:g} L$"
        shares = 100 * np.pi * one.slab_contact_radius**2
        softer = float(load[-1] / one.slab_stiffening[-1])
        below = float(np.interp(softer, data.curve_mean_pressure * scale, half_space))
        more = f"{label}: load × {float(one.slab_stiffening[-1]):.2f}"
        (line,) = area.loglog(load, shares, marker, label=more)
        area.plot([softer, float(load[-1])], [below, float(shares[-1])], color=line.get_color(), lw=0.6)
        area.plot(softer, below, marker, mfc="none", color=line.get_color())
        depth = scale * one.slab_approach / tall
        stiffening.plot(depth, one.slab_stiffening, marker=marker, lw=0.8, label=label)
    area.set(xlabel=r"mean pressure $\bar{p} R / (E^* L)$", ylabel="contact area (% of cell)")
    area.legend(loc="lower right", fontsize=6)
    text = "slabs are stiffer: open, the half-space\nat the deepest indentation of each"
    area.text(0.03, 0.97, text, va="top", fontsize=6, transform=area.transAxes)
    stiffening.axhline(1, color="k", lw=0.8)
    stiffening.set(xlabel=r"indentation $u_z^0 R / (L L_z)$", ylabel="load / Hertz at same indentation")
    stiffening.legend()


def caption_load_area(validation: Datasets) -> Iterator[str]:
    """Error of the contact radius against the closed form, and stiffening of slabs."""
    data, slabs = validation["load_area"], validation["slab_load_area"]
    error = np.abs(data["solved_contact_radius"] / data["hertz_contact_radius"] - 1)
    yield (
        f"contact radius at given load within {100 * float(error.max()):.2f} % of the closed form, "
        f"for Poisson's ratios {', '.join(f'{nu:g}' for nu in data['poisson'].values)} on "
        f"{data.attrs['grid_points']} nodes along an edge"
    )
    for tall, load in zip(slabs["slab_height"], slabs["slab_stiffening"][:, -1], strict=True):
        yield (
            f"a bonded slab of height {float(tall):g} L carries {float(load):.3f} times the load of a "
            f"half-space at the deepest indentation"
        )


def draw_fields(validation: Datasets, fields: Mapping[str, Sequence[str]]) -> Figure:
    """Draw fields on the diagonal plane of the cubic cell, and their difference to the finite elements.

    There is a row for each field. `fields` maps names to label and colour map. Displacements are over the
    approach, stresses over the maximum pressure. Triangles mark the edge of contact.
    """
    dataset = validation["elements"]
    maximum_pressure, radius = float(np.abs(dataset.stress_zz_spectral).max()), float(dataset.contact_radius)
    figure, axes = panels(rows=len(fields), height=60)
    pairs = zip(axes[::2], axes[1::2], fields.items(), strict=True)
    for value, difference, (name, (label, colours)) in pairs:
        ours, theirs = dataset[f"{name}_spectral"], dataset[f"{name}_elements"]
        shown = ours / (dataset.attrs["approach"] if name == "displacement_z" else maximum_pressure)
        odd = name == "stress_xz"  # a shear stress changes sign across the axis
        low, high = float(shown.min()), float(shown.max())
        if odd:
            high = max(-low, high)
            low = -high
        image = _draw_bands(value, *_mirrored(shown, odd), np.linspace(low, high, 31), colours)
        ticks = MaxNLocator(5, steps=[1, 2, 2.5, 5, 10])
        figure.colorbar(image, ax=value, label=label, shrink=0.85, ticks=ticks)
        percent = 100 * np.abs(theirs - ours) / np.abs(ours).max()
        both, norm = _mirrored(percent.clip(SMALLEST, LARGEST)), LogNorm(SMALLEST, LARGEST)
        error = difference.pcolormesh(*both, norm=norm, cmap="cividis", rasterized=True)
        figure.colorbar(error, ax=difference, label="difference to FEM (% of max)", shrink=0.85)
    half = np.sqrt(0.5)
    for axis in axes:
        axis.set(xlim=(-half, half), ylim=(0, 1), aspect="equal", xlabel="position along diagonal $/ L$")
        axis.set(ylabel="$z / L$", yticks=(0, 0.5, 1), xticks=(-0.5, 0, 0.5))
        axis.plot([-radius, radius], [1.03, 1.03], "v", ms=3, color="k", clip_on=False)
    return figure


def _mirrored(field: xr.DataArray, odd: bool = False) -> tuple[Array, Array, Array]:
    """Positions along the diagonal, height, and the field on both sides of the indenter's axis.

    The outermost values are extended to the faces of the cell, half a Gauss interval away.
    """
    values = np.pad(field.transpose("depth", "distance").values, ((1, 1), (0, 1)), mode="edge")
    distance = np.append(field.distance.values, np.sqrt(0.5))
    height = 1 - np.concatenate([[0.0], field.depth.values, [1.0]])
    both = np.concatenate([-distance[::-1], distance])
    return both, height, np.hstack([(-1 if odd else 1) * values[:, ::-1], values])


def _draw_bands(
    axis: Axes, x: ArrayLike, y: ArrayLike, values: ArrayLike, levels: Array, cmap: str
) -> ContourSet:
    """Draw filled contours as an image: contour bands leave hairlines in vector formats."""
    image = axis.contourf(x, y, values, levels=levels, cmap=cmap)
    image.set_edgecolor("face")
    image.set_rasterized(True)
    return image


def caption_fields(validation: Datasets, fields: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """Largest differences to the finite elements."""
    found = validation["elements"].isel(mesh=-1)
    for name in fields:
        yield (
            f"{name}: at most {100 * float(found['difference_away'].sel(field=name)):.3f} % of its largest "
            f"magnitude away from the edge of contact, "
            f"{100 * float(found['difference_edge'].sel(field=name)):.2f} % at it"
        )


def draw_von_mises(validation: Datasets) -> Figure:
    """Draw the vertical plane through the axis for each ratio, with Huber's closed form as lines."""
    data = validation["punch"]
    radius, scale = float(data.contact_radius), float(data.gradient_rms_contact)
    x, depth = data.x / radius, data.depth / radius
    figure, axes = panels(columns=data.sizes["poisson"], height=52)
    highest = float(data.von_mises_spectral.max()) / scale
    few, many = (np.linspace(0, highest, count) for count in (9, 25))
    shade = {"facecolor": "k", "alpha": 0.4, "linewidth": 0, "pad": 1.5}
    bottom = float(depth.max())
    for axis, nu in zip(axes, data.poisson.values, strict=True):
        one = data.sel(poisson=nu)
        image = _draw_bands(axis, x, depth, one.von_mises_spectral / scale, many, "viridis")
        exact = one.von_mises_closed_form / scale
        axis.contour(x, depth, exact, few[1:-1], colors="w", linewidths=0.5, linestyles="--")
        axis.plot(0, float(one.peak_depth_closed_form) / radius, "+", color="k", ms=6)
        text = "\n".join(
            f"{who}: {float(one[f'peak_von_mises_{name}'] / one.maximum_pressure):.3f} $p_0$"
            f" at {float(one[f'peak_depth_{name}']) / radius:.2f} $a$"
            for who, name in (("closed form", "closed_form"), ("cell", "confined"))
        )
        axis.text(0, 0.96 * bottom, text, ha="center", va="bottom", fontsize=7, color="w", bbox=shade)
        axis.set(xlabel="$x / a$", ylabel="depth $/ a$", aspect="equal", ylim=(bottom, 0))
        axis.set_title(rf"$\nu = {nu:g}$", loc="center")
    ticks = np.linspace(0, 0.7, 8)
    figure.colorbar(image, ax=axes, label=r"$\sigma_\mathrm{VM} / E^* \bar{g}_r$", shrink=0.8, ticks=ticks)
    return figure


def caption_von_mises(validation: Datasets) -> Iterator[str]:
    """Maximum stress under the paraboloid, by Fourier series and in closed form."""
    data = validation["punch"]
    scale, radius = data["maximum_pressure"], data["contact_radius"]
    for nu in data["poisson"].values:
        one = data.sel(poisson=nu)
        largest, depth = one["von_mises_spectral"].max() / scale, one["peak_depth_closed_form"] / radius
        yield (
            f"ν = {nu:g}: maximum von Mises stress {float(largest):.4f} p₀ in the periodic cell, "
            f"{float(one['peak_von_mises_closed_form'] / scale):.4f} p₀ for a single contact, at a depth of "
            f"{float(depth):.3f} a"
        )
