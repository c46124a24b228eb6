"""Captions of the figures: what is seen, in reStructuredText, with numbers taken from the same data.

`caption` begins with the first line of the figure's module and goes on with what `FIGURES` names for it,
if anything.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np
import xarray as xr

from asperity.paper.figures.style import label, wavelength_short
from asperity.stress.selection import selection_for
from asperity.stress.statistics import PERCENTS
from asperity.types import Array

Results = Mapping[str, xr.Dataset]


def caption(figure: str, stages: Mapping[str, Any]) -> str:
    """Caption of a figure, given what it is drawn from: stage → (study →) surface → dataset."""
    module = import_module(f"asperity.paper.figures.{figure}")
    assert module.__doc__ is not None
    title = module.__doc__.splitlines()[0]
    describe = FIGURES.get(figure)
    return "\n\n".join([title, *(describe(**stages) if describe else [])]) + "\n"


def rounding(validation: Results) -> list[str]:
    """Largest error of the library's formulas in both precisions."""
    error = validation["stability"]["error"].sel(formula="layer")
    return _bullets(
        f"largest error of this library in {precision}: {float(error.sel(precision=precision).max()):.1e}"
        for precision in map(str, error["precision"].values)
    )


def extremes(validation: Results) -> list[str]:
    """How many contacts ended how, and how many values out of range were refused."""
    from asperity.validation.extremes import NO_CELL, OUTCOMES, REFUSED

    data = validation["extremes"]
    outcome = data["outcome"].values
    found = outcome[np.tril(np.ones(outcome.shape, bool)) & (outcome != NO_CELL)]
    refused, beyond = data["beyond_outcome"].values == REFUSED, data.sizes["beyond"]
    double, single = (data.attrs[f"tolerance_{precision}"] for precision in ("float64", "float32"))
    text = (
        "Each level alone (diagonal) and with each level of every other setting; in bold the scene that they "
        "change. :math:`q_0 = 2\\pi/L`; loads are relative to the one that closes the last gap, approaches "
        "to the way from the lowest to the mean height. Solved to tolerances of "
        f"{double:g} (double precision) and {single:g} (single)."
    )
    counts = [
        f"{name}: {int(np.sum(found == number))}" for number, name in enumerate(OUTCOMES) if number != NO_CELL
    ]
    return [
        text,
        *_bullets([*counts, f"values out of range refused by name: {int(refused.sum())} of {beyond}"]),
    ]


def cell(validation: Results) -> list[str]:
    """Size of what is drawn."""
    data = validation["elements"]
    return [
        f"A paraboloid of radius {data.attrs['curvature_radius']:g} L pressed by "
        f"{data.attrs['approach']:.3g} L into a slab; "
        f"contact radius {float(data['contact_radius']):.3f} L. Displacements are magnified."
    ]


def hertz(validation: Results) -> list[str]:
    """Errors of the contact against closed forms, and stiffening of slabs."""
    data, slabs = validation["load_area"], validation["slab_load_area"]
    error = np.abs(data["solved_contact_radius"] / data["hertz_contact_radius"] - 1)
    return _bullets(
        [
            f"contact radius at given load within {100 * float(error.max()):.2f} % of the closed form, "
            f"for Poisson's ratios {', '.join(f'{nu:g}' for nu in data['poisson'].values)} on "
            f"{data.attrs['grid_points']} nodes an edge",
            *(
                f"a bonded slab of height {float(tall):g} L carries {float(load):.3f} times the load of a "
                f"half-space at the deepest indentation"
                for tall, load in zip(slabs["slab_height"], slabs["slab_stiffening"][:, -1], strict=True)
            ),
        ]
    )


def elements(names: tuple[str, ...], validation: Results) -> list[str]:
    """Differences of fields to the finite elements."""
    from asperity.validation.finite_elements import largest_differences

    found = largest_differences(validation["elements"])
    return _bullets(
        f"{name}: at most {100 * float(found['difference_away'].sel(field=name)):.3f} % of its largest "
        f"magnitude away from the edge of contact, "
        f"{100 * float(found['difference_edge'].sel(field=name)):.2f} % at it"
        for name in names
    )


