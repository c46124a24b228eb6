"""Partial slip: a tangential force below the limit of friction, under which part of the contact sticks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from asperity.core.units import shown_si
from asperity.engineering.question import (
    IN_FULL_CONTACT,
    Advice,
    Picture,
    Question,
    Row,
    advice_on_pixels,
    per_cent,
    row,
)
from asperity.settings.model import optional
from asperity.settings.quantities import Force, Length

if TYPE_CHECKING:
    import pandas as pd

    from asperity.contact.slip import PartialSlip as Slip
    from asperity.engineering.question import Answer, Case, Contact, LoadedSolid, Progress

GROUP = "partial slip"

COMPARED = ("tangential displacement", "sticking part of the contact", "energy lost in a cycle ± force")
"""Numbers that are also computed on pixels twice as large."""

CYCLE_STEPS = 6
"""Steps of first loading in the cycle: chords enclose 97 % of the energy, and cost five more contacts."""

UNEVEN = 0.1
"""A warning is given if sticking nodes move unevenly by more than this share of the displacement."""

CYCLE_CAPTION = (
    "Tangential force against tangential displacement in a cycle between the force and its opposite, after "
    "the first loading (dashed). The loop encloses the energy that a cycle loses."
)


@dataclass(frozen=True, eq=False)
class SlipResult:
    """The contact under the tangential load, on the nodes and on half of them, and a cycle of it."""

    slip: Slip
    on_half: Slip
    cycle: pd.DataFrame


class PartialSlip(Question):
    """Partial slip under a tangential load, instead of full sliding; see `asperity.contact.partial_slip`."""

    TILES = COMPARED
    LEAD = "slip"

    tangential_force: Force | None = optional("a displacement is given", example="50 mN")
    """Tangential force on the map, at most friction times load. Below that limit part of the contact
    sticks."""
    tangential_displacement: Length | None = optional("a force is given", example="20 nm")
    """Tangential displacement of the bodies instead of a force, on half-spaces."""

    def check(self, case: Case) -> Iterator[tuple[str, str]]:
        """Settings that partial slip needs, and settings that it excludes."""
        if (self.tangential_force is None) == (self.tangential_displacement is None):
            yield "partial_slip", ": exactly one of tangential_force and tangential_displacement is needed"
        if not case.friction:
            yield "partial_slip", ": needs sliding.friction, above 0"
        refused: dict[str, str] = {
            name: name for name in ("load_curve", "cycles", "film") if name in case.questions
        }
        refused |= {"cycles": "stress cycles (fatigue limits, shifts)"} if "cycles" in refused else {}
        hertz = ["a map in a Hertz contact"] if case.hertz_contact is not None else []
        yield from (("partial_slip", f": not accepted with {words}") for words in [*hertz, *refused.values()])
        if case.hardness:
            yield "partial_slip", ": an elastic contact is needed, without hardness"
        if self.tangential_displacement is not None and case.solid.uniform_compliance():
            needed = ": half-spaces are needed, or a tangential_force on layers"
            yield "partial_slip.tangential_displacement", needed

    def of_contact(self, answer: Answer, progress: Progress) -> SlipResult:
        """The contact under the tangential load."""
        import pandas as pd

        from asperity.contact.slip import partial_slip

        case, contact = answer.case, answer.contact
        imposed = {"tangential_displacement": self.tangential_displacement}
        if self.tangential_force is not None:  # above friction times load the bodies slide
            imposed = {"tangential_force": min(self.tangential_force, case.friction * contact.force)}
        slip = partial_slip(contact, case.friction, sliding_direction=case.sliding_direction, **imposed)
        half = answer.half.contact
        force = min(slip.tangential_force, slip.friction * half.force)
        on_half = partial_slip(
            half, slip.friction, tangential_force=force, sliding_direction=slip.sliding_direction
        )
        cycle, units = slip.cycle(CYCLE_STEPS), {"tangential_force": "N", "tangential_displacement": "m"}
        table = pd.DataFrame({f"{name}_{unit}": cycle[name].values for name, unit in units.items()})
        return SlipResult(slip, on_half, table)

    def loaded(self, answer: Answer, contact: Contact, body: str) -> LoadedSolid:
        """A body under pressure and tangential load."""
        found: SlipResult = answer.of(self)
        return (found.slip if contact is answer.contact else found.on_half).in_body(body)

    def verdict(self, answer: Answer) -> str:
        """Full sliding, or else the part of the contact that sticks, and the displacement."""
        slip = answer.of(self).slip
        force, moved = shown_si(slip.tangential_force, "N", 3), shown_si(slip.displacement, "m", 3)
        if slip.tangential_force >= slip.friction * slip.contact.force:
            return f"the bodies slide, with the force of friction, {force}"
        stick = f"{per_cent(slip.sticking_area)} of the contact sticks and the rest slips"
        return f"under a tangential force of {force} the bodies move by {moved}; {stick}"

    def rows(self, answer: Answer) -> Iterator[Row]:
        """Force, displacement, sticking part, stiffness, slip and lost energy."""
        return _rows(answer.of(self).slip)

    def advice(self, answer: Answer) -> Iterator[Advice]:
        """Errors of the superposition and of the pixels."""
        found: SlipResult = answer.of(self)
        limit = found.slip.friction * answer.numbers.force
        if self.tangential_force is not None and self.tangential_force >= limit:
            force, most = shown_si(self.tangential_force, "N"), shown_si(limit, "N")
            text = f"the bodies slide: {force} is not below friction times load, {most}, which is the "
            yield Advice(True, "gross sliding", f"{text}tangential force of this answer.")
        size = found.slip.deviation
        if size > 0:
            text = "the superposition of partial slip neglects that the displacement under a shear traction "
            text += "depends on the direction of its waves: nodes that stick are displaced unevenly, by "
            text += f"{per_cent(size)} (rms) of the tangential displacement."
            short = f"partial slip: sticking nodes are displaced unevenly by {per_cent(size)}"
            yield Advice(size > UNEVEN, "superposition of partial slip", text, short, size)
        fine, coarse = ({row.name: row.value for row in _rows(each)} for each in (found.slip, found.on_half))
        yield advice_on_pixels("slip", fine, {name: coarse[name] for name in COMPARED})

    def assumption(self, answer: Answer) -> str:
        """A tangential force that has grown once, and a pressure without friction."""
        return (
            "The tangential force has grown once from zero; the faces stick where the shear traction is below"
            " friction times pressure, and the pressure is computed without friction."
        )

    def files(self, case: Case) -> list[str]:
        """The cycle, and maps of slip and traction."""
        return ["cycle.csv", "cycle.png", "shear_traction.png", "slip.png"]

    def tables(self, answer: Answer) -> Mapping[str, pd.DataFrame]:
        """Force and displacement in a cycle between the tangential force and its opposite."""
        return {"cycle": answer.of(self).cycle}

    def fields(self, answer: Answer) -> Mapping[str, Any]:
        """Pressure of the part that sticks, and slip."""
        slip = answer.of(self).slip
        return {"sticking_pressure": slip.sticking.pressure, "slip": slip.slip}

    def pictures(self, answer: Answer) -> Iterator[Picture]:
        """Maps of traction and slip, and the loop of force and displacement."""
        from asperity.engineering.pictures import map_of_contact
        from asperity.views.maps import SHEAR_TRACTION, SLIP

        slip = answer.of(self).slip
        caption = "Shear traction by the tangential force"
        yield map_of_contact(answer, "shear_traction", slip.traction, SHEAR_TRACTION, caption)
        caption = "Slip of the faces under the tangential force, white within the outlines where they stick"
        yield map_of_contact(answer, "slip", slip.slip, SLIP, caption)
        yield Picture("cycle", CYCLE_CAPTION, _loop(answer.of(self).cycle))


def _rows(slip: Slip) -> Iterator[Row]:
    """Numbers of partial slip on a map."""
    import numpy as np

    force, limit = slip.tangential_force, slip.friction * slip.contact.force
    share = f"{100 * force / limit:.4g} % of friction times load"
    yield row(GROUP, "tangential force", force, "N", f"{shown_si(force, 'N')}, {share}")
    yield row(GROUP, "tangential displacement", slip.displacement, "m")
    sticking = slip.sticking_area
    yield row(GROUP, COMPARED[1], sticking, "1", f"{100 * sticking:.4g} % of it, the rest slips")
    for name, value in (("first", slip.initial_stiffness), ("last", slip.stiffness)):
        number = f"{shown_si(value * 1e-6, 'Pa')}/µm" if np.isfinite(value) else IN_FULL_CONTACT
        yield row(GROUP, f"{name} tangential stiffness", value, "Pa/m", number)
    yield row(GROUP, "largest slip", float(slip.slip.max()), "m")
    yield row(GROUP, COMPARED[2], slip.lost_energy, "J")


def _loop(cycle: pd.DataFrame) -> Any:
    """Loop of tangential force and displacement; first loading is half of the way back, reversed."""
    from asperity.core.units import scaled_unit
    from asperity.views.panels import canvas

    factors, symbols = zip(*map(scaled_unit, cycle.abs().max(), ("N", "m")), strict=True)
    force, displacement = (cycle.to_numpy() / factors).T
    back = slice(force.size // 2 + 1)
    with canvas([0.8], None) as (figure, (axis,), _):
        axis.plot(displacement, force, "-o", ms=3)
        axis.plot((displacement[0] - displacement[back]) / 2, (force[0] - force[back]) / 2, "--")
        axis.set(xlabel=f"tangential displacement ({symbols[1]})", ylabel=f"tangential force ({symbols[0]})")
    return figure
