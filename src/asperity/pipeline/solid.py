"""The solid of a study, as simple as its scene allows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from asperity.elasticity.layer import Layer

SOLID_ATTRIBUTES = ("solid", "solid_reason", "solid_bound", "uniform_mode", "poisson_contact")


def solid(settings: Mapping[str, Any]) -> tuple[Layer, dict[str, Any]]:
    """The layer of the configuration, or the half-space if the two cannot be told apart.

    Parameters
    ----------
    settings : mapping
        Section ``layer`` of the configuration. Young's modulus is chosen so that E* is one.

    Returns
    -------
    layer : Layer
    record : dict
        Global attributes for the files: what was used, and the bound that justified it. The longest
        wave of a unit cell, q = 2π, is the one that reaches deepest.
    """
    poisson = settings["poisson"]
    layer = Layer(
        young=1 - poisson**2,
        poisson=poisson,
        height=settings["height"],
        bottom=settings["bottom"],
        lateral=settings["lateral"],
    )
    choice = layer.effective(q_min=2 * np.pi, tolerance=settings["half_space_tolerance"])
    used = "half-space" if choice.layer.height is None else f"layer, {choice.layer.bottom} bottom"
    values = (used, choice.reason, choice.bound, f"laterally {settings['lateral']}", poisson)
    return choice.layer, dict(zip(SOLID_ATTRIBUTES, values, strict=True))
