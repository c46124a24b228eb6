"""Stage stress: the stress inside the solid under a contact, its peaks and its decay."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import xarray as xr

from asperity.contact.half_grid import HALF_TOLERANCE
from asperity.core.types import Progress
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.results.dataset import grid_of
from asperity.stress.analysis import SOUGHT, analyse_lateral_conditions
from asperity.stress.planes.planes import depth_grid
from asperity.study.stages.contact import SOLID_ATTRIBUTES, contact_on_half_the_nodes, solid
from asperity.study.stages.statistics import stress_numbers

GROWTH_PER_SPACING = 0.25
"""`growth` over `spacing` of `depth_grid`: the setting ``depth_spacing`` scales all distances of planes."""


def stress_of_seed(
    contact: xr.Dataset,
    layer_settings: Mapping[str, Any],
    stress_settings: Mapping[str, Any],
    laterals: Sequence[str] = (),
    quantities: Sequence[str] = SOUGHT,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Stress of one seed of the study with its numbers, and their estimates at zero grid spacing.

    Parameters are as for `compute_stress`.

    Returns
    -------
    dataset
        As of `compute_stress` under the condition of the layer, with the variables of
        `asperity.study.stages.statistics.stress_numbers`. With `laterals` these are along `lateral`, first
        under the condition of the layer.
    """
    found = compute_stress(contact, layer_settings, stress_settings, laterals, quantities, progress)
    halves: dict[str, tuple[xr.Dataset, xr.Dataset]] = {}
    if (half := contact_on_half_the_nodes(contact, layer_settings)) is not None:
        settings = {**stress_settings, "tolerance": HALF_TOLERANCE}
        of_half = compute_stress(half, layer_settings, settings, laterals, quantities)
        halves = {lateral: (half, stress) for lateral, stress in of_half.items()}
    each = [stress_numbers(contact, stress, halves.get(lateral)) for lateral, stress in found.items()]
    numbers = each[0]
    if len(each) > 1:
        numbers = xr.concat(each, "lateral", data_vars="all").assign_coords(lateral=list(found))
    return found[layer_settings["lateral"]].merge(numbers)


def compute_stress(
    contact: xr.Dataset,
    layer_settings: Mapping[str, Any],
    stress_settings: Mapping[str, Any],
    laterals: Sequence[str] = (),
    quantities: Sequence[str] = SOUGHT,
    progress: Progress | None = None,
) -> dict[str, xr.Dataset]:
    """Stress through the whole depth under a contact, for several Poisson's ratios and mean modes.

    Parameters
    ----------
    contact : dataset
        Result of stage contact.
    layer_settings, stress_settings : mapping
        Sections ``layer`` and ``stress`` of the configuration.
    laterals : sequence of names
        Conditions as of ``layer.lateral``, besides the layer's own.
    quantities : sequence of names
        Quantities whose peaks are sought.
    progress : callable, optional

    Returns
    -------
    dict
        Condition of the mean (q = 0) mode, first the condition of the layer → dataset as of `analyse_stress`.
        The planes of a half-space reach down to the height of the layer that it replaces. A layer has only
        the Poisson's ratio of its contact.

    Raises
    ------
    ValueError
        If the half-space of the contact cannot replace the layer at another Poisson's ratio.
    """
    layer, _ = solid(layer_settings)
    grid = grid_of(contact)
    poisson = [layer.poisson]
    if layer.height is None:
        poisson = stress_settings["poisson"]
        for ratio in poisson:
            other, record = solid({**layer_settings, "poisson": ratio})
            if other.height is not None:
                raise ValueError(
                    f"stress.poisson = {ratio}: {record['solid_reason']}; "
                    f"leave this ratio out or allow a larger layer.half_space_tolerance"
                )
    spacing = stress_settings["depth_spacing"]
    bottom = layer_settings["height"] if layer.base is None else layer.extent
    hardness = float(contact.get("hardness", math.inf))
    found = analyse_lateral_conditions(
        LoadedSolid(contact["pressure"].values.astype(float), grid, layer, hardness=hardness),
        [layer.lateral, *(name for name in laterals if name != layer.lateral)],
        depth_grid(grid, bottom, spacing, GROWTH_PER_SPACING * spacing, layer.interface),
        poisson,
        quantities,
        tolerance=stress_settings["tolerance"],
        progress=progress,
    )
    kept = {name: contact.attrs[name] for name in SOLID_ATTRIBUTES}
    kept["gradient_rms_contact"] = float(contact["gradient_rms_contact"])
    return {
        lateral: dataset.assign_attrs(kept, uniform_mode=f"laterally {lateral}")
        for lateral, dataset in found.items()
    }
