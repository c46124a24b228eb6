"""Strength of layers: whether they crack, and whether their interfaces peel."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from asperity.core.types import Progress
from asperity.core.units import shown_si
from asperity.engineering.answer_data import ON_INTERFACE
from asperity.engineering.numbers import EXTREMES
from asperity.engineering.question import Findings, Question, Stages
from asperity.engineering.records import DISCRETISATION, POSITIVE, Advice, Record, find
from asperity.engineering.scene import Scene

if TYPE_CHECKING:
    from asperity.engineering.face import RoughFace

TOPIC, LEAST = "strength of the layers", "least strength over stress"

CHANNELLING = 1.1215**2 * math.pi / 2
"""Z = 1.976 in the energy release rate G = Z σ² h/Ē of a crack that runs along a layer of thickness h under
the tension σ (`energy_release_rate`)."""


def energy_release_rate(stress: float, thickness: float, young: float, poisson: float) -> float:
    """Energy per area of a crack through a layer that runs along it under a uniform tension.

    G = Z σ² h/Ē with Ē = E/(1 − ν²) and Z = 1.976, the mean of K²/Ē over the depth of an edge crack with
    K = 1.1215 σ √(π a), for a layer as stiff as the solid below it (J. W. Hutchinson and Z. Suo, Adv. Appl.
    Mech. 29 (1992) 63, DOI 10.1016/S0065-2156(08)70164-9). In a stiffer layer it is larger.
    """
    return CHANNELLING * stress**2 * thickness * (1 - poisson**2) / young


class LayerStrength(Question):
    """Strength of each layer and of the interface below it over the stress, where `strength` is given.

    An interface peels where its shear stress or its tension reaches the strength in shear or in tension; a
    layer cracks where the energy release rate under its maximum tensile stress reaches its fracture energy.
    """

    ASKS = "Does the coating hold?"
    TILES = (LEAST,)
    LEAD = "interface"

    @classmethod
    def is_implied(cls, case: Scene) -> bool:
        """True if a layer has a strength."""
        strengths = (each.strength for body in case.groups_of_bodies.values() for each in body.layers)
        return any(value is not None for given in strengths if given is not None for _, value in given)

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """No strength, and strengths of the interface with a rigid base, whose stress is not computed."""
        if not self.is_implied(case):
            yield "strength", ": needs the strength of a layer, such as body.layers.0.strength.shear"
        for name, body in case.groups_of_bodies.items():
            last = len(body.layers) - 1
            strength = body.layers[last].strength if body.base is not None else None
            for kind in ("shear", "tension"):
                if strength is not None and getattr(strength, kind) is not None:
                    key = f"{name}.layers.{last}.strength.{kind}"
                    yield key, ": not accepted on a rigid base, where only cracks are judged"

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Strength over stress of each layer and interface, and whether they hold."""
        found = [*_criteria(stages)]
        records = [record for each in found for record in each.records]
        least = min((each.ratio for each in found), key=lambda ratio: ratio.best)
        place = least.quantity.partition(", ")[2]
        records.append(
            replace(least, quantity=LEAST, body="", note=", ".join(filter(None, [place, least.note])))
        )
        texts = [each.text() for each in found if not each.holds]
        return Findings(
            records=records,
            verdict="; ".join(texts) or f"the layers hold: {LEAST} {least.best_text()}, {place}",
            warnings=[Advice(True, TOPIC, f"{text[0].upper()}{text[1:]}.") for text in texts],
            assumption=(
                "A crack in a layer is judged under its maximum tensile stress, as if uniform, and as if "
                "the solid below were as stiff (Hutchinson and Suo 1992); in a stiffer layer it runs "
                "earlier. Shear and tension of an interface are judged apart."
            ),
        )


class _Criterion(NamedTuple):
    """A stress that a strength limits.

    The `place` fails as `fails` says; `ratio` is strength over stress, the last of its `records`.
    """

    place: str
    fails: str
    records: tuple[Record, ...]

    @property
    def ratio(self) -> Record:
        """Strength over stress."""
        return self.records[-1]

    @property
    def holds(self) -> bool:
        """True if the whole interval of the ratio, or its value where none is known, is above 1."""
        low = self.ratio.interval[0]
        return (self.ratio.value if math.isnan(low) else low) > 1

    def text(self) -> str:
        """How the place fails, from the ratio and its interval."""
        fails = self.fails.replace("s", "", 1) if self.ratio.interval[1] > 1 else self.fails
        may = "may " if self.ratio.interval[1] > 1 else ""
        return f"{self.place} {may}{fails}: strength over stress {self.ratio.best_text()}"


def _criteria(stages: Stages) -> Iterator[_Criterion]:
    """The criteria of all layers that have a strength, in every body."""
    names = list(stages.asked.different_bodies)
    for body in names:
        of = f" of the {body} body" if len(names) > 1 else ""
        constants = stages.bodies[body].body
        names_of_parts, faces = [*constants.parts], [*constants.interfaces, ""]
        for name, layer, face in zip(names_of_parts, constants.layers, faces, strict=False):
            if (strength := layer.strength) is None:
                continue
            for kind, quantity in ON_INTERFACE.items():
                if (limit := getattr(strength, kind)) is not None:
                    stress = next(find(stages.records, f"{quantity} {face}", body))
                    ratio = _ratio(stress, limit, f"{kind} of {face}")
                    yield _Criterion(f"{face}{of}", f"peels in {kind}", (ratio,))
            energy = strength.energy
            if strength.toughness is not None:
                energy = strength.toughness**2 * (1 - layer.poisson**2) / layer.young
            if energy is not None:
                stress = next(
                    find(stages.records, f"{EXTREMES['principal_1']}{f' in {name}' * bool(name)}", body)
                )
                one = energy_release_rate(1.0, layer.thickness, layer.young, layer.poisson)
                rate = Record(
                    f"energy release rate of a crack in {name or 'the layer'}",
                    one * stress.value**2,
                    "J/m^2",
                    TOPIC,
                    body,
                    bounds=POSITIVE,
                    note=stress.note,
                    varies=True,
                    better="less",
                )
                error = 2 * one * stress.value * stress.errors.get(DISCRETISATION, 0.0)
                ratio = _ratio(stress, math.sqrt(energy / one), f"crack in {name or 'the layer'}")
                records = rate.with_error(DISCRETISATION, error), ratio
                yield _Criterion(f"{name or 'the layer'}{of}", "cracks", records)


def _ratio(stress: Record, limit: float, of: str) -> Record:
    """Strength over stress, with the relative error of the stress."""
    ratio = Record(f"strength over stress, {of}", math.inf, "1", TOPIC, stress.body, better="more")
    if not stress.value > 0:
        return replace(ratio, words="unlimited, as there is no such stress")
    note = ", ".join(filter(None, [f"strength {shown_si(limit, 'Pa')}", stress.note]))
    value, position = limit / stress.value, stress.position
    ratio = replace(ratio, value=value, position=position, bounds=POSITIVE, varies=True, note=note)
    return replace(
        ratio, errors={cause: value * error / stress.best for cause, error in stress.errors.items()}
    )
