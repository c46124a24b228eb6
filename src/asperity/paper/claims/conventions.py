"""Likelihood of the conventions that the paper leaves open, from all statements that depend on them.

A set of conventions takes one option of every choice in `CONVENTIONS`. It reproduces a statement with the
probability that the number lies in the region predicted, given its estimate and its interval. Choices that
are no convention of a computation, such as thresholds, are averaged over. A statement may be wrong for
another reason with probability `SLIP`, so that none counts for everything. The likelihood of a set is the
product over the statements; that of one option is the largest over all sets that take it. Statements about
the same surfaces are not independent, so the ratios of likelihoods overstate; `CLEAR` is set accordingly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.special import ndtr, ndtri

from asperity.paper.claims.verdicts import CONFIDENCE, NO_DATA, UNTESTABLE, Finding, Judgement

CONVENTIONS = ("lateral", "peaks", "patches", "shear", "scaling", "breadth", "decay", "delta")
"""Choices of the readings that say how the paper computed its numbers."""

SLIP = 0.05
"""Probability with which a statement is wrong, or right, for a reason that no convention explains."""

CLEAR = 20.0
"""Ratio of likelihoods from which the statements decide for an option."""

SPEAKS = 0.5
"""Difference of the probability of a statement from which it speaks for an option."""


@dataclass(frozen=True)
class Support:
    """How well an option of a choice reproduces the statements.

    Parameters
    ----------
    choice : str
    option : object
    own : bool
        Whether it is the study's own option.
    relative : float
        Likelihood over that of the best option of the choice.
    expected : float
        Number of statements that depend on the choice and are reproduced, expected under the best set of
        conventions with this option.
    statements : int
        Number of statements that depend on the choice.
    favoured_by : tuple of str
        Identifiers of statements that are more likely under it than under the study's own option, or the best
        other one if it is the study's own.
    """

    choice: str
    option: object
    own: bool
    relative: float
    expected: float
    statements: int
    favoured_by: tuple[str, ...]


def probability(one: Judgement) -> float:
    """Probability that the true number lies in the region, given estimate and interval; NaN if unknown."""
    if one.verdict == NO_DATA or not np.isfinite(one.low):
        return np.nan
    deviation = (one.high - one.low) / 2 / ndtri(0.5 + CONFIDENCE / 2)
    if deviation == 0:
        return float(one.region.low <= one.value <= one.region.high)
    return float(
        ndtr((one.region.high - one.value) / deviation) - ndtr((one.region.low - one.value) / deviation)
    )


def support(findings: Sequence[Finding]) -> list[Support]:
    """Support of every option of every convention that some statement depends on."""
    tables = {
        f.claim.identifier: table
        for f in findings
        if f.verdict not in (NO_DATA, UNTESTABLE) and (table := _table(f))
    }
    options: dict[str, dict] = {}
    for f in findings:
        for one in f.judgements if f.claim.identifier in tables else ():
            for name in CONVENTIONS:
                if name in one.options:
                    options.setdefault(name, {})[one.options[name]] = None
    names = [name for name in CONVENTIONS if len(options.get(name, ())) > 1]
    sets = [dict(zip(names, values, strict=True)) for values in product(*(options[name] for name in names))]
    each = [{key: _of_set(table, taken) for key, table in tables.items()} for taken in sets]
    total = np.array([sum(np.log(SLIP + (1 - 2 * SLIP) * p) for p in one.values()) for one in each])
    found = []
    for name in names:
        best = {
            option: max((k for k, taken in enumerate(sets) if taken[name] == option), key=lambda k: total[k])
            for option in options[name]
        }
        top = max(total[k] for k in best.values())
        touched = [key for key, table in tables.items() if any(name in dict(taken) for taken in table)]
        own = next(iter(options[name]))
        for option, k in best.items():
            others = [b for o, b in best.items() if o != option]
            rival = best[own] if option != own else max(others, key=lambda b: total[b])
            favoured = tuple(key for key in touched if each[k][key] - each[rival][key] > SPEAKS)
            expected = sum(each[k][key] for key in touched)
            found.append(
                Support(
                    name,
                    option,
                    option == own,
                    float(np.exp(total[k] - top)),
                    expected,
                    len(touched),
                    favoured,
                )
            )
    return found


_Table = Mapping[tuple[tuple[str, object], ...], float]
"""Options of the conventions that a statement depends on → its probability under them."""


def _table(finding: Finding) -> _Table:
    """Probability of a statement under the options of its conventions, averaged over all other choices."""
    found: dict[tuple[tuple[str, object], ...], list[float]] = {}
    for one in finding.judgements:
        key = tuple((name, option) for name, option in one.options.items() if name in CONVENTIONS)
        if np.isfinite(chance := probability(one)):
            found.setdefault(key, []).append(chance)
    return {key: float(np.mean(chances)) for key, chances in found.items()}


def _of_set(table: _Table, taken: Mapping[str, object]) -> float:
    """Probability of a statement under a set of conventions; one half where it has no data for the set."""
    for key, chance in table.items():
        if all(taken.get(name, option) == option for name, option in key):
            return chance
    return 0.5
