"""Sensitivity: change of the main numbers for one per cent of each input, by one more answer each.

An input that is given with a tolerance, such as ``210 GPa ± 5 %``, adds its part to the errors: its tolerance
times this change. Inputs are taken as independent.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import Field

from asperity.engineering.question import Question, Row
from asperity.settings.body import OF_LAYER
from asperity.settings.model import Number, value_at, with_value

if TYPE_CHECKING:
    import pandas as pd

    from asperity.engineering.question import Answer, Case

GROUP = "change for one per cent more of an input"

STEP = 0.01
"""Relative change of an input."""

OF_BODY = (
    *("young", "hardness", "yield_stress", "fatigue_torsion"),
    *("layers.0.young", "layers.0.thickness", "layers.0.yield_stress"),
)
"""Constants of a body that are varied, if it has them."""

OTHERS = ("sliding.friction", "film.load_share", "film.lambda_ratio", "running_in.hardness")
"""Other inputs that are varied, if they are given."""


class Change(NamedTuple):
    """Relative change of a number for one per cent of an input."""

    group: str
    number: str
    input: str
    change: float


class Sensitivity(Question):
    """Change of the main numbers of the answer for one per cent of each input.

    Every input takes one more answer: load, moduli, hardness, yield stress, friction, film and coating, as
    far as the case has them.
    """

    tolerances: Mapping[str, Number] = Field(default_factory=dict)
    """Dotted key of an input → its relative tolerance; filled from inputs such as `210 GPa ± 5 %`."""

    def check(self, case: Case) -> Iterator[tuple[str, str]]:
        """Tolerances of other settings."""
        known = inputs_of(case)
        for key in self.tolerances:
            if key not in known:
                yield key, f": a tolerance is accepted for {', '.join(known)}"

    def other_cases(self, case: Case) -> dict[str, Case]:
        """The cases with one per cent more of an input, by its key."""
        alone = case.replaced(sensitivity=None, load_curve=None)
        return {key: varied(alone, key) for key in inputs_of(case)}

    def of_other_cases(self, answer: Answer, others: Mapping[str, Answer]) -> list[Change]:
        """The changes."""
        from asperity.engineering.answer import tile_names

        names, found = tile_names(answer.case), []
        rows = {(row.group, row.name): row for row in answer.rows if row.name in names}
        for key, other in others.items():
            for changed in other.rows:
                start = changed.group.partition(" (")[0]  # before the constants, which may be varied
                like = (group for group, _ in rows if group.partition(" (")[0] == start)
                own = rows.get((next(like, changed.group), changed.name))
                if own is not None and own.value:
                    found.append(Change(own.group, own.name, key, changed.value / own.value - 1))
        del answer.rows  # made again, with the errors by the inputs
        return found

    def relative_error(self, answer: Answer, row: Row) -> float:
        """Relative error of a number by the tolerances of the inputs; NaN without any."""
        changes: list[Change] = answer.of(self) or []
        parts = [
            each.change / STEP * self.tolerances[each.input]
            for each in changes
            if (each.group, each.number) == (row.group, row.name) and each.input in self.tolerances
        ]
        return math.hypot(*parts) if parts else math.nan

    def rows(self, answer: Answer) -> Iterator[Row]:
        """Changes of each number, the largest first."""
        changes: list[Change] = answer.of(self) or []
        largest_first = sorted(changes, key=lambda each: -abs(each.change))
        for number in dict.fromkeys((each.group, each.number) for each in changes):
            own = [each for each in largest_first if (each.group, each.number) == number]
            shown = ", ".join(f"{each.input} {100 * each.change:+.2g} %" for each in own)
            name = number[1] + (", upper body" if "upper body" in number[0] else "")
            yield Row(GROUP, f"{name}: change", own[0].change, "1", shown)

    def files(self, case: Case) -> list[str]:
        """The table."""
        return ["sensitivity.csv"]

    def tables(self, answer: Answer) -> Mapping[str, pd.DataFrame]:
        """Relative change of each number for one per cent of each input."""
        import pandas as pd

        return {"sensitivity": pd.DataFrame(answer.of(self), columns=Change._fields)}


def inputs_of(case: Case) -> list[str]:
    """Dotted keys of the inputs that a case has."""
    of_bodies = [
        f"{name}.{key}"
        for name, body in case.groups_of_bodies.items()
        for key in OF_BODY
        if body.base is None or key not in OF_LAYER
    ]
    values = {key: value_at(case, key) for key in [f"load.{case.load.kind}", *of_bodies, *OTHERS]}
    return [key for key, value in values.items() if isinstance(value, float) and 0 < value < math.inf]


def varied(case: Any, key: str) -> Any:
    """The case with one per cent more of an input."""
    group = key.partition(".")[0]
    changed = with_value(case, key, value_at(case, key) * (1 + STEP))
    if key.endswith("fatigue_torsion"):  # the ratio of the limits stays
        other = f"{group}.fatigue_bending"
        changed = with_value(changed, other, value_at(case, other) * (1 + STEP))
    return changed
