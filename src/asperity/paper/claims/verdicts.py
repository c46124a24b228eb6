"""Verdicts: whether the number of a claim lies where the sentence of the paper wants it.

A claim is judged under every reading that the paper's text admits: every combination of the options of its
choices (section ``readings`` of the configuration), the study's own options first. Under one reading
(`judge`) the 95 % interval of the mean over seeds (Student's t) lies inside the region of the claim: *holds*;
outside: *does not hold*; across its edge, or with one seed only: *not decided*. Two surfaces are compared
seed by seed, since one seed gives both the same random phases. A number that does not depend on a random
surface has its numerical uncertainty as interval. Where the continuum limit of the number is known and
differs from the number by more than the standard error, the limit decides, with its error in the interval.

The claim *holds* or *does not hold* if it does under every reading. It *depends on* choices if it holds under
one reading and does not under another; it is *not decided* if a reading does not decide it and no other
contradicts. A claim whose surfaces or datasets the configuration lacks stays in the table, with *no data*.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.special import stdtrit

from asperity.paper.claims.continuum import Limit, continuum
from asperity.paper.claims.evidence import Evidence, Fixed, Measure, MissingEvidenceError, Options

HOLDS, FAILS, UNDECIDED, NO_DATA = "holds", "does not hold", "not decided", "no data"
DEPENDS, UNTESTABLE = "depends on the reading", "not testable here"
VERDICTS = (HOLDS, FAILS, DEPENDS, UNDECIDED, UNTESTABLE, NO_DATA)

CONFIDENCE = 0.95
"""Confidence of the intervals."""

LIMIT_ERRORS = 2.0
"""Errors of a continuum limit that its interval takes to each side."""


class Region(NamedTuple):
    """Interval in which a claim wants its number."""

    low: float
    high: float

    def __str__(self) -> str:
        if np.isinf(self.high):
            return f"> {self.low:g}"
        return f"< {self.high:g}" if self.low <= 0 else f"{self.low:g} to {self.high:g}"


@dataclass(frozen=True)
class Threshold:
    """A region whose edge the paper does not give: a choice of the readings.

    Parameters
    ----------
    choice : str
        Name in section ``readings``.
    own : float
        The study's own option.
    region : callable
        Option → region.
    """

    choice: str
    own: float
    region: Callable[[float], Region]


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
    quantity : str
        What exactly is measured.
    wanted : Region or Threshold
        Where the sentence wants the number.
    measure : callable
        Takes the number from the evidence.
    untestable : str
        Why our number cannot refute the sentence; empty if it can.
    """

    identifier: str
    section: str
    sentence: str
    quantity: str
    wanted: Region | Threshold
    measure: Measure
    untestable: str = ""

    @property
    def region(self) -> Region:
        """Where the sentence wants the number, in the study's own reading."""
        return self.region_under({})

    @property
    def choices(self) -> tuple[str, ...]:
        """Choices of the readings on which the verdict may depend."""
        of_number = getattr(self.measure, "choices", ())
        grid = ("grid",) if of_number or hasattr(self.measure, "parts") else ()
        edge = (self.wanted.choice,) if isinstance(self.wanted, Threshold) else ()
        return (*of_number, *grid, *edge)

    def region_under(self, options: Options) -> Region:
        """Where the sentence wants the number under a reading."""
        if isinstance(self.wanted, Region):
            return self.wanted
        return self.wanted.region(options.get(self.wanted.choice, self.wanted.own))


