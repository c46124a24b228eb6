"""Several layers on a body of a case: numbers of each layer and interface, and strengths of layers."""

import numpy as np
import pytest
from samples import refuses
from scipy.integrate import quad
from test_engineering import a_rough_map

import asperity as asp
from asperity import Body, run
from asperity.engineering.drawing import yield_at
from asperity.engineering.questions.strength import energy_release_rate
from asperity.engineering.scene import solid_of
from asperity.engineering.show.pictures import pictures

STEEL = {"young": 210e9, "poisson": 0.3, "yield_stress": 1e9}
HARD, BOND = (
    {"thickness": 2e-6, "young": 400e9, "poisson": 0.2, "yield_stress": 4e9},
    {"thickness": 0.5e-6, "young": 280e9, "poisson": 0.21, "yield_stress": 0.4e9},
)
STACK = Body(**STEEL, layers=[HARD | {"residual_stress": 5e8}, BOND | {"residual_stress": -2e8}])
PRESSURE = 400e6


@pytest.fixture(scope="module")
def answer():
    return run(a_rough_map(), STACK, mean_pressure=PRESSURE)


def test_parts_and_interfaces_have_names_and_depths():
    assert [*STACK.parts] == ["layer 1", "layer 2", "the base"]
    assert STACK.interfaces == {"interface 1": 2e-6, "interface 2": 2e-6 + 0.5e-6}
    assert [*Body(**STEEL, layers=[HARD]).parts] == ["the coating", "the base"]
    film = Body(base="bonded", layers=[HARD, BOND])
    assert ([*film.parts], [*film.interfaces]) == (["layer 1", "layer 2"], ["the interface"])
    assert [*Body(base="bonded", layers=[HARD]).parts] == [*Body(**STEEL).parts] == [""]
    for body in (STACK, film):
        solid = solid_of(body)
        assert solid.interfaces == tuple(body.interfaces.values())
        assert solid_of(Body.model_validate(solid)) == solid
    depths = [1e-6, 2e-6, 2.2e-6, 2e-6 + 0.5e-6, 3e-6]
    np.testing.assert_array_equal(yield_at(STACK, np.array(depths)), [4e9, 4e9, 0.4e9, 0.4e9, 1e9])


def test_numbers_of_layers_and_interfaces_are_those_of_the_planes(answer):
    """On both faces of each interface, with the residual stress of the layer."""
    faces = [face for depth in STACK.interfaces.values() for face in (depth, np.nextafter(depth, 1))]
    names = ("xx", "xz", "yz", "zz", "von_mises")
    solid = answer.contact.in_body("lower")
    planes = [each.fields for each in asp.stress_planes(solid, faces, fields=names, tolerance=0)]
    sides = [("1", "layer 1", 5e8), ("1", "layer 2", -2e8), ("2", "layer 2", -2e8), ("2", "the base", 0.0)]
    for (interface, part, residual), plane in zip(sides, planes, strict=True):
        xx = plane["xx"] + residual
        found = answer[f"σ_xx on interface {interface}, in {part}"]
        assert found.value == pytest.approx(xx.flat[np.abs(xx).argmax()], rel=2e-3)
        assert bool(found.note) == bool(residual)
        shear = answer[f"maximum shear stress on interface {interface}"]
        assert shear.value == pytest.approx(np.hypot(plane["xz"], plane["yz"]).max(), rel=2e-3)
        assert shear.position.depth == STACK.interfaces[f"interface {interface}"]
    for part in STACK.parts:
        largest = answer[f"maximum von Mises stress in {part}"]
        assert largest.value <= answer["maximum von Mises stress"].value
        assert largest.errors["discretisation"] > 0
    assert answer["maximum shear stress on interface 2"].errors["discretisation"] > 0


def test_each_layer_yields_by_its_own_limit(answer):
    edges = dict(zip(STACK.parts, [(0, 2e-6), (2e-6, 2.5e-6), (2.5e-6, 1.0)], strict=True))
    for part, (top, bottom) in edges.items():
        within = "" if part == "the base" else f" in {part}"
        limit = STACK.parts[part].yield_stress
        assert answer[f"yield stress{within.replace(' in', ' of')}"].value == limit
        assert (answer[f"volume above yield{within}"].value > 0) == (
            answer[f"maximum von Mises stress in {part}"].value > limit
        )
        assert any(f"{part} yields" in text.replace("Layer", "layer") for text in answer.verdict)
        assert top < answer[f"maximum depth above yield{within}"].value <= bottom * (1 + 1e-12)


def test_a_split_layer_is_the_whole_layer():
    """Two layers of one material are one layer: the same contact and stress, in another number of parts."""
    halves = [HARD | {"thickness": 0.75e-6}, HARD | {"thickness": 1.25e-6}]
    one, two = (
        run(a_rough_map(), Body(**STEEL, layers=each), mean_pressure=60e6) for each in ([HARD], halves)
    )
    for name in ("maximum pressure", "contact area fraction", "volume above yield"):
        assert two[name].value == pytest.approx(one[name].value, rel=1e-4)
    pairs = {"maximum shear stress on interface 2": "maximum shear stress on the interface"}
    pairs["maximum von Mises stress in the base"] = "maximum von Mises stress in the base"
    for own, other in pairs.items():
        assert two[own].value == pytest.approx(one[other].value, rel=1e-3)
    assert two["volume above yield in layer 1"].value + two[
        "volume above yield in layer 2"
    ].value == pytest.approx(one["volume above yield in the coating"].value, rel=0.02)


