"""Warnings and notes that an experienced colleague would give about an answer."""

from __future__ import annotations

import math
from collections.abc import Iterator

from asperity.contact.solution import SHOWN_ERROR
from asperity.core.units import shown_si
from asperity.engineering.answer import Advice, Answer
from asperity.engineering.answer_numbers import BodyAnswer

WARNING, NOTE = "warning", "note"

UNLIKELY_STRAIN = 0.02
"""Von Mises stress over Young's modulus above which hardly a material stays elastic; the yield stress of
hardened steel is 0.01 of its modulus (M. F. Ashby, Materials Selection, 2011, figure 4.5)."""

RESOLUTION_CHANGE = 0.1
"""Change on doubling the pixels from which a number is called limited by the grid."""

FEW_PIXELS_PER_WAVE = 8
"""Pixels on the shortest wave that resolve the stress under it; the preset "paper" takes as many."""

STEEP, VERY_STEEP = 0.3, 1.0
"""Rms gradients: linear theory is second order in the slope, 9 % at 0.3; at 1 it does not hold."""

LARGE_AREA = 0.3
"""Real contact fraction above which contacts merge and the periodic images matter."""

SMALL_PATCH_SHARE = 0.2
"""Share of the load on patches of at most four pixels from which spikes are suspected."""

FEW_NODES_IN_PATCH = 20
"""Nodes of a patch that resolve its pressure: a radius of 2.5 pixels."""

EDGE_STEP = 3.0
"""Step at the edges of a period over that between neighbouring pixels; about one for a periodic surface."""

EDGE_LOAD = 0.01
"""Share of the load on the edges of a map with a free boundary from which they count."""

NEIGHBOUR_CHANGE = 0.05
"""Change of real contact or largest pressure by the periodic images of a form that deserves a warning."""

WIDE_SPAN = 0.5
"""Width of a contact over the distance between neighbouring forms above which they change each other."""

ALTERED_SHARE = 0.02
"""Share of the area with altered or filled heights that is worth a note."""

SOFTEST, SOFT, STIFF, STIFFEST = 1e3, 5e7, 5e9, 1.25e12
"""Young's moduli in Pa: gels from 1 kPa; rubbers up to 50 MPa; metals, glasses and ceramics from 5 GPa;
diamond has 1.22 TPa (M. F. Ashby, Materials Selection in Mechanical Design, 2011, figure 4.3)."""

USUAL_POISSON = (0.0, 0.495)
"""Poisson's ratios of stiff solids; only rubbers and gels are closer to 1/2."""

HIGHEST_YIELD = 0.1
"""Yield stress over Young's modulus: about the theoretical strength of a crystal."""

ACCEPTED_VIOLATION = 1e-3
"""Violation of the conditions of contact, relative, from which a solution is doubtful."""

CHANGING_NUMBERS = {
    "area_fraction": "real contact",
    "largest_pressure": "largest pressure",
    "largest_von_mises": "largest von Mises stress",
    "peaks_90": "90th percentile of the von Mises peaks",
    "peaks_99": "99th percentile of the von Mises peaks",
}
"""Numbers whose change with the pixels is reported, in words."""


def advise(answer: Answer) -> tuple[Advice, ...]:
    """All warnings and notes on an answer, warnings first."""
    found = [*_on_contact(answer)]
    for rule in (_on_material, _on_yield):
        for name, body in answer.bodies.items():
            found += rule(body, f" of the {name} body" if len(answer.bodies) > 1 else "")
    found += [*_on_patches(answer), *_on_resolution(answer), *_on_map(answer), *_on_neighbours(answer)]
    return tuple(sorted(found, key=lambda advice: advice.level != WARNING))


def _on_contact(answer: Answer) -> Iterator[Advice]:
    """No contact, an area that was missed, a doubtful solution, heights as large as the map."""
    numbers, load = answer.numbers, answer.case.load
    if not numbers.contact_nodes:
        yield Advice(WARNING, "no contact", "the bodies do not touch.")
    height, edge = numbers.peak_to_valley, min(answer.face.grid.length)
    if height > 0.5 * edge:
        yield Advice(
            WARNING,
            "heights as large as the map",
            f"the heights span {_m(height)}, the shorter edge is {_m(edge)}: check the units of the heights "
            "and of the edges.",
        )
    area = numbers.area_fraction
    if load.kind == "area_fraction" and abs(area / load.value - 1) > SHOWN_ERROR:
        yield Advice(
            WARNING,
            "another real contact",
            f"{100 * load.value:.3g} % of the area was asked for, {100 * area:.3g} % is the nearest that "
            "this map allows: many of its lowest points have the same height, or it has too few points.",
        )
    if not numbers.violation <= ACCEPTED_VIOLATION:
        yield Advice(
            WARNING,
            "accuracy of the solution",
            f"the conditions of contact are violated by {numbers.violation:.2g} of the rms height or the "
            "pressure.",
        )


