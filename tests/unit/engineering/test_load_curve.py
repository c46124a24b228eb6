"""Load curves of answers, the load where yield begins, conductances, and answers with a hardness."""

from functools import cache

import numpy as np
import pytest
from samples import refuses
from test_engineering import AS_IT_IS, EDGE, a_rough_map, a_sphere, hertz

import asperity as asp
from asperity import Body, Case, run
from asperity.engineering.questions.load_curve import yield_load

STEEL = Body(young=210e9, poisson=0.3)
LOAD = {"mean_pressure": 100e6}


@cache
def answer_of(**constants):
    """The answer of a rough map on steel with other constants."""
    return run(a_rough_map(), STEEL.replaced(**constants), **LOAD)


def test_answer_is_that_of_the_last_load():
    curve = run(a_rough_map(), STEEL, mean_pressure=100e6, load_curve={"loads": [1e6, 10e6]})
    alone = answer_of()
    np.testing.assert_array_equal(curve.contact.pressure, alone.contact.pressure)
    assert "curve" not in alone.tables
    table = curve.tables["curve"]
    assert table["mean_pressure_Pa"].to_numpy() == pytest.approx([1e6, 10e6, 100e6])
    for name in ("contact_area_fraction", "normal_approach_m", "maximum_pressure_Pa", "stiffness_Pa_m"):
        assert np.all(np.diff(table[name]) > 0)
    assert np.all(np.diff(table["mean_gap_m"]) < 0)
    last = table.iloc[-1]
    assert last["contact_area_fraction"] == alone["contact area fraction"].value
    assert last["normal_approach_m"] == alone["normal approach"].value
    assert last["mean_gap_m"] == pytest.approx(alone["mean gap"].value)
    von_mises = alone["maximum von Mises stress"].value
    assert last["maximum_von_mises_lower_Pa"] == pytest.approx(von_mises, rel=1e-6)


def test_yield_of_a_sphere_begins_where_hertz_says():
    """Von Mises stress 0.62 p₀ at ν = 0.3 (Johnson 1985, Sec. 6.1); errors of the grid and the cell."""
    _, largest = hertz(STEEL)
    limit = 0.62 * largest / 2 ** (1 / 3)  # half of the load of the sphere: p₀ grows as its third root
    body, sphere = STEEL.replaced(yield_stress=limit), {"file": a_sphere(), **AS_IT_IS}
    answer = run(sphere, body, force=0.8, load_curve={"loads": [0.2]})
    begins = answer.record("mean pressure where yield begins", "lower")
    assert begins.value == pytest.approx(0.5 / EDGE**2, rel=0.05)
    assert begins.errors == {"the search": pytest.approx(0.005 * begins.value)}
    assert begins.text().endswith("by the search")


def test_yield_beyond_the_curve_is_a_bound():
    loads, stresses = np.array([1.0, 2.0, 4.0]), np.array([1.0, 2.0, 4.0])
    never = pytest.fail
    assert yield_load(loads, stresses, 0.5, never) == 0
    assert yield_load(loads, stresses, 5.0, never) == np.inf
    assert yield_load(loads, stresses, 3.0, lambda load: load) == pytest.approx(3.0, rel=0.005)


def loads_of(*values, last, steps=None, kind="mean_pressure"):
    """Loads in SI units of a curve that ends at a load."""
    curve = {"loads": values} | ({} if steps is None else {"steps": steps})
    case = Case(map="a.x3p", body=STEEL, load={kind: last}, load_curve=curve)
    return case.load_curve.path(case)


CONDUCTING = STEEL.replaced(conductivity=50.0)

test_wrong_loads_are_refused = refuses(
    (lambda: loads_of("5 MPa", last="1 MPa"), "load_curve.loads = 5 MPa, 1 MPa: a list of rising values"),
    (lambda: loads_of("1 MPa", 2e6, last="5 MPa", steps=3), "load_curve.loads = 2 values: a single one is n"),
    (lambda: loads_of(last="5 MPa", steps=3), r"load_curve.loads = \[\]: a list of 1 to 99 rising values"),
    (
        lambda: loads_of(0.1, last=0.1, kind="contact_area_fraction"),
        "load_curve.loads = 0.1, 0.1: a list of rising",
    ),
    (lambda: loads_of("5 N", last="1 MPa"), "load_curve.loads: '5 N': a mean pressure is needed"),
    (lambda: run(a_rough_map(), CONDUCTING, force=1.0), "conduction: a counter_body is needed"),
    (lambda: run(a_rough_map(), CONDUCTING, STEEL, force=1.0), "counter_body.conductivity: missing"),
    (lambda: asp.engineering.load_curve([]), ".*at least one is needed"),
)


