"""Accuracy: one knob for every source of error, and presets that set all of them at once.

A configuration names a preset, and may name any knob itself, which then counts. What each preset costs and
how wrong it is was measured by `asperity.accuracy.measurement`; `asperity.accuracy.plan` reads that measurement.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from asperity.spectral import good_size


@dataclass(frozen=True)
class AccuracySettings:
    """Settings of every source of error.

    Parameters
    ----------
    points_per_wavelength : float
        Grid spacings on the shortest wavelength of a surface: the discretisation.
    contact_tolerance : float
        Largest relative residual of a converged contact.
    precision : "float64" or "float32"
        Of the fields of the contact solve.
    depth_tolerance : float
        Error allowed where a deep plane is computed on a coarser grid.
    depth_spacing : float
        Distance between the planes nearest to the surface, in grid spacings.
    half_space_tolerance : float
        Largest difference at which the half-space stands for the layer.
    seeds : int
        Random surfaces of each kind.
    """

    points_per_wavelength: float
    contact_tolerance: float
    precision: str
    depth_tolerance: float
    depth_spacing: float
    half_space_tolerance: float
    seeds: int

    def points(self, wavelength_short: float) -> int:
        """Nodes on the edge of a unit cell, an even number whose transform is fast."""
        return good_size(round(self.points_per_wavelength / wavelength_short - 1e-6))


PRESETS = {
    "draft": AccuracySettings(4.0, 1e-4, "float64", 1e-2, 0.5, 0.05, 1),
    "paper": AccuracySettings(8.0, 1e-6, "float64", 1e-4, 0.5, 0.05, 1),
    "reference": AccuracySettings(16.0, 1e-8, "float64", 1e-6, 0.25, 0.05, 8),
}

_KEYS = {
    ("contact", "tolerance"): "contact_tolerance",
    ("contact", "precision"): "precision",
    ("stress", "tolerance"): "depth_tolerance",
    ("stress", "depth_spacing"): "depth_spacing",
    ("layer", "half_space_tolerance"): "half_space_tolerance",
}
"""Section and key of the configuration → knob."""


def complete(config: Mapping[str, Any]) -> dict[str, Any]:
    """The configuration with the knobs of its preset wherever it names none itself.

    Parameters
    ----------
    config : mapping
        Its key ``accuracy`` names the preset.

    Returns
    -------
    dict
        A copy; completed again it stays as it is. A measured map without a shortest wavelength keeps its
        own points.
    """
    knobs = PRESETS[config["accuracy"]]
    whole = copy.deepcopy(dict(config))
    whole.setdefault("seeds", list(range(1, knobs.seeds + 1)))
    for (section, key), name in _KEYS.items():
        whole[section].setdefault(key, getattr(knobs, name))
    for surface in (*whole["surfaces"].values(), *whole["measured"].values()):
        if "wavelength_short" in surface:
            surface.setdefault("points", knobs.points(surface["wavelength_short"]))
    return whole


def accuracy_of(config: Mapping[str, Any], name: str) -> AccuracySettings:
    """The knobs of a complete configuration, for an entry of ``surfaces``."""
    surface = config["surfaces"][name]
    density = surface["points"] * surface["wavelength_short"]
    chosen = {knob: config[section][key] for (section, key), knob in _KEYS.items()}
    return AccuracySettings(points_per_wavelength=density, seeds=len(config["seeds"]), **chosen)


def overlay(knobs: AccuracySettings, wavelengths: Mapping[str, float]) -> dict[str, Any]:
    """The keys of a configuration that set these knobs.

    Parameters
    ----------
    knobs : AccuracySettings
    wavelengths : mapping
        Name of a surface → its shortest wavelength.
    """
    keys: dict[str, Any] = {"seeds": list(range(1, knobs.seeds + 1))}
    keys["surfaces"] = {name: {"points": knobs.points(short)} for name, short in wavelengths.items()}
    for (section, key), name in _KEYS.items():
        keys.setdefault(section, {})[key] = getattr(knobs, name)
    return keys
