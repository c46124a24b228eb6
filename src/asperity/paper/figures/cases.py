"""Cases that figures compare: surfaces at one Poisson's ratio, their densities of peaks, and captions."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from asperity.core.types import Array, ArrayLike
from asperity.results.dataset import settings_of
from asperity.stress.peaks.selection import selection_for
from asperity.views.style import label, wavelength_short

Datasets = Mapping[str, xr.Dataset]
"""Surface or name → dataset."""

SHEAR_STRESSES = ("xz", "yz", "xy")
"""Quantities as often positive as negative, of which the magnitude is shown."""

SMALLEST_DENSITY = 2e-3
"""Lower end of the axis of a density, over the largest density."""

LARGEST_OVER_MEDIAN = 10.0
"""Largest value of a peak drawn, over the largest median of the cases. Spikes of a measured map have peaks
far above it, which would flatten all curves; peaks of random surfaces are below 6."""


@dataclass(frozen=True)
class FigureCase:
    """A curve or a panel: statistics of one surface at one Poisson's ratio.

    Parameters
    ----------
    title : str
        Name of the case in the figure, mathematics between dollar signs.
    statistics : dataset
        Result of stage statistics, at one Poisson's ratio.
    """

    title: str
    statistics: xr.Dataset

    @property
    def name(self) -> str:
        """The title with its mathematics as reStructuredText has it."""
        return name(self.title)

    @property
    def wavelength_short(self) -> float:
        """Shortest wavelength of the surface, the unit of depths and distances."""
        return wavelength_short(self.statistics)

    def peaks(self, quantity: str) -> xr.Dataset:
        """Statistics of the peaks of a quantity that figures and claims count."""
        return self.statistics.sel(quantity=quantity, selection=selection_for(quantity))

    def peak_percentiles(self, quantity: str) -> str:
        """Number of the peaks of a quantity and percentiles of their magnitude, with their bands."""
        peaks = self.peaks(quantity)
        parts = []
        for percent in (50.0, 99.0):
            one = peaks.sel(percent=percent)
            if np.isnan(one["peak_percentile"]):
                continue
            text = f"{float(one['peak_percentile']):.3f}"
            if np.isfinite(one["peak_percentile_low"]):
                low, high = (float(one[f"peak_percentile_{end}"]) for end in ("low", "high"))
                text += f" [{low:.3f}, {high:.3f}]"
            parts.append(f"{text} E\\* ḡ_r at the {percent:g}th percentile")
        return f"{int(peaks['peak_counts'].sum())} peaks, {', '.join(parts)}"


def of_surfaces(statistics: Datasets) -> list[FigureCase]:
    """A case for each surface, at the Poisson's ratio of its contact."""
    own = {name: data.sel(poisson=data.attrs["poisson_contact"]) for name, data in statistics.items()}
    return [FigureCase(label(statistics[name]), data) for name, data in own.items()]


def of_ratios(statistics: Datasets) -> list[FigureCase]:
    """A case for each Poisson's ratio of a single surface."""
    (data,) = statistics.values()
    return [FigureCase(rf"$\nu = {ratio:g}$", data.sel(poisson=ratio)) for ratio in data["poisson"].values]


def extreme_ratios(statistics: Datasets) -> list[FigureCase]:
    """The cases of the largest and of the smallest Poisson's ratio of a single surface."""
    cases = sorted(of_ratios(statistics), key=lambda case: float(case.statistics["poisson"]), reverse=True)
    return [cases[0], cases[-1]] if len(cases) > 1 else cases


def shortest_waves(statistics: Datasets) -> list[FigureCase]:
    """The cases of the two surfaces with the shortest waves, the shorter one last."""
    return sorted(of_surfaces(statistics), key=lambda case: case.wavelength_short)[:2][::-1]


CASES = {
    "surfaces": of_surfaces,
    "ratios": of_ratios,
    "extreme ratios": extreme_ratios,
    "shortest waves": shortest_waves,
}
"""Option ``cases`` of a figure → the cases that it shows."""


def distinct(results: Datasets) -> dict[str, xr.Dataset]:
    """Results of different surfaces: one of those that differ in the load alone, with their common label."""
    found: dict[str, xr.Dataset] = {}
    kinds: list[Any] = []
    for key, data in results.items():
        surface = settings_of(data).get("surface", key)
        if surface not in kinds:
            kinds.append(surface)
            found[key] = data
            continue
        first = list(found)[kinds.index(surface)]
        found[first] = found[first].assign_attrs(label=label(results[first]).rpartition(", ")[0])
    return found


def settings_in_words(results: Any, several_ratios: bool) -> str:
    """Hurst exponents, Poisson's ratios, areas and seeds of all results of a figure, in one line.

    Parameters
    ----------
    results : mapping
        Tree of datasets.
    several_ratios : bool
        The figure shows all Poisson's ratios of its results, not only the ratios of the contacts.
    """
    leaves, found = [results], dict[str, set[Any]]()
    while leaves:
        one = leaves.pop()
        if not isinstance(one, xr.Dataset):
            leaves += one.values()
            continue
        settings = settings_of(one)
        surface = settings.get("surface", {})
        ratios = one["poisson"].values.ravel() if "poisson" in one.coords else one.attrs.get("poisson", ())
        if "poisson_contact" in one.attrs and not several_ratios:
            ratios = one.attrs["poisson_contact"]
        areas = [
            one[key].mean()
            for key in ("contact_area_fraction", "seed_contact_area_fraction")
            if key in one and surface
        ]
        for key, values in {
            "H = ": [surface["hurst"]] if "hurst" in surface else [],
            "": ["measured map"] if "file" in surface else [],
            "ν = ": np.ravel(ratios).tolist(),
            "area ": [float(f"{100 * float(area):.2g}") for area in areas],
            "seeds ": np.ravel(settings.get("seed", ())).tolist() if "hurst" in surface else [],
        }.items():
            found.setdefault(key, set()).update(values)
    texts = []
    for key, values in found.items():
        listed = sorted(values, key=lambda value: (isinstance(value, str), value))
        words = [value if isinstance(value, str) else f"{value:g}" for value in listed]
        if key == "seeds " and len(listed) > 2 and listed == list(range(listed[0], listed[-1] + 1)):
            words = [f"{words[0]}–{words[-1]}"]
        if words:
            texts.append(key + ", ".join(words) + (" %" if key == "area " else ""))
    return "; ".join(texts)


