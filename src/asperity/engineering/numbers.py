"""The records of an answer that no question asks for: contact, Hertz contact, hardness, stress in a body."""

import math
from bisect import bisect_left
from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from typing import Any

import numpy as np
import xarray as xr

from asperity.contact import Contact
from asperity.core.units import shown_si
from asperity.engineering.answer_data import ON_INTERFACE
from asperity.engineering.body_stress import BodyStress
from asperity.engineering.contact_numbers import ContactNumbers
from asperity.engineering.records import (
    DISCRETISATION,
    FRACTION,
    LIMITED,
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
from asperity.settings.body import HARDNESS_OVER_YIELD, Body, Layer
from asperity.settings.load import Hertz
from asperity.stress.extremes import DIRECTION, OF_MATERIALS, Extreme
from asperity.stress.peaks.selection import has_percentile, in_cell, select_peaks

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
    **{name: ("extreme", field) for field, name in EXTREMES.items()},
    "90th percentile of the peaks": ("p90", "von_mises"),
    "99th percentile of the peaks": ("p99", "von_mises"),
}
"""Quantity with a discretisation error → variable in `asperity.continuum_limit`, and quantity or field."""

PERCENTS = (50, 90, 99)
"""Percentiles of the von Mises peaks below the contacts that are listed."""


AT_SURFACE = ("", "the coating", "layer 1")
"""Names of the materials that are in contact."""

ON_IMAGE, AT_LINE = "on a mirror image of the map", "at the edge of the map, where its mirror image begins"
"""Notes on the positions of numbers."""

PARTS = ("mean pressure", "mean contact pressure", "maximum pressure", "force")
"""Quantities of which a film carries a part."""