def _on_material(part: BodyAnswer, where: str) -> Iterator[Advice]:
    """Constants that hardly a material has."""
    body = part.body
    young, ratio, limit = body.young, body.poisson, body.yield_stress
    polymer = (
        f"Young's modulus{where} is {_pa(young)}, that of a polymer. Metals, glasses and ceramics have 5 GPa "
        "to 1 TPa (steel 210 GPa): was GPa meant?"
    )
    if not SOFTEST <= young <= STIFFEST:
        text = f"Young's modulus{where} is {_pa(young)}; gels have 1 kPa and more, diamond 1.2 TPa."
        yield Advice(WARNING, "Young's modulus", text)
    elif SOFT < young < STIFF and ratio < 0.4 and limit is None:
        yield Advice(NOTE, "Young's modulus", polymer)
    elif SOFT < young < STIFF and (limit or 0) > HIGHEST_YIELD * young:
        yield Advice(WARNING, "Young's modulus", polymer)
    low, high = USUAL_POISSON
    if ratio < low:
        text = f"Poisson's ratio{where} is {ratio:g}; only auxetic foams are below 0."
        yield Advice(NOTE, "Poisson's ratio", text)
    elif ratio > high and young > STIFF:
        yield Advice(
            WARNING,
            "Poisson's ratio",
            f"Poisson's ratio{where} is {ratio:g} at a modulus of {_pa(young)}; metals and ceramics have "
            "0.15 to 0.45, only rubbers and gels are close to 1/2.",
        )
    if limit is not None and limit > HIGHEST_YIELD * young:
        yield Advice(
            WARNING,
            "yield stress",
            f"the yield stress{where}, {_pa(limit)}, is above a tenth of Young's modulus, {_pa(young)}: no "
            "stiff material is that strong; check the units.",
        )


def _on_yield(part: BodyAnswer, where: str) -> Iterator[Advice]:
    """Stress above the yield stress, or above what any material stands."""
    limit, stress, young = part.body.yield_stress, part.largest_von_mises, part.body.young
    if limit is not None and stress > limit:
        depths = ""
        if part.depths_above_yield is not None:
            first, last = part.depths_above_yield
            depths = f"; depths from {_m(first) if first else 'the surface'} to {_m(last)} are affected"
        yield Advice(
            WARNING,
            "stress beyond yield",
            f"the largest von Mises stress{where}, {_pa(stress)}, is {stress / limit:.3g} times the yield "
            f"stress of {_pa(limit)}. This is an elastic result only: real material flows there, the "
            f"pressure stays below the hardness, about {_pa(3 * limit)}, and the real contact grows{depths}.",
        )
    elif limit is None and stress > UNLIKELY_STRAIN * young:
        yield Advice(
            WARNING,
            "stress beyond any yield stress",
            f"the largest von Mises stress{where}, {_pa(stress)}, is {100 * stress / young:.2g} % of Young's "
            f"modulus; hardly a material stays elastic above {100 * UNLIKELY_STRAIN:g} %. Give the yield "
            "stress to see the volume above it.",
        )


def _on_patches(answer: Answer) -> Iterator[Advice]:
    """Load on single pixels, and on patches of too few pixels for their stress."""
    numbers = answer.numbers
    share, nodes = numbers.load_on_small_patches, numbers.typical_patch_nodes
    if share > SMALL_PATCH_SHARE and nodes <= 4:
        yield Advice(
            WARNING,
            "spikes carry the load",
            f"{100 * share:.0f} % of the load is on patches of at most four pixels, "
            f"{100 * numbers.load_of_largest_node:.2g} % on one pixel alone. Remove the spikes of the map "
            "(despike 8), or filter waves shorter than about eight pixels.",
        )
    if 0 < nodes < FEW_NODES_IN_PATCH:
        yield Advice(
            WARNING,
            "patches of few pixels",
            f"half of the load is on patches of at most {nodes:.0f} pixels; about {FEW_NODES_IN_PATCH} are "
            "needed to resolve the pressure of a patch and the stress under it. The real contact and the "
            "largest stresses depend on the pixel size.",
        )


