"""The elastic solid of a study: the layer of the configuration, or the half-space in its place."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from asperity.elasticity.layer import Layer
from asperity.elasticity.simplest_solid import simplest_solid

SOLID_ATTRIBUTES = ("solid", "solid_reason", "solid_bound", "uniform_mode", "poisson_contact")
"""Global attributes of result files that describe the solid."""

_SMALLEST_WAVENUMBER = 2 * np.pi
"""Wavenumber of the longest wave on the unit cell, which reaches deepest."""


def solid(settings: Mapping[str, Any]) -> tuple[Layer, dict[str, Any]]:
    """The solid of a study and its description for the result files.

    Parameters
    ----------
    settings : mapping
        Section ``layer`` of the configuration: height, bottom, poisson, lateral, half_space_tolerance.
        Lengths are in units of the cell edge.

    Returns
    -------
    layer : Layer
        The layer of the settings, or the half-space if both differ by at most half_space_tolerance
        (`asperity.elasticity.simplest_solid`). Young's modulus is 1 − ν², so that E* is one.
    record : dict
        The `SOLID_ATTRIBUTES`: the solid used, the reason and the difference, the condition of
        the mean (q = 0) mode, and Poisson's ratio.
    """
    poisson = settings["poisson"]
    layer = Layer(
        young=1 - poisson**2,
        poisson=poisson,
        height=settings["height"],
        bottom=settings["bottom"],
        lateral=settings["lateral"],
    )
    chosen = simplest_solid(layer, _SMALLEST_WAVENUMBER, settings["half_space_tolerance"])
    name = "half-space" if chosen.layer.height is None else f"layer, {chosen.layer.bottom} bottom"
    record = {
        "solid": name,
        "solid_reason": chosen.reason,
        "solid_bound": chosen.difference,
        "uniform_mode": f"laterally {settings['lateral']}",
        "poisson_contact": poisson,
    }
    return chosen.layer, record
