"""Result datasets of an answer in SI units: surface, contact, and the stress in each body."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from typing import Any

import xarray as xr

from asperity.engineering.answer import Answer
from asperity.engineering.indenter import MapSettings
from asperity.results.variables import SI_UNITS
from asperity.surface.dataset import surface_dataset
from asperity.surface.height_map import HeightMap


def result_datasets(answer: Answer) -> dict[str, tuple[str, xr.Dataset]]:
    """File name → title and dataset of every result of an answer."""
    name = answer.indenter.name
    results = {
        "surface.nc": (f"Rough surface {name}", indenter_dataset(answer)),
        "contact.nc": (f"Contact with rough surface {name}", contact_dataset(answer)),
    }
    for body in answer.bodies:
        file = "stress.nc" if len(answer.bodies) == 1 else f"stress_{body}.nc"
        title = f"Stress under rough surface {name}" + ("" if len(answer.bodies) == 1 else f", {body} body")
        results[file] = (title, stress_dataset(answer, body))
    return results


def settings_of(answer: Answer) -> dict[str, Any]:
    """Settings from which the answer can be made again, in SI units."""
    case = answer.case
    return {
        "name": answer.indenter.name,
        "map": _plain(answer.map_settings),
        "counter_map": _counter(answer),
        "layer": {"height": case.lower.height, "poisson": case.lower.poisson},
        "lower": asdict(case.lower),
        "upper": None if case.upper is None else asdict(case.upper),
        "load": {case.load.kind: case.load.value},
        "friction": case.friction,
        "sliding_direction": case.sliding_direction,
        "fields": list(answer.fields),
    }


def _plain(settings: MapSettings) -> dict[str, Any]:
    """Settings of a map that are given, as plain values."""
    return {
        name: list(value) if isinstance(value, tuple) else value
        for name, value in vars(settings).items()
        if value is not None and name != "option"
    }


def _counter(answer: Answer) -> dict[str, Any] | None:
    """Name and settings of the map of the counter body, as plain values."""
    counter = answer.counter_map
    if counter is None:
        return None
    source = counter.source.name if isinstance(counter.source, HeightMap) else os.fspath(counter.source)
    return {
        "source": source,
        "settings": None if counter.settings is None else _plain(counter.settings),
        "turned_about": counter.turned_about,
        "shift": list(counter.shift),
    }


def indenter_dataset(answer: Answer) -> xr.Dataset:
    """The surface that was pressed, with its roughness parameters and spectrum."""
    indenter = answer.indenter
    return surface_dataset(indenter.height, indenter.grid).assign_attrs(
        unit_system=SI_UNITS,
        map_treatment="\n".join(indenter.done),
        wavelength_short=indenter.wavelength_short,
        edge_step=indenter.edge_step,
    )


def contact_dataset(answer: Answer) -> xr.Dataset:
    """Pressure, displacement and gap; the attributes describe the lower body, the settings both."""
    return answer.contact.to_dataset().assign_attrs(
        settings=json.dumps(settings_of(answer), sort_keys=True),
        force=answer.numbers.force,
        approach_since_first_touch=answer.numbers.approach,
        **_solid(answer, "lower"),
    )


def stress_dataset(answer: Answer, body: str) -> xr.Dataset:
    """The stress in one body."""
    part = answer.bodies[body]
    attributes: dict[str, Any] = {
        "unit_system": SI_UNITS,
        "body": body,
        **_solid(answer, body),
        "gradient_rms_contact": answer.numbers.gradient_rms_contact,
    }
    if part.body.yield_stress is not None:
        attributes["yield_stress"] = part.body.yield_stress
        attributes["volume_above_yield"] = part.volume_above_yield
    return answer.stresses[body].assign_attrs(attributes)


def _solid(answer: Answer, name: str) -> dict[str, Any]:
    """Attributes that describe a body, named as in the files of the study."""
    body = answer.case.bodies[name]
    half_space = body.height is None
    return {
        "solid": "half-space" if half_space else f"layer, {body.bottom} bottom",
        "solid_reason": "asked for",
        "solid_bound": 0.0,
        "uniform_mode": "laterally confined",
        "poisson_contact": body.poisson,
        "young": body.young,
    }
