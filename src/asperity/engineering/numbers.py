"""The records of an answer that no question asks for: contact, Hertz contact, hardness, stress in a body."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from typing import Any

import numpy as np
import xarray as xr

from asperity.contact import Contact
from asperity.core.units import shown_si
from asperity.engineering.answer_data import INTERFACE_TILES
from asperity.engineering.body_stress import BodyStress
from asperity.engineering.contact_numbers import ContactNumbers
from asperity.engineering.records import (
    DISCRETISATION,
    FRACTION,
    POSITIONS,
    POSITIVE,
    UNBOUNDED,
    Bounds,
    Position,
    Record,
    find,
    fraction,
)
from asperity.engineering.scene import Scene
from asperity.fourier.grid import BOUNDARIES
from asperity.settings.body import HARDNESS_OVER_YIELD
from asperity.settings.load import Hertz
from asperity.stress.extremes import DIRECTION
from asperity.stress.peaks.selection import has_percentile, select_peaks

EXTREMES = {
    "von_mises": "maximum von Mises stress",
    "maximum_shear": "maximum shear stress (Tresca)",
    "principal_1": "maximum tensile stress",
    "principal_3": "maximum compressive stress",
    "hydrostatic": "maximum hydrostatic pressure",
}
"""Field → name of its extreme value among the numbers."""

LIMITS = {
    "contact area fraction": ("contact_area_fraction", None),
    "rms gradient in contact": ("gradient_rms_contact", None),
    "maximum pressure": ("maximum", "pressure"),
    "maximum von Mises stress": ("extreme", "von_mises"),
    "maximum shear stress (Tresca)": ("extreme", "maximum_shear"),
    "maximum tensile stress": ("extreme", "principal_1"),
    "maximum compressive stress": ("extreme", "principal_3"),
    "maximum hydrostatic pressure": ("extreme", "hydrostatic"),
    "90th percentile of the peaks": ("p90", "von_mises"),
    "99th percentile of the peaks": ("p99", "von_mises"),
}
"""Quantity with a discretisation error → variable in `asperity.continuum_limit`, and quantity or field."""

PERCENTS = (50, 90, 99)
"""Percentiles of the von Mises peaks below the contacts that are listed."""


PARTS = ("mean pressure", "mean contact pressure", "maximum pressure", "force")
"""Quantities of which a film carries a part."""


def contact_records(
    numbers: ContactNumbers, limits: xr.Dataset, contact: Contact, of_positions: float, carried: float
) -> Iterator[Record]:
    """Numbers of the contact on the map.

    Parameters
    ----------
    numbers : ContactNumbers
    limits : dataset
        Of `asperity.continuum_limit`.
    contact : Contact
    of_positions : float
        Relative error of the contact area between measurement positions; NaN where it is not known.
    carried : float
        Fraction of the load that the contact carries; a film carries the rest.
    """
    is_elastic = math.isinf(contact.hardness)
    most = POSITIVE if is_elastic else Bounds(0.0, contact.hardness, "the hardness")
    for each in fields(ContactNumbers):
        if not each.metadata or math.isnan(getattr(numbers, each.name)):
            continue
        quantity, value = each.metadata["name"], float(getattr(numbers, each.name))
        record = Record(quantity, value, each.metadata["unit"])
        if each.name != "normal_approach":
            record = replace(record, bounds=POSITIVE)
        if each.name == "contact_area_fraction":
            record = fraction(quantity, value, note=f"of {shown_si(numbers.nominal_area, 'm^2')}")
        elif each.name == "contact_area":
            record = replace(record, bounds=Bounds(0.0, numbers.nominal_area, "the nominal area"))
        elif each.name == "maximum_pressure":
            record = replace(record, bounds=most, varies=True, better="less")
        elif each.name == "normal_approach" and (free := BOUNDARIES[contact.boundary]).count(True) == 1:
            distance = shown_si(contact.grid.length[free.index(True)], "m")
            record = replace(record, note=f"from the surface {distance} beside a line of load")
        elif each.name == "patches":
            record = replace(record, note=f"{numbers.contact_nodes} nodes")
        if each.name == "contact_area":
            record = _extrapolated(record, limits, "contact area fraction", numbers.nominal_area)
        record = _extrapolated(record, limits, quantity)
        if each.name in ("contact_area_fraction", "contact_area"):
            record = replace(record, varies=True).with_error(POSITIONS, of_positions * value)
        if carried < 1 and quantity in PARTS:
            record = replace(record, note="the part of the asperities")
        yield record


def hertz_records(case: Scene) -> Iterator[Record]:
    """The smooth Hertz contact around the map."""
    contact, load = case.hertz_contact, case.load
    if contact is None or not isinstance(load, Hertz):
        return
    y, x = load.at
    shear, depth = contact.maximum_shear(case.body.poisson)
    at = f"at {y:g} half-widths along y and {x:g} along x" if y or x else "in the middle"
    values: dict[str, tuple[float, str, dict[str, Any]]] = {
        "maximum Hertz pressure": (contact.maximum_pressure, "Pa", {}),
        "half-width along x": (contact.half_width_x, "m", {}),
        "half-width along y": (contact.half_width_y, "m", {}),
        "Hertz pressure on the map": (case.cell_pressure, "Pa", {"note": at}),
        "maximum shear stress, smooth": (
            shear,
            "Pa",
            {"position": Position(depth), "note": "without friction"},
        ),
    }
    for name, (value, unit, more) in values.items():
        if math.isfinite(value):
            yield Record(name, value, unit, "Hertz contact of the smooth bodies", **more)


def plastic_records(contact: Contact, is_estimated: bool, rms_gradient: float) -> Iterator[Record]:
    """Numbers of a contact under a hardness, which is given or follows from the yield stress."""
    topic = "plastic contact"
    note = f"{HARDNESS_OVER_YIELD:g} times the yield stress (Tabor), as none is given" if is_estimated else ""
    shares = {
        "area fraction at the hardness": contact.plastic_area,
        "load fraction at the hardness": contact.plastic_load,
    }
    yield Record("hardness", contact.hardness, "Pa", topic, note=note)
    if is_estimated and not contact.plastic_area:
        return
    for name, share in shares.items():
        yield fraction(name, share, topic=topic)
    depth = 0.0 if contact.plastic_depth is None else float(contact.plastic_depth.max())
    yield Record("maximum plastic depth", depth, "m", topic)
    index = contact.solid.effective_modulus * rms_gradient / contact.hardness
    yield Record("plasticity index", index, topic=topic, note="E* × Sdq / hardness")


def elastic_record(name: str, elastic: float, records: Iterable[Record]) -> Iterator[Record]:
    """A number of the elastic contact, if it differs by more than its error from that under a hardness."""
    own = next(find(records, name))
    if not abs(elastic - own.value) <= own.error:
        note = "without the estimated hardness"
        bounds = own.bounds if own.bounds == FRACTION else UNBOUNDED
        yield Record(f"{name}, elastic", elastic, own.unit, own.topic, bounds=bounds, note=note)


def body_records(case: Scene, name: str, stress: BodyStress, hardness: float) -> Iterator[Record]:
    """Numbers of the stress in a body under a contact of some hardness, infinite if it is elastic."""
    coating, limits = stress.body.coating, stress.limits

    def record(quantity: str, value: float, unit: str = "Pa", **more: Any) -> Record:
        return _extrapolated(Record(quantity, value, unit, "stress", name, **more), limits, quantity)

    worse: dict[str, Any] = {"varies": True, "better": "less"}
    for field, quantity in EXTREMES.items():
        found = stress.extremes[field]
        value = DIRECTION[field] * found.value
        if not value > 0:
            yield record(quantity, 0.0, words="none")
            continue
        position = Position(found.depth, found.y, found.x)
        bounds = POSITIVE
        if field == "hydrostatic" and math.isfinite(hardness) and _is_plain(case, name):
            # The hydrostatic stress is harmonic, and −2 (1 + ν) p / 3 at the surface.
            most = 2 * (1 + stress.layer.poisson) / 3 * hardness
            bounds = Bounds(0.0, most, "2 (1 + ν) / 3 of the hardness")
        note = "on a mirror image of the map" if found.on_image else ""
        yield record(quantity, value, position=position, bounds=bounds, note=note, **worse)
    if stress.interface is not None:
        for material, part in stress.materials.items():
            quantity, own = f"maximum von Mises stress in the {material}", part.von_mises
            yield record(quantity, own.value, position=Position(own.depth), **worse)
        for quantity, found in zip(INTERFACE_TILES, stress.interface.extremes.values(), strict=True):
            if found.value > 0:
                yield record(quantity, found.value, position=Position(*found[1:4]), **worse)
            else:
                yield record(quantity, 0.0, words="none", **worse)
        for material, value in zip(stress.materials, stress.interface.along, strict=True):
            yield record(f"σ_xx on the interface, in the {material}", value)
        if coating is not None and coating.residual_stress:
            energy = (1 - coating.poisson) * coating.residual_stress**2 * coating.thickness / coating.young
            note = "which a coating that comes off sets free"
            yield record("energy of the residual stress of the coating", energy, "J/m^2", note=note)
        if coating is not None and coating.yield_stress is not None:
            yield record("yield stress of the coating", coating.yield_stress)
    peaks = select_peaks(stress.stress, "von_mises", selection="under_contact")["peak_value"].values
    for percent in PERCENTS:
        if has_percentile(peaks.size, percent / 100):
            value = float(np.percentile(np.abs(peaks), percent))
            yield record(f"{percent}th percentile of the peaks", value, bounds=POSITIVE)


def _is_plain(case: Scene, name: str) -> bool:
    """True for a half-space under a contact pressure alone."""
    body = case.bodies[name]
    loads = case.friction or case.carried < 1 or body.layers or body.residual_stress or case.hertz_contact
    return not loads


def _extrapolated(record: Record, limits: xr.Dataset, quantity: str, size: float = 1.0) -> Record:
    """A record with its estimate at zero pixel size and its discretisation error, where there is one.

    Parameters
    ----------
    record : Record
    limits : dataset
    quantity : str
        Quantity of the limit.
    size : float
        Unit of the record over that of the limit.
    """
    if quantity not in LIMITS:
        return record
    values = limit_of(limits, quantity)
    estimate = size * values["estimate"]
    if not (math.isfinite(estimate) and values["error"] > 0):
        is_known = values["error"] == 0 or not record.value
        return record if is_known else replace(record, lacks=(DISCRETISATION,))
    error = abs(estimate) * values["error"]
    if values["estimate"] == values["on_grid"]:  # extreme stresses have an error, and no correction
        return record.with_error(DISCRETISATION, error)
    return replace(record, extrapolated=estimate).with_error(DISCRETISATION, error)


def limit_of(limits: xr.Dataset, quantity: str) -> dict[str, float]:
    """Kind → value of a quantity of `LIMITS` in a result of `asperity.continuum_limit`."""
    output, of = LIMITS[quantity]
    values = limits[output]
    if of is not None:
        values = values.sel({"field" if output == "extreme" else "quantity": of})
    return dict(zip(limits["kind"].values.tolist(), values.values.ravel().tolist(), strict=True))
