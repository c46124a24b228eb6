"""Extremes: outcomes of contacts with one or two settings at the ends of their ranges."""

import numpy as np
import xarray as xr
from extremes import NO_CELL, OUTCOMES, REFUSED
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from asperity.core.types import Array
from asperity.views.style import MILLIMETRE, PAGE

_HEIGHT = 178 * MILLIMETRE

_SHADES = ("#FFFFFF", "#0072B2", "#8CC5E8", "#E69F00", "#BBBBBB", "#000000", "#CC79A7", "#D55E00")
_COLOURS = dict(zip(OUTCOMES, _SHADES, strict=True))
_MEANINGS = {
    "certified and checked": "certified, as the direct solution",
    "certified": "certified, by a bound",
    "not converged": "ConvergenceError",
    "refused": "refused by name",
    "wrong": "silently wrong",
    "warned": "floating-point warning",
    "failed": "another exception",
}
_AXES = {
    "poisson": r"$\nu$",
    "scaled_height": r"$q_0 z_m$",
    "bottom": "bottom",
    "imposed": "imposed",
    "rms_gradient": r"gradient",
    "hurst": r"$H$",
    "wavelength_long": r"$\lambda_l/L$",
    "nodes_short": r"$\lambda_s/\Delta x$",
    "johnson": r"$\gamma$, $\delta$",
    "precision": "precision",
    "points": r"$N$",
    "method": "method",
}
_SMALLEST_ERROR = 1e-3
"""Smallest error drawn, over the tolerance; the largest is the error that is still allowed."""


def draw(data: xr.Dataset) -> Figure:
    """Draw outcomes on and below the diagonal, and errors over the tolerance above it.

    The levels of the default case are set in bold. q₀ = 2π/L.
    """
    figure = Figure(figsize=(PAGE, _HEIGHT))
    axis = figure.add_subplot()
    outcome = data["outcome"].values
    lower = _lower(outcome)
    axis.pcolormesh(
        np.ma.masked_array(outcome, ~lower),
        cmap=ListedColormap(_SHADES),
        vmin=-0.5,
        vmax=len(OUTCOMES) - 0.5,
        rasterized=True,
    )
    error = data["scaled_pressure_error"].values
    seen = np.triu(np.isfinite(error), 1)
    image = axis.pcolormesh(
        np.ma.masked_array(np.clip(error, _SMALLEST_ERROR, None), ~seen),
        cmap="cividis",
        norm=LogNorm(_SMALLEST_ERROR, float(data.attrs["allowed"])),
        rasterized=True,
    )
    _name_levels(axis, data)
    bar = figure.colorbar(
        image, ax=axis, orientation="horizontal", shrink=0.5, aspect=40, pad=0.01, extend="both"
    )
    bar.set_label("above the diagonal: error of the pressure over the tolerance")
    counts = _counts(outcome)
    handles = [
        Patch(color=_COLOURS[name], label=f"{text}: {counts[name]}") for name, text in _MEANINGS.items()
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def caption(data: xr.Dataset) -> str:
    """Number of contacts with each outcome, and of values out of range that were refused."""
    refused, beyond = data["beyond_outcome"].values == REFUSED, data.sizes["beyond"]
    double, single = (data.attrs[f"tolerance_{precision}"] for precision in ("float64", "float32"))
    text = (
        "Each level alone (diagonal) and with each level of every other setting; the levels of the default "
        "case in bold. q₀ = 2π/L; loads are relative to the one that closes the last gap, "
        "approaches to the distance between the lowest and the mean height. Solved to tolerances of "
        f"{double:g} (double precision) and {single:g} (single)."
    )
    counts = [f"{name}: {count}" for name, count in _counts(data["outcome"].values).items()]
    refusals = f"values out of range refused by name: {int(refused.sum())} of {beyond}"
    return "\n".join([text, "", *(f"- {line}" for line in (*counts, refusals))])


def _counts(outcome: Array) -> dict[str, int]:
    """Number of contacts with each outcome."""
    found = outcome[_lower(outcome)]
    return {name: int(np.sum(found == number)) for number, name in enumerate(OUTCOMES) if number != NO_CELL}


def _lower(outcome: Array) -> Array:
    """True where the matrix has a contact on or below the diagonal."""
    return np.tril(np.ones(outcome.shape, bool)) & (outcome != NO_CELL)


def _name_levels(axis: Axes, data: xr.Dataset) -> None:
    """Write the levels along both edges, and the names of the settings, with lines between them."""
    count = data.sizes["level"]
    places = np.arange(count) + 0.5
    names = [str(value) for value in data["level_value"].values]
    axis.set(xlim=(0, count), ylim=(count, 0), aspect="equal")
    axis.set_xticks(places, names, rotation=90)
    axis.set_yticks(places, names)
    axis.tick_params(length=0, labelsize=4.6, pad=1)
    for texts in (axis.get_xticklabels(), axis.get_yticklabels()):
        for text, default in zip(texts, data["level_default"].values, strict=True):
            text.set_fontweight("bold" if default else "normal")
    axis.spines[["top", "right"]].set_visible(True)
    settings = [str(name) for name in data["level_axis"].values]
    for name in dict.fromkeys(settings):
        first = settings.index(name)
        last = first + settings.count(name)
        for line in (axis.axvline, axis.axhline):
            line(last, color="0.3", linewidth=0.4)
        middle = (first + last) / 2
        axis.text(middle, -0.4, _AXES[name], rotation=90, ha="center", va="bottom", fontsize=7)
        axis.text(count + 0.4, middle, _AXES[name], ha="left", va="center", fontsize=7)
