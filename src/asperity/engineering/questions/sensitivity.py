"""Sensitivity: change of the main numbers for one per cent of each input, by one more answer each.

An input that is given with a tolerance, such as ``210 GPa ± 5 %``, adds its part to the errors: its tolerance
times this change. Inputs are taken as independent.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd
from pydantic import Field

from asperity.core.types import Progress
from asperity.engineering.answer_data import tile_names
from asperity.engineering.face import RoughFace
from asperity.engineering.question import Findings, Question, Stages
from asperity.engineering.records import FRACTION, PER_AREA, Record
from asperity.engineering.scene import Scene
from asperity.settings.body import OF_LAYER
from asperity.settings.model import Number, Settings, SettingsError, value_at, with_value

TOPIC = "change for one per cent more of an input"

STEP = 0.01
"""Relative change of an input."""

COUNTED, FEWEST_NODES = ("contact area fraction", "contact area", "mean contact pressure"), 10
"""Quantities that count nodes, and the number of nodes from which a change of them is a number."""

NEGLIGIBLE = 1e-6
"""Relative error by the inputs that is the error of the contact: the number does not depend on them."""


class Sensitivity(Question):
    """Change of the main numbers of the answer for one per cent of each input.

    Every input takes one more answer: load, moduli, hardness, yield stress, friction, film and coating, as
    far as the case has them.
    """

    ASKS = "Which input matters?"

    tolerances: Mapping[str, Number] = Field(default_factory=dict)
    """Dotted key of an input → its relative tolerance; filled from inputs such as `210 GPa ± 5 %`."""

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
        """Tolerances of other settings, and those that allow inputs of the other sign."""
        known = inputs_of(case)
        for key, tolerance in self.tolerances.items():
            if key not in known:
                yield key, f": a tolerance is accepted for {', '.join(known)}"
            elif not 0 <= tolerance < 1:
                yield key, f": a tolerance below 100 % is needed, ± {100 * tolerance:g} % is given"
        if rough is not None:
            return
        try:
            alone = self._alone(case)
        except SettingsError:  # the case reports its own problems
            return
        for key in known:
            try:
                varied(alone, key)
            except SettingsError as error:
                yield key, f": one per cent more, of the sensitivity, is refused ({error.found[0]})"

    def other_cases(self, case: Any) -> dict[str, Any]:
        """The cases with one per cent more of an input, by its key."""
        return {key: varied(self._alone(case), key) for key in inputs_of(case)}

    def _alone(self, case: Any) -> Any:
        """The case without this question and without a load curve."""
        return case.replaced(sensitivity=None, load_curve=None)

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """Changes of each number at the top of the page, and its error by the tolerances of the inputs."""
        tiles = {name for names in tile_names(stages.asked) for name in names}
        rows, records = [], []
        errors: dict[tuple[str, str], float] = {}
        values = {
            key: {(each.quantity, each.body): each.value for each in others}
            for key, others in stages.others.items()
        }
        for own in stages.records:
            name = own.quantity, own.body
            known = {key: found[name] for key, found in values.items() if name in found}
            if not (own.value and math.isfinite(own.value)) or own.words or not known:
                continue
            changes = {key: value / own.value - 1 for key, value in known.items()}
            parts = [changes[key] / STEP * size for key, size in self.tolerances.items() if key in changes]
            nodes, is_count = stages.numbers.contact_nodes, own.unit in ("1", PER_AREA)
            too_few = own.quantity in COUNTED and STEP * nodes < FEWEST_NODES
            if parts and (own.bounds == FRACTION or not is_count):
                size = math.hypot(*parts)
                errors |= {name: math.nan if too_few else size} if too_few or size > NEGLIGIBLE else {}
            if own.quantity not in tiles:
                continue
            quantity = f"{own.quantity}: change"
            if too_few:
                words = f"not known, as {100 * STEP:g} % of {nodes} contact nodes is too few to count"
                records.append(Record(quantity, math.nan, topic=TOPIC, body=own.body, words=words))
                continue
            largest_first = sorted(changes.items(), key=lambda each: -abs(each[1]))
            shown = ", ".join(f"{key} {100 * change:+.2g} %" for key, change in largest_first)
            records.append(Record(quantity, largest_first[0][1], topic=TOPIC, body=own.body, words=shown))
            rows += [(*name, *each) for each in changes.items()]
        table = pd.DataFrame(rows, columns=["quantity", "body", "input", "change"])
        return Findings(records=records, tables={"sensitivity": table}, input_errors=errors)


def inputs_of(case: Scene) -> list[str]:
    """Dotted keys of the inputs that a case has: its load, and settings of bodies and questions to vary."""
    found = {f"load.{case.load.kind}": case.load.value}
    for name, group in {**case.groups_of_bodies, **case.questions}.items():
        found |= _varied_in(group, name)
    return [key for key, value in found.items() if 0 < value < math.inf]


def _varied_in(group: Settings, key: str) -> dict[str, float]:
    """Dotted keys and values of the settings of a group and below it that are declared as `varied`."""
    found: dict[str, float] = {}
    for name, field in type(group).model_fields.items():
        value, own = getattr(group, name), f"{key}.{name}"
        if isinstance(value, tuple):
            for number, each in enumerate(value):
                found |= _varied_in(each, f"{own}.{number}") if isinstance(each, Settings) else {}
        elif value is not None and isinstance(extra := field.json_schema_extra, dict) and extra.get("varied"):
            found[own] = value
    if getattr(group, "hardness_is_estimated", False):  # it varies with the yield stress
        found.pop(f"{key}.hardness", None)
    if getattr(group, "base", None) is not None:  # the body has the constants of its layer
        return {own: value for own, value in found.items() if own.removeprefix(f"{key}.") not in OF_LAYER}
    return found


def varied(case: Any, key: str) -> Any:
    """The case with one per cent more of an input."""
    changed = with_value(case, key, value_at(case, key) * (1 + STEP))
    if key.endswith("fatigue_torsion"):  # the ratio of the limits stays
        other = f"{key.partition('.')[0]}.fatigue_bending"
        changed = with_value(changed, other, value_at(case, other) * (1 + STEP))
    return changed
