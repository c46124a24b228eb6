"""Partial slip: a tangential force below the limit of friction, under which part of the contact sticks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr

from asperity.contact import Contact
from asperity.core.types import Progress
from asperity.core.units import scaled_unit, shown_si
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.face import RoughFace
from asperity.engineering.question import (
    IN_FULL_CONTACT,
    Findings,
    Picture,
    Question,
    Stages,
    advice_on_pixels,
    on_map,
)
from asperity.engineering.records import Advice, Bounds, Record, fraction, per_cent
from asperity.engineering.scene import Scene
from asperity.settings.model import optional
from asperity.settings.quantities import Force, Length

if TYPE_CHECKING:
    from asperity.contact.slip import PartialSlip as Slip

TOPIC = "partial slip"

COMPARED = (
    "tangential displacement",
    "sticking area fraction of the contact",
    "energy lost in a cycle ± force",
)
"""Numbers that are also computed on pixels twice as large."""

CYCLE_STEPS = 6
"""Steps of first loading in the cycle: chords enclose 97 % of the energy, and cost five more contacts."""

UNEVEN = 0.1
"""A warning is given if sticking nodes move unevenly by more than this fraction of the displacement."""

CYCLE_CAPTION = (
    "Tangential force against tangential displacement in a cycle between the force and its opposite, after "
    "the first loading (dashed). The loop encloses the energy that a cycle loses."
)


class PartialSlip(Question):
    """Partial slip under a tangential load, instead of gross sliding; see `asperity.contact.partial_slip`."""

    ASKS = "Does it slip under a tangential load?"
    TILES = COMPARED
    LEAD = "slip"
    FILES = ("partial_slip", "cycle", "shear_traction", "slip")

    tangential_force: Force | None = optional("a displacement is given", example="50 mN")
    """Tangential force on the map, at most friction times load. Below that limit part of the contact
    sticks."""
    tangential_displacement: Length | None = optional("a force is given", example="20 nm")
    """Tangential displacement of the bodies instead of a force, on half-spaces."""

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
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
        for name, body in case.groups_of_bodies.items():
            if body.hardness not in (None, math.inf) and not body.hardness_is_estimated:
                origin = "given" if body.gives("hardness") else "from its material"
                hardness = f"the hardness is {shown_si(body.hardness, 'Pa')}, {origin}"
                yield "partial_slip", f": requires an elastic contact; set {name}.hardness: inf ({hardness})"
        if self.tangential_displacement is not None and case.solid.uniform_compliance():
            needed = ": half-spaces are needed, or a tangential_force on layers"
            yield "partial_slip.tangential_displacement", needed

    def cost(self, case: Scene, is_mirrored: bool) -> tuple[float, float]:
        """A contact, and the contacts of the cycle."""
        return 1.5, 2.5

    def tractions(self, case: Scene, contact: Contact) -> xr.Dataset:
        """Pressure of the part that sticks, and slip; above friction times load the bodies slide."""
        slip, title = self._slip(case, contact), "Partial slip under a tangential force"
        return on_map(contact, title, sticking_pressure=slip.sticking.pressure, slip=slip.slip)

    def _slip(self, case: Scene, contact: Contact) -> Slip:
        """A contact of the case under the tangential load."""
        from asperity.contact.slip import ALL_SLIPS, partial_slip

        given: dict[str, Any] = {"tangential_displacement": self.tangential_displacement}
        if self.tangential_force is not None:
            given = {"tangential_force": min(self.tangential_force, case.friction * contact.force)}
        direction = case.sliding_direction
        try:
            return partial_slip(contact, case.friction, sliding_direction=direction, **given)
        except ValueError as error:
            if not str(error).endswith(ALL_SLIPS):
                raise
        given = {"tangential_force": case.friction * contact.force}
        return partial_slip(contact, case.friction, sliding_direction=direction, **given)

    def loaded(self, loaded: LoadedSolid, contact: Contact, tractions: xr.Dataset | None) -> LoadedSolid:
        """A body under pressure and tangential load."""
        assert tractions is not None
        return replace(loaded, sticking_pressure=tractions["sticking_pressure"].values)

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Force, displacement, sticking part, stiffness, slip, lost energy, and their errors."""
        slip, on_half = (self._slip(stages.asked, each) for each in (stages.contact, stages.coarse.contact))
        fine, coarse = [*_records(slip)], {each.quantity: each.value for each in _records(on_half)}
        warnings = [*self._warnings(slip)]
        values = {each.quantity: each.value for each in fine}
        warnings.append(advice_on_pixels("slip", values, {name: coarse[name] for name in COMPARED}))
        cycle, units = slip.cycle(CYCLE_STEPS), {"tangential_force": "N", "tangential_displacement": "m"}
        table = pd.DataFrame({f"{name}_{unit}": cycle[name].values for name, unit in units.items()})
        return Findings(
            records=fine,
            verdict=_verdict(slip),
            warnings=warnings,
            assumption="The tangential force has grown once from zero; the faces stick where the shear "
            "traction is below friction times pressure, and the pressure is computed without friction.",
            tables={"cycle": table},
        )

    def _warnings(self, slip: Slip) -> Iterator[Advice]:
        """Gross sliding, and the error of the superposition."""
        limit = slip.friction * slip.contact.force
        if self.tangential_displacement is not None and not slip.sticking.force:
            text = f"the bodies slide: all slips from {shown_si(slip.displacement, 'm')} on."
            yield Advice(True, "gross sliding", text)
        if self.tangential_force is not None and self.tangential_force >= limit:
            force, most = shown_si(self.tangential_force, "N"), shown_si(limit, "N")
            text = f"the bodies slide: {force} is not below friction times load, {most}, which is the "
            yield Advice(True, "gross sliding", f"{text}tangential force of this answer.")
        size = slip.deviation
        if size > 0:
            text = "the superposition of partial slip neglects that the displacement under a shear traction "
            text += "depends on the direction of its waves: nodes that stick are displaced unevenly, by "
            text += f"{per_cent(size)} (rms) of the tangential displacement."
            short = f"partial slip: sticking nodes are displaced unevenly by {per_cent(size)}"
            yield Advice(size > UNEVEN, "superposition of partial slip", text, short, size)

    def pictures(self, answer: AnswerData) -> Iterator[Picture]:
        """Maps of traction and slip, and the loop of force and displacement."""
        from asperity.engineering.drawing import map_of_contact
        from asperity.views.maps import SHEAR_TRACTION, SLIP

        fields = answer.datasets["partial_slip"]
        traction = answer.case.friction * (answer.contact.pressure - fields["sticking_pressure"].values)
        caption = "Shear traction by the tangential force"
        yield map_of_contact(answer, "shear_traction", traction, SHEAR_TRACTION, caption)
        caption = "Slip of the faces under the tangential force, white within the outlines where they stick"
        yield map_of_contact(answer, "slip", fields["slip"].values, SLIP, caption)
        yield Picture("cycle", CYCLE_CAPTION, _loop(answer.tables["cycle"]))