def punch(validation: Results) -> list[str]:
    """Largest stress under the paraboloid, by Fourier series and in closed form."""
    data = validation["punch"]
    scale, radius = data["largest_pressure"], data["contact_radius"]
    rows = []
    for nu in data["poisson"].values:
        one = data.sel(poisson=nu)
        largest, depth = one["von_mises_spectral"].max() / scale, one["peak_depth_closed_form"] / radius
        rows.append(
            f"ν = {nu:g}: largest von Mises stress {float(largest):.4f} p₀ in the periodic cell, "
            f"{float(one['peak_von_mises_closed_form'] / scale):.4f} p₀ for a single contact, at a depth of "
            f"{float(depth):.3f} a"
        )
    return _bullets(rows)


def indented(surface: Results, contact: Results) -> list[str]:
    """What the drawn surface is, and how far it touches."""
    name = list(surface)[-1]
    return [f"Drawn: {_named(surface[name])}.", *traction({name: contact[name]})]


def heights(surface: Results, statistics: Results) -> list[str]:
    """Moments of each surface, all seeds."""
    return _bullets(
        f"{_named(surface[name])}: skewness {_spread(data['member_skewness'])}, "
        f"kurtosis {_spread(data['member_kurtosis'])}{_error(surface[name])}"
        for name, data in statistics.items()
    )


def traction(contact: Results) -> list[str]:
    """How much touches under which load."""
    return _bullets(
        f"{_named(data)}: {100 * float(data['area_fraction']):.2f} % of the area in contact at a mean "
        f"pressure of {float(data['mean_pressure'] / data['gradient_rms_contact']):.4f} E\\* ḡ_r, "
        f"ḡ_r = {float(data['gradient_rms_contact']):.4f}"
        for data in contact.values()
    )


def load_area(contact: Results, statistics: Results) -> list[str]:
    """Proportionality of area and load, and the pressure peaks."""
    lines = []
    for name, data in contact.items():
        kappa = data["path_area_fraction"] * data["path_gradient_rms_contact"] / data["path_mean_pressure"]
        lines.append(
            f"{_named(data)}: area fraction over scaled load from {float(kappa[0]):.3f} to "
            f"{float(kappa[-1]):.3f} "
            f"(Persson 1.596, Bush, Gibson and Thomas 2.507, at small load); "
            f"{_peaks(statistics[name], 'pressure', statistics[name].attrs['poisson_contact'])}"
        )
    return _bullets(lines)


def peaks(statistics: Results) -> list[str]:
    """Percentiles of the von Mises stress and two components, surface by surface."""
    return _bullets(
        f"{_named(data)}, {symbol}: {_peaks(data, quantity, data.attrs['poisson_contact'])}"
        for data in statistics.values()
        for quantity, symbol in (("von_mises", "σ_VM"), ("xx", "\\|σ_xx\\|"), ("xz", "\\|σ_xz\\|"))
    )


def depths(statistics: Results) -> list[str]:
    """Where the peaks are, surface by surface."""
    return _bullets(
        f"{_named(data)}: {_depth(data, data.attrs['poisson_contact'], wavelength_short(data), 'λ_s')}"
        for data in statistics.values()
    )


def decay(statistics: Results) -> list[str]:
    """Depth and distance at which the covariance has halved, surface by surface."""
    return _bullets(
        f"{_named(data)}: {_halves(data, data.attrs['poisson_contact'])}" for data in statistics.values()
    )


def ratios_peaks(statistics: Results) -> list[str]:
    """Percentiles for each Poisson's ratio, and the ratio of the extremes."""
    (data,) = statistics.values()
    lines = [
        f"ν = {nu:g}, σ_VM: {_peaks(data, 'von_mises', nu)}; \\|σ_xx\\|: {_peaks(data, 'xx', nu)}"
        for nu in data["poisson"].values
    ]
    low, high = float(data["poisson"].min()), float(data["poisson"].max())
    percentiles = data["peak_percentile"].sel(quantity="von_mises", selection=selection_for("von_mises"))
    factor = percentiles.sel(poisson=low) / percentiles.sel(poisson=high)
    values = ", ".join(
        f"{float(value):.2f} at the {p:g}th percentile" for p, value in zip(PERCENTS, factor, strict=True)
    )
    lines.append(f"von Mises peaks at ν = {low:g} over those at ν = {high:g}: {values}")
    return _bullets(lines)