def test_steps_are_in_equal_ratios():
    assert loads_of("1 MPa", last="100 MPa", steps=3) == pytest.approx([1e6, 10e6, 100e6])


def test_full_contact_is_infinitely_stiff():
    height = asp.self_affine((64, 64), 0.8, 5e-4, 2.5e-4, rms_height=1e-6, seed=1, length=1e-3)
    body = Body(young=200e9, poisson=0.3, conductivity=50.0)
    surface = asp.HeightMap(height, (1e-3, 1e-3), periodic=True, unit="m", name="sine")
    answer = run(surface, body, body, mean_pressure=10e9, load_curve={"loads": [1e9]})
    for name in ("thermal contact conductance", "stiffness"):
        assert answer[name].value == np.inf
        assert answer[name].text().startswith("infinite, as the bodies are in full contact")
    assert answer.tables["curve"]["stiffness_Pa_m"].iloc[-1] == np.inf


def plastic(answer):
    return {each.quantity: each.value for each in answer.records if each.topic == "plastic contact"}


def test_hardness_limits_the_pressure():
    answer = answer_of(hardness=4e9)
    contact, found = answer.contact, plastic(answer)
    assert answer["maximum pressure"].value == pytest.approx(4e9)
    assert found["area fraction at the hardness"] == contact.plastic_area > 0
    assert found["load fraction at the hardness"] == contact.plastic_load > 0
    assert found["maximum plastic depth"] == contact.plastic_depth.max() > 0
    gradient = asp.roughness_parameters(contact.height, contact.grid).rms_gradient
    assert found["plasticity index"] == pytest.approx(210e9 / (1 - 0.3**2) * gradient / 4e9)
    # The maximum pressure is the hardness on every grid.
    assert np.isnan(answer["maximum pressure"].extrapolated)


def test_smaller_hardness_counts():
    bodies = [STEEL.replaced(hardness=hardness) for hardness in (4e9, 8e9)]
    contacts = [run(a_rough_map(), *pair, **LOAD).contact for pair in (bodies, bodies[::-1])]
    for contact in contacts:
        assert contact.hardness == pytest.approx(4e9)


def test_yield_stress_is_a_hardness_and_the_elastic_numbers_stand_beside():
    """Tabor's, unless another is given, the load is beyond it, or no pressure reaches it."""
    elastic, answer = answer_of(yield_stress=4e9 / 3, hardness=np.inf), answer_of(yield_stress=4e9 / 3)
    hard = answer_of(hardness=4e9)
    np.testing.assert_array_equal(answer.contact.pressure, hard.contact.pressure)
    for name in ("contact area fraction", "maximum pressure"):
        assert answer[f"{name}, elastic"].value == pytest.approx(elastic[name].value)
        assert f"{name}, elastic" not in {each.quantity for each in (*elastic.records, *hard.records)}
    assert any(each.short.startswith("model: an elastic contact") for each in answer.uncertainties)
    assert "3 times the yield stress" in answer["hardness"].note
    for limit in (100e9, 30e6):  # far above all pressures, and below a third of the mean pressure
        contact = answer_of(yield_stress=limit).contact
        np.testing.assert_array_equal(contact.pressure, elastic.contact.pressure)
    beyond = [each.subject for each in answer_of(yield_stress=30e6).warnings]
    assert "load beyond the hardness" in beyond


def test_a_larger_force_than_any_hardness_is_answered_elastically():
    """As is a full contact; a hardness that is given refuses the first."""
    soft, edge = {"young": 1e9, "poisson": 0.3, "yield_stress": 1e6}, 1e-4
    height = asp.self_affine((16, 16), 0.8, edge / 2, edge / 4, 1e-7, seed=1, length=edge)
    surface = asp.HeightMap(height, (edge, edge), periodic=True, unit="m")
    for load in ({"force": 4e6 * edge**2}, {"contact_area_fraction": 1.0}):
        assert np.isinf(run(surface, asp.Body(**soft), **load).contact.hardness)
    with pytest.raises(asp.SettingsError, match="a mean pressure below the hardness"):
        run(surface, asp.Body(**soft, hardness=3e6), force=4e6 * edge**2)


test_wrong_hardness_is_refused = refuses(
    (
        lambda: run(a_rough_map(), STEEL.replaced(hardness=50e6), **LOAD),
        "load.mean_pressure = 100 MPa: a mean pressure below the hardness 50 MPa is needed; check both",
    ),
    (lambda: STEEL.replaced(hardness=0.0), "hardness = 0.0"),
)
