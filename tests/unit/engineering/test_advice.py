"""Every warning is given where it applies and not where it does not, in an answer with values replaced."""

import math
from dataclasses import is_dataclass, replace
from typing import NamedTuple

import pytest
import xarray as xr

import asperity as asp
from asperity import Body, run
from asperity.engineering import advice
from asperity.engineering.question import Stages
from asperity.settings.model import Settings
from asperity.surface.treatment.treatment import Doubt

STEEL = Body(young=210e9, poisson=0.3, yield_stress=2e9)


class Advised(NamedTuple):
    """What an answer is advised on: its stages, and further contacts with which it is compared."""

    stages: Stages
    compared: advice.Compared

    def given(self):
        """All warnings and notes, those of the questions with the records before them."""
        found = [
            question.compute(self.stages, lambda *_: None)
            for question in self.stages.asked.questions.values()
        ]
        of_questions = [each for one in found for each in one.warnings]
        return advice.advise(self.stages, self.compared, self.stages.records, of_questions)


def advised(*body, **settings):
    """What the answer of a case is advised on."""
    found = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("asperity.engineering.stages.advise", lambda *given: found.append(given) or [])
        run(*body, **settings)
    return Advised(*found[0][:2])


@pytest.fixture(scope="module")
def sound():
    """An answer without advice: both grids resolve its surface."""
    height = asp.self_affine((128, 128), 0.8, 16e-6, 8e-6, rms_height=1e-8, seed=1, length=128e-6)
    surface = asp.HeightMap(height, (128e-6, 128e-6), periodic=True, unit="m", name="ground")
    found = advised(surface, STEEL, contact_area_fraction=0.05)
    limits = found.stages.bodies["lower"].limits
    alike = limits.where(limits["kind"] != "on_half", limits.sel(kind="on_grid"))
    changes = {"bodies.lower.limits": alike.assign_attrs(limits.attrs)}
    return changed(found, changes | {"numbers.typical_patch_width": 9.0, "rough.doubts": ()})


def changed(advised, changes):
    """A copy in which values of the stages are replaced at the places that their names give."""
    stages = advised.stages
    for path, value in changes.items():
        stages = replaced(stages, path, value)
    return advised._replace(stages=stages)


def replaced(whole, path, value):
    """A copy of a part of an answer with a value at a place, which may be that of a record."""
    name, _, rest = path.partition(".")
    if isinstance(whole, list):  # of records
        return [replaced(each, rest, value) if each.quantity == name else each for each in whole]
    if rest:
        value = replaced(whole[name] if isinstance(whole, dict) else getattr(whole, name), rest, value)
    if isinstance(whole, dict):
        return whole | {name: value}
    if isinstance(whole, xr.Dataset):
        return whole.assign_attrs({name: value})
    if isinstance(whole, Settings):
        return whole.replaced(**{name: value})
    return replace(whole, **{name: value}) if is_dataclass(whole) else whole._replace(**{name: value})


def subjects(advised, level="warning"):
    return [found.subject for found in advised.given() if found.level == level]


def test_nothing_is_warned_of_in_a_sound_answer(sound):
    assert subjects(sound) == []
    notes = ["numbers extrapolated to zero pixel size", "resolution", "one position of the surface"]
    assert subjects(sound, "note") == notes


STRESS, BODY, RECORD = "records.maximum von Mises stress.value", "bodies.lower.body", "rough.face.treatment"
SPIKES = Doubt("despike", "3 spikes of up to 2 µm", "8", "to replace them")
FREE = {"rough.face.boundary": "free", "numbers.load_on_edges": 0.2}


