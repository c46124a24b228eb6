"""Every warning is given where it applies and not where it does not."""

from types import SimpleNamespace

import pytest
import xarray as xr

import asperity as asp
from asperity.engineering import Body, advice
from asperity.fourier.grid import Grid


def limits(reason="", **on_grid):
    """Estimates that equal the values on both grids, but for some values on the finer one."""
    kinds = ["on_grid", "on_half", "estimate", "error"]
    same = {"area_fraction": 0.05, "gradient_rms_contact": 0.1}
    of_peaks = {"largest": 1e9, "p90": 8e8, "p99": 9e8}
    found = xr.Dataset(
        {name: ("kind", [on_grid.get(name, size), size, size, 0.0]) for name, size in same.items()}
        | {
            name: (("kind", "quantity"), [[on_grid.get(name, size)] * 2, *[[size] * 2] * 2, [0.0] * 2])
            for name, size in of_peaks.items()
        },
        coords={"kind": kinds, "quantity": ["pressure", "von_mises"]},
    )
    return found.assign_attrs(reason=reason)


def an_answer(bodies=1, estimates=None, imposed_area=0.05, doubts=(), friction=0.0, hardness=None, **changed):
    """An answer about which nothing is to be said, with some of its values replaced."""
    numbers, face, record, body = (changed.pop(name, {}) for name in ("numbers", "face", "record", "body"))
    plain = {
        "area_fraction": 0.05,
        "rms_gradient": 0.05,
        "contact_nodes": 900,
        "peak_to_valley": 3e-6,
        "typical_patch_width": 9.0,
        "pressure_on_spike": False,
        "load_on_small_patches": 0.01,
        "load_of_largest_node": 0.001,
        "load_on_edges": 0.0,
        "violation": 1e-7,
        "largest_pressure": 3e9,
        "nominal_pressure": 1e8,
    }
    shown = {
        "grid": Grid((128, 128), 128e-6),
        "height": asp.self_affine((128, 128), 0.8, 1 / 8, 1 / 16, rms_height=1e-7, seed=1),
        "images": 1,
        "wavelength_short": 8e-6,
        "boundary": "periodic",
    }
    treated = {"altered_fraction": 0.0, "filled_fraction": 0.0, "edge_step": 0.0} | record
    part = {
        "body": Body(**({"young": 210e9, "poisson": 0.3, "yield_stress": 2e9} | changed)),
        "largest_von_mises": 1e9,
        "depths_above_yield": (0.0, 2e-6),
        "limits": limits() if estimates is None else estimates,
        "cycles": None,
    }
    stress = SimpleNamespace(**(part | body))
    stress.materials = {"": stress}
    return SimpleNamespace(
        numbers=SimpleNamespace(**(plain | numbers)),
        face=SimpleNamespace(**(shown | face), treatment=SimpleNamespace(**treated)),
        case=SimpleNamespace(
            hertz_contact=None,
            load=SimpleNamespace(kind="area_fraction", value=imposed_area),
            friction=friction,
            solid=asp.Layer(1e6, 0.5, height=20.37e-6),
            different_bodies=("lower", "upper")[:bodies],
            bodies={"lower": part["body"]},
            hardness=hardness,
            options=asp.MapOptions(),
        ),
        slip=None,
        coarse={},
        rough=SimpleNamespace(doubts=doubts, spikes=[(0, 0)] * 3),
        bodies=dict.fromkeys(("lower", "upper")[:bodies], stress),
        neighbours=None,
        unfiltered=None,
        plastic=None,
    )


def subjects(answer, level="warning"):
    return [found.subject for found in advice.advise(answer) if found.level == level]


def test_nothing_is_warned_of_in_a_sound_answer():
    assert subjects(an_answer()) == []
    notes = ["numbers for vanishing pixels", "resolution", "one place of the surface"]
    assert subjects(an_answer(), "note") == notes


