"""Yield: the volume whose von Mises stress is above the yield stress, its depths, and peaks above it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.core.units import scaled_unit, shown_si
from asperity.engineering.question import HARDNESS_OVER_YIELD, Advice, Question, Row, per_cent, row

if TYPE_CHECKING:
    from asperity.core.types import Array, Progress
    from asperity.engineering.places import Blocks
    from asperity.engineering.question import Answer, Case, LinearPlane, LoadedSolid


@dataclass(frozen=True)
class Yielded:
    """Part of a body whose von Mises stress is above yield, in SI units.

    Parameters
    ----------
    volume, error : float
        Volume under the map whose von Mises stress is above yield, and its error by pixels and planes; NaN
        where there is no estimate.
    depths : (first, last) or None
        Depths between which there are such points.
    fraction : float
        `volume` over the volume from the surface to the last of these depths.
    of_places : float
        Relative error of the volume from place to place; NaN where it is not known.
    """

    volume: float
    error: float
    depths: tuple[float, float] | None
    fraction: float
    of_places: float


class _OfBlocks:
    """Mean depth above a limit in each block of the map, by trapezoids between planes."""

    def __init__(self, limit: float, blocks: Blocks) -> None:
        self._limit, self._blocks = limit, blocks
        self._last: tuple[float, Array] | None = None
        self.means = np.zeros(blocks.shape)

    def add(self, depth: float, values: Array) -> None:
        """Add the next plane downward, its values on the map."""
        share = self._blocks.means(values > self._limit)
        if self._last is not None:
            self.means += (depth - self._last[0]) * (share + self._last[1]) / 2
        self._last = depth, share


class Yielding(Question):
    """Volume above the yield stress of the bodies; below its coating of a coated body."""

    TILES = ("largest von Mises stress", "volume above yield per area", "share above yield")
    LEAD = "section"

    @classmethod
    def is_implied(cls, case: Case) -> bool:
        """True if a body or its material has a yield stress."""
        return any(body.yield_stress is not None for body in case.groups_of_bodies.values())

    def check(self, case: Case) -> Iterator[tuple[str, str]]:
        """Bodies without a yield stress."""
        if not self.is_implied(case):
            yield "yielding", ": a yield_stress of a body is needed"

    def of_contact(self, answer: Answer, progress: Progress) -> dict[str, Any]:
        """Body → `Yielded`; filled as the bodies are analysed."""
        return {}

    def watch(self, answer: Answer, body: str, loaded: LoadedSolid) -> Callable[[LinearPlane], None] | None:
        """The volume above yield, from the planes below a coating."""
        from asperity.stress.exceedance import Exceedance

        limit, below = answer.case.bodies[body].yield_stress, loaded.layer.interface or -1.0
        if limit is None:
            return None
        exceedance = Exceedance(limit, answer.face.boundary == "periodic")
        of_blocks = None if answer.blocks is None else _OfBlocks(limit, answer.blocks)
        answer.of(self)[body] = exceedance, of_blocks

        def add(plane: LinearPlane) -> None:
            if plane.depth > below:
                values = plane.field("von_mises", loaded.layer.poisson)
                exceedance.add(plane.depth, plane.grid, values)
                if of_blocks is not None:
                    of_blocks.add(plane.depth, values[answer.face.part_of(plane.grid)])

        return add

    def of_body(self, answer: Answer, body: str, progress: Progress) -> None:
        """Volume and depths, and their error."""
        from asperity.engineering.body_stress import largest_von_mises_between
        from asperity.stress.peaks.selection import select_peaks

        limit, part, area = answer.case.bodies[body].yield_stress, answer.bodies[body], answer.face.grid.area
        if limit is None:
            return
        found, of_blocks = answer.of(self)[body]
        top = np.nextafter(part.layer.interface, np.inf) if part.layer.interface else 0.0
        found.finish(largest_von_mises_between(part.stress, top, np.inf).value)
        count = int((select_peaks(part.stress, "von_mises")["peak_value"] > limit).sum())
        error = found.error(part.limits, count) * area
        fraction = found.volume / found.depths[1] if found.depths else 0.0
        of_places = np.nan
        if answer.blocks is not None and of_blocks is not None and found.volume:
            of_places = answer.blocks.error(of_blocks.means)
        answer.of(self)[body] = Yielded(found.volume * area, error, found.depths, fraction, of_places)

    def verdict(self, answer: Answer) -> str:
        """Yield of each material, its depth and the largest stress."""
        found, names = [], _bodies_apart(answer)
        for name in names:
            for material, limit, stress, depths in self._materials(answer, name):
                what = f"the {material}" if material else "the material"
                what += f" of the {name} body" if len(names) > 1 else ""
                ratio = f"{stress / limit:.3g} times its yield stress, {shown_si(limit, 'Pa', 3)}"
                if stress <= limit:
                    found.append(f"{what} stays elastic, with at most {ratio}")
                elif depths is None:
                    found.append(f"{what} yields, with up to {ratio}")
                else:
                    share, last = per_cent(answer.of(self)[name].fraction), shown_si(depths[1], "m", 3)
                    found.append(f"{what} yields: {share} of its volume down to {last}, with up to {ratio}")
        return "; ".join(found)

    def _materials(self, answer: Answer, body: str) -> Iterator[tuple[str, float, float, Any]]:
        """Materials of a body: name, yield stress, largest von Mises stress, depths above yield if known."""
        yielded: Yielded | None = answer.of(self).get(body)
        for material, part in answer.bodies[body].materials.items():
            if (limit := part.body.yield_stress) is not None:
                depths = None if yielded is None or material == "coating" else yielded.depths
                yield material, limit, part.largest_von_mises, depths

    def attributes(self, answer: Answer, body: str) -> Mapping[str, Any]:
        """Yield stress, and the volume above it."""
        limit = answer.case.bodies[body].yield_stress
        if limit is None:
            return {}
        return {"yield_stress": limit, "volume_above_yield": answer.of(self)[body].volume}

    def rows_of_body(self, answer: Answer, body: str) -> Iterator[Row]:
        """Volume, depths and peaks above yield."""
        part, group = answer.bodies[body], answer.case.stress_title(body)
        if (limit := answer.case.bodies[body].yield_stress) is None:
            return
        found: Yielded = answer.of(self)[body]

        yield row(group, "yield stress", limit, "Pa")
        source, map_area = "the pixels and planes", answer.face.grid.area
        per_area = row(group, "volume above yield per area", found.volume / map_area, "m").by(
            found.error / map_area, source
        )
        if found.error == 0:  # far below yield; a pool of maps needs it
            per_area = per_area._replace(estimate=per_area.value, error=0.0)
        if found.depths is None:
            yield row(group, "volume above yield", 0.0, "m^3", "none: everything stays elastic")
            yield per_area
        else:
            first, last = found.depths
            factor, symbol = scaled_unit([last], "m")
            share = f"{100 * found.fraction:.3g} % of the volume down to {shown_si(last, 'm', 3)}"
            between = f"depths from {first / factor:.3g} to {last / factor:.3g} {symbol}"
            yield row(group, "volume above yield", found.volume, "m^3", shown_si(found.volume, "m^3", 3))
            yield per_area.of_places(found.of_places)
            error = found.error / (map_area * last)
            fraction = row(group, "share above yield", found.fraction, "1", share).by(error, source)
            yield fraction.of_places(found.of_places)
            yield row(group, "deepest point above yield", last, "m", between)
        peaks = answer.peaks().query("body == @body and quantity == 'von_mises'")
        below = peaks["depth_m"] > (part.layer.interface or -1.0)
        density = int(((peaks["value_Pa"] > limit) & below).sum()) / answer.numbers.nominal_area
        yield row(group, "peaks above yield", density, "1/m^2", f"{1e-6 * density:.4g} per mm²")

    def advice(self, answer: Answer) -> Iterator[Advice]:
        """Stress above yield, of coating and base of each body."""
        for name in _bodies_apart(answer):
            where = f" of the {name} body" if len(answer.case.different_bodies) > 1 else ""
            for material, limit, stress, depths in self._materials(answer, name):
                if stress <= limit:
                    continue
                affected = ""
                if depths is not None:
                    first, last = (shown_si(depth, "m", 3) for depth in depths)
                    affected = f"; depths from {first if depths[0] else 'the surface'} to {last} are affected"
                of, ratio = f" of the {material}{where}" if material else where, f"{stress / limit:.3g}"
                text = f"the largest von Mises stress{of}, {shown_si(stress, 'Pa', 3)}, is {ratio} times the "
                text += f"yield stress of {shown_si(limit, 'Pa', 3)}"
                # The hardness that a yield stress suggests holds for the surface.
                if answer.pressed.hardness is None and material != "base":
                    hardness = shown_si(HARDNESS_OVER_YIELD * limit, "Pa", 3)
                    affected = f". This is an elastic result only: real material flows there{affected}. The "
                    affected += f"pressure stays below the hardness, about {hardness}, and the real contact "
                    affected += "grows; body.hardness limits the pressure"
                yield Advice(True, "stress beyond yield", f"{text}{affected}.")


def _bodies_apart(answer: Answer) -> list[str]:
    """Names of the bodies whose stress differs; of two bodies of one material the first."""
    bodies, names = list(answer.case.bodies.values()), list(answer.case.different_bodies)
    return names[:1] if bodies[0].is_like(bodies[-1]) else names
