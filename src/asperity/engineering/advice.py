"""Warnings and notes on an answer; `advice.yaml` has their texts."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from string import Formatter
from typing import Any

import numpy as np

from asperity.contact import Contact
from asperity.contact.solution import SHOWN_ERROR
from asperity.core.data import packaged_yaml
from asperity.core.units import shown_si, to_si
from asperity.engineering.answer_data import at_the_top
from asperity.engineering.numbers import EXTREMES, LIMITS, limit_of
from asperity.engineering.question import RESOLUTION_CHANGE, Stages
from asperity.engineering.records import DISCRETISATION, PLANES, Advice, Record, per_cent
from asperity.settings.body import HARDNESS_OVER_YIELD, OfMaterial
from asperity.settings.load import Hertz
from asperity.stress.analysis import PLASTIC_CONTACT
from asperity.surface.reading.formats import PROFILE
from asperity.surface.roughness import STRONG_LAY, sampling_error, texture

UNLIKELY_STRAIN = 0.02
"""Von Mises stress over Young's modulus above which hardly any material stays elastic; the yield stress of
hardened steel is 0.01 of its modulus (M. F. Ashby, Materials Selection, 2011, figure 4.5)."""

FEW_PIXELS_PER_WAVE = 8
"""Pixels on the shortest wave that resolve the stress under it; the preset "paper" uses as many."""

STEEP, VERY_STEEP = 0.3, 1.0
"""Rms gradients: linear theory is second order in the slope, 9 % at 0.3; at 1 it does not hold."""

LARGE_AREA = 0.3
"""Contact area fraction above which contacts merge and the periodic images matter."""

SMALL_PATCH_SHARE = 0.2
"""Load fraction on contact spots of at most four pixels from which spikes are suspected."""

FEW_PIXELS_ACROSS = 5
"""Width of a contact spot in pixels that resolves its pressure."""

EDGE_STEP = 3.0
"""Height step across edges over the step between pixels, above which a warning is given; 1 if periodic."""

EDGE_LOAD = 0.01
"""Fraction of the load on the edges of a map with a free boundary above which a warning is given."""

NEIGHBOUR_CHANGE = 0.05
"""Change of contact area or maximum pressure by the periodic images of a form that deserves a warning."""

CONFINED = 0.01
"""Lateral stress of the confined mean pressure over the maximum von Mises stress that makes a note."""

WIDE_SPAN = 0.5
"""Width of a contact over the distance between neighbouring forms above which they influence each other."""

ALTERED_SHARE = 0.02
"""Fraction of the area with altered or filled heights that makes a note."""

SOFTEST, SOFT, STIFF, STIFFEST = 1e3, 5e7, 5e9, 1.25e12
"""Young's moduli in Pa: gels from 1 kPa; rubbers up to 50 MPa; metals, glasses and ceramics from 5 GPa;
diamond has 1.22 TPa (M. F. Ashby, Materials Selection in Mechanical Design, 2011, figure 4.3)."""

RUBBER, HIGHEST_RATIO = 0.4, 0.495
"""Poisson's ratios: soft solids below the first are no rubbers, and stiff solids have at most the second."""

HIGHEST_YIELD = 0.1
"""Yield stress over Young's modulus: about the theoretical strength of a crystal."""

COMPARED = [name for name in LIMITS if name == EXTREMES["von_mises"] or name not in EXTREMES.values()]
"""Quantities whose change with the pixels is listed."""

NEGLIGIBLE = 1e-6
"""Relative size below which a number is zero up to rounding: its change with the grid is not reported."""

ACCEPTED_VIOLATION = 1e-3
"""Relative violation of the conditions of contact above which a warning is given."""

OTHER_STATE = 0.02
"""Difference of a given hardness from that of the material above which the yield stress is another's."""

NOT_SEPARATE = 0.1
"""Change of the Hertz pressure over the map above which the map is too large for a uniform pressure."""

SPIKE_SIZE = math.inf
"""Uncertainty of a maximum pressure on a spike, which is listed before all others."""

Found = tuple[bool, str, dict[str, Any]]
"""True for a warning, name in `advice.yaml`, and values for its text in addition to the stages; ``size`` is
the relative uncertainty that it states."""


@dataclass(frozen=True, eq=False)
class Compared:
    """Further contacts with which an answer is compared.

    Attributes
    ----------
    neighbours : (float, Contact or None) or None
        Width of the contact of a ball or cylinder over the distance to its periodic images (the larger ratio
        along y and x, or across the cylinder), and the contact under the same load without images (None for
        layers and cylinders). None without such a form, or with a free boundary.
    elastic : Contact or None
        Without the hardness that a yield stress suggests; None where no node reaches that.
    unfiltered : Contact or None
        Under the same load without the Gaussian filters; None if there are none.
    """

    neighbours: tuple[float, Contact | None] | None
    elastic: Contact | None
    unfiltered: Contact | None