@dataclass(frozen=True)
class Judgement:
    """The number of a claim under one reading, and what it decides.

    Parameters
    ----------
    options : mapping
        Choice of the claim → option taken.
    region : Region
    verdict : one of `VERDICTS`
    value : float
        Mean over seeds, or its continuum limit where that decides.
    error : float
        Standard error over seeds, or the numerical uncertainty; NaN with one seed.
    low, high : float
        Interval that decides.
    seeds : int
        Number of seeds; 0 if no random surface enters.
    missing : str
        What is missing, if the verdict is *no data*.
    at_nodes : float
        The value on the study's grid.
    shift, shift_error : float
        What the continuum limit adds to the value on the study's grid, where it is known; else NaN.
    """

    options: Options
    region: Region
    verdict: str
    value: float = np.nan
    error: float = np.nan
    low: float = np.nan
    high: float = np.nan
    seeds: int = 0
    missing: str = ""
    at_nodes: float = np.nan
    shift: float = np.nan
    shift_error: float = np.nan


@dataclass(frozen=True)
class Finding:
    """A claim with its verdict over all readings.

    Parameters
    ----------
    claim : Claim
    verdict : one of `VERDICTS`
    judgements : tuple of Judgement
        One for each reading, the study's own first.
    choices : tuple of names
        Choices on which the verdict depends, or which leave it undecided.
    shown : tuple of Judgement
        Readings that show the verdict: the study's own, and those nearest to it that decide otherwise.
    """

    claim: Claim
    verdict: str
    judgements: tuple[Judgement, ...]
    choices: tuple[str, ...] = ()
    shown: tuple[Judgement, ...] = ()

    @property
    def own(self) -> Judgement:
        """The study's own reading."""
        return self.judgements[0]


def decide(
    claims: Sequence[Claim],
    evidence: Evidence,
    finer: Mapping[float, Evidence] | None = None,
    readings: Mapping[str, Sequence] | None = None,
) -> list[Finding]:
    """Judge every claim under every reading.

    Parameters
    ----------
    claims : sequence of Claim
    evidence : Evidence
    finer : mapping, optional
        As of `continuum`. The limit less the value on the coarsest of these grids, which should have as many
        nodes on the shortest wavelength as the study, is added to the value of the study.
    readings : mapping, optional
        Choice → its options, the study's own first: section ``readings`` of the configuration. By default
        every choice has the study's own option alone.
    """
    return [
        conclude(claim, list(_judgements(claim, evidence, finer or {}, readings or {}))) for claim in claims
    ]


def _judgements(
    claim: Claim,
    evidence: Evidence,
    finer: Mapping[float, Evidence],
    readings: Mapping[str, Sequence],
) -> Iterator[Judgement]:
    """The judgement of a claim under every reading of its choices, the study's own first."""
    names = [name for name in claim.choices if readings.get(name)]
    measured: dict[tuple, tuple[xr.DataArray | Fixed | MissingEvidenceError, Limit | None]] = {}
    of_number = [name for name in names if name in getattr(claim.measure, "choices", ())]
    for values in product(*(readings[name] for name in names)):
        options = dict(zip(names, values, strict=True))
        key = tuple(options[name] for name in of_number)
        if key not in measured:
            measured[key] = _measured(claim, evidence.under(options), finer, options)
        yield _judgement(claim, options, *measured[key])


def _measured(
    claim: Claim, evidence: Evidence, finer: Mapping[float, Evidence], options: Options
) -> tuple[xr.DataArray | Fixed | MissingEvidenceError, Limit | None]:
    """The number of a claim under a reading, or what is missing for it, and its continuum limit."""
    try:
        found = claim.measure(evidence)
    except MissingEvidenceError as missing:
        return missing, None
    try:
        limit = continuum(claim.measure, {nodes: one.under(options) for nodes, one in finer.items()})
    except MissingEvidenceError:
        limit = None
    return found, limit


def judge(claim: Claim, evidence: Evidence) -> Judgement:
    """Decide one claim under one reading, that of the evidence, by the rule of this module."""
    return _judgement(claim, evidence.options, *_measured(claim, evidence, {}, evidence.options))


