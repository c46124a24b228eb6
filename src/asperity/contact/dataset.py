"""A solved contact as a dataset of xarray, named as in result files of stage contact."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import xarray as xr

from asperity import accessor
from asperity.elasticity.two_bodies import TwoBodies

if TYPE_CHECKING:
    from asperity.contact.solution import Contact
    from asperity.elasticity.layer import Layer


accessor.register()


def contact_dataset(contact: Contact, unit_system: str) -> xr.Dataset:
    """Fields over y and x and numbers of a contact; see `Contact.to_dataset`."""
    y, x = contact.grid.coordinates()
    plane = ("y", "x")
    solid = contact.solid
    lower, upper = (solid.lower, solid.upper) if isinstance(solid, TwoBodies) else (solid, None)
    certificate = {
        f"certificate_{name}": value
        for name, value in asdict(contact.certificate).items()
        if name != "seconds"
    }
    settings: dict[str, Any] = {"layer": _settings(lower)}
    if upper is not None:
        settings["upper"] = _settings(upper)
    return xr.Dataset(
        {
            "pressure": (plane, contact.pressure),
            "displacement": (plane, contact.displacement),
            "gap": (plane, contact.gap),
            "area_fraction": contact.area_fraction,
            "mean_pressure": contact.mean_pressure,
            "approach": contact.approach,
            "gradient_rms_contact": contact.gradient_rms_contact,
        },
        coords={"y": y, "x": x},
        attrs={
            "unit_system": unit_system,
            "settings": json.dumps(settings, sort_keys=True),
            "boundary": contact.boundary,
            "effective_modulus": solid.effective_modulus,
            "solid": "half-space" if lower.height is None else f"layer, {lower.bottom} bottom",
            "solid_reason": "asked for",
            "solid_bound": 0.0,
            "uniform_mode": f"laterally {lower.lateral}",
            "poisson_contact": lower.poisson,
            "young": lower.young,
            "method": contact.method,
            "fft_engine": contact.fft_engine,
            **certificate,
        },
    )


def _settings(layer: Layer) -> dict[str, Any]:
    return {name: value for name, value in asdict(layer).items() if value is not None} | {
        "height": layer.height
    }
