"""Answers with a hardness, given or suggested by the yield stress."""

import numpy as np
import pytest
from samples import refuses
from test_engineering import a_rough_map

import asperity as asp
from asperity.engineering import Body, run

SOFT = Body(210e9, 0.3, hardness=4e9)
LOAD = {"mean_pressure": 100e6}


def rows(answer):
    return {row.name: row.value for row in answer.rows if row.group.startswith("plastic contact")}


def test_hardness_limits_the_pressure():
    answer = run(a_rough_map(), SOFT, **LOAD)
    contact, found = answer.contact, rows(answer)
    assert answer.numbers.largest_pressure == pytest.approx(4e9)
    assert found["area at the hardness"] == contact.plastic_area > 0
    assert found["load at the hardness"] == contact.plastic_load > 0
    assert found["largest plastic depth"] == contact.plastic_depth.max() > 0
    gradient = asp.roughness_parameters(contact.height, contact.grid.length).rms_gradient
    assert found["plasticity index"] == pytest.approx(210e9 / (1 - 0.3**2) * gradient / 4e9)
    largest = next(row for row in answer.rows if row.name == "largest pressure")
    assert np.isnan(largest.estimate)  # the largest pressure is the hardness on every grid


def test_smaller_hardness_counts():
    hard = Body(210e9, 0.3, hardness=8e9)
    contacts = [run(a_rough_map(), *bodies, **LOAD).contact for bodies in ((SOFT, hard), (hard, SOFT))]
    for contact in contacts:
        assert contact.hardness == pytest.approx(4e9)


def test_yield_stress_suggests_a_hardness():
    """The answer is that of the elastic contact, with the plastic one beside it."""
    elastic = run(a_rough_map(), Body(210e9, 0.3), **LOAD)
    answer = run(a_rough_map(), Body(210e9, 0.3, yield_stress=4e9 / 3), **LOAD)
    np.testing.assert_array_equal(answer.contact.pressure, elastic.contact.pressure)
    assert rows(elastic) == {}
    plastic, found = run(a_rough_map(), SOFT, **LOAD), rows(answer)
    assert found["plastic real contact"] == plastic.numbers.area_fraction > elastic.numbers.area_fraction
    assert found["load at the hardness"] == pytest.approx(rows(plastic)["load at the hardness"])
    strong = run(a_rough_map(), Body(210e9, 0.3, yield_stress=100e9), **LOAD)
    assert rows(strong) == {}


test_wrong_hardness_is_refused = refuses(
    (lambda: run(a_rough_map(), Body(1e9, 0.3, hardness=50e6), **LOAD), "hardness = 50 MPa: more than the p"),
    (lambda: Body(210e9, 0.3, hardness=0.0), "hardness"),
)
