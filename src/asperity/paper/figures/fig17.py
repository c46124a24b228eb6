"""Figure 17: skewness and short waves, and the distribution of the von Mises peaks."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from asperity.paper.figures.cases import Case, Datasets, bullets, of_surfaces, von_mises_densities
from asperity.views.style import panels


def draw(statistics: Mapping[str, Datasets]) -> Figure:
    """Draw the densities for surfaces of different (a) skewness and (b) shortest wavelength.

    Parameters
    ----------
    statistics : mapping of mappings of datasets
        Studies ``skewness`` and ``kurtosis``, by surface.
    """
    figure, axes = panels(columns=len(statistics))
    for axis, study in zip(axes, statistics.values(), strict=True):
        von_mises_densities(axis, of_surfaces(study))
    return figure


def caption(statistics: Mapping[str, Datasets]) -> str:
    """Percentiles over E* ḡ_r, and the gradients and medians that show what this scaling does."""
    return bullets(
        f"{case.name}: {case.peak_percentiles('von_mises')}; {_gradients(case)}"
        for study in ("skewness", "kurtosis")
        for case in of_surfaces(statistics[study])
    )


def _gradients(case: Case) -> str:
    """The rms gradient in contact and outside, and the median peak in units of E*."""
    contact, outside = (
        float(case.statistics[f"seed_gradient_rms_{where}"].mean()) for where in ("contact", "outside")
    )
    median = contact * float(case.peaks("von_mises")["peak_percentile"].sel(percent=50.0))
    return (
        f"rms gradient {contact:.4f} in contact, {outside:.4f} outside; "
        f"median peak {1e3 * median:.2f} · 10⁻³ E\\*"
    )
