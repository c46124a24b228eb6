"""Change of an answer with each input, and the error by inputs with a tolerance."""

import numpy as np
import pytest
from samples import refuses

import asperity as asp

SMOOTH = asp.HeightMap(np.zeros((96, 96)), (96e-6, 96e-6), unit="m", name="ball")
BALL = {"file": SMOOTH, "radius": "1 mm", "periodic": "none"}


@pytest.fixture(scope="module")
def answer():
    body = {"young": "210 GPa ± 5 %", "poisson": 0.3}
    return asp.run(BALL, body, load={"force": "1 N ± 3 %"})


def test_changes_are_the_exponents_of_hertz(answer):
    """p₀ ∝ F^(1/3) E^(2/3) (K. L. Johnson, Contact Mechanics, 1985, Eq. 4.24)."""
    table = answer.tables["sensitivity"]
    found = table[table["quantity"] == "maximum pressure"].set_index("input")["change"]
    assert found["load.force"] == pytest.approx(1.01 ** (1 / 3) - 1, rel=0.05)
    assert found["body.young"] == pytest.approx(1.01 ** (2 / 3) - 1, rel=0.05)


def test_tolerance_of_an_input_is_a_named_error(answer):
    pressure = answer["maximum pressure"]
    error = pressure.value * np.hypot(0.05 * 2 / 3, 0.03 / 3)
    assert pressure.errors["the inputs"] == pytest.approx(error, rel=0.05)
    assert " GPa by the inputs" in pressure.text()
    assert answer.case.body.young == 210e9
    assert answer.case.sensitivity.tolerances == {"body.young": 0.05, "load.force": 0.03}


def case(young="2 GPa", poisson=0.3):
    return lambda: asp.Case(map="a", body={"young": young, "poisson": poisson}, load={"force": "1 N"})


test_wrong_tolerance_is_refused = refuses(
    (case("2 GPa ± 5"), "body.young = 2 GPa ± 5: a tolerance in per cent is needed"),
    (case(poisson="0.3 ± 5 %"), "body.poisson: a tolerance is accepted for load.force, body.young"),
    (case("2 GPa ± 200 %"), "body.young: a tolerance below 100 % is needed, ± 200 % is given"),
)
