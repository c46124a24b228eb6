"""The interface in an answer, in numbers of the map: partial slip, the gap, and a leak through it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pandas as pd

from asperity.contact import Contact
from asperity.contact.gap import FilmFlow, Percolation, film_flow, open_along
from asperity.contact.slip import PartialSlip, partial_slip
from asperity.core.units import shown_si
from asperity.engineering.answer_numbers import IN_FULL_CONTACT
from asperity.engineering.case import Case
from asperity.engineering.continuum import HalfGrid
from asperity.surface.treatment.treatment import TreatedMap

Numbers = tuple[str, float, str, str]
"""Name, value, unit, and words of a number."""

SETTLING = ("tangential displacement", "sticking part of the contact", "energy lost in a cycle ± force")
"""Numbers of partial slip that are compared with those of pixels twice as large."""

STEPS = 6
"""Forces of first loading in the cycle: chords enclose 97 % of the energy, and cost five contacts more."""


def slip_of(case: Case, face: TreatedMap, contact: Contact) -> PartialSlip | None:
    """The contact of a case under its tangential force or displacement; None if it has none."""
    if case.tangential_displacement is not None:
        imposed = {"tangential_displacement": case.tangential_displacement}
    elif case.tangential_force is not None:
        case.check_tangential_force(contact.mean_pressure * face.map_area)
        force = case.tangential_force * contact.grid.area / face.map_area
        imposed = {"tangential_force": min(force, case.friction * contact.force)}
    else:
        return None
    return partial_slip(contact, case.friction, sliding_direction=case.sliding_direction, **imposed)


def slip_rows(slip: PartialSlip, map_area: float) -> Iterator[Numbers]:
    """Name, value, unit and words of the numbers of partial slip on a map."""
    on_map = map_area / slip.contact.grid.area
    force, limit = slip.tangential_force * on_map, slip.friction * slip.contact.force * on_map
    share = f"{100 * force / limit:.4g} % of friction times load"
    yield "tangential force", force, "N", f"{shown_si(force, 'N')}, {share}"
    yield "tangential displacement", slip.displacement, "m", shown_si(slip.displacement, "m")
    sticking = slip.sticking_area
    yield "sticking part of the contact", sticking, "1", f"{100 * sticking:.4g} % of it, the rest slips"
    for name, value in (("first", slip.initial_stiffness), ("last", slip.stiffness)):
        number = f"{shown_si(value * 1e-6, 'Pa')}/µm" if np.isfinite(value) else IN_FULL_CONTACT
        yield f"{name} tangential stiffness", value, "Pa/m", number
    largest, lost = float(slip.slip.max()), slip.lost_energy * on_map
    yield "largest slip", largest, "m", shown_si(largest, "m")
    yield "energy lost in a cycle ± force", lost, "J", shown_si(lost, "J")


def cycle_table(slip: PartialSlip, map_area: float) -> pd.DataFrame:
    """Tangential force on a map and displacement in a cycle between the force and its opposite."""
    cycle = slip.cycle(STEPS)
    force = cycle["tangential_force"].values * map_area / slip.contact.grid.area
    displacement = cycle["tangential_displacement"].values
    return pd.DataFrame({"tangential_force_N": force, "tangential_displacement_m": displacement})


def flow_of(case: Case, face: TreatedMap, contact: Contact) -> FilmFlow | None:
    """Flow of the film of a case through the map; None if it has none."""
    if case.viscosity is None or case.pressure_difference is None:
        return None
    direction, images = case.flow_direction or "x", face.images
    flow = film_flow(contact, case.viscosity, images * case.pressure_difference, direction)
    return replace(
        flow,
        flow_rate=flow.flow_rate / images,
        flux=np.stack([face.part(along) for along in flow.flux]),
        pressure=face.part(flow.pressure) - (images - 1) * case.pressure_difference,
    )


def interface_on_half(case: Case, face: TreatedMap, half: HalfGrid) -> dict[str, float]:
    """Numbers of slip and leak by name, as they are with pixels twice as large; no leak is 0."""
    found = {}
    if half.slip is not None:
        found = {name: value for name, value, *_ in slip_rows(half.slip, face.map_area) if name in SETTLING}
    if case.viscosity is not None and case.pressure_difference is not None:
        direction, fall = case.flow_direction or "x", face.images * case.pressure_difference
        leak = 0.0
        if open_along(half.contact)["yx".index(direction)]:
            leak = film_flow(half.contact, case.viscosity, fall, direction).flow_rate / face.images
        found[f"leakage along {direction}"] = leak
    return found


def gap_rows(
    paths: Percolation, flow: FilmFlow | None, face: TreatedMap, direction: str
) -> Iterator[Numbers]:
    """Numbers of the percolation of contact and gap, and of a leak along a direction."""
    for phase, found in (("contact", paths.contact), ("gap", paths.gap)):
        for axis in (1, 0):
            yield (
                f"{phase} percolates along {'yx'[axis]}",
                float(found[axis]),
                "1",
                "yes" if found[axis] else "no",
            )
    for axis in (1, 0):
        width, words = paths.constriction[axis], "none, the gap is closed"
        if paths.gap[axis]:
            y, x = face.on_map(*paths.place[axis])
            words = f"{shown_si(width, 'm')} at x = {shown_si(float(x), 'm')}, y = {shown_si(float(y), 'm')}"
        yield f"narrowest constriction along {'yx'[axis]}", width, "m", words
    if flow is not None:
        shown = f"{1e9 * flow.flow_rate:.4g} mm³/s, to {100 * flow.conservation_error:.1g} % of it"
        yield f"leakage along {direction}", flow.flow_rate, "m^3/s", shown
        words = f"{flow.flow_factor:.4g} of the flow between planes at the mean gap"
        yield "pressure flow factor", flow.flow_factor, "1", words