def _judgement(
    claim: Claim, options: Options, found: xr.DataArray | Fixed | MissingEvidenceError, limit: Limit | None
) -> Judgement:
    region = claim.region_under(options)
    if isinstance(found, MissingEvidenceError):
        return Judgement(options, region, NO_DATA, missing=str(found))
    unknown = int(np.sum(~np.isfinite(found)))
    if unknown:
        missing = f"nothing to measure in {unknown} of {np.size(found)} numbers"
        return Judgement(options, region, NO_DATA, missing=missing)
    if isinstance(found, Fixed):
        seeds, value, error = 0, *found
        half = error
    else:
        seeds, value, error, half = found.size, float(found.mean()), np.nan, np.nan
        if seeds > 1:
            error = float(found.std(ddof=1) / np.sqrt(seeds))
            half = float(stdtrit(seeds - 1, 0.5 + CONFIDENCE / 2)) * error
    at_nodes, shift, shift_error = value, np.nan, np.nan
    if limit is not None:
        shift, shift_error = limit.limit - float(limit.values[0]), limit.error
        if options.get("grid", "continuum") == "continuum" and abs(shift) > error:
            value += shift
            error, half = (
                float(np.hypot(error, shift_error)),
                float(np.hypot(half, LIMIT_ERRORS * shift_error)),
            )
    low, high = value - half, value + half
    verdict = _verdict(low, high, region)
    return Judgement(
        options, region, verdict, value, error, low, high, seeds, "", at_nodes, shift, shift_error
    )


def _verdict(low: float, high: float, region: Region) -> str:
    if region.low <= low and high <= region.high:
        return HOLDS
    if high < region.low or low > region.high:
        return FAILS
    return UNDECIDED


def conclude(claim: Claim, judgements: Sequence[Judgement]) -> Finding:
    """The verdict over all readings of a claim, and the choices and readings that show it.

    Readings without data are left out, unless the study's own is one of them.
    """
    every = tuple(judgements)
    own, known = every[0], [one for one in every if one.verdict != NO_DATA]
    found = {one.verdict for one in known}
    if own.verdict == NO_DATA:
        return Finding(claim, NO_DATA, every, shown=(own,))
    if claim.untestable and own.verdict != HOLDS:
        return Finding(claim, UNTESTABLE, every, shown=(own,))
    if len(found) == 1:
        return Finding(claim, own.verdict, every, shown=(own,))
    if {HOLDS, FAILS} <= found:
        choices, pair = _contrast(own, known, (HOLDS, FAILS))
        return Finding(claim, DEPENDS, every, choices, pair)
    decided = (found - {UNDECIDED}).pop()
    choices, pair = _contrast(own, known, (decided, UNDECIDED))
    return Finding(claim, UNDECIDED, every, choices, pair)


def _contrast(
    own: Judgement, known: Sequence[Judgement], verdicts: tuple[str, str]
) -> tuple[tuple[str, ...], tuple[Judgement, ...]]:
    """The choices that tell two verdicts apart, and readings that show it, those nearest to the study's own.

    Of all pairs of readings with the two verdicts, those count that differ in the fewest choices, and among
    these the ones nearest to the study's own reading.
    """

    def apart(one: Judgement, other: Judgement) -> tuple[str, ...]:
        return tuple(name for name in own.options if one.options[name] != other.options[name])

    pairs = [
        (one, other)
        for one in known
        if one.verdict == verdicts[0]
        for other in known
        if other.verdict == verdicts[1]
    ]
    rank = [
        (len(apart(one, other)), min(len(apart(own, one)), len(apart(own, other)))) for one, other in pairs
    ]
    nearest = [pair for pair, place in zip(pairs, rank, strict=True) if place == min(rank)]
    choices = tuple(name for name in own.options if any(name in apart(*pair) for pair in nearest))
    shown: list[Judgement] = []
    for pair in nearest:
        for one in sorted(pair, key=lambda one: len(apart(own, one))):
            if one not in shown:
                shown.append(one)
    return choices, tuple(shown)


def tally(findings: Sequence[Finding]) -> dict[str, int]:
    """Number of claims with each verdict."""
    return {verdict: sum(f.verdict == verdict for f in findings) for verdict in VERDICTS}
