"""Peaks of the stress: magnitude and depth of every one."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.core.types import Array
from asperity.stress.peaks.selection import SAME_RATIO, select_peaks
from asperity.views.panels import canvas, finish_title
from asperity.views.scales import Measure, measure, robust_limits
from asperity.views.source import require_same_system, title_of, titled
from asperity.views.stress_plot import field_name

LARGE_PEAK = 0.5
"""Peaks of at least this part of the largest magnitude set the depth that is shown."""

SHAPE = 0.8
"""Height of a panel over its width."""

AXIS_DEPTH = 1.3
"""Depth of the axis over the depth of the deepest peaks; the rest is for the legend."""

MOST_BINS = 200
"""Most bins of a histogram."""

TICKS = 5
"""Most intervals between ticks of magnitude, whose numbers may be long."""


def plot_peaks(
    stress: Any,
    quantity: str = "von_mises",
    poisson: float | None = None,
    *,
    axes: Axes | Sequence[Axes] | None = None,
    yield_stress: float | tuple[Array, Array] | None = None,
    unit_system: str | None = None,
) -> Figure:
    """Magnitude and depth of the stress peaks, each a point; peaks under a contact have another colour.

    The line is the maximum von Mises stress of each plane. Peaks that all lie in the surface, such as those
    of the contact pressure, are drawn as a histogram.

    Parameters
    ----------
    stress : dataset, sequence of them, or mapping from titles to them
        Results of stage stress; several are drawn beside each other on the same axes.
    quantity : str
        One of the analysed quantities.
    poisson : float, optional
        One of the analysed Poisson's ratios, by default the ratio of the contact.
    axes : Axes or sequence of Axes, optional
        Where to draw, one for each result; by default in a new figure.
    yield_stress : float or (depths, stresses), optional
        It is marked, and the depth down to which it is reached is shown; under a coating it depends on depth.
    unit_system : "SI", optional
        Of results that do not say theirs, such as the stress under a `Contact`.

    Returns
    -------
    figure : matplotlib Figure
        The axes leave single outliers out; the panel says how many, and their extreme.

    Raises
    ------
    ValueError, TypeError
        If a result is of another stage, or lacks the quantity or the ratio.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> stress = asp.analyse_stress(contact, quantities=("von_mises",))
    >>> figure = asp.views.plot_peaks(stress, "von_mises")
    >>> len(figure.axes)
    1
    """
    given = titled(stress)
    for _, data in given:
        if not (isinstance(data, xr.Dataset) and "peak_value" in data):
            raise TypeError("stress: a result of stage stress, with its peaks, is needed")
    systems = [data.attrs.get("unit_system", unit_system) for _, data in given]
    require_same_system(systems)
    system = systems[0]
    found = [_peaks(data, quantity, poisson) for _, data in given]
    sizes = [np.abs(data["peak_value"].values) for data, _ in found]
    depths = [data["peak_depth"].values for data, _ in found]
    limits = robust_limits(sizes, 0.0)
    # Small peaks lie at the surface around the contacts, and far below them: large ones set the depth shown.
    large = [
        depth[size >= LARGE_PEAK * size.max(initial=0.0)] for depth, size in zip(depths, sizes, strict=True)
    ]
    deepest = robust_limits(large if any(depth.any() for depth in large) else depths, 0.0).high
    for _, profile in found:
        if yield_stress is not None and profile is not None:
            limit = np.interp(profile[0], *yield_stress) if isinstance(yield_stress, tuple) else yield_stress
            deepest = profile[0][profile[1] > limit].max(initial=deepest)
    unit = measure(limits.high, "stress", system)
    length = measure(deepest, "length", system)
    in_surface = not any(depth.any() for depth in depths)
    with canvas([SHAPE] * len(given), axes) as (figure, panels, _):
        for axis, (title, result), (data, profile) in zip(panels, given, found, strict=True):
            values = np.abs(data["peak_value"].values)
            if in_surface:
                shown, high = values[values <= limits.high] / unit.factor, limits.high / unit.factor
                axis.hist(shown, bins=_number_of_bins(shown, high), range=(0, high), color="C0")
                axis.set(xlim=(0, high), ylabel="number of peaks")
                axis.locator_params(axis="y", integer=True)
            else:
                line: dict[str, Any] = {"color": "C3", "lw": 0.8, "label": "yield stress"}
                if isinstance(yield_stress, tuple):
                    axis.plot(yield_stress[1] / unit.factor, yield_stress[0] / length.factor, **line)
                elif yield_stress is not None:
                    axis.axvline(yield_stress / unit.factor, **line)
                _draw_points(axis, data, profile, (limits.high, deepest), unit, length)
            axis.locator_params(axis="x", nbins=TICKS)
            axis.set_xlabel(unit.label(f"magnitude of peaks of {field_name(quantity)}"))
            finish_title(axis, title_of(result) if title is None else title, limits.beyond(values, unit))
    return figure


def _number_of_bins(values: Array, high: float) -> int:
    """Number of bins from 0 to `high` by the rule of Freedman and Diaconis, at least as many as by Sturges's.

    D. Freedman and P. Diaconis, Z. Wahrscheinlichkeitstheorie 57 (1981) 453, doi 10.1007/BF01025868. Equal
    values, for which the rule is undefined, get `MOST_BINS`.
    """
    least = math.ceil(math.log2(max(values.size, 1))) + 1
    quartiles = np.quantile(values, [0.25, 0.75]) if values.size else [0.0, high]
    width = 2 * float(quartiles[1] - quartiles[0]) / float(np.cbrt(max(values.size, 1)))
    return max(least, MOST_BINS if MOST_BINS * width <= high else math.ceil(high / width))


def _peaks(
    stress: xr.Dataset, quantity: str, poisson: float | None
) -> tuple[xr.Dataset, tuple[Array, Array] | None]:
    """Peaks of a quantity, and for the von Mises stress its largest value over depth."""
    if poisson is None:
        own = stress.attrs.get("poisson_contact")
        if own in stress["poisson"].values:
            poisson = own
    found = select_peaks(stress, quantity, poisson)
    if quantity != "von_mises":
        return found, None
    ratio = float(found["poisson"])
    profile = stress["maximum_von_mises"].sel(poisson=ratio, method="nearest", tolerance=SAME_RATIO)
    return found, (stress["plane_depth"].values, profile.values)


def _draw_points(
    axis: Axes,
    data: xr.Dataset,
    profile: tuple[Array, Array] | None,
    shown: tuple[float, float],
    unit: Measure,
    length: Measure,
) -> None:
    """Draw peaks and the profile on axes up to the magnitude and depth that are shown."""
    under = data["peak_under_contact"].values.astype(bool)
    values, depth = np.abs(data["peak_value"].values) / unit.factor, data["peak_depth"].values / length.factor
    for chosen, colour, name in ((~under, "C4", "elsewhere"), (under, "C0", "under a contact")):
        axis.plot(
            values[chosen],
            depth[chosen],
            ls="none",
            marker="o",
            ms=2 if values.size < 5000 else 1,
            mew=0,
            alpha=0.6,
            color=colour,
            label=f"{np.count_nonzero(chosen)} {name}",
            rasterized=values.size > 2000,
        )
    if profile is not None:
        axis.plot(
            profile[1] / unit.factor, profile[0] / length.factor, color="C1", label="maximum of each plane"
        )
    axis.set(
        xlim=(0, 1.03 * shown[0] / unit.factor),
        ylim=(AXIS_DEPTH * shown[1] / length.factor, 0),
        ylabel=length.label("depth"),
    )
    # The frame hides the line of the profile behind the words.
    axis.legend(loc="lower right", markerscale=3, frameon=True, framealpha=0.9, edgecolor="none")
