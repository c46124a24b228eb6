"""The contact of a case: its bodies pressed together by its load."""

import math
from typing import Any

import numpy as np

from asperity.contact import Contact, solve_contact
from asperity.contact.solve import FULL_CONTACT, approach_of_full_contact
from asperity.core.types import Progress
from asperity.core.units import shown_si
from asperity.engineering.face import RoughFace
from asperity.engineering.scene import Scene
from asperity.settings.load import LARGEST_LOAD, Hertz
from asperity.settings.model import SettingsError
from asperity.surface.treatment.treatment import TreatedMap

SMALLEST_APPROACH = 1e-7
"""Least approach over the range of heights; their rounding is 1e-16 of it."""


def press(
    face: TreatedMap,
    case: Scene,
    progress: Progress | None = None,
    hardness: float | None = None,
    start: Contact | None = None,
) -> Contact:
    """The contact of a case, by default with the hardness of its bodies.

    A `start` from a similar case on the same grid saves up to half of the time.

    Raises
    ------
    SettingsError
        If the load is out of range for the map.
    ConvergenceError
        If the contact does not converge.
    """
    imposed = imposed_load(face, case)
    hardness = hardness or case.hardness
    is_beyond = _is_full(face, case) or imposed.get("mean_pressure", 0.0) >= (hardness or math.inf)
    if case.hardness_is_estimated and is_beyond:
        hardness = None  # no contact bears the load
    options = {"hardness": hardness, "boundary": face.boundary, **imposed}
    options["adhesion"] = case.adhesion_on(face.grid)
    is_like = start is not None and start.grid == face.grid and options["adhesion"] is None
    initial = start if is_like else None  # under adhesion solutions depend on the start
    return solve_contact(face.height, case.solid, face.grid, progress=progress, initial=initial, **options)


def mean_pressure(case: Scene, rough: RoughFace | None = None) -> float:
    """The mean pressure that a load imposes on the map, as far as it is known; 0 for an approach or area."""
    if case.load.kind == "force" and not isinstance(case.load, Hertz):
        return case.load.value / rough.face.grid.area if rough else 0.0
    return 0.0 if case.load.kind in ("normal_approach", "contact_area_fraction") else case.cell_pressure


def _is_full(face: TreatedMap, case: Scene) -> bool:
    """True if all nodes of a periodic map are to touch."""
    size, is_area = face.height.size, case.load.kind == "contact_area_fraction"
    return is_area and face.boundary == "periodic" and round(case.load.value * size) == size


def imposed_load(face: TreatedMap, case: Scene) -> dict[str, Any]:
    """The load as an argument of `solve_contact`; `SettingsError` if it is out of range for the map."""
    load, lowest = case.load, float(face.height.min())
    if isinstance(load, Hertz):
        return {"mean_pressure": case.cell_pressure}
    if load.kind == "force":
        mean_pressure = load.value / face.grid.area
        if wrong := [*case.problems_of_pressure(mean_pressure)]:
            raise SettingsError("", wrong)
        return {"mean_pressure": mean_pressure}
    if _is_full(face, case) and case.hardness and not case.hardness_is_estimated:
        full = solve_contact(face.height, case.solid, face.grid, contact_area_fraction=1.0)
        if full.maximum_pressure > case.hardness:
            taken = f"full contact takes a pressure of {shown_si(full.maximum_pressure, 'Pa')}"
            needed = f": less is needed under a hardness of {shown_si(case.hardness, 'Pa')}, {taken}"
            raise SettingsError("", [("load.contact_area_fraction", f" = {load.value:g}{needed}")])
    if load.kind != "normal_approach":
        return {load.kind: load.value}
    least, furthest = SMALLEST_APPROACH * np.ptp(face.height), LARGEST_LOAD * max(face.grid.period)
    accepted = ""
    if not least < load.value < furthest:
        accepted = f"a length from {shown_si(least, 'm')}, which is {SMALLEST_APPROACH:g} of the range of "
        accepted += f"heights, to {shown_si(furthest, 'm')} is needed"
    elif load.value >= (most := approach_of_full_contact(face.height, case.solid, face.boundary) - lowest):
        accepted = f"less than {shown_si(most, 'm')} is needed, {FULL_CONTACT}"
    if accepted:
        raise SettingsError("", [("load.normal_approach", f" = {shown_si(load.value, 'm')}: {accepted}")])
    return {"approach": lowest + load.value}