def advise(
    stages: Stages, compared: Compared, records: Sequence[Record], of_questions: Iterable[Advice]
) -> list[Advice]:
    """All warnings and notes on an answer, warnings first."""
    texts = packaged_yaml("asperity.engineering", "advice.yaml")
    found = [*_on_contact(stages, compared)]
    shown = stages.asked.different_bodies
    for name in shown:
        where = f" of the {name} body" if len(shown) > 1 else ""
        for material, (part, extremes) in stages.bodies[name].materials.items():
            of_material = f" of {material}{where}" if material else where
            of_part = _on_part(part, extremes["von_mises"].value)
            found += [(warns, key, values | {"where": of_material}) for warns, key, values in of_part]
    found += [*_on_pixels(stages, records), *_on_map(stages, compared), *_on_neighbours(stages, compared)]
    made: dict[str, Advice] = {}
    bodies = list(stages.asked.bodies.values())
    alike = bodies[0].is_like(bodies[-1]) and len(bodies[0].parts) == 1
    for warns, key, values in found:
        text, known = texts[key], {"stages": stages, "numbers": stages.numbers, **values}
        words = {part: _Units().format(text.get(part, ""), **known) for part in ("subject", "text", "short")}
        advice = Advice(warns, **words, size=values.get("size", 0.0))
        # Advice on two bodies of the same material is given once.
        made.setdefault(key if alike and "where" in values else advice.text, advice)
    made |= {each.text: each for each in of_questions}
    return sorted(made.values(), key=lambda advice: not advice.warns)


class _Units(Formatter):
    """Format of texts in which ``{length:m}`` shows a number in SI, and ``{share:%}`` one in per cent."""

    def format_field(self, value: Any, format_spec: str) -> Any:
        if format_spec == "%":
            return per_cent(value)
        return shown_si(value, format_spec, 3) if format_spec in ("m", "Pa") else format(value, format_spec)


def _most_pressure(young: float, ratio: float) -> float:
    """Pressure at a strain of about 1; nearly incompressible solids bear a larger one in full contact."""
    confined = (1 + ratio) * (1 - 2 * ratio)
    return max(young, young * (1 - ratio) / confined if confined > 0 else math.inf)


