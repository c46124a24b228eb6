"""Claims and verdicts: the number of a sentence of the paper is compared with the region that the sentence
implies.

The claims are read from `paper.yaml`. A claim is judged under every interpretation that the paper's text
admits: every combination of the options of its choices (`asperity.paper.claims.sources.CHOICES`), the study's
own options first. Under one of them (`judge`) the 95 % interval of the mean over seeds (Student's t) lies
inside the region of the claim (`REGIONS`): *holds*; outside: *does not hold*; across its edge, or with one
seed only: *not decided*. A claim that our number cannot refute holds or is *not testable here*. Two surfaces
are compared seed by seed, since one seed gives both the same random phases. The numbers are estimates at
zero grid spacing, and the discretisation error that remains widens the interval in quadrature. A number
that does not depend on a random surface has its numerical uncertainty as interval.

The claim *holds* or *does not hold* if it does under every interpretation. It *depends on* choices if it
holds under one and does not under another; it is *not decided* if one interpretation does not decide it and
no other contradicts. A claim whose surfaces or datasets the configuration lacks stays, with *no data*.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from scipy.special import stdtrit

from asperity.core.data import packaged_yaml
from asperity.paper.claims import numbers
from asperity.paper.claims.numbers import (
    Evidence,
    FixedNumber,
    Measure,
    MissingEvidenceError,
    Number,
    Options,
)
from asperity.paper.claims.sources import CHOICES


class Region(NamedTuple):
    """Interval in which the number of a claim lies if the claim holds."""

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
        The number: a ratio of two quantities, or one with its unit.
    region : str
        Region of the number if the sentence holds: a name of `REGIONS`, or ``alike``.
    measure : callable
        Takes the number from the evidence.
    untestable : str
        Reason why our number cannot refute the sentence; empty if it can.
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
        """Region of the number if the sentence holds under an interpretation."""
        if self.region != "alike":
            return REGIONS[self.region]
        share = options.get("alike", CHOICES["alike"][0])
        return Region(1 - share, 1 + share)


def _claim(identifier: str, number: Mapping[str, Any] | None = None, **fields: str) -> Claim:
    """A claim from its entry; one without a number has a function of its name."""
    measure = Number(**number) if number else getattr(numbers, identifier)
    return Claim(identifier, measure=measure, **fields)


CLAIMS = tuple(_claim(identifier, **entry) for identifier, entry in _PAPER["statements"].items())

HOLDS, FAILS, UNDECIDED, NO_DATA = "holds", "does not hold", "not decided", "no data"
DEPENDS, UNTESTABLE = "depends on the interpretation", "not testable here"
VERDICTS = (HOLDS, FAILS, DEPENDS, UNDECIDED, UNTESTABLE, NO_DATA)

CONFIDENCE = 0.95
"""Confidence of the intervals."""


@dataclass(frozen=True)
class Judgement:
    """The number of a claim under one interpretation, and its verdict: a row of ``interpretations.csv``.

    Parameters
    ----------
    interpretation : mapping
        Choice of the claim → option taken.
    region_low, region_high : float
        Region of the number if the statement holds.
    value : float
        Mean over seeds, at zero grid spacing where a correction is known.
    value_on_grid : float
        The same on the grid of the study.
    standard_error : float
        Over seeds, or the numerical uncertainty; NaN with one seed.
    grid_error : float
        Discretisation error that remains after its correction.
    interval_low, interval_high : float
        Interval that decides the verdict, from both errors.
    seeds : int
        Number of seeds; 0 if no random surface enters.
    verdict : one of `VERDICTS`
    missing : str
        The missing evidence, if the verdict is *no data*.
    """

    interpretation: Options
    region_low: float
    region_high: float
    value: float = np.nan
    value_on_grid: float = np.nan
    standard_error: float = np.nan
    grid_error: float = np.nan
    interval_low: float = np.nan
    interval_high: float = np.nan
    seeds: int = 0
    verdict: str = NO_DATA
    missing: str = ""

    @property
    def region(self) -> Region:
        """Region of the number if the statement holds."""
        return Region(self.region_low, self.region_high)


@dataclass(frozen=True)
class Finding:
    """A claim with its verdict over all interpretations.

    Parameters
    ----------
    claim : Claim
    verdict : one of `VERDICTS`
    judgements : tuple of Judgement
        One for each interpretation, the study's own first.
    choices : tuple of names
        Choices on which the verdict depends, or which leave it undecided.
    shown : tuple of Judgement
        Interpretations that show the verdict: the study's own, or two with different verdicts.
    """

    claim: Claim
    verdict: str
    judgements: tuple[Judgement, ...]
    choices: tuple[str, ...] = ()
    shown: tuple[Judgement, ...] = ()

    @property
    def own(self) -> Judgement:
        """The study's own interpretation."""
        return self.judgements[0]


