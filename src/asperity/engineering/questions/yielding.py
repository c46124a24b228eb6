"""Yield: the volume whose von Mises stress is above the yield stress, its depths, and peaks above it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from asperity.core.types import Array, Progress
from asperity.core.units import shown_si
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.engineering.places import Blocks
from asperity.engineering.question import Findings, Pressed, Question, Stages
from asperity.engineering.records import (
    PLANES,
    POSITIONS,
    POSITIVE,
    Advice,
    Record,
    find,
    fraction,
    per_cent,
)
from asperity.engineering.scene import Scene
from asperity.settings.body import HARDNESS_OVER_YIELD
from asperity.stress.peaks.selection import select_peaks

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

        self.exceedance: Exceedance = Exceedance(limit, pressed.face.boundary)
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
        for body in stages.asked.different_bodies:
            part = stages.bodies[body]
            found: Yielded | None = part.observed.get("yielding")
            if found is not None:
                found.exceedance.finish(part.parts[-1]["von_mises"].value)
                records += _records(stages, body, found)
                volume = found.exceedance.volume * stages.face.grid.area
                attributes[body] = {"yield_stress": part.body.yield_stress, "volume_above_yield": volume}
        materials = [*_materials(stages, records)]
        return Findings(
            records=records,
            verdict="; ".join(each.verdict() for each in materials),
            warnings=[each.warning(stages) for each in materials if not each.is_elastic],
            attributes=attributes,
        )


def _records(stages: Stages, body: str, found: Yielded) -> Iterator[Record]:
    """Volume, depths and peaks above yield in a body."""
    part, area, above = stages.bodies[body], stages.face.grid.area, found.exceedance
    of: dict[str, Any] = {"topic": "stress", "body": body}
    worse: dict[str, Any] = of | {"varies": True, "better": "less"}
    limit = part.body.yield_stress or np.inf
    peaks = select_peaks(part.stress, "von_mises")
    is_above = peaks["peak_value"].values > limit
    error = above.error(part.limits, int(is_above.sum()))
    positions = found.error_of_positions(stages.blocks)
    yield Record("yield stress", limit, "Pa", **of)
    per_area = Record("volume above yield per area", above.volume, "m", bounds=POSITIVE, **worse)
    if above.depths is None:
        none = "none: everything stays elastic"
        yield Record("volume above yield", 0.0, "m^3", words=none, **worse)
        extrapolated = 0.0 if error == 0 else np.nan  # far below yield: it is known to be zero
        yield replace(per_area, extrapolated=extrapolated).with_error(PLANES, error)
    else:
        first, last = above.depths
        share = fraction("volume fraction above yield", above.volume / last, **worse)
        volumes = (
            Record("volume above yield", above.volume * area, "m^3", bounds=POSITIVE, **worse),
            per_area,
            replace(share, note=f"of the volume down to {shown_si(last, 'm', 3)}"),
        )
        for each in volumes:
            of_pixels = error * each.value / above.volume
            yield each.with_error(PLANES, of_pixels).with_error(POSITIONS, positions * each.value)
        note = f"from a depth of {shown_si(first, 'm', 3)}" if first else "from the surface"
        yield Record("maximum depth above yield", last, "m", note=note, bounds=POSITIVE, **worse)
    below = peaks["peak_depth"].values > (part.layer.interface or -1.0)
    density = int((is_above & below).sum()) / stages.numbers.nominal_area
    yield Record("peaks above yield", density, "1/m^2", bounds=POSITIVE, **worse)


class _Material(NamedTuple):
    """A material with a yield stress: its words, name, stress, and the volume above yield if it is known."""

    words: str
    name: str
    limit: float
    stress: Record
    volume: Record | None
    depth: Record | None

    @property
    def is_elastic(self) -> bool:
        """True if the whole interval of the stress, or its value where none is known, is below yield."""
        high = self.stress.interval[1]
        return (self.stress.value if math.isnan(high) else high) <= self.limit

    def verdict(self) -> str:
        """Whether the material yields, from the stress and its interval."""
        shown, limit = self.stress.best_text(), shown_si(self.limit, "Pa", 3)
        ratio = f"{self.stress.best / self.limit:.3g} times its yield stress, {limit}"
        low = self.stress.interval[0]
        text = f"{self.words} yields"
        if self.is_elastic:
            text = f"{self.words} stays elastic"
        elif low <= self.limit:
            text = f"{self.words} may yield"
        text += f": maximum von Mises stress {shown}, {ratio}"
        if self.volume is not None and self.volume.value and self.depth is not None:
            down_to = self.depth.number(digits=3)
            text += f"; {per_cent(self.volume.value)} of its volume down to {down_to} is above it"
        return text

    def warning(self, stages: Stages) -> Advice:
        """Stress that is, or may be, above the yield stress."""
        of = self.words.removeprefix("the material") if self.name == "" else f" of {self.words}"
        reaches = "may exceed" if self.stress.interval[0] <= self.limit else "exceeds"
        affected = ""
        if self.depth is not None:
            affected = f"; depths down to {self.depth.number(digits=3)} are affected"
        text = f"the maximum von Mises stress{of}, {self.stress.best_text()}, {reaches} the yield stress of "
        text += shown_si(self.limit, "Pa", 3)
        # The hardness that a yield stress suggests holds for the surface.
        if stages.case.hardness is None and self.name != "base":
            hardness = shown_si(HARDNESS_OVER_YIELD * self.limit, "Pa", 3)
            affected = (
                f". The answer is elastic: real material flows there{affected}. The pressure stays below "
            )
            affected += (
                f"the hardness, about {hardness}, and the contact area grows; body.hardness limits the "
            )
            affected += "pressure"
        return Advice(True, "stress beyond yield", f"{text}{affected}.")


def _materials(stages: Stages, records: Sequence[Record]) -> Iterator[_Material]:
    """The materials with a yield stress; of two bodies of one material those of the first alone."""
    bodies, names = list(stages.asked.bodies.values()), list(stages.asked.different_bodies)
    alike = bodies[0].is_like(bodies[-1])
    for body in names[:1] if alike else names:
        of = f" of the {body} body" if len(names) > 1 and not alike else ""
        for name, part in stages.bodies[body].materials.items():
            if (limit := part.body.yield_stress) is None:
                continue
            quantity = f"maximum von Mises stress{f' in the {name}' if name else ''}"
            stress = next(find(stages.records, quantity, body))
            volume, depth = (
                None if name == "coating" else next(find(records, each, body), None)
                for each in ("volume fraction above yield", "maximum depth above yield")
            )
            yield _Material(f"the {name or 'material'}{of}", name, limit, stress, volume, depth)
