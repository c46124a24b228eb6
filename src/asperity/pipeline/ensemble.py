"""Numbers of many seeds of one surface on one grid, without their fields.

A sample is one seed of a surface, taken through the stages surface, contact, stress and statistics in
memory. Only the numbers of `asperity.pipeline.statistics.seed_statistics` and the processor time are kept,
under every condition of the uniform mode that the readings ask for. A sample of the surface alone has no
contact: its roughness parameters are correlated with the numbers of the contact and cost next to nothing.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any

import xarray as xr

from asperity.pipeline.blocks import SURFACE_ALONE, grid_points
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.solid import SOLID_ATTRIBUTES
from asperity.pipeline.statistics import seed_statistics
from asperity.pipeline.stress import QUANTITIES, compute_stresses
from asperity.pipeline.surface import random_heights
from asperity.spectral import Grid
from asperity.surface.roughness import roughness_parameters
from asperity.types import Progress

SURFACE_NUMBERS = ("rms_gradient", "skewness", "kurtosis")
"""Roughness parameters of a sample of the surface alone."""


def sample(
    parameters: Mapping[str, Any],
    nodes: float,
    seeds: Sequence[int],
    layer_settings: Mapping[str, Any],
    contact_settings: Mapping[str, Any],
    stress_settings: Mapping[str, Any],
    readings: Mapping[str, Any],
    progress: Progress | None = None,
) -> xr.Dataset:
    """Numbers of the seeds of a surface on one grid.

    Parameters
    ----------
    parameters : mapping
        Entry of section ``surfaces`` of the configuration; its ``points`` are not used.
    nodes : float
        Nodes on the shortest wavelength; `SURFACE_ALONE` for the surface alone.
    seeds : sequence of int
    layer_settings, contact_settings, stress_settings : mapping
        Sections of the configuration. The contact has no load-area curve.
    readings : mapping
        Section ``readings`` of the configuration: ``lateral``, ``shear`` and ``patch_nodes`` are used.
    progress : callable, optional

    Returns
    -------
    dataset
        Along `seed` and `lateral`, the condition of the layer first, variables of `seed_statistics`; along
        `seed` the processor time. Of the surface alone, roughness parameters along `seed`.
    """
    points = grid_points(parameters["wavelength_short"], nodes)
    grid = Grid((points, points))
    contact_settings = {**contact_settings, "path_area_fractions": []}
    found, seconds = [], []
    for number, seed in enumerate(seeds):
        begin = time.process_time()
        if nodes == SURFACE_ALONE:
            found.append(_alone(parameters, grid, seed))
        else:
            surface = _surface(parameters, grid, seed)
            contact = solve_contact(surface, layer_settings, contact_settings)
            found.append(_numbers(surface, contact, layer_settings, stress_settings, readings))
        seconds.append(time.process_time() - begin)
        if progress is not None:
            progress(number + 1, len(seeds))
    whole = xr.concat(found, "seed", combine_attrs="override").assign_coords(seed=list(seeds))
    whole["seed_seconds"] = ("seed", seconds)
    return whole


def _numbers(
    surface: xr.Dataset,
    contact: xr.Dataset,
    layer_settings: Mapping[str, Any],
    stress_settings: Mapping[str, Any],
    readings: Mapping[str, Any],
) -> xr.Dataset:
    """Numbers of one seed along `lateral`."""
    quantities = list(dict.fromkeys([*QUANTITIES, *readings["shear"]]))
    stresses = compute_stresses(contact, layer_settings, stress_settings, readings["lateral"], quantities)
    each = [
        seed_statistics(surface, contact, stress, readings["patch_nodes"]) for stress in stresses.values()
    ]
    stress = stresses[layer_settings["lateral"]]
    joined = xr.concat(each, "lateral", data_vars="all").assign_coords(lateral=list(stresses))
    return joined.assign_attrs({name: stress.attrs[name] for name in SOLID_ATTRIBUTES})


def _surface(parameters: Mapping[str, Any], grid: Grid, seed: int) -> xr.Dataset:
    """The part of a result of stage surface that contact and statistics read."""
    height = random_heights(parameters, grid, seed)[1]
    roughness = roughness_parameters(height, grid.length)
    y, x = grid.coordinates()
    return xr.Dataset(
        {
            "height": (("y", "x"), height),
            "rms_gradient": roughness.rms_gradient,
            "skewness": roughness.skewness,
            "kurtosis": roughness.kurtosis,
        },
        coords={"y": y, "x": x},
    )


def _alone(parameters: Mapping[str, Any], grid: Grid, seed: int) -> xr.Dataset:
    """Roughness parameters of a surface on the smallest grid that holds its waves."""
    roughness = roughness_parameters(random_heights(parameters, grid, seed)[1], grid.length)
    return xr.Dataset({f"seed_{name}": getattr(roughness, name) for name in SURFACE_NUMBERS})
