"""Yield: the volume whose von Mises stress is above the yield stress, its depths, and peaks above it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from asperity.core.types import Array, Progress
from asperity.core.units import shown_si
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.engineering.answer_data import ALIKE
from asperity.engineering.face import RoughFace
from asperity.engineering.numbers import AT_SURFACE
from asperity.engineering.places import Blocks
from asperity.engineering.question import Findings, Pressed, Question, Stages
from asperity.engineering.records import (
    DISCRETISATION,
    LIMITED,
    PLANES,
    POSITIONS,
    POSITIVE,
    Advice,
    Record,
    find,
    fraction,
)
from asperity.engineering.scene import Scene
from asperity.settings.body import HARDNESS_OVER_YIELD, Body
from asperity.stress.peaks.selection import in_cell, select_peaks
from asperity.stress.planes.stream import LinearPlane

if TYPE_CHECKING:
    from asperity.stress.exceedance import Exceedance


class Yielded:
    """Volume of a material whose von Mises stress is above yield, from a stream of planes.

    Attributes
    ----------
    exceedance : Exceedance
        Volume and depths above the yield stress.
    between : (float, float)
        Depths between which the material lies.
    """

    def __init__(
        self, limit: float, between: tuple[float, float], pressed: Pressed, loaded: LoadedSolid
    ) -> None:
        from asperity.stress.exceedance import Exceedance

        self.exceedance: Exceedance = Exceedance(limit, pressed.face.boundary)
        self._limit, self._face, self._blocks = limit, pressed.face, pressed.blocks
        self._poisson, self.between = loaded.layer.poisson, between
        self._last: tuple[float, Array] | None = None
        self._means: Array | float = 0.0

    def add(self, plane: LinearPlane) -> None:
        """Add the next plane downward; blocks of the map take their mean depth above yield by trapezoids."""
        if not self.between[0] < plane.depth <= self.between[1]:
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


class YieldedParts(dict[str, Yielded]):
    """Name of each material of a body with a yield stress → its volume above yield."""

    def add(self, plane: LinearPlane) -> None:
        """Add the next plane downward."""
        for each in self.values():
            each.add(plane)


class Yielding(Question):
    """Volume above the yield stress of each material of the bodies."""

    ASKS = "Where does it yield?"
    TILES = ("maximum von Mises stress", "volume above yield per area", "volume fraction above yield")
    LEAD = "section"
    BY_MATERIAL = True

    @classmethod
    def is_implied(cls, case: Scene) -> bool:
        """True if a body, a layer or their material has a yield stress."""
        parts = (part for body in case.groups_of_bodies.values() for part in body.parts.values())
        return any(part.yield_stress is not None for part in parts)

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """Bodies without a yield stress."""
        if not self.is_implied(case):
            yield "yielding", ": needs the yield stress of a body, body.yield_stress or body.material"

    def observer(self, pressed: Pressed, body: str, loaded: LoadedSolid) -> YieldedParts:
        """The volumes above yield of the materials."""
        constants = pressed.asked.bodies[body]
        ends = [-1.0, *constants.interfaces.values(), math.inf]
        parts = zip(constants.parts.items(), pairwise(ends), strict=True)
        return YieldedParts(
            (name, Yielded(part.yield_stress, between, pressed, loaded))
            for (name, part), between in parts
            if part.yield_stress is not None
        )

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Volume, depths and peaks above yield of each body, and whether its materials yield."""
        records: list[Record] = []
        attributes: dict[str, dict[str, Any]] = {}
        for body in stages.asked.different_bodies:
            part = stages.bodies[body]
            for name, found in part.observed["yielding"].items():
                constants, extremes = part.materials[name]
                found.exceedance.finish(extremes["von_mises"].value)
                records += _records(stages, body, name, found)
                if constants is part.body:
                    volume = found.exceedance.volume * stages.face.grid.area
                    attributes[body] = {"yield_stress": constants.yield_stress, "volume_above_yield": volume}
        materials = [*_materials(stages, records)]
        if len(materials) == 2 and materials[0].equals(materials[1]):
            materials = [materials[0]._replace(of=" of both bodies")]
        return Findings(
            records=records,
            verdict="; ".join(each.verdict() for each in materials),
            warnings=[each.warning(stages) for each in materials if not each.is_elastic],
            attributes=attributes,
        )


