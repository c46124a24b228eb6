"""Likelihood of the conventions: by hand-made judgements, against the formula written out."""

import numpy as np
import pytest
from scipy.stats import norm

from asperity.paper.claims.conventions import SLIP, probability, support
from asperity.paper.claims.evidence import Fixed
from asperity.paper.claims.verdicts import Claim, Judgement, Region, conclude

HALF = 1.959964
"""Half an interval of 95 % of a normal distribution, in standard deviations."""


ABOVE_ONE = Region(1.0, np.inf)


def judged(value, deviation=0.1, region=ABOVE_ONE, **options):
    half = HALF * deviation
    low, high = value - half, value + half
    verdict = "holds" if low > 1 else "does not hold" if high < 1 else "not decided"
    return Judgement(options, region, verdict, value, deviation, low, high, 8)


def claim(name, *judgements):
    return conclude(Claim(name, "5.2", name, "q", Region(1.0, np.inf), lambda e: Fixed(1)), judgements)


def test_the_probability_is_that_of_a_normal_estimate():
    assert probability(judged(1.05)) == pytest.approx(norm.cdf(0.5), rel=1e-6)
    assert probability(judged(1.5, 0.1, Region(1.4, 1.6))) == pytest.approx(2 * norm.cdf(1) - 1, rel=1e-6)
    assert probability(judged(1.2, 0.0)) == 1
    assert np.isnan(probability(Judgement({}, Region(1, 2), "not decided", 1.5, seeds=1)))


def test_the_likelihood_of_an_option_is_the_product_over_the_statements():
    """Three statements for `free`, one for `confined`, one that the choice does not touch."""
    found = [
        *(claim(f"s{n}", judged(0.5, lateral="confined"), judged(1.5, lateral="free")) for n in range(3)),
        claim("other", judged(1.5, lateral="confined"), judged(0.5, lateral="free")),
        claim("plain", judged(1.5, alike=0.05), judged(1.5, alike=0.1)),
    ]
    confined, free = support(found)
    assert (confined.option, free.option) == ("confined", "free")
    assert free.relative == 1
    chance = SLIP / (1 - SLIP)
    assert confined.relative == pytest.approx(chance**2, rel=1e-4)
    assert free.expected == pytest.approx(3, abs=1e-4)
    assert free.statements == 4
    assert free.favoured_by == ("s0", "s1", "s2")
    assert confined.favoured_by == ("other",)
    assert confined.own
    assert not free.own


def test_thresholds_are_averaged_and_other_conventions_are_free():
    """The peaks make good what the uniform mode breaks: no option of it is worse then."""
    table = {
        ("confined", "below"): 0.5,
        ("confined", "with"): 1.5,
        ("free", "below"): 1.5,
        ("free", "with"): 1.5,
    }
    joint = claim("s", *(judged(v, lateral=a, peaks=b) for (a, b), v in table.items()))
    by_option = {(one.choice, one.option): one.relative for one in support([joint])}
    assert all(value == pytest.approx(1) for value in by_option.values())
    half = claim(
        "t",
        judged(0.5, lateral="confined", alike=0.05),
        judged(1.5, lateral="confined", alike=0.1),
        judged(1.5, lateral="free", alike=0.05),
        judged(1.5, lateral="free", alike=0.1),
    )
    confined, _ = support([half])
    assert confined.relative == pytest.approx(0.5 / (1 - SLIP), rel=1e-4)


def test_a_statement_that_is_undecided_alike_says_nothing():
    confined, free = support([claim("s", judged(1.0, lateral="confined"), judged(1.0, lateral="free"))])
    assert confined.relative == free.relative == pytest.approx(1)
    assert confined.favoured_by == free.favoured_by == ()
