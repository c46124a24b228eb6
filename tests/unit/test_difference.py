"""Differences between two surfaces: intervals, and the sentence that says which is better."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

import asperity as asp
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.records import DISCRETISATION, POSITIONS, Record
from asperity.engineering.sample import SampleData
from asperity.engineering.show.comparison import compared

NAME = "volume above yield per area"
KEY = "stress", "lower", NAME
STEEL = {"young": "210 GPa", "poisson": 0.3, "yield_stress": "2 GPa"}
CASE = asp.Case(map="a.x3p", body=STEEL, load={"force": "1 N"})


def answer(value, **errors):
    """An answer with the volume above yield alone, with errors of the pixels and between positions."""
    known = {DISCRETISATION: errors.get("pixels", 0.0), POSITIONS: errors.get("positions", 0.0)}
    record = Record(NAME, value, "m", *KEY[:2], errors=known, varies=True, better="less")
    return AnswerData(CASE, SimpleNamespace(name="map"), None, (record,), (), (), (), {}, {})


def sample(values, **errors):
    return SampleData({str(number): answer(value, **errors) for number, value in enumerate(values)})


def test_samples_differ_as_welch_says():
    values = {"ground": [1.31e-6, 1.2e-6, 1.45e-6], "superfinished": [0.30e-6, 0.35e-6, 0.22e-6, 0.31e-6]}
    comparison = compared({name: sample(each) for name, each in values.items()})
    found = comparison.difference(KEY, *values)
    welch = stats.ttest_ind(values["superfinished"], values["ground"], equal_var=False)
    low, high = welch.confidence_interval(0.95)
    assert (found.chance, found.error) == (pytest.approx(welch.pvalue), pytest.approx((high - low) / 2))
    wider = compared({name: sample(each, pixels=1e-7) for name, each in values.items()})
    error = wider.difference(KEY, *values).error
    assert error == pytest.approx(np.sqrt(found.error**2 + 2e-14))
    shown = r"superfinished: volume above yield per area 0\.\d+ ± 0\.\d+ µm against 1\.\d+ ± 0\.\d+ µm of "
    assert re.fullmatch(rf"{shown}ground; better, p = {welch.pvalue:.2g}\.", comparison.verdict)


def test_single_maps_say_that_positions_are_not_known():
    both = {"pixels": 1e-8, "positions": 2e-7}
    unknown = compared({"a": answer(1.3e-6, pixels=1e-8), "b": answer(0.3e-6, **both)})
    assert np.isnan(unknown.difference(KEY, "a", "b").chance)
    assert "differences between positions are not known" in unknown.verdict
    comparison = compared({"a": answer(0.3e-6, **both), "b": answer(0.4e-6, **both)})
    known = comparison.difference(KEY, "a", "b")
    assert known.error == pytest.approx(np.sqrt(2 * (1e-8**2 + 2e-7**2)))
    assert known.chance == pytest.approx(2 * stats.norm.sf(stats.norm.ppf(0.975) * 1e-7 / known.error))
    assert "no significant difference" in comparison.verdict