def ratios_depths(statistics: Results) -> list[str]:
    """Where the peaks are, for the extreme Poisson's ratios."""
    (data,) = statistics.values()
    return _bullets(
        f"ν = {nu:g}: {_depth(data, nu, wavelength_short(data), 'λ_s')}"
        for nu in (float(data["poisson"].max()), float(data["poisson"].min()))
    )


def ratios_decay(statistics: Results) -> list[str]:
    """Decay for each Poisson's ratio."""
    (data,) = statistics.values()
    return _bullets(f"ν = {nu:g}: {_halves(data, nu)}" for nu in data["poisson"].values)


def two_heights(surface: Mapping[str, Results], statistics: Mapping[str, Results]) -> list[str]:
    """Moments of the skewed surfaces and of those with other cut-offs."""
    kurtosis = [float(data["member_kurtosis"].mean()) for data in statistics["kurtosis"].values()]
    errors = [
        float(data["kurtosis_error"]) for data in surface["kurtosis"].values() if "kurtosis_error" in data
    ]
    change = max(kurtosis) - min(kurtosis)
    scatter = max(errors, default=float("nan"))
    comparison = "less" if change < scatter else "not less"
    return [
        *heights(surface["skewness"], statistics["skewness"]),
        *heights(surface["kurtosis"], statistics["kurtosis"]),
        f"From one shortest wavelength to another the kurtosis changes by {change:.3f}, {comparison} than "
        f"one sample scatters ({scatter:.3f}): a Gaussian surface has a kurtosis of 3 whatever its waves.",
    ]


def two_peaks(statistics: Mapping[str, Results]) -> list[str]:
    """Percentiles scaled and not scaled by the gradient, and the gradients that make the difference."""
    return _bullets(
        f"{_named(data)}: {_peaks(data, 'von_mises', data.attrs['poisson_contact'])}; {_gradients(data)}"
        for study in ("skewness", "kurtosis")
        for data in statistics[study].values()
    )


def common_depths(statistics: Results) -> list[str]:
    """Where the peaks are, in one unit of depth."""
    chosen = sorted(statistics.values(), key=wavelength_short)[:2][::-1]
    unit = wavelength_short(chosen[0])
    return _bullets(
        f"{_named(data)}: {_depth(data, data.attrs['poisson_contact'], unit, 'λ_sn')}" for data in chosen
    )


FIGURES: dict[str, Callable[..., list[str]]] = {
    "fig01": cell,
    "fig02": hertz,
    "fig03": partial(elements, ("displacement_z", "stress_zz")),
    "fig04": partial(elements, ("stress_xx", "stress_xz")),
    "fig05": indented,
    "fig06": heights,
    "fig07": traction,
    "fig08": load_area,
    "fig09": peaks,
    "fig10": depths,
    "fig11": decay,
    "fig12": punch,
    "fig13": ratios_peaks,
    "fig14": ratios_depths,
    "fig15": ratios_decay,
    "fig16": two_heights,
    "fig17": two_peaks,
    "fig18": common_depths,
    "stability": rounding,
    "extremes": extremes,
}


def _bullets(lines: Iterable[str]) -> list[str]:
    return ["\n".join(f"- {line}" for line in lines)]


def _spread(members: xr.DataArray) -> str:
    """Mean of the members, with its standard error if there are several."""
    values = np.asarray(members, dtype=float)
    if values.size == 1:
        return f"{values[0]:.3f}"
    return f"{values.mean():.3f} ± {values.std(ddof=1) / np.sqrt(values.size):.3f} ({values.size} samples)"


