"""Stage contact: the solid pressed against a rough surface, and its load-area curve."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import xarray as xr

from asperity.contact import solve_path
from asperity.pipeline.solid import solid
from asperity.results.dataset import grid_of
from asperity.types import Progress


def solve_contact(
    surface: xr.Dataset,
    layer_settings: Mapping[str, Any],
    contact_settings: Mapping[str, Any],
    progress: Progress | None = None,
) -> xr.Dataset:
    """Contact at the area fractions of the configuration.

    Parameters
    ----------
    surface : dataset
        Result of stage surface.
    layer_settings, contact_settings : mapping
        Sections ``layer`` and ``contact`` of the configuration.
    progress : callable, optional
        Called as ``progress(done, total)``.

    Returns
    -------
    dataset
        Pressure, displacement and gap at the area fraction ``contact.area_fraction``, and the load-area
        curve. The attributes hold the description of the solid (`asperity.pipeline.solid.SOLID_ATTRIBUTES`)
        and the certificate of the solution.

    Raises
    ------
    ConvergenceError
        If the contact at an area fraction does not converge.
    """
    layer, record = solid(layer_settings)
    chosen = contact_settings["area_fraction"]
    fractions = sorted({*contact_settings["path_area_fractions"], chosen})
    path = solve_path(
        surface["height"].values,
        layer,
        grid_of(surface).length,
        area_fractions=fractions,
        method=contact_settings["method"],
        rtol=contact_settings["tolerance"],
        dtype=contact_settings["precision"],
        progress=progress,
    )
    curve = []
    for fraction, step in zip(fractions, path, strict=True):
        curve.append((step.area_fraction, step.mean_pressure, step.gradient_rms_contact))
        if fraction == chosen:
            contact = step
    area_fraction, mean_pressure, gradient_rms = np.array(curve).T
    plane = ("y", "x")
    dataset = xr.Dataset(
        {
            "pressure": (plane, contact.pressure),
            "displacement": (plane, contact.displacement),
            "gap": (plane, contact.gap),
            "area_fraction": contact.area_fraction,
            "mean_pressure": contact.mean_pressure,
            "approach": contact.approach,
            "gradient_rms_contact": contact.gradient_rms_contact,
            "path_area_fraction": ("load", area_fraction),
            "path_mean_pressure": ("load", mean_pressure),
            "path_gradient_rms_contact": ("load", gradient_rms),
        },
        coords={"y": surface["y"], "x": surface["x"]},
    )
    certificate = {
        f"certificate_{name}": value
        for name, value in asdict(contact.certificate).items()
        if name != "seconds"
    }
    return dataset.assign_attrs(record | certificate)
