"""Running-in: first loads flatten the map at the hardness; the answer is the elastic contact after them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from asperity.contact import Contact
from asperity.core.types import Progress
from asperity.core.units import shown_si
from asperity.engineering.face import RoughFace
from asperity.engineering.press import mean_pressure, press
from asperity.engineering.question import Findings, Question, Stages
from asperity.engineering.records import POSITIVE, Advice, Bounds, Record, fraction
from asperity.engineering.scene import Scene
from asperity.settings.model import Whole, optional, setting
from asperity.settings.quantities import Pressure
from asperity.surface.roughness import roughness_parameters

UNCHANGED = 1e-6
"""Plastic depth of another load, over the range of heights, below which it changes nothing: the error of the
contact."""


@dataclass(frozen=True, eq=False)
class Flattening:
    """The first contact, and the largest depth by which each load has flattened the map."""

    first: Contact
    depths: list[float]

    @property
    def another(self) -> float:
        """Flattening by one more load over the flattening by the first load (largest depths)."""
        return self.depths[-1] / self.depths[0] if self.depths[0] else 0.0


class RunningIn(Question):
    """Running-in: first loads, as large as the load of the case, flatten the map.

    Where the pressure reaches the hardness, a load flattens the map by the overlap of the bodies. The answer
    describes the elastic contact of the flattened map under the same load.
    """

    ASKS = "What remains after running-in?"
    TILES = ("maximum flattening of the first load",)

    loads: Whole = setting(1, ge=1, le=20, example=1)
    """Number of loads that flatten the map before the answer."""
    hardness: Pressure | None = optional("the smaller hardness of the bodies", example="7 GPa", varied=True)
    """Hardness at which the first loads flatten the map."""

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """A hardness that is missing or not above the load, and moving faces."""
        hardness = self.hardness or case.hardness
        if hardness is None:
            yield "running_in.hardness", ": missing; a pressure above the mean pressure is needed"
        elif not (mean := mean_pressure(case, rough)) < hardness:
            least = f"more than the mean pressure {shown_si(mean, 'Pa')} is needed"
            yield "running_in.hardness", f" = {shown_si(hardness, 'Pa')}: {least}"
        cycles = case.questions.get("cycles")
        if cycles is not None and cycles.shifts is not None and case.counter_map is not None:
            refused = "running_in and cycles.shifts, which press each face many times"
            yield "counter_body.map", f": not accepted with {refused}"

    def cost(self, case: Scene, is_mirrored: bool) -> tuple[float, float]:
        """A contact for each load, and one more."""
        return 0.5 * (self.loads + 1), 0.0

    def prepare(self, case: Any, rough: RoughFace, progress: Progress) -> tuple[Any, RoughFace, Flattening]:
        """The elastic case and the flattened map."""
        # A film carries a part of the pressure that reaches the hardness, and `case` holds the rest.
        hardness, face = case.questions["running_in"].hardness or case.hardness or math.inf, rough.face
        first: Contact | None = None
        depths: list[float] = []
        for number in range(self.loads + 1):  # the last one shows if another load changes anything
            contact = press(face, case, hardness=hardness)
            depth = 0.0 if contact.plastic_depth is None else float(contact.plastic_depth.max())
            first, depths = first or contact, [*depths, depth]
            if number < self.loads:
                face = replace(face, height=contact.flattened_height())
            progress(number + 1, self.loads + 1)
        assert first is not None
        times = f"{self.loads} load{'s' * (self.loads > 1)} at a hardness of {shown_si(hardness, 'Pa')}"
        times += " beside the pressure of the film" if "film" in case.questions else ""
        done = f"flattened by {times}, by up to {shown_si(depths[0], 'm', 3)} at the first"
        face = replace(face, done=(*face.done, done))
        elastic = {name: body.replaced(hardness=math.inf) for name, body in case.groups_of_bodies.items()}
        asked = {"running_in": self.replaced(hardness=hardness), "sensitivity": None}
        case = case.replaced(**elastic, **asked)
        return case, rough._replace(face=face), Flattening(first, depths)

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """The first contact, the depth of flattening, and the depth by which another load would flatten."""
        found: Flattening = stages.prepared["running_in"]
        first, depth, topic = found.first, found.depths[0], "running-in"
        words, note, another = "none, without wear and hardening", "", 0.0
        if found.depths[-1] > UNCHANGED * stages.numbers.peak_to_valley:
            another = found.depths[-1]
            words, note = "", f"{100 * found.another:.2g} % of the first"
        volume = 0.0 if first.plastic_depth is None else float(first.plastic_depth.mean())
        before, after = roughness_parameters(first.height, first.grid), stages.numbers

        def of_both(quantity: str, value: float, later: float, unit: str = "1") -> Record:
            shown = f"{later:.3g}" if unit == "1" else shown_si(later, unit, 3)
            change = f", {100 * (later / value - 1):+.2g} %" if value else ""
            return Record(quantity, value, unit, topic, note=f"after running-in {shown}{change}")

        area = 100 * after.contact_area_fraction
        records = [
            fraction(
                "contact area fraction of the first load",
                first.contact_area_fraction,
                topic=topic,
                note=f"after running-in {area:.3g} %",
            ),
            of_both(
                "maximum pressure of the first load", first.maximum_pressure, after.maximum_pressure, "Pa"
            ),
            of_both("Sq before the first load", before.rms_height, after.rms_height, "m"),
            of_both("Sdq before the first load", before.rms_gradient, after.rms_gradient),
            fraction("area fraction at the hardness of the first load", first.plastic_area, topic=topic),
            Record("maximum flattening of the first load", depth, "m", topic),
            Record("volume flattened by the first load per area", volume, "m", topic, bounds=POSITIVE),
            Record("flattening by another load", another, "m", topic, words=words, note=note),
        ]
        nothing = "the first load stays below the hardness everywhere: it flattens nothing."
        heights = (shown_si(each.rms_height, "m", 3) for each in (before, after))
        verdict = (
            f"the first load flattens the surface by up to {shown_si(depth, 'm', 3)}, and changes Sq from "
        )
        verdict += f"{' to '.join(heights)}; wear and hardening are not included, so that it is not decided "
        verdict += "whether the surface runs in further"
        return Findings(
            records=records,
            verdict=verdict if depth else "",
            bounds={"maximum pressure": Bounds(0.0, first.hardness, "the hardness at running-in")}
            if stages.asked.load.kind not in ("contact_area_fraction", "normal_approach")
            else {},
            warnings=[] if depth else [Advice(False, "running-in", nothing)],
            assumption="Running-in flattens the surface where the pressure reaches the hardness, without "
            "residual stress, pile-up or wear; numbers hold for the elastic contact after it.",
        )