def _on_contact(stages: Stages, compared: Compared) -> Iterator[Found]:
    """Advice on missing contact, impossible pressures or heights, a missed area, an inaccurate solution."""
    numbers, case, face = stages.numbers, stages.asked, stages.face
    if not numbers.contact_nodes:
        yield True, "no_contact", {}
    if numbers.pressure_on_spike:
        yield True, "pressure_on_spike", {"count": len(stages.rough.spikes), "size": SPIKE_SIZE}
    layers = [body.layer for body in stages.bodies.values()]
    borne, young = min((_most_pressure(each.young, each.poisson), each.young) for each in layers)
    if numbers.maximum_pressure > borne:
        yield True, "beyond_modulus", {"young": young}
    surfaces = [next(iter(body.parts.values())) for body in case.bodies.values()]
    suggested = HARDNESS_OVER_YIELD * min(each.yield_stress or math.inf for each in surfaces)
    if math.isinf(stages.contact.hardness) and numbers.nominal_pressure >= suggested:
        yield True, "beyond_hardness", {"hardness": suggested, "times": HARDNESS_OVER_YIELD}
    for each in (each for each in surfaces if math.isinf(stages.contact.hardness)):
        known = each.materials[0].constants if each.material else {}
        limit = to_si(known["hardness"].value, "pressure") if "hardness" in known else math.inf
        if numbers.maximum_pressure > limit:
            size = numbers.maximum_pressure / limit - 1
            yield True, "beyond_material", {"material": each.material, "limit": limit, "size": size}
    for body in case.bodies.values():
        taken, hardness = body.from_material, float(body.hardness or math.inf)
        is_given = math.isfinite(hardness) and not (body.hardness_is_estimated or "hardness" in taken)
        if is_given and "yield_stress" in taken and "hardness" in (known := body.materials[0].constants):
            limit = to_si(known["hardness"].value, "pressure")
            if abs(hardness / limit - 1) > OTHER_STATE:
                given = {"hardness": hardness, "yield_stress": body.yield_stress}
                yield False, "another_state", given | {"material": body.material, "limit": limit}
    if (elastic := compared.elastic) is not None:
        own, alone = stages.contact.contact_area_fraction, elastic.contact_area_fraction
        values = {"area": 100 * own, "alone": 100 * alone, "pressure": elastic.maximum_pressure}
        values |= {"size": abs(alone / own - 1), "times": HARDNESS_OVER_YIELD}
        yield values["size"] > NEIGHBOUR_CHANGE, "estimated_hardness", values
    if stages.contact.plastic_area:
        yield False, "clipped_pressure", {"size": 0.0, "meaning": PLASTIC_CONTACT}
    edge = (max if case.map.format == PROFILE else min)(face.grid.period)
    if numbers.peak_to_valley > 0.5 * edge:
        yield True, "large_heights", {"edge": edge}
    if (smooth := case.hertz_contact) is not None and isinstance(case.load, Hertz):
        widths, across = (smooth.half_width_y, smooth.half_width_x), np.linspace(-0.5, 0.5, 21)
        y, x = (
            middle * width + across * edge_of_map if width < math.inf else np.zeros(1)
            for middle, width, edge_of_map in zip(case.load.at, widths, face.grid.length, strict=True)
        )
        pressure = smooth.pressure(y[:, None], x) / (smooth.maximum_pressure * case.load.share)
        size = float(np.abs(pressure - 1).max())
        along_it = face.grid.length[int(np.argmin(widths))]
        values = {"size": size, "ratio": smooth.narrow / along_it, "width": 2 * smooth.narrow}
        yield size > NOT_SEPARATE, "scales", values
        rolling: Any = None if math.inf not in widths else "x" if widths[0] == math.inf else "y"
        cycles: Any = case.questions.get("cycles")
        if cycles is not None and cycles.shifts is not None:
            rolling = case.sliding_direction
        if rolling in ("x", "y"):
            _, ratio, lay = texture(face.height, face.grid.spacing)
            along = "y" if 45 < lay < 135 else "x"
            if ratio < STRONG_LAY and rolling != along:
                yield False, "across_lay", {"rolling": rolling, "along": along}
    wanted, area = case.load.value, numbers.contact_area_fraction
    if case.load.kind == "contact_area_fraction" and abs(area / wanted - 1) > SHOWN_ERROR:
        yield True, "another_area", {"wanted": 100 * wanted, "area": 100 * area}
    if not numbers.violation <= ACCEPTED_VIOLATION:
        yield True, "inaccurate", {}


def _on_part(part: OfMaterial, stress: float) -> Iterator[Found]:
    """Advice on implausible constants, and on stress above the strength of any material."""
    young, ratio, limit = part.young, part.poisson, part.yield_stress
    values: dict[str, Any] = {"young": young, "ratio": ratio, "limit": limit, "stress": stress}
    too_strong = limit is not None and limit > HIGHEST_YIELD * young
    if not SOFTEST <= young <= STIFFEST:
        yield True, "no_modulus", values
    elif SOFT < young < STIFF and (too_strong or (limit is None and ratio < RUBBER)):
        yield too_strong, "polymer", values
    if ratio < 0:
        yield False, "auxetic", values
    elif ratio > HIGHEST_RATIO and young > STIFF:
        yield True, "incompressible", values
    if too_strong:
        yield True, "high_yield", values
    if limit is None and stress > UNLIKELY_STRAIN * young:
        share = stress / young
        yield True, "surely_yielding", values | {"share": share, "limit": UNLIKELY_STRAIN}


