"""Rough surfaces: spectra, distributions of heights, cross-sections, and the pressure on them."""

from collections.abc import Iterator, Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import ScalarFormatter

from asperity.paper.figures.cases import (
    Datasets,
    contact_area,
    curve_with_band,
    distinct,
    name,
    title_panel,
    with_band,
)
from asperity.results.dataset import grid_of
from asperity.views.scales import blocks
from asperity.views.style import COLUMN, PAGE, label, panels

SMALLEST_POWER = 1e-8
"""Smallest spectral density drawn, over the largest: below are rounding errors."""

OFFSET = 7.0
"""Distance between the sections of several surfaces in one panel, in rms heights."""

ZOOM = 0.125
"""Edge of the magnified part of a map of pressure, over the edge of the cell."""

ALIKE = 0.1
"""Largest difference of densities, over the largest density, up to which curves coincide."""

PIXELS = 512
"""Smallest number of pixels along an edge of a map, where the grid has as many nodes."""

WIDEST = 4.0
"""Largest ratio of the upper end of the colours to the maximum pressure of the surface with the smallest
pressures: otherwise a surface with spikes would make the others pale."""


def draw_spectrum(surface: Datasets) -> Figure:
    """Draw the radially averaged spectrum of one seed over the number of waves in a cell length.

    A thin line is the expected spectrum of a random surface before its heights are transformed.
    """
    figure, (axis,) = panels(columns=1, width=COLUMN)
    surface = distinct(surface)
    largest = max(float(data["spectrum"].max()) for data in surface.values())
    for number, data in enumerate(surface.values()):
        waves = data["wavenumber"] / (2 * np.pi)
        power = data["spectrum"].where(data["spectrum"] > SMALLEST_POWER * largest)
        axis.loglog(waves, power, ".", ms=3, color=f"C{number}", label=label(data))
        if "spectrum_target" in data:
            target = data["spectrum_target"]
            axis.loglog(waves, target.where(target > 0), lw=0.7, color=f"C{number}")
    axis.set_xscale("log", base=2)
    axis.xaxis.set_major_formatter(ScalarFormatter())
    axis.set(xlabel=r"waves in a cell length, $L / \lambda$", ylabel=r"spectral density $/ L^4$")
    axis.legend()
    return figure


def caption_spectrum(surface: Datasets) -> Iterator[str]:
    """Root-mean-square height and gradient of each surface."""
    for data in distinct(surface).values():
        height, gradient = float(data["rms_height"]), float(data["rms_gradient"])
        yield f"{name(label(data))}: rms height {height:.4g} L, rms gradient {gradient:.4g}"


def draw_heights(surface: Datasets, statistics: Datasets) -> Figure:
    """Draw the density of the heights of all seeds, and the section y = L/2 of one."""
    figure, (heights, section) = panels()
    surface, statistics = distinct(surface), distinct(statistics)
    _draw_densities(heights, statistics, [label(data) for data in statistics.values()])
    heights.legend()
    _draw_sections(section, surface, OFFSET if len(surface) > 1 else 0.0, lw=0.6)
    section.set(ylabel=r"$h / h_\mathrm{rms}$")
    if len(surface) > 1:
        section.set(ylabel=r"$h / h_\mathrm{rms}$, shifted", yticks=[])
    return figure


def caption_heights(surface: Datasets, statistics: Datasets) -> Iterator[str]:
    """Skewness and kurtosis of each surface, means over seeds."""
    for key, data in distinct(statistics).items():
        one = distinct(surface)[key]
        skewness, kurtosis = (_mean(data[f"seed_{moment}"]) for moment in ("skewness", "kurtosis"))
        text = f"{name(label(one))}: skewness {skewness}, kurtosis {kurtosis}"
        if "kurtosis_error" in one:
            text += (
                f" (standard errors of one Gaussian sample of this spectrum: "
                f"{float(one['skewness_error']):.3f} and {float(one['kurtosis_error']):.3f})"
            )
        yield text


def draw_studies(surface: Mapping[str, Datasets], statistics: Mapping[str, Datasets]) -> Figure:
    """Draw the heights as `draw_heights` does, a column of panels for ``skewness`` and ``kurtosis`` each."""
    figure, axes = panels(columns=len(statistics), rows=2, height=58)
    for study, heights, section in zip(statistics, axes, axes[len(statistics) :], strict=False):
        moment = "skewness" if study == "skewness" else "kurtosis"
        titles = [
            f"{label(data)}\n{moment} " + f"{float(data[f'seed_{moment}'].mean()):.2f}".replace("-", "−")
            for data in statistics[study].values()
        ]
        _draw_densities(heights, statistics[study], titles)
        heights.legend(fontsize=6)
        heights.set_ylim(top=1.05 * heights.get_ylim()[1])
        _draw_sections(section, surface[study], OFFSET, lw=0.5)
        section.set(ylabel=r"$h / h_\mathrm{rms}$, shifted", yticks=[])
    return figure