@pytest.mark.parametrize(
    ("changed", "subject"),
    [
        ({"body": {"largest_von_mises": 2.1e9}}, "stress beyond yield"),
        ({"body": {"largest_von_mises": 2.1e9}, "hardness": 6e9}, "stress beyond yield"),
        ({"numbers": {"nominal_pressure": 6.1e9}}, "load beyond the hardness"),
        ({"body": {"largest_von_mises": 5e9}, "yield_stress": None}, "stress beyond any yield stress"),
        ({"estimates": limits(largest=1.2e9)}, "limited by the resolution of the map"),
        ({"numbers": {"rms_gradient": 1.5}}, "steep slopes"),
        ({"numbers": {"area_fraction": 0.4}, "imposed_area": 0.4}, "large real contact"),
        ({"numbers": {"area_fraction": 0.25}}, "another real contact"),
        ({"record": {"edge_step": 8.0}}, "edges do not match"),
        ({"numbers": {"load_on_edges": 0.2}, "face": {"boundary": "free"}}, "contact at the edge of the map"),
        ({"numbers": {"load_on_small_patches": 0.7, "typical_patch_width": 1.1}}, "spikes carry the load"),
        ({"numbers": {"typical_patch_width": 2.6}}, "patches of few pixels"),
        ({"numbers": {"contact_nodes": 0}}, "no contact"),
        ({"numbers": {"pressure_on_spike": True}}, "largest pressure on a spike"),
        ({"numbers": {"largest_pressure": 300e9}}, "pressure above Young's modulus"),
        ({"doubts": ["unit: an rms height of 0.4 nm; is um the unit?"]}, "unit of the map"),
        ({"numbers": {"peak_to_valley": 3e-4}}, "heights as large as the map"),
        ({"young": 210e12}, "Young's modulus"),
        ({"young": 210e6}, "Young's modulus"),
        ({"poisson": 0.5}, "Poisson's ratio"),
        ({"yield_stress": 1.5e11}, "yield stress"),
        ({"numbers": {"violation": 0.1}}, "accuracy of the solution"),
        ({"numbers": {"violation": float("nan")}}, "accuracy of the solution"),
    ],
)
def test_a_warning_is_given(changed, subject):
    assert subject in subjects(an_answer(**changed))


@pytest.mark.parametrize(
    ("changed", "subject"),
    [
        ({"numbers": {"rms_gradient": 0.5}}, "steep slopes"),
        ({"record": {"altered_fraction": 0.36}}, "altered heights"),
        ({"record": {"filled_fraction": 0.05}}, "altered heights"),
        ({"estimates": limits("8 nodes are in contact")}, "no estimate for vanishing pixels"),
        ({"doubts": ["detrend: a bow of 2 µm; set it to curvature"]}, "detrend of the map"),
        ({"young": 210e6, "yield_stress": None}, "Young's modulus"),
        ({"poisson": -0.2}, "Poisson's ratio"),
    ],
)
def test_a_note_is_given(changed, subject):
    assert subject in subjects(an_answer(**changed), "note")


def test_the_body_is_named_if_there_are_two():
    """The same is not said twice of two bodies of one material."""
    answer = an_answer(bodies=2, body={"largest_von_mises": 3e9})
    texts = [a.text for a in advice.advise(answer)]
    assert any("of the lower body" in text for text in texts)
    assert not any("of the upper body" in text for text in texts)
    answer.bodies["upper"] = SimpleNamespace(**vars(answer.bodies["lower"]) | {"body": Body(70e9, 0.33)})
    assert any("of the upper body" in a.text for a in advice.advise(answer))
    of_one = [a.text for a in advice.advise(an_answer(body={"largest_von_mises": 3e9}))]
    assert of_one
    assert not any("lower body" in text for text in of_one)


def test_friction_on_a_thin_layer_is_warned_of():
    (found,) = (f for f in advice.advise(an_answer(friction=0.3)) if f.subject == "friction in the contact")
    assert found.level == "warning"
    assert "waves of 128 µm by up to 37 %" in found.text  # 1.23 μ at a wavenumber of 1/height


def test_a_change_of_rounding_errors_is_not_told():
    """The mean slope of a single node in contact is zero by symmetry."""
    estimates = limits(largest=1.02e9)
    estimates["gradient_rms_contact"].values[:2] = 1e-3, 1e-17
    (found,) = (f for f in advice.advise(an_answer(estimates=estimates)) if f.subject == "resolution")
    assert "rms gradient" not in found.text
    assert "largest pressure by +2 %" in found.text