WARNINGS = [
    ({STRESS: 2.1e9}, "stress beyond yield"),
    ({STRESS: 2.1e9, "asked.body.hardness": 6e9}, "stress beyond yield"),
    ({"numbers.nominal_pressure": 6.1e9, "contact.hardness": math.inf}, "load beyond the hardness"),
    ({f"{BODY}.yield_stress": None, f"{BODY}.young": 6e9}, "stress beyond any yield stress"),
    ({"numbers.rms_gradient": 1.5}, "steep slopes"),
    ({"numbers.contact_area_fraction": 0.4, "asked.load.contact_area_fraction": 0.4}, "large contact area"),
    ({"numbers.contact_area_fraction": 0.25}, "another contact area"),
    ({f"{RECORD}.edge_step": 8.0}, "edges do not match"),
    (FREE, "contact at the edge of the map"),
    ({"numbers.load_on_small_patches": 0.7, "numbers.typical_patch_width": 1.1}, "spikes carry the load"),
    ({"numbers.typical_patch_width": 2.6}, "contact spots of few pixels"),
    ({"numbers.contact_nodes": 0}, "no contact"),
    ({"numbers.pressure_on_spike": True}, "maximum pressure on a spike"),
    ({"numbers.maximum_pressure": 300e9}, "pressure above Young's modulus"),
    ({"rough.doubts": [Doubt("unit", "an rms height of 0.4 nm; is um the unit?")]}, "unit of the map"),
    ({"numbers.peak_to_valley": 3e-4}, "heights as large as the map"),
    ({f"{BODY}.young": 210e12}, "Young's modulus"),
    ({f"{BODY}.young": 210e6}, "Young's modulus"),
    ({f"{BODY}.poisson": 0.5}, "Poisson's ratio"),
    ({f"{BODY}.yield_stress": 1.5e11}, "yield stress"),
    ({"numbers.violation": float("nan")}, "accuracy of the solution"),
    ({"rough.doubts": [Doubt("detrend", "a form of 2 µm height", "curvature")]}, "detrend of the map"),
    ({"rough.doubts": [SPIKES], "numbers.presses_spikes": True}, "despike of the map"),
]
NOTES = [
    ({"numbers.rms_gradient": 0.5}, "steep slopes"),
    ({f"{RECORD}.altered_fraction": 0.36}, "altered heights"),
    ({f"{RECORD}.filled_fraction": 0.05}, "altered heights"),
    ({"bodies.lower.limits.reason": "8 nodes"}, "no extrapolation to zero pixel size"),
    ({"rough.doubts": [SPIKES]}, "despike of the map"),
    ({f"{BODY}.young": 210e6, f"{BODY}.yield_stress": None}, "Young's modulus"),
    ({f"{BODY}.poisson": -0.2}, "Poisson's ratio"),
]


@pytest.mark.parametrize(
    ("level", "changes", "subject"),
    [*(("warning", *row) for row in WARNINGS), *(("note", *row) for row in NOTES)],
)
def test_advice_is_given(sound, level, changes, subject):
    assert subject in subjects(changed(sound, changes), level)


def test_bodies_are_named_if_they_differ(sound):
    def told(upper):
        height = sound.stages.face.height
        surface = asp.HeightMap(height, (128e-6, 128e-6), periodic=True, orientation="lower face", unit="m")
        answer = run(surface, STEEL.replaced(yield_stress=1e8), upper, contact_area_fraction=0.05)
        return [each.text for each in answer.warnings if each.subject == "stress beyond yield"]

    assert ["of the upper body" in text for text in told(STEEL.replaced(yield_stress=1e8))] == [False]
    for text, name in zip(told(STEEL.replaced(yield_stress=2e8)), ("lower", "upper"), strict=True):
        assert f"of the {name} body" in text


def test_friction_on_a_thin_layer_is_warned_of(sound):
    rubber = Body(layers=[{"young": 1e6, "poisson": 0.5, "thickness": 20.37e-6}], base="bonded")
    layer = {
        "asked.yielding": None,
        "asked.body": rubber,
        "asked.sliding": {"friction": 0.3, "direction": "x"},
    }
    advised = changed(sound, layer)
    (found,) = (each for each in advised.given() if each.subject == "friction in the contact")
    assert found.level == "warning"
    assert "wavelength 128 µm by up to 37 %" in found.text  # 1.23 μ at a wavenumber of 1/height


def test_a_change_of_rounding_errors_is_not_told(sound):
    """The mean slope of a single node in contact is zero by symmetry."""
    limits = sound.stages.bodies["lower"].limits.copy(deep=True)
    for kind, value in (("on_grid", 1e-3), ("on_half", 1e-17)):
        limits["gradient_rms_contact"].loc[{"kind": kind}] = value
    limits["maximum"].loc[{"kind": "on_grid", "quantity": "pressure"}] *= 1.2
    advised = changed(sound, {"bodies.lower.limits": limits})
    (found,) = (each for each in advised.given() if each.subject.startswith("limited by the resol"))
    assert "rms gradient" not in found.text
    assert "maximum pressure by +20 %" in found.text
