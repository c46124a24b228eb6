"""Verdicts: whether the number of a claim lies where the sentence of the paper wants it.

One rule decides all claims (`judge`). The 95 % interval of the mean over seeds (Student's t) lies inside the
region of the claim: *holds*; outside: *does not hold*; across its edge, or with one seed only: *not decided*.
Two surfaces are compared seed by seed, since one seed gives both the same random phases. A number that does
not depend on a random surface has its numerical uncertainty as interval. A claim whose surfaces or datasets
the configuration lacks stays in the table, with *no data*.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import stdtrit

from asperity.paper.claims.continuum import continuum
from asperity.paper.claims.evidence import Evidence, Fixed, Measure, MissingEvidenceError

HOLDS, FAILS, UNDECIDED, NO_DATA = "holds", "does not hold", "not decided", "no data"
VERDICTS = (HOLDS, FAILS, UNDECIDED, NO_DATA)

CONFIDENCE = 0.95
"""Confidence of the intervals."""


class Region(NamedTuple):
    """Interval in which a claim wants its number."""

    low: float
    high: float

    def __str__(self) -> str:
        if np.isinf(self.high):
            return f"> {self.low:g}"
        return f"< {self.high:g}" if self.low <= 0 else f"{self.low:g} to {self.high:g}"


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
    region : Region
        Where the sentence wants the number.
    measure : callable
        Takes the number from the evidence.
    """

    identifier: str
    section: str
    sentence: str
    quantity: str
    region: Region
    measure: Measure


@dataclass(frozen=True)
class Finding:
    """A claim with its verdict.

    Parameters
    ----------
    claim : Claim
    verdict : one of `VERDICTS`
    value : float
        Mean over seeds.
    error : float
        Standard error over seeds, or the numerical uncertainty; NaN with one seed.
    low, high : float
        Interval that decides.
    seeds : int
        Number of seeds; 0 if no random surface enters.
    missing : str
        What is missing, if the verdict is *no data*.
    shift, shift_error : float
        What the continuum limit adds to the value, where it is known; else NaN.
    """

    claim: Claim
    verdict: str
    value: float = np.nan
    error: float = np.nan
    low: float = np.nan
    high: float = np.nan
    seeds: int = 0
    missing: str = ""
    shift: float = np.nan
    shift_error: float = np.nan


def decide(
    claims: Sequence[Claim], evidence: Evidence, finer: Mapping[float, Evidence] | None = None
) -> list[Finding]:
    """Judge every claim, with the shift of its number to vanishing grid spacing where it is known.

    Parameters
    ----------
    claims : sequence of Claim
    evidence : Evidence
    finer : mapping, optional
        As of `continuum`. The shift is the limit less the value on the coarsest of these grids, which should
        have as many nodes on the shortest wavelength as the study.
    """
    findings = []
    for claim in claims:
        finding = judge(claim, evidence)
        try:
            limit = continuum(claim.measure, finer or {})
        except MissingEvidenceError:
            findings.append(finding)
        else:
            shift = limit.limit - float(limit.values[0])
            findings.append(replace(finding, shift=shift, shift_error=limit.error))
    return findings


def judge(claim: Claim, evidence: Evidence) -> Finding:
    """Decide one claim by the rule of this module."""
    try:
        found = claim.measure(evidence)
    except MissingEvidenceError as missing:
        return Finding(claim, NO_DATA, missing=str(missing))
    unknown = int(np.sum(~np.isfinite(found)))
    if unknown:
        return Finding(claim, NO_DATA, missing=f"nothing to measure in {unknown} of {np.size(found)} numbers")
    if isinstance(found, Fixed):
        seeds, value, error = 0, *found
        half = error
    else:
        seeds, value, error, half = found.size, float(found.mean()), np.nan, np.nan
        if seeds > 1:
            error = float(found.std(ddof=1) / np.sqrt(seeds))
            half = float(stdtrit(seeds - 1, 0.5 + CONFIDENCE / 2)) * error
    low, high = value - half, value + half
    return Finding(claim, _verdict(low, high, claim.region), value, error, low, high, seeds)


def _verdict(low: float, high: float, region: Region) -> str:
    if region.low <= low and high <= region.high:
        return HOLDS
    if high < region.low or low > region.high:
        return FAILS
    return UNDECIDED


def tally(findings: Sequence[Finding]) -> dict[str, int]:
    """Number of claims with each verdict."""
    return {verdict: sum(f.verdict == verdict for f in findings) for verdict in VERDICTS}
