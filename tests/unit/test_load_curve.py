"""Load curves of answers, the load where yield begins, conductances, and answers with a hardness."""

import numpy as np
import pytest
from samples import refuses
from test_engineering import AS_IT_IS, EDGE, a_rough_map, a_sphere, hertz

import asperity as asp
from asperity.engineering import Body, run
from asperity.engineering.case import loads_of
from asperity.engineering.load_curve import yield_load

STEEL = Body(210e9, 0.3)


def test_answer_is_that_of_the_last_load():
    curve = run(a_rough_map(), STEEL, mean_pressure=[1e6, 10e6, 100e6])
    alone = run(a_rough_map(), STEEL, mean_pressure=100e6)
    np.testing.assert_array_equal(curve.contact.pressure, alone.contact.pressure)
    assert alone.curve is None
    table = curve.curve.frame()
    assert table["mean_pressure_Pa"].to_numpy() == pytest.approx([1e6, 10e6, 100e6])
    for name in ("area_fraction", "approach_m", "largest_pressure_Pa", "stiffness_Pa_m"):
        assert np.all(np.diff(table[name]) > 0)
    assert np.all(np.diff(table["mean_gap_m"]) < 0)
    last = table.iloc[-1]
    assert last["area_fraction"] == alone.numbers.area_fraction
    assert last["approach_m"] == alone.numbers.approach
    assert last["mean_gap_m"] == pytest.approx(alone.numbers.mean_gap)
    largest = alone.bodies["lower"].largest_von_mises
    assert last["largest_von_mises_lower_Pa"] == pytest.approx(largest, rel=1e-6)


def test_yield_of_a_sphere_begins_where_hertz_says():
    """Von Mises stress 0.62 p₀ at ν = 0.3 (Johnson 1985, Sec. 6.1); errors of the grid and the cell."""
    _, largest = hertz(STEEL)
    limit = 0.62 * largest / 2 ** (1 / 3)  # half of the load of the sphere: p₀ grows as its third root
    body = Body(STEEL.young, STEEL.poisson, yield_stress=limit)
    answer = run(a_sphere(), body, force=[0.2, 0.8], map_options=AS_IT_IS)
    assert answer.curve.yield_loads["lower"] == pytest.approx(0.5 / EDGE**2, rel=0.05)
    (row,) = (row for row in answer.rows if row.name.startswith("mean pressure where yield"))
    assert row.shown.endswith("± 0.5 %")


def test_yield_beyond_the_curve_is_a_bound():
    loads, stresses = np.array([1.0, 2.0, 4.0]), np.array([1.0, 2.0, 4.0])
    never = pytest.fail
    assert yield_load(loads, stresses, 0.5, never) == 0
    assert yield_load(loads, stresses, 5.0, never) == np.inf
    assert yield_load(loads, stresses, 3.0, lambda load: load) == pytest.approx(3.0, rel=0.005)


def pressures(*values, **settings):
    return loads_of("pressure", {"pressure": [*values], **settings})


test_wrong_loads_are_refused = refuses(
    (lambda: pressures("5 MPa", "1 MPa"), "pressure = '5 MPa 1 MPa': a list of rising values is needed"),
    (lambda: pressures("5 MPa", steps=3), "pressure = '5 MPa': two values, the first and the last"),
    (lambda: loads_of("area_fraction", {"area_fraction": [0.1, 0.1]}), "area_fraction = '0.1 0.1': a list"),
    (lambda: run(a_rough_map(), STEEL, mean_pressure=[2e6, 1e6]), ".*rising"),
    (lambda: run(a_rough_map(), Body(1.0, 0.3, conductivity=50.0), force=1.0), "conductivity = 50: a second"),
    (lambda: asp.load_curve([]), ".*at least one is needed"),
)


def test_steps_are_in_equal_ratios():
    assert pressures("1 MPa", "100 MPa", steps=3) == pytest.approx([1e6, 10e6, 100e6])


@pytest.mark.parametrize("nodes", [63, 64])  # the mean mode of rounding errors is 0 on even grids alone
def test_full_contact_is_infinitely_stiff(nodes, tmp_path):
    height = asp.self_affine((nodes, nodes), 0.8, 5e-4, 2.5e-4, rms_height=1e-6, seed=1, length=1e-3)
    contact = asp.solve(height, asp.Layer(200e9, 0.3), 1e-3, mean_pressure=10e9)
    assert contact.area_fraction == 1
    assert contact.stiffness == contact.conductance(1.0) == np.inf
    assert contact.load_interval[1] == np.inf
    on_layer = asp.solve(height, asp.Layer(200e9, 0.3, height=1e-4), 1e-3, mean_pressure=50e9)
    oedometric = 200e9 * 0.7 / (1.3 * 0.4) / 1e-4  # uniform strain fixed laterally
    assert on_layer.area_fraction == 1
    assert on_layer.stiffness == pytest.approx(oedometric)

    body = Body(200e9, 0.3, conductivity=50.0)
    surface = asp.HeightMap(height, (1e-3, 1e-3), periodic=True, unit="m", name="sine")
    answer = run(surface, body, Body(200e9, 0.3, conductivity=50.0), mean_pressure=[1e9, 10e9])
    rows = {row.name: row for row in answer.rows}
    for name in ("thermal contact conductance", "stiffness"):
        assert rows[name].value == np.inf
        assert rows[name].shown.startswith("infinite, as the bodies touch everywhere")
    asp.write_answer(answer, tmp_path / "out")
    assert "<td>infinite</td>" in (tmp_path / "out" / "report.html").read_text()


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
