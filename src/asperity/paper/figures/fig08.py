"""Figure 8: load and area, and the distribution of the peaks of the contact pressure."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from scipy.special import erf

from asperity.paper.figures.shared import density, name_density
from asperity.paper.figures.style import label, panels


def draw(contact: Mapping[str, xr.Dataset], statistics: Mapping[str, xr.Dataset]) -> Figure:
    """Panel a: area fraction against load with two theories; panel b: density of the pressure peaks.

    Parameters
    ----------
    contact, statistics : mapping of datasets
        Results of the stages of these names, by surface.

    Notes
    -----
    Persson: a = erf(√2 P₀ / E* ḡ), doi 10.1063/1.1388626; Bush, Gibson and Thomas: a = √(2π) P₀ / E* ḡ,
    doi 10.1016/0043-1648(75)90145-3. Both are evaluated with the gradient of the true contact.
    """
    figure, (curve, peaks) = panels()
    reach = 0.0
    for data, marker in zip(contact.values(), "osD^", strict=False):
        load = data["path_mean_pressure"] / data["path_gradient_rms_contact"]
        curve.plot(load, 100 * data["path_area_fraction"], marker, mfc="none", label=label(data))
        reach = max(reach, float(load.max()))
    theory = np.linspace(0, reach, 200)
    curve.plot(theory, 100 * erf(np.sqrt(2) * theory), "k-", lw=0.9, label="Persson")
    curve.plot(theory, 100 * np.sqrt(2 * np.pi) * theory, "k--", lw=0.9, label="Bush, Gibson, Thomas")
    curve.set(
        xlabel=r"$P_0 / E^* \bar{g}_r$",
        ylabel="contact area fraction $a_r$ (%)",
        xlim=(0, None),
        ylim=(0, None),
    )
    curve.legend()
    for data in statistics.values():
        density(peaks, data, "pressure", data.attrs["poisson_contact"], label=label(data))
    name_density(peaks, "t_3")
    peaks.legend()
    return figure
