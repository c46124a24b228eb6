"""The same seed is the same surface, in every version: heights kept from version 0.2.0."""

from __future__ import annotations

import numpy as np
import pytest

import asperity as asp

NODES = ((0, 0), (5, 3), (40, 17), (-1, -1))

KEPT = {
    "gaussian": (-8.013507012107e-05, -0.0005666137202627, 0.001011018936736, 0.0001685427755742),
    "oblong": (9.140337036648e-05, -0.0006875475432636, -0.001141259980401, -7.985680229927e-05),
    "moments": (-0.000157749237419, -0.0006089798220698, 0.0009948557297628, 8.684304304785e-05),
    "johnson": (-2.491424816625e-05, -0.0005473411137005, 0.001029413145712, 0.0002321716431317),
}
"""Surface → its heights at `NODES`. A change here is a change of every random surface that was published."""


def made(name):
    gaussian = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    if name == "oblong":
        return asp.self_affine((96, 64), 0.3, 0.5, 0.125, rms_height=1e-3, seed=7, length=(1.5, 1.0))
    if name == "moments":
        return asp.with_moments(gaussian, skewness=0.5, kurtosis=3.5)
    if name == "johnson":
        return asp.johnson(gaussian, gamma=-1.0, delta=2.0)
    return gaussian


@pytest.mark.parametrize("name", KEPT)
def test_heights_are_those_that_were_kept(name):
    height = made(name)
    tolerance = 1e-9 if name != "moments" else 1e-6  # with_moments solves for its parameters
    assert [height[node] for node in NODES] == pytest.approx(KEPT[name], rel=tolerance)


def test_a_finer_grid_has_the_same_surface():
    coarse = made("gaussian")
    fine = asp.self_affine((128, 128), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    np.testing.assert_allclose(fine[::2, ::2], coarse, atol=1e-14)
