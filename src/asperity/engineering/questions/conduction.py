"""Conduction of heat and current through the contact."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from asperity.engineering.question import IN_FULL_CONTACT, Question, Row

if TYPE_CHECKING:
    from asperity.engineering.answer import Answer
    from asperity.engineering.case import Case

CONSTANTS = ("conductivity", "resistivity")
"""Constants of a body; a conductance needs those of both bodies."""

UNITS = {"thermal_conductance": "W/(m² K)", "electrical_conductance": "S/m²"}
"""Conductance per nominal area → its unit."""


class Conduction(Question):
    """Contact conductance, thermal and electrical, of two half-spaces.

    It follows from the stiffness of the contact (J. R. Barber, Proc. R. Soc. A 459 (2003) 53, doi
    10.1098/rspa.2002.1038), without films and without what passes through the gap.
    """

    @classmethod
    def is_implied(cls, case: Case) -> bool:
        """True if a body gives a conductivity or resistivity itself."""
        return any(body.gives(name) for body in case.groups_of_bodies.values() for name in CONSTANTS)

    def check(self, case: Case) -> Iterator[tuple[str, str]]:
        """Constants that one body lacks, and bodies that are no half-spaces."""
        if case.elastic_counter_body is None:
            yield "conduction", ": a counter_body is needed, elastic and with its own constants"
            return
        bodies = case.groups_of_bodies
        for name, body in bodies.items():
            if body.layer is not None or body.coating is not None:
                yield (
                    f"{name}.{'coating' if body.layer is None else 'layer'}",
                    ": not accepted with conduction",
                )
        half = []
        for constant in CONSTANTS:
            missing = [name for name, body in bodies.items() if getattr(body, constant) is None]
            if len(missing) == 1 and any(body.gives(constant) for body in bodies.values()):
                half.append((f"{missing[0]}.{constant}", ": missing; those of both bodies are needed"))
        yield from half
        if not half and not resistivities(case):
            yield "conduction", ": conductivity or resistivity of both bodies is needed"

    def rows(self, answer: Answer) -> Iterator[Row]:
        """Conductance per nominal area."""
        for name, resistivity in resistivities(answer.case).items():
            value, unit = answer.contact.conductance(resistivity), UNITS[name]
            number = IN_FULL_CONTACT if math.isinf(value) else f"{value:.4g} {unit}"
            yield Row(
                "contact", name.replace("_", " contact "), value, unit, f"{number}, without films and gap"
            )


def resistivities(case: Case) -> dict[str, float]:
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
