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


_PAPER = packaged_yaml("asperity.paper.claims", "paper.yaml")

REGIONS = {name: Region(*map(float, ends)) for name, ends in _PAPER["regions"].items()}
"""Name → region; ``alike`` is a choice of the interpretation."""


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
    """A claim from its entry; one without a number has a function of its name."""
    measure = Number(**number) if number else getattr(closed_forms, identifier)
    return Claim(identifier, measure=measure, **fields)


CLAIMS = tuple(_claim(identifier, **entry) for identifier, entry in _PAPER["statements"].items())
