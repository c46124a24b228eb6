"""Yield: the volume whose von Mises stress is above the yield stress, its depths, and peaks above it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.core.types import Array, Progress
from asperity.core.units import shown_si
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.engineering.body_stress import BodyStress, largest_von_mises_between
from asperity.engineering.places import Blocks
from asperity.engineering.press import HARDNESS_OVER_YIELD
from asperity.engineering.question import Findings, Pressed, Question, Stages
from asperity.engineering.records import (
    PLANES,
    POSITIONS,
    POSITIVE,
    Advice,
    Record,
    fraction,
    per_cent,
)
from asperity.engineering.scene import Scene

if TYPE_CHECKING:
    from asperity.engineering.face import RoughFace
    from asperity.stress.exceedance import Exceedance
    from asperity.stress.planes.stream import LinearPlane


class Yielded:
    """Part of a body whose von Mises stress is above yield, from a stream of planes below its coating.

    Attributes
    ----------
    exceedance : Exceedance
        Volume and depths above the yield stress.
    """

    def __init__(self, limit: float, pressed: Pressed, loaded: LoadedSolid) -> None:
        from asperity.stress.exceedance import Exceedance

        self.exceedance: Exceedance = Exceedance(limit, pressed.face.boundary == "periodic")
        self._limit, self._face, self._blocks = limit, pressed.face, pressed.blocks
        self._poisson, self._below = loaded.layer.poisson, loaded.layer.interface or -1.0
        self._last: tuple[float, Array] | None = None
        self._means: Array | float = 0.0

    def add(self, plane: LinearPlane) -> None:
        """Add the next plane downward; blocks of the map take their mean depth above yield by trapezoids."""
        if plane.depth <= self._below:
            return
        values = plane.field("von_mises", self._poisson)
        self.exceedance.add(plane.depth, plane.grid, values)
        if self._blocks is not None:
            share = self._blocks.means(values[self._face.part_of(plane.grid)] > self._limit)
            if self._last is not None:
                depth, above = self._last
                self._means = self._means + (plane.depth - depth) * (share + above) / 2
            self._last = plane.depth, share

    def error_of_positions(self, blocks: Blocks | None) -> float:
        """Relative error of the volume between measurement positions; NaN where it is not known."""
        if blocks is None or not self.exceedance.volume:
            return np.nan
        return blocks.error(np.asarray(self._means))


class Yielding(Question):
    """Volume above the yield stress of the bodies; below its coating of a coated body."""

    ASKS = "Where does it yield?"
    TILES = ("maximum von Mises stress", "volume above yield per area", "volume fraction above yield")
    LEAD = "section"

    @classmethod
    def is_implied(cls, case: Scene) -> bool:
        """True if a body or its material has a yield stress."""
        return any(body.yield_stress is not None for body in case.groups_of_bodies.values())

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """Bodies without a yield stress."""
        if not self.is_implied(case):
            yield "yielding", ": a yield_stress of a body is needed"

    def observer(self, pressed: Pressed, body: str, loaded: LoadedSolid) -> Yielded | None:
        """The volume above yield, from the planes below a coating."""
        limit = pressed.asked.bodies[body].yield_stress
        return None if limit is None else Yielded(limit, pressed, loaded)

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Volume, depths and peaks above yield of each body, and whether its materials yield."""
        records: list[Record] = []
        attributes: dict[str, dict[str, Any]] = {}
        depths: dict[str, tuple[float, float] | None] = {}
        for body in stages.asked.different_bodies:
            part = stages.bodies[body]
            found: Yielded | None = part.observed.get("yielding")
            if found is not None:
                top = np.nextafter(part.layer.interface, np.inf) if part.layer.interface else 0.0
                found.exceedance.finish(largest_von_mises_between(part.stress, top, np.inf).value)
                records += self._records(stages, body, found)
                depths[body] = found.exceedance.depths
                volume = found.exceedance.volume * stages.face.grid.area
                attributes[body] = {"yield_stress": part.body.yield_stress, "volume_above_yield": volume}
        materials = [*_materials(stages)]
        verdict = "; ".join(_verdict(*each, depths.get(each[1]), records) for each in materials)
        warnings = [
            advice
            for each in materials
            if (advice := _warning(stages, *each, depths.get(each[1]))) is not None
        ]
        return Findings(records=records, verdict=verdict, warnings=warnings, attributes=attributes)

    def _records(self, stages: Stages, body: str, found: Yielded) -> Iterator[Record]:
        """Volume, depths and peaks above yield in a body."""
        part, area, above = stages.bodies[body], stages.face.grid.area, found.exceedance
        of: dict[str, Any] = {"topic": "stress", "body": body}
        limit = part.body.yield_stress
        stress = part.stress
        peaks = stress.sel(peak=(stress["peak_quantity"] == "von_mises").values)
        deep = peaks["peak_depth"].values > (part.layer.interface or -1.0)
        count = int(((peaks["peak_value"].values > limit) & deep).sum())
        error = above.error(part.limits, _count_above(part, limit))
        positions = found.error_of_positions(stages.blocks)
        worse: dict[str, Any] = of | {"varies": True, "better": "less"}
        yield Record("yield stress", limit, "Pa", **of)
        per_area = Record("volume above yield per area", above.volume, "m", bounds=POSITIVE, **worse)
        if above.depths is None:
            none = "none: everything stays elastic"
            yield Record("volume above yield", 0.0, "m^3", words=none, **worse)
            extrapolated = 0.0 if error == 0 else np.nan  # far below yield: it is known to be zero
            yield replace(per_area, extrapolated=extrapolated).with_error(PLANES, error)
        else:
            first, last = above.depths
            volume = Record("volume above yield", above.volume * area, "m^3", bounds=POSITIVE, **worse)
            share = fraction("volume fraction above yield", above.volume / last, **worse)
            share = replace(share, note=f"of the volume down to {shown_si(last, 'm', 3)}")
            for each in (volume, per_area, share):
                size = each.value / above.volume
                yield each.with_error(PLANES, error * size).with_error(POSITIONS, positions * each.value)
            note = f"from a depth of {shown_si(first, 'm', 3)}" if first else "from the surface"
            yield Record("maximum depth above yield", last, "m", note=note, **worse)
        yield Record("peaks above yield", count / stages.numbers.nominal_area, "1/m^2", **worse)


