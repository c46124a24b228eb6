"""Height and depth of the von Mises peaks of one surface under several areas, and lengths of the contact."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from asperity.paper.nayak.samples import boundary_integral
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.statistics import seed_statistics
from asperity.pipeline.stress import compute_stress
from asperity.pipeline.surface import make_surface
from asperity.results import dataset
from asperity.runtime.progress import ProgressBar
from asperity.spectral import Fourier, gradient
from asperity.stress.statistics import autocorrelation, half_length

TAIL = 0.99
"""Share of the peaks below the magnitude that stands for the high peaks."""

_KEPT = (
    "seed_area_fraction",
    "seed_mean_pressure",
    "seed_rms_gradient",
    "seed_gradient_rms_contact",
    "seed_patch_radius",
    "seed_peak_quantile",
    "seed_mean_depth_highest",
)


def collect(config: Mapping[str, Any]) -> dict[str, xr.Dataset]:
    """Samples of all surfaces of the configuration, read from their files or computed.

    The areas are those of ``contact.path_area_fractions`` and ``contact.area_fraction``. A file made from
    other settings is computed anew.
    """
    found = {}
    for name, surface in config["surfaces"].items():
        path = Path(config["results"]) / "samples" / f"{name}.nc"
        parameters = {key: value for key, value in surface.items() if key != "label"}
        made_from = {
            "name": name,
            "surface": parameters,
            "seeds": config["seeds"],
            **{section: config[section] for section in ("layer", "contact", "stress")},
        }
        found[name] = _sampled(path, made_from)
    return found


def _sampled(path: Path, made_from: dict[str, Any]) -> xr.Dataset:
    kept = dataset.read_made_from(path, made_from)
    if kept is not None:
        return kept
    with ProgressBar(made_from["name"]):
        found = xr.concat([_of_seed(made_from, seed) for seed in made_from["seeds"]], "seed")
    found = found.assign_coords(seed=made_from["seeds"])
    dataset.write(found, path, f"Peaks and lengths of surface {made_from['name']}", made_from)
    return dataset.read(path)


def _of_seed(settings: Mapping[str, Any], seed: int) -> xr.Dataset:
    surface = make_surface(settings["surface"], seed)
    contact = settings["contact"]
    areas = sorted({*contact["path_area_fractions"], contact["area_fraction"]})
    found = [sample(surface, area, settings) for area in areas]
    return xr.concat(found, "load").assign_coords(load=np.arange(len(areas)) + 1)


def sample(surface: xr.Dataset, area_fraction: float, settings: Mapping[str, Any]) -> xr.Dataset:
    """Numbers of one surface under one area: peaks, and lengths of the contact that may scale their depth.

    Parameters
    ----------
    surface : dataset
        Result of stage surface.
    area_fraction : float
    settings : mapping
        With sections ``layer``, ``contact`` and ``stress`` of the configuration.
    """
    of_area = {**settings["contact"], "area_fraction": area_fraction, "path_area_fractions": []}
    contact = solve_contact(surface, settings["layer"], of_area)
    stress = compute_stress(contact, settings["layer"], settings["stress"])
    numbers = seed_statistics(surface, contact, stress)[[*_KEPT]]
    numbers = numbers.sel(quantity=["von_mises"], level=[TAIL])
    return numbers.assign(contact_lengths(surface["height"].values, contact))


def contact_lengths(height: np.ndarray, contact: xr.Dataset) -> dict[str, float]:
    """Lengths of one contact, in units of the cell.

    Returns
    -------
    dict
        ``seed_pressure_length``: distance at which the autocovariance of the pressure falls to half;
        ``seed_hydraulic_radius``: twice the area over the length of its boundary, the radius of a circle;
        ``seed_height_length``: rms height over rms profile slope over the contact, √(m₀/m₂)_r;
        ``seed_curvature_length``: rms profile slope over curvature over the contact, √(m₂/m₄)_r.
    """
    grid, pressure = dataset.grid_of(contact), contact["pressure"].values
    touching = pressure > 0
    fourier = Fourier(grid)
    coefficients = fourier.forward(height)
    slope_y, slope_x = gradient(coefficients, fourier)
    laplacian = fourier.inverse(-(grid.wavenumber() ** 2) * coefficients)
    gradient_rms = np.sqrt((slope_y**2 + slope_x**2)[touching].mean())
    boundary = boundary_integral(touching, np.ones_like(height), grid)
    lag, covariance = autocorrelation(pressure, grid)
    return {
        "seed_pressure_length": half_length(lag, covariance / covariance[0]),
        "seed_hydraulic_radius": 2 * touching.mean() / boundary * (4 / np.pi),
        "seed_height_length": float(height[touching].std() / (gradient_rms / np.sqrt(2))),
        "seed_curvature_length": float(
            gradient_rms / np.sqrt(2) / np.sqrt(3 / 8 * (laplacian[touching] ** 2).mean())
        ),
    }
