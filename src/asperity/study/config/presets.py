"""Presets of accuracy, which set every source of error at once.

A configuration names a preset as ``accuracy``; a setting that it gives itself overrides the preset. Cost and
errors of each preset, after the correction of the grid, are measured by ``benchmarks/tradeoff.py``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class AccuracySettings:
    """Settings that decide about accuracy, one for every source of error.

    Parameters
    ----------
    points_per_wavelength : float
        Grid spacings per shortest wavelength of a surface: the discretisation.
    contact_tolerance : float
        Estimated error of the pressure, relative to its norm.
    precision : "float64" or "float32"
        Floating-point precision of the contact problem.
    depth_tolerance : float
        Largest error of a deep plane from computing it on a coarser grid.
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
        from asperity.fourier.grid import (
            good_size,  # numerical libraries, which the help of a command does not wait for
        )

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


def accuracy_of(config: Mapping[str, Any], name: str) -> AccuracySettings:
    """Settings of accuracy in a complete configuration, for one entry of ``surfaces``."""
    surface = config["surfaces"][name]
    return AccuracySettings(
        points_per_wavelength=surface["points"] * surface["wavelength_short"],
        seeds=len(config["seeds"]),
        **{attribute: config[section][key] for section, key, attribute in _split_keys()},
    )


def overlay(settings: AccuracySettings, wavelengths: Mapping[str, float]) -> dict[str, Any]:
    """Overlay of a configuration with these settings of accuracy.

    Parameters
    ----------
    settings : AccuracySettings
    wavelengths : mapping
        Name of a surface → its shortest wavelength.
    """
    keys: dict[str, Any] = {"seeds": list(range(1, settings.seeds + 1))}
    keys["surfaces"] = {name: {"points": settings.points(short)} for name, short in wavelengths.items()}
    for section, key, attribute in _split_keys():
        keys.setdefault(section, {})[key] = getattr(settings, attribute)
    return keys


def _split_keys() -> list[tuple[str, str, str]]:
    """Section, key and attribute of every entry of `KEYS`."""
    return [(*key.split("."), attribute) for key, attribute in KEYS.items()]  # type: ignore[misc]
