"""Strength of layers: whether they crack, and whether their interfaces peel."""

import math
from collections.abc import Iterator
from dataclasses import replace

from asperity.core.types import Progress
from asperity.core.units import shown_si
from asperity.engineering.answer_data import ON_INTERFACE
from asperity.engineering.face import RoughFace
from asperity.engineering.numbers import EXTREMES
from asperity.engineering.question import Findings, Question, Stages
from asperity.engineering.records import POSITIVE, Advice, Record, find
from asperity.engineering.scene import Scene

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
            for kind in ON_INTERFACE:
                if getattr(strength, kind, None) is not None:
                    key = f"{name}.layers.{last}.strength.{kind}"
                    yield key, ": not accepted on a rigid base, where only cracks are judged"

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Strength over stress of each layer and interface, and whether they hold."""
        ratios, failures = [], []
        for place, ways, ratio in _criteria(stages):
            ratios.append(ratio)
            low, high = (ratio.value,) * 2 if math.isnan(ratio.error) else ratio.interval
            if low <= 1:
                failures.append(f"{place} {ways[high <= 1]}: strength over stress {ratio.best_text()}")
        least = min(ratios, key=lambda ratio: ratio.best)
        note = ", ".join(filter(None, [least.quantity, least.note]))
        holds = f"the layers hold: {LEAST} {least.best_text()}, {least.quantity}"
        named = [replace(each, quantity=f"strength over stress, {each.quantity}") for each in ratios]
        return Findings(
            records=[*named, replace(least, quantity=LEAST, body="", note=note)],
            verdict="; ".join(failures) or holds,
            warnings=[Advice(True, TOPIC, f"{text[0].upper()}{text[1:]}.") for text in failures],
            assumption=(
                "A crack in a layer is judged under its maximum tensile stress, as if uniform, and as if "
                "the solid below were as stiff (Hutchinson and Suo 1992); in a stiffer layer it runs "
                "earlier. Shear and tension of an interface are judged apart."
            ),
        )


def _criteria(stages: Stages) -> Iterator[tuple[str, tuple[str, str], Record]]:
    """Place, that it may fail and that it fails, and strength over stress with the way as its name."""
    names = list(stages.asked.different_bodies)
    for body in names:
        of = f" of the {body} body" if len(names) > 1 else ""
        constants = stages.bodies[body].body
        faces = [*constants.interfaces, ""]
        for name, layer, face in zip(constants.parts, constants.layers, faces, strict=False):
            if (strength := layer.strength) is None:
                continue
            for kind, quantity in ON_INTERFACE.items():
                if (limit := getattr(strength, kind)) is not None:
                    stress = next(find(stages.records, f"{quantity} {face}", body))
                    ways = f"may peel in {kind}", f"peels in {kind}"
                    yield f"{face}{of}", ways, _ratio(stress, limit, f"{kind} of {face}")
            energy = strength.energy
            if strength.toughness is not None:
                energy = strength.toughness**2 * (1 - layer.poisson**2) / layer.young
            if energy is not None:
                tension = EXTREMES["principal_1"] + (f" in {name}" if name else "")
                stress = next(find(stages.records, tension, body))
                of_unit = energy_release_rate(1.0, layer.thickness, layer.young, layer.poisson)
                limit = math.sqrt(energy / of_unit)
                # The peak tension is of a point; the residual stress alone is that of the whole layer.
                ways = ("may crack, by an upper bound",) * 2
                if (layer.residual_stress or 0.0) >= limit:
                    ways = "may crack", "cracks"
                ratio = _ratio(stress, limit, f"crack in {name or 'the layer'}")
                yield f"{name or 'the layer'}{of}", ways, ratio


def _ratio(stress: Record, limit: float, of: str) -> Record:
    """Strength over stress, with the relative error of the stress."""
    ratio = Record(of, math.inf, "1", TOPIC, stress.body, better="more")
    if not stress.value > 0:
        return replace(ratio, words="unlimited, as there is no such stress")
    note = ", ".join(filter(None, [f"strength {shown_si(limit, 'Pa')}", stress.note]))
    value, position = limit / stress.value, stress.position
    ratio = replace(ratio, value=value, position=position, bounds=POSITIVE, varies=True, note=note)
    return replace(
        ratio, errors={cause: value * error / stress.best for cause, error in stress.errors.items()}
    )