def _error(surface: xr.Dataset) -> str:
    """Scatter of one Gaussian sample, if the surface is one."""
    if "kurtosis_error" not in surface:
        return ""
    return (
        f" (a Gaussian sample of this spectrum scatters by {float(surface['skewness_error']):.3f} "
        f"and {float(surface['kurtosis_error']):.3f})"
    )


def _named(data: xr.Dataset) -> str:
    """What the surface is called, its mathematics as reStructuredText has it."""
    return re.sub(r"\$(.*?)\$", r":math:`\1`", label(data))


def _peaks(data: xr.Dataset, quantity: str, poisson: float) -> str:
    """How many peaks, and percentiles of their magnitude over E* ḡ_r, with bands if there are any."""
    chosen = data.sel(quantity=quantity, poisson=poisson, selection=selection_for(quantity))
    parts = []
    for percent in (50.0, 99.0):
        one = chosen.sel(percent=percent)
        text = f"{float(one['peak_percentile']):.3f}"
        if np.isfinite(one["peak_percentile_low"]):
            text += f" [{float(one['peak_percentile_low']):.3f}, {float(one['peak_percentile_high']):.3f}]"
        parts.append(f"{text} E\\* ḡ_r at the {percent:g}th percentile")
    return f"{int(chosen['peak_counts'].sum())} peaks, {', '.join(parts)}"


def _depth(data: xr.Dataset, poisson: float, unit: float, symbol: str) -> str:
    """Median depth of the von Mises peaks: of all, and of the largest tenth."""
    chosen = data.sel(quantity="von_mises", poisson=poisson, selection=selection_for("von_mises"))
    counts, edges = chosen["joint_counts"].values, chosen["depth_edge"].values
    large = np.cumsum(counts.sum(axis=1)[::-1])[::-1] <= 0.1 * counts.sum()
    every, largest = (
        np.interp(0.5, np.concatenate([[0.0], np.cumsum(c)]) / max(c.sum(), 1), edges) / unit
        for c in (counts.sum(axis=0), counts[large].sum(axis=0))
    )
    return f"median depth of the peaks {every:.3f} {symbol}, of the largest tenth {largest:.3f} {symbol}"


def _halves(data: xr.Dataset, poisson: float) -> str:
    """Where the covariance of Eq. 22 has fallen to half, below the reference plane and in it."""
    chosen, unit = data.sel(poisson=poisson), wavelength_short(data)
    depth, reference = chosen["plane_depth"].values, float(chosen["reference_depth"])
    below = depth >= reference
    down = _half(depth[below], chosen["scaled_covariance_depth"].values[below]) / unit
    across = _half(chosen["lag"].values, chosen["scaled_covariance_plane"].values) / unit
    return (
        f"largest von Mises stress at a depth of {reference / unit:.3f} λ_s; covariance halved at a depth of "
        f"{down:.3f} λ_s, and at a distance of {across:.3f} λ_s in the plane"
    )


def _half(position: Array, values: Array) -> float:
    """Where values first fall below half of the first one."""
    below = int(np.argmax(values < values[0] / 2))
    if not below:
        return float("nan")
    left, right = values[below - 1] / values[0], values[below] / values[0]
    return float(position[below - 1] + (left - 0.5) / (left - right) * np.diff(position)[below - 1])


def _gradients(data: xr.Dataset) -> str:
    """The rms gradient over the contact and outside it, and the median peak not scaled by it."""
    contact = data["seed_gradient_rms_contact"].values
    whole, share = data["member_rms_gradient"].values, data["member_area_fraction"].values
    outside = np.sqrt(np.maximum(whole**2 - share * contact**2, 0) / np.maximum(1 - share, 1e-12))
    chosen = data.sel(
        quantity="von_mises",
        poisson=data.attrs["poisson_contact"],
        selection=selection_for("von_mises"),
        percent=50.0,
    )
    return (
        f"rms gradient {contact.mean():.4f} in contact, {outside.mean():.4f} outside; "
        f"median peak {1e3 * float(chosen['peak_percentile']) * contact.mean():.2f} · 10⁻³ E\\* unscaled"
    )
