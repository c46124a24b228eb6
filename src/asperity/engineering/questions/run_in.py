"""Run-in: first loads flatten the map at the hardness, and the answer is the elastic contact after them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from asperity.core.units import shown_si
from asperity.engineering.question import Advice, Question, Row, row
from asperity.settings.model import Whole, optional, setting
from asperity.settings.quantities import Pressure

if TYPE_CHECKING:
    from asperity.engineering.question import Answer, Case, Contact, Progress, RoughFace

GROUP = "run-in"

UNCHANGED = 1e-6
"""Plastic depth of another load, over the range of heights, below which it changes nothing: the error of the
contact."""


@dataclass(frozen=True, eq=False)
class RunInResult:
    """The first contact, and the largest depth by which each load has flattened the map."""

    first: Contact
    depths: list[float]

    @property
    def another(self) -> float:
        """Flattening by one more load over the flattening by the first load (largest depths)."""
        return self.depths[-1] / self.depths[0] if self.depths[0] else 0.0


class RunIn(Question):
    """Run-in: first loads, as large as the load of the case, flatten the map.

    Where the pressure reaches the hardness, a load flattens the map by the overlap of the bodies. The answer
    describes the elastic contact of the flattened map under the same load.
    """

    loads: Whole = setting(1, ge=1, le=20, example=1)
    """Number of loads that flatten the map before the answer."""
    hardness: Pressure | None = optional("the smaller hardness of the bodies", example="7 GPa")
    """Hardness at which the first loads flatten the map."""

    def check(self, case: Case) -> Iterator[tuple[str, str]]:
        """A hardness that is missing or not above the load, and moving faces."""
        hardness = self.hardness or case.hardness
        if hardness is None:
            yield "running_in.hardness", ": missing; a pressure above the mean pressure is needed"
        elif case.load.kind in ("mean_pressure", "hertz_pressure") and not case.cell_pressure < hardness:
            least = f"more than the mean pressure {shown_si(case.cell_pressure, 'Pa')} is needed"
            yield "running_in.hardness", f" = {shown_si(hardness, 'Pa')}: {least}"
        if case.cycles is not None and case.cycles.shifts is not None and case.counter_map is not None:
            refused = "running_in and cycles.shifts, which press each face many times"
            yield "counter_body.map", f": not accepted with {refused}"

    def before_contact(self, case: Case, rough: RoughFace, progress: Progress) -> tuple[Case, RoughFace, Any]:
        """The elastic case and the flattened map."""
        from asperity.engineering.press import press

        hardness, face = self.hardness or case.hardness or math.inf, rough.face
        plastic = case.replaced(body=case.body.replaced(hardness=hardness))
        first: Contact | None = None
        depths: list[float] = []
        for number in range(self.loads + 1):  # the last one shows if another load changes anything
            contact = press(face, plastic)
            depth = 0.0 if contact.plastic_depth is None else float(contact.plastic_depth.max())
            first, depths = first or contact, [*depths, depth]
            if number < self.loads:
                face = replace(face, height=contact.flattened_height())
            progress(number + 1, self.loads + 1)
        assert first is not None
        times = f"{self.loads} load{'s' * (self.loads > 1)} at a hardness of {shown_si(hardness, 'Pa')}"
        done = f"flattened by {times}, by up to {shown_si(depths[0], 'm', 3)} at the first"
        face = replace(face, done=(*face.done, done))
        elastic = {name: body.replaced(hardness=math.inf) for name, body in case.groups_of_bodies.items()}
        return case.replaced(**elastic), rough._replace(face=face), RunInResult(first, depths)

    def verdict(self, answer: Answer) -> str:
        """Depth by which the first load flattens the map."""
        depth = answer.of(self).depths[0]
        return f"the first load flattens peaks by up to {shown_si(depth, 'm', 3)}" if depth else ""

    def rows(self, answer: Answer) -> Iterator[Row]:
        """The first contact, the depth of flattening, and the depth by which another load would flatten."""
        found: RunInResult = answer.of(self)
        first, area = found.first, found.first.area_fraction
        yield Row(GROUP, "real contact of the first load", area, "1", f"{100 * area:.4g} %")
        share = first.plastic_area
        yield Row(GROUP, "area at the hardness of the first load", share, "1", f"{100 * share:.4g} %")
        yield row(GROUP, "largest flattening of the first load", found.depths[0], "m")
        words = "none: it changes nothing"
        if found.depths[-1] > UNCHANGED * answer.numbers.peak_to_valley:
            words = f"{shown_si(found.depths[-1], 'm')}, {100 * found.another:.2g} % of the first"
        yield Row(GROUP, "flattening by another load", found.depths[-1], "m", words)

    def advice(self, answer: Answer) -> Iterator[Advice]:
        """Note if the first load flattens nothing."""
        found: RunInResult = answer.of(self)
        if not found.depths[0]:
            yield Advice(
                False, "run-in", "the first load stays below the hardness everywhere: it flattens nothing."
            )

    def assumption(self, answer: Answer) -> str:
        """Flattening without residual stress, pile-up or wear."""
        return (
            "Run-in flattens the surface where the pressure reaches the hardness, without residual stress,"
            " pile-up or wear; numbers hold for the elastic contact of the flattened surface."
        )
