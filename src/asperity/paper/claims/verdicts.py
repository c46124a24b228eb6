"""Verdicts: whether the number of a claim lies where the sentence of the paper wants it.

A claim is judged under every interpretation that the paper's text admits: every combination of the options
of its choices (section ``interpretations`` of the configuration), the study's own options first. Under one of
them (`judge`) the 95 % interval of the mean over seeds (Student's t) lies inside the region of the claim:
*holds*; outside: *does not hold*; across its edge, or with one seed only: *not decided*. A claim that our
number cannot refute holds or is *not testable here*. Two surfaces are
compared seed by seed, since one seed gives both the same random phases. A number that does not depend on a
random surface has its numerical uncertainty as interval. Where the continuum limit of the number is known and
differs from the number by more than the standard error, the limit decides, with its error in the interval.

The claim *holds* or *does not hold* if it does under every interpretation. It *depends on* choices if it
holds under one and does not under another; it is *not decided* if one interpretation does not decide it and
no other contradicts. A claim whose surfaces or datasets the configuration lacks stays, with *no data*.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.special import stdtrit

from asperity.paper.claims.continuum import continuum
from asperity.paper.claims.numbers import Evidence, Fixed, MissingEvidenceError, Options
from asperity.paper.claims.paper import Claim, Region

HOLDS, FAILS, UNDECIDED, NO_DATA = "holds", "does not hold", "not decided", "no data"
DEPENDS, UNTESTABLE = "depends on the interpretation", "not testable here"
VERDICTS = (HOLDS, FAILS, DEPENDS, UNDECIDED, UNTESTABLE, NO_DATA)

CONFIDENCE = 0.95
"""Confidence of the intervals."""

LIMIT_ERRORS = 2.0
"""Errors of a continuum limit that its interval takes to each side."""


@dataclass(frozen=True)
class Judgement:
    """The number of a claim under one interpretation, and what it decides: a row of ``interpretations.csv``.

    Parameters
    ----------
    interpretation : mapping
        Choice of the claim → option taken.
    region_low, region_high : float
        Where the statement wants the number.
    value : float
        Mean over seeds, or its continuum limit where that decides.
    standard_error : float
        Over seeds, or the numerical uncertainty; NaN with one seed.
    interval_low, interval_high : float
        Interval that decides.
    seeds : int
        Number of seeds; 0 if no random surface enters.
    verdict : one of `VERDICTS`
    value_at_nodes : float
        The value on the study's grid.
    continuum_shift, continuum_shift_error : float
        What the continuum limit adds to the value on the study's grid, where it is known; else NaN.
    missing : str
        What is missing, if the verdict is *no data*.
    """

    interpretation: Options
    region_low: float
    region_high: float
    value: float = np.nan
    standard_error: float = np.nan
    interval_low: float = np.nan
    interval_high: float = np.nan
    seeds: int = 0
    verdict: str = NO_DATA
    value_at_nodes: float = np.nan
    continuum_shift: float = np.nan
    continuum_shift_error: float = np.nan
    missing: str = ""

    @property
    def region(self) -> Region:
        """Where the statement wants the number."""
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
        Interpretations that show the verdict: the study's own, and those nearest to it that decide otherwise.
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
    finer: Mapping[float, Evidence] | None = None,
    interpretations: Mapping[str, Sequence] | None = None,
) -> list[Finding]:
    """Judge every claim under every interpretation.

    Parameters
    ----------
    claims : sequence of Claim
    evidence : Evidence
    finer : mapping, optional
        As of `continuum`. The limit less the value on the coarsest of these grids, which should have as many
        nodes on the shortest wavelength as the study, is added to the value of the study.
    interpretations : mapping, optional
        Choice → its options, the study's own first: section ``interpretations`` of the configuration. By
        default every choice has the study's own option alone.
    """

    def judgements(claim: Claim) -> Iterator[Judgement]:
        names = [name for name in claim.choices if (interpretations or {}).get(name)]
        for values in product(*((interpretations or {})[name] for name in names)):
            options = dict(zip(names, values, strict=True))
            of_grids = {nodes: one.under(options) for nodes, one in (finer or {}).items()}
            yield judge(claim, evidence.under(options), of_grids)

    return [conclude(claim, list(judgements(claim))) for claim in claims]


def judge(claim: Claim, evidence: Evidence, finer: Mapping[float, Evidence] | None = None) -> Judgement:
    """Decide one claim under one interpretation, that of the evidence, by the rule of this module."""
    options, region = evidence.options, claim.region_under(evidence.options)
    try:
        found = claim.measure(evidence)
    except MissingEvidenceError as lacking:
        return Judgement(options, *region, missing=str(lacking))
    if unknown := int(np.sum(~np.isfinite(found))):
        missing = f"nothing to measure in {unknown} of {np.size(found)} numbers"
        return Judgement(options, *region, missing=missing)
    if isinstance(found, Fixed):
        seeds, value, error = 0, *found
        half = error
    else:
        seeds, value, error, half = found.size, float(found.mean()), np.nan, np.nan
        if seeds > 1:
            error = float(found.std(ddof=1) / np.sqrt(seeds))
            half = float(stdtrit(seeds - 1, 0.5 + CONFIDENCE / 2)) * error
    at_nodes, shift, shift_error = value, np.nan, np.nan
    try:
        limit = continuum(claim.measure, finer or {})
        shift, shift_error = limit.limit - float(limit.values[0]), limit.error
        if abs(shift) > error:
            value += shift
            error = float(np.hypot(error, shift_error))
            half = float(np.hypot(half, LIMIT_ERRORS * shift_error))
    except MissingEvidenceError:
        pass
    low, high = value - half, value + half
    verdict = UNDECIDED
    if region.low <= low and high <= region.high:
        verdict = HOLDS
    elif claim.untestable:
        verdict = UNTESTABLE
    elif high < region.low or low > region.high:
        verdict = FAILS
    return Judgement(options, *region, value, error, low, high, seeds, verdict, at_nodes, shift, shift_error)


def conclude(claim: Claim, judgements: Sequence[Judgement]) -> Finding:
    """The verdict over all interpretations of a claim, and the choices and judgements that show it.

    Interpretations without data are left out, unless the study's own is one of them.
    """
    every = tuple(judgements)
    found = {one.verdict for one in every} - {NO_DATA}
    if every[0].verdict == NO_DATA or len(found) == 1:
        return Finding(claim, every[0].verdict, every, shown=every[:1])
    if {HOLDS, FAILS} <= found:
        return Finding(claim, DEPENDS, every, *_contrast(every, HOLDS, FAILS))
    (decided,) = found - {UNDECIDED}
    return Finding(claim, UNDECIDED, every, *_contrast(every, decided, UNDECIDED))


def _contrast(every: Sequence[Judgement], *verdicts: str) -> tuple[tuple[str, ...], tuple[Judgement, ...]]:
    """The choices that tell two verdicts apart, and judgements that show it, nearest to the study's own.

    The study's own judgement is the first one. Of all pairs of interpretations with the two verdicts, those
    count that differ in the fewest choices, and among these the ones nearest to the study's own.
    """

    def apart(one: Judgement, other: Judgement) -> tuple[str, ...]:
        return tuple(
            name for name in own.interpretation if one.interpretation[name] != other.interpretation[name]
        )

    own = every[0]
    of_verdict = [[one for one in every if one.verdict == verdict] for verdict in verdicts]
    ranked: dict[tuple[int, int], list[tuple[Judgement, ...]]] = {}
    for pair in product(*of_verdict):
        rank = (len(apart(*pair)), min(len(apart(own, one)) for one in pair))
        ranked.setdefault(rank, []).append(pair)
    nearest = ranked[min(ranked)]
    choices = tuple(name for name in own.interpretation if any(name in apart(*pair) for pair in nearest))
    shown: list[Judgement] = []
    for pair in nearest:
        for one in sorted(pair, key=lambda one: len(apart(own, one))):
            if one not in shown:
                shown.append(one)
    return choices, tuple(shown)


def tally(findings: Sequence[Finding]) -> dict[str, int]:
    """Number of claims with each verdict."""
    return {verdict: sum(f.verdict == verdict for f in findings) for verdict in VERDICTS}