def decide(
    claims: Sequence[Claim],
    evidence: Evidence,
    interpretations: Mapping[str, Sequence] | None = None,
) -> list[Finding]:
    """Judge every claim under every interpretation.

    Parameters
    ----------
    claims : sequence of Claim
    evidence : Evidence
    interpretations : mapping, optional
        Choice → its options, the study's own first, as `asperity.paper.claims.sources.CHOICES`. By default
        every choice has the study's own option alone.
    """

    def judgements(claim: Claim) -> Iterator[Judgement]:
        names = [name for name in claim.choices if (interpretations or {}).get(name)]
        for values in product(*((interpretations or {})[name] for name in names)):
            yield judge(claim, evidence.under(dict(zip(names, values, strict=True))))

    return [conclude(claim, list(judgements(claim))) for claim in claims]


def judge(claim: Claim, evidence: Evidence) -> Judgement:
    """Decide one claim under the interpretation of the evidence, by the rule of this module."""
    options, region = evidence.options, claim.region_under(evidence.options)
    try:
        found = claim.measure(evidence)
    except MissingEvidenceError as lacking:
        return Judgement(options, *region, missing=str(lacking))
    values = np.atleast_1d(found.value if isinstance(found, FixedNumber) else found.values)
    if unknown := int(np.sum(~np.isfinite(values))):
        missing = f"nothing to measure in {unknown} of {values.size} numbers"
        return Judgement(options, *region, missing=missing)
    value, error, half = float(values.mean()), np.nan, np.nan
    if isinstance(found, FixedNumber):
        seeds, on_grid, of_grid = 0, value, np.nan
        error = half = found.uncertainty
    else:
        seeds, on_grid, of_grid = values.size, float(found.on_grid.mean()), float(found.grid_errors.mean())
        if seeds > 1:
            error = float(values.std(ddof=1) / np.sqrt(seeds))
            half = float(np.hypot(stdtrit(seeds - 1, 0.5 + CONFIDENCE / 2) * error, of_grid))
    low, high = value - half, value + half
    verdict = UNDECIDED
    if region.low <= low and high <= region.high:
        verdict = HOLDS
    elif claim.untestable:
        verdict = UNTESTABLE
    elif high < region.low or low > region.high:
        verdict = FAILS
    return Judgement(options, *region, value, on_grid, error, of_grid, low, high, seeds, verdict)


def conclude(claim: Claim, judgements: Sequence[Judgement]) -> Finding:
    """The verdict over all interpretations of a claim, and the choices and judgements that decide it.

    Interpretations without data are left out, unless the study's own is one of them. If verdicts differ, two
    interpretations are shown that give the two verdicts and differ in the fewest choices; of several such
    pairs, the one nearest to the study's own interpretation.
    """
    every = tuple(judgements)
    found = {one.verdict for one in every} - {NO_DATA}
    if every[0].verdict == NO_DATA or len(found) == 1:
        return Finding(claim, every[0].verdict, every, shown=every[:1])
    depends = {HOLDS, FAILS} <= found
    verdicts = (HOLDS, FAILS) if depends else (*(found - {UNDECIDED}), UNDECIDED)

    def apart(one: Judgement, other: Judgement) -> tuple[str, ...]:
        options = one.interpretation.items()
        return tuple(name for name, option in options if option != other.interpretation[name])

    def from_own(one: Judgement) -> int:
        return len(apart(every[0], one))

    pairs = product(*([one for one in every if one.verdict == verdict] for verdict in verdicts))
    pair = min(pairs, key=lambda pair: (len(apart(*pair)), sum(map(from_own, pair))))
    shown = tuple(sorted(pair, key=from_own))
    return Finding(claim, DEPENDS if depends else UNDECIDED, every, apart(*pair), shown)


def tally(findings: Sequence[Finding]) -> dict[str, int]:
    """Number of claims with each verdict."""
    return {verdict: sum(f.verdict == verdict for f in findings) for verdict in VERDICTS}