def name(title: str) -> str:
    """A title with its mathematics as reStructuredText has it."""
    return re.sub(r"\$(.*?)\$", r":math:`\1`", title)


def contact_area(data: xr.Dataset) -> str:
    """Area in contact, load, and rms gradient of a surface."""
    gradient = float(data["gradient_rms_contact"])
    return (
        f"{name(label(data))}: {100 * float(data['contact_area_fraction']):.2f} % of the area in contact at "
        f"a mean pressure of {float(data['mean_pressure']) / gradient:.4f} E\\* ḡ_r, ḡ_r = {gradient:.4f}"
    )


def title_panel(axis: Axes, title: str) -> None:
    """Write a title over a panel; a title of several parts has a line for each, above the panel's letter."""
    axis.set_title(title.replace(", ", ",\n") + "\n" if ", " in title else title, loc="center")


def von_mises_densities(axis: Axes, cases: Sequence[FigureCase]) -> None:
    """Draw the probability density of the von Mises peaks, one curve for each case."""
    for case in cases:
        peak_density(axis, case, "von_mises", label=case.title)
    finish_densities(axis, r"\sigma_\mathrm{VM}")


def peak_density(axis: Axes, case: FigureCase, quantity: str, compression: bool = False, **look: Any) -> None:
    """Draw the probability density of the peaks of a quantity; of a shear stress, of its magnitude.

    With `compression`, compressive stresses are drawn to the right.
    """
    peaks = case.peaks(quantity)
    edges = peaks["bin_edge"].values
    curves = with_band(peaks, "peak_density")
    if quantity in SHEAR_STRESSES:
        folded = np.linspace(0, np.abs(edges).max(), edges.size)
        curves = [folded_density(curve, edges, folded) for curve in curves]
        edges = folded
    sign = -1 if compression else 1
    curve_with_band(axis, sign * (edges[1:] + edges[:-1]) / 2, *curves, **look)


def folded_density(values: Array, edges: Array, folded_edges: Array) -> Array:
    """Density of a magnitude, from the density of the signed quantity, constant in each bin."""
    below = np.concatenate([[0.0], np.cumsum(values * np.diff(edges))])
    share = np.interp(folded_edges, edges, below) - np.interp(-folded_edges, edges, below)
    return np.diff(share) / np.diff(folded_edges)


def finish_densities(axis: Axes, symbol: str) -> None:
    """Label the axes of densities of scaled peaks, limit them to what can be seen, and add the legend.

    If peaks lie beyond the axis (`LARGEST_OVER_MEDIAN`), the legend says which share of them.
    """
    scaled = rf"{symbol}^\mathrm{{lmax}} / E^* \bar{{g}}_r"
    lines = [(np.asarray(line.get_xdata()), np.asarray(line.get_ydata())) for line in axis.lines]
    visible = SMALLEST_DENSITY * max(float(y.max()) for _, y in lines)
    limit = LARGEST_OVER_MEDIAN * max(median(x, y) for x, y in lines)
    largest = max(float(x[(y > visible) & (x <= limit)].max(initial=0.0)) for x, y in lines)
    axis.set(xlabel=f"${scaled}$", ylabel=rf"PDF$\,[{scaled}]$", xlim=(0, 1.02 * largest), ylim=(0, None))
    if len(lines) > 2:  # room for the legend above the curves
        axis.set_ylim(top=1.4 * axis.get_ylim()[1])
    beyond = max(float(y[x > 1.02 * largest].sum() / max(y.sum(), 1e-300)) for x, y in lines)
    spikes = any(np.any((y > visible) & (x > limit)) for x, y in lines)
    axis.legend(title=f"{100 * beyond:.2g} % beyond the axis" if spikes else None)


def median(values: Array, weights: Array) -> float:
    """Median of the positive values, each with its weight; zero if there are none."""
    positive = values > 0
    if not weights[positive].sum() > 0:
        return 0.0
    return float(np.quantile(values[positive], 0.5, weights=weights[positive], method="inverted_cdf"))


def with_band(data: xr.Dataset, variable: str) -> list[Array]:
    """Values of a variable, and the lower and the upper end of its confidence band."""
    return [data[f"{variable}{end}"].values for end in ("", "_low", "_high")]


def curve_with_band(axis: Axes, x: ArrayLike, values: Array, low: Array, high: Array, **look: Any) -> None:
    """Draw a curve, and its confidence band if it has one."""
    line = axis.plot(x, values, **look)[0]
    if np.isfinite(low).all():
        axis.fill_between(np.asarray(x), low, high, color=line.get_color(), alpha=0.25, lw=0)