def _on_pixels(stages: Stages, records: Sequence[Record]) -> Iterator[Found]:
    """Advice on load on small contact spots, and on the change of the numbers at half the resolution."""
    numbers, limits = stages.numbers, stages.bodies["lower"].limits
    share, width = numbers.load_on_small_patches, numbers.typical_patch_width
    if share > SMALL_PATCH_SHARE and width <= 2 and not numbers.pressure_on_spike:
        yield True, "spikes", {"size": share}
    if 0 < width < FEW_PIXELS_ACROSS:
        yield True, "few_pixels", {"enough": FEW_PIXELS_ACROSS}
    if reason := limits.attrs.get("reason"):
        yield False, "no_estimate", {"reason": reason}
    elif reason := limits.attrs.get("reason_of_stress"):
        yield False, "no_estimate_of_stress", {"reason": reason}
    else:
        yield False, "vanishing_pixels", {}
    known, listed = {}, {each.quantity for each in records}
    for name in filter(listed.__contains__, COMPARED):
        values = limit_of(limits, name)
        least, most = sorted(abs(values[kind]) for kind in ("on_grid", "on_half"))
        # The mean slope of a contact of single nodes is zero by symmetry, up to rounding errors.
        size = numbers.rms_gradient if "gradient" in name else most
        if math.isfinite(least + most) and least > NEGLIGIBLE * size:
            known[name] = values["on_grid"] / values["on_half"] - 1
    if not known:
        return
    pixel, wave = max(stages.face.grid.spacing), stages.face.wavelength_short
    size = max(map(abs, known.values()))
    changed = ", ".join(f"{name} by {100 * change:+.0f} %" for name, change in known.items())
    if len(stages.asked.different_bodies) > 1:
        changed += "; stresses are from the lower body"
    waves = ""
    if wave / pixel < FEW_PIXELS_PER_WAVE:
        waves = f" The shortest wave, {shown_si(wave, 'm', 3)}, has {wave / pixel:.2g} pixels; "
        waves += f"{FEW_PIXELS_PER_WAVE} resolve it."
    settled = size <= RESOLUTION_CHANGE
    error = f"those twice as large change numbers by up to {per_cent(size)}"
    top = [each for each in at_the_top(stages.asked, records) if each.best]
    for each in top:
        of_pixels = [each.errors.get(cause, 0.0) for cause in (DISCRETISATION, PLANES)]
        if (relative := math.hypot(*of_pixels) / abs(each.best)) > size:
            size, error = relative, f"the {each.quantity} has an error of up to {per_cent(relative)}"
    found = {"pixel": pixel, "changes": changed, "waves": waves, "size": size, "error": error}
    yield not settled, "resolved" if settled else "unresolved", found


def _on_map(stages: Stages, compared: Compared) -> Iterator[Found]:
    """Advice on slopes, contact area and edges beyond the theory, and on altered heights."""
    numbers, face, record = stages.numbers, stages.face, stages.face.treatment
    for doubt in stages.rough.doubts:
        subject = doubt.option
        if subject != "despike" or not numbers.pressure_on_spike:
            alters = subject == "detrend" or (subject == "despike" and numbers.presses_spikes)
            flag = f" (--{subject} {doubt.proposed})" if doubt.proposed else ""
            values: dict[str, Any] = {"subject": subject, "size": SPIKE_SIZE}
            values["doubt"] = doubt if doubt.text.endswith("?") else f"{doubt}{flag}."
            values["short"] = f"map: {doubt.text}{flag}" if alters else ""
            yield alters or subject in ("unit", "physical_size", "missing"), "doubt", values
    slope = numbers.rms_gradient
    if slope > STEEP:
        yield slope > VERY_STEEP, "steep", {"angle": math.degrees(math.atan(slope)), "size": slope**2}
    if numbers.contact_area_fraction > LARGE_AREA:
        yield True, "large_contact", {"area": 100 * numbers.contact_area_fraction, "limit": 100 * LARGE_AREA}
    if face.boundary == "periodic" and record.edge_step > EDGE_STEP:
        yield True, "edges", {}
    if face.boundary != "periodic" and numbers.load_on_edges > EDGE_LOAD:
        yield True, "contact_at_edge", {"size": numbers.load_on_edges}
    if (plain := compared.unfiltered) is not None:
        values = {"height": record.filtered_height, "gradient": record.filtered_gradient}
        yield (
            False,
            "filtered",
            values | {"area": 100 * plain.contact_area_fraction, "pressure": plain.maximum_pressure},
        )
    for share, key in ((record.altered_fraction, "windowed"), (record.filled_fraction, "filled")):
        if share > ALTERED_SHARE:
            yield False, key, {"size": share}
    if stages.asked.map.radius is None:
        yield False, "sample", {"size": sampling_error(face.height, face.grid)}


def _on_neighbours(stages: Stages, compared: Compared) -> Iterator[Found]:
    """Advice on the periodic images of a ball or cylinder, which press on the same body."""
    if stages.asked.map.form == "cylinder" and stages.face.boundary != "free":
        yield False, "line_contact", {"axis": stages.asked.map.cylinder_axis}
    if compared.neighbours is None:
        return
    span, alone = compared.neighbours
    for part in stages.bodies.values():
        ratio, stress = part.body.poisson, part.von_mises.value
        lateral = ratio / (1 - ratio) * stages.numbers.nominal_pressure
        if lateral > CONFINED * stress:
            yield False, "confined", {"lateral": lateral, "size": lateral / stress}
            break
    if alone is None:
        yield span > WIDE_SPAN, "neighbours", {"span": span}
        return
    area = stages.numbers.contact_area_fraction / alone.contact_area_fraction - 1
    pressure = stages.numbers.maximum_pressure / alone.maximum_pressure - 1
    size = max(abs(area), abs(pressure))
    found = {"span": span, "area": 100 * area, "pressure": 100 * pressure, "size": size}
    yield size > NEIGHBOUR_CHANGE, "neighbours_compared", found
