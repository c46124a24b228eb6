"""Registry of the comparisons of the study, by their keys in section ``validation`` of the configuration."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import xarray as xr

from asperity.validation.closed_forms import load_area, punch, slab_load_area
from asperity.validation.convergence import grid_convergence, mesh_convergence
from asperity.validation.extremes import outcome_matrix
from asperity.validation.finite_elements import compare_elements
from asperity.validation.held_out import edge_tension, elliptic_contacts, layer_indentation, wave_asymptotes
from asperity.validation.rounding import rounding_errors

COMPARISONS: Mapping[str, Callable[..., xr.Dataset]] = {
    "load_area": load_area,
    "slab_load_area": slab_load_area,
    "grid_convergence": grid_convergence,
    "elements": compare_elements,
    "mesh_convergence": mesh_convergence,
    "punch": punch,
    "elliptic_contacts": elliptic_contacts,
    "edge_tension": edge_tension,
    "layer_indentation": layer_indentation,
    "wave_asymptotes": wave_asymptotes,
    "stability": rounding_errors,
    "extremes": outcome_matrix,
}
"""Function of each comparison; its keyword arguments are the keys of its configuration, and `progress`."""


def title(name: str) -> str:
    """Title of the dataset of a comparison: the first line of its function's docstring."""
    return f"Validation: {(COMPARISONS[name].__doc__ or name).splitlines()[0].removesuffix('.')}"
