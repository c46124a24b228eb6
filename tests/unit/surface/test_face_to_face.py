"""Two maps face to face are the sum of their reliefs, one of them turned over."""

import numpy as np
import pytest
from samples import refuses

from asperity.surface.reading.height_map import LOWER_FACE, HeightMap
from asperity.surface.treatment.face_to_face import face_to_face

EDGE = (32e-6, 48e-6)


def wave(shape=(32, 48), ky=1, kx=2, phase=0.4, length=EDGE, **more):
    """A wave at the middles of pixels, which repeats with the edges."""
    y, x = ((np.arange(n) + 0.5) / n for n in shape)
    height = 1e-7 * np.cos(2 * np.pi * (ky * y[:, None] + kx * x) + phase)
    return HeightMap(height, length, unit="m", **more)


def noise(seed):
    return HeightMap(1e-7 * np.random.default_rng(seed).normal(size=(32, 48)), EDGE, unit="m")


LOWER, UPPER = noise(1), noise(2)


@pytest.mark.parametrize(("axis", "turn"), [("y", np.s_[:, ::-1]), ("x", np.s_[::-1])])
def test_upper_map_is_turned_over_about_the_axis(axis, turn):
    """The right of the upper map touches the left of the lower one, turned about y.

    From below left and right are exchanged; a lower face is not turned.
    """
    pair = face_to_face(LOWER, UPPER, axis)
    expected = -LOWER.height - UPPER.height[turn]
    np.testing.assert_array_equal(pair.map.height, expected - expected.mean())
    assert (pair.map.orientation, pair.map.length, pair.whole) == (LOWER_FACE, EDGE, True)
    assert pair.done == (f"counter map turned over about the axis {axis}, and laid on the map",)
    exchanged = face_to_face(UPPER, LOWER, axis).map.height
    np.testing.assert_allclose(exchanged[turn], pair.map.height, atol=1e-22)
    down = HeightMap(-UPPER.height[turn], EDGE, orientation=LOWER_FACE, unit="m")
    other = face_to_face(LOWER, down, axis)
    np.testing.assert_array_equal(other.map.height, pair.map.height)
    assert "not turned" in other.done[0]


@pytest.mark.parametrize("shape", [(32, 48), (40, 60), (50, 75)])
def test_unlike_pixels_are_interpolated(shape):
    """Waves with no slope at the edges are exact."""
    lower = wave(ky=0, kx=1, phase=0.0)
    found = face_to_face(lower, wave(shape, ky=2, kx=0, phase=0.0))
    assert ("interpolated" in found.done[-1]) == (shape != (32, 48))
    expected = -lower.height - wave((32, 48), ky=2, kx=0, phase=0.0).height
    np.testing.assert_allclose(found.map.height, expected - expected.mean(), atol=1e-19)


def test_shift_leaves_the_common_area():
    found = face_to_face(LOWER, UPPER, shift=(3e-6, -5e-6))
    expected = -LOWER.height[3:, :43] - UPPER.height[:, ::-1][:29, 5:]
    np.testing.assert_allclose(found.map.height, expected - expected.mean(), atol=1e-22)
    assert found.origin == pytest.approx((3e-6, 0.0))
    assert found.map.length == pytest.approx((29e-6, 43e-6))
    assert "29 µm x 43 µm in common" in found.done[1]


@pytest.mark.parametrize("shape", [(32, 48), (64, 72)])
@pytest.mark.parametrize("shift", [(0.0, 0.0), (2e-6, 7e-6), (1.3e-6, -0.4e-6)])
def test_periodic_maps_stay_periodic(shape, shift):
    """Against the shifted wave itself, on nodes and between them."""
    lower, upper = wave(periodic=True), wave(shape, ky=1, kx=3, phase=1.0, periodic=True)
    found = face_to_face(lower, upper, shift=shift)
    phase = 1.0 - 2 * np.pi * (shift[0] / EDGE[0] - 3 * shift[1] / EDGE[1])
    expected = -lower.height - wave(ky=1, kx=-3, phase=phase).height
    np.testing.assert_allclose(found.map.height, expected - expected.mean(), atol=1e-20)
    assert found.map.periodic


def laid(upper=UPPER, **settings):
    return face_to_face(wave(periodic=True), upper, **settings)


test_wrong_maps_are_refused_in_one_line = refuses(
    (lambda: laid(turned_about="z"), "turned_about = 'z': one of y, x is needed"),
    (lambda: laid(shift=1.0), "shift = 1.0: a pair"),
    (lambda: laid(shift=(0.0, 47e-6)), "shift along x = 4.7e-05: the maps have 1 nodes in common, at least"),
    (lambda: laid(HeightMap(np.full((4, 4), np.nan), EDGE, unit="m")), "upper: 16 points have no data"),
    (lambda: laid(HeightMap(np.zeros((4, 4)), EDGE)), ".*unit of one map is known"),
    (lambda: laid(wave(length=(32e-6, 32e-6), periodic=True)), ".*periodic maps of equal edges are needed"),
    (lambda: laid(wave(orientation=None)), ".*which way is up"),
)