def _on_resolution(answer: Answer) -> Iterator[Advice]:
    """Size of the error from the pixels, from a second solution at half the resolution."""
    changes = answer.fine.changes_from(answer.coarse)
    known = {name: change for name, change in changes.items() if math.isfinite(change)}
    if not known:
        return
    pixel, wave = max(answer.face.grid.spacing), answer.face.wavelength_short
    changed = ", ".join(f"{CHANGING_NUMBERS[name]} by {100 * known[name]:+.0f} %" for name in known)
    if len(answer.bodies) > 1:
        changed += "; stresses are those of the lower body"
    text = (
        f"halving the pixels to {_m(pixel)} changed the {changed} (from a second solution with pixels twice "
        "as large)."
    )
    if all(abs(change) <= RESOLUTION_CHANGE for change in known.values()):
        yield Advice(NOTE, "resolution", text)
        return
    unresolved = ""
    if wave / pixel < FEW_PIXELS_PER_WAVE:
        unresolved = f" The shortest wave, {_m(wave)}, has {wave / pixel:.2g} pixels; "
        unresolved += f"{FEW_PIXELS_PER_WAVE} resolve it."
    yield Advice(
        WARNING,
        "limited by the resolution of the map",
        f"{text} These numbers have not settled: a finer map may change them as much again.{unresolved} "
        "Remove waves shorter than those that matter to you, and interpolate to finer pixels.",
    )


def _on_map(answer: Answer) -> Iterator[Advice]:
    """Slopes, real contact and edges beyond the theory; altered heights."""
    numbers, face, record = answer.numbers, answer.face, answer.face.treatment
    slope = numbers.rms_gradient
    if slope > STEEP:
        yield Advice(
            WARNING if slope > VERY_STEEP else NOTE,
            "steep slopes",
            f"the rms gradient of the surface is {slope:.2g}, an angle of "
            f"{math.degrees(math.atan(slope)):.0f}°. The theory is for small slopes (error of the order of "
            f"its square, {100 * slope**2:.0f} %). Look for spikes, and check that heights and edges have "
            "the same unit.",
        )
    if numbers.area_fraction > LARGE_AREA:
        yield Advice(
            WARNING,
            "large real contact",
            f"{100 * numbers.area_fraction:.3g} % of the area is in contact. Above about "
            f"{100 * LARGE_AREA:.0f} % contacts merge, and the result depends on the periodic repetition and "
            "on the edges of the map.",
        )
    if record.edge_step > EDGE_STEP:
        yield Advice(
            WARNING,
            "edges do not match",
            f"opposite edges of the period differ by {record.edge_step:.3g} times the step between "
            "neighbouring pixels. Contact at these edges is an artefact: mirror or window the map.",
        )
    if face.boundary == "free" and numbers.load_on_edges > EDGE_LOAD:
        yield Advice(
            WARNING,
            "contact at the edge of the map",
            f"{100 * numbers.load_on_edges:.2g} % of the load is on the outermost pixels. The real surface "
            "goes on, and the pressure at an edge is that of a punch: the largest stresses may be artefacts.",
        )
    windowed = "lies in the window that lowers it to the mean plane, and hardly touches"
    filled = "had no data and was filled smoothly"
    for share, what in ((record.altered_fraction, windowed), (record.filled_fraction, filled)):
        if share > ALTERED_SHARE:
            yield Advice(NOTE, "altered heights", f"{100 * share:.0f} % of the map {what}.")


def _on_neighbours(answer: Answer) -> Iterator[Advice]:
    """Periodic images of a ball or cylinder, which press on the same body."""
    alone, now = answer.neighbours, answer.numbers
    if alone is None or not now.contact_nodes:
        return
    text = (
        f"the form repeats with the map; the contact spans {100 * alone.span:.0f} % of the distance between "
        "neighbours."
    )
    large = alone.span > WIDE_SPAN
    if not math.isnan(alone.largest_pressure):
        area = now.area_fraction / alone.area_fraction - 1
        pressure = now.largest_pressure / alone.largest_pressure - 1
        large = max(abs(area), abs(pressure)) > NEIGHBOUR_CHANGE
        text += (
            f" The neighbours change the real contact by {100 * area:+.2g} % and the largest pressure by "
            f"{100 * pressure:+.2g} %, compared with one form alone under the same load. Set boundary to "
            "free to be without them."
        )
    yield Advice(WARNING if large else NOTE, "neighbouring forms", text)


def _pa(value: float) -> str:
    return shown_si(value, "Pa", 3)


def _m(value: float) -> str:
    return shown_si(value, "m", 3)
