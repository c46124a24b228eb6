"""Conduction of heat and current through the contact."""

import math
from collections.abc import Iterator

from asperity.core.types import Progress
from asperity.core.units import shown_si
from asperity.engineering.face import RoughFace
from asperity.engineering.question import IN_FULL_CONTACT, Findings, Question, Stages
from asperity.engineering.records import Record
from asperity.engineering.scene import Scene

TOPIC = "conduction"

CONSTANTS = ("conductivity", "resistivity")
"""Constants of a body; a conductance needs the constant of both bodies."""

UNITS = {"thermal_conductance": "W/(m² K)", "electrical_conductance": "S/m²"}
"""Conductance per nominal area → its unit."""


class Conduction(Question):
    """Contact conductance, thermal and electrical, of two half-spaces.

    It follows from the stiffness of the contact (J. R. Barber, Proc. R. Soc. A 459 (2003) 53, doi
    10.1098/rspa.2002.1038), without films and without conduction through the gap.
    """

    ASKS = "How well does the contact conduct?"
    TILES = (
        *("electrical contact resistance", "constriction of the nominal area"),
        "thermal contact conductance",
    )

    @classmethod
    def is_implied(cls, case: Scene) -> bool:
        """True if a body gives a conductivity or resistivity itself."""
        return any(body.gives(name) for body in case.groups_of_bodies.values() for name in CONSTANTS)

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """Constants that one body lacks, and bodies that are no half-spaces."""
        if case.elastic_counter_body is None:
            yield "conduction", ": a counter_body is needed, elastic and with its own constants"
            return
        yield from ((key, ": not accepted with conduction") for key in case.layers_and_coatings)
        bodies, half = case.groups_of_bodies, []
        for constant in CONSTANTS:
            missing = [name for name, body in bodies.items() if getattr(body, constant) is None]
            if len(missing) == 1 and any(body.gives(constant) for body in bodies.values()):
                half.append((f"{missing[0]}.{constant}", ": missing; values of both bodies are needed"))
        yield from half
        if not half and not resistivities(case):
            yield "conduction", ": conductivity or resistivity of both bodies is needed"

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Conductances per nominal area, the electrical resistance, and the constriction of that area.

        The resistance of the bodies around it is (ρ₁ + ρ₂) / (4 α) for a circle of radius α (R. Holm,
        Electric Contacts, 1967, §1; J. A. Greenwood, Br. J. Appl. Phys. 17 (1966) 1621, DOI
        10.1088/0508-3443/17/12/310).
        """
        records, found, area = [], [], stages.face.grid.area
        for name, resistivity in sorted(resistivities(stages.asked).items()):  # current before heat
            value, unit = stages.contact.conductance(resistivity), UNITS[name]
            if name == "electrical_conductance" and value > 0:
                resistance = 1 / (value * area)
                note = f"on the nominal area of {shown_si(area, 'm^2')}, without films"
                records.append(Record("electrical contact resistance", resistance, "Ω", TOPIC, note=note))
                found.append(f"the contact spots resist the current with {shown_si(resistance, 'Ω', 3)}")
            if name == "electrical_conductance" and stages.face.boundary == "periodic":
                around = resistivity / (4 * math.sqrt(area / math.pi))
                note = "in addition (Holm), if wider bodies touch only on this area"
                records.append(Record("constriction of the nominal area", around, "Ω", TOPIC, note=note))
                found.append(f"bodies that touch only on this area add {shown_si(around, 'Ω', 3)} (Holm)")
            if name == "thermal_conductance":
                found.append(f"the contact spots conduct heat with {value:.3g} {unit}")
            words, quantity = IN_FULL_CONTACT if math.isinf(value) else "", name.replace("_", " contact ")
            records.append(Record(quantity, value, unit, TOPIC, words=words, note="without films"))
        return Findings(
            records=records,
            verdict="; ".join([*found, "films, oxides and the gap are left out"]),
            assumption="Heat and current pass through the contact spots alone, not through films, oxides or "
            "the gap.",
        )


def resistivities(case: Scene) -> dict[str, float]:
    """Name of a conductance → sum of the resistivities of both bodies, thermal or electrical."""
    bodies, found = list(case.bodies.values()), {}
    if "conduction" in case.questions and len(bodies) == 2:
        heat = [body.conductivity for body in bodies if body.conductivity is not None]
        current = [body.resistivity for body in bodies if body.resistivity is not None]
        if len(heat) == 2:
            found["thermal_conductance"] = sum(1 / each for each in heat)
        if len(current) == 2:
            found["electrical_conductance"] = sum(current)
    return found
