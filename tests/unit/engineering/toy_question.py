"""A question that is no part of asperity.

Nothing but its class and its field of the case is added.
"""

from collections.abc import Iterator

import xarray as xr
from matplotlib.figure import Figure

from asperity.core.types import Progress
from asperity.engineering import case
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.question import Findings, Picture, Question, Stages
from asperity.engineering.records import Advice, Record
from asperity.engineering.scene import Scene
from asperity.settings.model import Number, optional, setting

TOY = "toy pressure"


class Toy(Question):
    """A multiple of the mean pressure."""

    ASKS = "Is it a toy?"
    TILES = (TOY,)
    FILES = ("toy",)

    times: Number = setting(2.0, ge=0, le=10, example=3.0)
    """Toy pressure over mean pressure."""

    def cost(self, case: Scene, is_mirrored: bool) -> tuple[float, float]:
        return 0.0, 7.0

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        value = self.times * stages.numbers.nominal_pressure
        return Findings(
            records=[Record(TOY, value, "Pa", "toys")],
            verdict="it is a toy",
            warnings=[Advice(True, "toys", "toys are for play.")],
            datasets={"toy": xr.Dataset({"mean_pressure": value}, attrs={"title": "A toy"})},
        )

    def pictures(self, answer: AnswerData) -> Iterator[Picture]:
        figure = Figure()
        figure.add_subplot().plot([0.0, answer[TOY].value])
        yield Picture("toy", "A line to the toy pressure", figure)


class Case(case.Case):
    """The case with one more question."""

    toy: Toy | None = optional("not asked")
    """A toy."""