def contact_records(
    numbers: ContactNumbers, limits: xr.Dataset, contact: Contact, of_positions: float, case: Scene
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
    case : Scene
    """
    is_elastic = math.isinf(contact.hardness)
    most = POSITIVE if is_elastic else Bounds(0.0, contact.hardness, "the hardness")
    least = max(numbers.nominal_pressure, 0.0)
    for each in fields(ContactNumbers):
        if not each.metadata or math.isnan(getattr(numbers, each.name)):
            continue
        quantity, value = each.metadata["name"], float(getattr(numbers, each.name))
        record = Record(quantity, value, each.metadata["unit"])
        may_pull = contact.adhesion is not None and quantity in PARTS
        if each.name != "normal_approach" and not may_pull:
            record = replace(record, bounds=POSITIVE)
        if each.name == "contact_area_fraction":
            record = fraction(quantity, value, note=f"of {shown_si(numbers.nominal_area, 'm^2')}")
        elif each.name == "contact_area":
            record = replace(record, bounds=Bounds(0.0, numbers.nominal_area, "the nominal area"))
        elif each.name == "maximum_pressure":
            row, column = np.unravel_index(contact.pressure.argmax(), contact.pressure.shape)
            place = row * contact.grid.spacing[0], column * contact.grid.spacing[1]
            note = AT_LINE if contact.grid.at_mirror_line(*place) else ""
            between = Bounds(min(least, most.high), most.high, "the mean contact pressure")
            if not is_elastic:
                between = between._replace(reason=most.reason)
            bounds = record.bounds if may_pull else between
            record = replace(record, bounds=bounds, note=note, varies=True, better="less")
        elif each.name == "normal_approach" and (free := BOUNDARIES[contact.boundary]).count(True) == 1:
            distance = shown_si(contact.grid.length[free.index(True)], "m")
            record = replace(record, note=f"from the surface {distance} beside a line of load")
        elif each.name == "patches":
            record = replace(record, note=f"{numbers.contact_nodes} nodes")
        if each.name == "contact_area":
            record = _extrapolated(record, limits, "contact area fraction", numbers.nominal_area)
        elif each.name == "mean_pressure":  # the load over the area
            area = limit_of(limits, "contact area fraction")
            estimate = value * area["on_grid"] / area["estimate"] if area["estimate"] else math.nan
            record = replace(record, bounds=record.bounds if may_pull else most, extrapolated=estimate)
            record = record.with_error(DISCRETISATION, area["error"] * estimate)
            least = max(least, np.nan_to_num(record.interval[0]))
        record = _extrapolated(record, limits, quantity)
        if each.name in ("contact_area_fraction", "contact_area", "mean_pressure"):
            record = replace(record, varies=True).with_error(POSITIONS, of_positions * value)
        notes = {
            record.note: True,
            "on the map": quantity == "force",
            "of both faces together": quantity in ("Sq", "Sdq") and case.counter_map is not None,
            "the part of the asperities": case.carried < 1 and quantity in PARTS,
        }
        record = replace(record, note=", ".join(text for text, holds in notes.items() if text and holds))
        yield record


def hertz_records(case: Scene) -> Iterator[Record]:
    """The smooth Hertz contact around the map."""
    contact, load = case.hertz_contact, case.load
    if contact is None or not isinstance(load, Hertz):
        return
    y, x = load.at
    narrow, is_line = contact.narrow, math.isinf(max(contact.half_width_x, contact.half_width_y))
    per_length = math.pi / 2 * narrow * contact.maximum_pressure if is_line else math.inf
    shear, depth = contact.maximum_shear(case.body.poisson)
    at = f"at {y:g} half-widths along y and {x:g} along x" if y or x else "in the middle"
    values: dict[str, tuple[float, str, dict[str, Any]]] = {
        "maximum Hertz pressure": (contact.maximum_pressure, "Pa", {}),
        "half-width along x": (contact.half_width_x, "m", {}),
        "half-width along y": (contact.half_width_y, "m", {}),
        "load per length of the Hertz contact": (per_length, "N/m", {}),
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


def plastic_records(case: Scene, contact: Contact, rms_gradient: float) -> Iterator[Record]:
    """Numbers of a contact under a hardness, which is given or follows from the yield stress.

    Beside the pressure of a film, less than the hardness of the case is left for the asperities.
    """
    is_estimated, hardness = case.hardness_is_estimated, case.hardness or contact.hardness
    topic = "plastic contact"
    note = f"{HARDNESS_OVER_YIELD:g} times the yield stress (Tabor), as none is given" if is_estimated else ""
    shares = {
        "area fraction at the hardness": contact.plastic_area,
        "load fraction at the hardness": contact.plastic_load,
    }
    yield Record("hardness", hardness, "Pa", topic, note=note)
    if contact.hardness < hardness:
        note = "less the pressure of the film"
        yield Record("hardness left for the asperities", contact.hardness, "Pa", topic, note=note)
    if is_estimated and not contact.plastic_area:
        return
    for name, share in shares.items():
        yield fraction(name, share, topic=topic)
    depth = 0.0 if contact.plastic_depth is None else float(contact.plastic_depth.max())
    yield Record("maximum plastic depth", depth, "m", topic)
    index = contact.solid.effective_modulus * rms_gradient / hardness
    yield Record("plasticity index", index, topic=topic, note="E* × Sdq / hardness")


def elastic_record(name: str, elastic: float, records: Iterable[Record]) -> Iterator[Record]:
    """A number of the elastic contact, if it differs by more than its error from that under a hardness."""
    own = next(find(records, name))
    if not abs(elastic - own.value) <= own.error:
        note = "without the estimated hardness"
        bounds = own.bounds if own.bounds == FRACTION else UNBOUNDED
        yield Record(f"{name}, elastic", elastic, own.unit, own.topic, bounds=bounds, note=note)


def body_records(case: Scene, name: str, stress: BodyStress, contact: Contact) -> Iterator[Record]:
    """Numbers of the stress in a body under a contact."""
    limits, materials, hardness, body = stress.limits, stress.materials, contact.hardness, case.bodies[name]
    # A half-space under a contact pressure alone.
    more_loads = case.friction or case.carried < 1 or body.residual_stress or case.hertz_contact
    is_plain = not (more_loads or body.layers)

    def record(quantity: str, value: float, unit: str = "Pa", limit: str = "", **more: Any) -> Record:
        return _extrapolated(Record(quantity, value, unit, "stress", name, **more), limits, limit or quantity)

    def extreme(
        quantity: str, value: float, found: Extreme, limit: str = "", at_surface: bool = False, **more: Any
    ) -> Record:
        if not value > 0:
            return record(quantity, 0.0, words="none")
        residual = "" if limit.startswith(tuple(ON_INTERFACE)) else residual_in(stress.body, found.depth)
        notes = {
            LIMITED: at_surface and contact.plastic_area > 0,
            residual: True,
            ON_IMAGE: found.on_image,
            AT_LINE: contact.grid.at_mirror_line(found.y, found.x),
        }
        note = ", ".join(text for text, holds in notes.items() if text and holds)
        more |= {"note": note, "varies": True, "better": "less"}
        return record(quantity, value, limit=limit, position=Position(*found[1:4]), **more)

    for field, quantity in EXTREMES.items():
        bounds = POSITIVE
        if field == "hydrostatic" and math.isfinite(hardness) and is_plain:
            # The hydrostatic stress is harmonic, and −2 (1 + ν) p / 3 at the surface.
            most = 2 * (1 + stress.layer.poisson) / 3 * hardness
            bounds = Bounds(0.0, most, "2 (1 + ν) / 3 of the hardness")
        found = stress.extremes[field]
        at_surface = field == "von_mises" and not stress.interfaces
        yield extreme(quantity, DIRECTION[field] * found.value, found, at_surface=at_surface, bounds=bounds)
    if stress.interfaces:
        for number, (material, (_, extremes)) in enumerate(materials.items()):
            for field in OF_MATERIALS:
                own = extremes[field]
                at_surface = field == "von_mises" and material in AT_SURFACE
                yield extreme(
                    f"{EXTREMES[field]} in {material}", own.value, own, f"{field} {number}", at_surface
                )
    for number, (interface, stresses) in enumerate(
        zip(stress.body.interfaces, stress.interfaces, strict=True)
    ):
        for kind, words in ON_INTERFACE.items():
            own = getattr(stresses, kind)
            yield extreme(f"{words} {interface}", own.value, own, f"{kind} {number}")
        depth = stresses.shear.depth
        for side, (material, value) in enumerate(zip([*materials][number:], stresses.along, strict=False)):
            note = residual_in(stress.body, depth if side == 0 else float(np.nextafter(depth, np.inf)))
            yield record(f"σ_xx on {interface}, in {material}", value, note=note)
    for material, (part, _) in materials.items():
        if isinstance(part, Layer) and part.residual_stress:
            energy = (1 - part.poisson) * part.residual_stress**2 * part.thickness / part.young
            note = f"which {material or 'a layer'} sets free if it comes off"
            yield record(f"energy of the residual stress of {material}", energy, "J/m^2", note=note)
    peaks, maps = in_cell(select_peaks(stress.stress, "von_mises", selection="under_contact"))
    for percent in PERCENTS:
        if has_percentile(peaks.sizes["peak"] / maps, percent / 100):
            value = float(np.percentile(peaks["peak_value"].values, percent))
            yield record(f"{percent}th percentile of the peaks", value, bounds=POSITIVE)


def residual_in(body: Body, depth: float) -> str:
    """The residual stress of the layer at a depth in words; on an interface that of the layer above."""
    number = bisect_left([*body.interfaces.values()], depth)
    residual = body.layers[number].residual_stress if number < len(body.layers) else None
    return f"with the residual stress {shown_si(residual, 'Pa')}" if residual else ""


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
    if quantity not in LIMITS and quantity not in limits.coords.get("field", ()):
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
    """Kind → value of a quantity of `LIMITS`, or an extreme value, in a result of `continuum_limit`."""
    output, of = LIMITS.get(quantity, ("extreme", quantity))
    values = limits[output]
    if of is not None:
        values = values.sel({"field" if output == "extreme" else "quantity": of})
    return dict(zip(limits["kind"].values.tolist(), values.values.ravel().tolist(), strict=True))
