"""Sentences that several captions share, in reStructuredText, with numbers read from the results."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

import numpy as np
import xarray as xr

from asperity.paper.figures.cases import Case
from asperity.views.style import label


def bullets(lines: Iterable[str]) -> str:
    """A list of sentences."""
    return "\n".join(f"- {line}" for line in lines)


def name(title: str) -> str:
    """A title with its mathematics as reStructuredText has it."""
    return re.sub(r"\$(.*?)\$", r":math:`\1`", title)


def surface_name(data: xr.Dataset) -> str:
    """Name of the surface of a result."""
    return name(label(data))


def height_moments(surface: Mapping[str, xr.Dataset], statistics: Mapping[str, xr.Dataset]) -> list[str]:
    """Skewness and kurtosis of each surface, means over seeds."""
    return [
        f"{surface_name(surface[key])}: skewness {_mean(data['seed_skewness'])}, "
        f"kurtosis {_mean(data['seed_kurtosis'])}{_sampling_error(surface[key])}"
        for key, data in statistics.items()
    ]


def _mean(seeds: xr.DataArray) -> str:
    """Mean over seeds, with its standard error if there are several."""
    values = np.asarray(seeds, dtype=float)
    if values.size == 1:
        return f"{values[0]:.3f}"
    return f"{values.mean():.3f} ± {values.std(ddof=1) / np.sqrt(values.size):.3f} ({values.size} samples)"


def _sampling_error(surface: xr.Dataset) -> str:
    """Standard errors of the moments of one sample, if the surface is Gaussian."""
    if "kurtosis_error" not in surface:
        return ""
    return (
        f" (standard errors of one Gaussian sample of this spectrum: "
        f"{float(surface['skewness_error']):.3f} and {float(surface['kurtosis_error']):.3f})"
    )


def contact_area(contact: Mapping[str, xr.Dataset]) -> list[str]:
    """Area in contact, load, and rms gradient of each surface."""
    return [
        f"{surface_name(data)}: {100 * float(data['area_fraction']):.2f} % of the area in contact at a mean "
        f"pressure of {float(data['mean_pressure'] / data['gradient_rms_contact']):.4f} E\\* ḡ_r, "
        f"ḡ_r = {float(data['gradient_rms_contact']):.4f}"
        for data in contact.values()
    ]


def peak_percentiles(case: Case, quantity: str) -> str:
    """Number of the peaks of a quantity and percentiles of their magnitude, with bands if there are any."""
    peaks = case.peaks(quantity)
    parts = []
    for percent in (50.0, 99.0):
        one = peaks.sel(percent=percent)
        text = f"{float(one['peak_percentile']):.3f}"
        if np.isfinite(one["peak_percentile_low"]):
            text += f" [{float(one['peak_percentile_low']):.3f}, {float(one['peak_percentile_high']):.3f}]"
        parts.append(f"{text} E\\* ḡ_r at the {percent:g}th percentile")
    return f"{int(peaks['peak_counts'].sum())} peaks, {', '.join(parts)}"


def peak_depths(cases: Iterable[Case], unit: float | None = None, symbol: str = "λ_s") -> list[str]:
    """Median depths of the von Mises peaks, in a given unit or in the shortest wavelength of each surface."""
    lines = []
    for case in cases:
        peaks, scale = case.peaks("von_mises"), unit or case.wavelength_short
        every, highest = (float(peaks[f"median_depth{which}"]) / scale for which in ("", "_highest"))
        lines.append(
            f"{name(case.title)}: median depth of the peaks {every:.3f} {symbol}, "
            f"of the highest tenth {highest:.3f} {symbol}"
        )
    return lines


def decay_lengths(cases: Iterable[Case]) -> list[str]:
    """Depth of the largest von Mises stress, and where the covariance of Eq. 22 has fallen to half."""
    lines = []
    for case in cases:
        profiles, unit = case.profiles, case.wavelength_short
        reference, down, across = (
            float(profiles[length]) / unit
            for length in ("reference_depth", "decay_length_depth", "decay_length_plane")
        )
        lines.append(
            f"{name(case.title)}: largest von Mises stress at a depth of {reference:.3f} λ_s; covariance "
            f"halved at a depth of {reference + down:.3f} λ_s, and at a distance of {across:.3f} λ_s "
            f"in the plane"
        )
    return lines