def caption_studies(surface: Mapping[str, Datasets], statistics: Mapping[str, Datasets]) -> Iterator[str]:
    """Moments of each surface, and the change of the kurtosis with the short waves."""
    for study in statistics:
        yield from caption_heights(surface[study], statistics[study])
    kurtosis = [float(data["seed_kurtosis"].mean()) for data in statistics["kurtosis"].values()]
    gaussian = [data for data in surface["kurtosis"].values() if "kurtosis_error" in data]
    errors = [float(data["kurtosis_error"]) for data in gaussian]
    change, scatter = max(kurtosis) - min(kurtosis), max(errors, default=float("nan"))
    compared = "less" if change < scatter else "not less"
    yield (
        f"From one shortest wavelength to another the kurtosis changes by {change:.3f}, {compared} than the "
        f"standard error of one sample ({scatter:.3f}): a Gaussian surface has a kurtosis of 3 "
        f"whatever its shortest wavelength."
    )


def draw_pressure(contact: Datasets) -> Figure:
    """Draw the pressure over E* times the rms gradient of the real contact; white where there is no contact.

    A second row magnifies the part of the cell around the maximum pressure of the first surface.

    Notes
    -----
    A pixel shows the maximum pressure of the nodes under it, so that the smallest contacts are seen.
    """
    maps = []
    for data in contact.values():
        size = max(1, data.sizes["y"] // PIXELS)
        largest_of_blocks = blocks(data["pressure"].values, (size, size), np.max)
        maps.append(largest_of_blocks / float(data["gradient_rms_contact"]))
    width = PAGE if len(maps) > 1 else COLUMN
    figure, axes = panels(columns=len(maps), rows=2, height=min(76.0, 25.4 * width / len(maps)), width=width)
    first = next(iter(contact.values()))["pressure"]
    place = np.unravel_index(np.argmax(first.values), first.shape)
    middle = np.divide(place, first.shape)
    corner = np.clip(middle - ZOOM / 2, 0.0, 1 - ZOOM).tolist()
    ends = [np.percentile(values[values > 0], 99.5) for values in maps]
    largest = min(max(ends), WIDEST * min(ends))
    for axis, near, data, values in zip(axes, axes[len(maps) :], contact.values(), maps, strict=False):
        height, width = grid_of(data).length
        nodes = data["pressure"].values / float(data["gradient_rms_contact"])
        for each, field in ((axis, values), (near, nodes)):
            shown, extent = np.ma.masked_equal(field, 0), (0, width, 0, height)
            image = each.imshow(shown, "viridis_r", origin="lower", extent=extent, vmin=0, vmax=largest)
            each.set(xlabel="$x / L$", ylabel="$y / L$")
            each.spines[["top", "right"]].set_visible(True)
        (bottom, left), (tall, wide) = (corner[0] * height, corner[1] * width), (ZOOM * height, ZOOM * width)
        near.set(xlim=(left, left + wide), ylim=(bottom, bottom + tall))
        axis.indicate_inset((left, bottom, wide, tall), edgecolor="k", alpha=1, lw=0.6)
        title_panel(axis, label(data))
    figure.colorbar(image, ax=axes, label=r"$t_3 / E^* \bar{g}_r$", extend="max", shrink=0.8)
    return figure


def caption_pressure(contact: Datasets) -> Iterator[str]:
    """Area in contact and load of each surface."""
    return map(contact_area, contact.values())


def _draw_densities(axis: Axes, statistics: Datasets, titles: list[str]) -> None:
    """Draw the probability density of the heights over their rms, all seeds, a curve for each surface.

    Each curve is thinner than the one before and has other dashes, so that coinciding ones are all seen.
    """
    looks = zip((2.4, 1.6, 1.2, 1.0), ("-", "--", ":", "-."), strict=True)
    densities = [data["height_density"].values for data in statistics.values()]
    for title, data, (width, dashes) in zip(titles, statistics.values(), looks, strict=False):
        edges = data["height_edge"].values
        middles = (edges[1:] + edges[:-1]) / 2
        band = with_band(data, "height_density")
        curve_with_band(axis, middles, *band, label=title, lw=width, ls=dashes)
    apart = np.ptp(densities, axis=0).max() / np.max(densities)
    if len(densities) > 1 and apart < ALIKE:
        text = f"curves coincide\nwithin {100 * apart:.0f} %\nof the largest"
        axis.text(0.02, 0.98, text, va="top", fontsize=6, transform=axis.transAxes)
    axis.set(xlabel=r"$h / h_\mathrm{rms}$", ylabel="probability density", xlim=(-4.5, 4.5), ylim=(0, None))


def _draw_sections(axis: Axes, surface: Datasets, offset: float, lw: float) -> None:
    """Draw the section y = L/2 of each surface, each lower than the one before."""
    for number, data in enumerate(surface.values()):
        profile = data["height"].isel(y=data.sizes["y"] // 2) / data["rms_height"]
        axis.plot(data["x"], profile - offset * number, lw=lw, label=label(data))
        if offset:
            axis.axhline(-offset * number, color="k", lw=0.3)
    longest = max(grid_of(data).length[1] for data in surface.values())
    axis.set(xlabel="$x / L$", xlim=(0, longest))


def _mean(seeds: xr.DataArray) -> str:
    """Mean over seeds, with its standard error if there are several."""
    values = np.asarray(seeds, dtype=float)
    if values.size == 1:
        return f"{values[0]:.3f}"
    return f"{values.mean():.3f} ± {values.std(ddof=1) / np.sqrt(values.size):.3f} ({values.size} samples)"
