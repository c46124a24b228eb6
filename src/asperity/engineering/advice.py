"""Warnings that an experienced colleague would give about an answer, each a function of the results.

A warning says that a number of the answer must not be used as it stands; a note says what to keep in mind.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

from asperity.contact.solution import SHOWN_ERROR
from asperity.engineering.findings import BodyAnswer, Findings
from asperity.units import shown_si

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


class Advice(NamedTuple):
    """A warning or a note.

    Attributes
    ----------
    level : "warning" or "note"
    subject : str
        Short heading.
    text : str
        One or two sentences.
    """

    level: str
    subject: str
    text: str


def advise(answer: Findings) -> list[Advice]:
    """All warnings and notes on an answer, warnings first."""
    found = [advice for rule in RULES for advice in rule(answer)]
    return sorted(found, key=lambda advice: advice.level != WARNING)


def stress_beyond_yield(answer: Findings) -> Iterator[Advice]:
    """Stress above the yield stress, or above what any material stands."""
    for name, body in answer.bodies.items():
        limit, stress = body.body.yield_stress, body.largest_von_mises
        where = _where(answer, name)
        if limit is not None and stress > limit:
            yield Advice(
                WARNING,
                "stress beyond yield",
                f"the largest von Mises stress{where}, {_pa(stress)}, is {stress / limit:.3g} times the "
                f"yield stress of {_pa(limit)}. This is an elastic result only: real material flows there, "
                f"the pressure stays below the hardness, about {_pa(3 * limit)}, and the real contact grows"
                f"{_depths(body)}.",
            )
        elif limit is None and stress > UNLIKELY_STRAIN * body.body.young:
            yield Advice(
                WARNING,
                "stress beyond any yield stress",
                f"the largest von Mises stress{where}, {_pa(stress)}, is "
                f"{100 * stress / body.body.young:.2g} % of Young's modulus; hardly a material stays elastic "
                f"above {100 * UNLIKELY_STRAIN:g} %. Give the yield stress to see the volume above it.",
            )


def resolution(answer: Findings) -> Iterator[Advice]:
    """Size of the error from the pixels, from a second solution at half the resolution."""
    changes = answer.fine.changes_from(answer.coarse)
    names = {
        "area_fraction": "real contact",
        "largest_pressure": "largest pressure",
        "largest_von_mises": "largest von Mises stress",
        "peaks_90": "90th percentile of the von Mises peaks",
        "peaks_99": "99th percentile of the von Mises peaks",
    }
    known = {name: change for name, change in changes.items() if math.isfinite(change)}
    told = ", ".join(f"{names[name]} by {100 * change:+.0f} %" for name, change in known.items())
    if len(answer.bodies) > 1:
        told += "; stresses are those of the lower body"
    limited = [name for name, change in known.items() if abs(change) > RESOLUTION_CHANGE]
    pixel = max(answer.indenter.grid.spacing)
    per_wave = answer.indenter.wavelength_short / pixel
    origin = "from a second solution with pixels twice as large"
    if limited:
        unresolved = (
            f" The shortest wave, {_m(answer.indenter.wavelength_short)}, has {per_wave:.2g} pixels; "
            f"{FEW_PIXELS_PER_WAVE} resolve it."
            if per_wave < FEW_PIXELS_PER_WAVE
            else ""
        )
        yield Advice(
            WARNING,
            "limited by the resolution of the map",
            f"halving the pixels to {_m(pixel)} changed the {told} ({origin}). These numbers have not "
            f"settled: a finer map may change them as much again.{unresolved} Remove waves shorter than "
            "those that matter to you, and interpolate to finer pixels.",
        )
    elif known:
        yield Advice(
            NOTE,
            "resolution",
            f"halving the pixels to {_m(pixel)} changed the {told} ({origin}).",
        )


def steep_slopes(answer: Findings) -> Iterator[Advice]:
    """Slopes beyond the linear theory."""
    slope = answer.numbers.rms_gradient
    if slope > STEEP:
        level = WARNING if slope > VERY_STEEP else NOTE
        yield Advice(
            level,
            "steep slopes",
            f"the rms gradient of the surface is {slope:.2g}, an angle of "
            f"{math.degrees(math.atan(slope)):.0f}°. The theory is for small slopes (error of the order of "
            f"its square, {100 * slope**2:.0f} %). Look for spikes, and check that heights and edges have "
            "the same unit.",
        )


def large_area(answer: Findings) -> Iterator[Advice]:
    """Real contact so large that contacts merge."""
    area = answer.numbers.area_fraction
    if area > LARGE_AREA:
        yield Advice(
            WARNING,
            "large real contact",
            f"{100 * area:.3g} % of the area is in contact. Above about {100 * LARGE_AREA:.0f} % contacts "
            "merge, and the result depends on the periodic repetition and on the edges of the map.",
        )


def missed_area(answer: Findings) -> Iterator[Advice]:
    """An imposed area that the surface does not allow."""
    load, area = answer.load, answer.numbers.area_fraction
    if load.kind == "area_fraction" and abs(area / load.value - 1) > SHOWN_ERROR:
        yield Advice(
            WARNING,
            "another real contact",
            f"{100 * load.value:.3g} % of the area was asked for, {100 * area:.3g} % is the nearest that "
            "this map allows: many of its lowest points have the same height, or it has too few points.",
        )


def edges(answer: Findings) -> Iterator[Advice]:
    """Steps where opposite edges of the period meet."""
    step = answer.indenter.edge_step
    if step > EDGE_STEP:
        yield Advice(
            WARNING,
            "edges do not match",
            f"opposite edges of the period differ by {step:.3g} times the step between neighbouring pixels. "
            "Contact at these edges is an artefact: mirror or window the map.",
        )


def load_on_edges(answer: Findings) -> Iterator[Advice]:
    """Contact at the edges of a map that nothing surrounds."""
    share = answer.numbers.load_on_edges
    if answer.indenter.boundary == "free" and share > EDGE_LOAD:
        yield Advice(
            WARNING,
            "contact at the edge of the map",
            f"{100 * share:.2g} % of the load is on the outermost pixels. The real surface goes on, and "
            "the pressure at an edge is that of a punch: the largest stresses may be artefacts.",
        )


def neighbouring_forms(answer: Findings) -> Iterator[Advice]:
    """Periodic images of a ball or cylinder, which press on the same body."""
    found = answer.neighbours
    if found is None or not answer.numbers.contact_nodes:
        return
    spans = (
        f"the form repeats with the map; the contact spans {100 * found.span:.0f} % of the distance between "
        "neighbours"
    )
    if math.isnan(found.largest_pressure):
        level = WARNING if found.span > WIDE_SPAN else NOTE
        yield Advice(level, "neighbouring forms", f"{spans}.")
        return
    now, alone = answer.numbers, found
    area = now.area_fraction / alone.area_fraction - 1
    pressure = now.largest_pressure / alone.largest_pressure - 1
    level = WARNING if max(abs(area), abs(pressure)) > NEIGHBOUR_CHANGE else NOTE
    yield Advice(
        level,
        "neighbouring forms",
        f"{spans}. The neighbours change the real contact by {100 * area:+.2g} % and the largest pressure by "
        f"{100 * pressure:+.2g} %, compared with one form alone under the same load. Set boundary to free to "
        "be without them.",
    )


def altered_map(answer: Findings) -> Iterator[Advice]:
    """Share of the map that a window or a filling altered."""
    for share, text in (
        (
            answer.indenter.altered_share,
            "lies in the window that lowers it to the mean plane, and hardly touches",
        ),
        (answer.indenter.filled_share, "had no data and was filled smoothly"),
    ):
        if share > ALTERED_SHARE:
            yield Advice(NOTE, "altered heights", f"{100 * share:.0f} % of the map {text}.")


def spikes(answer: Findings) -> Iterator[Advice]:
    """Load on single pixels."""
    share = answer.numbers.load_on_small_patches
    if share > SMALL_PATCH_SHARE and answer.numbers.typical_patch_nodes <= 4:
        yield Advice(
            WARNING,
            "spikes carry the load",
            f"{100 * share:.0f} % of the load is on patches of at most four pixels, "
            f"{100 * answer.numbers.load_of_largest_node:.2g} % on one pixel alone. Remove the spikes of the "
            "map (despike 8), or filter waves shorter than about eight pixels.",
        )


def few_nodes(answer: Findings) -> Iterator[Advice]:
    """Patches of contact of too few pixels for their stress."""
    nodes = answer.numbers.typical_patch_nodes
    if 0 < nodes < FEW_NODES_IN_PATCH:
        yield Advice(
            WARNING,
            "patches of few pixels",
            f"half of the load is on patches of at most {nodes:.0f} pixels; about {FEW_NODES_IN_PATCH} are "
            "needed to resolve the pressure of a patch and the stress under it. The real contact and the "
            "largest stresses depend on the pixel size.",
        )


def no_contact(answer: Findings) -> Iterator[Advice]:
    """Bodies that do not touch."""
    if not answer.numbers.contact_nodes:
        yield Advice(WARNING, "no contact", "the bodies do not touch.")


def impossible_heights(answer: Findings) -> Iterator[Advice]:
    """Heights larger than the map."""
    height, edge = answer.numbers.peak_to_valley, min(answer.indenter.grid.length)
    if height > 0.5 * edge:
        yield Advice(
            WARNING,
            "heights as large as the map",
            f"the heights span {_m(height)}, the shorter edge is {_m(edge)}: check the units of the heights "
            "and of the edges.",
        )


def implausible_materials(answer: Findings) -> Iterator[Advice]:
    """Constants that hardly a material has."""
    for name, part in answer.bodies.items():
        body, where = part.body, _where(answer, name)
        if not SOFTEST <= body.young <= STIFFEST:
            yield Advice(
                WARNING,
                "Young's modulus",
                f"Young's modulus{where} is {_pa(body.young)}; gels have 1 kPa and more, diamond 1.2 TPa.",
            )
        elif SOFT < body.young < STIFF and body.poisson < 0.4 and body.yield_stress is None:
            yield Advice(NOTE, "Young's modulus", _soft(body.young, where))
        elif SOFT < body.young < STIFF and (body.yield_stress or 0) > HIGHEST_YIELD * body.young:
            yield Advice(WARNING, "Young's modulus", _soft(body.young, where))
        low, high = USUAL_POISSON
        if body.poisson < low:
            yield Advice(
                NOTE,
                "Poisson's ratio",
                f"Poisson's ratio{where} is {body.poisson:g}; only auxetic foams are below 0.",
            )
        elif body.poisson > high and body.young > STIFF:
            yield Advice(
                WARNING,
                "Poisson's ratio",
                f"Poisson's ratio{where} is {body.poisson:g} at a modulus of {_pa(body.young)}; metals and "
                "ceramics have 0.15 to 0.45, only rubbers and gels are close to 1/2.",
            )
        if body.yield_stress is not None and body.yield_stress > HIGHEST_YIELD * body.young:
            yield Advice(
                WARNING,
                "yield stress",
                f"the yield stress{where}, {_pa(body.yield_stress)}, is above a tenth of Young's modulus, "
                f"{_pa(body.young)}: no stiff material is that strong; check the units.",
            )


def doubtful_solution(answer: Findings) -> Iterator[Advice]:
    """Conditions of contact that the solution violates."""
    violation = answer.numbers.violation
    if not violation <= ACCEPTED_VIOLATION:
        yield Advice(
            WARNING,
            "accuracy of the solution",
            f"the conditions of contact are violated by {violation:.2g} of the rms height or the pressure.",
        )


Rule = Callable[[Findings], Iterator[Advice]]

RULES: tuple[Rule, ...] = (
    no_contact,
    impossible_heights,
    implausible_materials,
    stress_beyond_yield,
    spikes,
    few_nodes,
    resolution,
    steep_slopes,
    missed_area,
    large_area,
    edges,
    load_on_edges,
    neighbouring_forms,
    altered_map,
    doubtful_solution,
)
"""All rules, the most important first."""


def _pa(value: float) -> str:
    return shown_si(value, "Pa", 3)


def _m(value: float) -> str:
    return shown_si(value, "m", 3)


def _where(answer: Findings, name: str) -> str:
    return f" of the {name} body" if len(answer.bodies) > 1 else ""


def _depths(body: BodyAnswer) -> str:
    if body.depths_above_yield is None or body.fraction_above_yield is None:
        return ""
    first, last = body.depths_above_yield
    begin = _m(first) if first else "the surface"
    return f"; depths from {begin} to {_m(last)} are affected"


def _soft(young: float, where: str) -> str:
    return (
        f"Young's modulus{where} is {_pa(young)}, that of a polymer. Metals, glasses and ceramics have 5 GPa "
        "to 1 TPa (steel 210 GPa): was GPa meant?"
    )