def test_answer_is_opened_with_its_layers(answer, tmp_path, without_pictures):
    answer.write(tmp_path / "answer")
    opened = asp.open_answer(tmp_path / "answer")
    assert opened.case.bodies == answer.case.bodies
    assert opened.records == answer.records
    depth = STACK.interfaces["interface 2"]
    for fields in ([each.plane(depth), each.section()] for each in (answer, opened)):
        assert {depth, np.nextafter(depth, 1)} <= set(fields[1]["depth"].values)
        for own, other in zip(fields, (answer.plane(depth), answer.section()), strict=True):
            np.testing.assert_array_equal(own, other)
    assert {"interface_1_shear", "interface_2_shear", "section"} <= {each.name for each in pictures(opened)}


def test_energy_release_rate_is_the_mean_of_an_edge_crack():
    """G of a crack along a layer is the mean of K²/Ē of edge cracks of all depths, K = 1.1215 σ √(π a)."""
    stress, thickness, young, poisson = 2e9, 3e-6, 300e9, 0.2
    of_depth = lambda depth: (1.1215 * stress) ** 2 * np.pi * depth * (1 - poisson**2) / young  # noqa: E731
    mean = quad(of_depth, 0, thickness)[0] / thickness
    assert energy_release_rate(stress, thickness, young, poisson) == pytest.approx(mean)
    assert mean == pytest.approx(1.976 * stress**2 * thickness * (1 - poisson**2) / young, rel=1e-3)


@pytest.mark.parametrize(
    ("strength", "text", "quantity", "factor"),
    [
        ({"energy": 1e3}, "The layers hold: least strength over stress", "crack in the coating", 1e3),
        ({"energy": 1e-2}, "The coating cracks: ", "crack in the coating", 1e-2),
        ({"shear": 1e3}, "The interface peels in shear: ", "shear of the interface", None),
        ({"shear": 1e12, "tension": 1e12}, "The layers hold: ", "shear of the interface", None),
    ],
)
def test_strength_of_a_coating_under_residual_tension(strength, text, quantity, factor):
    """A load that hardly matters: the tension is the residual stress, to a thousandth."""
    coating = HARD | {"residual_stress": 2e9, "strength": strength}
    answer = run(a_rough_map(), Body(young=210e9, poisson=0.3, layers=[coating]), mean_pressure=1e3)
    assert any(each.startswith(text) for each in answer.verdict)
    ratio = answer[f"strength over stress, {quantity}"]
    assert answer["least strength over stress"].value <= ratio.value
    if factor is not None:
        rate = energy_release_rate(2e9, 2e-6, 400e9, 0.2)
        assert ratio.value == pytest.approx((factor / rate) ** 0.5, rel=0.01)
        assert "with the residual stress 2 GPa" in ratio.note
    else:
        stress = answer["maximum shear stress on the interface"].value
        assert ratio.value == pytest.approx(strength["shear"] / stress)
        assert "residual" not in ratio.note


def test_interval_that_holds_one_is_undecided(answer):
    """The verdict follows from the interval of the stress, not from its value."""
    shear = answer["maximum shear stress on interface 1"]
    limit = shear.value * (1 + 0.5 * shear.errors["discretisation"] / shear.value)
    layers = [HARD | {"residual_stress": 5e8, "strength": {"shear": limit}}, BOND | {"residual_stress": -2e8}]
    found = run(a_rough_map(), Body(**STEEL, layers=layers), mean_pressure=PRESSURE)
    assert any(text.startswith("Interface 1 may peel in shear") for text in found.verdict)
    assert found["least strength over stress"].value > 1


def body(**more):
    return lambda: asp.Case(map="a.x3p", load={"force": 1.0}, body={"layers": [HARD, BOND]} | more)


BOTH, MISSPELT, UNSAID = {"energy": 1, "toughness": 1}, {"strength": {"energi": 1}}, {"strength": {}}
PEELS, LIMITS = {"shear": 1e6}, {"fatigue_torsion": 1e8, "fatigue_bending": 2e8}
test_wrong_layers_are_refused = refuses(
    (body(), "2 problems:\n  body.young: missing"),
    (body(base="bonded", **LIMITS), "body.fatigue_torsion: not accepted with several layers on a rigid base"),
    (body(base="bonded", layers=[HARD, BOND | {"strength": PEELS}]), "body.layers.1.strength.shear: not"),
    (body(**STEEL, layers=[HARD, {"young": 1e9}]), r"2 problems:\n  body.layers.1.poisson: missing"),
    (body(**STEEL, layers=[HARD, BOND | {"strength": BOTH}]), "body.layers.1.strength.t"),
    (body(**STEEL, layers=[HARD | MISSPELT]), "body.layers.0.strength.energi: unknown key; did"),
    (body(**STEEL, layers=[HARD | UNSAID]), "body.layers.0.strength: one of shear, tension, energy"),
    (lambda: asp.Case(map="a", load={"force": 1.0}, body=STEEL, strength={}), "strength: needs the strength"),
)