def _count_above(part: BodyStress, limit: float | None) -> int:
    """Number of peaks of the von Mises stress in the solid above a limit."""
    from asperity.stress.peaks.selection import select_peaks

    return int((select_peaks(part.stress, "von_mises")["peak_value"] > limit).sum())


def _materials(stages: Stages) -> Iterator[tuple[str, str, BodyStress]]:
    """Words for each material with a yield stress, its body, and the stress in it.

    Of two bodies of one material the first alone.
    """
    bodies, names = list(stages.asked.bodies.values()), list(stages.asked.different_bodies)
    for name in names[:1] if bodies[0].is_like(bodies[-1]) else names:
        for material, part in stages.bodies[name].materials.items():
            if part.body.yield_stress is not None:
                of = f" of the {name} body" if len(names) > 1 and not bodies[0].is_like(bodies[-1]) else ""
                yield f"the {material or 'material'}{of}", name, part


def _verdict(
    what: str, body: str, part: BodyStress, depths: tuple[float, float] | None, records: list[Record]
) -> str:
    """Yield of a material, its depth and the maximum stress."""
    limit, stress = part.body.yield_stress, part.von_mises.value
    ratio = f"{stress / limit:.3g} times its yield stress, {shown_si(limit, 'Pa', 3)}"
    if stress <= limit:
        return f"{what} stays elastic, with at most {ratio}"
    if depths is None or what.startswith("the coating"):
        return f"{what} yields, with up to {ratio}"
    share = next(
        each.value for each in records if each.body == body and each.quantity.startswith("volume fraction")
    )
    return f"{what} yields: {per_cent(share)} of its volume down to {shown_si(depths[1], 'm', 3)}, with up to {ratio}"


def _warning(
    stages: Stages, what: str, body: str, part: BodyStress, depths: tuple[float, float] | None
) -> Advice | None:
    """Stress above the yield stress of a material."""
    limit, stress = part.body.yield_stress, part.von_mises.value
    if stress <= limit:
        return None
    affected, of = "", what.removeprefix("the material").replace("the ", " of the ", 1)
    if depths is not None and not what.startswith("the coating"):
        first, last = (shown_si(depth, "m", 3) for depth in depths)
        affected = f"; depths from {first if depths[0] else 'the surface'} to {last} are affected"
    text = f"the maximum von Mises stress{of}, {shown_si(stress, 'Pa', 3)}, is {stress / limit:.3g} times the "
    text += f"yield stress of {shown_si(limit, 'Pa', 3)}"
    # The hardness that a yield stress suggests holds for the surface.
    if stages.case.hardness is None and not what.startswith("the base"):
        hardness = shown_si(HARDNESS_OVER_YIELD * limit, "Pa", 3)
        affected = f". This is an elastic result only: real material flows there{affected}. The pressure stays "
        affected += f"below the hardness, about {hardness}, and the contact area grows; body.hardness limits "
        affected += "the pressure"
    return Advice(True, "stress beyond yield", f"{text}{affected}.")
