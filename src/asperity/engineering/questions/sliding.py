"""Gross sliding: a shear traction of friction times pressure, which enters the stress."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from typing import Annotated, Any

import numpy as np
from pydantic import PlainValidator, PrivateAttr, WithJsonSchema

from asperity.core.types import Progress
from asperity.core.units import shown_si
from asperity.elasticity.two_bodies import sliding_coupling
from asperity.engineering.face import RoughFace
from asperity.engineering.question import Findings, Question, Stages
from asperity.engineering.records import Advice, per_cent
from asperity.engineering.scene import Scene
from asperity.settings.model import NeededError, Number, optional, setting
from asperity.surface.roughness import STRONG_LAY, texture
from asperity.surface.treatment.treatment import TreatedMap

NEGLECTED_COUPLING = 0.1
"""Relative change of a displacement by friction above which a warning is given."""

MAX_FRICTION = 10.0
"""Largest coefficient of friction."""


def _direction(value: Any) -> str | float:
    """Direction x or y, or an angle in degrees."""
    if value in ("x", "y"):
        return str(value)
    with suppress(TypeError, ValueError, OverflowError):
        if not isinstance(value, bool) and math.isfinite(angle := float(value)):
            return angle
    raise NeededError("x, y or an angle in degrees from x towards y")


Direction = Annotated[
    str | float,
    PlainValidator(_direction),
    WithJsonSchema({"type": ["number", "string"], "accepts": "x, y or an angle in degrees from x towards y"}),
]


class Sliding(Question):
    """Gross sliding of the bodies.

    The shear traction is the coefficient of friction times the pressure. The pressure is computed without
    friction.
    """

    friction: Number = setting(0.0, ge=0, le=MAX_FRICTION, example=0.1, varied=True)
    """Coefficient of friction in gross sliding; it enters the stress, not the pressure. Requires half-spaces,
    coated or not, or bonded layers."""
    direction: Direction | None = optional(
        "with friction the axis nearest to the lay of the map; x without a lay"
    )
    """Direction in which the counter body moves over the body."""
    _chosen: str = PrivateAttr("")

    def along_lay(self, face: TreatedMap) -> Sliding:
        """The same friction in the given direction, else along the axis nearest to the lay of a map."""
        if self.direction is not None or not self.friction:
            return self
        _, ratio, lay = texture(face.height, face.grid.spacing)
        has_lay = ratio < STRONG_LAY
        found = self.replaced(direction="y" if has_lay and 45 < lay < 135 else "x")
        at = f"the lay of the map is at {lay:.0f}° from x"
        found._chosen = at if has_lay else "the map has no strong lay"
        return found

    def along(self, first: Sliding) -> Sliding:
        """The direction of the first of several maps, unless one was given."""
        return self.replaced(direction=first.direction) if self._chosen else self

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """Bodies that bear no shear."""
        for name, body in case.groups_of_bodies.items():
            if self.friction and body.base == "frictionless":
                needed = f"0 is needed with {name}.base = frictionless, which bears no shear"
                yield "sliding.friction", f" = {self.friction:g}: {needed}"

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Direction and force of friction, and the change of the displacement by the neglected friction."""
        if not self.friction:
            return Findings()
        warnings = [*self._warnings(stages)]
        if "partial_slip" in stages.asked.questions:
            return Findings(warnings=warnings)
        along, force = stages.asked.along, shown_si(self.friction * stages.numbers.force, "N", 3)
        return Findings(
            verdict=f"the counter body slides along {along} against a friction force of {force} on the map",
            warnings=warnings,
            assumption="In gross sliding the shear traction is the coefficient of friction times the "
            "pressure; the pressure is computed without friction.",
        )

    def _warnings(self, stages: Stages) -> Iterator[Advice]:
        """Direction that was not given; change of the displacement by the neglected friction."""
        if self._chosen:
            along = f"no direction is given: the faces slide along {self.direction}, as {self._chosen}"
            text = f"{along}. The stress depends on the direction (sliding.direction)."
            yield Advice(False, "direction of sliding", text)

        face = stages.face
        wave = np.geomspace(face.wavelength_short, max(face.grid.period), 100)
        change = self.friction * sliding_coupling(stages.asked.solid, 2 * np.pi / wave)
        most = int(change.argmax())
        size, where = float(change[most]), shown_si(wave[most], "m", 3)
        if not size > 0:  # between equal bodies
            return
        text = f"Friction would change waves of wavelength {where} by up to {per_cent(size)}, and waves of "
        text += f"{shown_si(wave[0], 'm', 3)} by up to {per_cent(change[0])}."
        waves = f"waves of wavelength {where}"
        if most == 0:
            waves = "waves of every wavelength"
            text = f"Friction would change {waves} by up to {per_cent(size)}."
        text = f"the contact is solved without friction. {text}"
        short = f"friction: the contact is solved without it; {waves} have an error of up to {per_cent(size)}"
        yield Advice(size > NEGLECTED_COUPLING, "friction in the contact", text, short, size)
