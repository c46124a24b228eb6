"""Figure 3: normal displacement and stress under a Hertzian contact, and finite elements beside them."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from asperity.paper.figures.diagonal import describe_differences, draw_fields

STAGES = ("validation",)
DATASETS = ("elements",)
COST = "figure of elements"


def draw(validation: Mapping[str, xr.Dataset]) -> Figure:
    """Draw u_z (a) and σ_zz (c) on the diagonal plane, and their differences to the finite elements (b, d).

    Triangles mark the edge of contact.
    """
    return draw_fields(
        validation["elements"],
        [
            ("displacement_z", r"$u_z / u_z^0$", "length", "viridis"),
            ("stress_zz", r"$\sigma_{zz} / p_0$", "stress", "viridis"),
        ],
    )


def caption(validation: Mapping[str, xr.Dataset]) -> str:
    """Largest differences to the finite elements."""
    return describe_differences(validation["elements"], ["displacement_z", "stress_zz"])
