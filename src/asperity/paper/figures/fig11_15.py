"""The average decay of the von Mises stress along depth and in the plane of its largest peak."""

from __future__ import annotations

from matplotlib.figure import Figure

from asperity.paper.figures.cases import CASES, Datasets, bullets, curve_with_band
from asperity.views.style import panels

LARGEST_DISTANCE = 6.0
"""Largest depth or distance drawn, in units of the shortest wavelength."""


def draw(statistics: Datasets, cases: str) -> Figure:
    """Draw Eq. 22 (a) along depth and (b) in the plane of the largest peak, over the variance there."""
    figure, (along_depth, in_plane) = panels()
    for case in CASES[cases](statistics):
        profiles, unit = case.profiles, case.wavelength_short
        factor = 1 / float(profiles["scaled_covariance_plane"][0])
        for axis, distance, name in (
            (along_depth, "plane_depth", "scaled_covariance_depth"),
            (in_plane, "lag", "scaled_covariance_plane"),
        ):
            curves = [factor * profiles[f"{name}{end}"].values for end in ("", "_low", "_high")]
            curve_with_band(axis, profiles[distance] / unit, *curves, label=case.title)
    for axis in (along_depth, in_plane):
        axis.axhline(0, color="k", lw=0.4)
        axis.legend()
        axis.set_xlim(0, LARGEST_DISTANCE)
    along_depth.set(
        xlabel=r"depth $/ \lambda_s$", ylabel=r"$G_\mathrm{VM}(z) / G_\mathrm{VM}(z_\mathrm{peak})$"
    )
    in_plane.set(xlabel=r"distance $/ \lambda_s$", ylabel=r"$G_\mathrm{VM}(r) / G_\mathrm{VM}(0)$")
    return figure


def caption(statistics: Datasets, cases: str) -> str:
    """Depth of the largest von Mises stress, and where the covariance of Eq. 22 has fallen to half."""
    lines = []
    for case in CASES[cases](statistics):
        reference, down, across = (
            float(case.profiles[length]) / case.wavelength_short
            for length in ("reference_depth", "decay_length_depth", "decay_length_plane")
        )
        lines.append(
            f"{case.name}: largest von Mises stress at a depth of {reference:.3f} λ_s; covariance "
            f"halved at a depth of {reference + down:.3f} λ_s, and at a distance of {across:.3f} λ_s "
            f"in the plane"
        )
    return bullets(lines)
