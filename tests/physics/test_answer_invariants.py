"""What holds in every answer, on the surfaces of all families with all pairs of bodies and questions.

Every other answer that tests compute, as of templates and of the cases of the pages, is checked, too
(`checked_answers`).
"""

from dataclasses import replace

import numpy as np
import pytest
from answer_invariants import violations
from families import FAMILIES, Nodes

import asperity as asp
from asperity.engineering.records import DISCRETISATION, Bounds, Position

SHAPE, EDGE, PRESSURE = (30, 24), (15e-6, 12e-6), 2e8
STEEL, SOFT = {"young": 210e9, "poisson": 0.3}, {"young": 70e9, "poisson": 0.33}
BODIES = (
    STEEL | {"yield_stress": 1e9},
    STEEL | {"hardness": 3e9, "yield_stress": 1e9},
    STEEL | {"layers": [{"thickness": 1e-6, "young": 400e9, "poisson": 0.2, "residual_stress": -1e9}]},
)
COUNTERS = None, None, SOFT | {"yield_stress": 3e8}, STEEL | {"hardness": 2e9}
QUESTIONS = (
    {},
    {"sliding": {"friction": 0.3, "direction": 30}},
    {"sliding": {"friction": 0.05, "direction": "y"}, "film": {"load_fraction": 0.6}},
    {"running_in": {"loads": 2, "hardness": 2.5e9}, "load_curve": {"loads": [2e7, 8e7]}},
)


@pytest.mark.parametrize("family", names := [name for name in FAMILIES if name != "flat"])
def test_invariants_hold_on_every_family(family):
    """On a mirrored or periodic map; every pair of body, counter body and question occurs."""
    number, draw = names.index(family), np.random.default_rng(names.index(family))
    relief = FAMILIES[family](Nodes(SHAPE, 0.3, number))
    surface = asp.HeightMap(
        -1e-7 * 4 ** draw.random() * relief, EDGE, periodic=bool(draw.random() < 0.3), unit="m", name=family
    )
    body, counter, questions = BODIES[number % 3], COUNTERS[number % 4], QUESTIONS[number // 4 % 4]
    if "layers" in body:
        questions = {name: each for name, each in questions.items() if name != "film"}
    answer = asp.run({"file": surface, "detrend": "none"}, body, counter, mean_pressure=PRESSURE, **questions)
    assert list(violations(answer)) == []


def with_record(answer, quantity, **changes):
    """The answer with a number that differs."""
    records = [replace(each, **changes) if each.quantity == quantity else each for each in answer.records]
    return replace(answer, records=tuple(records))


WRONG = {
    "is outside": ("contact area fraction", {"value": 1.2}),
    "has not the bounds": ("contact area fraction", {"bounds": Bounds()}),
    "of a map of": ("maximum von Mises stress", {"position": Position(0.0, 0.0, 1.0)}),
    "not from √3 to 2": ("maximum shear stress (Tresca)", {"value": 1.0}),
    "do not rise": ("mean contact pressure", {"value": 1e12}),
    "exceeds the hardness": ("maximum pressure", {"value": 4e9, "bounds": Bounds()}),
    "different relative errors": ("contact area", {"errors": {DISCRETISATION: 1e-10}}),
    "is not said of": ("maximum von Mises stress", {"errors": {DISCRETISATION: 1e9}}),
}


@pytest.mark.parametrize("words", WRONG)
def test_violated_invariants_are_found(words):
    body = STEEL | {"hardness": 3e9, "yield_stress": 1.5e9}
    height = asp.self_affine((24, 24), 0.8, 12e-6, 4e-6, rms_height=1e-7, seed=1, length=24e-6)
    surface = asp.HeightMap(height, (24e-6, 24e-6), periodic=True, unit="m", name="rough")
    answer = asp.run(surface, body, mean_pressure=PRESSURE)
    assert list(violations(answer)) == []
    quantity, changes = WRONG[words]
    assert any(words in text for text in violations(with_record(answer, quantity, **changes)))
