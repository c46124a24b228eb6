"""What holds in every answer, whatever the surface, the bodies and the load: bounds between its numbers."""

import math
import re
from itertools import pairwise

import numpy as np

from asperity.engineering.records import DISCRETISATION, FRACTION, PLANES

ROUNDED, MONOTONE = 1e-5, 1e-3
"""Relative room for the tolerance of the contact, and for that of a search, between numbers of an answer."""

ALIKE = (
    ("contact area fraction", "contact area"),
    ("volume above yield per area", "volume above yield"),
)
"""Numbers of one quantity, whose relative errors are equal."""

RISES = {
    "contact_area_fraction": 1,
    "normal_approach_m": 1,
    "mean_gap_m": -1,
    "maximum_pressure_Pa": 1,
}
"""Column of a load curve → 1 if it rises with the load, −1 if it falls."""


def violations(answer):
    """The invariants that an answer does not keep, in words."""
    known = [each for each in answer.records if not math.isnan(each.value)]
    records = [each for each in known if not each.words]
    found = [text for each in known for text in _of_record(answer, each)]
    for body in answer.stress:
        found += _of_stress({each.quantity: each for each in records if each.body == body})
    numbers = {each.quantity: each for each in records if not each.body}
    found += [*_of_contact(answer, numbers), *_of_tables(answer), *_of_verdict(answer)]
    for one, other in ALIKE:
        for each in records:
            for second in (other for other in records if other.body == each.body):
                if (each.quantity, second.quantity) == (one, other) and not math.isclose(
                    _relative(each), _relative(second), rel_tol=1e-6, abs_tol=1e-12
                ):
                    found.append(f"{one} and {other} have different relative errors")
    return found


def _relative(record):
    return np.nan_to_num(record.error) / max(abs(record.best), 1e-300)


def _of_record(answer, record):
    """Bounds, position and printed text of a number."""
    name, (low, high, _) = f"{record.quantity} {record.body}".strip(), record.bounds
    room = ROUNDED * max(abs(record.value), 1e-300)
    if not low - room <= record.value <= high + room:
        yield f"{name} = {record.value:.9g} is outside {low:g} to {high:.9g}"
    if "fraction" in record.quantity and ": change" not in record.quantity and record.bounds != FRACTION:
        yield f"{name} has not the bounds of a fraction"
    if record.position.depth < 0:
        yield f"{name} lies above the surface"
    first, last = record.interval
    if math.isfinite(record.error) and not (low <= first <= record.best + room and first <= last <= high):
        yield f"{name}: the interval {first:g} to {last:g} does not hold {record.best:g} or its bounds"
    for axis, place, edge in zip("yx", record.position[1:], answer.face.grid.length, strict=True):
        if math.isfinite(place) and not 0 <= place <= edge:
            yield f"{name} lies at {axis} = {place:g} of a map of {edge:g}"
    if not low - room <= record.best <= high + room:
        yield f"{name} = {record.best:g} at zero pixel size is outside {low:g} to {high:g}"
    for value, error in re.findall(r"([\d.]+) ± ([\d.]+)", record.text()):
        digits = error.replace(".", "").strip("0")
        if len(digits) > 2 or len(value.partition(".")[2]) != len(error.partition(".")[2]):
            yield f"{name} is printed beyond its error: {record.text()}"


def _of_stress(numbers):
    """Inequalities between the fields at one point, and between peaks and maxima."""
    names = "maximum von Mises stress", "maximum shear stress (Tresca)"
    if all(name in numbers for name in names):
        von_mises, shear = (numbers[name].value for name in names)
        if not von_mises * (1 - ROUNDED) <= 2 * shear <= 2 / math.sqrt(3) * von_mises * (1 + ROUNDED):
            yield f"von Mises {von_mises:g}, Tresca {shear:g}: not from √3 to 2"
        ratio = _relative(numbers[names[0]]) / max(_relative(numbers[names[1]]), 1e-300)
        if numbers[names[0]].errors and not 0.5 < ratio < 2:
            yield f"relative errors of von Mises and Tresca stress differ by a factor of {ratio:g}"
    order = [numbers[f"{level}th percentile of the peaks"].value for level in (50, 90, 99)
             if f"{level}th percentile of the peaks" in numbers]  # fmt: skip
    order += [numbers[names[0]].value] if names[0] in numbers else []
    if any(one > other * (1 + ROUNDED) for one, other in pairwise(order)):
        yield f"percentiles and the maximum of the von Mises stress do not rise: {order}"
    limit = numbers["yield stress"].value if "maximum depth above yield" in numbers else -math.inf
    if names[0] in numbers and not numbers[names[0]].value > limit:
        yield "a volume is above yield, but the maximum stress is not"


def _of_contact(answer, numbers):
    """Pressures in their order, and at most the hardness, the part of a film included."""
    names, case = ("mean pressure", "mean contact pressure", "maximum pressure"), answer.case
    if all(name in numbers for name in names) and case.adhesion is None:
        pressures = [numbers[name].value for name in names]
        if any(one > other * (1 + ROUNDED) for one, other in pairwise(pressures)):
            yield f"mean, mean contact and maximum pressure do not rise: {pressures}"
    running_in = case.questions.get("running_in")
    hardness = case.hardness if running_in is None or running_in.hardness is None else running_in.hardness
    imposed = running_in is not None and case.load.kind in ("contact_area_fraction", "normal_approach")
    left_out = running_in is None and not math.isfinite(
        answer.contact.hardness
    )  # estimated, and below the load
    if hardness is not None and math.isfinite(hardness) and not imposed and not left_out:
        film = numbers["mean pressure of the film"].value if "mean pressure of the film" in numbers else 0.0
        pressure = numbers["maximum pressure"]
        highest = np.nanmax([pressure.value, pressure.best, pressure.interval[1]])
        if film + highest > hardness * (1 + ROUNDED):
            yield f"the pressure {film:g} + {highest:g} exceeds the hardness {hardness:g}"


def _of_tables(answer):
    """Peaks and contact spots on the map, and a load curve that is monotone."""
    for name in ("peaks", "contact_spots"):
        for axis, edge in zip("yx", answer.face.grid.length, strict=True):
            places = answer.tables[name][f"{axis}_m"]
            if not places.between(-1e-12 * edge, edge).all():
                yield f"{name} at {axis} = {places.min():g} to {places.max():g} of {edge:g}"
    curve = answer.tables.get("curve")
    for column, sign in RISES.items() if curve is not None else ():
        steps = sign * np.diff(curve[column])
        if not (steps >= -MONOTONE * np.abs(curve[column]).max()).all():
            yield f"{column} is not monotone: {curve[column].tolist()}"


def _of_verdict(answer):
    """A body stays elastic, or yields, only if its whole interval of stress says so."""
    known = [each for each in answer.records if each.quantity == "yield stress"]
    if len(known) != 1 or len(answer.case.bodies) > 1 or answer.case.body.layers:
        return
    stress = answer.record("maximum von Mises stress", known[0].body)
    low, high = stress.interval if stress.errors else (stress.value, stress.value)
    yields, may, elastic = ("material yields", "material may yield", "material stays elastic")
    said = elastic if high <= known[0].value else may if low <= known[0].value else yields
    if not any(said in text for text in answer.verdict):
        yield f"{said} is not said of {low:g} to {high:g}, yield stress {known[0].value:g}"
    causes = {DISCRETISATION, PLANES}
    volume = answer.record("volume above yield per area", known[0].body)
    if said == elastic and (volume.value > 0 or any(volume.errors.get(each, 0) > 0 for each in causes)):
        yield f"the volume above yield of an elastic body is {volume.text()}"
