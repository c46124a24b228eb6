"""Differences between two surfaces: intervals, and the sentence that says which is better."""

import numpy as np
import pytest
from scipy import stats

from asperity.engineering.question import Row
from asperity.engineering.sample import SampleRow, mean_of_maps
from asperity.engineering.several_answers import differences, verdict

GROUP, NAME = "stress in the elastic body", "volume above yield per area"


def sample_row(values, errors=np.nan):
    return SampleRow(GROUP, NAME, "m", mean_of_maps(values, errors), np.array(values))


def test_samples_differ_as_welch_says():
    first, second = [1.31e-6, 1.2e-6, 1.45e-6], [0.30e-6, 0.35e-6, 0.22e-6, 0.31e-6]
    (found,) = differences([sample_row(first)], [sample_row(second)])
    welch = stats.ttest_ind(second, first, equal_var=False)
    low, high = welch.confidence_interval(0.95)
    assert (found.chance, found.error) == (pytest.approx(welch.pvalue), pytest.approx((high - low) / 2))
    (wider,) = differences([sample_row(first, 1e-7)], [sample_row(second, 1e-7)])
    assert wider.error == pytest.approx(np.sqrt(found.error**2 + 2e-14))
    said = verdict([found], ("ground", "superfinished"), [NAME])
    assert said.startswith(
        "superfinished: volume above yield per area 0.295 µm against 1.32 µm of ground; bet"
    )
    assert f"p = {welch.pvalue:.2g}" in said


def test_single_maps_say_that_places_are_not_known():
    rows = [
        Row(GROUP, NAME, value, "m", "", value, 1e-8, "the pixels", places)
        for value, places in ((1.3e-6, np.nan), (0.3e-6, 2e-7), (0.4e-6, 2e-7))
    ]
    (unknown,) = differences(rows[:1], rows[1:2])
    assert np.isnan(unknown.chance)
    assert "add maps" in verdict([unknown], ("a", "b"), [NAME])
    (known,) = differences(rows[1:2], rows[2:])
    assert known.error == pytest.approx(np.sqrt(2 * (1e-8**2 + 2e-7**2)))
    assert known.chance == pytest.approx(2 * stats.norm.sf(stats.norm.ppf(0.975) * 1e-7 / known.error))
    assert "no significant difference" in verdict([known], ("a", "b"), [NAME])
