"""Presets of accuracy: a configuration names one, which sets every source of error at once.

A setting that the configuration gives itself overrides the preset. Cost and errors of each preset, after the
correction of the grid, are measured by ``benchmarks/tradeoff.py``.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from asperity.core.sizes import good_size


@dataclass(frozen=True)
class AccuracySettings:
    """Settings of accuracy, one for every source of error.

    Parameters
    ----------
    points_per_wavelength : float
        Grid spacings per shortest wavelength of a surface: the discretisation.
    contact_tolerance : float
        Estimated error of the pressure, relative to its norm.
    precision : "float64" or "float32"
        Floating-point precision of the contact problem.
    depth_tolerance : float
        Largest error that a coarser grid may cause in a deep plane.
    depth_spacing : float
        Distance between planes near the surface, in grid spacings.
    half_space_tolerance : float
        Largest difference at which the half-space replaces the layer.
    seeds : int
        Number of random surfaces of each kind.
    """

    points_per_wavelength: float
    contact_tolerance: float
    precision: str
    depth_tolerance: float
    depth_spacing: float
    half_space_tolerance: float
    seeds: int

    def points(self, wavelength_short: float) -> int:
        """Nodes on an edge of a unit cell, an even number whose Fourier transform is fast."""
        return good_size(round(self.points_per_wavelength / wavelength_short - 1e-6))


PRESETS = {
    "draft": AccuracySettings(4.0, 1e-4, "float64", 1e-2, 0.25, 0.05, 1),
    "paper": AccuracySettings(8.0, 1e-6, "float64", 1e-4, 0.5, 0.05, 1),
    "reference": AccuracySettings(16.0, 1e-8, "float64", 1e-6, 0.25, 0.05, 8),
}

KEYS = {
    "contact.tolerance": "contact_tolerance",
    "contact.precision": "precision",
    "stress.tolerance": "depth_tolerance",
    "stress.depth_spacing": "depth_spacing",
    "layer.half_space_tolerance": "half_space_tolerance",
}
"""Key of the configuration → attribute of `AccuracySettings`.

The other two attributes set ``seeds`` and, surface by surface, ``points``.
"""

PARTS = {tuple(key.split(".")): name for key, name in KEYS.items()}
"""Section and last part of each key of `KEYS` → attribute."""


def accuracy_of(config: Mapping[str, Any], name: str) -> AccuracySettings:
    """Settings of accuracy in a complete configuration, for one entry of ``surfaces``."""
    surface = config["surfaces"][name]
    return AccuracySettings(
        points_per_wavelength=surface["points"] * surface["wavelength_short"],
        seeds=len(config["seeds"]),
        **{name: config[section][key] for (section, key), name in PARTS.items()},
    )
