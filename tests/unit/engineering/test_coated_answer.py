"""Coated bodies: their answer, their case and results, what is refused."""

import json

import numpy as np
import pytest
from samples import refuses
from small_study import LAYER as LAYER_SETTINGS
from small_study import SURFACE, results_of
from test_engineering import a_rough_map

import asperity as asp
from asperity import Body, run
from asperity.core.errors import InputError
from asperity.engineering.drawing import yield_at
from asperity.engineering.scene import solid_of
from asperity.engineering.show.pictures import pictures
from asperity.settings.check import check
from asperity.study.stages.contact import solid
from asperity.views.source import sources

COATING = {"thickness": 2e-6, "young": 400e9, "poisson": 0.25}
LIMITS = {"yield_stress": 1e9, "fatigue_torsion": 300e6, "fatigue_bending": 480e6}
COATED = Body(young=210e9, poisson=0.3, **LIMITS, layers=[COATING])
LAYER, STEEL = solid_of(COATED), asp.Solid(210e9, 0.3)


@pytest.fixture(scope="module")
def answer():
    soft = {"thickness": 1e-6, "young": 20e9, "poisson": 0.4, "yield_stress": 100e6}
    upper = Body(young=110e9, poisson=0.34, layers=[soft])
    return run(a_rough_map(), COATED, upper, mean_pressure=60e6, load_curve={"loads": [1e6]})


def test_answer_tells_the_materials_apart(answer):
    """The limits of the base count below the coating alone."""
    note = answer.record("maximum depth above yield", "lower").note
    assert 1e-6 * float(note.split()[-2]) >= LAYER.interface
    assert answer.datasets["cycles_lower"]["cycle_depth"].values[0] > LAYER.interface
    assert 1e6 < answer.record("mean pressure where yield begins", "lower").value < 60e6
    texts = [each.text for each in answer.warnings if "yield stress" in each.text]
    assert any("of the base of the lower body" in text for text in texts)
    assert any("of the coating of the upper body" in text for text in texts)


def test_results_describe_the_coatings(answer, tmp_path, without_pictures):
    """The section from the file equals the answer's, the bodies and the case are the same."""
    answer.write(tmp_path / "answer")
    dataset = asp.read_result(tmp_path / "answer" / "contact.nc")
    own, read = (
        asp.stress_section(solid, fields=("xx",), depths=[0.0, 1e-6, 3e-6])["xx"]
        for solid in (answer.contact.in_body("lower"), asp.LoadedSolid.from_dataset(dataset))
    )
    np.testing.assert_allclose(own, read, atol=1e-12 * float(abs(own).max()))  # rounding of E* = 1
    (source,) = sources({"": dataset}, None)
    assert source.layers["upper"] == solid_of(answer.case.counter_body)
    assert asp.Case.read(answer.case.written() | {"map": "a.x3p"}).bodies == answer.case.bodies


def test_residual_stress_of_the_coating_is_added():
    """It adds to σ_xx in the coating alone; the interface has a place and its picture."""
    body = COATED.replaced(fatigue_torsion=None, fatigue_bending=None)
    stressed = body.replaced(layers=[{**COATING, "yield_stress": 4e9, "residual_stress": -1e9}])
    found = [run(a_rough_map(), each, mean_pressure=60e6) for each in (body, stressed)]
    for name in ("maximum shear stress on the interface", "σ_xx on the interface, in the base"):
        assert found[1][name].value == pytest.approx(found[0][name].value, rel=1e-6)
    (plane,) = asp.stress_planes(
        found[0].contact.in_body("lower"), [LAYER.interface], fields=("xx",), tolerance=0
    )
    stress = plane.fields["xx"] - 1e9
    largest = stress.flat[np.abs(stress).argmax()]
    assert found[1]["σ_xx on the interface, in the coating"].value == pytest.approx(largest, rel=1e-3)
    energy = found[1]["energy of the residual stress of the coating"].value
    assert energy == pytest.approx((1 - 0.25) * 1e9**2 * 2e-6 / 400e9)
    assert found[1]["maximum shear stress on the interface"].position.depth == LAYER.interface
    assert np.isfinite(found[1]["maximum shear stress on the interface"].position).all()
    assert any("The interface of the coating" in text for text in found[1].verdict)
    np.testing.assert_array_equal(yield_at(stressed, np.array([1e-6, 3e-6])), [4e9, 1e9])
    assert "interface_shear" in {each.name for each in pictures(found[1])}


test_wrong_coating_is_refused = refuses(
    (lambda: asp.elasticity.layer_fields(LAYER, asp.Grid((8, 8)), {}), "layer = Solid.*: one without a base"),
    (lambda: COATED.replaced(layers=[{"thickness": 1e-6, "young": 1e9}]), r"layers\.0\.poisson: missing"),
    (lambda: COATED.replaced(layers=[{"yield_stress": 1e9}]), r"3 problems:\n  layers\.0\.young: missing"),
    (lambda: COATED.replaced(base="bonded"), "base = 'bonded': young, poisson, yield_stress belong to"),
    (lambda: Body(base="bonded", young=1e9, poisson=0.3), "base: needs layers"),
    (
        lambda: Body(base="bonded", layers=[COATING | {"residual_stress": 1e6}]),
        "layers.0.residual_stress: not",
    ),
    (lambda: Body(base="bonded", layers=[{"material": "100Cr7", "thickness": 1.0}]), "layers.0.material = "),
    (lambda: run({"file": "a.x3p", "periodic": "none"}, COATED, force=1.0), "body.layers: not accepted"),
)


def test_study_of_a_coating():
    """The study computes both materials, and a section from its file equals the section of its contact."""
    settings = LAYER_SETTINGS | {"height": 0.02, "base": {"modulus_ratio": 0.25, "poisson": 0.2}}
    found = results_of(1, settings)
    layer, record = solid(settings)
    assert record["solid"] == found.stress.attrs["solid"] == "coated half-space"
    assert layer.base.young == pytest.approx(0.25 * layer.young)
    assert {0.02, np.nextafter(0.02, 1)} <= set(found.stress["plane_depth"].values)
    assert found.stress["plane_depth"].values[-1] == 1.0
    written = found.contact.assign_attrs(settings=json.dumps({"layer": settings}))
    assert asp.LoadedSolid.from_dataset(written).layer == layer
    with pytest.raises(InputError, match=r"^layer.bottom = 'frictionless': bonded is needed"):
        check({"surfaces": {"a": SURFACE}, "layer": settings | {"bottom": "frictionless"}})
