"""Spectrum: the power spectral density of the heights of rough surfaces."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import ScalarFormatter

from asperity.paper.figures.cases import Datasets, bullets, name
from asperity.views.style import COLUMN, label, panels

SMALLEST_POWER = 1e-8
"""Smallest spectral density drawn, over the largest: below are rounding errors."""


def draw(surface: Datasets) -> Figure:
    """Draw the radially averaged spectrum of one seed over the number of waves in a cell length.

    A thin line is the expected spectrum of a random surface before its heights are transformed.
    """
    figure, (axis,) = panels(columns=1, width=COLUMN)
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


def caption(surface: Datasets) -> str:
    """Root-mean-square height and gradient of each surface."""
    return bullets(
        f"{name(label(data))}: rms height {float(data['rms_height']):.4g} L, "
        f"rms gradient {float(data['rms_gradient']):.4g}"
        for data in surface.values()
    )