def _records(stages: Stages, body: str, name: str, found: Yielded) -> Iterator[Record]:
    """Volume, depths and peaks above yield in a material of a body; of a layer with its name."""
    part, area, above = stages.bodies[body], stages.face.grid.area, found.exceedance
    of: dict[str, Any] = {"topic": "stress", "body": body}
    worse: dict[str, Any] = of | {"varies": True, "better": "less"}
    constants, (top, bottom) = part.materials[name][0], found.between
    within = "" if constants is part.body else f" in {name}"
    limit = constants.yield_stress or np.inf
    peaks, maps = in_cell(select_peaks(part.stress, "von_mises"))
    depths = peaks["peak_depth"].values
    is_above = (peaks["peak_value"].values > limit) & (depths > top) & (depths <= bottom)
    error = above.error(part.limits, np.count_nonzero(is_above) / maps)
    positions = found.error_of_positions(stages.blocks)
    yield Record(f"yield stress{within.replace(' in ', ' of ')}", limit, "Pa", **of)
    per_area = Record(f"volume above yield per area{within}", above.volume, "m", bounds=POSITIVE, **worse)
    if above.depths is None:
        none = "none: everything stays elastic" if error == 0 else "none on these pixels"
        yield Record(f"volume above yield{within}", 0.0, "m^3", words=none, **worse)
        extrapolated = 0.0 if error == 0 else np.nan  # far below yield: it is known to be zero
        yield replace(per_area, extrapolated=extrapolated).with_error(PLANES, error)
    else:
        first, last = above.depths
        share = above.volume / (last - max(top, 0.0))
        volumes = (
            Record(f"volume above yield{within}", above.volume * area, "m^3", bounds=POSITIVE, **worse),
            per_area,
            fraction(
                f"volume fraction above yield{within}",
                share,
                note=f"of the volume{f' of {name}' * bool(name)} down to {shown_si(last, 'm', 3)}",
                **worse,
            ),
        )
        for each in volumes:
            of_pixels = error * each.value / above.volume
            yield each.with_error(PLANES, of_pixels).with_error(POSITIONS, positions * each.value)
        note = f"from a depth of {shown_si(first, 'm', 3)}" if first else "from the surface"
        deepest = Record(f"maximum depth above yield{within}", last, "m", note=note, bounds=POSITIVE, **worse)
        yield deepest.with_error(PLANES, math.nan)
    density = np.count_nonzero(is_above) / maps / stages.numbers.nominal_area
    yield Record(f"peaks above yield{within}", density, "1/m^2", bounds=POSITIVE, **worse)


class _Material(NamedTuple):
    """A material with a yield stress: its name, bodies, stress, and the volume above yield per area."""

    name: str
    of: str
    limit: float
    stress: Record
    volume: Record | None
    depth: Record | None
    hardness: float
    """That the contact reaches; 0 if it reaches none, or not on this material."""

    def equals(self, other: _Material) -> bool:
        """True for materials of two bodies without coatings whose yield stress and stress are equal."""
        same = abs(self.stress.value - other.stress.value) <= ALIKE * self.stress.value
        return not (self.name or other.name) and self.limit == other.limit and same

    @property
    def is_elastic(self) -> bool:
        """True if the whole interval of the stress, or its value where none is known, is below yield."""
        high = self.stress.interval[1]
        return (self.stress.value if math.isnan(high) else high) <= self.limit

    def verdict(self) -> str:
        """Whether the material yields, from the stress and its interval."""
        shown, limit = self.stress.best_text(), shown_si(self.limit, "Pa", 3)
        low = self.stress.interval[0]
        material = f"{self.name or 'the material'}{self.of}"
        text = f"{material} yields"
        if self.is_elastic:
            text = f"{material} stays elastic"
            if DISCRETISATION in self.stress.lacks:
                text += " on these pixels (discretisation error not known)"
        elif low <= self.limit:
            text = f"{material} may yield"
        times = f"{self.stress.best / self.limit:.3g} times its yield stress, {limit}"
        if self.volume is None or not self.volume.value or self.depth is None:
            return f"{text}: maximum von Mises stress {shown}, {times}"
        volume = f"volume above yield per area {self.volume.best_text()}, down to a depth of "
        volume += self.depth.number(digits=3)
        if self.hardness:
            limited = f"is {LIMITED}, {shown_si(self.hardness, 'Pa', 3)}"
            return f"{text}: {volume}; its maximum von Mises stress, {shown}, {limited}, and is {times}"
        return f"{text}: maximum von Mises stress {shown}, {times}; {volume}"

    def warning(self, stages: Stages) -> Advice:
        """Stress that is, or may be, above the yield stress."""
        of = f" of {self.name}" * bool(self.name) + self.of
        reaches = "may exceed" if self.stress.interval[0] <= self.limit else "exceeds"
        affected = ""
        if self.depth is not None:
            affected = f"; depths down to {self.depth.number(digits=3)} are affected"
        text = f"the maximum von Mises stress{of}, {self.stress.best_text()}, {reaches} the yield stress of "
        text += shown_si(self.limit, "Pa", 3)
        # The hardness that a yield stress suggests holds for the surface.
        if stages.case.hardness is None and self.name in AT_SURFACE:
            hardness = shown_si(HARDNESS_OVER_YIELD * self.limit, "Pa", 3)
            affected = (
                f". The answer is elastic: real material flows there{affected}. The pressure stays below "
            )
            affected += f"the hardness, about {hardness}, and the contact area grows; a hardness limits the "
            affected += "pressure (body.hardness)"
        size = 1 - self.limit / self.stress.best
        times = f"{self.stress.best / self.limit:.3g} times the yield stress"
        short = f"model: the stress is elastic, up to {times}{of}" if size > 0 else ""
        return Advice(True, "stress beyond yield", f"{text}{affected}.", short, size)


def _materials(stages: Stages, records: Sequence[Record]) -> Iterator[_Material]:
    """The materials with a yield stress; of two bodies of one material those of the first alone."""
    bodies, names = list(stages.asked.bodies.values()), list(stages.asked.different_bodies)
    alike = bodies[0].is_like(bodies[-1])
    for body in names[:1] if alike else names:
        of = f" of the {body} body" if len(names) > 1 and not alike else ""
        for name, (part, _) in stages.bodies[body].materials.items():
            if (limit := part.yield_stress) is None:
                continue
            stress = next(find(stages.records, f"maximum von Mises stress{f' in {name}' * bool(name)}", body))
            within = "" if isinstance(part, Body) else f" in {name}"
            volume, depth = (
                next(find(records, f"{each}{within}", body), None)
                for each in ("volume above yield per area", "maximum depth above yield")
            )
            hardness = stages.contact.hardness if LIMITED in stress.note else 0.0
            yield _Material(name, of, limit, stress, volume, depth, hardness)
