"""Stress under a Hertzian contact on the diagonal plane of the cubic cell, beside finite elements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from asperity.core.types import Array
from asperity.paper.figures.cases import Datasets, bullets
from asperity.views.style import panels

SMALLEST, LARGEST = 1e-3, 10.0
"""Limits between which differences are drawn, in percent of the field's largest magnitude."""


def draw(validation: Datasets, fields: Mapping[str, Sequence[str]]) -> Figure:
    """Draw a row for each field: the spectral solution, and its difference to the finite elements.

    `fields` maps names to label and colour map. Displacements are over the approach, stresses over the
    largest pressure. Triangles mark the edge of contact.
    """
    dataset = validation["elements"]
    figure, axes = panels(rows=len(fields), height=60)
    for row, (name, (label, colours)) in enumerate(fields.items()):
        value, difference = axes[2 * row : 2 * row + 2]
        ours, theirs = dataset[f"{name}_spectral"], dataset[f"{name}_elements"]
        largest_pressure = float(np.abs(dataset.stress_zz_spectral).max())
        shown = ours / (dataset.attrs["approach"] if name == "displacement_z" else largest_pressure)
        # A shear stress changes sign across the axis.
        odd = name == "stress_xz"
        low, high = float(shown.min()), float(shown.max())
        if odd:
            high = max(-low, high)
            low = -high
        image = value.contourf(*_mirrored(shown, odd), levels=np.linspace(low, high, 31), cmap=colours)
        # Contour bands leave hairlines in vector formats.
        image.set_edgecolor("face")
        image.set_rasterized(True)
        ticks = MaxNLocator(5, steps=[1, 2, 2.5, 5, 10])
        figure.colorbar(image, ax=value, label=label, shrink=0.85, ticks=ticks)
        percent = 100 * np.abs(theirs - ours) / np.abs(ours).max()
        norm = LogNorm(SMALLEST, LARGEST)
        error = difference.pcolormesh(
            *_mirrored(percent.clip(SMALLEST, LARGEST), False), norm=norm, cmap="cividis", rasterized=True
        )
        figure.colorbar(error, ax=difference, label="difference to FEM (% of max)", shrink=0.85)
        for axis in (value, difference):
            _frame(axis, float(dataset.contact_radius))
    return figure


def caption(validation: Datasets, fields: Mapping[str, Sequence[str]]) -> str:
    """Largest differences to the finite elements."""
    found = validation["elements"].isel(mesh=-1)
    return bullets(
        f"{name}: at most {100 * float(found['difference_away'].sel(field=name)):.3f} % of its largest "
        f"magnitude away from the edge of contact, "
        f"{100 * float(found['difference_edge'].sel(field=name)):.2f} % at it"
        for name in fields
    )


def _mirrored(field: xr.DataArray, odd: bool) -> tuple[Array, Array, Array]:
    """Positions along the diagonal, height, and the field on both sides of the indenter's axis.

    The outermost values are extended to the faces of the cell, half a Gauss interval away.
    """
    values = np.pad(field.transpose("depth", "distance").values, ((1, 1), (0, 1)), mode="edge")
    distance = np.append(field.distance.values, np.sqrt(0.5))
    height = 1 - np.concatenate([[0.0], field.depth.values, [1.0]])
    both = np.concatenate([-distance[::-1], distance])
    return both, height, np.hstack([(-1 if odd else 1) * values[:, ::-1], values])


def _frame(axis: Axes, contact_radius: float) -> None:
    """Set the axes of the plane, and mark the edge of contact above the surface."""
    half = np.sqrt(0.5)
    axis.set(xlim=(-half, half), ylim=(0, 1), aspect="equal", xlabel="position along diagonal $/ L$")
    axis.set(ylabel="$z / L$", yticks=(0, 0.5, 1), xticks=(-0.5, 0, 0.5))
    edges = [-contact_radius, contact_radius]
    axis.plot(edges, [1.03, 1.03], ls="", marker="v", ms=3, color="k", clip_on=False)
