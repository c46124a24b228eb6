"""Figure 4: lateral and shear stress under a Hertzian contact, and finite elements beside them."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.diagonal import describe_differences, draw_fields

STAGES = ("validation",)
DATASETS = ("elements",)
COST = "figure of elements"


def draw(validation: Mapping[str, xr.Dataset]) -> Figure:
    """Draw σ_xx (a) and σ_xz (c) on the diagonal plane, and their differences to the finite elements (b, d).

    Triangles mark the edge of contact.
    """
    return draw_fields(
        validation["elements"],
        [
            ("stress_xx", r"$\sigma_{xx} / p_0$", "stress", "viridis"),
            ("stress_xz", r"$\sigma_{xz} / p_0$", "stress", "RdBu_r"),
        ],
    )


def caption(validation: Mapping[str, xr.Dataset]) -> str:
    """Largest differences to the finite elements."""
    return describe_differences(validation["elements"], ["stress_xx", "stress_xz"])
