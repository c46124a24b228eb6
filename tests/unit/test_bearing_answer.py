"""Answers for a bearing: a part of a map in a Hertz contact, forms with two radii, and what they say."""

import numpy as np
import pytest

import asperity as asp
from asperity.settings.model import SettingsError

STEEL = {"young": "207 GPa", "poisson": 0.3, "yield_stress": "2 GPa"}
BALL = {"force": "166.7 N", "radius_x": "3.776 mm", "radius_y": "123.8 mm"}


def ground(shape=(96, 128), pixel=2e-6, seed=1):
    """A map ground along y, as 300 x 400 µm of an instrument."""
    edges = shape[0] * pixel, shape[1] * pixel
    height = asp.self_affine((shape[1], shape[1]), 0.8, edges[1] / 4, 8 * pixel, 1e-7, seed, length=edges[1])
    along = np.repeat(height[: shape[0] // 8], 8, axis=0)
    return asp.HeightMap(along, edges, unit="m", name="ring")


def test_map_wider_than_its_hertz_contact_names_both_remedies():
    with pytest.raises(SettingsError, match=r'map\.crop = "66 µm".*map\.radius and map\.radius_y'):
        asp.run(ground(), STEEL, STEEL, load=BALL)


def test_part_of_a_map_is_pressed_and_said():
    answer = asp.run(
        {"file": ground(), "crop": "66 um", "crop_at": ("80 um", "120 um")}, STEEL, STEEL, load=BALL
    )
    assert answer.face.map_length == pytest.approx((66e-6, 66e-6))
    assert any(
        "cropped to 66 µm x 66 µm" in line and "around 81 µm x 121 µm" in line for line in answer.face.done
    )
    assert answer.contact.mean_pressure == pytest.approx(1.255e9, rel=1e-3)


def test_elliptic_body_with_a_free_boundary_is_as_hertz_says():
    """Radii of 1 and 4 mm on pixels of a/20; the approach of the paraboloid has no image to disturb it."""
    edges, shape, load = (200e-6, 120e-6), (200, 120), 2.0
    flat = asp.HeightMap(np.zeros(shape), edges, unit="m", name="ball")
    answer = asp.run(
        {"file": flat, "radius": "1 mm", "radius_y": "4 mm", "periodic": "none"}, STEEL, force=load
    )
    exact = asp.stress.HertzContact.from_radii(
        1e-3, 4e-3, asp.Solid(207e9, 0.3).effective_modulus, force=load
    )
    assert answer.numbers.largest_pressure == pytest.approx(exact.largest_pressure, rel=0.01)
    area = np.pi * exact.half_width_x * exact.half_width_y
    assert answer.numbers.contact_area == pytest.approx(area, rel=0.02)


def test_friction_without_a_direction_slides_along_the_lay():
    case = {"sliding": {"friction": 0.08}, "mean_pressure": "100 MPa"}
    answer = asp.run({"file": ground(), "crop": "100 um"}, STEEL, **case)
    assert answer.case.sliding_direction == "y"
    assert any("sliding.direction is not given" in advice.text for advice in answer.advice)
    isotropic = asp.self_affine((64, 64), 0.8, 2e-5, 8e-6, 1e-7, seed=1, length=1e-4)
    answer = asp.run(asp.HeightMap(isotropic, (1e-4, 1e-4), unit="m"), STEEL, **case)
    assert answer.case.sliding_direction == "x"
