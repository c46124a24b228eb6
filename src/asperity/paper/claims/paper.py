"""The statements of the paper, from `paper.yaml`: each a number, and the region in which it wants it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from asperity.core.data import packaged_yaml
from asperity.paper.claims import closed_forms
from asperity.paper.claims.numbers import Measure, Number, Options
from asperity.paper.claims.sources import CHOICES


class Region(NamedTuple):
    """Interval in which a claim wants its number."""

    low: float
    high: float

    def __str__(self) -> str:
        if np.isinf(self.high):
            return f"> {self.low:g}"
        return f"< {self.high:g}" if self.low <= 0 else f"{self.low:g} to {self.high:g}"


REGIONS = {
    "positive": Region(0.0, np.inf),
    "larger": Region(1.0, np.inf),
    "smaller": Region(0.0, 1.0),
    # The paper gives no numbers for these: docs/claims.md lists the verdicts that other edges would change.
    # A distance of distributions from quantiles is low by up to 0.0025 for ten thousand peaks.
    "clearly larger": Region(1.05, np.inf),
    "clearly smaller": Region(0.0, 0.95),
    "overlapping": Region(0.0, 0.05),
    "different": Region(0.05, 1.0),
    "about 1.5": Region(1.4, 1.6),
    "controlled": Region(0.5, 1.0),
    "small": Region(0.0, 0.5),
    "one percent": Region(0.0, 0.01),
}
"""Name in `paper.yaml` → region; ``alike`` is a choice of the interpretation."""


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper as a number.

    Parameters
    ----------
    identifier : str
    section : str
        Of the paper; several are separated by commas.
    sentence : str
        In our words.
    compared : str
        What the number is: a ratio of two quantities, or one with its unit.
    region : str
        Where the sentence wants the number: a name of `REGIONS`, or ``alike``.
    measure : callable
        Takes the number from the evidence.
    untestable : str
        Why our number cannot refute the sentence; empty if it can.
    """

    identifier: str
    section: str
    sentence: str
    compared: str
    region: str
    measure: Measure
    untestable: str = ""

    @property
    def choices(self) -> tuple[str, ...]:
        """Choices of the interpretation on which the verdict may depend."""
        return (*getattr(self.measure, "choices", ()), *(("alike",) if self.region == "alike" else ()))

    def region_under(self, options: Options) -> Region:
        """Where the sentence wants the number under an interpretation."""
        if self.region != "alike":
            return REGIONS[self.region]
        share = options.get("alike", CHOICES["alike"][0])
        return Region(1 - share, 1 + share)


def _claim(identifier: str, number: Mapping[str, Any] | None = None, **fields: str) -> Claim:
    """A claim from its entry, in which tuples may be single texts."""
    if number is None:
        return Claim(identifier, measure=getattr(closed_forms, identifier), **fields)
    pairs = {
        name: (number[name],) if isinstance(number[name], str) else tuple(number[name])
        for name in ("of", "quantity", "poisson", "follows")
        if name in number
    }
    return Claim(identifier, measure=Number(**{**number, **pairs}), **fields)


_PAPER = packaged_yaml("asperity.paper.claims", "paper.yaml")

CLAIMS = tuple(_claim(identifier, **entry) for identifier, entry in _PAPER["statements"].items())