def _verdict(slip: Slip) -> str:
    """Gross sliding, or else the part of the contact that sticks, and the displacement."""
    force, moved = shown_si(slip.tangential_force, "N", 3), shown_si(slip.displacement, "m", 3)
    if slip.tangential_force >= slip.friction * slip.contact.force:
        return f"the bodies slide, with the force of friction, {force}"
    stick = f"{per_cent(slip.sticking_area)} of the contact sticks and the rest slips"
    return f"under a tangential force of {force} the bodies move by {moved}; {stick}"


def _records(slip: Slip) -> Iterator[Record]:
    """Numbers of partial slip on a map."""
    force, limit = slip.tangential_force, slip.friction * slip.contact.force
    note = f"{100 * force / limit:.4g} % of friction times load"
    yield Record("tangential force", force, "N", TOPIC, note=note, bounds=Bounds(0.0, limit, "gross sliding"))
    yield Record("tangential displacement", slip.displacement, "m", TOPIC)
    yield fraction(COMPARED[1], slip.sticking_area, topic=TOPIC, note="the rest slips")
    for name, value in (("first", slip.initial_stiffness), ("last", slip.stiffness)):
        words = "" if np.isfinite(value) else IN_FULL_CONTACT
        yield Record(f"{name} tangential stiffness", value, "Pa/m", TOPIC, words=words)
    yield Record("maximum slip", float(slip.slip.max()), "m", TOPIC)
    yield Record(COMPARED[2], slip.lost_energy, "J", TOPIC)


def _loop(cycle: pd.DataFrame) -> Any:
    """Loop of tangential force and displacement; first loading is half of the way back, reversed."""
    from asperity.views.panels import canvas

    factors, symbols = zip(*map(scaled_unit, cycle.abs().max(), ("N", "m")), strict=True)
    force, displacement = (cycle.to_numpy() / factors).T
    back = slice(force.size // 2 + 1)
    with canvas([0.8], None) as (figure, (axis,), _):
        axis.plot(displacement, force, "-o", ms=3)
        axis.plot((displacement[0] - displacement[back]) / 2, (force[0] - force[back]) / 2, "--")
        axis.set(xlabel=f"tangential displacement ({symbols[1]})", ylabel=f"tangential force ({symbols[0]})")
    return figure
